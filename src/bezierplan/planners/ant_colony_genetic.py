"""Ant colony optimisation followed by a genetic algorithm over the cells of a grid (ACO-GA), one of
ma2020's competing methods (Section 4.1).

Its reference 30 (SmartPATH) gives the scheme: ants find the first paths, and a genetic algorithm
with its own crossover improves them. If two parents share a cell, the first child gets the shorter
head and the shorter tail; the second child is the second parent.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.planners import About, Plan, Range, ant_colony
from bezierplan.planners.parts import cell_paths
from bezierplan.planners.parts.genetic import check_pairs
from bezierplan.planners.parts.settings import SHARE, with_settings
from bezierplan.workspaces.problem import Problem

workspaces = ("grid",)
exact = True


Mutation = IntEnum("Mutation", {"one_cell": cell_paths.ONE_CELL, "reconnect": cell_paths.RECONNECT})


class Settings(NamedTuple):
    """Settings of the genetic algorithm, beside those of the colony; ma2020 gives none."""

    population: Annotated[int, Range(2), About("paths of a generation")]
    generations: Annotated[int, Range(0), About("generations after the first")]
    crossover_probability: Annotated[float, SHARE, About("of a pair of parents")]
    mutation_probability: Annotated[float, SHARE, About("of a child")]
    mutation: Annotated[
        Mutation,
        About(
            "an inner cell becomes another one next to the same two, or a section is reconnected "
            "through a random cell"
        ),
    ]
    longest_join: Annotated[int, Range(2), About("most cells of a reconnected section")]
    elitism: Annotated[int, SHARE, About("how many of the best so far replace a child")]


check = check_pairs


@with_settings(ant_colony.Settings, Settings)
def plan(
    problem: Problem, rng: np.random.Generator, ants: ant_colony.Settings, settings: Settings
) -> Plan:
    """Return the shortest path found over the 8-connected lattice of a grid.

    The first population consists of the best path of all ants and the paths of the last iteration's
    ants, repeated in turn. Children lose their loops.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its length in units, infinite if there is no path. The history covers the
        iterations of the ants, then the generations.

    Raises
    ------
    ValueError
        If start or target is not in a free cell.

    References
    ----------
    ma2020, Section 4.1, reference 30.
    """
    places = cell_paths.build_lattice(problem, ants.corners)
    first, moves = rng.spawn(2)
    colony = ant_colony.search(places, first, ants)
    best, history = colony.best, colony.history
    # Without a path there is nothing to breed, and a path of one cell cannot change.
    if len(best) > 0 and places.start != places.target:
        rules = cell_paths.Rules(
            settings.crossover_probability,
            settings.mutation_probability,
            settings.elitism,
            settings.mutation,
            settings.longest_join,
        )
        best, later = cell_paths.evolve(
            moves,
            places,
            *_choose_first_population(colony, settings.population),
            settings.generations,
            rules,
        )
        history = np.concatenate([history, later[1:]])
    generations = len(history) - len(colony.history)
    evaluations = ants.ants * len(colony.history) + settings.population * generations
    return cell_paths.plan_of(problem, best, history, evaluations, "generations")


def _choose_first_population(
    colony: ant_colony.Colony, population: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return paths (population, cells) and their sizes: the best one, then the last ants' in
    turn.
    """
    paths = np.empty((population, colony.paths.shape[1]), np.int64)
    sizes = np.full(population, len(colony.best))
    paths[:, : len(colony.best)] = colony.best
    arrived = np.flatnonzero(colony.sizes)
    if len(arrived):
        ants = np.resize(arrived, population - 1)
        paths[1:], sizes[1:] = colony.paths[ants], colony.sizes[ants]
    return paths, sizes
