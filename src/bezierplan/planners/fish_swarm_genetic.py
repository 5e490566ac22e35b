"""Artificial fish swarm followed by a genetic algorithm over the cells of a grid (ASFA-GA), one of
ma2020's competing methods (Section 4.1).

Only the title of its reference 31 is known. Fish forage from cell to cell and occasionally follow
one that is closer to the target; the paths of those that arrive form the first population of a
genetic algorithm, which mutates a path by foraging a section of it again.
"""

from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Plan, Range
from bezierplan.planners.parts import cell_paths
from bezierplan.planners.parts.genetic import check_pairs
from bezierplan.planners.parts.settings import NOT_NEGATIVE, SHARE, with_settings
from bezierplan.workspaces.lattice import Corners
from bezierplan.workspaces.problem import Problem

workspaces = ("grid",)
exact = True


# How far a fish sees others, in cells; the share of the fish in sight from which on nobody is
# followed; steps after which a fish looks for others.
_SIGHT, _CROWDING, _FOLLOW_EVERY = 6.0, 0.618, 5
# Most swarms released; cells behind it with which a fish dies; most cells of a section foraged
# again.
_RELEASES, _LONGEST_PATH, _LONGEST_WALK = 200, 200, 60


class Settings(NamedTuple):
    """Settings of the swarm and the genetic algorithm; ma2020 gives none."""

    corners: Annotated[
        Corners, About("how many of the two cells beside a diagonal step may be occupied")
    ]
    fish: Annotated[int, Range(1), About("fish of a swarm")]
    tries: Annotated[
        int,
        NOT_NEGATIVE,
        About("random neighbours examined for one closer to the target before any is taken"),
    ]
    population: Annotated[int, Range(2), About("paths of a generation")]
    generations: Annotated[int, NOT_NEGATIVE, About("generations after the first")]
    crossover_probability: Annotated[float, SHARE, About("of a pair of parents")]
    mutation_probability: Annotated[
        float, SHARE, About("of a child, a section of whose path is foraged again")
    ]
    elitism: Annotated[int, SHARE, About("how many of the best so far replace a child")]


check = check_pairs


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest path found over the 8-connected lattice of a grid.

    Swarms of fish are released at the start until there are enough paths for the population. A fish
    enters no cell twice. Every `_FOLLOW_EVERY` steps it looks for others within sight, including
    those that have arrived: if there are fewer than `_CROWDING` times the fish and the one nearest
    to the target is nearer than itself, it moves to the neighbour nearest to that one. A fish with
    no neighbour left dies. If there are fewer paths than the population, they are repeated in
    turn. Children lose their loops.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its length in units, infinite if there is no path.

    Raises
    ------
    ValueError
        If start or target is not in a free cell.

    References
    ----------
    ma2020, Section 4.1, reference 31.
    """
    places = cell_paths.build_lattice(problem, settings.corners)
    first, moves = rng.spawn(2)
    if places.start == places.target:
        # No search needed: all fish have arrived.
        settings = settings._replace(generations=0)
        paths, sizes, releases = np.array([[places.start]]), np.array([1]), 1
    else:
        paths, sizes, releases = _collect_first_paths(first, places, settings)
    best, history = np.empty(0, np.int64), np.array([np.inf])
    if len(sizes) > 0:
        rules = cell_paths.Rules(
            settings.crossover_probability,
            settings.mutation_probability,
            settings.elitism,
            cell_paths.WALK,
            _LONGEST_WALK,
            settings.tries,
        )
        turns = np.resize(np.arange(len(sizes)), settings.population)
        best, history = cell_paths.evolve(
            moves, places, paths[turns], sizes[turns], settings.generations, rules
        )
    evaluations = settings.fish * releases + settings.population * (len(history) - 1)
    return cell_paths.plan_of(problem, best, history, evaluations, "generations")


_SWIMMING, _ARRIVED, _DEAD = range(3)


@compile_kernel
def _collect_first_paths(rng, lattice, swarm):
    """Release swarms until enough fish arrive, or `_RELEASES` times.

    Returns the first paths (n, longest path) of fish that arrive, at most a population, their sizes
    (n,), and the number of releases.
    """
    most = swarm.population
    arrivals = np.empty((most, _LONGEST_PATH), np.int64)
    arrival_sizes = np.empty(most, np.int64)
    paths = np.empty((swarm.fish, _LONGEST_PATH), np.int64)
    sizes = np.empty(swarm.fish, np.int64)
    visited = np.empty((swarm.fish, len(lattice.row)), np.int64)
    cells, states = np.empty(swarm.fish, np.int64), np.empty(swarm.fish, np.int64)
    count = releases = 0
    while count < most and releases < _RELEASES:
        releases += 1
        visited[:] = 0
        visited[:, lattice.start] = 1
        paths[:, 0] = cells[:] = lattice.start
        sizes[:] = 1
        states[:] = _SWIMMING
        step = 0
        while np.any(states == _SWIMMING):
            step += 1
            for i in range(swarm.fish):
                if states[i] != _SWIMMING:
                    continue
                cell = -1
                if step % _FOLLOW_EVERY == 0:
                    # Fish move one after another: those behind see where the others are by now.
                    cell = _follow(lattice, i, cells, states, visited[i], swarm)
                if cell < 0:
                    cell = cell_paths.choose_cell_for_prey(
                        rng, lattice, cells[i], lattice.target, swarm.tries, visited[i]
                    )
                if cell < 0 or sizes[i] == _LONGEST_PATH:
                    states[i] = _DEAD
                    continue
                paths[i, sizes[i]] = cells[i] = cell
                visited[i, cell] = 1
                sizes[i] += 1
                if cell == lattice.target:
                    states[i] = _ARRIVED
                    if count < most:
                        arrival_sizes[count] = cell_paths.put(
                            paths[i, : sizes[i]], arrivals[count], 0
                        )
                        count += 1
    return arrivals[:count], arrival_sizes[:count], releases


@allocation_free
def _follow(lattice, i, cells, states, visited, swarm):
    """Return the unvisited neighbour of a fish's cell that is nearest to its leader, or -1.

    The leader is the fish in sight nearest to the target. There is no such neighbour if the leader
    is no nearer to the target than the fish itself, or if too many fish are in sight.
    """
    in_sight, leader, near = (
        0,
        -1,
        cell_paths.compute_distance_square(lattice, cells[i], lattice.target),
    )
    for j in range(swarm.fish):
        if (
            j != i
            and states[j] != _DEAD
            and cell_paths.compute_distance_square(lattice, cells[i], cells[j]) <= _SIGHT**2
        ):
            in_sight += 1
            distance = cell_paths.compute_distance_square(lattice, cells[j], lattice.target)
            if distance < near:
                leader, near = cells[j], distance
    chosen = -1
    if leader >= 0 and in_sight < _CROWDING * swarm.fish:
        for cell in lattice.neighbours[cells[i]]:
            if cell >= 0 and not visited[cell]:
                distance = cell_paths.compute_distance_square(lattice, cell, leader)
                if chosen < 0 or distance < near:
                    chosen, near = cell, distance
    return chosen
