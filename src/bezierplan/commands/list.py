"""List the contents of studies, or what the settings of their planners mean."""

from argparse import ArgumentParser

from bezierplan.commands import add_studies
from bezierplan.planners import planner_module, planner_settings
from bezierplan.study import reading
from bezierplan.study.artefacts import in_printed_order
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print the contents of the configured studies, or of those named."""
    add_studies(parser)
    parser.add_argument("--settings", action="store_true", help="each planner's settings: accepted values, meaning, unit, source")
    words = parser.parse_args(words)
    for study in reading.load(reading.read_config({"studies": words.studies} if words.studies else {})).values():
        print("\n".join(settings(study) if words.settings else lines(study)))


def settings(study: Study) -> list[str]:
    """The settings of a study's planners, one per line."""
    planners = dict.fromkeys(map(study.planner, study.methods))
    return [
        f"{study.key}: {planner}: {name:24} {declared}" + (f"; {declared.meaning}" if declared.meaning else "")
        for planner in planners
        for name, declared in planner_settings(planner_module(planner)).items()
    ]


def lines(study: Study) -> list[str]:
    """A study's title, artefacts, methods, workspaces and experiments, one per line."""
    text = [f"{study.key}: {study.title}"]
    for kind, artefacts in (("table", study.tables), ("figure", study.figures)):
        text += [f"  {kind:12}{study.key}_{name:12} {artefacts[name].title}" for name in in_printed_order(artefacts)]
    for name, method in study.methods.items():
        variant = f", a variant of {method.variant_of}" if method.variant_of else ""
        text.append(f"  {'method':12}{name:20} {study.planner(name)}{variant}")
    text += [f"  {'workspace':12}{name:20} {workspace.kind}" for name, workspace in study.workspaces.items()]
    for name, experiment in study.experiments.items():
        size = f"{len(experiment.problems)} problems, {len(experiment.methods)} methods"
        repeats = ", ".join(f"{experiment.repeats[scale]} ({scale})" for scale in SCALES)
        text.append(f"  {'experiment':12}{name:20} {size}, repeats {repeats}")
    return text
