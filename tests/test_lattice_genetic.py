"""The genetic algorithm over the lattice: both codings, and their first populations."""

import math

import numpy as np
import pytest
from test_lattice_planners import plan

from bezierplan.workspaces.grid import Grid, from_lines
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


def test_without_the_best_kept_it_may_be_lost_but_not_forgotten():
    kept, lost = plan("ga", seed=3), plan("ga", seed=3, elitism=0)
    assert (np.diff(lost.history) <= 0).all()
    assert kept.history[0] == lost.history[0]
    assert not np.array_equal(kept.history, lost.history)


def test_a_join_that_no_path_fits_in_finds_none():
    assert plan("ga", longest_join=20).path is None
    assert plan("ga_rows", longest_join=20).path is None


def test_a_row_without_a_free_cell_has_no_path():
    grid = from_lines(["....", "####", "...."], 1.0, "unit")
    found = plan("ga_rows", Problem("test", grid, (0.0, 0.0), (4.0, 3.0)))
    assert found.path is None
    assert found.history.tolist() == [math.inf]
