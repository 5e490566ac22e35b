"""Sentences of a paper, judged on runs and on the paper's own numbers.

A claim is a list of checks; config/README.md describes their format, `kinds` the test behind each
kind. Every check gives one or more comparisons, every comparison a mark:

| mark | meaning |
| --- | --- |
| + | the sentence holds here: p < 0.05, and the effect is as claimed and as large as the margin |
| - | the opposite holds |
| 0 | neither, and the interval of the effect lies within the margin |
| ? | none of these, or too little data to test |

Comparisons that a check takes `together` (a superlative: the best of all in a column, or on a map)
are judged as one, and are shown below it as secondary ones.

A comparison has one mark on its own and one in the family of all comparisons of the claim's primary
checks (`verdicts` explains the procedure). If all have to hold, every mark on its own must be + to
support the claim; everything else follows from the family's marks:

| verdict | all have to hold | any may hold |
| --- | --- | --- |
| supported | every mark + on its own | at least one + |
| partly | + in some but not all; if there is no - and no 0, in at least three quarters | |
| contradicted | no +, and a - | every mark - on its own |
| no effect | every mark 0 | no + and no ?, not all - |
| undecided | otherwise: a ? prevents a verdict, or most marks are ? | a ? prevents a verdict |
| depends | on the chance of one experiment, which our runs tell | |
| untestable | the reason is given | likewise |

If all have to hold together, as one sentence (`holds: together`): supported if every mark is + on
its own; contradicted by one - in the family, or by a 0 beside a +; no effect with a 0 and neither;
otherwise undecided.

A sentence about seconds is judged on counted work if its check names one (`work`); the seconds are
reported next to it. If it names none, the seconds decide:
the planners are then of different kinds, whose evaluations are different things.

`analysis.columns` describes the columns of the two tables: claims.csv, one row per claim and
variant, and claim_checks.csv, one row per comparison.
"""

import json
import math

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics
from bezierplan.analysis.claims import comparisons, sentences, verdicts
from bezierplan.analysis.claims.check import ClaimCheck, OfRuns
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.effects import Contrast, Finding, MarkedComparison
from bezierplan.analysis.claims.material import Material, Untestable
from bezierplan.analysis.claims.variants import (
    apply_variant,
    list_variants,
    name_variant,
    split_work,
)
from bezierplan.analysis.columns import COLUMNS_OF


def judge_claims(material: Material) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Judge the claims of a study; return the tables `claims` and
    `claim_checks`.

    All random draws are seeded by names, and nothing depends on the order of the runs. Raises Fault
    for a claim that mixes runs of several conditions or names an unknown function.
    """
    claim_rows, check_rows = [], []
    for claim in material.study.claims:
        # The first assignment is the primary variant.
        first, *_ = assignments = list_variants(claim)
        for assignment in assignments:
            row, details = _judge_variant(claim, first, assignment, material)
            claim_rows.append(row | {"primary": assignment is first})
            check_rows += details
    # Int64, because a column of whole numbers with gaps would be written as decimals.
    claims = pd.DataFrame(claim_rows, columns=COLUMNS_OF["claims"]).astype({"n": "Int64"})
    checks = pd.DataFrame(check_rows, columns=COLUMNS_OF["claim_checks"])
    return claims, checks.astype({"together": "Int64", "conditions": "Int64"})


# From comparisons to a verdict.


def _judge_variant(
    claim: Claim, first: dict, assignment: dict, material: Material
) -> tuple[dict, list[dict]]:
    """Judge one variant of a claim; return its row of claims.csv and its rows of
    claim_checks.csv.
    """
    # `rest` means the same as in the primary variant, so it is filled in before values are
    # substituted.
    checks = [comparisons.fill_rest(check, claim, material) for check in claim.checks]
    checks = apply_variant(checks, first, assignment)
    key = {"study": material.study.name, "id": claim.id, "variant": name_variant(assignment)}
    judgements, obstacle = _judge_checks(checks, claim, "/".join(key.values()), material)
    deciding = [entry for entry in judgements if entry.primary]
    decisive = None if obstacle else _select_decisive(deciding, claim.holds)
    held = [held for _, held in map(_judge_printed, deciding) if held is not None]
    row = key | {
        "place": claim.place,
        "statement": claim.statement,
        "artefact": ", ".join(claim.artefacts),
        "finding": bool(claim.finding),
        "main": bool(claim.main),
        "timed": any(split_work(check)[0].timed for check in checks if check.primary),
        "published": f"{sum(held)} of {len(held)}" if held else "not printed",
    }
    if decisive:
        row |= _describe_verdict(claim, deciding, decisive)
    else:
        row |= {"verdict": "untestable", "reason": obstacle}
    rows = [
        _build_check_row(entry, material) | key | {"decisive": entry is decisive}
        for entry in judgements
    ]
    if decisive and assignment is first:
        primary = [each for each in rows if each["primary"]]
        row["where_it_holds"] = sentences.describe_where(primary, checks, material.study.labels)
    return row, rows


def _describe_verdict(
    claim: Claim, deciding: list[MarkedComparison], decisive: MarkedComparison
) -> dict:
    """Reach the verdict on a claim from its comparisons; return the fields of its row that follow
    from it.

    deciding: the primary comparisons. decisive: the one whose effect is shown.
    """
    verdict = verdicts.judge_marks(
        [entry.mark for entry in deciding], [entry.mark_family for entry in deciding], claim.holds
    )
    # Our runs are enough: what stays open is the chance of one experiment.
    if verdict == "undecided" and all(
        entry.finding.chance_known for entry in deciding if entry.mark_family == "?"
    ):
        verdict = "depends"
    criterion = sentences.note_own_criterion(claim, verdict)
    return decisive.finding._asdict() | {
        "verdict": verdict,
        "holds": f"{sum(entry.mark == '+' for entry in deciding)} of {len(deciding)}",
        "counted": decisive.comparison.counted,
        "p_family": decisive.p_family,
        "reason": sentences.join_notes(criterion, _write_reason(decisive), claim.note),
    }


def _judge_checks(
    checks: list[ClaimCheck], claim: Claim, name: str, material: Material
) -> tuple[list[MarkedComparison], str]:
    """Judge all checks of a claim; return their comparisons with marks, and the reason why a
    primary check cannot be tested (empty if all can).
    """
    judgements, obstacle = [], ""
    for number, written in enumerate(checks, start=1):
        for check in split_work(written):
            try:
                judgements += _judge_check(number, check, claim, name, material)
            except Untestable as reason:
                # Only a primary check that cannot be tested leaves the claim without a verdict.
                if check.primary:
                    obstacle = obstacle or str(reason)
                else:
                    nothing = Finding(reason=str(reason))
                    judgements.append(MarkedComparison(number, check, False, Contrast(), nothing))
    return _mark_comparisons(judgements), obstacle


def _judge_check(
    number: int, check: ClaimCheck, claim: Claim, name: str, material: Material
) -> list[MarkedComparison]:
    """Judge the comparisons of one check; return them with their findings. Raises Untestable."""
    if not isinstance(check, OfRuns):
        judged = [(Contrast(terms), finding) for terms, finding in check.judge(claim, material)]
    elif check.timed and not check.relative:
        raise Untestable("absolute seconds say nothing about another machine")
    else:
        judged = [
            (each, check.find(each, f"{name}/{number}/{each.terms.name}"))
            for each in comparisons.build_comparisons(check, claim, material)
        ]
    entries = [
        MarkedComparison(number, check, check.primary, compared, finding)
        for compared, finding in judged
    ]
    return _combine_places(entries) if check.together else entries


def _combine_places(findings: list[MarkedComparison]) -> list[MarkedComparison]:
    """Combine the comparisons of each place into one, followed by themselves as secondary ones."""
    by_place: dict[tuple, list[MarkedComparison]] = {}
    for each in findings:
        by_place.setdefault(each.comparison.place, []).append(each)
    judged = []
    for own in by_place.values():
        finding, decisive = verdicts.combine_findings([each.finding for each in own])
        parts = tuple(each.comparison for each in own)
        whole = own[decisive]._replace(finding=finding, parts=parts)
        judged += [whole, *(each._replace(primary=False) for each in own)]
    return judged


def _mark_comparisons(findings: list[MarkedComparison]) -> list[MarkedComparison]:
    """Mark each comparison by its own p, the primary ones also by their p in the family."""
    p = np.array([entry.finding.p if entry.primary else math.nan for entry in findings])
    in_family = np.full(len(p), math.nan)
    # Marks of comparisons without p do not follow from p, so these are not in the family.
    in_family[~np.isnan(p)] = verdicts.compute_family_p(p[~np.isnan(p)])
    return [
        entry._replace(
            mark=verdicts.choose_mark(entry.finding, entry.finding.p),
            mark_family=verdicts.choose_mark(entry.finding, p_family) if entry.primary else "",
            p_family=p_family,
        )
        for entry, p_family in zip(findings, in_family.tolist())
    ]


def _select_decisive(deciding: list[MarkedComparison], holds: str) -> MarkedComparison:
    """Select the decisive comparison.

    If all have to hold, it is the worst - by effect (of the first check that has one), otherwise
    the one with the largest p, preceded by any without p that is not +. If any may hold, it is the
    one with the smallest p, among those with a + if there are any.
    """

    def find_p(entry: MarkedComparison) -> float:
        """Return p by which comparisons are ordered; without p, more than any if not +,
        else less.
        """
        if math.isnan(entry.finding.p):
            return -1.0 if entry.mark == "+" else 2.0
        return entry.finding.p

    if holds == "any":
        return min(
            [entry for entry in deciding if entry.mark_family == "+"] or deciding, key=find_p
        )
    against = [entry for entry in deciding if entry.mark_family == "-"]
    if not against:
        return max(deciding, key=find_p)
    # Effects of different checks may have different units.
    first = [entry for entry in against if entry.number == against[0].number]
    return max(
        first,
        key=lambda entry: np.nan_to_num(abs(entry.finding.effect - entry.check.target), nan=np.inf),
    )


# The printed numbers, and experiments of the paper's size.


def _judge_printed(entry: MarkedComparison) -> tuple[float, bool | None]:
    """Compute the effect in the printed numbers, and judge whether the sentence holds in them; None
    if they are not printed.
    """
    parts = entry.parts or (entry.comparison,)
    if any(np.isnan(part.printed).any() for part in parts):
        return math.nan, None
    printed = [entry.check.compute_effect(part.printed, part.cells) for part in parts]
    held = all(entry.check.is_as_claimed(effect, entry.finding.margin) for effect in printed)
    shown = entry.comparison
    return float(entry.check.compute_effect(shown.printed, shown.cells)), held


# Rows.


def _write_reason(each: MarkedComparison) -> str:
    """Write the notes for the reader of a row: the reason for the mark, and the note on the
    comparison.
    """
    unexplained = "too few units to tell" if each.mark == "?" else ""
    return sentences.join_notes(each.finding.reason or unexplained, each.comparison.note)


def _build_check_row(entry: MarkedComparison, material: Material) -> dict:
    """Build a row of claim_checks.csv, whose columns leave out the rest of what is known."""
    check, compared = entry.check, entry.comparison
    effect_published, agrees = _judge_printed(entry)
    return (
        entry.finding._asdict()
        | entry._asdict()
        | compared.terms._asdict()
        | {
            "check": entry.number,
            "test": check.test,
            "experiments": ", ".join(check.experiments),
            "metric": check.metric,
            # A kind without a choice of statistics has none to show.
            "statistic": (check.statistic or "rank")
            if "statistic" in type(check).model_fields
            else "",
            "unit": _find_unit(check, material),
            "scale": check.scale,
            "together": len(entry.parts) or None,
            # JSON knows no numbers of numpy.
            "place": json.dumps(dict(compared.place), default=np.generic.item),
            "conditions": compared.conditions,
            "counted": compared.counted,
            "effect_published": effect_published,
            "published": {True: "holds", False: "fails", None: "not printed"}[agrees],
            "timed": check.timed,
            "reason": _write_reason(entry),
        }
    )


def _find_unit(check: ClaimCheck, material: Material) -> str:
    """Find the unit of a check's metric, or of the effect of a function; empty if neither
    is known.
    """
    if check.effect_unit:
        return check.effect_unit
    known = [material.results[name] for name in check.experiments if name in material.results]
    # All problems share one unit of length.
    problem = next((problem for each in known for problem in each.problems.values()), None)
    return metrics.find_unit(check.metric, problem.workspace.unit) if problem else ""
