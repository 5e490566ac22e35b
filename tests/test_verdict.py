"""What follows for each paper: the sentences of the kept outcome, and their conditions."""

import re

import numpy as np
import outcome
import pandas as pd
import pytest

from bezierplan.analysis.outcome import verdict
from bezierplan.commands import read_studies
from bezierplan.places import TREE

KEPT = TREE / outcome.KEPT


@pytest.fixture(scope="module")
def kept():
    files = {
        "numbers": "numbers.csv",
        "claims": "claims.csv",
        "baseline": "baseline_comparison.csv",
        "wholes": "wholes.csv",
        "worth": outcome.WORTH,
    }
    tables = {
        name: pd.read_csv(KEPT / file) for name, file in files.items() if (KEPT / file).exists()
    }
    audits = [pd.read_csv(KEPT / f"{study}_{outcome.AUDIT}") for study in read_studies()]
    return tables | {"audit": pd.concat(audits)}


@pytest.mark.parametrize("study", ["song2016", "elhoseny2017", "ma2020", "tharwat2018", "meledje"])
def test_sentences_follow_from_the_kept_outcome(kept, study):
    """A sentence whose condition fails has to be written anew."""
    template = verdict.read(TREE / f"config/studies/{study}/verdict.yaml")
    found = verdict.sentences(template, verdict.own_rows(kept, study))
    assert 2 <= len(found) <= 5
    assert [each.fails for each in found] == [None] * len(found)
    text = (KEPT / f"{study}.md").read_text(encoding="utf-8")
    words = [word for word in text.split() if re.search(r"\w", word)]
    assert len(words) <= 1700
    assert all(each.text in text for each in found)


def test_a_sentence_whose_numbers_change_is_computed_again(kept):
    rows = verdict.own_rows(kept, "ma2020")
    template = verdict.read(TREE / "config/studies/ma2020/verdict.yaml")
    audit = rows["audit"].copy()
    shortest = audit.index[
        audit["place"].str.startswith("method=aco") & audit["place"].str.endswith("min")
    ]
    audit.loc[shortest[0], "printed"] -= 1
    *_, last = verdict.sentences(template, rows | {"audit": audit})
    assert last.text.startswith("6 of 8 shortest lengths")
    audit.loc[shortest, "printed"] = 0
    *_, last = verdict.sentences(template, rows | {"audit": audit})
    assert last.fails == "named > 4: 0.0 and 4.0"
    text = verdict.markdown(template, rows | {"audit": audit}, {"aco": "ACO"})
    assert "8 shortest" not in text
    assert "| ACO | " in text


def test_values_that_are_not_there_take_the_sentence_away(kept):
    rows = verdict.own_rows(kept, "tharwat2018")
    template = verdict.read(TREE / "config/studies/tharwat2018/verdict.yaml")
    (ranks,) = [
        found
        for found in verdict.sentences(template, rows | {"audit": rows["audit"].iloc[:0]})
        if "Friedman" in found.text
    ]
    assert ranks.fails.startswith("a value is missing")


def test_a_value_that_is_no_number_takes_the_sentence_away():
    sentence = {
        "text": "{mean:.1f}",
        "values": {"mean": {"of": "numbers", "column": "value_ours", "take": "mean"}},
    }
    shown = {"of": "numbers", "columns": {"ours": "value_ours"}}
    template = verdict.VerdictFile.model_validate({"sentences": [sentence], "table": shown})
    rows = {"numbers": pd.DataFrame({"value_ours": [np.nan]})}
    (only,) = verdict.sentences(template, rows)
    assert only.fails == "a value is missing: mean"
