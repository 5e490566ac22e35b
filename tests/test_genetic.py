"""Genetic operators: distributions against their formulas, and what no operator may do."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from bezierplan.planners.parts.genetic import (
    change_gene,
    complement_bit,
    draw_parents,
    flip_bit,
    swap_tails,
)

BITS = 8
chromosomes = st.lists(st.integers(0, 255), min_size=6, max_size=6).map(
    lambda genes: np.array(genes, dtype=np.int64)
)


def bits_of(chromosome):
    return "".join(f"{gene:08b}" for gene in chromosome)


@given(chromosomes, chromosomes, st.integers(1, 6 * BITS - 1))
def test_crossover_swaps_exactly_the_bits_behind_the_cut(one, other, cut):
    a, b = bits_of(one), bits_of(other)
    swap_tails(one, other, cut, BITS)
    assert bits_of(one) == a[:cut] + b[cut:]
    assert bits_of(other) == b[:cut] + a[cut:]


@given(chromosomes, st.integers(0, 6 * BITS - 1))
def test_mutation_complements_exactly_one_bit(chromosome, position):
    before = bits_of(chromosome)
    complement_bit(chromosome, position, BITS)
    after = bits_of(chromosome)
    assert [i for i in range(len(before)) if before[i] != after[i]] == [position]


def test_roulette_draws_in_proportion_to_fitness():
    fitness = np.array([1.0, 2.0, 3.0, 4.0])
    drawn = draw_parents(np.random.default_rng(0), fitness, 100_000)
    assert stats.chisquare(np.bincount(drawn), 100_000 * fitness / fitness.sum()).pvalue > 1e-3


def test_redrawn_genes_are_uniform_over_genes_and_alleles():
    rng, alleles, counts = np.random.default_rng(0), np.array([7, 9, 300]), np.zeros((4, 3))
    for _ in range(6000):
        chromosome = np.full(4, -1)
        change_gene(rng, chromosome, 9, alleles, np.ones(512, dtype=bool), False)
        (gene,) = np.flatnonzero(chromosome != -1)
        counts[gene] += alleles == chromosome[gene]
    assert stats.chisquare(counts.ravel()).pvalue > 1e-3


@given(st.integers(0, 10_000))
def test_a_flip_changes_one_bit_or_nothing(seed):
    rng = np.random.default_rng(seed)
    legal = rng.random(512) < 0.1
    genes = rng.choice(np.flatnonzero(legal), 4)
    before = genes.copy()
    flip_bit(rng, genes, 2, 9, legal)
    assert legal[genes].all()
    assert np.array_equal(np.delete(genes, 2), np.delete(before, 2))
    assert int(genes[2] ^ before[2]).bit_count() <= 1


def test_a_gene_without_a_legal_neighbour_stays():
    legal = np.zeros(512, dtype=bool)
    legal[5] = True
    genes = np.array([5])
    flip_bit(np.random.default_rng(0), genes, 0, 9, legal)
    assert genes.tolist() == [5]
