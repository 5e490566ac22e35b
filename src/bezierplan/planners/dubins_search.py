"""A baseline for robots that cannot turn on the spot: a path of arcs and straight lines that turns
no tighter than a radius anywhere, from one heading to another where they are given (Dubins 1957).

If the shortest such path without obstacles is free, it is the answer, and exact. Otherwise hybrid
A* finds one (Dolgov et al. 2008): from the start it drives short arcs to the left, straight lines
and short arcs to the right; of all places reached in about the same heading in the same cell the
nearest is driven on from; the distance ahead is estimated by that around obstacles over a lattice,
and by the Dubins path without them. Now and then the Dubins path from there to the target is tried;
if it is free, a path is found. It is then pulled tight: parts of it are replaced by Dubins paths
between its own places, and these places are moved as long as it becomes shorter.

Every arc and line is tested by the certified checker's own search, as the cubic pieces that are the
answer. A search that finds nothing is repeated with finer steps, then from more places, and with
wider turns, which lead farther with each step, up to a limit (`MOST_EXPANDED`). That it finds
nothing is no proof that there is no such path.
"""

import heapq
import math
from collections.abc import Callable, Iterator
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.geometry import curves, shortest_paths
from bezierplan.geometry.any_collision import collides
from bezierplan.geometry.checker import TOLERANCE, first_collision, is_free
from bezierplan.geometry.region import GridRegion, Region, from_origin, region
from bezierplan.kernels import allocation_free, compiled
from bezierplan.planners import About, Plan, Range
from bezierplan.planners.parts.dubins import MOST_PIECES, WORDS, pieces_of, words_between
from bezierplan.planners.parts.settings import UNITS, with_settings
from bezierplan.workspaces.limits import LARGEST, SMALLEST_FEATURE
from bezierplan.workspaces.problem import Path, Problem

extra = ("expanded",)
exact = True
deterministic = True

MOST_EXPANDED = 400_000
"""Most places from which all searches for one path drive on."""

# A step turns by at most this angle, in radians, and is at most this share of the map's longer
# side. Searches follow each other with steps shorter by a factor, and drive on from at most so many
# places; then with wider turns, on a scale that does not depend on the radius.
_STEP_ANGLE = math.pi / 8
_STEP_SHARE = 1 / 60
_SEARCHES = ((1.0, 6_000), (0.5, 9_000), (0.25, 12_000), (1.0, 60_000))
_WIDER = (1.0, 60_000)
_WIDER_PER_OCTAVE = 2

# The length ahead counts so much more than that driven: what is found first need not be shortest,
# since it is pulled tight.
_HASTE = 2.0

# Side of a cell of places, in steps: no step ends in the cell in which it begins.
_CELL = 1 / 1.6

# Most headings that are told apart.
_MOST_HEADINGS = 256

# The Dubins path to the target is tried from places that are nearer to it than all before, and from
# one in so many others.
_TRIED = 16

# Nodes of the lattice over which distances around obstacles are counted, about.
_NODES = 40_000

# Squares of the lattice are tested for obstacles so many times so many at once, then one by one.
_AT_ONCE = 8

# Where the lattice knows no way, the distance ahead is this many times the straight line.
_DETOUR = 2.0

# Places of a path between which it is pulled tight, at most; how often that is done; and the gain
# that ends it, as a share of the length.
_MOST_PLACES = 100
_ROUNDS = 3
_LEAST_GAIN = 1e-3

# From a place, those before it are looked at until so many in a row cannot be joined with it.
_OUT_OF_SIGHT = 6

# Places are moved by this share of the turning radius, and turned by this angle in radians; then so
# often by half of that.
_MOVED = 0.5
_TURNED = 0.4
_HALVINGS = 8


class Settings(NamedTuple):
    """What the robot can do, and how it stands at both ends; without a heading, any is right."""

    turning_radius: Annotated[
        float,
        Range(SMALLEST_FEATURE, LARGEST),
        About("the smallest radius in which the robot turns", unit=UNITS),
    ]
    start_heading: Annotated[
        float | None,
        Range(-math.tau, math.tau),
        About("heading at the start, counterclockwise from the x-axis; null for any", unit="rad"),
    ]
    target_heading: Annotated[
        float | None,
        Range(-math.tau, math.tau),
        About("heading at the target; null for any", unit="rad"),
    ]


class Lattice(NamedTuple):
    """Distances to the target around obstacles. low: (2,) its lower left node. side: distance of
    nodes. ahead: (rows, columns).
    """

    low: np.ndarray
    side: float
    ahead: np.ndarray


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """A path that turns no tighter than the turning radius.

    Parameters
    ----------
    problem : Problem
        In any workspace of the plane.
    rng : numpy.random.Generator
        Unused: the search is deterministic.

    Returns
    -------
    Plan
        Its objective is its length, in units, or infinite if there is no path. Extra column:
        expanded, the number of places from which the search drove on, 0 if the Dubins path itself
        is free.

    References
    ----------
    L. E. Dubins, On curves of minimal length with a constraint on average curvature, and with
    prescribed initial and terminal positions and tangents, American Journal of Mathematics 79
    (1957); D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel, Practical search techniques in path
    planning for autonomous driving, AAAI Workshop on Search in AI and Robotics (2008).
    """
    blocked = region(problem.workspace)
    return searched(
        problem, settings, shortest_paths.shortest_path(problem, blocked=blocked), blocked
    )


def searched(
    problem: Problem,
    settings: Settings,
    bound: shortest_paths.Bound,
    blocked: Region,
    ahead: Callable[[], Lattice] | None = None,
    only_radius: bool = False,
) -> Plan:
    """The same, where the exact shortest path and the region of the map are known.

    ahead: makes their `lattice_of`, for who searches several times. only_radius: one search with
    the radius itself, from as many places as any.
    """
    if math.isinf(bound.length):
        return _answer(problem, None, 0, "no way", blocked)
    radius = settings.turning_radius
    places = from_origin(np.array([problem.start, problem.target], dtype=float), blocked)
    ends = np.column_stack([places, [settings.start_heading, settings.target_heading]])
    direct = chain_of(ends, radius, 1, blocked)
    if len(direct):
        return _answer(problem, direct, 0, "direct", blocked)
    lattice = ahead() if ahead else lattice_of(problem, bound, blocked)
    expanded = 0
    for driven, factor, most in _searches(problem, radius, only_radius):
        poses, count = _search(
            ends,
            driven,
            factor * _step(problem, driven),
            lattice,
            min(most, MOST_EXPANDED - expanded),
            blocked,
        )
        expanded += count
        pieces = _pulled_tight(poses, ends, driven, blocked)
        if len(pieces):
            if driven > radius:
                pieces = _tighter(pieces, _places(pieces, ends), radius, blocked)
            return _answer(problem, pieces, expanded, "search", blocked)
    return _answer(problem, None, expanded, "none found", blocked)


def _answer(
    problem: Problem, pieces: np.ndarray | None, expanded: int, stop: str, blocked: Region
) -> Plan:
    """The answer with a path of pieces (n, 4, 2), relative to the region's origin, or without."""
    told = {"evaluations": 1 + expanded, "stop": stop, "extra": {"expanded": expanded}}
    if pieces is None:
        return Plan(None, math.inf, claimed_feasible=False, history=np.array([math.inf]), **told)
    points = np.concatenate([pieces[0, :1], pieces[:, 1:].reshape(-1, 2)])
    if isinstance(blocked, GridRegion):
        points = points + blocked.origin
    points[0], points[-1] = problem.start, problem.target  # to the last bit
    path = Path("cubic_chain", points)
    length = curves.length(path)
    # The verdict of the checker, without the clearance, which takes longer than the search on a map
    # of many cells.
    pieces = from_origin(np.ascontiguousarray(curves.bezier_pieces(path)), blocked)
    free = first_collision(pieces, blocked)[0] == math.inf
    return Plan(path, length, claimed_feasible=free, history=np.array([length]), **told)


def _searches(
    problem: Problem, radius: float, only_radius: bool
) -> Iterator[tuple[float, float, int]]:
    """The searches in turn: the radius that is driven, the factor of its steps, the most places."""
    if only_radius:
        yield radius, *_WIDER
        return
    for search in _SEARCHES:
        yield radius, *search
    x_low, x_high, y_low, y_high = problem.workspace.bounds
    longer_side = max(x_high - x_low, y_high - y_low)
    below, easiest, above = (
        math.floor(math.log2(each) * _WIDER_PER_OCTAVE) + 1
        for each in (radius, easiest_radius(problem), longer_side)
    )
    # From where steps lead far enough to tighter turns, which need more of them, then the rest.
    scale = [*range(max(easiest, below) - 1, below - 1, -1), *range(max(easiest, below), above)]
    for number in scale:
        yield 2 ** (number / _WIDER_PER_OCTAVE), *_WIDER


def _step(problem: Problem, radius: float) -> float:
    """The longest step of a search."""
    return _STEP_ANGLE * min(radius, easiest_radius(problem))


def easiest_radius(problem: Problem) -> float:
    """The smallest radius with which the longest steps lead across the map in few."""
    x_low, x_high, y_low, y_high = problem.workspace.bounds
    return _STEP_SHARE * max(x_high - x_low, y_high - y_low) / _STEP_ANGLE


def lattice_of(problem: Problem, bound: shortest_paths.Bound, blocked: Region) -> Lattice:
    """Distances to the target over a lattice; where the exact shortest path passes, its own."""
    x_low, x_high, y_low, y_high = problem.workspace.bounds
    side = math.sqrt((x_high - x_low) * (y_high - y_low) / _NODES)
    low = from_origin(np.array([x_low, y_low]), blocked)
    shape = math.ceil((y_high - y_low) / side) + 1, math.ceil((x_high - x_low) / side) + 1
    line = from_origin(bound.points, blocked)
    legs = np.hypot(*np.diff(line, axis=0).T)
    parts = np.maximum(np.ceil(legs / side), 1).astype(int)
    share = np.concatenate([np.arange(count) / count for count in parts])
    leg = np.repeat(np.arange(len(parts)), parts)
    along = line[leg] + share[:, None] * (line[leg + 1] - line[leg])
    rest = bound.length - (np.cumsum(legs) - legs)[leg] - share * legs[leg]
    known = np.column_stack([np.vstack([along, line[-1]]), np.append(rest, 0.0)])
    return Lattice(low, side, _distances(low, side, shape, known, blocked))


@compiled
def _distances(low, side, shape, known, blocked):
    """Distances ahead (rows, columns) over the lattice's free links to the 8 neighbours, from known
    ones (n, 3): x, y, distance.
    """
    rows, columns = shape
    ahead = np.full((rows, columns), np.inf)
    settled = np.zeros((rows, columns), dtype=np.bool_)
    link = np.empty((1, 2, 2))
    clear = _clear_squares(low, side, shape, blocked)
    heap = [(np.inf, 0, 0)]
    for k in range(len(known)):
        column, row = round((known[k, 0] - low[0]) / side), round((known[k, 1] - low[1]) / side)
        if known[k, 2] < ahead[row, column]:
            ahead[row, column] = known[k, 2]
            heapq.heappush(heap, (known[k, 2], row, column))
    while len(heap) > 1:
        length, row, column = heapq.heappop(heap)
        if settled[row, column] or length == np.inf:
            continue
        settled[row, column] = True
        for up in range(-1, 2):
            for right in range(-1, 2):
                other_row, other_column = row + up, column + right
                if (
                    not (0 <= other_row < rows and 0 <= other_column < columns)
                    or settled[other_row, other_column]
                ):
                    continue
                so_far = length + side * math.hypot(up, right)
                if so_far >= ahead[other_row, other_column]:
                    continue
                link[0, 0, 0], link[0, 0, 1] = low[0] + side * column, low[1] + side * row
                link[0, 1, 0] = low[0] + side * other_column
                link[0, 1, 1] = low[1] + side * other_row
                if _is_clear(row, column, up, right, clear) or not collides(link, blocked):
                    ahead[other_row, other_column] = so_far
                    heapq.heappush(heap, (so_far, other_row, other_column))
    return ahead


@compiled
def _clear_squares(low, side, shape, blocked):
    """Which squares between four nodes are certified free, with a margin: bool (rows + 1, columns +
    1), one ring of squares more than there are. First many are tried at once.
    """
    clear = np.zeros((shape[0] + 1, shape[1] + 1), dtype=np.bool_)
    hull = np.empty((4, 2))
    for row in range(0, shape[0] - 1, _AT_ONCE):
        for column in range(0, shape[1] - 1, _AT_ONCE):
            top = min(row + _AT_ONCE, shape[0] - 1)
            right = min(column + _AT_ONCE, shape[1] - 1)
            _square(low, side, row, top, column, right, hull)
            all_free = is_free(hull, blocked)
            for i in range(row, top):
                for j in range(column, right):
                    if not all_free:
                        _square(low, side, i, i + 1, j, j + 1, hull)
                    clear[i + 1, j + 1] = all_free or is_free(hull, blocked)
    return clear


@allocation_free
def _square(low, side, bottom, top, left, right, hull):
    """Write the corners (4, 2) of some squares of the lattice with a margin around them."""
    margin = 0.01 * side + 10.0 * TOLERANCE
    for k in range(4):
        hull[k, 0] = low[0] + (side * right + margin if k % 2 else side * left - margin)
        hull[k, 1] = low[1] + (side * top + margin if k // 2 else side * bottom - margin)


@allocation_free
def _is_clear(row, column, up, right, clear):
    """Whether a link to a neighbour lies in a clear square, or between two of which one is."""
    i, j = row + min(up, 0) + 1, column + min(right, 0) + 1
    return clear[i, j] or (up == 0 and clear[i - 1, j]) or (right == 0 and clear[i, j - 1])


@allocation_free
def _ahead(pose, target, radius, lattice, words):
    """An estimate of the length from a pose to the target."""
    straight = math.hypot(target[0] - pose[0], target[1] - pose[1])
    rows, columns = lattice.ahead.shape
    column = min(max(round((pose[0] - lattice.low[0]) / lattice.side), 0), columns - 1)
    row = min(max(round((pose[1] - lattice.low[1]) / lattice.side), 0), rows - 1)
    around = lattice.ahead[row, column]
    if around == np.inf:
        around = _DETOUR * straight
    words_between(pose, target, radius, words)
    turning = np.inf
    for k in range(WORDS):
        turning = min(turning, words[k, 7])
    return max(around, turning if turning < np.inf else straight)


@compiled
def _free_word(a, b, radius, most, blocked, words, pieces):
    """The shortest free one of the `most` shortest words between two poses: its number, -1 without
    one, and of how many pieces it is.
    """
    words_between(a, b, radius, words)
    for _ in range(most):
        best = 0
        for k in range(1, WORDS):
            if words[k, 7] < words[best, 7]:
                best = k
        if words[best, 7] == np.inf:
            break
        count = pieces_of(a, b, words[best], radius, pieces)
        if not collides(pieces[:count], blocked):
            return best, count
        words[best, 7] = np.inf
    return -1, 0


@compiled
def chain_of(poses, radius, most, blocked):
    """The pieces (n, 4, 2) of free words from pose to pose; none if one of them is missing."""
    words, pieces = np.empty((WORDS, 8)), np.empty((MOST_PIECES, 4, 2))
    chain = np.empty(((len(poses) - 1) * MOST_PIECES, 4, 2))
    total = 0
    for i in range(len(poses) - 1):
        word, count = _free_word(poses[i], poses[i + 1], radius, most, blocked, words, pieces)
        if word < 0:
            return chain[:0]
        for k in range(count):
            for j in range(4):
                chain[total, j, 0], chain[total, j, 1] = pieces[k, j, 0], pieces[k, j, 1]
            total += 1
    return chain[:total]


# --------------------------------------------------------------------------------------------------
# Hybrid A*


@compiled
def _search(ends, radius, step, lattice, most, blocked):
    """Poses (n, 3) from start to target, each reached from the one before by a step or a word, and
    the number of places driven on from.

    A place is known by the cell and the heading in which it lies, its exact pose is kept. None are
    found if the queue is empty or `most` places were driven on from.
    """
    start, target = ends[0], ends[1]
    headings = min(max(round(math.tau * radius / step), 8), _MOST_HEADINGS)
    room = 3 * most + headings + 1
    poses, came_from, length = np.empty((room, 3)), np.full(room, -1), np.zeros(room)
    words, pieces = np.empty((WORDS, 8)), np.empty((MOST_PIECES, 4, 2))
    word = np.zeros(8)
    nodes = {0: 0}
    nodes.clear()
    heap = [(0.0, 0)]
    heap.clear()
    count = 0
    for k in range(headings):
        free_heading = math.isnan(start[2])
        poses[count, 0], poses[count, 1] = start[0], start[1]
        poses[count, 2] = math.tau * k / headings if free_heading else start[2]
        nodes[_key(poses[count], step, headings)] = count
        heapq.heappush(heap, (_HASTE * _ahead(poses[count], target, radius, lattice, words), count))
        count += 1
        if not free_heading:
            break
    nearest = np.inf
    expanded = 0
    while len(heap) > 0 and expanded < most:
        _, node = heapq.heappop(heap)
        if nodes[_key(poses[node], step, headings)] != node:  # reached on a shorter way since
            continue
        expanded += 1
        ahead = _ahead(poses[node], target, radius, lattice, words)
        if ahead < nearest or expanded % _TRIED == 0:
            nearest = min(nearest, ahead)
            if _free_word(poses[node], target, radius, WORDS, blocked, words, pieces)[0] >= 0:
                way = _way(poses, came_from, node, 1)
                way[-1] = target
                return way, expanded
        for turn in range(-1, 2):
            pose = poses[count]
            _drive(poses[node], float(turn), step, radius, pose)
            key = _key(pose, step, headings)
            so_far = length[node] + step
            if key in nodes and length[nodes[key]] <= so_far:
                continue
            word[0], word[1], word[6] = turn, step, poses[node, 2]
            pieces_of(poses[node], pose, word, radius, pieces)
            if collides(pieces[:1], blocked):
                continue
            came_from[count], length[count] = node, so_far
            nodes[key] = count
            heapq.heappush(
                heap, (so_far + _HASTE * _ahead(pose, target, radius, lattice, words), count)
            )
            count += 1
    return poses[:0], expanded


@allocation_free
def _drive(pose, turn, step, radius, reached):
    """The pose that is reached from another by an arc or a straight line."""
    heading = pose[2] + turn * step / radius
    if turn == 0.0:
        reached[0] = pose[0] + step * math.cos(heading)
        reached[1] = pose[1] + step * math.sin(heading)
    else:
        reached[0] = pose[0] + turn * radius * (math.sin(heading) - math.sin(pose[2]))
        reached[1] = pose[1] - turn * radius * (math.cos(heading) - math.cos(pose[2]))
    reached[2] = heading


@allocation_free
def _key(pose, step, headings):
    """The number of a pose's cell and heading; unique up to a million steps from the origin."""
    side = _CELL * step
    column, row = math.floor(pose[0] / side), math.floor(pose[1] / side)
    heading = round(pose[2] / math.tau * headings) % headings
    return ((row + (1 << 24)) * (1 << 25) + column + (1 << 24)) * _MOST_HEADINGS + heading


@compiled
def _way(poses, came_from, last, room):
    """The poses (n, 3) from start to a node, and room for so many more."""
    count = 0
    node = last
    while node >= 0:
        count += 1
        node = came_from[node]
    way = np.empty((count + room, 3))
    node = last
    for k in range(count - 1, -1, -1):
        way[k] = poses[node]
        node = came_from[node]
    return way


# --------------------------------------------------------------------------------------------------
# Pulling tight


def _pulled_tight(
    poses: np.ndarray, ends: np.ndarray, radius: float, blocked: Region
) -> np.ndarray:
    """The pieces of a path along some poses (n, 3), pulled tight; none without poses.

    ends: (2, 3) as they were asked for. Where the heading at the start is free, the words from
    there may be others than those that the search drove, and not free: then it is that of the
    search.
    """
    best = np.empty((0, 4, 2))
    if not len(poses):
        return best
    for first in (ends[0], poses[0]):
        poses = np.vstack([first, poses[1:]])
        best = chain_of(poses, radius, WORDS, blocked)
        if len(best):
            return _tighter(best, poses, radius, blocked)
    return best


def _tighter(best: np.ndarray, poses: np.ndarray, radius: float, blocked: Region) -> np.ndarray:
    """The pieces of a path pulled tight between poses (n, 3) along it while it gets shorter."""
    length = _length(best)
    for _ in range(_ROUNDS):
        few = _shortcut(poses, radius, blocked)
        if not len(few):
            break
        _move(few, radius, blocked)
        pieces = chain_of(few, radius, WORDS, blocked)
        gain = length - _length(pieces)
        if gain > 0:
            best, length = pieces, length - gain
        if gain <= _LEAST_GAIN * length:
            break
        poses = _places(best, poses[[0, -1]])
    return best


def _length(pieces: np.ndarray) -> float:
    points = np.concatenate([pieces[0, :1], pieces[:, 1:].reshape(-1, 2)])
    return curves.length(Path("cubic_chain", points))


def _places(pieces: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Poses (n, 3) along the pieces of a path, between its ends: the joints, and between them as
    many on each as there is room for.
    """
    parts = max(1, _MOST_PLACES // len(pieces))
    t = np.arange(parts) / parts
    basis, slope = curves.bernstein(3, t), curves.bernstein(2, t)
    points = np.einsum("sk,nkd->nsd", basis, pieces).reshape(-1, 2)
    along = np.einsum("sk,nkd->nsd", slope, np.diff(pieces, axis=1)).reshape(-1, 2)
    inner = np.column_stack([points, np.arctan2(along[:, 1], along[:, 0])])[1:]
    return np.vstack([ends[0], inner, ends[1]])


@compiled
def _shortcut(poses, radius, blocked):
    """Those of poses (n, 3) along a path with the shortest chain of free words, if there is one."""
    words, pieces = np.empty((WORDS, 8)), np.empty((MOST_PIECES, 4, 2))
    count = len(poses)
    length, came_from = np.full(count, np.inf), np.full(count, -1)
    length[0] = 0.0
    for j in range(1, count):
        unseen = 0
        for i in range(j - 1, -1, -1):
            if length[i] < length[j]:
                word = _free_word(
                    poses[i], poses[j], radius, WORDS if i == j - 1 else 1, blocked, words, pieces
                )[0]
                unseen = unseen + 1 if word < 0 else 0
                if word >= 0 and length[i] + words[word, 7] < length[j]:
                    length[j], came_from[j] = length[i] + words[word, 7], i
            if unseen == _OUT_OF_SIGHT:
                break
    if length[-1] == np.inf:
        return poses[:0]
    return _way(poses, came_from, count - 1, 0)


@compiled
def _move(poses, radius, blocked):
    """Move and turn each pose (n, 3) between the ends while its words get shorter and are free."""
    words, pieces, before = np.empty((WORDS, 8)), np.empty((MOST_PIECES, 4, 2)), np.empty(3)
    share = 1.0
    for _ in range(_HALVINGS):
        for i in range(1, len(poses) - 1):
            shortest = _through(poses, i, radius, blocked, words, pieces, np.inf)
            for k in range(6):
                for c in range(3):
                    before[c] = poses[i, c]
                size = share * (_TURNED if k >= 4 else _MOVED * radius)
                poses[i, k // 2] += size if k % 2 == 0 else -size
                length = _through(poses, i, radius, blocked, words, pieces, shortest)
                if length < shortest:
                    shortest = length
                else:
                    for c in range(3):
                        poses[i, c] = before[c]
        share *= 0.5


@compiled
def _through(poses, i, radius, blocked, words, pieces, limit):
    """Length of the shortest free words to a pose and from it; infinite if not below a limit."""
    total = 0.0
    for k in range(i - 1, i + 1):
        words_between(poses[k], poses[k + 1], radius, words)
        shortest = np.inf
        for w in range(WORDS):
            shortest = min(shortest, words[w, 7])
        total += shortest
    if total >= limit:
        return np.inf
    total = 0.0
    for k in range(i - 1, i + 1):
        word = _free_word(
            poses[k], poses[k + 1], radius, 1 if limit < np.inf else WORDS, blocked, words, pieces
        )[0]
        if word < 0:
            return np.inf
        total += words[word, 7]
    return total
