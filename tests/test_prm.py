"""The probabilistic roadmap: its sight test, its graph against a plain reference, degenerate
cases.
"""

import itertools
import math

import fields
import numpy as np
import pytest
from fields import among_circles as problem
from fields import assert_path_fits, drawn
from studies import planned

from bezierplan.geometry import curves
from bezierplan.planners import prm

PUBLIC = problem(fields.PUBLIC)


def plan(where=PUBLIC, seed=0, **changes):
    return planned("tharwat2018", "prm", where, seed, **changes)


def shortest(points, roads):
    """Length of the shortest way from point 0 to point 1, by relaxing every road as often as there
    are points.
    """
    lengths = np.full(len(points), np.inf)
    lengths[0] = 0
    for _ in points:
        for one, other in roads:
            step = math.dist(points[one], points[other])
            lengths[one] = min(lengths[one], lengths[other] + step)
            lengths[other] = min(lengths[other], lengths[one] + step)
    return lengths[1]


def sees(one, other, where):
    """Whether a segment enters no circle, by 2,001 of its points."""
    points = one + np.linspace(0, 1, 2001)[:, None] * (other - one)
    distances = np.hypot(*(points[:, None] - where.workspace.centres).transpose(2, 0, 1))
    return (distances > where.workspace.radii - 1e-6).all()


@pytest.mark.parametrize(
    ("links", "seed"), list(itertools.product(["visible", "nearest"], range(4)))
)
def test_path_is_the_shortest_way_over_the_roads(links, seed):
    nodes, neighbours = 12, 4
    rng = np.random.default_rng(seed)
    points = [np.array(PUBLIC.start), np.array(PUBLIC.target)]
    while len(points) < nodes + 2:
        point = -10 + 20 * rng.random(2)
        if (np.hypot(*(point - PUBLIC.workspace.centres).T) >= PUBLIC.workspace.radii).all():
            points.append(point)
    pairs = set(itertools.combinations(range(len(points)), 2))
    if links == "nearest":
        ranked = [
            sorted(range(len(points)), key=lambda other: math.dist(points[one], points[other]))
            for one in range(len(points))
        ]
        pairs = {
            tuple(sorted((one, other)))
            for one in range(len(points))
            for other in ranked[one][1 : neighbours + 1]
        }
    roads = [(one, other) for one, other in pairs if sees(points[one], points[other], PUBLIC)]
    found = plan(seed=seed, nodes=nodes, links=links, neighbours=neighbours)
    assert found.extra["roads"] == len(roads)
    assert found.objective == pytest.approx(shortest(points, roads))
    assert found.claimed_feasible == (found.path is not None)


def test_more_nodes_keep_those_of_fewer():
    low, high, is_free, _ = prm._prepare_circles(PUBLIC.workspace, 0.0)
    for seed in range(5):
        few, some, many = (
            prm._draw_free_points(np.random.default_rng(seed), nodes, low, high, is_free)
            for nodes in (10, 50, 200)
        )
        assert list(map(len, (few, some, many))) == [10, 50, 200]
        assert np.array_equal(few, some[:10])
        assert np.array_equal(some, many[:50])
        # With links to all that is seen, every way over few nodes is one over more.
        lengths = [plan(seed=seed, nodes=nodes).objective for nodes in (10, 50, 200)]
        assert lengths[2] <= lengths[1] <= lengths[0]


def test_touching_is_allowed():
    tangent = problem([[2.0, -1.0, 1.0]], target=(4.0, 0.0))
    assert plan(tangent, nodes=0).objective == 4
    assert plan(tangent, nodes=0, d_min=0.01).path is None


def test_roadmaps_are_drawn_until_one_connects_start_and_target():
    few = {"nodes": 6, "links": "nearest", "neighbours": 2}
    once = [plan(seed=seed, **few) for seed in range(30)]
    often = [plan(seed=seed, attempts=50, **few) for seed in range(30)]
    assert 0 < sum(found.path is None for found in once) < 30
    assert all(found.path is not None for found in often)
    for first, last in zip(once, often):
        assert (last.evaluations == 1) == (first.path is not None)
        if first.path is not None:
            assert last.objective == first.objective
    enclosed = [[2 * math.cos(a), 2 * math.sin(a), 1] for a in np.linspace(0, 2 * math.pi, 9)]
    assert plan(problem(enclosed), attempts=3).evaluations == 3


def test_a_field_without_free_places_has_no_nodes_and_ends(monkeypatch):
    monkeypatch.setattr(prm, "_MOST_DRAWS", 10)
    assert plan(problem([[0, 0, 20]])).path is None


@pytest.mark.parametrize("number", range(12))
def test_paths_on_a_grid_touch_no_occupied_cell(number):
    where = drawn(number, obstacles=10)
    found = plan(where, seed=number, nodes=300, links="nearest")
    assert_path_fits(where, found)
    assert found.objective == pytest.approx(curves.length(found.path))


def test_a_grid_has_no_distance_to_keep():
    with pytest.raises(ValueError, match=r"d_min: 0\.5; on a grid expected 0"):
        plan(drawn(0), d_min=0.5)
