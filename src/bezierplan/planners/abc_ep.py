"""Artificial bee colony and evolutionary programming (ABC-EP): the colony builds a path point by
point, evolution shortens it.

The baseline of that name in elhoseny2017 and tharwat2018 (Contreras-Cruz, Ayala-Ramirez and
Hernandez-Belmonte, 2015). Neither paper gives its parameters or operators; these are textbook ones.
A colony of bees searches for the next point of the path in a square around the last one; points
already chosen repel, which leads out of dead ends. The path is complete as soon as the target is in
sight. It is then shortened by dropping unnecessary points and by mutating a population of copies.

A leg is free if it touches no occupied cell. Lengths and points in the kernels are in cells.
"""

from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import is_free_leg
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.genetic import draw_parents
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import NOT_NEGATIVE, with_settings
from bezierplan.planners.parts.sorting import ascending

extra = ("first_length", "turns")
workspaces = ("grid",)
exact = True

# The cost of a point that cannot be seen from the last one: above all others, and the same for all
# such points.
_UNSEEN = 1e9
# Textbook values of the colony: sources, each with an employed and an onlooker bee; failed trials
# after which a source is redrawn; points chosen before the search is abandoned; and the weight of a
# point's distance from the last one, where that to the target has weight 1.
_SOURCES, _TRIAL_LIMIT, _MOST_POINTS, _STEP_WEIGHT = 20, 5, 200, 0.5
# Of evolution: shares of children in which an inner point moves by a Gaussian step, and of those
# without one of the inner points (the rest get a leg's midpoint); the standard deviation of a
# midpoint, as a share of that of a move; opponents drawn for each of parents and children, of whom
# those not worse than most of them survive; and what a leg that touches an occupied cell adds.
_MOVE_SHARE, _REMOVAL_SHARE, _INSERTION_SPREAD, _OPPONENTS, _BLOCKED = 0.6, 0.2, 0.3, 5, 1e6


class Settings(NamedTuple):
    """Settings of colony and evolution; the papers give none, these are textbook ones."""

    cycles: Annotated[int, NOT_NEGATIVE, About("cycles of the colony for one point")]
    reach: Annotated[
        float,
        Range(0, 1),
        About("half the side of the square around the last point, as a share of the smaller side"),
    ]
    visited_weight: Annotated[
        float,
        NOT_NEGATIVE,
        About("weight of cones around the points chosen so far, as high and wide as the reach"),
    ]
    population: Annotated[
        int, Range(1), About("copies of the path that evolve, each with one child a generation")
    ]
    generations: Annotated[int, NOT_NEGATIVE, About("generations")]
    spread: Annotated[
        float, NOT_NEGATIVE, About("standard deviation of a move, as a share of the smaller side")
    ]


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest polyline found.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its length in units, infinite if there is no path. Extra columns:
        first_length, the length of the path before evolution, in units; turns, the number of inner
        points of the final path.

    References
    ----------
    elhoseny2017, Tables 2, 3 and 6; tharwat2018, Figure 22; Contreras-Cruz, Ayala-Ramirez and
    Hernandez-Belmonte (2015).
    """
    grid = problem.workspace
    start, target = grid.in_cells(problem.ends)
    smaller_side = min(grid.occupied.shape) - 1  # between the centres of the outermost cells
    # One point cannot be shortened.
    if problem.start == problem.target:
        settings = settings._replace(generations=0)
    rules = settings._replace(
        reach=settings.reach * smaller_side, spread=settings.spread * smaller_side
    )
    colony, evolution = rng.spawn(2)
    path = _build_first_path(colony, grid.occupied, start, target, rules)
    if len(path) == 0:
        return Plan.of_one(None, np.inf, "no way", {"first_length": np.inf, "turns": 0})
    points, history = _evolve(evolution, grid.occupied, _cut_short(grid.occupied, path), rules)
    history *= grid.cell
    points = grid.in_units(points)
    points[[0, -1]] = problem.ends
    return Plan(
        path=Path("polyline", points),
        objective=history[-1],
        claimed_feasible=True,
        evaluations=1 + settings.population * settings.generations,
        history=history,
        stop="generations",
        extra={"first_length": float(history[0]), "turns": len(points) - 2},
    )


# --------------------------------------------------------------------------------------------------
# The colony


@compile_kernel
def _build_first_path(rng, occupied, start, target, rules):
    """Build a free path (points, 2), point by point until the target is in sight.

    It is empty if no free point is found or `_MOST_POINTS` do not suffice.
    """
    path = np.empty((_MOST_POINTS + 2, 2))
    path[0, 0], path[0, 1] = start  # an assignment of a whole row takes seconds to compile
    for count in range(1, _MOST_POINTS + 2):
        if is_free_leg(occupied, path[count - 1], target):
            path[count, 0], path[count, 1] = target
            return path[: count + 1].copy()
        if _append_next_point(rng, occupied, target, path, count, rules) >= _UNSEEN:
            break
    return np.empty((0, 2))


@compile_kernel
def _append_next_point(rng, occupied, target, path, count, rules):
    """Append the best point found to a path of `count` points, in place; return its cost."""
    low, high = np.empty(2), np.empty(2)
    for k in range(2):
        low[k] = max(0.5, path[count - 1, k] - rules.reach)
        high[k] = min(occupied.shape[1 - k] - 0.5, path[count - 1, k] + rules.reach)
    x, cost = np.empty((_SOURCES, 2)), np.empty(_SOURCES)
    failures = np.zeros(_SOURCES, np.int64)
    point = np.empty(2)
    best, best_cost = path[count], np.inf
    for i in range(_SOURCES):
        _draw(rng, low, high, x[i])
        cost[i] = _compute_cost(occupied, target, path, count, x[i], rules)

    for cycle in range(rules.cycles + 1):
        # The best point is recorded before its source can be redrawn.
        for i in range(_SOURCES):
            if cost[i] < best_cost:
                best[0], best[1] = x[i, 0], x[i, 1]
                best_cost = cost[i]
        if cycle == rules.cycles:
            break
        for i in range(_SOURCES):
            if failures[i] >= _TRIAL_LIMIT:  # a scout
                _draw(rng, low, high, x[i])
                cost[i] = _compute_cost(occupied, target, path, count, x[i], rules)
                failures[i] = 0
        # First each source's own bee, then the onlookers, who choose sources by their fitness.
        for turn in range(2):
            if turn == 1:
                onlooked = draw_parents(rng, 1.0 / (1.0 + cost), _SOURCES)
            for bee in range(_SOURCES):
                i = onlooked[bee] if turn == 1 else bee
                other = draw_integer(rng, 0, _SOURCES - 1)
                other += other >= i
                # A bee moves one coordinate only.
                k = draw_integer(rng, 0, 2)
                point[0], point[1] = x[i, 0], x[i, 1]
                point[k] += (2 * rng.random() - 1) * (x[i, k] - x[other, k])
                point[k] = min(max(point[k], low[k]), high[k])
                tried = _compute_cost(occupied, target, path, count, point, rules)
                if tried < cost[i]:
                    x[i, k] = point[k]
                    cost[i] = tried
                    failures[i] = 0
                else:
                    failures[i] += 1
    return best_cost


@allocation_free
def _draw(rng, low, high, point):
    """Draw a point uniformly from a box, in place."""
    for k in range(2):
        point[k] = low[k] + (high[k] - low[k]) * rng.random()


@allocation_free
def _compute_cost(occupied, target, path, count, point, rules):
    """Return the cost of the next point: the distance to it and from it to the target, and cones
    over the cells around the points chosen before.
    """
    if not is_free_leg(occupied, path[count - 1], point):
        return _UNSEEN
    height = 0.0
    # Cones are taken at the centre of a point's cell, so all points of a cell are repelled alike.
    cell = np.floor(point[0]) + 0.5, np.floor(point[1]) + 0.5
    for chosen in range(1, count):
        height += max(0.0, rules.reach - _measure_leg(path[chosen], cell))
    return (
        _STEP_WEIGHT * _measure_leg(path[count - 1], point)
        + _measure_leg(point, target)
        + rules.visited_weight * height
    )


@allocation_free
def _measure_leg(start, end):
    """Return the length of a leg between two points."""
    return np.sqrt((end[0] - start[0]) ** 2 + (end[1] - start[1]) ** 2)


@compile_kernel
def _cut_short(occupied, path):
    """Return a path without unnecessary points: each is joined to the last one that it sees."""
    kept = np.zeros(len(path), np.int64)
    count = 1
    while kept[count - 1] < len(path) - 1:
        here = kept[count - 1]
        seen = len(path) - 1
        while seen > here + 1 and not is_free_leg(occupied, path[here], path[seen]):
            seen -= 1
        kept[count] = seen
        count += 1
    return path[kept[:count]]


# --------------------------------------------------------------------------------------------------
# Evolution


@compile_kernel
def _evolve(rng, occupied, path, rules):
    """Return the cheapest path of the last generation (points, 2), and the lowest cost so far
    (generations + 1,).
    """
    population, generations = rules.population, rules.generations
    # A generation adds at most one point to a path.
    points = np.empty((2 * population, len(path) + generations, 2))
    counts = np.full(2 * population, len(path))
    # Parents first, starting with the cheapest; the other slots are for children.
    slots = np.arange(2 * population)
    for i in range(population):
        _copy(path, 0, len(path), points[i], 0)
    cost = np.full(2 * population, _price_path(occupied, path))
    history = np.empty(generations + 1)
    history[0] = cost[0]

    for generation in range(generations):
        for i in range(population):
            parent, child = slots[i], slots[population + i]
            counts[child] = _mutate(
                rng, occupied, points[parent, : counts[parent]], points[child], rules.spread
            )
            cost[child] = _price_path(occupied, points[child, : counts[child]])
        _rank(slots, _count_wins(rng, cost), cost)
        history[generation + 1] = cost[slots[0]]
    return points[slots[0], : counts[slots[0]]], history


@allocation_free
def _mutate(rng, occupied, points, child, spread):
    """Write a changed copy of a path into `child`, and return its number of points.

    An inner point is moved or dropped, or a midpoint is inserted.
    """
    kind, count = rng.random(), len(points)
    if count == 2 or kind >= _MOVE_SHARE + _REMOVAL_SHARE:
        # The child's new point; the parent's points after it move up by one.
        changed = draw_integer(rng, 1, count)
        kept, behind = changed, changed + 1
        for k in range(2):
            child[changed, k] = 0.5 * (points[changed - 1, k] + points[changed, k])
        _shift(rng, occupied, child[changed], spread * _INSERTION_SPREAD)
    else:
        changed = draw_integer(rng, 1, count - 1)
        kept = behind = changed + 1
        if kind < _MOVE_SHARE:
            _copy(points, changed, kept, child, changed)
            _shift(rng, occupied, child[changed], spread)
        else:
            behind = changed
    _copy(points, 0, changed, child, 0)
    _copy(points, kept, count, child, behind)
    return count + behind - kept


@allocation_free
def _copy(points, first, last, others, place):
    """Copy points first .. last - 1 to a place among others."""
    for p in range(first, last):
        for k in range(2):
            others[place + p - first, k] = points[p, k]


@allocation_free
def _shift(rng, occupied, point, spread):
    """Move a point by Gaussian steps, in place, within the centres of the outermost cells."""
    for k in range(2):
        side = occupied.shape[1 - k]
        point[k] = min(max(point[k] + spread * rng.standard_normal(), 0.5), side - 0.5)


@allocation_free
def _price_path(occupied, points):
    """Return the length of a path (points, 2), with a penalty for each blocked leg."""
    price = 0.0
    for p in range(len(points) - 1):
        start, end = points[p], points[p + 1]
        length = _measure_leg(start, end)
        price += length if is_free_leg(occupied, start, end) else length + _BLOCKED
    return price


@compile_kernel
def _count_wins(rng, cost):
    """Count, for each path (n,), the random opponents that it is not worse than."""
    wins = np.zeros(len(cost), np.int64)
    for i in range(len(cost)):
        for _ in range(_OPPONENTS):
            other = draw_integer(rng, 0, len(cost) - 1)
            other += other >= i
            wins[i] += cost[i] <= cost[other]
    return wins


@compile_kernel
def _rank(slots, wins, cost):
    """Sort slots in place, stably: most wins first, ties by lowest cost.

    The cheapest of all loses to none, so it comes first.
    """
    cheapest_first = slots[ascending(cost[slots])]
    order = ascending(-wins[cheapest_first])
    for k in range(len(slots)):
        slots[k] = cheapest_first[order[k]]
