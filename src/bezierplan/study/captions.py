"""The captions of a study's tables and figures. Verdicts are those that docs/outcome keeps, if its
settings are those of the study.
"""

from bezierplan.analysis.claims.claim import Claim
from bezierplan.figures.caption import (
    MOST_FINDINGS,
    Caption,
    CaptionClaim,
    describe_verdict,
    describe_verdicts,
)
from bezierplan.study.definition import Study
from bezierplan.study.evidence import read_kept
from bezierplan.study.runs_behind import count_experiment_runs, describe_runs_behind


def build_caption(study: Study, artefact: str, scale: str) -> Caption:
    """Build the caption of a table or figure; the page has settings and all claims."""
    rows = {row["id"]: row for row in read_kept(study, "claims") if row["primary"] == "True"}
    about = [
        claim
        for claim in study.claims
        if artefact in claim.artefacts and (claim.id in rows or claim.scale in (None, scale))
    ]
    # Only the first of them are printed: sentences of the paper that can be tested go first.
    about.sort(key=lambda claim: (_is_untestable(claim), bool(claim.finding)))
    findings = [
        CaptionClaim(
            claim.id,
            claim.statement.removesuffix("."),
            _describe_claim(study, claim, rows.get(claim.id), scale),
        )
        for claim in about[:MOST_FINDINGS]
    ]
    remark = ""
    if artefact in study.layout and not about:
        remark = f"In the paper: {study.layout[artefact].says}"
    elif scale == "full" and artefact in study.find_tables_of_runs():
        remark = _describe_means(study, artefact)
    behind = describe_runs_behind(study, artefact, scale)
    return Caption(study.artefact(artefact).title, findings, remark, behind)


def _is_untestable(claim: Claim) -> bool:
    """Return whether a check of the claim is of kind `untestable`."""
    return any(check.test == "untestable" for check in claim.checks)


def _describe_claim(study: Study, claim: Claim, row: dict[str, str] | None, scale: str) -> str:
    """Describe the verdict that docs/outcome keeps for a claim (`row`); empty without a row, unless
    the claim is untestable.
    """
    if _is_untestable(claim):
        return describe_verdict("untestable", 0)
    if not row:
        return ""
    verdict, own = row["verdict"], row["verdict_papers_size"]
    many, few = (_count_runs(study, claim, each) for each in ("extended", "full"))
    # Some functions look at no run, so their number says nothing.
    if verdict == own and all(check.test == "function" for check in claim.checks):
        many = 0
    return describe_verdicts(verdict, many, own if scale == "full" else "", few)


def _count_runs(study: Study, claim: Claim, scale: str) -> int:
    """Return on how many runs of each method a claim is judged, in its experiment with the most."""
    experiments = (name for each in claim.checks if each.primary for name in each.experiments)
    return max((count_experiment_runs(study, name, scale) for name in experiments), default=0)


def _describe_means(study: Study, table: str) -> str:
    """Say of how many runs the means of a table are, if some leave out runs without a free path."""
    every = count_experiment_runs(study, study.find_tables_of_runs()[table].experiment, "full")
    means = (
        int(row["n_ours"])
        for row in read_kept(study, "numbers_papers_size")
        if row["table"] == table and row["statistic"] == "mean"
    )
    least = min(means, default=every)
    left_out = f"Means leave out runs without a free path: at least {least} of {every} remain"
    return left_out if least < every else ""
