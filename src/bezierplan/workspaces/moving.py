"""Circles that move: how a description's numbers become them, and how they are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bezierplan.workspaces.limits import Bounds, check_count, check_thickness
from bezierplan.workspaces.random_field import draw_centres

if TYPE_CHECKING:
    from bezierplan.workspaces.worlds import MovingCircles


def circles(
    description: dict, walls: Bounds, centres: np.ndarray, velocities: np.ndarray, radii: np.ndarray
) -> MovingCircles:
    """Build circles that move within walls: centres and velocities (n, 2), radii (n,).

    Raises ValueError for a radius that is too small.
    """
    from bezierplan.workspaces.worlds import MovingCircles

    for i, radius in enumerate(radii):
        check_thickness(radius, f"circles: circle {i}: radius")
    pace, end = float(description["pace"]), description["steps"]
    return MovingCircles(
        walls, walls, centres, velocities, radii, "circles", pace, end, description["unit"]
    )


def draw_circles(
    rng: np.random.Generator,
    description: dict,
    problem: dict,
    count: int,
    walls: Bounds,
    radius: float,
) -> MovingCircles:
    """Draw circles of a radius that move from random places in random directions, and keep the
    first `obstacles` of the problem.

    Raises ValueError for more than there are, and if no free place is found.
    """
    check_count(problem["obstacles"], count)
    centres = draw_centres(rng, count, walls, problem, radius + description["clear_ends"])
    heading = rng.uniform(0.0, 2 * np.pi, count)
    velocities = description["speed"] * np.column_stack([np.cos(heading), np.sin(heading)])
    kept = slice(problem["obstacles"])
    radii = np.full(count, float(radius))
    return circles(description, walls, centres[kept], velocities[kept], radii[kept])
