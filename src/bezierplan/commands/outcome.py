"""Copy the outcome of results/extended and results/full to docs/outcome and into the README."""

import shutil
from typing import Any

import pandas as pd

from bezierplan.analysis.outcome import outcome, verdict
from bezierplan.commands import studies_of
from bezierplan.study.page import settings_of

PICTURES = ("song2016/paper/figure3.png", "song2016/beyond/identified.png")


def main() -> None:
    """Write docs/outcome and the README's table from results/extended and results/full. Raises
    FileNotFoundError for what `make outcome` has not made yet.
    """
    studies = studies_of()
    settings = pd.DataFrame(
        [(key, *row) for key, each in studies.items() for row in settings_of(each)],
        columns=["study", "of", "setting", "value"],
    )
    tables = {
        key: {
            name: (study.tables[name].title, len(study.tables[name].index))
            for name, table in study.compared().items()
            if table.published and table.printed
        }
        for key, study in studies.items()
    }
    outcome.write(*named(studies), settings, scored(studies), tables)
    for picture in PICTURES:
        study, _, name = picture.split("/")
        shutil.copyfile(outcome.FULL / picture, outcome.KEPT / f"{study}_{name}")


def named(studies: dict[str, Any]) -> tuple[dict[str, str], verdict.Files]:
    """The titles of studies, and their sentences."""
    titles = {key: study.title for key, study in studies.items()}
    files = {key: (each.verdict_file(), each.labels) for key, each in studies.items()}
    return titles, {key: file for key, file in files.items() if file[0]}


def scored(studies: dict[str, Any]) -> list[str]:
    """The experiments that compare methods with a baseline, each `study/name`."""
    compared = {key: each.baseline_comparison for key, each in studies.items()}
    return [f"{key}/{name}" for key, each in compared.items() if each for name in each.experiments]
