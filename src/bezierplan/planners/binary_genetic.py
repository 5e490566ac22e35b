"""Genetic algorithm over the cells of a grid, each control point a binary cell number (song2016,
Section III).

A chromosome is the sequence of the free control points between start and target. Every control
point is the centre of a cell, free or occupied; only the samples of the curve are tested. Cells are
numbered so that every bit string is a cell (`grid.embed`); no operator can leave the workspace.
Lengths in the kernels are in cells.

The objective is a sum over stretches of the curve: runs of samples that depend on the same few
control points (four of eight for cubic pieces). A stretch that a child inherits whole from a
parent keeps the parent's length, which changes no result.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry import curves
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.genetic import (
    breed,
    check_curve,
    check_pairs,
    complement_bit,
    copy,
    is_same,
)
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import (
    NOT_NEGATIVE,
    SHARE,
    UNITS,
    convert_to_cells,
    with_settings,
)
from bezierplan.workspaces.grid import ON_LINE, Grid, embed

extra = ("bad_samples",)
# A run that reports its last generation can lose the best path.
keeps_best = False
workspaces = ("grid",)

Curve = IntEnum("Curve", "polyline piecewise_quadratic piecewise_cubic bezier")
Spacing = IntEnum("Spacing", "parameter arc_length")
Cut = IntEnum("Cut", "bit gene")
Mutation = IntEnum("Mutation", "one_bit each_gene each_bit")
PenaltyFor = IntEnum("PenaltyFor", "each_sample path per_cell")
Report = IntEnum("Report", "best_so_far last_generation")
Rejection = IntEnum("Rejection", "all consecutive harmless none")


class Settings(NamedTuple):
    """Settings of the search (song2016, Sections III and IV)."""

    curve: Annotated[Curve, About("kind of curve", "song2016, Section III")]
    genes: Annotated[
        int,
        Range(0, 60),
        About("free control points, beside start and target", "song2016, Section IV"),
    ]
    samples: Annotated[
        int, Range(2), About("points of the curve tested and measured, both ends included")
    ]
    spacing: Annotated[
        Spacing, About("samples are uniform in the parameter, or (polylines) along the path")
    ]
    population: Annotated[
        int, Range(2), About("chromosomes of a generation", "song2016, Section IV")
    ]
    generations: Annotated[
        int, NOT_NEGATIVE, About("generations after the first", "song2016, Section IV")
    ]
    crossover_probability: Annotated[
        float, SHARE, About("of a pair of parents", "song2016, Section IV")
    ]
    cut: Annotated[Cut, About("the crossover point lies before any bit, or only between genes")]
    mutation_probability: Annotated[
        float, SHARE, About("of a chromosome, a gene or a bit", "song2016, Section IV")
    ]
    mutation: Annotated[
        Mutation,
        About(
            "a bit of a chromosome is complemented, one of each gene, or each",
            "song2016, Section III-E",
        ),
    ]
    elitism: Annotated[int, SHARE, About("how many of the best so far replace a chromosome")]
    penalty: Annotated[
        float, NOT_NEGATIVE, About("added for occupied samples", "song2016, Section IV", UNITS)
    ]
    penalty_for: Annotated[
        PenaltyFor,
        About(
            "each sample in an occupied cell, once a path with any, or each time that samples "
            "enter an occupied cell",
            "song2016, Sections III-D and IV",
        ),
    ]
    occupied_point_penalty: Annotated[
        float, NOT_NEGATIVE, About("added for each control point in an occupied cell", unit=UNITS)
    ]
    report: Annotated[
        Report,
        About(
            "best path of all generations, or of the last one, and then the history is the best of "
            "each generation"
        ),
    ]
    rejection: Annotated[
        Rejection,
        About(
            "which control points of the final path are rejected because they coincide with "
            "another: all, those next to each other, all if no more samples then lie in occupied "
            "cells, or none",
            "song2016, Remark 3",
        ),
    ]


def check(settings: dict) -> None:
    """Raise ValueError, naming the setting and what is expected, unless settings that depend on
    each other fit together.
    """
    check_curve(settings, "genes")
    check_pairs(settings)
    if settings["spacing"] == "arc_length" and settings["curve"] != "polyline":
        raise ValueError("spacing: arc_length; only a polyline has it, other curves need parameter")


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest penalised curve found through free control points.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        The path without the control points that are rejected; `objective` is that of the best
        chromosome, which has them. `claimed_feasible`: no sample in an occupied cell. Extra column:
        bad_samples, the number of samples in occupied cells.

    References
    ----------
    song2016, Sections III and IV.
    """
    grid = problem.workspace
    occupied = embed(grid.occupied)
    # Start and target need not be centres of cells: they are two additional cells with their own
    # numbers.
    row, column = np.indices(occupied.shape).reshape(2, -1)
    places = np.vstack(
        [
            np.column_stack([column, row]) + 0.5,
            grid.in_cells(problem.ends),
        ]
    )
    ends = [occupied.size, occupied.size + 1]
    starts, moves = rng.spawn(2)
    if settings.genes == 0 or problem.start == problem.target:
        # No search needed: one chromosome, the straight line or the point.
        settings = settings._replace(population=1, generations=0, occupied_point_penalty=0.0)
        cells = np.full((1, settings.genes + 2), ends[0])
    else:
        cells = np.empty((settings.population, settings.genes + 2), np.int64)
        cells[:, 1:-1] = starts.integers(
            0, occupied.size, size=(settings.population, settings.genes)
        )
    cells[:, 0], cells[:, -1] = ends

    curve = Curve(settings.curve).name
    basis = curves.sample_matrix(curve, settings.genes + 2, settings.samples)
    by_arc_length = settings.spacing == Spacing.arc_length
    measured = _Curve(
        basis=np.ascontiguousarray(basis.T),
        stretches=np.array([[0, settings.genes + 1, 0, settings.samples - 1]])
        if by_arc_length
        else find_stretches(basis),
        by_arc_length=by_arc_length,
    )
    best, best_bad, history = _search(
        moves, cells, occupied, places, measured, convert_to_cells(settings, grid.cell)
    )
    points = grid.in_units(places[best])
    # Start and target went into cells and back, which can change their last bits.
    points[[0, -1]] = problem.ends
    path = Path(curve, points)
    rest = drop_repeated_points(points, settings.rejection == Rejection.consecutive)
    if settings.rejection != Rejection.none and len(rest) < len(points):
        # Too few points for pieces of this degree define one piece of a lower degree.
        shorter = Path(curve if len(rest) >= curves.least_points(curve) else "bezier", rest)
        # Without a point the curve changes, so its samples are tested again.
        bad = _count_bad_samples(shorter, grid, occupied, settings.samples)
        if bad <= best_bad or settings.rejection != Rejection.harmless:
            path, best_bad = shorter, bad
    return Plan(
        path=path,
        objective=history[-1] * grid.cell,
        claimed_feasible=best_bad == 0,
        evaluations=settings.population * (settings.generations + 1),
        history=history * grid.cell,
        stop="generations",
        extra={"bad_samples": int(best_bad)},
    )


def drop_repeated_points(points: np.ndarray, consecutive: bool = False) -> np.ndarray:
    """Return control points (n, 2) without repetitions, (m, 2) (song2016, Remark 3).

    Start and target stay, and of equal inner points the first. With `consecutive`, only points that
    follow each other count as equal.

    >>> points = np.array([[0, 0], [0, 0], [2, 1], [3, 1], [2, 1], [4, 0]])
    >>> drop_repeated_points(points).tolist()
    [[0, 0], [2, 1], [3, 1], [4, 0]]
    >>> drop_repeated_points(points, consecutive=True).tolist()
    [[0, 0], [2, 1], [3, 1], [2, 1], [4, 0]]
    """
    start, *inner, target = map(tuple, points.tolist())
    if consecutive:
        inner = [point for point, before in zip(inner, [start, *inner]) if point != before]
        rest = inner[:-1] if inner[-1:] == [target] else inner
    else:
        rest = [point for point in dict.fromkeys(inner) if point not in (start, target)]
    return np.array([start, *rest, target])


def _count_bad_samples(path: Path, grid: Grid, occupied: np.ndarray, samples: int) -> int:
    """Count the samples of a path that lie in occupied cells."""
    basis = curves.sample_matrix(path.curve, len(path.points), samples)
    column, row = np.floor(grid.in_cells(basis @ path.points) + ON_LINE).astype(int).T
    return int(occupied[row, column].sum())


def find_stretches(basis: np.ndarray) -> np.ndarray:
    """Find runs of chords between samples whose two ends depend on the same control points.

    basis: (samples, control points), the curve's linear map.

    Returns (stretches, 4): first and last control point, first and last sample.
    """
    used = basis != 0
    first, last = used.argmax(axis=1), basis.shape[1] - 1 - used[:, ::-1].argmax(axis=1)
    support = np.column_stack([np.minimum(first[:-1], first[1:]), np.maximum(last[:-1], last[1:])])
    begins = np.flatnonzero(np.any(support[1:] != support[:-1], axis=1)) + 1
    begins = np.concatenate([[0], begins, [len(support)]])
    return np.column_stack([support[begins[:-1]], begins[:-1], begins[1:]])


class _Curve(NamedTuple):
    """How chromosomes are measured.

    basis: (control points, samples), the curve's linear map.
    stretches: found by `find_stretches`.
    """

    basis: np.ndarray
    stretches: np.ndarray
    by_arc_length: bool


@compile_kernel
def _search(rng, cells, occupied, places, curve, rules):
    """Run the genetic algorithm; return the best chromosome's cells, its number of samples in
    occupied cells, and the history.

    The history (generations + 1,) holds the best objective so far, or of each generation.

    cells: (population, control points) numbers of cells.
    places: (cells + 2, 2) the cells' centres, then start and target, in cells.
    """
    population = len(cells)
    basis, stretches = curve.basis, curve.stretches
    # The logarithm of a power of 2 may be a rounding error off.
    bits = int(np.log2(occupied.size) + 0.5)
    # By stretch: its length, how many samples lie in occupied cells, and how often they enter one.
    found = np.empty((population, len(stretches), 3))
    parent_found = np.empty_like(found)
    # The first generation inherits nothing.
    parents = np.full_like(cells, -1)
    draws = np.zeros(population, np.int64)
    objective = np.empty(population)
    best, best_objective, best_bad = cells[0].copy(), np.inf, 0.0
    history = np.empty(rules.generations + 1)
    # Flat, so that kernels look up a cell by its number.
    by_number, columns, samples = occupied.ravel(), occupied.shape[1], basis.shape[1]
    scratch = (
        np.empty(samples),
        np.empty(samples),
        np.empty(samples),
        np.empty(samples, np.int32),
    )

    for generation in range(rules.generations + 1):
        if rules.report == Report.last_generation:
            # Elitism brings the best of the generation before, so this one is never worse.
            best_objective = np.inf
        for i in range(population):
            mother, father = draws[i - i % 2], draws[min(i | 1, population - 1)]
            length = count = visits = 0.0
            for k in range(len(stretches)):
                first, last = stretches[k, 0], stretches[k, 1] + 1
                own, measures = cells[i, first:last], found[i, k]
                # Both parents of the pair: a crossover gives a child parts of either.
                for parent in (mother, father):
                    if is_same(own, parents[parent, first:last]):
                        copy(parent_found[parent, k], measures)
                        break
                else:
                    measures[0], measures[1], measures[2] = (
                        _measure_by_arc_length(cells[i], occupied, places, samples)
                        if curve.by_arc_length
                        else _measure(
                            cells[i],
                            by_number,
                            columns,
                            places,
                            basis,
                            stretches[k],
                            scratch,
                            rules.penalty_for == PenaltyFor.per_cell,
                        )
                    )
                length += measures[0]
                count += measures[1]
                visits += measures[2]
                objective[i] = length + rules.penalty * _count_penalties(
                    count, visits, rules.penalty_for
                )
                # No other stretch makes it smaller, and only parents need to be measured in full.
                if generation == rules.generations and objective[i] >= best_objective:
                    break
            if rules.occupied_point_penalty > 0:
                for cell in cells[i, 1:-1]:
                    objective[i] += rules.occupied_point_penalty * by_number[cell]
            if objective[i] < best_objective:
                copy(cells[i], best)
                best_objective, best_bad = objective[i], count
        history[generation] = best_objective
        if generation == rules.generations:
            break

        parents, cells = cells, parents
        parent_found, found = found, parent_found
        unit = bits if rules.cut == Cut.gene else 1
        draws = breed(rng, parents, objective, cells, 1, rules.crossover_probability, unit, bits)
        for i in range(population):
            _mutate(rng, cells[i, 1:-1], bits, rules.mutation_probability, rules.mutation)
        if rules.elitism:
            copy(best, cells[0])
    return best, best_bad, history


@allocation_free
def _count_penalties(bad, entries, penalty_for):
    """Return how often the penalty is added for so many samples in occupied cells and so many
    entries into them (song2016, eq. 9).
    """
    if penalty_for == PenaltyFor.each_sample:
        return bad
    if penalty_for == PenaltyFor.per_cell:
        return entries
    return min(bad, 1.0)


@allocation_free
def _mutate(rng, genes, bits, probability, mutation):
    """Complement random bits of a chromosome in place (song2016, Section III-E: `one_bit`)."""
    if mutation == Mutation.one_bit:
        if rng.random() < probability:
            complement_bit(genes, draw_integer(rng, 0, bits * len(genes)), bits)
    elif mutation == Mutation.each_gene:
        for gene in range(len(genes)):
            if rng.random() < probability:
                complement_bit(genes, gene * bits + draw_integer(rng, 0, bits), bits)
    else:
        for position in range(bits * len(genes)):
            if rng.random() < probability:
                complement_bit(genes, position, bits)


@allocation_free
def _measure(cells, occupied, columns, places, basis, stretch, scratch, with_entries):
    """Measure one stretch of a curve.

    Returns its length in cells, the number of its samples in occupied cells, not counting the
    first, and how often they enter one, 0 if it is not requested. Start and target lie in free
    cells, so no sample is missed.

    occupied: (cells,), of a grid with so many columns.
    basis: (control points, samples).
    scratch: three arrays (samples,) of numbers and one of whole numbers.
    """
    first_point, last_point, first, last = stretch
    x, y, chords, numbers = scratch
    samples = last - first + 1
    for s in range(samples):
        x[s] = y[s] = 0.0
    for p in range(first_point, last_point + 1):
        weights = basis[p, first : last + 1]
        column, row = places[cells[p], 0], places[cells[p], 1]
        for s in range(samples):
            x[s] += weights[s] * column
            y[s] += weights[s] * row
    # What vector instructions can do comes first: they make whole numbers of 32 bits only. Then the
    # sum, in its order, which waits so long for each addition that cells are looked up meanwhile.
    for s in range(samples):
        numbers[s] = np.int32(y[s] + ON_LINE) * columns + np.int32(x[s] + ON_LINE)
    for s in range(samples - 1):
        chords[s] = np.sqrt((x[s + 1] - x[s]) ** 2 + (y[s + 1] - y[s]) ** 2)
    length, bad = 0.0, 0
    for s in range(samples - 1):
        length += chords[s]
        bad += occupied[numbers[s + 1]]
    entries = 0
    if with_entries:
        for s in range(samples - 1):
            entries += occupied[numbers[s + 1]] and numbers[s + 1] != numbers[s]
    return length, bad, entries


@compile_kernel
def _measure_by_arc_length(cells, occupied, places, samples):
    """Measure a polyline at samples that are equally spaced along it.

    Returns its length in cells, the number of samples that lie in occupied cells, and how often
    they enter one.
    """
    points = len(cells)
    x, y, passed = np.empty(points), np.empty(points), np.zeros(points)
    for p in range(points):
        x[p], y[p] = places[cells[p], 0], places[cells[p], 1]
        if p:
            passed[p] = passed[p - 1] + np.sqrt((x[p] - x[p - 1]) ** 2 + (y[p] - y[p - 1]) ** 2)
    bad = entries = 0
    last_row, last_column = int(y[0] + ON_LINE), int(x[0] + ON_LINE)
    p = 0
    for s in range(1, samples):
        along = passed[-1] * s / (samples - 1)
        while p < points - 2 and along > passed[p + 1]:
            p += 1
        edge = passed[p + 1] - passed[p]
        # A leg of length 0 has no shares, and rounding must not lead beyond its end.
        share = min((along - passed[p]) / edge, 1.0) if edge > 0 else 1.0
        row = int(y[p] + share * (y[p + 1] - y[p]) + ON_LINE)
        column = int(x[p] + share * (x[p + 1] - x[p]) + ON_LINE)
        bad += occupied[row, column]
        entries += occupied[row, column] and (row != last_row or column != last_column)
        last_row, last_column = row, column
    return passed[-1], bad, entries
