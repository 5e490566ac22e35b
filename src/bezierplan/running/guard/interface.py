"""Check that a file is a planner, before any run: for studies and for the contract tests.

A file of unknown origin is first executed in a process of its own (`guard`), because it may end or
stall the process that it is in.
"""

import copy
import inspect
from collections.abc import Callable, Iterable, Iterator
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from bezierplan.planners import find_setting_fault, is_file, load_planner, read_settings
from bezierplan.planners.parts.settings import read_setting
from bezierplan.running.chunk import Settings
from bezierplan.running.guard import process
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.schema.checked import Fault, check_all, describe_known
from bezierplan.schema.safe_text import LONGEST, describe_in_one_line, escape
from bezierplan.workspaces import files

KINDS = {each: kind for kind, each in files.KINDS.items()}
"""Type of a workspace -> its kind, as planners name it."""


def load_planner_module(planner: str, location: str) -> ModuleType:
    """Load the module of a planner, given as a name or the path of a file. Raises Fault, beginning
    with a location, unless it can be executed and has the interface of a planner (`planners`).
    """
    if is_file(planner):
        try:
            _read_traits_of_file(planner)
        except PlannerFailure as failure:
            raise Fault(f"{location}: {failure}") from None
    try:
        return load_planner(planner)
    except Exception as error:  # a user's file can fail the second time alone
        raise Fault(f"{location}: {describe_in_one_line(error)}") from None


class Traits(NamedTuple):
    """The traits of a planner by which its answers are judged: the names of its settings, whether
    it uses no random numbers, and whether its objective is the best of its history.
    """

    settings: list[str]
    deterministic: bool
    keeps_best: bool


def read_traits(planner: str) -> Traits:
    """Return the traits of a planner, given as a name or the path of a file; a file is not executed
    in this process. Raises PlannerFailure if it cannot be executed.
    """
    if is_file(planner):
        try:
            return _read_traits_of_file(planner)
        except PlannerFailure as failure:
            raise PlannerFailure(f"planner {planner}: {failure}") from None
    return _read_traits(load_planner(planner))


@cache
def _read_traits_of_file(planner: str) -> Traits:
    """Import a planner's file in another process, and return its traits. Raises PlannerFailure
    unless it has the interface of one.
    """
    file = str(Path(planner).resolve())
    work = partial(describe_in_process, planner=file)
    (said,) = process.run_function(work, "when it is imported", process.STARTS)
    if isinstance(said, str):
        raise PlannerFailure(said)
    return Traits(*said)


def describe_in_process(begin: Callable[[str], None], planner: str) -> Iterator[Traits | str]:
    """Yield the traits of a planner's file, or what is wrong with it. It runs in a process of its
    own.
    """
    try:
        module = load_planner(planner)
    except BaseException as error:  # a user's file can fail in any way
        yield describe_in_one_line(error)
    else:
        yield find_interface_fault(module) or _read_traits(module)


def _read_traits(module: ModuleType) -> Traits:
    """Return the traits that a planner's module declares."""
    return Traits(
        [*read_settings(module)],
        bool(getattr(module, "deterministic", False)),
        bool(getattr(module, "keeps_best", True)),
    )


def ask(function: Callable[..., Any], location: str, *arguments: Any) -> None:
    """Call a planner's `check` or `serves`, which raises ValueError to report a problem. Raises
    Fault, beginning with a location.
    """
    try:
        # Copies, so that the function cannot change the settings of later runs.
        function(*map(copy.copy, arguments))
        return
    except ValueError as error:
        said = escape(" ".join(str(error).split()), LONGEST) or "ValueError"
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a user's function can fail in any way
        said = f"{function.__name__} of its planner fails ({describe_in_one_line(error)})"
    raise Fault(f"{location}: {said}")


def find_interface_fault(module: ModuleType) -> str:
    """Describe what a module lacks to be a planner; empty if nothing."""
    plan = getattr(module, "plan", None)
    if not callable(plan) or isinstance(plan, type):
        return "no function plan; expected plan(problem, rng, *, <settings>)"
    try:
        # A file with `from __future__ import annotations` has texts in place of annotations.
        parameters = inspect.signature(plan, eval_str=True).parameters.values()
    except Exception as error:
        return f"function plan: its annotations cannot be read ({describe_in_one_line(error)})"
    settings = [each for each in parameters if each.kind is each.KEYWORD_ONLY]
    others = [each for each in parameters if each not in settings]
    if sum(each.default is each.empty for each in others) != 2 or any(
        each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD) for each in others
    ):
        return "function plan: expected plan(problem, rng, *, <settings>)"
    for parameter in settings:
        if parameter.default is not parameter.empty:
            return (
                f"setting {parameter.name}: has a default value; "
                "a study gives a value to every setting"
            )
        try:
            read_setting(parameter.annotation)
        except TypeError:
            annotated = f"is annotated with {inspect.formatannotation(parameter.annotation)}"
            if parameter.annotation is parameter.empty:
                annotated = "has no annotation"
            return (
                f"setting {parameter.name}: {annotated}; expected bool, int, float, Literal, or "
                "Annotated with a Range"
            )
    if isinstance(extra := getattr(module, "extra", ()), str):
        return f"extra: {extra!r}: expected a tuple of names, such as ({extra!r},)"
    # A planner that names none serves all.
    kinds = getattr(module, "workspaces", (*KINDS.values(),))
    if not isinstance(kinds, tuple | list) or not kinds:
        return f"workspaces: {kinds!r}: expected kinds among {', '.join(KINDS.values())}"
    for kind in kinds:
        if kind not in KINDS.values():
            return f"workspaces: {kind}: unknown{describe_known(kind, KINDS.values())}"
    return ""


def refuse_unknown(module: ModuleType, names: Iterable[str], location: str) -> None:
    """Raise Fault, beginning with a location, for a name that is no setting of a planner."""
    check_all(names, read_settings(module), location)


def check_settings(module: ModuleType, settings: Settings, location: str) -> None:
    """Raise Fault, beginning with a location, unless all settings of a planner are there, have the
    right types and ranges, and satisfy the planner's own `check`. Other names are ignored.
    """
    declared = read_settings(module)
    missing = [
        ", ".join(filter(None, [f"{name}: {each}", each.meaning]))
        for name, each in declared.items()
        if name not in settings
    ]
    if missing:
        raise Fault(f"{location} are missing: {'; '.join(missing)}")
    for name, each in declared.items():
        if wanted := find_setting_fault(each, settings[name]):
            raise Fault(f"{location}: {name}: {settings[name]!r}; expected {wanted}")
    if hasattr(module, "check"):
        ask(module.check, location, settings)
