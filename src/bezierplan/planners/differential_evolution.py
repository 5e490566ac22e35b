"""Differential evolution of a curve's free control points: the generic optimiser beside which the
papers' searches are measured (Storn and Price 1997, DE/rand/1/bin).

A vector is (x_1, ..., x_n, y_1, ..., y_n), the coordinates of the n free control points. Curve,
samples and penalty are those of the method that it is compared with: depth in circles or polygons
(tharwat2018), samples in occupied cells (song2016), or chords through them (ma2020; elhoseny2017,
where such a path is deleted). In the kernels coordinates are in cells, or units where there are no
cells.
"""

import math
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import find_cell_at
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.bca import count_collisions
from bezierplan.planners.parts import penalised
from bezierplan.planners.parts.genetic import check_curve, copy
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import NOT_NEGATIVE, UNITS, convert_to_cells, with_settings
from bezierplan.workspaces.grid import ON_LINE, Grid

workspaces = ("circles", "polygons", "grid")

Curve = IntEnum("Curve", "bezier piecewise_quadratic piecewise_cubic")
Collision = IntEnum("Collision", "samples chords")


class Settings(NamedTuple):
    """Settings of the search, and of the objective that it shares with a paper's method."""

    population: Annotated[
        int, Range(4), About("NP, vectors of a generation", "Storn and Price 1997")
    ]
    generations: Annotated[
        int, NOT_NEGATIVE, About("generations after the first", "Storn and Price 1997")
    ]
    weight: Annotated[
        float, Range(0, 2), About("F, factor of the difference", "Storn and Price 1997")
    ]
    crossover: Annotated[
        float,
        Range(0, 1),
        About("CR, probability of a mutant's coordinate", "Storn and Price 1997"),
    ]
    curve: Annotated[Curve, About("kind of curve")]
    control_points: Annotated[
        int, Range(1, 60), About("free control points, beside start and target")
    ]
    samples: Annotated[
        int,
        Range(2),
        About(
            "points of the curve tested and measured, uniform in the parameter, both ends included"
        ),
    ]
    collision: Annotated[
        Collision,
        About(
            "the violation on a grid: the number of samples in occupied cells, or the share that "
            "lie in one or end a chord through one; elsewhere the depth of tharwat2018, eq. 21"
        ),
    ]
    factor: Annotated[
        float, NOT_NEGATIVE, About("length added for the violation, as a multiple of it")
    ]
    collision_penalty: Annotated[float, NOT_NEGATIVE, About("added for the violation", unit=UNITS)]
    surcharge: Annotated[
        float,
        Range(0, math.inf),
        About("added to a path in collision; infinite: it is deleted", unit=UNITS),
    ]


def check(settings: dict) -> None:
    """Raise ValueError, naming the setting and what is expected, unless settings that depend on
    each other fit together.
    """
    check_curve(settings, "control_points")


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest penalised curve found, its free control points anywhere in the field.

    Parameters
    ----------
    problem : Problem
        On a grid, or among circles or polygons.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        `claimed_feasible`: no violation.

    References
    ----------
    Storn and Price (1997), Differential evolution, Journal of Global Optimization 11.
    """
    world = problem.workspace
    cells = isinstance(world, Grid)
    origin, cell = (np.array(world.origin), world.cell) if cells else (np.zeros(2), 1.0)
    rules = convert_to_cells(settings, cell)
    ends = (problem.ends - origin) / cell
    low, high = (np.reshape(world.bounds, (2, 2)).T - origin) / cell
    curve = Curve(rules.curve).name
    of_ends, of_free = penalised.compute_basis(curve, rules.control_points, rules.samples)
    objective = penalised.Objective(
        ends=ends.T @ of_ends,
        free=of_free,
        balls=penalised.round_obstacles(world, 0.0),
        polygons=penalised.grow_polygons(world, 0.0),
        # Of the objective only the measures are used: `_compute_cost` has penalties of its own.
        penalty=int(penalised.Penalty.multiply),
        beta=rules.factor,
    )
    occupied = np.array(world.occupied) if cells else np.empty((0, 0), bool)

    # Moves have a generator of their own, so they do not depend on how much the first vectors drew.
    starts, moves = rng.spawn(2)
    low, high = low.repeat(rules.control_points), high.repeat(rules.control_points)
    x = low + (high - low) * starts.random((rules.population, len(low)))
    best, history, violation = _evolve(moves, x, low, high, objective, occupied, rules)
    free = best.reshape(2, -1).T * cell + origin
    return Plan(
        path=Path(curve, np.vstack([problem.start, free, problem.target])),
        objective=history[-1] * cell,
        claimed_feasible=violation <= penalised.FEASIBLE,
        evaluations=rules.population * (rules.generations + 1),
        history=history * cell,
        stop="generations",
        extra={},
    )


@compile_kernel
def _evolve(rng, x, low, high, objective, occupied, rules):
    """Run DE/rand/1/bin; return the best vector (2 n,), the history, and the vector's violation.

    The history (generations + 1,) holds the lowest cost after each generation.

    x: (population, 2 n), the first generation; overwritten.
    low, high: (2 n,), the field, at whose border coordinates are held.
    objective: measures the curve's samples among circles or polygons.
    occupied: bool (rows, columns), (0, 0) where there are no cells.
    """
    population, dimensions = x.shape
    samples = objective.free.shape[1]
    scratch = np.empty((2, samples)), np.empty(samples)
    cost, violation, trials = np.empty(population), np.empty(population), np.empty_like(x)
    history = np.empty(rules.generations + 1)
    for i in range(population):
        cost[i], violation[i] = _compute_cost(x[i], objective, occupied, rules, scratch)
    history[0] = cost.min()
    for generation in range(1, rules.generations + 1):
        for i in range(population):
            a, b, c = _draw_three_others(rng, i, population)
            # One coordinate always comes from the mutant, or a trial could equal its parent.
            forced = draw_integer(rng, 0, dimensions)
            for k in range(dimensions):
                trials[i, k] = x[i, k]
                if rng.random() < rules.crossover or k == forced:
                    mutant = x[a, k] + rules.weight * (x[b, k] - x[c, k])
                    trials[i, k] = min(max(mutant, low[k]), high[k])
        for i in range(population):
            # Selection waits until all trials are made, so each is made of the old generation.
            value, violated = _compute_cost(trials[i], objective, occupied, rules, scratch)
            # A trial that is as good replaces its parent, so the search can cross a plateau.
            if value <= cost[i]:
                copy(trials[i], x[i])
                cost[i], violation[i] = value, violated
        history[generation] = cost.min()
    best = cost.argmin()
    return x[best], history, violation[best]


@allocation_free
def _draw_three_others(rng, i, population):
    """Draw the numbers of three different vectors, none of which is `i`."""
    a = b = c = i
    while a == i:
        a = draw_integer(rng, 0, population)
    while b in (i, a):
        b = draw_integer(rng, 0, population)
    while c in (i, a, b):
        c = draw_integer(rng, 0, population)
    return a, b, c


@allocation_free
def _compute_cost(vector, objective, occupied, rules, scratch):
    """Return the length with what its violation adds, and the violation."""
    curve, chords = scratch
    penalised.write_curve(vector, objective, curve)
    length = penalised.measure_length(curve, chords)
    if len(occupied) == 0:
        violation = penalised.measure_violation(curve, objective, chords)[0]
    elif rules.collision == Collision.samples:
        violation = float(_count_samples_in_occupied_cells(curve, occupied))
    else:
        violation = count_collisions(curve[0], curve[1], occupied) / curve.shape[1]
    cost = length * (1.0 + rules.factor * violation) + rules.collision_penalty * violation
    return cost + (rules.surcharge if violation > penalised.FEASIBLE else 0.0), violation


@allocation_free
def _count_samples_in_occupied_cells(curve, occupied):
    """Count the samples (2, samples) after the first in occupied cells (song2016, eq. 9)."""
    bad = 0
    for s in range(1, curve.shape[1]):
        column, row = find_cell_at(curve[0, s] + ON_LINE, curve[1, s] + ON_LINE, occupied)
        bad += occupied[row, column]
    return bad
