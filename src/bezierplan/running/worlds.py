"""The problems of experiments in moving worlds: built from their descriptions, and kept in files like those of `problems`, with one more
column: world, as JSON (`workspaces.worlds`). The workspace of such a problem is what planners see at the beginning.
"""

import math
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet

from bezierplan.running import problems as problem_files
from bezierplan.workspaces import random_field, worlds
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import check_bounds, check_thickness
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.random_circles import MOST_DRAWS
from bezierplan.workspaces.seeds import generator
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles, World


def build_all(job: dict, folder: Path) -> tuple[dict[str, Problem], dict[str, str], dict[str, World]]:
    """Problems, the names of their workspaces, and their worlds, all keyed by problem, from their descriptions (`jobs.problems_job`).

    Map files are looked up in the folder. Raises ValueError for a fault in any of them.
    """
    made, found = {}, {}
    for name, problem in job["problems"].items():
        description = job["workspaces"][problem["workspace"]]
        world = build(description, problem, f"{job['study']}/{problem['workspace']}", folder)
        made[name] = problem_files.build(name, problem, world.workspace(0))
        found[name] = world
    return made, {name: problem["workspace"] for name, problem in job["problems"].items()}, found


def build(description: dict, problem: dict, name: str, folder: Path) -> World:
    """The world of a problem; random ones are drawn from the name of study and workspace and from the problem's numbers alone.

    Raises ValueError, naming the key.
    """
    kind = description["kind"]
    if kind == "changing_cells":
        return _changing_cells(description, problem, folder)
    if kind == "random_changing_cells":
        return _random_changes(description, problem, name, folder)
    return _moving_circles(description, problem, name)


# Circles


def _moving_circles(description: dict, problem: dict, name: str) -> MovingCircles:
    kind = description["kind"]
    on_field = kind == "random_moving_field"
    side = problem.get("side", 0)
    walls = (0.0, float(side), 0.0, float(side)) if on_field else tuple(map(float, description["bounds"]))
    check_bounds(walls)
    if kind == "moving_circles":
        table = np.array(description["circles"], dtype=float).reshape(-1, 5)
        centres, radii, velocities = table[:, :2].copy(), table[:, 2].copy(), table[:, 3:].copy()
        low, high = np.reshape(walls, (2, 2)).T
        if ((centres < low) | (centres > high)).any():
            raise ValueError(f"circles: a centre lies outside bounds {list(walls)}; centres are reflected there")
    else:
        ends = [*problem["start"], *problem["target"]]
        parts = [name, side, *ends, problem["obstacles"], problem["layout"]] if on_field else [name, *ends, problem["layout"]]
        rng = generator("/".join(map(str, parts)))
        radius = description["radius"] * (side if on_field else 1)
        count = problem["obstacles"] if on_field else description["circles"]
        centres = _drawn_centres(rng, count, walls, np.reshape(ends, (2, 2)), radius + description["clear_ends"])
        heading = rng.uniform(0.0, 2 * np.pi, count)
        velocities = description["speed"] * np.column_stack([np.cos(heading), np.sin(heading)])
        # Of a layout in the plane, the first so many circles, as where nothing moves.
        centres, velocities = centres[: problem["obstacles"]], velocities[: problem["obstacles"]]
        radii = np.full(len(centres), float(radius))
    for i, radius in enumerate(radii):
        check_thickness(radius, f"circles: circle {i}: radius")
    bounds = tuple(value + (0.5 if n % 2 else -0.5) for n, value in enumerate(walls)) if on_field else walls
    pace, end, unit = float(description["pace"]), description["steps"], description["unit"]
    return MovingCircles(bounds, walls, centres, velocities, radii, "cells" if on_field else "circles", pace, end, unit)


def _drawn_centres(rng: np.random.Generator, count: int, walls: tuple, ends: np.ndarray, least: float) -> np.ndarray:
    """Centres (count, 2) within the walls, none of them closer to an end than the minimum distance."""
    low, high = np.reshape(walls, (2, 2)).T
    centres = np.empty((count, 2))
    for i in range(count):
        for _ in range(MOST_DRAWS):
            centres[i] = rng.uniform(low, high)
            if np.hypot(*(ends - centres[i]).T).min() >= least:
                break
        else:
            raise ValueError(f"radius: no circle keeps {least:g} away from start and target in {MOST_DRAWS} draws")
    return centres


# Cells


def _changing_cells(description: dict, problem: dict, folder: Path) -> ChangingCells:
    from bezierplan.workspaces.kinds.grid import load

    given = {key: description[key] for key in ("cell", "unit")}
    names = [description["file"], *(change["file"] for change in description["changes"])]
    maps = tuple(load(given | {"file": file}, folder) for file in names)
    for file, grid in zip(names, maps):
        if grid.occupied.shape != maps[0].occupied.shape:
            raise ValueError(f"changes: {file}: {grid.occupied.shape} cells, but {names[0]} has {maps[0].occupied.shape}")
    first = problem_files.build("first", problem, maps[0])
    moments = np.array([_moment(change, first, float(description["pace"])) for change in description["changes"]])
    if (np.diff(moments) <= 0).any() or (moments <= 0).any():
        raise ValueError(f"changes: they are at steps {', '.join(f'{each:g}' for each in moments)}; expected ascending ones above 0")
    return ChangingCells(maps, moments, float(description["pace"]), description["steps"])


def _moment(change: dict, first: Problem, pace: float) -> float:
    """When a change happens, in steps."""
    from bezierplan.geometry import shortest_paths

    if "at" in change:
        return float(change["at"])
    # A share of the way of a robot that follows the shortest path from cell to cell.
    length = shortest_paths.centre_path(first).length
    if math.isinf(length):
        raise ValueError(f"changes: after: {change['after']:g}: no path leads from start to target on the first map; expected at: a step")
    return change["after"] * length / pace


# Draws of one change before a world is abandoned.
_MOST_CHANGES = 1000


def _random_changes(description: dict, problem: dict, name: str, folder: Path) -> ChangingCells:
    """At every `every`-th step as many random cells change as the problem has `obstacles`; start and target stay free, and connected."""
    from bezierplan.workspaces.kinds.grid import load

    first = load({key: description[key] for key in ("unit", "cell", "file")}, folder)
    ends = [first.cell_of(*map(float, problem[end])) for end in ("start", "target")]
    if None in ends:
        raise ValueError("start or target lies outside the map")
    moments = np.arange(description["every"], description["steps"], description["every"], dtype=float)
    rng = generator("/".join(map(str, [name, *problem["start"], *problem["target"], problem["obstacles"], problem["layout"]])))
    changeable = np.ones(first.occupied.shape, dtype=bool)
    for end in ends:
        changeable[end] = False
    numbers = np.flatnonzero(changeable)
    if problem["obstacles"] > len(numbers):
        raise ValueError(f"obstacles: {problem['obstacles']}; expected at most {len(numbers)}, the cells that can change")
    maps = [first]
    for _ in moments:
        for _ in range(_MOST_CHANGES):
            occupied = maps[-1].occupied.copy()
            occupied.flat[rng.choice(numbers, problem["obstacles"], replace=False)] ^= True
            if random_field.connected(occupied, *ends):
                break
        else:
            raise ValueError(f"obstacles: {problem['obstacles']}: start and target are cut off from each other in {_MOST_CHANGES} changes")
        maps.append(Grid(occupied, first.cell, first.unit))
    return ChangingCells(tuple(maps), moments, float(description["pace"]), description["steps"])


# Files


def write(problems: dict[str, Problem], workspaces: dict[str, str], found: dict[str, World], file: str) -> None:
    """Write problems, with the names of their workspaces and their worlds."""
    problem_files.write(problems, workspaces, file)
    table = parquet.read_table(file)
    column = pa.array([worlds.to_json(found[name]) for name in table["problem"].to_pylist()])
    parquet.write_table(table.append_column("world", column), file)


def read(file: str) -> dict[str, World]:
    """The worlds of a file of problems, by problem; empty if nothing moves there."""
    if "world" not in parquet.read_schema(file).names:
        return {}
    table = parquet.read_table(file, columns=["problem", "world"]).to_pydict()
    return {name: worlds.from_json(text) for name, text in zip(table["problem"], table["world"])}
