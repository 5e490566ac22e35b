"""The answer to each paper: its facts in the kept outcome, and faults that are told."""

import facts
import outcome
import pandas as pd
import pytest
from studies import KEYS

from bezierplan.analysis.outcome import texts
from bezierplan.commands import read_studies
from bezierplan.places import TREE

KEPT = TREE / outcome.KEPT


@pytest.fixture(scope="module")
def ma2020():
    file = TREE / "config/studies/ma2020/verdict.yaml"
    return texts.read(file), facts.read_outcome_tables(KEPT, "ma2020")


@pytest.mark.parametrize("study", KEYS)
def test_the_facts_of_each_text_hold_in_the_kept_outcome(study):
    answer = outcome.fill_texts(KEPT, {study: read_studies()[study]})[study]
    assert answer.faults == []
    kept = pd.read_csv(KEPT / outcome.TEXTS).set_index("study").loc[study]
    assert (answer.title, answer.text) == (kept["title"], kept["text"])
    assert f"**{answer.title}.** {answer.text}" in (KEPT / f"{study}.md").read_text("utf-8")


def faults(found, text="All is well.", title="Yes", tables=None, **changed):
    """What is wrong with a text whose one fact is that BCA is shorter, with changes."""
    fact = {
        "of": "claim_checks",
        "where": {"id": "C1", "check": 1},
        "each": ["place"],
        "rows": 2,
        "take": "mark",
        "equals": "+",
    }
    fact = {name: value for name, value in (fact | changed).items() if value is not None}
    content = {"title": title, "text": text, "facts": {"short": fact}}
    return facts.fill(texts.Text.model_validate(content), tables or found[1]).faults


def test_a_fact_fails_that_finds_other_rows_than_it_must(ma2020):
    assert faults(ma2020) == []
    assert faults(ma2020, where={"id": "C0"}) == [
        "short: finds 0 rows; expected 2",
        "short: holds in 0 of 0 rows; expected 2",
    ]
    assert faults(ma2020, rows=3)[0] == "short: finds 2 rows; expected 3"
    assert "several rows have the same id" in faults(ma2020, each=["id"])[0]


def test_a_fact_fails_in_a_row_that_pools_and_where_a_sign_is_turned(ma2020):
    checks = ma2020[1]["claim_checks"].assign(conditions=1)
    own = checks.index[(checks["id"] == "C1") & (checks["check"] == 1)]
    pooled, turned = checks.copy(), checks.copy()
    pooled.loc[own[0], "conditions"] = 200
    turned.loc[own[0], "mark"] = "-"
    for tables, fault in (
        (pooled, "a row pools 200 conditions"),
        (turned, "holds in 1 of 2 rows; expected 2"),
    ):
        assert faults(ma2020, tables=ma2020[1] | {"claim_checks": tables}) == [f"short: {fault}"]


def test_a_reading_that_turns_a_claim_must_be_named(ma2020):
    readings = ma2020[1]["claims_by_reading"].copy()
    own = (readings["id"] == "C1") & (readings["check"] == 1) & (readings["reading"] != "default")
    name = readings.loc[own, "reading"].iloc[0]
    readings.loc[own & (readings["reading"] == name), "verdict_on_check"] = "contradicted"
    tables = ma2020[1] | {"claims_by_reading": readings}
    assert faults(ma2020, tables=tables) == [f"short: turned by the readings {name}"]
    assert faults(ma2020, tables=tables, turned_by=[name]) == []
    assert faults(ma2020, turned_by=[name]) == ["short: turned by the readings none"]


def test_numbers_come_from_facts_and_texts_are_short(ma2020):
    typed = "text: {} is typed; expected a fact in braces"
    assert faults(ma2020, "Of 12 lengths 3.5 fit.") == [typed.format("12"), typed.format("3.5")]
    assert faults(ma2020, "Table 1, environment 2, CPSO-2 and Figure 3 are names.") == []
    assert faults(ma2020, "In {short.holds} of {short.rows}.") == []
    assert "expected a fact that has it" in faults(ma2020, "In {other}.")[0]
    assert faults(ma2020, "word " * 61) == ["text: 61 words; expected at most 60"]
    assert faults(ma2020, title="word " * 9) == ["title: 9 words; expected at most 8"]


def test_values_are_shown_with_their_digits(ma2020):
    content = {
        "title": "Yes",
        "text": "{keep.low} to {keep.high} %",
        "facts": {
            "keep": {
                "of": "claim_checks",
                "where": {"id": "C30", "check": 1},
                "rows": 2,
                "take": "effect",
                "below": 1,
                "percent": True,
                "digits": 1,
            }
        },
    }
    checks = ma2020[1]["claim_checks"].copy()
    own = (checks["id"] == "C30") & (checks["check"] == 1)
    checks.loc[own, "effect"] = [0.416, 0.234]
    answer = facts.fill(texts.Text.model_validate(content), ma2020[1] | {"claim_checks": checks})
    assert answer.text == "20 to 40 %"
