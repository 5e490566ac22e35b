"""Genetic algorithm for the control points of one Bézier curve on a grid: the shortest curve (BCA),
or one that also keeps a safety distance from the obstacles (BCA-Q) (ma2020, Section 3).

A chromosome is the sequence of the free control points, each gene the binary number of a free cell;
cells are numbered row by row from the top left (ma2020, eqs. 10 and 11, the latter with the sign
that stays on the map). Lengths in the kernels are in cells.

Every form of the fitness is expressed as a cost, its reciprocal: the roulette uses 1 / cost, and
the lowest cost is the best.
"""

import math
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import find_cell_at, sum_of_steps
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts.genetic import (
    breed,
    change_gene,
    check_curve,
    check_pairs,
    copy,
    flip_bit,
    is_same,
)
from bezierplan.planners.parts.penalised import compute_basis, write_curve
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import (
    NOT_NEGATIVE,
    SHARE,
    UNITS,
    convert_to_cells,
    with_settings,
)
from bezierplan.workspaces.grid import ON_LINE, Grid

extra = ("bad_samples", "safety_term")
workspaces = ("grid",)

CurveKind = IntEnum("CurveKind", "bezier piecewise_quadratic")
Initial = IntEnum("Initial", "uniform sorted feasible")
Fitness = IntEnum(
    "Fitness", "length repaired literal_weights hard_safety reciprocal_literal as_printed"
)
FitnessFeasible = IntEnum("FitnessFeasible", "collision_free clearance")
Mutation = IntEnum("Mutation", "bit_flip cell per_gene")

# Maximum number of draws of a chromosome until its curve is free.
_FEASIBLE_TRIES = 200
# If a chord crosses two grid lines at parameters that differ by less than this, it crosses them at
# their common corner.
_AT_CORNER = 1e-12


class Settings(NamedTuple):
    """Settings of the search (ma2020, Sections 3 and 4).

    Notes
    -----
    With the length L, c of n samples in collision, G = L (1 + collision_factor c / n) +
    collision_surcharge [c > 0], the weights w1 = length_weight and w2 = safety_weight, the straight
    distance D and the safety term F of eq. 14 (1 for c > 0), the cost is

        length              G (BCA)
        repaired            w1 G / D + w2 F (BCA-Q)
        literal_weights     w1 G + w2 F
        hard_safety         G + collision_surcharge F
        reciprocal_literal  L of a feasible path, w1 L + w2 F of the others
        as_printed          1 / L of a feasible path, w1 L + w2 F of the others (eq. 12)
    """

    curve: Annotated[
        CurveKind, About("one Bézier curve, or a chain of quadratic pieces", "ma2020, eqs. 1, 6")
    ]
    control_points: Annotated[
        int, Range(0, 60), About("free control points, beside start and target")
    ]
    samples: Annotated[
        int,
        Range(2),
        About(
            "points of the curve tested and measured, uniform in the parameter, both ends included"
        ),
    ]
    initial: Annotated[
        Initial,
        About(
            "genes are free cells drawn uniformly; "
            "also sorted by x + y; or redrawn until the curve is free"
        ),
    ]
    population: Annotated[int, Range(2), About("chromosomes of a generation", "ma2020, Section 4")]
    generations: Annotated[
        int, NOT_NEGATIVE, About("generations after the first", "ma2020, Section 4")
    ]
    crossover_probability: Annotated[
        float,
        SHARE,
        About("of a pair of parents", "ma2020, Section 4"),
    ]
    mutation_probability: Annotated[
        float,
        SHARE,
        About("of a chromosome, or (per_gene) of each gene", "ma2020, Section 4"),
    ]
    mutation: Annotated[
        Mutation,
        About(
            "a gene's bit is flipped such that it stays a free cell, it becomes a random free "
            "cell, or a bit of each is flipped"
        ),
    ]
    elitism: Annotated[int, SHARE, About("how many of the best so far replace a chromosome")]
    fitness: Annotated[
        Fitness,
        About("form of the cost, whose reciprocal is the fitness", "ma2020, eqs. 12 to 14"),
    ]
    fitness_feasible: Annotated[
        FitnessFeasible,
        About(
            "feasible in the last two forms: free of collisions, or also clear by safety_distance"
        ),
    ]
    length_weight: Annotated[float, Range(1e-6), About("w1", "ma2020, eq. 12")]
    safety_weight: Annotated[float, NOT_NEGATIVE, About("w2", "ma2020, eq. 12")]
    safety_distance: Annotated[
        float, NOT_NEGATIVE, About("distance to keep from obstacles", "ma2020, eq. 14", UNITS)
    ]
    collision_factor: Annotated[
        float,
        NOT_NEGATIVE,
        About("length added for samples in collision, as a multiple of their share"),
    ]
    collision_surcharge: Annotated[
        float, NOT_NEGATIVE, About("added to a path with a collision", unit=UNITS)
    ]


def check(settings: dict) -> None:
    """Raise ValueError, naming the setting and what is expected, unless settings that depend on
    each other fit together.
    """
    check_pairs(settings)
    check_curve(settings, "control_points")


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the best curve found whose free control points are centres of free cells.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        `claimed_feasible`: no sample collides. Extra columns: bad_samples, the number of colliding
        samples; safety_term, the path's F.

    Raises
    ------
    ValueError
        If the map has no free cell.

    References
    ----------
    ma2020, Sections 3.2 to 3.4.
    """
    grid = problem.workspace
    if problem.start == problem.target:
        # Start and target coincide: there is no length to minimise and no distance to divide by.
        point = Path("bezier", problem.ends)
        return Plan.of_one(point, 0.0, "generations", {"bad_samples": 0, "safety_term": 0.0})
    if settings.control_points == 0:
        # No search needed: one chromosome, the straight line.
        settings = settings._replace(population=1, generations=0)
    rules = convert_to_cells(settings, grid.cell)
    curve = CurveKind(settings.curve).name
    cells = _prepare_cells(grid, math.ceil(rules.safety_distance))
    ends, free = compute_basis(curve, settings.control_points, settings.samples)
    sampled = _Curve(
        grid.in_cells(problem.ends).T @ ends,
        free,
        math.dist(*problem.ends) / grid.cell,
        grid.cell,
        np.empty(2 * settings.control_points),
        np.empty((2, settings.samples)),
        np.empty(settings.samples),
    )
    # Moves have a generator of their own: they do not depend on how often first curves are redrawn.
    starts, moves = rng.spawn(2)
    codes = cells.free[
        starts.integers(0, len(cells.free), size=(settings.population, settings.control_points))
    ]
    if settings.initial == Initial.sorted:
        along = cells.centres[codes].sum(axis=2)
        codes = np.take_along_axis(codes, along.argsort(axis=1, kind="stable"), axis=1)
    elif settings.initial == Initial.feasible:
        _redraw(starts, codes, cells, sampled)

    best, history = _search(moves, codes, cells, sampled, rules)
    # The search measures the clearance only if the fitness asks for it, the table has it always.
    _, bad, clearance = _measure(best, cells, sampled, True)
    points = np.vstack([problem.start, grid.in_units(cells.centres[best]), problem.target])
    return Plan(
        path=Path(curve, points),
        objective=history[-1],
        claimed_feasible=bad == 0,
        evaluations=settings.population * (settings.generations + 1),
        history=history,
        stop="generations",
        extra={
            "bad_samples": int(bad),
            "safety_term": _compute_safety_term(bad, clearance, rules.safety_distance),
        },
    )


class _Cells(NamedTuple):
    """The grid for the kernels, x along columns and y along rows, in cells.

    occupied: bool (rows, columns), bottom row first.
    centres: (cells, 2), by code.
    legal: bool (2**bits,), whether a code stands for a free cell.
    free: the codes of the free cells.
    near: (n, 2), column and row of occupied cells; near[first[i] : first[i + 1]] with i = columns
        row + column may lie within the safety distance of a point in the cell (row, column).
    """

    occupied: np.ndarray
    centres: np.ndarray
    legal: np.ndarray
    free: np.ndarray
    near: np.ndarray
    first: np.ndarray


class _Curve(NamedTuple):
    """Samples of a curve as a linear map of its control points, and room for one curve.

    ends: (2, samples), x and y contributions of start and target to the samples, in cells.
    free: (control points, samples), the weights of the free control points.
    straight: distance from start to target, in cells.
    cell: side of a cell, in units.
    points, samples, chords: (2 control points,), (2, samples) and (samples,), overwritten by each
        curve that is measured.
    """

    ends: np.ndarray
    free: np.ndarray
    straight: float
    cell: float
    points: np.ndarray
    samples: np.ndarray
    chords: np.ndarray


def list_code_centres(rows: int, columns: int) -> np.ndarray:
    """Return the centres (cells, 2) of the cells by code, in cells.

    Codes count row by row from the top left, from 0 (ma2020, eqs. 10 and 11, which count from 1).

    >>> list_code_centres(2, 2).tolist()
    [[0.5, 1.5], [1.5, 1.5], [0.5, 0.5], [1.5, 0.5]]
    """
    down, along = np.indices((rows, columns)).reshape(2, -1)
    return np.column_stack([along + 0.5, rows - down - 0.5])


def _prepare_cells(grid: Grid, reach: int) -> _Cells:
    """Prepare the grid for the kernels.

    reach: `near` holds the occupied cells at most so many columns and rows away.

    Raises ValueError if no cell is free.
    """
    rows, columns = grid.occupied.shape
    # As many codes as the shortest bit strings for all cells have; the rest stand for none.
    legal = np.zeros(1 << (rows * columns - 1).bit_length(), bool)
    legal[: rows * columns] = ~grid.occupied[::-1].ravel()
    free = np.flatnonzero(legal)
    if not len(free):
        raise ValueError("all cells are occupied; expected a free cell for the control points")
    # No window is wider than the map.
    reach = min(reach, max(rows, columns))
    # A list for each cell: distances are then measured to a few cells, not to all occupied ones.
    around = np.lib.stride_tricks.sliding_window_view(
        np.pad(grid.occupied, reach), (2 * reach + 1, 2 * reach + 1)
    )
    row, column, up, right = np.nonzero(around)
    near = np.column_stack([column + right - reach, row + up - reach])
    # The occupied cells around a cell follow each other, for `nonzero` goes cell by cell.
    at = columns * row + column
    return _Cells(
        grid.occupied,
        list_code_centres(rows, columns),
        legal,
        free,
        near,
        np.searchsorted(at, np.arange(rows * columns + 1)),
    )


@compile_kernel
def _search(rng, codes, cells, curve, rules):
    """Return the best chromosome (control points,), and the lowest cost so far (generations + 1,).

    codes: (population, control points), the first generation; overwritten.
    """
    population = len(codes)
    # The logarithm of a power of 2 may be a rounding error off.
    bits = int(np.log2(len(cells.legal)) + 0.5)
    cost, parent_cost = np.empty(population), np.empty(population)
    # The first generation inherits nothing.
    parents = np.full_like(codes, -1)
    draws = np.zeros(population, np.int64)
    best, best_cost = codes[0].copy(), np.inf
    history = np.empty(rules.generations + 1)

    for generation in range(rules.generations + 1):
        for i in range(population):
            # A child equal to one of its parents takes over its cost, which changes no result.
            mother, father = draws[i - i % 2], draws[min(i | 1, population - 1)]
            if generation > 0 and is_same(codes[i], parents[mother]):
                cost[i] = parent_cost[mother]
            elif generation > 0 and is_same(codes[i], parents[father]):
                cost[i] = parent_cost[father]
            else:
                cost[i] = _compute_cost(codes[i], cells, curve, rules)
            if cost[i] < best_cost:
                copy(codes[i], best)
                best_cost = cost[i]
        history[generation] = best_cost
        if generation == rules.generations:
            break

        parents, codes = codes, parents
        parent_cost, cost = cost, parent_cost
        # The paper crosses control points: cuts lie between genes, so the unit is a gene's bits.
        draws = breed(rng, parents, parent_cost, codes, 0, rules.crossover_probability, bits, bits)
        for i in range(population):
            _mutate(rng, codes[i], bits, cells, rules)
        if rules.elitism:
            copy(best, codes[0])
    return best, history


@compile_kernel
def _redraw(rng, codes, cells, curve):
    """Redraw each chromosome, in place, until its curve is free, at most `_FEASIBLE_TRIES`
    times.
    """
    for i in range(len(codes)):
        for _ in range(_FEASIBLE_TRIES):
            if _measure(codes[i], cells, curve, False)[1] == 0:
                break
            for gene in range(codes.shape[1]):
                codes[i, gene] = cells.free[draw_integer(rng, 0, len(cells.free))]


@allocation_free
def _mutate(rng, genes, bits, cells, rules):
    """Change random genes of a chromosome in place (ma2020, Section 3.4)."""
    if rules.mutation == Mutation.per_gene:
        for gene in range(len(genes)):
            if rng.random() < rules.mutation_probability:
                flip_bit(rng, genes, gene, bits, cells.legal)
    elif rng.random() < rules.mutation_probability:
        change_gene(rng, genes, bits, cells.free, cells.legal, rules.mutation == Mutation.bit_flip)


@allocation_free
def _compute_cost(genes, cells, curve, rules):
    """Return a chromosome's cost, the reciprocal of its fitness (`Settings` lists the forms)."""
    length, bad, clearance = _measure(genes, cells, curve, rules.fitness != Fitness.length)
    priced = length * (
        1.0 + rules.collision_factor * bad / curve.ends.shape[1]
    ) + rules.collision_surcharge * (bad > 0)
    if rules.fitness == Fitness.length:
        return priced * curve.cell
    safety = _compute_safety_term(bad, clearance, rules.safety_distance)
    if rules.fitness == Fitness.repaired:
        return rules.length_weight * priced / curve.straight + rules.safety_weight * safety
    if rules.fitness == Fitness.literal_weights:
        return rules.length_weight * priced * curve.cell + rules.safety_weight * safety
    if rules.fitness == Fitness.hard_safety:
        return (priced + rules.collision_surcharge * safety) * curve.cell
    if bad > 0 or (
        rules.fitness_feasible == FitnessFeasible.clearance and clearance < rules.safety_distance
    ):
        return rules.length_weight * length * curve.cell + rules.safety_weight * safety
    return (
        length * curve.cell
        if rules.fitness == Fitness.reciprocal_literal
        else 1.0 / (length * curve.cell)
    )


@allocation_free
def _compute_safety_term(bad, clearance, safety_distance):
    """Return how far the path undercuts the safety distance, 0 to 1 (ma2020, eq. 14).

    It is 1 for a path that collides.
    """
    if safety_distance == 0 or (bad == 0 and clearance >= safety_distance):
        return 0.0
    return 1.0 if bad > 0 else (1.0 - clearance / safety_distance) ** 2


@allocation_free
def _measure(genes, cells, curve, with_clearance):
    """Measure the polyline through a curve's samples.

    Returns its length in cells, the number of colliding samples, and the least distance of the
    samples to the occupied cells nearby: infinite if there are none, 0 for a path that collides or
    if it is not requested.
    """
    n, (x, y) = len(genes), curve.samples
    for k in range(n):
        curve.points[k], curve.points[n + k] = cells.centres[genes[k]]
    write_curve(curve.points, curve, curve.samples)
    bad = count_collisions(x, y, cells.occupied)
    clearance = _measure_clearance(x, y, cells) if with_clearance and bad == 0 else 0.0
    return sum_of_steps(x, y, curve.chords), bad, clearance


@allocation_free
def count_collisions(x, y, occupied):
    """Count the samples that lie inside an occupied cell or end a chord that passes through one
    between its ends.

    Touching is allowed.
    """
    bad = 0
    column, row = find_cell_at(x[0], y[0], occupied)
    for s in range(len(x)):
        last_column, last_row = column, row
        column, row = find_cell_at(x[s], y[s], occupied)
        if occupied[row, column] and _is_inside(x[s], column) and _is_inside(y[s], row):
            bad += 1
        # A chord within one cell, or to a cell that shares a side, passes through no other.
        elif abs(column - last_column) + abs(row - last_row) > 1:
            bad += _cuts_obstacle(x[s - 1], y[s - 1], x[s], y[s], occupied)
    return bad


@allocation_free
def _is_inside(value, cell):
    """Tell whether a coordinate is between the grid lines of its cell; rounding must not decide."""
    return cell + ON_LINE < value < cell + 1 - ON_LINE


@allocation_free
def _cuts_obstacle(x, y, x_end, y_end, occupied):
    """Tell whether a chord passes through an occupied cell between the cells of its ends.

    The chord is divided so that no part crosses two grid lines of the same kind; a part that
    crosses one of each kind passes through one more cell.
    """
    parts = int(max(abs(x_end - x), abs(y_end - y))) + 1
    step_x, step_y = (x_end - x) / parts, (y_end - y) / parts
    column, row = find_cell_at(x, y, occupied)
    for part in range(1, parts + 1):
        next_x, next_y = x + step_x, y + step_y
        next_column, next_row = find_cell_at(next_x, next_y, occupied)
        if (
            part < parts
            and occupied[next_row, next_column]
            and _is_inside(next_x, next_column)
            and _is_inside(next_y, next_row)
        ):
            return True
        if column != next_column and row != next_row:
            to_line_x = (max(column, next_column) - x) / step_x
            to_line_y = (max(row, next_row) - y) / step_y
            if to_line_x < to_line_y - _AT_CORNER and occupied[row, next_column]:
                return True
            if to_line_y < to_line_x - _AT_CORNER and occupied[next_row, column]:
                return True
        x, y, column, row = next_x, next_y, next_column, next_row
    return False


@allocation_free
def _measure_clearance(x, y, cells):
    """Return the least distance, in cells, of samples to the occupied cells near theirs.

    It is infinite if there are none.
    """
    least = np.inf
    for s in range(len(x)):
        column, row = find_cell_at(x[s], y[s], cells.occupied)
        cell = cells.occupied.shape[1] * row + column
        for k in range(cells.first[cell], cells.first[cell + 1]):
            column, row = cells.near[k, 0], cells.near[k, 1]
            dx = max(column - x[s], 0.0, x[s] - column - 1)
            dy = max(row - y[s], 0.0, y[s] - row - 1)
            least = min(least, dx * dx + dy * dy)
    return np.sqrt(least)
