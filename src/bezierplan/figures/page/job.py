"""The page of a scale, from the files that the workflow made."""

import json
from pathlib import Path
from typing import Any

import pandas as pd

from bezierplan.figures.page import answer, build, content, gather, runs


def page(job: dict[str, Any], folder: Path, summary: list[str] | None) -> content.Page:
    """The content of the page.

    job: `scale`, and `studies`: study -> what `gather.studies` takes, and `experiments` (name -> `methods`, `repeats` and the files `runs`,
    `problems`, `bounds` and, of drives, `traces`). folder: that of the scale. summary: files of all studies together,
    numbers.csv, claims.csv and worth.csv, if the scale has them."""
    tables: list[pd.DataFrame | None] = [gather.read(file) for file in summary] if summary else [None, None, None]
    studies = gather.studies(job["studies"], folder, *tables)
    workspaces: dict[str, dict[str, Any]] = {}
    problems: dict[str, content.Problem] = {}
    kept: dict[str, content.Run] = {}
    for key, own in job["studies"].items():
        shown: list[content.Shown] = []
        for experiment, described in own["experiments"].items():
            chosen = runs.chosen(key, experiment, described)
            shown += chosen.shown
            workspaces |= chosen.workspaces
            problems |= chosen.problems
            kept |= chosen.runs
        studies[key] = studies[key].model_copy(update={"shown": shown})
    shared = {"workspaces": workspaces, "problems": problems}
    return content.Page(scale=job["scale"], answer=answer.answer(studies), studies=studies, runs=kept, **_once(**shared))


def _once(workspaces: dict[str, dict[str, Any]], problems: dict[str, content.Problem]) -> dict[str, dict[str, Any]]:
    """Workspaces without those that equal an earlier one, and problems that name the earlier one."""
    first: dict[str, str] = {}
    names = {name: first.setdefault(json.dumps(shapes), name) for name, shapes in workspaces.items()}
    return {
        "workspaces": {name: workspaces[name] for name in first.values()},
        "problems": {name: each.model_copy(update={"workspace": names[each.workspace]}) for name, each in problems.items()},
    }


def write(job: dict[str, Any], folder: Path, summary: list[str] | None, file: str) -> None:
    """Write the page."""
    Path(file).write_text(build.html(page(job, folder, summary), folder), encoding="utf-8")
