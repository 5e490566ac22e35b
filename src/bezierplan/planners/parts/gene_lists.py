"""Chromosomes of many genes, few of which are 1, stored as ascending lists; and pools of these.

Functions that change a list or a pool say so; no function keeps state.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compiled
from bezierplan.planners.parts.diversity import q_statistic, shared
from bezierplan.planners.parts.genetic import same
from bezierplan.planners.parts.sorting import sort


class Pool(NamedTuple):
    """Chromosomes: ones (places, room) the genes that are 1, ascending; count (places,) how many;
    cost (places,) the inverse of the fitness.
    """

    ones: np.ndarray
    count: np.ndarray
    cost: np.ndarray


@compiled
def empty_pool(places: int, room: int) -> Pool:
    """A pool with room for `places` chromosomes of `room` genes each."""
    return Pool(np.empty((places, room), np.int64), np.zeros(places, np.int64), np.empty(places))


@allocation_free
def put(ones: np.ndarray, count: int, cost: float, pool: Pool, place: int) -> None:
    """Write a chromosome to a place of the pool, in place."""
    for k in range(count):
        pool.ones[place, k] = ones[k]
    pool.count[place], pool.cost[place] = count, cost


@compiled
def select(pool: Pool, survivors: int, fill: int) -> None:
    """Move the best of the first chromosomes to the front, in place; ties in their order."""
    highest = pool.cost[:survivors].max()
    # Some that cost no more are enough, so the others need no sorting.
    order, count = np.empty(fill, dtype=np.int64), 0
    for i in range(fill):
        order[count] = i
        count += pool.cost[i] <= highest
    sort(order[:count], pool.cost)
    best, most = order[:survivors], pool.count.max()
    pool.ones[:survivors, :most] = pool.ones[best, :most]
    pool.count[:survivors] = pool.count[best]
    pool.cost[:survivors] = pool.cost[best]


@allocation_free
def position(genes: np.ndarray, count: int, gene: int) -> int:
    """Index of a gene among the first `count` of a list, `count` if it is not there."""
    for i in range(count):
        if genes[i] == gene:
            return i
    return count


@allocation_free
def flip(genes: np.ndarray, count: int, gene: int) -> int:
    """Flip a gene of a list, in place; returns how many are 1. Genes that do not fit are lost."""
    index = position(genes, count, gene)
    if index < count:
        for i in range(index, count - 1):
            genes[i] = genes[i + 1]
        return count - 1
    if count == len(genes):
        return count
    index = count
    while index > 0 and genes[index - 1] > gene:
        genes[index] = genes[index - 1]
        index -= 1
    genes[index] = gene
    return count + 1


@allocation_free
def gap(rng: np.random.Generator, log_stay: float) -> int:
    """Number of genes left unchanged before the next change; 2**31 stands for more than there are
    genes. log_stay: the logarithm of the probability that a gene does not change.
    """
    if log_stay == 0.0:
        return 2**31
    return int(min(math.log(1.0 - rng.random()) / log_stay, 2.0**31)) if log_stay > -np.inf else 0


@allocation_free
def cross(pool: Pool, head: int, tail: int, cut: int, child: np.ndarray) -> int:
    """Write, to a child, the genes of one chromosome before a cut and of another from it on;
    returns how many are 1.
    """
    count = 0
    for i in range(pool.count[head]):
        if pool.ones[head, i] < cut:
            child[count] = pool.ones[head, i]
            count += 1
    for i in range(pool.count[tail]):
        if pool.ones[tail, i] >= cut:
            child[count] = pool.ones[tail, i]
            count += 1
    return count


@compiled
def kinds_of(pool: Pool, size: int) -> tuple[int, np.ndarray, np.ndarray]:
    """Number of distinct chromosomes among the first `size` of the pool, a place of each of them
    (size,), and for each place (size,) which of them is there.
    """
    kind, heads, kinds = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64), 0
    for i in range(size):
        k = kinds - 1
        while k >= 0:
            head = heads[k]  # equal chromosomes have equal costs
            if pool.cost[i] == pool.cost[head] and same(
                pool.ones[i, : pool.count[i]], pool.ones[head, : pool.count[head]]
            ):
                break
            k -= 1
        if k < 0:
            k = kinds
            heads[kinds] = i
            kinds += 1
        kind[i] = k
    return kinds, heads, kind


@allocation_free
def q(one: np.ndarray, other: np.ndarray, genes: int) -> float:
    """The Q statistic of the lists of two chromosomes of `genes` genes."""
    both = shared(one, other)
    return q_statistic(
        both, genes - len(one) - len(other) + both, len(one) - both, len(other) - both
    )


@compiled
def sum_of_q(pool: Pool, first: int, fill: int, genes: int) -> float:
    """Sum of Q over the pairs of chromosomes in the pool, the second of which is at a place from
    `first` on.

    A pool holds many copies, so Q is computed once for each pair of distinct chromosomes; the sum
    is made in the order of the places.
    """
    kinds, heads, kind = kinds_of(pool, fill)
    values, marked = np.empty((kinds, kinds)), np.zeros(genes, dtype=np.int64)
    for k in range(kinds):
        chromosome = heads[k]
        for gene in pool.ones[chromosome, : pool.count[chromosome]]:
            marked[gene] = 1
        for m in range(k + 1):
            other, both = heads[m], 0
            for n in range(pool.count[other]):
                both += marked[pool.ones[other, n]]
            only_one, only_other = pool.count[chromosome] - both, pool.count[other] - both
            values[k, m] = values[m, k] = q_statistic(
                both, genes - both - only_one - only_other, only_one, only_other
            )
        for gene in pool.ones[chromosome, : pool.count[chromosome]]:
            marked[gene] = 0
    total = 0.0
    for j in range(max(first, 1), fill):
        row = values[kind[j]]
        for i in range(j):
            total += row[kind[i]]
    return total


# Entries of a memory of chromosomes.
_REMEMBERED = 1024


@compiled
def empty_memory(room: int) -> Pool:
    """A memory of the costs of chromosomes of `room` genes each; newer ones replace older ones."""
    memory = empty_pool(_REMEMBERED, room)
    memory.count[:] = -1
    return memory


@allocation_free
def entry(ones: np.ndarray, memory: Pool) -> tuple[int, bool]:
    """The place of a chromosome in a memory, and whether it is there."""
    mixed = np.uint64(len(ones))
    for gene in ones:
        mixed = (mixed ^ np.uint64(gene)) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    place = np.int64(mixed & np.uint64(_REMEMBERED - 1))
    return place, memory.count[place] == len(ones) and same(
        ones, memory.ones[place, : memory.count[place]]
    )
