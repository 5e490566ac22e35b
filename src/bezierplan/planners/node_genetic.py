"""Genetic algorithm over cell sequences of any length, with five mutation operators (meledje).

A chromosome is a path: the numbers of its cells from start to target, joined by straight edges between their centres (`workspaces.ground`).

Lengths, heights and energies in the kernels are in cells.
"""

import math
from typing import Annotated, Literal, NamedTuple, get_args

import numpy as np

from bezierplan.kernels import allocation_free, compiled
from bezierplan.planners import Plan, Range
from bezierplan.planners.parts.genetic import check_pairs, roulette
from bezierplan.planners.parts.node_mutation import Mutation, mutate
from bezierplan.planners.parts.random_integers import below
from bezierplan.planners.parts.sorting import ascending
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.ground import centres, edge_energy, ground_of, least_energy, obstacles_met, path_met
from bezierplan.workspaces.problem import Path, Problem

extra = ("optimum", "optimal", "near_optimal", "infeasible", "feasible_last", "made_infeasible", "node_diversity")
workspaces = ("grid",)
exact = True
keeps_best = False

Initial = Literal["feasible", "rejection", "unrestricted"]
Selection = Literal["linear_rank", "best_half", "tournament", "roulette"]
_FEASIBLE, _REJECTION, _UNRESTRICTED = range(3)
_LINEAR_RANK, _BEST_HALF, _TOURNAMENT, _ROULETTE = range(4)

# Walks, or random paths, tried for one path of the first population before it counts as unreachable.
_MOST_TRIES = 1_000_000
# Smaller differences between the energy of a path and the best so far are rounding errors.
_IMPROVEMENT = 1e-9


class Rules(NamedTuple):
    """The settings of `plan` as the kernels read them, choices as their indices in `Mutation`, `Initial` and `Selection`."""

    mutation: int
    population: int
    generations: int
    stall: int
    initial: int
    most_nodes: int
    selection: int
    crossover_probability: float
    one_cut: bool
    mutation_probability: float
    each_node: bool
    any_node: bool
    beside_obstacle: bool
    keep_better: bool
    same_signs: bool
    whole_path: bool
    penalty: float
    elitism: int
    best_so_far: bool


class _Found(NamedTuple):
    """path: the cells of the result, empty if there was no first population. objective: its energy plus penalty. met: number of occupied
    cells it meets. history: lowest objective so far, by generation. feasible_last: share of feasible paths in the last population.
    made_infeasible: share of mutated feasible paths that the mutation made infeasible. diversity: mean of `node_diversity`.
    """

    path: np.ndarray
    objective: float
    met: int
    history: np.ndarray
    evaluations: int
    stalled: bool
    feasible_last: float
    made_infeasible: float
    diversity: float


def check(settings: dict) -> None:
    """Rules across several settings. Raises ValueError naming the setting and what is expected."""
    check_pairs(settings["population"])
    if settings["friction"] == 0:
        raise ValueError("friction: 0; climbing is weighed by its reciprocal, so a number above 0 is needed")


def plan(
    problem: Problem,
    rng: np.random.Generator,
    *,
    mutation: Mutation,
    population: Annotated[int, Range(2)],
    generations: Annotated[int, Range(0)],
    stall: Annotated[int, Range(1)],
    initial: Initial,
    most_nodes: Annotated[int, Range(1)],
    selection: Selection,
    crossover_probability: Annotated[float, Range(0, 1)],
    cut: Literal["same", "independent"],
    mutation_probability: Annotated[float, Range(0, 1)],
    mutation_for: Literal["path", "node"],
    without_obstacle: Literal["any_node", "none"],
    obstacle_node: Literal["edge", "neighbour"],
    keep_better: bool,
    direction: Literal["forward", "same_signs"],
    ref21_test: Literal["edges", "path"],
    random_node: Literal["free", "any"],
    penalty: Annotated[float, Range(0)],
    elitism: Annotated[int, Range(0, 1)],
    result: Literal["last_generation", "best_so_far"],
    optimal_within: Annotated[float, Range(0)],
    friction: Annotated[float, Range(0)],
    corners: Literal["open", "closed"],
) -> Plan:
    """Path of minimum energy from cell to cell: its length, plus its climbs divided by the friction (meledje, Sections 2 and 3).

    mutation: the operator, applied with mutation_probability once per path, or once per inner node (mutation_for). stall: generations
    without improvement after which the search stops early. initial: the first population, of feasible walks from cell to visible cell; of
    random paths of which only feasible ones are kept (rejection); or of random paths without restriction; each with at most most_nodes
    inner nodes. selection: how parents are drawn from the population; roulette draws them in proportion to the reciprocal of the objective.
    crossover_probability: of a pair of parents; cut: after the same number of nodes in both, or independently. without_obstacle: what
    `proposed` does to a path that meets no obstacle: any node is changed as in ref12, or none. obstacle_node: which nodes it considers to
    encounter an obstacle, those whose edge to the next node meets one, or those in a cell next to an occupied one. keep_better: whether
    ref12 and proposed keep a node that is better than all its neighbours. direction: which steps towards the target `ref21` accepts, within
    a right angle of the straight line to it, or with the same signs; ref21_test: whether it tests the two edges of the new node or the
    whole path. random_node: which cells `random` draws from. penalty: in units of length, for each occupied cell that an edge meets.
    elitism: how many of the best so far replace a path. result: the best path of the last generation, or the best found in the run.
    optimal_within: share of the optimum by which a path may exceed it and still count as optimal. corners: whether an edge through a corner
    of occupied cells meets them (closed).

    The planner's own test: no edge meets an occupied cell. Extra columns: optimum, the minimum energy of all feasible paths from cell to
    cell; optimal, near_optimal, infeasible, exactly one of which is true; feasible_last, the share of feasible paths in the last
    population; made_infeasible, the share of mutated feasible paths that became infeasible; node_diversity, the mean over generations of
    the probability that an inner node of one path is not a node of another. Raises ValueError if start or target is not the centre of a
    cell.
    """
    grid = problem.workspace
    ground = ground_of(grid, friction, corners == "closed")
    start, target = (_cell_at(grid, end, getattr(problem, end)) for end in ("start", "target"))
    optimum = least_energy(grid, friction, corners == "closed", start, target)
    starts, moves = rng.spawn(2)
    if obstacles_met(ground, start, target) == 0:
        # No search needed: a walk sees its target immediately, and paths without inner nodes cannot change.
        energy = edge_energy(ground, start, target)
        found = _Found(np.array([start, target]), energy, 0, np.array([energy]), 1, False, 1.0, math.nan, 0.0)
        stop = "direct"
    elif math.isinf(optimum):
        found, stop = _NOTHING, "no path"
    else:
        rules = Rules(
            mutation=get_args(Mutation).index(mutation),
            population=population,
            generations=generations,
            stall=stall,
            initial=get_args(Initial).index(initial),
            most_nodes=most_nodes,
            selection=get_args(Selection).index(selection),
            crossover_probability=float(crossover_probability),
            one_cut=cut == "same",
            mutation_probability=float(mutation_probability),
            each_node=mutation_for == "node",
            any_node=without_obstacle == "any_node",
            beside_obstacle=obstacle_node == "neighbour",
            keep_better=keep_better,
            same_signs=direction == "same_signs",
            whole_path=ref21_test == "path",
            penalty=penalty / grid.cell,
            elitism=elitism,
            best_so_far=result == "best_so_far",
        )
        drawn = _inner(~grid.occupied | (random_node == "any"), start, target)
        found = _search(starts, moves, ground, start, target, _inner(~grid.occupied, start, target), drawn, rules)
        stop = "no first population" if not len(found.path) else "stall" if found.stalled else "generations"
    feasible = len(found.path) > 0 and found.met == 0
    optimal = feasible and found.objective <= optimum * (1 + optimal_within)
    return Plan(
        path=Path("polyline", centres(grid, found.path)) if len(found.path) else None,
        objective=found.objective * grid.cell,
        claimed_feasible=feasible,
        evaluations=found.evaluations,
        history=found.history * grid.cell,
        stop=stop,
        extra={
            "optimum": optimum * grid.cell,
            "optimal": optimal,
            "near_optimal": feasible and not optimal,
            "infeasible": not feasible,
            "feasible_last": found.feasible_last,
            "made_infeasible": found.made_infeasible,
            "node_diversity": found.diversity,
        },
    )


_NOTHING = _Found(np.empty(0, dtype=np.int64), math.inf, 0, np.array([math.inf]), 1, False, 0.0, math.nan, 0.0)


def _inner(cells: np.ndarray, start: int, target: int) -> np.ndarray:
    """Numbers of the cells marked in a bool array (rows, columns), without start and target."""
    numbers = np.flatnonzero(cells)
    return numbers[(numbers != start) & (numbers != target)]


def serves(problem: Problem) -> None:
    """Raise ValueError, naming the end and what is expected, unless start and target are centres of cells."""
    for end in ("start", "target"):
        _cell_at(problem.workspace, end, getattr(problem, end))


def _cell_at(grid: Grid, end: str, point: tuple[float, float]) -> int:
    row, column = grid.cell_of(*point)
    number = int(row * grid.occupied.shape[1] + column)
    if point != grid.centre(number):
        raise ValueError(f"{end}: {point}; paths go from cell to cell, so the centre of a cell is needed, such as {grid.centre(number)}")
    return number


# ---------------------------------------------------------------------------------------------------------------------
# The search


@compiled
def _search(starts, moves, ground, start, target, free, drawn, rules):
    """The genetic algorithm. free: the free cells without start and target; drawn: the cells from which random mutation draws."""
    population = rules.population
    paths, lengths = np.empty((population, rules.most_nodes + 2), dtype=np.int64), np.empty(population, dtype=np.int64)
    for i in range(population):
        paths[i, 0] = start
        lengths[i] = _first_path(starts, paths[i], target, free, ground, rules)
        if lengths[i] == 0:
            return _Found(np.empty(0, dtype=np.int64), np.inf, 0, np.full(1, np.inf), 1, False, 0.0, np.nan, 0.0)
    children, child_lengths = paths.copy(), lengths.copy()
    objective, met = np.empty(population), np.empty(population, dtype=np.int64)
    ranks, neighbours = np.arange(population, 0, -1).astype(np.float64), np.empty(8, dtype=np.int64)
    history = np.empty(rules.generations + 1)
    best, best_length, best_objective, best_met = paths[0].copy(), 0, np.inf, 0
    improved = evaluations = feasible = spoiled = 0
    diversity = 0.0

    for generation in range(rules.generations + 1):
        for i in range(population):
            objective[i], met[i] = _evaluate(paths[i, : lengths[i]], ground, rules.penalty)
        evaluations += population
        diversity += node_diversity(paths, lengths, ground.occupied.size)
        order = ascending(objective)
        first = order[0]
        if objective[first] < best_objective - _IMPROVEMENT:
            if len(best) < lengths[first]:
                best = np.empty(paths.shape[1], dtype=np.int64)
            best_length, best_objective, best_met = lengths[first], objective[first], met[first]
            _copy(paths[first], best, best_length)
            improved = generation
        history[generation] = best_objective
        stalled = generation - improved >= rules.stall
        if stalled or generation == rules.generations:
            break

        if rules.selection == _ROULETTE:
            parents = roulette(moves, 1.0 / objective, population)
        else:
            parents = _select(moves, order, ranks, rules.selection)
        if not rules.one_cut and 2 * lengths.max() > children.shape[1]:
            children = np.empty((population, 2 * lengths.max()), dtype=np.int64)
        for i in range(0, population, 2):
            mother, father = parents[i], parents[i + 1]
            if moves.random() < rules.crossover_probability:
                cut = other_cut = 1 + below(moves, min(lengths[mother], lengths[father]) - 1)
                if not rules.one_cut:
                    cut, other_cut = 1 + below(moves, lengths[mother] - 1), 1 + below(moves, lengths[father] - 1)
            else:
                cut, other_cut = lengths[mother], lengths[father]
            child_lengths[i] = join(paths[mother], cut, paths[father], other_cut, lengths[father], children[i])
            child_lengths[i + 1] = join(paths[father], other_cut, paths[mother], cut, lengths[mother], children[i + 1])
        if children.shape[1] > paths.shape[1]:
            paths = np.empty_like(children)
        paths, children = children, paths
        lengths, child_lengths = child_lengths, lengths
        for i in range(population):
            for _ in range(lengths[i] - 2 if rules.each_node else 1):
                if moves.random() < rules.mutation_probability and lengths[i] > 2:
                    path = paths[i, : lengths[i]]
                    was_feasible = path_met(path, ground) == 0
                    evaluations += mutate(moves, path, drawn, ground, rules, neighbours)
                    feasible += was_feasible
                    spoiled += was_feasible and path_met(path, ground) > 0
        if rules.elitism:
            _copy(best, paths[0], best_length)
            lengths[0] = best_length

    if not rules.best_so_far:
        best, best_length, best_objective, best_met = paths[first], lengths[first], objective[first], met[first]
    return _Found(
        best[:best_length].copy(),
        best_objective,
        best_met,
        history[: generation + 1].copy(),
        evaluations,
        stalled,
        (met == 0).mean(),
        spoiled / feasible if feasible else np.nan,
        diversity / (generation + 1),
    )


@allocation_free
def _copy(source, target, length):
    for k in range(length):
        target[k] = source[k]


@allocation_free
def join(head: np.ndarray, cut: int, tail: np.ndarray, tail_cut: int, tail_length: int, child: np.ndarray) -> int:
    """Write to a child the first `cut` nodes of one path and those after the first `tail_cut` of another (meledje, Section 2.6).

    Returns its length. Cuts after the last node leave the head unchanged.
    """
    for k in range(cut):
        child[k] = head[k]
    for k in range(tail_cut, tail_length):
        child[cut + k - tail_cut] = tail[k]
    return cut + tail_length - tail_cut


@allocation_free
def _evaluate(path, ground, penalty):
    """Energy of a path plus its penalty, and the number of occupied cells that its edges meet (meledje, eqs. 1 to 3)."""
    energy = 0.0
    for k in range(len(path) - 1):
        energy += edge_energy(ground, path[k], path[k + 1])
    met = path_met(path, ground)
    return energy + penalty * met, met


@compiled
def node_diversity(paths: np.ndarray, lengths: np.ndarray, cells: int) -> float:
    """Probability that an inner node of one path (n, ...) is not a node of another; 0 without inner nodes. cells: number of cells."""
    having, last = np.zeros(cells, dtype=np.int64), np.full(cells, -1)
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


@allocation_free
def _first_path(rng, path, target, free, ground, rules):
    """A random path, written after its start; returns its number of nodes, or 0 if none was found."""
    for _ in range(_MOST_TRIES):
        length = _walk(rng, path, target, free, ground) if rules.initial == _FEASIBLE else _random_path(rng, path, target, free)
        if length and (rules.initial != _REJECTION or path_met(path[:length], ground) == 0):
            return length
    return 0


@allocation_free
def _walk(rng, path, target, free, ground):
    """A walk from cell to visible cell, none visited twice, until the target is visible; returns 0 if it becomes too long or sees no new
    cell.
    """
    length = 1
    while obstacles_met(ground, path[length - 1], target) > 0:
        if length == len(path) - 1:
            return 0
        path[length] = -1
        for _ in range(len(free)):
            cell = free[below(rng, len(free))]
            if _continues(cell, path, length, ground):
                path[length] = cell
                break
        if path[length] < 0:
            path[length] = _one_of_few(rng, path, length, free, ground)
            if path[length] < 0:
                return 0
        length += 1
    path[length] = target
    return length + 1


@allocation_free
def _one_of_few(rng, path, length, free, ground):
    """A uniformly drawn cell that is visible from the last cell of a path and not yet part of it, found by checking all cells; -1 if there
    is none.
    """
    count = 0
    for cell in free:
        count += _continues(cell, path, length, ground)
    if count == 0:
        return -1
    chosen = below(rng, count)
    for cell in free:
        if _continues(cell, path, length, ground):
            if chosen == 0:
                return cell
            chosen -= 1
    return -1


@allocation_free
def _continues(cell, path, length, ground):
    """Whether a cell is visible from the last cell of a path and not yet part of it."""
    return obstacles_met(ground, path[length - 1], cell) == 0 and not _among(cell, path, length)


@allocation_free
def _among(cell, path, length):
    for k in range(length):
        if path[k] == cell:
            return True
    return False


@allocation_free
def _random_path(rng, path, target, free):
    """A random number of inner nodes within the limit, each a random free cell."""
    inner = below(rng, len(path) - 1)
    for k in range(1, inner + 1):
        path[k] = free[below(rng, len(free))]
    path[inner + 1] = target
    return inner + 2


# Selection (meledje, Section 2.5).


@compiled
def _select(rng, order, ranks, selection):
    """As many parents as there are paths, drawn with replacement. order: paths, best first; ranks: their weights for a linear ranking."""
    if selection == _LINEAR_RANK:
        return order[roulette(rng, ranks, len(order))]
    parents = np.empty_like(order)
    for i in range(len(order)):
        if selection == _BEST_HALF:
            parents[i] = order[below(rng, len(order) // 2)]
        else:
            parents[i] = order[min(below(rng, len(order)), below(rng, len(order)))]
    return parents
