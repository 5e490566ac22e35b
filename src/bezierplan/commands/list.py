"""List the contents of studies, or what the settings of their planners mean."""

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from bezierplan.analysis import metrics
from bezierplan.analysis.claims import kinds
from bezierplan.analysis.table_kinds import Table
from bezierplan.commands import studies_of
from bezierplan.figures import panels
from bezierplan.planners import known_planners, planner_module, planner_settings
from bezierplan.schema.checked import Fault, closest
from bezierplan.study.artefacts import Figure, in_printed_order
from bezierplan.study.definition import Study
from bezierplan.workspaces import kinds as workspace_kinds


def main(*words: str, settings: bool = False, studies: Sequence[str] = ()) -> None:
    """Print the contents of the configured studies, or of those named. Raises Fault for a word that
    is neither a kind nor a study.

    Parameters
    ----------
    *words : str
        kinds (tables, figures, methods, experiments, claims) and studies; without any,
        all of them; or names that files of a study can use (metrics, panels, tests, worlds,
        planners), those of the studies included
    settings : bool
        each planner's settings: accepted values, meaning, unit, source
    studies : list of str
        a study in place of those of config/config.yaml: a name or a folder

    Examples
    --------
    list methods song2016
    list --settings --studies tharwat2018
    list metrics mystudy
    """
    folders = [word for word in words if (Path(word) / "experiments.yaml").is_file()]
    words = tuple(Path(word).resolve().name if word in folders else word for word in words)
    loaded = studies_of([*studies, *(f"{Path(folder).resolve()}" for folder in folders)])
    known = [*KINDS, *NAMES, *loaded]
    for word in words:
        if word not in known:
            raise Fault(f"list: {word}: neither a kind nor a study{closest(word, known)}")
    for word in [word for word in words if word in NAMES]:
        print("\n".join(f"{name:28} {meaning}" for name, meaning in sorted(NAMES[word]())))
    if {*words} & NAMES.keys() and not {*words} & KINDS.keys():
        return
    shown = [word for word in words if word in KINDS] or list(KINDS)
    for key, study in loaded.items():
        if key in words or not loaded.keys() & set(words):
            print("\n".join(settings_of(study) if settings else lines(study, shown)))


def settings_of(study: Study) -> list[str]:
    """The settings of a study's planners, one per line."""
    planners = dict.fromkeys(map(study.planner, study.methods))
    return [
        f"{study.key}: {planner}: {name:24} {declared}"
        + (f"; {declared.meaning}" if declared.meaning else "")
        for planner in planners
        for name, declared in planner_settings(planner_module(planner)).items()
    ]


def lines(study: Study, names: list[str]) -> list[str]:
    """A study's title and what it has of some kinds of `KINDS`, one per line."""
    return [
        f"{study.key}: {study.title}",
        *(f"  {kind.removesuffix('s'):12}{line}" for kind in names for line in KINDS[kind](study)),
    ]


def _titled(study: Study, artefacts: Mapping[str, Table | Figure]) -> Iterator[str]:
    for name in in_printed_order(artefacts):
        yield f"{study.key}_{name:12} {artefacts[name].title}"


def _methods(study: Study) -> Iterator[str]:
    for name, method in study.methods.items():
        variant = f", a variant of {method.variant_of}" if method.variant_of else ""
        planner = study.planner(name)
        says = f"{inspect.getdoc(planner_module(planner))}".partition("\n\n")[0]
        yield f"{name:20} {planner}{variant}: {' '.join(says.split())}"


def _said(modules: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names of modules, or of models in them, with the first sentence about their module."""
    for name, of in modules.items():
        says = inspect.getdoc(inspect.getmodule(of) if isinstance(of, type) else of) or ""
        yield name, " ".join(says.partition("\n\n")[0].split())


NAMES: dict[str, Callable[[], Iterable[tuple[str, str]]]] = {
    "metrics": lambda: (
        (name, f"{each.meaning} ({each.unit})") for name, each in metrics.METRICS.items()
    ),
    "panels": lambda: _said(panels.kinds()),
    "tests": lambda: _said(kinds.kinds()),
    "worlds": lambda: _said(workspace_kinds.kinds()),
    "planners": lambda: _said({name: planner_module(name) for name in known_planners()}),
}
"""What the files of a study can name, with a line on each."""

KINDS: dict[str, Callable[[Study], Iterable[str]]] = {
    "tables": lambda study: _titled(study, study.tables),
    "figures": lambda study: _titled(study, study.figures),
    "methods": _methods,
    "experiments": lambda study: (
        f"{name:20} {len(each.problems)} problems, {len(each.methods)} methods, repeats "
        f"{each.repeats}"
        for name, each in study.experiments.items()
    ),
    "claims": lambda study: (f"{claim.id:20} {claim.statement}" for claim in study.claims),
}
"""What a study has, by kind, and how it is listed."""
