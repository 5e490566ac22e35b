"""List the contents of studies, or what the settings of their planners mean."""

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from bezierplan.analysis.table_kinds import Table
from bezierplan.commands import studies_of
from bezierplan.planners import planner_module, planner_settings
from bezierplan.schema.checked import Fault, closest
from bezierplan.study.artefacts import Figure, in_printed_order
from bezierplan.study.definition import Study


def main(*words: str, settings: bool = False, studies: Sequence[str] = ()) -> None:
    """Print the contents of the configured studies, or of those named. Raises Fault for a word that
    is neither a kind nor a study.

    Parameters
    ----------
    *words : str
        kinds (tables, figures, methods, experiments, claims) and studies; without any,
        all of them
    settings : bool
        each planner's settings: accepted values, meaning, unit, source
    studies : list of str
        a study in place of those of config/config.yaml: a name or a folder

    Examples
    --------
    list methods song2016
    list --settings --studies tharwat2018
    """
    loaded = studies_of(studies)
    for word in words:
        if word not in KINDS and word not in loaded:
            raise Fault(
                f"list: {word}: neither a kind nor a study{closest(word, [*KINDS, *loaded])}"
            )
    kinds = [word for word in words if word in KINDS] or list(KINDS)
    for key, study in loaded.items():
        if key in words or not loaded.keys() & set(words):
            print("\n".join(settings_of(study) if settings else lines(study, kinds)))


def settings_of(study: Study) -> list[str]:
    """The settings of a study's planners, one per line."""
    planners = dict.fromkeys(map(study.planner, study.methods))
    return [
        f"{study.key}: {planner}: {name:24} {declared}"
        + (f"; {declared.meaning}" if declared.meaning else "")
        for planner in planners
        for name, declared in planner_settings(planner_module(planner)).items()
    ]


def lines(study: Study, kinds: list[str]) -> list[str]:
    """A study's title and what it has of some kinds of `KINDS`, one per line."""
    return [
        f"{study.key}: {study.title}",
        *(f"  {kind.removesuffix('s'):12}{line}" for kind in kinds for line in KINDS[kind](study)),
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
