"""All metrics: name, unit, meaning, and the runs that they cover.

A metric is a column of the runs table, or is computed from other columns: by a function of its
name, which declares it (`measures`), or by one below that has further arguments. This module is
also imported where only the names matter, so it imports pandas only when a value is requested.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis import measures
from bezierplan.analysis.metric import (
    ALL_STUDIES,
    METRICS,
    Metric,
    build_column_metric,
    build_count,
    build_generation,
)

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.metric import Problems


def compute_values(runs: pd.DataFrame, name: str, problems: Problems) -> pd.Series:
    """Compute a metric of each run.

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
        If the runs table lacks a column that only some have, or a study's own metric is infinite.
    """
    import pandas as pd

    metric = METRICS[name]
    counted = runs[runs["feasible"].astype(bool)] if metric.feasible_only else runs
    lacking = [
        column
        for column in metric.needs or (() if metric.compute else (name,))
        if column not in runs
    ]
    # Measures need at least one run.
    if counted.empty:
        numbers = pd.Series(dtype=float)
    elif lacking:
        raise ValueError(f"metric {name}: no run has it: their table has no column {lacking[0]}")
    else:
        values = metric.compute(counted, problems) if metric.compute else counted[name]
        numbers = pd.Series(np.asarray(values, dtype=float), index=counted.index)
        if metric.own and (infinite := np.isinf(numbers)).any():
            run = counted.loc[infinite.idxmax(), "id"]
            raise ValueError(
                f"metric {name}: infinite for run {run}; expected a finite number, or nan for none"
            )
    return numbers.reindex(runs.index)


def add_columns(names: Iterable[str]) -> None:
    """Add metrics of columns that planners report and that are none yet."""
    # A name that is not stored has a metric, too (`__missing__`), but checks of names and lists
    # of them know only those that are stored.
    METRICS.update({name: METRICS[name] for name in names if name not in METRICS})


def find_unit(name: str, workspace_unit: str) -> str:
    """Return the unit of a metric in a workspace.

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


AT_LEAST_A_LENGTH = ("length", "objective")
"""Metrics that are path lengths or never less."""

OF_COLUMNS = (
    "objective",
    "claimed_feasible",
    "feasible",
    "collision_depth",
    "clearance",
    "generations",
    "hit_waiting",
    "clearance_least",
    "least_arrival",
)
"""Columns of `running.columns` that are metrics, and those of which no value lies below 0."""
AT_LEAST_0 = (
    "evaluations",
    "cpu_s",
    "steps",
    "travelled",
    "replans",
    "waits",
    "collision_steps",
    "replan_mean_s",
    "replan_95_s",
    "replan_max_s",
)

METRICS |= {
    "length": build_column_metric("length", feasible_only=True, least="bound"),
    "arrival": build_column_metric("arrival", feasible_only=True, least=0.0),
}
METRICS |= {name: build_column_metric(name) for name in OF_COLUMNS}
METRICS |= {name: build_column_metric(name, least=0.0) for name in AT_LEAST_0}
METRICS |= {
    "failed": build_count(
        "without a path that the certified checker accepts",
        lambda runs, _: ~runs["feasible"].astype(bool),
    ),
    "falsely_claimed": build_count(
        "free by the planner's own test, colliding by the checker's",
        partial(measures.find_disagreements, True),
    ),
    "wrongly_rejected": build_count(
        "free by the checker's test, not by the planner's own",
        partial(measures.find_disagreements, False),
    ),
    "generation_improved": build_generation(
        "last generation that improved the objective",
        partial(measures.find_first_generation, 0.0),
    ),
    "generation_1pct": build_generation(
        "first generation within 1 % of the run's final objective",
        partial(measures.find_first_generation, 0.01),
    ),
    "optimum": Metric("u", "least objective of all feasible paths of the planner's kind"),
    "optimal": build_count(
        "whether the final path is feasible and optimal, by the planner's own test"
    ),
    "infeasible": build_count("whether the final path is infeasible, by the planner's own test"),
    "gap_reference": Metric(
        "-",
        "length / length of the best known path of the same kind - 1",
        lambda runs, _: runs["length"] / measures.read_reference(runs) - 1,
        feasible_only=True,
        needs=("reference",),
    ),
    "collided": build_count(
        "whether the robot is in an obstacle at any time",
        lambda runs, _: runs["collision_at"].notna(),
    ),
}

for _percent in (1, 2, 5, 10):
    METRICS[f"within_{_percent}pct"] = build_count(
        f"whether the path is certified and at most {_percent} % longer than the exact shortest "
        "one",
        partial(measures.is_near_shortest, _percent / 100),
    )

# At the end: what is declared later is a study's own, and cannot have these names.
ALL_STUDIES.update(METRICS)
