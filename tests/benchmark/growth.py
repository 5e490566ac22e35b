"""How cost grows with what there is more of: samples, obstacles, cells.

Each series is CPU seconds at sizes in a geometric series. The slope of log(cost) over log(size) is
the power of the size that the cost grows with; at most linear is a slope of at most 1. It is fitted
to the upper sizes only, where a constant cost no longer hides growth.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import frame
import numpy as np
from limits import corner_to_corner, random_cells
from scipy.stats import linregress

from bezierplan.geometry import checker, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.planners import planner_module, planner_settings
from bezierplan.running import problems
from bezierplan.workspaces import files
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

COLUMNS = ("a cost", "of", "sizes", "CPU ms", "slope", "+-", "")
ROUNDS = 3
FITTED = 4
"""The slope is that of this many of the largest sizes."""
LIMIT = 1.0
"""Largest slope of a cost that grows at most linearly."""

Work = Callable[[], object]
# Name, what there is more of, sizes, and what makes the work of a size, which is not measured.
Series = tuple[str, str, Sequence[int], Callable[[int], Work]]


class Slope(NamedTuple):
    """Slope of a line through log(seconds) over log(size), and its standard error."""

    value: float
    error: float

    @property
    def steeper(self) -> bool:
        """Whether the slope lies above `LIMIT` by more than two standard errors."""
        return self.value - 2 * self.error > LIMIT


def slope(sizes: Sequence[float], seconds: Sequence[float]) -> Slope:
    """The slope of the `FITTED` largest sizes; both arguments (n,), sizes ascending."""
    line = linregress(np.log(sizes[-FITTED:]), np.log(seconds[-FITTED:]))
    return Slope(line.slope, line.stderr)


def geometric(first: int, last: int, number: int = 6) -> list[int]:
    """Whole numbers in a geometric series."""
    return np.rint(np.geomspace(first, last, number)).astype(int).tolist()


def rows(small: bool) -> Iterator[frame.Row]:
    """Each series with its slope."""
    series = [*_samples(), *_obstacles(), *_cells()]
    for name, kind, sizes, prepare in series[:: 4 if small else 1]:
        sizes = sizes[: 2 if small else None]
        works = [prepare(size) for size in sizes]
        seconds = frame.cpu_seconds_of_each(works, 1 if small else ROUNDS)
        line = slope(sizes, seconds)
        ends = (f"{sizes[0]:,}-{sizes[-1]:,}", f"{1e3 * seconds[0]:.2g}-{1e3 * seconds[-1]:.3g}")
        yield (name, kind, *ends, *line, "steeper" if line.steeper else "")


def _samples() -> Iterator[Series]:
    for key, method, problem in (
        ("tharwat2018", "pso", "equal"),
        ("song2016", "smooth", "0_240"),
        ("ma2020", "bca", "environment1"),
    ):
        study = frame.study(key)
        work = partial(_run_with_samples, study, method, problem)
        yield f"run of {study.planner(method)}", "samples", geometric(101, 3201), work
    squares = region(_room(6, _squares))
    yield (
        "check, by pieces",
        "pieces",
        geometric(32, 1024),
        lambda n: partial(checker.check, _along(6, n), squares),
    )


def _run_with_samples(study: frame.Study, method: str, name: str, samples: int) -> Work:
    workspace = files.load(study.workspace_of(name).plain(), study.folder)
    problem = problems.build(name, study.problems[name].plain("settings"), workspace)
    settings = study.resolved(method) | study.problems[name].settings | {"samples": samples}
    return _run(study.planner(method), problem, settings)


def _run(planner: str, problem: Problem, settings: dict) -> Work:
    """A run with always the same random numbers."""
    module = planner_module(planner)
    accepted = {name: value for name, value in settings.items() if name in planner_settings(module)}
    return lambda: module.plan(problem, np.random.default_rng(0), **accepted)


def _along(side: int, pieces: int) -> np.ndarray:
    """Free straight pieces (pieces, 2, 2) of a wave from left to right, between two rows of the
    obstacles of `_room`.
    """
    x = np.linspace(0.1, side - 0.1, pieces + 1)
    points = np.column_stack([x, side // 2 + 0.1 * np.sin(20 * x)])
    return np.stack([points[:-1], points[1:]], axis=1)


def _obstacles() -> Iterator[Series]:
    """One obstacle in each square of a room."""
    settings = frame.study("tharwat2018").resolved("pso") | {"stall_limit": 0}
    sizes = [side**2 for side in (2, 3, 4, 6, 8, 11, 16, 23)]

    def check(draw: Callable, n: int) -> Work:
        side = math.isqrt(n)
        return partial(checker.check, _along(side, 10), region(_room(side, draw)))

    for name, draw in (("circles", _discs), ("polygons", _squares)):
        across = partial(_across, draw)
        runs = lambda n, across=across: _run("chaotic_pso", across(n), settings)  # noqa: E731
        yield f"run of chaotic_pso among {name}", "obstacles", sizes, runs
        yield f"check among {name}", "obstacles", sizes, partial(check, draw)
        # Among fewer polygons than 125, all pairs of corners are tested.
        bound = lambda n, across=across: partial(shortest_paths.shortest_path, across(n))  # noqa: E731
        yield f"exact bound among {name}", "obstacles", [*sizes, 32**2, 45**2], bound


def _across(draw: Callable, obstacles: int) -> Problem:
    """From corner to corner of a room."""
    side = math.isqrt(obstacles)
    return Problem("", _room(side, draw), (0.05, 0.05), (side - 0.05, side - 0.05))


def _room(side: int, draw: Callable) -> Workspace:
    """A room of side x side units with an obstacle in the middle of each, drawn from its bounds,
    centres (n, 2) and radii (n,).
    """
    centres = np.stack(np.meshgrid(*[np.arange(side) + 0.5] * 2), axis=-1).reshape(-1, 2)
    radii = np.random.default_rng(side).uniform(0.2, 0.35, side**2)
    return draw((0.0, float(side), 0.0, float(side)), centres, radii)


def _discs(bounds: tuple, centres: np.ndarray, radii: np.ndarray) -> Circles:
    return Circles(bounds, centres, radii, "unit")


def _squares(bounds: tuple, centres: np.ndarray, radii: np.ndarray) -> Polygons:
    ring = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    rings = ((centre + radius * ring,) for centre, radius in zip(centres, radii))
    return Polygons(bounds, tuple(rings), "unit")


def _cells() -> Iterator[Series]:
    """Cells of a square grid: exact bounds by search and by a graph of pairs of corners, the check,
    and runs of planners.
    """

    def bound(n: int) -> Work:
        problem = corner_to_corner(random_cells(math.isqrt(n), 1))
        return partial(shortest_paths.shortest_path, problem)

    yield "exact bound, search", "cells", _squared(128, 640), bound
    yield "exact bound, graph", "cells", _squared(12, 60), bound
    yield "check", "cells", _squared(32, 512), _check_in_row
    for key, method, last in (
        ("elhoseny2017", "octile_bound", 512),
        ("elhoseny2017", "mga_c", 256),
        ("elhoseny2017", "ga", 256),
        ("ma2020", "ga", 128),
        ("ma2020", "aco", 128),
        ("ma2020", "bca", 512),
        ("song2016", "smooth", 512),
        ("meledje", "proposed", 64),
    ):
        study = frame.study(key)
        work = partial(_run_on_cells, study, method)
        yield f"run of {study.planner(method)}", "cells", _squared(16, last), work


def _squared(first: int, last: int) -> list[int]:
    return [side**2 for side in geometric(first, last)]


def _run_on_cells(study: frame.Study, method: str, cells: int) -> Work:
    """A run on a grid with always the same number of blocks, in which a path may be as many times
    longer as a side of the grid is.
    """
    side, settings = math.isqrt(cells), study.resolved(method)
    for name in settings.keys() & {"longest_join", "longest_path"}:
        settings[name] = int(side / 16 * settings[name])
    occupied, rng = np.zeros((side, side), dtype=bool), np.random.default_rng(0)
    for row, column in rng.integers(1, side - 1, (25, 2)):
        height, width = rng.integers(1, max(2, side // 8), 2)
        occupied[row : row + height, column : column + width] = True
    occupied[0, 0] = occupied[-1, -1] = False
    return _run(study.planner(method), corner_to_corner(Grid(occupied, 1.0, "cell")), settings)


def _check_in_row(cells: int) -> Work:
    """The check of ten pieces along the lowest row of a grid, all of it free."""
    side = math.isqrt(cells)
    occupied = random_cells(side, 1).occupied.copy()
    occupied[0] = False
    x = np.linspace(0.5, side - 0.5, 11)
    points = np.column_stack([x, 0.5 + 0.1 * np.sin(x)])
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    return partial(checker.check, pieces, region(Grid(occupied, 1.0, "cell")))
