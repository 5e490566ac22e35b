"""The genetic algorithm over the lattice: both codings, and their first populations."""

import itertools
import math

import numpy as np
import pytest
from test_lattice_planners import environment, plan

from bezierplan.planners import lattice_genetic
from bezierplan.planners.parts import cell_paths
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.lattice import lattice
from bezierplan.workspaces.problem import Problem

OPEN = Problem("test", Grid(np.zeros((8, 8), dtype=bool), 1.0, "unit"), (0.0, 0.0), (8.0, 8.0))


def test_without_a_gene_start_and_target_are_joined():
    found = plan("ga", OPEN, genes=0, generations=3)
    assert found.objective == pytest.approx(8 * math.sqrt(2))
    assert (found.history == found.history[0]).all()


def test_genes_sorted_along_the_way_give_shorter_first_paths():
    first = {
        name: np.mean([plan(name, seed=seed, generations=0).objective for seed in range(10)])
        for name in ("ga", "ga_sorted")
    }
    assert first["ga_sorted"] < first["ga"] - 5


@pytest.mark.parametrize("mutation", ["cell", "bit_flip"])
def test_mutation_draws_a_cell_or_flips_a_bit(mutation):
    """Of one gene, to a free cell: any of them, or those whose number differs in one bit."""
    free = np.array([1, 2, 3, 7, 12])
    legal = np.isin(np.arange(16), free)
    found = set()
    for seed in range(200):
        genes = np.array([3, 3, 3])
        lattice_genetic._mutate(
            np.random.default_rng(seed), genes, 4, free, legal, lattice_genetic.Mutation[mutation]
        )
        changed = np.flatnonzero(genes != 3)
        assert len(changed) <= 1
        found |= {(gene, int(genes[gene])) for gene in changed.tolist()}
    others = {1, 2, 7} if mutation == "bit_flip" else {1, 2, 7, 12}
    assert found == {(gene, cell) for gene in range(3) for cell in others}


def test_without_the_best_kept_it_may_be_lost_but_not_forgotten():
    kept, lost = plan("ga", seed=3), plan("ga", seed=3, elitism=0)
    assert (np.diff(lost.history) <= 0).all()
    assert kept.history[0] == lost.history[0]
    assert not np.array_equal(kept.history, lost.history)


def test_a_join_that_no_path_fits_in_finds_none():
    assert plan("ga", longest_join=20).path is None
    assert plan("ga_rows", longest_join=20).path is None


@pytest.mark.parametrize("ends", [((0.0, 0.0), (20.0, 20.0)), ((20.0, 20.0), (0.0, 0.0))])
def test_first_paths_by_rows_are_paths_from_start_to_target(ends):
    places = lattice(environment(2).workspace, *ends, "one")
    paths, sizes = lattice_genetic._first_paths(np.random.default_rng(0), places, 20, 600)
    for path, size in zip(paths, sizes, strict=True):
        assert (path[0], path[size - 1]) == (places.start, places.target)
        assert all(
            cell_paths.step_between(places, *pair) >= 0 for pair in itertools.pairwise(path[:size])
        )
        assert set(places.row[path[:size]].tolist()) == set(range(20))


def test_a_row_without_a_free_cell_has_no_path():
    grid = from_lines(["....", "####", "...."], 1.0, "unit")
    found = plan("ga_rows", Problem("test", grid, (0.0, 0.0), (4.0, 3.0)))
    assert found.path is None
    assert found.history.tolist() == [math.inf]
