"""Ant colony optimisation followed by a genetic algorithm over the cells of a grid (ACO-GA), one of ma2020's rivals (Section 4.1).

Its reference 30 (SmartPATH) gives the scheme: ants find the first paths, and a genetic algorithm with its own crossover improves them. If
two parents share a cell, the first child gets the shorter head and the shorter tail; the second child is the second parent.
"""

from typing import Annotated, Literal

import numpy as np

from bezierplan.planners import Plan, Range, ant_colony
from bezierplan.planners.parts import cell_paths
from bezierplan.planners.parts.genetic import check_pairs
from bezierplan.workspaces.lattice import Corners, lattice, points
from bezierplan.workspaces.problem import Path, Problem

workspaces = ("grid",)
exact = True


def check(settings: dict) -> None:
    """Rules across several settings. Raises ValueError naming the setting and what is expected."""
    check_pairs(settings["population"])


def plan(
    problem: Problem,
    rng: np.random.Generator,
    *,
    corners: Corners,
    ants: Annotated[int, Range(1)],
    iterations: Annotated[int, Range(1)],
    trail_weight: Annotated[float, Range(0)],
    heuristic_weight: Annotated[float, Range(0)],
    target_heuristic: Annotated[float, Range(0)],
    initial_trail: Annotated[float, Range(0)],
    evaporation: Annotated[float, Range(0, 1)],
    deposit: Annotated[float, Range(0)],
    trail_update: Literal["ant_system", "ant_colony_system"],
    exploitation: Annotated[float, Range(0, 1)],
    local_evaporation: Annotated[float, Range(0, 1)],
    population: Annotated[int, Range(2)],
    generations: Annotated[int, Range(0)],
    crossover_probability: Annotated[float, Range(0, 1)],
    mutation_probability: Annotated[float, Range(0, 1)],
    mutation: Literal["one_cell", "reconnect"],
    longest_join: Annotated[int, Range(2)],
    elitism: Annotated[int, Range(0, 1)],
) -> Plan:
    """Shortest path over the 8-connected lattice of a grid; its objective is its length in units, infinite if there is no path.

    corners to local_evaporation: as in `ant_colony`. The first population consists of the best path of all ants and the paths of the last
    iteration's ants, repeated in turn. crossover_probability: of a pair of parents. mutation_probability: of a child; mutation: a random
    inner cell of its path is replaced by another one next to the same two cells (one_cell), or a section is reconnected through a random
    cell, within longest_join cells (reconnect). Children lose their loops. elitism: whether the best so far replaces a child.

    The history covers the iterations of the ants, then the generations. Raises ValueError if start or target is not in a free cell.
    """
    grid = problem.workspace
    places = lattice(grid, problem.start, problem.target, corners)
    first, moves = rng.spawn(2)
    colony_rules = ant_colony.Rules(
        ants=ants,
        iterations=iterations,
        trail_weight=float(trail_weight),
        heuristic_weight=float(heuristic_weight),
        target_heuristic=float(target_heuristic),
        initial_trail=float(initial_trail),
        evaporation=float(evaporation),
        deposit=float(deposit),
        best_only=trail_update == "ant_colony_system",
        exploitation=float(exploitation),
        local_evaporation=float(local_evaporation),
    )
    colony = ant_colony.search(places, first, colony_rules)
    best, history = colony.best, colony.history
    found = len(best) > 0
    if found and places.start != places.target:
        rules = cell_paths.Rules(
            float(crossover_probability),
            True,
            float(mutation_probability),
            cell_paths.ONE_CELL if mutation == "one_cell" else cell_paths.RECONNECT,
            longest_join,
            0,
            True,
            elitism,
        )
        best, later = cell_paths.evolve(moves, places, *_first_population(colony, population), generations, rules)
        history = np.concatenate([history, later[1:]])
    return Plan(
        path=Path("polyline", points(grid, problem.start, problem.target, best)) if found else None,
        objective=history[-1] * grid.cell,
        claimed_feasible=found,
        evaluations=ants * len(colony.history) + population * (len(history) - len(colony.history)),
        history=history * grid.cell,
        stop="generations" if found else "no path",
        extra={},
    )


def _first_population(colony: ant_colony.Colony, population: int) -> tuple[np.ndarray, np.ndarray]:
    """Paths (population, cells) and their sizes (population,)."""
    paths, sizes = np.empty((population, colony.paths.shape[1]), dtype=np.int64), np.full(population, len(colony.best))
    paths[:, : len(colony.best)] = colony.best
    arrived = np.flatnonzero(colony.sizes)
    if len(arrived):
        ants = np.resize(arrived, population - 1)
        paths[1:], sizes[1:] = colony.paths[ants], colony.sizes[ants]
    return paths, sizes
