"""The measures behind the metrics: computed from other columns of the runs table, from the history
of the objective, or from the path.

A measure takes a table of at least one run and the problems by name, and gives one number per run
(n,), NaN where a run has no such value; those of a path alone, or of a path on a map, are made into
one by their decorators. Curve modules are imported only when a value is requested.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.analysis.metric import metric, of_path, of_paths, on_map, on_maps
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import ON_LINE, Grid, embed

if TYPE_CHECKING:
    import pandas as pd
    from shapely import Geometry

    from bezierplan.workspaces.problem import Path, Problem, Workspace

# Values of a curve's parameter at which curvature is taken: 100 steps on each of the six quadratic
# pieces of song2016.
CURVATURE_SAMPLES = 601
# Samples of a path that determine its way round the circles.
CLASS_SAMPLES = 2001
# Samples of a curved piece between which headings are compared (ma2020: 2,000 chords).
HEADING_SAMPLES = 2001
# Approximate length, in units, of the parts by which a path's bending is measured, and samples of a
# curved piece from which they are cut.
BENDING_PART = 0.1
BENDING_SAMPLES = 64
# A smaller change of heading, in radians, is not a corner.
CORNER = 1e-6
# By which share a printed length may be rounded.
ROUNDED = 0.01
# A value this many interquartile ranges beyond its quartile is an outlier in a box plot.
_OUTLIER_REACH = 1.5


def disagrees(claimed: bool, runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) the planner's own test gives this result and the checker the opposite."""
    return ((runs["claimed_feasible"] == claimed) & (runs["feasible"] != claimed)).to_numpy()


@metric(
    "-",
    "rank of the objective among the rows of the table, within one unit",
    among_rows=True,
    least=1.0,
    step=0.5,
)
def rank(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Rank (n,) of the objective within one unit, among methods or numbers of obstacles; ties share
    the mean of their ranks.
    """
    unit = [column for column in ("workspace", "layout", "profile", "repeat") if column in runs]
    return runs.groupby(unit, dropna=False)["objective"].rank().to_numpy()


@metric("-", "whether the objective lies beyond the whiskers of its method's box", step=1.0)
def outlier(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) a run's objective lies beyond the whiskers of the box of its method under its
    condition.
    """
    grouped = runs.groupby(["condition", "method"], dropna=False)["objective"]
    first, third = (
        grouped.transform(lambda each: each.quantile(0.25)),
        grouped.transform(lambda each: each.quantile(0.75)),
    )
    reach = _OUTLIER_REACH * (third - first)
    return ((runs["objective"] < first - reach) | (runs["objective"] > third + reach)).to_numpy()


def reference(runs: pd.DataFrame) -> pd.Series:
    """The length of the best known path of each run's problem. Raises ValueError if it is shorter
    than the exact shortest path.
    """
    too_short = runs["reference"] < (1 - ROUNDED) * runs.get("bound", np.nan)
    if too_short.any():
        run = runs[too_short].iloc[0]
        raise ValueError(
            f"problem {run['problem']}: reference {run['reference']:g} lies below the exact "
            f"shortest length {run['bound']:.12g}"
        )
    return runs["reference"]


def held_history(runs: pd.DataFrame) -> np.ndarray:
    """Best objective so far by generation: (runs, maximum generations + 1). Runs that stopped early
    hold their last value.
    """
    lengths = runs["history"].map(len).to_numpy()
    starts = np.cumsum(lengths) - lengths
    columns = np.minimum(np.arange(lengths.max()), lengths[:, None] - 1)
    return np.concatenate(runs["history"].to_list())[starts[:, None] + columns]


def first_generation_within(
    share: float, runs: pd.DataFrame, problems: dict[str, Problem]
) -> np.ndarray:
    """First generation (n,) whose best objective so far is at most 1 + share times the final
    one.
    """
    held = held_history(runs)
    return (held <= held[:, -1:] * (1 + share)).argmax(axis=1)


def first_generation_improved_by(
    share: float, runs: pd.DataFrame, problems: dict[str, Problem]
) -> np.ndarray:
    """First generation (n,) by which a share of the improvement from generation 0 to the last is
    made; 0 if there is none.
    """
    held = held_history(runs)
    return (held <= held[:, :1] - share * (held[:, :1] - held[:, -1:])).argmax(axis=1)


def deviation(column: str, runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """Absolute relative deviation (n,) of a column from the median of its method and condition."""
    median = runs.groupby(["experiment", "condition", "method"])[column].transform("median")
    return (runs[column] / median - 1).abs()


def over(column: str, bound: str, runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """A column over one that bounds it from below, minus 1 (n,)."""
    return runs[column] / runs[bound] - 1


@metric(
    "-",
    "arrival / lower bound on the arrival - 1, where all methods of the table arrive",
    among_rows=True,
    least=0.0,
    needs=("arrival",),
)
def paired_gap_least_arrival(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """The gap of the arrival (n,) of the runs in whose condition and repeat all methods among the
    runs have a feasible one; NaN of others.
    """
    arrived = runs["method"].where(runs["feasible"].astype(bool))
    together = arrived.groupby([runs["condition"], runs["repeat"]]).transform("nunique")
    gap = over("arrival", "least_arrival", runs, problems)
    return gap.where(together == runs["method"].nunique())


@metric(
    "-",
    "length / length of the best feasible run of the same method and condition - 1",
    feasible_only=True,
)
def gap_best(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """Length over that of the best run of the same method and condition, minus 1 (n,)."""
    best = runs.groupby(["experiment", "condition", "method"])["length"].transform("min")
    return runs["length"] / best - 1


def homotopy_class(points: np.ndarray, workspace: Workspace) -> float:
    """On which side a polyline (n, 2) passes each circle: the sum of 2^k over the circles k = 0, 1,
    ... that it leaves to its left.

    A circle lies to the left if the angle swept by the polyline about its centre is positive. This
    distinguishes classes if no polyline winds round a circle and all have the same ends. NaN
    without points or in a workspace of another kind.
    """
    if not len(points) or not isinstance(workspace, Circles):
        return np.nan
    x, y = np.ascontiguousarray(points.T)[:, None] - workspace.centres.T[:, :, None]
    angles = np.arctan2(y[:, [0, -1]], x[:, [0, -1]])
    # Where the polyline crosses the ray to the left of the centre, its angle jumps from pi to -pi,
    # or back.
    leftward = x[:, :-1] * y[:, 1:] > y[:, :-1] * x[:, 1:]
    above = y >= 0
    rounds = (above[:, :-1] & ~above[:, 1:] & leftward).sum(axis=1) - (
        ~above[:, :-1] & above[:, 1:] & ~leftward
    ).sum(axis=1)
    swept = angles[:, 1] - angles[:, 0] + 2 * np.pi * rounds
    return float((2.0 ** np.arange(len(workspace.centres)))[swept > 0].sum())


@on_map(
    "-",
    "class of the path: the sum of 2^k over the circles k that it leaves to its left",
    "circles",
    step=1.0,
)
def homotopy(path: Path, workspace: Workspace) -> float:
    """The homotopy class of a path."""
    return homotopy_class(_samples(path, CLASS_SAMPLES), workspace)


def _samples(path: Path, count: int) -> np.ndarray:
    """Points (count, 2) along a path."""
    from bezierplan.geometry import curves

    return curves.sample_matrix(path.curve, len(path.points), count) @ path.points


@metric(
    "-",
    "whether the path is free and passes each circle where the shortest one does",
    step=1.0,
    on=("circles",),
)
def best_corridor(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) a run's path is free and in the homotopy class of the exact shortest one; NaN
    without circles.
    """
    best = {
        problem: homotopy_class(
            np.reshape(own["bound_path"].iloc[0], (-1, 2)), problems[problem].workspace
        )
        for problem, own in runs.groupby("problem")
    }
    best = runs["problem"].map(best).to_numpy()
    return np.where(
        np.isnan(best), np.nan, runs["feasible"] & (on_maps(homotopy, runs, problems) == best)
    )


def _curvature(path: Path) -> np.ndarray:
    """Curvature of `CURVATURE_SAMPLES` samples, NaN where the speed is zero."""
    from bezierplan.geometry import curves

    return curves.curvature(path, CURVATURE_SAMPLES)[0]


@of_path(
    "1/u",
    f"largest absolute curvature over {CURVATURE_SAMPLES} samples, corners between pieces left out",
)
def max_curvature(path: Path) -> float:
    """Largest absolute curvature of `CURVATURE_SAMPLES` samples, in 1/unit; it counts as 0 where
    the speed is zero.
    """
    return float(np.nan_to_num(np.abs(_curvature(path))).max())


@of_path(
    "1/u",
    f"largest curvature over {CURVATURE_SAMPLES} samples by its sign, left turns positive; "
    "corners between pieces left out",
)
def signed_curvature(path: Path) -> float:
    """Largest curvature of `CURVATURE_SAMPLES` samples with its sign (song2016, eq. 5: left turns
    are positive), in 1/unit; it counts as 0 where the speed is zero.
    """
    return float(np.nan_to_num(_curvature(path)).max())


@of_path("1/u", "largest jump of curvature over the joints, infinite at a corner")
def curvature_jump(path: Path) -> float:
    """Largest jump of curvature over a path's joints, in 1/unit."""
    from bezierplan.geometry import curves

    return curves.curvature_jump(path)


@metric("-", "control points of all paths evaluated", step=1.0, least=0.0)
def points_evaluated(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Control points (n,) of all paths evaluated, each counted with as many as the run's path has;
    NaN where the run has no path.
    """
    points = runs["path_points"].map(len) / 2
    return (runs["evaluations"] * points.where(points > 0)).to_numpy()


@of_path("-", "control points that differ from each other", feasible_only=False, step=1.0)
def distinct_points(path: Path) -> int:
    """Number of distinct control points of a path."""
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
    is_polyline = path.curve == "polyline"
    return _headings(_steps(path.points if is_polyline else _samples(path, HEADING_SAMPLES)))


@of_path("rad", "largest change of heading between neighbouring chords")
def heading_max(path: Path) -> float:
    """Largest change of heading between neighbouring chords, in radians."""
    return float(_path_headings(path).max(initial=0.0))


@of_path("rad", "changes of heading, all added")
def turning(path: Path) -> float:
    """Sum of all changes of heading, in radians."""
    return float(_path_headings(path).sum())


def _equal_parts(path: Path) -> tuple[np.ndarray, float]:
    """A path as steps (n, 2) between points at equal arc-length spacing, and that spacing, close to
    `BENDING_PART`.
    """
    from bezierplan.geometry import curves

    points = path.points
    if path.curve != "polyline":
        count = BENDING_SAMPLES * len(curves.bezier_pieces(path)) + 1
        points = _samples(path, count)
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    parts = max(2, round(at[-1] / BENDING_PART))
    wanted = np.linspace(0.0, at[-1], parts + 1)
    return np.diff(
        np.column_stack([np.interp(wanted, at, points[:, axis]) for axis in range(2)]), axis=0
    ), at[-1] / parts


@of_path(
    "rad²/u",
    f"squared changes of heading between parts of {BENDING_PART:g} u over their length, all "
    "added: the integral of squared curvature",
)
def bending(path: Path) -> float:
    """Integral of squared curvature, from parts of about `BENDING_PART`, in radians^2/unit."""
    steps, length = _equal_parts(path)
    return float((_headings(steps) ** 2).sum() / length) if length else 0.0


@of_path("degrees", f"largest change of heading between parts of {BENDING_PART:g} u")
def max_turn(path: Path) -> float:
    """Largest change of heading between parts of about `BENDING_PART`, in degrees."""
    return float(np.degrees(_headings(_equal_parts(path)[0]).max(initial=0.0)))


@of_path("-", "joints of a path's pieces at which its heading changes", step=1.0)
def corners(path: Path) -> int:
    """Joints of a path's pieces at which its heading changes."""
    from bezierplan.geometry import curves

    legs = [steps for steps in map(_steps, curves.bezier_pieces(path)) if len(steps)]
    return sum(
        int(_headings(np.array([one[-1], other[0]]))[0] > CORNER)
        for one, other in itertools.pairwise(legs)
    )


@on_map(
    "-",
    "corners of a polyline that can be left out, because a free leg joins the corners before "
    "and after; none for a curve",
    "grid",
    step=1.0,
)
def spare_corners(path: Path, grid: Grid) -> float:
    """Corners of a polyline that can be left out: a straight leg that enters no occupied cell joins
    the corners before and after. NaN for a curve.
    """
    import shapely

    if path.curve != "polyline":
        return np.nan
    steps = np.diff(path.points, axis=0)
    moved = np.hypot(*steps.T) > 0
    places, headings = path.points[1:][moved], _headings(steps[moved])
    turns = np.concatenate([path.points[:1], places[:-1][headings > CORNER], places[-1:]])
    legs = shapely.linestrings(np.stack([turns[:-2], turns[2:]], axis=1))
    inside = _inside(*_hashable(grid))
    return float((~shapely.intersects(inside, legs)).sum())


def _hashable(grid: Grid) -> tuple[bytes, int, float, tuple[float, float]]:
    """What a grid is made from (`_grid`)."""
    return grid.occupied.tobytes(), grid.occupied.shape[1], grid.cell, grid.origin


def _grid(occupied: bytes, columns: int, cell: float, origin: tuple[float, float]) -> Grid:
    return Grid(np.frombuffer(occupied, dtype=bool).reshape(-1, columns), cell, "", origin)


@lru_cache(maxsize=8)
def _inside(*made_from: Any) -> Geometry:
    """What a path must not enter: the occupied cells of a grid, a billionth of a cell smaller,
    since a path may touch them.
    """
    import shapely

    grid = _grid(*made_from)
    rows, columns = np.nonzero(grid.occupied)
    x, y = grid.origin[0] + grid.cell * columns, grid.origin[1] + grid.cell * rows
    whole = shapely.union_all(shapely.box(x, y, x + grid.cell, y + grid.cell))
    inner = whole.buffer(-1e-9 * grid.cell)
    shapely.prepare(inner)
    return inner


@metric(
    "u",
    "least distance to the occupied cells of a grid, its border not counted",
    feasible_only=True,
    on=("grid",),
)
def obstacle_clearance(runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """Smallest distance (n,) from a path in a grid to its occupied cells; infinite if there are
    none.
    """
    names = runs["problem"].unique()
    measures = {name: _clearance_in(*_hashable(problems[name].workspace)) for name in names}
    return of_paths(runs["problem"].map(measures), runs)


@cache
def _clearance_in(*made_from: Any) -> Callable[[Path], float]:
    """The smallest distance of a free path to the occupied cells of a grid, as a measure of the
    path.

    This is the checker's clearance, which counts the border, in the same grid padded with free
    cells so that the border is farthest.
    """
    from bezierplan.geometry import checker, curves
    from bezierplan.geometry.region import region

    grid = _grid(*made_from)
    margin = sum(grid.occupied.shape)
    wide = region(Grid(np.pad(grid.occupied, margin), grid.cell, ""))

    def clearance(path: Path) -> float:
        moved = path._replace(points=(grid.in_cells(path.points) + margin) * grid.cell)
        return (
            checker.check(curves.bezier_pieces(moved), wide).clearance
            if grid.occupied.any()
            else np.inf
        )

    return clearance


@metric(
    "-",
    "whether the planner's safety distance from the occupied cells is kept",
    feasible_only=True,
    step=1.0,
    needs=("safety_distance",),
    on=("grid",),
)
def keeps_distance(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Whether (n,) a path keeps its planner's safety distance from the obstacles; NaN where the
    planner has none.
    """
    kept = np.array(obstacle_clearance(runs, problems)) >= runs["safety_distance"]
    return kept.astype(float).where(runs["safety_distance"].notna()).to_numpy()


@metric(
    "u",
    "length of a path that keeps the planner's safety distance",
    feasible_only=True,
    needs=("safety_distance",),
    on=("grid",),
)
def length_at_distance(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """Lengths (n,) of the paths that keep their planner's safety distance; NaN of all others."""
    return runs["length"].where(keeps_distance(runs, problems) == 1).to_numpy()


@on_map("-", "control points in occupied cells of a grid", "grid", step=1.0)
def occupied_points(path: Path, grid: Grid) -> int:
    """Number of control points in occupied cells; a point on a grid line belongs to the cell above
    or to the right.

    song2016's planner may use surplus cells outside a grid whose width is not a power of two
    (`grid.embed`); they count as occupied.
    """
    occupied = embed(grid.occupied)
    columns, rows = np.floor(grid.in_cells(path.points) + ON_LINE).astype(int).T
    last = np.array(occupied.shape) - 1
    return int(occupied[np.minimum(rows, last[0]), np.minimum(columns, last[1])].sum())


def _free_cells(path: Path, grid: Grid) -> int | None:
    """Number of cells that a path touches; None if one of them is occupied."""
    from bezierplan.geometry import cell_length

    columns, rows = cell_length.touched_cells(*cell_length.samples(path, grid))
    return None if cell_length.occupied_cells(columns, rows, grid.occupied) else len(columns)


def length_in_cells(name: str, runs: pd.DataFrame, problems: dict[str, Problem]) -> list[float]:
    """A length counted in cells (`cell_length`). Raises ValueError, naming the run, if one lies
    below its problem's bound.

    NaN for a path that touches an occupied cell: it is free, but along an obstacle's side rounding
    would decide which cells it counts, and the bound is that of free cells.
    """
    from bezierplan.geometry import cell_length

    count = getattr(cell_length, name)
    lengths = on_maps(
        lambda path, grid: np.nan if _free_cells(path, grid) is None else count(path, grid),
        runs,
        problems,
    )
    for run, length, bound in zip(runs["id"], lengths, runs["octile_bound"]):
        if length < bound * (1 - 1e-12):
            raise ValueError(
                f"run {run} is said to be feasible, but its length {length:.12g} in cells lies "
                f"below the bound {bound:.12g}"
            )
    return lengths


@on_map(
    "-",
    "number of cells that the path touches; none for a path that touches an occupied cell",
    "grid",
    least=0.0,
    step=1.0,
)
def cells(path: Path, grid: Grid) -> float:
    """Number of cells that a path touches; NaN for one that touches an occupied cell."""
    free = _free_cells(path, grid)
    return np.nan if free is None else float(free)


@of_path("u", "length of the control polygon", least="bound")
def polygon_length(path: Path) -> float:
    """Length of a path's control polygon, in units."""
    return float(np.hypot(*np.diff(path.points, axis=0).T).sum())


@metric("-", "whether an obstacle is in the way, so that no straight line is free", step=1.0)
def blocked(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """Whether (n,) the exact shortest path of a run's problem is longer than the straight line."""
    straight = {
        name: np.hypot(*np.subtract(each.start, each.target)) for name, each in problems.items()
    }
    return runs["bound"] > runs["problem"].map(straight) * (1 + 1e-9)


@metric(
    "-",
    "whether the straight line from start to target touches an occupied cell",
    step=1.0,
    on=("grid",),
)
def straight_blocked(runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """Whether (n,) the straight line of a run's problem, which lies on a grid, touches an occupied
    cell.
    """
    from bezierplan.workspaces.problem import Path

    blocked = {}
    for name in runs["problem"].unique():
        line = Path("polyline", np.array([problems[name].start, problems[name].target]))
        blocked[name] = _free_cells(line, problems[name].workspace) is None
    return runs["problem"].map(blocked)


def gap_cells(name: str, runs: pd.DataFrame, problems: dict[str, Problem]) -> pd.Series:
    """A length counted in cells over the problem's least such length, minus 1 (n,)."""
    return length_in_cells(name, runs, problems) / runs["octile_bound"] - 1
