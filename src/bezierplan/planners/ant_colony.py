"""Ant colony optimisation over the cells of a grid (ACO), a competing method in ma2020
(Section 4.1; its reference 28, no parameters given).

Ants walk from cell to cell, attracted by the trails of earlier ants and by the closeness of the
target. With the trail update `ant_system` all ants of an iteration lay trails (Dorigo, Maniezzo and
Colorni 1996). With `ant_colony_system` only the best path so far receives one; ants may also erode
trails and take the most attractive step outright (Dorigo and Gambardella 1997).
"""

from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Plan, Problem, Range
from bezierplan.planners.parts.cell_paths import (
    build_lattice,
    measure_length,
    plan_of,
    put,
    step_between,
)
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import NOT_NEGATIVE, SHARE, with_settings
from bezierplan.workspaces.lattice import Corners, Lattice

workspaces = ("grid",)
exact = True


TrailUpdate = IntEnum("TrailUpdate", "ant_system ant_colony_system")


class Settings(NamedTuple):
    """Settings of a colony; ma2020 names the method and gives none (Dorigo, Maniezzo and Colorni
    1996; Dorigo and Gambardella 1997).
    """

    corners: Annotated[
        Corners, About("how many of the two cells beside a diagonal step may be occupied")
    ]
    ants: Annotated[int, Range(1), About("ants of an iteration")]
    iterations: Annotated[int, Range(1), About("iterations")]
    trail_weight: Annotated[
        float, NOT_NEGATIVE, About("exponent of the trail in the attraction of a step")
    ]
    heuristic_weight: Annotated[
        float,
        NOT_NEGATIVE,
        About("exponent of the heuristic, 1 over the distance to the target in cells"),
    ]
    target_heuristic: Annotated[float, NOT_NEGATIVE, About("heuristic of the target itself")]
    initial_trail: Annotated[float, NOT_NEGATIVE, About("trail on every step at first")]
    evaporation: Annotated[float, SHARE, About("share of a trail lost per iteration")]
    deposit: Annotated[
        float,
        NOT_NEGATIVE,
        About("added, divided by a path's length in cells, to each of its steps, both ways"),
    ]
    trail_update: Annotated[
        TrailUpdate,
        About(
            "all ants lay trails, or only steps of the best path so far evaporate and receive "
            "deposit times evaporation"
        ),
    ]
    exploitation: Annotated[
        float, SHARE, About("probability q0 of taking the most attractive step")
    ]
    local_evaporation: Annotated[
        float,
        SHARE,
        About("share by which an ant moves the trail of its step back to the initial one"),
    ]


class Colony(NamedTuple):
    """Result of a colony.

    best: (n,) cells of the shortest path, empty if no ant arrived.
    history: (iterations,) the shortest length so far, in cells.
    paths: (ants, cells) those of the last iteration's ants.
    sizes: (ants,), 0 for an ant that died.
    """

    best: np.ndarray
    history: np.ndarray
    paths: np.ndarray
    sizes: np.ndarray


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest path found over the 8-connected lattice of a grid.

    An ant draws its next cell from the unvisited neighbours, in proportion to trail**trail_weight *
    heuristic**heuristic_weight. An ant with no neighbour left dies.

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
    ma2020, Section 4.1, reference 28.
    """
    places = build_lattice(problem, settings.corners)
    colony = search(places, rng, settings)
    evaluations = settings.ants * len(colony.history)
    return plan_of(problem, colony.best, colony.history, evaluations, "iterations")


def search(places: Lattice, rng: np.random.Generator, rules: Settings) -> Colony:
    """Run the search behind `plan`, for one iteration if start and target lie in the same cell."""
    distance = np.hypot(
        places.row - places.row[places.target], places.column - places.column[places.target]
    )
    # No division by 0; the target's own heuristic is a setting.
    distance[places.target] = 1.0
    heuristic = 1.0 / distance
    heuristic[places.target] = rules.target_heuristic
    if places.start == places.target:
        rules = rules._replace(iterations=1)
    return Colony(*_run_colony(rng, places, heuristic**rules.heuristic_weight, rules))


@compile_kernel
def _run_colony(rng, lattice, heuristic, rules):
    """Return the best path, the history, and the last iteration's paths with their sizes, as in
    `Colony`.

    heuristic: (cells,), with its weight applied.
    """
    cells = len(lattice.row)
    trail = np.full((cells, 8), rules.initial_trail)
    visits = np.full(cells, -1)
    paths = np.empty((rules.ants, cells), np.int64)
    sizes = np.empty(rules.ants, np.int64)
    best, best_size, best_length = np.empty(cells, np.int64), 0, np.inf
    history = np.empty(rules.iterations)

    for iteration in range(rules.iterations):
        for ant in range(rules.ants):
            sizes[ant] = _walk(
                rng,
                lattice,
                trail,
                heuristic,
                rules,
                paths[ant],
                visits,
                iteration * rules.ants + ant,
            )
            if sizes[ant]:
                walked = measure_length(paths[ant, : sizes[ant]], lattice)
                if walked < best_length:
                    best_size, best_length = put(paths[ant, : sizes[ant]], best, 0), walked
        history[iteration] = best_length
        # Nobody walks after the last iteration, so its trails need no update.
        if iteration == rules.iterations - 1:
            break

        if rules.trail_update == TrailUpdate.ant_colony_system:
            for k in range(1, best_size):
                _lay(
                    lattice,
                    trail,
                    best[k - 1],
                    best[k],
                    1.0 - rules.evaporation,
                    rules.evaporation * rules.deposit / best_length,
                )
        else:
            # All trails evaporate before any ant lays a new one.
            for cell in range(cells):
                for step in range(8):
                    trail[cell, step] *= 1.0 - rules.evaporation
            for ant in range(rules.ants):
                if sizes[ant]:
                    amount = rules.deposit / measure_length(paths[ant, : sizes[ant]], lattice)
                    for k in range(1, sizes[ant]):
                        _lay(lattice, trail, paths[ant, k - 1], paths[ant, k], 1.0, amount)
    return best[:best_size], history, paths, sizes


@compile_kernel
def _walk(rng, lattice, trail, heuristic, rules, path, visits, ant):
    """Let an ant walk, write its path and return the size, or 0 if the ant dies.

    visits: (cells,) the number of the last ant that visited each cell; so it need not be cleared.
    """
    steps, attraction = np.empty(8, np.int64), np.empty(8)
    cell = lattice.start
    path[0] = cell
    visits[cell] = ant
    size = 1
    while cell != lattice.target:
        open_steps = 0
        for step in range(8):
            neighbour = lattice.neighbours[cell, step]
            if neighbour >= 0 and visits[neighbour] != ant:
                steps[open_steps] = step
                weighted = trail[cell, step]
                # Taking the power costs as much as the rest of a step.
                if rules.trail_weight != 1.0:
                    weighted **= rules.trail_weight
                attraction[open_steps] = weighted * heuristic[neighbour]
                open_steps += 1
        if open_steps == 0:
            return 0
        neighbour = lattice.neighbours[
            cell, steps[_choose(rng, attraction[:open_steps], rules.exploitation)]
        ]
        if rules.local_evaporation > 0:
            _lay(
                lattice,
                trail,
                cell,
                neighbour,
                1.0 - rules.local_evaporation,
                rules.local_evaporation * rules.initial_trail,
            )
        cell = neighbour
        path[size] = cell
        visits[cell] = ant
        size += 1
    return size


@allocation_free
def _choose(rng, attraction, exploitation):
    """Draw a random index of an array (n,), in proportion to its values, or uniform if all are 0.

    With the probability `exploitation` it is the index of the largest value.
    """
    # No number is drawn without exploitation, which the ant system does not have.
    if exploitation > 0 and rng.random() < exploitation:
        return np.argmax(attraction)
    total = attraction.sum()
    if total == 0:
        return draw_integer(rng, 0, len(attraction))
    draw = rng.random() * total
    for k in range(len(attraction) - 1):
        draw -= attraction[k]
        if draw < 0:
            return k
    # Rounding can leave a rest of the draw after the last but one; it belongs to the last.
    return len(attraction) - 1


@allocation_free
def _lay(lattice, trail, one, other, rest, deposit):
    """Keep a share of a step's trail and add to it, in both directions."""
    there, back = step_between(lattice, one, other), step_between(lattice, other, one)
    trail[one, there] = rest * trail[one, there] + deposit
    trail[other, back] = rest * trail[other, back] + deposit
