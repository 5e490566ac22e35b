"""List the contents of studies, or what the settings of their planners mean."""

import inspect
from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Mapping

from bezierplan.analysis.table_kinds import Table
from bezierplan.commands import add_studies
from bezierplan.planners import planner_module, planner_settings
from bezierplan.schema.checked import Fault, closest
from bezierplan.study import reading
from bezierplan.study.artefacts import Figure, in_printed_order
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print the contents of the configured studies, or of those named. Raises Fault for a word that
    is neither a kind nor a study.
    """
    described = f"kinds ({', '.join(KINDS)}) and studies; without any, all of them"
    parser.add_argument("words", nargs="*", metavar="KIND_OR_STUDY", help=described)
    add_studies(parser)
    parser.add_argument(
        "--settings",
        action="store_true",
        help="each planner's settings: accepted values, meaning, unit, source",
    )
    asked = parser.parse_args(words)
    studies = reading.load(reading.read_config({"studies": asked.studies} if asked.studies else {}))
    for word in asked.words:
        if word not in KINDS and word not in studies:
            raise Fault(
                f"list: {word}: neither a kind nor a study{closest(word, [*KINDS, *studies])}"
            )
    kinds = [word for word in asked.words if word in KINDS] or list(KINDS)
    for key, study in studies.items():
        if key in asked.words or not studies.keys() & set(asked.words):
            print("\n".join(settings(study) if asked.settings else lines(study, kinds)))


def settings(study: Study) -> list[str]:
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
        says = (
            (inspect.getdoc(planner_module(planner)) or "")
            .split("\n\n")[0]
            .replace("\n", " ")
            .rstrip(".")
        )
        yield f"{name:20} {planner}{variant}" + (f": {says}" if says else "")


def _workspaces(study: Study) -> Iterator[str]:
    for name, workspace in study.workspaces.items():
        yield f"{name:20} {workspace.kind}"


def _experiments(study: Study) -> Iterator[str]:
    for name, experiment in study.experiments.items():
        repeats = ", ".join(f"{experiment.repeats[scale]} ({scale})" for scale in SCALES)
        yield (
            f"{name:20} {len(experiment.problems)} problems, {len(experiment.methods)} methods, "
            f"repeats {repeats}"
        )


def _claims(study: Study) -> Iterator[str]:
    for claim in study.claims:
        yield f"{claim.id:20} {claim.statement}"


KINDS: dict[str, Callable[[Study], Iterator[str]]] = {
    "tables": lambda study: _titled(study, study.tables),
    "figures": lambda study: _titled(study, study.figures),
    "methods": _methods,
    "workspaces": _workspaces,
    "experiments": _experiments,
    "claims": _claims,
}
"""What a study has, by kind, and how it is listed."""
