"""Words about claims: where they hold, and how many comparisons they need."""

import itertools
import json
from types import SimpleNamespace

import checks_of_claims
import pytest

from bezierplan.analysis.claims import sentences

CHECK = checks_of_claims.check_of(
    {"test": "lower", "experiment": "e", "metric": "length", "margin": 0.5}
    | {"groups": ["mga"], "than": ["prm", "ga"], "direction": "lower"}
)
LABELS = {"mga": "MGA", "prm": "roadmap"}


def rows(marks: str) -> list[dict]:
    """Comparisons of mga with two rivals on as many maps as are needed for the marks."""
    row = {"check": 1, "test": "lower", "statistic": None, "metric": "length", "group": "mga"}
    places = itertools.product(["prm", "ga"], range(len(marks) // 2))
    return [
        row | {"other": rival, "place": json.dumps({"workspace": n}), "mark_family": mark}
        for mark, (rival, n) in zip(marks, places, strict=True)
    ]


@pytest.mark.parametrize(
    ("marks", "words"),
    [
        ("+-", "Holds: against roadmap. The contrary: against ga"),
        (
            "+?00",
            "Holds: against roadmap, workspace 0. No effect: against ga, workspace 0; against ga, "
            "workspace 1. Undecided: against roadmap, workspace 1",
        ),
        ("+" * 5 + "-", "Holds: 5 of 6. The contrary: against ga, workspace 2"),
        ("----", ""),
    ],
)
def test_a_claim_lists_its_comparisons_by_mark_or_counts_them(marks, words):
    assert sentences.describe_where(rows(marks), [CHECK], LABELS) == words


def test_comparisons_of_different_measures_are_told_apart():
    first, second = rows("+-")
    second |= {"other": "prm", "metric": "cpu_s", "statistic": "mean"}
    found = sentences.describe_where([first, second], [CHECK], LABELS)
    assert found == "Holds: length. The contrary: mean cpu s"


@pytest.mark.parametrize(
    ("holds", "verdict", "count", "said"),
    [
        ("any", "supported", "3 of 16", "3 of 16; one suffices"),
        ("together", "contradicted", "6 of 12", "6 of 12; all are needed together"),
        ("all", "contradicted", "1 of 3", "1 of 3; none when corrected for their number"),
        ("all", "untestable", None, ""),
    ],
)
def test_a_count_says_how_many_are_needed(holds, verdict, count, said):
    assert sentences.describe_count(SimpleNamespace(holds=holds), verdict, count) == said
