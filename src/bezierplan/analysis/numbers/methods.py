"""Results of each method on each problem, and their summary by families of problems."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics, naming, statistics
from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.results import Results
from bezierplan.geometry.tightest_turn import largest_curvature
from bezierplan.planners import rounded_shortest_path
from bezierplan.running.answer import restore_path
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

BASELINE = "the exact shortest path with rounded corners"
"""The planner that every method but itself is compared with, in words."""

_PLANNER = "rounded_shortest_path"

# The turns of at most so many paths are measured: more would take longer than to find the paths,
# and move no median.
_MEASURED = 100

# What is read of runs: slices of frames of all columns take most of the time.
_COLUMNS = ["problem", "method", "bound", "free", "gap", "corners", "cpu_s", "evaluations"]
_COLUMNS += ["planner", "path_curve", "path_points"]

# A shortest path that is longer than the straight line by less, as a share, is that line.
_STRAIGHT = 1e-9

# Excesses that differ by less are equal, and so are curvatures that differ by a smaller factor: the
# radii of the rounded path are 2 % apart.
_EQUAL, _TIGHTER = 1e-6, 1.03


def _measure_methods(
    experiment: str, results: Results, families: Mapping[str, Any]
) -> Iterator[dict[str, Any]]:
    """Yield the row of each method on each problem of an experiment: the columns of `methods.csv`
    but for study and proposed.
    """
    problems = results.problems
    runs = results.runs.assign(
        free=results.runs["feasible"].astype(bool),
        gap=metrics.compute_values(results.runs, "gap", problems),
        corners=metrics.compute_values(results.runs, "corners", problems),
    )[_COLUMNS]
    for name, of_problem in runs.groupby("problem", sort=False):
        problem, bound = problems[name], of_problem["bound"].iloc[0]
        straight = bound <= math.dist(problem.start, problem.target) * (1 + _STRAIGHT)
        own = (key for key, each in families.items() if each.has(experiment, name, straight))
        family = next(own, "")
        for method, of_method in of_problem.groupby("method", sort=False):
            free = of_method[of_method["free"]]
            smooth = free[free["corners"] == 0]
            excess = free["gap"].to_numpy()
            draws = generator(f"methods/{experiment}/{name}/{method}")
            low, high = statistics.compute_interval("median", excess, draws)
            yield {
                "experiment": experiment,
                "family": family,
                "problem": name,
                "method": method,
                "straight": straight,
                "runs": len(of_method),
                "free": len(free) / len(of_method),
                "excess": np.median(excess) if len(excess) else math.nan,
                "excess_low": low,
                "excess_high": high,
                "round": len(smooth),
                "cornered": len(free) - len(smooth),
                **(
                    _measure_turns(smooth, problem, bound)
                    if family and of_method["planner"].iloc[0] != _PLANNER
                    else {}
                ),
                "cpu_ms": 1000 * of_method["cpu_s"].median(),
                "evaluations": of_method["evaluations"].median(),
            }


def _measure_turns(smooth: pd.DataFrame, problem: Problem, bound: float) -> dict[str, float]:
    """Measure how tightly paths without corners turn, and what a rounded shortest path that may
    turn so gives; nothing if there are no such paths.
    """
    if smooth.empty:
        return {}
    paths = map(restore_path, smooth["path_curve"], smooth["path_points"].head(_MEASURED))
    curvature = float(np.median([largest_curvature(path) for path in paths]))
    radius = 1 / curvature if curvature > 0 else math.inf
    draws = generator("methods/rounded")  # unused: the path is exact
    # The path may be of any length: with a limit, the planner would take a smaller radius.
    plan = rounded_shortest_path.plan(problem, draws, turning_radius=radius, excess=math.inf)
    return {
        "curvature": curvature,
        "rounded": plan.objective / bound - 1,
        "rounded_curvature": largest_curvature(plan.path),
    }


def measure_studies(
    proposed: Mapping[str, str | None],
    families: Mapping[str, Mapping[str, Any]],
    experiments: Mapping[str, Results],
) -> pd.DataFrame:
    """Measure the methods of all experiments, each `study/experiment`; return the rows of
    `methods.csv`.

    proposed, families: by study, as it declares them (`study.experiments.FamilyEntry`).
    """
    tables = []
    for place, results in experiments.items():
        study, _, name = place.partition("/")
        rows = pd.DataFrame(_measure_methods(name, results, families[study]))
        tables.append(rows.assign(study=study, proposed=rows["method"] == proposed[study]))
    rows = pd.concat(tables) if tables else pd.DataFrame()
    return rows.reindex(columns=COLUMNS_OF["methods"])


def group_by_family(rows: pd.DataFrame) -> pd.DataFrame:
    """Group the rows of `methods.csv` by study, family and method, the least often free first, and
    of equal ones the longest.

    Columns: problems, runs; free, and worst, the share of the worst problem; over the problems the
    medians of excess, rounded and cpu_ms; round and cornered, free runs; both, the problems with a
    path without corners, and adds, those of them in which the method is shorter than the rounded
    path, or turns less tightly than that can.
    """
    known = rows[rows["family"].notna() & rows["family"].ne("")]
    both = known["rounded"].notna()
    shorter = known["excess"] < known["rounded"] - _EQUAL
    smoother = known["curvature"] * _TIGHTER < known["rounded_curvature"]
    # Shares are weighted by runs, of which problems may have different numbers.
    known = known.assign(
        frees=known["free"] * known["runs"], both=both, adds=both & (shorter | smoother)
    )
    groups = known.groupby(["study", "family", "method", "proposed"], sort=False)
    sums = groups[["runs", "frees", "round", "cornered", "both", "adds"]].sum()
    table = groups[["excess", "rounded", "cpu_ms"]].median().join(sums)
    table = table.assign(
        problems=groups.size(), worst=groups["free"].min(), free=table["frees"] / table["runs"]
    )
    worst_first = table.sort_values(["free", "excess"], ascending=[True, False])
    return worst_first.drop(columns="frees").reset_index()


def format_table(rows: pd.DataFrame, labels: naming.Labels) -> pd.DataFrame:
    """Format the rows of `group_by_family` as words; the index is the method.

    labels: name -> how it is printed; a name of several studies stands after `study/`.
    """
    names = rows["study"] + "/" + rows["method"]
    index = [labels.get(both, labels.get(own, own)) for both, own in zip(names, rows["method"])]
    return pd.DataFrame(
        {
            "scenarios": rows["family"].to_list(),
            "free paths": [
                # The worst problem's where it is another one in print.
                ", worst ".join(dict.fromkeys(map(_format_share, (row.free, row.worst))))
                for row in rows.itertuples()
            ],
            "free paths with corners": [
                f"{row.cornered:.0f} of {row.round + row.cornered:.0f}" for row in rows.itertuples()
            ],
            "excess": [*map(_format_share, rows["excess"])],
            "excess of a rounded path as smooth": [*map(_format_share, rows["rounded"])],
            "problems where the method beats that path": [
                f"{row.adds:.0f} of {row.both:.0f}" if row.both else "–"
                for row in rows.itertuples()
            ],
            "time": [*map("{:.3g} ms".format, rows["cpu_ms"])],
        },
        index=pd.Index(index, name="method"),
    )


def _format_share(value: float) -> str:
    """Format a share in per cent; a dash if there is none."""
    return "–" if math.isnan(value) else f"{naming.format_number(round(100 * value, 2))} %"
