"""The best objective of each generation: one chosen run with median and spread of all runs, or one
line per method or value of a factor.

A study's label of `generation` names the axis, such as `iteration` for a swarm.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis import naming, statistics
from bezierplan.analysis.measures import extend_histories
from bezierplan.figures import style
from bezierplan.figures.groups import (
    LIMITS,
    collect_rows,
    describe_runs,
    find_limits,
    find_published,
    show_metric,
)
from bezierplan.figures.panels import Note, Pick, Picked, RunsPanel, require_one
from bezierplan.figures.panels.paths import choose_run, describe_feasible_runs, describe_run
from bezierplan.running.columns import Row
from bezierplan.schema.model import Column, PrintedTable, Whole, build_error
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results


# Marks on the line of a group, at generations that differ from those of the other lines.
_MARKS = 5

# More bands on top of each other than this are one grey: then intervals stand at the end, unless
# they are too many as well.
_MOST_BANDS, _MOST_ENDS = 3, 5


class Options(RunsPanel):
    pick: Picked = None
    hue: Column = Field(
        None,
        description="instead of pick, a column of the runs table: a line for each of its values",
    )
    until: Whole = Field(
        None,
        description="the generation at which the axis ends; "
        "left out: the last one of the longest run",
    )
    printed: PrintedTable = Field(
        None,
        description="with hue, the name of a published table "
        "whose means are marked at the last generation",
    )

    @property
    def one(self) -> tuple[str, ...]:
        """Return the columns in which the runs have one value, if one of them is chosen."""
        return ("problem", "method") if self.pick else ()

    @model_validator(mode="after")
    def _check_source(self) -> Options:
        """Refuse both or neither of pick and hue, and keys that need hue."""
        require_one(self, "pick", "hue")
        if self.printed and self.hue is None:
            raise build_error("printed: needs hue")
        return self


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return one row per generation, and with `hue` also per value of it.

    A run that stopped early keeps its last objective. Objectives are the planner's own, in units,
    over all runs, feasible or not; bound is the exact shortest length.

    With `pick`, columns of `paths.choose_run` come first, then generation, objective (of the chosen
    run; empty if there is none), median, quartile1 and quartile3, bound. With `hue`, columns of
    `groups.collect_rows` come first, then generation, objective (the mean), low95 and high95 (its
    95 % bootstrap interval), bound (empty if problems differ in it). With `context`, a column
    reference: the length of the best known path of the methods' own kind, empty if problems differ
    in it. With `printed`, a column of that name: the mean that this published table has for a
    group, in the row of the last generation.

    Rows end at the generation `until`, unless a run is longer. Raises ValueError with `pick` unless
    all runs are of one problem and one method.
    """
    # Without `until`, as many as the longest run has.
    generations = max(results.runs["history"].map(len).max(), (options.until or -1) + 1)
    shared = find_limits(results.runs)
    if options.pick is not None:
        frame = _build_rows_of_run(results, options.pick, generations)
    else:
        frame = collect_rows(
            results, [options.hue], lambda own: _build_rows_of_group(own, options, generations)
        )
        theirs = frame.pop("printed")
        frame["bound"] = shared.get("bound", np.nan)
        if options.printed is not None and results.published is not None:
            frame["printed"] = theirs
    if options.context:
        frame["reference"] = shared.get("reference", np.nan)
    return frame


def _build_rows_of_run(results: Results, pick: Pick, generations: int) -> pd.DataFrame:
    """Return the history of a chosen run beside the quartiles of all runs."""
    import pandas as pd

    run, names = choose_run(results, pick)
    low, median, high = np.quantile(
        extend_histories(results.runs, generations), [0.25, 0.5, 0.75], axis=0
    )
    own = np.nan if run is None else extend_histories(run.to_frame().T, generations)[0]
    drawn = {
        "generation": range(generations),
        "objective": own,
        "median": median,
        "quartile1": low,
        "quartile3": high,
        "bound": results.runs["bound"].iloc[0],
    }
    return pd.DataFrame(names | drawn)


def _build_rows_of_group(group: Results, options: Options, generations: int) -> Iterable[Row]:
    """Yield each generation of a group with the interval of its mean.

    All generations use the same draws of runs, so that the ends of the interval are smooth lines.
    """
    hue = options.hue
    histories = extend_histories(group.runs, generations)
    name = f"convergence/{hue}={group.runs[hue].iloc[0]}"
    means = statistics.STATISTICS["mean"](histories.T)
    theirs = find_published(group, "objective", options.printed)
    ends = np.nan, np.nan
    for number, column in enumerate(histories.T):
        # Equal objectives have equal intervals: they are not resampled.
        if number == 0 or not np.array_equal(column, histories[:, number - 1]):
            ends = statistics.compute_interval("mean", column, generator(name))
        last = theirs and number == generations - 1
        yield {
            "generation": number,
            "objective": means[number],
            "low95": ends[0],
            "high95": ends[1],
            "printed": theirs[0] if last else np.nan,
        }


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the histories with the limits that all runs share."""
    # An axis needs two ends, also for runs that end with their first generation.
    axes.set_xlim(0, max(1, frame["generation"].max()))
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(naming.name_column("generation", scene.labels))
    axes.grid(visible=True)
    for name, look in LIMITS.items():
        if options.context and np.isfinite(frame[name].iloc[0]):
            axes.axhline(frame[name].iloc[0], zorder=3.5, **look)
    if options.hue is not None:
        return _draw_groups(axes, frame, scene, options)
    generation = frame["generation"]
    if options.context:
        band = {"color": style.LIGHT_BLUE, "linewidth": 0, "label": "quartiles of all runs"}
        axes.fill_between(generation, frame["quartile1"], frame["quartile3"], **band)
        axes.plot(generation, frame["median"], label="median of all runs", **style.OURS)
    if frame["objective"].notna().any():
        label = "run shown" if options.context else None
        axes.plot(generation, frame["objective"], label=label, **style.RUN_SHOWN)
    show_metric(axes, "objective", scene)
    return Note("", describe_run(frame, describe_feasible_runs(frame)))


def _draw_groups(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw a line for each group, with as many intervals as stay legible."""
    groups = style.list_groups(frame, options.hue, options, scene)
    for number, (_, rows, look) in enumerate(groups):
        step = max(1, len(rows) // _MARKS)
        first = number * step // len(groups)
        generation = rows["generation"]
        axes.plot(generation, rows["objective"], markevery=(first, step), **look)
        if len(groups) <= _MOST_BANDS:
            # Pale, with an edge that stays visible where bands overlap.
            band = {"facecolor": (look["color"], 0.12), "edgecolor": (look["color"], 0.5)}
            ends = rows["low95"], rows["high95"]
            axes.fill_between(generation, *ends, zorder=1.5, linewidth=0.4, **band)
        elif len(groups) <= _MOST_ENDS:
            last = rows.iloc[-1]
            # Side by side, so that all can be seen.
            at = last["generation"] * (1 - 0.015 * (len(groups) - number))
            bar = {"color": look["color"], "linewidth": 1.1, "zorder": 3.5}
            axes.vlines(at, last["low95"], last["high95"], **bar)
        if "printed" in rows:
            edge = style.PUBLISHED_MARK | {"markeredgecolor": look["color"], "clip_on": False}
            axes.plot(generation, rows["printed"], zorder=4, **edge)
            axes.plot([], [], label="published final mean", **style.PUBLISHED_MARK)
    if len(groups) <= _MOST_ENDS:
        wide = {"linewidth": 4, "alpha": 0.3}
        if len(groups) > _MOST_BANDS:
            wide = {"label": f"{style.INTERVAL['label']} at the end"}
        axes.plot([], [], **style.INTERVAL | wide)
    show_metric(axes, "objective", scene, "mean")
    return Note("", describe_runs(frame, "mean", "line"))
