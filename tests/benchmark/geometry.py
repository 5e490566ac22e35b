"""Checks and bounds by kind and size of workspace."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from timing import cpu_seconds

from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.geojson import polygons_from_geojson
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Path as Curve
from bezierplan.workspaces.problem import Problem, Workspace


def random_grid(side: int, rng: np.random.Generator) -> Grid:
    """A grid of that many rows and columns with 25 rectangular blocks, two corners free."""
    occupied = np.zeros((side, side), dtype=bool)
    for row, column in rng.integers(1, side - 1, (25, 2)):
        height, width = rng.integers(1, max(2, side // 8), 2)
        occupied[row : row + height, column : column + width] = True
    occupied[0, 0] = occupied[-1, -1] = False
    return Grid(occupied, 1.0, "cell")


def random_discs(count: int, rng: np.random.Generator) -> Circles:
    """Discs in a square, two corners free."""
    centres = rng.uniform(2, 18, (count, 2))
    return Circles((0.0, 20.0, 0.0, 20.0), centres, rng.uniform(0.3, 1.0, count), "unit")


def workspaces() -> Iterator[tuple[str, Workspace]]:
    """Workspaces of every kind, small and large, by name."""
    rng = np.random.default_rng(0)
    for count in (3, 10, 25):
        yield f"circles {count}", random_discs(count, rng)
    for side in (16, 20, 100, 200):
        yield f"cells {side} x {side}", random_grid(side, rng)
    for file in sorted(
        (Path(__file__).parents[2] / "config/studies/elhoseny2017/workspaces").glob("*.geojson")
    ):
        yield f"polygons {file.stem}", polygons_from_geojson(file.read_text(), "m")


def benchmark_geometry() -> None:
    """Microseconds a check (median over random curves, half of them short) and milliseconds a bound
    from corner to corner.
    """
    print(
        f"\n{'workspace':26}{'check: median us':>18}{'99 % us':>10}"
        f"{'colliding':>11}{'bound: ms':>12}"
    )
    rng = np.random.default_rng(1)
    for name, workspace in workspaces():
        blocked = region(workspace)
        x_low, x_high, y_low, y_high = workspace.bounds
        seconds, colliding = [], 0
        for trial in range(401):
            first = rng.uniform((x_low, y_low), (x_high, y_high))
            reach = (x_high - x_low) * (0.05 if trial % 2 else 1.0)
            points = np.clip(
                first + rng.uniform(-reach, reach, (6, 2)), (x_low, y_low), (x_high, y_high)
            )
            pieces = curves.bezier_pieces(
                Curve(("bezier", "piecewise_quadratic")[trial // 2 % 2], points)
            )
            before = time.perf_counter()
            found = checker.check(pieces, blocked)
            seconds.append(time.perf_counter() - before)
            colliding += not found.feasible
        times = 1e6 * np.array(seconds[1:])
        inset = 0.5 * getattr(workspace, "cell", 0.02)
        corners = Problem(
            "bound", workspace, (x_low + inset, y_low + inset), (x_high - inset, y_high - inset)
        )
        bound = 1e3 * cpu_seconds(lambda: shortest_paths.shortest_path(corners))  # noqa: B023
        print(
            f"  {name:24}{np.median(times):18.0f}{np.quantile(times, 0.99):10.0f}"
            f"{colliding / 401:11.2f}{bound:12.2f}"
        )
