"""What a robot could reach that knew the future of its world: a bound below every arrival, and the
earliest arrival that a search finds.

The bound, `least_way`, is the shortest way among what stands still all the time. The search goes
over safe intervals. A place has safe intervals, during which nothing is there; a robot that reaches
it in one of them can stay until it ends. So the earliest arrival in each interval of each place is
all that a search must keep (Phillips and Likhachev, SIPP, ICRA 2011).

Every schedule found is exactly free, so the search bounds the best arrival from above. Among
circles the places are the points of a lattice. A place is reached from a neighbour or straight from
the neighbour's predecessor (Yakovlev and Andreychuk, AA-SIPP, ICAPS 2017), and the way found is
pulled taut off the lattice; ways with one bend, and a straight drive after a wait, are tried as
well. Another robot may still be earlier. Among cells the places are start, target and the corners
of all maps, and drives lead in any direction: where a map only gains obstacles, and once, no robot
of any kind is earlier.
"""

import heapq
import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.kernels import allocation_free, compiled
from bezierplan.running.simulation.motion_check import Motion, check
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles, World, positions


class Schedule(NamedTuple):
    """arrival: in steps, infinite if none was found in time. length: of the way, in units."""

    arrival: float
    length: float


def least_way(world: World, problem: Problem) -> shortest_paths.Bound:
    """The shortest way through places that are free at some time: no robot's way is shorter, and at
    its pace no robot arrives earlier.
    """
    if isinstance(world, ChangingCells):
        always = np.all([each.occupied for each in world.maps], axis=0)
        return shortest_paths.shortest_path(
            problem._replace(workspace=replace(world.maps[0], occupied=always))
        )
    # A circle that moves lets a robot pass that waits.
    still = ~world.velocities.any(axis=1)
    stays = Circles(world.bounds, world.centres[still], world.radii[still], world.unit)
    return shortest_paths.shortest_path(problem._replace(workspace=stays))


def earliest(world: World, problem: Problem) -> Schedule:
    """The earliest arrival found."""
    return (
        _among_cells(world, problem)
        if isinstance(world, ChangingCells)
        else _among_circles(world, problem)
    )


def reachable(world: World, problem: Problem) -> bool:
    """Whether the search finds a schedule, of any arrival before the world's end."""
    if isinstance(world, ChangingCells):
        return math.isfinite(_among_cells(world, problem).arrival)
    if problem.start == problem.target or len(
        _on_lattice(*_search(world, problem), world.end, False)[0]
    ):
        return True
    return math.isfinite(_straight(world, problem, math.inf))


# Circles


# A drive that would collide is tried again this much later, in steps, at most so often.
_LATER = 0.5
_MOST_TRIES = 12


def _among_circles(world: MovingCircles, problem: Problem) -> Schedule:
    straight = math.dist(problem.start, problem.target)
    if straight == 0:
        return Schedule(0.0, 0.0)
    search = _search(world, problem)
    schedule, bounds = Schedule(math.inf, math.inf), np.array(world.bounds, dtype=float)
    points, waits = _on_lattice(*search, world.end, True)
    while len(points):
        points, waits = _pulled(points, waits, search.centres, world.radii, bounds, world.pace)
        length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        schedule = Schedule(float(waits.sum()) + length / world.pace, length)
        points, waits = _with_one_bend(*search, schedule.arrival)
    arrival = _straight(world, problem, schedule.arrival)
    return Schedule(arrival, straight) if arrival < schedule.arrival else schedule


def _straight(world: MovingCircles, problem: Problem, before: float) -> float:
    """Arrival of the first straight drive after a wait of whole steps that is free and arrives
    before a time; infinite if there is none.
    """
    ends = np.array([problem.start, problem.target])
    duration = math.dist(problem.start, problem.target) / world.pace
    for wait in range(world.end):
        arrival = wait + duration
        if arrival >= before:
            break
        points, times = (
            (ends[[0, 0, 1]], [0.0, float(wait), arrival]) if wait else (ends, [0.0, arrival])
        )
        if math.isnan(check(Motion(points, np.array(times)), world).collision_at):
            return arrival
    return math.inf


class _Search(NamedTuple):
    """A search among circles. origin (2,) and counts (2,): of a lattice through the start whose
    straight moves take one step. centres: (steps + 2, n, 2), of the circles. radii (n,). start,
    target: (2,). pace: in units per step.
    """

    origin: np.ndarray
    counts: np.ndarray
    centres: np.ndarray
    radii: np.ndarray
    start: np.ndarray
    target: np.ndarray
    pace: float


def _search(world: MovingCircles, problem: Problem) -> _Search:
    x_low, x_high, y_low, y_high = world.bounds
    pace, start = world.pace, np.array(problem.start)
    before = np.floor((start - [x_low, y_low]) / pace + 1e-9)
    after = np.floor(([x_high, y_high] - start) / pace + 1e-9)
    walls = np.array(world.walls, dtype=float)
    centres = np.array(
        [positions(world.centres, world.velocities, walls, step) for step in range(world.end + 2)]
    )
    counts = (before + after + 1).astype(np.int64)
    return _Search(
        start - before * pace, counts, centres, world.radii, start, np.array(problem.target), pace
    )


@compiled
def _on_lattice(origin, counts, centres, radii, start, target, pace, end, any_angle):
    """Points (n, 2) of the earliest schedule found with its bends on the lattice, and the waits
    (n,) at each; none if it found none.

    any_angle: whether a place is reached from its predecessor's predecessor as well.
    """
    columns, rows = counts
    begins = _safe_intervals(origin, columns, rows, centres, radii, pace, end)
    # `best` and `parents` hold what is reached: to fill them before takes longer than the search,
    # which reaches few intervals.
    reached = np.zeros(begins.shape, dtype=np.bool_)
    best = np.empty(begins.shape)
    parents = np.empty(begins.shape, dtype=np.int64)
    since = np.empty(begins.shape, dtype=np.int64)
    first_node = round((start[1] - origin[1]) / pace) * columns + round(
        (start[0] - origin[0]) / pace
    )
    # Where a circle comes during the first step, the robot must leave at once.
    hurried = begins[first_node, 0] < 0
    reached[first_node, 0] = True
    best[first_node, 0] = 0.0
    parents[first_node, 0] = -1
    since[first_node, 0] = 0
    heap = [(math.hypot(target[0] - start[0], target[1] - start[1]) / pace, 0.0, first_node, 0)]
    while len(heap) > 0:
        _, time, node, interval = heapq.heappop(heap)
        if node < 0:
            return _traced(
                time, -1 - node, interval, origin, columns, target, pace, best, parents, since
            )
        if time > best[node, interval]:
            continue
        x, y = origin[0] + node % columns * pace, origin[1] + node // columns * pace
        leave = _leave(begins, node, interval, end, hurried and node == first_node)
        home = math.hypot(target[0] - x, target[1] - y)
        # Here and below, an integer in the place of a float would compile the kernel a second time.
        if any_angle or home < 1.5 * pace:
            latest = float(leave) if home < 1.5 * pace else time
            depart = _departure(
                x, y, target[0], target[1], time, latest, home / pace, centres, radii
            )
            if depart < np.inf:
                heapq.heappush(
                    heap, (depart + home / pace, depart + home / pace, -1 - node, interval)
                )
        parent = parents[node, interval] if any_angle else -1
        parent_interval = since[node, interval]
        if parent >= 0:
            parent_x = origin[0] + parent % columns * pace
            parent_y = origin[1] + parent // columns * pace
            parent_leave = _leave(
                begins, parent, parent_interval, end, hurried and parent == first_node
            )
        for dx in range(-1, 2):
            for dy in range(-1, 2):
                column, row = node % columns + dx, node // columns + dy
                if (dx == 0 and dy == 0) or not (0 <= column < columns and 0 <= row < rows):
                    continue
                neighbour = row * columns + column
                other_x, other_y = origin[0] + column * pace, origin[1] + row * pace
                duration = math.hypot(dx, dy)
                # Each safe interval of the other place that this one can reach.
                step = int(time + duration)
                while step < end and step <= leave + duration:
                    if begins[neighbour, step] < 0:
                        step += 1
                        continue
                    into = np.int64(begins[neighbour, step])
                    until = step
                    while until < end and begins[neighbour, until] == into:
                        until += 1
                    step = until
                    known = best[neighbour, into] if reached[neighbour, into] else np.inf
                    arrival, before, before_interval = known, node, interval
                    if parent >= 0:
                        direct = math.hypot(other_x - parent_x, other_y - parent_y) / pace
                        first = max(best[parent, parent_interval], into - direct)
                        last = min(parent_leave, until - direct)
                        if first + direct < arrival:
                            depart = _departure(
                                parent_x,
                                parent_y,
                                other_x,
                                other_y,
                                first,
                                last,
                                direct,
                                centres,
                                radii,
                            )
                            if depart + direct < arrival:
                                arrival = depart + direct
                                before = parent
                                before_interval = parent_interval
                    first, last = max(time, into - duration), min(leave, until - duration)
                    if first + duration < arrival:
                        depart = _departure(
                            x, y, other_x, other_y, first, last, duration, centres, radii
                        )
                        if depart + duration < arrival:
                            arrival, before, before_interval = depart + duration, node, interval
                    if arrival < known:
                        reached[neighbour, into], best[neighbour, into] = True, arrival
                        parents[neighbour, into], since[neighbour, into] = before, before_interval
                        rest = math.hypot(target[0] - other_x, target[1] - other_y) / pace
                        heapq.heappush(heap, (arrival + rest, arrival, neighbour, into))
    return np.empty((0, 2)), np.empty(0)


@allocation_free
def _leave(begins, node, interval, end, hurried):
    """The step at which a place's safe interval ends; 0 if the first one must be left at once."""
    leave = interval
    while leave < end and begins[node, leave] == interval and not (hurried and interval == 0):
        leave += 1
    return leave


@compiled
def _traced(arrival, node, interval, origin, columns, target, pace, best, parents, since):
    """Points and waits, as of `_on_lattice`, of the schedule that goes from a place in an interval
    to the target, from its predecessors.
    """
    count, at, during = 2, node, interval
    while parents[at, during] >= 0:
        at, during, count = parents[at, during], since[at, during], count + 1
    points, times = np.empty((count, 2)), np.empty(count)
    points[count - 1, 0], points[count - 1, 1], times[count - 1] = target[0], target[1], arrival
    for k in range(count - 2, -1, -1):
        points[k, 0] = origin[0] + node % columns * pace
        points[k, 1] = origin[1] + node // columns * pace
        times[k] = best[node, interval]
        node, interval = parents[node, interval], since[node, interval]
    waits = np.zeros(count)
    for k in range(count - 1):
        waits[k] = max(
            times[k + 1]
            - times[k]
            - math.hypot(points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1]) / pace,
            0.0,
        )
    return points, waits


@compiled
def _with_one_bend(origin, counts, centres, radii, start, target, pace, before):
    """Points (3, 2) and waits (3,), as of `_on_lattice`, of the earliest schedule with one bend on
    the lattice and no wait that arrives before a time, in steps; none if there is none. The search
    misses it where it reaches a place of the way earlier by another one.
    """
    columns, rows = counts
    best, points, waits = before - _EARLIER, np.empty((3, 2)), np.zeros(3)
    tried = np.empty((3, 2))
    tried[0, 0], tried[0, 1], tried[2, 0], tried[2, 1] = start[0], start[1], target[0], target[1]
    for node in range(columns * rows):
        tried[1, 0] = origin[0] + node % columns * pace
        tried[1, 1] = origin[1] + node // columns * pace
        length = math.hypot(tried[1, 0] - start[0], tried[1, 1] - start[1]) + math.hypot(
            target[0] - tried[1, 0], target[1] - tried[1, 1]
        )
        if length / pace < best and _arrival(tried, waits, 3, centres, radii, pace) < np.inf:
            best = length / pace
            for i in range(3):
                points[i, 0], points[i, 1] = tried[i, 0], tried[i, 1]
    if best < before - _EARLIER:
        return points, waits
    return points[:0], waits[:0]


# A way is pulled taut in shifts from the first to the last length, in paces, in so many directions.
_FIRST_SHIFT, _LAST_SHIFT = 2.0, 0.005
_SHIFTS = 16

# A change must make a schedule this much earlier, in steps.
_EARLIER = 1e-6


@compiled
def _pulled(points, waits, centres, radii, bounds, pace):
    """Points (m, 2) and waits (m,), as of `_on_lattice`, of a schedule from a free one, with points
    left out, points shifted and waits cut for as long as that makes it earlier and leaves it free.
    It changes what it is given. bounds (4,): as in `MovingCircles`.
    """
    n = len(points)
    arrival = _arrival(points, waits, n, centres, radii, pace)
    tried, tried_waits = np.empty_like(points), np.empty_like(waits)
    shift = _FIRST_SHIFT * pace
    while shift >= _LAST_SHIFT * pace:
        better = False
        k = 0
        while k < n - 1:
            # To leave out the point, to wait less before it is left, and to shift it.
            for attempt in range(-2, _SHIFTS):
                if k == 0 and attempt != -1:
                    continue
                for i in range(n):
                    j = i + 1 if attempt == -2 and i >= k else i
                    if j < n:
                        tried[i, 0] = points[j, 0]
                        tried[i, 1] = points[j, 1]
                        tried_waits[i] = waits[j]
                m = n - 1 if attempt == -2 else n
                if attempt == -1:
                    tried_waits[k] = max(waits[k] - shift / pace, 0.0)
                elif attempt >= 0:
                    angle = 2.0 * math.pi * attempt / _SHIFTS
                    tried[k, 0] = min(
                        max(points[k, 0] + shift * math.cos(angle), bounds[0]), bounds[1]
                    )
                    tried[k, 1] = min(
                        max(points[k, 1] + shift * math.sin(angle), bounds[2]), bounds[3]
                    )
                found = _arrival(tried, tried_waits, m, centres, radii, pace)
                if found < arrival - _EARLIER:
                    n, arrival, better = m, found, True
                    for i in range(n):
                        points[i, 0] = tried[i, 0]
                        points[i, 1] = tried[i, 1]
                        waits[i] = tried_waits[i]
                    if attempt == -2:
                        k -= 1
                        break
            k += 1
        if not better:
            shift /= 2.0
    return points[:n], waits[:n]


@allocation_free
def _arrival(points, waits, count, centres, radii, pace):
    """When a schedule of so many points arrives, in steps; infinite if it collides or is late."""
    time = 0.0
    for k in range(count - 1):
        x, y, next_x, next_y = points[k, 0], points[k, 1], points[k + 1, 0], points[k + 1, 1]
        if time + waits[k] >= len(centres) - 1:
            return np.inf
        if waits[k] > 0.0 and not _is_free(x, y, x, y, time, waits[k], centres, radii):
            return np.inf
        time += waits[k]
        duration = math.hypot(next_x - x, next_y - y) / pace
        if duration > 0.0:
            if time + duration >= len(centres) - 1 or not _is_free(
                x, y, next_x, next_y, time, duration, centres, radii
            ):
                return np.inf
            time += duration
    return time


@compiled
def _safe_intervals(origin, columns, rows, centres, radii, pace, end):
    """For each place and step, the first step of the safe interval that holds it, or -1 if some
    circle comes there during the step.
    """
    begins = np.zeros((columns * rows, end), dtype=np.int16)
    for step in range(end):
        for k in range(len(radii)):
            reach = radii[k]
            low_x = min(centres[step, k, 0], centres[step + 1, k, 0])
            high_x = max(centres[step, k, 0], centres[step + 1, k, 0])
            low_y = min(centres[step, k, 1], centres[step + 1, k, 1])
            high_y = max(centres[step, k, 1], centres[step + 1, k, 1])
            first = math.ceil((low_x - reach - origin[0]) / pace)
            last = math.floor((high_x + reach - origin[0]) / pace)
            bottom = math.ceil((low_y - reach - origin[1]) / pace)
            top = math.floor((high_y + reach - origin[1]) / pace)
            for row in range(max(bottom, 0), min(top, rows - 1) + 1):
                for column in range(max(first, 0), min(last, columns - 1) + 1):
                    x, y = origin[0] + column * pace, origin[1] + row * pace
                    if _meets(
                        x,
                        y,
                        x,
                        y,
                        float(step),
                        step + 1.0,
                        centres[step : step + 2, k],
                        reach,
                        step,
                    ):
                        begins[row * columns + column, step] = -1
    for node in range(columns * rows):
        begin = 0
        for step in range(end):
            if begins[node, step] < 0:
                begin = step + 1
            else:
                begins[node, step] = begin
    return begins


@allocation_free
def _meets(x, y, to_x, to_y, begin, end, centres, radius, step):
    """Whether a robot that moves from one point at `begin` to another at `end`, both within a step,
    enters a circle that moves from the first to the second of two centres (2, 2) during the step.
    """
    early, late = begin - step, end - step
    dx = x - centres[0, 0] - early * (centres[1, 0] - centres[0, 0])
    dy = y - centres[0, 1] - early * (centres[1, 1] - centres[0, 1])
    ex = to_x - centres[0, 0] - late * (centres[1, 0] - centres[0, 0]) - dx
    ey = to_y - centres[0, 1] - late * (centres[1, 1] - centres[0, 1]) - dy
    size = ex * ex + ey * ey
    share = min(max(-(dx * ex + dy * ey) / size, 0.0), 1.0) if size > 0.0 else 0.0
    return (dx + share * ex) ** 2 + (dy + share * ey) ** 2 < radius * radius


@allocation_free
def _departure(x, y, to_x, to_y, earliest, latest, duration, centres, radii):
    """The first of some departures between two times, in steps, after which a drive collides with
    nothing; infinite without one.
    """
    depart = earliest
    for _ in range(_MOST_TRIES):
        if depart > latest or depart + duration >= len(centres) - 1:
            return np.inf
        if _is_free(x, y, to_x, to_y, depart, duration, centres, radii):
            return depart
        depart += _LATER
    return np.inf


@allocation_free
def _is_free(x, y, to_x, to_y, depart, duration, centres, radii):
    begin = depart
    while begin < depart + duration:
        step = int(begin)
        end = min(step + 1.0, depart + duration)
        one, other = (begin - depart) / duration, (end - depart) / duration
        for k in range(len(radii)):
            here_x, here_y = x + one * (to_x - x), y + one * (to_y - y)
            there_x, there_y = x + other * (to_x - x), y + other * (to_y - y)
            if _meets(
                here_x,
                here_y,
                there_x,
                there_y,
                begin,
                end,
                centres[step : step + 2, k],
                radii[k],
                step,
            ):
                return False
        begin = end
    return True


# Cells


def _among_cells(world: ChangingCells, problem: Problem) -> Schedule:
    grid = world.maps[0]
    occupied = np.array([np.pad(each.occupied, 1, constant_values=True) for each in world.maps])
    # In cells from the lower left corner of the ring of occupied cells around the map.
    ends = grid.in_cells(np.array([problem.start, problem.target], dtype=float)) + 1.0
    around = (
        occupied[:, :-1, :-1] * 1
        + occupied[:, :-1, 1:]
        + occupied[:, 1:, :-1]
        + occupied[:, 1:, 1:]
    )
    diagonal = (around == 2) & (occupied[:, :-1, :-1] == occupied[:, 1:, 1:])
    rows, columns = np.nonzero(((around == 1) | diagonal).any(axis=0))
    places = np.concatenate([ends, np.column_stack([columns, rows]) + 1.0])
    begins = np.concatenate([[0.0], world.moments])
    arrival, length = _between_corners(places, occupied, begins, world.pace / grid.cell)
    return Schedule(arrival if arrival <= world.end else math.inf, length * grid.cell)


@compiled
def _between_corners(places, occupied, begins, pace):
    """Arrival, in steps, and length, in cells, of the earliest schedule from the first place (n, 2)
    to the second.

    occupied: (maps, rows, columns). begins: (maps,) when each map begins. pace: in cells per step.
    """
    n, maps = len(places), len(occupied)
    # The first map of the safe interval that holds a map, or -1 if the place is blocked.
    since = np.zeros((n, maps), dtype=np.int64)
    for i in range(n):
        for f in range(maps):
            if _inside(places[i, 0], places[i, 1], occupied[f]):
                since[i, f] = -1
            else:
                since[i, f] = since[i, f - 1] if f > 0 and since[i, f - 1] >= 0 else f
    best, lengths = np.full((n, maps), np.inf), np.full((n, maps), np.inf)
    done = np.zeros((n, maps), dtype=np.bool_)
    cuts = np.empty(occupied.shape[1] + occupied.shape[2] + 2)
    if since[0, 0] < 0:
        return np.inf, np.inf
    best[0, 0], lengths[0, 0] = 0.0, 0.0
    while True:
        i, f, time = -1, -1, np.inf
        for each in range(n):
            for other in range(maps):
                if not done[each, other] and best[each, other] < time:
                    i, f, time = each, other, best[each, other]
        if i < 0:
            return np.inf, np.inf
        if i == 1:
            return time, lengths[1, f]
        done[i, f] = True
        leave = _end_of(since[i], f, begins)
        for j in range(n):
            size = math.hypot(places[j, 0] - places[i, 0], places[j, 1] - places[i, 1])
            if size == 0.0:
                continue
            for into in range(maps):
                if since[j, into] != into or done[j, into]:
                    continue
                until = _end_of(since[j], into, begins)
                earliest = max(time, begins[into] - size / pace) if into > 0 else time
                if earliest + size / pace >= min(until, best[j, into]):
                    continue
                latest = min(leave, until - size / pace)
                depart = _free_departure(
                    places[i], places[j], size, earliest, latest, occupied, begins, pace, cuts
                )
                if depart + size / pace < best[j, into]:
                    best[j, into] = depart + size / pace
                    lengths[j, into] = lengths[i, f] + size


@allocation_free
def _end_of(since, first, begins):
    """When the safe interval that begins with a map ends."""
    f = first
    while f < len(begins) and since[f] == first:
        f += 1
    return begins[f] if f < len(begins) else np.inf


@allocation_free
def _free_departure(start, end, size, depart, latest, occupied, begins, pace, cuts):
    """The first departure from a time on, in steps, after which the straight drive meets no
    occupied cell; infinite after the latest.

    cuts: room for `_write_crossings`.
    """
    pieces = _write_crossings(start, end, cuts) - 1
    while depart <= latest:
        delayed = depart
        for k in range(pieces):
            middle = (cuts[k] + cuts[k + 1]) / 2.0
            x, y = start[0] + middle * (end[0] - start[0]), start[1] + middle * (end[1] - start[1])
            enters, leaves = depart + cuts[k] * size / pace, depart + cuts[k + 1] * size / pace
            for f in range(np.searchsorted(begins, enters, side="right") - 1, len(begins)):
                ends = begins[f + 1] if f + 1 < len(begins) else np.inf
                if leaves <= begins[f] + 1e-12:
                    break
                if enters < ends - 1e-12 and _inside(x, y, occupied[f]):
                    # It may enter this cell only when this map is over.
                    delayed = max(delayed, ends - cuts[k] * size / pace)
            if delayed > latest:
                return np.inf
        if delayed == depart:
            return depart
        depart = delayed
    return np.inf


@allocation_free
def _write_crossings(start, end, cuts):
    """Write the ascending parameters from 0 to 1 at which a segment crosses a grid line, each once;
    returns their number.
    """
    cuts[0] = 0.0
    count = 1
    column, columns, right = _lines_between(start[0], end[0])
    row, rows, up = _lines_between(start[1], end[1])
    while columns > 0 or rows > 0:
        across = (column - start[0]) / (end[0] - start[0]) if columns > 0 else np.inf
        along = (row - start[1]) / (end[1] - start[1]) if rows > 0 else np.inf
        if across <= along:
            column, columns = column + right, columns - 1
        else:
            row, rows = row + up, rows - 1
        if min(across, along) > cuts[count - 1]:
            cuts[count] = min(across, along)
            count += 1
    if cuts[count - 1] < 1.0:
        cuts[count] = 1.0
        count += 1
    return count


@allocation_free
def _lines_between(begin, end):
    """The first grid line beyond a coordinate on the way to another, how many there are before that
    one, and the step to the next line.
    """
    lines = math.ceil(max(begin, end)) - math.floor(min(begin, end)) - 1
    return (math.floor(begin) + 1, lines, 1) if end > begin else (math.ceil(begin) - 1, lines, -1)


# A coordinate this close to a grid line, in cells, lies on it.
_ON_LINE = 1e-9


@allocation_free
def _inside(x, y, occupied):
    """Whether a point lies in the interior of the occupied cells."""
    left, right = math.floor(x - _ON_LINE), math.floor(x + _ON_LINE)
    bottom, top = math.floor(y - _ON_LINE), math.floor(y + _ON_LINE)
    return (
        occupied[bottom, left]
        and occupied[bottom, right]
        and occupied[top, left]
        and occupied[top, right]
    )
