"""From the comparisons of a claim to marks, to one verdict, and to words that say where the claim
holds.

A comparison has two marks, one from its own p and one from its p within the family: all comparisons
of a claim's primary checks in one variant. The procedure is a standard one at each step:

- All comparisons have to hold: the sentence is supported if every comparison is `+` on its own.
  This is an intersection-union test, which needs no correction (Berger 1982, Technometrics 24,
  295). Everything else uses the p of the family.
- All together: as above, but the sentence is one, such as that Singer is the best of eight maps. It
  is contradicted by one comparison that is `-` in the family, or one that is `0` beside others that
  are `+`; without either and with a `0`, there is no effect.
- Any comparison may hold: the sentence is supported if one is `+` in the family, and contradicted
  if every one is `-` on its own.
- The family is corrected by Benjamini and Hochberg (1995, J. R. Stat. Soc. B 57, 289). It finds
  something exactly when Simes' global test rejects "no effect anywhere" (1986, Biometrika 73, 751),
  so at most 5 % of sentences without any effect get a mark other than `0` and `?`. Comparisons that
  share a method are positively dependent, which the procedure allows (Benjamini and Yekutieli 2001,
  Ann. Stat. 29, 1165). The least p of ten pairs is 0.002: Holm's correction over 30 comparisons can
  never bring it below 0.05; this one can.
- In addition to p, a `+` or `-` needs an effect as large as the margin (Goodman, Spruill and
  Komaroff 2019, Am. Stat. 73, 168).
- Comparisons that a check takes together are one comparison in the family: `+` by the
  intersection-union test, `-` by Bonferroni within it (`combine_findings`).
- A `0` needs an interval within the margin (two one-sided tests, Schuirmann 1987, J. Pharmacokinet.
  Biopharm. 15, 657).
"""

import math
from collections.abc import Sequence

import numpy as np

from bezierplan.analysis.claims.effects import ALPHA, Finding

# Least share of all comparisons that must be decided; if no decided one speaks against the claim,
# the least share that must hold.
DECIDED, HOLDING = 0.5, 0.75


def compute_family_p(p: np.ndarray) -> np.ndarray:
    """Correct the p (n,) of a family by Benjamini and Hochberg's step-up procedure: (n,)."""
    from scipy import stats

    return stats.false_discovery_control(p)


def choose_mark(finding: Finding, p: float) -> str:
    """Choose the mark of a comparison by its own p or that of its family."""
    if finding.mark:
        return finding.mark
    if finding.toward and p < ALPHA:
        return "+" if finding.toward > 0 else "-"
    return "0" if finding.negligible else "?"


def combine_findings(findings: Sequence[Finding]) -> tuple[Finding, int]:
    """Combine findings (at least one) into one that they all hold together; return it and the
    number of the decisive one, whose effect it has.

    It holds as surely as the least sure of them (intersection-union), and fails if the surest
    contrary one does, corrected by Bonferroni for their number. It is negligible if one of them is,
    since the sentence asks for a difference in each.
    """
    tested = [_set_p_by_mark(each) for each in findings]
    against = [number for number, each in enumerate(tested) if each.toward < 0]
    # A finding without p is less sure than one with any p.
    order = {number: 2.0 if math.isnan(each.p) else each.p for number, each in enumerate(tested)}
    if against:
        decisive = min(against, key=order.__getitem__)
        # Bonferroni, because the surest of several was chosen.
        p, toward = min(1.0, len(tested) * tested[decisive].p), -1
    else:
        open_ones = [number for number, each in enumerate(tested) if not each.toward] or list(order)
        # A negligible one comes first, since the sentence asks for a difference in each.
        decisive = max(open_ones, key=lambda number: (tested[number].negligible, order[number]))
        p, toward = tested[decisive].p, min(each.toward for each in tested)
    negligible = any(each.negligible and not each.toward for each in tested)
    return findings[decisive]._replace(mark="", p=p, toward=toward, negligible=negligible), decisive


def _set_p_by_mark(finding: Finding) -> Finding:
    """Set p and side of a finding with a mark of its own; return any other unchanged."""
    if not finding.mark:
        return finding
    toward = {"+": 1, "-": -1}.get(finding.mark, 0)
    p = 1.0 if finding.mark == "?" else 0.0
    return finding._replace(toward=toward, p=p, negligible=finding.mark == "0")


def judge_marks(alone: Sequence[str], together: Sequence[str], holds: str) -> str:
    """Judge a claim by the marks of its comparisons (at least one) alone and in the family.

    holds: whether `all` comparisons have to hold, `any`, or all `together` as one sentence.
    """
    marks = set(together)
    if set(alone) == {"+"} or (holds == "any" and "+" in marks):
        return "supported"
    if holds == "together":
        # It fails as soon as one comparison does: the best of eight is better than each other one.
        if "-" in marks or marks >= {"0", "+"}:
            return "contradicted"
        return "no effect" if "0" in marks else "undecided"
    if "+" in marks:
        return _judge_partly(together)
    fails = set(alone) == {"-"} if holds == "any" else "-" in marks
    if fails:
        return "contradicted"
    return "undecided" if "?" in marks else "no effect"


def _judge_partly(marks: Sequence[str]) -> str:
    """Judge a claim of which some comparisons hold: partly, or undecided if too many are open."""
    decided = [mark for mark in marks if mark != "?"]
    # Where all that is decided holds, the open comparisons may all hold as well: `partly` says that
    # some do not.
    least = HOLDING if set(decided) == {"+"} else DECIDED
    return "partly" if len(decided) >= least * len(marks) else "undecided"
