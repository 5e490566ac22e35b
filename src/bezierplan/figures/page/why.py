"""Why a claim has its verdict, in a plain sentence: what is compared, by how much it differs, what
the claim says, and who chose the limit.

There is a template for each kind of test (`analysis.claims.kinds`).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from bezierplan.analysis.claims.check import Check, OfRuns, PublishedMargin
from bezierplan.analysis.claims.kinds import share
from bezierplan.analysis.metrics import METRICS
from bezierplan.figures.amounts import amount

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds import equal_within, function, trend

Row = dict[str, Any]

EVENTS = {
    "below": "below",
    "above": "above",
    "at_most": "at most",
    "at_least": "at least",
    "equals": "",
}
_TIMES = 2.0
"""Relative effects above this are given as multiples, not in per cent."""

_NEEDS = {"all": "in every run", "none": "in no run", "some": "in at least one run"}
_NEEDS["as printed"] = "in all runs of the paper"


def why(row: Row, check: Check, name: str, condition: str, own_criterion: bool) -> str:
    """The sentence about a claim's decisive comparison.

    row: of claim_checks.csv, None where it is empty. name, condition: what is compared, and where,
    as printed. own_criterion: whether the limit is ours because the paper gives no number.
    """
    template = _TEMPLATES.get(row["test"], _effect)
    if row["effect"] is None and template is not _function:
        template = _effect
    notes = [
        "judged on counted work, because seconds differ from machine to machine"
        if isinstance(check, OfRuns) and check.work
        else "",
        "the paper gives no number, so this limit is ours" if own_criterion else "",
    ]
    where = f"{condition}: " if condition else ""
    text = "; ".join(filter(None, [where + template(row, check, name), *notes]))
    return f"{text[:1].upper()}{text[1:]}."


def rule(holds: str | None, verdict: str, count: str | None) -> str:
    """How many comparisons of a claim hold, and how many it needs where that is not plain.

    >>> rule("any", "supported", "3 of 16"), rule("together", "contradicted", "6 of 12")
    ('3 of 16; one suffices', '6 of 12; all are needed together')
    """
    held, _, total = (count or "").partition(" of ")
    some = total and 0 < int(held) < int(total)
    needs = {"any": "one suffices", "together": "all are needed together"}.get(holds or "")
    if some and not needs and verdict == "contradicted":
        needs = "none when corrected for their number"
    return f"{count}; {needs}" if some and needs else count or ""


def reference(check: Check) -> float:
    """The effect on whose other side a claim fails: the share that it needs, 0 for any other
    test.
    """
    if not isinstance(check, share.Options):
        return 0.0
    return {"all": 1.0, "as printed": 1.0, "none": 0.0, "some": 0.0}.get(
        check.threshold, check.threshold
    )


def _claimed(row: Row, check: Check) -> str:
    """What a claim that compares groups says, in each of the comparisons taken together."""
    together = re.fullmatch(r"all (\d+) together", row["comparison"] or "")
    return f"the claim says {check.direction}" + (
        f" in all {together[1]} comparisons" if together else ""
    )


def _between(row: Row, check: Check, name: str) -> str:
    """Of groups that should be lower, or higher, than others."""
    match = re.fullmatch(r"(.+) (lower|higher) than (.+)", name)
    if not match:
        return _effect(row, check, name)
    # Of an event, the share of runs in which it happens.
    measured = re.sub("^whether ", "the share of runs in which ", _quantity(row))
    return (
        f"in {measured}, {match[1]} is {_apart(row, check)} {match[3]}{_interval(row, check)}; "
        f"{_claimed(row, check)}{_margin(row, check)}"
    )


def _apart(row: Row, check: Check) -> str:
    """How a group compares with another: `3 cell lower than`, `25,000 times`."""
    effect = row["effect"]
    if not effect:
        return "equal to"
    if check.relative and effect > _TIMES:
        return f"{_printed(1 + effect)} times"
    return f"{_size(row, check)} {_side(effect)} than"


def _side(effect: float) -> str:
    return "lower" if effect < 0 else "higher"


def _equal(row: Row, check: equal_within.Options, name: str) -> str:
    """Of groups that should be alike, or apart by a stated amount."""
    group, _, second = name.partition(" as ")
    if not second:
        return _effect(row, check, name)
    target = check.target
    says = (
        f"by how much: {_amount(abs(target), row, check)} {_side(target)}"
        if target
        else "that they are alike"
    )
    return (
        f"in {_quantity(row)}, {group} is {_apart(row, check)} "
        f"{second}{_interval(row, check)}; the claim says {says}{_margin(row, check)}"
    )


def _trend(row: Row, check: trend.Options, name: str) -> str:
    """Of a quantity that should rise or fall along another."""
    along, moves = check.x.replace("_", " "), "rises" if row["effect"] > 0 else "falls"
    claimed = {"up": "rises", "down": "falls"}[check.direction]
    return (
        f"{_quantity(row)} {moves} by {_size(row, check)}{_interval(row, check)} from the least to "
        f"the largest {along}; the claim says that it {claimed}{_margin(row, check)}"
    )


def _share(row: Row, check: share.Options, name: str) -> str:
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
    low, high = row["low95"], row["high95"]
    between = (
        ""
        if low is None or high is None
        else f" (95 % interval {100 * low:.3g} to {100 * high:.3g} %)"
    )
    units = "runs" if check.replicate == "repeat" else f"means by {check.replicate}"
    found = f"{happens} in {100 * row['effect']:.3g} % of the {units}{between}"
    return f"{found}; the claim needs it {needed}"


def _event(row: Row, check: share.Options) -> str:
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


def _function(row: Row, check: function.Options, name: str) -> str:
    """Of what a function of the study's own finds."""
    if row["effect"] is None:
        return f"{check.effect}: no value"
    return f"{check.effect}: {_printed(row['effect'])}{_unit(row)}{_interval(row, check)}"


def _effect(row: Row, check: Check, name: str) -> str:
    """Of any other comparison; without an effect, how many runs of each group have a value."""
    if row["effect"] is not None:
        return (
            f"{_quantity(row)}, {name}: {_amount(row['effect'], row, check)}{_interval(row, check)}"
        )
    groups = re.fullmatch(r"(.+) (?:lower|higher) than (.+)", name)
    counts = (row["counted"] or "").split(", ")
    if groups and len(counts) == 2:
        each = " and ".join(
            f"in {count} runs of {group}"
            for count, group in zip(counts, groups.groups(), strict=True)
        )
        return f"{_quantity(row)} has a value {each}; {_claimed(row, check)}"
    counted = f"a value in {' and '.join(counts)} runs" if row["counted"] else "no value"
    return f"{_quantity(row)}, {name}: {counted}"


_TEMPLATES = {
    "lower": _between,
    "equal_within": _equal,
    "trend": _trend,
    "share": _share,
    "function": _function,
}


def _quantity(row: Row) -> str:
    """What is measured, with its statistic: `exact arc length (mean)`."""
    statistic = row["statistic"]
    measured = meaning(row["metric"] or "") or (row["metric"] or "").replace("_", " ")
    return f"{measured} ({statistic})" if statistic and statistic != "rank" else measured


def meaning(metric: str) -> str:
    """What a metric measures, in a phrase; empty if it is not one of the metrics of runs."""
    return METRICS[metric].meaning if metric in METRICS else ""


def _unit(row: Row) -> str:
    return "" if row["unit"] in (None, "", "-") else f" {row['unit']}"


def _size(row: Row, check: Check) -> str:
    return _amount(abs(row["effect"]), row, check)


def _amount(value: float, row: Row, check: Check) -> str:
    """An effect with its unit; a relative one in per cent."""
    if check.relative:
        return f"{_printed(100 * value)} %"
    return amount(_printed(value), _unit(row).strip()).strip()


def _printed(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):,.10g}"


def _interval(row: Row, check: Check) -> str:
    ends, unit = [row["low95"], row["high95"]], ""
    if None in ends:
        return ""
    if check.relative and row["effect"] > _TIMES and check.against:
        ends, unit = [1 + end for end in ends], " times"
    elif check.relative:
        ends, unit = [100 * end for end in ends], " %"
    return f" (95 % interval {' to '.join(map(_printed, ends))}{unit})"


def _margin(row: Row, check: Check) -> str:
    """The limit within which a difference does not count, and who chose it."""
    if row["margin"] is None:
        return ""
    printed = isinstance(check, OfRuns) and isinstance(check.margin, PublishedMargin)
    origin = "our choice, and not more than the printed difference" if printed else "our choice"
    return f"; differences below {_amount(row['margin'], row, check)} do not count ({origin})"
