"""Kernels without compilation (NUMBA_DISABLE_JIT), for debuggers and coverage: the same answers,
bit for bit.
"""

import json
import pkgutil
from collections.abc import Iterable
from pathlib import Path

import starts
from studies import study
from test_checker import TOUCHING
from test_region import WORKSPACES

import bezierplan
from bezierplan.analysis.stored_runs import format_row
from bezierplan.commands import replay
from bezierplan.geometry import shortest_paths
from bezierplan.geometry.checker import check
from bezierplan.workspaces.problem import Problem

ROOT = Path(__file__).resolve().parents[1]
RUN = "song2016/routes/0_15/straight_line/0"


def digits(numbers: Iterable[float]) -> str:
    """Numbers with all digits, of whatever type: compiled code returns those of Python, the others
    are numpy's.
    """
    return " ".join(float(number).hex() for number in numbers)


def answers() -> dict[str, str]:
    """What the checker and the exact shortest paths answer, with all digits."""
    found = {
        case: digits(check(pieces, blocked)) for case, (blocked, pieces, _) in TOUCHING.items()
    }
    for name, workspace in WORKSPACES.items():
        shortest = shortest_paths.shortest_path(Problem(name, workspace, (0.5, 3.0), (9.5, 5.5)))
        found[name] = digits((shortest.length, *shortest.points.ravel()))
    return found


def modules() -> list[str]:
    """All modules of the package but the one that is a program."""
    walk = pkgutil.walk_packages(bezierplan.__path__, "bezierplan.")
    return [each.name for each in walk if not each.name.endswith("__main__")]


def run_again() -> str:
    """A run, as text, without the times."""
    made = replay.replay(RUN, {"song2016": study("song2016")})
    run = made.runs.iloc[0]
    return format_row({name: value for name, value in run.to_dict().items() if name != "cpu_s"})


def test_the_checker_and_a_run_answer_the_same_without_compilation():
    """In a process that has imported all modules."""
    imports = "import importlib, json, test_uncompiled as own"
    code = "[importlib.import_module(name) for name in own.modules()]"
    code += "; print(json.dumps([own.answers(), own.run_again()]))"
    said = starts.python(f"{imports}; {code}", ROOT, ROOT / "tests", NUMBA_DISABLE_JIT="1")
    assert json.loads(said) == [answers(), run_again()]
