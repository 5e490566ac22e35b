"""Comparison of each method with the baseline that anyone could use, the exact shortest path with
rounded corners.

A method is measured under the conditions of some experiments, a condition being a problem with the
values of the varied settings. Under each, the median of its runs is divided by the median of the
baseline's runs; the table has the median of these ratios over the conditions. Columns:

- study, method, baseline: what is measured, and against what
- proposed: whether it is the method that the paper proposes
- conditions: conditions under which both have runs
- feasible, feasible_baseline: share of their runs whose path the certified checker accepts
- compared: conditions under which both have a feasible run
- length: length over the baseline's, feasible runs only
- bent: those of the compared conditions under which the baseline's path bends and has no corners
- curvature: largest curvature over the baseline's under these conditions, feasible runs only;
  infinite for paths with corners
- cpu: CPU time over the baseline's, all runs
- gap, gap_low, gap_high: length over that of the exact shortest path, less 1, feasible runs only,
  and its 95 % bootstrap interval
- evaluations: paths that a run evaluates
"""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics, statistics
from bezierplan.analysis.results import Results
from bezierplan.workspaces.seeds import generator

COLUMNS = (
    "study",
    "method",
    "baseline",
    "proposed",
    "conditions",
    "feasible",
    "feasible_baseline",
    "compared",
    "length",
    "bent",
    "curvature",
    "cpu",
    "gap",
    "gap_low",
    "gap_high",
    "evaluations",
)

# A path whose largest curvature times its length is below this, in radians, is straight.
_STRAIGHT = 1e-6

# In sentences, ratios closer to 1 than this are equal to it.
EQUAL = 1e-3

RATIOS = ("length", "curvature", "cpu")
"""Columns that are ratios to the baseline's."""

BASELINE = "the exact shortest path with rounded corners"
"""What the baseline is, in words."""


def measured(
    experiments: dict[str, Results], baseline: str, with_baseline: bool = False
) -> pd.DataFrame:
    """One row for each method of some experiments, in all of which the baseline runs; `COLUMNS` but
    for the study.

    with_baseline: whether the baseline has a row too.
    """
    values = pd.concat(
        [_values(results).assign(experiment=name) for name, results in experiments.items()]
    )
    groups = values.groupby(["experiment", "condition", "method"], sort=False)
    runs = groups["free"].agg(free="sum", runs="count")
    medians = groups[[*RATIOS, "evaluations"]].median().join(runs).reset_index()
    of_baseline = medians["method"] == baseline
    pairs = medians[~of_baseline | with_baseline].merge(
        medians[of_baseline], on=["experiment", "condition"], suffixes=("", "_baseline")
    )
    bent = np.isfinite(pairs["curvature_baseline"]) & (
        pairs["curvature_baseline"] * pairs["length_baseline"] > _STRAIGHT
    )
    pairs["curvature_baseline"] = pairs["curvature_baseline"].where(bent)
    for name in RATIOS:
        pairs[name] /= pairs[f"{name}_baseline"]
    methods = pairs.groupby("method", sort=False)
    sums, counts = methods.sum(numeric_only=True), methods.count()
    rows = (
        methods[[*RATIOS, "evaluations"]]
        .median()
        .assign(
            baseline=baseline,
            conditions=methods.size(),
            feasible=sums["free"] / sums["runs"],
            feasible_baseline=sums["free_baseline"] / sums["runs_baseline"],
            compared=counts["length"],
            bent=counts["curvature"],
        )
    )
    gaps = {name: _gaps(values[values["method"] == name], name) for name in rows.index}
    rows = rows.join(pd.DataFrame.from_dict(gaps, orient="index"))
    return rows.reset_index(names="method").reindex(columns=COLUMNS[1:])


def _gaps(values: pd.DataFrame, method: str) -> dict[str, float]:
    """The columns about gaps of a method, from its rows of values."""
    free = np.sort(values["gap"].dropna())
    low, high = statistics.interval("median", free, generator(f"gap/{method}"))
    return {
        "gap": np.median(free) if len(free) else math.nan,
        "gap_low": low,
        "gap_high": high,
    }


def of_studies(
    baselines: Mapping[str, tuple[str, str | None]],
    results: Mapping[str, Results],
    with_baseline: bool = False,
) -> pd.DataFrame:
    """One row for each method of all studies; `COLUMNS`.

    baselines: by study, each with the method that the paper proposes. results: by
    `study/experiment`.
    """
    tables = []
    for study, (baseline, proposed) in baselines.items():
        experiments = {
            place.partition("/")[2]: own
            for place, own in results.items()
            if place.startswith(f"{study}/")
        }
        rows = measured(experiments, baseline, with_baseline)
        tables.append(rows.assign(study=study, proposed=rows["method"] == proposed))
    rows = pd.concat(tables) if tables else pd.DataFrame()
    return rows.reindex(columns=COLUMNS)


def _values(results: Results) -> pd.DataFrame:
    """One row for each run, with all that is compared of it."""
    runs, problems = results.runs, results.problems
    cornered = metrics.values(runs, "corners", problems) > 0
    return runs[["condition", "method"]].assign(
        length=metrics.values(runs, "length", problems),
        curvature=metrics.values(runs, "max_curvature", problems).mask(cornered, np.inf),
        evaluations=runs["evaluations"],
        cpu=runs["cpu_s"],
        free=runs["feasible"].astype(bool),
        gap=metrics.values(runs, "gap", problems),
    )


def counted(count: int, noun: str) -> str:
    """A number of things in words."""
    return f"{count} {noun}" + ("s" if count != 1 else "")


def number(value: float, digits: int = 3) -> str:
    """Some digits, without an exponent."""
    return f"{float(f'{value:.{digits}g}'):,.10g}"
