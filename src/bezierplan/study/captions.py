"""The captions of a study's tables and figures. Verdicts are those that docs/outcome keeps, if its
settings are those of the study.
"""

import csv
import hashlib

from bezierplan.analysis.claims.claim import Claim
from bezierplan.figures.caption import (
    MOST_FINDINGS,
    Caption,
    CaptionClaim,
    describe_verdict,
    describe_verdicts,
)
from bezierplan.machine.digest import compute_content_digest
from bezierplan.places import STUDIES, TREE
from bezierplan.study.definition import Study
from bezierplan.study.runs_behind import count_runs, find_runs_behind

Rows = list[dict[str, str]]

OUTCOME = TREE / "docs" / "outcome"
_LONG = 80
"""Characters of a value that stand where settings are compared."""
_KEPT: dict[int, tuple[Study, list[str], Rows, Rows]] = {}
"""By id of a study: the study, which keeps its id, its changes, claims and numbers."""


def build_caption(study: Study, artefact: str, scale: str) -> Caption:
    """The caption of a table or figure. The page has the methods' settings, and all claims."""
    _, _, claims, numbers = _read_kept(study)
    rows = {row["id"]: row for row in claims}
    about = [
        claim
        for claim in study.claims
        if artefact in claim.artefacts and (claim.id in rows or claim.scale in (None, scale))
    ]
    about.sort(key=lambda claim: (_is_untestable(claim), bool(claim.finding)))
    findings = [
        CaptionClaim(
            claim.id,
            claim.statement.removesuffix("."),
            _tell(study, claim, rows.get(claim.id), scale),
        )
        for claim in about[:MOST_FINDINGS]
    ]
    remark = ""
    if artefact in study.layout and not about:
        remark = f"In the paper: {study.layout[artefact].says}"
    elif scale == "full" and artefact in study.find_tables_of_runs():
        remark = _tell_means(study, artefact, numbers)
    behind = find_runs_behind(study, artefact, scale)
    return Caption(study.artefact(artefact).title, findings, remark, behind)


def _is_untestable(claim: Claim) -> bool:
    return any(check.test == "untestable" for check in claim.checks)


def _tell(study: Study, claim: Claim, outcome: dict[str, str] | None, scale: str) -> str:
    """The verdict in words, as far as it is known before the runs."""
    if _is_untestable(claim):
        return describe_verdict("untestable", 0)
    if not outcome:
        return ""
    verdict, own = outcome["verdict"], outcome["verdict_papers_size"]
    many, few = (_count_runs(study, claim, each) for each in ("extended", "full"))
    # Some functions look at no run; what they say does not depend on their number.
    if verdict == own and all(check.test == "function" for check in claim.checks):
        many = 0
    return describe_verdicts(verdict, many, own if scale == "full" else "", few)


def _count_runs(study: Study, claim: Claim, scale: str) -> int:
    """The runs of each method that a claim is judged on, in the experiment with the most."""
    experiments = (name for each in claim.checks if each.primary for name in each.experiments)
    return max((count_runs(study, name, scale) for name in experiments), default=0)


def _tell_means(study: Study, table: str, numbers: Rows) -> str:
    """How many runs the means of a table are of, if some leave out runs without a free path."""
    every = count_runs(study, study.find_tables_of_runs()[table].experiment, "full")
    means = (row for row in numbers if row["table"] == table and row["statistic"] == "mean")
    least = min((int(row["n_ours"]) for row in means), default=every)
    left_out = f"Means leave out runs without a free path: at least {least} of {every} remain"
    return left_out if least < every else ""


def list_changes(study: Study) -> list[str]:
    """Return which settings of a study of this project are not those of docs/outcome, in words."""
    return _read_kept(study)[1]


def is_of_project(study: Study) -> bool:
    """Return whether a study lies where those of this project do."""
    return study.folder.resolve().is_relative_to(STUDIES)


def _read_kept(study: Study) -> tuple[Study, list[str], Rows, Rows]:
    """What docs/outcome keeps of a study, read once; rows only if no setting has changed."""
    if id(study) not in _KEPT:
        changes = _compare_settings(study)
        parts = (
            [] if changes else _read(study, name) for name in ("claims", "numbers_papers_size")
        )
        claims, numbers = ([row for row in rows if row["primary"] == "True"] for rows in parts)
        _KEPT[id(study)] = study, changes, claims, numbers
    return _KEPT[id(study)]


def _read(study: Study, name: str) -> Rows:
    """The rows of a study of this project in a table of docs/outcome, if there is one."""
    file = OUTCOME / f"{name}.csv"
    if not (is_of_project(study) and file.is_file()):
        return []
    with file.open(encoding="utf-8", newline="") as rows:
        return [row for row in csv.DictReader(rows) if row["study"] == study.key]


def _compare_settings(study: Study) -> list[str]:
    """Which settings are not those of docs/outcome; none if it keeps none."""
    before = {(row["of"], row["setting"]): row["value"] for row in _read(study, "settings")}
    now = {(of, name): value for of, name, value in list_settings(study)} if before else {}
    return [
        f"{name} of {of} is {now.get((of, name), 'absent')}, in the README's outcome "
        f"{before.get((of, name), 'absent')}"
        for of, name in now | before
        if now.get((of, name)) != before.get((of, name))
    ]


def list_settings(study: Study) -> list[tuple[str, str, str]]:
    """All that a study sets, of a method or of what `kind name` says: that, setting and value."""
    settings = {method: study.resolve_settings(method) for method in study.methods}
    for name, workspace in study.workspaces.items():
        maps = study.maps([name])
        content = {"content of the map": compute_content_digest(*maps)} if maps else {}
        settings[f"workspace {name}"] = workspace.plain() | content
    for name, problem in study.problems.items():
        settings[f"problem {name}"] = problem.plain()
    for name, experiment in study.experiments.items():
        settings[f"experiment {name}"] = experiment.plain("chunk", "time_limit")
    settings |= {f"policy {name}": policy.plain() for name, policy in study.policies.items()}
    settings["presets"] = study.presets
    return [
        (owner, setting, _shorten(str(value)))
        for owner, own in settings.items()
        for setting, value in own.items()
    ]


def _shorten(text: str) -> str:
    """A text, of a long one a digest."""
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    return text if len(text) <= _LONG else f"{text[:_LONG]}... ({digest})"
