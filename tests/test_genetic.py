"""Genetic operators: distributions against their formulas, and what no operator may do."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from bezierplan.planners.parts.genetic import (
    flip_bit,
    redraw_gene,
)


def test_redrawn_genes_are_uniform_over_genes_and_alleles():
    rng, alleles, counts = np.random.default_rng(0), np.array([7, 9, 300]), np.zeros((4, 3))
    for _ in range(6000):
        chromosome = np.full(4, -1)
        redraw_gene(rng, chromosome, alleles)
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
