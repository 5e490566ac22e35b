"""Stored runs judged again (`recheck`): sound ones pass, and every edit of them is named."""

import re
import shutil
from collections.abc import Callable

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from chunks import CHUNK, MADE

from bezierplan.running import execution, problems, recheck, table_files
from bezierplan.running.simulation.policy import Policy
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles


def edited(file, column, change):
    """Change each value of a column of a file; with a digest like an honest file."""
    table = parquet.read_table(file)
    place = table.column_names.index(column)
    values = pa.array([*map(change, table[column].to_pylist())], table.schema.field(column).type)
    table_files.write(table.set_column(place, column, values), str(file))


FIELD = (0.0, 10.0, 0.0, 10.0)
OPEN, SHUT = (
    from_lines([".........", ".........", row, row, "........."], 1.0, "m")
    for row in (".........", "....#....")
)
WAY = (0.5, 2.5), (8.5, 2.5)
# A robot evades a circle at twice the pace, plans round a gate that shuts, is hit by one that shuts
# on it, and does not arrive.
WORLDS = {
    "circles": MovingCircles(
        FIELD,
        FIELD,
        np.array([[5.0, 8.0]]),
        np.array([[0.0, 0.1]]),
        np.array([1.0]),
        "circles",
        2.0,
        60,
        "m",
    ),
    "cells": ChangingCells((OPEN, SHUT), np.array([2.5]), 1.0, 60),
    "hit": ChangingCells((OPEN, SHUT), np.array([4.0]), 1.0, 60),
    "late": ChangingCells((OPEN, SHUT), np.array([2.5]), 1.0, 4),
}
MET = {name: Problem(name, world.workspace(0), *WAY) for name, world in WORLDS.items()}
POLICY = Policy(replan="when_changed", waits=False, brake=1.0, horizon=2.0, spacing=0.1)
DRIVES = CHUNK._replace(
    experiment="d",
    planner="shortest_path",
    problems={name: {"workspace": "field"} for name in MET},
    policy=POLICY.model_dump(),
)


@pytest.fixture(scope="module")
def tasks(tmp_path_factory):
    """What is to be judged: runs and drives."""
    folder = tmp_path_factory.mktemp("files")
    files = {name: str(folder / f"{name}.parquet") for name in ("e", "d")}
    problems.write(MADE, dict.fromkeys(MADE, "field"), files["e"])
    problems.write(MET, dict.fromkeys(MET, "field"), files["d"], WORLDS)
    runs = {
        "e": (CHUNK, execution.run_chunk(MADE, CHUNK)[0]),
        "d": (DRIVES, execution.run_chunk(MET, DRIVES, WORLDS)[0]),
    }
    made = {}
    for name, (chunk, table) in runs.items():
        file = str(folder / f"{name}.runs.parquet")
        table_files.write(table, file)
        made[name] = recheck.StoredRuns(files[name], {file: chunk})
    return made


@pytest.fixture(params=["e", "d"])
def each(request, tasks):
    return tasks[request.param]


def test_runs_and_drives_are_sound_and_can_be_made_again(each):
    verdict, count = recheck.verify([each], 1, print), {"e": 4, "d": 8}
    ((_, chunk),) = each.runs.items()
    rows = count[chunk.experiment]
    assert (verdict.faults, verdict.files, verdict.runs) == ((), 1, rows)
    for every, number in ((True, rows), (False, 1)):
        # Not the verdict's digest: that names the folder, and chooses another run once in thirty.
        again = recheck.run_again([each], (), 1, "digest", every)
        assert again == recheck.RunsVerdict(runs=number), "all, or the first"
    told = []
    twenty = recheck.verify([each] * 20, 2, told.append)
    assert (twenty.faults, twenty.files, twenty.runs, len(told)) == ((), 20, 20 * rows, 2)


def test_drives_that_are_sound_may_collide_or_not_arrive(tasks):
    (file,) = tasks["d"].runs
    rows = {row["problem"]: row for row in table_files.read(file).to_pylist()}
    assert [rows[name]["feasible"] for name in WORLDS] == [True, True, False, False]
    assert [rows[name]["claimed_feasible"] for name in WORLDS] == [True, True, True, False]
    assert (rows["hit"]["collision_at"], rows["hit"]["collision_steps"]) == (4.0, 1)


EDITS: dict[tuple[str, str, str], Callable] = {
    ("e", "feasible", "feasible"): lambda value: True,
    ("e", "length", "length"): lambda value: value - 1e-6,
    ("e", "clearance", "clearance"): lambda value: value + 1e-7,
    ("e", "path_points", "length"): lambda points: [1.0, 8.0, 5.0, 9.0, 9.0, 8.0],
    ("e", "path_points", "path_points"): lambda points: [*points[:-1], points[-1] + 0.5],
    ("e", "path_curve", "path_points"): lambda value: "",
    ("e", "repeat", "repeat"): lambda value: value + 1,
    ("e", "method", "method"): lambda value: "other",
    ("e", "generations", "generations"): lambda value: 7,
    ("d", "arrival", "objective"): lambda value: value - 1.0,
    ("d", "length", "length"): lambda value: value - 1.0,
    ("d", "feasible", "feasible"): lambda value: not value,
    ("d", "path_points", "length"): lambda points: [*points[:2], 5.0, 9.0, *points[2:]],
}


def on_a_copy(task, folder):
    """A task whose runs are those of a copy of its file, and that file."""
    ((file, chunk),) = task.runs.items()
    copy = shutil.copy(file, folder)
    return task._replace(runs={copy: chunk}), copy


@pytest.mark.parametrize(("name", "column", "named"), EDITS)
def test_an_edit_is_told_with_file_run_column_and_both_values(tasks, tmp_path, name, column, named):
    task, copy = on_a_copy(tasks[name], tmp_path)
    edited(copy, column, EDITS[name, column, named])
    faults = recheck.judge(task).faults
    assert any(f": {named}: stored " in str(fault) for fault in faults)
    assert all(str(fault).startswith(f"{copy}: s/{name}/") for fault in faults)


@pytest.mark.parametrize(
    ("column", "least", "rows"),
    [("length", 8e-9, 4), ("clearance", 3e-9, 2), ("collision_at", 1e-6, 2)],
)
def test_an_edit_is_told_from_the_tolerance_on(tasks, tmp_path, column, least, rows):
    for share, count in ((0.9, 0), (1.1, rows)):
        task, copy = on_a_copy(tasks["e"], tmp_path)
        edited(copy, column, lambda value, share=share: value + share * least)
        assert len(recheck.judge(task).faults) == count


FORGED = {
    "dropped": lambda table: table.slice(0, 2),
    "doubled": lambda table: pa.concat_tables([table, table.slice(0, 1)]),
    "copied": lambda table: table.take([0] * len(table)),
}


@pytest.mark.parametrize("case", FORGED)
def test_rows_that_were_dropped_doubled_or_copied_are_named(tasks, tmp_path, case):
    task, copy = on_a_copy(tasks["e"], tmp_path)
    table_files.write(FORGED[case](table_files.read(copy)), copy)
    assert re.search(r" rows; expected 4$|: id: stored ", str(recheck.judge(task).faults[0]))


@pytest.mark.parametrize(
    ("name", "column", "change"),
    [
        ("e", "history", lambda values: [values[0] / 2]),
        ("d", "steps", lambda value: value + 1),
    ],
)
def test_what_no_path_tells_shows_when_a_run_is_made_again(tasks, tmp_path, name, column, change):
    task, copy = on_a_copy(tasks[name], tmp_path)
    edited(copy, column, change)
    assert not recheck.judge(task).faults
    faults = recheck.run_again([task], (), 1, "", every=True).faults
    assert faults
    assert all(f": {column}: stored " in str(fault) for fault in faults)
    # Of few runs the first one alone is made again.
    first = table_files.read(copy)["id"][0].as_py()
    (fault,) = recheck.run_again([task], (), 1, "digest", every=False).faults
    assert f": {first}: " in str(fault)


def test_a_foreign_table_is_refused(tasks, tmp_path):
    """Files in the places of others are in `test_chunks`."""
    task, copy = on_a_copy(tasks["e"], tmp_path)
    table = parquet.read_table(copy)
    words = table.set_column(table.column_names.index("length"), "length", table["id"])
    table_files.write(words, copy)
    (found,) = recheck.judge(task).faults
    fault = "column length is of type string, not double"
    assert str(found).startswith(f"{copy}: {fault}; delete it and start again")


def test_a_file_of_problems_that_is_none_or_another_is_told(tasks, tmp_path):
    cut = tmp_path / "cut.parquet"
    cut.write_bytes(b"PAR1")
    for task, fault in (
        (tasks["e"]._replace(problems=str(cut)), "not a whole file of problems"),
        (tasks["e"]._replace(problems=tasks["d"].problems), "not of the problems that"),
    ):
        (found,) = recheck.judge(task).faults
        assert str(found).startswith(f"{task.problems}: {fault}")
