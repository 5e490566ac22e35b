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
reported next to it, and the reason says where they disagree. Without one, the seconds decide:
between planners of different kinds, whose evaluations are different things.

`columns` describes the columns of the two tables: claims.csv, one row per claim and variant, and
claim_checks.csv, one row per comparison.
"""

import json
import math

import numpy as np
import pandas as pd

from bezierplan.analysis.claims import comparisons, effects, sentences, verdicts
from bezierplan.analysis.claims.check import ClaimCheck, OfRuns
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.columns import CHECK_COLUMNS, CLAIM_COLUMNS
from bezierplan.analysis.claims.effects import Comparison, Finding, MarkedComparison, Terms
from bezierplan.analysis.claims.kinds import kind_of
from bezierplan.analysis.claims.material import Material, Untestable
from bezierplan.analysis.claims.variants import in_variant, name_of, variants, with_work


def judge(material: Material) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The claims of a study as tables with `CLAIM_COLUMNS` and `CHECK_COLUMNS`.

    All random draws are seeded by names, and nothing depends on the order of the runs. Raises Fault
    for a claim that mixes runs of several conditions or names an unknown function.
    """
    claim_rows, check_rows = [], []
    for claim in material.study.claims:
        first, *_ = assignments = variants(claim)
        for assignment in assignments:
            row, details = _judge_variant(claim, first, assignment, material)
            claim_rows.append(row | {"primary": assignment is first})
            check_rows += details
    claims = pd.DataFrame(claim_rows, columns=CLAIM_COLUMNS).astype({"n": "Int64"})
    checks = pd.DataFrame(check_rows, columns=CHECK_COLUMNS)
    return claims, checks.astype({"together": "Int64"})


# From comparisons to a verdict.


def _judge_variant(
    claim: Claim, first: dict, assignment: dict, material: Material
) -> tuple[dict, list[dict]]:
    """The row of claims.csv, and those of claim_checks.csv, of one variant of a claim."""
    variant = name_of(assignment)
    holds = claim.holds
    name = f"{material.study.name}/{claim.id}/{variant}"
    # `rest` means the same as in the primary variant, so it is filled in before values are
    # substituted.
    checks = [comparisons.with_rest(check, claim, material) for check in claim.checks]
    checks = in_variant(checks, first, assignment)
    content = {
        **{key: getattr(claim, key) for key in ("id", "place", "statement")},
        "study": material.study.name,
        "variant": variant,
        "artefact": ", ".join(claim.artefacts),
        "finding": bool(claim.finding),
        "main": bool(claim.main),
        "own_criterion": claim.criterion is not None,
        "timed": any(
            comparisons.is_timed(check)
            for check in checks
            if check.primary and len(with_work(check)) == 1
        ),
    }
    judgements, obstacle = [], ""
    for number, check in [
        (number, each) for number, given in enumerate(checks, start=1) for each in with_work(given)
    ]:
        try:
            judgements += _findings(number, check, claim, name, material)
        except Untestable as reason:
            if not check.primary:
                judgements.append(
                    MarkedComparison(
                        number, check, False, (), Terms(), None, Finding(reason=str(reason))
                    )
                )
            else:
                obstacle = obstacle or str(reason)
    judgements = _marked(judgements)
    deciding = [each for each in judgements if each.primary]
    decisive = None if obstacle else _shown(deciding, holds)
    named = {key: content[key] for key in ("study", "id", "variant")}
    rows = [
        _check_row(each, material) | named | {"decisive": each is decisive} for each in judgements
    ]
    if decisive is None:
        return content | {
            "verdict": "untestable",
            "published": _published(deciding),
            "reason": obstacle,
        }, rows
    finding = decisive.finding
    verdict = verdicts.verdict(
        [each.mark for each in deciding], [each.mark_family for each in deciding], holds
    )
    if verdict == "undecided" and all(
        each.finding.chance_known for each in deciding if each.mark_family == "?"
    ):
        verdict = "depends"
    everywhere = verdict == "supported" and holds != "any"
    unit = _unit(deciding[0].check, material)
    reasons = [
        sentences.by_own_criterion(claim, verdict),
        sentences.less_than(deciding, verdict, unit),
        _reason(decisive),
        sentences.disagreement(judgements),
        claim.note or "",
    ]
    summary = finding._asdict() | {
        "verdict": verdict,
        "holds": f"{sum(each.mark == '+' for each in deciding)} of {len(deciding)}",
        "where_it_holds": ""
        if everywhere
        else sentences.where_it_holds(judgements, material.study.labels),
        "published": _published(deciding),
        "low95": finding.low,
        "high95": finding.high,
        "counted": decisive.comparison.counted if decisive.comparison else "",
        "p_family": decisive.p_family,
        "reason": "; ".join(filter(None, reasons)),
    }
    return content | summary, rows


def _findings(
    number: int, check: ClaimCheck, claim: Claim, name: str, material: Material
) -> list[MarkedComparison]:
    """The comparisons of one check with their findings. Raises Untestable."""
    primary, kind = check.primary, kind_of(check)
    judged: list[tuple[Terms, Comparison | None, Finding]]
    if not isinstance(check, OfRuns):
        judged = [
            (terms, None, finding) for terms, finding in kind.findings(check, claim, material)
        ]
    elif comparisons.is_timed(check) and not check.relative:
        raise Untestable("absolute seconds say nothing about another machine")
    else:
        judged = [
            (each.terms, each, kind.find(check, each, f"{name}/{number}/{each.terms.name}"))
            for each in comparisons.comparisons(check, claim, material)
        ]
    found = []
    for terms, compared, finding in judged:
        place = compared.place if compared else ()
        finding = verdicts.among(finding, check, material.among)
        found.append(MarkedComparison(number, check, primary, place, terms, compared, finding))
    return _together(found) if check.together else found


def _together(findings: list[MarkedComparison]) -> list[MarkedComparison]:
    """The comparisons of each place as one, followed by themselves as secondary ones."""
    places = dict.fromkeys(each.place for each in findings)
    judged = []
    for own in ([each for each in findings if each.place == place] for place in places):
        finding, decisive = verdicts.conjunction([each.finding for each in own])
        parts = tuple(each.comparison for each in own)
        whole = own[decisive]._replace(finding=finding, parts=parts)
        judged += [whole, *(each._replace(primary=False) for each in own)]
    return judged


def _marked(findings: list[MarkedComparison]) -> list[MarkedComparison]:
    """The comparisons with their marks, the primary ones also with their marks in the family."""
    tested = [
        number
        for number, each in enumerate(findings)
        if each.primary and not math.isnan(each.finding.p)
    ]
    corrected = dict(
        zip(tested, verdicts.family(np.array([findings[number].finding.p for number in tested])))
    )
    marked = []
    for number, each in enumerate(findings):
        p_family = corrected.get(number, math.nan)
        together = verdicts.mark(each.finding, p_family) if each.primary else ""
        marked.append(
            each._replace(
                mark=verdicts.mark(each.finding, each.finding.p),
                mark_family=together,
                p_family=p_family,
            )
        )
    return marked


def _shown(deciding: list[MarkedComparison], holds: str) -> MarkedComparison:
    """The decisive comparison.

    If all have to hold, the worst - by effect (of the first check that has one), otherwise that
    with the largest p, preceded by any without p that is not +. If any may hold, that with the
    smallest p, among those with a + if there are any.
    """

    def p(each: MarkedComparison) -> float:
        return (
            each.finding.p if not math.isnan(each.finding.p) else -1.0 if each.mark == "+" else 2.0
        )

    if holds == "any":
        return min([each for each in deciding if each.mark_family == "+"] or deciding, key=p)
    against = [each for each in deciding if each.mark_family == "-"]
    if against:
        first = [each for each in against if each.number == against[0].number]
        return max(
            first,
            key=lambda each: np.nan_to_num(
                abs(each.finding.effect - each.check.target), nan=np.inf
            ),
        )
    return max(deciding, key=p)


# The printed numbers, and experiments of the paper's size.


def _printed(entry: MarkedComparison) -> tuple[float, bool | None]:
    """The effect in the printed numbers, and whether the sentence holds in them; None if they are
    not printed.
    """
    parts = entry.parts or (entry.comparison,)
    if None in parts or any(np.isnan(part.printed).any() for part in parts):
        return math.nan, None
    printed = [effects.effect(entry.check, part.printed, part.cells) for part in parts]
    held = all(
        bool(effects.claimed(entry.check, effect, entry.finding.margin)) for effect in printed
    )
    return float(
        effects.effect(entry.check, entry.comparison.printed, entry.comparison.cells)
    ), held


def _published(deciding: list[MarkedComparison]) -> str:
    held = [held for _, held in map(_printed, deciding) if held is not None]
    return f"{sum(held)} of {len(held)}" if held else "not printed"


# Rows.


def _reason(each: MarkedComparison) -> str:
    """Notes for the reader of a row."""
    unexplained = "too few units to tell" if each.mark == "?" else ""
    note = each.comparison.note if each.comparison else ""
    return "; ".join(filter(None, [each.finding.reason or unexplained, note]))


def _check_row(entry: MarkedComparison, material: Material) -> dict:
    """A row of claim_checks.csv, whose columns leave out the rest of the finding."""
    check, finding = entry.check, entry.finding
    effect_published, agrees = _printed(entry)
    return finding._asdict() | {
        "check": entry.number,
        "primary": entry.primary,
        "test": check.test,
        "experiments": ", ".join(check.experiments),
        "metric": check.metric,
        "statistic": check.statistic_shown,
        "unit": _unit(check, material),
        **entry.terms._asdict(),
        "together": len(entry.parts) or None,
        "place": json.dumps(
            {key: getattr(at, "item", lambda at=at: at)() for key, at in entry.place}
        ),
        "mark": entry.mark,
        "mark_family": entry.mark_family,
        "counted": entry.comparison.counted if entry.comparison else "",
        "low95": finding.low,
        "high95": finding.high,
        "p_family": entry.p_family,
        "effect_published": effect_published,
        "published": {True: "holds", False: "fails", None: "not printed"}[agrees],
        "timed": comparisons.is_timed(check),
        "reason": _reason(entry),
    }


def _unit(check: ClaimCheck, material: Material) -> str:
    """The unit of a check's metric, or of the effect of a function; empty if neither is known."""
    if check.effect_unit:
        return check.effect_unit
    experiments = [name for name in check.experiments if name in material.results]
    return comparisons.unit_of(check.metric, experiments, material) if experiments else ""
