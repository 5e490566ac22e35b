"""Copy planners' answers once into plain values; only the copy is judged and stored.

Runs, drives, contract tests and `python -m bezierplan plan` all use it, whether an answer comes
from this process or, as text, from another one.
"""

import math
import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from numbers import Integral, Real
from typing import Any

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.geometry.checker.hulls import LARGEST_DEGREE
from bezierplan.geometry.region import Region
from bezierplan.planners import Plan
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.schema.safe_text import describe_in_one_line
from bezierplan.workspaces.problem import Path, Problem

MOST_POINTS = {"bezier": LARGEST_DEGREE + 1, "polyline": 10_000, "cubic_chain": 10_000}
"""Most control points of a curve. The checker judges chains of so many within seconds."""
MOST_BLENDED = 1_000
"""Most control points of other curves, whose matrix grows with the square of their number."""

_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")
_LARGEST_WHOLE = 2**63 - 1
# Larger whole numbers would lose digits in a column that also holds fractions.
_EXACT = 2**53
# numpy's truth value is not a subclass of Python's.
_TRUTHS = (bool, np.bool_)

NO_PATH = checker.Check(False, math.nan, math.nan, math.nan, math.nan, 0)


class Unfit(ValueError):
    """An answer that no row may show. The message is one line that begins with the field."""


@contextmanager
def wrap_errors(name: str) -> Iterator[None]:
    """Turn any exception in a block that runs a planner, or reads its answer, into a
    PlannerFailure.

    name: how the message begins.
    """
    try:
        yield
    except PlannerFailure:
        raise
    except Unfit as fault:
        # Without its cause: that would show a line of our check, and none of the planner's.
        raise PlannerFailure(f"{name}: its answer: {fault}") from None
    except Exception as error:
        # With its cause: the log shows the planner's own lines.
        raise PlannerFailure(f"{name}: {describe_in_one_line(error)}") from error


def convert_answer(answer: Any, names: Collection[str] = ()) -> Plan:
    """Copy a planner's answer into a Plan of plain values, with new float64 arrays for its points
    and history.

    names: names that its extra columns cannot have. Raises Unfit for the first field with another
    type, form or range.
    """
    _require(isinstance(answer, Plan), f"is a {type(answer).__name__}; expected a Plan")
    path, objective, claim, evaluations, history, stop, extra = answer
    if path is not None:
        path = read_path(path)
    _require(
        _is_a(Real, objective) and not math.isnan(objective),
        "objective: expected a number, and not nan",
    )
    _require(isinstance(claim, _TRUTHS), "claimed_feasible: expected true or false")
    _require(
        _is_a(Integral, evaluations) and 0 <= evaluations <= _LARGEST_WHOLE,
        f"evaluations: expected a whole number, at least 0 and at most {_LARGEST_WHOLE}",
    )
    _require(
        _is_array(history, 1, "fiu") and len(history) and not np.isnan(history).any(),
        "history: expected an array of numbers without nan, (generations + 1,)",
    )
    _require(isinstance(stop, str) and stop.isprintable(), "stop: expected a word")
    extra = _convert_extra(extra, names)
    _require(path is not None or not claim, "claimed_feasible: true without a path")
    history = np.array(history, dtype=float)
    return Plan(path, float(objective), bool(claim), int(evaluations), history, stop, extra)


def accept_answer(answer: Any, problem: Problem, names: Collection[str] = ()) -> Plan:
    """Convert an answer, and check that its path joins the problem's start and target. Raises
    Unfit.
    """
    plan = convert_answer(answer, names)
    check_ends(plan.path, problem)
    return plan


def check_columns(plan: Plan, first: Plan, finite: bool) -> None:
    """Raise Unfit if a plan's own columns differ from those of the planner's first run.

    finite: refuse infinite numbers in them too.
    """
    for name in {**first.extra, **plan.extra}:
        pair = plan.extra.get(name), first.extra.get(name)
        # A column of a table has one type in all rows.
        if None in pair or len({isinstance(value, _TRUTHS) for value in pair}) > 1:
            raise Unfit(
                f"column {name}: missing, or a truth and a number in two runs; a table needs the "
                "same columns in each row"
            )
        if finite and math.isinf(pair[0]):
            raise Unfit(f"column {name}: {pair[0]}; expected a finite number, or nan for none")


def check_history(plan: Plan, keeps_best: bool) -> None:
    """Raise Unfit if a planner keeps the best path, but its history rises or does not end with the
    objective of its path.
    """
    history, last = plan.history, plan.history[-1]
    _require(
        not keeps_best or (history[1:] <= history[:-1]).all(),
        "history: rises; expected the best objective so far, or keeps_best = False",
    )
    _require(
        not keeps_best or not plan.path or last == plan.objective,
        f"objective: {plan.objective}; expected the last of history, {last}, or keeps_best = False",
    )


def check_ends(path: Path | None, problem: Problem) -> None:
    """Raise Unfit if an end of a path differs from the problem's.

    The comparison is bitwise, without a tolerance: a curve begins and ends at control points, and a
    planner copies the problem's own numbers into these, so nothing is rounded.
    """
    for end, place in zip(("start", "target"), curves.ends(path.curve) if path else ()):
        wanted, point = getattr(problem, end), tuple(path.points[place].tolist())
        if point != wanted:
            raise Unfit(f"path: {end}: {point}; expected exactly {wanted}")


def store_path(path: Path | None) -> tuple[str, list[float]]:
    """Return a path as a row stores it: its curve, and its control points flat as x0, y0, x1, y1,
    ...; both are empty without a path.
    """
    return ("", []) if path is None else (path.curve, path.points.ravel().tolist())


def restore_path(curve: str, points: Any) -> Path | None:
    """Return the path that `store_path` stored, or None."""
    return Path(curve, np.array(points, dtype=float).reshape(-1, 2)) if curve else None


def judge_path(path: Path | None, blocked: Region) -> dict[str, Any]:
    """Return the columns of a row that a path alone decides, without a path nan and false.

    Lengths, depth and clearance are in the unit of the workspace (`columns.Outcome`). Raises
    ValueError for a path whose control points the checker refuses.
    """
    length, check = math.nan, NO_PATH
    if path:
        pieces = curves.bezier_pieces(path)
        check = checker.check(pieces, blocked)  # which refuses what has no length
        length = curves.length_of(pieces)
    return {
        "length": length,
        "feasible": check.feasible,
        "collision_at": check.collision_at,
        "collision_depth": check.depth,
        "clearance": check.clearance,
        "clearance_error": check.tolerance,
    }


# --------------------------------------------------------------------------------------------------
# The fields


def read_path(path: Any) -> Path:
    """Copy a path into plain values. Raises Unfit."""
    _require(isinstance(path, Path), "path: expected None or a Path")
    if path.curve not in curves.CURVES:
        raise Unfit(f"path: curve: {path.curve!r}; expected one of {', '.join(curves.CURVES)}")
    _require(
        _is_array(path.points, 2, "f") and path.points.shape[1] == 2,
        "path: points: expected an array of floats, (n, 2)",
    )
    most = MOST_POINTS.get(path.curve, MOST_BLENDED)
    _require(
        len(path.points) <= most,
        f"path: points: {len(path.points)}; expected at most {most} of a {path.curve}",
    )
    # In rows: an array in columns is another type, for which kernels compile once more.
    copy = Path(path.curve, np.array(path.points, dtype=float, order="C"))
    _require(np.isfinite(copy.points).all(), "path: points: expected finite numbers")
    try:
        # The checker refuses coordinates and degrees that are too large; an exception later would
        # end a whole study.
        checker.refuse_unfit(curves.bezier_pieces(copy))
    except ValueError as error:
        raise Unfit(f"path: {' '.join(str(error).split())}") from None
    return copy


def _require(truth: Any, message: str) -> None:
    """Raise Unfit with a message unless something is true of an answer."""
    if not truth:
        raise Unfit(message)


def _convert_extra(columns: Any, names: Collection[str]) -> dict[str, float | bool]:
    """Return the extra columns as plain values; raise Unfit for a name that no column can have or
    one of `names`, and for a value that is no truth and no number, a whole one of at most `_EXACT`.
    """
    _require(isinstance(columns, dict), "extra: expected names with numbers or truths")
    for name in columns:
        _require(
            isinstance(name, str) and _NAME.fullmatch(name),
            f"extra: {name!a}: expected a name of at most 64 small letters, digits and underscores",
        )
        _require(name not in names, f"extra: {name}: a column or setting has this name already")
    return {name: _convert_column(name, value) for name, value in columns.items()}


def _convert_column(name: str, value: Any) -> float | bool:
    """Return the value of an extra column as a bool, int or float. Raises Unfit."""
    if isinstance(value, _TRUTHS):
        return bool(value)
    whole = isinstance(value, Integral)
    _require(
        isinstance(value, Real) and not (whole and abs(value) > _EXACT),
        f"extra: {name}: expected a number, a whole one of at most 2**53, or a truth",
    )
    return int(value) if whole else float(value)


def _is_a(kind: type, value: Any) -> bool:
    """Return whether a value is a number of a kind, and not a boolean."""
    return isinstance(value, kind) and not isinstance(value, _TRUTHS)


def _is_array(value: Any, dimensions: int, kinds: str) -> bool:
    """Return whether a value is an array with a number of dimensions and one of the numpy kinds
    (letters).
    """
    return isinstance(value, np.ndarray) and value.ndim == dimensions and value.dtype.kind in kinds
