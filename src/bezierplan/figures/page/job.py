"""The page of a scale, from the files that the workflow made."""

import json
import multiprocessing
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pandas as pd

import bezierplan
from bezierplan import places
from bezierplan.analysis import headline
from bezierplan.figures.page import answer, build, content, gather, outcome, runs
from bezierplan.figures.page.page_job import ExperimentShown, PageJob, StudyShown
from bezierplan.running.jobs.watchdog import end_with_parent


def page(
    job: PageJob,
    folder: Path,
    summary: list[str] | None,
    processes: int = 1,
    verified: str | None = None,
) -> content.Page:
    """The content of the page.

    folder: that of the scale. summary: files of all studies together, numbers.csv, claims.csv and
    baseline_comparison.csv, if the scale has them. processes: how many look for runs, if more than
    one beside this one. verified: the file of the check of these runs (`judge.recheck`), if there
    is one.
    """
    experiments = [
        (key, *each) for key, own in job.studies.items() for each in own.experiments.items()
    ]
    shown: dict[str, list[content.Shown]] = {key: [] for key in job.studies}
    workspaces: dict[str, dict[str, Any]] = {}
    problems: dict[str, content.Problem] = {}
    kept: dict[str, content.Run] = {}
    with _mapping(processes) as mapped:
        found = mapped(_chosen, experiments)
        tables: list[pd.DataFrame | None] = (
            [gather.read(file) for file in summary] if summary else [None, None, None]
        )
        studies = gather.studies(job.studies, folder, *tables)
        for (key, *_), chosen in zip(experiments, found, strict=True):
            shown[key] += chosen.shown
            workspaces |= chosen.workspaces
            problems |= chosen.problems
            kept |= chosen.runs
    studies = {
        key: study.model_copy(update={"shown": shown[key]}) for key, study in studies.items()
    }
    titles = {key: own.title for key, own in job.studies.items()}
    readme = outcome.kept() if job.outcome else None
    if readme:
        studies = outcome.beside(studies, readme)
    checked = content.Verified(**json.loads(Path(verified).read_text())) if verified else None
    return content.Page(
        scale=job.scale,
        about_scale=answer.about_scale(job.scale, _repeats(job.studies)),
        made_by=_made_by(),
        headline=_headline(tables, titles),
        headline_extended=outcome.sentences(readme, titles) if readme else [],
        answer=answer.answer(studies),
        verified=checked,
        studies=studies,
        runs=kept,
        **_once(workspaces, problems),
    )


def _headline(tables: list[pd.DataFrame | None], titles: dict[str, str]) -> content.Headline | None:
    """The headline (`analysis.headline`) of numbers, claims and methods beside the baseline; None
    without them.
    """
    if any(table is None for table in tables):
        return None
    overview = headline.headline(*tables, titles)
    shown = overview.table.loc[:, (overview.table != "").any()]
    rows = {
        str(study): list(map(str, row))
        for study, row in zip(shown.index, shown.to_numpy(), strict=True)
    }
    return content.Headline(
        sentences=overview.sentences, columns=[headline.COLUMNS[name] for name in shown], rows=rows
    )


def _repeats(studies: dict[str, StudyShown]) -> dict[str, list[list[int]]]:
    """Scale -> of each study, the least and the largest number of runs of a method under a
    condition.
    """
    scales = {scale for study in studies.values() for scale in study.repeats}
    return {
        scale: [study.repeats[scale] for study in studies.values() if study.repeats[scale]]
        or [[0, 0]]
        for scale in scales
    }


def _made_by() -> str:
    """The version of this package, and of a clone the commit with its date."""
    version = f"bezierplan {bezierplan.__version__}"
    if not (places.TREE / ".git").exists():
        return version
    command = ["git", "-C", str(places.TREE), "log", "-1", "--format=%h of %cs"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):  # such as no git, or another user's clone
        return version
    return f"{version}, commit {found.stdout.strip()}"


@contextmanager
def _mapping(processes: int) -> Iterator[Callable[..., Any]]:
    """`map`, in processes beside this one if there are to be several, on Linux: elsewhere they
    would begin with a job's script anew.
    """
    if processes == 1 or sys.platform != "linux":
        yield map
        return
    with ProcessPoolExecutor(
        processes, multiprocessing.get_context("fork"), end_with_parent
    ) as pool:
        yield pool.map


def _chosen(experiment: tuple[str, str, ExperimentShown]) -> runs.Chosen:
    return runs.chosen(*experiment)


def _once(
    workspaces: dict[str, dict[str, Any]], problems: dict[str, content.Problem]
) -> dict[str, dict[str, Any]]:
    """Workspaces without those that equal an earlier one, and problems that name the earlier
    one.
    """
    first: dict[str, str] = {}
    names = {
        name: first.setdefault(json.dumps(shapes), name) for name, shapes in workspaces.items()
    }
    return {
        "workspaces": {name: workspaces[name] for name in first.values()},
        "problems": {
            name: each.model_copy(update={"workspace": names[each.workspace]})
            for name, each in problems.items()
        },
    }


def write(
    job: PageJob,
    folder: Path,
    summary: list[str] | None,
    file: str,
    processes: int = 1,
    verified: str | None = None,
) -> None:
    """Write the page."""
    Path(file).write_text(
        build.html(page(job, folder, summary, processes, verified), folder), encoding="utf-8"
    )
