"""The contract tests: planners of the package pass, bad ones fail for exactly the right fact, bad
input ends in one line.
"""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from studies import studies

from bezierplan.geometry import checker, shortest_paths
from bezierplan.geometry.region import build_region
from bezierplan.planners import list_planners
from bezierplan.running import execution
from bezierplan.running.guard import contract, interface
from bezierplan.running.jobs import watchdog
from bezierplan.schema.checked import Fault
from bezierplan.study.jobs import build_chunk

pytestmark = pytest.mark.usefixtures("planners_are_read_here")

# Of searches: the contract is that of a long one.
FEW = {"generations": 5, "iterations": 5, "first_draws": 400}


def settings_in_force() -> dict[str, dict]:
    """Planner -> its settings in the first experiment of a study that runs it, with few rounds of a
    search.
    """
    found = {}
    for study in studies().values():
        for experiment in study.experiments:
            for method in study.methods_of(experiment):
                described = build_chunk(study, experiment, method, "smoke", 0)
                condition = described.conditions()[0]
                settings = execution.resolve_settings(described, condition)
                few = {key: count for key, count in FEW.items() if key in settings}
                found.setdefault(study.planner(method), settings | few)
    return found


SETTINGS = settings_in_force()

WALK = """
import math
from typing import Annotated, Literal

import numpy as np
from numba import njit

from bezierplan.geometry import shortest_paths
from bezierplan.planners import Path, Plan, Range


def plan(problem, rng, *, evaluations: Annotated[int, Range(1)]):
    start, target = problem.start, problem.target
    middles = rng.uniform(0, 1, (evaluations, 2)) + start
    lengths = np.hypot(*(middles - start).T) + np.hypot(*(middles - target).T)
    history = np.minimum.accumulate(lengths)
    path = Path("polyline", np.array([start, middles[lengths.argmin()], target]))
    return Plan(path, history[-1], claimed_feasible=True, evaluations=evaluations, history=history,
                stop="evaluations", extra={"tries": 1})
"""
TITLED = """    title = problem.name.partition(": ")[2]
    if title == {title!r}:
        {fault}
    return Plan("""
# What a planner does on a problem, the fact that finds it, and what is said of it.
FAULTS_OF_RUNS = {
    "another start": (
        "open",
        'path = Path("polyline", np.array([np.add(start, 1e-9), target]))',
        "plan",
        "path: start: ",
    ),
    "a history that rises": (
        "start is target",
        "history = np.sort(lengths)[::1]",
        "history",
        "history: rises; expected the best objective so far",
    ),
    "a budget": (
        "target beside start",
        "evaluations += 1",
        "budget",
        "21 evaluations; expected at most 20",
    ),
    "an end of the history": ("no obstacles", "history[-1] -= 1", "history", "objective: "),
    "random numbers of a kernel": (
        "open",
        "path.points[1] += njit(lambda: np.random.random())()",
        "random numbers",
        "path: another value from the same generator; all random numbers come from rng, and",
    ),
    "an order": (
        "narrow",
        "path.points[1] += sum(n * int(word) for n, word in enumerate({*map(str, range(64))}))",
        "random numbers",
        "another plan in another process; hash()",
    ),
    "a column of two types": (
        "narrow",
        "return Plan(path, history[-1], True, evaluations, history, '', {'tries': True})",
        "plan",
        "column tries: missing, or a truth and a number in two runs",
    ),
    "a column of another": (
        "start is target",
        "return Plan(path, history[-1], True, evaluations, history, '', {'length': 1})",
        "plan",
        "extra: length: a column or setting has this name",
    ),
}
# What ends all runs: the whole line follows the name of the planner.
ENDS = {
    "an exception": (
        'raise RuntimeError("no\\nway")',
        "circles: open: line 21 of walk.py: RuntimeError: no way",
    ),
    "another type": (
        "history = history.tolist()",
        "circles: open: its answer: history: expected an array",
    ),
    "processes": (
        "import subprocess; subprocess.Popen(['sleep', '60'])",
        f"circles: open: {watchdog.LEFT}",
    ),
}
EXACT = "4 paths claimed feasible, 0 by the checker"


def written(folder, source, workspaces=("circles",)):
    file = folder / "walk.py"
    file.write_text(f"workspaces = {workspaces}\n{source}")
    return str(file)


def failed(planner, settings):
    findings = list(contract.check_planner(planner, settings))
    assert not any("\n" in str(finding) for finding in findings)
    return [finding for finding in findings if not finding.passed]


def test_an_experiment_runs_each_planner_of_the_package():
    assert set(list_planners()) - SETTINGS.keys() == set(), "no experiment of a study runs these"


@pytest.mark.parametrize("planner", list_planners())
def test_planners_of_the_package_pass(planner):
    assert not failed(planner, SETTINGS[planner])


def test_a_planner_in_a_file_passes_on_every_kind_of_workspace(tmp_path):
    file = written(tmp_path, WALK, ("grid", "circles", "polygons"))
    findings = list(contract.check_planner(file, {"evaluations": 20}))
    assert all(finding.passed for finding in findings)
    kinds = {finding.problem.split(":")[0] for finding in findings}
    assert kinds == {*interface.KINDS.values(), "all problems"}
    assert contract.ContractFinding("grid: open", "budget", True, "20 evaluations") in findings


@pytest.mark.parametrize("case", FAULTS_OF_RUNS)
def test_a_bad_planner_fails_for_its_fault(case, tmp_path):
    title, deed, fact, told = FAULTS_OF_RUNS[case]
    source = WALK.replace("    return Plan(", TITLED.format(title=title, fault=deed), 1)
    source = source.replace("history[-1], claimed", "lengths.min(), claimed")
    (found,) = failed(written(tmp_path, source), {"evaluations": 20})
    assert found.problem.endswith(title)
    assert (found.fact, found.detail[: len(told)]) == (fact, told)


@pytest.mark.parametrize("case", ENDS)
def test_what_ends_the_runs_is_one_fault(case, tmp_path):
    deed, told = ENDS[case]
    source = WALK.replace("    return Plan(", TITLED.format(title="open", fault=deed), 1)
    (found,) = failed(written(tmp_path, source), {"evaluations": 20})
    assert told in found.detail


@pytest.mark.parametrize(
    ("old", "new", "fact", "told"),
    [
        ("\ndef plan(", "exact = True\n\ndef plan(", "claims", EXACT),
        (
            '"tries": 1',
            '"own": np.inf',
            "plan",
            "column own: inf; expected a finite number, or nan",
        ),
        (
            "    start, target",
            "    rng = np.random.default_rng(5)\n    start, target",
            "random numbers",
            "all repeats are equal and count as one, for it draws no number",
        ),
        (
            "(evaluations, 2)) + start",
            "(evaluations, 2)) + problem.workspace.bounds[1]",
            "paths",
            "none of 32 paths is free",
        ),
    ],
)
def test_a_planner_is_not_what_it_says(old, new, fact, told, tmp_path):
    found = failed(written(tmp_path, WALK.replace(old, new, 1)), {"evaluations": 20})
    assert {each.fact for each in found} == {fact}
    assert found[-1].detail.startswith(told)


def test_wrong_claims_of_a_planner_that_is_not_exact_are_counted():
    found = {each[:2]: each for each in contract.check_planner("straight_line", {})}
    assert found["circles: obstacle in the way", "claims"].detail == EXACT
    assert found["grid: open", "claims"].detail == "4 paths claimed feasible, 4 by the checker"


@pytest.mark.parametrize("kind", interface.KINDS.values())
def test_problems_are_legal_and_only_the_sealed_one_has_no_way(kind):
    for problem in contract.list_problems(SimpleNamespace(workspaces=(kind,))):
        blocked = build_region(problem.workspace)
        for point in (problem.start, problem.target):
            assert checker.check(np.array([[point, point]]), blocked).feasible
        assert np.isinf(shortest_paths.shortest_path(problem).length) == problem.name.endswith(
            contract.SEALED
        )


CHECK = (
    'def check(settings):\n    raise ValueError("evaluations: 20; an odd number is '
    'needed")\n\n\ndef plan('
)
# Settings, what is told of them, and perhaps a text of the planner and another in its place.
FAULTS = {
    "missing setting": ({}, "settings are missing: evaluations: a whole number at least 1"),
    "unknown setting": (
        {"evaluation": 20},
        "settings: evaluation: unknown; did you mean evaluations?",
    ),
    "settings that do not fit": (
        {"evaluations": 20},
        "settings: evaluations: 20; an odd number is needed",
        "def plan(",
        CHECK,
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_told_in_one_line_before_anything_runs(fault, tmp_path):
    settings, told, *change = FAULTS[fault]
    file = written(tmp_path, WALK.replace(*change, 1) if change else WALK)
    with pytest.raises(Fault) as caught:
        contract.check_planner(file, settings)
    message = str(caught.value)
    assert told in message
    assert message.startswith(file)
    assert "\n" not in message


@pytest.mark.parametrize(
    ("planner", "told"),
    [
        (
            "strait_line",
            "strait_line: unknown planner, and not the path of a file that ends in .py; did you "
            "mean straight_line?",
        ),
        ("nowhere/walk.py", "nowhere/walk.py: FileNotFoundError: "),
    ],
)
def test_planner_that_is_not_there_is_told(planner, told):
    with pytest.raises(Fault, match=re.escape(told)):
        contract.check_planner(planner, {})
