"""The genetic algorithm of song2016: its objective against an independent reference, its degenerate
cases, its settings.
"""

import itertools
import math
from functools import partial

import fields
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from studies import planned, study

from bezierplan.geometry import curves
from bezierplan.planners import binary_genetic
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.problem import Path, Problem

DEFAULT = study("song2016").resolve_settings("smooth") | {"population": 20, "generations": 10}
# The objective is that of the best chromosome, with all its points.
SETTINGS = DEFAULT | {"rejection": "none"}
SAMPLES = {"polyline": 701, "piecewise_quadratic": 601, "piecewise_cubic": 501, "bezier": 601}
random_grid = partial(fields.random_grid, shape=(16, 16), cell=10.0)
OPEN = Grid(np.zeros((16, 16), dtype=bool), 10.0, "unit")
WALL = from_lines(["......#.", "......#.", "......#.", "......#."], 1.0, "unit")


def problem(workspace, start, target):
    return Problem("test", workspace, workspace.centre(start), workspace.centre(target))


def plan(workspace=OPEN, start=0, target=255, seed=0, **changes):
    return planned(
        "song2016", "smooth", problem(workspace, start, target), seed, **SETTINGS | changes
    )


def reference(path, grid, samples):
    """Length and number of occupied samples of a path, by numpy alone."""
    points = curves.sample_matrix(path.curve, len(path.points), samples) @ path.points
    column, row = np.floor(points / grid.cell + 1e-9).astype(int).T
    return np.hypot(*np.diff(points, axis=0).T).sum(), grid.occupied[row, column].sum()


def entries(points, grid):
    """How often samples of a path enter an occupied cell, by plain Python."""
    cells = [grid.cell_of(*(point + 1e-9 * grid.cell)) for point in points]
    return sum(
        bool(grid.occupied[cell]) and cell != before for before, cell in itertools.pairwise(cells)
    )


@given(st.integers(0, 10_000), st.sampled_from(curves.B_SPLINES))
def test_objective_is_length_plus_penalty_for_each_entry_into_an_occupied_cell(seed, curve):
    grid, samples = random_grid(seed), SAMPLES[curve]
    found = plan(
        grid, seed=seed, curve=curve, samples=samples, generations=3, penalty_for="per_cell"
    )
    length, bad = reference(found.path, grid, samples)
    points = curves.sample_matrix(curve, len(found.path.points), samples) @ found.path.points
    assert found.objective == pytest.approx(length + 10 * entries(points, grid), rel=1e-12)
    assert found.extra["bad_samples"] == bad


def test_a_cell_is_entered_once_however_fine_the_samples():
    """A straight line through a wall one cell thick, measured along its length too."""
    for samples, spacing in itertools.product((50, 701), ("parameter", "arc_length")):
        found = plan(
            WALL,
            start=0,
            target=7,
            curve="polyline",
            samples=samples,
            spacing=spacing,
            genes=0,
            penalty_for="per_cell",
        )
        assert found.objective == pytest.approx(7.0 + 10.0)
        assert found.extra["bad_samples"] > 1


@given(st.integers(0, 10_000), st.sampled_from(curves.B_SPLINES), st.booleans())
def test_objective_is_length_plus_penalty_for_each_occupied_sample(seed, curve, odd):
    """Also of samples that the pieces of a curve do not divide."""
    grid, samples = random_grid(seed), SAMPLES[curve] - 7 * odd
    found = plan(grid, seed=seed, curve=curve, samples=samples, generations=3)
    length, bad = reference(found.path, grid, samples)
    assert found.objective == pytest.approx(length + 10 * bad, rel=1e-12)
    assert found.extra["bad_samples"] == bad
    assert found.claimed_feasible == (bad == 0)


def test_a_path_that_stays_at_its_start_has_no_occupied_points():
    found = plan(start=5, target=5, occupied_point_penalty=10.0)
    assert found.history.tolist() == pytest.approx([0.0], abs=1e-9)


@pytest.mark.parametrize("penalty", [0.0, 10.0])
def test_the_last_generation_can_be_worse_than_an_earlier_one(penalty):
    """Of the same runs without elitism: the best so far is the least of the generations."""
    grid = random_grid(4)
    lost = {"elitism": 0, "generations": 30, "occupied_point_penalty": penalty}
    worse = 0
    for seed in range(5):
        best = plan(grid, seed=seed, **lost)
        last = plan(grid, seed=seed, report="last_generation", **lost)
        assert np.array_equal(np.minimum.accumulate(last.history), best.history)
        assert (np.diff(last.history) > 0).any()
        assert last.objective == last.history[-1] >= best.objective
        worse += last.objective > best.objective
        length, bad = reference(last.path, grid, 501)
        column, row = (last.path.points / 10).astype(int).T
        assert last.objective == pytest.approx(
            length + 10 * bad + penalty * grid.occupied[row, column].sum()
        )
        assert last.extra["bad_samples"] == bad
        # The best of a generation is what a run that ends with it reports.
        shorter = plan(grid, seed=seed, report="last_generation", **lost | {"generations": 12})
        assert np.array_equal(shorter.history, last.history[:13])
    assert worse > 0


def test_surplus_cells_of_a_narrow_grid_are_occupied():
    narrow = Grid(np.zeros((3, 5), dtype=bool), 1.0, "unit")
    found = plan(narrow, start=0, target=14, generations=30)
    assert found.claimed_feasible
    length, _ = reference(
        found.path,
        Grid(np.pad(narrow.occupied, ((0, 1), (0, 3)), constant_values=True), 1.0, "unit"),
        501,
    )
    assert found.objective == pytest.approx(length)


def test_one_penalty_a_path_makes_the_straight_line_through_a_wall_best():
    found = plan(
        WALL, start=0, target=7, generations=60, population=60, penalty_for="path", penalty=1.0
    )
    assert found.objective == pytest.approx(8.0)


def test_polyline_measured_along_its_length_is_exact():
    found = plan(random_grid(2), curve="polyline", samples=701, spacing="arc_length", generations=5)
    assert found.objective - 10 * found.extra["bad_samples"] == pytest.approx(
        curves.length(found.path)
    )


def test_default_chain_has_a_continuous_second_derivative():
    """song2016, eq. 6, whatever cells the points lie in, those that coincide included."""
    assert DEFAULT["curve"] == "piecewise_cubic"
    for points in np.random.default_rng(3).integers(0, 3, (50, 8, 2)).astype(float):
        pieces = curves.bezier_pieces(Path(DEFAULT["curve"], points))
        for order in range(3):
            derivative = np.diff(pieces, n=order, axis=1)
            assert derivative[1:, 0] == pytest.approx(derivative[:-1, -1], abs=1e-12)


@pytest.mark.parametrize("curve", curves.B_SPLINES)
def test_coinciding_points_leave_the_final_path_and_nothing_else(curve):
    """On a map of few cells, round a wall, eight points take some of them twice."""
    grid = from_lines(["....", ".##."], 1.0, "unit")
    changed = harmful = 0
    for seed in range(20):
        kept, rest, harmless = (
            plan(grid, 0, 3, seed, curve=curve, samples=SAMPLES[curve], rejection=rejection)
            for rejection in ("none", "all", "harmless")
        )
        assert rest.objective == kept.objective
        assert np.array_equal(rest.history, kept.history)
        assert np.array_equal(
            rest.path.points, binary_genetic.drop_repeated_points(kept.path.points)
        )
        bad = reference(rest.path, grid, SAMPLES[curve])[1]
        assert rest.extra["bad_samples"] == bad
        assert rest.claimed_feasible == (bad == 0)
        worse = bad > kept.extra["bad_samples"]
        assert np.array_equal(harmless.path.points, (kept if worse else rest).path.points)
        changed += len(rest.path.points) < 8
        harmful += worse
    assert changed > 10
    assert harmful > 0


BITS, GENES = 8, 6


def flipped(mutation, probability, times):
    """Which bits of a chromosome of zeros are complemented: (times, genes, bits)."""
    rng = np.random.default_rng(4)
    found = np.empty((times, GENES, BITS), dtype=int)
    for each in found:
        genes = np.zeros(GENES, dtype=np.int64)
        binary_genetic._mutate(rng, genes, BITS, probability, mutation)
        each[:] = genes[:, None] >> np.arange(BITS) & 1
    return found


def test_one_bit_of_each_gene_is_complemented():
    found = flipped(binary_genetic.Mutation.each_gene, 1.0, 800)
    assert (found.sum(axis=2) == 1).all()
    assert np.abs(found.sum(axis=0) - 100).max() < 4 * 10
    share = flipped(binary_genetic.Mutation.each_gene, 0.25, 4000).sum(axis=(0, 2)) / 4000
    assert share == pytest.approx(np.full(GENES, 0.25), abs=4 * math.sqrt(0.25 * 0.75 / 4000))


def test_each_bit_is_complemented_by_itself():
    assert (flipped(binary_genetic.Mutation.each_bit, 1.0, 1) == 1).all()
    share = flipped(binary_genetic.Mutation.each_bit, 0.25, 4000).mean(axis=0)
    assert np.abs(share - 0.25).max() < 4 * math.sqrt(0.25 * 0.75 / 4000)
    assert (flipped(binary_genetic.Mutation.each_bit, 0.0, 1) == 0).all()
