"""Drives in worlds that move: a step without replans, a whole drive, and a plan."""

import numpy as np
from timing import cpu_seconds

from bezierplan.planners import planner_module
from bezierplan.running.simulation import circles, motion_check
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.ways import way
from bezierplan.running.worlds import build
from bezierplan.study import reading
from bezierplan.workspaces.problem import Problem

STEPS, OBSTACLES = 600, 15


def benchmark_simulation() -> None:
    """The field of elhoseny2017 with 15 moving obstacles; the limits are 10 microseconds per step,
    0.1 s per drive of 600 steps without replans, and 0.05 s per plan (95th percentile).
    """
    study = reading.load(reading.read_config({"studies": ["elhoseny2017"]}))["elhoseny2017"]
    described = study.problems["moving_slow"].plain("settings", "layouts") | {
        "obstacles": OBSTACLES,
        "layout": 0,
    }
    world = build(
        study.workspaces["moving_slow"].plain(), described, "elhoseny2017/moving_slow", study.folder
    )
    policy = study.policies["replans"]
    # A way as long as the drive, of chords of half a cell, in a corner that no circle reaches: all
    # of it is checked in every step.
    turn = np.linspace(0.0, STEPS, 2 * STEPS)
    along = way(np.column_stack([200.0 + turn % 3.0, 200.0 + turn]))
    seconds = cpu_seconds(
        lambda: circles.follow(world, along, 0, policy.but(replan="when_blocked"))
    )
    print(f"\n{'a step without replans':36}{1e6 * seconds / STEPS:12.1f} us")
    motion = Motion(np.column_stack([np.linspace(0, 100, STEPS + 1)] * 2), np.arange(STEPS + 1.0))
    seconds += cpu_seconds(lambda: motion_check.check(motion, world))
    print(f"{'a drive of 600 steps, with its check':36}{1e3 * seconds:12.1f} ms")
    settings = study.resolved("mga_replans") | study.problems["moving_slow"].settings
    plan, taken = planner_module("modified_genetic").plan, []
    for step in range(0, 200, 5):
        problem = Problem("field", world.workspace(step, 2.0), (0.0, 0.0), (100.0, 100.0))
        rng = np.random.default_rng(step)
        taken.append(cpu_seconds(lambda: plan(problem, rng, **settings), rounds=1))  # noqa: B023
    print(f"{'a plan at N = 100, 95th percentile':36}{1e3 * np.quantile(taken, 0.95):12.1f} ms")
