"""Claims and assumptions of the five studies: they fit their models, are complete, and name what
exists.
"""

import string
import typing
from functools import cache
from pathlib import Path

import pytest
from studies import KEYS, study

from bezierplan.analysis.claims import kinds
from bezierplan.schema import checked
from bezierplan.schema.model import Model, convert_to_list, list_keys
from bezierplan.study import claims as study_claims
from bezierplan.study.alternatives import find_default

STUDIES = Path(__file__).parents[1] / "config" / "studies"
# Of use to readers' own claims; of the papers' only those to come need them.
IDLE_KEYS = {"pool", "paired", "secondary"}


@cache
def claims(key):
    return checked.read(STUDIES / key / "claims.yaml")["claims"]


@cache
def assumptions(key):
    return checked.read(STUDIES / key / "assumptions.yaml")["assumptions"]


def all_checks():
    return [check for key in KEYS for claim in claims(key) for check in claim["checks"]]


def names_by_column(claim):
    """(column, value) of every value that the checks of a claim name, `rest` left out."""
    for check in claim.checks:
        named = [
            (check.cells, [name for name in check.groups_named if name != "rest"]),
            ("metric", [*filter(None, [check.metric, check.pick and check.pick.lowest])]),
            ("experiment", check.experiments),
            *getattr(check, "where", {}).items(),
        ]
        for column, given in named:
            yield from ((column, value) for value in convert_to_list(given))


@pytest.mark.parametrize("key", KEYS)
def test_claims_are_numbered(key):
    ids = [claim.id for claim in study(key).claims]
    assert ids == [f"C{number}" for number in range(1, len(ids) + 1)]


@pytest.mark.parametrize("key", KEYS)
def test_first_value_of_a_variant_is_what_the_checks_name(key):
    """Or the checks name nothing of its column. Of a list a claim may name some members only."""
    for claim in study(key).claims:
        named = {*names_by_column(claim)}
        for column, (first, *_) in claim.variants.items():
            free = all(column != other for other, _ in named)
            assert free or any((column, name) in named for name in convert_to_list(first)), claim.id


@pytest.mark.parametrize("key", KEYS)
def test_the_interpretation_in_force_decides(key):
    """Methods that are another reading of a published one are in variants alone, and in
    findings, which may compare readings.
    """
    for claim in (each for each in study(key).claims if not each.finding):
        named = {name for column, name in names_by_column(claim) if column == "method"}
        assert not named & study(key).variants().keys(), claim.id


@pytest.mark.parametrize("key", KEYS)
def test_assumptions_are_numbered_and_defaults_are_no_alternatives(key):
    ids = [assumption["id"] for assumption in assumptions(key)]
    assert len(set(ids)) == len(ids)
    numbers = [int(name[1:].rstrip(string.ascii_lowercase)) for name in ids]
    assert sorted(set(numbers)) == list(range(1, max(numbers) + 1))
    assert numbers == sorted(numbers)
    for assumption in study(key).assumptions:
        default = find_default(study(key), assumption)
        in_force = default.values() if isinstance(default, dict) else [default]
        assert not set(in_force) & set(assumption.alternatives), (
            f"{assumption.id}: the default is not an alternative"
        )


def keys_of_data(data):
    if isinstance(data, list):
        return set().union(*map(keys_of_data, data))
    if not isinstance(data, dict):
        return set()
    return set(data).union(*map(keys_of_data, data.values()))


def keys_of(model):
    """Keys of a model and of those within it."""
    parts = [part for field in model.model_fields.values() for part in models_in(field.annotation)]
    return set(list_keys(model)).union(*map(keys_of, parts))


def models_in(annotation):
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return [annotation, *annotation.__subclasses__()]
    return [model for part in typing.get_args(annotation) for model in models_in(part)]


@pytest.mark.parametrize(
    ("name", "model"),
    [("claims", study_claims.ClaimsFile), ("assumptions", study_claims.AssumptionsFile)],
)
def test_no_key_of_a_file_is_unused(name, model):
    used = {name, "fitted", "readings", *list_keys(study_claims.ReadingEntry)}.union(
        *(keys_of_data({"claims": claims, "assumptions": assumptions}[name](key)) for key in KEYS)
    )
    assert keys_of(model) - used == set()


@pytest.mark.parametrize("name", kinds.list_kinds())
def test_no_key_of_a_kind_of_test_is_unused(name):
    """A key may be used by one kind and idle in another."""
    used = set().union(*(check.keys() for check in all_checks() if check["test"] == name))
    assert set(list_keys(kinds.list_kinds()[name])) - used <= IDLE_KEYS
