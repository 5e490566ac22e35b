"""The one door for planners' answers: what comes in is copied once into plain values, and only the
copy is judged and stored.

It serves runs, drives, the contract tests and `python -m bezierplan plan` alike. Types are exact: a
subclass could show one value to the judge and another to the table.
"""

import keyword
import math
import re
from collections.abc import Collection
from typing import Any

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.geometry.checker.hulls import LARGEST_DEGREE
from bezierplan.geometry.region import Region
from bezierplan.planners import Plan
from bezierplan.workspaces.problem import Path, Problem

MOST_POINTS = 10_000
"""Most control points of a chain of pieces that share no matrix; the checker judges them within
seconds.
"""
MOST_BLENDED = 1_000
"""Most control points of other curves, whose matrix grows with the square of their number. Beziers
end at the checker's largest degree.
"""
MOST_HISTORY = 1_000_000
MOST_STOP = 100
"""Most characters of the word for why a planner stopped."""
MOST_EXTRA = 64
MOST_NAME = 64

_CHAINS = ("polyline", "cubic_chain")
_NAME = re.compile(r"[a-z][a-z0-9_]*")
_LARGEST_WHOLE = 2**63 - 1
_TRUTHS = (bool, np.bool_)
_WHOLES = (int, *(np.dtype(code).type for code in "bhilqBHILQ"))
_FLOATS = (float, np.float16, np.float32, np.float64)
# Whole numbers up to this size are floats.
_LARGEST_EXACT = 2**53

NO_PATH = checker.Check(False, math.nan, math.nan, math.nan, math.nan, 0)


class Unfit(ValueError):
    """An answer that no row may show; the message is one line that begins with the field."""


def plain(answer: Any, taken: Collection[str] = ()) -> Plan:
    """A planner's answer as a Plan of plain values, copied once: its points and history are new
    arrays of float64.

    taken: names not allowed for extra columns. Raises Unfit for the first field with another type,
    form, size or range.
    """
    if type(answer) is not Plan:
        raise Unfit(f"is a {type(answer).__name__}; expected a Plan")
    path = None if answer.path is None else path_of(answer.path)
    plan = Plan(
        path=path,
        objective=_objective(answer.objective),
        claimed_feasible=_claim(answer.claimed_feasible),
        evaluations=_evaluations(answer.evaluations),
        history=_history(answer.history),
        stop=_stop(answer.stop),
        extra=_extra(answer.extra, taken),
    )
    if path is None and plan.claimed_feasible:
        raise Unfit("claimed_feasible: true without a path")
    return plan


def accepted(answer: Any, problem: Problem, taken: Collection[str]) -> Plan:
    """`plain`, of an answer whose path joins the problem's start and target. Raises Unfit."""
    plan = plain(answer, taken)
    check_ends(plan, problem)
    return plan


def check_ends(plan: Plan, problem: Problem) -> None:
    """Raise Unfit if an end of a plan's path differs from the problem's.

    The comparison is bitwise, without a tolerance: a curve begins and ends at control points, into
    which a planner copies the problem's own numbers, so nothing is rounded.
    """
    if plan.path is None:
        return
    for end, place in zip(("start", "target"), curves.ends(plan.path.curve)):
        wanted, point = getattr(problem, end), tuple(plan.path.points[place].tolist())
        if point != wanted:
            raise Unfit(f"path: {end}: {point}; expected exactly {wanted}")


def stored(path: Path | None) -> tuple[str, list[float]]:
    """A path as a row stores it: its curve, and its control points flat as x0, y0, x1, y1, ...;
    empty without a path.
    """
    return ("", []) if path is None else (path.curve, path.points.ravel().tolist())


def restored(curve: str, points: Any) -> Path | None:
    """The path that `stored` wrote."""
    return Path(curve, np.array(points, dtype=float).reshape(-1, 2)) if curve else None


def verdict(path: Path | None, blocked: Region) -> tuple[float, checker.Check]:
    """Length and verdict of a path; without one, not a number and `NO_PATH`."""
    if path is None:
        return math.nan, NO_PATH
    pieces = curves.bezier_pieces(path)
    check = checker.check(pieces, blocked)  # which refuses what has no length
    return curves.length_of(pieces), check


# --------------------------------------------------------------------------------------------------
# The fields. Each function returns the plain value of a field, or raises Unfit.


def path_of(path: Any) -> Path:
    """A path as plain values. Raises Unfit."""
    if type(path) is not Path:
        raise Unfit("path: expected None or a Path")
    if type(path.curve) is not str:
        raise Unfit(
            f"path: curve: is a {type(path.curve).__name__}; expected one of "
            f"{', '.join(curves.CURVES)}"
        )
    if not _is_array(path.points, 2, "f") or path.points.shape[1] != 2:
        raise Unfit("path: points: expected an array of floats, (n, 2)")
    if path.curve in curves.CURVES and len(path.points) > _most_points(path.curve):
        raise Unfit(
            f"path: points: {len(path.points)}; "
            f"expected at most {_most_points(path.curve)} of a {path.curve}"
        )
    points = np.array(path.points, dtype=float, order="C")
    if not np.isfinite(points).all():
        raise Unfit("path: points: expected finite numbers")
    copy = Path(path.curve, points)
    try:
        # A path that the checker rejects would abort a study: a coordinate too large, a degree too
        # high.
        checker.refuse_unfit(curves.bezier_pieces(copy))
    except ValueError as error:
        raise Unfit(f"path: {_one_line(error)}") from None
    return copy


def _most_points(curve: str) -> int:
    if curve == "bezier":
        return LARGEST_DEGREE + 1
    return MOST_POINTS if curve in _CHAINS else MOST_BLENDED


def _objective(value: Any) -> float:
    if type(value) not in (*_FLOATS, *_WHOLES):
        raise Unfit("objective: expected a number, and not nan")
    try:
        objective = float(value)
    except OverflowError:
        raise Unfit("objective: expected a number that a float can hold") from None
    if math.isnan(objective):
        raise Unfit("objective: expected a number, and not nan")
    return objective


def _claim(value: Any) -> bool:
    if type(value) not in _TRUTHS:
        raise Unfit("claimed_feasible: expected true or false")
    return bool(value)


def _evaluations(value: Any) -> int:
    if type(value) not in _WHOLES or not 0 <= value <= _LARGEST_WHOLE:
        raise Unfit(
            f"evaluations: expected a whole number, at least 0 and at most {_LARGEST_WHOLE}"
        )
    return int(value)


def _history(values: Any) -> np.ndarray:
    if not _is_array(values, 1, "fiu") or not 0 < len(values) <= MOST_HISTORY:
        raise Unfit(
            "history: expected an array of numbers without nan, (generations + 1,), of at most "
            f"{MOST_HISTORY} values"
        )
    if (
        values.dtype.kind != "f"
        and not -_LARGEST_EXACT <= int(values.min()) <= int(values.max()) <= _LARGEST_EXACT
    ):
        raise Unfit(
            "history: expected whole numbers between "
            f"-{_LARGEST_EXACT} and {_LARGEST_EXACT}, or floats"
        )
    history = np.array(values, dtype=float)
    if np.isnan(history).any():
        raise Unfit("history: expected an array of numbers without nan, (generations + 1,)")
    return history


def _stop(value: Any) -> str:
    if type(value) is not str or len(value) > MOST_STOP or not value.isprintable():
        raise Unfit(f"stop: expected a word, of at most {MOST_STOP} printable characters")
    return value


def _extra(columns: Any, taken: Collection[str]) -> dict[str, float | bool]:
    if type(columns) is not dict or not all(type(name) is str for name in columns):
        raise Unfit("extra: expected names with numbers or truths")
    if len(columns) > MOST_EXTRA:
        raise Unfit(f"extra: {len(columns)} columns; expected at most {MOST_EXTRA}")
    for name in columns:
        if not _NAME.fullmatch(name) or len(name) > MOST_NAME or keyword.iskeyword(name):
            shown = ascii(name[:20])
            raise Unfit(
                f"extra: {shown}: expected a name of at most {MOST_NAME} small letters, digits "
                "and underscores, and no keyword"
            )
        if name in taken:
            raise Unfit(f"extra: {name}: a column or setting has this name already")
    return {name: _column(name, value) for name, value in columns.items()}


def _column(name: str, value: Any) -> float | bool:
    if type(value) in _TRUTHS:
        return bool(value)
    if type(value) in _FLOATS:
        return float(value)
    if type(value) not in _WHOLES or not -_LARGEST_WHOLE - 1 <= value <= _LARGEST_WHOLE:
        raise Unfit(f"extra: {name}: expected a number within 64 bits, or a truth")
    return int(value)


def _is_array(value: Any, dimensions: int, kinds: str) -> bool:
    """Whether a value is an array, and no subclass, with a number of dimensions and a dtype kind
    among the given numpy letters.
    """
    return type(value) is np.ndarray and value.ndim == dimensions and value.dtype.kind in kinds


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
