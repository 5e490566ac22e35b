"""Choices that a paper leaves open: which alternatives are tried, with which methods and claims."""

import dataclasses
import itertools
from typing import Any

from bezierplan.analysis.claims.check import Check
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.sensitivity import Tried
from bezierplan.schema.model import one_or_list
from bezierplan.study.claims import Assumption
from bezierplan.study.definition import Study


def alternatives(study: Study) -> dict[str, tuple[Assumption, Any]]:
    """Every alternative that governs a setting: name, such as `O2_8`, -> assumption and value."""
    return {
        f"{assumption.id}_{value}": (assumption, value)
        for assumption in study.assumptions
        if assumption.setting
        for value in assumption.alternatives
    }


def tried(study: Study) -> list[str]:
    """Names of the alternatives that are tried on claims."""
    return [name for name, (assumption, _) in alternatives(study).items() if assumption.claims]


def concerned(study: Study, assumption: Assumption) -> list[str]:
    """Methods whose setting an assumption governs, except baselines and variants; only those that
    it names, if any.
    """
    of = assumption.methods or [
        name
        for name, method in study.methods.items()
        if name not in study.baselines and not method.variant_of
    ]
    return [method for method in of if assumption.setting in study.resolved(method)]


def default_of(study: Study, assumption: Assumption) -> Any:
    """The value that runs use where an assumption leaves it to a setting: one for the methods
    without a value of their own, or each of those that it names.
    """
    setting, methods = assumption.setting, concerned(study, assumption)
    if setting is None:
        return assumption.default
    used = {
        method: next(
            (
                settings[setting]
                for problem in assumption.problems
                if setting in (settings := study.problems[problem].settings)
                and setting not in study.methods[method].settings
            ),
            study.resolved(method)[setting],
        )
        for method in methods
    }
    shared = [used[name] for name in methods if setting not in study.methods[name].settings]
    return used if assumption.methods else next(iter([*shared, *used.values()]), None)


def methods_changed(study: Study, name: str) -> list[str]:
    """Methods of the headline claims whose settings an alternative changes."""
    return concerned(study, alternatives(study)[name][0])


def with_alternative(study: Study, name: str) -> Study:
    """The study under one alternative of `alternatives`."""
    assumption, value = alternatives(study)[name]
    methods = dict(study.methods)
    for method in methods_changed(study, name):
        changed = (
            methods[method].settings
            | {assumption.setting: value}
            | assumption.along.get(method, {})
        )
        methods[method] = methods[method].but(settings=changed)
    return dataclasses.replace(study, methods=methods)


def claims_tried(study: Study, name: str) -> list[Claim]:
    """The claims on which an alternative is tried."""
    wanted = alternatives(study)[name][0].claims
    return [claim for claim in study.claims if claim.id in wanted]


def headline_claims(study: Study, name: str) -> list[Claim]:
    """The claims on which an alternative is tried, in their primary variant only."""
    return [claim.in_primary_variant() for claim in claims_tried(study, name)]


def alternatives_described(study: Study) -> dict[str, Tried]:
    """What `analysis.sensitivity` prints about each alternative, by name."""
    return {
        name: Tried(study.key, of.id, of.detail, of.setting, default_of(study, of), value)
        for name, (of, value) in alternatives(study).items()
        if of.claims
    }


def methods_of_claims(study: Study, claims: list[Claim], experiment: str) -> list[str]:
    """Methods of an experiment, without variants, that claims compare; all of them if a check names
    none.
    """
    methods = [
        name for name in study.experiments[experiment].methods if not study.methods[name].variant_of
    ]
    named = set()
    for claim in claims:
        for check in claim.checks:
            if experiment in check.experiments:
                named |= _compared(study, claim, check) or set(methods)
    return [name for name in methods if name in named]


def _compared(study: Study, claim: Claim, check: Check) -> set[str]:
    """Methods that a check names; for `rest`, those of the claim's table."""
    methods = set(one_or_list(check.where.get("method", [])))
    if check.cells == "method":
        methods.update(check.groups_named)
    if "rest" in methods:
        tables = [study.compared()[name] for name in claim.artefacts if name in study.compared()]
        methods.update(
            *(one_or_list(table.where.get("method", list(study.methods))) for table in tables)
        )
    return methods


def experiments_of_claims(claims: list[Claim]) -> list[str]:
    """Names of the experiments whose runs decide claims, once each; variants may name more."""
    named = [name for claim in claims for check in claim.checks for name in check.experiments]
    named += itertools.chain.from_iterable(
        one_or_list(value) for claim in claims for value in claim.variants.get("experiment", [])
    )
    return list(dict.fromkeys(named))
