"""The outcome in a few sentences and one table with a row for each study: what README, page and
summary show first.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import words
from bezierplan.analysis.numbers import baseline_comparison, comparison

PAPERS = {
    "numbers": "printed numbers",
    "narrow": "our range can tell",
    "inside": "of these inside it",
    "off": "typically off by",
    "hold": "claims that hold",
    "partly": "hold in part",
    "fail": "fail",
    "open": "cannot be decided",
}
"""Columns of the table of papers -> their headings; the name of the study stands before them."""

METHODS = {
    "feasible": "free paths",
    "length": "length",
    "curvature": "tightest bend",
    "cpu": "CPU time",
}
"""Columns of the table of proposed methods -> their headings, likewise."""


class Headline(NamedTuple):
    """sentences: numbers, claims, and methods beside the baseline, as far as there are any. papers,
    methods: by study, text in `PAPERS` and `METHODS`.
    """

    sentences: list[str]
    papers: pd.DataFrame
    methods: pd.DataFrame


def positions(numbers: pd.DataFrame) -> dict[str, int | str]:
    """Return how many printed numbers there are, for how many our range is narrow enough to tell,
    how many of these lie inside and outside it, and the median distance from ours.

    numbers: those that count.
    """
    told = numbers[~numbers["wide"].astype(bool)]
    inside = int((told["position"] == "inside").sum())
    distances = deviations(numbers)
    return {
        "numbers": len(numbers),
        "narrow": len(told),
        "inside": inside,
        "outside": len(told) - inside,
        "off": f"{100 * np.median(distances):.2g} %" if len(distances) else "",
    }


def headline(
    numbers: pd.DataFrame, claims: pd.DataFrame, measures: pd.DataFrame, titles: dict[str, str]
) -> Headline:
    """The headline of some studies.

    numbers: as from `summary.numbers`. claims: as from `claims.judge`. measures: as from
    `baseline_comparison.measured`, of all studies. titles: of the studies, by name.
    """
    counted = numbers[numbers["counted"].astype(bool)]
    deciding = claims[claims["primary"] & ~claims["finding"].astype(bool)]
    groups = words.groups("claim")
    names = [*dict.fromkeys(groups.values())]
    judged = pd.crosstab(deciding["study"], deciding["verdict"].map(groups))
    studies = {*counted["study"], *deciding["study"]}
    order = sorted(studies, key=list(titles).index)
    judged = judged.reindex(index=order, columns=names, fill_value=0)
    sentences = [
        sentence_of_numbers(counted),
        _of_claims(judged.sum()) if len(claims) else "",
        beside_baseline(measures),
    ]
    of_studies = [positions(counted[counted["study"] == study]) for study in order]
    papers = judged.join(pd.DataFrame(of_studies, index=order))
    proposed = measures[measures["proposed"].astype(bool)].set_index("study")
    methods = pd.DataFrame.from_dict(
        {study: _measured(proposed.loc[study]) for study in order if study in proposed.index},
        orient="index",
        columns=list(METHODS),
    )
    papers = papers.loc[order, list(PAPERS)].astype(str)
    return Headline(
        [sentence for sentence in sentences if sentence],
        papers.rename_axis("study"),
        methods.rename_axis("study"),
    )


def deviations(numbers: pd.DataFrame) -> np.ndarray:
    """|ours - published| / |published| of numbers, infinite beside a 0. Ours are scaled to the
    paper's number of runs. Quantities that the paper does not define say nothing.
    """
    numbers = numbers[numbers["reason"] != comparison.UNDEFINED]
    published, ours = (
        numbers[name].to_numpy(dtype=float) for name in ("value_published", "value_ours_scaled")
    )
    off = np.abs(ours - published)
    return np.divide(
        off, np.abs(published), out=np.where(off > 0, np.inf, 0.0), where=published != 0
    )


def beside_baseline(measures: pd.DataFrame) -> str:
    """Whether a method that is feasible as often as the baseline gives a shorter path, and how many
    give a smoother one at which cost in length; empty without methods.
    """
    if measures.empty:
        return ""
    number = baseline_comparison.number
    reliable = measures[measures["feasible"] >= measures["feasible_baseline"]]
    shorter = int((reliable["length"] < 1 - baseline_comparison.EQUAL).sum())
    smoother = reliable[reliable["curvature"] < 1 - baseline_comparison.EQUAL]
    text = (
        f"{baseline_comparison.BASELINE.capitalize()} is always free: of the "
        f"{baseline_comparison.counted(len(reliable), 'method')} that are free as often, "
        f"{shorter or 'none'} {'give' if shorter > 1 else 'gives'} a shorter path"
    )
    if smoother.empty:
        return f"{text}, and none a smoother one."
    low, high = (number(smoother["length"].agg(end)) for end in ("min", "max"))
    return f"{text}, and {len(smoother)} a smoother one, {low} to {high} times as long."


def sentence_of_numbers(numbers: pd.DataFrame) -> str:
    """Return what the positions of the printed numbers that count say together; empty without."""
    if numbers.empty:
        return ""
    found = positions(numbers)
    vague = len(numbers) - int(found["narrow"])
    text = (
        f"Of {baseline_comparison.counted(len(numbers), 'printed number')} our range is narrow "
        f"enough to tell for {found['narrow']}: {found['inside']} lie inside it, "
        f"{found['outside']} outside."
    )
    if vague:
        text += f" The other {vague} would fit almost anything."
    ours = int((numbers["reason"] == comparison.NO_MAP).sum())
    if ours:
        text += f" For {ours} the paper prints no map, so neither proves it right or wrong."
    return text


def _of_claims(counts: pd.Series) -> str:
    """How many claims hold, and how many fail. counts: by group."""
    return (
        f"Of {baseline_comparison.counted(counts.sum(), 'claim')} {counts['hold']} hold, "
        f"{counts['partly']} hold in part, {counts['fail']} fail, and {counts['open']} cannot be "
        "decided."
    )


def _measured(row: pd.Series) -> dict[str, str]:
    """A proposed method beside the baseline."""
    shown = {"feasible": f"{baseline_comparison.number(100 * row['feasible'])} %"}
    for name in ("length", "curvature", "cpu"):
        value = row[name]
        if not np.isfinite(value):
            shown[name] = "corners" if np.isinf(value) else ""
        elif name == "length":  # near 1, where the second decimal tells
            shown[name] = f"{value:.2f} ×"
        else:
            shown[name] = f"{baseline_comparison.number(value, 2)} ×"
    return shown
