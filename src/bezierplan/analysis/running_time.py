"""How much work a planner needs for a good path: expected running times, and what each planner
makes of each problem.

A run solves a problem within a share if the certified checker accepts its path and the path is at
most that share longer than the exact shortest one. The expected running time (ERT) is the work of
all runs, also of those that do not get there, over the number of runs that do: what it costs on
average to start the planner again and again until a run solves the problem (Hansen, Auger,
Brockhoff, Tusar, Tusar 2016, "COCO: performance assessment", arXiv 1605.03560, Section 5; Auger and
Hansen 2005).

COCO stops a run's count when it reaches its target. Here whole runs count: `history` holds a
planner's own objective, with its penalties and by its own test, so only the path at the end of a
run has a certified length. For a planner that could stop earlier this is an upper bound.
Evaluations are paths that a planner judges: a search of a graph judges one, so planners of unlike
kinds compare by CPU time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.metric import metric

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.workspaces.problem import Problem

TARGETS = (0.01, 0.02, 0.05, 0.1)
"""Shares above the exact bound that count as solved."""

_GROUP = ("experiment", "condition", "method")


def solves(runs: pd.DataFrame, within: float) -> np.ndarray:
    """Whether (n,) a run's path is certified and at most this share longer than the exact shortest
    one.
    """
    return (
        runs["feasible"].astype(bool) & (runs["length"] <= (1 + within) * runs["bound"])
    ).to_numpy()


def work_to(
    cost: str, within: float, runs: pd.DataFrame, problems: dict[str, Problem]
) -> np.ndarray:
    """The expected running time (n,) of a run's method under its condition, the same for all of its
    runs; infinite if none gets there.
    """
    marked = runs.assign(done=solves(runs, within))
    sums = marked.groupby([column for column in _GROUP if column in runs], dropna=False)[
        [cost, "done"]
    ].transform("sum")
    return expected(sums[cost].to_numpy(), sums["done"].to_numpy())


@metric(
    "u", "exact arc length, infinite unless the certified checker accepts the path", least="bound"
)
def certified_length(runs: pd.DataFrame, problems: dict[str, Problem]) -> np.ndarray:
    """The length (n,) of a path that the certified checker accepts, infinite for any other."""
    return np.where(runs["feasible"].astype(bool), runs["length"], np.inf)


def expected(work: np.ndarray, successes: np.ndarray) -> np.ndarray:
    """Work over successes, both of the same shape; infinite without a success."""
    return np.divide(
        work, successes, out=np.full(np.shape(work), np.inf), where=np.asarray(successes) > 0
    )


def by_problem(runs: pd.DataFrame, values: np.ndarray) -> pd.DataFrame:
    """The lower median of values (n,) of the runs: one row per condition, one column per method.

    Raises ValueError if a method has no run under some condition: a comparison needs shared
    problems.
    """
    table = (
        runs.assign(value=values)
        .groupby(["condition", "method"])["value"]
        .quantile(0.5, interpolation="lower")
        .unstack("method")
    )
    if table.isna().any(axis=None):
        method = table.columns[table.isna().any()][0]
        raise ValueError(
            f"{method} has no run under {table.index[table[method].isna()][0]}; compared methods "
            "need the same problems"
        )
    return table


def ratios(table: pd.DataFrame) -> pd.DataFrame:
    """Each value over the best of its row (Dolan and More 2002, performance ratio); infinite where
    a method or all of them fail.
    """
    best = table.min(axis=1).to_numpy()[:, None]
    values = table.to_numpy(dtype=float)
    # Of equal values, 0 / 0 included, each is the best.
    quotients = np.divide(
        values,
        best,
        out=np.where(values <= best, 1.0, np.inf),
        where=np.isfinite(best) & (best > 0),
    )
    return table.where(~np.isfinite(values), quotients).where(np.isfinite(values), np.inf)
