"""What must not take longer than a promised time: the six maps of elhoseny2017, and large inputs.
Each line shows the limit beside it.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from timing import cpu_seconds

from bezierplan.figures.panels import workspace as panel
from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.planners import modified_genetic, rounded_shortest_path
from bezierplan.running import problems
from bezierplan.study import jobs, reading
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Path, Problem

RUNS = 5


class Timed(NamedTuple):
    """What was timed, its CPU seconds, and how many it may take."""

    name: str
    seconds: float
    limit: float


def _on_the_maps() -> Iterator[Timed]:
    """The mean run of MGA-C, the exact shortest path, and what its rounding adds, each on the map
    where it takes longest.
    """
    study = reading.load(reading.read_config({"studies": ["elhoseny2017"]}))["elhoseny2017"]
    made = problems.build_all(jobs.problems_job(study, "maps", "smoke"), study.folder)
    maps = list(made.values())

    def genetic(problem: Problem) -> float:
        settings = study.resolved("mga_c")

        def runs() -> None:
            for seed in range(RUNS):
                modified_genetic.plan(problem, np.random.default_rng(seed), **settings)

        return cpu_seconds(runs, 1) / RUNS

    def exact(problem: Problem) -> float:
        return cpu_seconds(lambda: shortest_paths.shortest_path(problem))

    def rounding(problem: Problem) -> float:
        settings = study.resolved("rounded")
        return cpu_seconds(
            lambda: rounded_shortest_path.plan(problem, np.random.default_rng(0), **settings)
        ) - exact(problem)

    for name, work, limit in (
        ("MGA-C", genetic, 1.5),
        ("exact shortest path", exact, 0.02),
        ("rounding", rounding, 0.005),
    ):
        seconds, hardest = max((work(problem), problem.name) for problem in maps)
        yield Timed(f"{name}, {hardest}", seconds, limit)


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


def star(corners: int) -> Problem:
    """A way around a star with that many corners."""
    angles = np.arange(corners) * math.tau / corners
    ring = 5 + np.where(np.arange(corners) % 2, 4.0, 3.0)[:, None] * np.column_stack(
        [np.cos(angles), np.sin(angles)]
    )
    return Problem("", Polygons((0.0, 10.0, 0.0, 10.0), ((ring,),), "m"), (0.1, 5.0), (9.9, 5.1))


def draw(grid: Grid) -> None:
    """What is drawn of a grid, as a picture in memory."""
    import io

    from matplotlib.figure import Figure

    figure = Figure()
    panel.shade(figure.add_subplot(), panel.data(grid))
    figure.savefig(io.BytesIO(), format="svg")


def _large() -> Iterator[Timed]:
    """Exact bounds, a picture and a check of inputs that are as large as they may be."""
    for side, largest, limit in ((128, 1, 5.0), (1000, 1, 10.0), (1000, 3, 10.0), (1000, 30, 10.0)):
        problem = Problem("", random_cells(side, largest), (0.5, 0.5), (side - 0.5, side - 0.5))
        yield Timed(
            f"{side} x {side} cells, blocks up to {largest}",
            cpu_seconds(lambda: shortest_paths.shortest_path(problem), 1),  # noqa: B023
            limit,
        )
    problem = star(5000)
    yield Timed(
        "polygon with 5,000 corners",
        cpu_seconds(lambda: shortest_paths.shortest_path(problem), 1),
        5.0,
    )
    grid = random_cells(2000, 30)
    yield Timed("picture of 2000 x 2000 cells", cpu_seconds(lambda: draw(grid), 1), 5.0)
    share = np.linspace(0, 1, 61)
    pieces = curves.bezier_pieces(
        Path("bezier", np.column_stack([1 + 8 * share, 9.5 + 0.3 * np.sin(60 * share)]))
    )
    blocked = region(problem.workspace)
    yield Timed(
        "check of a curve of degree 60", cpu_seconds(lambda: checker.check(pieces, blocked)), 5.0
    )


def benchmark_limits() -> None:
    """CPU time beside its limit."""
    print(f"\n{'limits':44}{'CPU s':>12}{'at most':>12}")
    for part in (_on_the_maps, _large):
        for timed in part():
            late = "" if timed.seconds <= timed.limit else "   too slow"
            print(f"  {timed.name:42}{timed.seconds:12.4f}{timed.limit:12.3f}{late}", flush=True)
