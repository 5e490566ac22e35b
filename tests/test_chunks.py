"""From a study to its jobs and results: every repeat is run, and read once; which experiments are compared pair by pair."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from studies import studies

from bezierplan.analysis import results
from bezierplan.running import problems
from bezierplan.study import definition, jobs, targets
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


def behind(given, scale):
    """The runs behind the tables and figures of a scale and those that it names, as (study, experiment, method)."""
    shown = (
        jobs.smoke(given)[0] if scale == "smoke" else [(key, name) for key, own in given.items() for name in [*own.tables, *own.figures]]
    )
    files = targets.files_of_smoke(given) if scale == "smoke" else []
    for key, name in shown:
        kind = "table" if name in given[key].tables else "figure"
        files += targets.artefact_inputs(given, scale, key, **{kind: name})["runs"]
    return {(place[2], place[4], place[5]) for place in (Path(file).parts for file in files) if place[3] == "runs"}


@pytest.mark.parametrize("scale", ["smoke", "full"])
def test_each_planner_has_one_leader_among_the_runs_of_a_scale(scale):
    given = studies()
    leaders, made = jobs.leaders(given, scale), behind(given, scale)
    planners = [given[key].planner(method) for key, _, method in leaders]
    assert sorted(planners) == sorted({given[key].planner(method) for key, _, method in made})
    assert leaders.keys() <= made
    for key in given:
        places = [place for (own, *_), place in leaders.items() if own == key]
        assert places == list(range(len(places)))


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
