"""The modified genetic algorithm: its encoding, validation, operators and rules for diversity, by
hand and by properties.
"""

import itertools
import math
from functools import partial

import numpy as np
import pytest
from fields import assert_path_fits, drawn, field_of
from studies import planned, study

from bezierplan.geometry import cell_length, curves
from bezierplan.papers.elhoseny2017.functions import compute_q
from bezierplan.planners import modified_genetic as planner
from bezierplan.planners.parts import gene_curves
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Path, Problem

SETTINGS = study("elhoseny2017").resolve_settings("mga")
run = partial(planned, "elhoseny2017", "mga")
FIELD = drawn(0, obstacles=15)
FEW = {"population": 20, "iterations": 10}


def field(
    side=100,
    *circles,
    ends=None,
    gene_lattice="coarse",
    point_order="index",
):
    grid = field_of(side, *circles)
    ends = np.array(((0, 0), (side, side)) if ends is None else ends, dtype=float)
    return planner.build_field(grid, grid.in_cells(ends), gene_lattice, point_order)


def rules(**changes):
    """The settings as the search reads them."""
    return fill_settings(planner.Settings, SETTINGS | changes)


def gene(x, y):
    """The gene of a point of the field of side 100 on the coarse lattice."""
    return 21 * (x // 5) + y // 5


# The lattice.


@pytest.mark.parametrize("side", [4, 20, 50, 100, 200, 333])
def test_the_lattice_of_any_side_ends_in_the_corners(side):
    found = field(side)
    assert found.points.min() == 0.5
    assert found.points.max() == side + 0.5
    steps = np.unique(found.points[:, 0] - 0.5)
    assert set(np.floor(np.arange(21) * side / 20 + 0.5)) == set(steps)


def test_every_cell_can_be_a_gene():
    found = field(9, (4, 4, 1.2), gene_lattice="cell")
    assert len(found.points) == 100
    np.testing.assert_array_equal(found.points[37] - 0.5, (3, 7))
    assert len(found.choices) == 100 - 2 - 5


# Validation.


def validated(ones, found, rules):
    """`validate` with a scratch of its own."""
    return gene_curves.validate(ones, found, rules, np.inf, gene_curves.prepare_scratch(found))


def test_constraints_in_their_order():
    found = field(100, (50, 50, 3))
    empty = np.empty(0, dtype=np.int64)
    assert validated(empty, found, rules()) == np.inf
    straight = np.array([gene(25, 25)])
    assert validated(straight, found, rules()) == np.inf
    around = np.array([gene(25, 75)])
    assert 141.5 < validated(around, found, rules()) < np.inf
    near = np.array([gene(25, 75), gene(25, 80)])
    assert validated(near, found, rules(least_distance=5.0)) < np.inf
    assert validated(near, found, rules(least_distance=5.1)) == np.inf


@pytest.mark.parametrize("curve", ["single", "chain"])
def test_the_longest_curve_has_room(curve):
    """59 control points that alternate between opposite corners of a field, three at a time: a
    chain gets as far as its points.
    """
    found = field(20, gene_lattice="cell")
    ones = np.arange(59)
    turns = (ones // 3 % 2 * (len(found.points) - 3)) + 1
    scratch = gene_curves.prepare_scratch(found)
    scratch.x[:] = -1.0
    crossing = found._replace(points=found.points[turns])
    cost = gene_curves.validate(
        ones, crossing, rules(curve=curve, least_distance=0.0), np.inf, scratch
    )
    assert cost < np.inf
    used = np.count_nonzero(scratch.x != -1.0)
    assert (0.25 * len(scratch.x) if curve == "chain" else cost) < used < len(scratch.x)


def test_pieces_of_a_chain_are_those_of_the_path():
    points = np.random.default_rng(5).uniform(0, 20, (9, 2))
    for count in range(4, 10):
        pieces = np.empty((count - 3, 4, 2))
        for k, piece in enumerate(pieces):
            gene_curves._write_piece(points[:count], k, piece)
        path = Path("piecewise_cubic", points[:count])
        np.testing.assert_allclose(pieces, curves.bezier_pieces(path), rtol=0, atol=1e-12)


def test_more_than_59_points_are_too_many():
    found = field(100)
    ones = np.array([gene(5 * i, 5 * j) for i in range(4) for j in range(1, 16)])
    assert len(ones) == 60
    assert validated(ones, found, rules()) == np.inf
    assert validated(ones[:59], found, rules()) < np.inf


def length_of(x, y):
    return cell_length.sum_of_steps(x, y, np.empty(len(x)))


def walked(ones, found, curve):
    """x and y of all samples of a curve, and the number of occupied cells that a walk over all its
    cells finds.
    """
    points = planner.build_polygon(ones, found)
    pieces = points[None]
    if curve == "chain" and len(points) > 3:
        pieces = np.empty((len(points) - 3, 4, 2))
        for k, piece in enumerate(pieces):
            gene_curves._write_piece(points, k, piece)
    x, y = cell_length.sample_curve(pieces)
    return (
        x,
        y,
        cell_length.count_occupied_cells(*cell_length.list_touched_cells(x, y), found.occupied),
    )


def maps_and_ends(among):
    """Maps of single cells, where most curves pass within a cell of occupied ones, cut their
    corners, and have samples on their sides; or of circles of a radius; each with two ends.
    """
    rng = np.random.default_rng(4)
    for number in range(20):
        if among != "single cells":
            task = drawn(number, among, 15, (100, 32)[number % 2])
            ends = task.workspace.in_cells(np.array([task.start, task.target]))
            yield task.workspace, np.floor(ends) if number % 3 == 0 else ends  # on grid lines
            continue
        occupied = rng.random((24, 24)) < (0.02, 0.06, 0.12)[number % 3]
        occupied[0, 0] = occupied[-1, -1] = False
        ends = (((0.5, 0.5), (23.5, 23.5)), ((0.0, 0.0), (23.0, 23.25)))[number % 2]
        yield Grid(occupied, 1.0, "cell"), np.array(ends)


@pytest.mark.parametrize("curve", ["single", "chain"])
@pytest.mark.parametrize(
    ("among", "lattice"),
    [*itertools.product([0.02, 0.06], ["coarse", "cell"]), ("single cells", "cell")],
)
def test_first_sights_never_change_a_verdict(among, lattice, curve):
    """Curves that the walk over all cells calls free or colliding are called the same by the
    shortcuts before it.
    """
    rng = np.random.default_rng(3)
    free = colliding = 0
    for grid, ends in maps_and_ends(among):
        found = planner.build_field(grid, ends, lattice, "projection")
        for _ in range(100):
            ones = np.sort(rng.choice(found.choices, rng.integers(1, 6), replace=False))
            x, y, bad = walked(ones, found, curve)
            cost = validated(ones, found, rules(least_distance=0.0, curve=curve))
            assert cost == (length_of(x, y) if bad == 0 else np.inf)
            free += bad == 0
            colliding += bad > 0
    assert min(free, colliding) > 50


@pytest.mark.parametrize(
    ("reach", "away", "free"),
    [((4, 4), 0.0, True), ((4, 3), 0.0, False), ((4, 4), 0.1, False), ((6, 4), 1.0, True)],
)
def test_a_part_is_free_if_the_room_around_its_ends_holds_its_chord_how_far_it_bends_and_a_step(
    reach, away, free
):
    x, y = np.array([10.0, 15.0]), np.array([10.0, 7.0])
    assert gene_curves._is_free_part(x, y, np.array(reach), 0, away) == free


def test_a_target_on_the_border_is_looked_at_within_the_grid():
    """Where no cell lies beyond, the first sight reads none: uncompiled it raises IndexError if it
    does.
    """
    room = np.full((20, 20), 3)
    for x, y in ((20.0, 20.0), (20.0, 10.5), (10.5, 20.0)):
        # A sample on the border is left to the walk over the cells.
        assert (
            gene_curves._count_free_samples.py_func(x, y, room)
            == gene_curves._count_free_samples(x, y, room)
            == -1
        )
    # One on another grid line has free cells on both sides.
    assert gene_curves._count_free_samples(10.0, 10.5, room) == 2
    assert gene_curves._count_free_samples(10.0, 10.5, np.full((20, 20), 2)) == -1
    assert gene_curves._count_free_samples(10.3, 10.5, np.zeros((20, 20), dtype=np.int64)) == 0


@pytest.mark.parametrize(
    "ends", list(itertools.permutations([(0.5, 0.5), (20.0, 20.0), (20.0, 9.3), (9.3, 20.0)], 2))
)
def test_ends_on_the_border_are_joined(ends):
    occupied = np.zeros((20, 20), dtype=bool)
    occupied[[17, 7, 18], [18, 18, 7]] = (
        True  # near the ends, so that the walk over the cells decides
    )
    found = run(Problem("border", Grid(occupied, 1.0, "cell", (0.0, 0.0)), *ends), **FEW)
    assert found.claimed_feasible
    assert np.array_equal(found.path.points[[0, -1]], ends)
    assert found.objective == pytest.approx(math.dist(*ends), rel=0.02)


# The search.


@pytest.mark.parametrize("diversity_rule", ["none", "more_offspring", "relaxing", "unique"])
@pytest.mark.parametrize("curve", ["single", "chain"])
def test_plans_are_free_and_as_long_as_said(diversity_rule, curve):
    for number in range(3):
        task = drawn(number, obstacles=15)
        found = run(task, number, diversity=diversity_rule, curve=curve, **FEW)
        assert_path_fits(task, found)
        assert found.objective == pytest.approx(
            length_of(*cell_length.sample_in_cells(found.path, task.workspace)), rel=1e-12
        )
        assert len(found.history) == 11


def test_without_a_rule_it_is_the_plain_algorithm_bit_by_bit():
    """A threshold that Q never exceeds, or no further batch, asks for nothing."""
    plain = run(FIELD, 4, diversity="none")
    for changed in ({"eta": 1.0, "eta_decay": 1.0}, {"most_batches": 0}):
        watched = run(FIELD, 4, **changed)
        assert np.array_equal(plain.path.points, watched.path.points)
        assert np.array_equal(plain.history, watched.history)
        assert plain.evaluations == watched.evaluations
        assert watched.extra["extra_batches"] == 0
    endless = run(FIELD, 4, eta=-1.0, eta_decay=1.0, most_batches=2).extra
    assert (endless["loops"], endless["endless_loops"], endless["extra_batches"]) == (80, 80, 160)


def test_unique_lets_no_two_children_be_alike():
    plain, unique = (run(FIELD, 5, diversity=rule, first_draws=1) for rule in ("none", "unique"))
    assert unique.extra["distinct_chromosomes"] > plain.extra["distinct_chromosomes"]
    # Only random chromosomes of the first population can be equal by chance.
    assert unique.extra["distinct_chromosomes"] > 58


def test_children_that_are_not_crossed_mutate_as_well():
    """Without crossover a child that does not mutate is a copy, so that nothing could be found that
    the first population does not have.
    """
    found = run(FIELD, 7, crossover_probability=0.0, replacements=0)
    assert found.objective < found.history[0]
    assert found.extra["valid_share"] < 1.0


def test_q_statistic():
    """The example of elhoseny2017, Section 3.3.1, is in `test_the_table_of_the_example`."""

    def of(*texts):
        return compute_q(*(np.array(list(text), dtype=int) for text in texts))

    assert of("1100", "1100") == 1.0
    assert of("1100", "0011") == -1.0
    assert of("1111", "1111") == 1.0
    assert of("1111", "1110") == 0.0


# What it takes to get through a maze.

WALLED = np.zeros((9, 9), dtype=bool)
WALLED[3, :7] = WALLED[6, 2:] = True  # back and forth


def maze():
    grid = Grid(WALLED, 1.0, "cell")
    return grid, planner.build_field(grid, np.array([[0.5, 0.5], [8.5, 8.5]]), "cell", "geodesic")


@pytest.mark.parametrize("seed", range(3))
def test_only_points_along_the_corridors_get_through_the_maze(seed):
    task, changes = Problem("maze", maze()[0], (0.5, 0.5), (8.5, 8.5)), {"least_distance": 0.0}
    assert_path_fits(task, run(task, seed, **FEW | changes))
    few = FEW | changes | {"first_draws": 20_000, "point_order": "projection"}
    assert not run(task, seed, **few).claimed_feasible


def test_a_warm_start_is_never_worse_than_the_path_that_it_starts_from():
    where = drawn(11, obstacles=15)
    first, last = planner.resume(where, np.random.default_rng(1), None, **SETTINGS | FEW)
    assert first.objective == run(where, 1, **FEW).objective
    few = FEW | {"iterations": 1}
    again, _ = planner.resume(where, np.random.default_rng(2), last, **SETTINGS | few)
    assert again.history[0] <= first.objective < run(where, 2, **few).history[0]
