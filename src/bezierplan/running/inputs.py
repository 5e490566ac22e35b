"""The input files of jobs, and the folders of results.

A job knows which results it reads (`Shows`), and Snakemake hands it their files in that order. So
no job takes paths apart: rules decide where files lie, and so does a workflow of which this one is
a module.
"""

import re
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

Shows = dict[str, dict[str, int]]
"""Experiment -> method -> number of chunks of runs."""

PAPER, BEYOND = "paper", "beyond"


def choose_tree(artefact: str) -> str:
    """Return the folder of a table or figure: `paper` if it has a number in the paper, otherwise
    `beyond`.

    >>> choose_tree("table1"), choose_tree("figure_scale")
    ('paper', 'beyond')
    """
    return PAPER if re.fullmatch(r"(table|figure)[0-9]+", artefact) else BEYOND


class Files(NamedTuple):
    """Files of an experiment: chunks of runs by method, its problems, and their exact bounds."""

    runs: dict[str, list[str]]
    problems: str
    bounds: str

    @property
    def chunks(self) -> list[str]:
        """Return the chunks of all methods."""
        return [chunk for chunks in self.runs.values() for chunk in chunks]


def group_by_experiment(shows: Shows, inputs: Any) -> dict[str, Files]:
    """Return the files of each experiment, by its name, from a job's inputs `runs`, `problems` and
    `bounds`.
    """
    runs = iter(getattr(inputs, "runs", ()))
    return {
        name: Files(
            {method: list(islice(runs, number)) for method, number in methods.items()},
            problems,
            bounds,
        )
        for (name, methods), problems, bounds in zip(
            shows.items(), inputs.problems, inputs.bounds, strict=True
        )
    }


def group_by_table(files: Iterable[str]) -> dict[str, str]:
    """Return each table's file of published numbers or of comparisons with them, by table."""
    # Up to the first point: `table1.comparison.csv` is of table1, too.
    return {Path(file).name.split(".")[0]: file for file in files}
