"""The headline: three sentences and a table with a row for each study, the same in README, page and
summary.
"""

import math

import pandas as pd
import pytest

from bezierplan.analysis import comparison, headline


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
    return pd.DataFrame(rows).assign(primary=True, finding=False)


def measured(*rows):
    names = ("study", "feasible", "feasible_baseline", "length", "cpu", "proposed")
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
        measured(("one", 0.9, 1.0, 0.5, 3.0, True), ("one", 1.0, 1.0, 1.0, 0.25, False)),
        {"one": "One et al. (2000): paths", "two": "Two"},
    )
    assert found.sentences == [
        "3 published numbers: 1 in agreement, 1 in disagreement, 1 inconclusive.",
        "6 claims: 1 supported, 1 supported in part, 2 contradicted, 1 without effect, "
        "1 untestable.",
        "Of 1 method feasible as often as the baseline, the exact shortest path with rounded "
        "corners, none gives a shorter path.",
    ]
    assert found.table.loc["one"].to_list() == [
        *("1, 1, 0", "1 of 2", "1, 1, 1, 0"),
        *("90 %", "0.5", "3"),
    ]
    assert found.table.loc["two"].to_list() == ["0, 0, 1", "1 of 1", "0, 0, 2, 1", "", "", ""]
    assert len(found.table.columns) + 1 <= 7


def test_a_shorter_path_of_a_method_as_reliable_as_the_baseline_is_said():
    assert headline.beside_baseline(
        measured(("one", 1.0, 1.0, 0.9, 1.0, True), ("one", 1.0, 1.0, 1.2, 1.0, False))
    ).endswith("1 gives a shorter path.")
    assert headline.beside_baseline(measured(("one", 0.5, 1.0, 0.9, 1.0, True))).startswith(
        "Of 0 methods feasible as often as the baseline"
    )
    assert headline.beside_baseline(measured()) == ""


def test_deviations_are_relative_and_of_quantities_that_the_paper_defines():
    undefined = ("one", "inconclusive", 5.0, 50.0, {"why": comparison.UNDEFINED})
    table = numbers(("one", "agrees", 5.0, 6.85, {}), undefined, ("one", "agrees", 0.0, 1.0, {}))
    assert headline.deviations(table) == pytest.approx([0.37, math.inf])
    assert headline.deviations(numbers(("one", "agrees", 0.0, 0.0, {}))) == 0


def test_markdown_leaves_out_what_no_study_has():
    text = headline.markdown(
        headline.headline(
            numbers(("one", "agrees", 1.0, 1.0, {})),
            claims(one=["supported"]),
            measured(),
            {"one": "One"},
        )
    )
    assert text.startswith(
        "**1 published number: 1 in agreement. 1 claim: 1 supported.**\n\n| study | numbers"
    )
    assert "length" not in text.splitlines()[2]
