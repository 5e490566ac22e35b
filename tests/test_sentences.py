"""Why a claim has its verdict, in one plain sentence for each kind of test."""

import json
from types import SimpleNamespace

import checks_of_claims
import pytest

from bezierplan.analysis.claims import sentences

ROW = {
    "test": "lower",
    "metric": "length",
    "statistic": "mean",
    "unit": "cell",
    "effect": 3.0,
    "low95": 1.0,
    "high95": 5.0,
    "margin": 0.5,
}
ROW |= {"counted": "0 of 10, 10 of 10", "together": None}
ROW |= {"place": json.dumps({"problem": "case1"})}
SHARE = {
    "test": "share",
    "metric": "generation_5pct",
    "statistic": None,
    "unit": "generation",
    "margin": None,
}
SHARE |= {"effect": 0.39, "low95": 0.29, "high95": 0.49}
OURS = "differences below {} do not count (our choice)."

SENTENCES = {
    "higher where lower is claimed": (
        {},
        {"direction": "lower"},
        ("mga", "lower than", "ga"),
        "Case 1: in exact arc length (mean), mga is 3 cells higher than ga (95 % interval 1 to 5); "
        "the claim says lower; " + OURS.format("0.5 cells"),
    ),
    "many times as high, in counted work": (
        {
            "metric": "evaluations",
            "statistic": "rank",
            "effect": 25000.0,
            "low95": 24200.0,
            "high95": 25800.0,
            "margin": 0.1,
        },
        {"scale": "relative", "work": "evaluations", "margin": {"published": 0.1}},
        ("mga", "lower than", "prm"),
        "Case 1: in paths whose objective the planner asked for, mga is 25,000 times prm (95 % "
        "interval 24,200 to 25,800 times); the claim "
        "says lower; differences below 10 % do not count (our choice, and not more than the "
        "printed difference); judged on counted work, "
        "because seconds differ from machine to machine.",
    ),
    "a superlative": (
        {"statistic": "rank", "together": 3.0},
        {"direction": "lower"},
        ("mga", "lower than", "ga"),
        "Case 1: in exact arc length, mga is 3 cells higher than ga (95 % interval 1 to 5); "
        "the claim says lower in all 3 comparisons; " + OURS.format("0.5 cells"),
    ),
    "a stated difference": (
        {"test": "equal_within", "effect": -0.000331, "low95": None, "margin": 0.01},
        {"scale": "relative", "target": 0.0496},
        ("bca_q", "as", "bca"),
        "Case 1: in exact arc length (mean), bca_q is 0.0331 % lower than bca; the claim says by "
        "how much: 4.96 % higher; " + OURS.format("1 %"),
    ),
    "a share": (
        SHARE,
        {"event": {"at_most": 30}, "threshold": 0.5, "direction": "at_least"},
        ("at_most 30", "in at_least", "0.5"),
        "Case 1: first generation within 5 % of the run's final objective is at most 30 in 39 % "
        "of the runs (95 % interval 29 to 49 %); "
        "the claim needs it in at least 50 %.",
    ),
    "an event": (
        SHARE | {"metric": "collided", "unit": "-"},
        {"threshold": "none", "metric": "feasible"},
        ("", "in", "none"),
        "Case 1: the robot is in an obstacle at any time in 39 % of the runs (95 % interval 29 to "
        "49 %); the claim needs it in no run.",
    ),
    "a trend": (
        {"test": "trend", "statistic": "rank", "effect": -3.0, "low95": -5.0, "high95": -1.0},
        {"x": "obstacles", "direction": "up"},
        ("obstacles", "up", ""),
        "Case 1: exact arc length falls by 3 cells (95 % interval -5 to -1) from the least to the "
        "largest obstacles; "
        "the claim says that it rises; " + OURS.format("0.5 cells"),
    ),
    "a function": (
        {
            "test": "function",
            "metric": None,
            "unit": "-",
            "effect": 0.235,
            "low95": 0.233,
            "high95": 0.237,
        },
        {"effect": "share of the values above 0.7"},
        ("gauss above", "", ""),
        "Case 1: share of the values above 0.7: 0.235 (95 % interval 0.233 to 0.237).",
    ),
    "no value": (
        {"effect": None},
        {"direction": "lower"},
        ("mga", "lower than", "ga"),
        "Case 1: without a free path there is no exact arc length (mean), which is there in 0 of "
        "10 runs of mga and in 10 of 10 runs of ga; the claim says lower.",
    ),
}


OF_RUNS = {"experiment": "e", "metric": "length"}
GROUPS = OF_RUNS | {"groups": ["a"], "than": ["b"], "margin": 0.5}
NEEDED = {
    "lower": GROUPS | {"direction": "lower"},
    "equal_within": GROUPS | {"statistic": "mean"},
    "trend": OF_RUNS | {"margin": 0.5},
    "share": OF_RUNS,
    "function": {"name": "found", "effect_unit": "-"},
}
"""Kind of test -> keys that it needs and no sentence mentions."""


def check_of(test, **written):
    return checks_of_claims.check_of({"test": test} | NEEDED[test] | written)


@pytest.mark.parametrize(("row", "check", "terms", "sentence"), SENTENCES.values(), ids=SENTENCES)
def test_each_kind_of_test_has_a_sentence(row, check, terms, sentence):
    given = ROW | dict(zip(("group", "relation", "other"), terms)) | row
    labels = {"case1": "Case 1", "bca_q": "bca_q"}
    found = sentences.explain_verdict(
        given, check_of(given["test"], **check), labels, own_criterion=False
    )
    assert found == sentence


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
