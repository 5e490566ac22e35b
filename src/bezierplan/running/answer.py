"""Validate a planner's answer: the one check made before every row of a runs table and in the contract tests."""

import math
import numbers
from collections.abc import Collection
from typing import Any

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.planners import Plan
from bezierplan.workspaces.problem import Path, Problem


def fault(plan: Any, problem: Problem, taken: Collection[str]) -> str:
    """The first fault in an answer to a problem, as one line that begins with the field; empty if there is none.

    taken: names not allowed for extra columns.
    """
    return plan_fault(plan) or ends_fault(plan, problem) or names_fault(plan, taken)


def plan_fault(plan: Any) -> str:
    """The first field of a plan whose type or form differs from `problem.Plan`; empty if there is none."""
    if not isinstance(plan, Plan):
        return f"is a {type(plan).__name__}; expected a Plan"
    fit = {
        "objective: expected a number, and not nan": _is_number(plan.objective) and not math.isnan(plan.objective),
        "claimed_feasible: expected true or false": isinstance(plan.claimed_feasible, bool | np.bool_),
        "evaluations: expected a whole number, at least 0": _is_whole(plan.evaluations) and plan.evaluations >= 0,
        "history: expected an array of numbers without nan, (generations + 1,)": _is_array(plan.history, 1, "fiu")
        and len(plan.history) > 0
        and not np.isnan(plan.history).any(),
        "stop: expected a word": isinstance(plan.stop, str),
        "extra: expected names with numbers or truths": isinstance(plan.extra, dict)
        and all(isinstance(name, str) and (_is_number(value) or isinstance(value, bool)) for name, value in plan.extra.items()),
        "path: expected None or a Path": plan.path is None or isinstance(plan.path, Path),
    }
    found = next((what for what, right in fit.items() if not right), "")
    if found or plan.path is not None:
        return found or _path_fault(plan.path)
    return "claimed_feasible: true without a path" if plan.claimed_feasible else ""


def _path_fault(path: Path) -> str:
    if not isinstance(path.curve, str):
        return f"path: curve: is a {type(path.curve).__name__}; expected one of {', '.join(curves.CURVES)}"
    if not _is_array(path.points, 2, "f") or path.points.shape[1] != 2:
        return "path: points: expected an array of floats, (n, 2)"
    if not np.isfinite(path.points).all():
        return "path: points: expected finite numbers"
    try:
        # A path that the checker rejects would abort a study: a coordinate too large, a degree too high.
        checker.refuse_unfit(curves.bezier_pieces(path))
    except ValueError as error:
        return f"path: {error}"
    return ""


def ends_fault(plan: Plan, problem: Problem) -> str:
    """Which end of a plan's path differs from the problem's; empty if neither does.

    The comparison is bitwise, without a tolerance: a curve begins and ends at control points, into which a planner copies the problem's
    own numbers, so nothing is rounded.
    """
    if plan.path is None:
        return ""
    for end, place in zip(("start", "target"), curves.ends(plan.path.curve)):
        wanted, point = getattr(problem, end), tuple(plan.path.points[place].tolist())
        if point != wanted:
            return f"path: {end}: {point}; expected exactly {wanted}"
    return ""


def names_fault(plan: Plan, taken: Collection[str]) -> str:
    """The first extra column of a plan whose name is invalid or already taken; empty if there is none."""
    for name in plan.extra:
        if not name.isidentifier():
            return f"extra: {name!r}: expected a name of letters, digits and underscores"
        if name in taken:
            return f"extra: {name}: a column or setting has this name already"
    return ""


def _is_number(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _is_whole(value: Any) -> bool:
    return isinstance(value, numbers.Integral) and not isinstance(value, bool)


def _is_array(value: Any, dimensions: int, kinds: str) -> bool:
    """Whether a value is an array with the given number of dimensions and a dtype kind among the given numpy letters."""
    return isinstance(value, np.ndarray) and value.ndim == dimensions and value.dtype.kind in kinds
