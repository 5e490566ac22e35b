"""List the contents of studies."""

from argparse import ArgumentParser

from bezierplan.commands import add_studies
from bezierplan.study import reading
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print the contents of the configured studies, or of those named."""
    add_studies(parser)
    names = parser.parse_args(words).studies
    for study in reading.load(reading.read_config({"studies": names} if names else {})).values():
        print("\n".join(lines(study)))


def lines(study: Study) -> list[str]:
    """A study's title, artefacts, methods, workspaces and experiments, one per line."""
    found = [f"{study.key}: {study.title}"]
    for kind, artefacts in (("table", study.tables), ("figure", study.figures)):
        found += [f"  {kind:12}{study.key}_{name:12} {content.title}" for name, content in artefacts.items()]
    for name, method in study.methods.items():
        variant = f", a variant of {method.variant_of}" if method.variant_of else ""
        found.append(f"  {'method':12}{name:20} {study.planner(name)}{variant}")
    found += [f"  {'workspace':12}{name:20} {workspace.kind}" for name, workspace in study.workspaces.items()]
    for name, experiment in study.experiments.items():
        size = f"{len(experiment.problems)} problems, {len(experiment.methods)} methods"
        repeats = ", ".join(f"{experiment.repeats[scale]} ({scale})" for scale in SCALES)
        found.append(f"  {'experiment':12}{name:20} {size}, repeats {repeats}")
    return found
