"""Maps that a program makes: all checks that readers of files do as they read, in one place."""

from functools import lru_cache

import numpy as np

from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.files import Workspace
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.grown import original
from bezierplan.workspaces.limits import check_bounds, check_numbers, check_thickness


@lru_cache(maxsize=4)
def check_map(workspace: Workspace) -> None:
    """Raise ValueError, naming the field, for arrays of the wrong shape, numbers that are none,
    bounds out of order, radii and cells that are too small, and rings that are no simple polygon.
    """
    # Only the map before its growth comes from a program; the grown one is made here.
    home = original(workspace)
    if isinstance(home, Grid):
        _check_shape(home.occupied, "occupied", (None, None))
        check_thickness(home.cell, "cell:")
    check_bounds(home.bounds)
    if isinstance(home, Circles):
        _check_shape(home.radii, "radii", (None,))
        _check_shape(home.centres, "centres", (len(home.radii), 2))
        check_numbers(np.append(home.centres, home.radii), "circles")
        check_thickness(min(home.radii, default=np.inf), "radii: least")
    elif not isinstance(home, Grid):
        _check_rings(home.obstacles)


def _check_rings(obstacles: tuple[tuple[np.ndarray, ...], ...]) -> None:
    """Raise ValueError, naming the obstacle, for rings that are no simple polygon."""
    import shapely

    for number, rings in enumerate(obstacles):
        where = f"obstacles: {number}"
        for ring in rings:
            _check_shape(ring, where, (None, 2))
            check_numbers(ring, where)
        try:
            polygon = shapely.Polygon(rings[0], rings[1:])
        except ValueError as fault:
            raise ValueError(f"{where}: {fault}") from None
        if not polygon.is_valid:
            raise ValueError(
                f"{where}: {shapely.is_valid_reason(polygon)}; expected a simple polygon"
            )


def _check_shape(array: np.ndarray, name: str, shape: tuple[int | None, ...]) -> None:
    """Raise ValueError unless an array has a shape, of which None is any length."""
    fits = len(array.shape) == len(shape) and all(
        size == asked or asked is None for size, asked in zip(array.shape, shape)
    )
    if not fits:
        raise ValueError(f"{name}: an array {array.shape}; expected {shape}, None for any length")
