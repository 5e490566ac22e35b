"""Every metric once: name, unit, meaning, and over which runs it is taken.

A metric is a column of the runs table, or is computed from other columns: from the history of the objective, or from the path. This module
is also read where only the names matter, so it imports pandas, and what draws curves, no earlier than a value is asked for.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import ON_LINE, Grid, embed

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.workspaces.problem import Path, Problem, Workspace

# Values of a curve's parameter at which curvature is taken: 100 steps on each of the six quadratic pieces of song2016.
CURVATURE_SAMPLES = 601
# A finer test than any planner's own.
FINE_SAMPLES = 4001
# Samples of a path by which its way round the circles is told.
CLASS_SAMPLES = 2001
# Samples of a curved piece between which its heading is compared (ma2020: 2,000 chords).
HEADING_SAMPLES = 2001
# Parts of about this length, in units, by which a path's bending is measured, and samples of a curved piece that they are cut from.
BENDING_PART = 0.1
BENDING_SAMPLES = 64
# A smaller change of heading, in radians, is no corner.
CORNER = 1e-6


class Metric(NamedTuple):
    """unit: `u` stands for the workspace's unit of length, `-` for a number without unit. meaning: one phrase.

    feasible_only: taken over the runs whose path the certified checker accepts, otherwise over all runs.
    compute: (runs, problems) -> one number a run (n,), where runs is a table of at least one run; None for a column of the runs table.
    among_rows: it compares the methods of a table with each other, so variants and baselines beside the table have none.
    least: the least value that a run can have, or the column of the runs table that holds it. most: the largest.
    bound, gap: the column with the bound of its kind of length, and the metric that is the gap to it.
    """

    unit: str
    meaning: str
    feasible_only: bool
    compute: Callable[[pd.DataFrame, dict[str, Problem]], np.ndarray] | None = None
    among_rows: bool = False
    least: float | str = -np.inf
    most: float = np.inf
    bound: str = "bound"
    gap: str = "gap"


def values(runs: pd.DataFrame, name: str, problems: dict[str, Problem]) -> pd.Series:
    """A metric of each run, as floats (truth as 1 and 0) with the runs' index.

    Not a number where the run has no such value, and where the metric is for feasible runs only and the run is not feasible. A metric that
    compares runs with each other compares those given. Raises KeyError for an unknown metric, and where the runs table lacks a column.
    """
    import pandas as pd

    metric = METRICS[name]
    counted = runs[runs["feasible"].astype(bool)] if metric.feasible_only else runs
    if counted.empty:
        numbers = pd.Series(dtype=float)
    elif metric.compute is None:
        numbers = counted[name].astype(float)
    else:
        numbers = pd.Series(np.asarray(metric.compute(counted, problems), dtype=float), index=counted.index)
    return numbers.reindex(runs.index)


def unit(name: str, workspace_unit: str) -> str:
    """The unit of a metric in a workspace with the given unit of length."""
    return re.sub(r"\bu\b", workspace_unit, METRICS[name].unit)


def _failed(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    return ~runs["feasible"].astype(bool)


def _disagrees(claimed: bool, runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) the planner's own test says this and the checker's the opposite."""
    return ((runs["claimed_feasible"] == claimed) & (runs["feasible"] != claimed)).to_numpy()


def _rank(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Rank (n,) of the objective within one unit, among methods or numbers of obstacles; equal ones share the mean of their ranks."""
    unit = [column for column in ("workspace", "layout", "profile", "repeat") if column in runs]
    return runs.groupby(unit, dropna=False)["objective"].rank().to_numpy()


# A value this many interquartile ranges beyond its quartile is an outlier of a box plot.
_OUTLIER_REACH = 1.5


def _outlier(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) a run's objective lies beyond the whiskers of the box of its method under its condition."""
    grouped = runs.groupby(["condition", "method"], dropna=False)["objective"]
    first, third = grouped.transform(lambda each: each.quantile(0.25)), grouped.transform(lambda each: each.quantile(0.75))
    reach = _OUTLIER_REACH * (third - first)
    return ((runs["objective"] < first - reach) | (runs["objective"] > third + reach)).to_numpy()


def _gap_reference(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Length over that of the best known path of the same kind, minus 1 (n,); not a number where none is known."""
    return runs["length"] / runs["reference"] - 1


def _excess_reference(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Length minus that of the best known path of the same kind (n,); not a number where none is known."""
    return runs["length"] - runs["reference"]


def _held_history(runs: pd.DataFrame) -> np.ndarray:
    """Best objective so far by generation: (runs, most generations + 1). Runs that stopped early hold their last value."""
    lengths = runs["history"].map(len).to_numpy()
    starts = np.cumsum(lengths) - lengths
    columns = np.minimum(np.arange(lengths.max()), lengths[:, None] - 1)
    return np.concatenate(runs["history"].to_list())[starts[:, None] + columns]


def _lowest_objective(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Lowest objective (n,) of any generation, whichever one the planner's result is taken from."""
    return _held_history(runs)[:, -1]


def _first_generation_within(share: float, runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """First generation (n,) whose best objective so far is at most 1 + share times the final one."""
    held = _held_history(runs)
    return (held <= held[:, -1:] * (1 + share)).argmax(axis=1)


def _improvement_by(generation: int, runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Share (n,) of the improvement from generation 0 to the last one that is made by a generation."""
    held = _held_history(runs)
    total = held[:, 0] - held[:, -1]
    made = held[:, 0] - held[:, min(generation, held.shape[1] - 1)]
    return np.divide(made, total, out=np.full(len(held), np.nan), where=total > 0)


def _history_mean(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Mean (n,) of the best objective so far over all generations."""
    return _held_history(runs).mean(axis=1)


def _deviation(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    median = runs.groupby(["experiment", "condition", "method"])["length"].transform("median")
    return (runs["length"] / median - 1).abs()


def _gap(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    return runs["length"] / runs["bound"] - 1


def _gap_best(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    best = runs.groupby(["experiment", "condition", "method"])["length"].transform("min")
    return runs["length"] / best - 1


def _paths(runs: pd.DataFrame) -> Iterator[Path | None]:
    """The path of each run, None where it has none."""
    from bezierplan.workspaces.problem import Path

    for curve, points in zip(runs["path_curve"], runs["path_points"]):
        yield Path(curve, np.reshape(points, (-1, 2))) if curve else None


def _of_path(measure: Callable[[Path], float], runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """A number of each run's path, not a number where the run has none."""
    return [np.nan if path is None else measure(path) for path in _paths(runs)]


def _of_path_on_grid(measure: Callable[[Path, Grid], float], runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """A number of each run's path and the grid that it lies in, not a number where the run has no path."""
    return [np.nan if path is None else measure(path, problems[problem].workspace) for path, problem in zip(_paths(runs), runs["problem"])]


def homotopy_class(points: np.ndarray, workspace: Workspace) -> float:
    """On which side a way of points (n, 2) passes each circle: the sum of 2^k over the circles k = 0, 1, ... that it leaves to its left.

    A circle lies to the left if the angle that the way sweeps about its centre is positive. Enough to tell classes apart where no way winds
    round a circle and all have the same ends. Not a number without points or in a workspace of another kind.
    """
    if not len(points) or not isinstance(workspace, Circles):
        return np.nan
    x, y = np.ascontiguousarray(points.T)[:, None] - workspace.centres.T[:, :, None]
    angles = np.arctan2(y[:, [0, -1]], x[:, [0, -1]])
    # Where the way crosses the ray to the left of the centre its angle goes on from pi to -pi, or back.
    leftward = x[:, :-1] * y[:, 1:] > y[:, :-1] * x[:, 1:]
    above = y >= 0
    rounds = (above[:, :-1] & ~above[:, 1:] & leftward).sum(axis=1) - (~above[:, :-1] & above[:, 1:] & ~leftward).sum(axis=1)
    swept = angles[:, 1] - angles[:, 0] + 2 * np.pi * rounds
    return float((2.0 ** np.arange(len(workspace.centres)))[swept > 0].sum())


def _homotopy(runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """The homotopy class of each run's path."""
    from bezierplan.geometry import curves

    found = []
    for path, problem in zip(_paths(runs), runs["problem"]):
        if path is None:
            found.append(np.nan)
            continue
        points = curves.sample_matrix(path.curve, len(path.points), CLASS_SAMPLES) @ path.points
        found.append(homotopy_class(points, problems[problem].workspace))
    return found


def _best_corridor(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) a run's path is free and in the homotopy class of the exact shortest one; not a number without circles."""
    best = {
        problem: homotopy_class(np.reshape(own["bound_path"].iloc[0], (-1, 2)), problems[problem].workspace)
        for problem, own in runs.groupby("problem")
    }
    best = runs["problem"].map(best).to_numpy()
    return np.where(np.isnan(best), np.nan, runs["feasible"] & (_homotopy(runs, problems) == best))


def _max_curvature(path: Path) -> float:
    from bezierplan.geometry import curves

    kappa, _ = curves.curvature(path, CURVATURE_SAMPLES)
    return float(np.nan_to_num(np.abs(kappa)).max())


def _zero_speed_points(path: Path) -> int:
    from bezierplan.geometry import curves

    kappa, _ = curves.curvature(path, CURVATURE_SAMPLES)
    return int(np.isnan(kappa).sum())


def _curvature_jump(path: Path) -> float:
    from bezierplan.geometry import curves

    return curves.curvature_jump(path)


def _distinct_points(path: Path) -> int:
    return len(set(map(tuple, path.points.tolist())))


def _steps(points: np.ndarray) -> np.ndarray:
    """Steps (m, 2) between points (n, 2), those of length 0 left out."""
    steps = np.diff(points, axis=0)
    return steps[np.hypot(*steps.T) > 0]


def _headings(steps: np.ndarray) -> np.ndarray:
    """Absolute changes of heading (n - 1,), in radians, between steps (n, 2)."""
    cross = steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0]
    return np.abs(np.arctan2(cross, (steps[:-1] * steps[1:]).sum(axis=1)))


def _path_headings(path: Path) -> np.ndarray:
    """Changes of heading along a path; a curve is taken as chords between samples."""
    from bezierplan.geometry import curves

    if path.curve == "polyline":
        return _headings(_steps(path.points))
    return _headings(_steps(curves.sample_matrix(path.curve, len(path.points), HEADING_SAMPLES) @ path.points))


def _heading_max(path: Path) -> float:
    return float(_path_headings(path).max(initial=0.0))


def _turning(path: Path) -> float:
    return float(_path_headings(path).sum())


def _equal_parts(path: Path) -> tuple[np.ndarray, float]:
    """A path as steps (n, 2) between points that lie apart by equal lengths of arc, and that length; both next to `BENDING_PART`."""
    from bezierplan.geometry import curves

    points = path.points
    if path.curve != "polyline":
        count = BENDING_SAMPLES * len(curves.bezier_pieces(path)) + 1
        points = curves.sample_matrix(path.curve, len(path.points), count) @ path.points
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    parts = max(2, round(at[-1] / BENDING_PART))
    wanted = np.linspace(0.0, at[-1], parts + 1)
    return np.diff(np.column_stack([np.interp(wanted, at, points[:, axis]) for axis in range(2)]), axis=0), at[-1] / parts


def _bending(path: Path) -> float:
    steps, length = _equal_parts(path)
    return float((_headings(steps) ** 2).sum() / length) if length else 0.0


def _max_turn(path: Path) -> float:
    return float(np.degrees(_headings(_equal_parts(path)[0]).max(initial=0.0)))


def _corners(path: Path) -> int:
    """Joints of a path's pieces at which its heading changes."""
    from bezierplan.geometry import curves

    legs = [steps for steps in map(_steps, curves.bezier_pieces(path)) if len(steps)]
    return sum(int(_headings(np.array([one[-1], other[0]]))[0] > CORNER) for one, other in itertools.pairwise(legs))


def _length_over_polygon(path: Path) -> float:
    from bezierplan.geometry import curves

    polygon = np.hypot(*np.diff(path.points, axis=0).T).sum()
    return curves.length(path) / polygon if polygon else 1.0


def _obstacle_clearance(runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """Least distance (n,) of a path in a grid to its occupied cells; infinite without any.

    The checker's clearance, which counts the border, in the same grid with so many free cells around it that the border is farthest.
    """
    from bezierplan.geometry import checker, curves
    from bezierplan.geometry.region import region

    wide, found = {}, []
    for path, name in zip(_paths(runs), runs["problem"]):
        grid = problems[name].workspace
        margin = sum(grid.occupied.shape)
        if name not in wide:
            wide[name] = region(Grid(np.pad(grid.occupied, margin), grid.cell, grid.unit))
        moved = path._replace(points=(grid.in_cells(path.points) + margin) * grid.cell)
        found.append(checker.check(curves.bezier_pieces(moved), wide[name]).clearance if grid.occupied.any() else np.inf)
    return found


def _keeps_distance(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) a path keeps its planner's safety distance from the obstacles; not a number where the planner has none."""
    kept = np.array(_obstacle_clearance(runs, problems)) >= runs["safety_distance"]
    return kept.astype(float).where(runs["safety_distance"].notna()).to_numpy()


def _in_occupied_cells(points: np.ndarray, grid: Grid) -> int:
    """How many of the points (n, 2), in units, lie in occupied cells; a point on a grid line belongs to the cell above or to the right.

    song2016's planner may use surplus cells beside a grid that is not a power of two wide (`grid.embed`); they count as occupied.
    """
    occupied = embed(grid.occupied)
    columns, rows = np.floor(grid.in_cells(points) + ON_LINE).astype(int).T
    return int(occupied[np.minimum(rows, occupied.shape[0] - 1), np.minimum(columns, occupied.shape[1] - 1)].sum())


def _occupied_points(path: Path, grid: Grid) -> int:
    return _in_occupied_cells(path.points, grid)


def _fine_bad(path: Path, grid: Grid) -> int:
    from bezierplan.geometry import curves

    return _in_occupied_cells(curves.sample_matrix(path.curve, len(path.points), FINE_SAMPLES) @ path.points, grid)


def _cell_length(name: str, runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """A length that counts cells (`cell_length`). Raises ValueError, naming the run, if one lies below the bound of its problem."""
    from bezierplan.geometry import cell_length

    lengths = _of_path_on_grid(getattr(cell_length, name), runs, problems)
    for run, length, bound in zip(runs["id"], lengths, runs["octile_bound"]):
        if length < bound * (1 - 1e-12):
            raise ValueError(f"run {run} is said to be feasible, but its length {length:.12g} in cells lies below the bound {bound:.12g}")
    return lengths


def _straight_blocked(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """Whether (n,) the straight line of a run's problem, which lies on a grid, touches an occupied cell."""
    from bezierplan.geometry import cell_length
    from bezierplan.workspaces.problem import Path

    blocked = {}
    for name in runs["problem"].unique():
        grid = problems[name].workspace
        line = Path("polyline", np.array([problems[name].start, problems[name].target]))
        cells = cell_length.touched_cells(*cell_length.samples(line, grid))
        blocked[name] = cell_length.occupied_cells(*cells, grid.occupied) > 0
    return runs["problem"].map(blocked)


def _gap_cells(name: str, runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """A length that counts cells over the least one of the problem, minus 1 (n,)."""
    return _cell_length(name, runs, problems) / runs["octile_bound"] - 1


# Lengths that count cells have a bound and a gap of their own.
_CELLS4 = {"bound": "octile_bound", "gap": "gap4"}
_CELLS8 = {"bound": "octile_bound", "gap": "gap8"}

METRICS: dict[str, Metric] = {
    "objective": Metric("u", "the planner's own final value, in its own rule", False),
    "length": Metric("u", "exact arc length", True, least="bound"),
    "claimed_feasible": Metric("-", "the planner's own test of the path", False),
    "feasible": Metric("-", "the certified checker's test of the path", False),
    "failed": Metric("-", "without a path that the certified checker accepts", False, _failed),
    "falsely_claimed": Metric("-", "free by the planner's own test, colliding by the checker's", False, partial(_disagrees, True)),
    "wrongly_rejected": Metric("-", "free by the checker's test, not by the planner's own", False, partial(_disagrees, False)),
    "obstacle_clearance": Metric("u", "least distance to the occupied cells of a grid, its border not counted", True, _obstacle_clearance),
    "keeps_distance": Metric("-", "whether the planner's safety distance from the occupied cells is kept", True, _keeps_distance),
    "collision_depth": Metric("u", "largest depth of the path in obstacles or beyond the border", False),
    "clearance": Metric("u", "least distance to the obstacles and the border", False),
    "evaluations": Metric("-", "paths whose objective the planner asked for", False, least=0.0),
    "generations": Metric("-", "generations really done", False),
    "rank": Metric("-", "rank of the objective among the rows of the table, within one unit", False, _rank, among_rows=True, least=1.0),
    "cpu_s": Metric("s", "CPU seconds of the run alone", False, least=0.0),
    "gap": Metric("-", "length / exact shortest length of the problem - 1", True, _gap, least=0.0),
    "gap_best": Metric("-", "length / length of the best feasible run of the same method and condition - 1", True, _gap_best),
    "generation_improved": Metric(
        "generation", "last generation that improved the objective", False, partial(_first_generation_within, 0.0), least=0.0
    ),
    "generation_1pct": Metric(
        "generation", "first generation within 1 % of the run's final objective", False, partial(_first_generation_within, 0.01), least=0.0
    ),
    "generation_5pct": Metric(
        "generation", "first generation within 5 % of the run's final objective", False, partial(_first_generation_within, 0.05), least=0.0
    ),
    "improvement_30": Metric("-", "share of the improvement of the objective made by generation 30", False, partial(_improvement_by, 30)),
    "objective_best": Metric("u", "lowest objective of any generation", False, _lowest_objective),
    "optimum": Metric("u", "least objective of all feasible paths of the planner's kind", False),
    "optimal": Metric("-", "whether the final path is feasible and optimal, by the planner's own test", False),
    "near_optimal": Metric("-", "whether the final path is feasible but not optimal, by the planner's own test", False),
    "infeasible": Metric("-", "whether the final path is infeasible, by the planner's own test", False),
    "feasible_last": Metric("-", "share of feasible paths in the last population", False),
    "made_infeasible": Metric("-", "share of the mutated feasible paths that mutation made infeasible", False),
    "node_diversity": Metric("-", "mean over generations of the chance that a path's inner node is no node of another", False),
    "max_curvature": Metric(
        "1/u",
        f"largest absolute curvature over {CURVATURE_SAMPLES} samples, corners between pieces left out",
        True,
        partial(_of_path, _max_curvature),
    ),
    "curvature_jump": Metric(
        "1/u", "largest jump of curvature over the joints, infinite at a corner", True, partial(_of_path, _curvature_jump)
    ),
    "zero_speed_points": Metric(
        "-",
        f"samples of {CURVATURE_SAMPLES} where the curve stands still and curvature is not defined",
        True,
        partial(_of_path, _zero_speed_points),
    ),
    "heading_max": Metric("rad", "largest change of heading between neighbouring chords", True, partial(_of_path, _heading_max)),
    "turning": Metric("rad", "changes of heading, all added", True, partial(_of_path, _turning)),
    "bending": Metric(
        "rad^2/u",
        f"squared changes of heading between parts of {BENDING_PART:g} u over their length, all added: the integral of squared curvature",
        True,
        partial(_of_path, _bending),
    ),
    "max_turn": Metric("degrees", f"largest change of heading between parts of {BENDING_PART:g} u", True, partial(_of_path, _max_turn)),
    "corners": Metric("-", "joints of a path's pieces at which its heading changes", True, partial(_of_path, _corners)),
    "length_over_polygon": Metric("-", "length / length of the control polygon", True, partial(_of_path, _length_over_polygon)),
    "distinct_points": Metric("-", "control points that differ from each other", False, partial(_of_path, _distinct_points)),
    "occupied_points": Metric("-", "control points in occupied cells of a grid", True, partial(_of_path_on_grid, _occupied_points)),
    "gap_reference": Metric("-", "length / length of the best known path of the same kind - 1", True, _gap_reference),
    "excess_reference": Metric("u", "length - length of the best known path of the same kind", True, _excess_reference),
    "cells4": Metric(
        "u", "cells that the path touches, 1.5 for a diagonal step", True, partial(_cell_length, "length4"), least="octile_bound", **_CELLS4
    ),
    "cells8": Metric(
        "u", "cells4 without the corners of the sequence of cells", True, partial(_cell_length, "length8"), least="octile_bound", **_CELLS8
    ),
    "octile_bound": Metric("u", "least length of a path of free cells, 1.5 for a diagonal step", False),
    "homotopy": Metric("-", "class of the path: the sum of 2^k over the circles k that it leaves to its left", True, _homotopy),
    "best_corridor": Metric("-", "whether the path is free and passes each circle where the shortest one does", False, _best_corridor),
    "gap4": Metric("-", "cells4 / octile_bound - 1", True, partial(_gap_cells, "length4"), least=0.0, **_CELLS4),
    "gap8": Metric("-", "cells8 / octile_bound - 1", True, partial(_gap_cells, "length8"), least=0.0, **_CELLS8),
    "straight_blocked": Metric("-", "whether the straight line from start to target touches an occupied cell", False, _straight_blocked),
    "history_mean": Metric("u", "mean over the generations of the best objective so far", False, _history_mean),
    "deviation": Metric("-", "absolute deviation of the length from the median of its condition and method, relative", True, _deviation),
    "distinct_chromosomes": Metric("-", "different chromosomes in the population, mean over the generations", False),
    "mean_q": Metric("-", "mean Q statistic of the pool, mean over the generations", False),
    "extra_batches": Metric("-", "further batches of offspring that the rule for diversity asked for", False),
    "valid_share": Metric("-", "share of the children that the planner kept", False),
    "outlier": Metric("-", "whether the objective lies beyond the whiskers of its method's box", False, _outlier),
    "violation": Metric("-", "mean depth of the samples below the circles, as a share of the radius, summed over circles", False),
    "collisions_a": Metric("particles", "colliding particles an iteration, of 20, the first swarm included", False, least=0.0, most=20.0),
    "collisions_b": Metric("samples", "colliding samples a path that was evaluated, summed over circles", False),
    "collisions_c": Metric("samples", "colliding samples of the best path, added over iterations", False),
    "collisions_d": Metric("iterations", "iterations whose best path collides", False),
    "collisions_e": Metric("-", "whether the final path collides, by the planner's own test", False),
    "collisions_f": Metric("-", "paths evaluated that collide", False),
    "bad_samples": Metric("-", "samples of the path that the planner punished", False),
    "fine_bad": Metric("-", f"samples of {FINE_SAMPLES} in occupied cells of a grid", False, partial(_of_path_on_grid, _fine_bad)),
}
