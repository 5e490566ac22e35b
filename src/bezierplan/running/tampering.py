"""Whether code of a planner has replaced something that its judge calls, such as numpy.isfinite.

Planners of this package, and what a Python program plans with, are executed in the process that
judges their paths, and files of planners are imported in the one that reads a study. Problems are
lent as copies (`loans`), but functions, classes and constants of modules are shared.
"""

import builtins
import sys
import warnings
from collections.abc import Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from bezierplan.running.watchdog import PlannerFailure

_LIBRARIES = (
    *("builtins", "math", "time", "os", "json", "functools", "contextlib", "warnings"),
    *("numpy", "numpy.linalg", "shapely"),
)
_OWN = "bezierplan."
_PLANNERS = "bezierplan.planners."
"""A planner may keep something in its own module, and replace parts of another planner."""
_FUNCTIONS = (FunctionType, staticmethod, classmethod)
_PLAIN = (bool, int, float, str, tuple)


@contextmanager
def left_alone(name: str) -> Iterator[None]:
    """A block that executes code of a planner, and perhaps judges its answers.

    Raises PlannerFailure, beginning with `name`, if after the block a name of a module or class on
    which the judge relies stands for another object than before, or a function of this package has
    other code, whatever else the block raises. All is as before again; so are, without a word, the
    working folder, the standard streams, what is done about warnings and numpy's errors, and a
    recursion limit that was lowered.
    """
    modules = {name: module for name, module in sys.modules.items() if _relies_on(name)}
    before = {home: dict(vars(home)) for home in _homes(modules)}
    codes = {function: _code(function) for home in before for function in _functions(home)}
    limit = sys.getrecursionlimit()
    try:
        with (
            chdir("."),
            redirect_stdout(sys.stdout),
            redirect_stderr(sys.stderr),
            warnings.catch_warnings(),
            np.errstate(),
        ):
            yield
    finally:
        sys.setrecursionlimit(max(limit, sys.getrecursionlimit()))
        places = [f"sys.modules[{name!r}]" for name in modules.keys() - sys.modules.keys()]
        sys.modules.update(modules)
        places += [place for home in before for place in _put_back(home, before[home])]
        places += [place for function in codes for place in _restore(function, codes[function])]
        if places:
            raise PlannerFailure(
                f"{name}: replaces {min(places)}; a planner leaves other modules as they are"
            )


def _relies_on(module: str) -> bool:
    own = module.startswith(_OWN) and not module.startswith(_PLANNERS)
    return own or module in _LIBRARIES


def _homes(modules: dict[str, ModuleType]) -> Iterator[ModuleType | type]:
    """Modules and the classes that they define."""
    for name, module in modules.items():
        yield module
        classes = (value for value in vars(module).values() if isinstance(value, type))
        yield from (kind for kind in classes if kind.__module__ == name and name not in _LIBRARIES)


def _put_back(home: ModuleType | type, before: dict[str, Any]) -> Iterator[str]:
    """The names of a module or class that stood for other objects before, and do so again."""
    now = vars(home)
    for name in now.keys() - before.keys():
        # A module gets the names of modules that are imported late, but none of Python's own.
        if hasattr(builtins, name) if isinstance(home, ModuleType) else not name.startswith("__"):
            delattr(home, name)
            yield f"{_path(home)}.{name}"
    for name, value in before.items():
        # Values such as `__pydantic_validator__` are filled in late by libraries.
        late = name.startswith("__") and not isinstance(value, _FUNCTIONS)
        if not (late or _is_same(now.get(name), value)):
            setattr(home, name, value)
            yield f"{_path(home)}.{name}"


def _is_same(now: Any, before: Any) -> bool:
    """Whether a name stands for the same object, or for an equal plain one: time.tzset() makes its
    names and numbers anew.
    """
    return now is before or (type(before) in _PLAIN and repr(now) == repr(before))


def _functions(home: ModuleType | type) -> Iterator[FunctionType]:
    """The functions that a module or class of this package defines, methods included."""
    module = home.__name__ if isinstance(home, ModuleType) else home.__module__
    for value in vars(home).values() if module.startswith(_OWN) else ():
        if type(value) in _FUNCTIONS:
            function = value if type(value) is FunctionType else value.__func__
            if function.__module__ == module:
                yield function


def _code(function: FunctionType) -> tuple:
    return function.__code__, function.__defaults__, function.__kwdefaults__


def _restore(function: FunctionType, before: tuple) -> Iterator[str]:
    if any(now is not then for now, then in zip(_code(function), before)):
        function.__code__, function.__defaults__, function.__kwdefaults__ = before
        yield f"the code of {function.__module__}.{function.__qualname__}"


def _path(home: ModuleType | type) -> str:
    if isinstance(home, ModuleType):
        return home.__name__
    return f"{home.__module__}.{home.__qualname__}"
