"""Planners, one file each, and their interface.

A planner is a module with a function

    plan(problem, rng, *, <settings>) -> Plan

whose keyword-only arguments are its settings, all without default values: annotated with `bool`, `int`, `float`, `Literal[...]`, or
`Annotated[int, Range(...)]`. It may also have `workspaces`, the kinds of workspace that it supports; `exact = True`, if its own feasibility
test is meant to agree with the certified check; `keeps_best = False`, if its result can be worse than the best path it found;
`deterministic = True`, if it uses no random numbers; `extra`, the names of its extra columns, so that a study which asks for another is
refused before the first run; `check(settings)`, which raises ValueError for incompatible settings;
`serves(problem)`, which raises ValueError for a problem that the planner cannot solve; `track(problem, rng, **settings)`, the control
points (iterations + 1, n, 2) of the best path after each iteration of the run that `plan` makes with the same arguments, for figures that
show how a run arrived at its path; `resume(problem, rng, last, **settings)`, a `Plan` and what the next call gets as `last`, None at first:
a plan that starts from an earlier one, for robots whose world changes.
"""

import importlib
import importlib.util
import inspect
import math
import sys
import typing
from functools import cache
from pathlib import Path as File
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from bezierplan.workspaces.problem import Path, Problem

__all__ = ["Path", "Plan", "Problem", "Range", "known_planners", "planner_module", "planner_settings", "setting_fault"]


class Plan(NamedTuple):
    """What a planner returns.

    path: None if it found no path to show. objective: its final objective value, by its own definition. claimed_feasible: the result of its
    own feasibility test. evaluations: number of paths whose objective it evaluated. history: (generations + 1,) best objective so far after
    generation 0, 1, .... stop: why it ended. extra: additional columns of the runs table, by name.
    """

    path: Path | None
    objective: float
    claimed_feasible: bool
    evaluations: int
    history: np.ndarray
    stop: str
    extra: dict[str, float | bool]


class Range(NamedTuple):
    """Limits of a setting's value, both inclusive. Infinity is a value only where it is given as a limit: few planners end with it."""

    low: float = -sys.float_info.max
    high: float = sys.float_info.max

    def __str__(self) -> str:
        if self.high >= sys.float_info.max:
            return f"at least {self.low:g}"
        return f"from {self.low:g} to {self.high:g}"


PLACE = ("workspace", "reference", "route", "side", "layout", "obstacles")
"""Keys of a described problem that are columns of the runs table."""


@cache
def planner_module(planner: str) -> ModuleType:
    """The module of a planner: `name` is planners/name.py of this package, `folder/name.py` a user's own file, which can import the modules
    next to it at the top of the file.

    Raises ModuleNotFoundError or FileNotFoundError if there is none.
    """
    if not planner.endswith(".py"):
        return importlib.import_module(f"bezierplan.planners.{planner}")
    spec = importlib.util.spec_from_file_location(File(planner).stem, planner)
    module = importlib.util.module_from_spec(spec)
    folder = File(planner).resolve().parent
    known = set(sys.modules)
    sys.path.append(str(folder))  # last, so that no user file shadows a library
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
        # The planners of another study may have modules of the same name next to them.
        beside = {file.stem for file in folder.iterdir()}
        for name in [name for name in sys.modules.keys() - known if name.split(".")[0] in beside]:
            del sys.modules[name]
    return module


def known_planners() -> list[str]:
    """Names of the planners of this package."""
    return sorted(file.stem for file in File(__file__).parent.glob("*.py") if file.stem != "__init__")


@cache
def planner_settings(module: ModuleType) -> dict[str, Any]:
    """Settings of a planner: name -> annotation, in the order of its signature. Do not modify the result."""
    hints = typing.get_type_hints(module.plan, include_extras=True)
    parameters = inspect.signature(module.plan).parameters.values()
    return {p.name: hints[p.name] for p in parameters if p.kind is inspect.Parameter.KEYWORD_ONLY}


def setting_fault(annotation: Any, value: Any) -> str | None:
    """What is expected instead of a setting's value, or None if the value is valid."""
    limits = Range()
    if type(None) in typing.get_args(annotation):
        annotation = next(part for part in typing.get_args(annotation) if part is not type(None))
    if typing.get_origin(annotation) is typing.Annotated:
        annotation, limits = typing.get_args(annotation)
    if typing.get_origin(annotation) is typing.Literal:
        choices = typing.get_args(annotation)
        return None if value in choices else "one of " + ", ".join(map(str, choices))
    number = {bool: "true or false", int: "a whole number", float: "a number"}[annotation]
    accepted = (int, float) if annotation is float else annotation
    if not isinstance(value, accepted) or (isinstance(value, bool) and annotation is not bool):
        return number
    if annotation is not bool and not limits.low <= value <= limits.high:
        finite = "" if abs(value) < math.inf else "finite "
        return f"a {finite}{number.removeprefix('a ')}" + ("" if limits == Range() else f" {limits}")
    return None
