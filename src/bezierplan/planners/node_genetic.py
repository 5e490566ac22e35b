"""Genetic algorithm over cell sequences of any length, with five mutation operators (meledje).

A chromosome is a path: the numbers of its cells from start to target, joined by straight edges
between their centres (`workspaces.ground`).

Lengths, heights and energies in the kernels are in cells.
"""

import math
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.genetic import check_pairs, copy, draw_parents
from bezierplan.planners.parts.node_mutation import (
    Mutation,
    ObstacleNode,
    WithoutObstacle,
    mutate,
)
from bezierplan.planners.parts.random_integers import draw_below
from bezierplan.planners.parts.settings import (
    NOT_NEGATIVE,
    SHARE,
    UNITS,
    convert_to_cells,
    with_settings,
)
from bezierplan.planners.parts.sorting import ascending, find_largest
from bezierplan.workspaces.ground import (
    MOST_NEIGHBOURS,
    Ground,
    Neighbourhood,
    build_ground,
    centres,
    compute_edge_energy,
    count_obstacles_along,
    count_obstacles_on,
    find_least_energy,
)

extra = (
    "optimum",
    "optimal",
    "near_optimal",
    "infeasible",
    "feasible_last",
    "made_infeasible",
    "node_diversity",
)
workspaces = ("grid",)
exact = True
keeps_best = False

Initial = IntEnum("Initial", "feasible rejection unrestricted")
Selection = IntEnum("Selection", "linear_rank best_half roulette")
Cut = IntEnum("Cut", "same independent")
MutationFor = IntEnum("MutationFor", "path node")
RandomNode = IntEnum("RandomNode", "free any")
Result = IntEnum("Result", "last_generation best_so_far")
Corners = IntEnum("Corners", "open closed")

# Walks tried for one path of the first population before it counts as unreachable.
_MOST_TRIES = 1_000_000
# Smaller differences between the energy of a path and the best so far are rounding errors.
_IMPROVEMENT = 1e-9


class Settings(NamedTuple):
    """Settings of the search (meledje, Sections 2 to 4)."""

    mutation: Annotated[Mutation, About("mutation operator", "meledje, Section 3")]
    population: Annotated[int, Range(2), About("paths of a generation", "meledje, Section 4")]
    generations: Annotated[int, NOT_NEGATIVE, About("most generations after the first")]
    stall: Annotated[int, Range(1), About("generations without improvement that end the search")]
    initial: Annotated[
        Initial,
        About(
            "first paths: walks from cell to visible cell, random paths of which feasible ones "
            "are kept (slow on maps of thousands of cells), or any",
            "meledje, Section 2.3",
        ),
    ]
    most_nodes: Annotated[int, Range(1), About("most inner nodes of a first path")]
    selection: Annotated[
        Selection,
        About("how parents are drawn; roulette in proportion to the reciprocal of the objective"),
    ]
    crossover_probability: Annotated[
        float, SHARE, About("of a pair of parents", "meledje, Section 4")
    ]
    cut: Annotated[Cut, About("parents are cut after the same number of nodes, or independently")]
    mutation_probability: Annotated[
        float, SHARE, About("of a path, or of each inner node", "meledje, Section 4")
    ]
    mutation_for: Annotated[
        MutationFor, About("what mutates with that probability: a path, or each inner node")
    ]
    without_obstacle: Annotated[
        WithoutObstacle,
        About(
            "what `proposed` changes of a path that meets no obstacle: "
            "any node as in ref12, or none"
        ),
    ]
    obstacle_node: Annotated[
        ObstacleNode,
        About(
            "a node encounters an obstacle if its edge to the next node meets one, or in a cell "
            "next to an occupied one"
        ),
    ]
    neighbourhood: Annotated[
        Neighbourhood,
        About(
            "cells that ref12, ref21 and proposed may move a node to: the eight around it, the "
            "four beside it, or all at most two columns and rows away"
        ),
    ]
    keep_better: Annotated[
        bool,
        About(
            "whether ref12 and proposed keep a node better than all its neighbours",
            "meledje, Table 1, step 4",
        ),
    ]
    random_node: Annotated[RandomNode, About("cells that `random` draws from")]
    penalty: Annotated[
        float, NOT_NEGATIVE, About("added for each occupied cell that an edge meets", unit=UNITS)
    ]
    elitism: Annotated[int, SHARE, About("how many of the best so far replace a path")]
    result: Annotated[Result, About("best path of the last generation, or of the run")]
    optimal_within: Annotated[
        float, NOT_NEGATIVE, About("share of the optimum by which an optimal path may exceed it")
    ]
    friction: Annotated[
        float,
        Range(1e-6),
        About("climbs are divided by it", "meledje, Section 2.1, without a number"),
    ]
    corners: Annotated[
        Corners, About("whether an edge through a corner of occupied cells meets them (closed)")
    ]


class _Outcome(NamedTuple):
    """Result of a search.

    path: the cells, empty if there was no first population.
    objective: the path's energy plus penalty.
    encounters: number of occupied cells that it meets.
    history: lowest objective so far, by generation.
    feasible_last: share of feasible paths in the last population.
    made_infeasible: share of mutated feasible paths that the mutation made infeasible.
    diversity: mean of `measure_node_diversity` over the generations.
    """

    path: np.ndarray
    objective: float
    encounters: int
    history: np.ndarray
    evaluations: int
    stalls: bool
    feasible_last: float
    made_infeasible: float
    diversity: float


check = check_pairs


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the path from cell to cell with the least energy found: its length, plus its climbs
    divided by the friction.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        `claimed_feasible`: no edge meets an occupied cell. Extra columns: optimum, the minimum
        energy of all feasible paths from cell to cell; optimal, near_optimal, infeasible, exactly
        one of which is true; feasible_last, the share of feasible paths in the last population;
        made_infeasible, the share of mutated feasible paths that became infeasible; node_diversity,
        the mean over generations of the probability that an inner node of one path is not a node of
        another.

    Raises
    ------
    ValueError
        If start or target is not the centre of a cell.

    References
    ----------
    meledje, Sections 2 and 3.
    """
    grid = problem.workspace
    friction, closed = settings.friction, settings.corners == Corners.closed
    ground = build_ground(grid, friction, closed)
    start, target = (_find_cell_at(problem, end) for end in ("start", "target"))
    optimum = find_least_energy(grid, friction, closed, start, target)
    # Moves have a generator of their own: they do not depend on how many draws the first paths
    # took.
    starts, moves = rng.spawn(2)
    if count_obstacles_on(ground, start, target) == 0:
        # No search needed: a walk sees its target immediately, and paths without inner nodes cannot
        # change.
        energy = compute_edge_energy(ground, start, target)
        result = _Outcome(
            np.array([start, target]), energy, 0, np.array([energy]), 1, False, 1.0, math.nan, 0.0
        )
        stop = "direct"
    elif math.isinf(optimum):
        # No walk would arrive, and each first path would take all its tries.
        result, stop = _NOTHING, "no path"
    else:
        alleles = _list_inner_cells(
            ~grid.occupied | (settings.random_node == RandomNode.any), start, target
        )
        result = _search(
            starts,
            moves,
            ground,
            start,
            target,
            _list_inner_cells(~grid.occupied, start, target),
            alleles,
            convert_to_cells(settings, grid.cell),
        )
        stop = (
            "no first population"
            if not len(result.path)
            else "stall"
            if result.stalls
            else "generations"
        )
    feasible = len(result.path) > 0 and result.encounters == 0
    optimal = feasible and result.objective <= optimum * (1 + settings.optimal_within)
    return Plan(
        path=Path("polyline", centres(grid, result.path)) if len(result.path) else None,
        objective=result.objective * grid.cell,
        claimed_feasible=feasible,
        evaluations=result.evaluations,
        history=result.history * grid.cell,
        stop=stop,
        extra={
            "optimum": optimum * grid.cell,
            "optimal": optimal,
            "near_optimal": feasible and not optimal,
            "infeasible": not feasible,
            "feasible_last": result.feasible_last,
            "made_infeasible": result.made_infeasible,
            "node_diversity": result.diversity,
        },
    )


_NOTHING = _Outcome(
    np.empty(0, np.int64), math.inf, 0, np.array([math.inf]), 1, False, 0.0, math.nan, 0.0
)


def _list_inner_cells(cells: np.ndarray, start: int, target: int) -> np.ndarray:
    """List the cells marked in a bool array (rows, columns), by number, without start and
    target.
    """
    numbers = np.flatnonzero(cells)
    return numbers[(numbers != start) & (numbers != target)]


def serves(problem: Problem) -> None:
    """Raise ValueError, naming the end, unless start and target are centres of cells."""
    for end in ("start", "target"):
        _find_cell_at(problem, end)


def _find_cell_at(problem: Problem, end: str) -> int:
    """Return the number of the cell whose centre is the start or the target.

    Raises ValueError, naming the end, for any other point.
    """
    grid, point = problem.workspace, getattr(problem, end)
    row, column = grid.cell_of(*point)
    number = int(row * grid.occupied.shape[1] + column)
    if point != grid.centre(number):
        raise ValueError(
            f"{end}: {point}; paths go from cell to cell, so the centre of a cell is needed, such "
            f"as {grid.centre(number)}"
        )
    return number


# --------------------------------------------------------------------------------------------------
# The search


@compile_kernel
def _search(starts, moves, ground, start, target, free, alleles, rules):
    """Run the genetic algorithm and return its outcome, with an empty path if a first path is not
    found.

    free: free cells without the ends.
    alleles: cells from which random mutation draws.
    """
    population = rules.population
    paths = np.empty((population, rules.most_nodes + 2), np.int64)
    lengths = np.empty(population, np.int64)
    ways = np.empty((0, 0))
    if rules.initial == Initial.rejection:
        ways = compute_free_ways(target, free, ground, rules.most_nodes)
    for i in range(population):
        paths[i, 0] = start
        lengths[i] = _draw_first_path(starts, paths[i], target, free, ground, rules, ways)
        if lengths[i] == 0:
            none = np.full(1, np.inf)
            return _Outcome(paths[i, :0].copy(), np.inf, 0, none, 1, False, 0.0, np.nan, 0.0)
    objective, encounters = np.empty(population), np.empty(population, np.int64)
    # The best of n paths has weight n, the worst 1.
    ranks = np.arange(population, 0, -1).astype(np.float64)
    neighbours = np.empty(MOST_NEIGHBOURS, np.int64)
    history = np.empty(rules.generations + 1)
    best, best_objective, best_encounters = paths[0].copy(), np.inf, 0
    last_gain = evaluations = feasible = losses = 0
    diversity = 0.0

    for generation in range(rules.generations + 1):
        for i in range(population):
            objective[i], encounters[i] = _evaluate(paths[i, : lengths[i]], ground, rules.penalty)
        evaluations += population
        diversity += measure_node_diversity(paths, lengths, ground.occupied.size)
        order = ascending(objective)
        first = order[0]
        # A gain within rounding must not put off the end that `stall` sets.
        if objective[first] < best_objective - _IMPROVEMENT:
            best, best_objective = paths[first, : lengths[first]].copy(), objective[first]
            best_encounters = encounters[first]
            last_gain = generation
        history[generation] = best_objective
        stalls = generation - last_gain >= rules.stall
        if stalls or generation == rules.generations:
            break

        if rules.selection == Selection.roulette:
            parents = draw_parents(moves, 1.0 / objective, population)
        elif rules.selection == Selection.linear_rank:
            parents = order[draw_parents(moves, ranks, population)]
        else:
            parents = np.empty_like(order)
            for i in range(population):
                parents[i] = order[draw_below(moves, population // 2)]
        # A child has at most the nodes of both parents.
        children = np.empty((population, 2 * find_largest(lengths)), np.int64)
        child_lengths = np.empty_like(lengths)
        for i in range(0, population, 2):
            mother, father = parents[i], parents[i + 1]
            if moves.random() < rules.crossover_probability:
                # Cuts lie behind the start and before the target.
                cut = other_cut = 1 + draw_below(moves, min(lengths[mother], lengths[father]) - 1)
                if rules.cut == Cut.independent:
                    cut = 1 + draw_below(moves, lengths[mother] - 1)
                    other_cut = 1 + draw_below(moves, lengths[father] - 1)
            else:
                cut, other_cut = lengths[mother], lengths[father]
            child_lengths[i] = join(
                paths[mother], cut, paths[father], other_cut, lengths[father], children[i]
            )
            child_lengths[i + 1] = join(
                paths[father], other_cut, paths[mother], cut, lengths[mother], children[i + 1]
            )
        paths, lengths = children, child_lengths
        for i in range(population):
            # Feasibility is asked before and after each mutation, for the share that mutation
            # destroys.
            for _ in range(lengths[i] - 2 if rules.mutation_for == MutationFor.node else 1):
                if moves.random() < rules.mutation_probability and lengths[i] > 2:
                    path = paths[i, : lengths[i]]
                    was_feasible = count_obstacles_along(path, ground) == 0
                    # Neighbours that an operator compares count as evaluated.
                    evaluations += mutate(moves, path, alleles, ground, rules, neighbours)
                    feasible += was_feasible
                    losses += was_feasible and count_obstacles_along(path, ground) > 0
        if rules.elitism:
            copy(best, paths[0])
            lengths[0] = len(best)

    if rules.result == Result.last_generation:
        # The last generation was evaluated, but not bred from, so `first` is its best.
        best, best_objective = paths[first, : lengths[first]].copy(), objective[first]
        best_encounters = encounters[first]
    return _Outcome(
        best,
        best_objective,
        best_encounters,
        history[: generation + 1].copy(),
        evaluations,
        stalls,
        (encounters == 0).mean(),
        losses / feasible if feasible else np.nan,
        diversity / (generation + 1),
    )


@allocation_free
def join(
    head: np.ndarray, cut: int, tail: np.ndarray, tail_cut: int, tail_length: int, child: np.ndarray
) -> int:
    """Write to a child the first `cut` nodes of one path and those after the first `tail_cut` of
    another (meledje, Section 2.6), and return its length.

    Cuts after the last node leave the head unchanged.
    """
    copy(head[:cut], child)
    copy(tail[tail_cut:tail_length], child[cut:])
    return cut + tail_length - tail_cut


@allocation_free
def _evaluate(path, ground, penalty):
    """Return the energy of a path plus penalty, and the number of occupied cells its edges meet
    (meledje, eqs. 1 to 3).
    """
    energy = 0.0
    for k in range(len(path) - 1):
        energy += compute_edge_energy(ground, path[k], path[k + 1])
    encounters = count_obstacles_along(path, ground)
    return energy + penalty * encounters, encounters


@compile_kernel
def measure_node_diversity(paths: np.ndarray, lengths: np.ndarray, cells: int) -> float:
    """Return the probability that an inner node of one path (n, ...) is not a node of another.

    It is 0 without inner nodes. cells: number of cells.
    """
    having, last = np.zeros(cells, np.int64), np.full(cells, -1)
    for i in range(len(paths)):
        for k in range(1, lengths[i] - 1):
            if last[paths[i, k]] != i:
                last[paths[i, k]] = i
                having[paths[i, k]] += 1
    nodes = lonely = 0
    for count in having:
        nodes += count
        lonely += count * (len(paths) - count)
    return lonely / (nodes * (len(paths) - 1)) if nodes else 0.0


# The first population (meledje, Section 2.3).


@compile_kernel
def _draw_first_path(rng, path, target, free, ground, rules, ways):
    """Write a random path after its start and return its number of nodes, 0 if none was found.

    ways: `compute_free_ways`, for `rejection`.
    """
    if rules.initial == Initial.rejection:
        return draw_feasible_path(rng, path, target, free, ground, ways)
    for _ in range(_MOST_TRIES):
        length = (
            _walk(rng, path, target, free, ground)
            if rules.initial == Initial.feasible
            else _draw_random_path(rng, path, target, free)
        )
        if length:
            return length
    return 0


@compile_kernel
def compute_free_ways(target: int, free: np.ndarray, ground: Ground, most_nodes: int) -> np.ndarray:
    """Return the chance (cells, most_nodes + 1) that so many random free cells after a cell lead to
    the target without meeting an obstacle.
    """
    ways = np.zeros((ground.occupied.size, most_nodes + 1))
    for cell in range(len(ways)):
        ways[cell, 0] = count_obstacles_on(ground, cell, target) == 0
    for inner in range(1, most_nodes + 1):
        for cell in range(len(ways)):
            for following in free:
                if count_obstacles_on(ground, cell, following) == 0:
                    ways[cell, inner] += ways[following, inner - 1] / len(free)
    return ways


@compile_kernel
def draw_feasible_path(
    rng: np.random.Generator,
    path: np.ndarray,
    target: int,
    free: np.ndarray,
    ground: Ground,
    ways: np.ndarray,
) -> int:
    """Write a feasible path after its start and return its number of nodes, 0 if there is none.

    Its number of inner nodes and their cells have the chances that they have where random numbers
    within the limit and random free cells are drawn until the path is feasible. Drawing them so
    would take millions of times on some maps.
    """
    if ways[path[0]].sum() == 0:
        return 0
    inner = draw_parents(rng, ways[path[0]], 1)[0]
    weights = np.empty(len(free))
    for k in range(1, inner + 1):
        for c in range(len(free)):
            is_free = count_obstacles_on(ground, path[k - 1], free[c]) == 0
            weights[c] = ways[free[c], inner - k] if is_free else 0.0
        path[k] = free[draw_parents(rng, weights, 1)[0]]
    path[inner + 1] = target
    return inner + 2


@allocation_free
def _walk(rng, path, target, free, ground):
    """Walk from cell to visible cell, none visited twice, until the target is visible.

    Returns the number of nodes, 0 if the walk becomes too long or sees no new cell.
    """
    length = 1
    while count_obstacles_on(ground, path[length - 1], target) > 0:
        if length == len(path) - 1:
            return 0
        path[length] = -1
        # Where many cells are visible, a few draws find one faster than a look at all of them.
        for _ in range(len(free)):
            cell = free[draw_below(rng, len(free))]
            if _can_continue(cell, path, length, ground):
                path[length] = cell
                break
        if path[length] < 0:
            path[length] = _draw_one_of_few(rng, path, length, free, ground)
            if path[length] < 0:
                return 0
        length += 1
    path[length] = target
    return length + 1


@allocation_free
def _draw_one_of_few(rng, path, length, free, ground):
    """Draw a cell that is visible from the last cell of a path and not yet part of it, each with
    equal probability; -1 if there is none.

    All cells are checked.
    """
    count = 0
    for cell in free:
        count += _can_continue(cell, path, length, ground)
    if count == 0:
        return -1
    chosen = draw_below(rng, count)
    for cell in free:
        if _can_continue(cell, path, length, ground):
            if chosen == 0:
                return cell
            chosen -= 1
    return -1


@allocation_free
def _can_continue(cell, path, length, ground):
    """Tell whether a cell is visible from the last cell of a path and not yet part of it."""
    return count_obstacles_on(ground, path[length - 1], cell) == 0 and not _is_among(
        cell, path, length
    )


@allocation_free
def _is_among(cell, path, length):
    """Tell whether a cell is one of the first `length` of a path."""
    for k in range(length):
        if path[k] == cell:
            return True
    return False


@allocation_free
def _draw_random_path(rng, path, target, free):
    """Write a random number of inner nodes within the limit, each a random free cell."""
    inner = draw_below(rng, len(path) - 1)
    for k in range(1, inner + 1):
        path[k] = free[draw_below(rng, len(free))]
    path[inner + 1] = target
    return inner + 2
