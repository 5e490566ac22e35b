"""The problems of an experiment: built from their descriptions, and kept in a file with one row per
problem.

Columns of a problem file: problem, workspace (its name), start_x, start_y, target_x, target_y
(units), drawn (the workspace itself, as JSON: `workspaces.files.to_json`). Columns of a file of
bounds: `columns.Bound`.
"""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bezierplan.geometry import cell_length
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import Region, blocks, region
from bezierplan.running.columns import Bound
from bezierplan.running.descriptions import Descriptions
from bezierplan.workspaces import files, lattice, robot
from bezierplan.workspaces.frames import WORLD, Frame, corners, frame_of, inward_map
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grown import grown_of, original
from bezierplan.workspaces.problem import Problem, Workspace

if TYPE_CHECKING:
    import pyarrow as pa

    from bezierplan.geometry import shortest_paths


Regions = Callable[[Workspace], Region]
"""The blocked region of a map in its own frame."""


def remembered() -> Regions:
    """`region` that builds the one of each map once, for callers who keep their maps."""
    known: dict[int, tuple[Workspace, Region]] = {}

    def find(workspace: Workspace) -> Region:
        if id(workspace) not in known:
            known[id(workspace)] = workspace, region(workspace)
        return known[id(workspace)][1]

    return find


class Placed(NamedTuple):
    """A problem in the world, and in the frame in which it is computed with."""

    world: Problem
    near: Problem
    frame: Frame = WORLD


def placed(
    problem: Problem, regions: Regions = region, served: Collection[str] | None = None
) -> Placed:
    """A problem of the world whose start and target are known to be free, in its frame on the map
    that suits a planner of some kinds of workspace, None for all.

    Raises ValueError as `build` does.
    """
    frame = frame_of(problem.workspace)
    home = robot.suited(inward_map(problem.workspace, frame), served)
    ends = {"start": problem.start, "target": problem.target}
    near = build(problem.name, ends, home, regions, frame)
    start, target = (_pair(end) for end in (problem.start, problem.target))
    return Placed(problem._replace(start=start, target=target), near, frame)


# A place of a turned map that is this close to its border, in units, is on it: projected
# coordinates are no finer.
_ON_BORDER = 1e-8


def build(
    name: str,
    description: dict,
    workspace: Workspace,
    regions: Regions = region,
    frame: Frame = WORLD,
) -> Problem:
    """A problem from its description: start and target, (x, y) in units, or start_cell and
    target_cell, cell numbers of a grid.

    frame: of the workspace, and so of the problem; start and target are told in the world. Raises
    ValueError, naming key and value, unless they lie in free space.
    """
    start, target = (
        _end(end, description, workspace, regions, frame) for end in ("start", "target")
    )
    return Problem(name, workspace, start, target)


def _end(
    end: str, description: dict, workspace: Workspace, regions: Regions, frame: Frame
) -> tuple[float, float]:
    key = end if end in description else f"{end}_cell"
    value = description[key]
    if key == end:
        point = _pair(frame.inward(_pair(value)))
    elif isinstance(workspace, Grid):
        try:
            point = workspace.centre(value)
        except ValueError as error:
            raise ValueError(f"{key}: {error}") from None
    else:
        raise ValueError(f"{key}: {value}: only a grid has cell numbers; expected {end}: [x, y]")
    grown, home = grown_of(workspace), original(workspace)
    x_low, x_high, y_low, y_high = home.bounds
    if frame.yaw:
        point = _on_border(point[0], x_low, x_high), _on_border(point[1], y_low, y_high)
    if not (x_low <= point[0] <= x_high and y_low <= point[1] <= y_high):
        raise ValueError(f"{key}: {value}: outside the workspace; {_within(home, frame)}")
    if blocks(regions(home), point):
        raise ValueError(f"{key}: {value}: in an obstacle; expected a free place of the workspace")
    if grown and blocks(regions(workspace), point):
        distance = check(np.array([[point, point]]), regions(home)).clearance
        least = grown.radius if distance < grown.radius else (1 + robot.ARC_EXCESS) * grown.radius
        cells = ", by whole cells" if isinstance(workspace, Grid) and not workspace.drawn else ""
        raise ValueError(
            f"{key}: {value}: {distance:.6g} from an obstacle or the border; expected at least "
            f"the robot's radius, {least:.6g}{cells}"
        )
    if (
        isinstance(workspace, Grid)
        and workspace.drawn
        and workspace.occupied[workspace.cell_of(*point)]
    ):
        raise ValueError(
            f"{key}: {value}: in an occupied cell; expected a free one, or a smaller cell"
        )
    return point


def _pair(value: Sequence[float] | np.ndarray) -> tuple[float, float]:
    return float(value[0]), float(value[1])


def _on_border(value: float, low: float, high: float) -> float:
    nearest = min(max(value, low), high)
    return nearest if abs(value - nearest) < _ON_BORDER else value


def _within(workspace: Workspace, frame: Frame) -> str:
    """Where the places of a map are, in the world."""
    around = corners(workspace, frame)
    if frame.yaw:
        places = " ".join(f"{x:.9g},{y:.9g}" for x, y in around)
        return f"expected a place of the turned map, whose corners are {places}"
    (x_low, y_low), (x_high, y_high) = around[0], around[2]
    return f"expected x from {x_low:.12g} to {x_high:.12g} and y from {y_low:.12g} to {y_high:.12g}"


def build_all(described: Descriptions, folder: Path) -> dict[str, Problem]:
    """Problems by name, from their descriptions.

    Map files are looked up in the folder. Raises ValueError for a fault in any of them.
    """
    from bezierplan.workspaces.kinds import kind_of

    kinds = {name: kind_of(each) for name, each in described.workspaces.items()}
    fixed = {
        name: files.load(each, folder)
        for name, each in described.workspaces.items()
        if hasattr(kinds[name], "load")
    }
    problems, of_fixed = {}, remembered()
    for name, description in described.problems.items():
        home = description["workspace"]
        arguments = described.workspaces[home], description, f"{described.study}/{home}"
        if home in fixed:
            workspace = fixed[home]
        elif hasattr(kinds[home], "draw"):
            workspace = kinds[home].draw(*arguments)
        else:
            workspace = _suitable(
                kinds[home].candidates(*arguments), described.workspaces[home], description
            )
        if "scenario" in description:
            description = description | scenario(
                described.workspaces[home], description["scenario"], workspace, folder
            )
        # Start and target are looked up in the region of the same map, as are those of all problems
        # on a map from a file; drawn maps are as many as problems, and so are not kept.
        regions = of_fixed if home in fixed else remembered()
        problems[name] = build(name, description, workspace, regions)
    return problems


# Tolerance between our optimal length of a scenario and the printed one, in cells.
_SAME_OPTIMUM = 1e-3


def scenario(description: dict, number: int, workspace: Workspace, folder: Path) -> dict:
    """Start and target of a scenario. Raises ValueError if it does not fit our map or length."""
    from bezierplan.geometry import shortest_paths

    assert isinstance(workspace, Grid)  # only a kind of grids has scenarios
    printed = files.scenario(description, number, workspace, folder)
    start, target = _cell(workspace, printed.start), _cell(workspace, printed.target)
    length = shortest_paths.lattice_path(
        workspace.occupied, start, target, math.sqrt(2), "none"
    ).length
    if not abs(length - printed.optimal) <= _SAME_OPTIMUM:
        place = f"{description['scenarios']}: line {number + 1}"
        raise ValueError(
            f"{place}: optimal length {printed.optimal:g}; "
            f"on {description['file']} it is {length:.8g}"
        )
    return {"start": printed.start, "target": printed.target}


# Tolerance between the shortest lattice path's length and the wanted one, in cells.
_SAME_LENGTH = 1e-4


def _suitable(maps: Iterator[Grid], description: dict, problem: dict) -> Grid:
    """The first of some maps whose shortest path over the 8-connected lattice has the wanted
    length, in cells, if one is given.

    Raises ValueError if there is none.
    """
    from bezierplan.geometry import shortest_paths

    wanted = description.get("lattice_length")
    for grid in maps:
        ends = lattice.lattice(
            grid, tuple(problem["start"]), tuple(problem["target"]), description["corners"]
        )
        start, target = divmod(ends.start, problem["side"]), divmod(ends.target, problem["side"])
        length = (
            shortest_paths.lattice_path(
                grid.occupied, start, target, ends.diagonal, description["corners"]
            ).length
            + ends.ends
        )
        if math.isfinite(length) and (wanted is None or abs(length - wanted) < _SAME_LENGTH):
            return grid
    from bezierplan.workspaces.kinds.random_blocks import MOST_MAPS

    asked = (
        "a path from start to target"
        if wanted is None
        else f"a shortest lattice path of lattice_length {wanted:g}"
    )
    raise ValueError(
        f"obstacles: {problem['obstacles']}: of {MOST_MAPS} maps none has so many "
        f"occupied cells and {asked}"
    )


def write(problems: dict[str, Problem], workspaces: dict[str, str], file: str) -> None:
    """Write problems, by name, with the names of their workspaces."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    rows = [
        {
            "problem": name,
            "workspace": workspaces[name],
            "start_x": problem.start[0],
            "start_y": problem.start[1],
            "target_x": problem.target[0],
            "target_y": problem.target[1],
            "drawn": files.to_json(problem.workspace),
        }
        for name, problem in problems.items()
    ]
    parquet.write_table(pa.Table.from_pylist(rows), file)


def read(file: str) -> dict[str, Problem]:
    """The problems of a file, by name, in file order; those in one workspace share its object."""
    from bezierplan.running import rows

    table = rows.read_alone(file).to_pylist()
    drawn = {text: files.from_json(text) for text in {row["drawn"] for row in table}}
    return {
        row["problem"]: Problem(
            row["problem"],
            drawn[row["drawn"]],
            (row["start_x"], row["start_y"]),
            (row["target_x"], row["target_y"]),
        )
        for row in table
    }


def bounds_of(problems: dict[str, Problem]) -> "pa.Table":
    """The straight line and the exact shortest path of each problem, one row each."""
    from bezierplan.geometry import shortest_paths
    from bezierplan.running import rows

    bounds = [
        bound_row(name, problem, shortest_paths.shortest_path(problem), _cell_bound(problem))
        for name, problem in problems.items()
    ]
    return rows.table([each._asdict() for each in bounds], Bound)


def bound_row(
    name: str, problem: Problem, bound: "shortest_paths.Bound", octile_bound: float
) -> Bound:
    """A row of a file of bounds. bound: the shortest path, in units; octile_bound: in units, NaN
    where there is none.
    """
    from bezierplan.geometry import shortest_paths

    return Bound(
        problem=name,
        straight_line=math.dist(problem.start, problem.target),
        bound=bound.length,
        least_length=shortest_paths.least_length(bound),
        bound_path=bound.points.ravel().tolist(),
        octile_bound=octile_bound,
    )


def _cell_bound(problem: Problem) -> float:
    """The least length, in units, of a path over free cells with straight and diagonal steps, which
    may pass between two occupied cells.
    """
    from bezierplan.geometry import shortest_paths

    grid = problem.workspace
    if not isinstance(grid, Grid):
        return math.nan
    start, target = _cell(grid, problem.start), _cell(grid, problem.target)
    return (
        shortest_paths.lattice_path(
            grid.occupied, start, target, cell_length.DIAGONAL, "free"
        ).length
        * grid.cell
    )


def _cell(grid: Grid, point: tuple[float, float]) -> tuple[int, int]:
    """Row and column of a point inside a grid."""
    cell = grid.cell_of(*point)
    assert cell is not None
    return cell
