"""Planners, one file each, and their interface.

A planner is a module with a function::

    plan(problem, rng, *, settings) -> Plan

whose keyword-only arguments are its settings, all without default values: annotated with `bool`,
`int`, `float`, `Literal[...]`, or `Annotated[int, Range(...), About(...)]`. A planner whose kernels
read its settings declares the same annotations as the fields of a named tuple and has
`with_settings` make the arguments (`parts.settings`). It may also have `workspaces`, the kinds of
workspace that it supports; `exact = True`, if its own feasibility test is meant to agree with the
certified check; `keeps_best = False`, if its result can be worse than the best path it found;
`deterministic = True`, if it uses no random numbers; `extra`, the names of its extra columns, so
that a study which asks for another is refused before the first run; `check(settings)`, which raises
ValueError for incompatible settings; `serves(problem)`, which raises ValueError for a problem that
the planner cannot solve; `track(problem, rng, **settings)`, the control points (iterations + 1, n,
2) of the best path after each iteration of the run that `plan` makes with the same arguments, for
figures that show how a run arrived at its path; `resume(problem, rng, last, **settings)`, a `Plan`
and what the next call gets as `last`, None at first: a plan that starts from an earlier one, for
robots whose world changes.
"""

from functools import cache
from pathlib import Path as File
from types import ModuleType
from typing import NamedTuple

import numpy as np

from bezierplan.machine.modules import is_file, load_module
from bezierplan.planners.parts.settings import (
    About,
    Range,
    Setting,
    find_setting_fault,
    list_settings,
)
from bezierplan.workspaces.problem import Path, Problem

__all__ = [
    "About",
    "Path",
    "Plan",
    "Problem",
    "Range",
    "Setting",
    "find_setting_fault",
    "is_file",
    "list_planners",
    "load_planner",
    "read_settings",
]


class Plan(NamedTuple):
    """The answer of a planner.

    Attributes
    ----------
    path : Path or None
        None if it found no path to show.
    objective : float
        Its final objective value, by its own definition.
    claimed_feasible : bool
        The result of its own feasibility test.
    evaluations : int
        Number of paths whose objective it evaluated.
    history : (generations + 1,) array
        Best objective so far after generation 0, 1, ....
    stop : str
        Why it ended.
    extra : dict of str to float or bool
        Additional columns of the runs table, by name.
    """

    path: Path | None
    objective: float
    claimed_feasible: bool
    evaluations: int
    history: np.ndarray
    stop: str
    extra: dict[str, float | bool]

    @classmethod
    def of_one(
        cls,
        path: Path | None,
        length: float,
        stop: str,
        extra: dict[str, float | bool] | None = None,
    ) -> "Plan":
        """Build the answer of a planner that evaluates one path: it claims that any path is free,
        and None means that it found none. Nothing is tested here.
        """
        return cls(path, length, path is not None, 1, np.array([length]), stop, extra or {})


PLACE = ("workspace", "reference", "route", "side", "layout", "obstacles")
"""Keys of a described problem that are columns of the runs table."""


@cache
def load_planner(planner: str) -> ModuleType:
    """Import the module of a planner.

    `name` stands for planners/name.py of this package, `folder/name.py` for a user's own file,
    which can import the modules next to it at the top of the file.

    Raises ModuleNotFoundError or FileNotFoundError if there is none.
    """
    return load_module(planner if is_file(planner) else f"bezierplan.planners.{planner}")


def list_planners() -> list[str]:
    """List the names of the planners of this package."""
    return sorted(file.stem for file in File(__file__).parent.glob("[!_]*.py"))


@cache
def read_settings(module: ModuleType) -> dict[str, Setting]:
    """Read the settings of a planner, by name, in the order of its signature.

    Do not modify the result: it is kept for the next call.
    """
    return list_settings(module.plan)
