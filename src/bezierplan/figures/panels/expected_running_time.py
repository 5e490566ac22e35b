"""Expected running times of methods to paths within 1, 2, 5 and 10 % of the exact shortest one
(`analysis.running_time`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis import running_time
from bezierplan.figures import seen, style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from collections.abc import Iterable

    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

_DRAWS = 1000

# Distance of the marks of one method, as a share of the distance between methods.
_APART = 0.18

# Distance of the place for what never happens from the largest finite value and from the last
# label, as shares of the axis.
_NEVER, _CLEAR = 0.12, 0.2

# The least ratio of the place for what never happens to the largest finite value.
_LEAST_APART = 4.0

_NAMES = {"evaluations": "expected evaluations", "cpu_s": "expected CPU time (s)"}


class Options(RunsPanel):
    named_rows: ClassVar[bool] = True

    cost: Literal["evaluations", "cpu_s"] = Field(
        description="what is counted: evaluations or cpu_s"
    )

    @property
    def measured(self) -> str | None:
        """The metric whose numbers are drawn."""
        return self.cost

    @property
    def timed(self) -> bool:
        """Whether these are seconds."""
        return self.cost == "cpu_s"


def data(results: Results, options: Options) -> pd.DataFrame:
    """One row per method and target; columns: method, within, value, low95, high95, problems,
    reached, runs, successes.

    value: the expected running time, on several problems (conditions) the lower median over them;
    infinite where at least half of them are never solved. low95, high95: its 95 % bootstrap
    interval, from runs drawn within each problem or, where each has one run of a method, from
    problems. reached: problems with a success; runs, successes: counts over all problems.

    Raises ValueError if a method lacks runs on a problem.
    """
    import pandas as pd

    cost = options.cost
    runs, rows = results.runs.sort_values("id"), []
    for within in running_time.TARGETS:
        marked = runs.assign(done=running_time.solves(runs, within))
        running_time.by_problem(marked, marked["done"].to_numpy(dtype=float))
        for method, group in marked.groupby("method"):
            groups = _by_condition(group, cost)
            values = np.array(
                [running_time.expected(work.sum(), done.sum()) for work, done in groups]
            )
            low, high = _interval(
                groups, values, generator(f"expected running time/{cost}/{within}/{method}")
            )
            rows.append(
                {
                    "method": method,
                    "within": within,
                    "value": _middle(values),
                    "low95": low,
                    "high95": high,
                    "problems": len(groups),
                    "reached": int(np.isfinite(values).sum()),
                    "runs": len(group),
                    "successes": int(group["done"].sum()),
                }
            )
    return pd.DataFrame(rows)


def _by_condition(runs: pd.DataFrame, cost: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """The cost (n,) and the success (n,) of the n runs under each condition, in the order of the
    conditions' names.
    """
    import pandas as pd

    codes, _ = pd.factorize(runs["condition"], sort=True)
    order, ends = np.argsort(codes, kind="stable"), np.cumsum(np.bincount(codes))[:-1]
    work, done = runs[cost].to_numpy(dtype=float)[order], runs["done"].to_numpy()[order]
    return list(zip(np.split(work, ends), np.split(done, ends)))


def _middle(values: np.ndarray) -> np.ndarray:
    """The lower median along the last axis; infinite numbers are numbers."""
    return np.quantile(values, 0.5, axis=-1, method="inverted_cdf")


def _interval(
    groups: list[tuple[np.ndarray, np.ndarray]], values: np.ndarray, rng: np.random.Generator
) -> tuple[float, float]:
    """The 95 % percentile interval of the median over problems, each given by the work and the
    success of its runs.
    """
    if max(len(work) for work, _ in groups) == 1:
        drawn = (
            _middle(values[rng.integers(len(values), size=(_DRAWS, len(values)))])
            if len(values) > 1
            else np.full(_DRAWS, np.nan)
        )
    else:
        again = []
        for work, done in groups:
            times = rng.multinomial(len(work), np.full(len(work), 1 / len(work)), size=_DRAWS)
            again.append(running_time.expected(times @ work, times @ done.astype(float)))
        drawn = _middle(np.array(again).T)
    low, high = np.quantile(drawn, [0.025, 0.975], method="inverted_cdf")
    return float(low), float(high)


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, a line of marks per method. An infinite time stands at the right
    edge.
    """
    from matplotlib.ticker import FixedLocator, FuncFormatter

    methods, targets = (
        style.in_order(frame["method"], options.where),
        sorted(frame["within"].unique()),
    )
    # Intervals as well, so that none leaves the panel but those without an end.
    shown = frame[["value", "low95", "high95"]].to_numpy(dtype=float)
    finite = shown[np.isfinite(shown) & (shown > 0)]
    low, high = (finite.min(), finite.max()) if len(finite) else (1.0, 10.0)
    never = high * max((high / low) ** _NEVER, _LEAST_APART)
    axes.set_xscale("log")
    axes.set_xlim(low / 2, never * 1.5)
    axes.set_xlabel(_NAMES[options.cost])
    for number, (target, look) in enumerate(
        zip(targets, style.lines([str(target) for target in targets]))
    ):
        times = frame[frame["within"] == target].set_index("method").reindex(methods)
        heights = np.arange(len(methods)) + _APART * (number - (len(targets) - 1) / 2)
        known = np.isfinite(times["value"].to_numpy())
        ends = [times[name].clip(low / 2, never)[known] for name in ("low95", "high95")]
        axes.hlines(heights[known], *ends, color=look["color"], linewidth=0.8, zorder=2)
        axes.plot([], [], **style.INTERVAL)
        mark = look | {"linestyle": "", "zorder": 3}
        axes.plot(times["value"][known], heights[known], label=f"within {100 * target:g} %", **mark)
        hollow = mark | {"markerfacecolor": style.FREE}
        axes.plot(np.full((~known).sum(), never), heights[~known], **hollow)
    axes.axvline(never / 1.8, color="0.5", linewidth=0.6, linestyle=(0, (1, 2)), zorder=1)
    # So far from the last place that their labels do not touch.
    last = never / (3 * never / low) ** _CLEAR
    steps = (1.0,) if high > 100 * low else (1.0, 3.0)
    decades = 10.0 ** np.arange(np.floor(np.log10(low / 2)), np.ceil(np.log10(high)) + 1)
    places = np.sort(np.outer(decades, steps).ravel())
    ticks = _thinned(places[(places >= low / 2) & (places <= last)], never / low)
    thousand = 1000 if options.cost == "cpu_s" and scene.milliseconds else 1
    if thousand > 1:
        axes.set_xlabel(f"{_NAMES['cpu_s'].removesuffix('(s)')}(ms)")
    axes.xaxis.set_major_locator(FixedLocator([*ticks, never]))
    axes.xaxis.set_minor_locator(FixedLocator([]))
    axes.xaxis.set_major_formatter(
        FuncFormatter(lambda value, _: "never" if value == never else _power(thousand * value))
    )
    style.separate_rows(axes, len(methods))
    names = [scene.labels.get(method, method) for method in methods]
    style.name_rows(axes, names)
    axes.set_box_aspect(min(1.4, 0.14 + 0.12 * len(methods)))
    problems, fewest, most = frame["problems"].iloc[0], frame["runs"].min(), frame["runs"].max()
    told = (
        f"median over {problems:g} problems; never: at least half of them are not solved in any run"
        if problems > 1
        else f"{fewest:g}{'' if fewest == most else f' to {most:g}'} runs per method; "
        "never: no run gets there"
    )
    return Note("", told, _seen(frame, methods, names))


def _seen(frame: pd.DataFrame, methods: list[str], names: list[str]) -> str:
    """Which method gets to the widest target first, and which never do."""
    target = frame["within"].max()
    times = frame[frame["within"] == target].set_index("method")["value"].reindex(methods)
    never = [name for name, time in zip(names, times) if not np.isfinite(time)]
    clauses = [
        seen.extremes(f"expected work to {100 * target:g} %", dict(zip(names, times))),
        f"never: {', '.join(never)}" if never else "",
    ]
    return "; ".join(filter(None, clauses))


def _thinned(ticks: Iterable[float], span: float) -> list[float]:
    """Those of increasing ticks whose labels do not touch on an axis that spans a factor."""
    kept: list[float] = []
    for tick in ticks:
        if not kept or tick >= kept[-1] * span**_CLEAR:
            kept.append(tick)
    return kept


def _power(value: float) -> str:
    """A power of ten as a plain number as long as that is short."""
    return f"{value:,.10g}" if 1e-3 <= value < 1e6 else f"$10^{{{round(np.log10(value))}}}$"
