"""List what studies have, or the names that their files can use."""

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from bezierplan.analysis import metrics
from bezierplan.analysis.claims import kinds
from bezierplan.commands import find_study_path, is_study, read_studies
from bezierplan.figures import panels
from bezierplan.figures.page import sort_as_printed
from bezierplan.planners import list_planners, load_planner, read_settings
from bezierplan.schema.checked import check_all
from bezierplan.study.definition import Study
from bezierplan.workspaces import kinds as workspace_kinds

Rows = Iterable[tuple[str, Any]]


def main(*words: str) -> None:
    """Print the contents of the configured studies, or of those named. Raises Fault for a word that
    is neither a kind nor a study.

    Parameters
    ----------
    *words : str
        kinds (tables, figures, methods, experiments, claims, settings) and studies or their
        folders; without any, all of them but settings; or names that files of a study can use
        (metrics, panels, tests, worlds, planners), those of the studies included

    Examples
    --------
    list methods song2016
    list settings tharwat2018
    list metrics mystudy
    """
    loaded = read_studies([word for word in words if is_study(word)])
    names = [Path(find_study_path(word)).name for word in words]
    check_all(names, (*KINDS, *NAMES, *loaded), "list")
    if "metrics" in names:
        _load_metrics(loaded.values())
    shown = [study for key, study in loaded.items() if key in names] or [*loaded.values()]
    asked = [name for name in names if name not in loaded]
    for heading, rows in list_things(
        shown, asked or [kind for kind in KINDS if kind != "settings"]
    ):
        print(heading)
        for name, text in rows:
            print(f"  {name:28} {text}")


def _load_metrics(studies: Iterable[Study]) -> None:
    """Load the metrics of studies, and register the columns that only their planners have."""
    from bezierplan.analysis import study_code

    for study in studies:
        study_code.load_functions(study.code_for("metrics"))
        for planner in map(study.planner, study.methods):
            metrics.add_columns(getattr(load_planner(planner), "extra", ()))


def list_things(studies: Iterable[Study], names: Sequence[str]) -> Iterator[tuple[str, Rows]]:
    """Yield headings, each with rows of a name and a line about it: first the kinds of `NAMES`,
    then for each study those of `KINDS`.
    """
    yield from ((kind, sorted(NAMES[kind]())) for kind in names if kind in NAMES)
    for study in studies:
        for kind in names:
            if kind in KINDS:
                yield f"{study.key}, {kind}: {study.title}", KINDS[kind](study)


def _list_titles(study: Study, artefacts: Mapping[str, Any]) -> Rows:
    """Return the full name and the title of each table or figure, in the order of print."""
    return ((f"{study.key}_{name}", artefacts[name].title) for name in sort_as_printed(artefacts))


def _list_methods(study: Study) -> Rows:
    """Yield each method with what is its own: printed name, planner, policy and settings. The
    first one of a planner also has the paragraph about that.
    """
    described = set()
    for name, method in study.methods.items():
        planner = study.planner(name)
        variant = f", a variant of {method.variant_of}" if method.variant_of else ""
        policy = f"policy {method.policy}" if method.policy else ""
        own = ", ".join(f"{key} {value}" for key, value in method.settings.items())
        paragraph = (
            "" if planner in described else _read_paragraph(load_planner(planner)).rstrip(".")
        )
        described.add(planner)
        parts = filter(None, [f"{planner}{variant}", policy, own, paragraph])
        yield name, f"{study.labels.get(name, name)}: {'; '.join(parts)}"


def _list_settings(study: Study) -> Rows:
    """Yield each setting of the planners of a study."""
    for planner in dict.fromkeys(map(study.planner, study.methods)):
        for name, declared in read_settings(load_planner(planner)).items():
            yield f"{planner}: {name}", f"{declared}; {declared.meaning}"


def _read_paragraph(thing: Any) -> str:
    """Return the first paragraph about a module, or about a model's module, on one line."""
    module = inspect.getmodule(thing) if isinstance(thing, type) else thing
    return " ".join((inspect.getdoc(module) or "").partition("\n\n")[0].split())


def _read_paragraphs(things: Mapping[str, Any]) -> Rows:
    """Yield each name with the first paragraph about its thing."""
    return ((name, _read_paragraph(each)) for name, each in things.items())


KINDS: dict[str, Callable[[Study], Rows]] = {
    "tables": lambda study: _list_titles(study, study.tables),
    "figures": lambda study: _list_titles(study, study.figures),
    "methods": _list_methods,
    "experiments": lambda study: (
        (name, f"{len(each.problems)} problems, {len(each.methods)} methods, {each.repeats}")
        for name, each in study.experiments.items()
    ),
    "claims": lambda study: ((claim.id, claim.statement) for claim in study.claims),
    "settings": _list_settings,
}
"""Kind -> what a study has of it."""

NAMES: dict[str, Callable[[], Rows]] = {
    "metrics": lambda: (
        (name, f"{each.meaning} ({each.unit})") for name, each in metrics.METRICS.items()
    ),
    "panels": lambda: _read_paragraphs(panels.list_kinds()),
    "tests": lambda: _read_paragraphs(kinds.list_kinds()),
    "worlds": lambda: _read_paragraphs(workspace_kinds.kinds()),
    "planners": lambda: _read_paragraphs({name: load_planner(name) for name in list_planners()}),
}
"""Kind -> the names that the files of a study can use."""
