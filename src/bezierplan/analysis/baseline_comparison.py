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
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics
from bezierplan.analysis.results import Results, read
from bezierplan.running.inputs import Files

COLUMNS = (
    *("study", "method", "baseline", "proposed", "conditions", "feasible", "feasible_baseline"),
    *("compared", "length", "bent", "curvature", "cpu"),
)

# A path whose largest curvature times its length is below this, in radians, is straight.
_STRAIGHT = 1e-6

# In sentences, ratios closer to 1 than this are equal to it.
EQUAL = 1e-3

BASELINE = "the exact shortest path with rounded corners"
"""What the baseline is, in words."""


def measured(experiments: dict[str, Results], baseline: str) -> pd.DataFrame:
    """One row for each method of some experiments, in all of which the baseline runs; `COLUMNS` but
    for the study.
    """
    medians = pd.concat(
        [_medians(results).assign(experiment=name) for name, results in experiments.items()],
        ignore_index=True,
    )
    of_baseline = medians["method"] == baseline
    pairs = medians[~of_baseline].merge(
        medians[of_baseline], on=["experiment", "condition"], suffixes=("", "_baseline")
    )
    bent = np.isfinite(pairs["curvature_baseline"]) & (
        pairs["curvature_baseline"] * pairs["length_baseline"] > _STRAIGHT
    )
    pairs["curvature_baseline"] = pairs["curvature_baseline"].where(bent)
    for name in ("length", "curvature", "cpu"):
        pairs[name] /= pairs[f"{name}_baseline"]
    methods = pairs.groupby("method", sort=False)
    sums, counts = methods.sum(numeric_only=True), methods.count()
    rows = (
        methods[["length", "curvature", "cpu"]]
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
    return rows.reset_index().reindex(columns=COLUMNS[1:])


def of_studies(
    baselines: Mapping[str, tuple[str, str | None]],
    repeats: Mapping[str, int],
    files: Mapping[str, Files],
) -> pd.DataFrame:
    """One row for each method of all studies; `COLUMNS`.

    baselines: by study, each with the method that the paper proposes. repeats, files: of
    experiments, each by `study/experiment`.
    """
    tables = []
    for study, (baseline, proposed) in baselines.items():
        experiments = {
            place.partition("/")[2]: read(files[place], number, place.partition("/")[2])
            for place, number in repeats.items()
            if place.startswith(f"{study}/")
        }
        rows = measured(experiments, baseline)
        tables.append(rows.assign(study=study, proposed=rows["method"] == proposed))
    rows = pd.concat(tables) if tables else pd.DataFrame()
    return rows.reindex(columns=COLUMNS)


def _medians(results: Results) -> pd.DataFrame:
    """One row for each condition and method: medians of length, curvature and CPU time, and the
    numbers of runs and of feasible ones.
    """
    runs, problems = results.runs, results.problems
    cornered = metrics.values(runs, "corners", problems) > 0
    values = runs[["condition", "method"]].assign(
        length=metrics.values(runs, "length", problems),
        curvature=metrics.values(runs, "max_curvature", problems).mask(cornered, np.inf),
        cpu=runs["cpu_s"],
        free=runs["feasible"].astype(bool),
    )
    groups = values.groupby(["condition", "method"], sort=False)
    return (
        groups[["length", "curvature", "cpu"]]
        .median()
        .join(groups["free"].agg(free="sum", runs="count"))
        .reset_index()
    )


def counted(count: int, noun: str) -> str:
    """A number of things in words."""
    return f"{count} {noun}" + ("s" if count != 1 else "")


def number(value: float, digits: int = 3) -> str:
    """Some digits, without an exponent."""
    return f"{float(f'{value:.{digits}g}'):,.10g}"
