"""Tours: the order of way points in which the exact shortest path through all is shortest."""

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.running import legs
from bezierplan.running.problems import Placed, Regions

ORDERS = ("given", "shortest")
"""Orders of way points: as they are given, or the one of the shortest path through all."""

MOST_POINTS = 12
"""Most way points that are ordered: time and memory double with each."""


def check_order(order: str, via: Sequence[tuple[float, float]]) -> None:
    """Raise ValueError for an order that is unknown, does nothing, or takes too long to find."""
    if order not in ORDERS:
        raise ValueError(f"via_order: {order!r}; expected {' or '.join(ORDERS)}")
    if order == "shortest" and not via:
        raise ValueError("via_order: shortest: there are no way points; expected some (via)")
    if order == "shortest" and len(via) > MOST_POINTS:
        raise ValueError(
            f"via_order: shortest: {len(via)} way points; expected at most {MOST_POINTS}, or "
            f"via_order given"
        )


def ordered(
    order: str, problem: Placed, via: Sequence[tuple[float, float]], regions: Regions
) -> list[tuple[float, float]]:
    """Way points, in the world, in the order in which a path passes them.

    Raises ValueError for one that is not free.
    """
    if order == "given" or len(via) < 2:
        return list(via)
    ends = [part.start for part in legs.legs(problem, via, regions)]
    whole = legs.legs(problem, (), regions)[0]
    places, blocked = [*ends, whole.target], regions(problem.near.workspace)
    lengths = np.zeros((len(places), len(places)))
    for one, other in combinations(range(len(places)), 2):
        part = whole._replace(start=places[one], target=places[other])
        length = shortest_paths.shortest_path(part, blocked=blocked).length
        lengths[one, other] = lengths[other, one] = length
    return [via[point - 1] for point in shortest_order(lengths)]


def shortest_order(lengths: np.ndarray) -> list[int]:
    """The order of the places 1 to n - 2 on the shortest tour from place 0 to place n - 1.

    lengths: (n, n) from place to place. By dynamic programming over subsets (Held and Karp); of
    orders that are equally long, one that is the same every time.

    >>> line = np.array([0.0, 3.0, 1.0, 2.0, 4.0])
    >>> shortest_order(np.abs(line[:, None] - line))
    [2, 3, 1]
    """
    count = len(lengths) - 2
    between = lengths[1:-1, 1:-1]
    # least[visited, last]: length of the shortest way through a set of points that ends at one.
    least = np.full((1 << count, count), math.inf)
    before = np.zeros((1 << count, count), dtype=int)
    for visited in range(1, 1 << count):
        for last in range(count):
            rest = visited & ~(1 << last)
            if rest == visited:
                continue
            if rest == 0:
                least[visited, last] = lengths[0, 1 + last]
                continue
            # Only places of the rest: where none can be reached, all ways are equally endless.
            members = [place for place in range(count) if rest >> place & 1]
            ways = least[rest, members] + between[members, last]
            before[visited, last] = members[ways.argmin()]
            least[visited, last] = ways.min()
    visited = (1 << count) - 1
    last = int((least[visited] + lengths[1:-1, -1]).argmin())
    order = []
    while visited:
        order.append(last + 1)
        visited, last = visited & ~(1 << last), int(before[visited, last])
    return order[::-1]
