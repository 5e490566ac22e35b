"""What a paper leaves open: a study under other values of its assumptions is a study again, so that
all jobs can be made of it.
"""

import itertools
import math
import re
from collections.abc import Iterable
from typing import Any

from bezierplan.analysis import metrics
from bezierplan.analysis.claims.check import ClaimCheck
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.variants import in_variant, variants, with_work
from bezierplan.figures.panels.alternatives import FEW
from bezierplan.schema.model import convert_to_list
from bezierplan.study.claims import AssumptionEntry, ReadingEntry
from bezierplan.study.definition import Study
from bezierplan.study.experiments import Experiment

DEFAULT = "default"

MOST_REPEATS = 1000
"""Repeats of a method under each condition with which readings are judged, at most."""


def find_default(study: Study, assumption: AssumptionEntry) -> Any:
    """Return the value that runs use where an assumption leaves it to a setting: one for the
    methods without a value of their own, or each of those that it names.
    """
    setting, methods = assumption.setting, study.list_governed_methods(assumption)
    if setting is None:
        return assumption.default
    used = {}
    for name in methods:
        settings = [study.problems[problem].settings for problem in assumption.problems]
        values = [each[setting] for each in settings if setting in each]
        open_there = values and setting not in study.methods[name].settings
        used[name] = values[0] if open_there else study.resolve_settings(name)[setting]
    shared = [used[name] for name in methods if setting not in study.methods[name].settings]
    return used if assumption.methods else next(iter([*shared, *used.values()]), None)


def apply_values(study: Study, values: dict[str, Any]) -> Study:
    """Return the study with other values of some assumptions, by id. On a map that they change, no
    best known path counts.
    """
    workspaces, problems = dict(study.workspaces), dict(study.problems)
    for assumption in study.assumptions:
        if assumption.id in values:
            for name, key in assumption.workspace.items():
                plain = workspaces[name].plain() | {key: values[assumption.id]}
                workspaces[name] = type(workspaces[name]).model_validate(plain)
    for name, problem in study.problems.items():
        home = problem.workspace
        if problem.reference and workspaces[home] is not study.workspaces[home]:
            problems[name] = problem.but(reference=math.nan)
    return study.but(values=values, workspaces=workspaces, problems=problems)


def describe_values(study: Study, values: dict[str, Any]) -> str:
    """Return what some values of assumptions change, in words."""
    details = {each.id: each.detail for each in study.assumptions}
    return "; ".join(f"{details[name]}: {value}" for name, value in values.items())


# --------------------------------------------------------------------------------------------------
# Claims under readings


def is_judged(claim: Claim) -> bool:
    """Return whether a reading can turn a claim: its primary checks rest on runs, not on times."""
    primary = [with_work(check)[0] for check in claim.checks if check.primary]
    return all(check.experiments and not check.timed for check in primary)


def select_claims(study: Study, reading: ReadingEntry) -> list[Claim]:
    """Return the claims that are judged under a reading."""
    return [
        claim
        for claim in study.claims
        if (claim.id in reading.claims if reading.claims else claim.main) and is_judged(claim)
    ]


def build_joint_readings(study: Study) -> dict[str, Study]:
    """Return the study under each joint reading, with the claims that are judged under it, by the
    name of the folder of its results.
    """
    experiments = {
        name: content.but(
            repeats=_limit(content.repeats, MOST_REPEATS),
            chunk=_limit(content.chunk, MOST_REPEATS),
        )
        for name, content in study.experiments.items()
    }
    fewer = study.but(experiments=experiments)
    return {
        each.folder: keep_claims(apply_values(fewer, each.values), select_claims(study, each))
        for each in study.readings
    }


def build_single_alternatives(study: Study) -> dict[str, Study]:
    """Return the study with the claims of which a figure draws all alternatives, by default and
    under each alternative that no sentence excludes and that changes some of their runs, with few
    runs, by the name of the folder of its results; nothing without such a figure.
    """
    drawn = {claim for figure in study.figures.values() for claim in figure.claims}
    claims = [claim for claim in study.claims if claim.id in drawn]
    if not claims:
        return {}
    few = limit_runs(keep_claims(study, claims))
    contents = [few.experiments[name] for name in list_experiments(few.claims)]
    methods = {method for content in contents for method in content.methods}
    homes = {few.problems[name].workspace for content in contents for name in content.problems}
    return {DEFAULT: few} | {
        name_folder(each.id, value): apply_values(few, {each.id: value})
        for each in study.assumptions
        if methods.intersection(study.list_governed_methods(each))
        or homes.intersection(each.workspace)
        if not each.excluded_by
        for value in each.alternatives
    }


def name_folder(identity: str, value: Any) -> str:
    """Return the name of the folder of the results under an alternative."""
    return re.sub(r"[^\w.+-]", "_", f"{identity}_{value}")


def keep_claims(study: Study, claims: list[Claim]) -> Study:
    """Return the study with some claims alone, of which it has the primary checks in the primary
    variant, and with no other runs than these checks name.
    """
    claims = [
        claim.in_primary_variant().but(checks=[check for check in claim.checks if check.primary])
        for claim in claims
    ]
    experiments = dict(study.experiments)
    checks = [check for claim in claims for check in in_variant(claim.checks, *variants(claim) * 2)]
    for name in list_experiments(claims):
        naming = [check for check in checks if name in check.experiments]
        experiments[name] = _keep_checks(study, experiments[name], naming)
    return study.but(claims=claims, experiments=experiments)


def _keep_checks(study: Study, content: Experiment, checks: list[ClaimCheck]) -> Experiment:
    """Return an experiment with what checks name of its problems, methods and varied values."""

    def is_named(**columns: Any) -> bool:
        wheres = [getattr(check, "where", {}) for check in checks]
        return any(
            all(value in convert_to_list(where.get(name, value)) for name, value in columns.items())
            for where in wheres
        )

    def is_compared(method: str) -> bool:
        return any(
            check.cells != "method"
            or "rest" in check.groups_named
            or metrics.METRICS[check.metric].among_rows
            or method in check.groups_named
            for check in checks
        )

    problems = [
        name
        for name in content.problems
        if is_named(problem=name, workspace=study.problems[name].workspace)
    ]
    return content.but(
        problems=problems or content.problems,  # some checks name those of single layouts
        methods=[name for name in content.methods if is_named(method=name) and is_compared(name)],
        vary={
            name: [value for value in values if is_named(**{name: value})]
            for name, values in content.vary.items()
        },
    )


def limit_runs(study: Study) -> Study:
    """Return the study with `FEW` runs of each method under each condition, or in each field that
    is drawn at random, at most.
    """
    problems = {
        name: problem.but(layouts=_limit(problem.layouts, FEW)) if problem.layouts else problem
        for name, problem in study.problems.items()
    }
    experiments = {}
    for name, content in study.experiments.items():
        fields = [problems[each].layouts for each in content.problems if problems[each].layouts]
        layouts = max((max(each.values()) for each in fields), default=1)
        most = max(1, FEW // layouts)
        experiments[name] = content.but(
            repeats=_limit(content.repeats, most), chunk=_limit(content.chunk, most), fewer={}
        )
    return study.but(problems=problems, experiments=experiments)


def _limit(numbers: dict[str, int], most: int) -> dict[str, int]:
    return {scale: min(number, most) for scale, number in numbers.items()}


def list_experiments(claims: Iterable[Claim]) -> list[str]:
    """Return the names of the experiments whose runs decide claims, once each; variants may name
    more.
    """
    named = [name for claim in claims for check in claim.checks for name in check.experiments]
    named += itertools.chain.from_iterable(
        convert_to_list(value) for claim in claims for value in claim.variants.get("experiment", [])
    )
    return list(dict.fromkeys(named))
