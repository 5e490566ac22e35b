"""Sequences of nodes on maps of growing size."""

import itertools

import numpy as np
from geometry import random_grid
from timing import cpu_seconds

from bezierplan.planners import node_genetic
from bezierplan.study import reading
from bezierplan.workspaces import files
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.ground import Ground, cheapest, ground_of, obstacles_met
from bezierplan.workspaces.ground import _ground as ground_tables
from bezierplan.workspaces.problem import Problem


def benchmark_node_genetic() -> None:
    """The proposed mutation of meledje on the maps of the study, and on random maps of growing
    size.

    Prepared once a map: the least energy of all paths, and up to `TABLE_CELLS` cells a table of all
    edges, whose size is printed.
    """
    study = reading.load(reading.read_config({"studies": ["meledje"]}))["meledje"]
    maps = {
        name: (
            files.load(study.workspaces[name].plain(), study.folder),
            study.problems[name].settings,
        )
        for name in list(study.problems)[:4]
    }
    maps |= {f"{side} x {side}": (_grid_in_the_way(side), {}) for side in (16, 32, 64, 128)}
    print(f"\n{'node_genetic':16}{'prepared in s':>16}{'ms a run':>12}{'MB of edges':>16}")
    for name, (grid, own) in maps.items():
        settings = study.resolved("proposed") | own
        problem = Problem(name, grid, grid.centre(0), grid.centre(grid.occupied.size - 1))
        ground = ground_of(grid, settings["friction"])
        prepared = cpu_seconds(lambda: _prepare(grid, settings["friction"]), rounds=1)  # noqa: B023
        runs = 20
        seconds = cpu_seconds(
            lambda: [
                node_genetic.plan(problem, np.random.default_rng(seed), **settings)  # noqa: B023
                for seed in range(runs)  # noqa: B023
            ]
        )
        megabytes = (ground.met.nbytes + ground.energy.nbytes) / 1e6
        print(f"  {name:14}{prepared:16.3f}{1000 * seconds / runs:12.2f}{megabytes:16.1f}")


def _grid_in_the_way(side: int) -> Grid:
    """A random grid whose corners do not see each other but are connected, so that there is
    something to search.
    """
    grids = (random_grid(side, np.random.default_rng(seed)) for seed in itertools.count(side))
    return next(grid for grid in grids if _has_work(ground_of(grid, 1.0), 0, side * side - 1))


def _has_work(ground: Ground, start: int, target: int) -> bool:
    return obstacles_met(ground, start, target) > 0 and cheapest(ground, start, target)[0] < np.inf


def _prepare(grid: Grid, friction: float) -> None:
    ground_tables.cache_clear()
    cheapest(ground_of(grid, friction), 0, grid.occupied.size - 1)
