"""The length of a particle's curve, and the penalty for the circles and polygons it meets;
a particle holds the free control points.

tharwat2018 has circles only. Its measure, depth as a share of the circle's radius, is read as depth
below the obstacle's edge as a share of the largest such depth, which for a circle is the same; so
it applies to a polygon too, whose largest depth is the radius of its largest inscribed circle. The
border is no obstacle: the swarm's own bounds keep the control points inside.
"""

from enum import IntEnum
from functools import cache
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import curves
from bezierplan.kernels import allocation_free
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.polygons import Polygons, list_rings_of_polygon, list_sides
from bezierplan.workspaces.problem import Workspace

Penalty = IntEnum("Penalty", "multiply add death")

# A path is feasible if its violation does not exceed this: a converging swarm ends tangent to a
# circle, a rounding error deep.
FEASIBLE = 1e-9


class Polygonal(NamedTuple):
    """Polygonal obstacles, for the kernels, in units.

    edges: (edges, 4), x and y of both ends of the edges of all polygons and their holes, polygon by
        polygon.
    first: (obstacles + 1,), where each polygon's edges begin.
    boxes: (obstacles, 4), left, right, bottom and top.
    deepest: (obstacles,), the largest depth in it.
    """

    edges: np.ndarray
    first: np.ndarray
    boxes: np.ndarray
    deepest: np.ndarray


class Objective(NamedTuple):
    """The fitness of a path, for the kernels.

    ends: (2, samples), the contributions of start and target to the samples, by coordinate.
    free: (n, samples), the weights of the free control points.
    balls: (obstacles, 3), centre and radius of circles, in units.
    polygons: the other obstacles, in the plane.
    penalty: the rule's number.
    beta: its factor.
    """

    ends: np.ndarray
    free: np.ndarray
    balls: np.ndarray
    polygons: Polygonal
    penalty: int
    beta: float


@cache
def compute_basis(curve: str, control_points: int, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the weights of start and target (2, samples) and of the free control points (n,
    samples) at the samples of a curve.
    """
    weights = curves.sample_matrix(curve, control_points + 2, samples).T
    # A copy, since numba would compile all kernels once more for an array that is read-only.
    return weights[curves.ends(curve)], weights[find_free_points(curve, control_points)].copy()


@cache
def find_free_points(curve: str, control_points: int) -> np.ndarray:
    """Return which control points of a curve are free (n,)."""
    return np.delete(np.arange(control_points + 2), curves.ends(curve))


@allocation_free
def compute_fitness(length: float, violation: float, objective: Objective) -> float:
    """Combine the length of a path with the penalty for its violation (tharwat2018, eq. 22, which
    leaves the penalty open).
    """
    if objective.penalty == Penalty.multiply:
        return length * (1.0 + objective.beta * violation)
    if objective.penalty == Penalty.add:
        return length + objective.beta * violation
    return objective.beta if violation > FEASIBLE else length


@allocation_free
def write_curve(particle: np.ndarray, objective: Objective, curve: np.ndarray) -> None:
    """Write the samples (2, samples) of the curve of a particle (2 n,).

    objective: of its fields only `ends` and `free` are needed.
    """
    n, samples = objective.free.shape
    x, y = curve[0], curve[1]
    for s in range(samples):
        x[s], y[s] = objective.ends[0, s], objective.ends[1, s]
    # Three control points at a time, so that samples are read and written fewer times.
    for k in range(n % 3):
        a, ax, ay = objective.free[k], particle[k], particle[n + k]
        for s in range(samples):
            x[s] += ax * a[s]
            y[s] += ay * a[s]
    for k in range(n % 3, n, 3):
        a, b, c = objective.free[k], objective.free[k + 1], objective.free[k + 2]
        ax, bx, cx = particle[k], particle[k + 1], particle[k + 2]
        ay, by, cy = particle[n + k], particle[n + k + 1], particle[n + k + 2]
        for s in range(samples):
            x[s] = x[s] + ax * a[s] + bx * b[s] + cx * c[s]
            y[s] = y[s] + ay * a[s] + by * b[s] + cy * c[s]


@allocation_free
def bound_length(curve: np.ndarray) -> float:
    """Return no more than the length of a curve (2, samples): the length of four chords."""
    last = curve.shape[1] - 1
    # A polyline through some of the samples is no longer than that through all of them.
    total = 0.0
    for k in range(4):
        begin, end = k * last // 4, (k + 1) * last // 4
        total += np.sqrt(
            (curve[0, end] - curve[0, begin]) ** 2 + (curve[1, end] - curve[1, begin]) ** 2
        )
    return total * (1.0 - 1e-9)  # for rounding errors


@allocation_free
def measure_length(curve: np.ndarray, chords: np.ndarray) -> float:
    """Return the length of the polyline through the samples of a curve (2, samples) (tharwat2018,
    eq. 19).

    chords: (samples,) scratch.
    """
    samples = curve.shape[1]
    x, y = curve[0], curve[1]
    # The square roots are vectorised if their sum is separate; its four partial sums need not wait
    # for each other.
    for s in range(samples - 1):
        chords[s] = np.sqrt((x[s + 1] - x[s]) ** 2 + (y[s + 1] - y[s]) ** 2)
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    fours = (samples - 1) // 4 * 4
    for s in range(0, fours, 4):
        a += chords[s]
        b += chords[s + 1]
        c += chords[s + 2]
        d += chords[s + 3]
    for s in range(fours, samples - 1):
        a += chords[s]
    return (a + b) + (c + d)


def round_obstacles(workspace: Workspace, d_min: float) -> np.ndarray:
    """Return the circles of a workspace, grown by a distance in units: (obstacles, 3), centre and
    radius.

    There are none elsewhere.
    """
    if not isinstance(workspace, Circles):
        return np.empty((0, 3))
    return np.column_stack([workspace.centres, workspace.radii + d_min])


def grow_polygons(workspace: Workspace, d_min: float) -> Polygonal:
    """Return the polygons of a workspace, grown by a distance in units; none elsewhere."""
    if not isinstance(workspace, Polygons) or not workspace.obstacles:
        return Polygonal(np.empty((0, 4)), np.zeros(1, np.int64), np.empty((0, 4)), np.empty(0))
    import shapely

    shapes = [shapely.Polygon(outer, holes).buffer(d_min) for outer, *holes in workspace.obstacles]
    edges = [np.concatenate([*map(list_sides, list_rings_of_polygon(shape))]) for shape in shapes]
    return Polygonal(
        edges=np.concatenate(edges),
        first=np.concatenate([[0], np.cumsum([len(each) for each in edges])]),
        # In rows, or the kernels are compiled twice.
        boxes=np.array([shape.bounds for shape in shapes]).take([0, 2, 1, 3], axis=1),
        # GEOS gives that circle as the line from its centre to the nearest point of the edge.
        deepest=np.array([shapely.maximum_inscribed_circle(shape).length for shape in shapes]),
    )


@allocation_free
def measure_violation(
    curve: np.ndarray, objective: Objective, scratch: np.ndarray
) -> tuple[float, int]:
    """Return the violation of a path, and its number of samples in obstacles, both summed over the
    obstacles.

    The violation of an obstacle is the mean over the samples of their depth below its edge, as a
    share of the largest depth (tharwat2018, eqs. 20 and 21).

    curve: (2, samples).
    scratch: (samples,) or longer.
    """
    of_balls, in_balls = _measure_among_balls(curve, objective.balls, scratch)
    of_polygons, in_polygons = _measure_among_polygons(curve[0], curve[1], objective.polygons)
    return of_balls + of_polygons, in_balls + in_polygons


@allocation_free
def _measure_among_polygons(x, y, polygons):
    """Return a path's violation among polygons, and its number of samples in them, both summed."""
    samples = len(x)
    total, colliding = 0.0, 0
    for o in range(len(polygons.deepest)):
        left, right, bottom, top = polygons.boxes[o]
        near = 0  # most polygons lie aside, which vector instructions tell
        for s in range(samples):
            near += (left < x[s]) & (x[s] < right) & (bottom < y[s]) & (y[s] < top)
        if near == 0:
            continue
        edges = polygons.edges[polygons.first[o] : polygons.first[o + 1]]
        depths = 0.0
        for s in range(samples):
            if left < x[s] < right and bottom < y[s] < top:
                depth = _measure_depth(x[s], y[s], edges)
                depths += depth / polygons.deepest[o]
                colliding += depth > 0.0
        total += depths / samples
    return total, colliding


@allocation_free
def _measure_depth(x, y, edges):
    """Return the distance of a point to the nearest edge (n, 4) of a polygon, 0 outside of it."""
    inside = False
    for e in range(len(edges)):
        x1, y1, x2, y2 = edges[e]
        # A ray to the right crosses an odd number of edges if it starts inside.
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) / (y2 - y1) * (x2 - x1):
            inside = not inside
    if not inside:
        return 0.0
    nearest = np.inf
    for e in range(len(edges)):
        x1, y1, x2, y2 = edges[e]
        dx, dy = x2 - x1, y2 - y1
        along = min(max(((x - x1) * dx + (y - y1) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
        nearest = min(nearest, (x1 + along * dx - x) ** 2 + (y1 + along * dy - y) ** 2)
    return np.sqrt(nearest)


@allocation_free
def _measure_among_balls(curve, balls, squares):
    """Return a path's violation among circles (obstacles, 3), and its number of samples in them,
    both summed.
    """
    samples = curve.shape[1]
    x, y = curve[0], curve[1]
    total, colliding = 0.0, 0
    for o in range(len(balls)):
        x_centre, y_centre, radius = balls[o, 0], balls[o, 1], balls[o, 2]
        square = radius * radius
        for s in range(samples):
            dx, dy = x[s] - x_centre, y[s] - y_centre
            squares[s] = dx * dx + dy * dy
        inside = 0
        for s in range(samples):
            inside += squares[s] < square
        if inside:
            depth = 0.0
            for s in range(samples):
                # Few samples are inside, so their square roots are taken one by one.
                if squares[s] < square:
                    # A square below the radius's own can have a root that rounds to more than the
                    # radius.
                    depth += max(1.0 - np.sqrt(squares[s]) / radius, 0.0)
            total += depth / samples
            colliding += inside
    return total, colliding
