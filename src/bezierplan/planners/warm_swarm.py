"""The swarm of `chaotic_pso`, which can start from the path of an earlier plan: for robots that
plan again while their world changes.
"""

from typing import Any

import numpy as np

from bezierplan.geometry import curves
from bezierplan.planners import Plan
from bezierplan.planners.chaotic_pso import check, plan, track, workspaces
from bezierplan.workspaces.problem import Problem

__all__ = ["check", "plan", "resume", "track", "workspaces"]


def resume(
    problem: Problem, rng: np.random.Generator, last: np.ndarray | None, **settings: Any
) -> tuple[Plan, np.ndarray | None]:
    """A plan of a swarm that starts from what the last call returned second, the last free path's
    control points (n, 2) between its ends; None for the first plan, which is that of `plan`.
    """
    found = plan(problem, rng, last, **settings)
    free = np.delete(found.path.points, curves.ends(found.path.curve), axis=0)
    return found, free if found.claimed_feasible else last
