"""Fields of occupied cells at random places."""

import numpy as np

from bezierplan.workspaces.grid import Grid


def scattered(rng, problem, *, side: int):
    """A square field with as many occupied cells as the problem has obstacles; fields of one layout
    with more of them contain those with fewer. Cells beside start and target stay free.
    """
    cells = [(row, column) for row in range(side) for column in range(side)]
    ends = [(int(y), int(x)) for x, y in (problem["start"], problem["target"])]
    away = [cell for cell in cells if all(np.abs(np.subtract(cell, end)).max() > 1 for end in ends)]
    occupied = np.zeros((side, side), dtype=bool)
    for number in rng.permutation(len(away))[: problem["obstacles"]]:
        occupied[away[number]] = True
    return Grid(occupied, 1.0, "cell")
