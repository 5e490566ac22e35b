"""The results of many runs that docs/outcome keeps of a study, and the settings behind them."""

import csv
from functools import cache

from bezierplan.machine.digest import compute_content_digest, hash_text
from bezierplan.places import OUTCOME, STUDIES
from bezierplan.study.definition import Study

Rows = list[dict[str, str]]

_LONG = 80
"""Most characters of a value in the table of settings."""


def is_of_project(study: Study) -> bool:
    """Return whether a study lies where those of this project do."""
    return study.folder.resolve().is_relative_to(STUDIES)


def read_kept(study: Study, name: str) -> Rows:
    """Read the rows of a study from a table of docs/outcome; none if the study is not of this
    project, or has other settings now.
    """
    return [] if list_changes(study) else _read_rows(study, name)


def _read_rows(study: Study, name: str) -> Rows:
    """Select the rows of a study of this project from a table."""
    own = study.key if is_of_project(study) else None
    return [row for row in _read_table(name) if row["study"] == own]


@cache
def _read_table(name: str) -> Rows:
    """Read a table of docs/outcome once; no rows if it is not there."""
    file = OUTCOME / f"{name}.csv"
    if not file.is_file():
        return []
    # Each start of the workflow reads these tables: to import pandas would take longer.
    with file.open(encoding="utf-8", newline="") as rows:
        return [*csv.DictReader(rows)]


@cache
def list_changes(study: Study) -> list[str]:
    """List in words the settings of a study that are not those of docs/outcome; none if it keeps
    none.
    """
    before = {(row["of"], row["setting"]): row["value"] for row in _read_rows(study, "settings")}
    now = {(of, name): value for of, name, value in list_settings(study)} if before else {}
    return [
        f"{name} of {of} is {now.get((of, name), 'absent')}, in the README's outcome "
        f"{before.get((of, name), 'absent')}"
        for of, name in now | before
        if now.get((of, name)) != before.get((of, name))
    ]


def list_settings(study: Study) -> list[tuple[str, str, str]]:
    """Return all settings of a study as rows of owner, setting and value. The owner is a method, or
    a kind and a name such as `workspace room`.
    """
    settings = {method: study.resolve_settings(method) for method in study.methods}
    for name, workspace in study.workspaces.items():
        # A map is a setting too: the digest shows that its file has changed.
        maps = study.maps([name])
        content = {"content of the map": compute_content_digest(*maps)} if maps else {}
        settings[f"workspace {name}"] = workspace.plain() | content
    for name, problem in study.problems.items():
        settings[f"problem {name}"] = problem.plain()
    for name, experiment in study.experiments.items():
        # How many runs one job makes, and when one is given up, changes no run.
        settings[f"experiment {name}"] = experiment.plain("chunk", "time_limit")
    settings |= {f"policy {name}": policy.plain() for name, policy in study.policies.items()}
    return [
        (owner, setting, _shorten(str(value)))
        for owner, own in settings.items()
        for setting, value in own.items()
    ]


def _shorten(text: str) -> str:
    """Return a text, cut if it is long, with a digest of the whole."""
    return text if len(text) <= _LONG else f"{text[:_LONG]}... ({hash_text(text)})"
