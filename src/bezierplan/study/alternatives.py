"""What a paper leaves open, and which methods it concerns."""

import itertools
from collections.abc import Iterable
from typing import Any

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.readings import assumptions as plain
from bezierplan.schema.model import one_or_list
from bezierplan.study.claims import AssumptionEntry
from bezierplan.study.definition import Study


def concerned(study: Study, assumption: AssumptionEntry) -> list[str]:
    """Methods whose setting an assumption governs, except baselines and variants; only those that
    it names, if any.
    """
    of = assumption.methods or [
        name
        for name, method in study.methods.items()
        if name not in study.baselines and not method.variant_of
    ]
    return [method for method in of if assumption.setting in study.resolved(method)]


def default_of(study: Study, assumption: AssumptionEntry) -> Any:
    """The value that runs use where an assumption leaves it to a setting: one for the methods
    without a value of their own, or each of those that it names.
    """
    setting, methods = assumption.setting, concerned(study, assumption)
    if setting is None:
        return assumption.default
    used = {}
    for name in methods:
        settings = [study.problems[problem].settings for problem in assumption.problems]
        values = [each[setting] for each in settings if setting in each]
        open_there = values and setting not in study.methods[name].settings
        used[name] = values[0] if open_there else study.resolved(name)[setting]
    shared = [used[name] for name in methods if setting not in study.methods[name].settings]
    return used if assumption.methods else next(iter([*shared, *used.values()]), None)


def with_alternative(study: Study, assumption: AssumptionEntry, value: Any) -> Study:
    """The study under one alternative of a setting."""
    methods = dict(study.methods)
    for name in concerned(study, assumption):
        more = {assumption.setting: value} | assumption.along.get(name, {})
        methods[name] = methods[name].but(settings=methods[name].settings | more)
    return study.but(methods=methods)


def experiments_of_claims(claims: list[Claim]) -> list[str]:
    """Names of the experiments whose runs decide claims, once each; variants may name more."""
    named = [name for claim in claims for check in claim.checks for name in check.experiments]
    named += itertools.chain.from_iterable(
        one_or_list(value) for claim in claims for value in claim.variants.get("experiment", [])
    )
    return list(dict.fromkeys(named))


def assumptions(study: Study, methods: Iterable[str]) -> list[plain.Alternatives]:
    """What the paper leaves open for some methods, for `analysis.readings`."""
    chosen = []
    for assumption in study.assumptions:
        concern = [name for name in concerned(study, assumption) if name in methods]
        along = {name: assumption.along.get(name, {}) for name in concern if assumption.setting}
        if assumption.alternatives and (along or assumption.workspace):
            chosen.append(
                plain.Alternatives(
                    assumption.id,
                    assumption.detail,
                    assumption.alternatives,
                    assumption.setting,
                    along,
                    assumption.problems,
                    assumption.workspace,
                    assumption.excluded_by or "",
                )
            )
    return chosen
