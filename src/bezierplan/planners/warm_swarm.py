"""The swarm of `chaotic_pso`, which can start from the path of an earlier plan: for robots that
plan again while their world changes.
"""

from typing import Any

import numpy as np

from bezierplan.geometry import curves
from bezierplan.planners import Plan, Problem
from bezierplan.planners.chaotic_pso import check, plan, track, workspaces

__all__ = ["check", "plan", "resume", "track", "workspaces"]


def resume(
    problem: Problem, rng: np.random.Generator, last: np.ndarray | None, **settings: Any
) -> tuple[Plan, np.ndarray | None]:
    """Plan again with a swarm that starts from the path of an earlier call.

    last: second result of the last call, the free control points (n, 2) of the last path that
        was free; None for the first plan, which is that of `plan`.
    """
    found = plan(problem, rng, last, **settings)
    free = np.delete(found.path.points, curves.ends(found.path.curve), axis=0)
    # A path in collision is no start: the last free one is kept for the next call.
    return found, free if found.claimed_feasible else last
