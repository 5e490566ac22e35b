"""A planner: the shortest of some polylines through one random point."""

from typing import Annotated

import numpy as np

from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan, Range

workspaces = ("grid",)


def plan(problem, rng, *, tries: Annotated[int, Range(1)]):
    """Return the shortest polyline through one of some random points that is in free cells."""
    grid, best, shortest, history = problem.workspace, None, np.inf, []
    x_low, x_high, y_low, y_high = grid.bounds
    for middle in rng.uniform((x_low, y_low), (x_high, y_high), (tries, 2)):
        path = Path("polyline", np.array([problem.start, middle, problem.target]))
        samples = curves.sample_matrix("polyline", 3, 201) @ path.points
        length = curves.length(path)
        if length < shortest and not any(grid.occupied[grid.cell_of(x, y)] for x, y in samples):
            best, shortest = path, length
        history.append(shortest)
    return Plan(best, shortest, best is not None, tries, np.array(history), "tries", {})
