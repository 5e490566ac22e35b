"""Why a claim has its verdict, in a plain sentence: what is compared, by how much it differs, what the claim says, and who chose the limit.

There is a template for each kind of test (`analysis.claims.kinds`).
"""

import re
from typing import Any

import pandas as pd

from bezierplan.analysis.metrics import METRICS

EVENTS = {"below": "below", "above": "above", "at_most": "at most", "at_least": "at least", "equals": ""}
_NEEDS = {"all": "in every run", "none": "in no run", "some": "in at least one run"}


def why(row: pd.Series, check: dict[str, Any], name: str, condition: str, own_criterion: bool) -> str:
    """The sentence about a claim's decisive comparison.

    row: of claim_checks.csv. check: as in claims.yaml. name, condition: what is compared, and where, as printed. own_criterion: whether the
    limit is ours because the paper gives no number.
    """
    where = f"{condition}: " if condition else ""
    said = _TEMPLATES.get(row["test"], _effect)(row, check, name)
    notes = [_seconds(check, row), "the paper gives no number, so this limit is ours" if own_criterion else ""]
    text = "; ".join(filter(None, [where + said, *notes]))
    return f"{text[:1].upper()}{text[1:]}."


def reference(check: dict[str, Any]) -> float:
    """The effect on whose other side a claim fails: the share that it needs, 0 for any other test."""
    if check["test"] != "share":
        return 0.0
    return {"all": 1.0, "none": 0.0, "some": 0.0}.get(check["threshold"], check["threshold"])


def _between(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of groups that should be lower, or higher, than others."""
    found = re.fullmatch(r"(.+) (lower|higher) than (.+)", name)
    if not found or pd.isna(row["effect"]):
        return _effect(row, check, name)
    group, direction, other = found.groups()
    side = "lower than" if row["effect"] < 0 else "higher than" if row["effect"] > 0 else "as large as"
    amount = f"{_amount(abs(row['effect']), row, check)} {side}" if row["effect"] else side
    return (
        f"{_quantity(row)} of {group} is {amount} that of {other}{_interval(row, check)}; the claim says {direction}{_margin(row, check)}"
    )


def _equal(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of groups that should be alike."""
    if pd.isna(row["effect"]):
        return _effect(row, check, name)
    group, _, other = name.partition(" as ")
    apart = f"{_quantity(row)} of {group} and of {other} differ by {_amount(abs(row['effect']), row, check)}{_interval(row, check)}"
    return f"{apart}; the claim says that they are alike{_margin(row, check)}"


def _differ(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of groups that should differ at all."""
    if pd.isna(row["effect"]):
        return _effect(row, check, name)
    amount = f"{_amount(abs(row['effect']), row, check)}{_interval(row, check)}"
    return f"{_quantity(row)} differs between {name} by {amount}; the claim says that it differs{_margin(row, check)}"


def _trend(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of a quantity that should rise or fall along another."""
    if pd.isna(row["effect"]):
        return _effect(row, check, name)
    along, moves = check["x"].replace("_", " "), "rises" if row["effect"] > 0 else "falls"
    wanted = {"up": "rises", "down": "falls"}[check["direction"]]
    amount = f"{_amount(abs(row['effect']), row, check)}{_interval(row, check)}"
    return (
        f"{_quantity(row)} {moves} by {amount} from the least to the largest {along}; the claim says that it {wanted}{_margin(row, check)}"
    )


def _share(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of a share of runs in which an event happens."""
    event = check.get("event") or {}
    happens = "; ".join(f"{_quantity(row)} is {EVENTS[key]} {value:g}{_unit(row)}".replace("  ", " ") for key, value in event.items())
    happens = happens or f"what counts ({_quantity(row)}) happens"
    needed = _NEEDS.get(check["threshold"]) if isinstance(check["threshold"], str) else None
    needed = needed or f"in {EVENTS[check['direction']]} {100 * check['threshold']:g} %"
    if pd.isna(row["effect"]):
        return _effect(row, check, name)
    if "pick" in check:
        picked = f"the run with the lowest {check['pick']['lowest'].replace('_', ' ')}"
        return f"in {picked}, {happens if row['effect'] else f'it is not so that {happens}'}; the claim needs it there"
    low, high = 100 * row["low95"], 100 * row["high95"]
    interval = "" if pd.isna(low) or pd.isna(high) else f" (95 % interval {low:.3g} to {high:.3g} %)"
    return f"{happens} in {100 * row['effect']:.3g} % of the runs{interval}; the claim needs it {needed}"


def _function(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of what a function of the study's own finds."""
    value = "no value" if pd.isna(row["effect"]) else f"{row['effect']:.3g}{_unit(row)}{_interval(row, check)}"
    return f"{check['effect']}: {value}"


def _arithmetic(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of printed numbers that should follow from each other."""
    return f"the paper's own numbers give {row['effect']:.4g}, and it prints {row['effect_size']:.4g}"


def _effect(row: pd.Series, check: dict[str, Any], name: str) -> str:
    """Of any other comparison."""
    if pd.isna(row["effect"]):
        counted = "" if pd.isna(row["counted"]) else str(row["counted"]).replace(", ", " and ")
        return f"{_quantity(row)}, {name}: " + (f"a value in {counted} runs" if counted else "no value")
    return f"{_quantity(row)}, {name}: {_amount(row['effect'], row, check)}{_interval(row, check)}"


_TEMPLATES = {
    "lower": _between,
    "ordered": _between,
    "equal_within": _equal,
    "difference": _differ,
    "trend": _trend,
    "share": _share,
    "function": _function,
    "published_arithmetic": _arithmetic,
}


def _quantity(row: pd.Series) -> str:
    """What is measured, with its statistic: `mean of: exact arc length`."""
    metric = "" if pd.isna(row["metric"]) else str(row["metric"])
    meaning = METRICS[metric].meaning if metric in METRICS else metric.replace("_", " ")
    statistic = "" if pd.isna(row["statistic"]) or row["statistic"] == "rank" else f" ({row['statistic']})"
    return f"{meaning}{statistic}"


def _unit(row: pd.Series) -> str:
    return "" if pd.isna(row["unit"]) or row["unit"] in ("", "-") else f" {row['unit']}"


def _amount(value: float, row: pd.Series, check: dict[str, Any]) -> str:
    """An effect with its unit; a relative one in per cent."""
    return f"{100 * value:.3g} %" if check.get("scale") == "relative" else f"{value:.3g}{_unit(row)}"


def _interval(row: pd.Series, check: dict[str, Any]) -> str:
    low, high = row["low95"], row["high95"]
    if pd.isna(low) or pd.isna(high):
        return ""
    factor = 100 if check.get("scale") == "relative" else 1
    return f" (difference, 95 % interval {factor * low:.3g} to {factor * high:.3g})"


def _margin(row: pd.Series, check: dict[str, Any]) -> str:
    """The limit within which a difference does not count, and who chose it."""
    if pd.isna(row["margin"]):
        return ""
    printed = isinstance(check.get("margin"), dict)
    origin = "our choice, and not more than the printed difference" if printed else "our choice"
    return f"; differences below {_amount(row['margin'], row, check)} do not count ({origin})"


def _seconds(check: dict[str, Any], row: pd.Series) -> str:
    return "judged on counted work, because seconds differ from machine to machine" if check.get("work") else ""
