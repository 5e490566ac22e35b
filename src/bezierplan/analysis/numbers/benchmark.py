"""Methods beside each other on the problems of an experiment, whose exact bounds are known."""

from collections.abc import Iterable, Mapping
from pathlib import Path as FilePath

import numpy as np
import pandas as pd

from bezierplan.geometry import curves, shortest_paths
from bezierplan.places import OUTCOME
from bezierplan.schema.checked import Fault, check_all, check_known
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Path, Problem

_OF_FREE = ["length", "excess", "curvature"]
_MEDIANS = [*_OF_FREE, "evaluations", "cpu_s"]

_SCORED = ["problem", "method", "runs", "feasible", "excess", "evaluations"]

STORED = OUTCOME / "methods.csv"
"""The file with the results of the papers' methods on each problem."""


def compute_summaries(runs: pd.DataFrame) -> pd.DataFrame:
    """Summarise the runs of each problem and method in a row.

    Columns: problem, method, number of runs, feasible (their share), the medians of length, excess
    (over the exact shortest path's, `shortest`) and curvature of these, and those of evaluations
    and cpu_s of all.
    """
    rows = runs.assign(excess=runs["length"] / runs["shortest"] - 1).astype({"feasible": bool})
    # The medians of these are of feasible runs alone.
    rows[_OF_FREE] = rows[_OF_FREE].where(rows["feasible"])
    groups = rows.groupby(["problem", "method"], sort=False)
    return groups.agg(
        runs=("feasible", "size"),
        feasible=("feasible", "mean"),
        **{name: (name, "median") for name in _MEDIANS},
    ).reset_index()


def rank_methods(rows: pd.DataFrame) -> pd.DataFrame:
    """Rank methods by their summaries, a row each, the best mean rank first.

    On each problem methods are ranked by the share of feasible runs, and equal ones by the excess;
    if that is equal too, they share the mean of their ranks.
    """
    # Excesses that agree to a millionth share a rank.
    rows = rows.round({"excess": 6}).sort_values(["feasible", "excess"], ascending=[False, True])
    order = rows.groupby(["feasible", "excess"], sort=False, dropna=False).ngroup()
    methods = rows.assign(rank=order.groupby(rows["problem"]).rank()).groupby("method")
    medians = dict.fromkeys(rows.columns.intersection(_MEDIANS, sort=False), "median")
    means = {"runs": "sum", "feasible": "mean"} | medians
    table = methods.agg({"problem": "nunique"} | means | {"rank": "mean"})
    return table.rename(columns={"problem": "problems"}).sort_values("rank", kind="stable")


def read_stored(experiment: str) -> pd.DataFrame:
    """Read the stored summaries of the papers' methods on an experiment, `study/name`."""
    rows = pd.read_csv(STORED).rename(columns={"free": "feasible"})
    study, _, name = experiment.partition("/")
    return rows.loc[(rows["study"] == study) & (rows["experiment"] == name), _SCORED]


def read_paths(file: FilePath, problems: Iterable[str]) -> list[tuple[str, Path | None, float]]:
    """Read problem, path and evaluations from each row of a csv file with the columns problem,
    curve and points (x y x y ...), and perhaps evaluations.

    A row without points is a run without a path. Raises Fault for a column that is missing, and for
    a problem that is not among those named.
    """
    paths = []
    try:
        # A problem may be called 15, which pandas would read as a number.
        rows = pd.read_csv(file, dtype={"problem": str, "points": str})
    except pd.errors.EmptyDataError:
        raise Fault(f"{file}: is empty; expected columns problem, curve, points") from None
    check_all(("problem", "curve", "points"), rows.columns, f"{file}: columns")
    check_all(rows["problem"], problems, f"{file}: problem")
    for number, row in enumerate(rows.to_dict("records"), 1):
        path = None
        if isinstance(row["points"], str):
            check_known(row["curve"], curves.CURVES, f"{file}: row {number}: curve")
            try:
                points = np.array(row["points"].split(), dtype=float).reshape(-1, 2)
            except ValueError:
                raise Fault(f"{file}: row {number}: points: expected x y x y ...") from None
            path = Path(row["curve"], points)
        paths.append((row["problem"], path, row.get("evaluations", np.nan)))
    return paths


def describe_problems(problems: Mapping[str, Problem]) -> pd.DataFrame:
    """List the problems, a row each: its ends, its map as JSON, and the exact shortest length."""
    rows = [
        {
            "problem": name,
            **dict(zip(("start_x", "start_y", "target_x", "target_y"), each.start + each.target)),
            "bound": shortest_paths.shortest_path(each).length,
            "map": files.write_json(each.workspace),
        }
        for name, each in problems.items()
    ]
    return pd.DataFrame(rows)
