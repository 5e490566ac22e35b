"""What code of a planner replaces in other modules is told by name and put back."""

import builtins
import math
import os
import sys
import warnings

import numpy as np
import pytest

import bezierplan as bp
from bezierplan.geometry import checker, shortest_paths
from bezierplan.running import tampering
from bezierplan.running.watchdog import PlannerFailure
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem

CHECK, BOUND = "bezierplan.geometry.checker.Check", "bezierplan.geometry.shortest_paths.graph.Bound"


@pytest.mark.parametrize(
    ("home", "name", "told"),
    [
        (np, "isfinite", "numpy.isfinite"),
        (np.linalg, "norm", "numpy.linalg.norm"),
        (math, "pi", "math.pi"),
        (builtins, "open", "builtins.open"),
        (checker, "check", "bezierplan.geometry.checker.check"),
        (checker.Check, "feasible", f"{CHECK}.feasible"),
        (shortest_paths.Bound, "length", f"{BOUND}.length"),
        (Problem, "__new__", "bezierplan.workspaces.problem.Problem.__new__"),
    ],
)
@pytest.mark.parametrize("fails", [False, True])
def test_what_is_replaced_is_told_and_put_back(home, name, told, fails):
    before = getattr(home, name)

    def planned():
        with tampering.left_alone("it"):
            setattr(home, name, 1)
            if fails:
                raise ZeroDivisionError

    with pytest.raises(PlannerFailure, match=f"^it: replaces {told}; a planner leaves other"):
        planned()
    assert getattr(home, name) is before


def test_what_is_removed_is_put_back():
    kept = math.hypot, sys.modules["bezierplan.geometry.checker"]
    with (
        pytest.raises(PlannerFailure, match=r"replaces math\.hypot;"),
        tampering.left_alone("it"),
    ):
        del math.hypot, sys.modules["bezierplan.geometry.checker"]
    assert (math.hypot, sys.modules["bezierplan.geometry.checker"]) == kept


@pytest.mark.parametrize(
    ("home", "name", "told"),
    [
        (checker, "max", "bezierplan.geometry.checker.max"),
        (shortest_paths.Bound, "gap", f"{BOUND}.gap"),
    ],
)
def test_what_is_added_is_told_and_taken_away(home, name, told):
    with pytest.raises(PlannerFailure, match=f"replaces {told};"), tampering.left_alone("it"):
        setattr(home, name, 1)
    assert name not in vars(home)


def doubled(pieces, blocked=None):
    return 2


@pytest.mark.parametrize(
    ("function", "told"),
    [
        (checker.check, "bezierplan.geometry.checker.check"),
        (Grid.in_cells, "bezierplan.workspaces.grid.Grid.in_cells"),
    ],
)
@pytest.mark.parametrize("part", ["__code__", "__defaults__", "__kwdefaults__"])
def test_other_code_of_a_function_is_told_and_put_back(function, told, part):
    before = getattr(function, part)
    with (
        pytest.raises(PlannerFailure, match=f"^it: replaces the code of {told};"),
        tampering.left_alone("it"),
    ):
        setattr(function, part, {"__kwdefaults__": {}}.get(part, getattr(doubled, part)))
    assert getattr(function, part) is before


def test_what_all_share_is_put_back_without_a_word():
    def state():
        return os.getcwd(), sys.stdout, np.geterr(), warnings.filters, sys.getrecursionlimit()

    before = state()
    with tampering.left_alone("it"):
        os.chdir("/")
        sys.stdout = None
        np.seterr(all="raise")
        warnings.simplefilter("error")
        sys.setrecursionlimit(before[-1] - 100)
    assert state() == before
    try:
        with tampering.left_alone("it"):
            sys.setrecursionlimit(before[-1] + 100)
        assert sys.getrecursionlimit() == before[-1] + 100, "a planner may need more"
    finally:
        sys.setrecursionlimit(before[-1])


def test_new_modules_and_a_planners_own_names_are_free(monkeypatch):
    from bezierplan.planners import straight_line

    monkeypatch.setattr(straight_line, "calls", 0, raising=False)
    with tampering.left_alone("it"):
        straight_line.calls = 1
        np.own_name = 2
    del np.own_name


def test_exception_of_the_block_is_raised_if_nothing_is_replaced():
    with pytest.raises(ZeroDivisionError), tampering.left_alone("it"):
        raise ZeroDivisionError


def test_function_that_is_planned_with_may_not_replace_either():
    def hasty(problem, rng):
        np.isfinite = math.isfinite

    free = bp.Grid(np.zeros((4, 4), dtype=bool), 1.0, "m")
    with pytest.raises(ValueError, match=r"^planner hasty: replaces numpy\.isfinite;"):
        bp.plan(bp.Problem("free", free, (0.5, 0.5), (3.5, 3.5)), hasty)
    assert np.isfinite(1)
