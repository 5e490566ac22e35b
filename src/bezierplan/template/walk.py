"""A planner: the shortest of some polylines through one random point."""

from typing import Annotated

import numpy as np

from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan, Range

workspaces = ("grid",)


def plan(problem, rng, *, tries: Annotated[int, Range(1)]):
    """The shortest of some polylines through a random point whose samples are in free cells."""
    grid, best, history = problem.workspace, None, []
    x_low, x_high, y_low, y_high = grid.bounds
    for middle in rng.uniform((x_low, y_low), (x_high, y_high), (tries, 2)):
        path = Path("polyline", np.array([problem.start, middle, problem.target]))
        cells = [
            grid.cell_of(x, y) for x, y in curves.sample_matrix("polyline", 3, 201) @ path.points
        ]
        if not any(grid.occupied[cell] for cell in cells) and (
            best is None or curves.length(path) < curves.length(best)
        ):
            best = path
        history.append(np.inf if best is None else curves.length(best))
    return Plan(best, history[-1], best is not None, tries, np.array(history), "tries", {})
