"""Planners of a reader's own, with modules of the reader's own beside them."""

from bezierplan.planners import planner_module

PLANNER = """
import json

import shared
from parts import steps


def plan(problem, rng, *, tries: int):
    return json.dumps(shared.VALUE + steps.VALUE)
"""


def folder_with(folder, value):
    (folder / "parts").mkdir(parents=True)
    (folder / "walk.py").write_text(PLANNER)
    (folder / "shared.py").write_text(f"VALUE = {value}\n")
    (folder / "json.py").write_text("raise RuntimeError('no library')\n")
    (folder / "parts" / "__init__.py").write_text("")
    (folder / "parts" / "steps.py").write_text("from .more import VALUE\n")
    (folder / "parts" / "more.py").write_text(f"VALUE = 10 * {value}\n")
    return str(folder / "walk.py")


def test_planners_find_the_modules_beside_them_and_no_others(tmp_path):
    first, second = (planner_module(folder_with(tmp_path / str(value), value)) for value in (1, 2))
    assert [each.plan(None, None, tries=1) for each in (first, second, first)] == ["11", "22", "11"]
