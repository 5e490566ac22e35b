"""Checks that a file is a planner and that settings fit it; every fault is reported in one line."""

import inspect
import traceback
from collections.abc import Callable
from types import ModuleType
from typing import Any

from bezierplan.planners import known_planners, planner_module, planner_settings, setting_fault
from bezierplan.running.execution import RUN_COLUMNS
from bezierplan.study.checked import Fault, closest
from bezierplan.study.definition import Study
from bezierplan.study.experiments import WORKSPACES
from bezierplan.study.files import inside

SERVED = [kind for kind, model in WORKSPACES.items() if not model.drawn and not model.moves]
"""Kinds of workspace that planners meet."""

_EXPECTED = "expected bool, int, float, Literal, or Annotated with a Range"


def loaded(study: Study, method: str, place: str) -> ModuleType:
    """The module of a method's planner. Raises Fault, beginning with a place, unless it has the interface of a planner (`problem`)."""
    name = study.methods[method].planner
    place = f"{place}: planner: {name}"
    if name.endswith(".py"):
        inside(study.folder, name, place)
    elif name not in known_planners():
        raise Fault(f"{place}: unknown{closest(name, known_planners())}; one of your own is a file, {name}.py")
    file = study.planner(method)
    try:
        module = planner_module(file)
    except (Exception, SystemExit) as error:  # a user's file can fail in any way
        raise Fault(f"{place}: {_failed(error, file)}") from None
    fault = interface_fault(module)
    if fault:
        raise Fault(f"{place}: {fault}")
    return module


def interface_fault(module: ModuleType) -> str | None:
    """What a module lacks to be a planner, or None."""
    plan = getattr(module, "plan", None)
    if not inspect.isfunction(plan):
        return "no function plan; expected plan(problem, rng, *, <settings>)"
    parameters = inspect.signature(plan).parameters.values()
    positional = [each.name for each in parameters if each.kind in (each.POSITIONAL_ONLY, each.POSITIONAL_OR_KEYWORD)]
    if len(positional) != 2 or any(each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD) for each in parameters):
        return "function plan: expected plan(problem, rng, *, <settings>)"
    for each in parameters:
        if each.kind is each.KEYWORD_ONLY and each.default is not each.empty:
            return f"setting {each.name}: has a default value; a study gives a value to every setting"
        if each.kind is each.KEYWORD_ONLY and each.annotation is each.empty:
            return f"setting {each.name}: has no annotation; {_EXPECTED}"
        # The column `generations` holds the number actually performed, so a setting of that name adds nothing.
        if each.kind is each.KEYWORD_ONLY and each.name in RUN_COLUMNS and each.name != "generations":
            return f"its setting {each.name} is a column of the runs table; give it another name"
    try:
        annotations = planner_settings(module)
    except Exception as error:
        return f"function plan: its annotations cannot be read ({type(error).__name__}: {error})"
    for setting, annotation in annotations.items():
        try:
            setting_fault(annotation, 0)
        except Exception:
            return f"setting {setting}: is annotated with {inspect.formatannotation(annotation)}; {_EXPECTED}"
    served = getattr(module, "workspaces", ())
    if not isinstance(served, tuple | list) or any(kind not in SERVED for kind in served):
        return f"workspaces: {served!r}: expected kinds among {', '.join(SERVED)}"
    return None


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


def check_settings(module: ModuleType, settings: dict[str, Any], place: str) -> None:
    """Check that the settings of one method have the right types and ranges and are consistent. Raises Fault, beginning with a place."""
    accepted = planner_settings(module)
    for setting in accepted.keys() & settings.keys():
        if wanted := setting_fault(accepted[setting], settings[setting]):
            raise Fault(f"{place}: settings: {setting}: {settings[setting]!r}; expected {wanted}")
    if hasattr(module, "check"):
        asked(module.check, f"{place}: settings", settings)


def asked(check: Callable[..., Any], place: str, *given: Any) -> None:
    """Call a planner's check, which raises ValueError to report a problem. Raises Fault, beginning with a place."""
    try:
        check(*given)
    except ValueError as error:
        raise Fault(f"{place}: {error}") from None
    except Exception as error:  # a user's check can fail in any way
        raise Fault(f"{place}: {check.__name__} of its planner fails ({type(error).__name__}: {error})") from None


def check_complete(study: Study, place: str) -> None:
    """Every method has a value for each of its settings. Raises Fault, which names all missing ones, by planner."""
    missing: dict[str, dict[str, None]] = {}
    for method in study.methods:
        lacking = [name for name in study.accepted(method) if name not in study.resolved(method)]
        missing.setdefault(study.methods[method].planner, {}).update(dict.fromkeys(lacking))
    told = [
        f"{', '.join(names)}: missing; {planner} needs {'it' if len(names) == 1 else 'them'}" for planner, names in missing.items() if names
    ]
    if told:
        raise Fault(f"{place}: settings: {'; '.join(told)}")
