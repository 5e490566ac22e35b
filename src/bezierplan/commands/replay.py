"""Rerun one run from its name alone: bit-identical, with its picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis import results
from bezierplan.commands.digest import read_rows, row_text
from bezierplan.figures import animation, sheet
from bezierplan.figures.panels import Sources, panel_of
from bezierplan.geometry import curves
from bezierplan.running import rides
from bezierplan.running.chunk import chunk_files
from bezierplan.schema.words import amount
from bezierplan.study import jobs, reading
from bezierplan.study.definition import Study
from bezierplan.study.replays import replay

LENGTHS = ("length", "bound", "clearance", "collision_depth")


def main(run: str, *, studies: Sequence[str] = ()) -> None:
    """Rerun it, print the outcome and whether it equals the stored run, and save its picture below
    results/replay. Raises Fault.

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
    loaded = reading.load(reading.read_config({"studies": list(studies)} if studies else {}))
    reproduced = replay(run, loaded)
    row = reproduced.runs.iloc[0]
    study = loaded[row["study"]]
    unit = reproduced.problems[row["problem"]].workspace.unit
    for name, text in described(row, unit).items():
        print(f"{name:18}{text}")
    for file, stored in stored_runs(run, Path("results")).items():
        print(f"{'stored in':18}{file}: {'equal' if equal(row, stored) else 'NOT EQUAL'}")
    picture = Path("results/replay") / f"{run}.svg"
    draw(reproduced, study, picture)
    print(f"{'picture':18}{picture}")
    if reproduced.worlds:
        animate(reproduced, picture.with_suffix(".gif"))
        print(f"{'animation':18}{picture.with_suffix('.gif')}")


def described(run: pd.Series, unit: str) -> dict[str, str]:
    """What to print of a run, by name: numbers with four digits, and lengths in units; what it does
    not have is left out.
    """
    lines = {
        name: amount(f"{run[name]:.4g}", unit) if name in LENGTHS else f"{run[name]:.4g}"
        for name in ("objective", *LENGTHS)
        if np.isfinite(run[name])
    }
    if not run["feasible"] and np.isfinite(run["collision_at"]):
        where = f"step {run['collision_at']:.4g}"
        if "steps" not in run:  # not of a drive
            x, y = curves.point_at(results.path_of(run), run["collision_at"])
            where = f"{x:.4g},{y:.4g}"
        lines["first collision"] = f"at {where}, {lines.pop('collision_depth')} deep"
    lines |= {name: "yes" if run[name] else "no" for name in ("feasible", "claimed_feasible")}
    return lines | {"evaluations": f"{run['evaluations']:,}; stopped by: {run['stop']}"}


def stored_runs(name: str, folder: Path) -> dict[Path, dict[str, Any]]:
    """The rows with this name in the run tables below a folder, by file."""
    study, experiment, _, method, _ = name.split("/")
    files = chunk_files(folder, f"*/{study}/runs/{experiment}/{method}/*.parquet")
    return {file: row for file in files for row in read_rows(file, name)}


def equal(run: pd.Series, stored: dict[str, Any]) -> bool:
    """Whether a reproduced run equals a stored row, bit for bit."""
    return row_text(run[list(stored)].to_dict()) == row_text(stored)


def draw(made: results.Results, study: Study, file: Path) -> None:
    """Save the picture of a reproduced run: its path, control points, first collision, if any, and
    the shortest path; of a drive, its end with the plans; svg, png and csv.
    """
    run = made.runs.iloc[0]
    kind = {"kind": "snapshot", "at": 1} if made.worlds else {"kind": "paths"}
    pick = {"repeat": int(run["repeat"])}
    panels = [panel_of({"experiment": run["experiment"], "pick": pick} | kind)]
    unit = made.problems[run["problem"]].workspace.unit
    scene = sheet.Scene(
        {run["experiment"]: made.problems}, {}, study.labels, unit, jobs.looks(study)
    )
    file.parent.mkdir(parents=True, exist_ok=True)
    frame = sheet.data(panels, Sources({run["experiment"]: made}))
    sheet.write_data(frame, str(file.with_suffix(".csv")))
    figure = sheet.draw(panels, sheet.read_data(str(file.with_suffix(".csv"))), scene, 1)
    sheet.save(figure, str(file.with_suffix(".svg")), str(file.with_suffix(".png")))


def animate(made: results.Results, file: Path) -> None:
    """Save a reproduced drive as an animated gif."""
    run = made.runs.iloc[0]
    name = run["problem"]
    ride, verdict = rides.rerun(
        made.jobs[run["method"]], run, made.problems[name], made.worlds[name]
    )
    animation.save(made.worlds[name], made.problems[name], ride, verdict, file)
