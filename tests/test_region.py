"""Whether a point is blocked, by the region alone, against the certified check of the path that
stays there.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.polygons import Polygons

SQUARE = np.array([[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]])
WALL = np.array([[7.0, 0.0], [8.0, 0.0], [8.0, 5.0], [7.0, 5.0]])
RING = np.array([[1.0, 6.0], [3.5, 6.0], [3.5, 9.0], [1.0, 9.0]])
HOLE = np.array([[2.0, 7.0], [3.0, 7.0], [3.0, 8.0], [2.0, 8.0]])
WORKSPACES = {
    "grid": from_lines(["....#", ".##..", ".##..", "....#", "#...."], 2.0, "unit"),
    "circles": Circles(
        (0.0, 10.0, 0.0, 10.0),
        np.array([[3.0, 3.0], [5.0, 3.0], [9.5, 9.5]]),
        np.array([1.0, 1.5, 1.0]),
        "unit",
    ),
    "polygons": Polygons((0.0, 10.0, 0.0, 10.0), ((SQUARE,), (WALL,), (RING, HOLE)), "unit"),
}
# Whole and half numbers meet edges, corners and seams; some lie outside.
coordinates = st.one_of(st.integers(-8, 28).map(lambda n: n / 2), st.floats(-4, 14))


@pytest.mark.parametrize("kind", WORKSPACES)
@given(x=coordinates, y=coordinates)
def test_point_is_blocked_where_a_path_that_stays_there_collides(kind, x, y):
    found = build_region(WORKSPACES[kind])
    assert is_blocked(found, (x, y)) != check(np.array([[(x, y), (x, y)]]), found).feasible
