"""The headline: three sentences and a table with a row for each study, the same in README, page and
summary.
"""

import math

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


def test_numbers_and_claims_are_said_in_two_sentences():
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
        {"one": "One et al. (2000): paths", "two": "Two"},
    )
    assert found.sentences == [
        "Of 3 printed numbers our range is narrow enough to tell for 2: 1 lie inside it, 1 "
        "outside. The other 1 would fit almost anything. For 1 the paper prints no map, so "
        "neither proves it right or wrong.",
        "Of 6 claims 1 hold, 1 hold in part, 3 fail, and 1 cannot be decided.",
    ]
    assert found.papers.loc["one"].to_list() == [*"221", "1.1e+02 %", *"1110"]
    assert found.papers.loc["two"].to_list() == [*"100", "0 %", *"0021"]


def test_findings_of_ours_and_other_interpretations_do_not_count():
    own = claims(one=["supported", "contradicted", "contradicted"])
    own["finding"], own["primary"] = [False, True, False], [True, True, False]
    printed = numbers(("one", "inside", 1.0, 1.0, {}), ("one", "above", 9.0, 1.0, {}))
    found = headline.headline(
        printed.assign(counted=[True, False]), own, {"one": "One"}
    ).papers.loc["one"]
    assert found.to_list() == ["1", "1", "1", "0 %", "1", "0", "0", "0"]


def test_deviations_are_relative_and_of_quantities_that_the_paper_defines():
    undefined = ("one", "below", 5.0, 50.0, {"reason": comparison.UNDEFINED})
    table = numbers(("one", "inside", 5.0, 6.85, {}), undefined, ("one", "inside", 0.0, 1.0, {}))
    assert headline.deviations(table) == pytest.approx([0.37, math.inf])
    assert headline.deviations(numbers(("one", "inside", 0.0, 0.0, {}))) == 0
