"""Drives in worlds that move: a step without replans, a whole drive, and a plan."""

from collections.abc import Iterator
from functools import partial

import frame
import numpy as np

from bezierplan.planners import planner_module
from bezierplan.running.simulation import circles, motion_check
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.ways import way
from bezierplan.running.worlds import build
from bezierplan.workspaces.problem import Problem

COLUMNS = ("field of elhoseny2017 with 15 moving obstacles", "ms", "at most")


def rows(small: bool) -> Iterator[frame.Row]:
    """The limits are 10 microseconds per step, 0.1 s per drive of 600 steps without replans, and
    0.05 s per plan (95th percentile).
    """
    steps, study = 60 if small else 600, frame.study("elhoseny2017")
    described = study.problems["moving_slow"].plain("settings", "layouts")
    described |= {"obstacles": 15, "layout": 0}
    home = study.workspaces["moving_slow"].plain()
    world = build(home, described, "elhoseny2017/moving_slow", study.folder)
    policy = study.policies["replans"].but(replan="when_blocked")
    # A way as long as the drive, of chords of half a cell, in a corner that no circle reaches: all
    # of it is checked in every step.
    turn = np.linspace(0.0, steps, 2 * steps)
    along = way(np.column_stack([200.0 + turn % 3.0, 200.0 + turn]))
    seconds = frame.cpu_seconds(partial(circles.follow, world, along, 0, policy))
    yield "a step without replans", 1e3 * seconds / steps, 0.01
    motion = Motion(np.column_stack([np.linspace(0, 100, steps + 1)] * 2), np.arange(steps + 1.0))
    seconds += frame.cpu_seconds(partial(motion_check.check, motion, world))
    yield f"a drive of {steps} steps, with its check", 1e3 * seconds, 100.0
    settings = study.resolved("mga_replans") | study.problems["moving_slow"].settings
    plan, plans = planner_module("modified_genetic").plan, []
    for step in range(0, 10 if small else 200, 5):
        problem = Problem("field", world.workspace(step, 2.0), (0.0, 0.0), (100.0, 100.0))
        work = partial(plan, problem, np.random.default_rng(step), **settings)
        plans.append(frame.cpu_seconds(work, 1))
    yield "a plan at N = 100, 95th percentile", 1e3 * float(np.quantile(plans, 0.95)), 50.0
