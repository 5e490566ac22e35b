"""Which points of a grid can be control points, one gene each, and the polygon of those selected
(elhoseny2017, Section 3).

Coordinates and lengths are in cells from the grid's lower left corner.
"""

from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.lattice import compute_distances


class Field(NamedTuple):
    """Where the curves lie; lengths in cells from the grid's corner.

    occupied: bool (rows, columns).
    room: (rows, columns) steps in any of eight directions to the nearest occupied cell, 0 for an
        occupied one; the longer side where all cells are free.
    points: (genes, 2) centre of each gene's cell, in the order in which control points are joined.
    index: (genes,) its place on the lattice, column by column.
    settable: (genes,) whether it may be 1.
    choices: the genes that may.
    start, target: x and y.
    """

    occupied: np.ndarray
    room: np.ndarray
    points: np.ndarray
    index: np.ndarray
    settable: np.ndarray
    choices: np.ndarray
    start: tuple[float, float]
    target: tuple[float, float]


def build_field(grid: Grid, ends: np.ndarray, gene_lattice: str, point_order: str) -> Field:
    """Build the genes of a grid, in the order in which they are joined.

    ends: (2, 2) both ends in cells.

    Raises ValueError if no cell of the lattice is free.
    """
    from scipy import ndimage

    rows, columns = grid.occupied.shape
    longer = max(rows, columns)
    # Cell indices of 21 points along the longer side, the outer ones at its ends; or all cells.
    steps = (
        np.floor(np.arange(21) * (longer - 1) / 20 + 0.5).astype(int)
        if gene_lattice == "coarse"
        else np.arange(longer)
    )
    column, row = (index.ravel() for index in np.meshgrid(steps, steps, indexing="ij"))
    points = np.column_stack([column, row]) + 0.5
    # The lattice is a square; beyond a grid's shorter side all is occupied.
    walls = np.pad(grid.occupied, ((0, longer - rows), (0, longer - columns)), constant_values=True)
    at_end = (points == np.floor(ends)[:, None] + 0.5).all(axis=2).any(axis=0)
    settable = ~walls[row, column] & ~at_end
    if not settable.any():
        raise ValueError(
            "gene_lattice: no free gene; every cell of the lattice is occupied, or start or target"
        )
    index = np.arange(len(points))
    if point_order == "projection":
        along = ends[1] - ends[0]
        left = along[0] * (points[:, 1] - ends[0, 1]) - along[1] * (points[:, 0] - ends[0, 0])
        # Points of the same projection are joined from left to right.
        index = np.lexsort((-left, (points - ends[0]) @ along))
    elif point_order == "geodesic":
        far = compute_distances(walls, *np.floor(ends[0, ::-1]).astype(int))
        index = np.argsort(far[row, column], kind="stable")
    room = ndimage.distance_transform_cdt(~grid.occupied, "chessboard")
    room[room < 0] = longer  # there is no occupied cell
    return Field(
        grid.occupied,
        room,
        points[index],
        index,
        settable[index],
        np.flatnonzero(settable[index]),
        *map(tuple, ends.tolist()),
    )


def find_genes_at(points: np.ndarray, field: Field) -> np.ndarray:
    """Find the free genes, ascending, in whose cells some points (n, 2) lie, in cells.

    Genes behind the start are left out: a robot that has passed them would drive back.
    """
    apart = np.abs(points[:, None] - field.points).max(axis=2, initial=0.0)
    genes = apart.argmin(axis=1)
    ahead = (field.points[genes] - field.start) @ np.subtract(field.target, field.start) > 0
    return np.unique(genes[(apart.min(axis=1) < 0.5) & field.settable[genes] & ahead])


def build_polygon(ones: np.ndarray, field: Field) -> np.ndarray:
    """Return start, the control points of a chromosome, and target: (points, 2)."""
    points = np.empty((len(ones) + 2, 2))
    write_polygon(ones, field, points)
    return points


@allocation_free
def write_polygon(ones: np.ndarray, field: Field, points: np.ndarray) -> int:
    """Write the polygon of a chromosome (n,) to the first n + 2 of some points; return their
    number.
    """
    count = len(ones)
    for axis in range(2):
        points[0, axis], points[count + 1, axis] = field.start[axis], field.target[axis]
        for i in range(count):
            points[i + 1, axis] = field.points[ones[i], axis]
    return count + 2
