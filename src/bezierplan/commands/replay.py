"""Rerun one run from its name alone: bit-identical, with its picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from bezierplan import api
from bezierplan.analysis import answers, results
from bezierplan.commands import studies_of
from bezierplan.commands.digest import read_rows, row_text
from bezierplan.figures import animation
from bezierplan.running import rides
from bezierplan.running.chunk import chunk_files
from bezierplan.study.replays import replay


def main(run: str, *, studies: Sequence[str] = ()) -> None:
    """Rerun it, print the outcome and whether it equals the stored run, and save its picture below
    results/replay; of a drive an animation. Raises Fault.

    Parameters
    ----------
    run : str
        its name: study/experiment/condition/method/repeat
    studies : list of str
        a study in place of those of config/config.yaml: a name or a folder

    Examples
    --------
    replay song2016/routes/15_240/smooth/3
    replay elhoseny2017/moving/moving_slow_0_10/mga_replans/0
    """
    loaded = studies_of(studies)
    reproduced = replay(run, loaded)
    row = reproduced.runs.iloc[0]
    for file, stored in stored_runs(run, Path("results")).items():
        print(f"{'stored in':16}{file}: {'equal' if equal(row, stored) else 'NOT EQUAL'}")
    picture = Path("results/replay") / f"{run}.svg"
    picture.parent.mkdir(parents=True, exist_ok=True)
    if reproduced.worlds:
        lines = {name: str(row[name]) for name in ("feasible", "length", "arrival", "stop")}
        picture = picture.with_suffix(".gif")
        animate(reproduced, picture)
    else:
        answer = api.answer_of(reproduced, run)
        lines = answers.lines(answer)
        answer.to_picture(picture)
    for name, text in {**lines, "picture": picture}.items():
        print(f"{name:16}{text}")


def stored_runs(name: str, folder: Path) -> dict[Path, dict[str, Any]]:
    """The rows with this name in the run tables below a folder, by file."""
    study, experiment, _, method, _ = name.split("/")
    files = chunk_files(folder, f"*/{study}/runs/{experiment}/{method}/*.parquet")
    return {file: row for file in files for row in read_rows(file, name)}


def equal(run: pd.Series, stored: dict[str, Any]) -> bool:
    """Whether a reproduced run equals a stored row, bit for bit."""
    return row_text(run[list(stored)].to_dict()) == row_text(stored)


def animate(reproduced: results.Results, file: Path) -> None:
    """Save a reproduced drive as an animated gif."""
    row = reproduced.runs.iloc[0]
    problem, world = (part[row["problem"]] for part in (reproduced.problems, reproduced.worlds))
    ride, verdict = rides.rerun(reproduced.jobs[row["method"]], row, problem, world)
    animation.save(world, problem, ride, verdict, file)
