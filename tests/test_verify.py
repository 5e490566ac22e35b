"""`python -m bezierplan verify`: results are what their points say, and every edit of them is told in one line."""

import shutil

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from bezierplan.__main__ import main
from bezierplan.running import execution, problems, rows
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

CIRCLES = Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 5.0]]), np.array([1.0]), "m")
MADE = {
    "free": Problem("free", CIRCLES, (1.0, 8.0), (9.0, 8.0)),
    "blocked": Problem("blocked", CIRCLES, (1.0, 5.0), (9.0, 5.0)),
}
JOB = {
    "study": "s",
    "experiment": "e",
    "method": "line",
    "planner": "straight_line",
    "settings": {},
    "problems": {name: {"workspace": "field"} for name in MADE},
    "vary": {},
    "presets": {},
    "seeds": "own",
    "repeats": [0, 2],
}
RUNS, BOUNDS = "s/runs/e/line/0.parquet", "s/problems/e.bounds.parquet"


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "full"
    (folder / RUNS).parent.mkdir(parents=True)
    (folder / BOUNDS).parent.mkdir(parents=True)
    problems.write(MADE, dict.fromkeys(MADE, "field"), str(folder / "s/problems/e.parquet"))
    parquet.write_table(problems.bounds_of(MADE), folder / BOUNDS)
    rows.write(execution.run_chunk(MADE, JOB)[0], str(folder / RUNS))
    return folder


@pytest.fixture
def results(kept, tmp_path):
    return shutil.copytree(kept, tmp_path / "full")


def edited(file, column, change, digest=False):
    """Change a column of a file by a function of its list; with a digest like an honest file."""
    table = parquet.read_table(file)
    place = table.column_names.index(column)
    changed = table.set_column(place, column, pa.array(change(table[column].to_pylist()), table.schema.field(column).type))
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
    shown = [line for line in lines if line.startswith(f"{results / RUNS}: s/e/") and f": {named}: stored " in line]
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


def test_wrong_input_is_one_line_with_status_2(results, capsys, tmp_path):
    assert verified(capsys, tmp_path / "nowhere") == (
        2,
        [],
        [f"{tmp_path / 'nowhere'}: no runs here; expected a folder of results, such as results/full"],
    )
    (results / RUNS).write_bytes(b"PAR1")
    status, lines, told = verified(capsys, results)
    assert (status, lines) == (2, [])
    assert told == [f"{results / RUNS}: not a whole Parquet file; delete it and start again: the workflow reproduces it"]
    (results / "s/problems/e.parquet").unlink()
    (results / BOUNDS).unlink()
    status, _, told = verified(capsys, results)
    assert status == 2
    assert told == [f"{results / 's/problems/e.parquet'}: missing; expected the problems of {(results / RUNS).parent}"]
