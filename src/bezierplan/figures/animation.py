"""Animations of drives in worlds that move."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.figures import style
from bezierplan.figures.panels import snapshot
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.running import execution

if TYPE_CHECKING:
    from PIL import Image

    from bezierplan.analysis.results import Results
    from bezierplan.running.simulation.motion_check import Verdict
    from bezierplan.running.simulation.robot import Ride
    from bezierplan.workspaces.problem import Problem
    from bezierplan.workspaces.worlds import World

# Frames of an animation and milliseconds of each, of the last one longer; inches, dots per inch and
# colours: together a few hundred kB.
FRAMES = 45
EACH, LAST = 120, 1500
_SIDE, _DOTS, _COLOURS = 3.6, 100, 32


def save_run(results: Results, file: Path) -> None:
    """Save the drive in the results of one run."""
    row = results.runs.iloc[0]
    problem, world = (part[row["problem"]] for part in (results.problems, results.worlds))
    ride, verdict = execution.redriven(results.jobs[row["method"]], row, problem, world)
    save(world, problem, ride, verdict, file)


def save(world: World, problem: Problem, ride: Ride, verdict: Verdict, file: Path) -> None:
    """Save a drive as an animated gif: obstacles, path travelled, current plan, and dropped plans
    in grey.
    """
    from PIL import Image

    frames = [
        _frame(world, problem, ride, verdict, number / (FRAMES - 1)) for number in range(FRAMES)
    ]
    # The colours of one frame serve for all, so that neighbouring frames differ only where
    # something moves.
    palette = frames[FRAMES // 2].quantize(_COLOURS, Image.Quantize.MAXCOVERAGE)
    first, *others = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    file.parent.mkdir(parents=True, exist_ok=True)
    first.save(
        file, save_all=True, append_images=others, duration=[EACH] * (FRAMES - 1) + [LAST], loop=0
    )


def _frame(
    world: World, problem: Problem, ride: Ride, verdict: Verdict, share: float
) -> Image.Image:
    """The picture of a share of a drive's time."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from PIL import Image

    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(_SIDE, _SIDE), dpi=_DOTS, layout="tight")
        axes = figure.subplots()
        rows = snapshot.moment(world, problem, ride, verdict, share)
        workspaces.shade(axes, rows)
        workspaces.scale(axes, world.unit)
        snapshot.show(axes, rows)
        axes.set_title(f"step {share * ride.motion.times[-1]:.0f}")
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
