"""BCA and BCA-Q of ma2020: the cost of a chromosome against an independent reference, its
operators, degenerate cases, settings.
"""

import math
from functools import partial

import fields
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from studies import planned

from bezierplan.geometry import checker, curves
from bezierplan.geometry.region import build_region
from bezierplan.planners import bca
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.problem import Problem

FEW = {"population": 20, "generations": 10}
OPEN = Grid(np.zeros((20, 20), dtype=bool), 1.0, "cell")
STRAIGHT = 20 * math.sqrt(2)
random_grid = partial(fields.random_grid, shape=(20, 20), share=0.15)
BLOCK = from_lines(["....", ".##.", ".##.", "...."], 1.0, "cell")


def plan(grid=OPEN, seed=0, **changes):
    corner = grid.bounds[1], grid.bounds[3]
    return planned("ma2020", "bca", Problem("test", grid, (0, 0), corner), seed, **FEW | changes)


def reference(path, grid, samples):
    """Length, share of samples inside occupied cells, and least distance of the samples to occupied
    cells, by numpy alone, in cells.
    """
    points = curves.sample_matrix("bezier", len(path.points), samples) @ path.points / grid.cell
    row, column = np.nonzero(grid.occupied)
    dx = np.maximum(column - points[:, :1], points[:, :1] - column - 1)
    dy = np.maximum(row - points[:, 1:], points[:, 1:] - row - 1)
    inside = ((dx < -1e-9) & (dy < -1e-9)).any(axis=1)
    distance = np.hypot(np.maximum(dx, 0), np.maximum(dy, 0)).min(initial=math.inf)
    return np.hypot(*np.diff(points, axis=0).T).sum(), inside.sum(), distance


@given(
    st.integers(0, 10_000),
    st.sampled_from(["length", "repaired", "literal_weights", "hard_safety"]),
    st.sampled_from([0.25, 1.0, 1.6]),
)
def test_cost_of_the_forms_that_know_collisions(seed, fitness, distance):
    grid = random_grid(seed)
    found = plan(grid, seed=seed, fitness=fitness, safety_distance=distance, generations=4)
    length, inside, clearance = reference(found.path, grid, 201)
    bad = found.extra["bad_samples"]
    # A chord can pass through a corner between two samples outside.
    assert inside <= bad <= inside + 40
    safety = 1.0 if bad else max(1 - clearance / distance, 0) ** 2
    priced = length * (1 + 5 * bad / 201) + 10 * (bad > 0)
    cost = {
        "length": priced,
        "repaired": 0.8 * priced / STRAIGHT + 0.1 * safety,
        "literal_weights": 0.8 * priced + 0.1 * safety,
        "hard_safety": priced + 10 * safety,
    }
    assert found.objective == pytest.approx(cost[fitness], rel=1e-12)
    assert found.extra["safety_term"] == pytest.approx(safety, abs=1e-12)
    assert found.claimed_feasible == (bad == 0)


@given(
    st.integers(0, 10_000),
    st.sampled_from(["reciprocal_literal", "as_printed"]),
    st.sampled_from(["collision_free", "clearance"]),
)
def test_cost_of_the_literal_forms(seed, fitness, feasible):
    grid = random_grid(seed, share=0.05)
    found = plan(grid, seed=seed, fitness=fitness, fitness_feasible=feasible, generations=4)
    length, _, clearance = reference(found.path, grid, 201)
    free = found.extra["bad_samples"] == 0 and (feasible == "collision_free" or clearance >= 0.25)
    if not free:
        assert found.objective == pytest.approx(0.8 * length + 0.1 * found.extra["safety_term"])
    else:
        assert found.objective == pytest.approx(
            length if fitness == "reciprocal_literal" else 1 / length
        )


@given(st.integers(0, 10_000))
def test_a_claimed_path_has_no_sample_inside_an_obstacle_however_fine(seed):
    grid = random_grid(seed)
    found = plan(grid, seed=seed, initial="feasible", generations=6)
    if found.claimed_feasible:
        # Its chords are free; the curve leaves them by less than this.
        check = checker.check(curves.bezier_pieces(found.path), build_region(grid))
        assert check.feasible or check.depth < 0.01


def chord(x, y, x_end, y_end, grid):
    return bca.count_collisions(np.array([x, x_end]), np.array([y, y_end]), grid.occupied)


@pytest.mark.parametrize(
    ("ends", "bad"),
    [
        ((0.6, 0.9, 1.4, 1.5), 1),  # ends inside
        ((1.1, 0.5, 0.5, 1.4), 0),  # past the corner: above the diagonal's free side
        ((0.9, 3.2, 1.3, 2.9), 1),  # ends inside after a corner
        ((0.8, 1.4, 1.3, 0.8), 1),  # cuts the corner (1, 1) of the block
        ((0.8, 1.2, 1.2, 0.8), 0),  # touches that corner
        ((0.8, 1.1, 1.1, 0.8), 0),  # passes outside of it
        ((0.5, 1.0, 3.5, 1.0), 0),  # runs along its side
        ((1.0, 0.5, 1.0, 3.5), 0),
        ((0.5, 1.5, 3.5, 1.5), 1),  # a long chord right through
        ((0.2, 2.6, 2.6, 3.9), 0),  # a long chord past
        ((0.5, 2.2, 1.8, 3.7), 1),  # a long chord through a corner
    ],
)
def test_chords_against_a_block(ends, bad):
    assert chord(*ends, BLOCK) == bad


def test_no_sample_is_counted_twice():
    """A sample inside whose chord cuts another occupied cell on its way."""
    grid = from_lines(["###", "#.#", "###"], 1.0, "cell")
    assert chord(1.5, 1.5, 2.6, 2.7, grid) == 1


def test_sorted_start_follows_the_way_to_the_target():
    points = plan(initial="sorted", generations=0, population=2).path.points
    assert (np.diff(points.sum(axis=1)) >= 0).all()


def test_feasible_start():
    grid = random_grid(2, share=0.05)
    assert not plan(grid, population=2, generations=0, seed=1).claimed_feasible
    assert plan(grid, population=2, generations=0, seed=1, initial="feasible").claimed_feasible


def test_no_mutation_and_no_crossover_only_copies():
    found = plan(crossover_probability=0.0, mutation_probability=0.0, generations=30)
    assert len(set(found.history.tolist())) == 1


@pytest.mark.parametrize(("grid", "free"), [(OPEN, True), (BLOCK, False)])
def test_no_control_point_leaves_the_straight_line(grid, free):
    found = plan(grid, control_points=0)
    assert len(found.path.points) == 2
    assert found.claimed_feasible == free
    assert (found.evaluations, len(found.history)) == (1, 1)
    if free:
        assert found.objective == pytest.approx(STRAIGHT)


def test_an_empty_map_has_no_safety_term():
    found = plan(generations=40, fitness="repaired")
    assert found.extra["safety_term"] == 0
    assert found.objective == pytest.approx(0.8 * reference(found.path, OPEN, 201)[0] / STRAIGHT)
    assert STRAIGHT - 1e-9 <= curves.length(found.path) < 1.2 * STRAIGHT


def test_no_safety_distance_is_never_undercut():
    """Then BCA-Q is BCA on another scale, also for a path that collides."""
    grid = random_grid(4, share=0.3)
    bca_q, shortest = (
        plan(grid, fitness=fitness, safety_distance=0, generations=30)
        for fitness in ("repaired", "length")
    )
    assert not bca_q.claimed_feasible
    assert bca_q.extra["safety_term"] == 0
    assert bca_q.objective * STRAIGHT / 0.8 == pytest.approx(shortest.objective)


def test_a_chain_of_pieces_is_measured_like_its_path():
    found = plan(random_grid(1), curve="piecewise_quadratic", samples=701, generations=20)
    assert found.path.curve == "piecewise_quadratic"
    assert len(found.path.points) == 10
    if found.claimed_feasible:
        assert found.objective == pytest.approx(curves.length(found.path), rel=1e-4)
    single = plan(random_grid(1), generations=20)
    assert not np.array_equal(found.history, single.history)
