"""Exact shortest paths: closed forms, published and reference lengths, and that the paths
themselves are free.
"""

import itertools
import math

import numpy as np
import pytest
import scipy
import shapely
from fields import BENCHMARK_MAPS, CELLS, EQUAL, PUBLIC, assert_is_bound, benchmark
from fields import among_circles as around

from bezierplan.geometry.shortest_paths import (
    Bound,
    centre_path,
    lattice_path,
    least_length,
    shortest_path,
)
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.lattice import STEPS, list_neighbours
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem

ROOT2 = math.sqrt(2)


def among(obstacles, start, target, bounds=(0.0, 10.0, 0.0, 10.0)):
    return Problem(
        "",
        Polygons(bounds, tuple((np.array(ring, dtype=float),) for ring in obstacles), "m"),
        start,
        target,
    )


def on_cells(occupied, start, target):
    return Problem("", Grid(np.array(occupied, dtype=bool), 1.0, "m"), start, target)


@pytest.mark.parametrize("name", sorted(file.stem for file in BENCHMARK_MAPS.glob("*.geojson")))
def test_shortest_paths_of_the_benchmark_maps(name):
    problem, length = benchmark(name)
    bound = shortest_path(problem)
    assert bound.length == pytest.approx(length, abs=1e-5)
    assert_is_bound(bound, problem)


SONG = [
    (0, 15, 190.293864, 194.390889),
    (15, 255, 202.374817, 207.024439),
    (240, 255, 170.739758, 173.631357),
    (0, 240, 224.086371, 231.126624),
    (0, 255, 218.494430, 220.032506),
    (15, 240, 220.848583, 224.361260),
]


@pytest.mark.parametrize(("first", "last", "any_angle", "through_centres"), SONG)
def test_paths_of_the_workspace_of_song2016(first, last, any_angle, through_centres):
    grid = from_lines(CELLS.read_text().splitlines(), 10.0, "m")
    problem = Problem("", grid, grid.centre(first), grid.centre(last))
    assert shortest_path(problem).length == pytest.approx(any_angle, abs=1e-5)
    assert centre_path(problem).length == pytest.approx(through_centres, abs=1e-5)
    assert_is_bound(shortest_path(problem), problem)
    assert_is_bound(centre_path(problem), problem)


CORNER_CONTACT = np.zeros((4, 4), dtype=bool)
CORNER_CONTACT[1, 1] = CORNER_CONTACT[2, 2] = True


@pytest.mark.parametrize(
    ("start", "target", "length"),
    [
        ((1, 3), (3, 1), 2.828427),
        ((0.5, 3.5), (3.5, 0.5), 4.242641),
        ((0.5, 2), (3.5, 2), 3),
        ((2, 2), (3, 1), 1.414214),
        ((1.5, 2.5), (2, 2), 0.707107),
    ],
)
def test_a_path_passes_a_contact(start, target, length):
    problem = on_cells(CORNER_CONTACT, start, target)
    bound = shortest_path(problem)
    assert bound.length == pytest.approx(length, abs=1e-5)
    assert_is_bound(bound, problem)


@pytest.mark.parametrize(
    ("discs", "start", "target", "length"),
    [
        (EQUAL, (0, 0), (4, 6), 7.7033905494),
        (PUBLIC, (0, 0), (4, 6), 7.4897085262),
        (((0, 0, 1),), (-2, 0), (2, 0), 2 * math.sqrt(3) + math.pi / 3),
        (((0, 0, 1),), (-1, 0), (2, 0), 3.8264459099),
        (((0, 0, 1),), (-1, 0), (1, 0), math.pi),
        (((0, 0, 1),), (0, 1), (5, 1), 5),
        (((0, 0.6, 1), (0, -0.6, 1)), (-3, 0), (3, 0), 6.8434828391),
        (((0, 0.6, 1), (0, -0.6, 1)), (-0.8, 0), (3, 0), 5.6360388551),
        (((0, 1, 1), (0, -1, 1)), (-3, 0), (3, 0), 6),
        (((0, 0, 2), (0.5, 0, 1)), (-3, 0), (3, 0), 7.3910465799),
        (((0, 0, 2), (0, 0, 2)), (-3, 0), (3, 0), 7.3910465799),
    ],
)
def test_paths_around_circles(discs, start, target, length):
    problem = around(discs, start, target)
    bound = shortest_path(problem)
    assert bound.length == pytest.approx(length, abs=1e-9)
    assert_is_bound(bound, problem)


@pytest.mark.parametrize(("discs", "most"), [(EQUAL, 553), (PUBLIC, 405)], ids=["equal", "public"])
def test_the_polyline_along_arcs_is_as_coarse_as_it_may_be(discs, most):
    bound = shortest_path(around(discs, (0, 0), (4, 6)))
    assert len(bound.points) <= most
    assert 9.8e-7 <= np.hypot(*np.diff(bound.points, axis=0).T).sum() - bound.length <= 1e-6


def test_a_polyline_keeps_clear_of_a_neighbouring_circle():
    # Around the first circle, past another one in a distance of 1e-7.
    problem = around(((0, 0, 1), (0, 2 + 1e-7, 1)), (-2, 0.5), (2, 0.4))
    bound = shortest_path(problem)
    assert bound.points[:, 1].max() >= 1
    assert_is_bound(bound, problem)


@pytest.mark.parametrize(
    "problem",
    [
        around(((0, 0, 1),), (0.5, 0), (3, 0)),
        on_cells([[False, True, False]], (0.5, 0.5), (2.5, 0.5)),
        on_cells([[False, False, False]], (0.5, 0.5), (3.5, 0.5)),
        among([[(4, 0), (5, 0), (5, 10), (4, 10)]], (1, 1), (9, 9)),
        among([[(4, 4), (6, 4), (6, 6), (4, 6)]], (5, 5), (9, 9)),
    ],
    ids=["in a disc", "cell across", "off the grid", "wall across", "in a polygon"],
)
def test_no_path(problem):
    bound = shortest_path(problem)
    assert bound.length == math.inf
    assert bound.points.shape == (0, 2)


@pytest.mark.parametrize(
    "problem",
    [
        around(((0, 0, 1),), (1, 0), (1, 0)),
        on_cells([[False, True]], (0.5, 0.5), (0.5, 0.5)),
        among([[(4, 4), (6, 4), (6, 6), (4, 6)]], (4, 4), (4, 4)),
    ],
    ids=["on a circle", "cells", "on a corner"],
)
def test_start_is_target(problem):
    assert shortest_path(problem).length == 0
    assert shortest_path(problem).points.tolist() == [list(problem.start), list(problem.target)]


@pytest.mark.parametrize(
    ("obstacles", "start", "target", "length"),
    [
        ([[(4, 4), (6, 4), (6, 6), (4, 6)]], (4, 4), (6, 6), 4),
        ([[(4, 4), (6, 4), (6, 6), (4, 6)]], (4, 5), (6, 5), 4),
        ([[(4, 4), (5, 5), (4, 6)], [(5, 5), (6, 4), (6, 6)]], (5, 2), (5, 8), 6),
        (
            [[(4, 4), (5, 5), (4, 6)], [(5, 5), (6, 4), (6, 6)]],
            (4.9, 4),
            (4.9, 6),
            2 * math.hypot(0.1, 1),
        ),
        (
            [[(0, 5), (5, 5), (5, 6), (0, 6)], [(5, 5), (5, 4), (10, 4), (10, 5)]],
            (4, 4),
            (6, 6),
            2 * ROOT2,
        ),
        (
            [[(0, 5), (5, 5), (5, 6), (0, 6)], [(5, 5), (5, 4), (10, 4), (10, 5)]],
            *((4, 4.5), (5.5, 7)),
            math.hypot(1, 0.5) + math.hypot(0.5, 2),
        ),
        (
            [[(4, 4), (5, 4), (5, 6), (4, 6)], [(5, 4), (6, 4), (6, 6), (5, 6)]],
            (5, 3),
            (5, 7),
            2 * ROOT2 + 2,
        ),
        ([[(4, 0), (5, 0), (5, 7), (4, 7)]], (3, 0), (6, 0), 1 + 2 * math.hypot(1, 7)),
    ],
    ids=[
        *(
            "corner to corner",
            "wall to wall",
            "between tips",
            "turning between tips",
            "between regions",
            "turning between regions",
        ),
        *("shared edge", "on the border"),
    ],
)
def test_paths_among_polygons(obstacles, start, target, length):
    problem = among(obstacles, start, target)
    bound = shortest_path(problem)
    assert bound.length == pytest.approx(length, rel=1e-12)
    assert_is_bound(bound, problem)


@pytest.mark.parametrize("weight", [1.5, ROOT2, 0.9, 2.5])
@pytest.mark.parametrize("rule", ["free", "one", "none"])
def test_lattice_paths_are_the_shortest_of_the_whole_graph(rule, weight):
    rng = np.random.default_rng(0)
    found = 0
    for _ in range(60):
        rows, columns = rng.integers(1, 15, 2)
        occupied = rng.random((rows, columns)) < rng.choice([0.0, 0.2, 0.4])
        start, target = (tuple(rng.integers((rows, columns)).tolist()) for _ in range(2))
        occupied[start] = occupied[target] = False
        reached = list_neighbours(occupied, rule)
        tails, steps = np.nonzero(reached >= 0)
        weights = np.where(STEPS[steps].all(axis=1), weight, 1.0)
        graph = scipy.sparse.coo_array(
            (weights, (tails, reached[tails, steps])), shape=(occupied.size, occupied.size)
        ).tocsr()
        least = scipy.sparse.csgraph.dijkstra(graph, indices=start[0] * columns + start[1])[
            target[0] * columns + target[1]
        ]
        bound = lattice_path(occupied, start, target, weight, rule)
        assert bound.length == pytest.approx(least, rel=1e-12)
        if np.isfinite(least):
            found += 1
            column, row = np.floor(bound.points).astype(int).T
            assert (row[0], column[0], row[-1], column[-1]) == (*start, *target)
            cells = row * columns + column
            assert all(other in reached[one] for one, other in itertools.pairwise(cells))
            diagonal = (np.abs(np.diff(bound.points, axis=0)).sum(axis=1) == 2).sum()
            assert bound.length == pytest.approx(
                len(cells) - 1 - diagonal + weight * diagonal, rel=1e-12
            )
    assert found > 30


def test_a_lattice_path_to_an_occupied_cell_and_to_itself():
    assert lattice_path(np.array([[False, True]]), (0, 0), (0, 1), 1.5, "free").length == math.inf
    assert lattice_path(np.array([[False, True]]), (0, 0), (0, 0), 1.5, "free").length == 0


def test_what_bounds_refuse():
    empty = np.zeros((2, 2), dtype=bool)
    with pytest.raises(ValueError, match=r"start .* is not the centre of a cell"):
        centre_path(on_cells(empty, (0.5, 1.0), (1.5, 1.5)))
    with pytest.raises(ValueError, match="expected at most 5000"):
        centre_path(on_cells(np.zeros((72, 72)), (0.5, 0.5), (1.5, 1.5)))


def test_the_least_length_of_a_feasible_path():
    straight = Bound(10.0, np.array([[0.0, 0.0], [10.0, 0.0]]))
    assert least_length(straight) == pytest.approx(10 - 1e-8, abs=1e-14)
    turning = Bound(2.0, np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
    assert 2.0 - least_length(turning) == pytest.approx(2e-9 + 1e-8 * math.pi / 2, abs=1e-15)
    assert least_length(Bound(math.inf, np.empty((0, 2)))) == math.inf


@pytest.mark.parametrize("place", ["cells", "lattice", "anywhere"])
def test_a_path_on_a_grid_is_as_long_as_among_its_cells(place):
    """Single cells and blocks, contacts and dead ends, from points on corners, on edges, in cells
    and in obstacles.
    """
    rng = np.random.default_rng(1)
    found_none = 0
    for _ in range(60):
        rows, columns = rng.integers(1, 15, 2)
        single = rng.random((rows, columns)) < rng.choice([0.1, 0.3, 0.5])
        blocks = np.kron(single[::2, ::2], np.ones((2, 2), dtype=bool))[:rows, :columns]
        occupied = blocks if rng.random() < 0.3 else single
        grid = Grid(occupied, 0.5, "m", (1.0, -2.0))
        parts = {
            "cells": rng.integers(0, 2 * rows + 1, 4) / 2,
            "lattice": rng.integers(0, 61, 4) / 4,
            "anywhere": 15 * rng.random(4),
        }
        ends = np.minimum(parts[place], [columns, rows, columns, rows]).reshape(2, 2)
        problem = Problem("", grid, *(tuple(each) for each in grid.in_units(ends)))
        squares = [
            grid.in_units(np.add([(0, 0), (1, 0), (1, 1), (0, 1)], cell))
            for cell in np.argwhere(occupied)[:, ::-1]
        ]
        found = shortest_path(problem)
        expected = shortest_path(among(squares, problem.start, problem.target, grid.bounds))
        assert found.length == pytest.approx(expected.length, rel=1e-12)
        found_none += math.isinf(found.length)
        if math.isfinite(found.length):
            assert_is_bound(found, problem)
    assert 4 < found_none < 48


def length_in_graph(rings, start, target):
    """Dijkstra's algorithm over all corners, with every free segment between two of them."""
    nodes = np.unique(np.concatenate([[start, target], *rings]), axis=0)
    one, other = np.triu_indices(len(nodes), 1)
    blocked = shapely.union_all([shapely.Polygon(ring) for ring in rings])
    segments = shapely.linestrings(nodes[np.c_[one, other]])
    free = ~shapely.relate_pattern(segments, blocked, "T********")  # no common inner point
    graph = scipy.sparse.coo_array(
        (shapely.length(segments)[free], (one[free], other[free])), shape=(len(nodes),) * 2
    )
    first, last = (np.flatnonzero((nodes == end).all(axis=1)).item() for end in (start, target))
    return scipy.sparse.csgraph.dijkstra(graph.tocsr(), directed=False, indices=first)[last]


@pytest.mark.parametrize("kind", ["stars", "meeting corners"])
def test_a_path_among_polygons_is_as_long_as_in_the_graph_of_all_corners(kind):
    rng = np.random.default_rng(3)
    found_ways = 0
    for _ in range(20):
        if kind == "stars":
            angles = np.sort(rng.uniform(0, math.tau, (4, 9)), axis=1)
            reach = rng.uniform(0.3, 2.2, angles.shape)
            centres = rng.uniform(2.5, 7.5, (4, 2))
            rings = [
                c + r[:, None] * np.column_stack([np.cos(a), np.sin(a)])
                for c, r, a in zip(centres, reach, angles)
            ]
            rings = [ring for ring in rings if shapely.Polygon(ring).is_valid]
        else:
            rings = [
                np.add([(0, 0), (1, 0), (1, 1), (0, 1)], place)
                for place in rng.integers(1, 9, (25, 2))
            ]
        problem = among(rings, (0.5, 0.25), (9.5, 9.75))
        found = shortest_path(problem)
        assert found.length == pytest.approx(
            length_in_graph(rings, problem.start, problem.target), rel=1e-12
        )
        found_ways += len(found.points) > 2
        assert_is_bound(found, problem)
    assert found_ways > 10
