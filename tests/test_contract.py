"""The contract tests: planners of the package pass, bad ones fail for exactly the right fact, bad
input ends in one line.
"""

import random
import re
from pathlib import Path

import numpy as np
import pytest
from studies import studies

from bezierplan.geometry import checker, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.planners import known_planners
from bezierplan.running import contract, execution, interface
from bezierplan.schema.checked import Fault
from bezierplan.study.jobs import job

ROOT = Path(__file__).parents[1]


def settings_in_force() -> dict[str, dict]:
    """Planner -> its settings in the first experiment of a study that runs it."""
    found = {}
    for study in studies().values():
        for experiment in study.experiments:
            for method in study.methods_of(experiment):
                described = job(study, experiment, method, "smoke", 0)
                condition = described.conditions()[0]
                found.setdefault(study.planner(method), execution.settings_in(described, condition))
    return found


SETTINGS = settings_in_force()

WALK = """
import math
import random
from typing import Annotated, Literal

import numpy as np
from numba import njit

from bezierplan.geometry import shortest_paths
from bezierplan.planners import Path, Plan, Range

KEPT = np.random.default_rng(0)


def plan(problem, rng, *, evaluations: Annotated[int, Range(1)]):
    start, target = problem.start, problem.target
    middles = rng.uniform(0, 1, (evaluations, 2)) + start
    lengths = np.hypot(*(middles - start).T) + np.hypot(*(middles - target).T)
    history = np.minimum.accumulate(lengths)
    path = Path("polyline", np.array([start, middles[lengths.argmin()], target]))
    return Plan(path, history[-1], claimed_feasible=True, evaluations=evaluations, history=history,
                stop="evaluations", extra={"tries": 1})
"""
DRAWN = "rng.uniform(0, 1, (evaluations, 2)) + start"
RETURN = "    return Plan("
RESET = "rng.bit_generator.state = np.random.default_rng(0).bit_generator.state"
LEAVES = "import subprocess; subprocess.Popen(['sleep', '600'], start_new_session=True)"

# A fault of a planner: what stands in WALK, what stands there instead, and the fact that fails.
BAD = {
    "draws from numpy": (
        DRAWN,
        "np.random.uniform(0, 1, (evaluations, 2)) + start",
        "global generators",
    ),
    "draws from random": (DRAWN, f"{DRAWN} + random.random()", "global generators"),
    "seeds numpy": (
        "    start, target",
        "    np.random.seed(5)\n    start, target",
        "global generators",
    ),
    "draws from numba's generator": (
        DRAWN,
        f"{DRAWN} + njit(lambda: np.random.random())()",
        "global generators",
    ),
    "draws from a generator of its own": (DRAWN, f"{DRAWN} + KEPT.random()", "same bits"),
    "puts its generator back to the first state": (
        "    start, target",
        f"    {RESET}\n    start, target",
        "generators",
    ),
    "is not deterministic as it says": ("KEPT =", "deterministic = True\nKEPT =", "generators"),
    "exits": (RETURN, f"    raise SystemExit\n{RETURN}", "plan"),
    "leaves a process behind": (RETURN, f"    {LEAVES}\n{RETURN}", "plan"),
    "replaces a function of a library": (
        RETURN,
        f"    np.isfinite = math.isfinite\n{RETURN}",
        "plan",
    ),
    "draws from entropy": ("rng.uniform", "np.random.default_rng().uniform", "same bits"),
    "changes an array of the problem": (
        "    start, target",
        "    problem.workspace.radii[:] *= 0.5\n    start, target",
        "plan",
    ),
    "puts another array into the problem": (
        "    start, target",
        '    object.__setattr__(problem.workspace, "radii", problem.workspace.radii * 0.5)\n    '
        "start, target",
        "problem unchanged",
    ),
    "starts elsewhere": ("np.array([start,", "np.array([np.add(start, 1e-9),", "path"),
    "ends elsewhere": ("target])", "np.add(target, 1e-9)])", "path"),
    "its history rises": ("np.minimum.accumulate(lengths)", "np.sort(lengths)", "history"),
    "its history has a gap": (RETURN, f"    history[0] = np.nan\n{RETURN}", "plan"),
    "its history ends with something else": ("history[-1],", "history[-1] + 1,", "history"),
    "claims wrongly and to be exact": ("KEPT =", "exact = True\nKEPT =", "claims"),
    "uses too many evaluations": (
        "evaluations=evaluations",
        "evaluations=evaluations + 1",
        "budget",
    ),
    "counts fewer evaluations than its history": (
        "evaluations=evaluations",
        "evaluations=evaluations - 1",
        "budget",
    ),
    "an extra column has a taken name": ('"tries"', '"length"', "extra columns"),
    "an extra column has the name of a setting": ('"tries"', '"evaluations"', "extra columns"),
    "an extra column is there at times": (
        '{"tries": 1}',
        '{"tries": 1} if start == target else {}',
        "extra columns",
    ),
    "raises": ("rng.uniform", "rng.unifrom", "plan"),
    "claims without a path": ("Plan(path,", "Plan(None,", "plan"),
    "its objective is not a number": ("history[-1],", "math.nan,", "plan"),
    "its objective is text": ("history[-1],", "str(history[-1]),", "plan"),
    "its claim is a word": ("claimed_feasible=True", 'claimed_feasible="yes"', "plan"),
    "its evaluations are no whole number": (
        "evaluations=evaluations",
        "evaluations=1.0 * evaluations",
        "plan",
    ),
    "its history is a list": ("history=history", "history=history.tolist()", "plan"),
    "its history is empty": ("history=history", "history=history[:0]", "plan"),
    "its extra is text": ('{"tries": 1}', '{"tries": "one"}', "plan"),
    "its curve is unknown": ('"polyline"', '"polylines"', "plan"),
    "its path is no Path": ('Path("polyline", ', '("polyline", ', "plan"),
    "its points are not finite": ("target])", "target]) * math.inf", "plan"),
    "its points are flat": ("target])", "target]).ravel()", "plan"),
    "returns a path": (RETURN, f"    return path\n{RETURN}", "plan"),
    "check changes the settings": (
        "def plan(",
        'def check(settings):\n    settings["evaluations"] = 1\n\n\ndef plan(',
        "settings unchanged",
    ),
}


def changed(old, new):
    """WALK with another text in one place."""
    assert old in WALK
    return WALK.replace(old, new, 1)


def written(folder, source, workspaces=("circles",)):
    file = folder / "walk.py"
    file.write_text(f"workspaces = {workspaces}\n{source}")
    return str(file)


def failed(planner, settings):
    findings = list(contract.check_planner(planner, settings))
    assert not any("\n" in str(finding) for finding in findings)
    return [finding for finding in findings if not finding.passed]


def test_every_other_planner_of_the_package_is_run_by_a_study():
    assert sorted(SETTINGS) == known_planners()


@pytest.mark.parametrize("planner", known_planners())
def test_planners_of_the_package_pass(planner):
    assert not failed(planner, SETTINGS[planner])


def test_a_planner_in_a_file_passes_on_every_kind_of_workspace(tmp_path):
    file = written(tmp_path, WALK, ("grid", "circles", "polygons"))
    findings = list(contract.check_planner(file, {"evaluations": 20}))
    assert all(finding.passed for finding in findings)
    assert {finding.problem.split(":")[0] for finding in findings} == {
        "grid",
        "circles",
        "polygons",
        "all problems",
    }
    assert contract.Finding("circles: open", "budget", True, "20 evaluations") in findings


@pytest.mark.parametrize("fault", BAD, ids=str)
def test_bad_planner_fails_for_its_fault_alone(fault, tmp_path):
    old, new, fact = BAD[fault]
    assert {
        finding.fact
        for finding in failed(written(tmp_path, changed(old, new)), {"evaluations": 20})
    } == {fact}


def test_planner_that_raises_without_a_way_fails_there_alone(tmp_path):
    source = changed(
        "    start, target",
        "    if math.isinf(shortest_paths.shortest_path(problem).length):\n        raise "
        'RuntimeError("no\\nway")\n    start, target',
    )
    assert failed(written(tmp_path, source), {"evaluations": 20}) == [
        contract.Finding("circles: sealed target", "plan", False, "raises RuntimeError: no way")
    ]


def test_feasible_path_to_a_sealed_target_fails(tmp_path):
    """Such a path ends elsewhere, which is reported as well."""
    source = changed("middles[lengths.argmin()], target]", "start]")
    assert ("circles: sealed target", "no way") in [
        finding[:2] for finding in failed(written(tmp_path, source), {"evaluations": 20})
    ]


def test_wrong_claims_of_a_planner_that_is_not_exact_are_counted():
    findings = {finding[:2]: finding for finding in contract.check_planner("straight_line", {})}
    assert findings["grid: obstacle in the way", "claims"].passed
    assert (
        findings["grid: obstacle in the way", "claims"].detail
        == "3 paths claimed feasible, 0 by the checker"
    )
    assert findings["grid: open", "claims"].detail == "3 paths claimed feasible, 3 by the checker"


def test_global_generators_get_their_state_back(tmp_path):
    old, new, _ = BAD["draws from numpy"]
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002
    before = random.getstate(), np.random.get_state()[1].tolist()  # noqa: NPY002
    failed(written(tmp_path, changed(old, new)), {"evaluations": 20})
    assert (random.getstate(), np.random.get_state()[1].tolist()) == before  # noqa: NPY002


def test_there_are_problems_of_every_kind_of_workspace():
    assert [*contract.PROBLEMS] == [*interface.KINDS.values()]


@pytest.mark.parametrize("kind", contract.PROBLEMS)
def test_problems_are_legal_and_only_the_sealed_one_has_no_way(kind):
    for problem in contract.PROBLEMS[kind]():
        blocked = region(problem.workspace)
        for point in (problem.start, problem.target):
            assert checker.check(np.array([[point, point]]), blocked).feasible
        assert np.isinf(shortest_paths.shortest_path(problem).length) == problem.name.endswith(
            "sealed target"
        )


def test_many_missing_settings_are_named_without_their_meanings():
    with pytest.raises(Fault, match=r"are missing: curve, .*, collision_surcharge; `list --sett"):
        contract.check_planner("bca", {})


CHECK = (
    'def check(settings):\n    raise ValueError("evaluations: 20; an odd number is '
    'needed")\n\n\ndef plan('
)
FAULTS = {
    "missing setting": (
        "plan(",
        "plan(",
        {},
        "settings are missing: evaluations: a whole number at least 1",
    ),
    "several missing settings": (
        "Range(1)]",
        'Range(1)], share: Annotated[float, Range(0, 1)], rule: Literal["a", "b"], quick: bool',
        {"quick": True},
        "missing: evaluations: a whole number at least 1; "
        "share: a number from 0 to 1; rule: one of a, b",
    ),
    "unknown setting": (
        "plan(",
        "plan(",
        {"evaluation": 20},
        "settings: evaluation: unknown; did you mean evaluations?",
    ),
    "wrong type": (
        "plan(",
        "plan(",
        {"evaluations": "many"},
        "settings: evaluations: 'many'; expected a whole number",
    ),
    "out of range": (
        "plan(",
        "plan(",
        {"evaluations": 0},
        "settings: evaluations: 0; expected a whole number at least 1",
    ),
    "settings that do not fit": (
        "def plan(",
        CHECK,
        {"evaluations": 20},
        "settings: evaluations: 20; an odd number is needed",
    ),
    "default value": (
        "Range(1)]",
        "Range(1)] = 20",
        {},
        "setting evaluations: has a default value",
    ),
    "no annotation": (
        "evaluations: Annotated[int, Range(1)]",
        "evaluations",
        {},
        "setting evaluations: has no annotation",
    ),
    "wrong annotation": (
        "Annotated[int, Range(1)]",
        "str",
        {},
        "setting evaluations: is annotated with str; expected bool, int,",
    ),
    "no function": (
        "def plan(",
        "def plant(",
        {},
        "no function plan; expected plan(problem, rng, *, <settings>)",
    ),
    "not Python": ("def plan(", "def plan((", {}, ": SyntaxError: "),
    "unknown workspace": (
        "KEPT =",
        'workspaces = ("gird",)\nKEPT =',
        {},
        "workspaces: gird: unknown; did you mean grid?",
    ),
}


@pytest.mark.parametrize("fault", FAULTS, ids=str)
def test_fault_is_told_in_one_line_before_anything_runs(fault, tmp_path):
    old, new, settings, told = FAULTS[fault]
    file = written(tmp_path, changed(old, new))
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


@pytest.mark.parametrize(
    ("does", "told"),
    [
        ("np.isfinite = math.isfinite", "replaces numpy.isfinite; a planner leaves other modules"),
        (LEAVES, "leaves a process behind, which is ended; end or join what it starts"),
        ("raise SystemExit", "raises sys.exit"),
    ],
)
def test_what_is_wrong_with_a_run_is_told(does, told, tmp_path):
    file = written(tmp_path, changed(RETURN, f"    {does}\n{RETURN}"))
    findings = [each for each in failed(file, {"evaluations": 8}) if each.fact == "plan"]
    assert findings
    assert all(each.detail.startswith(told) for each in findings)


def test_order_that_is_another_in_each_process_is_found(tmp_path):
    """The order of a set of 64 words: two processes agree almost never."""
    words = {f"w{n}": n for n in range(64)}
    file = written(
        tmp_path,
        changed(
            "    lengths =",
            f"    numbers, words = {words}, set({words})\n"
            "    middles[0, 1] += 1e-6 * sum(n * numbers[word] for n, word in enumerate(words))\n"
            "    lengths =",
        ),
    )
    assert not failed(file, {"evaluations": 8})
    found = list(contract.check_elsewhere(file, {"evaluations": 8}))
    assert {each.fact for each in found if not each.passed} == {"another process"}
    (tmp_path / "sound").mkdir()
    file = written(tmp_path / "sound", WALK)
    assert all(each.passed for each in contract.check_elsewhere(file, {"evaluations": 8}))
