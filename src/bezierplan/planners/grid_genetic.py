"""Genetic algorithm over paths of cells: a chromosome is a path of neighbouring free cells (the
competing GA of elhoseny2017).

The baseline called GA in Tables 2, 3 and 6 of elhoseny2017 (Alajlan et al., 2013), which gives no
parameters or operators; these are common ones. First paths are greedy walks through random cells. A
crossover joins the head of one path and the tail of another at a shared cell; a mutation makes a
new walk between two cells of a path. Loops are removed from every path.

A cell has eight neighbours; a diagonal step may pass between two occupied cells. In the kernels a
cell is its index in the grid with a frame of occupied cells around it, so that no step leaves the
grid. Costs in the kernels are in cells.
"""

from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compiled
from bezierplan.planners import About, Plan, Range
from bezierplan.planners.parts.cell_paths import put
from bezierplan.planners.parts.genetic import roulette
from bezierplan.planners.parts.random_integers import integer
from bezierplan.planners.parts.settings import with_settings
from bezierplan.planners.parts.sorting import ascending
from bezierplan.workspaces.problem import Path, Problem

extra = ("first_walks",)
workspaces = ("grid",)
exact = True

# Steps of column and row to the eight neighbours, straight ones first.
_COLUMN_STEPS = (1, 0, -1, 0, 1, -1, -1, 1)
_ROW_STEPS = (0, 1, 0, -1, 1, 1, -1, -1)

# First walks tried for each chromosome; missing ones are copies of those found.
_ATTEMPTS = 40
# Steps after which a walk is abandoned, as a multiple of rows + columns.
_LONGEST_WALK = 6
# Where no free neighbour is nearer to the goal: fewest random steps, most of them as a share of the
# columns, and the probability that a random step keeps the direction, if that cell is free.
_LEAST_DETOUR, _DETOUR_SHARE, _STRAIGHT_ON = 3, 0.125, 0.8


class Settings(NamedTuple):
    """Settings of the search; elhoseny2017 names the method and gives one of them."""

    population: Annotated[int, Range(2), About("paths of a generation")]
    generations: Annotated[int, Range(0), About("generations after the first")]
    crossover_probability: Annotated[float, Range(0, 1), About("of a pair of parents")]
    mutation_probability: Annotated[float, Range(0, 1), About("of a child")]
    diagonal_cost: Annotated[
        float,
        Range(1, 2),
        About("of a diagonal step; a straight one costs 1", "elhoseny2017, Section 4.6", "cells"),
    ]
    random_step: Annotated[
        float,
        Range(0, 1),
        About("probability that a step of a walk is random where some cell is nearer to the goal"),
    ]


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Cheapest path of cells found, a polyline through their centres.

    A walk goes to the free neighbour nearest to its goal, but for random steps. The best of parents
    and children survive.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its cost in units, infinite if there is no path. Extra column: first_walks,
        the number of first paths found.

    References
    ----------
    elhoseny2017, Tables 2, 3 and 6.
    """
    grid = problem.workspace
    walls = np.pad(grid.occupied, 1, constant_values=True)
    ends = grid.in_cells(np.array([problem.start, problem.target], dtype=float))
    (start_column, target_column), (start_row, target_row) = (
        np.minimum(ends.astype(int), np.array(grid.occupied.shape[::-1]) - 1).T + 1
    )
    rows, columns = grid.occupied.shape
    walker = _Walker(
        walls=walls.ravel(),
        columns=walls.shape[1],
        longest_walk=_LONGEST_WALK * (rows + columns),
        most_detour=max(_LEAST_DETOUR, _LEAST_DETOUR - 1 + int(_DETOUR_SHARE * columns)),
        random_step=settings.random_step,
    )
    if problem.start == problem.target:
        settings = settings._replace(generations=0)
    start = start_row * walls.shape[1] + start_column
    target = target_row * walls.shape[1] + target_column
    cells, found, history = _search(*rng.spawn(2), walker, start, target, settings)
    history *= grid.cell
    extra = {"first_walks": int(found)}
    if found == 0:
        return Plan.of_one(None, np.inf, "no way", extra)
    row, column = np.divmod(cells, walls.shape[1])
    centres = grid.in_units(np.column_stack([column, row]) - 0.5)
    return Plan(
        path=Path("polyline", _through(problem, centres[_turns(column, row)])),
        objective=history[-1],
        claimed_feasible=True,
        evaluations=settings.population * len(history),
        history=history,
        stop="generations",
        extra=extra,
    )


def _turns(column: np.ndarray, row: np.ndarray) -> np.ndarray:
    """Whether (n,) a cell of a path is its first, its last, or one where the direction changes."""
    steps = np.column_stack([np.diff(column), np.diff(row)])
    inner = (steps[1:] != steps[:-1]).any(axis=1)
    return np.concatenate([[True], inner, [True]])[-len(column) :]


def _through(problem: Problem, centres: np.ndarray) -> np.ndarray:
    """Points from start to target, which lie in the first and last cell, through cells' centres."""
    points = [problem.start, *centres.tolist(), problem.target]
    # An end that coincides with a centre, up to rounding, replaces it.
    first, last = (
        np.allclose(points[i], points[j], rtol=0, atol=1e-9 * problem.workspace.cell)
        for i, j in ((0, 1), (-1, -2))
    )
    del points[1 : 1 + first]
    if last and len(points) > 2:
        del points[-2]
    return np.array(points)


class _Walker(NamedTuple):
    """What a walk depends on. walls: bool (cells,), the framed grid row by row; columns: of the
    framed grid. longest_walk: in steps; most_detour: steps of a detour, inclusive.
    """

    walls: np.ndarray
    columns: int
    longest_walk: int
    most_detour: int
    random_step: float


@compiled
def _search(walks_rng, moves_rng, walker, start, target, rules):
    """Cells (n,) of the cheapest path, the number of first walks found, and the lowest cost so far
    (generations + 1,).
    """
    size, columns, population = len(walker.walls), walker.columns, rules.population
    # A path visits a cell once; before its loops are removed, a child consists of at most two paths
    # and a walk.
    walk = np.empty(2 * size + 2 * walker.longest_walk + 2, dtype=np.int64)
    last_visit = np.empty(size, dtype=np.int64)
    index, common = np.full(size, -1), np.empty(size, dtype=np.int64)

    paths, costs = _first_walks(walks_rng, walker, start, target, rules, walk, last_visit)
    founders = len(paths)
    if founders == 0:
        return np.empty(0, dtype=np.int64), founders, np.full(1, np.inf)
    for i in range(founders, population):
        paths.append(paths[i % founders])
        costs[i] = costs[i % founders]
    paths, costs = _best(paths, costs, population)
    history = np.empty(rules.generations + 1)
    history[0] = costs[0]

    for generation in range(rules.generations):
        drawn = roulette(moves_rng, 1.0 / costs[:population], 2 * population)
        for i in range(population):
            head, tail = paths[drawn[2 * i]], paths[drawn[2 * i + 1]]
            count = 0
            if moves_rng.random() < rules.crossover_probability:
                count = _join(moves_rng, head, tail, index, common, walk)
            if count == 0:
                count = put(head, walk, 0)
            count = _cut_loops(walk, count, last_visit)
            if moves_rng.random() < rules.mutation_probability and count > 1:
                count = _walk_anew(moves_rng, walker, walk, count, last_visit)
            paths.append(walk[:count].copy())
            costs[population + i] = _cost(walk, count, columns, rules.diagonal_cost)
        paths, costs = _best(paths, costs, population)
        history[generation + 1] = costs[0]
    return paths[0], founders, history


@compiled
def _best(paths, costs, population):
    """The cheapest paths in ascending order of cost, ties in their original order; and their costs
    (2 population,), with room for children.
    """
    order = ascending(costs[: len(paths)])
    best = np.empty(2 * population)
    for k in range(population):
        best[k] = costs[order[k]]
    return [paths[order[k]] for k in range(population)], best


@compiled
def _first_walks(rng, walker, start, target, rules, walk, last_visit):
    """Up to `population` paths, and their costs (2 population,): the first one directly to the
    target, the others through a free cell.
    """
    paths = [walk[:0]]
    paths.clear()
    costs = np.empty(2 * rules.population)
    for attempt in range(_ATTEMPTS * rules.population):
        if len(paths) == rules.population:
            break
        walk[0] = start
        count = 1
        if attempt > 0:
            way = integer(rng, 0, len(walker.walls))
            while walker.walls[way]:
                way = integer(rng, 0, len(walker.walls))
            count = _extend(rng, walker, walk, count, way)
        if count > 0:
            count = _extend(rng, walker, walk, count, target)
        if count > 0:
            count = _cut_loops(walk, count, last_visit)
            costs[len(paths)] = _cost(walk, count, walker.columns, rules.diagonal_cost)
            paths.append(walk[:count].copy())
    return paths, costs


@allocation_free
def _extend(rng, walker, walk, count, goal):
    """Continue a walk of `count` cells to a goal, in place. Returns the new number of cells, or 0
    if the walk becomes too long or cannot move.
    """
    walls, columns = walker.walls, walker.columns
    end = count + walker.longest_walk
    goal_row, goal_column = goal // columns, goal % columns
    cell = walk[count - 1]
    row, column = cell // columns, cell % columns
    step = -1  # the last step taken
    detour = 0
    while cell != goal:
        if count == end:
            return 0
        if detour == 0 and walker.random_step > 0 and rng.random() < walker.random_step:
            detour, step = 1, -1
        if detour == 0:
            nearest = (goal_row - row) ** 2 + (goal_column - column) ** 2
            nearer = -1
            for k in range(8):
                distance = (goal_row - row - _ROW_STEPS[k]) ** 2 + (
                    goal_column - column - _COLUMN_STEPS[k]
                ) ** 2
                if (
                    distance < nearest
                    and not walls[cell + _ROW_STEPS[k] * columns + _COLUMN_STEPS[k]]
                ):
                    nearest = distance
                    nearer = k
            if nearer < 0:
                detour = integer(rng, _LEAST_DETOUR, walker.most_detour + 1)
            else:
                step = nearer
        if detour > 0:
            detour -= 1
            blocked = step < 0 or walls[cell + _ROW_STEPS[step] * columns + _COLUMN_STEPS[step]]
            if blocked or rng.random() >= _STRAIGHT_ON:
                step = _random_step(rng, walls, columns, cell)
                if step < 0:
                    return 0
        row += _ROW_STEPS[step]
        column += _COLUMN_STEPS[step]
        cell = row * columns + column
        walk[count] = cell
        count += 1
    return count


@allocation_free
def _random_step(rng, walls, columns, cell):
    """A random step to a free neighbour of a cell, -1 if it has none."""
    free = 0
    for k in range(8):
        free += not walls[cell + _ROW_STEPS[k] * columns + _COLUMN_STEPS[k]]
    if free == 0:
        return -1
    left = integer(rng, 0, free)
    step = -1
    while left >= 0:
        step += 1
        left -= not walls[cell + _ROW_STEPS[step] * columns + _COLUMN_STEPS[step]]
    return step


@allocation_free
def _cut_loops(walk, count, last_visit):
    """Remove the loops of a walk, in place: after each cell it continues as after its last visit
    there. Returns the remaining number of cells.
    """
    for k in range(count):
        last_visit[walk[k]] = k
    kept = 0
    k = 0
    while k < count:
        walk[kept] = walk[k]
        k = last_visit[walk[k]] + 1
        kept += 1
    return kept


@allocation_free
def _join(rng, head, tail, index, common, walk):
    """Write the head of one path and the tail of another, joined at a random inner cell of both.
    Returns its length, or 0 if there is no such cell.

    index: (cells,) scratch, all -1 before and after.
    """
    for k in range(1, len(head) - 1):
        index[head[k]] = k
    shared = 0
    for k in range(1, len(tail) - 1):
        if index[tail[k]] >= 0:
            common[shared] = k
            shared += 1
    count = 0
    if shared > 0:
        cut = common[integer(rng, 0, shared)]
        count = put(head[: index[tail[cut]]], walk, 0)
        count = put(tail[cut:], walk, count)
    for k in range(1, len(head) - 1):
        index[head[k]] = -1
    return count


@allocation_free
def _walk_anew(rng, walker, path, count, last_visit):
    """Replace the section between two random cells of a path by a new walk, in place; a failed walk
    changes nothing.
    """
    one = integer(rng, 0, count)
    other = integer(rng, 0, count - 1)
    other += other >= one
    first, last = min(one, other), max(one, other)
    # The new walk is written after the path, followed by the path's tail; then both are moved
    # forward.
    path[count] = path[first]
    end = _extend(rng, walker, path, count + 1, path[last])
    if end == 0:
        return count
    end = put(path[last + 1 : count], path, end)
    return _cut_loops(path, put(path[count + 1 : end], path, first + 1), last_visit)


@allocation_free
def _cost(path, count, columns, diagonal_cost):
    """Cost of a path of `count` cells."""
    diagonal = 0
    for k in range(count - 1):
        step = abs(path[k + 1] - path[k])
        diagonal += step != 1 and step != columns
    return count - 1 - diagonal + diagonal_cost * diagonal
