"""The runs behind a table or figure of a study."""

from typing import Any

from bezierplan.analysis.table_kinds import TableEntry
from bezierplan.figures.figure import Figure
from bezierplan.schema.model import convert_to_list
from bezierplan.study.definition import Study


def list_parts_with_runs(artefact: TableEntry | Figure) -> list[Any]:
    """Return the parts of a table or figure that show runs: the table itself, or some panels."""
    parts = getattr(artefact, "panels", [artefact])
    return [part for part in parts if getattr(part, "experiment", None)]


def list_methods(study: Study, artefact: str) -> dict[str, list[str]]:
    """Return the methods whose runs a table or figure shows, baselines included if named, by
    experiment.
    """
    needed: dict[str, set[str]] = {}
    for panel in list_parts_with_runs(study.artefact(artefact)):
        methods = panel.where.get("method", study.own_methods(panel.experiment, artefact))
        needed.setdefault(panel.experiment, set()).update(convert_to_list(methods))
    return {
        name: [method for method in study.methods_of(name) if method in shown]
        for name, shown in needed.items()
    }


def describe_runs_behind(study: Study, artefact: str, scale: str) -> str:
    """Describe how many runs of each method are behind a table or figure."""
    parts, told = list_parts_with_runs(study.artefact(artefact)), []
    for experiment in list_methods(study, artefact):
        content = study.experiments[experiment]
        own = [part.where for part in parts if part.experiment == experiment]
        # A panel may show single repeats.
        listed = max(len(convert_to_list(where.get("repeat", []))) for where in own)
        repeats, layouts = listed or content.repeats[scale], count_layouts(study, experiment, scale)
        told.append(
            f"{'at most ' if scale == 'extended' and content.fewer else ''}{repeats:,} "
            f"run{'s' if repeats > 1 else ''} of each method on each "
            + (f"of {layouts} layouts, {repeats * layouts:,} in all" if layouts > 1 else "problem")
        )
    return "; ".join(dict.fromkeys(told))


def count_layouts(study: Study, experiment: str, scale: str) -> int:
    """Return the largest number of layouts that a problem of an experiment has at a scale."""
    problems = (study.problems[name].layouts for name in study.experiments[experiment].problems)
    return max((layouts or {scale: 1})[scale] for layouts in problems)


def count_experiment_runs(study: Study, experiment: str, scale: str) -> int:
    """Return how many runs each method has in an experiment, over all layouts of the problem with
    the most.
    """
    return study.experiments[experiment].repeats[scale] * count_layouts(study, experiment, scale)
