"""The certified check: what touches is free, what enters is found, and where, how deep, how
near.
"""

import math
import re

import numpy as np
import pytest
from test_exact_properties import elevated

from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons

FREE = None


def points_of(text):
    """Points from text such as `(0,1)(2.5,3)`."""
    return np.array([[float(x), float(y)] for x, y in re.findall(r"\(([^,]+),([^)]+)\)", text)])


def bezier(text):
    return points_of(text)[None]


def polyline(points):
    points = points_of(points) if isinstance(points, str) else np.asarray(points, dtype=float)
    return np.stack([points[:-1], points[1:]], axis=1)


def lowered(pieces, by):
    return pieces - np.array([0.0, by])


def circles(*discs, bounds=(-10.0, 10.0, -10.0, 10.0)):
    table = np.array(discs, dtype=float).reshape(-1, 3)
    return build_region(Circles(bounds, table[:, :2], table[:, 2], "m"))


def cells(size, *occupied, cell=1.0):
    """A square grid from the ranges (first column, first row, columns, rows) of its occupied
    cells.
    """
    grid = np.zeros((size, size), dtype=bool)
    for column, row, columns, rows in occupied:
        grid[row : row + rows, column : column + columns] = True
    return build_region(Grid(grid, cell, "m"))


def polygons(*obstacles, bounds=(0.0, 10.0, 0.0, 10.0)):
    """Polygons from text; an obstacle is one ring, or several separated by spaces: the outer one
    and its holes.
    """
    return build_region(
        Polygons(
            bounds,
            tuple(tuple(points_of(ring) for ring in text.split()) for text in obstacles),
            "m",
        )
    )


UNIT_DISC = circles((0, 0, 1))
DISC_FAR_OFF = circles((8, -8, 1))
BLOCK = cells(6, (2, 2, 2, 1))
BLOCK_AND_BORDER = cells(6, (2, 2, 2, 1), (3, 0, 1, 1))
LARGE_BLOCK = cells(6, (1, 1, 3, 3))
CORNER_CONTACT = cells(4, (1, 1, 1, 1), (2, 2, 1, 1))
SQUARE = polygons("(4,4)(6,4)(6,6)(4,6)")
ELL = polygons("(2,2)(8,2)(8,8)(6,8)(6,4)(2,4)")
HOLLOW = polygons("(1,1)(9,1)(9,9)(1,9) (3,3)(7,3)(7,7)(3,7)")
WALL_ON_BORDER = polygons("(4,0)(5,0)(5,7)(4,7)")
TRIANGLES = polygons("(4,4)(5,5)(4,6)", "(5,5)(6,4)(6,6)")
THIN_WALL = polygons("(4,5)(6,5)(6,5.000001)(4,5.000001)")
NARROW_GAP = polygons("(4,4)(5,4)(5,6)(4,6)", "(5.0000001,4)(10,4)(10,6)(5.0000001,6)")
SHARED_EDGE = polygons("(4,4)(5,4)(5,6)(4,6)", "(5,4)(10,4)(10,6)(5,6)")
WAVE_ON_EDGE = np.column_stack([np.random.default_rng(0).uniform(0, 6, 13), np.full(13, 3.0)])[None]

TOUCHING = {
    "disc: tangent": (UNIT_DISC, bezier("(-3,1)(3,1)"), FREE),
    "disc: tangent and back": (UNIT_DISC, bezier("(-3,1)(3,1)(-3,1)"), FREE),
    "disc: one point on the circle": (UNIT_DISC, bezier("(1,0)(1,0)(1,0)(1,0)"), FREE),
    "disc: secant 1e-8 deep": (UNIT_DISC, bezier("(-3,0.99999999)(3,0.99999999)"), 0.49998),
    "disc: apex on it, curving away": (UNIT_DISC, bezier("(-1,2)(0,0)(1,2)"), FREE),
    "disc: apex on it, bending round": (UNIT_DISC, bezier("(-2,.4)(0,1.6)(2,.4)"), FREE),
    "disc: starts on it, radial": (UNIT_DISC, bezier("(1,0)(2,0)(3,1)"), FREE),
    "disc: starts on it, tangential": (UNIT_DISC, bezier("(1,0)(1,2)(3,3)"), FREE),
    "disc: one point inside": (UNIT_DISC, bezier("(.5,0)(.5,0)(.5,0)"), 0.0),
    "disc: as small as the path's rounding": (
        circles((0, 0.02, 1e-4)),
        bezier("(-5,0)(0,.04)(5,0)"),
        0.49999,
    ),
    "border: touched from inside": (DISC_FAR_OFF, bezier("(-5,8)(0,12)(5,8)"), FREE),
    "border: from it outwards and back": (DISC_FAR_OFF, bezier("(-5,10)(0,12)(5,10)"), 0.0),
    "border: crossed by 5e-4": (DISC_FAR_OFF, bezier("(-5,8)(0,12.001)(5,8)"), 0.49209531),
    "cells: along an edge": (BLOCK, bezier("(0,3)(6,3)"), FREE),
    "cells: to and fro along an edge": (BLOCK, WAVE_ON_EDGE, FREE),
    "cells: around along edges": (BLOCK, polyline("(0,0)(2,0)(2,3)(4,3)(4,2)(6,2)"), FREE),
    "cells: past a corner": (BLOCK, bezier("(0,1)(4,5)"), FREE),
    "cells: past a corner, 4.5e-9 lower": (BLOCK, lowered(bezier("(0,1)(4,5)"), 4.5e-9), 0.5),
    "cells: through a seam": (BLOCK, bezier("(3,0)(3,6)"), 1 / 3),
    "cells: beside a seam": (BLOCK, bezier("(2.9999999985,0)(2.9999999985,6)"), 1 / 3),
    "cells: within a seam": (BLOCK, bezier("(3,2)(3,3)"), 0.0),
    "cells: along the border under a cell": (BLOCK_AND_BORDER, bezier("(0,0)(6,0)"), 0.5),
    "cells: through a block's vertices": (LARGE_BLOCK, bezier("(0,0)(5,5)"), 0.2),
    "cells: from an edge into the cell and back": (BLOCK, bezier("(2.25,3)(2.5,2.5)(2.75,3)"), 0.0),
    "cells: out of the grid": (BLOCK, bezier("(1,1)(-2,1)"), 1 / 3),
    "cells: far out of the grid": (BLOCK, bezier("(-5,1)(-5,2)"), 0.0),
    "contact: straight through": (CORNER_CONTACT, bezier("(1,3)(3,1)"), FREE),
    "contact: apex on it": (CORNER_CONTACT, bezier("(.5,3.5)(2,2)(3.5,.5)"), FREE),
    "contact: along grid lines": (CORNER_CONTACT, bezier("(0,2)(4,2)"), FREE),
    "square: along a wall": (SQUARE, bezier("(0,6)(10,6)"), FREE),
    "square: past a corner": (SQUARE, bezier("(2,4)(6,8)"), FREE),
    "square: past a corner, 4.5e-9 lower": (SQUARE, lowered(bezier("(2,4)(6,8)"), 4.5e-9), 0.5),
    "square: apex on a corner": (SQUARE, bezier("(3,7)(5,5)(7,7)"), FREE),
    "square: from a wall into it and back": (SQUARE, bezier("(4.5,6)(5,5)(5.5,6)"), 0.0),
    "square: from wall to wall through it": (SQUARE, bezier("(4,5)(6,5)"), 0.0),
    "square: from a corner into it and back": (SQUARE, bezier("(6,6)(5,5.5)(6,5)"), 0.0),
    "square: from a wall away and back": (SQUARE, bezier("(4.5,6)(5,7)(5.5,6)"), FREE),
    "square: along its diagonal": (SQUARE, bezier("(4,4)(6,6)"), 0.0),
    "L: along a wall and on into it": (ELL, bezier("(2,4)(8,4)"), 2 / 3),
    "L: from the inner corner into it": (ELL, bezier("(6,4)(8,2)"), 0.0),
    "L: from wall to wall across the inner corner": (ELL, bezier("(3,4)(6,4)(6,7)"), FREE),
    "L: from wall to wall under the inner corner": (ELL, bezier("(3,4)(7,3)(6,7)"), 0.0),
    "L: along both walls of the inner corner": (ELL, polyline("(2,4)(6,4)(6,8)"), FREE),
    "hole: round its walls": (HOLLOW, polyline("(3,3)(7,3)(7,7)(3,7)(3,3)"), FREE),
    "hole: from its corner to the outer one": (HOLLOW, bezier("(7,7)(9,9)"), 0.0),
    "wall on the border: under it": (WALL_ON_BORDER, bezier("(0,0)(10,0)"), 0.4),
    "wall on the border: over it": (WALL_ON_BORDER, polyline("(1,1)(4,7)(5,7)(9,1)"), FREE),
    "triangles: between their tips": (TRIANGLES, bezier("(5,2)(5,8)"), FREE),
    "thin wall: through it": (THIN_WALL, bezier("(5,2)(5,8)"), 0.5),
    "thin wall: along its lower side": (THIN_WALL, bezier("(0,5)(10,5)"), FREE),
    "thin wall: along its upper side": (THIN_WALL, bezier("(0,5.000001)(10,5.000001)"), FREE),
    "thin wall: chord through it, curve past it": (
        THIN_WALL,
        polyline("(3,4)(4,5.000001)(6,5.000001)(7,4)"),
        FREE,
    ),
    "gap of 1e-7: through it": (NARROW_GAP, bezier("(5.00000005,2)(5.00000005,8)"), FREE),
    "shared edge: along it": (SHARED_EDGE, bezier("(5,2)(5,8)"), 1 / 3),
}


@pytest.mark.parametrize("case", TOUCHING)
def test_touching_is_free_and_entering_is_not(case):
    blocked, pieces, collision_at = TOUCHING[case]
    found = check(pieces, blocked)
    assert found.feasible == (collision_at is FREE)
    if found.feasible:
        assert math.isnan(found.collision_at)
        assert found.depth == 0
        assert found.clearance <= 6e-8
        assert found.intervals <= 64 + len(pieces)
    else:
        assert found.collision_at == pytest.approx(collision_at, abs=1e-5)
        assert found.depth > 1e-9
        assert found.clearance == 0


@pytest.mark.parametrize("bulge", [0.0, 1e-3])
def test_an_apex_under_a_thin_wall_touches_it(bulge):
    # The apex of the curve (3,4)(5,6)(7,4) is (5,5), on the wall's lower side.
    found = check(bezier(f"(3,4)(5,{6 + bulge})(7,4)"), THIN_WALL)
    assert found.feasible == (bulge == 0)


def test_the_first_collision_is_the_first_along_the_path():
    found = check(polyline("(-3,1)(3,1)(3,0)(-3,0)(-3,-3)(3,3)"), UNIT_DISC)
    assert found.collision_at == pytest.approx(2 + 1 / 3, abs=1e-8)


@pytest.mark.parametrize(
    ("blocked", "pieces", "depth"),
    [
        (UNIT_DISC, bezier("(-3,.25)(3,.25)"), 0.75),
        (UNIT_DISC, bezier("(-2,1)(0,0)(2,1)"), 0.5),
        (DISC_FAR_OFF, bezier("(-5,8)(0,12.001)(5,8)"), 5e-4),
        (DISC_FAR_OFF, bezier("(0,0)(13,14)"), 5.0),
        (BLOCK, bezier("(0,2.25)(6,2.25)"), 0.25),
        (LARGE_BLOCK, bezier("(0,0)(5,5)"), 1.5),
        (SQUARE, bezier("(0,5.75)(10,5.75)"), 0.25),
        (SQUARE, bezier("(0,7)(5,4)(10,7)"), 0.5),
        (SHARED_EDGE, bezier("(5,2)(5,8)"), 1.0),
    ],
)
def test_depth_is_the_largest_distance_to_free_space(blocked, pieces, depth):
    found = check(pieces, blocked)
    assert found.depth == pytest.approx(depth, rel=1e-6)
    assert found.depth <= depth * (1 + 1e-9) <= (found.depth + found.tolerance) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("blocked", "pieces", "clearance"),
    [
        (UNIT_DISC, bezier("(-3,1.25)(3,1.25)"), 0.25),
        (UNIT_DISC, bezier("(-2,1.5)(0,2.5)(2,1.5)"), 1.0),
        (circles(), bezier("(-5,0)(5,8)"), 2.0),
        (BLOCK, bezier("(0.5,3.5)(5.5,3.5)"), 0.5),
        (BLOCK, bezier("(1.5,4.5)(1.75,4)"), math.hypot(0.25, 1)),
        (SQUARE, bezier("(1,7)(5,7)(9,7)"), 1.0),
        (SQUARE, bezier("(3,9)(5,5)(7,9)"), 1.0),
        (NARROW_GAP, bezier("(5.00000005,2)(5.00000005,8)"), 5e-8),
        (polygons(), bezier("(3,3)(4,5)"), 3.0),
    ],
)
def test_clearance_is_the_least_distance_to_the_blocked_region(blocked, pieces, clearance):
    found = check(pieces, blocked)
    assert found.feasible
    assert found.clearance == pytest.approx(clearance, abs=found.tolerance)


def test_no_free_space_at_all():
    assert check(bezier("(5,5)(6,6)"), polygons("(0,0)(10,0)(10,10)(0,10)")).collision_at == 0
    assert not check(bezier("(1,1)(2,2)"), cells(4, (0, 0, 4, 4))).feasible


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1.1e5])
def test_unfit_coordinates_are_refused(value):
    with pytest.raises(ValueError, match="not finite or beyond 100000"):
        check(np.array([[[0.0, 0.0], [value, 1.0]]]), UNIT_DISC)


def test_large_degrees_have_a_smaller_range():
    far = np.zeros((1, 61, 2))
    far[0, :, 0] = 5e4
    assert check(far, circles((0.0, 0.0, 1.0), bounds=(-1e5, 1e5, -1e5, 1e5))).feasible
    far[0, 30, 0] = 5.4e4
    with pytest.raises(ValueError, match=r"not finite or beyond 53333[.]3"):
        check(far, UNIT_DISC)


@pytest.mark.parametrize(
    "blocked",
    [
        build_region(Grid(np.arange(900).reshape(30, 30) % 41 == 7, 1.0, "m")),
        circles((10.0, 12.0, 4.0), (20.0, 19.0, 3.0), bounds=(0.0, 30.0, 0.0, 30.0)),
    ],
    ids=["grid", "circles"],
)
def test_curves_of_degree_60_get_the_verdict_of_the_same_curve_of_a_low_degree(blocked):
    rng = np.random.default_rng(60)
    verdicts = []
    for _ in range(60):
        piece = rng.uniform(0.5, 29.5, (rng.integers(3, 6), 2))
        low, high = (
            check(piece[None], blocked),
            check(elevated(piece, 61 - len(piece))[None], blocked),
        )
        verdicts.append(low.feasible)
        assert low.feasible == high.feasible
        if low.feasible:
            assert high.clearance == pytest.approx(low.clearance, abs=1e-8)
        else:
            assert high.collision_at == pytest.approx(low.collision_at, abs=1e-5)
            assert high.depth == pytest.approx(low.depth, rel=1e-5, abs=1e-8)
    assert 10 < sum(verdicts) < 50


def test_halving_a_curve_of_degree_60_stays_far_below_the_tolerance():
    # A path that touches the border to the last bit of its exact value: down to parts of 2**-40
    # nothing may be called a collision.
    rng = np.random.default_rng(5)
    height = np.abs(rng.uniform(0, 2000, 61))
    height[[0, 1, 59, 60]] = 0.0
    piece = np.column_stack([np.linspace(0, 2000, 61), height])
    assert check(piece[None], circles(bounds=(0.0, 2000.0, 0.0, 2000.0))).feasible
    assert not check(piece[None] - [0.0, 1e-8], circles(bounds=(0.0, 2000.0, 0.0, 2000.0))).feasible


def test_the_error_of_a_depth_is_proven():
    found = check(polyline("(1,5)(9,5)"), circles((5, 5, 2)))
    assert found.depth == pytest.approx(2.0, rel=1e-6)
    assert found.tolerance == 1e-6 * found.depth
