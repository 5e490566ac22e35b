"""The outcome in a few sentences and one table with a row for each study: what README, page and
summary show first.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import baseline_comparison, comparison, words
from bezierplan.analysis.markdown import table_text

COLUMNS = {
    "numbers": f"numbers: {', '.join(dict.fromkeys(words.groups('number').values()))}",
    "close": "within 10 %",
    "claims": f"claims: {', '.join(dict.fromkeys(words.groups('claim').values()))}",
    "feasible": "proposed method: free paths",
    "length": "its length",
    "cpu": "its CPU time",
}
"""Columns of the table -> their headings; the name of the study stands before them."""

LEGEND = (
    "*agree*: inside our 95 % prediction interval for an experiment of the paper's size, which "
    "must exclude a number that a run could have, such as most of those printed for competing "
    "methods; or *identified*, the length of a path that we can name. *open*: the paper does not "
    "print the map or define the quantity, or the interval is too wide; a claim is open if it is "
    "undecided, untestable, or depends on what the paper leaves open. *fail*: contradicted, or no "
    "effect. Length and CPU time of the proposed method are medians over those of the exact "
    "shortest path with rounded corners, which needs no search and is always free."
)

CLOSE = 0.1
"""Relative deviation up to which a number is close to the printed one."""


class Headline(NamedTuple):
    """sentences: numbers, claims, and methods beside the baseline, as far as there are any. table:
    by study, text in `COLUMNS`.
    """

    sentences: list[str]
    table: pd.DataFrame


def outcome(numbers: pd.DataFrame, claims: pd.DataFrame) -> pd.DataFrame:
    """One row per study: the published numbers that count, in total and by verdict of the test
    (`comparison`), and claims by verdict.

    numbers: as from `numbers`. claims: as from `claims.judge`. Only primary interpretations and
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
    sentences = [
        _sentence("published number", counts[[*words.on("number")]].sum()),
        _sentence("claim", counts[[*words.on("claim")]].sum()) + _by_our_criterion(claims),
        beside_baseline(measures),
    ]
    counted = numbers[numbers["counted"].astype(bool)]
    rows = {
        study: {
            "numbers": _grouped(row, "number"),
            "close": _close(deviations(counted[counted["study"] == study])),
            "claims": _grouped(row, "claim"),
            **_measured(measures[measures["study"] == study]),
        }
        for study, row in counts.loc[sorted(counts.index, key=list(titles).index)].iterrows()
    }
    table = pd.DataFrame.from_dict(rows, orient="index", columns=list(COLUMNS)).rename_axis("study")
    return Headline([sentence for sentence in sentences if sentence], table)


def markdown(head: Headline) -> str:
    """The headline as markdown: the sentences, the table, and what its words mean."""
    shown = head.table.loc[:, (head.table != "").any()].rename(columns=COLUMNS)
    return "\n\n".join([f"**{' '.join(head.sentences)}**", table_text(shown), LEGEND])


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
    """Whether a method that is feasible as often as the baseline gives a shorter path; empty
    without methods.
    """
    reliable = measures[measures["feasible"] >= measures["feasible_baseline"]]
    shorter = int((reliable["length"] < 1 - baseline_comparison.EQUAL).sum())
    return (
        ""
        if measures.empty
        else (
            f"Of {baseline_comparison.counted(len(reliable), 'method')} feasible as often as the "
            f"baseline, {baseline_comparison.BASELINE}, {shorter or 'none'} "
            f"{'give' if shorter > 1 else 'gives'} a shorter path."
        )
    )


def _sentence(noun: str, counts: pd.Series) -> str:
    """How many things have each verdict, in words; empty without things."""
    total = int(counts.sum())
    parts = [
        f"{count} {words.WORDS[verdict].counted}" for verdict, count in counts.items() if count
    ]
    return f"{baseline_comparison.counted(total, noun)}: {', '.join(parts)}." if total else ""


def _by_our_criterion(claims: pd.DataFrame) -> str:
    """How many claims fail by a criterion of ours alone, in words; empty if none does."""
    if "own_criterion" not in claims:
        return ""
    deciding = claims[
        claims["primary"] & ~claims["finding"].astype(bool) & claims["own_criterion"].astype(bool)
    ]
    count = int((deciding["verdict"].map(words.groups("claim")) == "fail").sum())
    if not count:
        return ""
    fails = f"{baseline_comparison.counted(count, 'claim')} {'fails' if count == 1 else 'fail'}"
    return f" {fails} only by our own criterion, because the paper gives no number."


def _grouped(counts: pd.Series, what: str) -> str:
    """How many numbers or claims count as each group; empty without any. counts: by verdict."""
    groups = words.groups(what)
    found = counts[[*groups]].groupby(groups, sort=False).sum()
    return ", ".join(map(str, found)) if found.any() else ""


def _close(off: np.ndarray) -> str:
    return f"{int((off <= CLOSE).sum())} of {len(off)}" if len(off) else ""


def _measured(rows: pd.DataFrame) -> dict[str, str]:
    """The study's proposed method beside the baseline."""
    own = rows[rows["proposed"].astype(bool)]
    if own.empty:
        return dict.fromkeys(("feasible", "length", "cpu"), "")
    number, (row,) = baseline_comparison.number, own.to_dict("records")
    return {
        "feasible": f"{number(100 * row['feasible'])} %",
        "length": "" if np.isnan(row["length"]) else number(row["length"]),
        "cpu": number(row["cpu"], 2),
    }
