"""Metrics of elhoseny2017 alone."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.measures import (
    cells,
    compute_heading_changes,
    extend_histories,
    sample_path,
)
from bezierplan.analysis.metric import (
    Metric,
    build_count,
    measure_on_maps,
    metric,
    of_path,
    register,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    import pandas as pd

    from bezierplan.analysis.metric import Problems
    from bezierplan.workspaces.grid import Grid
    from bezierplan.workspaces.problem import Path

# Approximate length, in units, of the parts by which a path's bending is measured, and samples of a
# curved piece from which they are cut.
BENDING_PART = 0.1
BENDING_SAMPLES = 64


def _cut_into_equal_parts(path: Path) -> tuple[np.ndarray, float]:
    """Cut a path into steps (n, 2) between points at equal arc-length spacing.

    Returns the steps and the spacing, which is close to `BENDING_PART`.
    """
    from bezierplan.geometry import curves
    from bezierplan.running.simulation.ways import build_way

    points = path.points
    if path.curve != "polyline":
        points = sample_path(path, BENDING_SAMPLES * len(curves.bezier_pieces(path)) + 1)
    way = build_way(points)
    # Two parts at least, or there would be no change of heading.
    parts = max(2, round(way.length / BENDING_PART))
    places = way.place(np.linspace(0.0, way.length, parts + 1))
    return np.diff(places, axis=0), way.length / parts


@of_path(
    "rad²/u",
    f"squared changes of heading between parts of {BENDING_PART:g} u over their length, all "
    "added: the integral of squared curvature",
)
def bending(path: Path) -> float:
    """Return the integral of squared curvature, from parts of about `BENDING_PART`, in
    rad²/unit.
    """
    steps, length = _cut_into_equal_parts(path)
    return float((compute_heading_changes(steps) ** 2).sum() / length) if length else 0.0


@of_path("degrees", f"largest change of heading between parts of {BENDING_PART:g} u")
def max_turn(path: Path) -> float:
    """Return the largest change of heading between parts of about `BENDING_PART`, in degrees."""
    return float(
        np.degrees(compute_heading_changes(_cut_into_equal_parts(path)[0]).max(initial=0.0))
    )


@metric(
    "-",
    "whether the straight line from start to target touches an occupied cell",
    step=1.0,
    on=("grid",),
)
def straight_blocked(runs: pd.DataFrame, problems: Problems) -> np.ndarray:
    """Tell for which runs (n,), on grids, the straight line from start to target touches an
    occupied cell.
    """
    lines = [problems[name].start + problems[name].target for name in runs["problem"]]
    straight = runs.assign(path_curve="polyline", path_points=lines)
    return np.isnan(measure_on_maps(cells, straight, problems))


@cache
def _choose_count(name: str) -> Callable[[Path, Grid], float]:
    """Choose a length of `cell_length` by its name, as a measure of free cells alone.

    It is one function for each name, because results are remembered by the function.
    """
    from bezierplan.geometry import cell_length

    count = getattr(cell_length, name)
    return lambda path, grid: np.nan if np.isnan(cells(path, grid)) else count(path, grid)


def measure_in_cells(name: str, runs: pd.DataFrame, problems: Problems) -> list[float]:
    """Measure a length counted in cells (`cell_length`).

    NaN for a path that touches an occupied cell: it is free, but along an obstacle's side rounding
    would decide which cells it counts, and the bound holds for free cells.

    Raises ValueError, naming the run, if a length lies below its problem's bound.
    """
    lengths = measure_on_maps(_choose_count(name), runs, problems)
    for run, length, bound in zip(runs["id"], lengths, runs["octile_bound"]):
        # Sums of steps and of diagonals differ by rounding only.
        if length < bound * (1 - 1e-12):
            raise ValueError(
                f"run {run} is said to be feasible, but its length {length:.12g} in cells lies "
                f"below the bound {bound:.12g}"
            )
    return lengths


def compute_gap_in_cells(name: str, runs: pd.DataFrame, problems: Problems) -> pd.Series:
    """Return a length counted in cells over the problem's least such length, minus 1 (n,)."""
    return measure_in_cells(name, runs, problems) / runs["octile_bound"] - 1


register(
    {
        "octile_bound": Metric(
            "u", "least length of a path of free cells, 1.5 for a diagonal step", on=("grid",)
        ),
        "history_mean": Metric(
            "u",
            "mean over the generations of the best objective so far",
            lambda runs, _: extend_histories(runs).mean(axis=1),
        ),
        "distinct_chromosomes": Metric(
            "-", "different chromosomes in the population, mean over the generations"
        ),
        "population_q": Metric(
            "-", "mean Q statistic of the surviving population, mean over the generations"
        ),
        "loops": build_count("iterations whose offspring are so alike that more are made"),
        "endless_loops": build_count(
            "iterations that make as many batches of offspring as they may"
        ),
    }
)


def _register_length(name: str, function: str, gap: str, meaning: str) -> None:
    """Register a length counted in cells, which has its own bound and gap, and that gap."""
    alike = {"bound": "octile_bound", "gap": gap, "feasible_only": True, "on": ("grid",)}
    length, over = partial(measure_in_cells, function), partial(compute_gap_in_cells, function)
    register(
        {
            name: Metric("u", meaning, length, least="octile_bound", **alike),
            gap: Metric("-", f"{name} / octile_bound - 1", over, least=0.0, **alike),
        }
    )


_register_length(
    "points",
    "length_by_points",
    "gap_points",
    "points of the path at most a cell apart, 1.5 for a diagonal step; none for a path that "
    "touches an occupied cell",
)
_register_length(
    "cells4",
    "length4",
    "gap4",
    "cells that the path touches, 1.5 for a diagonal step; none for a path that touches an "
    "occupied cell",
)
_register_length("cells8", "length8", "gap8", "cells4 without the corners of the sequence of cells")
