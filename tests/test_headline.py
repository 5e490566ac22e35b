"""The headline: three sentences and a table with a row for each study, the same in README, page and
summary.
"""

import math

import outcome
import pandas as pd
import pytest

from bezierplan.analysis.numbers import comparison
from bezierplan.analysis.outcome import headline


def numbers(*rows):
    """rows: study, verdict, published, ours, and further columns."""
    made = [
        {
            "study": study,
            "verdict": verdict,
            "value_published": printed,
            "value_ours_scaled": ours,
            **more,
        }
        for study, verdict, printed, ours, more in rows
    ]
    usual = {"counted": True, "why": ""}
    return pd.DataFrame([usual | row for row in made])


def claims(**verdicts):
    rows = [
        {"study": study, "id": f"C{n}", "verdict": each}
        for study, own in verdicts.items()
        for n, each in enumerate(own)
    ]
    return pd.DataFrame(rows).assign(primary=True, finding=False, main=True)


def measured(*rows):
    names = ("study", "feasible", "feasible_baseline", "length", "curvature", "cpu", "proposed")
    return pd.DataFrame([dict(zip(names, row, strict=True)) for row in rows], columns=names)


def test_numbers_claims_and_methods_are_said_in_three_sentences():
    found = headline.headline(
        numbers(
            ("one", "agrees", 10.0, 11.0, {}),
            ("one", "disagrees", 10.0, 31.0, {}),
            ("two", "inconclusive", 10.0, 10.0, {}),
        ),
        claims(
            one=["supported", "partly", "no effect"],
            two=["contradicted", "contradicted", "untestable"],
        ),
        measured(
            ("one", 0.9, 1.0, 0.5, 12.34, 3.0, True), ("one", 1.0, 1.0, 1.0, math.inf, 0.25, False)
        ),
        {"one": "One et al. (2000): paths", "two": "Two"},
    )
    assert found.sentences == [
        "Of 3 printed numbers 2 can be tested; of these we reproduce 1.",
        "Of 6 claims 1 hold, 1 hold in part, 3 fail, and 1 cannot be decided.",
        "The exact shortest path with rounded corners is always free: of the 1 method that are "
        "free as often, none gives a shorter path, and none a smoother one.",
    ]
    assert found.papers.loc["one"].to_list() == ["in part", *"21", "1 of 2", *"1110"]
    assert found.papers.loc["two"].to_list() == ["not reproduced", *"00", "1 of 1", *"0021"]
    assert found.methods.loc["one"].to_list() == ["90 %", "0.50 ×", "12 ×", "3 ×"]


def test_findings_of_ours_and_other_interpretations_do_not_count():
    own = claims(one=["supported", "contradicted", "contradicted"])
    own["finding"], own["primary"] = [False, True, False], [True, True, False]
    printed = numbers(("one", "agrees", 1.0, 1.0, {}), ("one", "disagrees", 1.0, 9.0, {}))
    counts = headline.outcome(printed.assign(counted=[True, False]), own).loc["one"]
    assert (counts["numbers"], counts["agrees"], counts["disagrees"]) == (1, 1, 0)
    assert (counts["supported"], counts["contradicted"]) == (1, 0)


@pytest.mark.parametrize(
    ("verdicts", "word"),
    [
        (["supported", "depends", "untestable"], "reproduced"),
        (["supported", "contradicted"], "in part"),
        (["no effect", "partly"], "in part"),
        (["no effect", "contradicted", "undecided"], "not reproduced"),
        (["depends", "untestable"], "cannot be told"),
        ([], "cannot be told"),
    ],
)
def test_a_paper_has_one_word_by_its_main_claims(verdicts, word):
    own = claims(one=[*verdicts, "contradicted"])
    own["main"] = [True] * len(verdicts) + [False]
    assert headline.word(own) == word


def test_what_a_method_as_reliable_as_the_baseline_gives_is_said():
    text = headline.beside_baseline(
        measured(
            ("one", 1.0, 1.0, 0.9, 2.0, 1.0, True),
            ("one", 1.0, 1.0, 1.2, 0.1, 1.0, False),
            ("two", 1.0, 1.0, 1.05, 0.5, 1.0, False),
            ("two", 0.5, 1.0, 0.5, 0.5, 1.0, False),
        )
    )
    assert text.endswith("1 gives a shorter path, and 2 a smoother one, 1.05 to 1.2 times as long.")
    assert headline.beside_baseline(measured()) == ""


def test_deviations_are_relative_and_of_quantities_that_the_paper_defines():
    undefined = ("one", "inconclusive", 5.0, 50.0, {"why": comparison.UNDEFINED})
    table = numbers(("one", "agrees", 5.0, 6.85, {}), undefined, ("one", "agrees", 0.0, 1.0, {}))
    assert headline.deviations(table) == pytest.approx([0.37, math.inf])
    assert headline.deviations(numbers(("one", "agrees", 0.0, 0.0, {}))) == 0


def test_markdown_leaves_out_what_no_study_has():
    text = outcome.markdown(
        headline.headline(
            numbers(("one", "agrees", 1.0, 1.0, {})),
            claims(one=["supported"]),
            measured(),
            {"one": "One"},
        ),
        {},
    )
    assert text.startswith(
        "**Of 1 printed number 1 can be tested; of these we reproduce 1. Of 1 claim"
    )
    assert "| reproduced | 1 | 1 | 1 of 1 | 1 | 0 | 0 | 0 |" in text
    assert headline.LEGEND in text
