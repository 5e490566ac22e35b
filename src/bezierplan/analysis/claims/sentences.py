"""All words about claims: names of comparisons, where a claim holds, and notes. Files, page, site
and reports say what is made here, from what was judged (`effects.MarkedComparison`) or from its row
in claim_checks.csv.
"""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from bezierplan.analysis.claims import variants
from bezierplan.analysis.claims.check import ClaimCheck
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.kinds import share
from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.naming import Labels, name_column
from bezierplan.schema.model import convert_to_list, is_number

Row = dict[str, Any]

MOST_LISTED = 3
"""Up to this many names are listed, otherwise only counted."""

_WORDS = {"+": "Holds", "-": "The contrary", "0": "No effect", "?": "Undecided"}
"""Mark -> what it says of the comparisons that have it."""


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


def describe_metric(metric: str | None) -> str:
    """Describe a metric in a phrase; empty if it is not one of the metrics of runs."""
    return METRICS[metric].meaning if metric in METRICS else ""


# Notes


def note_own_criterion(claim: Claim, verdict: str) -> str:
    """Return the first words of the reason for a claim that holds, or does not, by a threshold of
    ours, where the paper gives no number.
    """
    if claim.criterion is None or verdict == "undecided":
        return ""
    word = {"supported": "holds", "partly": "holds in part"}.get(verdict, "fails")
    return f"{word} by our criterion alone"


def describe_where(rows: Sequence[Row], checks: Sequence[ClaimCheck], labels: Labels) -> str:
    """Describe where a claim holds: list the comparisons of each mark by what differs between them,
    or count them if they are many; empty if all have one mark.

    rows: the primary ones of claim_checks.csv. checks: of the claim. Example: `Holds: length.
    Undecided: 5 of 6`.
    """
    parts = []
    for row in rows:
        group, other, place = name_terms(row, checks[row["check"] - 1], labels)
        # What a function computes takes many words.
        statistic = (
            "" if row["test"] == "function" or row["statistic"] == "rank" else row["statistic"]
        )
        measured = " ".join(filter(None, [statistic, row["metric"] or row["test"]]))
        parts.append((group, other and f"against {other}", place, measured.replace("_", " ")))
    # What all comparisons share is left out, as in `MGA against GA, Case 1`.
    told_apart = [each if len({*each}) > 1 else [""] * len(rows) for each in zip(*parts)]
    names = [
        ", ".join(filter(None, (f"{group} {other}".strip(), place, measured)))
        for group, other, place, measured in zip(*told_apart)
    ]
    told = []
    for mark, word in _WORDS.items():
        own = [name for name, row in zip(names, rows) if row["mark_family"] == mark]
        listed = "; ".join(own) if len(own) <= MOST_LISTED else f"{len(own)} of {len(rows)}"
        told += [f"{word}: {listed}"] if any(own) else []
    return ". ".join(told) if len(told) > 1 else ""


def _name_group(check: ClaimCheck, group: Any) -> Any:
    """Name a group; a number, which a file may hold as text, gets the name of its column."""
    # The name of a method may look like a number.
    if isinstance(group, str) and check.cells != "method":
        with suppress(ValueError):
            group = float(group)
    return group if isinstance(group, str) else f"{group:g} {check.cells.replace('_', ' ')}"
