"""Every curve kind as one linear map from control points to Bézier pieces; samples, exact length,
curvature.

Four kinds are clamped uniform B-splines of n control points and differ only in degree: `polyline`
(1), `piecewise_quadratic` (2), `piecewise_cubic` (3), and `bezier` (n - 1, which has one piece). A
piece of a B-spline is a Bézier curve whose control points are values of the spline's blossom (its
polar form).

Two kinds pass through their points. `spline` is the cubic spline through all of them at uniform
parameters, with not-a-knot ends. `ferguson` is a chain of cubic Hermite pieces (tharwat2018's
reference 33); its control points are pairs of a point and its tangent, the derivative with respect
to the piece's own parameter: P0, T0, V, TV, ..., P1, T1.

A `cubic_chain` is any chain of cubic Bézier pieces, each beginning where the previous one ends: 3 k
+ 1 control points for k pieces.
"""

import math
from functools import cache

import numpy as np

from bezierplan.workspaces import polygons
from bezierplan.workspaces.problem import Path

_DEGREE = {"polyline": 1, "piecewise_quadratic": 2, "piecewise_cubic": 3, "bezier": None}
B_SPLINES = tuple(_DEGREE)
CURVES = (*B_SPLINES, "spline", "ferguson", "cubic_chain")

# Curves whose control points are those of their pieces, which have this degree; ways that were
# driven have hundreds.
_CHAINS = {"polyline": 1, "cubic_chain": 3}

# Below this share of the curve's highest speed a point counts as standing still, as happens with
# repeated control points; curvature is undefined there.
STANDSTILL = 1e-3


def least_points(curve: str) -> int:
    """Return the least number of control points of a curve kind, including start and target.

    >>> least_points("piecewise_cubic"), least_points("ferguson")
    (4, 4)
    """
    if curve in ("ferguson", "cubic_chain"):
        return 4
    return max(2, (_DEGREE.get(curve) or 1) + 1)


def ends(curve: str) -> list[int]:
    """Return which control points are start and target; the last of `ferguson` is a tangent."""
    return [0, -2 if curve == "ferguson" else -1]


def _blossom(knots: np.ndarray, span: int, arguments: np.ndarray) -> np.ndarray:
    """Return the weights (degree + 1,) of the control points span - degree .. span in a spline's
    blossom at `degree` arguments.
    """
    degree = len(arguments)
    rows = np.eye(degree + 1)
    for level, u in enumerate(arguments, start=1):
        for j in range(degree, level - 1, -1):
            low = knots[span - degree + j]
            high = knots[span + 1 + j - level]
            share = (u - low) / (high - low)
            rows[j] = (1 - share) * rows[j - 1] + share * rows[j]
    return rows[degree]


@cache
def piece_matrix(curve: str, points: int) -> np.ndarray:
    """Return the linear map from control points to Bézier pieces: (pieces, degree + 1, points).
    Read-only.

    Raises ValueError for an unknown kind, for too few control points, for an odd number of control
    points of a `ferguson` curve, and for a number other than 3 k + 1 of a `cubic_chain`.
    """
    if curve not in CURVES:
        raise ValueError(f"unknown curve {curve!r}; known: {', '.join(CURVES)}")
    step = {"ferguson": 2, "cubic_chain": 3}.get(curve, 1)
    least = least_points(curve)
    if points < least or (points - least) % step:
        more = f", or by a multiple of {step} more" if step > 1 else ""
        raise ValueError(
            f"a curve of kind {curve} needs at least {least} control points{more}, not {points}"
        )
    own = np.eye(points)
    if curve == "ferguson":
        matrix = _hermite_pieces(own[::2], own[1::2])
    elif curve in _CHAINS:
        matrix = own[_index_chain(points, _CHAINS[curve])]
    elif curve == "spline":
        matrix = _spline_pieces(points)
    else:
        matrix = _b_spline_pieces(_DEGREE[curve] or points - 1, points)
    matrix.setflags(write=False)
    return matrix


def _b_spline_pieces(degree: int, points: int) -> np.ndarray:
    """Return the pieces (pieces, degree + 1, points) of a clamped uniform B-spline."""
    pieces = points - degree
    if pieces == 1:
        # The blossoms give this too, but for 60 points in half a second.
        return np.eye(points)[None]
    knots = np.concatenate(
        [np.zeros(degree), np.arange(pieces + 1.0), np.full(degree, float(pieces))]
    )
    matrix = np.zeros((pieces, degree + 1, points))
    for piece in range(pieces):
        for k in range(degree + 1):
            arguments = np.array([piece] * (degree - k) + [piece + 1.0] * k)
            matrix[piece, k, piece : piece + degree + 1] = _blossom(
                knots, piece + degree, arguments
            )
    return matrix


def _spline_pieces(points: int) -> np.ndarray:
    """Return the pieces (points - 1, 4, points) of the cubic spline through all points."""
    # This part of scipy takes long to import, and one kind of curve alone needs it.
    from scipy.interpolate import CubicSpline

    # With two or three points these are the line or the parabola through them.
    at = np.arange(float(points))
    slopes = CubicSpline(at, np.eye(points), bc_type="not-a-knot")(at, nu=1)
    return _hermite_pieces(np.eye(points), slopes)


def _index_chain(points: int, degree: int) -> np.ndarray:
    """Return the indices of the control points of each piece of a chain: (pieces, degree + 1)."""
    return np.arange(0, points - 1, degree)[:, None] + np.arange(degree + 1)


def _hermite_pieces(values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Return cubic pieces between consecutive values (n, points) with the slopes (n, points) there.

    Slopes are with respect to the parameter of a piece.
    """
    return np.stack(
        [values[:-1], values[:-1] + slopes[:-1] / 3, values[1:] - slopes[1:] / 3, values[1:]],
        axis=1,
    )


def bezier_pieces(path: Path) -> np.ndarray:
    """Return the path as Bézier pieces (pieces, degree + 1, 2), in its unit, each piece beginning
    where the previous one ends.

    A quadratic B-spline has a joint in the middle of each inner leg of its control polygon:

    >>> points = np.array([[0.0, 0.0], [1.0, 2.0], [3.0, 2.0], [4.0, 0.0]])
    >>> bezier_pieces(Path("piecewise_quadratic", points)).tolist()
    [[[0.0, 0.0], [1.0, 2.0], [2.0, 2.0]], [[2.0, 2.0], [3.0, 2.0], [4.0, 0.0]]]
    """
    points = np.asarray(path.points, dtype=float)
    # Indices avoid a matrix that grows with the square of the number of pieces.
    if path.curve in _CHAINS and len(points) > 1:
        return points[_index_chain(len(points), _CHAINS[path.curve])]
    return piece_matrix(path.curve, len(points)) @ points


def bernstein(degree: int, t: np.ndarray) -> np.ndarray:
    """Return the Bernstein polynomials (len(t), degree + 1) at parameters t in [0, 1] (song2016,
    eq. 2; tharwat2018, eq. 2).
    """
    k = np.arange(degree + 1)
    binomial = np.array([math.comb(degree, i) for i in k], float)
    return binomial * t[:, None] ** k * (1 - t[:, None]) ** (degree - k)


def sample_parameters(pieces: int, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the piece (samples,) and the parameter within it (samples,) of samples that are
    uniform over a whole curve, both ends included.

    Joints are hit exactly: the parameters are quotients of integers.
    """
    steps = np.arange(samples) * pieces
    piece = np.minimum(steps // (samples - 1), pieces - 1)
    return piece, (steps - piece * (samples - 1)) / (samples - 1)


def evaluate_pieces(pieces: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the points (n, 2) of pieces (n, degree + 1, 2) at one parameter each (n,)."""
    return np.einsum("sk,skd->sd", bernstein(pieces.shape[1] - 1, t), pieces)


def differentiate_pieces(pieces: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the derivatives (n, 2) of pieces (n, degree + 1, 2) at one parameter each (n,)."""
    return (pieces.shape[1] - 1) * evaluate_pieces(np.diff(pieces, axis=1), t)


@cache
def sample_matrix(curve: str, points: int, samples: int) -> np.ndarray:
    """Return the linear map from control points to samples, uniform in the parameter over the whole
    curve: (samples, points). Read-only.
    """
    matrix = piece_matrix(curve, points)
    piece, t = sample_parameters(len(matrix), samples)
    basis = evaluate_pieces(matrix[piece], t)
    basis.setflags(write=False)
    return basis


def point_at(path: Path, at: float) -> np.ndarray:
    """Return the point (2,) of a path, in its unit, at a piece's number plus the parameter in
    it.
    """
    pieces = bezier_pieces(path)
    piece = min(int(at), len(pieces) - 1)
    return bernstein(pieces.shape[1] - 1, np.array([at - piece]))[0] @ pieces[piece]


def length(path: Path) -> float:
    """Return the exact arc length of a path in its unit (relative error below 1e-10).

    >>> length(Path("polyline", np.array([[0.0, 0.0], [3.0, 4.0]])))
    5.0

    A parabola, whose length has a closed form:

    >>> arc = length(Path("bezier", np.array([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]])))
    >>> math.isclose(arc, math.sqrt(5) + math.asinh(2) / 2)
    True
    """
    return length_of(bezier_pieces(path))


def length_of(pieces: np.ndarray) -> float:
    """Return the `length` of a path from its Bézier pieces (pieces, degree + 1, 2)."""

    from bezierplan.geometry.arc_length import measure_piece

    return math.fsum(map(measure_piece, pieces))


def curvature(path: Path, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the curvature along a path (song2016, eq. 5): values (samples,) in 1/unit, and the
    speeds (samples,) at the same parameters.

    The value is nan where the curve stands still (`STANDSTILL`). song2016's eq. 4 prints a dot over
    the control points in the second derivative; the formula needs the points themselves.
    """
    pieces = bezier_pieces(path)
    piece, t = sample_parameters(len(pieces), samples)
    return curvatures(pieces[piece], t)


def curvatures(pieces: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return curvature (n,) and speed (n,) of pieces (n, degree + 1, 2) at one parameter each."""
    degree = pieces.shape[1] - 1
    first = differentiate_pieces(pieces, t)
    # Of straight pieces there are no second differences, and their sum is 0.
    second = degree * (degree - 1) * evaluate_pieces(np.diff(pieces, n=2, axis=1), t)
    speed = np.hypot(*first.T)
    moving = speed > STANDSTILL * speed.max()
    kappa = np.full(len(t), np.nan)
    cross = polygons.cross(first, second)
    kappa[moving] = cross[moving] / speed[moving] ** 3
    return kappa, speed


def curvature_jump(path: Path) -> float:
    """Return the largest jump in curvature across the joints of a path, in 1/unit, from the end
    values of the pieces.

    Joints where either side stands still are left out; 0 if there are no joints, infinite where the
    tangent turns.
    """
    pieces = bezier_pieces(path)
    (start, start_speed), (end, end_speed) = (
        curvatures(pieces, np.full(len(pieces), t)) for t in (0.0, 1.0)
    )
    fastest = max(start_speed.max(), end_speed.max())
    moving = (start_speed[1:] > STANDSTILL * fastest) & (end_speed[:-1] > STANDSTILL * fastest)
    leaving = pieces[1:, 1] - pieces[1:, 0]
    arriving = pieces[:-1, -1] - pieces[:-1, -2]
    cross = polygons.cross(leaving, arriving)
    along = (leaving * arriving).sum(axis=1)
    # Joints of smooth curves turn by rounding errors only.
    turns = moving & ((along <= 0) | (np.abs(cross) > 1e-9 * np.abs(along)))
    if turns.any():
        return math.inf
    jumps = np.abs(start[1:] - end[:-1])[moving]
    return float(np.nan_to_num(jumps).max(initial=0.0))
