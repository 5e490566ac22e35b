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
from bezierplan.kernels import allocation_free, compiled
from bezierplan.planners import About, Plan, Range
from bezierplan.planners.parts.genetic import roulette
from bezierplan.planners.parts.random_integers import integer
from bezierplan.planners.parts.settings import UNITS, in_cells, with_settings
from bezierplan.planners.parts.sorting import ascending
from bezierplan.workspaces.problem import Path, Problem

extra = ("first_length", "turns")
workspaces = ("grid",)
exact = True

# The cost of a point that cannot be seen from the last one: above all others, and the same for all
# such points.
_UNSEEN = 1e9


class Settings(NamedTuple):
    """Settings of colony and evolution; the papers give none, these are textbook ones."""

    sources: Annotated[
        int, Range(2), About("sources of the colony, each with an employed and an onlooker bee")
    ]
    cycles: Annotated[int, Range(0), About("cycles of the colony for one point")]
    trial_limit: Annotated[int, Range(1), About("failed trials after which a source is redrawn")]
    reach: Annotated[
        float,
        Range(0, 1),
        About("half the side of the square around the last point, as a share of the smaller side"),
    ]
    step_weight: Annotated[
        float,
        Range(0),
        About("weight of a point's distance from the last one; that to the target has weight 1"),
    ]
    visited_weight: Annotated[
        float,
        Range(0),
        About("weight of cones around the points chosen so far, as high and wide as the reach"),
    ]
    most_points: Annotated[int, Range(0), About("points chosen before the search is abandoned")]
    population: Annotated[
        int, Range(1), About("copies of the path that evolve, each with one child a generation")
    ]
    generations: Annotated[int, Range(0), About("generations")]
    move_share: Annotated[
        float,
        Range(0, 1),
        About("share of children in which an inner point moves by a Gaussian step"),
    ]
    removal_share: Annotated[
        float,
        Range(0, 1),
        About("share of children without one of the inner points; the rest get a leg's midpoint"),
    ]
    spread: Annotated[
        float, Range(0), About("standard deviation of a move, as a share of the smaller side")
    ]
    insertion_spread: Annotated[
        float, Range(0), About("standard deviation of a midpoint, as a share of the spread")
    ]
    opponents: Annotated[
        int,
        Range(1),
        About("drawn for each of parents and children; those not worse than most of them survive"),
    ]
    blocked_penalty: Annotated[
        float, Range(0), About("added for each leg that touches an occupied cell", unit=UNITS)
    ]


def check(settings: dict) -> None:
    """Rules across several settings. Raises ValueError naming the setting and what is expected."""
    shares = settings["move_share"] + settings["removal_share"]
    if shares > 1:
        raise ValueError(
            f"move_share: with removal_share {shares:g}; "
            "expected at most 1, the rest inserts points"
        )


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Shortest polyline found.

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
    start, target = grid.in_cells(np.array([problem.start, problem.target], dtype=float))
    smaller_side = min(grid.occupied.shape) - 1  # between the centres of the outermost cells
    if problem.start == problem.target:
        settings = settings._replace(generations=0)
    rules = in_cells(settings, grid.cell)._replace(
        reach=settings.reach * smaller_side, spread=settings.spread * smaller_side
    )
    points, history = _search(*rng.spawn(2), grid.occupied, start, target, rules)
    history *= grid.cell
    extra = {"first_length": float(history[0]), "turns": max(0, len(points) - 2)}
    if len(points) == 0:
        return Plan.of_one(None, np.inf, "no way", extra)
    points = grid.in_units(points)
    points[[0, -1]] = problem.start, problem.target
    evaluations = 1 + settings.population * settings.generations
    path = Path("polyline", points)
    return Plan(
        path,
        history[-1],
        claimed_feasible=True,
        evaluations=evaluations,
        history=history,
        stop="generations",
        extra=extra,
    )


@compiled
def _search(colony_rng, evolution_rng, occupied, start, target, rules):
    """Points (points, 2) of the path, if found, and the least length so far (generations + 1,)."""
    path = _first_path(colony_rng, occupied, start, target, rules)
    if len(path) == 0:
        return path, np.full(1, np.inf)
    return _evolve(evolution_rng, occupied, _cut_short(occupied, path), rules)


# --------------------------------------------------------------------------------------------------
# The colony


@compiled
def _first_path(rng, occupied, start, target, rules):
    """A free path (points, 2), point by point until the target is in sight; empty if no free point
    is found or most_points do not suffice.
    """
    path = np.empty((rules.most_points + 2, 2))
    path[0, 0], path[0, 1] = start  # an assignment of a whole row takes seconds to compile
    for count in range(1, rules.most_points + 2):
        last = path[count - 1]
        if is_free_leg(occupied, last[0], last[1], target[0], target[1]):
            path[count, 0], path[count, 1] = target
            return path[: count + 1].copy()
        if (
            count <= rules.most_points
            and _next_point(rng, occupied, target, path, count, rules) >= _UNSEEN
        ):
            break
    return np.empty((0, 2))


@compiled
def _next_point(rng, occupied, target, path, count, rules):
    """Append, in place, the best point found to the first `count` of a path. Returns its cost."""
    low, high = np.empty(2), np.empty(2)
    for k in range(2):
        low[k] = max(0.5, path[count - 1, k] - rules.reach)
        high[k] = min(occupied.shape[1 - k] - 0.5, path[count - 1, k] + rules.reach)
    sources = rules.sources
    x, cost, failed = np.empty((sources, 2)), np.empty(sources), np.zeros(sources, dtype=np.int64)
    point = np.empty(2)
    best, best_cost = path[count], np.inf
    for i in range(sources):
        _draw(rng, low, high, x[i])
        cost[i] = _cost(occupied, target, path, count, x[i], rules)

    for cycle in range(rules.cycles + 1):
        # The best point is recorded before its source can be redrawn.
        for i in range(sources):
            if cost[i] < best_cost:
                best[0], best[1] = x[i, 0], x[i, 1]
                best_cost = cost[i]
        if cycle == rules.cycles:
            break
        for i in range(sources):
            if failed[i] >= rules.trial_limit:  # a scout
                _draw(rng, low, high, x[i])
                cost[i] = _cost(occupied, target, path, count, x[i], rules)
                failed[i] = 0
        for turn in range(2):
            if turn == 1:
                onlooked = roulette(rng, 1.0 / (1.0 + cost), sources)
            for bee in range(sources):
                i = onlooked[bee] if turn == 1 else bee
                other = integer(rng, 0, sources - 1)
                other += other >= i
                k = integer(rng, 0, 2)
                point[0], point[1] = x[i, 0], x[i, 1]
                point[k] += (2 * rng.random() - 1) * (x[i, k] - x[other, k])
                point[k] = min(max(point[k], low[k]), high[k])
                tried = _cost(occupied, target, path, count, point, rules)
                if tried < cost[i]:
                    x[i, k] = point[k]
                    cost[i] = tried
                    failed[i] = 0
                else:
                    failed[i] += 1
    return best_cost


@allocation_free
def _draw(rng, low, high, point):
    """A random point of a box, in place."""
    for k in range(2):
        point[k] = low[k] + (high[k] - low[k]) * rng.random()


@allocation_free
def _cost(occupied, target, path, count, point, rules):
    """Cost of the next point: the distance to it, the distance from it to the target, and cones
    over the cells around the points chosen before.
    """
    last = path[count - 1]
    if not is_free_leg(occupied, last[0], last[1], point[0], point[1]):
        return _UNSEEN
    height = 0.0
    column, row = np.floor(point[0]) + 0.5, np.floor(point[1]) + 0.5
    for chosen in range(1, count):
        height += max(0.0, rules.reach - _length(path[chosen, 0], path[chosen, 1], column, row))
    return (
        rules.step_weight * _length(last[0], last[1], point[0], point[1])
        + _length(point[0], point[1], target[0], target[1])
        + rules.visited_weight * height
    )


@allocation_free
def _length(x0, y0, x1, y1):
    return np.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)


@compiled
def _cut_short(occupied, path):
    """A path without unnecessary points: each point is joined to the last one that it sees."""
    kept = np.zeros(len(path), dtype=np.int64)
    count = 1
    while kept[count - 1] < len(path) - 1:
        here = kept[count - 1]
        seen = len(path) - 1
        while seen > here + 1 and not is_free_leg(
            occupied, path[here, 0], path[here, 1], path[seen, 0], path[seen, 1]
        ):
            seen -= 1
        kept[count] = seen
        count += 1
    return path[kept[:count]]


# --------------------------------------------------------------------------------------------------
# Evolution


@compiled
def _evolve(rng, occupied, path, rules):
    """The cheapest path of the last generation (points, 2), and the lowest cost so far (generations
    + 1,).

    Every path keeps the lengths of its legs, plus the penalty where they are blocked: a mutation
    changes at most two of them.
    """
    population, generations = rules.population, rules.generations
    room = len(path) + generations
    points, legs = np.empty((2 * population, room, 2)), np.empty((2 * population, room))
    counts, cost = np.full(2 * population, len(path)), np.empty(2 * population)
    # Parents first, starting with the cheapest; the other slots are for children.
    slots = np.arange(2 * population)
    for i in range(population):
        for p in range(len(path)):
            points[i, p, 0], points[i, p, 1] = path[p, 0], path[p, 1]
        for p in range(len(path) - 1):
            legs[i, p] = _leg(occupied, points[i], p, rules.blocked_penalty)
        cost[i] = legs[i, : len(path) - 1].sum()
    history = np.empty(generations + 1)
    history[0] = cost[0]

    for generation in range(generations):
        for i in range(population):
            parent, child = slots[i], slots[population + i]
            counts[child] = _mutated(
                rng,
                occupied,
                points[parent],
                legs[parent],
                counts[parent],
                points[child],
                legs[child],
                rules,
            )
            cost[child] = legs[child, : counts[child] - 1].sum()
        _rank(slots, _wins(rng, cost, rules.opponents), cost)
        history[generation + 1] = cost[slots[0]]
    return points[slots[0], : counts[slots[0]]], history


@allocation_free
def _mutated(rng, occupied, points, legs, count, child, child_legs, rules):
    """Make a child of a path, in place: an inner point is moved or dropped, or a midpoint is
    inserted. Returns the child's number of points.
    """
    kind = rng.random()
    if count == 2 or kind >= rules.move_share + rules.removal_share:
        # The child's new point; the parent's points after it move up by one.
        changed = integer(rng, 1, count)
        kept = changed
        for k in range(2):
            child[changed, k] = 0.5 * (points[changed - 1, k] + points[changed, k])
        _shift(rng, occupied, child[changed], rules.spread * rules.insertion_spread)
        behind = changed + 1
    elif kind < rules.move_share:
        changed = integer(rng, 1, count - 1)
        kept = changed + 1
        for k in range(2):
            child[changed, k] = points[changed, k]
        _shift(rng, occupied, child[changed], rules.spread)
        behind = changed + 1
    else:
        changed = integer(rng, 1, count - 1)
        kept = changed + 1
        behind = changed
    for p in range(changed):
        child[p, 0], child[p, 1] = points[p, 0], points[p, 1]
        child_legs[p] = legs[p]
    for p in range(kept, count):
        child[p + behind - kept, 0], child[p + behind - kept, 1] = points[p, 0], points[p, 1]
        child_legs[p + behind - kept] = legs[p]
    for p in range(changed - 1, behind):
        child_legs[p] = _leg(occupied, child, p, rules.blocked_penalty)
    return count + behind - kept


@allocation_free
def _shift(rng, occupied, point, spread):
    """Move a point by Gaussian steps, in place, within the centres of the outermost cells."""
    for k in range(2):
        side = occupied.shape[1 - k]
        point[k] = min(max(point[k] + spread * rng.standard_normal(), 0.5), side - 0.5)


@allocation_free
def _leg(occupied, points, p, blocked_penalty):
    """Length of the leg after point p, plus the penalty if it is blocked."""
    x0, y0 = points[p, 0], points[p, 1]
    x1, y1 = points[p + 1, 0], points[p + 1, 1]
    length = _length(x0, y0, x1, y1)
    return length if is_free_leg(occupied, x0, y0, x1, y1) else length + blocked_penalty


@compiled
def _wins(rng, cost, opponents):
    """For each path (n,), the number of random opponents that it is not worse than."""
    wins = np.zeros(len(cost), dtype=np.int64)
    for i in range(len(cost)):
        for _ in range(opponents):
            other = integer(rng, 0, len(cost) - 1)
            other += other >= i
            wins[i] += cost[i] <= cost[other]
    return wins


@compiled
def _rank(slots, wins, cost):
    """Sort slots in place, stably: most wins first, ties by lowest cost. The cheapest of all loses
    to none, so it comes first.
    """
    cheapest_first = slots[ascending(cost[slots])]
    order = ascending(-wins[cheapest_first])
    for k in range(len(slots)):
        slots[k] = cheapest_first[order[k]]
