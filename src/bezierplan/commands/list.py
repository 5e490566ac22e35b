"""What studies hold."""

from argparse import ArgumentParser

from bezierplan import study_file
from bezierplan.commands import add_studies
from bezierplan.study import Study


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print what the studies of the configuration, or those named, hold."""
    add_studies(parser)
    names = parser.parse_args(words).studies
    for study in study_file.load(study_file.read_config({"studies": names} if names else {})).values():
        print("\n".join(lines(study)))


def lines(study: Study) -> list[str]:
    """A study's title, artefacts, methods, workspaces and experiments, one a line."""
    found = [f"{study.key}: {study.title}"]
    for kind, artefacts in (("table", study.tables), ("figure", study.figures)):
        found += [f"  {kind:12}{study.key}_{name:12} {content['title']}" for name, content in artefacts.items()]
    for name, method in study.methods.items():
        variant = f", a variant of {method['variant_of']}" if "variant_of" in method else ""
        found.append(f"  {'method':12}{name:20} {study.planner(name)}{variant}")
    found += [f"  {'workspace':12}{name:20} {workspace['kind']}" for name, workspace in study.workspaces.items()]
    for name, experiment in study.experiments.items():
        size = f"{len(experiment['problems'])} problems, {len(experiment['methods'])} methods"
        repeats = ", ".join(f"{number} ({scale})" for scale, number in experiment["repeats"].items())
        found.append(f"  {'experiment':12}{name:20} {size}, repeats {repeats}")
    return found
