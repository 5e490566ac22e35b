"""Bounds that no robot can beat, whatever it knows of the future of its world."""

from dataclasses import replace

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells, World


def find_least_way(world: World, problem: Problem) -> shortest_paths.Bound:
    """Return the shortest way through places that are free at some time: no robot's way is
    shorter.
    """
    if isinstance(world, ChangingCells):
        always = np.all([each.occupied for each in world.maps], axis=0)
        return shortest_paths.shortest_path(
            problem._replace(workspace=replace(world.maps[0], occupied=always))
        )
    # A robot can wait until a moving circle has passed, so only those that stand still count.
    still = ~world.velocities.any(axis=1)
    stays = Circles(world.bounds, world.centres[still], world.radii[still], world.unit)
    return shortest_paths.shortest_path(problem._replace(workspace=stays))


def bound_arrival(world: World, problem: Problem) -> float:
    """Return a time, in steps, before which no robot arrives: the least way at the world's pace.

    Where the map changes once, and no robot can reach a changing cell before the change, the whole
    way is free on the second map: then the shortest path there is the exact earliest arrival.
    """
    if isinstance(world, ChangingCells) and len(world.maps) == 2:
        first, second = world.maps
        rows, columns = np.nonzero(first.occupied != second.occupied)
        start = first.in_cells(np.array([problem.start]))
        low = np.column_stack([columns, rows])
        away = np.hypot(*np.maximum(np.maximum(low - start, start - low - 1), 0.0).T)
        if away.min(initial=np.inf) * first.cell >= world.moments[0] * world.pace:
            return (
                shortest_paths.shortest_path(problem._replace(workspace=second)).length / world.pace
            )
    return find_least_way(world, problem).length / world.pace
