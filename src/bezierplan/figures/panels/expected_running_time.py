"""Expected running times of methods to paths within 1, 2, 5 and 10 % of the exact shortest one
(`analysis.running_time`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis import running_time
from bezierplan.figures import glance, style
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results

_DRAWS = 1000

# Distance of the marks of one method, as a share of the distance between methods.
_APART = 0.18

# The place of what never happens, as a factor of the largest finite value.
_NEVER = 6.0

_NAMES = {"evaluations": ("expected evaluations", ""), "cpu_s": ("expected CPU time", "s")}


class Options(RunsPanel):
    cost: Literal["evaluations", "cpu_s"] = Field(
        description="what is counted: evaluations or cpu_s"
    )


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
            groups = [
                (own[cost].to_numpy(dtype=float), own["done"].to_numpy(dtype=float))
                for _, own in group.groupby("condition")
            ]
            values = np.array(
                [running_time.expected(work.sum(), done.sum()) for work, done in groups]
            )
            rng = generator(f"expected running time/{cost}/{within}/{method}")
            low, high = _interval(groups, values, rng)
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


def _middle(values: np.ndarray) -> np.ndarray:
    """The lower median along the last axis; infinite numbers are numbers."""
    return np.quantile(values, 0.5, axis=-1, method="inverted_cdf")


def _interval(
    groups: list[tuple[np.ndarray, np.ndarray]], values: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """The 95 % percentile interval of the median over problems, each given by the work and the
    success of its runs: (2,).
    """
    if max(len(work) for work, _ in groups) > 1:
        again = []
        for work, done in groups:
            times = rng.multinomial(len(work), np.full(len(work), 1 / len(work)), size=_DRAWS)
            again.append(running_time.expected(times @ work, times @ done))
        draws = _middle(np.array(again).T)
    elif len(values) > 1:
        draws = _middle(values[rng.integers(len(values), size=(_DRAWS, len(values)))])
    else:
        draws = np.full(_DRAWS, np.nan)
    return np.quantile(draws, [0.025, 0.975], method="inverted_cdf")


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows of `data`, a line of marks per method. An infinite time stands at the right
    edge.
    """
    methods = style.in_order(frame["method"], options.where)
    targets = sorted(frame["within"].unique())
    # Intervals as well, so that none leaves the panel but those without an end.
    ends = frame[["value", "low95", "high95"]].to_numpy(dtype=float)
    finite = ends[np.isfinite(ends) & (ends > 0)]
    low, high = (finite.min(), finite.max()) if len(finite) else (1.0, 10.0)
    never = _NEVER * high
    looks = style.lines([str(target) for target in targets])
    for number, (target, look) in enumerate(zip(targets, looks)):
        times = frame[frame["within"] == target].set_index("method").reindex(methods)
        heights = np.arange(len(methods)) + _APART * (number - (len(targets) - 1) / 2)
        happens = np.isfinite(times["value"].to_numpy())
        ends = times[["low95", "high95"]].clip(low / 2, never)[happens].to_numpy().T
        axes.hlines(heights[happens], *ends, color=look["color"], linewidth=0.8, zorder=2)
        mark = look | {"linestyle": "", "zorder": 3}
        label = f"within {100 * target:g} %"
        axes.plot(times["value"][happens], heights[happens], label=label, **mark)
        hollow = mark | {"markerfacecolor": style.FREE}
        axes.plot(np.full((~happens).sum(), never), heights[~happens], **hollow)
    axes.plot([], [], **style.INTERVAL)
    axes.plot([], [], **style.HOLLOW | {"label": "hollow, right of the line: never"})
    axes.axvline(never / 2, color="0.5", linewidth=0.6, linestyle=(0, (1, 2)), zorder=1)
    name, unit = _NAMES[options.cost]
    style.measure(axes.xaxis, "log", unit)
    axes.set_xlim(low / 2, never * 1.5)
    axes.set_xlabel(name)
    style.name_rows(axes, [scene.labels.get(method, method) for method in methods])
    axes.set_box_aspect(min(1.4, 0.14 + 0.12 * len(methods)))
    row, widest = frame.iloc[0], frame[frame["within"] == targets[-1]]
    return Note(
        "",
        f"median over {row['problems']:g} problems; never: at least half of them are not solved in "
        "any run"
        if row["problems"] > 1
        else f"{row['runs']:g} runs per method; never: no run gets there",
        glance.extremes(
            f"expected work to {100 * targets[-1]:g} %", widest, "method", "value", scene.labels
        ),
    )
