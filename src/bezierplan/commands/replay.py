"""Rerun one run from its name alone: bit-identical, with its picture."""

import sys
from collections.abc import Sequence
from pathlib import Path

from bezierplan import api
from bezierplan.analysis import judgement
from bezierplan.analysis.results import Results
from bezierplan.analysis.stored_runs import find_stored_runs, is_equal
from bezierplan.commands import read_studies
from bezierplan.figures import sheet
from bezierplan.figures.panels import Sources, build_panel
from bezierplan.study.replays import replay

MOMENTS = (0.1, 0.4, 0.7, 1.0)
"""Moments at which a drive is drawn, as shares of its time."""


def main(run: str, *, studies: Sequence[str] = ()) -> None:
    """Rerun a run of a study, print its outcome and whether it equals the stored run, and save its
    picture below results/replay (of a drive, at some moments). Ends with status 1 if it differs
    from the stored run.

    Parameters
    ----------
    run : str
        its name: study/experiment/condition/method/repeat
    studies : list of str
        a study in place of those of config/config.yaml: a name or a folder

    Examples
    --------
    replay song2016/routes/15_240/smooth/2
    replay elhoseny2017/moving/moving_slow_0_10/mga_replans/0
    """
    loaded = read_studies(studies)
    reproduced = replay(run, loaded)
    row = reproduced.runs.iloc[0]
    same = {
        file: is_equal(row, stored)
        for file, stored in find_stored_runs(run, Path("results")).items()
    }
    for file, is_same in same.items():
        print(f"{'stored in':16}{file}: {'equal' if is_same else 'NOT EQUAL'}")
    picture = Path("results/replay") / f"{run}.svg"
    picture.parent.mkdir(parents=True, exist_ok=True)
    if reproduced.worlds:
        lines = {name: str(row[name]) for name in ("feasible", "length", "arrival", "stop")}
        draw_drive(reproduced, picture)
    else:
        answer = api.answer_of(reproduced, run)
        lines = judgement.describe_answer(answer)
        answer.save(picture)
    for name, text in {**lines, "picture": picture}.items():
        print(f"{name:16}{text}")
    if not all(same.values()):
        sys.exit(1)


def draw_drive(results: Results, picture: Path) -> None:
    """Save a picture of the drive in the results of one run."""
    experiment, repeat = results.runs[["experiment", "repeat"]].iloc[0]
    shown = {"kind": "snapshot", "experiment": experiment, "pick": {"repeat": int(repeat)}}
    panels = [build_panel(shown | {"at": moment}) for moment in MOMENTS]
    problems = {experiment: results.problems}
    frame = sheet.collect_data(panels, Sources({experiment: results}))
    figure = sheet.draw(panels, frame, sheet.FigureScene(problems, {}, {}, ""), columns=2)
    sheet.save(figure, str(picture))
