"""What planners get: copies of problems, so that nothing which they do to them can matter to the
judge or to a later run unnoticed.

The arrays of a workspace are read-only (`workspaces.arrays`). A planner that replaces one, as
`object.__setattr__` can, is found by `fault`, which compares objects after every run; and one that
writes into the memory of one, as `ctypes` can, by `thorough_fault`, which compares texts after a
chunk.
"""

from collections.abc import Hashable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any, NamedTuple

from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Problem, Workspace


class Loan(NamedTuple):
    """A problem for planners.

    text: its workspace as stored, if there is to be a thorough comparison. parts: the objects in
    its workspace, by place.
    """

    problem: Problem
    text: str
    parts: dict[str, Any]

    def fault(self) -> str:
        """Which part of the workspace is another object than was lent, in one line; or empty."""
        found = dict(_parts(self.problem.workspace))
        changed = [
            place
            for place in found.keys() | self.parts.keys()
            if found.get(place) is not self.parts.get(place)
        ]
        return _told(self.problem, min(changed)) if changed else ""

    def thorough_fault(self) -> str:
        """`fault`, or that the content of the workspace has changed."""
        return self.fault() or (
            ""
            if files.to_json(self.problem.workspace) == self.text
            else _told(self.problem, "content")
        )


def _told(problem: Problem, place: str) -> str:
    return (
        f"problem: {problem.name}: workspace: {place}: is another after the run; a planner "
        "copies what it changes"
    )


def lend(problems: dict[str, Problem]) -> dict[str, Loan]:
    """Copies of problems for planners, by name. Problems in the same workspace share one copy."""
    copies: dict[Hashable, tuple[Workspace, str, dict[str, Any]]] = {}
    loans = {}
    for name, problem in problems.items():
        key = id(problem.workspace)
        if key not in copies:
            text = files.to_json(problem.workspace)
            workspace = files.from_json(text)
            copies[key] = workspace, text, dict(_parts(workspace))
        workspace, text, parts = copies[key]
        start, target = (tuple(map(float, end)) for end in (problem.start, problem.target))
        loans[name] = Loan(Problem(problem.name, workspace, start, target), text, parts)
    return loans


def lend_once(problem: Problem) -> Loan:
    """A problem for one call of a planner, with its own workspace around the same arrays."""
    workspace = replace(problem.workspace)
    return Loan(problem._replace(workspace=workspace), "", dict(_parts(workspace)))


def _parts(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """The objects that a workspace consists of, each with its place in it."""
    names = _fields(type(value))
    if names is None:
        yield path, value
        return
    held = vars(value)
    for name in names:
        yield from _parts(held.get(name), f"{path}.{name}" if path else name)


@cache
def _fields(kind: type) -> tuple[str, ...] | None:
    """The names of a dataclass's fields; None of another class. Kept, for a robot that drives
    borrows a problem for each plan, and looking them up takes half of the time of that.
    """
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else None
