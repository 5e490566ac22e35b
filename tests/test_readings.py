"""Readings of a paper: what they change, what excludes them, how they fit, and what claims make of
them.
"""

import numpy as np
import pandas as pd
import pytest
from pivots import pivot_of
from studies import built, studies

from bezierplan.analysis.claims import by_reading
from bezierplan.analysis.outcome import outcome
from bezierplan.analysis.readings import fit, readings
from bezierplan.analysis.results import Results
from bezierplan.places import TREE
from bezierplan.running import execution
from bezierplan.study import jobs

STUDIES = studies()
READ = [key for key, study in STUDIES.items() if study.votes]


def job(key):
    made = jobs.readings(STUDIES[key], "full")
    files = {name: f"{STUDIES[key].folder}/published/{name}.csv" for name in made.tables}
    return made, readings.quantities(made.tables, made.votes, files)


def test_a_reading_changes_its_settings_on_its_problems_and_what_goes_along():
    made, _ = job("meledje")
    chunk = made.experiments["operators"].chunks["random"]
    second = readings.under(chunk, {"M15b": 50}, made.assumptions)
    assert second.settings == chunk.settings
    assert "generations" not in second.problems["env1_initial"]["settings"]
    changed = second.problems["env2_initial"]["settings"].items()
    assert changed >= {"generations": 50, "stall": 100, "population": 80}.items()
    both = readings.under(chunk, {"M10": 10, "M15": 200}, made.assumptions).settings
    assert (both["generations"], both["stall"]) == (200, 10)


def test_what_was_fitted_to_has_runs_and_no_vote_and_a_number_without_n_is_of_one_run():
    made, quantities = job("elhoseny2017")
    assert "mga" in made.experiments["fields100"].chunks
    voting = pd.concat([each.printed for each in quantities]).query("votes")
    assert {*voting["method"]} == {"prm", "abc_ep", "ga"}
    assert {*pd.concat([each.printed["n"] for each in job("song2016")[1]])} == {1}
    assert {*pd.concat([each.printed for each in job("ma2020")[1]]).query("votes")["method"]} == {
        "bca",
        "bca_q",
    }


# The fit


def of_kind(printed, size, counts=False, values=None):
    k = len(printed)
    values = np.zeros((2, k)) if values is None else values
    kinds = np.full(k, counts), np.zeros(k, dtype=bool)
    return fit.Numbers(values, np.asarray(printed, float), np.full(k, 0.01), *kinds, size)


def test_densities_are_densities_of_relative_errors_and_of_counts():
    counts = of_kind(np.arange(101), 100, counts=True)
    ours = fit.Moments(*(np.full(101, value) for value in (0.3, 100, 1, np.nan)))
    assert np.exp(fit._of_counts(counts, counts.printed, ours)).sum() == pytest.approx(1)
    errors = np.linspace(-20, 20, 400_001)
    means = of_kind(np.full(len(errors), 10.0), 1)
    ours = fit.Moments(10 * (1 - errors), *(np.full(len(errors), value) for value in (1, 1, 0.25)))
    found = np.exp(fit._of_means(means, means.printed, ours))
    assert np.trapezoid(found, errors) == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize(
    ("variance", "size", "units", "share", "step", "error"),
    [
        (0, 1, 1e9, 1, 0.6, 0.6 / np.sqrt(12)),  # of rounding, uniform
        (4, 4, 16, 1, 1e-9, np.sqrt(4 / 4 + 4 / 16)),  # of both means
        (4, 8, 16, 0.5, 1e-9, np.sqrt(4 / 4 + 4 / 16)),  # of the runs that count
    ],
)
def test_the_error_of_a_printed_mean(variance, size, units, share, step, error, monkeypatch):
    """In closed form: the density of Student's t at 0 is 3/8 where its scale is 1."""
    monkeypatch.setattr(fit, "DISCREPANCY", 0.0)
    number = of_kind([10.0], size)._replace(step=np.array([step]))
    ours = fit.Moments(*(np.array([each]) for each in (10.0, units, share, variance)))
    density = np.exp(fit._of_means(number, number.printed, ours))
    assert density == pytest.approx(3 / 8 / (error / 10))


def test_a_count_far_from_ours_has_the_density_of_any():
    count = of_kind([100], 100, counts=True)
    ours = fit.Moments(*(np.array([each]) for each in (0.0, 100, 1, np.nan)))
    assert np.exp(fit._of_counts(count, count.printed, ours)) == pytest.approx(0.05 / 101, rel=1e-6)


def test_printed_shares_vote_as_counts(tmp_path):
    file = tmp_path / "shares.csv"
    file.write_text("method,metric,statistic,n,unit,value\nmine,feasible,share,20,-,0.95\n")
    value = {"metric": "feasible", "statistic": "share", "label": "free", "decimals": 2}
    spec = pivot_of({"index": ["method"], "columns": ["value"], "values": [value]})
    tables = {"table1": spec.but(published="shares.csv")}
    (found,) = readings.quantities(tables, {"table1": {"feasible": {}}}, {"shares": str(file)})
    assert found.statistic == "count"
    assert found.printed[["value", "n", "votes"]].to_numpy().tolist() == [[19, 20, True]]


def test_moments_are_those_of_the_chosen_units_that_have_a_value():
    values = np.array([[1.0, 0.0], [np.nan, 1.0], [3.0, 1.0], [8.0, 1.0]])
    numbers = of_kind([0, 0], 2, values=values)._replace(counts=np.array([False, True]))
    found = fit.moments(numbers, np.array([[True, True, True, False], [False, True, False, False]]))
    assert [*found.centre[0]] == [2, 2 / 3]
    assert [*found.counted[:, 0]] == [2, 0]
    assert found.variance[0, 0] == 2
    assert np.isnan([found.centre[1, 0], found.variance[1, 0]]).all()
    medians = numbers._replace(medians=np.array([True, False]))
    assert fit.moments(medians, np.ones((1, 4), dtype=bool)).centre[0, 0] == 3


METHODS, SIZE, STORED = ("cpso1_singer", "cpso2_singer", "cpso1_tent", "cpso2_sine"), 10, 100


def swarms(repeats, **settings):
    """Objectives of real runs of tharwat2018 on its three circles: (repeats, methods)."""
    study = STUDIES["tharwat2018"]
    problem = {"equal": built(study, "maps", "equal")}
    chunks = job("tharwat2018")[0].experiments["maps"].chunks
    found = []
    for method in METHODS:
        chunk = chunks[method]._replace(repeats=repeats)
        chunk = chunk._replace(settings=chunk.settings | settings)
        found.append(execution.run_chunk(problem, chunk)[0]["objective"].to_numpy())
    return np.column_stack(found)


def chances(ours, printed, rng):
    """p of experiments (experiments, k) under runs of ours, with errors as small as the model's."""
    errors = fit.DISCREPANCY * rng.standard_t(fit.FREEDOM, printed.shape)
    numbers = of_kind(printed[0], SIZE, values=ours)
    each = (numbers._replace(printed=np.round(row, 2)) for row in printed * (1 + errors))
    return [fit.p_of_fit([one], rng) for one in each]


def test_p_is_uniform_for_experiments_of_ours_and_tells_what_it_can(monkeypatch):
    """Ours are drawn anew for every ten experiments. A swarm without chaos prints numbers that fit;
    one with twice the acceleration does not.
    """
    monkeypatch.setattr(fit, "EXPERIMENTS", 200)
    rng = np.random.default_rng(1)

    def experiments(runs):
        return runs.reshape(-1, SIZE, len(METHODS)).mean(axis=1)

    blocks = swarms([0, 10 * 2 * STORED]).reshape(10, 2 * STORED, len(METHODS))
    true = [chances(own[:STORED], experiments(own[STORED:]), rng) for own in blocks]
    assert np.mean(np.ravel(true) < 0.05) <= 0.12
    assert 0.35 <= np.mean(np.ravel(true) < 0.5) <= 0.62
    own = blocks[0, :STORED]
    fast = chances(own, experiments(swarms([0, 200], c1=3.0, c2=3.0)), rng)
    calm = chances(own, experiments(swarms([5000, 5200], chaotic_term="none")), rng)
    assert np.mean(np.array(fast) < 0.05) >= 0.5
    assert np.mean(np.array(calm) < 0.05) <= 0.2


def test_independent_groups_are_joined_by_fisher(monkeypatch):
    monkeypatch.setattr(fit, "_p_of_group", lambda group, rng: group)
    assert fit.p_of_fit([0.05], None) == pytest.approx(0.05)
    assert fit.p_of_fit([0.05, 0.05], None) == pytest.approx(0.0025 * (1 - np.log(0.0025)))


# Which readings are excluded


@pytest.mark.parametrize(
    ("lengths", "least", "why"),
    [
        ([8.0, 9.0], 7.0, ""),
        ([8.0, np.nan], 7.0, "the proposed method returns no path"),
        ([8.0, 9.0], 8.6, "a printed mean lies below the exact optimum"),
    ],
)
def test_what_excludes_a_reading(lengths, least, why):
    printed = pd.DataFrame({"method": ["mine"], "value": [8.5], "n": [2], "votes": [True]})
    printed.insert(1, "problem", "field")
    quantity = readings.Quantity(
        *("tried", {}, {}, "length", "mean", 2, "optimum", ["method", "problem"], printed)
    )
    runs = pd.DataFrame({"method": "mine", "problem": "field", "repeat": [0, 1], "length": lengths})
    found = {"tried": Results(runs.assign(feasible=True, optimum=least), {}, pd.DataFrame())}
    assert readings.excluded([quantity], found, "mine") == why
    assert readings.excluded([quantity], found, None) in ("", why)


def test_the_order_of_printed_means_beside_ours():
    names = [f"m{number}" for number in range(6)]
    printed = pd.DataFrame({"method": names, "value": [3, 1, 2, 6, 5, 4], "n": 2, "votes": True})
    quantity = readings.Quantity("tried", {}, {}, "length", "mean", 2, None, ["method"], printed)
    runs = pd.DataFrame({"method": names, "repeat": 0, "feasible": True})
    found = Results(runs.assign(length=[3, 1, 2, 6, 5, 4]), {}, pd.DataFrame())
    reverse = found._replace(runs=found.runs.assign(length=-found.runs["length"]))
    assert readings.lowest_order([quantity], {"tried": found}) == pytest.approx(1)
    assert readings.lowest_order([quantity], {"tried": reverse}) == pytest.approx(-1)
    assert np.isnan(readings.lowest_order([quantity._replace(statistic="count")], {}))


def test_an_excluding_sentence_saves_the_runs_and_pairs_are_tried():
    made, _ = job("tharwat2018")
    tried = []

    class Runner:
        assumptions = made.assumptions

        def moved(self, reading):
            return []

        def chunks(self, reading):
            tried.append(readings.name_of(reading))
            return []

    with pytest.raises(ValueError, match="No objects to concatenate"):
        readings.of_study("walks", [], Runner(), made.pairs, None, None, None)
    assert {"default", "O2=0.4, O3b=1.35"} < {*tried}
    assert not {"O7=mirror", "O8=dimension"} & {*tried}


# Claims


def table_of(**columns):
    return pd.DataFrame(columns)


CLAIMS = table_of(id=["C1"] * 2 + ["C2", "C3"], primary=[True, False, True, True])
CLAIMS["variant"], CLAIMS["reason"] = ["", "metric=length", "", ""], "why"
CLAIMS["verdict"] = ["supported", "undecided", "supported", "undecided"]
KEPT = table_of(
    reading=["default", "O1=2", "O2=3", "O3=4"],
    meaning=["", "How fast: 2", "How far: 3", "How high: 4"],
    excluded_by=["", "", "", "Section 1"],
    p=[0.2, 0.3, 0.001, np.nan],
)
TURNED = table_of(id="C1", reading=["default", "O1=2", "O2=3", "O3=4"])


@pytest.mark.parametrize(
    ("verdicts", "verdict", "words", "reason"),
    [
        (["supported", "partly", *["contradicted"] * 2], "supported", "2 of 2", "why"),
        (["supported", "undecided", "no effect", "no effect"], "supported", "1 of 2", "why"),
        (
            ["undecided", "contradicted", "supported", "supported"],
            "depends",
            "0 of 2",
            "supported by default, contradicted with O1 = 2 (How fast: 2); why",
        ),
    ],
)
def test_a_claim_depends_on_a_reading_that_fits_and_decides_the_opposite(
    verdicts, verdict, words, reason
):
    found = by_reading.told(CLAIMS, KEPT, TURNED.assign(verdict=verdicts), {})
    assert [*found["verdict"]] == [verdict, "undecided", "supported", "undecided"]
    assert found["readings"][0] == f"supported under {words} readings"
    assert [*found["readings"][1:]] == ["", by_reading.BY_DEFAULT, ""]
    assert found["reason"][0] == reason


def test_where_no_reading_fits_all_that_nothing_excludes_count():
    verdicts = ["supported", "supported", "no effect", "contradicted"]
    none_fits = KEPT.assign(p=[0.001, 0.002, 0.001, np.nan])
    found = by_reading.told(CLAIMS, none_fits, TURNED.assign(verdict=verdicts), {})
    assert found["verdict"][0] == "depends"
    assert found["readings"][0] == "supported under 2 of 3 readings"


def test_a_claim_depends_on_a_variant_with_any_other_verdict():
    claims = CLAIMS.assign(verdict=["supported", "partly", "supported", "undecided"])
    found = by_reading.told(
        claims, pd.DataFrame(), pd.DataFrame(), {"metric=length": "metric length"}
    )
    assert [*found["verdict"]] == ["depends", "partly", "supported", "undecided"]
    assert found["reason"][0] == "supported by default, partly with metric length; why"
    assert {*found["readings"]} == {""}


@pytest.mark.parametrize("key", READ)
def test_the_kept_readings_are_those_of_today(key):
    made, quantities = job(key)
    kept = pd.read_csv(TREE / outcome.KEPT / f"{key}_readings.csv")
    names = [readings.name_of(each) for each in readings.listed(made.assumptions, made.pairs)]
    assert [*kept["reading"]] == names
    assert (kept["numbers"] == sum(each.printed["votes"].sum() for each in quantities)).all()


@pytest.mark.parametrize(
    ("study", "claim", "hangs_on"),
    [
        *(("meledje", claim, "M3 = none") for claim in ("C1", "C3", "C4", "C10")),
        *(("elhoseny2017", claim, "metric ") for claim in ("C1", "C2", "C3", "C6", "C17")),
        *(("ma2020", claim, "strong") for claim in ("C4", "C24")),
        ("ma2020", "C6", "strict corners"),
    ],
)
def test_what_is_known_to_turn_does(study, claim, hangs_on):
    kept = (
        pd.read_csv(TREE / outcome.KEPT / "claims.csv").query("primary").set_index(["study", "id"])
    )
    assert kept.loc[(study, claim), "verdict"] == "depends"
    assert hangs_on in kept.loc[(study, claim), "reason"]


def test_the_order_of_chaotic_maps_is_reversed_with_an_inertia_of_1_alone():
    kept = pd.read_csv(TREE / outcome.KEPT / "tharwat2018_readings.csv").set_index("reading")
    assert kept.loc["default", "order"] < -0.5 < 0 < kept.loc["O2=0.4, O3b=1.35", "order"]
    assert (kept.loc[["default", "O2=0.4, O3b=1.35"], "p"] >= readings.LEAST_P).all()


@pytest.mark.parametrize(
    ("study", "reading", "why"),
    [
        ("meledje", "M19=closed", "a printed mean lies below the exact optimum"),
        ("elhoseny2017", "O1=0.1", "the proposed method returns no path"),
    ],
)
def test_what_is_known_to_be_excluded_is(study, reading, why):
    kept = pd.read_csv(TREE / outcome.KEPT / f"{study}_readings.csv").set_index("reading")
    assert kept.loc[reading, "excluded_by"] == why
    assert kept["excluded_by"].isna()["default"]
