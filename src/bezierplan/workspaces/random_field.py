"""Square fields of cells with circles at random positions (elhoseny2017, Sections 4.3 and 4.4).

A field of side N has (N + 1) x (N + 1) cells of side 1, whose centres are the points with integer
coordinates from 0 to N, so that the corners (0, 0) and (N, N), between which the paper plans, are
cells. A cell is occupied if its centre lies in a circle.
"""

import numpy as np

from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import Bounds
from bezierplan.workspaces.seeds import generator

# Number of fields, and of draws of one circle, before giving up.
MOST_FIELDS = 200
MOST_DRAWS = 10_000


def field(description: dict, problem: dict, name: str) -> Grid:
    """Draw the field of a problem from names and numbers alone: problems that differ in any of them
    get unrelated fields.

    Centres are uniform in the square from 0 to N; a centre too close to start or target is redrawn.
    Circles may overlap. A field in which no path of free cells leads from start to target is
    redrawn as a whole.

    description: radius, every circle's as a share of the side, or of radius_side, if that is a
        number; clear_ends, the cells that stay free between a circle and start or target; nested,
        whether fields that differ in their numbers of circles alone have the first circles in
        common; and unit.
    problem: side (N); start; target; obstacles, the number of circles; and layout, the number of
        the field.
    name: "study/workspace".

    Raises ValueError, naming the key, if start or target is not a cell of the field, or if no field
    can be found.
    """
    side = problem["side"]
    nested = description.get("nested", False)
    # Nested fields have one seed for all numbers of circles.
    count = () if nested else (problem["obstacles"],)
    rng = generator(name, side, *problem["start"], *problem["target"], *count, problem["layout"])
    square = 0.0, side, 0.0, side
    empty = from_circles(Circles(square, np.empty((0, 2)), np.empty(0), description["unit"]))
    cells = end_cells(empty, problem)
    measure = description.get("radius_side", "own")
    radius = description["radius"] * (side if measure == "own" else measure)
    for _ in range(MOST_FIELDS):
        # Each draw of a nested field begins anew, however many numbers the last one took.
        draw = rng.spawn(1)[0] if nested else rng
        centres = draw_centres(
            draw, problem["obstacles"], square, problem, radius + description["clear_ends"]
        )
        radii = np.full(len(centres), radius)
        grid = from_circles(Circles(square, centres, radii, description["unit"]))
        if is_connected(grid.occupied, *cells):
            return grid
    raise ValueError(
        f"radius: {description['radius']:g}: start and target are cut off from each other in "
        f"{MOST_FIELDS} fields"
    )


def end_cells(grid: Grid, problem: dict) -> list[tuple[int, int]]:
    """Return the cells (row, column) of a problem's start and target.

    Raises ValueError, naming the key, if one of them is not on the map.
    """
    cells = []
    for key in ("start", "target"):
        cell = grid.cell_of(*map(float, problem[key]))
        if cell is None:
            left, right, bottom, top = grid.bounds
            raise ValueError(
                f"{key}: {problem[key]}: outside the map; expected x from {left:g} to {right:g}, "
                f"y from {bottom:g} to {top:g}"
            )
        cells.append(cell)
    return cells


def draw_centres(
    rng: np.random.Generator,
    count: int,
    bounds: Bounds,
    problem: dict,
    least: float,
) -> np.ndarray:
    """Draw centres (count, 2) within bounds, none of them closer to an end of a problem than the
    least distance.

    Raises ValueError if no free place is found.
    """
    low, high = np.reshape(bounds, (2, 2)).T
    ends = np.array([problem["start"], problem["target"]], float)
    centres = np.empty((count, 2))
    for i in range(count):
        for _ in range(MOST_DRAWS):
            centres[i] = rng.uniform(low, high)
            if np.hypot(*(ends - centres[i]).T).min() >= least:
                break
        else:
            raise ValueError(
                f"radius: no circle keeps {least:g} away from start and target in "
                f"{MOST_DRAWS} draws"
            )
    return centres


def from_circles(circles: Circles) -> Grid:
    """Build the field of some circles; their bounds are its square, from 0 to N."""
    # Here, since a start that only reads descriptions needs no kernels.
    from bezierplan.workspaces.cells_in_circles import occupy

    count = round(circles.bounds[1]) + 1
    occupied = np.zeros((count, count), bool)
    occupy(occupied, np.ascontiguousarray(circles.centres), np.ascontiguousarray(circles.radii))
    return Grid(occupied, 1.0, circles.unit, (-0.5, -0.5), circles)


def is_connected(occupied: np.ndarray, start: tuple[int, int], target: tuple[int, int]) -> bool:
    """Tell whether free cells lead from one cell (row, column) to another; a diagonal step may pass
    between two occupied cells.
    """
    from scipy.ndimage import label

    names, _ = label(~occupied, structure=np.ones((3, 3)))
    return bool(names[start] and names[start] == names[target])
