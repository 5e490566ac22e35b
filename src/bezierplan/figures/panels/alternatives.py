"""A specification curve: the effect behind a claim with its interval, by default and under every
single alternative to details that the paper leaves open.
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from bezierplan.analysis import naming
from bezierplan.analysis.claims.claim import ClaimId
from bezierplan.figures import style
from bezierplan.figures.panels import Note, Panel, Sources
from bezierplan.schema.model import build_name_type

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

FEW = 40
"""Runs of each method under each condition, at most."""

# Height of a row and of the gap between two assumptions, and width of the axes, in inches.
_ROW, _GAP, _WIDTH = 0.125, 0.06, 2.7

# Most letters in a line of text beside the axes.
_LETTERS = 50

_LOOKS = {
    "+": style.build_mark_style("o", 3.5, style.BLUE, label="the claim holds"),
    "?": style.build_mark_style(
        "o", 3.5, style.BLACK, markerfacecolor=style.FREE, label="not decided"
    ),
    "0": style.build_mark_style(
        "s", 3.2, style.BLACK, markerfacecolor=style.FREE, label="too small to matter"
    ),
    "-": style.build_mark_style("X", 4.2, style.RED, label="the opposite holds"),
}

# Shares that words stand for; `some` needs any share above 0.
# `as printed` needs no share by itself: a line at nan is not drawn.
_SHARES = {"all": 1.0, "some": 0.0, "none": 0.0, "as printed": "nan"}


class Options(Panel):
    """Keys of a panel that shows a claim under all alternatives."""

    claim: build_name_type("claim", ClaimId) = Field(
        description="the id of a claim: its decisive comparison is drawn, by default and under "
        "each alternative of `assumptions.yaml` that no sentence excludes, of few runs"
    )

    def source(self, sources: Sources) -> pd.DataFrame:
        """Return the decisive comparison under each alternative."""
        import pandas as pd

        rows = []
        for alternative, checks in sources.alternatives:
            own = checks[(checks["id"] == self.claim) & checks["decisive"]]
            rows.append(alternative | (own.iloc[0].to_dict() if len(own) else {}))
        return pd.DataFrame(rows)


_COMPARED = ["metric", "statistic", "unit", "scale", "group", "relation", "other", "place"]


def data(source: pd.DataFrame, options: Options) -> pd.DataFrame:
    """Return one row per alternative: first the default, then those of each assumption.

    Assumptions are sorted by how far one of their values moves the effect, the largest first.
    Columns: assumption, detail, value, those that name the comparison, effect, low95, high95, mark.
    """
    frame = source.reindex(
        columns=["assumption", "detail", "value", *_COMPARED, "effect", "low95", "high95", "mark"]
    )
    moved = (frame["effect"] - frame["effect"].iloc[0]).abs().fillna(np.inf)
    by = {"later": frame.index > 0, "near": -moved.groupby(frame["assumption"]).transform("max")}
    return frame.assign(**by).sort_values([*by, "assumption", "effect"]).drop(columns=[*by])


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the rows from top to bottom, with details and values in words at the left."""
    default, effect = frame.iloc[0], frame["effect"].to_numpy()
    places = _name_rows(axes, frame)
    band = {"facecolor": "0.92", "linewidth": 0, "zorder": 0, "label": "95 % interval by default"}
    axes.axvspan(default["low95"], default["high95"], **band)
    # A claim that few runs leave untestable has none.
    is_share = str(default["relation"]).startswith("in")
    label = "share that the claim needs" if is_share else "no difference"
    needed = _SHARES.get(default["other"], default["other"]) if is_share else 0.0
    axes.axvline(float(needed), **style.BOUND, label=label)
    axes.hlines(places, frame["low95"], frame["high95"], color="0.35", linewidth=0.8)
    axes.plot([], [], **style.INTERVAL)
    marks, counts = frame["mark"].fillna("?").to_numpy(), []
    for mark, look in _LOOKS.items():
        if (chosen := marks == mark).any():
            axes.plot(effect[chosen], places[chosen], zorder=3, **look)
            counts.append(f"{look['label']}: {chosen.sum()}")
    middle = {"xycoords": axes.get_yaxis_transform(), "ha": "center", "va": "center"}
    for place in places[np.isnan(effect)]:
        axes.annotate("no value", (0.5, place), **middle)
    axes.grid(visible=True, axis="x")
    axes.set_xlabel(_name_effect(default, is_share, scene))
    return Note(
        "",
        f"one row for each alternative, alone, of at most {FEW} runs of a method under a "
        f"condition; the comparison that decides {options.claim}",
        f"of {len(frame)} rows, {', '.join(counts)}",
    )


def _name_rows(axes: Axes, frame: pd.DataFrame) -> np.ndarray:
    """Write details and values beside the axes, shape the axes, and return where rows are."""
    names = frame["value"].astype(str).str.replace("_", " ")
    beside = 4 + 4.1 * names.str.len().max()
    words = {"xycoords": axes.get_yaxis_transform(), "textcoords": "offset points", "ha": "right"}
    top, gap, places = 0.0, _GAP / _ROW, []
    for _, values in frame.groupby("assumption", sort=False):
        if top:
            axes.axhline(top - gap / 2, color="0.88", linewidth=0.5, zorder=0)
        text = textwrap.fill(values["detail"].iloc[0], _LETTERS)
        rows = max(len(values), len(text.splitlines()))
        place = (0, top + rows / 2)
        axes.annotate(text, place, (-beside, 0), va="center", linespacing=1.05, **words)
        places.append(top + (rows - len(values) + 1) / 2 + np.arange(len(values)))
        top += rows + gap
    rows = np.concatenate(places)
    axes.set_yticks(rows, names)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(top, -gap)
    axes.set_box_aspect((top + gap) * _ROW / _WIDTH)
    return rows


def _name_effect(row: pd.Series, is_share: bool, scene: Any) -> str:
    """Return the label of the axis of the effect."""
    metric = naming.name_column(row["metric"], scene.labels)
    if is_share:
        return f"share of runs: {metric}"
    unit = "share of the other" if row["scale"] == "relative" else row["unit"]
    beside = f" ({unit})" if isinstance(unit, str) and unit not in ("-", "") else ""
    return f"difference in {metric}{beside}"
