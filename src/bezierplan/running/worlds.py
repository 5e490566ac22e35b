"""The problems of experiments in moving worlds: built from their descriptions, and kept in files
like those of `problems`, with one more column: world, as JSON (`workspaces.worlds`). The workspace
of such a problem is what planners see at the beginning.
"""

import math
from pathlib import Path

import pyarrow as pa

from bezierplan.geometry import shortest_paths
from bezierplan.running import problems as problem_files
from bezierplan.running import rows
from bezierplan.running.columns import Bound, DriveBound
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.simulation import bounds
from bezierplan.workspaces import worlds
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import kind_of
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import World


def build_all(
    descriptions: Descriptions, folder: Path
) -> tuple[dict[str, Problem], dict[str, World]]:
    """Problems and their worlds, both by the problem's name, from their descriptions; no worlds
    where nothing moves.

    Map files are looked up in the folder. Raises ValueError for a fault in any of them.
    """
    if not all(hasattr(kind_of(each), "world") for each in descriptions.workspaces.values()):
        return problem_files.build_all(descriptions, folder), {}
    made, moving = {}, {}
    for name, problem in descriptions.problems.items():
        home = problem["workspace"]
        world = build(
            descriptions.workspaces[home], problem, f"{descriptions.study}/{home}", folder
        )
        made[name] = problem_files.build(name, problem, world.workspace(0))
        moving[name] = world
    return made, moving


def build(description: dict, problem: dict, name: str, folder: Path) -> World:
    """The world of a problem; random ones are drawn from the name of study and workspace and from
    the problem's numbers alone.

    Raises ValueError, naming the key.
    """

    def length(grid: Grid) -> float:
        """The length of the shortest path from cell to cell between the problem's ends."""
        return shortest_paths.centre_path(problem_files.build("first", problem, grid)).length

    return kind_of(description).world(description, problem, name, folder, length)


def read(file: str) -> dict[str, World]:
    """The worlds of a file of problems, by problem; empty if nothing moves there."""
    table = rows.read(file, threads=False)
    if "world" not in table.column_names:
        return {}
    made = zip(table["problem"].to_pylist(), table["world"].to_pylist())
    return {name: worlds.from_json(text) for name, text in made}


def bounds_of(problems: dict[str, Problem], moving: dict[str, World]) -> pa.Table:
    """`problems.bounds_of`; in worlds a row for each problem with columns of `columns.Bound`,
    without an octile bound, and of `columns.DriveBound`.
    """
    if not moving:
        return problem_files.bounds_of(problems)
    made = []
    for name, problem in problems.items():
        least = bounds.least_way(moving[name], problem)
        arrival = DriveBound(bounds.least_arrival(moving[name], problem))
        made.append(problem_files.bound_row(name, problem, least, math.nan) | arrival._asdict())
    return rows.table(made, Bound, DriveBound)
