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
    """rows: study, position, published, ours, and further columns."""
    made = [
        {
            "study": study,
            "position": position,
            "value_published": printed,
            "value_ours_scaled": ours,
            **more,
        }
        for study, position, printed, ours, more in rows
    ]
    usual = {"counted": True, "wide": False, "reason": ""}
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
            ("one", "inside", 10.0, 11.0, {"reason": comparison.NO_MAP}),
            ("one", "below", 10.0, 31.0, {}),
            ("two", "inside", 10.0, 10.0, {"wide": True}),
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
        "Of 3 printed numbers our range is narrow enough to tell for 2: 1 lie inside it, 1 "
        "outside. The other 1 would fit almost anything. For 1 the paper prints no map, so "
        "neither proves it right or wrong.",
        "Of 6 claims 1 hold, 1 hold in part, 3 fail, and 1 cannot be decided.",
        "The exact shortest path with rounded corners is always free: of the 1 method that are "
        "free as often, none gives a shorter path, and none a smoother one.",
    ]
    assert found.papers.loc["one"].to_list() == [*"221", "1.1e+02 %", *"1110"]
    assert found.papers.loc["two"].to_list() == [*"100", "0 %", *"0021"]
    assert found.methods.loc["one"].to_list() == ["90 %", "0.50 ×", "12 ×", "3 ×"]


def test_findings_of_ours_and_other_interpretations_do_not_count():
    own = claims(one=["supported", "contradicted", "contradicted"])
    own["finding"], own["primary"] = [False, True, False], [True, True, False]
    printed = numbers(("one", "inside", 1.0, 1.0, {}), ("one", "above", 9.0, 1.0, {}))
    found = headline.headline(
        printed.assign(counted=[True, False]), own, measured(), {"one": "One"}
    ).papers.loc["one"]
    assert found.to_list() == ["1", "1", "1", "0 %", "1", "0", "0", "0"]


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
    undefined = ("one", "below", 5.0, 50.0, {"reason": comparison.UNDEFINED})
    table = numbers(("one", "inside", 5.0, 6.85, {}), undefined, ("one", "inside", 0.0, 1.0, {}))
    assert headline.deviations(table) == pytest.approx([0.37, math.inf])
    assert headline.deviations(numbers(("one", "inside", 0.0, 0.0, {}))) == 0


def test_markdown_leaves_out_what_no_study_has():
    text = outcome.markdown(
        headline.headline(
            numbers(("one", "inside", 1.0, 1.0, {})),
            claims(one=["supported"]),
            measured(),
            {"one": "One"},
        ),
        {},
    )
    assert text.startswith(
        "**Of 1 printed number our range is narrow enough to tell for 1: 1 lie inside it, 0"
    )
    assert "| 1 | 1 | 1 | 0 % | 1 | 0 | 0 | 0 |" in text
    assert outcome.RANGE in text
