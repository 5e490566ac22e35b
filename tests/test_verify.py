"""`python -m bezierplan verify`: results follow from studies and runs, and every edit of them is
named.
"""

import contextlib
import json
import random
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
import starts
from chunks import CHUNK, MADE

from bezierplan.__main__ import main
from bezierplan.analysis.outcome import proof
from bezierplan.machine import digest
from bezierplan.places import TREE
from bezierplan.running import execution, problems, recheck, rows
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.study import stored
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles

BEND = """
import numpy as np
from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan
from place import MIDDLE

workspaces = ("circles",)

def plan(problem, rng):
    {seed}
    middle = [0.0, MIDDLE + rng.normal(0, 0.1)]
    path = Path("bezier", np.array([problem.start, middle, problem.target]))
    length = curves.length(path)
    return Plan(path, length, claimed_feasible=True, evaluations=1, history=np.array([length]),
                stop="one", extra={{}})
"""
STUDY = {
    "experiments.yaml": """
title: A bend round a disc
methods: {bend: {planner: bend.py}, line: {planner: straight_line}}
settings: {}
workspaces: {disc: {kind: circles, unit: m, bounds: [-5, 5, -5, 5], circles: [[0, 0, 1]]}}
problems: {across: {workspace: disc, start: [-4, 0], target: [4, 0]}}
experiments:
  bends: {problems: [across], methods: [bend, line], repeats: {smoke: 6, full: 6, extended: 6},
    chunk: {smoke: 3, full: 3, extended: 3}}
""",
    "artefacts.yaml": """
tables:
  table1: {title: Lengths, kind: pivot, experiment: bends, published: lengths.csv, index: [method],
    columns: [value], values: [{metric: length, statistic: mean, label: length, decimals: 2}]}
figures:
  figure1: {title: Lengths, columns: 1, panels: [
    {kind: boxes, experiment: bends, metric: length}]}
""",
    "claims.yaml": """
claims:
  - {id: C1, place: Table 1, statement: The line is shorter., artefact: table1, checks: [
      {test: lower, experiment: bends, metric: length, groups: [line], than: [bend],
       direction: lower, margin: 0.01}]}
""",
    "published/lengths.csv": "method,metric,statistic,n,unit,value\nbend,length,mean,6,m,10.0\n",
}
RUNS = "bend/runs/bends/bend/0.parquet"


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """The folder of the study `bend`, with its results."""
    folder = tmp_path_factory.mktemp("verified")
    study = folder / "bend"
    (study / "published").mkdir(parents=True)
    code = {"bend.py": BEND.format(seed=""), "place.py": "MIDDLE = 5.0\n"}
    for name, text in (STUDY | code).items():
        (study / name).write_text(text)
    words = ("--snakefile", str(TREE / "Snakefile"), "--config", 'studies=["./bend"]')
    words += ("--cores", "2", "--workflow-profile", "none")
    done = starts.snakemake(folder, "smoke", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture
def results(original, tmp_path):
    """The folder of a scale, as the workflow made it."""
    shutil.copytree(original, tmp_path, dirs_exist_ok=True)
    with contextlib.chdir(tmp_path):
        yield Path("results/smoke")


def verified(capsys, *words):
    """The status of the command, and the lines that it printed, and those about faults."""
    for known in (digest.function_digest, digest._reached, digest._syntax):
        known.cache_clear()  # as in a process of its own
    try:
        main(["verify", *map(str, words), "--cores", "1"])
        status = 0
    except SystemExit as end:
        status = end.code
    printed = capsys.readouterr()
    return status, printed.out.splitlines(), printed.err.splitlines()


def edited(file, column, change):
    """Change a column of a file by a function of its list; with a digest like an honest file."""
    table = parquet.read_table(file)
    place = table.column_names.index(column)
    changed = table.set_column(
        place, column, pa.array(change(table[column].to_pylist()), table.schema.field(column).type)
    )
    job = rows.kept_digests(table)[1]
    rows.write(changed, str(file), job)


def listed(folder, name):
    """Give the list of digests that of a file as it is now."""
    file = folder / "verified.json"
    content = json.loads(file.read_text())
    content["sha256"][name] = recheck.sha256(folder / name)
    recheck.write(content, str(file))


def unlisted(folder):
    """Take the page away, and the list of digests that it needs."""
    for name in ("index.html", "verified.json"):
        (folder / name).unlink()


def test_each_edit_of_one_byte_is_named(tmp_path):
    """Of files of each kind of the small subset, which `make test` makes before the tests, at any
    place; the page is no file of the list.
    """
    made = TREE / "results" / "smoke"
    assert (made / "verified.json").is_file(), "run snakemake smoke first"
    shutil.copytree(made, tmp_path / "smoke", ignore=shutil.ignore_patterns("logs"))
    folder = tmp_path / "smoke"
    listed = json.loads((folder / "verified.json").read_text())["sha256"]
    draw = random.Random(1)
    kinds: dict[str, list[Path]] = {}
    for name in sorted(listed):
        kinds.setdefault(name.partition(".")[2], []).append(folder / name)
    for file in [file for files in kinds.values() for file in draw.sample(files, 3)]:
        content = file.read_bytes()
        place = draw.randrange(len(content))
        other = draw.choice([byte for byte in range(256) if byte != content[place]])
        file.write_bytes(content[:place] + bytes([other]) + content[place + 1 :])
        assert [fault.file for fault in proof.unlisted(folder)] == [str(file)], place
        file.write_bytes(content)
    assert proof.unlisted(folder) == []


def test_one_byte_of_a_figure_s_data_is_named_by_the_command(results, capsys):
    file = next(results.glob("bend/*/figure1.csv"))
    content = file.read_bytes()
    file.write_bytes(content[:-3] + b"7" + content[-2:])
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0].startswith(f"{file}: all bytes: SHA-256: stored ")


def test_a_study_of_ones_own_is_found_here_or_where_it_is_said_to_lie(results, tmp_path, capsys):
    Path("bend").rename(tmp_path / "away")
    status, _, told = verified(capsys, results)
    assert (status, told) == (
        2,
        [
            f"{results / 'bend'}: no study bend in config/config.yaml or here; say where it lies: "
            "--studies FOLDER/bend"
        ],
    )
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "away").rename(tmp_path / "elsewhere/bend")
    places = stored.places_of(results, {"studies": ["song2016"]}, ["elsewhere/bend"])
    assert places == {"bend": "elsewhere/bend"}


def test_a_list_that_is_none_and_a_missing_file_are_one_line(results, capsys):
    (results / RUNS).unlink()
    status, lines, _ = verified(capsys, results)
    assert (status, lines[-1]) == (1, "1 files are missing")
    (results / "verified.json").rename(results / "kept.json")
    status, lines, _ = verified(capsys, results)
    assert (status, lines[-1]) == (1, "1 files are missing")
    (results / "verified.json").write_text("{")
    status, _, told = verified(capsys, results)
    assert status == 2
    assert told[-1].startswith(f"{results / 'verified.json'}: not a list of digests")


def test_a_claim_or_a_bound_that_was_edited_together_with_the_list_is_named(results, capsys):
    """And so is the page, which no list has."""
    bounds, claims = "bend/problems/bends.bounds.parquet", "bend/claims.csv"
    edited(results / bounds, "bound", lambda values: [value + 0.1 for value in values])
    listed(results, bounds)
    (results / claims).write_text((results / claims).read_text().replace("shorter", "longer"))
    listed(results, claims)
    page = results / "index.html"
    page.write_text(page.read_text().replace("numba", "number", 1))
    status, lines, _ = verified(capsys, results)
    assert status == 1
    for name in (bounds, claims, "index.html"):
        assert any(line.startswith(f"{results / name}: all bytes: ") for line in lines)


def test_code_that_did_not_make_the_runs_is_named(results, capsys):
    """Though it would make the same ones: here of a module that the planner imports."""
    Path("bend/place.py").write_text("MIDDLE = 1 / 10 * 50\n")
    status, lines, _ = verified(capsys, results)
    assert status == 1
    for chunk in (0, 1):
        place = f"{results}/bend/runs/bends/bend/{chunk}.parquet"
        assert lines[chunk].startswith(f"{place}: all rows: code and libraries: stored ")
    assert lines[-1] == "2 values differ"


def test_all_but_files_that_nothing_makes_is_sound(results, capsys):
    """Of a table, a figure, an experiment, a method and a chunk that are no more; and all runs can
    be made again.
    """
    named = json.loads((results / "verified.json").read_text())["sha256"]
    unnamed = {str(file.relative_to(results)) for file in results.rglob("*.*")} - named.keys()
    assert {name for name in unnamed if "log" not in name} == {"index.html", "verified.json"}
    assert recheck.sha256(results / "verified.json") in (results / "index.html").read_text()
    shutil.copytree(results / "bend/runs/bends/line", results / "bend/runs/bends/old")
    left = [
        *("old.csv", "problems/old.parquet", "paper/old.csv", "paper/table1.svg"),
        *("beyond/figure9.png", "runs/bends/line/2.parquet"),
    ]
    for name in left:
        (results / "bend" / name).parent.mkdir(exist_ok=True)
        shutil.copy(results / "bend/claims.csv", results / "bend" / name)
    left += [f"runs/bends/old/{file.name}" for file in (results / "bend/runs/bends/old").iterdir()]
    status, lines, _ = verified(capsys, results, "--all")
    told = {f"{results}/bend/{name}: of no table, figure or runs; delete it" for name in left}
    assert {*lines[: len(left)]} == told
    judged, again, files, _, last = lines[len(left) :]
    assert judged == "7 runs in 3 files: 7 different paths judged again"
    assert again == "7 runs made again"
    assert files.endswith(" files made again")
    assert (status, last) == (1, f"sound but for {len(left)} files that nothing makes")


def test_runs_that_are_missing_without_a_list_are_named(results, capsys):
    unlisted(results)
    shutil.rmtree(results / "bend/runs/bends/line")
    status, _, told = verified(capsys, results)
    assert status == 2
    assert ": no results/smoke/bend/runs/bends/line/" in told[-1]


def test_what_another_program_wrote_is_one_line_also_in_the_workflow(results, capsys):
    table = rows.read(str(results / RUNS)).replace_schema_metadata()
    names = table.column_names
    for name in ("id", "path_curve"):
        table = table.set_column(names.index(name), name, table[name].cast(pa.large_string()))
    parquet.write_table(table, results / RUNS)
    unlisted(results)
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0].startswith(
        f"{results / RUNS}: all rows: digest: stored none: another program wrote it, recomputed "
    )


SLIPS = {
    "the best of all runs": (
        "best = globals().setdefault('kept', []); best.append(rng.normal())\n"
        "    rng = type('', (), {'normal': lambda *_: min(best)})",
        "nothing kept from an earlier run",
    ),
    "what it reads beside it": (
        "open(__file__.replace('bend.py', 'params.json'), 'a')",
        "/params.json; runs would not be made again after a change of it",
    ),
    "a module that no import names": (
        "exec(open(__file__.replace('bend.py', 'other.py'), 'a+').read())",
        "/other.py; runs would not be made again after a change of it",
    ),
    "a rising history": (
        "rising = np.array([1.0, 2.0])\n    Plan = lambda *given, history, **more: "
        "__import__('bezierplan').planners.Plan(*given, history=rising, **more)",
        "its answer: history: rises; expected the best objective so far",
    ),
    "another objective": (
        "Plan = lambda path, length, **more: "
        "__import__('bezierplan').planners.Plan(path, 99.0, **more)",
        "its answer: objective: 99.0; expected the last of history, ",
    ),
    "an order of words": (
        "rng = np.random.default_rng(abs(hash('word')))",
        "no id() or hash()",
    ),
}


@pytest.mark.parametrize("case", SLIPS)
def test_a_slip_of_a_planner_is_told(case, tmp_path, planners_are_read_here):
    line, told = SLIPS[case]
    (tmp_path / "bend.py").write_text(BEND.format(seed=line))
    (tmp_path / "place.py").write_text("MIDDLE = 5.0\n")
    chunk = CHUNK._replace(planner=str(tmp_path / "bend.py"), repeats=[0, 6])
    with pytest.raises(PlannerFailure, match=re.escape(told)):
        execution.run_chunk(MADE, chunk)


# --------------------------------------------------------------------------------------------------
# Values


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
DRIVES = CHUNK._replace(
    experiment="d",
    planner="shortest_path",
    problems={name: {"workspace": "field"} for name in MET},
    policy=MOVES | SEES | {"spacing": 0.1, "step_seconds": 1.0},
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
        rows.write(table, file)
        made[name] = recheck.StoredRuns(files[name], {file: chunk}, {})
    return made


@pytest.fixture(params=["e", "d"])
def each(request, tasks):
    return tasks[request.param]


def test_runs_and_drives_are_sound_and_can_be_made_again(each):
    verdict = recheck.verify([each], 1, print)
    assert (verdict.faults, verdict.files, verdict.runs) == ((), 1, 4)
    for every, number in ((True, 4), (False, 1)):
        again = recheck.made_again([each], 1, verdict.digest, every)
        assert again == recheck.RunsVerdict(runs=number), "all, or the first"


EDITS: dict[tuple[str, str, str], Callable] = {
    ("e", "feasible", "feasible"): lambda values: [True] * len(values),
    ("e", "length", "length"): lambda values: [value - 1e-6 for value in values],
    ("e", "clearance", "clearance"): lambda values: [value + 1e-7 for value in values],
    ("e", "path_points", "length"): lambda values: [[1.0, 8.0, 5.0, 9.0, 9.0, 8.0]] * len(values),
    ("e", "path_points", "path_points"): lambda values: [
        [*points[:-1], points[-1] + 0.5] for points in values
    ],
    ("e", "path_curve", "path_points"): lambda values: [""] * len(values),
    ("e", "repeat", "repeat"): lambda values: [value + 1 for value in values],
    ("e", "method", "method"): lambda values: ["other"] * len(values),
    ("e", "generations", "generations"): lambda values: [7] * len(values),
    ("d", "arrival", "objective"): lambda values: [value - 1.0 for value in values],
    ("d", "length", "length"): lambda values: [value - 1.0 for value in values],
    ("d", "feasible", "feasible"): lambda values: [not value for value in values],
    ("d", "path_points", "length"): lambda values: [
        [*points[:2], 5.0, 9.0, *points[2:]] for points in values
    ],
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
    faults = recheck.judged(task).faults
    assert any((fault.file, fault.column) == (copy, named) for fault in faults)
    assert str(faults[0]).startswith(f"{copy}: s/{name}/")


FORGED = {
    "dropped": lambda table: table.slice(0, 2),
    "doubled": lambda table: pa.concat_tables([table, table.slice(0, 1)]),
    "copied": lambda table: table.take([0] * len(table)),
}


@pytest.mark.parametrize("case", FORGED)
def test_rows_that_were_dropped_doubled_or_copied_are_named(tasks, tmp_path, case):
    task, copy = on_a_copy(tasks["e"], tmp_path)
    rows.write(FORGED[case](rows.read(copy)), copy)
    assert recheck.judged(task).faults[0].column == "id"


@pytest.mark.parametrize(
    ("name", "column", "change"),
    [
        ("e", "history", lambda values: [[each[0] / 2] for each in values]),
        ("d", "steps", lambda values: [value + 1 for value in values]),
    ],
)
def test_what_no_path_tells_shows_when_a_run_is_made_again(tasks, tmp_path, name, column, change):
    task, copy = on_a_copy(tasks[name], tmp_path)
    edited(copy, column, change)
    assert not recheck.judged(task).faults
    faults = recheck.made_again([task], 1, "", every=True).faults
    assert {fault.column for fault in faults} == {column}


FOREIGN = {
    "other columns": (lambda table: pa.table({"a": [1]}), "no column id"),
    "text for numbers": (
        lambda table: table.set_column(
            table.column_names.index("length"), "length", pa.array(["1.0"] * len(table))
        ),
        "column length is of type string, not double",
    ),
}


@pytest.mark.parametrize("case", FOREIGN)
def test_a_foreign_table_is_refused(tasks, tmp_path, case):
    change, fault = FOREIGN[case]
    task, copy = on_a_copy(tasks["e"], tmp_path)
    rows.write(change(parquet.read_table(copy)), copy)
    with pytest.raises(ValueError, match=fault):
        recheck.judged(task)


def test_wrong_input_is_one_line_with_status_2(tasks, tmp_path, capsys):
    nowhere = tmp_path / "nowhere"
    line = f"{nowhere}: no runs here; expected a folder of results, such as results/full"
    assert verified(capsys, nowhere) == (2, [], [line])
    cut = tmp_path / "cut.parquet"
    cut.write_bytes(b"PAR1")
    for task, fault in (
        (tasks["e"]._replace(problems=str(cut)), "not a whole file of problems"),
        (tasks["e"]._replace(problems=tasks["d"].problems), "not of the problems that"),
    ):
        with pytest.raises(ValueError, match=f".parquet: {fault}"):
            recheck.judged(task)
