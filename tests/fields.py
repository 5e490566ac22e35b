"""Fields and maps for tests of planners, and what holds for every path that is found in a random
field.
"""

import json
from pathlib import Path as File

import numpy as np

from bezierplan.geometry import cell_length, curves, shortest_paths
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region
from bezierplan.geometry.shortest_paths import Bound
from bezierplan.planners import Plan
from bezierplan.workspaces import random_field
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.geojson import read_geojson
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.problem import Problem

STUDIES = File(__file__).resolve().parents[1] / "config" / "studies"
# The six benchmark maps of elhoseny2017, and the map of song2016.
BENCHMARK_MAPS = STUDIES / "elhoseny2017" / "workspaces"
CELLS = STUDIES / "song2016" / "workspaces" / "figure2.txt"

# Circles (x, y, radius) of one size and of three sizes, between the ends of `among_circles`.
EQUAL = ((1.5, 4.5, 1.2), (4.0, 3.0, 1.2), (1.2, 1.5, 1.2))
PUBLIC = ((1.5, 4.5, 1.5), (4.0, 3.0, 1.0), (1.2, 1.5, 0.8))


def benchmark(name: str) -> tuple[Problem, float]:
    """One of these maps with its own ends, and the length of the shortest path that it states."""
    text = (BENCHMARK_MAPS / f"{name}.geojson").read_text()
    properties = json.loads(text)["properties"]
    ends = [tuple(properties[end]) for end in ("start", "target")]
    polygons = read_geojson(text, "m")
    return Problem(name, polygons, *ends), properties["shortest_path_length_m"]


def among_circles(circles, start=(0.0, 0.0), target=(4.0, 6.0)) -> Problem:
    """Circles (x, y, radius) in the field of tharwat2018's maps."""
    table = np.array(circles, dtype=float).reshape(-1, 3)
    field = Circles((-10.0, 10.0, -10.0, 10.0), table[:, :2], table[:, 2], "unit")
    return Problem("test", field, start, target)


def field_of(side: float, *circles: tuple[float, float, float]) -> Grid:
    """The cells of a square field with circles (x, y, radius)."""
    table = np.array(circles, dtype=float).reshape(-1, 3)
    home = Circles((0.0, side, 0.0, side), table[:, :2], table[:, 2], "cell")
    return random_field.from_circles(home)


def drawn(number: int, radius: float = 0.06, obstacles: int = 25, side: int = 100) -> Problem:
    """From corner to corner of the field of a number, both pairs of corners in turn; radius: of the
    obstacles, as a share of the side.
    """
    start, target = [((0, 0), (side, side)), ((side, 0), (0, side))][number % 2]
    described = {
        "start": start,
        "target": target,
        "side": side,
        "obstacles": obstacles,
        "layout": number,
    }
    grid = random_field.field(
        {"radius": radius, "clear_ends": 2.0, "unit": "cell"}, described, "test"
    )
    return Problem("test", grid, tuple(map(float, start)), tuple(map(float, target)))


def random_grid(seed: int, shape: tuple[int, int], share: float = 0.3, cell: float = 1.0) -> Grid:
    """Cells of which a share is occupied, the first and the last one free."""
    occupied = np.random.default_rng(seed).random(shape) < share
    occupied[0, 0] = occupied[-1, -1] = False
    return Grid(occupied, cell, "unit")


def assert_path_fits(problem: Problem, found: Plan) -> None:
    """The path leads from start to target, touches no occupied cell, is free by the certified
    check, and no shorter than the least path of cells.
    """
    grid = problem.workspace
    assert found.claimed_feasible
    assert found.path.points[[0, -1]].tolist() == [list(problem.start), list(problem.target)]
    assert (
        cell_length.count_occupied_cells(
            *cell_length.list_touched_cells(*cell_length.sample_in_cells(found.path, grid)),
            grid.occupied,
        )
        == 0
    )
    assert check(curves.bezier_pieces(found.path), build_region(grid)).feasible
    octile_bound = shortest_paths.lattice_path(
        grid.occupied, grid.cell_of(*problem.start), grid.cell_of(*problem.target), 1.5, "free"
    ).length
    assert (
        octile_bound
        <= cell_length.length8(found.path, grid)
        <= cell_length.length4(found.path, grid)
    )


def pieces_of(bound: Bound) -> np.ndarray:
    """The legs of a shortest path, as the checker takes them."""
    return np.stack([bound.points[:-1], bound.points[1:]], axis=1)


def assert_is_bound(bound: Bound, problem: Problem) -> None:
    """The polyline goes from start to target, has the bound's length (with arcs: at most 1e-6
    more), and is free.
    """
    np.testing.assert_allclose(bound.points[[0, -1]], [problem.start, problem.target], atol=1e-12)
    drawn = np.hypot(*np.diff(bound.points, axis=0).T).sum()
    excess = 1e-6 if isinstance(problem.workspace, Circles) else 0
    assert -1e-9 <= drawn - bound.length <= excess + 1e-9
    assert check(pieces_of(bound), build_region(problem.workspace)).feasible


def on_map(
    *lines: str,
    start: tuple[float, float] | None = None,
    target: tuple[float, float] | None = None,
    cell: float = 1.0,
) -> Problem:
    """From the lower left to the upper right cell of a map of cells, unless told otherwise."""
    grid = from_lines(list(lines), cell, "unit")
    ends = start or grid.centre(0), target or grid.centre(grid.occupied.size - 1)
    return Problem("test", grid, *ends)
