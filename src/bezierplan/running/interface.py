"""Whether a file is a planner: the checks that come before any run, for studies and for the contract tests alike."""

import inspect
import traceback
from types import ModuleType
from typing import Any

from bezierplan.planners import planner_module, planner_settings, setting_fault
from bezierplan.schema.checked import Fault, closest

KINDS = ("grid", "circles", "polygons")
"""Kinds of workspace that planners meet."""

_EXPECTED = "expected bool, int, float, Literal, or Annotated with a Range"


def loaded(planner: str, place: str) -> ModuleType:
    """The module of a planner, given as a name or the path of a file. Raises Fault, beginning with a place, unless it can be executed and
    has the interface of a planner (`planners`).
    """
    try:
        module = planner_module(planner)
    except (Exception, SystemExit) as error:  # a user's file can fail in any way
        raise Fault(f"{place}: {_failed(error, planner)}") from None
    if fault := interface_fault(module):
        raise Fault(f"{place}: {fault}")
    return module


def interface_fault(module: ModuleType) -> str | None:
    """What a module lacks to be a planner, or None."""
    plan = getattr(module, "plan", None)
    if not inspect.isfunction(plan):
        return "no function plan; expected plan(problem, rng, *, <settings>)"
    parameters = inspect.signature(plan).parameters.values()
    fixed = [each for each in parameters if each.kind in (each.POSITIONAL_ONLY, each.POSITIONAL_OR_KEYWORD)]
    positional = [each.name for each in fixed if each.default is each.empty]
    if len(positional) != 2 or any(each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD) for each in parameters):
        return "function plan: expected plan(problem, rng, *, <settings>)"
    for each in parameters:
        if each.kind is each.KEYWORD_ONLY and each.default is not each.empty:
            return f"setting {each.name}: has a default value; a study gives a value to every setting"
        if each.kind is each.KEYWORD_ONLY and each.annotation is each.empty:
            return f"setting {each.name}: has no annotation; {_EXPECTED}"
    try:
        annotations = planner_settings(module)
    except Exception as error:
        return f"function plan: its annotations cannot be read ({type(error).__name__}: {error})"
    for setting, annotation in annotations.items():
        try:
            setting_fault(annotation, 0)
        except Exception:
            return f"setting {setting}: is annotated with {inspect.formatannotation(annotation)}; {_EXPECTED}"
    return _workspaces_fault(getattr(module, "workspaces", ()))


def _workspaces_fault(served: Any) -> str | None:
    if not isinstance(served, tuple | list):
        return f"workspaces: {served!r}: expected kinds among {', '.join(KINDS)}"
    unknown = [kind for kind in served if kind not in KINDS]
    return f"workspaces: {unknown[0]}: unknown{closest(unknown[0], KINDS)}" if unknown else None


def _failed(error: BaseException, file: str) -> str:
    """What went wrong in an executed file, with the line number if known."""
    if isinstance(error, SyntaxError):
        line = error.lineno
        text = error.msg
    else:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename.endswith(file)]
        line = lines[-1] if lines else None
        text = (str(error).splitlines() or [""])[0]
    return f"{f'line {line}: ' if line else ''}{type(error).__name__}: {text}"
