"""Mutation operators for paths from cell to cell (meledje, Section 3).

Each changes one inner node of a path in place and keeps the number of nodes.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_inline
from bezierplan.planners.parts.random_integers import draw_below
from bezierplan.workspaces.ground import (
    Ground,
    compute_edge_energy,
    count_obstacles_along,
    count_obstacles_on,
    list_free_neighbours,
)

Mutation = IntEnum("Mutation", "random random_repair ref12 ref21 proposed", start=0)
WithoutObstacle = IntEnum("WithoutObstacle", "any_node none", start=0)
ObstacleNode = IntEnum("ObstacleNode", "edge neighbour", start=0)

# Number of times random mutation is repeated to obtain a feasible path.
_MOST_REPAIRS = 50
# Smaller differences between the energies of two neighbours of a node are rounding errors.
_TIE = 1e-12


@allocation_free
def mutate(
    rng: np.random.Generator,
    path: np.ndarray,
    alleles: np.ndarray,
    ground: Ground,
    rules: NamedTuple,
    neighbours: np.ndarray,
) -> int:
    """Apply the operator once to a path of cells (n,), n at least 3, in place; return how many
    neighbour cells it compared.

    alleles: cells for random mutation.
    rules: `node_genetic.Settings`.
    neighbours: (MOST_NEIGHBOURS,) scratch.
    """
    if rules.mutation == Mutation.random:
        path[1 + draw_below(rng, len(path) - 2)] = alleles[draw_below(rng, len(alleles))]
        return 0
    if rules.mutation == Mutation.random_repair:
        return _mutate_until_feasible(rng, path, alleles, ground)
    if rules.mutation == Mutation.ref21:
        return _mutate_as_reference_21(rng, path, ground, rules, neighbours)
    k = 0
    if rules.mutation == Mutation.proposed:
        k = _draw_place_at_obstacle(
            rng, path, ground, rules.obstacle_node == ObstacleNode.neighbour
        )
        if k == 0 and rules.without_obstacle == WithoutObstacle.none:
            return 0
    if k == 0:
        k = 1 + draw_below(rng, len(path) - 2)
    return _move_to_best_neighbour(path, k, ground, rules, neighbours)


@allocation_free
def _mutate_until_feasible(rng, path, alleles, ground):
    """Try random mutations of the path, at most `_MOST_REPAIRS`, and keep the first that makes it
    feasible.
    """
    for _ in range(_MOST_REPAIRS):
        k = 1 + draw_below(rng, len(path) - 2)
        before = path[k]
        path[k] = alleles[draw_below(rng, len(alleles))]
        if count_obstacles_along(path, ground) == 0:
            return 0
        path[k] = before
    return 0


@allocation_free
def _draw_place_at_obstacle(rng, path, ground, beside_obstacle):
    """Draw the place in the path of an inner node whose edge to the next node meets an obstacle, 0
    if there is none (Table 1, step 1).

    beside_obstacle: instead, of a node with an occupied cell at or around it.
    """
    count = 0
    for k in range(1, len(path) - 1):
        count += _has_obstacle(path, k, ground, beside_obstacle)
    if count == 0:
        return 0
    chosen = draw_below(rng, count)
    for k in range(1, len(path) - 1):
        if _has_obstacle(path, k, ground, beside_obstacle):
            if chosen == 0:
                return k
            chosen -= 1
    return 0


@allocation_free
def _has_obstacle(path, k, ground, beside_obstacle):
    """Tell whether the edge from node k to the next one meets an obstacle or, with
    `beside_obstacle`, whether the node's cell or one of the eight around it is occupied.
    """
    if not beside_obstacle:
        return count_obstacles_on(ground, path[k], path[k + 1]) > 0
    row, column = divmod(path[k], ground.occupied.shape[1])
    return ground.occupied[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2].any()


@allocation_free
def _move_to_best_neighbour(path, k, ground, rules, neighbours):
    """Move node k to the free neighbour cell with the least cost, unless `keep_better` holds and
    none is better, and return how many were compared (Table 1, steps 2 to 4; reference 12).

    Ties go to the first from the lower left, row by row. Only the two edges of the node change.
    """
    count = list_free_neighbours(path[k], ground, rules.neighbourhood, neighbours)
    best, least = path[k], np.inf
    if rules.keep_better:
        least = _compute_cost_through(path, k, path[k], ground, rules.penalty)
    for cell in neighbours[:count]:
        cost = _compute_cost_through(path, k, cell, ground, rules.penalty)
        if cost < least - _TIE:
            best, least = cell, cost
    path[k] = best
    return count


@compile_inline
def _compute_cost_through(path, k, cell, ground, penalty):
    """Return the energy plus penalty of the two edges that node k would have in the given cell."""
    encounters = count_obstacles_on(ground, path[k - 1], cell) + count_obstacles_on(
        ground, cell, path[k + 1]
    )
    return (
        compute_edge_energy(ground, path[k - 1], cell)
        + compute_edge_energy(ground, cell, path[k + 1])
        + penalty * encounters
    )


@allocation_free
def _mutate_as_reference_21(rng, path, ground, rules, neighbours):
    """Move a random inner node to a free neighbour cell towards the target with two free edges, the
    first found in random order, if there is one (reference 21).

    Returns how many it tried.
    """
    k = 1 + draw_below(rng, len(path) - 2)
    count = list_free_neighbours(path[k], ground, rules.neighbourhood, neighbours)
    for tried in range(count):
        # The next of a random order is drawn only when it is needed.
        chosen = tried + draw_below(rng, count - tried)
        neighbours[tried], neighbours[chosen] = neighbours[chosen], neighbours[tried]
        cell = neighbours[tried]
        if (
            _is_towards(path[0], cell, path[-1], ground.occupied.shape[1])
            and count_obstacles_on(ground, path[k - 1], cell) == 0
            and count_obstacles_on(ground, cell, path[k + 1]) == 0
        ):
            path[k] = cell
            return tried + 1
    return count


@allocation_free
def _is_towards(start, cell, target, columns):
    """Tell whether a cell's direction to the target makes less than a right angle with that from
    the start to the target.
    """
    across, up = target % columns - cell % columns, target // columns - cell // columns
    whole_across = target % columns - start % columns
    whole_up = target // columns - start // columns
    return across * whole_across + up * whole_up > 0
