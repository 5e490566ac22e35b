"""The page of a scale, from the files that the workflow made."""

from pathlib import Path
from typing import Any

import pandas as pd

from bezierplan.figures.page import answer, build, content, gather, runs


def page(job: dict[str, Any], folder: Path, numbers: str | None, claims: str | None) -> content.Page:
    """The content of the page.

    job: `scale`, and `studies`: study -> what `gather.studies` takes, and `experiments` (name -> `methods`, `repeats` and the files `runs`,
    `problems` and `bounds`). folder: that of the scale. numbers, claims: files of all studies together, if the scale has them."""
    tables: list[pd.DataFrame | None] = [gather.read(file) if file else None for file in (numbers, claims)]
    studies = gather.studies(job["studies"], folder, *tables)
    problems: dict[str, content.Problem] = {}
    kept: dict[str, content.Run] = {}
    for key, own in job["studies"].items():
        shown: list[content.Shown] = []
        for experiment, described in own["experiments"].items():
            chosen = runs.chosen(key, experiment, described)
            shown += chosen.shown
            problems |= chosen.problems
            kept |= chosen.runs
        studies[key] = studies[key].model_copy(update={"shown": shown})
    return content.Page(scale=job["scale"], answer=answer.answer(studies), studies=studies, problems=problems, runs=kept)


def write(job: dict[str, Any], folder: Path, numbers: str | None, claims: str | None, file: str) -> None:
    """Write the page."""
    Path(file).write_text(build.html(page(job, folder, numbers, claims), folder), encoding="utf-8")
