"""The outcome of numbers, claims and methods, in a sentence each: README, page and the last
lines of a run show the same.
"""

import numpy as np
import pandas as pd

from bezierplan.analysis import naming, words
from bezierplan.analysis.numbers import comparison, methods


def describe_numbers(numbers: pd.DataFrame) -> str:
    """Say for how many printed numbers our range is narrow enough to tell, and how many of these
    lie inside it; empty without numbers that count.

    numbers: as from `summary.list_numbers`.
    """
    numbers = numbers[numbers["counted"].astype(bool)]
    if numbers.empty:
        return ""
    told = numbers[~numbers["wide"].astype(bool)]
    inside = int((told["position"] == "inside").sum())
    text = (
        f"Of {naming.format_count(len(numbers), 'printed number')} our range is narrow enough "
        f"to tell for {len(told)}: {inside} lie inside it, {len(told) - inside} outside."
    )
    if vague := len(numbers) - len(told):
        text += f" The other {vague} would fit almost anything."
    if ours := int((numbers["reason"] == comparison.NO_MAP).sum()):
        text += f" {ours} depend on a map that the paper does not print: these prove nothing."
    return text


def describe_claims(claims: pd.DataFrame) -> str:
    """Say how many claims of the papers hold, and how many fail; empty without claims.

    claims: as from `judge.judge_claims`.
    """
    claims = claims[claims["primary"].astype(bool) & ~claims["finding"].astype(bool)]
    if claims.empty:
        return ""
    groups = words.list_groups("claim")
    counts = claims["verdict"].map(groups).value_counts().reindex([*groups.values()], fill_value=0)
    # A group of several verdicts stands there once for each.
    counts = counts[~counts.index.duplicated()]
    return (
        f"Of {naming.format_count(len(claims), 'claim')} {counts['hold']} hold, {counts['partly']} "
        f"hold in part, {counts['fail']} fail, and {counts['open']} cannot be decided."
    )


def describe_methods(of_problems: pd.DataFrame) -> str:
    """Say what the papers' methods are worth beside the exact shortest path with rounded corners.

    of_problems: as from `methods.measure_studies`.
    """
    rows = methods.group_by_family(of_problems)
    rows = rows[rows["proposed"].astype(bool) & (rows["both"] > 0)]
    none = int((rows["adds"] == 0).sum())
    return (
        "A simpler planner, the exact shortest path with rounded corners, needs no search; in "
        f"{none} of {naming.format_count(len(rows), 'kind')} of scenarios with smooth paths, no "
        "method of a paper is shorter at equal smoothness, or smoother."
    )


def compute_deviations(numbers: pd.DataFrame) -> np.ndarray:
    """Compute |ours - published| / |published| of numbers, infinite beside a 0.

    Ours are scaled to the paper's number of runs. Quantities that the paper does not define say
    nothing, and are left out.
    """
    numbers = numbers[numbers["reason"] != comparison.UNDEFINED]
    published, ours = (
        numbers[name].to_numpy(dtype=float) for name in ("value_published", "value_ours_scaled")
    )
    off = np.abs(ours - published)
    return np.divide(
        off, np.abs(published), out=np.where(off > 0, np.inf, 0.0), where=published != 0
    )
