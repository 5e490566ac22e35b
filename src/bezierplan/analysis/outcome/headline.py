"""The outcome in a few sentences and one table with a row for each study: what README, page and
summary show first.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import naming, words
from bezierplan.analysis.numbers import comparison, methods

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


class Headline(NamedTuple):
    """sentences: of numbers and claims, as far as there are any. papers: by study, text in
    `PAPERS`.
    """

    sentences: list[str]
    papers: pd.DataFrame


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


def headline(numbers: pd.DataFrame, claims: pd.DataFrame, titles: dict[str, str]) -> Headline:
    """The headline of some studies.

    numbers: as from `summary.numbers`. claims: as from `claims.judge`. titles: of the
    studies, by name.
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
    ]
    of_studies = [positions(counted[counted["study"] == study]) for study in order]
    papers = judged.join(pd.DataFrame(of_studies, index=order))
    papers = papers.loc[order, list(PAPERS)].astype(str)
    return Headline([sentence for sentence in sentences if sentence], papers.rename_axis("study"))


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


def sentence_of_numbers(numbers: pd.DataFrame) -> str:
    """Return what the positions of the printed numbers that count say together; empty without."""
    if numbers.empty:
        return ""
    found = positions(numbers)
    vague = len(numbers) - int(found["narrow"])
    text = (
        f"Of {naming.count(len(numbers), 'printed number')} our range is narrow "
        f"enough to tell for {found['narrow']}: {found['inside']} lie inside it, "
        f"{found['outside']} outside."
    )
    if vague:
        text += f" The other {vague} would fit almost anything."
    ours = int((numbers["reason"] == comparison.NO_MAP).sum())
    if ours:
        text += f" For {ours} the paper prints no map, so neither proves it right or wrong."
    return text


def sentence_of_methods(of_problems: pd.DataFrame) -> str:
    """Return what the papers' methods are worth beside the exact shortest path with rounded
    corners. of_problems: as from `methods.of_studies`.
    """
    rows = methods.of_families(of_problems)
    rows = rows[rows["proposed"].astype(bool) & (rows["both"] > 0)]
    none = int((rows["adds"] == 0).sum())
    return (
        "A simpler planner, the exact shortest path with rounded corners, needs no search; in "
        f"{none} of {naming.count(len(rows), 'kind')} of scenarios the paper's method is nowhere "
        "shorter than it, nor smoother than it can be."
    )


def _of_claims(counts: pd.Series) -> str:
    """How many claims hold, and how many fail. counts: by group."""
    return (
        f"Of {naming.count(counts.sum(), 'claim')} {counts['hold']} hold, "
        f"{counts['partly']} hold in part, {counts['fail']} fail, and {counts['open']} cannot be "
        "decided."
    )
