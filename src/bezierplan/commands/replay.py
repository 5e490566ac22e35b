"""Rerun one run from its name alone: bit-identical, with its picture."""

from argparse import ArgumentParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis import results
from bezierplan.commands import add_studies
from bezierplan.commands.digest import read_rows, row_text
from bezierplan.figures import animation, sheet
from bezierplan.figures.panels import Sources, panel_of
from bezierplan.geometry import checker, curves
from bezierplan.running import rides
from bezierplan.running.chunk import chunk_files
from bezierplan.schema.words import amount
from bezierplan.study import jobs, reading
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES, Experiment
from bezierplan.study.replays import replay
from bezierplan.workspaces.problem import Problem


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Rerun it, print the outcome and whether it equals the stored run, and save its picture below
    results/replay. Raises Fault.
    """
    parser.add_argument("run", help="its name: study/experiment/condition/method/repeat")
    add_studies(parser)
    arguments = parser.parse_args(words)
    studies = reading.load(
        reading.read_config({"studies": arguments.studies} if arguments.studies else {})
    )
    reproduced = replay(arguments.run, studies)
    run = reproduced.runs.iloc[0]
    for name, text in described(
        run,
        reproduced.problems[run["problem"]],
        studies[run["study"]].experiments[run["experiment"]],
    ):
        print(f"{name:18}{text}")
    for file, stored in stored_runs(arguments.run, Path("results")).items():
        print(f"{'stored in':18}{file}: {'equal' if equal(run, stored) else 'NOT EQUAL'}")
    picture = Path("results/replay") / f"{arguments.run}.svg"
    draw(reproduced, studies[run["study"]], picture)
    print(f"{'picture':18}{picture}")
    if reproduced.worlds:
        animate(reproduced, picture.with_suffix(".gif"))
        print(f"{'animation':18}{picture.with_suffix('.gif')}")


def described(run: pd.Series, problem: Problem, experiment: Experiment) -> list[tuple[str, str]]:
    """Names and values to print of a run, with units and four digits; what a run does not have is
    left out.
    """
    unit = problem.workspace.unit
    lines = [("objective", f"{run['objective']:.4g}")] if np.isfinite(run["objective"]) else []
    if np.isfinite(run["length"]):
        excess = (
            f", {100 * (run['length'] / run['bound'] - 1):.4g} % above the shortest path"
            if 0 < run["bound"] < np.inf
            else ""
        )
        lines.append(("length", amount(f"{run['length']:.4g}", unit) + excess))
        lines.append(
            (
                "clearance",
                amount(
                    f"{0 if abs(run['clearance']) <= checker.TOLERANCE else run['clearance']:.4g}",
                    unit,
                ),
            )
        )
    lines.append(("feasible", _verdict(run, unit)))
    lines.append(("planner's check", "feasible" if run["claimed_feasible"] else "not feasible"))
    lines.append(("evaluations", f"{run['evaluations']:,}; stopped by: {run['stop']}"))
    most = max(experiment.repeats[scale] for scale in SCALES)
    if run["repeat"] >= most:
        lines.append(
            (
                "note",
                "no table has this repeat: "
                f"this experiment has {most} at most, from 0 to {most - 1}",
            )
        )
    return lines


def _verdict(run: pd.Series, unit: str) -> str:
    """The certified checker's verdict on a run."""
    if run["feasible"]:
        return "yes"
    if not np.isfinite(run["collision_at"]):
        return "no: no path from start to target"
    deep = f"at most {amount(format(run['collision_depth'], '.4g'), unit)} deep"
    if "steps" in run:  # of a drive: when, not where
        return f"no: first collision at step {run['collision_at']:.4g}, {deep}"
    x, y = curves.point_at(results.path_of(run), run["collision_at"])
    return f"no: enters an obstacle at {x:.4g},{y:.4g}, {deep}"


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
    panel = {
        "kind": "paths",
        "experiment": run["experiment"],
        "pick": {"repeat": int(run["repeat"])},
    }
    if made.worlds:
        panel |= {"kind": "snapshot", "at": 1}
    panels = [panel_of(panel)]
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
