"""Anytime curves: how good the best path is that a planner has after some CPU time.

A table of attempts has one row for each path that a planner gave: method, seed, cpu_s (CPU seconds
from the start of the run until it had the path), and excess (length over that of the exact shortest
path, less 1; infinite for a path that the certified checker rejects).
"""

import numpy as np
import pandas as pd

QUARTILES = (0.25, 0.5, 0.75)


def best_at(times: np.ndarray, cpu_s: np.ndarray, excess: np.ndarray) -> np.ndarray:
    """The least excess (t,) of a run's attempts by each of the times (t,); infinite before the
    first.

    times, and cpu_s (n,) of the attempts, in seconds; excess: (n,).
    """
    order = np.argsort(cpu_s, kind="stable")
    best = np.concatenate([[np.inf], np.minimum.accumulate(excess[order])])
    return best[np.searchsorted(cpu_s[order], times, side="right")]


def quartiles(attempts: pd.DataFrame, times: np.ndarray) -> np.ndarray:
    """Quartiles (3, t) over seeds of the excess of one method's best paths at times (t,), in
    seconds.

    They are values of single runs: a quartile is infinite while too few of them have a path.
    """
    curves = [
        best_at(times, own["cpu_s"].to_numpy(), own["excess"].to_numpy())
        for _, own in attempts.groupby("seed")
    ]
    return np.quantile(curves, QUARTILES, axis=0, method="inverted_cdf")


def times_until(attempts: pd.DataFrame, share: float) -> np.ndarray:
    """CPU seconds (seeds,) until each run of one method has a path within a share of the exact
    length; infinite if it never has.
    """
    there = attempts["cpu_s"].where(attempts["excess"] <= share, np.inf)
    return there.groupby(attempts["seed"]).min().to_numpy()


def time_table(attempts: pd.DataFrame, shares: tuple[float, ...]) -> pd.DataFrame:
    """One row for each problem, method and share: the median over seeds of the CPU seconds until a
    path is within the share of the exact length (infinite if fewer than half of the runs get
    there), and the share of seeds that get there.
    """
    rows = []
    for (problem, method), own in attempts.groupby(["problem", "method"], sort=False):
        for share in shares:
            until = times_until(own, share)
            median = np.quantile(until, 0.5, method="inverted_cdf")
            rows.append(
                {
                    "problem": problem,
                    "method": method,
                    "within": share,
                    "median_s": median,
                    "reached": np.isfinite(until).mean(),
                }
            )
    return pd.DataFrame(rows)
