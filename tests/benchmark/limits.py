"""What must not take longer than a promised time: the six maps of elhoseny2017, and large inputs.
Each line shows the limit beside it.
"""

import math
from collections.abc import Callable, Iterator
from functools import partial

import frame
import numpy as np

from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.planners import planner_module
from bezierplan.running import problems
from bezierplan.study import jobs
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Path, Problem

COLUMNS = ("limits", "CPU s", "at most", "")


def rows(small: bool) -> Iterator[frame.Row]:
    """CPU seconds beside the limit."""
    for name, seconds, limit in (*_on_the_maps(small), *_large(small)):
        yield name, seconds, limit, "" if seconds <= limit else "too slow"


def _on_the_maps(small: bool) -> Iterator[tuple[str, float, float]]:
    """MGA-C, the exact shortest path, and that path with its corners rounded, each on the map where
    it takes longest.
    """
    study = frame.study("elhoseny2017")
    maps = problems.build_all(jobs.problems_job(study, "maps", "smoke"), study.folder)
    works: dict[str, tuple[Callable[[Problem], object], float]] = {
        "exact shortest path": (shortest_paths.shortest_path, 0.02),
        "rounding, with the exact path": (_run(study, "rounded"), 0.025),
        "MGA-C": (_run(study, "mga_c"), 1.5),
    }
    for name, (work, limit) in works.items():
        seconds, hardest = max(
            (frame.cpu_seconds(partial(work, problem), 1 if small else frame.ROUNDS), problem.name)
            for problem in list(maps.values())[: 1 if small else None]
        )
        yield f"{name}, {hardest}", seconds, limit


def _run(study: frame.Study, method: str) -> Callable[[Problem], object]:
    plan, settings = planner_module(study.planner(method)).plan, study.resolved(method)
    return lambda problem: plan(problem, np.random.default_rng(0), **settings)


def random_cells(side: int, largest: int, seed: int = 2) -> Grid:
    """A grid with 20 % of its cells in square blocks of random sides, two corners free."""
    rng = np.random.default_rng(seed)
    occupied = np.zeros((side, side), dtype=bool)
    while occupied.mean() < 0.2:
        for row, column, size in zip(
            *rng.integers(0, side, (2, 500)), rng.integers(1, largest + 1, 500)
        ):
            occupied[row : row + size, column : column + size] = True
    occupied[0, 0] = occupied[-1, -1] = False
    return Grid(occupied, 1.0, "cell")


def corner_to_corner(grid: Grid) -> Problem:
    side = len(grid.occupied)
    return Problem("", grid, (0.5, 0.5), (side - 0.5, side - 0.5))


def _star(corners: int) -> Problem:
    """A way around a star with that many corners."""
    angles = np.arange(corners) * math.tau / corners
    reach = 3.0 + np.arange(corners) % 2
    ring = 5 + reach[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return Problem("", Polygons((0.0, 10.0, 0.0, 10.0), ((ring,),), "m"), (0.1, 5.0), (9.9, 5.1))


def _large(small: bool) -> Iterator[tuple[str, float, float]]:
    """Exact bounds and a check of inputs that are as large as they may be."""
    part = 10 if small else 1
    for side, largest, limit in ((128, 1, 5.0), (1000, 1, 10.0), (1000, 3, 10.0), (1000, 30, 10.0)):
        problem = corner_to_corner(random_cells(side // part, largest))
        seconds = frame.cpu_seconds(partial(shortest_paths.shortest_path, problem), 1)
        yield f"{side // part} x {side // part} cells, blocks up to {largest}", seconds, limit
    problem = _star(5000 // part)
    seconds = frame.cpu_seconds(partial(shortest_paths.shortest_path, problem), 1)
    yield f"polygon with {5000 // part:,} corners", seconds, 5.0
    share = np.linspace(0, 1, 61)
    wave = np.column_stack([1 + 8 * share, 9.5 + 0.3 * np.sin(60 * share)])
    pieces, blocked = curves.bezier_pieces(Path("bezier", wave)), region(problem.workspace)
    seconds = frame.cpu_seconds(partial(checker.check, pieces, blocked), 1)
    yield "check of a curve of degree 60", seconds, 5.0
