"""Which tangents and arcs a shortest path around circles can be made of: a search that draws
tangents only from circles that it reaches, and only to circles that can be seen from there.

A graph of all pairs of circles would grow with their square, though from most circles few others
are in sight. Here the algorithm A* goes from side to side: a side is a circle and a sense in which
a path turns around it. From a side rays leave along its tangents, one in each direction; circles
are looked at ring by ring of bins around it, and each hides a range of directions from all that lie
behind it, until every direction is hidden.

Angles on a side are counted in its sense: counterclockwise on side 2 k, clockwise on side 2 k + 1
of circle k, so that a path always moves on to larger ones. Circles 0 and 1 are start and target,
with radius 0.
"""

import heapq
import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.bins import Bins, columns_between, rows_between, rows_near
from bezierplan.geometry.checker import TOLERANCE
from bezierplan.geometry.shortest_paths.graph import NO_LENGTH
from bezierplan.kernels import allocation_free, compiled

# Arcs that overlap by less than this angle count as touching.
SAME_ANGLE = 1e-8

# A path may go back by this angle: where tangents touch three circles, rounding decides which point
# comes first.
_BACK = 1e-7

# Directions around a circle are told apart by so many sectors.
_SECTORS = 512

# Distance of a bin's corners from its middle, as a share of its side; a little more.
_HALF_DIAGONAL = 0.708

# A ray that would touch a circle of this share of the radius enters the circle by far more than the
# tolerance.
_WELL_INSIDE = 0.99

# A tangent that is longer than the way to the border by this factor leaves it by more than the
# tolerance.
_JUST_BEYOND = 1.000001

# Ways that are longer than the shortest by at most this share are kept: rounding may decide.
_TIED = 1e-9


class Scene(NamedTuple):
    """What is in the way. centres: (n, 2), radii: (n,), of the ends and the circles. bounds: (4,)
    of the border. bins: of all of them.
    """

    centres: np.ndarray
    radii: np.ndarray
    bounds: np.ndarray
    bins: Bins


class _Sights(NamedTuple):
    """Lists of the tangents that leave the sides looked from, those of each side together and by
    angle.

    leaves, leave: the side that a tangent leaves, and at which angle. to, arrive: the side that it
    reaches, and where. length: its own. so_far: that of the shortest way known to where it leaves.
    """

    leaves: list[int]
    leave: list[float]
    to: list[int]
    arrive: list[float]
    length: list[float]
    so_far: list[float]


class _Arrivals(NamedTuple):
    """Lists of what has been reached, the start first.

    side, angle: where. length: of the way. by: the tangent by which it came, before: what was
    reached before on the same side, each -1 without one.
    """

    side: list[int]
    angle: list[float]
    length: list[float]
    by: list[int]
    before: list[int]


class _Scratch(NamedTuple):
    """Room for a look. looks: (n,) the side from which a circle was last looked at. horizon:
    (_SECTORS,) the distance from which on nothing can be seen in a sector. tangents: (2 n, 4)
    tangents as leave, to, arrive, length. segment: (2, 2). queue: (bins,) bins to look into.
    queue_side: (bins,) the side from which a bin was last in the queue.
    """

    looks: np.ndarray
    horizon: np.ndarray
    tangents: np.ndarray
    segment: np.ndarray
    queue: np.ndarray
    queue_side: np.ndarray


@compiled
def search(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """What the shortest paths are made of, and those that are longer by a share of at most `_TIED`:
    tangents (t, 4), each by the circle that it leaves, the sense there (1 counterclockwise, -1
    clockwise), the circle that it reaches and the sense there; and arcs (a, 3), each by its circle,
    the angle at which it begins, and that by which it goes on counterclockwise. None if there is no
    path.
    """
    sides = 2 * len(scene.radii)
    sights = _Sights([0], [0.0], [0], [0.0], [0.0], [0.0])
    sights.leaves.clear()
    sights.leave.clear()
    sights.to.clear()
    sights.arrive.clear()
    sights.length.clear()
    sights.so_far.clear()
    first, last = np.full(sides, -1), np.full(sides, -1)
    scratch = _Scratch(
        np.full(len(scene.radii), -1),
        np.empty(_SECTORS),
        np.empty((sides, 4)),
        np.empty((2, 2)),
        np.empty(scene.bins.columns * scene.bins.rows, dtype=np.int64),
        np.full(scene.bins.columns * scene.bins.rows, -1),
    )
    arrivals = _Arrivals([0], [0.0], [0.0], [-1], [-1])
    latest = np.full(sides, -1)
    latest[0] = 0
    heap = [(_ahead(0, 0.0, scene), 0)]
    shortest, longest = np.inf, np.inf
    while len(heap) > 0:
        estimate, k = heapq.heappop(heap)
        if estimate > longest:
            break
        side = arrivals.side[k]
        if side == 2:
            if shortest == np.inf:
                shortest = arrivals.length[k]
                longest = shortest * (1.0 + _TIED)
            continue
        tangent = arrivals.by[k]
        if tangent >= 0 and arrivals.length[k] > sights.so_far[tangent] + sights.length[tangent]:
            continue
        if first[side] < 0:
            first[side] = len(sights.leave)
            _look(side, scene, scratch, sights)
            last[side] = len(sights.leave)
        radius = scene.radii[side // 2]
        end = _free_sweep(side, arrivals.angle[k], scene)
        count = last[side] - first[side]
        begin = _first_beyond(sights.leave, first[side], last[side], arrivals.angle[k])
        for step in range(count):
            tangent = begin + step if begin + step < last[side] else begin + step - count
            sweep = _sweep(arrivals.angle[k], sights.leave[tangent])
            if sweep > end:
                break
            so_far = arrivals.length[k] + radius * abs(sweep)
            if so_far >= sights.so_far[tangent]:
                # Who reached it sooner has gone on as well.
                if sweep > 0.0:
                    break
                continue
            sights.so_far[tangent] = so_far
            there = sights.to[tangent]
            so_far += sights.length[tangent]
            estimate = so_far + _ahead(there, sights.arrive[tangent], scene)
            heapq.heappush(heap, (estimate, len(arrivals.side)))
            arrivals.before.append(latest[there])
            latest[there] = len(arrivals.side)
            arrivals.side.append(there)
            arrivals.angle.append(sights.arrive[tangent])
            arrivals.length.append(so_far)
            arrivals.by.append(tangent)
    return _ways_back(scene, sights, arrivals, latest, longest)


@compiled
def _ways_back(
    scene: Scene,
    sights: _Sights,
    arrivals: _Arrivals,
    latest: np.ndarray,
    longest: float,
) -> tuple[np.ndarray, np.ndarray]:
    """The tangents (t, 4) and arcs (a, 3) of all ways up to a length: back from the target, from
    all that has been reached on each side.
    """
    marks = np.zeros(len(sights.leave), dtype=np.bool_)
    waiting = [0]
    waiting.clear()
    shortest = np.inf
    k = latest[2]
    while k >= 0:
        shortest = min(shortest, arrivals.length[k])
        if arrivals.length[k] <= longest:
            marks[arrivals.by[k]] = True
            waiting.append(arrivals.by[k])
        k = arrivals.before[k]
    slack = longest - shortest
    tangents = np.empty((len(sights.leave), 4), dtype=np.int64)
    arcs = [(0, 0.0, 0.0)]
    arcs.clear()
    count = 0
    while len(waiting) > 0:
        tangent = waiting.pop()
        side = sights.leaves[tangent]
        there = sights.to[tangent]
        tangents[count, 0], tangents[count, 1] = side // 2, _sense(side)
        tangents[count, 2], tangents[count, 3] = there // 2, _sense(there)
        count += 1
        k = latest[side]
        while k >= 0:
            sweep = _sweep(arrivals.angle[k], sights.leave[tangent])
            way = arrivals.length[k] + scene.radii[side // 2] * abs(sweep)
            if way <= sights.so_far[tangent] + slack and sweep <= _free_sweep(
                side, arrivals.angle[k], scene
            ):
                begin = arrivals.angle[k] if _sense(side) > 0 else -sights.leave[tangent]
                arcs.append((side // 2, begin, sweep))
                if arrivals.by[k] >= 0 and not marks[arrivals.by[k]]:
                    marks[arrivals.by[k]] = True
                    waiting.append(arrivals.by[k])
            k = arrivals.before[k]
    spans = np.empty((len(arcs), 3))
    for k in range(len(arcs)):
        spans[k, 0], spans[k, 1], spans[k, 2] = arcs[k]
    return tangents[:count], spans


@allocation_free
def _sense(side: int) -> int:
    """1 for counterclockwise, -1 for clockwise."""
    return 1 - 2 * (side % 2)


@allocation_free
def _sweep(begin: float, end: float) -> float:
    """From one angle on to another, at least `-_BACK`."""
    return (end - begin + _BACK) % math.tau - _BACK


@allocation_free
def _x_at(side: int, angle: float, scene: Scene) -> float:
    return scene.centres[side // 2, 0] + scene.radii[side // 2] * math.cos(angle)


@allocation_free
def _y_at(side: int, angle: float, scene: Scene) -> float:
    return scene.centres[side // 2, 1] + _sense(side) * scene.radii[side // 2] * math.sin(angle)


@allocation_free
def _ahead(side: int, angle: float, scene: Scene) -> float:
    """Straight distance to the target."""
    return math.hypot(
        _x_at(side, angle, scene) - scene.centres[1, 0],
        _y_at(side, angle, scene) - scene.centres[1, 1],
    )


@compiled
def _first_beyond(angles: list[float], low: int, high: int, angle: float) -> int:
    """The first of some ascending angles, those from low to high, that lies behind another one, or
    just before it.
    """
    first, end = low, high
    angle = (angle - _BACK) % math.tau
    while first < end:
        middle = (first + end) // 2
        if angles[middle] < angle:
            first = middle + 1
        else:
            end = middle
    return first


@allocation_free
def _free_sweep(side: int, angle: float, scene: Scene) -> float:
    """How far a path can go on around a side before another circle or the border."""
    circle, sense = side // 2, _sense(side)
    x, y, radius = scene.centres[circle, 0], scene.centres[circle, 1], scene.radii[circle]
    free = math.tau
    if radius == 0.0:
        return free
    left, right, bottom, top = scene.bounds
    for outward, margin in ((0.0, right - x), (0.5, top - y), (1.0, x - left), (1.5, y - bottom)):
        if margin < radius:
            half = math.acos(max(margin / radius, -1.0))
            free = min(free, _before(sense * outward * math.pi - angle, half))
    bins = scene.bins
    begin, end = columns_between(x - radius, x + radius, bins)
    low, high = rows_near(y - radius, y + radius, bins)
    for column in range(begin, end + 1):
        for place in range(column * bins.rows + low, column * bins.rows + high + 1):
            for k in bins.members[bins.first[place] : bins.first[place + 1]]:
                dx, dy = scene.centres[k, 0] - x, scene.centres[k, 1] - y
                distance = math.hypot(dx, dy)
                if k == circle or k < 2 or distance >= radius + scene.radii[k] - TOLERANCE:
                    continue
                half = _half_covered(distance, radius, scene.radii[k])
                free = min(free, _before(sense * math.atan2(dy, dx) - angle, half))
    return free


@allocation_free
def _half_covered(distance: float, radius: float, other: float) -> float:
    """Half of the angle of a circle that lies in another one, whose centre is at a distance."""
    cosine = (distance**2 + radius**2 - other**2) / (2 * distance * radius)
    return math.acos(min(max(cosine, -1.0), 1.0))


@allocation_free
def _before(middle: float, half: float) -> float:
    """The angle from 0 on to an interval of angles."""
    middle = (middle + math.pi) % math.tau - math.pi
    if middle + half <= SAME_ANGLE:
        middle += math.tau
    return max(middle - half, 0.0) + SAME_ANGLE


@compiled
def _look(side: int, scene: Scene, scratch: _Scratch, sights: _Sights) -> None:
    """Add the free tangents from a side to circles and to the target."""
    circle, bins = side // 2, scene.bins
    looks, horizon = scratch.looks, scratch.horizon
    radius = scene.radii[circle]
    _hide_outside(side, scene, horizon)
    looks[circle], looks[0], looks[1] = side, side, side
    count = _look_at(side, 1, scene, scratch, 0)
    # From the bins of the circle on to their neighbours, as long as any ray gets there.
    x, y = scene.centres[circle]
    waiting = 0
    begin, end = columns_between(x - radius, x + radius, bins)
    low, high = rows_near(y - radius, y + radius, bins)
    for column in range(begin, end + 1):
        for row in range(low, high + 1):
            waiting = _wait(column * bins.rows + row, side, scratch, waiting)
    done = 0
    while done < waiting:
        place = scratch.queue[done]
        done += 1
        column, row = place // bins.rows, place % bins.rows
        if _is_hidden(side, column, row, scene, horizon):
            continue
        for k in bins.members[bins.first[place] : bins.first[place + 1]]:
            if looks[k] != side:
                looks[k] = side
                count = _look_at(side, k, scene, scratch, count)
                _hide(side, k, scene, horizon)
        for next_column in range(max(column - 1, 0), min(column + 1, bins.columns - 1) + 1):
            for next_row in range(max(row - 1, 0), min(row + 1, bins.rows - 1) + 1):
                waiting = _wait(next_column * bins.rows + next_row, side, scratch, waiting)
    order = np.argsort(scratch.tangents[:count, 0])
    for k in order:
        sights.leaves.append(side)
        sights.leave.append(scratch.tangents[k, 0])
        sights.to.append(int(scratch.tangents[k, 1]))
        sights.arrive.append(scratch.tangents[k, 2])
        sights.length.append(scratch.tangents[k, 3])
        sights.so_far.append(np.inf)


@allocation_free
def _wait(place: int, side: int, scratch: _Scratch, waiting: int) -> int:
    """Put a bin into the queue, unless it has been there in this look; the queue's length."""
    if scratch.queue_side[place] == side:
        return waiting
    scratch.queue_side[place] = side
    scratch.queue[waiting] = place
    return waiting + 1


@allocation_free
def _is_hidden(side: int, column: int, row: int, scene: Scene, horizon: np.ndarray) -> bool:
    """Whether all rays that leave a side towards a bin end before it."""
    circle, sense, bins = side // 2, _sense(side), scene.bins
    radius = scene.radii[circle]
    dx = bins.low[0] + (column + 0.5) * bins.side - scene.centres[circle, 0]
    dy = bins.low[1] + (row + 0.5) * bins.side - scene.centres[circle, 1]
    distance, reach = math.hypot(dx, dy), _HALF_DIAGONAL * bins.side
    if distance <= radius + 2.0 * reach:
        return False
    nearest = math.sqrt((distance - reach) ** 2 - radius**2)
    # A ray turns by the angle at which a step across it is seen from where it leaves.
    leave = sense * math.atan2(dy, dx) - math.acos(radius / distance)
    begin, end = leave - reach / nearest, leave + reach / nearest
    for sector in range(
        math.floor(begin * (_SECTORS / math.tau)), math.ceil(end * (_SECTORS / math.tau))
    ):
        if horizon[sector % _SECTORS] > nearest:
            return False
    return True


@allocation_free
def _look_at(side: int, aim: int, scene: Scene, scratch: _Scratch, count: int) -> int:
    """Add the free tangents from a side to a circle to those found; their number."""
    circle, sense = side // 2, _sense(side)
    radius, size = scene.radii[circle], scene.radii[aim]
    dx = scene.centres[aim, 0] - scene.centres[circle, 0]
    dy = scene.centres[aim, 1] - scene.centres[circle, 1]
    distance = math.hypot(dx, dy)
    towards = sense * math.atan2(dy, dx)
    segment = scratch.segment
    for crossing in range(2 if size else 1):
        # On the same side of both circles, or from one side to the other.
        turn = 1 - 2 * crossing
        offset = radius - turn * size
        if distance < abs(offset) - TOLERANCE:
            continue
        if not (radius and size) and distance <= abs(offset) + TOLERANCE:
            offset = math.copysign(distance, offset)  # an end on a circle
        length = math.sqrt(max(distance**2 - offset**2, 0.0))
        half = math.acos(min(max(offset / distance, -1.0), 1.0)) if distance else 0.5 * math.pi
        leave = (towards - half) % math.tau
        if scratch.horizon[_sector(leave)] <= length:
            continue
        there = 2 * aim + (side % 2 if turn > 0 else 1 - side % 2)
        arrive = leave if turn > 0 else (math.pi - leave) % math.tau
        segment[0, 0], segment[0, 1] = _x_at(side, leave, scene), _y_at(side, leave, scene)
        segment[1, 0], segment[1, 1] = _x_at(there, arrive, scene), _y_at(there, arrive, scene)
        if is_free(segment[0], segment[1], scene):
            found = scratch.tangents[count]
            found[0], found[1], found[2] = leave, 2 if aim == 1 else there, arrive
            found[3] = math.hypot(segment[1, 0] - segment[0, 0], segment[1, 1] - segment[0, 1])
            count += 1
    return count


@allocation_free
def _sector(angle: float) -> int:
    return min(int(angle * (_SECTORS / math.tau)), _SECTORS - 1)


@allocation_free
def _hide(side: int, other: int, scene: Scene, horizon: np.ndarray) -> None:
    """Note in which sectors all rays that leave a side enter a circle."""
    circle, sense = side // 2, _sense(side)
    radius, size = scene.radii[circle], _WELL_INSIDE * scene.radii[other]
    dx = scene.centres[other, 0] - scene.centres[circle, 0]
    dy = scene.centres[other, 1] - scene.centres[circle, 1]
    distance = math.hypot(dx, dy)
    if distance == 0.0:
        return
    towards = sense * math.atan2(dy, dx)
    begin = towards - math.acos(min(max((radius - size) / distance, -1.0), 1.0))
    if distance >= radius + size:
        end = towards - math.acos((radius + size) / distance)
    elif radius:
        end = towards + _half_covered(distance, radius, size)
    else:
        end = towards
    for sector in range(
        math.ceil(begin * (_SECTORS / math.tau)), math.floor(end * (_SECTORS / math.tau))
    ):
        horizon[sector % _SECTORS] = min(horizon[sector % _SECTORS], distance)


@allocation_free
def _hide_outside(side: int, scene: Scene, horizon: np.ndarray) -> None:
    """Note for each sector how far the rays that leave a side in it get before the border."""
    circle, sense = side // 2, _sense(side)
    x, y, radius = scene.centres[circle, 0], scene.centres[circle, 1], scene.radii[circle]
    left, right, bottom, top = scene.bounds
    if min(x - left, right - x, y - bottom, top - y) < radius:
        for sector in range(_SECTORS):
            horizon[sector] = np.inf
        return
    # Between two corners a ray gets farthest at one end of a sector.
    last = np.inf
    for sector in range(_SECTORS + 1):
        angle = sector * (math.tau / _SECTORS)
        cosine, sine = math.cos(angle), sense * math.sin(angle)
        along_x, along_y = -sense * sine, sense * cosine
        from_x, from_y = x + radius * cosine, y + radius * sine
        end = np.inf
        if along_x:
            end = min(end, ((right if along_x > 0.0 else left) - from_x) / along_x)
        if along_y:
            end = min(end, ((top if along_y > 0.0 else bottom) - from_y) / along_y)
        if sector > 0:
            horizon[sector - 1] = max(last, end)
        last = end
    for corner in range(4):
        dx, dy = scene.bounds[corner % 2] - x, scene.bounds[2 + corner // 2] - y
        distance = math.hypot(dx, dy)
        if distance > radius:
            leave = (sense * math.atan2(dy, dx) - math.acos(radius / distance)) % math.tau
            length = math.sqrt(distance**2 - radius**2)
            horizon[_sector(leave)] = max(horizon[_sector(leave)], length)
    for sector in range(_SECTORS):
        horizon[sector] = _JUST_BEYOND * horizon[sector] + 1e3 * TOLERANCE


@allocation_free
def is_free(a: np.ndarray, b: np.ndarray, scene: Scene) -> bool:
    """Whether the segment from a to b, each (2,), is free."""
    left, right, bottom, top = scene.bounds
    if (
        min(a[0], b[0]) < left - TOLERANCE
        or max(a[0], b[0]) > right + TOLERANCE
        or min(a[1], b[1]) < bottom - TOLERANCE
        or max(a[1], b[1]) > top + TOLERANCE
    ):
        return False
    step_x, step_y = b[0] - a[0], b[1] - a[1]
    square = max(step_x * step_x + step_y * step_y, NO_LENGTH)
    bins = scene.bins
    begin, end = columns_between(a[0], b[0], bins)
    for step in range(end - begin + 1):
        column = begin + step if step_x >= 0 else end - step
        low, high = rows_between(a, b, column, bins)
        for place in range(column * bins.rows + low, column * bins.rows + high + 1):
            for k in bins.members[bins.first[place] : bins.first[place + 1]]:
                x, y = scene.centres[k, 0], scene.centres[k, 1]
                share = ((x - a[0]) * step_x + (y - a[1]) * step_y) / square
                share = min(max(share, 0.0), 1.0)
                distance = math.hypot(a[0] + share * step_x - x, a[1] + share * step_y - y)
                if distance < scene.radii[k] - TOLERANCE:
                    return False
    return True


@compiled
def circles_beside(line: np.ndarray, bins: Bins, count: int) -> np.ndarray:
    """Which of so many circles have their bins passed by a polyline (n, 2): bool (count,)."""
    near = np.zeros(count, dtype=np.bool_)
    for i in range(len(line) - 1):
        begin, end = columns_between(line[i, 0], line[i + 1, 0], bins)
        for column in range(begin, end + 1):
            low, high = rows_between(line[i], line[i + 1], column, bins)
            for place in range(column * bins.rows + low, column * bins.rows + high + 1):
                for k in bins.members[bins.first[place] : bins.first[place + 1]]:
                    near[k] = True
    return near
