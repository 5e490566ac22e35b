"""Modified genetic algorithm (MGA): selects the points of a field that are control points of a
Bézier curve (elhoseny2017, Section 3).

A chromosome has one gene for each point of a lattice of cells: 1 makes the point a control point, 0
leaves it out, and -1 marks an occupied cell, which is never set. It is stored as the ascending list
of the genes that are 1. A chromosome whose points are too close to each other or whose curve
touches an occupied cell is deleted and replaced by a random one (Section 3.2.2). On top of the
plain algorithm the paper monitors the Q statistic of the pool (Section 3.3). In the kernels
coordinates and lengths are in cells.

The paper says neither in which order control points are joined nor how many a random chromosome
has. Here they are joined in the order in which a walk over free cells reaches them, and random
chromosomes get more of them on a map on which few do not get through.
"""

import math
from enum import IntEnum
from typing import Annotated, Any, NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts import gene_lists
from bezierplan.planners.parts.diversity import count_shared
from bezierplan.planners.parts.gene_curves import (
    MOST_POINTS,
    CurveKind,
    Scratch,
    prepare_scratch,
    validate,
)
from bezierplan.planners.parts.gene_lattice import Field, build_field, build_polygon, find_genes_at
from bezierplan.planners.parts.genetic import check_pairs, copy, is_same
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import NOT_NEGATIVE, SHARE, with_settings
from bezierplan.planners.parts.sorting import find_first_above, find_largest

extra = (
    "distinct_chromosomes",
    "mean_q",
    "population_q",
    "loops",
    "endless_loops",
    "extra_batches",
    "valid_share",
)
workspaces = ("grid",)

# Capacity of a list of genes: a crossover of two chromosomes yields at most twice as many.
_ROOM = 2 * MOST_POINTS + 1

# Cost of a chromosome that fills a place in the first population because no valid one was found.
_UNFIT = 1e9

Diversity = IntEnum("Diversity", "none more_offspring relaxing unique")
GeneLattice = IntEnum("GeneLattice", "coarse cell")
PointOrder = IntEnum("PointOrder", "projection index geodesic")

# Invalid draws in a row after which random chromosomes get up to twice as many control points.
_BARREN = 400


class Settings(NamedTuple):
    """Settings of the search (elhoseny2017, Sections 3 and 4)."""

    population: Annotated[
        int, Range(2), About("chromosomes of a generation", "elhoseny2017, Section 4.2.2")
    ]
    iterations: Annotated[int, Range(1), About("iterations", "elhoseny2017, Section 4.2.2")]
    crossover_probability: Annotated[
        float, SHARE, About("of a pair of parents", "elhoseny2017, Section 4.2")
    ]
    mutation_rate: Annotated[
        float,
        SHARE,
        About("probability that a gene changes", "elhoseny2017, Section 4.2"),
    ]
    diversity: Annotated[
        Diversity,
        About(
            "none; more offspring while the mean Q of the pool exceeds eta; only children whose "
            "mean Q is at most 1 - eta (relaxing); "
            "or none equal to another chromosome (unique)",
            "elhoseny2017, Section 3.3, Algorithm 2",
        ),
    ]
    eta: Annotated[
        float, Range(-1, 1), About("limit of the Q statistic", "elhoseny2017, Section 4.2.2")
    ]
    eta_decay: Annotated[
        float,
        SHARE,
        About("factor of eta from one iteration to the next", "elhoseny2017, Section 3.3"),
    ]
    most_batches: Annotated[
        int, NOT_NEGATIVE, About("most extra batches of offspring in an iteration")
    ]
    gene_lattice: Annotated[GeneLattice, About("genes are 21 x 21 points, or every cell")]
    point_order: Annotated[
        PointOrder,
        About(
            "control points are joined by their projection on the line from start to target, by "
            "gene, or by distance over free cells"
        ),
    ]
    first_points: Annotated[int, Range(1), About("most control points of a random chromosome")]
    most_points: Annotated[
        int,
        Range(1, MOST_POINTS),
        About(f"likewise, doubled up to this after each {_BARREN} invalid draws in a row"),
    ]
    first_draws: Annotated[int, Range(1), About("most draws for the first population")]
    replacements: Annotated[
        int, NOT_NEGATIVE, About("draws for an invalid child", "elhoseny2017, Section 3.2.2")
    ]
    least_distance: Annotated[
        float,
        NOT_NEGATIVE,
        About("least distance of two control points", "elhoseny2017, Figure 4", unit="cells"),
    ]
    curve: Annotated[
        CurveKind,
        About(
            "one Bézier curve, or a chain of cubic ones that meet with equal curvature",
            "elhoseny2017, eq. 2 or Section 2.1",
        ),
    ]


class Outcome(NamedTuple):
    """Result of a search.

    ones: genes that are 1 in the best chromosome, empty if none.
    cost: its length.
    history: (iterations + 1,) best cost so far.
    distinct: (iterations + 1,) number of distinct chromosomes in the population.
    q: (iterations,) mean Q of the pool at the end of an iteration, where requested.
    population_q: (iterations + 1,) mean Q of the population.
    loops: iterations whose pool is so alike that more offspring are made.
    endless: iterations among them that end at the cap.
    batches: number of extra batches of offspring.
    evaluations: number of chromosomes validated.
    valid_share: share of valid children.
    """

    ones: np.ndarray
    cost: float
    history: np.ndarray
    distinct: np.ndarray
    q: np.ndarray
    population_q: np.ndarray
    loops: int
    endless: int
    batches: int
    evaluations: int
    valid_share: float


def check(settings: dict) -> None:
    """Raise ValueError, naming the setting and what is expected, unless settings that depend on
    each other fit together.
    """
    check_pairs(settings)
    if settings["first_points"] > settings["most_points"]:
        raise ValueError(
            f"first_points: {settings['first_points']}; at most {settings['most_points']}, the "
            "setting most_points"
        )


@with_settings(Settings)
def plan(
    problem: Problem, rng: np.random.Generator, settings: Settings, last: np.ndarray | None = None
) -> Plan:
    """Return the shortest curve found through control points on a lattice of cells.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.
    last : ndarray, (n, 2), optional
        Control points of an earlier path, in units, with whose genes the first population begins;
        else it is as the settings say.

    Returns
    -------
    Plan
        `claimed_feasible`: no cell that the sampled curve touches is occupied. Extra columns:
        distinct_chromosomes in the population and mean_q of the pool and population_q of the
        survivors, averaged over the iterations; loops, the iterations that make extra_batches of
        offspring, and endless_loops, those that make as many as they may; valid_share of the
        children.

    References
    ----------
    elhoseny2017, Algorithms 1 and 2, Sections 3.2 and 3.3.
    """
    grid = problem.workspace
    ends = grid.in_cells(problem.ends)
    if problem.start == problem.target:
        nothing = dict.fromkeys(extra, math.nan) | dict.fromkeys(extra[:1], 0.0)
        nothing |= dict.fromkeys(("loops", "endless_loops", "extra_batches"), 0)
        return Plan.of_one(Path("polyline", grid.in_units(ends)), 0.0, "start is target", nothing)
    # A start on the upper or right border lies in the last cell, not beyond it.
    ends = np.minimum(ends, np.nextafter(np.array(grid.occupied.shape[::-1], float), 0.0))
    field = build_field(
        grid,
        ends,
        GeneLattice(settings.gene_lattice).name,
        PointOrder(settings.point_order).name,
    )
    known = np.empty(0, np.int64) if last is None else find_genes_at(grid.in_cells(last), field)
    result = search(rng, field, settings, known, prepare_scratch(field))
    solved = len(result.ones) > 0
    points = grid.in_units(build_polygon(result.ones, field))
    points[[0, -1]] = problem.ends
    chained = settings.curve == CurveKind.chain and len(points) > 3
    return Plan(
        path=Path("piecewise_cubic" if chained else "bezier", points) if solved else None,
        objective=result.cost * grid.cell,
        claimed_feasible=solved,
        evaluations=result.evaluations,
        history=result.history * grid.cell,
        stop="iterations" if solved else "no valid chromosome",
        extra={
            "distinct_chromosomes": float(result.distinct.mean()),
            "mean_q": float(result.q.mean()),
            "population_q": float(result.population_q[1:].mean()),
            "loops": result.loops,
            "endless_loops": result.endless,
            "extra_batches": result.batches,
            "valid_share": result.valid_share,
        },
    )


def resume(
    problem: Problem, rng: np.random.Generator, last: np.ndarray | None, **settings: Any
) -> tuple[Plan, np.ndarray | None]:
    """Plan again with a first population that holds the path of an earlier call, by its control
    points.

    last: (n, 2), second result of the last call; None for the first plan, which is that of
        `plan`. Points that are no free genes now are left out.
    """
    found = plan(problem, rng, last, **settings)
    return found, found.path.points[1:-1] if found.claimed_feasible else last


@compile_kernel
def search(
    rng: np.random.Generator,
    field: Field,
    rules: Settings,
    start_genes: np.ndarray,
    scratch: Scratch,
) -> Outcome:
    """Run Algorithm 2, or the plain algorithm if there is no diversity rule.

    start_genes: the genes that are 1 in a chromosome with which the first population begins; if
    there are none, all are random. scratch: `prepare_scratch` the field.
    """
    loops_on = rules.diversity == Diversity.more_offspring
    size = rules.population
    # A pair of parents has two children, and each of them a mutated twin.
    children = 4 * (size // 2)
    places = size + (1 + rules.most_batches * loops_on) * children
    pool, child = gene_lists.prepare_pool(places, _ROOM), np.empty(_ROOM, np.int64)
    kinds = gene_lists.Kinds(
        np.empty(places, np.int64),
        np.empty(places),
        np.empty((places, places)),
        np.zeros(len(field.points), np.int64),
    )
    memory = gene_lists.prepare_pool(gene_lists.REMEMBERED, _ROOM)
    # No chromosome has so few genes.
    memory.count[:] = -1
    history, distinct = np.empty(rules.iterations + 1), np.empty(rules.iterations + 1)
    q, population_q = np.full(rules.iterations, np.nan), np.empty(rules.iterations + 1)
    best, best_cost = np.empty(0, np.int64), np.inf
    loops = endless = batches = births = losses = 0

    most, evaluations = _fill_population(rng, start_genes, child, pool, field, rules, scratch)
    eta = rules.eta
    for iteration in range(rules.iterations + 1):
        for row in range(size):
            # Who costs `_UNFIT` only fills a place and is no path.
            if pool.cost[row] < min(best_cost, _UNFIT):
                best, best_cost = pool.ones[row, : pool.count[row]].copy(), pool.cost[row]
        history[iteration] = best_cost
        count = gene_lists.count_kinds(pool, 0, size, 0, kinds)
        distinct[iteration] = count
        population_q[iteration] = gene_lists.compute_mean_q(kinds, count, size)
        if iteration == rules.iterations:
            break

        wheel = np.cumsum(1.0 / pool.cost[:size])
        # A child that costs more than any parent does not survive, so nobody needs to know by how
        # much; unless equal chromosomes are told by their costs.
        limit = np.inf if rules.diversity == Diversity.unique else find_largest(pool.cost[:size])
        fill, extra_batches, alike = size, -1, True
        # The paper's loop has no other end than a Q below eta, which a pool may never reach,
        # however many children join it. Each batch takes as long as the first, so `most_batches`
        # makes a run up to that many times longer.
        while alike and extra_batches < rules.most_batches * loops_on:
            before = fill
            fill, tries, invalid = _add_offspring(
                rng, pool, before, wheel, eta, limit, child, memory, most, field, rules, scratch
            )
            evaluations += tries
            births += children
            losses += invalid
            extra_batches += 1
            if loops_on:
                count = gene_lists.count_kinds(pool, before, fill, count, kinds)
                q[iteration] = gene_lists.compute_mean_q(kinds, count, fill)
                alike = q[iteration] > eta
        batches += extra_batches
        loops += extra_batches > 0
        endless += alike and extra_batches > 0
        gene_lists.select(pool, size, fill)
        # The limit falls from one iteration to the next (Section 3.3).
        eta *= rules.eta_decay
    return Outcome(
        best,
        best_cost,
        history,
        distinct,
        q,
        population_q,
        loops,
        endless,
        batches,
        evaluations,
        1.0 - losses / births,
    )


@allocation_free
def _fill_population(rng, start_genes, child, pool, field, rules, scratch):
    """Draw the first population.

    A place gets the first valid chromosome, or, after `_BARREN` draws with as many control points
    as there may be, one that never counts if another place is filled.

    Returns the most control points that a random chromosome has from now on, and the number of
    chromosomes validated.
    """
    most, evaluations, has_valid = rules.first_points, 0, False
    for row in range(rules.population):
        barren, cost = 0, np.inf
        while cost == np.inf and evaluations < rules.first_draws:
            if row == 0 and evaluations == 0 and len(start_genes) > 0:
                copy(start_genes, child)
                count = len(start_genes)
            else:
                count = _draw_chromosome(rng, child, field.choices, most)
            cost = validate(child[:count], field, rules, np.inf, scratch)
            evaluations += 1
            barren += 1
            if barren % _BARREN == 0 and cost == np.inf:
                if has_valid:
                    break
                most = min(2 * most, rules.most_points)
        has_valid = has_valid or cost < np.inf
        gene_lists.put(child, count, min(cost, _UNFIT), pool, row)
    return most, evaluations


@allocation_free
def _add_offspring(rng, pool, fill, wheel, eta, limit, child, memory, most, field, rules, scratch):
    """Add a batch of offspring of the pool's first chromosomes (Algorithm 2, lines 6 and 7) after
    those already in it.

    wheel: (population,) running sum of the parents' weights in the draw.
    limit: see `validate`.
    memory: holds validated chromosomes, changed in place.

    Returns the number of chromosomes now in the pool, of chromosomes validated, and of invalid
    children.
    """
    tries = invalid = 0
    for _ in range(rules.population // 2):
        one, other = _select_parents(rng, wheel)
        crossed = rng.random() < rules.crossover_probability
        # Without a crossover no cut is drawn.
        cut = draw_integer(rng, 1, len(field.points)) if crossed else 0
        for head, tail in ((one, other), (other, one)):
            for mutated in range(2):
                count = gene_lists.cross(
                    pool, head, tail if crossed else head, cut, field.index, child
                )
                if mutated:
                    count = _mutate(rng, child, count, field.settable, rules.mutation_rate)
                for replaced in range(rules.replacements + 1):
                    if replaced > 0:
                        count = _draw_chromosome(rng, child, field.choices, most)
                    # Most children have been there before, once the population is alike; their
                    # cost holds, for limits never rise.
                    place, known = gene_lists.find_entry(child[:count], memory)
                    if not known:
                        cost = validate(child[:count], field, rules, limit, scratch)
                        gene_lists.put(child, count, cost, memory, place)
                    cost = memory.cost[place]
                    tries += 1
                    invalid += replaced == 0 and cost == np.inf
                    if cost < np.inf:
                        break
                if cost < np.inf and not (
                    rules.diversity > Diversity.more_offspring
                    and _is_too_alike(
                        child[:count], cost, pool, fill, eta, len(field.points), rules.diversity
                    )
                ):
                    gene_lists.put(child, count, cost, pool, fill)
                    fill += 1
    return fill, tries, invalid


@allocation_free
def _select_parents(rng, wheel):
    """Draw the places of two different parents, in proportion to fitness (Algorithm 1, line 9).

    The second is drawn from the wheel without the first one.
    """
    first = find_first_above(wheel, rng.random() * wheel[-1])
    first = min(first, len(wheel) - 1)
    begin = wheel[first - 1] if first > 0 else 0.0
    share = wheel[first] - begin
    drawn = rng.random() * (wheel[-1] - share)
    second = find_first_above(wheel, drawn if drawn < begin else drawn + share)
    second = min(second, len(wheel) - 1)
    if second == first:
        # Rounding at the edge of the omitted share.
        second = first - 1 if first > 0 else first + 1
    return first, second


@allocation_free
def _mutate(rng, child, count, settable, rate):
    """Change random genes, except those that must not be set, and return how many are 1."""
    # Gaps of independent trials lead from one gene that changes to the next: no draw for each gene.
    unchanged = math.log1p(-rate) if rate < 1.0 else -np.inf
    gene = gene_lists.draw_gap(rng, unchanged)
    while gene < len(settable):
        if settable[gene]:
            count = gene_lists.flip(child, count, gene)
        gene += 1 + gene_lists.draw_gap(rng, unchanged)
    return count


@allocation_free
def _draw_chromosome(rng, child, choices, most):
    """Write a chromosome of 1 to `most` random genes and return how many."""
    wanted = min(draw_integer(rng, 1, most + 1), len(choices))
    count = 0
    while count < wanted:
        gene = choices[draw_integer(rng, 0, len(choices))]
        place = gene_lists.place_of(child, count, gene)
        if place == count or child[place] != gene:
            count = gene_lists.insert(child, count, place, gene)
    return count


@allocation_free
def _is_too_alike(ones, cost, pool, fill, eta, genes, diversity):
    """Tell whether the rule `relaxing` or `unique` rejects a child (Section 3.3)."""
    total = 0.0
    for i in range(fill):
        other = pool.ones[i, : pool.count[i]]
        if diversity == Diversity.relaxing:
            both = count_shared(ones, other)
            total += gene_lists.compute_q(both, len(ones), len(other), genes)
        elif cost == pool.cost[i] and is_same(ones, other):
            return True
    return diversity == Diversity.relaxing and total > (1.0 - eta) * fill
