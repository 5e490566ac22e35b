"""Build the problems of an experiment, and the worlds of those that move, from their descriptions,
and keep them in a file with one row per problem.

The workspace of a problem that moves is what planners see at the beginning. Columns of a problem
file: problem, workspace (its name), start_x, start_y, target_x, target_y (units), drawn (the
workspace itself, as JSON: `workspaces.files.write_json`); where it moves, world (as JSON:
`workspaces.worlds`). Columns of a file of bounds: `columns.Bound`, for drives `columns.DriveBound`
too.
"""

import math
from collections.abc import Collection
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.geometry import cell_length, shortest_paths
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.running.columns import Bound, DriveBound
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.simulation import bounds
from bezierplan.workspaces import files, robot, worlds
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grown import find_growth, original
from bezierplan.workspaces.limits import Place
from bezierplan.workspaces.problem import Problem, Workspace
from bezierplan.workspaces.worlds import World

# A plan needs no pyarrow, which takes long to import and belongs to the extra `workflow`.
if TYPE_CHECKING:
    import pyarrow as pa


Problems = dict[str, Problem]
"""By name."""
Worlds = dict[str, World]
"""The worlds of those that move, by the problem's name."""


def place_problem(problem: Problem, kinds: Collection[str] | None = None) -> Problem:
    """Build a problem again on the map that suits a planner, and check its start and target.

    kinds: the kinds of workspace that the planner serves, None for all. Raises ValueError as
    `build` does.
    """
    home = robot.choose_suitable(problem.workspace, kinds)
    return build(problem.name, {"start": problem.start, "target": problem.target}, home)


def build(name: str, description: dict, workspace: Workspace) -> Problem:
    """Build a problem from its description: start and target, (x, y) in units, or start_cell and
    target_cell, cell numbers of a grid.

    Raises ValueError, naming key and value, unless both lie in free space.
    """
    start, target = (read_place(end, description, workspace) for end in ("start", "target"))
    return Problem(name, workspace, start, target)


def read_place(end: str, description: dict, workspace: Workspace) -> Place:
    """Return the start or target of a description, or another place, as (x, y) in units. Raises
    ValueError if it is not free.
    """
    key = end if end in description else f"{end}_cell"
    value = description[key]
    if key == end:
        point = float(value[0]), float(value[1])
    elif isinstance(workspace, Grid):
        try:
            point = workspace.centre(value)
        except ValueError as error:
            raise ValueError(f"{key}: {error}") from None
    else:
        raise ValueError(f"{key}: {value}: only a grid has cell numbers; expected {end}: [x, y]")
    # First on the map itself: a place that is not free there is no fault of the robot's radius.
    grown, home = find_growth(workspace), original(workspace)
    x_low, x_high, y_low, y_high = home.bounds
    if not (x_low <= point[0] <= x_high and y_low <= point[1] <= y_high):
        raise ValueError(
            f"{key}: {value}: outside the workspace; expected x from {x_low:.12g} to {x_high:.12g} "
            f"and y from {y_low:.12g} to {y_high:.12g}"
        )
    if is_blocked(build_region(home), point):
        raise ValueError(f"{key}: {value}: in an obstacle; expected a free place of the workspace")
    if grown and is_blocked(build_region(workspace), point):
        # A path that stays at the point: its clearance is the distance to the map itself.
        distance = check(np.array([[point, point]]), build_region(home)).clearance
        # Around corners, the grown obstacles reach a little farther than the radius.
        least = grown.radius if distance < grown.radius else (1 + robot.ARC_EXCESS) * grown.radius
        cells = ", by whole cells" if isinstance(workspace, Grid) and not workspace.shapes else ""
        raise ValueError(
            f"{key}: {value}: {distance:.6g} from an obstacle or the border; expected at least "
            f"the robot's radius, {least:.6g}{cells}"
        )
    if (
        isinstance(workspace, Grid)
        and workspace.shapes
        and workspace.occupied[workspace.cell_of(*point)]
    ):
        raise ValueError(
            f"{key}: {value}: in an occupied cell; expected a free one, or a smaller cell"
        )
    return point


def build_all(descriptions: Descriptions, folder: Path) -> tuple[Problems, Worlds]:
    """Build problems, and the worlds of those that move, by the problem's name.

    folder: where map files lie. Random parts follow from the names of study and workspace and the
    problem's numbers alone. Raises ValueError for a fault in any description.
    """
    from bezierplan.workspaces.kinds import kind_of

    kinds = {name: kind_of(each) for name, each in descriptions.workspaces.items()}
    fixed = {
        name: files.load(each, folder)
        for name, each in descriptions.workspaces.items()
        if hasattr(kinds[name], "load")
    }
    problems, moving = {}, {}
    for name, problem in descriptions.problems.items():
        home = problem["workspace"]
        arguments = descriptions.workspaces[home], problem, f"{descriptions.study}/{home}"
        # Problems on one map share its object, so `build_region` prepares it once.
        if home in fixed:
            workspace = fixed[home]
        elif hasattr(kinds[home], "draw"):
            workspace = kinds[home].draw(*arguments)
        else:
            moving[name] = kinds[home].world(*arguments, folder, partial(_measure_steps, problem))
            workspace = moving[name].workspace(0)
        problems[name] = build(name, problem, workspace)
    return problems, moving


def _measure_steps(problem: dict, grid: Grid) -> float:
    """Return the length of the shortest path from cell to cell between a problem's ends."""
    return shortest_paths.centre_path(build("first", problem, grid)).length


def write(
    problems: Problems,
    workspaces: dict[str, str],
    file: str,
    moving: Worlds | None = None,
) -> None:
    """Write problems, by name, with the names of their workspaces, and their worlds, if there are
    any.
    """
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
            "drawn": files.write_json(problem.workspace),
        }
        | ({"world": worlds.to_json(moving[name])} if moving else {})
        for name, problem in problems.items()
    ]
    parquet.write_table(pa.Table.from_pylist(rows), file)


def read(file: str) -> tuple[Problems, Worlds]:
    """Read the problems of a file, by name, in file order, and the worlds of those that move.
    Problems in one workspace share its object.
    """
    from bezierplan.running import table_files

    table = table_files.read(file).to_pylist()
    drawn = {text: files.read_json(text) for text in {row["drawn"] for row in table}}
    problems = {
        row["problem"]: Problem(
            row["problem"],
            drawn[row["drawn"]],
            (row["start_x"], row["start_y"]),
            (row["target_x"], row["target_y"]),
        )
        for row in table
    }
    moving = {row["problem"]: worlds.from_json(row["world"]) for row in table if "world" in row}
    return problems, moving


def compute_bounds(problems: Problems, moving: Worlds) -> "pa.Table":
    """Return a table with the straight line and the exact shortest path of each problem; where it
    moves, with a length and a time that no robot can beat, and no octile bound.
    """
    from bezierplan.running import table_files

    made = []
    for name, problem in problems.items():
        world = moving.get(name)
        least = (
            bounds.find_least_way(world, problem)
            if world
            else shortest_paths.shortest_path(problem)
        )
        row = Bound(
            problem=name,
            straight_line=math.dist(problem.start, problem.target),
            bound=least.length,
            least_length=shortest_paths.least_length(least),
            bound_path=least.points.ravel().tolist(),
            octile_bound=math.nan if world else _compute_cell_bound(problem),
        )._asdict()
        if world:
            row |= DriveBound(bounds.bound_arrival(world, problem))._asdict()
        made.append(row)
    return table_files.build_table(made, Bound, DriveBound)


def _compute_cell_bound(problem: Problem) -> float:
    """Return the least length, in units, of a path over free cells with straight and diagonal
    steps, which may pass between two occupied cells; nan without cells.
    """
    grid = problem.workspace
    if not isinstance(grid, Grid):
        return math.nan
    start, target = grid.cell_of(*problem.start), grid.cell_of(*problem.target)
    assert start
    assert target
    return (
        shortest_paths.lattice_path(
            grid.occupied, start, target, cell_length.DIAGONAL, "free"
        ).length
        * grid.cell
    )
