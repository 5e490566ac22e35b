"""A baseline: the exact shortest path, which none can beat (`shortest_paths.shortest_path`)."""

import math

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.planners import Path, Plan, Problem

exact = True

deterministic = True


def plan(problem: Problem, rng: np.random.Generator) -> Plan:
    """Return the shortest path that touches obstacles but enters none; its objective is its length,
    in units, or infinite if there is no path.

    Around circles it is a polyline at most 1e-6 units longer.
    """
    bound = shortest_paths.shortest_path(problem)
    path = Path("polyline", bound.points) if math.isfinite(bound.length) else None
    return Plan.of_one(path, bound.length, "exact")
