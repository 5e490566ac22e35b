"""The workflow itself refuses planners that lie or do not end, by run and field, in one line; no table shows them."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

PLANNER = """
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
    points = np.array([problem.start, problem.target])
    answer = Plan(Path("polyline", points), 8.0, True, 1, np.array([8.0]), "one", {})
    return ANSWER
"""

# A method: what it answers, and the line that reports it.
TOLD = {
    "ends_short": (
        'answer._replace(path=Path("polyline", points * 0.5))',
        "path: start: (-2.0, 2.0); expected exactly (-4.0, 4.0)",
    ),
    "claims_feasible": ('answer._replace(extra={"feasible": True})', "extra: feasible: a column or setting has this name already"),
    "claims_length": ('answer._replace(extra={"length": 1.0})', "extra: length: a column or setting has this name already"),
    "hides_points": ('answer._replace(path=Path("polyline", points * np.nan))', "path: points: expected finite numbers"),
    "says_nothing": ("None", "is a NoneType; expected a Plan"),
    "flat": ('answer._replace(path=Path("polyline", points.ravel()))', "path: points: expected an array of floats, (n, 2)"),
}
LOOPS = "run liars/roads/across/loops/0: planner {folder}/loops.py: not done within the time limit of 4 s; it is ended"

# Who also lies to a robot that drives, and every run that is refused for a lie: experiment, problem and method, and whose lie it is.
DRIVEN = ("ends_short", "says_nothing")
REFUSED = [(f"roads/across/{method}", method) for method in TOLD] + [(f"drives/through/{method}_drives", method) for method in DRIVEN]

EXPERIMENTS = """
title: Planners that lie
methods: {{{methods}}}
settings: {{}}
policies:
  blind: {{replan: never, waits: false}}
workspaces:
  disc: {{kind: circles, unit: m, bounds: [-5, 5, -5, 5], circles: [[0, 0, 1]]}}
  moving: {{kind: moving_circles, unit: m, bounds: [-5, 5, -5, 5], circles: [[0, 0, 1, 0.1, 0]], pace: 1, steps: 20}}
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
    time_limit: 4
    repeats: {{smoke: 1, full: 1, extended: 1}}
    chunk: {{smoke: 1, full: 1, extended: 1}}
"""
ARTEFACTS = """
tables:
  all: {title: All, kind: pivot, experiment: roads, index: [method], columns: [value], values: &length [
    {metric: length, statistic: mean, label: length, decimals: 2}]}
  driven: {title: Driven, kind: pivot, experiment: drives, index: [method], columns: [value], values: *length}
"""


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """The folder in which a study of liars was run as far as it goes, and what the workflow told."""
    folder = tmp_path_factory.mktemp("truth")
    study = folder / "liars"
    study.mkdir()
    answers = {"honest": "answer", "loops": "never_ends(1)"} | {name: answer for name, (answer, _) in TOLD.items()}
    for name, answer in answers.items():
        (study / f"{name}.py").write_text(PLANNER.replace("ANSWER", answer))
    methods = [f"{name}: {{planner: {name}.py}}" for name in answers]
    drives = {f"{name}_drives": f"{{planner: {name}.py, policy: blind}}" for name in ("honest", *DRIVEN)}
    methods += [f"{name}: {method}" for name, method in drives.items()]
    words = {"methods": ", ".join(methods), "names": ", ".join(answers), "drives": ", ".join(drives)}
    (study / "experiments.yaml").write_text(EXPERIMENTS.format(**words))
    (study / "artefacts.yaml").write_text(ARTEFACTS)
    command = [sys.executable, "-m", "snakemake", "-s", str(ROOT / "Snakefile"), "--workflow-profile", "none", "--cores", "2"]
    target = [
        "results/smoke/liars/tables/all.csv",
        "results/smoke/liars/tables/driven.csv",
        "--keep-going",
        "--config",
        f"studies=[{study}]",
    ]
    done = subprocess.run([*command, *target], cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    return folder, done


@pytest.mark.parametrize(("run", "method"), REFUSED)
def test_liar_is_refused_by_name_in_one_line(ended, run, method):
    folder, done = ended
    told = f"run liars/{run}/0: the answer of planner liars/{method}.py: {TOLD[method][1]}"
    assert sum(told in line for line in done.stderr.splitlines()) == 1
    experiment, _, job = run.split("/")
    assert told in (folder / f"results/smoke/liars/logs/runs/{experiment}/{job}/0.log").read_text()


def test_kernel_that_never_ends_is_ended_by_name(ended):
    folder, done = ended
    told = LOOPS.format(folder="liars")
    assert sum(told in line for line in done.stderr.splitlines()) == 1
    assert told in (folder / "results/smoke/liars/logs/runs/roads/loops/0.log").read_text()


def test_no_table_shows_them_and_the_honest_one_ran(ended):
    folder, done = ended
    assert done.returncode != 0
    assert [file.parent.name for file in folder.glob("results/**/runs/roads/*/0.parquet")] == ["honest"]
    assert [file.parent.name for file in folder.glob("results/**/runs/drives/*/0.parquet")] == ["honest_drives"]
    assert not list(folder.glob("results/**/tables/*"))
    assert "Traceback" not in done.stderr
