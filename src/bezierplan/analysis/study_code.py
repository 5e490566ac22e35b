"""The code of a study: metrics, functions and an audit of its own (`machine.modules`)."""

from collections.abc import Callable, Iterable
from typing import Any

import pandas as pd

from bezierplan.analysis import drawings
from bezierplan.analysis import metrics as metrics  # whose names no study declares anew
from bezierplan.analysis.audit import rules
from bezierplan.machine.modules import load_module


def part(name: str) -> str:
    """What a module of a study is: `metrics`, `functions` and so on."""
    return name.removesuffix(".py").replace("/", ".").rpartition(".")[2]


def functions(code: Iterable[str]) -> dict[str, Callable[..., Any]]:
    """Load the code of a study, so that its metrics are known; its functions by name, with those
    that every study has.
    """
    loaded = {part(name): load_module(name) for name in code}
    return {"marks": drawings.marks} | public(loaded.get("functions"))


def audit(code: Iterable[str]) -> Callable[[dict[str, pd.DataFrame]], list[dict]]:
    """The audit of a study's printed numbers: its own, or the rules that its file lists."""
    own = [name for name in code if part(name) == "audit"]
    if own:
        return load_module(own[0]).audit
    return lambda published: rules.audit(published) if "rules" in published else []


def part_of(code: list[str]) -> dict[str, Callable[..., Any]]:
    """The public functions of a module that a study may have, given as a list of one or none."""
    return public(load_module(code[0]) if code else None)


def public(of: Any) -> dict[str, Callable[..., Any]]:
    """The public functions of a module by name; none of none."""
    return {
        name: value
        for name, value in (vars(of) if of else {}).items()
        if not name.startswith("_")
        and callable(value)
        and getattr(value, "__module__", None) == of.__name__
    }
