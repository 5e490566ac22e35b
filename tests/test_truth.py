"""The workflow itself refuses planners that lie, end, stall or change their world, by run and
planner, in one line; no table shows them.
"""

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
import starts

PLANNER = """
import os

import numpy as np
from numba import njit
from bezierplan.planners import Path, Plan

workspaces = ("circles",)


@njit
def never_ends(n):
    while n > 0:
        n = n % 7 + 1
    return n


def plan(problem, rng):
    world, points = problem.workspace, np.array([problem.start, problem.target])
    answer = Plan(Path("polyline", points), 8.0, True, 1, np.array([8.0]), "one", {})
    WORK
    return ANSWER
"""

# A method: what it does, what it answers, and how the line ends that reports it.
DEEDS = {
    "ends_short": (
        "",
        'answer._replace(path=Path("polyline", points * 0.5))',
        ": its answer: path: start: (-2.0, 2.0); expected exactly (-4.0, 4.0)",
    ),
    "says_nothing": ("", "None", ": its answer: is a NoneType; expected a Plan"),
    "exits": (
        "os._exit(0)",
        "answer",
        ": its process ended itself with exit status 0, before it was done",
    ),
    "loops": (
        "never_ends(1)",
        "answer",
        ": not done within the time limit of 6 s; it is ended",
    ),
}
# Who also lies to a robot that drives, and every run that is refused: experiment, problem and
# method, and whose deed it is.
DRIVEN = ("ends_short", "says_nothing")
REFUSED = [(f"roads/across/{method}", method) for method in DEEDS] + [
    (f"drives/through/{method}_drives", method) for method in DRIVEN
]

EXPERIMENTS = """
title: Planners that lie
methods: {{{methods}}}
settings: {{}}
policies:
  blind: {{replan: never, waits: false}}
workspaces:
  disc: {{kind: circles, unit: m, bounds: [-5, 5, -5, 5], circles: [[0, 0, 1]]}}
  moving: {{kind: moving_circles, unit: m, bounds: [-5, 5, -5, 5],
    circles: [[0, 0, 1, 0.1, 0]], pace: 1, steps: 20}}
problems:
  across: {{workspace: disc, start: [-4, 4], target: [4, 4]}}
  through: {{workspace: moving, start: [-4, 4], target: [4, 4]}}
experiments:
  drives:
    problems: [through]
    methods: [{drives}]
    repeats: {{smoke: 1, full: 1, extended: 1}}
    chunk: {{smoke: 1, full: 1, extended: 1}}
  roads:
    problems: [across]
    methods: [{names}]
    time_limit: 6
    repeats: {{smoke: 1, full: 1, extended: 1}}
    chunk: {{smoke: 1, full: 1, extended: 1}}
  plain:
    problems: [across]
    methods: [honest]
    repeats: {{smoke: 1, full: 1, extended: 1}}
    chunk: {{smoke: 1, full: 1, extended: 1}}
"""
ARTEFACTS = """
tables:
  all: {title: All, kind: pivot, experiment: roads, index: [method], columns: [value],
    values: &length [{metric: length, statistic: mean, label: length, decimals: 2}]}
  driven: {title: Driven, kind: pivot, experiment: drives, index: [method], columns: [value],
    values: *length}
  honest: {title: Honest, kind: pivot, experiment: plain, index: [method], columns: [value],
    values: *length}
"""
TABLES = "results/smoke/liars/beyond"


def written(home, planners):
    """A study in a folder with planners, by name, each with what it does and what it answers."""
    home.mkdir()
    for name, (work, answer) in planners.items():
        (home / f"{name}.py").write_text(
            PLANNER.replace("WORK", work or "pass").replace("ANSWER", answer)
        )
    methods = [f"{name}: {{planner: {name}.py}}" for name in planners]
    drives = {
        f"{name}_drives": f"{{planner: {name}.py, policy: blind}}"
        for name in ("honest", *DRIVEN)
        if name in planners
    }
    methods += [f"{name}: {method}" for name, method in drives.items()]
    words = {
        "methods": ", ".join(methods),
        "names": ", ".join(planners),
        "drives": ", ".join(drives),
    }
    (home / "experiments.yaml").write_text(EXPERIMENTS.format(**words))
    (home / "artefacts.yaml").write_text(ARTEFACTS)


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """The folder in which a study of liars was run as far as it goes, and what the workflow
    told.
    """
    folder = tmp_path_factory.mktemp("truth")
    deeds = {name: (work, answer) for name, (work, answer, _) in DEEDS.items()}
    written(folder / "liars", {"honest": ("", "answer")} | deeds)
    return folder, starts.make(
        folder,
        "liars",
        *(f"{TABLES}/{name}.csv" for name in ("all", "driven", "honest")),
        "--keep-going",
    )


def told_once(ended, told, experiment, method):
    """Whether a line is told once, and it is the last one of the job's log."""
    folder, done = ended
    log = f"results/smoke/liars/logs/runs/{experiment}/{method}/0.log"
    lines = [f"{told} ({where}: {log})" for where in ("full account", "log")]
    last = (folder / log).read_text().splitlines()[-1]
    return sum(line in lines for line in done.stderr.splitlines()) == 1 and last.endswith(
        tuple(f"CRITICAL {line}" for line in lines)
    )


@pytest.mark.parametrize(("run", "method"), REFUSED)
def test_what_a_planner_does_is_told_by_name_in_one_line(ended, run, method):
    experiment, _, job = run.split("/")
    told = f"run liars/{run}/0: planner liars/{method}.py{DEEDS[method][2]}"
    assert told_once(ended, told, experiment, job), ended[1].stderr


def test_no_table_shows_them_and_the_honest_one_ran(ended):
    folder, done = ended
    assert done.returncode == 1
    assert [file.parent.name for file in folder.glob("results/**/runs/roads/*/0.parquet")] == [
        "honest"
    ]
    assert [file.parent.name for file in folder.glob("results/**/runs/drives/*/0.parquet")] == [
        "honest_drives"
    ]
    assert {file.name for file in folder.glob(f"{TABLES}/*")} == {
        "honest.csv",
    }
    assert "Traceback" not in done.stderr


def test_runs_that_were_edited_between_two_jobs_are_shown_nowhere(ended):
    """Whoever it was: another planner, or a reader."""
    folder, _ = ended
    name = "results/smoke/liars/runs/plain/honest/0.parquet"
    file, sound = folder / name, (folder / name).read_bytes()
    table = parquet.read_table(file)
    place = table.column_names.index("length")
    parquet.write_table(table.set_column(place, "length", pa.array([1.0] * len(table))), file)
    for made in folder.glob(f"{TABLES}/honest*"):
        made.unlink()
    try:
        done = starts.make(folder, "liars", f"{TABLES}/honest.csv", "--rerun-triggers", "mtime")
    finally:
        file.write_bytes(sound)
    assert done.returncode == 1
    lines = [line for line in done.stderr.splitlines() if " (full account: " in line]
    told = f"{name}: other rows than were written"
    assert len({line for line in lines if told in line}) == 1, done.stderr
    assert not list(folder.glob(f"{TABLES}/honest*"))


def test_a_file_that_ends_the_start_is_told_before_any_job(tmp_path):
    written(tmp_path / "liars", {"honest": ("", "answer")})
    file = tmp_path / "liars" / "honest.py"
    file.write_text(f"{file.read_text()}\nos._exit(0)\n")
    done = starts.make(tmp_path, "liars", f"{TABLES}/honest.csv")
    assert done.returncode == 2
    told = (done.stdout + done.stderr).splitlines()
    (line,) = [line for line in told if not line.startswith("Config file ")]
    assert line.endswith(
        "when it is imported: its process ended itself with exit status 0, before it was done"
    )
    assert "honest" in line
    assert not (tmp_path / "results").exists()
