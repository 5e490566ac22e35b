"""Chromosomes of many genes, few of which are 1, stored as ascending lists; and pools of these.

Functions that change a list or a pool say so; no function keeps state.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners.parts.diversity import compute_q_statistic
from bezierplan.planners.parts.genetic import copy, is_same
from bezierplan.planners.parts.sorting import find_largest, sort


class Pool(NamedTuple):
    """Chromosomes of a population and its offspring.

    ones: (places, room) the genes that are 1, ascending.
    count: (places,) how many there are.
    cost: (places,) the inverse of the fitness.
    """

    ones: np.ndarray
    count: np.ndarray
    cost: np.ndarray


@compile_kernel
def prepare_pool(places: int, room: int) -> Pool:
    """Return a pool with room for `places` chromosomes of `room` genes each."""
    return Pool(np.empty((places, room), np.int64), np.zeros(places, np.int64), np.empty(places))


@allocation_free
def put(ones: np.ndarray, count: int, cost: float, pool: Pool, place: int) -> None:
    """Write a chromosome to a place of the pool, in place."""
    for k in range(count):
        pool.ones[place, k] = ones[k]
    pool.count[place], pool.cost[place] = count, cost


@compile_kernel
def select(pool: Pool, survivors: int, fill: int) -> None:
    """Move the best of the first `fill` chromosomes to the front, in place; ties in their order."""
    highest = find_largest(pool.cost[:survivors])
    # Some that cost no more are enough, so the others need no sorting.
    order, count = np.empty(fill, np.int64), 0
    for i in range(fill):
        order[count] = i
        count += pool.cost[i] <= highest
    sort(order[:count], pool.cost)
    best = order[:survivors]
    # No list is longer than the longest, so the rest of the room need not be copied.
    ones = pool.ones[best, : find_largest(pool.count)]
    for k in range(survivors):
        copy(ones[k], pool.ones[k])
    copy(pool.count[best], pool.count)
    copy(pool.cost[best], pool.cost)


@allocation_free
def place_of(genes: np.ndarray, count: int, gene: int) -> int:
    """Return the place among the first `count` of a list at which a gene stands, or belongs."""
    place = count
    while place > 0 and genes[place - 1] >= gene:
        place -= 1
    return place


@allocation_free
def insert(genes: np.ndarray, count: int, at: int, gene: int) -> int:
    """Insert a gene into a list, in place, and return how many are 1.

    A gene that does not fit is lost.
    """
    if count == len(genes):
        return count
    for i in range(count, at, -1):
        genes[i] = genes[i - 1]
    genes[at] = gene
    return count + 1


@allocation_free
def flip(genes: np.ndarray, count: int, gene: int) -> int:
    """Flip a gene of a list, in place, and return how many are 1."""
    place = place_of(genes, count, gene)
    if place == count or genes[place] != gene:
        return insert(genes, count, place, gene)
    for i in range(place, count - 1):
        genes[i] = genes[i + 1]
    return count - 1


@allocation_free
def draw_gap(rng: np.random.Generator, log_stay: float) -> int:
    """Draw how many genes stay unchanged before the next change; 2**31 is more than there are
    genes.

    log_stay: the logarithm of the probability that a gene does not change.
    """
    if log_stay == 0.0:
        return 2**31
    # The gaps of independent trials have a geometric distribution; 1 - random() is never 0.
    return int(min(math.log(1.0 - rng.random()) / log_stay, 2.0**31)) if log_stay > -np.inf else 0


@allocation_free
def cross(pool: Pool, head: int, tail: int, cut: int, index: np.ndarray, child: np.ndarray) -> int:
    """Write, to a child, the genes of one chromosome before a cut and of another from it on.

    index: (genes,) the place on the lattice that is compared with the cut.

    Returns how many are 1.
    """
    i = j = count = 0
    while i < pool.count[head] or j < pool.count[tail]:
        from_head = j == pool.count[tail] or (
            i < pool.count[head] and pool.ones[head, i] < pool.ones[tail, j]
        )
        gene = pool.ones[head, i] if from_head else pool.ones[tail, j]
        i += from_head
        j += not from_head
        if (index[gene] < cut) == from_head:
            child[count] = gene
            count += 1
    return count


@allocation_free
def compute_q(both: int, one: int, other: int, genes: int) -> float:
    """Return the Q statistic of two chromosomes of `genes` genes: numbers of those that are 1 in
    both, in one and in the other.
    """
    return compute_q_statistic(both, genes - one - other + both, one - both, other - both)


class Kinds(NamedTuple):
    """Distinct chromosomes of a pool in which many are alike.

    head: (places,) a place of each in the pool.
    copies: (places,) how many there are.
    q: (places, places) the Q of each with those before it.
    marks: (genes,) scratch, all 0 before and after.
    """

    head: np.ndarray
    copies: np.ndarray
    q: np.ndarray
    marks: np.ndarray


@allocation_free
def count_kinds(pool: Pool, first: int, fill: int, count: int, kinds: Kinds) -> int:
    """Count the chromosomes at the places from `first` on among `count` kinds, and return how many
    kinds there are then.
    """
    # Kinds stand in the order of their first chromosomes, so sums over them have the same bits
    # whether a pool is counted at once or batch by batch.
    for place in range(first, fill):
        kind = 0
        while kind < count and not _is_kind(pool, place, kinds.head[kind]):
            kind += 1
        if kind == count:
            _add_kind(pool, place, count, kinds)
            count += 1
        kinds.copies[kind] += 1.0
    return count


@allocation_free
def compute_mean_q(kinds: Kinds, count: int, fill: int) -> float:
    """Return the mean Q of all pairs of `fill` chromosomes of `count` kinds.

    Two equal ones have Q = 1.
    """
    total = 0.0
    for kind in range(count):
        # A kind of c copies has c (c - 1) / 2 pairs of its own; c is a factor of all its pairs.
        others = 0.5 * (kinds.copies[kind] - 1.0)
        for other in range(kind):
            others += kinds.copies[other] * kinds.q[kind, other]
        total += kinds.copies[kind] * others
    return total / (fill * (fill - 1) / 2)


@allocation_free
def _is_kind(pool, place, head):
    """Tell whether two places hold equal chromosomes, whose costs are then equal."""
    # Costs first: one comparison tells most different chromosomes apart.
    return pool.cost[place] == pool.cost[head] and is_same(
        pool.ones[place, : pool.count[place]], pool.ones[head, : pool.count[head]]
    )


@allocation_free
def _add_kind(pool, place, kind, kinds):
    """Add the chromosome at a place of the pool as a new kind, with its Q with each kind before it;
    its copies start at 0, and the caller counts this one.
    """
    kinds.head[kind], kinds.copies[kind] = place, 0.0
    ones, genes = pool.ones[place, : pool.count[place]], len(kinds.marks)
    for gene in ones:
        kinds.marks[gene] = 1
    for other in range(kind):
        head, both = kinds.head[other], 0
        for k in range(pool.count[head]):
            both += kinds.marks[pool.ones[head, k]]
        kinds.q[kind, other] = compute_q(both, len(ones), pool.count[head], genes)
    for gene in ones:
        kinds.marks[gene] = 0


# Entries of a memory of chromosomes, a pool in which each has a place of its own: a newer one
# replaces an older one. A power of 2, whose last bits are those of a hash.
REMEMBERED = 1024


@allocation_free
def find_entry(ones: np.ndarray, memory: Pool) -> tuple[int, bool]:
    """Return the place of a chromosome in a memory, and whether it is there."""
    # A hash; the odd factor is 2**64 over the golden ratio, which spreads neighbouring numbers.
    mixed = np.uint64(len(ones))
    for gene in ones:
        mixed = (mixed ^ np.uint64(gene)) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    place = np.int64(mixed & np.uint64(REMEMBERED - 1))
    return place, memory.count[place] == len(ones) and is_same(
        ones, memory.ones[place, : memory.count[place]]
    )
