"""A drive in a world that moves, at one moment: what is there and where it goes, the way so far,
the current plan, dropped plans.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import PICK, Note, Pick, RunsPanel, only
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.figures.panels.paths import NARROW_MARK
from bezierplan.schema.model import is_number, value

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results
    from bezierplan.running.simulation.motion_check import Verdict
    from bezierplan.running.simulation.robot import Ride
    from bezierplan.workspaces.problem import Problem
    from bezierplan.workspaces.worlds import World

# The arrow of a circle shows where it will be after this many steps; a longer way is cut off at
# this share of the field's width.
_ARROW_STEPS = 20
_LONGEST_ARROW = 0.1

# Chords of a drawn plan, as a share of the field's width.
_FINE = 0.005


class Options(RunsPanel):
    to_scale: ClassVar[bool] = True
    rerun: ClassVar[bool] = True
    one: ClassVar[tuple[str, ...]] = ("problem", "method")
    drives: ClassVar[bool] = True

    pick: Pick = Field(description=PICK)
    at: Annotated[float, value(lambda given: is_number(given) and 0 <= given <= 1, "")] = Field(
        description="the moment, as a share of the time of the drive, a number from 0 to 1"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """What is drawn, one row per place; columns: problem, method, run (its id), time (of the
    moment, in steps), part, number, x, y, size, x_velocity, y_velocity (units per step).

    Parts: those of `workspace.data`; start, target; way (driven so far); robot; plan (in force);
    dropped (earlier plans, by number); collision (places of first collisions up to the moment).
    Raises ValueError for runs of several problems or methods, and if no run is found.
    """
    from bezierplan.analysis.results import pick as picked
    from bezierplan.running import rides

    for column in ("problem", "method"):
        only(results.runs, column)
    run = picked(results.runs, options.pick.plain())
    if run is None:
        raise ValueError("no run to show; see the panel's `where` and `pick`")
    world, problem = results.worlds[run["problem"]], results.problems[run["problem"]]
    ride, verdict = rides.rerun(results.jobs[run["method"]], run, problem, world)
    frame = moment(world, problem, ride, verdict, options.at)
    return frame.assign(
        problem=run["problem"],
        method=run["method"],
        run=run["id"],
        time=options.at * ride.motion.times[-1],
    )


def moment(world: World, problem: Problem, ride: Ride, verdict: Verdict, at: float) -> pd.DataFrame:
    """Rows of a moment, a share of the time of a drive."""
    import pandas as pd

    from bezierplan.running.simulation.motion_check import between
    from bezierplan.running.simulation.ways import polyline
    from bezierplan.workspaces.worlds import MovingCircles

    time = at * ride.motion.times[-1]
    if isinstance(world, MovingCircles):
        step = int(time)
        now, after = world.at(step), world.at(step + 1)
        velocity = after - now
        x, y = (now + (time - step) * velocity).T
        circles = {
            "part": "circle",
            "x": x,
            "y": y,
            "size": world.radii,
            "obstacle": range(len(now)),
            "x_velocity": velocity[:, 0],
            "y_velocity": velocity[:, 1],
        }
        corners = {"part": "corner", "x": world.bounds[:2], "y": world.bounds[2:]}
        parts = [pd.DataFrame(corners), pd.DataFrame(circles)]
        width = world.bounds[1] - world.bounds[0]
    else:
        grid = world.workspace(time)
        parts, width = [workspaces.parts(grid)], grid.bounds[1] - grid.bounds[0]
    driven = between(ride.motion, 0.0, time).points if time > 0 else ride.motion.points[:1]
    parts.append(pd.DataFrame(driven, columns=["x", "y"]).assign(part="way"))
    parts.append(pd.DataFrame(driven[-1:], columns=["x", "y"]).assign(part="robot"))
    made = [plan for plan in ride.plans if plan.time <= time and plan.path]
    for number, plan in enumerate(made):
        points = pd.DataFrame(polyline(plan.path, _FINE * width), columns=["x", "y"])
        parts.append(
            points.assign(part="plan" if number == len(made) - 1 else "dropped", number=number)
        )
    if verdict.collision_at <= time:
        hit = between(ride.motion, 0.0, max(verdict.collision_at, 1e-9)).points[-1:]
        parts.append(pd.DataFrame(hit, columns=["x", "y"]).assign(part="collision"))
    return pd.concat([*parts, workspaces.ends(problem)], ignore_index=True)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    problem = scene.problems[options.experiment][frame["problem"].iloc[0]]
    workspaces.shade(axes, frame)
    workspaces.scale(axes, problem.workspace.unit)
    show(axes, frame, narrow=scene.narrow)
    if scene.narrow:
        axes.locator_params(nbins=4, integer=True)
    dropped = frame.loc[frame["part"] == "dropped", "number"].nunique()
    plans = f"{dropped or 'no'} plan{'s' if dropped > 1 else ''} discarded"
    return Note(f"step {frame['time'].iloc[0]:.0f}, {plans}", f"run {frame['run'].iloc[0]}")


def show(axes: Axes, frame: pd.DataFrame, *, narrow: bool = False) -> None:
    """Draw the rows of a moment over its obstacles."""
    circles = frame[frame["part"] == "circle"]
    if len(circles):
        arrows = _ARROW_STEPS * circles[["x_velocity", "y_velocity"]].to_numpy()
        longest = np.hypot(*arrows.T).max()
        reach = _LONGEST_ARROW * np.diff(axes.get_xlim())[0]
        arrows *= min(1.0, reach / longest) if longest > 0 else 1.0
        look = {
            "angles": "xy",
            "scale_units": "xy",
            "scale": 1,
            "color": style.BLACK,
            "width": 0.005,
            "zorder": 2.6,
        }
        axes.quiver(circles["x"], circles["y"], *arrows.T, **look)
        axes.plot([], [], label="velocity", **style.mark(r"$\rightarrow$", 8, style.BLACK))
    for _, rows in frame[frame["part"] == "dropped"].groupby("number"):
        axes.plot(
            rows["x"], rows["y"], color="0.7", linewidth=0.5, zorder=2.5, label="discarded plan"
        )
    looks: dict[str, dict[str, Any]] = {
        "plan": {
            "color": style.BLUE,
            "linewidth": 1.2,
            "linestyle": (0, (5, 1.5)),
            "zorder": 3,
            "label": "current plan",
        },
        "way": {"color": style.RED, "linewidth": 1.8, "zorder": 3.5, "label": "path driven"},
        "start": workspaces.START,
        "target": workspaces.TARGET,
        "robot": style.mark("o", 5, style.RED, zorder=5, label="robot"),
        "collision": style.mark("x", 8, style.BLACK, zorder=6, label="first collision"),
    }
    for part, look in looks.items():
        rows = frame[frame["part"] == part]
        if len(rows):
            if narrow and "marker" in look:
                look = look | {"markersize": NARROW_MARK * look["markersize"]}
            # A mark at the edge is seen whole.
            axes.plot(rows["x"], rows["y"], clip_on="marker" not in look, **look)
