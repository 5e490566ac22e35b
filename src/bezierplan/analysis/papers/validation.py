"""The rules by which elhoseny2017 accepts control points and curves (Section 3.2.2), one point at a
time, as its figures show them.
"""

import math
from typing import NamedTuple

import numpy as np

from bezierplan.geometry.cell_length import occupied_cells, samples, touched_cells
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Path


class Verdict(NamedTuple):
    """The verdict of Section 3.2.2 on a candidate control point: obstacle, too near, or
    accepted.
    """

    point: tuple[int, int]
    word: str


def verdicts(points: np.ndarray, grid: Grid, least: float) -> list[Verdict]:
    """The subprocesses `Obstacles` and `Distance Threshold` of Section 3.2.2, applied to points (n,
    2) in turn, in units of cells.

    least: the smallest allowed distance from the points accepted before.
    """
    verdicts_made: list[Verdict] = []
    for x, y in points.tolist():
        accepted = [each.point for each in verdicts_made if each.word == "accepted"]
        if grid.occupied[grid.cell_of(x, y)]:
            word = "obstacle"
        elif any(math.dist((x, y), point) < least for point in accepted):
            word = "too near"
        else:
            word = "accepted"
        verdicts_made.append(Verdict((x, y), word))
    return verdicts_made


def curve_through(
    points: list[tuple[int, int]], start: tuple[int, int], target: tuple[int, int]
) -> Path:
    """The Bézier curve of control points, ordered by their projection on the line from start to
    target.
    """
    along = np.subtract(target, start)
    order = sorted(points, key=lambda point: float(np.dot(np.subtract(point, start), along)))
    return Path("bezier", np.array([start, *order, target], dtype=float))


def is_free(path: Path, grid: Grid) -> bool:
    """The subprocess `Valid Path` of Section 3.2.2: whether no cell that the curve touches is
    occupied.
    """
    return occupied_cells(*touched_cells(*samples(path, grid)), grid.occupied) == 0
