"""All metrics: name, unit, meaning, and the runs that they cover.

A metric is a column of the runs table, or is computed from other columns (`measures`). This module
is also imported where only the names matter, so it imports pandas only when a value is requested.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bezierplan.analysis import measures, running_time
from bezierplan.analysis.measures import BENDING_PART, CURVATURE_SAMPLES, FINE_SAMPLES

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.workspaces.problem import Path, Problem


class Metric(NamedTuple):
    """What is measured of a run.

    Attributes
    ----------
    unit : str
        `u` stands for the workspace's unit of length, `-` for a number without unit.
    meaning : str
        One phrase.
    feasible_only : bool
        Whether it is taken over the runs whose path the certified checker accepts, otherwise over
        all runs.
    compute : callable or None
        (runs, problems) -> one number per run (n,), where runs is a table of at least one run; None
        for a column of the runs table.
    among_rows : bool
        Whether it compares the methods of a table with each other, so that variants and baselines
        outside the table have none.
    least : float or str
        The smallest value that a run can have, or the column of the runs table that holds it.
    most : float
        The largest value that a run can have.
    bound : str
        The column with the bound for this kind of length.
    gap : str
        The metric of the gap to that bound.
    step : float or None
        The distance between possible values of a run, 1 for whole numbers; None if there is none.
    of_group : bool
        Whether all runs of a method under a condition share it, so that resampling them does not
        show how certain it is.
    needs : tuple of str
        Columns that only some runs tables have; with none, and without compute, the column of its
        own name.
    on : tuple of str
        Kinds of workspace; () for all.
    """

    unit: str
    meaning: str
    feasible_only: bool
    compute: Callable[[pd.DataFrame, dict[str, Problem]], np.ndarray] | None = None
    among_rows: bool = False
    least: float | str = -np.inf
    most: float = np.inf
    bound: str = "bound"
    gap: str = "gap"
    step: float | None = None
    of_group: bool = False
    needs: tuple[str, ...] = ()
    on: tuple[str, ...] = ()


def values(runs: pd.DataFrame, name: str, problems: dict[str, Problem]) -> pd.Series:
    """A metric of each run.

    Parameters
    ----------
    runs : DataFrame
        Rows of a runs table; a metric that compares runs with each other uses these.
    name : str
        A name of `METRICS`.
    problems : dict of str to Problem
        The problems that the runs are of, by name.

    Returns
    -------
    Series of float
        With the runs' index; booleans as 1 and 0. Nan where the run has no such value, and where a
        metric for feasible runs only meets an infeasible run.

    Raises
    ------
    KeyError
        For an unknown metric.
    ValueError
        If the runs table lacks a column that only some have.
    """
    import pandas as pd

    metric = METRICS[name]
    counted = runs[runs["feasible"].astype(bool)] if metric.feasible_only else runs
    lacking = [
        column
        for column in metric.needs or (() if metric.compute else (name,))
        if column not in runs
    ]
    if counted.empty:
        numbers = pd.Series(dtype=float)
    elif lacking:
        raise ValueError(f"metric {name}: no run has it: their table has no column {lacking[0]}")
    elif metric.compute is None:
        numbers = counted[name].astype(float)
    else:
        numbers = pd.Series(
            np.asarray(metric.compute(counted, problems), dtype=float), index=counted.index
        )
    return numbers.reindex(runs.index)


def unit(name: str, workspace_unit: str) -> str:
    """The unit of a metric in a workspace.

    Parameters
    ----------
    name : str
        A name of `METRICS`.
    workspace_unit : str
        The workspace's unit of length.

    Returns
    -------
    str
        `-` for a number without unit.
    """
    return re.sub(r"\bu\b", lambda _: workspace_unit, METRICS[name].unit)


def _count(
    meaning: str,
    compute: Callable[[pd.DataFrame, dict[str, Problem]], np.ndarray] | None = None,
    **more: Any,
) -> Metric:
    """A count of every run, or whether something is true of it: 1 or 0."""
    return Metric("-", meaning, False, compute, step=1.0, **more)


def _generation(meaning: str, compute: Callable[..., np.ndarray]) -> Metric:
    """The number of a generation of every run."""
    return Metric("generation", meaning, False, compute, least=0.0, step=1.0)


def _of_path(
    unit: str,
    meaning: str,
    measure: Callable[[Path], float],
    feasible_only: bool = True,
    **more: Any,
) -> Metric:
    """A measure of a path alone."""
    return Metric(unit, meaning, feasible_only, partial(measures.of_path, measure), **more)


# Lengths counted in cells have their own bound and gap.
_CELLS4 = {"bound": "octile_bound", "gap": "gap4"}
_CELLS8 = {"bound": "octile_bound", "gap": "gap8"}

_GAP_LEAST_ARRIVAL = partial(measures.over, "arrival", "least_arrival")

METRICS: dict[str, Metric] = {
    "objective": Metric("u", "final value of the planner's objective", False),
    "length": Metric("u", "exact arc length", True, least="bound"),
    "polygon_length": _of_path(
        "u", "length of the control polygon", measures.polygon_length, least="bound"
    ),
    "certified_length": Metric(
        "u",
        "exact arc length, infinite unless the certified checker accepts the path",
        False,
        running_time.certified_length,
        least="bound",
    ),
    "claimed_feasible": _count("the planner's own test of the path"),
    "feasible": _count("the certified checker's test of the path"),
    "failed": _count(
        "without a path that the certified checker accepts",
        lambda runs, _: ~runs["feasible"].astype(bool),
    ),
    "falsely_claimed": _count(
        "free by the planner's own test, colliding by the checker's",
        partial(measures.disagrees, True),
    ),
    "wrongly_rejected": _count(
        "free by the checker's test, not by the planner's own", partial(measures.disagrees, False)
    ),
    "obstacle_clearance": Metric(
        "u",
        "least distance to the occupied cells of a grid, its border not counted",
        True,
        measures.obstacle_clearance,
        on=("grid",),
    ),
    "keeps_distance": Metric(
        "-",
        "whether the planner's safety distance from the occupied cells is kept",
        True,
        measures.keeps_distance,
        step=1.0,
        needs=("safety_distance",),
        on=("grid",),
    ),
    "length_at_distance": Metric(
        "u",
        "length of a path that keeps the planner's safety distance",
        True,
        measures.length_at_distance,
        needs=("safety_distance",),
        on=("grid",),
    ),
    "collision_depth": Metric(
        "u", "largest depth of the path in obstacles or beyond the border", False
    ),
    "clearance": Metric("u", "least distance to the obstacles and the border", False),
    "evaluations": _count("paths whose objective the planner asked for", least=0.0),
    "points_evaluated": _count(
        "control points of all paths evaluated", measures.points_evaluated, least=0.0
    ),
    "generations": _count("generations made"),
    "rank": Metric(
        "-",
        "rank of the objective among the rows of the table, within one unit",
        False,
        measures.rank,
        among_rows=True,
        least=1.0,
        step=0.5,
    ),
    "cpu_s": Metric("s", "CPU seconds of the run alone", False, least=0.0),
    "gap": Metric(
        "-",
        "length / exact shortest length of the problem - 1",
        True,
        partial(measures.over, "length", "bound"),
        least=0.0,
    ),
    "gap_best": Metric(
        "-",
        "length / length of the best feasible run of the same method and condition - 1",
        True,
        measures.gap_best,
    ),
    "generation_improved": _generation(
        "last generation that improved the objective",
        partial(measures.first_generation_within, 0.0),
    ),
    "generation_1pct": _generation(
        "first generation within 1 % of the run's final objective",
        partial(measures.first_generation_within, 0.01),
    ),
    "generation_5pct": _generation(
        "first generation within 5 % of the run's final objective",
        partial(measures.first_generation_within, 0.05),
    ),
    "improvement_30": Metric(
        "-",
        "share of the improvement of the objective made by generation 30",
        False,
        partial(measures.improvement_by, 30),
    ),
    "generation_90pct_improved": _generation(
        "first generation by which nine tenths of the run's improvement of the objective are made",
        partial(measures.first_generation_improved_by, 0.9),
    ),
    "objective_best": Metric(
        "u",
        "lowest objective of any generation",
        False,
        lambda runs, _: measures.held_history(runs).min(axis=1),
    ),
    "optimum": Metric("u", "least objective of all feasible paths of the planner's kind", False),
    "optimal": _count("whether the final path is feasible and optimal, by the planner's own test"),
    "near_optimal": _count(
        "whether the final path is feasible but not optimal, by the planner's own test"
    ),
    "infeasible": _count("whether the final path is infeasible, by the planner's own test"),
    "feasible_last": Metric("-", "share of feasible paths in the last population", False),
    "made_infeasible": Metric(
        "-", "share of the mutated feasible paths that mutation made infeasible", False
    ),
    "node_diversity": Metric(
        "-",
        "mean over generations of the chance that a path's inner node is no node of another",
        False,
    ),
    "max_curvature": _of_path(
        "1/u",
        f"largest absolute curvature over {CURVATURE_SAMPLES} samples, "
        "corners between pieces left out",
        measures.max_curvature,
    ),
    "signed_curvature": _of_path(
        "1/u",
        f"largest curvature over {CURVATURE_SAMPLES} samples by its sign, left turns positive; "
        "corners between pieces left out",
        measures.signed_curvature,
    ),
    "curvature_jump": _of_path(
        "1/u",
        "largest jump of curvature over the joints, infinite at a corner",
        measures.curvature_jump,
    ),
    "zero_speed_points": _of_path(
        "-",
        f"samples of {CURVATURE_SAMPLES} where the curve stands still and curvature is not defined",
        measures.zero_speed_points,
        step=1.0,
    ),
    "heading_max": _of_path(
        "rad", "largest change of heading between neighbouring chords", measures.heading_max
    ),
    "turning": _of_path("rad", "changes of heading, all added", measures.turning),
    "bending": _of_path(
        "rad²/u",
        f"squared changes of heading between parts of {BENDING_PART:g} u over their length, all "
        "added: the integral of squared curvature",
        measures.bending,
    ),
    "max_turn": _of_path(
        "degrees",
        f"largest change of heading between parts of {BENDING_PART:g} u",
        measures.max_turn,
    ),
    "corners": _of_path(
        "-", "joints of a path's pieces at which its heading changes", measures.corners, step=1.0
    ),
    "spare_corners": Metric(
        "-",
        "corners of a polyline that can be left out, because a free leg joins the corners before "
        "and after; none for a curve",
        True,
        partial(measures.of_path_on_grid, measures.spare_corners),
        step=1.0,
    ),
    "length_over_polygon": _of_path(
        "-", "length / length of the control polygon", measures.length_over_polygon
    ),
    "distinct_points": _of_path(
        "-",
        "control points that differ from each other",
        measures.distinct_points,
        feasible_only=False,
        step=1.0,
    ),
    "occupied_points": Metric(
        "-",
        "control points in occupied cells of a grid",
        True,
        partial(measures.of_path_on_grid, measures.occupied_points),
        step=1.0,
        on=("grid",),
    ),
    "gap_reference": Metric(
        "-",
        "length / length of the best known path of the same kind - 1",
        True,
        lambda runs, _: runs["length"] / measures.reference(runs) - 1,
        needs=("reference",),
    ),
    "excess_reference": Metric(
        "u",
        "length - length of the best known path of the same kind",
        True,
        lambda runs, _: runs["length"] - measures.reference(runs),
        needs=("reference",),
    ),
    "cells4": Metric(
        "u",
        "cells that the path touches, 1.5 for a diagonal step; "
        "none for a path that touches an occupied cell",
        True,
        partial(measures.length_in_cells, "length4"),
        least="octile_bound",
        **_CELLS4,
        on=("grid",),
    ),
    "cells8": Metric(
        "u",
        "cells4 without the corners of the sequence of cells",
        True,
        partial(measures.length_in_cells, "length8"),
        least="octile_bound",
        **_CELLS8,
        on=("grid",),
    ),
    "cells": Metric(
        "-",
        "number of cells that the path touches; none for a path that touches an occupied cell",
        True,
        partial(measures.of_path_on_grid, measures.cells_touched),
        least=0.0,
        step=1.0,
        on=("grid",),
    ),
    "octile_bound": Metric(
        "u", "least length of a path of free cells, 1.5 for a diagonal step", False, on=("grid",)
    ),
    "homotopy": Metric(
        "-",
        "class of the path: the sum of 2^k over the circles k that it leaves to its left",
        True,
        measures.homotopy,
        step=1.0,
        on=("circles",),
    ),
    "best_corridor": _count(
        "whether the path is free and passes each circle where the shortest one does",
        measures.best_corridor,
        on=("circles",),
    ),
    "gap4": Metric(
        "-",
        "cells4 / octile_bound - 1",
        True,
        partial(measures.gap_cells, "length4"),
        least=0.0,
        **_CELLS4,
        on=("grid",),
    ),
    "gap8": Metric(
        "-",
        "cells8 / octile_bound - 1",
        True,
        partial(measures.gap_cells, "length8"),
        least=0.0,
        **_CELLS8,
        on=("grid",),
    ),
    "straight_blocked": _count(
        "whether the straight line from start to target touches an occupied cell",
        measures.straight_blocked,
        on=("grid",),
    ),
    "history_mean": Metric(
        "u",
        "mean over the generations of the best objective so far",
        False,
        lambda runs, _: measures.held_history(runs).mean(axis=1),
    ),
    "deviation": Metric(
        "-",
        "absolute deviation of the length from the median of its condition and method, relative",
        True,
        partial(measures.deviation, "length"),
    ),
    "work_deviation": Metric(
        "-",
        "absolute deviation of the evaluations from the "
        "median of their condition and method, relative",
        False,
        partial(measures.deviation, "evaluations"),
    ),
    "distinct_chromosomes": Metric(
        "-", "different chromosomes in the population, mean over the generations", False
    ),
    "mean_q": Metric("-", "mean Q statistic of the pool, mean over the generations", False),
    "population_q": Metric(
        "-", "mean Q statistic of the surviving population, mean over the generations", False
    ),
    "extra_batches": _count("further batches of offspring that the rule for diversity asked for"),
    "valid_share": Metric("-", "share of the children that the planner kept", False),
    "outlier": _count(
        "whether the objective lies beyond the whiskers of its method's box", measures.outlier
    ),
    "violation": Metric(
        "-",
        "mean depth of the samples below the circles, as a share of the radius, "
        "summed over circles",
        False,
    ),
    "collisions_a": Metric(
        "particles",
        "colliding particles per iteration, of 20, the first swarm included",
        False,
        least=0.0,
        most=20.0,
    ),
    "collisions_b": Metric(
        "samples", "colliding samples per evaluated path, summed over circles", False
    ),
    "collisions_c": Metric(
        "samples", "colliding samples of the best path, added over iterations", False, step=1.0
    ),
    "collisions_d": Metric("iterations", "iterations whose best path collides", False, step=1.0),
    "collisions_e": _count("whether the final path collides, by the planner's own test"),
    "collisions_f": _count("paths evaluated that collide"),
    "bad_samples": _count("samples of the path that the planner penalised"),
    # Of drives in dynamic environments.
    "arrival": Metric("steps", "when the robot arrives", True, least=0.0),
    "steps": Metric("steps", "how long the robot drives and waits", False, least=0.0),
    "travelled": Metric("u", "distance travelled, whether or not it is free", False, least=0.0),
    "first_plan": Metric("u", "length of the first plan", False, least=0.0),
    "last_plan": Metric("u", "length of the last plan", False, least=0.0),
    "last_optimum": Metric(
        "u",
        "least length of a last plan from cell centre to cell centre, from where the robot was",
        False,
        least=0.0,
    ),
    "replans": _count("plans after the first", least=0.0),
    "waits": Metric("steps", "how long the robot waits", False, least=0.0),
    "collision_steps": _count("steps in which the robot is in an obstacle", least=0.0),
    "collided": _count(
        "whether the robot is in an obstacle at any time",
        lambda runs, _: runs["collision_at"].notna(),
    ),
    "hit_waiting": _count("whether the robot waits when it first collides"),
    "clearance_least": Metric(
        "u", "least distance to an obstacle, negative inside a circle", False
    ),
    "gap_least_arrival": Metric(
        "-",
        "arrival / lower bound on the arrival - 1",
        True,
        _GAP_LEAST_ARRIVAL,
        least=0.0,
        needs=("arrival",),
    ),
    "paired_gap_least_arrival": Metric(
        "-",
        "gap_least_arrival where all methods of the table arrive",
        False,
        partial(measures.paired, _GAP_LEAST_ARRIVAL),
        among_rows=True,
        least=0.0,
        needs=("arrival",),
    ),
    "least_arrival": Metric(
        "steps",
        "lower bound on the arrival: time for the shortest path among what is always there",
        False,
    ),
    "replan_mean_s": Metric(
        "s", "CPU seconds of a plan after the first, mean of a drive", False, least=0.0
    ),
    "replan_95_s": Metric(
        "s", "CPU seconds of a plan after the first, 95th percentile of a drive", False, least=0.0
    ),
    "replans_late": _count("plans after the first that took longer than a step", least=0.0),
    "replan_max_s": Metric(
        "s", "CPU seconds of a plan after the first, largest of a drive", False, least=0.0
    ),
    "fine_bad": _count(
        f"samples of {FINE_SAMPLES} in occupied cells of a grid",
        partial(measures.of_path_on_grid, measures.fine_bad),
        on=("grid",),
    ),
}

for _within in running_time.TARGETS:
    _percent = f"{100 * _within:.0f}"
    METRICS[f"within_{_percent}pct"] = _count(
        f"whether the path is certified and at most {_percent} % longer than the exact shortest "
        "one",
        partial(running_time.solved, _within),
    )
    for _cost, _unit in (("evaluations", "-"), ("cpu_s", "s")):
        METRICS[f"{_cost}_to_{_percent}pct"] = Metric(
            _unit,
            f"{_cost} of all runs of the same method and condition over the number of those "
            f"within {_percent} %: expected running time",
            False,
            partial(running_time.work_to, _cost, _within),
            least=0.0,
            of_group=True,
        )
