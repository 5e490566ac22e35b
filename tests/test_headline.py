"""The sentences on numbers and claims, the same in README and page."""

import math

import numbers_picture
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
    assert headline.describe_numbers(
        numbers(
            ("one", "inside", 10.0, 11.0, {"reason": comparison.NO_MAP}),
            ("one", "below", 10.0, 31.0, {}),
            ("two", "inside", 10.0, 10.0, {"wide": True}),
            ("two", "inside", 10.0, 10.0, {"counted": False}),
        )
    ) == (
        "Of 3 printed numbers our range is too wide to tell for 1: it also holds at least half of "
        "the paper's other numbers of that quantity and condition. Of the other 2, 1 lie inside "
        "our range, 1 outside. Inside or outside, 1 of these prove nothing about the paper (no "
        "exact map is printed: 1). Only 1 could confirm a paper, and 0 do."
    )
    judged = claims(
        one=["supported", "partly", "no effect"],
        two=["contradicted", "contradicted", "untestable"],
    )
    assert headline.describe_claims(judged) == (
        "Of 6 claims 1 hold, 1 hold in part, 3 fail, and 1 are open: 0 undecided, 1 untestable, "
        "0 dependent on unprinted details."
    )


def test_findings_of_ours_and_other_variants_do_not_count():
    own = claims(one=["supported", "contradicted", "contradicted"])
    own["finding"], own["primary"] = [False, True, False], [True, True, False]
    assert headline.describe_claims(own).startswith("Of 1 claim 1 hold, 0 hold in part, 0 fail")


def test_deviations_are_relative_and_of_quantities_that_the_paper_defines():
    undefined = ("one", "below", 5.0, 50.0, {"reason": comparison.UNDEFINED})
    table = numbers(("one", "inside", 5.0, 6.85, {}), undefined, ("one", "inside", 0.0, 1.0, {}))
    assert numbers_picture.compute_deviations(table) == pytest.approx([0.37, math.inf])
    assert numbers_picture.compute_deviations(numbers(("one", "inside", 0.0, 0.0, {}))) == 0
