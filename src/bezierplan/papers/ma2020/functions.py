"""ma2020: claims about paths and printed numbers that a comparison of runs cannot judge."""

from typing import TYPE_CHECKING

import pandas as pd

from bezierplan.analysis import metrics
from bezierplan.analysis.claims.material import Untestable
from bezierplan.analysis.results import pick, select
from bezierplan.papers.ma2020.metrics import obstacle_clearance

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, FunctionResult, Published
    from bezierplan.analysis.claims.kinds.function import Options as FunctionCheck


def drawn_farther(
    check: "FunctionCheck",
    results: "Experiments",
    published: "Published",
    *,
    method: str,
    other: str,
) -> "FunctionResult":
    """Judge claim C6: the path drawn of one method, its shortest, stays farther from obstacles than
    the one drawn of another, on every map.

    The effect is the least excess in clearance, the units are the paths.

    Raises Untestable if a method has no feasible run on a map.
    """
    experiment = results[check.experiment]
    excess = []
    for _, runs in experiment.runs.groupby("problem"):
        drawn = [
            pick(runs[runs["method"] == name], {"lowest": "length"}) for name in (method, other)
        ]
        if any(run is None for run in drawn):
            raise Untestable("a method has no feasible run on a map")
        own, beside = obstacle_clearance(pd.DataFrame(drawn), experiment.problems)
        excess.append(own - beside)
    return "+" if min(excess) > 0 else "-", float(min(excess)), None, 2 * len(excess)


def excess_of_corners(
    check: "FunctionCheck",
    results: "Experiments",
    published: "Published",
    *,
    beside: str,
    least: float,
) -> "FunctionResult":
    """Judge claim C27: superfluous corners cause at least a share of the excess of each method's
    mean length over that of another.

    The effect is the least share, the units are the paths.
    """
    experiment = results[check.experiment]
    runs = select(experiment.runs, check.where)
    saved = runs["length"] - metrics.compute_values(
        runs, "length_without_spares", experiment.problems
    )
    means = runs.assign(saved=saved).groupby("method")[["length", "saved"]].mean()
    others = means.drop(beside)
    share = float((others["saved"] / (others["length"] - means.loc[beside, "length"])).min())
    return "+" if share >= least else "-", share, None, len(runs)


def printed_minima(
    check: "FunctionCheck", results: "Experiments", published: "Published"
) -> "FunctionResult":
    """Judge claim C18: every shortest length in the text is the one in Table 1 or 2.

    The effect is the largest difference, the units are the lengths.
    """
    quoted, *tables = (
        published[name]
        .query("metric == 'length' and statistic == 'min'")
        .set_index(["workspace", "method"])["value"]
        for name in ("text_numbers", "table1", "table2")
    )
    apart = (quoted - pd.concat(tables).reindex(quoted.index)).abs()
    # Both are decimals as printed, so equal ones are equal to the last bit.
    return "+" if (apart == 0).all() else "-", float(apart.max()), None, len(quoted)


def read_side_of_maps(published: "Published") -> int:
    """Read how many cells both maps have along x and along y, as printed from start to target."""
    parameters = published["parameters"]
    (side,) = parameters.loc[parameters["parameter"] == "grid_size", "value"].unique()
    return int(side)
