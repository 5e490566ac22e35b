"""Readings of a paper: a study under other values of its assumptions, and its claims there."""

import math

import outcome
import pandas as pd
import pytest
from studies import studies

from bezierplan.analysis.claims import by_reading, sentences
from bezierplan.places import TREE
from bezierplan.study import alternatives, jobs

STUDIES = studies()


def chunk(study, experiment, method):
    return jobs.build_chunk(study, experiment, method, "extended", 0)


# A study under other values


def test_a_value_changes_its_setting_on_its_problems_and_what_goes_along():
    study = STUDIES["meledje"]
    default = chunk(study, "operators", "random")
    second = chunk(alternatives.apply_values(study, {"M15b": 50}), "operators", "random")
    assert second.settings == default.settings
    assert "generations" not in second.problems["env1_initial"]["settings"]
    changed = second.problems["env2_initial"]["settings"].items()
    assert changed >= {"generations": 50, "population": 80}.items()
    both = chunk(
        alternatives.apply_values(study, {"M10": 10, "M15": 200}), "operators", "random"
    ).settings
    assert (both["generations"], both["stall"]) == (200, 10)


def test_a_problem_keeps_its_own_value_under_one_that_is_not_of_it():
    study = STUDIES["ma2020"]
    genetic = study.methods["ga"].but(settings={"coding": "via_cells"})
    study = study.but(methods=study.methods | {"ga": genetic})
    made = chunk(alternatives.apply_values(study, {"O14g": 10}), "environments", "ga")
    assert made.settings["generations"] == 10
    assert made.problems["environment2"]["settings"]["generations"] == 100


@pytest.mark.parametrize(
    ("key", "values", "experiment", "shared"),
    [
        ("ma2020", {"O14h": 100}, "environments", {"aco", "bca", "bca_q"}),
        ("meledje", {"M15b": 50}, "heights", {"random", "ref12", "ref21", "proposed"}),
        ("tharwat2018", {"O3b": 1.35}, "maps", set()),
        ("tharwat2018", {"O3b": 1.35}, "obstacles", {"cpso2_singer"}),
    ],
)
def test_a_study_shares_the_runs_that_its_values_do_not_change(key, values, experiment, shared):
    study = STUDIES[key]
    other = alternatives.apply_values(study, values)
    same = {
        method
        for method in study.experiments[experiment].methods
        if jobs.is_shared(other, study, "extended", experiment, method)
    }
    assert same & shared == shared & {*study.experiments[experiment].methods}
    assert bool(same) == bool(shared)
    assert jobs.is_shared(other, study, "extended", experiment) == bool(shared)


def test_no_best_known_path_counts_on_another_map():
    study = STUDIES["tharwat2018"]
    other = alternatives.apply_values(study, {"O3b": 1.35})
    assert study.problems["equal"].reference
    assert math.isnan(other.problems["equal"].reference)
    assert other.problems["public"] == study.problems["public"]


def test_the_runs_of_claims_are_those_that_their_checks_name():
    study = STUDIES["tharwat2018"]
    claims = [claim for claim in study.claims if claim.id in ("C21", "C27")]
    own = alternatives.keep_claims(study, claims).experiments
    assert own["maps"].problems == ["equal"]
    assert {*own["maps"].methods} < {*study.experiments["maps"].methods}
    assert own["control_points"].methods == ["cpso2_singer"]
    assert own["control_points"].vary["particles"] == [20]


def test_alternatives_have_few_runs_and_none_is_excluded():
    for key, study in STUDIES.items():
        under = alternatives.build_single_alternatives(study)
        assert next(iter(under)) == alternatives.DEFAULT
        excluded = {each.id for each in study.assumptions if each.excluded_by}
        assert not excluded & {name for own in under.values() for name in own.values}, key
        few = under[alternatives.DEFAULT]
        for name in alternatives.list_experiments(few.claims):
            made = chunk(few, name, few.experiments[name].methods[0])
            layouts = max(place.get("layout", 0) for place in made.problems.values()) + 1
            assert made.repeats[1] * layouts <= 100


def test_a_printed_statistic_is_of_as_many_runs_of_ours_or_its_table_says_of_which_it_is():
    """The third rule for a default reading (docs/verdicts.in.md)."""
    numbers = pd.read_csv(TREE / outcome.KEPT / "numbers_papers_size.csv")
    printed = numbers[["n_published", "n_asked"]].min(axis=1).fillna(1)
    fewer = numbers[numbers["n_ours"] < printed]
    for (key, table), rows in fewer.groupby(["study", "table"]):
        note = STUDIES[key].tables[table].note or ""
        names = [STUDIES[key].labels.get(each, each) for each in rows["method"].unique()]
        assert [name for name in names if name not in note] == [], f"{key}: {table}: {note}"


# Claims


CLAIMS = pd.DataFrame({"id": ["C1"] * 2 + ["C2", "C3"], "primary": [True, False, True, True]})
CLAIMS["variant"], CLAIMS["reason"] = ["", "metric=length", "", ""], "why"
CLAIMS["verdict"] = ["supported", "undecided", "supported", "undecided"]


def under(**verdicts):
    """Verdicts on C1 by reading, as `add_dependence` takes them."""
    return {
        name: by_reading.ClaimTables(pd.DataFrame({"id": ["C1"], "verdict": [verdict]}), None)
        for name, verdict in verdicts.items()
    }


@pytest.mark.parametrize(
    ("verdicts", "verdict", "readings", "reason"),
    [
        (
            {"slow": "supported", "far": "partly"},
            "supported",
            "supported under slow; partly under far",
            "why",
        ),
        (
            {"slow": "undecided", "far": "contradicted"},
            "depends",
            "undecided under slow; contradicted under far",
            'supported by default, contradicted under "far" (How far: 3). Why',
        ),
        (
            {"slow": "no effect"},
            "depends",
            "no effect under slow",
            'supported by default, no effect under "slow" (How fast: 2). Why',
        ),
        (
            {"slow": "contradicted", "far": "contradicted"},
            "depends",
            "contradicted under slow, far",
            'supported by default, contradicted under "slow" (How fast: 2) and "far" (How far: 3). '
            "Why",
        ),
    ],
)
def test_a_claim_depends_on_a_reading_that_decides_the_opposite(
    verdicts, verdict, readings, reason
):
    """One that decides nothing is told, and is no agreement."""
    meanings = {"slow": "How fast: 2", "far": "How far: 3"}
    found = by_reading.add_dependence(CLAIMS, under(**verdicts), meanings, {})
    assert [*found["verdict"]] == [verdict, "undecided", "supported", "undecided"]
    assert [*found["readings"]] == [readings, "", "", ""]
    assert found["reason"][0] == reason


def test_a_claim_depends_on_a_variant_with_any_other_verdict():
    claims = CLAIMS.assign(verdict=["supported", "partly", "supported", "undecided"])
    found = by_reading.add_dependence(claims, {}, {}, {"metric=length": "metric length"})
    assert [*found["verdict"]] == ["depends", "partly", "supported", "undecided"]
    assert found["reason"][0] == 'supported by default, partly with "metric length". Why'
    assert {*found["readings"]} == {""}


def test_variants_have_their_names_or_are_described_by_their_values():
    study = STUDIES["ma2020"]
    names = sentences.name_variants(study.claims, study.labels)
    assert names["method=aco ga aco_ga asfa_ga"] == "usual rivals"
    half = "differential_evolution_half"
    assert names[f"method={half}"] == study.labels[half]


def test_a_claim_of_two_checks_has_the_verdict_on_each(tmp_path):
    """One of both holds; of each the comparison that speaks most against the claim is named, also
    from files in which all marks are 0.
    """
    study = STUDIES["ma2020"]
    claim = next(claim for claim in study.claims if claim.id == "C24")
    checks = pd.DataFrame(
        {"check": [1, 1, 2], "mark": ["+", "-", "+"], "effect": [1.0, -2.0, 3.0]}
    ).assign(study="ma2020", id="C24", variant="", primary=True)
    checks["mark_family"] = checks["mark"]
    judged = pd.DataFrame({"id": ["C24"], "variant": "", "primary": True, "verdict": "partly"})
    checks.assign(mark="0", mark_family="0").to_csv(tmp_path / "checks.csv")
    read = by_reading.read_checks(tmp_path / "checks.csv").assign(variant="")
    rows = by_reading.list_checks(
        [claim],
        {
            by_reading.DEFAULT: by_reading.ClaimTables(judged, checks),
            "zero": by_reading.ClaimTables(judged, read),
        },
    )
    assert rows["reading"].to_list() == ["default"] * 2 + ["zero"] * 2
    assert rows["verdict_on_check"].to_list() == ["partly", "supported", "no effect", "no effect"]
    assert rows["holds"].to_list() == ["1 of 2", "1 of 1", "0 of 2", "0 of 1"]
    assert rows["effect"].to_list() == [-2.0, 3.0, 1.0, 3.0]
