"""Genetic algorithm over paths of cells: a chromosome is a path of neighbouring free cells (the
competing GA of elhoseny2017).

The baseline called GA in Tables 2, 3 and 6 of elhoseny2017 (Alajlan et al., 2013), which gives no
parameters or operators; these are common ones. First paths are greedy walks through random cells,
which step back out of dead ends. A crossover joins the head of one path and the tail of another at
a shared cell; a mutation makes a new walk between two cells of a path. Loops are removed from every
path.

A cell has eight neighbours; a diagonal step may pass between two occupied cells. In the kernels a
cell is its index in the grid with a frame of occupied cells around it, so that no step leaves the
grid. Costs in the kernels are in cells.
"""

from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.cell_paths import cut_loops, draw_common_cell, put
from bezierplan.planners.parts.genetic import draw_parents
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import SHARE, with_settings
from bezierplan.planners.parts.sorting import ascending
from bezierplan.workspaces.grid import add_wall
from bezierplan.workspaces.lattice import drop_straight_vertices

workspaces = ("grid",)
exact = True

# Steps of column and row to the eight neighbours, straight ones first.
_COLUMN_STEPS = (1, 0, -1, 0, 1, -1, -1, 1)
_ROW_STEPS = (0, 1, 0, -1, 1, 1, -1, -1)


class Settings(NamedTuple):
    """Settings of the search; elhoseny2017 names the method and gives one of them."""

    population: Annotated[int, Range(2), About("paths of a generation")]
    generations: Annotated[int, Range(0), About("generations after the first")]
    crossover_probability: Annotated[float, SHARE, About("of a pair of parents")]
    mutation_probability: Annotated[float, SHARE, About("of a child")]
    diagonal_cost: Annotated[
        float,
        Range(1, 2),
        About("of a diagonal step; a straight one costs 1", "elhoseny2017, Section 4.6", "cells"),
    ]
    random_step: Annotated[
        float,
        SHARE,
        About("probability that a step of a walk is random where some cell is nearer to the goal"),
    ]


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the cheapest path of cells found, a polyline through their centres.

    A walk goes to that free neighbour which it has not visited and which is nearest to its goal,
    but for random steps; where there is none it steps back. The best of parents and children
    survive.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its cost in units, infinite if there is no path.

    References
    ----------
    elhoseny2017, Tables 2, 3 and 6.
    """
    grid = problem.workspace
    walls = add_wall(grid.occupied)
    ends = grid.in_cells(problem.ends)
    # An end on the upper or right border lies in the last cell; the frame shifts all by one.
    column, row = np.minimum(ends.astype(int), np.array(grid.occupied.shape[::-1]) - 1).T + 1
    if problem.start == problem.target:
        settings = settings._replace(generations=0)
    start, target = row * walls.shape[1] + column
    cells, history = _search(*rng.spawn(2), walls.ravel(), walls.shape[1], start, target, settings)
    history *= grid.cell
    if len(cells) == 0:
        return Plan.of_one(None, np.inf, "no way")
    row, column = np.divmod(cells, walls.shape[1])
    centres = grid.in_units(drop_straight_vertices(np.column_stack([column, row]) - 0.5))
    return Plan(
        path=Path("polyline", _join_through_centres(problem, centres)),
        objective=history[-1],
        claimed_feasible=True,
        evaluations=settings.population * len(history),
        history=history,
        stop="generations",
        extra={},
    )


def _join_through_centres(problem: Problem, centres: np.ndarray) -> np.ndarray:
    """Join start and target, which lie in the first and last cell, through cells' centres."""
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
    """Rules and state of walks, and scratch.

    walls: bool (cells,), the framed grid row by row.
    columns: number of the framed grid's columns.
    visits: (cells,) the number of the last walk that visited a cell, or of all walks for cell 0,
        which is a wall.
    marks: (cells,) scratch of operators on paths, all 0 between them.
    """

    walls: np.ndarray
    columns: int
    random_step: float
    visits: np.ndarray
    marks: np.ndarray


@compile_kernel
def _search(walks_rng, moves_rng, walls, columns, start, target, rules):
    """Return the cells (n,) of the cheapest path, none if there is no way, and the lowest cost so
    far (generations + 1,).
    """
    size, population = len(walls), rules.population
    walker = _Walker(
        walls, columns, rules.random_step, np.zeros(size, np.int64), np.zeros(size, np.int64)
    )
    # A path or a walk visits a cell once; before its loops are removed, a child consists of at most
    # two paths and a walk.
    walk = np.empty(3 * size, np.int64)

    paths, costs = _draw_first_walks(walks_rng, walker, start, target, rules, walk)
    if len(paths) == 0:
        return np.empty(0, np.int64), np.full(1, np.inf)
    # In order from the beginning on: the first path is always the cheapest.
    paths, costs = _select_best(paths, costs, population)
    history = np.empty(rules.generations + 1)
    history[0] = costs[0]

    for generation in range(rules.generations):
        # All parents in one call, which sums up the wheel once.
        drawn = draw_parents(moves_rng, 1.0 / costs[:population], 2 * population)
        for i in range(population):
            head, tail = paths[drawn[2 * i]], paths[drawn[2 * i + 1]]
            k = m = 0
            if moves_rng.random() < rules.crossover_probability:
                k, m = draw_common_cell(moves_rng, tail, head, walker.marks)
            if k == 0:
                # Without a shared cell the child is the first parent.
                k, m = len(tail), len(head)
            count = put(tail[k:], walk, put(head[:m], walk, 0))
            count = cut_loops(walk[:count], walker.marks)
            if moves_rng.random() < rules.mutation_probability and count > 1:
                count = _walk_anew(moves_rng, walker, walk, count)
            paths.append(walk[:count].copy())
            costs[population + i] = _measure_path(walk, count, columns, rules.diagonal_cost)
        paths, costs = _select_best(paths, costs, population)
        history[generation + 1] = costs[0]
    return paths[0], history


@compile_kernel
def _select_best(paths, costs, population):
    """Return the cheapest paths in ascending order of cost, ties in their original order, and their
    costs.

    The costs are (2 population,), with room for children.
    """
    order = ascending(costs[: len(paths)])
    best = np.empty(2 * population)
    for k in range(population):
        best[k] = costs[order[k]]
    return [paths[order[k]] for k in range(population)], best


@compile_kernel
def _draw_first_walks(rng, walker, start, target, rules, walk):
    """Return `population` paths, and their costs (2 population,).

    The first one leads directly to the target, the others through a free cell that can be reached;
    there are none if the target cannot be reached.
    """
    # The compiler needs an element to know the list's type.
    paths = [walk[:0]]
    paths.clear()
    costs = np.empty(2 * rules.population)
    while len(paths) < rules.population:
        walk[0], count = start, 1
        if len(paths) > 0:
            way = draw_integer(rng, 0, len(walker.walls))
            while walker.walls[way]:
                way = draw_integer(rng, 0, len(walker.walls))
            count = _extend(rng, walker, walk, 1, way)
        if count > 0:
            count = _extend(rng, walker, walk, count, target)
        if count > 0:
            count = cut_loops(walk[:count], walker.marks)
            costs[len(paths)] = _measure_path(walk, count, walker.columns, rules.diagonal_cost)
            paths.append(walk[:count].copy())
        elif len(paths) == 0:
            break
    return paths, costs


@allocation_free
def _extend(rng, walker, walk, count, goal):
    """Continue a walk of `count` cells to a goal, in place, and return the new number of cells.

    It is 0 if there is no way.
    """
    walls, columns, visits = walker.walls, walker.columns, walker.visits
    first = count
    visits[0] += 1
    visits[walk[count - 1]] = visits[0]
    while count >= first and walk[count - 1] != goal:
        cell = walk[count - 1]
        row, column = goal // columns - cell // columns, goal % columns - cell % columns
        # No number is drawn where no step can be random.
        random = walker.random_step > 0 and rng.random() < walker.random_step
        best, chosen, seen = np.inf, -1, 0
        for k in range(8):
            neighbour = cell + _ROW_STEPS[k] * columns + _COLUMN_STEPS[k]
            if walls[neighbour] or visits[neighbour] == visits[0]:
                continue
            seen += 1
            away = (row - _ROW_STEPS[k]) ** 2 + (column - _COLUMN_STEPS[k]) ** 2
            # Each of the neighbours seen so far stays chosen with equal probability.
            if (draw_integer(rng, 0, seen) == 0) if random else (away < best):
                best, chosen = away, neighbour
        if chosen < 0:
            count -= 1
            continue
        visits[chosen] = visits[0]
        walk[count] = chosen
        count += 1
    return count if count >= first else 0


@allocation_free
def _walk_anew(rng, walker, path, count):
    """Replace the section between two random cells of a path by a new walk, in place.

    Returns the new number of cells.
    """
    one = draw_integer(rng, 0, count)
    other = draw_integer(rng, 0, count - 1)
    # Another cell: numbers from `one` on move up by one.
    other += other >= one
    first, last = min(one, other), max(one, other)
    # The new walk is written after the path, followed by the path's tail; then both are moved
    # forward.
    path[count] = path[first]
    end = _extend(rng, walker, path, count + 1, path[last])
    end = put(path[last + 1 : count], path, end)
    return cut_loops(path[: put(path[count + 1 : end], path, first + 1)], walker.marks)


@allocation_free
def _measure_path(path, count, columns, diagonal_cost):
    """Return the cost of a path of `count` cells, in cells."""
    diagonal = 0
    for k in range(count - 1):
        step = abs(path[k + 1] - path[k])
        # Steps along a row or a column change the number by 1 or by the columns; all others are
        # diagonal.
        diagonal += step != 1 and step != columns
    return count - 1 - diagonal + diagonal_cost * diagonal
