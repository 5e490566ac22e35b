"""Captions of tables and figures: at most two findings in words, with the verdict of many runs."""

import re

import pytest
from studies import studies

from bezierplan.figures.caption import MOST_FINDINGS, describe_verdicts
from bezierplan.study import captions, evidence
from bezierplan.study.experiments import SCALES
from bezierplan.study.runs_behind import list_methods

BARE = re.compile(r"\bC[0-9]+\b|\w_\w")
"""The code of a claim, or a key."""


@pytest.mark.parametrize("scale", SCALES)
def test_captions_have_words_and_at_most_two_findings(scale):
    for own in studies().values():
        for name in [*own.tables, *own.figures]:
            caption = captions.build_caption(own, name, scale)
            assert not BARE.search(caption.write()), (own.key, name)
            assert len(caption.findings) <= MOST_FINDINGS
            assert all(each.words for each in caption.findings), (own.key, name)


def test_every_printed_finding_about_runs_has_a_claim():
    """A figure of runs without one only shows what its title says."""
    for own in studies().values():
        without = {
            name
            for name in own.layout
            if list_methods(own, name) and not captions.build_caption(own, name, "full").findings
        }
        assert without <= {"figure19"}, own.key


def test_the_runs_shown_are_named_where_they_say_something_else():
    own = studies()["tharwat2018"]
    told = "not decided by these 10 runs, contradicted by 4,000."
    shown = {scale: captions.build_caption(own, "figure15", scale).write() for scale in SCALES}
    assert told in shown["full"]
    assert "contradicted by 4,000 runs." in shown["smoke"]
    assert "contradicted by 4,000 runs." in shown["extended"]


@pytest.mark.parametrize(
    ("many", "shown", "text"),
    [
        ("supported", "supported", "supported by 40 runs"),
        ("supported", "", "supported by 40 runs"),
        ("partly", "undecided", "not decided by this run, supported in part by 40"),
        ("depends", "supported", "supported by this run, but depends on details that"),
        ("depends", "undecided", "not decided by this run, and depends on details that"),
        ("no effect", "depends", "no difference that matters in 40 runs"),
        ("untestable", "supported", "cannot be tested"),
    ],
)
def test_two_verdicts(many, shown, text):
    assert describe_verdicts(many, 40, shown, 1).startswith(text)


def test_a_caption_of_a_changed_study_leaves_verdicts_to_the_page():
    own = studies()["tharwat2018"]
    turned = own.but(settings=own.settings | {"c1": 1.4})
    assert evidence.list_changes(turned)
    caption = captions.build_caption(turned, "figure15", "full")
    assert [each.words for each in caption.findings] == ["", ""]
    assert "Singer" not in caption.write().partition("swarms. ")[2]


def test_a_table_says_where_means_are_of_fewer_runs():
    own = studies()["meledje"]
    note = captions.build_caption(own, "table3", "full").remark
    assert note == "Means leave out runs without a free path: at least 98 of 100 remain"
    assert not captions.build_caption(own, "table2", "full").remark
