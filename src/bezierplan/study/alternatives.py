"""Studies under other values of their assumptions. Such a study is a `Study` again, so the same
functions make its jobs.
"""

import math
import re
from collections.abc import Iterable
from typing import Any

from bezierplan.analysis import metrics
from bezierplan.analysis.claims.check import ClaimCheck
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.variants import apply_variant, list_variants, split_work
from bezierplan.figures.panels.alternatives import FEW
from bezierplan.schema.model import convert_to_list
from bezierplan.study.claims import AssumptionEntry, ReadingEntry
from bezierplan.study.definition import Study
from bezierplan.study.experiments import Experiment

DEFAULT = "default"

# All repeats of scale extended take three times the CPU time, and these are enough to decide.
MOST_REPEATS = 1000
"""Most repeats of a method under a condition when claims are judged under a reading."""


def find_default(study: Study, assumption: AssumptionEntry) -> Any:
    """Return the value that runs use for an assumption.

    If the assumption governs a setting, this is the value that its methods use; a dict, method ->
    value, if the assumption names methods.
    """
    setting, methods = assumption.setting, study.list_governed_methods(assumption)
    if setting is None:
        return assumption.default
    settings = [study.problems[problem].settings for problem in assumption.problems]
    values = [each[setting] for each in settings if setting in each]
    shared = [name for name in methods if setting not in study.methods[name].settings]
    used = {
        name: values[0] if values and name in shared else study.resolve_settings(name)[setting]
        for name in methods
    }
    return used if assumption.methods else next((used[name] for name in [*shared, *methods]), None)


def apply_values(study: Study, values: dict[str, Any]) -> Study:
    """Return the study with other values of some assumptions, by id. On a map that they change, the
    best known path length no longer counts.
    """
    workspaces, problems = dict(study.workspaces), dict(study.problems)
    for assumption in study.assumptions:
        if assumption.id in values:
            for name, key in assumption.workspace.items():
                plain = workspaces[name].plain() | {key: values[assumption.id]}
                workspaces[name] = type(workspaces[name]).model_validate(plain)
    for name, problem in study.problems.items():
        home = problem.workspace
        # A workspace that no value changes is still the same object.
        if problem.reference and workspaces[home] is not study.workspaces[home]:
            # The reference was measured on the unchanged map, so a gap to it would mean nothing.
            problems[name] = problem.but(reference=math.nan)
    return study.but(values=values, workspaces=workspaces, problems=problems)


def describe_values(study: Study, values: dict[str, Any]) -> str:
    """Describe in one line what other values of assumptions, by id, change."""
    details = {each.id: each.detail for each in study.assumptions}
    return "; ".join(f"{details[name]}: {value}" for name, value in values.items())


# --------------------------------------------------------------------------------------------------
# Claims under readings


def is_judged(claim: Claim) -> bool:
    """Return whether a claim can change under a reading: its primary checks rest on runs, and on no
    times.
    """
    primary = [split_work(check)[0] for check in claim.checks if check.primary]
    return all(check.experiments and not check.timed for check in primary)


def select_claims(study: Study, reading: ReadingEntry) -> list[Claim]:
    """Return the claims that are judged under a reading: those that it names, otherwise the main
    ones.
    """
    return [
        claim
        for claim in study.claims
        if (claim.id in reading.claims if reading.claims else claim.main) and is_judged(claim)
    ]


def build_joint_readings(study: Study) -> dict[str, Study]:
    """Return the study under each joint reading, by the folder of its results. Each has only the
    claims that are judged under that reading.
    """
    experiments = {
        name: content.but(
            repeats=_limit(content.repeats, MOST_REPEATS),
            # A chunk always runs whole, so it may not be larger than the repeats.
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
    """Return the study by default and under each single alternative, by the folder of its results.

    They have few runs (`limit_runs`) and only the claims that a figure draws; without such a figure
    the result is empty. An alternative is left out if a sentence of the paper excludes it, or if it
    changes none of these runs.
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
        # A slash in a value would put its results one folder deeper, where nobody looks.
        re.sub(r"[^\w.+-]", "_", f"{each.id}_{value}"): apply_values(few, {each.id: value})
        for each in study.assumptions
        if methods.intersection(study.list_governed_methods(each))
        or homes.intersection(each.workspace)
        if not each.excluded_by
        for value in each.alternatives
    }


def keep_claims(study: Study, claims: list[Claim]) -> Study:
    """Return the study with some of its claims alone, reduced to their primary checks in the
    primary variant, and with only the runs that these checks name.
    """
    claims = [
        claim.but(
            variants={column: values[:1] for column, values in claim.variants.items()},
            variant_names=[],
            checks=[check for check in claim.checks if check.primary],
        )
        for claim in claims
    ]
    experiments = dict(study.experiments)
    # A column of the primary variant that no check names becomes one more condition of `where`.
    checks = [
        check
        for claim in claims
        # One variant is left, which stands for the first one and for the chosen one.
        for check in apply_variant(claim.checks, *list_variants(claim) * 2)
    ]
    for name in list_experiments(claims):
        naming = [check for check in checks if name in check.experiments]
        experiments[name] = _keep_checks(study, experiments[name], naming)
    return study.but(claims=claims, experiments=experiments)


def _keep_checks(study: Study, content: Experiment, checks: list[ClaimCheck]) -> Experiment:
    """Return an experiment with only those of its problems, methods and varied values that checks
    name.
    """

    def is_named(**columns: Any) -> bool:
        """Return whether a check selects runs with these values; a check selects all values of a
        column that its `where` leaves out.
        """
        wheres = [getattr(check, "where", {}) for check in checks]
        return any(
            all(value in convert_to_list(where.get(name, value)) for name, value in columns.items())
            for where in wheres
        )

    def is_compared(method: str) -> bool:
        """Return whether a check needs the runs of a method: it names the method, or compares a
        method with all others.
        """
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
    """Return the study with at most `FEW` runs of each method under each condition; all layouts of
    a random field count together.
    """
    problems = {
        name: problem.but(layouts=_limit(problem.layouts, FEW)) if problem.layouts else problem
        for name, problem in study.problems.items()
    }
    experiments = {}
    for name, content in study.experiments.items():
        layouts = [n for each in content.problems for n in (problems[each].layouts or {}).values()]
        most = FEW // max(layouts, default=1)
        # `fewer` could ask for more runs than the limit.
        experiments[name] = content.but(
            repeats=_limit(content.repeats, most), chunk=_limit(content.chunk, most), fewer={}
        )
    return study.but(problems=problems, experiments=experiments)


def _limit(numbers: dict[str, int], most: int) -> dict[str, int]:
    """Return numbers by scale, each at most `most`."""
    return {scale: min(number, most) for scale, number in numbers.items()}


def list_experiments(claims: Iterable[Claim]) -> list[str]:
    """Return the names of the experiments whose runs decide some claims, including those that only
    a variant names.
    """
    named = [name for claim in claims for check in claim.checks for name in check.experiments]
    named += [
        name
        for claim in claims
        for value in claim.variants.get("experiment", [])
        for name in convert_to_list(value)
    ]
    return list(dict.fromkeys(named))
