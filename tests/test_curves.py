"""Curves: closed forms, worked examples, and properties that hold for every kind."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.integrate import quad
from scipy.interpolate import BSpline, CubicHermiteSpline, CubicSpline

from bezierplan.geometry import curves
from bezierplan.workspaces.problem import Path

coordinates = st.floats(-100, 100, allow_subnormal=False)


@st.composite
def paths(draw, kinds=curves.CURVES):
    curve = draw(st.sampled_from(kinds))
    count = draw(st.integers(curves.least_points(curve), 9))
    if curve == "ferguson":
        count -= count % 2
    if curve == "cubic_chain":
        count -= (count - 1) % 3
    return Path(curve, draw(hnp.arrays(float, (count, 2), elements=coordinates)))


def sampled(path, samples=201):
    return curves.sample_matrix(path.curve, len(path.points), samples) @ path.points


@pytest.mark.parametrize(
    ("curve", "degree"),
    [("polyline", 1), ("piecewise_quadratic", 2), ("piecewise_cubic", 3), ("bezier", 6)],
)
def test_samples_are_those_of_a_clamped_uniform_b_spline(curve, degree):
    points = np.random.default_rng(0).normal(size=(7, 2))
    pieces = 7 - degree
    knots = np.concatenate([np.zeros(degree), np.arange(pieces + 1), np.full(degree, pieces)])
    expected = BSpline(knots, points, degree)(np.linspace(0, pieces, 101))
    assert np.allclose(sampled(Path(curve, points), 101), expected, atol=1e-12)


@pytest.mark.parametrize("count", [2, 3, 4, 5, 9])
def test_spline_is_the_not_a_knot_spline_through_its_points(count):
    points = np.random.default_rng(0).normal(size=(count, 2))
    expected = CubicSpline(np.arange(count), points, bc_type="not-a-knot")(
        np.linspace(0, count - 1, 101)
    )
    assert np.allclose(sampled(Path("spline", points), 101), expected, atol=1e-12)
    assert np.array_equal(sampled(Path("spline", points), 10 * (count - 1) + 1)[::10], points)


def test_ferguson_curve_is_the_hermite_spline_of_its_points_and_tangents():
    points = np.random.default_rng(0).normal(size=(8, 2))
    expected = CubicHermiteSpline(np.arange(4), points[::2], points[1::2])(np.linspace(0, 3, 101))
    assert np.allclose(sampled(Path("ferguson", points), 101), expected, atol=1e-12)


@given(paths())
def test_ends_are_exact(path):
    assert np.array_equal(sampled(path)[[0, -1]], path.points[list(curves.ends(path.curve))])


@given(paths())
def test_length_lies_between_straight_line_and_control_polygons(path):
    pieces = curves.bezier_pieces(path)
    polygons = np.hypot(*np.moveaxis(np.diff(pieces, axis=1), 2, 0)).sum()
    length = curves.length(path)
    assert math.dist(pieces[0, 0], pieces[-1, -1]) <= length * (1 + 1e-9) + 1e-9
    assert length <= polygons * (1 + 1e-9) + 1e-9
    if path.curve in curves.B_SPLINES:
        assert polygons <= np.hypot(*np.diff(path.points, axis=0).T).sum() * (1 + 1e-9) + 1e-9


def transformed(path, turn, shift, backwards):
    """A path turned, moved, and perhaps passed from its end; tangents are turned, and reversed,
    only.
    """
    points = path.points @ turn
    if path.curve != "ferguson":
        return Path(path.curve, (points[::-1] if backwards else points) + shift)
    pairs = points.reshape(-1, 2, 2) * ([[1], [-1]] if backwards else 1) + [shift, (0, 0)]
    return Path(path.curve, (pairs[::-1] if backwards else pairs).reshape(-1, 2))


@given(paths(), st.floats(0, 2 * math.pi), st.tuples(coordinates, coordinates), st.booleans())
def test_length_does_not_change_when_a_path_is_moved_or_reversed(path, angle, shift, backwards):
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    other = transformed(path, turn, shift, backwards)
    assert curves.length(other) == pytest.approx(curves.length(path), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ([(0, 0), (1, 2), (2, 0)], 2.957885715089),
        ([(0, 0), (1, 1), (0, 1), (1, 0)], 2 * math.sqrt(2) - 1),
        ([(0, 0), (1, 1), (0.001, 1), (1, 0)], 1.828299336702),
        ([(0, 0), (3, 0), (1, 0)], 2.6),
        ([(0, 0)] * 3 + [(1, 2)] * 3, math.sqrt(5)),
        ([(1, 1)] * 4, 0),
    ],
    ids=["parabola", "cusp", "near cusp", "there and back", "repeated ends", "a point"],
)
def test_arc_length_is_exact(points, expected):
    assert curves.length(Path("bezier", np.array(points, dtype=float))) == pytest.approx(
        expected, abs=1e-10
    )


def test_arc_length_agrees_with_quadrature_in_high_degree():
    points = np.random.default_rng(4).normal(size=(13, 2))
    differences = 12 * np.diff(points, axis=0)
    speed = lambda t: np.hypot(*(curves.bernstein(11, np.array([t])) @ differences)[0])  # noqa: E731
    expected = sum(
        quad(speed, a, a + 0.05, epsabs=1e-13, epsrel=1e-13)[0] for a in np.arange(20) / 20
    )
    assert curves.length(Path("bezier", points)) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("side", [1, -1])
def test_curvature_is_positive_where_a_curve_turns_left(side):
    """The parabola y = x^2 from left to right turns left, with the curvature 2 / (1 + 4 x^2)^1.5;
    its mirror image turns right.
    """
    kappa, speed = curves.curvature(
        Path("bezier", np.array([[-1, 1], [0, -1], [1, 1]]) * [1, side]), 101
    )
    x = np.linspace(-1, 1, 101)
    assert kappa == pytest.approx(side * 2 / (1 + 4 * x**2) ** 1.5)
    assert speed == pytest.approx(2 * np.sqrt(1 + 4 * x**2))


def test_curvature_is_left_out_where_the_curve_stands_still():
    kappa, speed = curves.curvature(
        Path("bezier", np.array([[0, 0], [0, 0], [0, 0], [1, 2.0]])), 101
    )
    assert np.isnan(kappa[0])
    assert speed[0] == 0


@pytest.mark.parametrize(
    ("curve", "continuous"),
    [
        ("bezier", True),
        ("piecewise_cubic", True),
        ("spline", True),
        ("piecewise_quadratic", False),
        ("ferguson", False),
    ],
)
def test_only_cubic_splines_and_a_single_bezier_have_continuous_curvature(curve, continuous):
    points = np.random.default_rng(1).normal(size=(8, 2))
    assert (curves.curvature_jump(Path(curve, points)) < 1e-6) == continuous


def test_curvature_jumps_by_the_difference_where_an_s_changes_sides():
    """Two quadratic pieces, point-symmetric about their joint: the curvature before it is -3 / (4
    sqrt 2), behind it the opposite.
    """
    points = np.array([[-3, 0], [-1, 1], [1, -1], [3, 0.0]])
    assert curves.curvature_jump(Path("piecewise_quadratic", points)) == pytest.approx(
        3 / (2 * math.sqrt(2))
    )


def test_curvature_jumps_without_limit_at_the_corner_of_a_polyline():
    assert curves.curvature_jump(Path("polyline", np.array([[0, 0], [1, 0], [1, 1.0]]))) == math.inf


@pytest.mark.parametrize("curve", curves.CURVES)
def test_too_few_control_points_are_refused(curve):
    with pytest.raises(ValueError, match="at least"):
        curves.piece_matrix(curve, curves.least_points(curve) - 1)


def test_a_cubic_chain_is_its_pieces():
    points = np.random.default_rng(0).normal(size=(7, 2))
    path = Path("cubic_chain", points)
    assert np.array_equal(curves.bezier_pieces(path), np.stack([points[:4], points[3:]]))
    assert np.array_equal(
        curves.piece_matrix("cubic_chain", 7) @ points, curves.bezier_pieces(path)
    )


@pytest.mark.parametrize("count", [5, 6])
def test_a_cubic_chain_needs_3_k_and_1_control_points(count):
    with pytest.raises(ValueError, match="a multiple of 3 more"):
        curves.piece_matrix("cubic_chain", count)


def test_a_ferguson_curve_needs_pairs_of_a_point_and_a_tangent():
    with pytest.raises(ValueError, match="a multiple of 2 more"):
        curves.piece_matrix("ferguson", 5)
