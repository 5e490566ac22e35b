"""Settings of planners: one declaration gives the signature, the checks, the texts and what kernels
read.
"""

import inspect
from enum import IntEnum
from typing import Annotated, Literal, NamedTuple

import pytest

from bezierplan.machine.digest import _parse
from bezierplan.planners import list_planners, load_planner, read_settings
from bezierplan.planners.parts.settings import (
    UNITS,
    About,
    Range,
    convert_to_cells,
    fill_settings,
    find_setting_fault,
    read_setting,
    with_settings,
)

Rule = IntEnum("Rule", "keep drop", start=0)


class Settings(NamedTuple):
    """Of a planner that does not exist."""

    tries: Annotated[int, Range(1, 9), About("random points", "paper, Table 1")]
    reach: Annotated[float, Range(0), About("how far they lie", unit=UNITS)]
    rule: Annotated[Rule, About("what happens to them")]


class Further(NamedTuple):
    """More of it."""

    exact: bool


@with_settings(Settings, Further)
def plan(problem, rng, settings, further, start=None):
    """A plan."""
    return settings, further, start


def test_settings_are_given_by_name_and_arrive_as_numbers():
    settings, further, start = plan(None, None, "start", tries=2, reach=3, rule="drop", exact=True)
    assert settings == (2, 3.0, 1)
    assert [type(value) for value in settings] == [int, float, int]
    assert (further, start) == ((True,), "start")


@pytest.mark.parametrize(
    "values", [{"tries": 2}, {"tries": 2, "reach": 1.0, "rule": "keep", "exact": True, "speed": 1}]
)
def test_a_missing_or_unknown_setting_is_no_call(values):
    with pytest.raises(TypeError):
        plan(None, None, **values)


def test_signature_and_documentation_follow_from_the_declaration():
    parameters = inspect.signature(plan).parameters.values()
    assert [each.name for each in parameters] == [
        "problem",
        "rng",
        "start",
        "tries",
        "reach",
        "rule",
        "exact",
    ]
    assert [each.name for each in parameters if each.kind is each.KEYWORD_ONLY] == [
        *Settings._fields,
        *Further._fields,
    ]
    assert "tries : a whole number from 1 to 9\n    random points (paper, Table 1)" in plan.__doc__
    assert "rule : one of keep, drop\n    what happens to them (assumed)" in plan.__doc__


def test_equal_values_of_other_types_are_filled_in_as_they_are():
    """A kernel is compiled for each type, so 1 must not become what an equal number was before."""
    for tries in (1, 1.0, True):
        found = fill_settings(Settings, {"tries": tries, "reach": 3, "rule": "keep"})
        assert (type(found.tries), type(found.reach), found.rule) == (type(tries), float, 0)


def test_lengths_in_units_become_cells():
    settings = fill_settings(Settings, {"tries": 4, "reach": 3.0, "rule": "keep"})
    assert convert_to_cells(settings, 2.0) == (4, 1.5, 0)


@pytest.mark.parametrize(
    ("annotation", "value", "wanted"),
    [
        (Rule, "lose", "one of keep, drop"),
        (Rule, 1, "one of keep, drop"),
        (Literal["keep"], "drop", "one of keep"),
        (Annotated[int, Range(1, 9), About("tries")], 10, "a whole number from 1 to 9"),
        (Annotated[float, Range(1)], "1", "a number"),
        (bool, 1, "true or false"),
    ],
)
def test_a_wrong_value_is_answered_with_the_accepted_ones(annotation, value, wanted):
    assert find_setting_fault(read_setting(annotation), value) == wanted


@pytest.mark.parametrize("annotation", [str, list[int], Annotated[int, "tries"], IntEnum])
def test_other_annotations_declare_no_setting(annotation):
    with pytest.raises(TypeError):
        read_setting(annotation)


@pytest.mark.parametrize("planner", list_planners())
def test_every_setting_of_the_package_says_in_one_line_what_it_means_and_whence(planner):
    for name, declared in read_settings(load_planner(planner)).items():
        assert declared.about, name
        assert declared.about.text, name
        assert declared.about.source, name
        assert "\n" not in declared.meaning, name


def test_words_about_a_setting_run_no_job_again_but_its_unit_does():
    texts = [
        'About("a", "b")',
        'About("c", "d")',
        'About("a", "b", UNITS)',
        'About("c", unit=UNITS)',
    ]
    words, others, unit, named = (_parse(text.encode()).tree for text in texts)
    assert words == others
    assert len({words, unit, named}) == 3
