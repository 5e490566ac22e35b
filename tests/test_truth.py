"""The workflow itself refuses planners that lie, end, stall or change their world, by run and
planner, in one line; no table shows them.
"""

import os
import select
import subprocess
import sys
import time
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
import starts

from bezierplan.running import watchdog

ROOT = Path(__file__).parents[1]

PLANNER = """
import ctypes
import os
import signal
import subprocess

import numpy as np
from numba import njit
from bezierplan.planners import Path, Plan

workspaces = ("circles",)


@njit
def never_ends(n):
    while n > 0:
        n = n % 7 + 1
    return n


class SlyPlan(Plan):
    pass


class SlyArray(np.ndarray):
    def tolist(self):
        return [[0.0, 0.0]]


class SlyNumber(float):
    def __float__(self):
        return 1.0


def plan(problem, rng):
    world, points = problem.workspace, np.array([problem.start, problem.target])
    answer = Plan(Path("polyline", points), 8.0, True, 1, np.array([8.0]), "one", {})
    WORK
    return ANSWER
"""

IS_ANOTHER = "is another after the run; a planner copies what it changes"
# A method: what it does, what it answers, and how the line ends that reports it.
LIES = {
    "ends_short": (
        "",
        'answer._replace(path=Path("polyline", points * 0.5))',
        ": path: start: (-2.0, 2.0); expected exactly (-4.0, 4.0)",
    ),
    "claims_feasible": (
        "",
        'answer._replace(extra={"feasible": True})',
        ": extra: feasible: a column or setting has this name already",
    ),
    "claims_length": (
        "",
        'answer._replace(extra={"length": 1.0})',
        ": extra: length: a column or setting has this name already",
    ),
    "hides_points": (
        "",
        'answer._replace(path=Path("polyline", points * np.nan))',
        ": path: points: expected finite numbers",
    ),
    "says_nothing": ("", "None", ": is a NoneType; expected a Plan"),
    "flat": (
        "",
        'answer._replace(path=Path("polyline", points.ravel()))',
        ": path: points: expected an array of floats, (n, 2)",
    ),
    "sly_plan": ("", "SlyPlan(*answer)", ": is a SlyPlan; expected a Plan"),
    "sly_points": (
        "",
        'answer._replace(path=Path("polyline", points.view(SlyArray)))',
        ": path: points: expected an array of floats, (n, 2)",
    ),
    "sly_history": (
        "",
        "answer._replace(history=answer.history.view(SlyArray))",
        ": history: expected an array of numbers without nan, (generations + 1,), of at most "
        "1000000 values",
    ),
    "sly_objective": (
        "",
        "answer._replace(objective=SlyNumber(8.0))",
        ": objective: expected a number, and not nan",
    ),
}
# Likewise, of what is no answer.
DEEDS = {
    "moves": ("world.centres[:, 1] -= 3", "ValueError: output array is read-only"),
    "unlocks": (
        "world.radii.setflags(write=True)",
        "ValueError: cannot set WRITEABLE flag to True of this array",
    ),
    "swaps": (
        'object.__setattr__(world, "radii", world.radii * 0)',
        f"problem: across: workspace: radii: {IS_ANOTHER}",
    ),
    "writes": (
        "ctypes.memset(world.radii.ctypes.data, 0, 8)",
        f"problem: across: workspace: content: {IS_ANOTHER}",
    ),
    "replaces": (
        "np.isfinite = lambda values: True",
        "replaces numpy.isfinite; a planner leaves other modules as they are",
    ),
    "exits": ("os._exit(0)", "its process ended itself with exit status 0, before it was done"),
    "crashes": ("os.kill(os.getpid(), signal.SIGSEGV)", "its process was ended by signal SIGSEGV"),
    "forks": ("os.fork() or os.execvp('sleep', ['sleep', '4321.25'])", watchdog.LEFT),
    "detaches": ("subprocess.Popen(['sleep', '4321.25'], start_new_session=True)", watchdog.LEFT),
    "loops": ("never_ends(1)", "not done within the time limit of 2 s; it is ended"),
}

# Who also lies to a robot that drives, and every run that is refused for a lie: experiment, problem
# and method, and whose lie it is.
DRIVEN = ("ends_short", "says_nothing", "sly_plan")
REFUSED = [(f"roads/across/{method}", method) for method in LIES] + [
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
    time_limit: 2
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


def words_of(folder, *words):
    """What Snakemake is started with to make something of the study `liars` in a folder."""
    common = ["-s", str(ROOT / "Snakefile"), "--workflow-profile", "none", "--cores", "2"]
    return [*common, *words, "--config", f"studies=[{folder / 'liars'}]"]


def snakemake(folder, *words, **options):
    """Make something of the study `liars` in a folder."""
    return starts.snakemake(folder, *words_of(folder, *words), **options)


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """The folder in which a study of liars was run as far as it goes, and what the workflow
    told.
    """
    folder = tmp_path_factory.mktemp("truth")
    lies = {name: (work, answer) for name, (work, answer, _) in LIES.items()}
    written(
        folder / "liars",
        {"honest": ("", "answer")}
        | lies
        | {name: (work, "answer") for name, (work, _) in DEEDS.items()},
    )
    return folder, snakemake(
        folder, *(f"{TABLES}/{name}.csv" for name in ("all", "driven", "honest")), "--keep-going"
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
def test_liar_is_refused_by_name_in_one_line(ended, run, method):
    experiment, _, job = run.split("/")
    told = f"run liars/{run}/0: planner liars/{method}.py: its answer{LIES[method][2]}"
    assert told_once(ended, told, experiment, job), ended[1].stderr


@pytest.mark.parametrize("method", DEEDS)
def test_what_a_planner_does_is_told_by_name_in_one_line(ended, method):
    # What was written into memory or into other modules is looked for after all runs of a job.
    run = f"liars/roads/across/{method}/0"
    if method in ("writes", "replaces"):
        run = f"liars/roads/*/{method}"
    assert told_once(
        ended, f"run {run}: planner liars/{method}.py: {DEEDS[method][1]}", "roads", method
    ), ended[1].stderr


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
        "honest.comparison.csv",
        "honest.csv",
    }
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has pipes that keep writes apart")
def test_messages_of_the_workflow_are_written_with_their_ends(tmp_path):
    """What a job says between a message and its end would stand on the message's line."""
    written(tmp_path / "liars", {"honest": ("", "answer"), "exits": (DEEDS["exits"][0], "answer")})
    reading, writing = os.pipe2(os.O_DIRECT)
    command = [sys.executable, "-m", "snakemake", *words_of(tmp_path, f"{TABLES}/all.csv")]
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=writing
    ) as workflow:
        os.close(writing)
        writes = list(iter(lambda: os.read(reading, select.PIPE_BUF), b""))
    os.close(reading)
    assert workflow.returncode == 1
    assert any(b"ended itself with exit status 0" in each for each in writes)
    assert [
        each for each in writes if not each.endswith(b"\n") and len(each) < select.PIPE_BUF
    ] == []


@pytest.mark.skipif(
    sys.platform != "linux", reason="only Linux gives a process the children of its children"
)
def test_no_process_outlives_its_job(ended):
    running = [
        file.read_bytes()
        for file in Path("/proc").glob("[0-9]*/cmdline")
        if os.access(file, os.R_OK)
    ]
    assert not any(b"4321.25" in words for words in running)


@pytest.mark.parametrize(("column", "value"), [("feasible", False), ("length", 1.0)])
def test_runs_that_were_edited_between_two_jobs_are_shown_nowhere(ended, column, value):
    """Whoever it was: another planner, or a reader."""
    folder, _ = ended
    name = "results/smoke/liars/runs/plain/honest/0.parquet"
    file, sound = folder / name, (folder / name).read_bytes()
    table = parquet.read_table(file)
    place = table.column_names.index(column)
    parquet.write_table(
        table.set_column(
            place, column, pa.array([value] * len(table), table.schema.field(column).type)
        ),
        file,
    )
    for made in folder.glob(f"{TABLES}/honest*"):
        made.unlink()
    try:
        done = snakemake(folder, f"{TABLES}/honest.csv", "--rerun-triggers", "mtime")
    finally:
        file.write_bytes(sound)
    assert done.returncode == 1
    told = (
        f"{name}: its rows are not those that were written; delete it and start again: the "
        "workflow reproduces it"
    )
    assert sum(f"{told} (full account: " in line for line in done.stderr.splitlines()) == 1, (
        done.stderr
    )
    assert not list(folder.glob(f"{TABLES}/honest*"))


AT_START = {
    "exits": (
        "os._exit(0)",
        "",
        "when it is imported: its process ended itself with exit status 0, before it was done",
    ),
    "loops": (
        "while True: pass",
        "",
        "when it is imported: not done within the time limit of 1 s; it is ended",
    ),
    "replaces": (
        "np.hypot = None",
        "",
        "replaces numpy.hypot; a planner leaves other modules as they are",
    ),
    "asked exits": (
        "",
        "os._exit(0)",
        "serves of its planner: its process ended itself with exit status 0, before it was done",
    ),
    "asked loops": (
        "",
        "while True: pass",
        "serves of its planner: not done within the time limit of 1 s; it is ended",
    ),
}


@pytest.mark.parametrize("case", AT_START)
def test_a_file_that_ends_or_stalls_the_start_is_told_before_any_job(case, tmp_path):
    at_import, when_asked, told = AT_START[case]
    written(tmp_path / "liars", {"honest": ("", "answer")})
    file = tmp_path / "liars" / "honest.py"
    file.write_text(
        f"{file.read_text()}\ndef serves(problem):\n    {when_asked or 'pass'}\n\n\n{at_import}\n"
    )
    begun = time.monotonic()
    limit = {"bezierplan.running.interface.LIMIT": 1.0}
    done = snakemake(tmp_path, f"{TABLES}/honest.csv", constants=limit)
    assert done.returncode == 2
    (line,) = (done.stdout + done.stderr).splitlines()
    assert line.endswith(told)
    assert "honest" in line
    assert time.monotonic() - begun < 60
    assert not (tmp_path / "results").exists()
