"""All metrics: name, unit, meaning, and the runs that they cover.

A metric is a column of the runs table, or is computed from other columns: by a function of its
name, which declares it (`measures`), or by one below that has further arguments. This module is
also imported where only the names matter, so it imports pandas only when a value is requested.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.analysis import measures, running_time
from bezierplan.analysis.metric import METRICS, Metric

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.workspaces.problem import Problem


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
    return Metric("-", meaning, compute, step=1.0, **more)


def _generation(meaning: str, compute: Callable[..., np.ndarray]) -> Metric:
    """The number of a generation of every run."""
    return Metric("generation", meaning, compute, least=0.0, step=1.0)


# Lengths counted in cells have their own bound and gap.
_CELLS4 = {"bound": "octile_bound", "gap": "gap4"}
_CELLS8 = {"bound": "octile_bound", "gap": "gap8"}


AT_LEAST_A_LENGTH = ("length", "objective")
"""Metrics that are path lengths or never less."""

METRICS |= {
    "objective": Metric("u", "final value of the planner's objective"),
    "length": Metric("u", "exact arc length", feasible_only=True, least="bound"),
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
    "collision_depth": Metric("u", "largest depth of the path in obstacles or beyond the border"),
    "clearance": Metric("u", "least distance to the obstacles and the border"),
    "evaluations": _count("paths whose objective the planner asked for", least=0.0),
    "generations": _count("generations made"),
    "cpu_s": Metric("s", "CPU seconds of the run alone", least=0.0),
    "gap": Metric(
        "-",
        "length / exact shortest length of the problem - 1",
        partial(measures.over, "length", "bound"),
        feasible_only=True,
        least=0.0,
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
    "generation_90pct_improved": _generation(
        "first generation by which nine tenths of the run's improvement of the objective are made",
        partial(measures.first_generation_improved_by, 0.9),
    ),
    "objective_best": Metric(
        "u",
        "lowest objective of any generation",
        lambda runs, _: measures.held_history(runs).min(axis=1),
    ),
    "optimum": Metric("u", "least objective of all feasible paths of the planner's kind"),
    "optimal": _count("whether the final path is feasible and optimal, by the planner's own test"),
    "near_optimal": _count(
        "whether the final path is feasible but not optimal, by the planner's own test"
    ),
    "infeasible": _count("whether the final path is infeasible, by the planner's own test"),
    "feasible_last": Metric("-", "share of feasible paths in the last population"),
    "made_infeasible": Metric(
        "-", "share of the mutated feasible paths that mutation made infeasible"
    ),
    "node_diversity": Metric(
        "-", "mean over generations of the chance that a path's inner node is no node of another"
    ),
    "gap_reference": Metric(
        "-",
        "length / length of the best known path of the same kind - 1",
        lambda runs, _: runs["length"] / measures.reference(runs) - 1,
        feasible_only=True,
        needs=("reference",),
    ),
    "cells4": Metric(
        "u",
        "cells that the path touches, 1.5 for a diagonal step; "
        "none for a path that touches an occupied cell",
        partial(measures.length_in_cells, "length4"),
        feasible_only=True,
        least="octile_bound",
        **_CELLS4,
        on=("grid",),
    ),
    "cells8": Metric(
        "u",
        "cells4 without the corners of the sequence of cells",
        partial(measures.length_in_cells, "length8"),
        feasible_only=True,
        least="octile_bound",
        **_CELLS8,
        on=("grid",),
    ),
    "octile_bound": Metric(
        "u", "least length of a path of free cells, 1.5 for a diagonal step", on=("grid",)
    ),
    "gap4": Metric(
        "-",
        "cells4 / octile_bound - 1",
        partial(measures.gap_cells, "length4"),
        feasible_only=True,
        least=0.0,
        **_CELLS4,
        on=("grid",),
    ),
    "gap8": Metric(
        "-",
        "cells8 / octile_bound - 1",
        partial(measures.gap_cells, "length8"),
        feasible_only=True,
        least=0.0,
        **_CELLS8,
        on=("grid",),
    ),
    "history_mean": Metric(
        "u",
        "mean over the generations of the best objective so far",
        lambda runs, _: measures.held_history(runs).mean(axis=1),
    ),
    "deviation": Metric(
        "-",
        "absolute deviation of the length from the median of its condition and method, relative",
        partial(measures.deviation, "length"),
        feasible_only=True,
    ),
    "work_deviation": Metric(
        "-",
        "absolute deviation of the evaluations from the "
        "median of their condition and method, relative",
        partial(measures.deviation, "evaluations"),
    ),
    "distinct_chromosomes": Metric(
        "-", "different chromosomes in the population, mean over the generations"
    ),
    "mean_q": Metric("-", "mean Q statistic of the pool, mean over the generations"),
    "population_q": Metric(
        "-", "mean Q statistic of the surviving population, mean over the generations"
    ),
    "extra_batches": _count("further batches of offspring that the rule for diversity asked for"),
    "valid_share": Metric("-", "share of the children that the planner kept"),
    "violation": Metric(
        "-",
        "mean depth of the samples below the circles, as a share of the radius, "
        "summed over circles",
    ),
    "collisions_a": Metric(
        "particles",
        "colliding particles per iteration, of 20, the first swarm included",
        least=0.0,
        most=20.0,
    ),
    "collisions_b": Metric("samples", "colliding samples per evaluated path, summed over circles"),
    "collisions_c": Metric(
        "samples", "colliding samples of the best path, added over iterations", step=1.0
    ),
    "collisions_d": Metric("iterations", "iterations whose best path collides", step=1.0),
    "collisions_e": _count("whether the final path collides, by the planner's own test"),
    "collisions_f": _count("paths evaluated that collide"),
    "bad_samples": _count("samples of the path that the planner penalised"),
    "arrival": Metric("steps", "when the robot arrives", feasible_only=True, least=0.0),
    "steps": Metric("steps", "how long the robot drives and waits", least=0.0),
    "travelled": Metric("u", "distance travelled, whether or not it is free", least=0.0),
    "last_plan": Metric("u", "length of the last plan", least=0.0),
    "last_optimum": Metric(
        "u",
        "least length of a last plan from cell centre to cell centre, from where the robot was",
        least=0.0,
    ),
    "replans": _count("plans after the first", least=0.0),
    "waits": Metric("steps", "how long the robot waits", least=0.0),
    "collision_steps": _count("steps in which the robot is in an obstacle", least=0.0),
    "collided": _count(
        "whether the robot is in an obstacle at any time",
        lambda runs, _: runs["collision_at"].notna(),
    ),
    "hit_waiting": _count("whether the robot waits when it first collides"),
    "clearance_least": Metric("u", "least distance to an obstacle, negative inside a circle"),
    "least_arrival": Metric(
        "steps", "lower bound on the arrival: time for the shortest path among what is always there"
    ),
    "replan_mean_s": Metric(
        "s", "CPU seconds of a plan after the first, mean of a drive", least=0.0
    ),
    "replan_95_s": Metric(
        "s", "CPU seconds of a plan after the first, 95th percentile of a drive", least=0.0
    ),
    "replans_late": _count("plans after the first that took longer than a step", least=0.0),
    "replan_max_s": Metric(
        "s", "CPU seconds of a plan after the first, largest of a drive", least=0.0
    ),
}

for _within in running_time.TARGETS:
    _percent = f"{100 * _within:.0f}"
    METRICS[f"within_{_percent}pct"] = _count(
        f"whether the path is certified and at most {_percent} % longer than the exact shortest "
        "one",
        lambda runs, _, within=_within: running_time.solves(runs, within),
    )
    for _cost, _unit in (("evaluations", "-"), ("cpu_s", "s")):
        METRICS[f"{_cost}_to_{_percent}pct"] = Metric(
            _unit,
            f"{_cost} of all runs of the same method and condition over the number of those "
            f"within {_percent} %: expected running time",
            partial(running_time.work_to, _cost, _within),
            least=0.0,
            of_group=True,
        )
