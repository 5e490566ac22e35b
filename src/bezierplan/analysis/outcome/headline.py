"""The outcome of numbers and of claims, in a sentence each: README, page and the last lines of a
run show the same.
"""

from collections import Counter

import pandas as pd

from bezierplan.analysis import legend, naming


def describe_numbers(numbers: pd.DataFrame) -> str:
    """Say for how many printed numbers our range is too wide to tell, and how many of the others
    lie inside it; empty without numbers that count.

    numbers: as from `summary.list_numbers`.
    """
    numbers = numbers[numbers["counted"].astype(bool)]
    if numbers.empty:
        return ""
    told = numbers[~numbers["wide"].astype(bool)]
    inside = int((told["position"] == "inside").sum())
    text = f"Of {naming.format_count(len(numbers), 'printed number')} "
    if vague := len(numbers) - len(told):
        text += (
            f"our range is too wide to tell for {vague}: it also holds at least half of the "
            f"paper's other numbers of that quantity and condition. Of the other {len(told)}, "
        )
    text += f"{inside} lie inside our range, {len(told) - inside} outside."
    reasons = told["reason"].fillna("")
    worth = told[reasons == ""]
    if len(worth) < len(told):
        counts = reasons[reasons != ""].value_counts()
        why = ", ".join(f"{reason}: {count}" for reason, count in counts.items())
        text += (
            f" Inside or outside, {len(told) - len(worth)} of these prove nothing about the paper "
            f"({why}). Only {len(worth)} could confirm a paper, and "
            f"{(worth['position'] == 'inside').sum()} do."
        )
    return text


def describe_claims(claims: pd.DataFrame) -> str:
    """Say how many claims of the papers hold, and how many fail; empty without claims.

    claims: as from `judge.judge_claims`.
    """
    claims = claims[claims["primary"].astype(bool) & ~claims["finding"].astype(bool)]
    if claims.empty:
        return ""
    each = Counter(claims["verdict"])
    counts = Counter(legend.WORDS[verdict].group for verdict in claims["verdict"])
    return (
        f"Of {naming.format_count(len(claims), 'claim')} {counts['hold']} hold, {counts['partly']} "
        f"hold in part, {counts['fail']} fail, and {counts['open']} are open: {each['undecided']} "
        f"undecided, {each['untestable']} untestable, {each['depends']} dependent on unprinted "
        "details."
    )
