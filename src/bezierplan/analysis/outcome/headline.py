"""The outcome in a few sentences and one table with a row for each study: what README, page and
summary show first.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import words
from bezierplan.analysis.numbers import baseline_comparison, comparison

PAPERS = {
    "word": "outcome",
    "tested": "numbers that can be tested",
    "agree": "of these we reproduce",
    "close": "ours within 10 %",
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

LEGEND = (
    "A paper's word follows from the claims of its abstract and conclusion. A number *reproduces* "
    "if it lies in our 95 % prediction interval, narrow enough to rule out other plausible values, "
    "or is the length of a path that we can name. Most *cannot be tested*: the paper does not "
    "print the map, or define the quantity."
)

CLOSE = 0.1
"""Relative deviation up to which a number is close to the printed one."""


class Headline(NamedTuple):
    """sentences: numbers, claims, and methods beside the baseline, as far as there are any. papers,
    methods: by study, text in `PAPERS` and `METHODS`.
    """

    sentences: list[str]
    papers: pd.DataFrame
    methods: pd.DataFrame


def outcome(numbers: pd.DataFrame, claims: pd.DataFrame) -> pd.DataFrame:
    """One row per study: the published numbers that count, in total and by verdict of the test
    (`comparison`), and claims by verdict.

    numbers: as from `numbers`. claims: as from `claims.judge`. Only the default reading and
    variants count.
    """
    judged = numbers[numbers["counted"]]
    deciding = claims[claims["primary"] & ~claims["finding"].astype(bool)]
    counts, verdicts = (
        pd.crosstab(rows["study"], rows["verdict"]).reindex(columns=[*words.on(what)], fill_value=0)
        for rows, what in ((judged, "number"), (deciding, "claim"))
    )
    counts.insert(0, "numbers", counts.sum(axis=1))
    return counts.join(verdicts, how="outer").fillna(0).astype(int)


def headline(
    numbers: pd.DataFrame, claims: pd.DataFrame, measures: pd.DataFrame, titles: dict[str, str]
) -> Headline:
    """The headline of some studies.

    numbers: as from `summary.numbers`. claims: as from `claims.judge`. measures: as from
    `baseline_comparison.measured`, of all studies. titles: of the studies, by name.
    """
    counts = outcome(numbers, claims)
    grouped = {what: _grouped(counts, what) for what in ("number", "claim")}
    sentences = [
        _of_numbers(grouped["number"].sum()),
        _of_claims(grouped["claim"].sum()) if len(claims) else "",
        beside_baseline(measures),
    ]
    tested, counted = grouped["number"], numbers[numbers["counted"].astype(bool)]
    papers = grouped["claim"].assign(
        word=[word(claims[claims["study"] == study]) for study in counts.index],
        tested=tested["agree"] + tested["disagree"],
        agree=tested["agree"],
        close=[_close(counted[counted["study"] == study]) for study in counts.index],
    )
    order = sorted(counts.index, key=list(titles).index)
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


def word(claims: pd.DataFrame) -> str:
    """A paper in a word, from its claims of abstract and conclusion: whether all of those that can
    be decided hold, or none.
    """
    main = claims[claims["primary"] & claims["main"].astype(bool)]
    groups = main["verdict"].map(words.groups("claim"))
    decided = groups[groups != "open"]
    if decided.empty:
        return "cannot be told"
    if (decided == "hold").all():
        return "reproduced"
    return "not reproduced" if (decided == "fail").all() else "in part"


def deviations(numbers: pd.DataFrame) -> np.ndarray:
    """|ours - published| / |published| of numbers, infinite beside a 0. Ours are scaled to the
    paper's number of runs. Quantities that the paper does not define say nothing.
    """
    numbers = numbers[numbers["why"] != comparison.UNDEFINED]
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


def _of_numbers(counts: pd.Series) -> str:
    """How many printed numbers can be tested, and how many reproduce. counts: by group."""
    total, agree = int(counts.sum()), int(counts["agree"])
    return (
        f"Of {baseline_comparison.counted(total, 'printed number')} {agree + counts['disagree']} "
        f"can be tested; of these we reproduce {agree}."
        if total
        else ""
    )


def _of_claims(counts: pd.Series) -> str:
    """How many claims hold, and how many fail. counts: by group."""
    return (
        f"Of {baseline_comparison.counted(counts.sum(), 'claim')} {counts['hold']} hold, "
        f"{counts['partly']} hold in part, {counts['fail']} fail, and {counts['open']} cannot be "
        "decided."
    )


def _close(numbers: pd.DataFrame) -> str:
    off = deviations(numbers)
    return f"{(off <= CLOSE).sum()} of {len(off)}"


def _grouped(counts: pd.DataFrame, what: str) -> pd.DataFrame:
    """How many numbers or claims of each study count as each group. counts: by verdict."""
    groups = words.groups(what)
    return counts[[*groups]].T.groupby(groups, sort=False).sum().T


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
