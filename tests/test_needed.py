"""Runs that scale extended has, beside those that claims and published numbers need."""

import math
from argparse import ArgumentParser

import pandas as pd
import pytest
from studies import studies

from bezierplan.commands import needed, outcome
from bezierplan.places import TREE
from bezierplan.schema.checked import Fault
from bezierplan.schema.model import one_or_list
from bezierplan.study import jobs

STUDIES = studies()
STUDY = "song2016"


def tables(folder, claims, checks, numbers=()):
    """Results with rows of claims, of their checks, and of numbers."""
    of_study = folder / STUDY
    of_study.mkdir()
    claim = {"variant": "", "primary": True, "timed": False}
    pd.DataFrame([claim | row for row in claims]).to_csv(of_study / "claims.csv", index=False)
    check = {"variant": "", "mark_family": "+", "decisive": True, "n": 250, "experiments": "routes"}
    pd.DataFrame([check | row for row in checks]).to_csv(of_study / "claim_checks.csv", index=False)
    number = {
        "study": STUDY,
        "table": "table1",
        "counted": True,
        "verdict": "inconclusive",
        "n_ours": 250,
        "n_published": 10.0,
    }
    columns = ["statistic", "low95_ours", "high95_ours", "low95_predicted", "high95_predicted"]
    rows = [number | row for row in numbers]
    pd.DataFrame(rows, columns=[*number, *columns]).to_csv(folder / "numbers.csv", index=False)
    return needed.table({STUDY: STUDIES[STUDY]}, folder).set_index("experiment")


def test_a_claim_needs_what_decides_its_comparison(tmp_path):
    row = tables(
        tmp_path,
        [{"id": "C1", "verdict": "supported"}],
        [{"id": "C1", "units_needed": 180.0}],
    ).loc["routes"]
    given = STUDIES[STUDY].experiments["routes"].repeats["extended"]
    assert row["given"] == given
    assert row["needed"] == math.ceil(180 / 250 * given)
    assert row["asked_by"] == "C1"


def test_a_decided_claim_needs_no_more_than_decided_it(tmp_path):
    row = tables(
        tmp_path,
        [{"id": "C1", "verdict": "partly"}],
        [{"id": "C1", "units_needed": 5000.0}],
    ).loc["routes"]
    assert row["needed"] == row["given"]


def test_an_undecided_claim_needs_all_that_is_open(tmp_path):
    undecided = {"id": "C1", "mark_family": "?", "decisive": False}
    row = tables(
        tmp_path,
        [{"id": "C1", "verdict": "undecided"}],
        [undecided | {"units_needed": 500.0}, undecided | {"units_needed": 750.0}],
    ).loc["routes"]
    assert row["needed"] == 3 * row["given"]
    assert pd.isna(row["out_of_reach"]) or row["out_of_reach"] == ""


@pytest.mark.parametrize("units", [1e6, math.nan])
def test_an_undecided_claim_may_be_out_of_reach(tmp_path, units):
    row = tables(
        tmp_path,
        [{"id": "C1", "verdict": "undecided"}],
        [{"id": "C1", "mark_family": "?", "units_needed": units}],
    ).loc["routes"]
    assert row["out_of_reach"] == "C1"
    assert row["needed"] == row["paper"]


def test_claims_about_seconds_and_variants_ask_for_nothing(tmp_path):
    found = tables(
        tmp_path,
        [
            {"id": "C1", "verdict": "undecided", "timed": True},
            {"id": "C2", "verdict": "undecided", "primary": False},
            {"id": "C3", "verdict": "supported"},
        ],
        [
            {"id": "C1", "mark_family": "?", "units_needed": 900.0},
            {"id": "C2", "mark_family": "?", "units_needed": 900.0},
            {"id": "C3", "units_needed": 1.0},
        ],
    )
    assert list(found["needed"]) == [found.loc["routes", "paper"]]


def test_a_mean_needs_an_interval_half_as_wide_as_the_papers(tmp_path):
    mean = {"statistic": "mean", "low95_predicted": 0.0, "high95_predicted": 8.0}
    row = tables(
        tmp_path,
        [{"id": "C1", "verdict": "supported"}],
        [{"id": "C1", "units_needed": 1.0}],
        [mean | {"low95_ours": 1.0, "high95_ours": 7.0}],
    ).loc["routes"]
    # 6 wide, and half of 8 is asked: (6 / 4)^2 as many
    assert row["needed"] == math.ceil(1.5**2 * row["given"])
    assert row["asked_by"] == "table1"


def test_an_extreme_needs_39_experiments_of_the_papers_size(tmp_path):
    row = tables(
        tmp_path,
        [{"id": "C1", "verdict": "supported"}],
        [{"id": "C1", "units_needed": 1.0}],
        [{"statistic": "max", "verdict": "disagrees"}],
    ).loc["routes"]
    assert row["needed"] == 39 * 10 / 250 * row["given"]


def test_without_results_one_line_tells_what_makes_them(tmp_path, monkeypatch):
    monkeypatch.setattr(needed, "RESULTS", tmp_path)
    with pytest.raises(Fault, match=r"numbers\.csv: not there yet; `snakemake extended`"):
        needed.main(ArgumentParser(), [])


def test_extended_has_the_runs_that_decide_and_no_multiple_of_them():
    """Of the outcome that is kept: each experiment has what it needs, and at most ten times that,
    unless a claim stays out of reach.
    """
    kept = pd.read_csv(TREE / outcome.KEPT / needed.KEPT)
    for row in kept.itertuples():
        given = needed.runs(STUDIES[row.study], row.experiment, "extended")
        assert given >= row.needed, f"{row.study}/{row.experiment}: {row.asked_by}"
        if pd.isna(row.out_of_reach):
            assert given <= needed.MOST * row.needed, f"{row.study}/{row.experiment}"


def test_no_number_that_counts_is_of_conditions_with_fewer_runs():
    """Of the outcome that is kept: `given` is what such a number has."""
    numbers = pd.read_csv(TREE / outcome.KEPT / "numbers.csv")
    for row in numbers[numbers["counted"]].itertuples():
        own = STUDIES[row.study]
        for experiment in jobs.experiments_of(own, row.table):
            fewer = own.experiments[experiment].fewer
            assert row.method not in fewer.get("method", {}), row
            assert row.profile not in fewer.get("profile", {}), row
            assert row.workspace not in fewer.get("problem", {}), row


def test_no_primary_claim_names_conditions_with_fewer_runs():
    for own in STUDIES.values():
        for claim in own.claims:
            for check in claim.in_primary_variant().checks:
                for experiment in one_or_list(getattr(check, "experiment", None) or []):
                    for factor, fewer in own.experiments[experiment].fewer.items():
                        named = one_or_list((check.where or {}).get(factor, []))
                        assert not set(map(str, named)) & set(fewer), claim.id
