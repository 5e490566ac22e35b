"""`python -m bezierplan verify`: results are what their points say, and every edit of them is told
in one line.
"""

import shutil

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from bezierplan.__main__ import main
from bezierplan.running import execution, problems, rides, rows, worlds
from bezierplan.running.chunk import Chunk
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles

CIRCLES = Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 5.0]]), np.array([1.0]), "m")
MADE = {
    "free": Problem("free", CIRCLES, (1.0, 8.0), (9.0, 8.0)),
    "blocked": Problem("blocked", CIRCLES, (1.0, 5.0), (9.0, 5.0)),
}
CHUNK = Chunk(
    study="s",
    experiment="e",
    method="line",
    planner="straight_line",
    settings={},
    problems={name: {"workspace": "field"} for name in MADE},
    vary={},
    presets={},
    seeds="own",
    repeats=[0, 2],
)
RUNS, BOUNDS = "s/runs/e/line/0.parquet", "s/problems/e.bounds.parquet"


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "full"
    (folder / RUNS).parent.mkdir(parents=True)
    (folder / BOUNDS).parent.mkdir(parents=True)
    problems.write(MADE, dict.fromkeys(MADE, "field"), str(folder / "s/problems/e.parquet"))
    parquet.write_table(problems.bounds_of(MADE), folder / BOUNDS)
    rows.write(execution.run_chunk(MADE, CHUNK)[0], str(folder / RUNS))
    return folder


@pytest.fixture
def results(kept, tmp_path):
    return shutil.copytree(kept, tmp_path / "full")


def edited(file, column, change, digest=False):
    """Change a column of a file by a function of its list; with a digest like an honest file."""
    table = parquet.read_table(file)
    place = table.column_names.index(column)
    changed = table.set_column(
        place, column, pa.array(change(table[column].to_pylist()), table.schema.field(column).type)
    )
    rows.write(changed, str(file)) if digest else parquet.write_table(changed, file)


def verified(capsys, *words):
    """The status of the command, and the lines that it printed."""
    try:
        main(["verify", *map(str, words), "--cores", "1"])
        status = 0
    except SystemExit as end:
        status = end.code
    told = capsys.readouterr()
    return status, told.out.splitlines(), told.err.splitlines()


def test_untouched_results_are_sound(results, capsys):
    status, lines, progress = verified(capsys, results)
    assert status == 0
    assert lines[0] == "4 runs in 1 files: 2 different paths judged again, 2 bounds computed again"
    assert "numba " in lines[1]
    assert lines[-1] == "sound"
    assert progress == ["2 of 2 tables checked, 0 faults"]


EDITS = {
    "feasible": lambda values: [True] * len(values),
    "length": lambda values: [value - 1e-6 for value in values],
    "clearance": lambda values: [value + 0.1 for value in values],
    "path_points": lambda values: [[1.0, 8.0, 5.0, 9.0, 9.0, 8.0]] * len(values),
    "repeat": lambda values: [value + 1 for value in values],
    "method": lambda values: ["other"] * len(values),
    "generations": lambda values: [7] * len(values),
}


@pytest.mark.parametrize("column", EDITS)
def test_an_edit_is_told_with_file_run_column_and_both_values(results, capsys, column):
    edited(results / RUNS, column, EDITS[column], digest=True)
    status, lines, _ = verified(capsys, results)
    assert status == 1
    named = {"path_points": "length", "repeat": "id"}.get(column, column)
    shown = [
        line
        for line in lines
        if line.startswith(f"{results / RUNS}: s/e/") and f": {named}: stored " in line
    ]
    assert shown
    assert all(", recomputed " in line for line in shown)
    assert lines[-1].endswith(" values differ")


def test_an_edit_of_what_no_path_determines_shows_in_the_digest(results, capsys):
    edited(results / RUNS, "evaluations", lambda values: [value + 1 for value in values])
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0].startswith(f"{results / RUNS}: all rows: digest: stored ")


def test_a_bound_that_was_edited_is_told(results, capsys):
    edited(results / BOUNDS, "bound", lambda values: [5.0] * len(values))
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0].startswith(f"{results / BOUNDS}: blocked: bound: stored 5.0, recomputed 8.")


FIELD = (0.0, 10.0, 0.0, 10.0)
OPEN, SHUT = (
    from_lines([".........", ".........", row, row, "........."], 1.0, "m")
    for row in (".........", "....#....")
)
WORLDS = {
    "circles": MovingCircles(
        FIELD,
        FIELD,
        np.array([[5.0, 8.0]]),
        np.array([[0.0, 0.1]]),
        np.array([1.0]),
        "circles",
        1.0,
        60,
        "m",
    ),
    "cells": ChangingCells((OPEN, SHUT), np.array([2.5]), 1.0, 60),
}
MET = {
    "circles": Problem("circles", WORLDS["circles"].workspace(0), (1.0, 5.0), (9.0, 5.0)),
    "cells": Problem("cells", WORLDS["cells"].workspace(0), (0.5, 2.5), (8.5, 2.5)),
}
MOVES = {
    "replan": "when_changed",
    "every": 1,
    "warm": False,
    "waits": False,
    "evades": False,
    "start": "position",
    "brake": 1.0,
}
SEES = {
    "sees": "before",
    "knows": "positions",
    "check_margin": 0.0,
    "plan_margins": [0.0],
    "horizon": 2.0,
}
POLICY = MOVES | SEES | {"spacing": 0.1, "step_seconds": 1.0}
DRIVES, FIRST_DRIVES = "s/runs/d/line/0.parquet", "s/problems/d.bounds.parquet"


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """Results of a robot that drives along the shortest path that it sees, among circles and
    cells.
    """
    folder = tmp_path_factory.mktemp("drives") / "full"
    (folder / DRIVES).parent.mkdir(parents=True)
    (folder / FIRST_DRIVES).parent.mkdir(parents=True)
    worlds.write(MET, dict.fromkeys(MET, "field"), WORLDS, str(folder / "s/problems/d.parquet"))
    described = {name: {"workspace": "field"} for name in MET}
    drives = CHUNK._replace(
        experiment="d", planner="shortest_path", problems=described, policy=POLICY
    )
    runs, _, traces = rides.run_chunk(MET, WORLDS, drives)
    rows.write(runs, str(folder / DRIVES))
    parquet.write_table(traces, (folder / DRIVES).with_suffix(".traces.parquet"))
    parquet.write_table(rides.bounds_of(MET, WORLDS), folder / FIRST_DRIVES)
    return folder


def test_drives_and_their_bounds_are_sound(driven, capsys):
    status, lines, _ = verified(capsys, driven)
    assert (status, lines[-1]) == (0, "sound")
    assert lines[0] == "4 runs in 1 files: 0 different paths judged again, 2 bounds computed again"


@pytest.mark.parametrize("column", ["arrival", "length", "feasible", "path_points"])
def test_an_edit_of_a_drive_is_told(driven, tmp_path, capsys, column):
    folder = shutil.copytree(driven, tmp_path / "full")
    changes = {
        "feasible": lambda values: [not value for value in values],
        "path_points": lambda values: [[*points[:2], 5.0, 9.0, *points[2:]] for points in values],
    }
    edited(
        folder / DRIVES,
        column,
        changes.get(column, lambda values: [value - 1.0 for value in values]),
        digest=True,
    )
    status, lines, _ = verified(capsys, folder)
    named = {"arrival": "objective", "path_points": "length"}.get(column, column)
    assert status == 1
    assert any(
        line.startswith(f"{folder / DRIVES}: s/d/") and f": {named}: stored " in line
        for line in lines
    )


@pytest.mark.parametrize("column", ["least_arrival", "bound", "bound_path"])
def test_an_edited_bound_of_a_moving_world_is_told(driven, tmp_path, capsys, column):
    folder = shutil.copytree(driven, tmp_path / "full")
    edited(
        folder / FIRST_DRIVES,
        column,
        lambda values: [np.multiply(value, 1.001).tolist() for value in values],
    )
    status, lines, _ = verified(capsys, folder)
    assert status == 1
    assert f"{folder / FIRST_DRIVES}: cells: {column}: stored " in "\n".join(lines)


def test_a_drive_through_what_its_trace_meets_is_not_free(driven, tmp_path, capsys):
    """Who edits the verdict, the collision and the clearance still has the trace against them."""
    folder = shutil.copytree(driven, tmp_path / "full")
    file = (folder / DRIVES).with_suffix(".traces.parquet")
    for column in ("x", "y"):
        edited(file, column, lambda values: [[-1.0] * len(each) for each in values])
    status, lines, _ = verified(capsys, folder)
    assert status == 1
    assert (
        sum(": feasible: stored True, recomputed False" in line for line in lines)
        == len(lines) - 3
        == 4
    )


FOREIGN = {
    "other columns": (lambda table: pa.table({"a": [1]}), "no column id"),
    "text for numbers": (
        lambda table: table.set_column(
            table.column_names.index("length"), "length", pa.array(["1.0"] * len(table))
        ),
        "column length: expected numbers in every row",
    ),
    "a missing value": (
        lambda table: table.set_column(
            table.column_names.index("feasible"),
            "feasible",
            pa.array([None, *[True] * (len(table) - 1)]),
        ),
        "column feasible: expected truths in every row",
    ),
    "points that are numbers": (
        lambda table: table.set_column(
            table.column_names.index("path_points"), "path_points", table["length"]
        ),
        "column path_points: expected lists of numbers in every row",
    ),
}


@pytest.mark.parametrize("case", FOREIGN)
def test_a_foreign_table_is_one_line_with_status_2(results, capsys, case):
    change, told = FOREIGN[case]
    parquet.write_table(change(parquet.read_table(results / RUNS)), results / RUNS)
    expected = f"{results / RUNS}: {told}; delete it and start again: the workflow reproduces it"
    assert verified(capsys, results) == (2, [], [expected])


@pytest.mark.parametrize("name", [BOUNDS, "s/problems/e.parquet"])
def test_foreign_bounds_and_problems_are_one_line_with_status_2(results, capsys, name):
    parquet.write_table(pa.table({"a": [1]}), results / name)
    status, lines, told = verified(capsys, results)
    assert (status, lines) == (2, [])
    what = "no column problem" if name == BOUNDS else "not a whole file of problems"
    assert told == [
        f"{results / name}: {what}; delete it and start again: the workflow reproduces it"
    ]


def test_points_that_are_no_path_are_told(results, capsys):
    edited(
        results / RUNS,
        "path_points",
        lambda values: [[1.0, 8.0, 9.0]] * 2 + [[float("nan")] * 4] * 2,
        digest=True,
    )
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert sum(": path_points: stored a path, recomputed " in line for line in lines) == 4


def test_wrong_input_is_one_line_with_status_2(results, capsys, tmp_path):
    assert verified(capsys, tmp_path / "nowhere") == (
        2,
        [],
        [
            f"{tmp_path / 'nowhere'}: no runs here; "
            "expected a folder of results, such as results/full"
        ],
    )
    (results / RUNS).write_bytes(b"PAR1")
    status, lines, told = verified(capsys, results)
    assert (status, lines) == (2, [])
    assert told == [
        f"{results / RUNS}: not a whole Parquet file; "
        "delete it and start again: the workflow reproduces it"
    ]
    (results / "s/problems/e.parquet").unlink()
    (results / BOUNDS).unlink()
    status, _, told = verified(capsys, results)
    assert status == 2
    assert told == [
        f"{results / 's/problems/e.parquet'}: missing; expected the problems of "
        f"{(results / RUNS).parents[1]}"
    ]
