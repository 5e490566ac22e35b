"""The jobs that draw figures: from files of runs, problems, bounds and published numbers to
pictures and the table of what they show.
"""

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from bezierplan.analysis import results
from bezierplan.figures import sheet, style
from bezierplan.figures.figure_job import FigureJob
from bezierplan.figures.panels import Sources
from bezierplan.running import problems as problem_files
from bezierplan.running.inputs import Files
from bezierplan.workspaces import files as workspace_files
from bezierplan.workspaces.problem import Problem


class Pictures(Protocol):
    """Files of a figure: pictures, what is drawn as csv, and its caption."""

    svg: str
    png: str
    pdf: str
    data: str
    caption: str


class NarrowPictures(Protocol):
    """Files of a figure on a sheet of one text column."""

    svg: str
    pdf: str


def draw(
    job: FigureJob,
    files: Mapping[str, Files],
    published_files: Mapping[str, str],
    folder: Path,
    output: Pictures,
) -> None:
    """Draw a figure, from the table that is written first and read back.

    files: by experiment. published_files: of published numbers, by table. folder: that of the
    study, with its maps.
    """
    published = {name: results.published_table(file) for name, file in published_files.items()}
    numbers = results.joined_numbers(published)
    experiments = {
        name: runs._replace(published=numbers, jobs=job.chunks.get(name))
        for name, runs in results.read_all(files, job.repeats).items()
    }
    functions = vars(importlib.import_module(job.module)) if job.module else {}
    scene = _scene(job, {name: runs.problems for name, runs in experiments.items()}, folder)
    sources = Sources(experiments, scene.workspaces, functions, published, job.study)
    sheet.write_data(sheet.data(job.panels, sources), output.data)
    figure = sheet.draw(job.panels, sheet.read_data(output.data), scene, job.columns)
    sheet.save(figure, output.svg, output.png, output.pdf)
    Path(output.caption).write_text(f"{figure.get_label()}\n", encoding="utf-8")


def draw_narrow(
    job: FigureJob,
    problems: Mapping[str, str],
    data: str,
    folder: Path,
    output: NarrowPictures,
) -> None:
    """Draw the figure of a job on a sheet of one text column. problems: files by experiment. data:
    the file of what is drawn.
    """
    scene = _scene(job, {name: problem_files.read(problems[name]) for name in job.repeats}, folder)
    figure = sheet.draw(
        job.panels, sheet.read_data(data), scene, sheet.narrow_columns(job.panels), style.NARROW
    )
    sheet.save(figure, output.svg, pdf=output.pdf)


def _scene(job: FigureJob, problems: dict[str, dict[str, Problem]], folder: Path) -> sheet.Scene:
    """What the panels are drawn with. problems: by experiment, then by name."""
    workspaces = {
        name: workspace_files.load(described, folder) for name, described in job.workspaces.items()
    }
    return sheet.Scene(problems, workspaces, job.labels, job.unit, job.looks)
