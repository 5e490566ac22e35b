"""A specification curve (Simonsohn, Simmons and Nelson 2020, Nat. Hum. Behav. 4, 1208) of the
readings of a paper: their scores in order, beside those of true readings, and below, what each
chooses.
"""

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bezierplan.analysis.choices import Choice
from bezierplan.figures import style

LOOKS = {
    "reading": style.mark("o", 3, style.BLUE),
    "excluded by a sentence of the paper": style.mark("x", 3.5, "0.35"),
    "default": style.mark("s", 4.5, style.BLACK),
    "best that no sentence excludes": style.mark("*", 7, style.RED),
}
"""Part -> the look of its readings."""
TRUE = "true reading"
ROW = 2.9 / 25.4
"""Height of an alternative's row, in inches."""


def data(scores: pd.DataFrame, calibration: pd.DataFrame) -> pd.DataFrame:
    """A row for each reading, the best first, then for each hidden one; columns: part (one of
    `LOOKS`, or `TRUE`), reading, score, error. Both tables as from `analysis.readings`.
    """
    free = scores["excluded_by"].isna()
    plain, excluded, default, best = LOOKS
    part = np.where(free, plain, excluded)
    part = np.where(scores["reading"] == "default", default, part)
    part = np.where(scores.index == free.idxmax(), best, part)
    hidden = calibration[calibration["hidden"]].sort_values("score", ascending=False)
    tables = [scores.assign(part=part), hidden.assign(part=TRUE, reading=hidden["truth"])]
    return pd.concat(tables)[["part", "reading", "score", "error"]]


def draw(frame: pd.DataFrame, choices: list[Choice]) -> Figure:
    """The figure of a table made by `data`. choices: of the paper's details."""
    true = frame["part"] == TRUE
    readings, true_scores = frame[~true].reset_index(drop=True), frame.loc[true, "score"]
    made = readings.assign(choice=readings["reading"].str.split(", ")).explode("choice")
    rows = {
        f"{each.id}={value}": f"{what} = {value} ({each.id})".replace("_", " ")
        for each in choices
        for what in [each.setting or next(iter(each.workspaces.values()))]
        for value in each.alternatives
        if f"{each.id}={value}" in {*made["choice"]}
    }
    with mpl.rc_context(style.SETTINGS):
        below = ROW * len(rows)
        figure = Figure(figsize=(style.WIDTHS["two"], below + 3), layout="constrained")
        FigureCanvasAgg(figure)
        (curve, truths), (matrix, empty) = figure.subplots(
            *(2, 2), sharex="col", sharey="row", width_ratios=(9, 1), height_ratios=(2, below)
        )
        empty.remove()
        for part, look in LOOKS.items():
            own = readings[readings["part"] == part]
            places, bars = own.index + 1, own["error"]
            curve.errorbar(places, own["score"], bars, elinewidth=0.6, label=part, **look)
            own = made[(made["part"] == part) & made["choice"].isin(rows)]
            matrix.plot(own.index + 1, own["choice"].map([*rows].index), **look)
        truths.plot(range(len(true_scores)), true_scores, label=TRUE, **style.PUBLISHED_MARK)
        for axes in (curve, truths):
            axes.axhspan(
                true_scores.min(), true_scores.max(), color=style.LIGHT_BLUE, alpha=0.5, zorder=0
            )
            axes.grid(visible=True, axis="y")
        truths.set_xticks([])
        curve.set_ylabel("score (mean log density of a printed number)")
        style.name_rows(matrix, [*rows.values()])
        matrix.set_xlabel("place of the reading, the best first")
        figure.legend(loc="outside upper center", ncols=3)
    return figure
