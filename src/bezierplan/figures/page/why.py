"""Why a claim has its verdict, in a plain sentence: what is compared, by how much it differs, what
the claim says, and who chose the limit.

There is a template for each kind of test (`analysis.claims.kinds`).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pandas as pd

from bezierplan.analysis.claims.check import Check, OfRuns, PublishedMargin
from bezierplan.analysis.claims.kinds import share
from bezierplan.analysis.metrics import METRICS
from bezierplan.schema.words import amount

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds import (
        difference,
        equal_within,
        function,
        lower,
        trend,
    )

EVENTS = {
    "below": "below",
    "above": "above",
    "at_most": "at most",
    "at_least": "at least",
    "equals": "",
}
_TIMES = 2.0
"""Relative effects above this are told as multiples, not in per cent."""

_NEEDS = {"all": "in every run", "none": "in no run", "some": "in at least one run"}
_NEEDS["as printed"] = "in all runs of the paper"


def why(row: pd.Series, check: Check, name: str, condition: str, own_criterion: bool) -> str:
    """The sentence about a claim's decisive comparison.

    row: of claim_checks.csv. name, condition: what is compared, and where, as printed.
    own_criterion: whether the limit is ours because the paper gives no number.
    """
    where = f"{condition}: " if condition else ""
    template = _TEMPLATES.get(row["test"], _effect)
    if pd.isna(row["effect"]) and template is not _function:
        template = _effect
    said = template(row, check, name)
    notes = [
        _seconds(check),
        "the paper gives no number, so this limit is ours" if own_criterion else "",
    ]
    text = "; ".join(filter(None, [where + said, *notes]))
    return f"{text[:1].upper()}{text[1:]}."


def reference(check: Check) -> float:
    """The effect on whose other side a claim fails: the share that it needs, 0 for any other
    test.
    """
    if not isinstance(check, share.Options):
        return 0.0
    return {"all": 1.0, "none": 0.0, "some": 0.0}.get(check.threshold, check.threshold)


def _between(row: pd.Series, check: lower.Options, name: str) -> str:
    """Of groups that should be lower, or higher, than others."""
    together = re.fullmatch(r"all (\d+) together", name)
    if together:
        decisive = (
            f"of {together[1]} comparisons in {_measured(row)}, the decisive one is "
            f"{_apart(row, check).removesuffix(' than')}"
        )
        return (
            f"{decisive}{_interval(row, check)}; the claim says {check.direction} in all of "
            f"them{_margin(row, check)}"
        )
    match = re.fullmatch(r"(.+) (lower|higher) than (.+)", name)
    if not match:
        return _effect(row, check, name)
    group, direction, other = match.groups()
    told = f"in {_measured(row)}, {group} is {_apart(row, check)} {other}{_interval(row, check)}"
    return f"{told}; the claim says {direction}{_margin(row, check)}"


def _apart(row: pd.Series, check: Check) -> str:
    """How a group compares with another: `3 cell lower than`, `25,000 times`."""
    effect = row["effect"]
    if not effect:
        return "equal to"
    if check.relative and effect > _TIMES:
        return f"{_printed(1 + effect)} times"
    return f"{_amount(abs(effect), row, check)} {'lower' if effect < 0 else 'higher'} than"


def _equal(row: pd.Series, check: equal_within.Options, name: str) -> str:
    """Of groups that should be alike, or apart by a stated amount."""
    group, _, second = name.partition(" as ")
    if not second:
        return _effect(row, check, name)
    target = check.target
    says = (
        "that they are alike"
        if not target
        else f"by how much: {_amount(abs(target), row, check)} "
        f"{'lower' if target < 0 else 'higher'}"
    )
    return (
        f"in {_quantity(row)}, {group} is {_apart(row, check)} "
        f"{second}{_interval(row, check)}; the claim says {says}{_margin(row, check)}"
    )


def _differ(row: pd.Series, check: difference.Options, name: str) -> str:
    """Of groups that should differ at all."""
    amount = f"{_amount(abs(row['effect']), row, check)}{_interval(row, check)}"
    return (
        f"{_quantity(row)} differs between {name} by {amount}; the claim says that it "
        f"differs{_margin(row, check)}"
    )


def _trend(row: pd.Series, check: trend.Options, name: str) -> str:
    """Of a quantity that should rise or fall along another."""
    along, moves = check.x.replace("_", " "), "rises" if row["effect"] > 0 else "falls"
    wanted = {"up": "rises", "down": "falls"}[check.direction]
    amount = f"{_amount(abs(row['effect']), row, check)}{_interval(row, check)}"
    return (
        f"{_quantity(row)} {moves} by {amount} from the least to the largest {along}; the "
        f"claim says that it {wanted}{_margin(row, check)}"
    )


def _share(row: pd.Series, check: share.Options, name: str) -> str:
    """Of a share of runs in which an event happens."""
    happens = _event(row, check)
    if check.pick:
        picked = f"the run with the lowest {check.pick.lowest.replace('_', ' ')}"
        return (
            f"the claim needs that, in {picked}, {happens}; "
            f"{'this holds' if row['effect'] else 'this does not hold'}"
        )
    needed = _NEEDS.get(check.threshold) if isinstance(check.threshold, str) else None
    needed = needed or f"in {EVENTS[check.direction]} {100 * check.threshold:g} %"
    low, high = 100 * row["low95"], 100 * row["high95"]
    ends = "" if pd.isna(low) or pd.isna(high) else f" (95 % interval {low:.3g} to {high:.3g} %)"
    found = f"{happens} in {100 * row['effect']:.3g} % of the runs{ends}"
    return f"{found}; the claim needs it {needed}"


def _event(row: pd.Series, check: share.Options) -> str:
    """What happens in a run that counts."""
    meaning = _quantity(row)
    if check.limit:
        key, value = check.limit
        unit = "" if str(row["unit"]) in meaning else _unit(row)
        return " ".join(f"{meaning} is {EVENTS[key]} {value:g}{unit}".split())
    return (
        meaning.removeprefix("whether ")
        if meaning.startswith("whether ")
        else f"the path is {row['metric'].replace('_', ' ')} ({meaning})"
    )


def _function(row: pd.Series, check: function.Options, name: str) -> str:
    """Of what a function of the study's own finds."""
    value = (
        "no value"
        if pd.isna(row["effect"])
        else f"{_printed(row['effect'])}{_unit(row)}{_interval(row, check)}"
    )
    return f"{check.effect}: {value}"


def _effect(row: pd.Series, check: Check, name: str) -> str:
    """Of any other comparison."""
    if pd.isna(row["effect"]):
        counted = "" if pd.isna(row["counted"]) else str(row["counted"]).replace(", ", " and ")
        return f"{_quantity(row)}, {name}: " + (
            f"a value in {counted} runs" if counted else "no value"
        )
    return f"{_quantity(row)}, {name}: {_amount(row['effect'], row, check)}{_interval(row, check)}"


_TEMPLATES = {
    "lower": _between,
    "equal_within": _equal,
    "difference": _differ,
    "trend": _trend,
    "share": _share,
    "function": _function,
}


def _quantity(row: pd.Series) -> str:
    """What is measured, with its statistic: `exact arc length (mean)`."""
    metric = "" if pd.isna(row["metric"]) else str(row["metric"])
    meaning = METRICS[metric].meaning if metric in METRICS else metric.replace("_", " ")
    statistic = (
        "" if pd.isna(row["statistic"]) or row["statistic"] == "rank" else f" ({row['statistic']})"
    )
    return f"{meaning}{statistic}"


def _measured(row: pd.Series) -> str:
    """What is compared: of an event, the share of runs in which it happens."""
    return re.sub("^whether ", "the share of runs in which ", _quantity(row))


def _unit(row: pd.Series) -> str:
    return "" if pd.isna(row["unit"]) or row["unit"] in ("", "-") else f" {row['unit']}"


def _amount(value: float, row: pd.Series, check: Check) -> str:
    """An effect with its unit; a relative one in per cent."""
    if check.relative:
        return f"{_printed(100 * value)} %"
    return amount(_printed(value), _unit(row).strip()).strip()


def _printed(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):,.10g}"


def _interval(row: pd.Series, check: Check) -> str:
    low, high = row["low95"], row["high95"]
    if pd.isna(low) or pd.isna(high):
        return ""
    relative = check.relative
    if relative and row["effect"] > _TIMES and check.against:
        return f" (95 % interval {_printed(1 + low)} to {_printed(1 + high)} times)"
    ends = " to ".join(_printed(100 * end if relative else end) for end in (low, high))
    return f" (95 % interval {ends}{' %' if relative else ''})"


def _margin(row: pd.Series, check: Check) -> str:
    """The limit within which a difference does not count, and who chose it."""
    if pd.isna(row["margin"]):
        return ""
    printed = isinstance(check, OfRuns) and isinstance(check.margin, PublishedMargin)
    origin = "our choice, and not more than the printed difference" if printed else "our choice"
    return f"; differences below {_amount(row['margin'], row, check)} do not count ({origin})"


def _seconds(check: Check) -> str:
    return (
        "judged on counted work, because seconds differ from machine to machine"
        if isinstance(check, OfRuns) and check.work
        else ""
    )
