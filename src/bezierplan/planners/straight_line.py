"""A baseline: the straight line from start to target, whatever lies between them."""

import math

import numpy as np

from bezierplan.planners import Path, Plan, Problem

deterministic = True


def plan(problem: Problem, rng: np.random.Generator) -> Plan:
    """Return the straight line from start to target; its objective is its length, in units.

    It ignores obstacles and claims every path to be free.
    """
    length = math.dist(problem.start, problem.target)
    path = Path("polyline", problem.ends)
    return Plan.of_one(path, length, "direct")
