"""From a study to its jobs and results: every repeat is run, and read once; which experiments are compared pair by pair."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from studies import study

from bezierplan.analysis import results
from bezierplan.running import problems
from bezierplan.study import definition, jobs
from bezierplan.study.experiments import Experiment
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem


def experiment(repeats, chunk, **others):
    return Experiment(
        problems=["across"],
        methods=["mine"],
        **{key: dict.fromkeys(("smoke", "full", "extended"), number) for key, number in (("repeats", repeats), ("chunk", chunk))},
        **others,
    )


@pytest.mark.parametrize(("repeats", "chunk", "count"), [(10, 4, 3), (8, 4, 2), (1, 4, 1), (9, 3, 3), (100, 1, 100), (4, 5, 1)])
def test_chunks_hold_all_repeats_and_no_chunk_more(repeats, chunk, count):
    empty = {field.name: {} for field in fields(definition.Study)} | {"key": "s", "folder": Path(), "title": "A study", "claims": []}
    own = definition.Study(**empty | {"experiments": {"first": experiment(repeats, chunk)}})
    assert list(jobs.chunks(own, "first", "full")) == list(range(count))


@pytest.mark.parametrize("key", ["song2016", "elhoseny2017"])
def test_chunks_of_a_planner_are_counted_over_methods_and_experiments(key):
    own = study(key)
    counted = {}
    for (experiment, method, chunk), before in jobs.turns(own, "full").items():
        assert method in own.methods_of(experiment)
        assert chunk in jobs.chunks(own, experiment, "full")
        counted.setdefault(own.methods[method].planner, []).append(before)
    assert all(found == list(range(len(found))) for found in counted.values())
    expected = sum(len(own.methods_of(name)) * len(jobs.chunks(own, name, "full")) for name in own.experiments)
    assert sum(map(len, counted.values())) == expected


@pytest.mark.parametrize(
    ("seeds", "paired"), [({}, False), ({"seeds": "own"}, False), ({"seeds": "shared"}, True), ({"seeds": "common"}, True)]
)
def test_runs_are_pairs_where_methods_share_their_random_numbers(seeds, paired):
    """Runs of two methods with seeds of their own have nothing to do with each other."""
    assert experiment(10, 5, **seeds).paired == paired


def test_results_are_cut_at_the_number_of_repeats(tmp_path):
    """Two chunks of four repeats; six are asked for, and whole chunks were run."""
    grid = from_lines(["..", ".."], 1.0, "m")
    described = {"across": Problem("across", grid, (0.5, 0.5), (1.5, 1.5))}
    problems.write(described, {"across": "square"}, str(tmp_path / "problems.parquet"))
    parquet.write_table(problems.bounds_of(described), tmp_path / "bounds.parquet")
    files = []
    for chunk in range(2):
        repeats = np.arange(4 * chunk, 4 * chunk + 4)
        runs = pd.DataFrame({"id": [f"r{n}" for n in repeats], "problem": "across", "repeat": repeats, "length": 2.0, "feasible": True})
        times = pd.DataFrame({"id": runs["id"], "cpu_s": repeats / 100, "wall_s": repeats / 50})
        files.append(str(tmp_path / f"{chunk}.parquet"))
        parquet.write_table(pa.Table.from_pandas(runs), files[-1])
        parquet.write_table(pa.Table.from_pandas(times[::-1]), tmp_path / f"{chunk}.times.parquet")
    found = results.read(files, 6, str(tmp_path / "problems.parquet"), str(tmp_path / "bounds.parquet")).runs
    assert found["repeat"].to_list() == [0, 1, 2, 3, 4, 5]
    assert found["cpu_s"].to_list() == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert found["bound"].to_numpy() == pytest.approx(np.sqrt(2))
