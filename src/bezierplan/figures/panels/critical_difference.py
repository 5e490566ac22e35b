"""Mean ranks of methods on one axis; bars join those that Friedman's and Nemenyi's tests cannot distinguish (Demsar 2006)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis import metrics, running_time
from bezierplan.figures import style
from bezierplan.figures.panels import RunsPanel
from bezierplan.schema.model import Metric, PrintedTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


_LEVEL = 0.05

# Heights in the drawing, in lines of text: of a bar over indistinguishable ranks, and of the items above the axis.
_BAR, _ABOVE = 0.45, 3.2
# Room for names on either side, as a share of the axis.
_NAMES = 1.2


class Options(RunsPanel):
    """Keys of a panel."""

    fewest_methods: ClassVar[int] = 3

    metric: Metric = Field("objective", description="what is ranked, the name of a metric; left out: objective")
    printed: PrintedTable = Field(None, description="the name of a published table whose mean ranks are shown besides")
    unit: Literal["repeat", "problem"] = Field(
        "repeat", description="in what methods are ranked: each repeat of a condition (left out: this), or each problem, by the median run"
    )

    @property
    def published_drawn(self) -> bool:
        """Whether published mean ranks are shown."""
        return self.printed is not None


@Options.filled
def data(results: Results, *, metric: str, printed: str | None, unit: Literal["repeat", "problem"]) -> pd.DataFrame:
    """One row per rank; columns: method, part, value, until, methods and units (counts), chi2, p_value, difference.

    Parts: rank (the mean rank of a method, 1 for the lowest values; ties share the mean of their ranks), published (that of the
    paper), alike (from one rank to another, between which no two differ by more than the critical difference). In a unit every method
    is ranked: a repeat of a condition or, with `problem`, a condition, by the lower median of its repeats. chi2 and p_value: Friedman's
    test; difference: Nemenyi's critical difference at 5 %.

    metric: what is ranked. printed: the published table whose mean ranks are also shown. Raises ValueError for fewer than three
    methods, and if a unit lacks one.
    """
    import pandas as pd
    from scipy import stats

    runs = results.runs.assign(value=metrics.values(results.runs, metric, results.problems))
    if unit == "problem":
        table = running_time.by_problem(runs, runs["value"].to_numpy())
    else:
        table = runs.pivot_table(index=["condition", "repeat"], columns="method", values="value", dropna=False)
    units, methods = table.shape
    if methods < 3 or table.isna().any(axis=None):
        raise ValueError(f"mean ranks need at least three methods with a {metric} in every repeat; found {methods} in {units}")
    ranks = pd.Series(stats.rankdata(table.to_numpy(), axis=1).mean(axis=0), index=table.columns).sort_values(kind="stable")
    difference = stats.studentized_range.ppf(1 - _LEVEL, methods, np.inf) * math.sqrt(methods * (methods + 1) / (12 * units))
    chi2, p_value = stats.friedmanchisquare(*table.to_numpy().T)
    rows = [{"method": method, "part": "rank", "value": rank} for method, rank in ranks.items()]
    rows += [{"part": "alike", "value": low, "until": high} for low, high in _alike(ranks.to_numpy(), difference)]
    if printed is not None and results.published is not None:
        theirs = results.published.query("table == @printed and metric == 'rank' and method in @ranks.index")
        rows += [{"method": row.method, "part": "published", "value": row.value} for row in theirs.itertuples()]
    tested = {"methods": methods, "units": units, "chi2": chi2, "p_value": p_value, "difference": difference}
    return pd.DataFrame(rows).reindex(columns=["method", "part", "value", "until"]).assign(**tested)


def _alike(ranks: np.ndarray, difference: float) -> list[tuple[float, float]]:
    """The longest ranges of sorted ranks (n,) no wider than a difference, with at least two ranks."""
    found = []
    for first, low in enumerate(ranks):
        last = int(np.searchsorted(ranks, low + difference, side="right")) - 1
        if last > first and (not found or ranks[last] > found[-1][1]):
            found.append((float(low), float(ranks[last])))
    return found


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, panel: dict) -> str:
    """Draw the rows of `data`, the best names on the left; returns the note below the panel's title."""
    tested = frame.iloc[0]
    count = int(tested["methods"])
    axes.set_axis_off()
    side = _NAMES * (count - 1)
    axes.set_xlim(1 - side, count + side)
    _draw_scale(axes, count, tested["difference"])
    bars = frame[frame["part"] == "alike"]
    for number, (low, high) in enumerate(zip(bars["value"], bars["until"]), start=1):
        axes.plot([low - 0.04, high + 0.04], [-_BAR * number] * 2, color=style.BLACK, linewidth=2.4, solid_capstyle="butt")
    top = -_BAR * (len(bars) + 1) - 0.5
    ranks, printed = frame[frame["part"] == "rank"], frame[frame["part"] == "published"].set_index("method")["value"]
    half = (count + 1) // 2
    for number, (method, rank) in enumerate(zip(ranks["method"], ranks["value"])):
        left = number < half
        height = top - (number if left else count - 1 - number)
        edge = 1 - 0.1 * (count - 1) if left else count + 0.1 * (count - 1)
        axes.plot([rank, rank, edge], [0, height, height], color=style.BLUE, linewidth=0.8)
        name = f"{scene.labels.get(method, method)} {rank:.2f}" + (f" ({printed[method]:g})" if method in printed else "")
        axes.text(edge, height, f"{name} " if left else f" {name}", ha="right" if left else "left", va="center")
    axes.set_ylim(top - half, _ABOVE)
    axes.set_box_aspect(min(1.2, 0.055 * (_ABOVE - top + half)))
    chance = f"p = {tested['p_value']:.2g}" if tested["p_value"] >= 1e-4 else "p below 0.0001"
    units = "problems" if panel.get("unit") == "problem" else "repeats"
    words = f"{tested['units']:g} {units}; Friedman chi2 {tested['chi2']:.1f}, {chance}"
    return words if printed.empty else f"{words}\nin parentheses: the published mean rank"


def _draw_scale(axes: Axes, count: int, difference: float) -> None:
    """The axis from 1 to `count`, with the critical difference as a length above it."""
    thin = {"color": style.BLACK, "linewidth": 0.8}
    axes.plot([1, count], [0, 0], **thin)
    for rank in range(1, count + 1):
        axes.plot([rank, rank], [0, 0.25], **thin)
        axes.text(rank, 0.35, str(rank), ha="center", va="bottom")
    axes.text((1 + count) / 2, 1.25, "mean rank", ha="center", va="bottom")
    axes.plot([1, 1 + difference], [2.35, 2.35], marker="|", markersize=4, **thin)
    axes.text(1 + difference, 2.35, f" critical difference {difference:.2f}", ha="left", va="center")
