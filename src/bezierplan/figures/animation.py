"""Animations of drives in worlds that move."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.figures import style
from bezierplan.figures.panels import snapshot
from bezierplan.figures.panels import workspace as workspaces

if TYPE_CHECKING:
    from bezierplan.running.simulation.motion_check import Verdict
    from bezierplan.running.simulation.robot import Ride
    from bezierplan.workspaces.problem import Problem
    from bezierplan.workspaces.worlds import World

# Frames of an animation and frames per second; inches and dots per inch: together well below 2 MB.
FRAMES, RATE = 90, 15
_SIDE, _DOTS = 3.6, 100


def save(world: World, problem: Problem, ride: Ride, verdict: Verdict, file: Path) -> None:
    """Save a drive as an animated gif: obstacles, way driven, current plan, and dropped plans in grey."""
    import matplotlib as mpl
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(_SIDE, _SIDE), layout="tight")
        axes = figure.subplots()

        def frame(number: int) -> None:
            axes.clear()
            rows = snapshot.moment(world, problem, ride, verdict, number / (FRAMES - 1))
            workspaces.shade(axes, rows)
            workspaces.scale(axes, world.unit)
            snapshot.show(axes, rows)
            axes.set_title(f"step {number / (FRAMES - 1) * ride.motion.times[-1]:.0f}")

        # The last frame stays for a second.
        numbers = np.append(np.arange(FRAMES), np.full(RATE, FRAMES - 1))
        file.parent.mkdir(parents=True, exist_ok=True)
        FuncAnimation(figure, frame, frames=numbers.tolist()).save(file, writer=PillowWriter(fps=RATE), dpi=_DOTS)
