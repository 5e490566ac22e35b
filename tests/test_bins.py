"""Edges by place: the certified check asks the same of near edges as of all."""

import math
import time

import numpy as np
import pytest

from bezierplan.geometry import checker
from bezierplan.geometry.bins import Bins
from bezierplan.geometry.checker.certificates import is_free
from bezierplan.geometry.region import PolygonRegion, Region, build_region
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons

SIDE = 10.0
# Beside an edge, within the tolerance of the check and beyond it, on either side.
BESIDE = (0.0, 1e-13, 3e-10, 8e-10, 2e-9, 1e-8, 1e-6, 1e-3, 0.1)


def field(seed: int, obstacles: int) -> PolygonRegion:
    """Boxes along the axes and turned ones, some of which overlap and some of which cross the
    border.
    """
    rng = np.random.default_rng(seed)
    rings = []
    for number in range(obstacles):
        angle = math.pi / 2 * number / obstacles if number % 2 else 0.0
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        box = rng.uniform(0.1, 1.5, 2) * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        rings.append((box @ turn.T + rng.integers(0, 11, 2),))
    return build_region(Polygons((0.0, SIDE, 0.0, SIDE), tuple(rings), "m"))


def of_all_edges(blocked: Region) -> Region:
    """The region with one bin that holds every edge."""
    low, count = blocked.edges.reshape(-1, 2).min(axis=0), len(blocked.edges)
    return blocked._replace(bins=Bins(low, 1e9, 1, 1, np.array([0, count]), np.arange(count)))


def beside_edges(blocked: PolygonRegion, rng: np.random.Generator, count: int) -> np.ndarray:
    """Points on edges, at their ends, and a little beside them: (count, 2)."""
    chosen = rng.integers(len(blocked.edges), size=count)
    edges, normals = blocked.edges[chosen], blocked.normals[chosen]
    along = rng.choice([0.0, 1.0, *rng.random(4)], count)[:, None]
    away = (rng.choice(BESIDE, count) * rng.choice([-1, 1], count))[:, None]
    return edges[:, :2] + along * (edges[:, 2:] - edges[:, :2]) + away * normals


@pytest.mark.parametrize("seed", range(12))
def test_a_hull_is_free_as_by_all_edges(seed):
    blocked, rng = field(seed, [1, 2, 5, 20][seed % 4]), np.random.default_rng(100 + seed)
    whole, answers = of_all_edges(blocked), []
    for number in range(1200):
        if number % 3:
            # From one place beside an edge to another, or along an edge.
            ends = beside_edges(blocked, rng, 2)
            if number % 3 == 2:
                (edge,) = blocked.edges[rng.integers(len(blocked.edges), size=1)]
                ends = edge[:2] + rng.random((2, 1)) * (edge[2:] - edge[:2])
            share = np.linspace(0, 1, rng.integers(2, 5))[:, None]
            points = ends[0] + share * (ends[1] - ends[0])
            points[1:-1] += rng.choice([0.0, 1e-10, 1e-7, 0.2]) * rng.normal(
                size=points[1:-1].shape
            )
        else:
            points = rng.uniform(-0.1, SIDE + 0.1, 2) + rng.choice([0.01, 0.5, 3]) * rng.normal(
                size=(rng.integers(1, 5), 2)
            )
        answers.append(is_free(points, blocked))
        assert answers[-1] == is_free(points, whole), points
    assert 0 < sum(answers) < len(answers)


def cells(seed: int) -> Region:
    rng = np.random.default_rng(seed)
    return build_region(
        Grid(rng.random((30, 40)) < [0.01, 0.1, 0.3][seed % 3], SIDE / 40, "m", (0, 0))
    )


def discs(seed: int) -> Region:
    rng = np.random.default_rng(seed)
    home = Circles((0.0, SIDE, 0.0, SIDE), SIDE * rng.random((5, 2)), rng.uniform(0.1, 1, 5), "m")
    return build_region(home)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", [lambda seed: field(seed, 8), cells, discs])
def test_depth_and_clearance_are_bit_for_bit_those_by_all_edges(kind, seed):
    blocked, rng = kind(seed), np.random.default_rng(200 + seed)
    whole, verdicts = of_all_edges(blocked), []
    for _ in range(400):
        points = rng.uniform(-0.1, SIDE + 0.1, 2) + rng.choice([0.01, 0.2, 2]) * rng.normal(
            size=(7, 2)
        )
        pieces = np.stack([points[:4], points[3:]])
        verdicts.append(checker.check(pieces, blocked))
        np.testing.assert_equal(verdicts[-1], checker.check(pieces, whole))
    assert 0 < sum(verdict.feasible for verdict in verdicts) < len(verdicts)


def test_a_map_of_two_million_random_cells_is_checked_in_milliseconds():
    """With all its edges this took 20 s."""
    occupied = np.random.default_rng(0).random((1500, 1500)) < 0.2
    occupied[:3] = occupied[:, :3] = False
    blocked = build_region(Grid(occupied, 0.05, "m", (0, 0)))
    around = np.array([[[0.05, 74.95], [0.05, 0.05]], [[0.05, 0.05], [74.95, 0.05]]])
    across = np.array([[[0.05, 0.05], [74.0, 74.0]]])
    verdicts = [checker.check(pieces, blocked) for pieces in (around, across)]  # compiles
    begin = time.process_time()
    assert [checker.check(pieces, blocked) for pieces in (around, across)] == verdicts
    assert time.process_time() - begin < 2.0
    assert [verdict.feasible for verdict in verdicts] == [True, False]
