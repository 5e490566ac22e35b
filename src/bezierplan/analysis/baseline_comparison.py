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


def section(rows: pd.DataFrame, titles: dict[str, str]) -> list[str]:
    """Paragraphs of the summary: a heading, what is compared, and a sentence for each study; none
    without rows.

    rows: those of all studies, with the columns `COLUMNS`. titles: of the studies, by name.
    """
    if rows.empty:
        return []
    return [
        f"## Comparison with {BASELINE}",
        "The baseline is what a practitioner would use without any of these planners. Under each "
        "condition, the median of a method's runs is divided by the median of the baseline's; "
        "`baseline_comparison.csv` has the median of these ratios.",
        *(
            f"**{titles[study]}** {sentence(own)}"
            for study, own in rows.groupby("study", sort=False)
        ),
    ]


def sentence(rows: pd.DataFrame) -> str:
    """What follows from the rows of one study."""
    count = len(rows)
    parts = [
        f"{counted(count, 'method')}: feasible in {span(100 * rows['feasible'])} % of the runs "
        f"(baseline: {number(100 * rows['feasible_baseline'].min())} %), at {span(rows['cpu'])} "
        "times the baseline's CPU time."
    ]
    if rows["length"].notna().any():
        cornered, less = np.isinf(rows["curvature"]).sum(), (rows["curvature"] < 1 - EQUAL).sum()
        parts.append(
            f"Feasible paths are {span(rows['length'])} times as long. Of "
            f"{counted(count, 'method')}, {less} {'has' if less == 1 else 'have'} a lower maximum "
            f"curvature, {cornered} {'gives' if cornered == 1 else 'give'} paths with corners."
        )
    return " ".join([*parts, _verdict(rows)])


def _verdict(own: pd.DataFrame) -> str:
    """Whether a method that is feasible as often as the baseline is shorter or curves less."""
    reliable = own[own["feasible"] >= own["feasible_baseline"]]
    better = reliable[(reliable["length"] < 1 - EQUAL) | (reliable["curvature"] < 1 - EQUAL)]
    words = (
        f"Of {counted(len(reliable), 'method')} feasible as often as the baseline, "
        f"{len(better) or 'none'} {'are' if len(better) > 1 else 'is'} shorter or less curved"
    )
    if better.empty:
        return f"{words}."
    best = better.sort_values(["curvature", "length"], kind="stable").iloc[0]
    return (
        f"{words}; the least curved, {best['method']}, has {number(best['curvature'])} times the "
        f"curvature, {number(best['length'])} times the length and {number(best['cpu'])} times the "
        "CPU time."
    )


def counted(count: int, noun: str) -> str:
    """A number of things in words."""
    return f"{count} {noun}" + ("s" if count != 1 else "")


def span(values: pd.Series, digits: int = 3) -> str:
    """The least and the largest of some numbers, once if they print alike."""
    low, high = number(values.min(), digits), number(values.max(), digits)
    return low if low == high else f"{low} to {high}"


def number(value: float, digits: int = 3) -> str:
    """Some digits, without an exponent."""
    return f"{float(f'{value:.{digits}g}'):,.10g}"
