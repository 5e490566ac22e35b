"""What holds for every workspace: the check agrees with dense sampling, and neither it nor a bound
depends on how a problem is written.
"""

import itertools
import math

import numpy as np
import pytest
import shapely
from fields import BENCHMARK_MAPS, CELLS, pieces_of
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from bezierplan.geometry.checker import check
from bezierplan.geometry.curves import bernstein, bezier_pieces, least_points
from bezierplan.geometry.region import build_region
from bezierplan.geometry.shortest_paths import (
    centre_path,
    lattice_path,
    least_length,
    shortest_path,
)
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.geojson import read_geojson
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Path, Problem

KINDS = ("circles", "cells", "polygons")

# Curves of every degree, and the one whose control points are no points of the plane alone;
# `spline` is made of cubic pieces as well.
CURVES = ("polyline", "piecewise_quadratic", "piecewise_cubic", "bezier", "ferguson")

# Deeper than the first is never called free, not deeper than the second never colliding.
CERTAINLY_DEEP = 4e-9
CERTAINLY_FREE = 5e-10

# --------------------------------------------------------------------------------------------------
# Against dense sampling


class Judge:
    """Depth and clearance of points of a workspace: shapely's distances to free and to blocked
    space; closed forms for circles.
    """

    def __init__(self, workspace):
        self.circles = workspace if isinstance(workspace, Circles) else None
        left, right, bottom, top = workspace.bounds
        border = shapely.box(left, bottom, right, top)
        far = 10 * max(right - left, top - bottom)
        outside = shapely.box(left - far, bottom - far, right + far, top + far) - border
        if self.circles:
            self.free, self.blocked = border, outside
        else:
            obstacles = shapely.union_all(shapes_of(workspace))
            self.free = border - obstacles
            self.blocked = shapely.union_all([obstacles, outside])
        shapely.prepare([self.free, self.blocked])

    def signed_distance(self, points):
        """Distance to the blocked region, negative inside of it: (n,)."""
        places = shapely.points(points)
        signed = shapely.distance(self.blocked, places)
        # shapely gives no number for the distance to free space if there is none.
        signed -= np.where(
            signed > 0, 0, np.nan_to_num(shapely.distance(self.free, places), nan=math.inf)
        )
        if self.circles:
            offsets = points[:, None] - self.circles.centres
            signed = np.minimum(
                signed,
                (np.hypot(offsets[..., 0], offsets[..., 1]) - self.circles.radii).min(
                    axis=1, initial=math.inf
                ),
            )
        return signed


def shapes_of(workspace):
    if isinstance(workspace, Grid):
        row, column = np.nonzero(workspace.occupied)
        h = workspace.cell
        return shapely.box(column * h, row * h, (column + 1) * h, (row + 1) * h)
    return [shapely.Polygon(rings[0], rings[1:]) for rings in workspace.obstacles]


def evaluate(pieces, at):
    """Points (n, 2) of a path at piece numbers plus parameters (n,)."""
    number = np.clip(np.floor(at).astype(int), 0, len(pieces) - 1)
    return np.einsum("nk,nkd->nd", bernstein(pieces.shape[1] - 1, at - number), pieces[number])


def least(function, pieces, samples, minima=4):
    """Least value of a function of points along a path: over its joints and uniform samples,
    refined to 1e-7 around the least minima.
    """
    at = np.union1d(np.linspace(0, len(pieces), samples), np.arange(len(pieces)))
    values = function(evaluate(pieces, at))
    padded = np.pad(values, 1, constant_values=math.inf)
    local = np.flatnonzero((values <= padded[:-2]) & (values <= padded[2:]))
    best = values.min()
    centres = at[local[np.argsort(values[local])[:minima]]]
    reach = len(pieces) / samples
    for _ in range(3):
        near = np.clip(centres[:, None] + reach * np.linspace(-1, 1, 61), 0, len(pieces))
        found = function(evaluate(pieces, near.ravel())).reshape(near.shape)
        best = min(best, found.min())
        centres = near[np.arange(len(near)), found.argmin(axis=1)]
        reach /= 30
    return best


def assert_check_is_right(workspace, pieces, blocked, judge):
    samples = min(1200, max(100, 40 * pieces[:, :, 0].size))
    found = check(pieces, blocked)
    if found.feasible:
        distance = least(judge.signed_distance, pieces, samples)
        assert distance >= -CERTAINLY_DEEP
        assert found.clearance - found.tolerance <= max(distance, 0) + 1e-12
        assert found.clearance >= distance - 1e-6
        return
    around = np.clip(found.collision_at + np.linspace(-1e-7, 1e-7, 11), 0, len(pieces))
    assert judge.signed_distance(evaluate(pieces, around)).min() < -CERTAINLY_FREE
    at = np.linspace(0, len(pieces), samples)
    depth = -judge.signed_distance(evaluate(pieces, at))
    assert depth[at < found.collision_at].max(initial=0) <= CERTAINLY_DEEP
    assert depth.max() <= found.depth + found.tolerance + 1e-11


def random_path(rng, curve, extent):
    """A random path in a square workspace; every other one is short. Bézier curves have degrees up
    to 11.
    """
    count = int(rng.integers(least_points(curve), 13))
    if curve == "ferguson":
        count -= count % 2  # points and tangents by turns
    if rng.random() < 0.5:
        low, high = extent
        return Path(curve, rng.uniform(low, high, (count, 2)))
    size = 0.1 * (extent[1] - extent[0])
    return Path(
        curve,
        rng.uniform(*extent, 2)
        + np.cumsum(rng.normal(0, size / math.sqrt(count), (count, 2)), axis=0),
    )


def random_workspaces(kind, rng):
    if kind == "circles":
        return [
            Circles(
                (-10.0, 10.0, -10.0, 10.0), rng.uniform(-9, 9, (n, 2)), rng.uniform(0.2, 2, n), "m"
            )
            for n in (3, 8, 12)
        ]
    if kind == "cells":
        song = from_lines(CELLS.read_text().splitlines(), 10.0, "m")
        return [
            song,
            Grid(rng.random((12, 12)) < 0.25, 1.0, "m"),
            Grid(rng.random((20, 20)) < 0.1, 0.1, "m"),
        ]
    complex2 = read_geojson((BENCHMARK_MAPS / "complex2.geojson").read_text(), "m")
    triangles = tuple((rng.uniform(1, 19, 2) + rng.uniform(-3, 3, (3, 2)),) for _ in range(8))
    spiral = read_geojson((BENCHMARK_MAPS / "square_spiral.geojson").read_text(), "m")
    return [complex2, Polygons((0.0, 20.0, 0.0, 20.0), triangles, "m"), spiral]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("curve", CURVES)
def test_random_paths_against_dense_sampling(curve, kind):
    rng = np.random.default_rng([CURVES.index(curve), KINDS.index(kind)])
    for workspace in random_workspaces(kind, rng):
        blocked, judge = build_region(workspace), Judge(workspace)
        for _ in range(40):
            pieces = bezier_pieces(random_path(rng, curve, workspace.bounds[:2]))
            assert_check_is_right(workspace, pieces, blocked, judge)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("curve", CURVES)
def test_tangent_paths_against_dense_sampling(curve, kind):
    """Paths moved until they are tangent to an obstacle are free, 4e-9 deeper they collide."""
    rng = np.random.default_rng([7, CURVES.index(curve), KINDS.index(kind)])
    for _ in range(40):
        path = random_path(rng, curve, (-5.0, 5.0))
        pieces = bezier_pieces(path)
        if kind == "circles":
            centre = rng.uniform(-8, 8, 2)

            def function(points, centre=centre):
                return np.hypot(*(points - centre).T)

            radius = least(function, pieces, 400)
            workspaces = [
                Circles((-99.0, 99.0, -99.0, 99.0), centre[None], np.array([radius + depth]), "m")
                for depth in (0, 4e-9)
            ]
        else:
            angle = 0.0 if kind == "cells" else rng.uniform(-1, 1)
            normal = np.array([-math.sin(angle), math.cos(angle)])
            least_height = least(lambda points, normal=normal: points @ normal, pieces, 400)
            pieces = (
                pieces
                + (50 - least_height) * normal
                + 50 * np.array([math.cos(angle), math.sin(angle)])
            )
            workspaces = [half_blocked(kind, angle)] * 2
        for workspace, depth in zip(workspaces, (0, 4.2e-9)):
            moved = pieces if kind == "circles" else pieces - depth * normal
            found = check(moved, build_region(workspace))
            assert found.feasible == (depth == 0)
            assert found.clearance <= 1e-9
            assert found.intervals <= 64 + 40 * len(pieces) * (pieces.shape[1] - 1) + len(pieces)


def half_blocked(kind, angle):
    """A workspace blocked below the line through 50 times the normal of some angle."""
    if kind == "cells":
        return Grid(np.broadcast_to(np.arange(20)[:, None] < 5, (20, 20)), 10.0, "m")
    along = np.array([math.cos(angle), math.sin(angle)])
    normal = np.array([-along[1], along[0]])
    ends = 50 * normal + np.array([[-400], [400]]) * along
    return Polygons(
        (-500.0, 500.0, -500.0, 500.0), ((np.concatenate([ends, ends[::-1] - 50 * normal]),),), "m"
    )


# --------------------------------------------------------------------------------------------------
# However a problem is written

SIZE = 6
LATTICE = st.integers(0, 2 * SIZE).map(lambda value: value / 2)
PLACE = st.tuples(LATTICE, LATTICE)


@st.composite
def circle_workspaces(draw):
    table = draw(
        st.lists(st.tuples(LATTICE, LATTICE, st.sampled_from([0.25, 0.5, 1.0, 1.25])), max_size=5)
    )
    table = np.array(table, dtype=float).reshape(-1, 3)
    return Circles((0.0, float(SIZE), 0.0, float(SIZE)), table[:, :2], table[:, 2], "m")


def grid_workspaces():
    return hnp.arrays(bool, (SIZE, SIZE), elements=st.sampled_from([False, False, True])).map(
        lambda occupied: Grid(occupied, 1.0, "m")
    )


@st.composite
def polygon_workspaces(draw):
    """Triangles and rectangles on a lattice: corners, edges and diagonals coincide often."""
    obstacles = []
    for _ in range(draw(st.integers(0, 4))):
        corners = np.array(draw(st.lists(PLACE, min_size=3, max_size=3)))
        low, high = corners.min(axis=0), corners.max(axis=0)
        if draw(st.booleans()):
            corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
        if shapely.Polygon(corners).area > 0:
            obstacles.append((corners,))
    return Polygons((0.0, float(SIZE), 0.0, float(SIZE)), tuple(obstacles), "m")


WORKSPACES = st.one_of(circle_workspaces(), grid_workspaces(), polygon_workspaces())
PROBLEMS = st.builds(Problem, st.just(""), WORKSPACES, PLACE, PLACE)


@st.composite
def paths(draw):
    curve = draw(st.sampled_from(CURVES))
    points = draw(st.lists(PLACE, min_size=least_points(curve), max_size=7))
    if curve == "ferguson":
        points = points[: len(points) - len(points) % 2]  # points and tangents by turns
    return bezier_pieces(Path(curve, np.array(points)))


@given(WORKSPACES, paths())
def test_touching_paths_against_dense_sampling(workspace, pieces):
    """On a lattice paths begin, end, turn and run on the boundaries of obstacles all the time."""
    assert_check_is_right(workspace, pieces, build_region(workspace), Judge(workspace))


def mapped(workspace, flip):
    """A workspace mirrored at its main diagonal, or at its vertical middle line."""
    if isinstance(workspace, Grid):
        return Grid(
            np.ascontiguousarray(
                workspace.occupied.T if flip == "diagonal" else workspace.occupied[:, ::-1]
            ),
            workspace.cell,
            "m",
        )
    if isinstance(workspace, Circles):
        return Circles(
            workspace.bounds, mapped_points(workspace.centres, flip), workspace.radii, "m"
        )
    rings = tuple(
        tuple(mapped_points(ring, flip) for ring in obstacle) for obstacle in workspace.obstacles
    )
    return Polygons(workspace.bounds, rings, "m")


def mapped_points(points, flip):
    points = np.asarray(points, dtype=float)
    return points[..., ::-1] if flip == "diagonal" else points * (-1, 1) + (SIZE, 0)


@given(PROBLEMS)
def test_a_shortest_path_is_free_and_the_straight_line_if_that_is(problem):
    bound = shortest_path(problem)
    straight = math.dist(problem.start, problem.target)
    blocked = build_region(problem.workspace)
    if check(np.array([[problem.start, problem.target]]), blocked).feasible:
        assert bound.length == pytest.approx(straight, rel=1e-12)
    else:
        assert bound.length > straight
    assert least_length(bound) <= bound.length
    if bound.length < math.inf:
        assert check(pieces_of(bound), blocked).feasible


@given(PROBLEMS, paths(), st.sampled_from(["diagonal", "middle"]))
def test_mirroring(problem, pieces, flip):
    mirrored = Problem(
        "",
        mapped(problem.workspace, flip),
        *(tuple(mapped_points(p, flip)) for p in (problem.start, problem.target)),
    )
    assert shortest_path(mirrored).length == pytest.approx(shortest_path(problem).length, rel=1e-9)
    found = check(pieces, build_region(problem.workspace))
    assert_same_check(check(mapped_points(pieces, flip), build_region(mirrored.workspace)), found)


def assert_same_check(a, b):
    assert a.feasible == b.feasible
    assert a.collision_at == pytest.approx(b.collision_at, abs=1e-6, nan_ok=True)
    assert a.depth == pytest.approx(b.depth, abs=2e-6 * (1 + b.depth))
    assert a.clearance == pytest.approx(b.clearance, abs=2e-9)


@given(grid_workspaces(), paths())
def test_a_grid_is_its_cells_as_polygons(grid, pieces):
    """So is its shortest path: `test_a_path_on_a_grid_is_as_long_as_among_its_cells`."""
    row, column = np.nonzero(grid.occupied)
    squares = tuple(
        (np.array([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)], dtype=float),)
        for x, y in zip(column, row)
    )
    squares = Polygons(grid.bounds, squares, "m")
    found = check(pieces, build_region(grid))
    # The parameter depends on which depth above the tolerance is noticed, which is free; where a
    # path dives in slowly it matters.
    assert_same_check(
        check(pieces, build_region(squares))._replace(collision_at=found.collision_at), found
    )


def elevated(piece, times):
    """The same curve with a degree higher by `times`."""
    for _ in range(times):
        n = len(piece)
        share = np.arange(n + 1)[:, None] / n
        piece = share * np.vstack([piece[:1], piece]) + (1 - share) * np.vstack([piece, piece[-1:]])
    return piece


def split(piece, t):
    """A piece cut in two at a parameter."""
    left, right, level = [], [], piece
    while len(level):
        left.append(level[0])
        right.append(level[-1])
        level = (1 - t) * level[:-1] + t * level[1:]
    return np.array([left, right[::-1]])


@given(
    WORKSPACES,
    paths(),
    st.integers(1, 3),
    st.floats(0.05, 0.95),
)
def test_the_verdict_does_not_depend_on_how_a_path_is_written(workspace, pieces, times, t):
    blocked = build_region(workspace)
    found = check(pieces, blocked)
    higher = check(np.array([elevated(piece, times) for piece in pieces]), blocked)
    assert_same_check(higher, found)
    halves = check(np.concatenate([split(piece, t) for piece in pieces]), blocked)
    assert halves.feasible == found.feasible
    if not found.feasible:
        piece, part = divmod(halves.collision_at, 2)
        back = piece + (part * t if part < 1 else t + (part - 1) * (1 - t))
        assert back == pytest.approx(found.collision_at, abs=1e-4)
    reverse = check(pieces[::-1, ::-1], blocked)
    assert reverse.feasible == found.feasible
    assert reverse.clearance == pytest.approx(found.clearance, abs=2e-9)


@given(
    grid_workspaces(),
    st.tuples(st.integers(0, SIZE - 1), st.integers(0, SIZE - 1)),
    st.tuples(st.integers(0, SIZE - 1), st.integers(0, SIZE - 1)),
)
def test_lattice_centre_and_any_angle_paths(grid, start, target):
    """Each serves more routes than the one before it, and all of them are free."""
    ends = [tuple(value + 0.5 for value in cell[::-1]) for cell in (start, target)]
    problem = Problem("", grid, *ends)
    bounds = [
        lattice_path(grid.occupied, start, target, math.sqrt(2), rule)
        for rule in ("none", "one", "free")
    ]
    bounds += [centre_path(problem), shortest_path(problem)]
    blocked = build_region(grid)
    for bound in bounds:
        if len(bound.points) > 1:
            found = check(pieces_of(bound), blocked)
            assert found.feasible
            assert found.intervals <= 64 + len(bound.points)
    lengths = [bound.length for bound in bounds]
    assert all(later <= earlier * (1 + 1e-12) for earlier, later in itertools.pairwise(lengths))
