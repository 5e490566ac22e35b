"""The measures behind the metrics: computed from other columns of the runs table, from the history
of the objective, or from the path.

A measure takes a table of at least one run and the problems by name, and gives one number per run
(n,), NaN where a run has no such value; those of a path alone, or of a path on a map, are made into
one by their decorators. Curve modules are imported only when a value is requested.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.metric import metric, of_path, on_map
from bezierplan.workspaces.grid import Grid

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.metric import Problems
    from bezierplan.workspaces.problem import Path

# Values of a curve's parameter at which curvature is taken: 120 steps on each of the five cubic
# pieces of song2016.
CURVATURE_SAMPLES = 601
# Samples of a curved piece between which headings are compared (ma2020: 2,000 chords).
HEADING_SAMPLES = 2001
# A smaller change of heading, in radians, is not a corner.
CORNER = 1e-6
# By which share a printed length may be rounded.
ROUNDED = 0.01


def find_disagreements(claimed: bool, runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Return where (n,) the planner's own test gives this result and the checker the opposite."""
    return (runs["claimed_feasible"] == claimed) & (runs["feasible"] != claimed)


@metric(
    "-",
    "rank of the objective among the rows of the table, within one unit",
    among_rows=True,
    least=1.0,
    step=0.5,
)
def rank(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Rank the objective within one unit (n,), among methods or numbers of obstacles; ties share
    the mean of their ranks.
    """
    unit = [column for column in ("workspace", "layout", "profile", "repeat") if column in runs]
    return runs.groupby(unit, dropna=False)["objective"].rank()


def read_reference(runs: pd.DataFrame) -> pd.Series:
    """Return the length of the best known path of each run's problem. Raises ValueError if it is
    shorter than the exact shortest path.
    """
    too_short = runs["reference"] < (1 - ROUNDED) * runs.get("bound", np.nan)
    if too_short.any():
        run = runs[too_short].iloc[0]
        raise ValueError(
            f"problem {run['problem']}: reference {run['reference']:g} lies below the exact "
            f"shortest length {run['bound']:.12g}"
        )
    return runs["reference"]


def extend_histories(runs: pd.DataFrame, least: int = 0) -> np.ndarray:
    """Return the histories (runs, generations + 1), each extended with its last value to the
    length of the longest one, or to `least` if that is longer.
    """
    lengths = runs["history"].map(len).to_numpy()
    starts = np.cumsum(lengths) - lengths
    columns = np.minimum(np.arange(max(lengths.max(), least)), lengths[:, None] - 1)
    # Histories end to end; beyond the end of one, its last entry is repeated.
    return np.concatenate(runs["history"].to_list())[starts[:, None] + columns]


def find_first_generation(share: float, runs: pd.DataFrame, problems: Problems) -> np.ndarray:
    """Find the first generation (n,) whose best objective so far is at most 1 + share times the
    final one.
    """
    held = extend_histories(runs)
    return (held <= held[:, -1:] * (1 + share)).argmax(axis=1)


@metric("-", "length / exact shortest length of the problem - 1", feasible_only=True, least=0.0)
def gap(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Compute the length over the exact shortest length, minus 1 (n,)."""
    return runs["length"] / runs["bound"] - 1


def is_near_shortest(share: float, runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Tell which runs (n,) have a path that the certified checker accepts and that is at most this
    share longer than the exact shortest one.
    """
    return certified_length(runs, problems) <= (1 + share) * runs["bound"]


@metric(
    "u", "exact arc length, infinite unless the certified checker accepts the path", least="bound"
)
def certified_length(runs: pd.DataFrame, problems: Problems) -> np.ndarray:
    """Return the length (n,) of a path that the certified checker accepts, else infinity."""
    return np.where(runs["feasible"].astype(bool), runs["length"], np.inf)


@metric(
    "-",
    "arrival / lower bound on the arrival - 1, where all methods of the table arrive",
    among_rows=True,
    least=0.0,
    needs=("arrival",),
)
def paired_gap_least_arrival(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Compute the gap of the arrival (n,) of the runs in whose condition and repeat all methods
    among the runs have a feasible one; NaN for the others.
    """
    arrived = runs["method"].where(runs["feasible"].astype(bool))
    together = arrived.groupby([runs["condition"], runs["repeat"]]).transform("nunique")
    late = runs["arrival"] / runs["least_arrival"] - 1
    return late.where(together == runs["method"].nunique())


def sample_path(path: Path, count: int) -> np.ndarray:
    """Sample points (count, 2) along a path."""
    from bezierplan.geometry import curves

    return curves.sample_matrix(path.curve, len(path.points), count) @ path.points


def sample_curvature(path: Path) -> np.ndarray:
    """Sample the curvature of a path at `CURVATURE_SAMPLES` values, NaN where the speed is zero."""
    from bezierplan.geometry import curves

    return curves.curvature(path, CURVATURE_SAMPLES)[0]


@of_path(
    "1/u",
    f"largest absolute curvature over {CURVATURE_SAMPLES} samples, corners between pieces left out",
)
def max_curvature(path: Path) -> float:
    """Return the largest absolute curvature of `CURVATURE_SAMPLES` samples, in 1/unit; it counts as
    0 where the speed is zero.
    """
    return float(np.nan_to_num(np.abs(sample_curvature(path))).max())


@of_path("1/u", "largest jump of curvature over the joints, infinite at a corner")
def curvature_jump(path: Path) -> float:
    """Return the largest jump of curvature over a path's joints, in 1/unit."""
    from bezierplan.geometry import curves

    return curves.curvature_jump(path)


def list_steps(points: np.ndarray) -> np.ndarray:
    """List the steps (m, 2) between points (n, 2) but for those of length 0."""
    steps = np.diff(points, axis=0)
    # A step of length 0 has no heading, and the turn there would be lost.
    return steps[np.hypot(*steps.T) > 0]


def compute_heading_changes(steps: np.ndarray) -> np.ndarray:
    """Compute the absolute changes of heading (n - 1,), in radians, between steps (n, 2)."""
    cross = steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0]
    # The arccosine of a dot product would lose digits at small angles.
    return np.abs(np.arctan2(cross, (steps[:-1] * steps[1:]).sum(axis=1)))


def measure_heading_changes(path: Path) -> np.ndarray:
    """Measure the changes of heading along a path, in radians; a curve is taken as chords between
    samples.
    """
    is_polyline = path.curve == "polyline"
    return compute_heading_changes(
        list_steps(path.points if is_polyline else sample_path(path, HEADING_SAMPLES))
    )


@of_path("rad", "changes of heading, all added")
def turning(path: Path) -> float:
    """Sum all changes of heading, in radians."""
    return float(measure_heading_changes(path).sum())


@of_path("-", "joints of a path's pieces at which its heading changes", step=1.0)
def corners(path: Path) -> int:
    """Count the joints of a path's pieces at which its heading changes."""
    from bezierplan.geometry import curves

    legs = [steps for steps in map(list_steps, curves.bezier_pieces(path)) if len(steps)]
    return sum(
        int(compute_heading_changes(np.array([one[-1], other[0]]))[0] > CORNER)
        for one, other in itertools.pairwise(legs)
    )


@on_map(
    "-",
    "number of cells that the path touches; none for a path that touches an occupied cell",
    "grid",
    least=0.0,
    step=1.0,
)
def cells(path: Path, grid: Grid) -> float:
    """Count the cells that a path touches; NaN for one that touches an occupied cell."""
    from bezierplan.geometry import cell_length

    columns, rows = cell_length.list_touched_cells(*cell_length.sample_in_cells(path, grid))
    occupied = cell_length.count_occupied_cells(columns, rows, grid.occupied)
    return np.nan if occupied else float(len(columns))


@metric("-", "whether an obstacle is in the way, so that no straight line is free", step=1.0)
def blocked(runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Return where (n,) the exact shortest path of a run's problem is longer than the straight
    line.
    """
    straight = {
        name: np.hypot(*np.subtract(each.start, each.target)) for name, each in problems.items()
    }
    # A straight shortest path has the same length up to rounding.
    return runs["bound"] > runs["problem"].map(straight) * (1 + 1e-9)
