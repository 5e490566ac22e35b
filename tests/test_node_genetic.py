"""The genetic algorithm over nodes (meledje): its edges against an independent test, its optimum,
its operators, degenerate cases.
"""

import itertools
import math
from collections import Counter
from dataclasses import replace
from functools import cache, partial

import fields
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from studies import planned, problem_of, study
from test_exact_properties import shapes_of

from bezierplan.geometry import curves
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region
from bezierplan.geometry.shortest_paths import centre_path
from bezierplan.planners import node_genetic
from bezierplan.planners.parts.node_mutation import mutate
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.workspaces import ground as ground_of_cells
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.ground import (
    MOST_NEIGHBOURS,
    Neighbourhood,
    build_ground,
    compute_edge_energy,
    count_obstacles_on,
    find_cheapest,
    list_free_neighbours,
)
from bezierplan.workspaces.problem import Problem

# Least energies from the lower left to the upper right corner, by a program of its own.
OPTIMA = {
    "env1_initial": 26.268314,
    "env1_modified": 28.946764,
    "env2_initial": 35.605289,
    "env2_modified": 32.250610,
}
SETTINGS = study("meledje").resolve_settings("proposed")
plan = partial(planned, "meledje", "proposed", population=20, generations=30)
random_grid = partial(fields.random_grid, shape=(9, 12))
OPERATORS = ("random", "random_repair", "ref12", "ref21", "proposed")
BLOCK = from_lines(["......", "..##..", "..##..", "......"], 1.0, "cell")


def problem(grid, start=0, target=None):
    return Problem(
        "test",
        grid,
        grid.centre(start),
        grid.centre(grid.occupied.size - 1 if target is None else target),
    )


ENVIRONMENTS = {name: problem_of("meledje", name) for name in OPTIMA}


def cells_of(path, grid):
    """Numbers of the cells in whose centres a path has its points."""
    column, row = np.floor(path.points / grid.cell).astype(int).T
    return row * grid.occupied.shape[1] + column


@cache
def met(one, other, grid):
    """Of how many occupied cells the edge between two cells passes through the interior."""
    edge = shapely.LineString([grid.centre(one), grid.centre(other)])
    place = shapely.Point(grid.centre(one)) if one == other else edge
    return shapely.relate_pattern(place, shapes_of(grid), "T********").sum()


def length(one, other, columns):
    return math.dist(divmod(one, columns), divmod(other, columns))


# Edges


@given(st.integers(0, 10_000), st.tuples(st.integers(1, 9), st.integers(1, 9)))
def test_edges_meet_the_cells_whose_interior_they_pass(seed, shape):
    grid = Grid(np.random.default_rng(seed).random(shape) < 0.4, 1.0, "cell")
    ground = build_ground(grid, 1.0)
    for one, other in np.random.default_rng(seed).integers(0, grid.occupied.size, (40, 2)).tolist():
        assert count_obstacles_on(ground, one, other) == met(one, other, grid)
        assert compute_edge_energy(ground, one, other) == length(one, other, shape[1])


@pytest.mark.parametrize("mutation", OPERATORS)
def test_edges_measured_on_demand_give_the_same_bits(mutation, monkeypatch):
    where = ENVIRONMENTS["env2_modified"]
    with_table = plan(where, mutation=mutation)
    monkeypatch.setattr(ground_of_cells, "TABLE_CELLS", 0)
    # A map of its own, whose ground is not known yet.
    where = where._replace(workspace=replace(where.workspace))
    assert build_ground(where.workspace, 1.0).encounters.size == 0
    on_demand = plan(where, mutation=mutation)
    assert on_demand.history.tobytes() == with_table.history.tobytes()
    assert on_demand.path.points.tobytes() == with_table.path.points.tobytes()
    assert on_demand.extra == pytest.approx(with_table.extra, abs=0, nan_ok=True)


# The optimum


@pytest.mark.parametrize("name", OPTIMA)
def test_optimum_of_the_four_maps(name):
    grid = ENVIRONMENTS[name].workspace
    energy, path = find_cheapest(build_ground(grid, 1.0), 0, 255)
    assert energy == pytest.approx(OPTIMA[name], abs=1e-6)
    assert math.fsum(
        length(a, b, 16) for a, b in itertools.pairwise(path.tolist())
    ) == pytest.approx(energy)
    assert all(met(a, b, grid) == 0 for a, b in itertools.pairwise(path.tolist()))
    assert plan(ENVIRONMENTS[name], generations=0).extra["optimum"] == energy
    closed = plan(ENVIRONMENTS[name], corners="closed", generations=0)
    assert closed.extra["optimum"] > energy + 0.01, "the optimum touches corners"
    assert centre_path(ENVIRONMENTS[name]).length == pytest.approx(energy)


@pytest.mark.parametrize("seed", range(8))
def test_optimum_of_random_maps(seed):
    grid = random_grid(seed, shape=(6, 7), share=0.4)
    energy, _ = find_cheapest(build_ground(grid, 1.0), 0, grid.occupied.size - 1)
    assert energy == pytest.approx(centre_path(problem(grid)).length)


# Whole runs


@pytest.mark.parametrize(("mutation", "name"), list(itertools.product(OPERATORS, OPTIMA)))
def test_objective_claim_and_class_of_the_result(mutation, name):
    grid, columns = ENVIRONMENTS[name].workspace, 16
    for seed in range(4):
        found = plan(ENVIRONMENTS[name], seed, mutation=mutation, generations=12)
        edges = list(itertools.pairwise(cells_of(found.path, grid).tolist()))
        obstacles = sum(met(a, b, grid) for a, b in edges)
        assert found.objective == pytest.approx(
            math.fsum(length(a, b, columns) for a, b in edges) + 15 * obstacles
        )
        assert (
            found.claimed_feasible
            == (obstacles == 0)
            == check(curves.bezier_pieces(found.path), build_region(grid)).feasible
        )
        classes = [found.extra[key] for key in ("optimal", "near_optimal", "infeasible")]
        assert sum(classes) == 1
        assert found.extra["infeasible"] == (obstacles > 0)
        assert found.extra["optimal"] == (obstacles == 0 and found.objective < OPTIMA[name] + 1e-5)
        assert found.history[-1] <= found.objective
        assert len(edges) <= SETTINGS["most_nodes"] + 1


def test_first_populations_do_not_depend_on_the_operator():
    first = {
        plan(ENVIRONMENTS["env1_initial"], 3, mutation=mutation).history[0]
        for mutation in OPERATORS
    }
    assert len(first) == 1


def test_evaluations_are_the_population_of_each_generation_and_the_neighbours_tried():
    where = ENVIRONMENTS["env1_initial"]
    assert plan(where, mutation="random", generations=7, stall=100).evaluations == 20 * 8
    tried = (
        plan(
            where, mutation="ref12", generations=7, stall=100, mutation_probability=1.0
        ).evaluations
        - 20 * 8
    )
    assert 20 * 7 * 2 < tried <= 20 * 7 * 8


def test_the_best_path_so_far_is_kept_if_wanted():
    where = ENVIRONMENTS["env2_initial"]
    runs = [plan(where, seed, mutation="random") for seed in range(10)]
    assert any(found.objective > found.history[-1] for found in runs)
    for seed in range(10):
        kept, best = (
            plan(where, seed, mutation="random", elitism=1),
            plan(where, seed, mutation="random", result="best_so_far"),
        )
        assert kept.objective == pytest.approx(kept.history[-1], abs=1e-9)
        assert best.objective == best.history[-1] == runs[seed].history[-1]


# First populations


def test_first_paths_are_found_in_corridors_and_dead_ends():
    """From the start of a corridor one cell is visible beside 300 that are not; and walks that see
    no new cell, in a dead end of a single cell beside the start, begin again.
    """
    corridor = np.ones((20, 20), dtype=bool)
    corridor[0, :3] = corridor[:3, 2] = corridor[2, 2:] = corridor[2:, 5:] = False
    dead_end = from_lines(["##..", "##.#", "#..#", "..##"], 1.0, "cell")
    for grid in (Grid(corridor, 1.0, "cell"), dead_end):
        found = plan(problem(grid), generations=0, population=100)
        assert found.extra["feasible_last"] == 1.0


def test_rejection_keeps_feasible_paths_with_the_chances_that_they_have():
    """On a map so small that all random paths of up to two inner nodes can be listed."""
    grid = from_lines(["...", ".#.", "..."], 1.0, "cell")
    free, ground = np.array([1, 2, 3, 5, 6, 7]), build_ground(grid, 1.0)
    chances = {
        (0, *inner, 8): 1 / len(free) ** count
        for count in range(3)
        for inner in itertools.product(free.tolist(), repeat=count)
        if all(met(a, b, grid) == 0 for a, b in itertools.pairwise((0, *inner, 8)))
    }
    ways = node_genetic.compute_free_ways(8, free, ground, 2)
    by_count = [sum(p for path, p in chances.items() if len(path) == n) for n in (2, 3, 4)]
    assert ways[0] == pytest.approx(by_count)
    rng, path, drawn = np.random.default_rng(0), np.zeros(4, dtype=np.int64), Counter()
    for _ in range(4000):
        count = node_genetic.draw_feasible_path(rng, path, 8, free, ground, ways)
        drawn[tuple(path[:count].tolist())] += 1
    expected = np.array(list(chances.values())) / sum(chances.values()) * 4000
    assert drawn.keys() <= chances.keys()
    assert stats.chisquare([drawn[path] for path in chances], expected).pvalue > 1e-3
    assert node_genetic.draw_feasible_path(rng, path, 8, free, ground, np.zeros_like(ways)) == 0


# Operators


def test_closed_corners_are_met():
    """Of (0, 0) to (2, 2) on a map with a block beside the way; the straight way passes two
    corners.
    """
    for rows, open_, closed in (
        (["...", ".#.", "..."], 1, 1),
        (["...", "#..", "..."], 0, 1),
        ([".#.", "#..", "..."], 0, 2),
        (["..."] * 3, 0, 0),
    ):
        grid = from_lines(rows, 1.0, "cell")
        for one, other in ((0, 8), (8, 0)):
            assert count_obstacles_on(build_ground(grid, 1.0), one, other) == open_
            assert count_obstacles_on(build_ground(grid, 1.0, closed=True), one, other) == closed
        # Along a row nothing changes, and what passes an interior is met by either rule.
        for one, other in itertools.product(range(9), repeat=2):
            assert count_obstacles_on(
                build_ground(grid, 1.0, True), one, other
            ) >= count_obstacles_on(build_ground(grid, 1.0), one, other)


def test_a_node_beside_an_obstacle_encounters_it():
    """Below the block and past it: the edges are free, the first inner node lies beside the block,
    the second does not.
    """
    path = [0, 3, 11, 23]
    for seed in range(20):
        by_edge, by_neighbour = (
            mutated(path, BLOCK, "proposed", seed, without_obstacle="none", obstacle_node=node)[0]
            for node in ("edge", "neighbour")
        )
        assert by_edge == path
        assert by_neighbour[1] != 3
        assert by_neighbour[2] == 11
    far = from_lines(["........", "........", "........", "......##"], 1.0, "cell")
    assert mutated([0, 8, 31], far, "proposed", without_obstacle="none", obstacle_node="neighbour")[
        0
    ] == [0, 8, 31]


def mutated(path, grid, mutation, seed=0, **changes):
    """A path after one mutation, and how many paths were evaluated."""
    rules = fill_settings(node_genetic.Settings, SETTINGS | {"mutation": mutation} | changes)
    path = np.array(path)
    drawn = np.setdiff1d(np.flatnonzero(~grid.occupied), [path[0], path[-1]])
    tried = mutate(
        np.random.default_rng(seed),
        path,
        drawn,
        build_ground(grid, 1.0),
        rules,
        np.empty(MOST_NEIGHBOURS, dtype=np.int64),
    )
    return path.tolist(), tried


def cost(path, grid):
    return sum(
        length(a, b, grid.occupied.shape[1]) + 15 * met(a, b, grid)
        for a, b in itertools.pairwise(path)
    )


STEPS = {
    "eight": list(itertools.product((-1, 0, 1), repeat=2)),
    "four": [(-1, 0), (0, -1), (0, 1), (1, 0)],
    "within_two": list(itertools.product((-2, -1, 0, 1, 2), repeat=2)),
}
each_neighbourhood = pytest.mark.parametrize("neighbourhood", STEPS)


def around(cell, grid, neighbourhood="eight"):
    """Free neighbours of a cell, row by row from the lower left."""
    rows, columns = grid.occupied.shape
    found = []
    for up, across in STEPS[neighbourhood]:
        row, column = cell // columns + up, cell % columns + across
        if (
            (up, across) != (0, 0)
            and 0 <= row < rows
            and 0 <= column < columns
            and not grid.occupied[row, column]
        ):
            found.append(row * columns + column)
    return found


def random_paths(grid, count=60, inner=4):
    free = np.flatnonzero(~grid.occupied)
    for path in np.random.default_rng(1).choice(free, (count, inner)).tolist():
        yield [0, *path, grid.occupied.size - 1]


def changed(before, after):
    return [k for k in range(len(before)) if before[k] != after[k]]


@pytest.mark.parametrize("mutation", OPERATORS)
def test_an_operator_changes_at_most_one_inner_node_to_a_free_cell(mutation):
    # Few obstacles and nodes for the operators that keep or need edges which meet none.
    careful = mutation in ("random_repair", "ref21")
    grid = random_grid(2, share=0.05 if careful else 0.3)
    moved = []
    for seed, path in enumerate(random_paths(grid, inner=2 if careful else 4)):
        after, _ = mutated(path, grid, mutation, seed)
        places = changed(path, after)
        assert len(places) <= 1
        assert {0, len(path) - 1}.isdisjoint(places)
        assert not grid.occupied.flat[after].any()
        moved += places
    assert len(moved) >= 20
    # No inner node is left out.
    assert set(moved) == set(range(1, len(path) - 1))


@each_neighbourhood
def test_neighbours_are_the_free_cells_of_their_neighbourhood(neighbourhood):
    assert len(Neighbourhood) == len(STEPS)
    # On a map without obstacles too, so that no place for one is missing.
    for grid in (random_grid(6), random_grid(6, share=0.0), random_grid(6, shape=(1, 3))):
        ground, found = build_ground(grid, 1.0), np.empty(MOST_NEIGHBOURS, dtype=np.int64)
        for cell in range(grid.occupied.size):
            count = list_free_neighbours(cell, ground, Neighbourhood[neighbourhood], found)
            assert found[:count].tolist() == around(cell, grid, neighbourhood)


@each_neighbourhood
@pytest.mark.parametrize(
    ("mutation", "keep_better"), list(itertools.product(["ref12", "proposed"], [False, True]))
)
def test_the_best_neighbour_takes_the_place_of_a_node(mutation, keep_better, neighbourhood):
    grid = random_grid(3)
    kept = 0
    for seed, path in enumerate(random_paths(grid)):
        after, tried = mutated(
            path, grid, mutation, seed, keep_better=keep_better, neighbourhood=neighbourhood
        )
        if after == path:
            kept += 1
            assert keep_better or any(not around(node, grid, neighbourhood) for node in path[1:-1])
            continue
        (k,) = changed(path, after)
        near = around(path[k], grid, neighbourhood)
        costs = [cost([*path[:k], cell, *path[k + 1 :]], grid) for cell in near]
        assert tried == len(costs)
        assert cost(after, grid) == pytest.approx(min(costs))
        assert after[k] == near[int(np.argmax(np.array(costs) < min(costs) + 1e-9))]
        assert not keep_better or cost(after, grid) < cost(path, grid)
    # Of eight neighbours one is always free here; with more, hardly a node is better than all.
    assert neighbourhood != "eight" or (kept > 0) == keep_better
    assert kept < 60


def test_a_feasible_path_is_changed_as_by_reference_12_or_not_at_all():
    path = [0, 1, 4, 23]
    assert sum(met(a, b, BLOCK) for a, b in itertools.pairwise(path)) == 0
    for seed in range(20):
        assert mutated(path, BLOCK, "proposed", seed, without_obstacle="none") == (path, 0)
        assert mutated(path, BLOCK, "proposed", seed) == mutated(path, BLOCK, "ref12", seed)


@each_neighbourhood
def test_reference_21_steps_towards_the_target_along_free_edges(neighbourhood):
    grid = random_grid(5, share=0.15)
    columns = grid.occupied.shape[1]
    target = np.array(divmod(grid.occupied.size - 1, columns))
    moved = 0
    for seed, path in enumerate(random_paths(grid)):
        after, _ = mutated(path, grid, "ref21", seed, neighbourhood=neighbourhood)
        for k in changed(path, after):
            moved += 1
            way = target - divmod(after[k], columns)
            assert way @ target > 0
            assert after[k] in around(path[k], grid, neighbourhood)
            assert met(after[k - 1], after[k], grid) == met(after[k], after[k + 1], grid) == 0
    assert moved > 3


def test_random_mutation_draws_occupied_cells_if_it_may():
    """Then more of the feasible paths are spoilt."""
    shares = {
        drawn: np.mean(
            [
                plan(
                    ENVIRONMENTS["env1_initial"], seed, mutation="random", random_node=drawn
                ).extra["made_infeasible"]
                for seed in range(10)
            ]
        )
        for drawn in ("free", "any")
    }
    assert shares["free"] < shares["any"]


# Measures


@pytest.mark.parametrize("seed", range(5))
def test_node_diversity_is_the_chance_that_a_node_is_foreign(seed):
    rng = np.random.default_rng(seed)
    lengths = rng.integers(2, 8, 12)
    paths = rng.integers(0, 15, (12, 8))
    inner = [set(path[1 : n - 1].tolist()) for path, n in zip(paths, lengths)]
    foreign = [
        node not in other
        for i, nodes in enumerate(inner)
        for node in nodes
        for j, other in enumerate(inner)
        if j != i
    ]
    assert node_genetic.measure_node_diversity(paths, lengths, 15) == pytest.approx(
        np.mean(foreign)
    )


def test_shares_of_feasible_paths():
    where = ENVIRONMENTS["env1_initial"]
    feasible = {
        initial: plan(where, generations=0, initial=initial).extra["feasible_last"]
        for initial in ("feasible", "rejection", "unrestricted")
    }
    assert feasible["feasible"] == feasible["rejection"] == 1.0 > feasible["unrestricted"]
    assert math.isnan(plan(where, generations=0).extra["made_infeasible"])
    assert plan(where, mutation="random", generations=10).extra["made_infeasible"] > 0.5
    assert plan(where, mutation="random_repair", generations=10).extra["made_infeasible"] == 0.0


# Degenerate and bad input


def test_a_target_in_sight_needs_no_search():
    found = plan(problem(from_lines(["....", "...."], 1.0, "cell")))
    assert found.stop == "direct"
    assert found.objective == pytest.approx(math.sqrt(10))
    assert found.extra["optimal"]
    assert len(found.history) == found.evaluations == 1


def test_a_target_out_of_reach_of_so_few_nodes():
    where = problem(from_lines(["...", ".#.", ".#.", ".#."], 1.0, "cell"), 0, 2)
    found = plan(where, most_nodes=1)
    assert found.path is None
    assert found.stop == "no first population"
    assert plan(where, most_nodes=2).claimed_feasible
