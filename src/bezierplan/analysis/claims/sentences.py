"""All words about claims: names of comparisons, why a claim has its verdict in a plain sentence,
where it holds, and notes. Files, page, site and reports say what is made here, from what was judged
(`effects.MarkedComparison`) or from its row in claim_checks.csv.

There is a template for each kind of test (`kinds`).
"""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from bezierplan.analysis.claims import variants
from bezierplan.analysis.claims.check import ClaimCheck, PublishedMargin
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.effects import MarkedComparison
from bezierplan.analysis.claims.kinds import function, share, trend
from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.naming import Labels, format_amount, format_number, name_column
from bezierplan.schema.model import convert_to_list, is_number

Row = dict[str, Any]

_TIMES = 2.0
"""Relative effects above this are given as multiples, not in per cent."""

MOST_LISTED = 4
"""Up to this many names are listed, otherwise only counted."""

_NEEDS = {
    "all": "in every run",
    "none": "in no run",
    "some": "in at least one run",
    "as printed": "in all runs of the paper",
}


class PrintedTerms(NamedTuple):
    """The groups and the place of a row of claim_checks.csv, as printed."""

    group: str
    other: str
    place: str


def name_terms(row: Row, check: ClaimCheck | None, labels: Labels) -> PrintedTerms:
    """Name the groups and the place of a row of claim_checks.csv, None where it is empty."""
    place = describe_place(json.loads(row["place"]), labels)
    if not (check and check.against):
        return PrintedTerms("", "", place)
    groups = (str(_name_group(check, row[end])) for end in ("group", "other"))
    return PrintedTerms(*(name_column(group, labels) for group in groups), place)


def name_comparison(row: Row, check: ClaimCheck | None, labels: Labels) -> str:
    """Name a comparison: the terms, and the place. check: None if the study has it no more."""
    terms = [row[name] for name in ("group", "relation", "other")]
    words = ["" if term is None else _format_value(term) for term in terms]
    names = name_terms(row, check, labels)
    if names.group:
        words[0], words[2] = names.group, names.other
    if row["together"]:
        words = [f"all {row['together']:.0f} together"]
    return ", ".join(filter(None, [" ".join(filter(None, words)), names.place]))


def name_variants(claims: Sequence[Claim], labels: Labels) -> dict[str, str]:
    """Name the variants of claims as printed, by their names in claims.csv."""
    named = {}
    for claim in claims:
        listed = variants.list_variants(claim)
        words = claim.variant_names or [describe_place(values, labels) for values in listed]
        named |= zip(map(variants.name_variant, listed), words)
    return named


def describe_place(values: Mapping[str, Any], labels: Labels) -> str:
    """Describe values by column as printed: a label, or the value after the name of its column."""
    words = []
    for column, value in values.items():
        name, each_value = name_column(column, labels), convert_to_list(value)
        if value is True:
            words.append(name)
        elif value is None:  # the default among variants: all rows
            words.append(f"{name} or not")
        else:
            known = all(str(each) in labels for each in each_value)
            named = [labels.get(str(each), _format_value(each)) for each in each_value]
            words.append(("" if known else f"{name} ") + " and ".join(named))
    return ", ".join(words)


def _format_value(value: Any) -> str:
    """Format a value without a label."""
    return f"{value:g}" if is_number(value) else str(value).replace("_", " ")


def explain_verdict(row: Row, check: ClaimCheck, labels: Labels, own_criterion: bool) -> str:
    """Explain a verdict by a sentence about the claim's decisive comparison.

    row: from claim_checks.csv, None where it is empty. labels: name -> how it is printed.
    own_criterion: whether the limit is ours because the paper gives no number.
    """
    template = _TEMPLATES[row["test"]]
    # The other templates print the effect.
    if row["effect"] is None and template is not _describe_function:
        template = _describe_counts
    notes = [
        "judged on counted work, because seconds differ from machine to machine"
        if check.work
        else "",
        "the paper gives no number, so this limit is ours" if own_criterion else "",
    ]
    names = name_terms(row, check, labels)
    where = f"{names.place}: " if names.place else ""
    text = "; ".join(filter(None, [where + template(row, check, names), *notes]))
    # Not `capitalize`, which makes all other letters small.
    return f"{text[:1].upper()}{text[1:]}."


def join_notes(*notes: str) -> str:
    """Join notes to sentences; the first begins as it stands, and empty ones are left out."""
    text = ""
    for note in filter(None, notes):
        text = f"{text.rstrip('.')}. {note[0].upper()}{note[1:]}" if text else note
    return text


def describe_count(claim: Claim | None, verdict: str, count: str | None) -> str:
    """Describe how many comparisons of a claim hold, such as `3 of 16; one suffices`, and how many
    it needs where that is not plain.

    count: as in claims.csv. claim: None if the study has it no more.
    """
    held, _, total = (count or "").partition(" of ")
    some = total and 0 < int(held) < int(total)
    needs = {"any": "one suffices", "together": "all are needed together"}.get(
        claim.holds if claim else ""
    )
    if some and not needs and verdict == "contradicted":
        needs = "none when corrected for their number"
    return f"{count}; {needs}" if some and needs else count or ""


def find_threshold(check: ClaimCheck) -> float:
    """Return the effect on whose other side a claim fails: the share that it needs, 0 for any other
    test.
    """
    if not isinstance(check, share.Options):
        return 0.0
    return {"all": 1.0, "as printed": 1.0, "none": 0.0, "some": 0.0}.get(
        check.threshold, check.threshold
    )


def _describe_claim(row: Row, check: ClaimCheck) -> str:
    """Say the direction or the difference that a claim gives, and in how many comparisons taken
    together.
    """
    if check.direction:
        together = f" in all {row['together']:.0f} comparisons" if row["together"] else ""
        return f"the claim says {check.direction}{together}"
    if not check.target:
        return "the claim says that they are alike"
    amount = _format_amount(abs(check.target), row, check)
    return f"the claim says by how much: {amount} {_name_side(check.target)}"


def _describe_groups(row: Row, check: ClaimCheck, names: PrintedTerms) -> str:
    """Describe a comparison of groups that should differ, or be alike."""
    # Of an event, the share of runs in which it happens.
    quantity = _name_quantity(row)
    event = quantity.removeprefix("whether ")
    measured = quantity if event == quantity else f"the share of runs in which {event}"
    return (
        f"in {measured}, {names.group} is {_describe_difference(row, check)} "
        f"{names.other}{_format_interval(row, check)}"
        f"; {_describe_claim(row, check)}{_describe_margin(row, check)}"
    )


def _describe_difference(row: Row, check: ClaimCheck) -> str:
    """Describe how a group compares with another: `3 cell lower than`, `25,000 times`."""
    effect = row["effect"]
    if not effect:
        return "equal to"
    if check.relative and effect > _TIMES:
        return f"{format_number(1 + effect)} times"
    return f"{_format_amount(abs(effect), row, check)} {_name_side(effect)} than"


def _name_side(effect: float) -> str:
    """Name the side of an effect: lower or higher."""
    return "lower" if effect < 0 else "higher"


def _describe_trend(row: Row, check: trend.Options, names: PrintedTerms) -> str:
    """Describe a quantity that should rise or fall along another."""
    along, moves = check.x.replace("_", " "), "rises" if row["effect"] > 0 else "falls"
    claimed = {"up": "rises", "down": "falls"}[check.direction]
    size = _format_amount(abs(row["effect"]), row, check)
    return (
        f"{_name_quantity(row)} {moves} by {size}{_format_interval(row, check)} from the "
        f"least to the largest {along}; the claim says that it {claimed}"
        f"{_describe_margin(row, check)}"
    )


def _describe_share(row: Row, check: share.Options, names: PrintedTerms) -> str:
    """Describe a share of runs in which an event happens."""
    happens = _describe_event(row, check)
    if check.pick:
        picked = f"the run with the lowest {check.pick.lowest.replace('_', ' ')}"
        return (
            f"the claim needs that, in {picked}, {happens}; "
            f"{'this holds' if row['effect'] else 'this does not hold'}"
        )
    needed = _NEEDS.get(check.threshold)
    needed = needed or f"in {_format_value(check.direction)} {100 * check.threshold:g} %"
    units = "runs" if check.replicate == "repeat" else f"means by {check.replicate}"
    found = f"{happens} in {100 * row['effect']:.3g} % of the {units}"
    return f"{found}{_format_interval(row, check)}; the claim needs it {needed}"


def _describe_event(row: Row, check: share.Options) -> str:
    """Describe the event of a share: what happens in a run that counts."""
    meaning = _name_quantity(row)
    if check.limit:
        word, value = check.limit
        unit = "" if str(row["unit"]) in meaning else _format_unit(row)
        return f"{meaning} is {_format_value(word)} {value:g}{unit}"
    return (
        meaning.removeprefix("whether ")
        if meaning.startswith("whether ")
        else f"the path is {row['metric'].replace('_', ' ')} ({meaning})"
    )


def _describe_function(row: Row, check: function.Options, names: PrintedTerms) -> str:
    """Describe the finding of a function of the study's own."""
    if row["effect"] is None:
        return f"{check.effect}: no value"
    return (
        f"{check.effect}: {format_number(row['effect'])}{_format_unit(row)}"
        f"{_format_interval(row, check)}"
    )


def _describe_counts(row: Row, check: ClaimCheck, names: PrintedTerms) -> str:
    """Describe a comparison without an effect: how many runs of each group have a value."""
    counts = row["counted"].split(", ")
    groups = [f" of {group}" for group in (names.group, names.other) if group] or [""]
    if len(counts) != len(groups):
        return f"{_name_quantity(row)} has no value"
    have = " and ".join(f"in {count} runs{group}" for count, group in zip(counts, groups))
    claimed = f"; {_describe_claim(row, check)}" if check.against and check.direction else ""
    return f"without a free path there is no {_name_quantity(row)}, which is there {have}{claimed}"


_TEMPLATES = {
    "lower": _describe_groups,
    "equal_within": _describe_groups,
    "trend": _describe_trend,
    "share": _describe_share,
    "function": _describe_function,
}


def _name_quantity(row: Row) -> str:
    """Name the quantity that is measured, with its statistic: `exact arc length (mean)`."""
    statistic = row["statistic"]
    measured = METRICS[row["metric"] or ""].meaning.partition(";")[0]
    return f"{measured} ({statistic})" if statistic and statistic != "rank" else measured


def describe_metric(metric: str | None) -> str:
    """Describe a metric in a phrase; empty if it is not one of the metrics of runs."""
    return METRICS[metric].meaning if metric in METRICS else ""


def _format_unit(row: Row) -> str:
    """Format the unit of a row to follow a number; empty if it has none."""
    return "" if row["unit"] in (None, "-") else f" {row['unit']}"


def _format_amount(value: float, row: Row, check: ClaimCheck) -> str:
    """Format an effect with its unit; a relative one in per cent."""
    if check.relative:
        return f"{format_number(100 * value)} %"
    return format_amount(format_number(value), _format_unit(row).strip()).strip()


def _format_interval(row: Row, check: ClaimCheck) -> str:
    """Format the 95 % interval of a row like its effect; empty without one."""
    ends, unit = [row["low95"], row["high95"]], ""
    if None in ends:
        return ""
    if check.relative and row["effect"] > _TIMES and check.against:
        ends, unit = [1 + end for end in ends], " times"
    elif check.relative or isinstance(check, share.Options):
        ends, unit = [100 * end for end in ends], " %"
    return f" (95 % interval {' to '.join(map(format_number, ends))}{unit})"


def _describe_margin(row: Row, check: ClaimCheck) -> str:
    """Describe the limit within which a difference does not count, and who chose it."""
    if row["margin"] is None:
        return ""
    printed = isinstance(check.margin, PublishedMargin)
    origin = "our choice, and not more than the printed difference" if printed else "our choice"
    return (
        f"; differences below {_format_amount(row['margin'], row, check)} do not count ({origin})"
    )


# Notes


def note_own_criterion(claim: Claim, verdict: str) -> str:
    """Return the first words of the reason for a claim that holds, or does not, by a threshold of
    ours, where the paper gives no number.
    """
    if claim.criterion is None or verdict == "undecided":
        return ""
    word = {"supported": "holds", "partly": "holds in part"}.get(verdict, "fails")
    return f"{word} by our criterion alone"


def note_negligible(deciding: Sequence[MarkedComparison], verdict: str, unit: str) -> str:
    """Say below what size all negligible differences of a claim without effect lie; empty for any
    other.
    """
    within = [each for each in deciding if each.mark_family == "0"]
    if verdict != "no effect" or not within:
        return ""
    most = max(max(abs(each.finding.low95), abs(each.finding.high95)) for each in within)
    relative = within[0].check.relative
    size = f"{100 * most:.2g} %" if relative else f"{most:.2g} {unit}".removesuffix(" -")
    where = (
        "" if len(within) == len(deciding) else f"in {len(within)} of {len(deciding)} comparisons, "
    )
    return f"{where}differs by less than {size}"


# Where a claim holds


class Entry(NamedTuple):
    """A comparison for its description in words: the values of its factors (`against`, `group`,
    `what`, columns), and its mark.
    """

    factors: Mapping[str, Any]
    mark: str


def _list_factors(entry: MarkedComparison, deciding: Sequence[MarkedComparison]) -> Entry:
    """List the factors that distinguish a comparison from the others of its claim, with
    its mark.
    """
    factors: dict[str, Any] = {}
    if entry.check.against and not entry.parts:
        group, other = (_name_group(entry.check, cell) for cell in entry.comparison.cells)
        factors |= {"against": other, "group": group}
    factors |= dict(entry.comparison.place)
    if len({_describe_check(other.check) for other in deciding}) > 1:
        factors["what"] = _describe_check(entry.check)
    return Entry(factors, entry.mark_family)


def _describe_check(check: ClaimCheck) -> str:
    """Describe what a check compares, in words."""
    statistic = check.statistic if "statistic" in check.model_fields_set else ""
    return f"{statistic} {check.metric or check.test}".strip().replace("_", " ")


def describe_where_it_holds(findings: Sequence[MarkedComparison], labels: Labels) -> str:
    """Say where a claim holds (`describe_split`), by the comparisons that decide.

    If all or none of these hold, because the closest of several taken together decides, say it by
    those one by one.
    """
    deciding = [each for each in findings if each.primary]
    words = describe_split([_list_factors(each, deciding) for each in deciding], labels)
    single = [
        each._replace(mark_family=each.mark)
        for each in findings
        if not each.primary and any(each.check is whole.check for whole in deciding if whole.parts)
    ]
    if words or not any(each.mark == "+" for each in single):
        return words
    words = describe_split([_list_factors(each, single) for each in single], labels)
    return f"taken singly, {words}" if words else ""


def _name_group(check: ClaimCheck, group: Any) -> Any:
    """Name a group; a number, which a file may hold as text, gets the name of its column."""
    # The name of a method may look like a number.
    if isinstance(group, str) and check.cells != "method":
        with suppress(ValueError):
            group = float(group)
    return group if isinstance(group, str) else f"{group:g} {check.cells.replace('_', ' ')}"


def note_disagreement(findings: Sequence[MarkedComparison]) -> str:
    """Note where seconds disagree with the counted work that is judged in their place."""
    seconds = {_build_key(each): each.mark for each in findings if each.check.timed}
    pairs = [
        (each.mark, seconds[_build_key(each)])
        for each in findings
        if each.primary and _build_key(each) in seconds and each.check._printed_metric
    ]
    differing = sum(mark != other for mark, other in pairs)
    return (
        f"judged on counted work; seconds disagree in {differing} of {len(pairs)}"
        if differing
        else ""
    )


def _build_key(entry: MarkedComparison) -> tuple:
    """Return what identifies a comparison: its place, and its terms or, if it combines several, how
    many.
    """
    return entry.comparison.place, len(entry.parts) or entry.comparison.terms


def describe_split(comparisons: Sequence[Entry], labels: Labels) -> str:
    """Describe which comparisons of a claim hold and which do not; empty if all or none do.

    They are split by the factor that best separates those that hold from those that do not; for a
    value with both, the text says how many hold. If none holds, the words are about the contrary.
    labels: name -> how it is printed. Example: `against 5 of 7: all but Circle and Sinusoidal`.
    """
    sought = "+" if any(each.mark == "+" for each in comparisons) else "-"
    held = sum(each.mark == sought for each in comparisons)
    if held in (0, len(comparisons)):
        return ""
    factor, marks = _find_best_split(comparisons, sought)
    full = [value for value, own in marks.items() if all(own)]
    words = [_describe_subset(factor, full, list(marks), labels)] if full else []
    words += [
        f"{_choose_preposition(factor)}{_name_value(value, labels)} in {sum(own)} of {len(own)}"
        for value, own in marks.items()
        if any(own) and not all(own)
    ]
    unknown = sum(each.mark == "?" for each in comparisons)
    words += [] if factor else [f"in {held} of {len(comparisons)}"]
    words += [f"undecided in {unknown} of {len(comparisons)}"] if unknown else []
    return ("" if sought == "+" else "the contrary ") + "; ".join(words)


def _find_best_split(
    comparisons: Sequence[Entry], sought: str
) -> tuple[str, dict[Any, list[bool]]]:
    """Find the factor of all comparisons with the least mixed values (Gini impurity), the first
    among equals.

    Returns it, and by value which of its comparisons have the mark; empty if none has two values.
    """
    best, least = ("", {}), np.inf
    for factor in comparisons[0].factors:
        if any(factor not in each.factors for each in comparisons):
            continue
        parts: dict[Any, list[bool]] = {}
        for each in comparisons:
            parts.setdefault(each.factors[factor], []).append(each.mark == sought)
        impurity = sum(len(part) * np.mean(part) * (1 - np.mean(part)) for part in parts.values())
        # Equal impurities may differ in their last bits; then the first factor stays.
        if len(parts) > 1 and impurity < least - 1e-9:
            best, least = (factor, parts), impurity
    return best


def _describe_subset(factor: str, subset: list, every: list, labels: Labels) -> str:
    """Describe a subset of a factor's values."""
    others = [value for value in every if value not in subset]
    before = _choose_preposition(factor)
    # A long list is told by the few that it lacks.
    few = len(subset) > len(others) and len(others) <= MOST_LISTED and len(every) > MOST_LISTED
    if few and before.startswith("at "):
        return f"{before}other than {_join_names(others, labels)}"
    if few:
        return f"{before}{len(subset)} of {len(every)}: all but {_join_names(others, labels)}"
    return f"{before}{_join_names(subset, labels)}"


def _join_names(values: list, labels: Labels) -> str:
    """Join the names of values by commas and a last `and`."""
    names = [_name_value(value, labels) for value in values]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _name_value(value: Any, labels: Labels) -> str:
    """Name a value by its label, or else by its text."""
    return labels.get(str(value), f"{value:g}" if isinstance(value, float) else str(value))


def _choose_preposition(factor: str) -> str:
    """Choose the word before the values of a factor."""
    words = {"against": "against", "group": "for", "method": "for"}
    places = ("what", "workspace", "problem", "experiment")
    return words.get(factor, "in" if factor in places else f"at {factor.replace('_', ' ')}") + " "
