"""One moment of a drive in a world that moves: obstacles and their velocity, the way so far, the
current plan and dropped plans.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.figures import style
from bezierplan.figures.panels import Note, Picked, RunsPanel
from bezierplan.figures.panels import workspace as workspaces
from bezierplan.figures.panels.paths import choose_run
from bezierplan.schema.model import build_number_type

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results
    from bezierplan.running.simulation.robot import Ride
    from bezierplan.workspaces.worlds import World

# The arrow of a circle shows where it will be after this many steps; a longer way is cut off at
# this share of the field's width.
_ARROW_STEPS = 20
_LONGEST_ARROW = 0.1

# Chords of a drawn plan, as a share of the field's width.
_FINE = 0.005


_DROPPED = {"color": "0.7", "linewidth": 0.5, "zorder": 2.5, "label": "discarded plan"}
_LOOK: dict[str, dict[str, Any]] = {
    "plan": {
        "color": style.BLUE,
        "linewidth": 1.2,
        "linestyle": style.DASHED,
        "zorder": 3,
        "label": "current plan",
        "clip_on": True,
    },
    "way": style.RUN_SHOWN | {"zorder": 3.5, "label": "path driven"},
    **workspaces.ENDS,
    "robot": style.build_mark_style("o", 5, style.RED, zorder=5, label="robot"),
    "collision": style.build_mark_style("x", 8, style.BLACK, zorder=6, label="first collision"),
}


class Options(RunsPanel):
    rerun = True
    one = ("problem", "method")
    drives = True

    pick: Picked
    at: build_number_type(ge=0, le=1) = Field(
        description="the moment, as a share of the time of the drive, a number from 0 to 1"
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """Run a drive again and return the points to draw for one moment: its surroundings then, the
    way so far, the plan in force and dropped ones.

    Columns: problem, method, run (its id), time (of the moment, in steps), part, number, x, y,
    size, x_velocity, y_velocity (units per step). Parts are all of `workspace.data`, and start,
    target; way (driven so far); robot; plan (in force); dropped (earlier plans, by number);
    collision (places of first collisions up to the moment).

    Raises ValueError for runs of several problems or methods, and if no run is found.
    """
    import pandas as pd

    from bezierplan.running import execution

    run, _ = choose_run(results, options.pick)
    if run is None:
        raise ValueError("no run to show; see the panel's `where` and `pick`")
    world, problem = results.worlds[run["problem"]], results.problems[run["problem"]]
    ride, verdict = execution.drive_again(results.jobs[run["method"]], run, problem, world)
    time = options.at * ride.motion.times[-1]
    frame = _list_places(world, ride, verdict.collision_at, time)
    names = {"problem": run["problem"], "method": run["method"], "run": run["id"], "time": time}
    return pd.concat([frame, workspaces.list_ends(problem)], ignore_index=True).assign(**names)


def _list_places(world: World, ride: Ride, collision_at: float, time: float) -> pd.DataFrame:
    """Return the rows of a moment, without start and target. collision_at, time: in steps."""
    import pandas as pd

    from bezierplan.running.simulation.motion_check import cut_motion
    from bezierplan.running.simulation.ways import build_polyline
    from bezierplan.workspaces.worlds import MovingCircles

    if isinstance(world, MovingCircles):
        step = int(time)
        now, after = world.at(step), world.at(step + 1)
        velocity = after - now
        circles = workspaces.list_points({"circle": now + (time - step) * velocity})
        circles = circles.assign(size=world.radii, obstacle=range(len(now)))
        circles[["x_velocity", "y_velocity"]] = velocity
        bounds = world.bounds
        parts = [workspaces.list_corners(bounds), circles]
    else:
        grid = world.workspace(time)
        parts, bounds = [workspaces.list_workspace_rows(grid)], grid.bounds
    driven = cut_motion(ride.motion, 0.0, time).points if time > 0 else ride.motion.points[:1]
    parts.append(workspaces.list_points({"way": driven, "robot": driven[-1:]}))
    plans = [plan for plan in ride.plans if plan.time <= time and plan.path]
    for number, plan in enumerate(plans):
        part = "plan" if plan is plans[-1] else "dropped"
        line = build_polyline(plan.path, _FINE * (bounds[1] - bounds[0]))
        parts.append(workspaces.list_points({part: line}).assign(number=number))
    if collision_at <= time:
        hit = cut_motion(ride.motion, 0.0, max(collision_at, 1e-9)).points[-1:]
        parts.append(workspaces.list_points({"collision": hit}))
    return pd.concat(parts, ignore_index=True)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the moment, with an arrow at each circle that moves."""
    workspaces.draw_shapes(axes, frame)
    workspaces.label_axes(axes, options.find_workspace(frame, scene).unit)
    circles = frame[frame["part"] == "circle"]
    if len(circles):
        arrows = _ARROW_STEPS * circles[["x_velocity", "y_velocity"]].to_numpy()
        longest = np.hypot(*arrows.T).max()
        reach = _LONGEST_ARROW * np.diff(axes.get_xlim())[0]
        arrows *= min(1.0, reach / longest) if longest > 0 else 1.0
        # In units of the axes: by default the lengths of arrows are relative to the panel.
        units = {"angles": "xy", "scale_units": "xy", "scale": 1, "width": 0.005}
        axes.quiver(circles["x"], circles["y"], *arrows.T, zorder=2.6, **units)
        axes.plot(
            [], [], label="velocity", **style.build_mark_style(r"$\rightarrow$", 8, style.BLACK)
        )
    for _, plan in frame[frame["part"] == "dropped"].groupby("number"):
        axes.plot(plan["x"], plan["y"], **_DROPPED)
    style.draw_parts(axes, frame, _LOOK, clip_on=False)
    row, dropped = frame.iloc[0], frame.loc[frame["part"] == "dropped", "number"].nunique()
    return Note(f"step {row['time']:.0f}, plans discarded: {dropped}", f"run {row['run']}")
