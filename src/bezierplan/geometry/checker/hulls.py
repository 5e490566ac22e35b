"""Hulls of the control points of Bézier pieces: halving, extent and direction; and the limits
within which they are sufficiently exact.
"""

import math

import numpy as np

from bezierplan.kernels import allocation_free

# Depth in units above which a point is certainly blocked.
TOLERANCE = 1e-9

# Smaller differences between coordinates are rounding errors; beyond coordinates of about a
# thousand, so are smaller ones than some units in the last place.
ROUNDING = 1e-12
_LAST_PLACES = 4 * np.finfo(float).eps

# With larger coordinates, the rounding errors of halved control points would approach the
# tolerance.
LARGEST_COORDINATE = 1e5

LARGEST_DEGREE = 60

# Binomial coefficients of squares of such polynomials, too.
_ORDERS = range(2 * LARGEST_DEGREE + 1)
BINOMIAL = np.array([[math.comb(n, k) for k in _ORDERS] for n in _ORDERS], float)

# From the largest coordinate, halving reaches the tolerance in about fifty levels; each level needs
# one stack entry.
STACK = 64

# A chord this much shorter than its hull does not indicate the hull's direction.
_SHORT_CHORD = 1e-3


@allocation_free
def copy_points(points: np.ndarray, place: np.ndarray) -> None:
    """Copy control points one by one. Array assignment does it too, but compiles for seconds."""
    for i in range(len(points)):
        place[i, 0] = points[i, 0]
        place[i, 1] = points[i, 1]


@allocation_free
def halve(points: np.ndarray, left: np.ndarray) -> None:
    """Replace a piece by its right half and write its left half (de Casteljau's construction)."""
    n = len(points) - 1
    for level in range(n + 1):
        left[level, 0] = points[0, 0]
        left[level, 1] = points[0, 1]
        for i in range(n - level):
            points[i, 0] = 0.5 * (points[i, 0] + points[i + 1, 0])
            points[i, 1] = 0.5 * (points[i, 1] + points[i + 1, 1])


@allocation_free
def measure_distance(point: np.ndarray, other: np.ndarray) -> float:
    """Return the distance of two points (2,)."""
    return math.hypot(other[0] - point[0], other[1] - point[1])


@allocation_free
def compute_doubled_area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Return twice the signed area of a triangle, positive if it is counterclockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@allocation_free
def measure_size(points: np.ndarray) -> float:
    """Return the largest distance of a control point from the first one."""
    largest = 0.0
    for i in range(1, len(points)):
        largest = max(largest, measure_distance(points[0], points[i]))
    return largest


@allocation_free
def choose_resolution(points: np.ndarray) -> float:
    """Return the size in units below which halving no longer separates control points: `ROUNDING`,
    or more for large coordinates.
    """
    largest = 0.0
    for i in range(len(points)):
        largest = max(largest, abs(points[i, 0]), abs(points[i, 1]))
    return max(ROUNDING, _LAST_PLACES * largest)


@allocation_free
def choose_direction(points: np.ndarray) -> tuple[float, float]:
    """Return a unit vector along a hull: the direction of its chord or, where the chord is short,
    towards the point farthest from the first one.
    """
    farthest = len(points) - 1
    longest = measure_size(points)
    if measure_distance(points[0], points[-1]) < _SHORT_CHORD * longest:
        for i in range(1, len(points)):
            if measure_distance(points[0], points[i]) == longest:
                farthest = i
    x = points[farthest, 0] - points[0, 0]
    y = points[farthest, 1] - points[0, 1]
    length = math.hypot(x, y)
    if length == 0.0:
        return 1.0, 0.0
    return x / length, y / length


@allocation_free
def measure_range_along(points: np.ndarray, x: float, y: float) -> tuple[float, float]:
    """Return the range of control points' components along (x, y), relative to the first one."""
    low = high = 0.0
    for i in range(1, len(points)):
        component = (points[i, 0] - points[0, 0]) * x + (points[i, 1] - points[0, 1]) * y
        low = min(low, component)
        high = max(high, component)
    return low, high


@allocation_free
def bound_box(points: np.ndarray) -> tuple[float, float, float, float]:
    """Return the lowest and highest x, lowest and highest y of the control points."""
    left = right = points[0, 0]
    bottom = top = points[0, 1]
    for i in range(1, len(points)):
        left = min(left, points[i, 0])
        right = max(right, points[i, 0])
        bottom = min(bottom, points[i, 1])
        top = max(top, points[i, 1])
    return left, right, bottom, top


@allocation_free
def measure_distance_to_segment(
    x: float, y: float, ax: float, ay: float, bx: float, by: float
) -> float:
    """Return the distance of the point (x, y) from the segment from (ax, ay) to (bx, by)."""
    dx = bx - ax
    dy = by - ay
    square = dx * dx + dy * dy
    share = 0.0
    if square > 0.0:
        share = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / square))
    dx = x - ax - share * dx
    dy = y - ay - share * dy
    return math.sqrt(dx * dx + dy * dy)


@allocation_free
def measure_bulge(points: np.ndarray) -> float:
    """Return the largest distance of a control point from the chord."""
    largest = 0.0
    for i in range(1, len(points) - 1):
        distance = measure_distance_to_segment(
            points[i, 0], points[i, 1], points[0, 0], points[0, 1], points[-1, 0], points[-1, 1]
        )
        largest = max(largest, distance)
    return largest
