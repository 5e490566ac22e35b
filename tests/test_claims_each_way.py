"""Every claim of the five papers on runs where its sentence is true and where it is false: it has
to come out supported, and not.

The runs are made from the claim's own checks, by large effects and small noise, so a claim whose
checks contradict each other fails here. Claims that ask a function or printed numbers have data of
their own.
"""

import itertools
from collections import defaultdict
from functools import cache

import numpy as np
import pandas as pd
import pytest
from studies import KEYS, published, study

from bezierplan.analysis import metrics, statistics, study_code
from bezierplan.analysis.claims import comparisons, judge, variants
from bezierplan.analysis.claims.check import OfRuns
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.material import Material
from bezierplan.analysis.results import Results
from bezierplan.papers.tharwat2018 import functions as tharwat2018
from bezierplan.schema.model import convert_to_list
from bezierplan.study import jobs
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

UNITS, LAYOUTS = 80, 8
# A level is so many times the one below; single runs are about so much off, as a share.
STEP, NOISE = 3.0, 0.0005
TRUTHS = {
    "claimed_feasible",
    "feasible",
    "optimal",
    "near_optimal",
    "infeasible",
    "keeps_distance",
    "best_corridor",
    "collided",
}
SPREADS = ("iqr", "std", "range")
PROBLEM = Problem("", from_lines(["..", ".."], 1.0, "m"), (0.5, 0.5), (1.5, 1.5))
FALSE_VERDICTS = {"contradicted", "no effect", "partly"}


@cache
def for_claims(key):
    return jobs.build_claims(study(key), "full").study


def deciding(key, claim) -> list[OfRuns]:
    """The deciding checks of the deciding variant, `rest` filled in, seconds replaced by the work
    that counts.
    """
    material = Material(for_claims(key)._replace(variant_of={}), {}, published(key), {})
    first, *_ = variants.list_variants(claim)
    checks = [comparisons.fill_rest(check, claim, material) for check in claim.checks]
    return [
        variants.split_work(check)[0]
        for check in variants.apply_variant(checks, first, first)
        if check.primary
    ]


def is_generated(claim) -> bool:
    return all(isinstance(check, OfRuns) for check in claim.checks if check.primary)


def is_untestable(claim) -> bool:
    return any(check.test == "untestable" for check in claim.checks)


def list_claims(fits) -> list[tuple[str, str]]:
    return [(key, claim.id) for key in KEYS for claim in study(key).claims if fits(claim)]


UNTESTABLE, GENERATED = list_claims(is_untestable), list_claims(is_generated)
CASES = list_claims(lambda claim: not is_untestable(claim))


def claim_of(key, identity) -> Claim:
    return next(claim for claim in study(key).claims if claim.id == identity)


# Runs that make a claim true, or its contrary.


def column_of(check) -> str:
    return check.cells or "method"


def factors(key, claim, checks, experiment) -> dict[str, list]:
    """Columns of the runs of an experiment, and the values that the claim's checks ask for."""
    found: dict[str, list] = defaultdict(list)
    own = [check for check in checks if experiment in check.experiments]
    for check in own:
        for column, wanted in check.where.items():
            if column not in metrics.METRICS:
                found[column] += convert_to_list(wanted)
        found[column_of(check)] += check.groups_named
    if any(check.metric == "rank" for check in own):
        part = for_claims(key).artefacts[claim.artefacts[0]][0]
        for column, wanted in part.where.items():
            found[column] += convert_to_list(wanted)
    for check in own:
        for column in [*check.every, *check.pool]:
            if not found[column]:
                found[column] = list(range(LAYOUTS)) if column == "layout" else [1, 2]
        if check.test == "trend" and len(set(found[check.x])) < 3:
            found[check.x] += [10, 20, 30, 40, 50]
    if any(check.replicate == "layout" for check in own):
        found["layout"] = list(range(UNITS))
    found.pop("experiment", None)
    if not found["method"]:
        found["method"] = ["plain"]
    return {column: list(dict.fromkeys(values)) for column, values in found.items()}


def levels(checks, truth, values) -> dict[tuple, dict]:
    """(metric, is it about spread?, column) -> value of the column -> (level, factor): what lies
    above what.
    """
    edges, equal = defaultdict(set), defaultdict(dict)
    for check in checks:
        place = (check.metric, check.statistic in SPREADS, column_of(check))
        match check.test:
            case "lower":
                pairs = [tuple(pair) for pair in check.compared]
                if (*pairs[0][::-1],) in pairs:  # either way round: the groups differ at all
                    pairs = [pair for pair in pairs if pair[0] < pair[1]] if truth else []
            case "trend":
                pairs = list(itertools.pairwise(sorted(values.get(check.x, []))))
            case "equal_within":
                off = check.target if truth else check.target + 10 * check.margin
                for group, other in itertools.product(check.groups, check.than):
                    equal[place][group] = (other, off, check.relative)
                continue
            case _:
                continue
        upwards = (check.direction in (None, "lower", "up")) == truth
        edges[place] |= {(low, high) if upwards else (high, low) for low, high in pairs}
    found = {}
    for place in {*edges, *equal}:
        ranks = dict.fromkeys(itertools.chain.from_iterable(edges[place]), 0)
        for _ in range(len(ranks) + 1):
            changed = [(low, high) for low, high in edges[place] if ranks[high] <= ranks[low]]
            for low, high in changed:
                ranks[high] = ranks[low] + 1
        assert not changed, f"the checks on {place} contradict each other"
        found[place] = {value: (rank, None) for value, rank in ranks.items()}
        for group, (other, off, relative) in equal[place].items():
            found[place][group] = (found[place].get(other, (0, None))[0], (off, relative))
    return found


def happened(check, truth, n, rng) -> np.ndarray:
    """In which of n runs the event of a share happens."""
    if check.pick:
        return np.full(n, truth)
    share = {
        "all": (0.5, 1.0),
        "as printed": (0.5, 1.0),
        "none": (0.5, 0.0),
        "some": (0.0, 0.5),
        "at_least": (0.0, 1.0),
        "at_most": (1.0, 0.0),
    }[check.direction or check.threshold]
    happens = np.zeros(n, dtype=bool)
    happens[: round(share[truth] * n)] = True
    return rng.permutation(happens)


def of_event(check, happens) -> np.ndarray:
    """Values of a metric for which the event of a share happened, or not."""
    if not check.limit:
        return happens
    word, limit = check.limit
    other = {
        "below": (limit, limit - 1),
        "at_most": (limit + 1, limit),
        "above": (limit, limit + 1),
        "at_least": (limit - 1, limit),
    }
    return np.where(happens, *reversed(other[word]))


def made(key, claim, truth) -> dict[str, Results]:
    """Results by experiment on which the claim's sentence is true, or its contrary."""
    checks = deciding(key, claim)
    names = dict.fromkeys(name for check in checks for name in check.experiments)
    results = {}
    for name in names:
        own = [check for check in checks if name in check.experiments]
        columns = factors(key, claim, checks, name)
        repeats = range(
            1
            if columns.get("layout", [0])[-1] == UNITS - 1
            else 12
            if "layout" in columns
            else UNITS
        )
        rows = pd.DataFrame(
            itertools.product(*columns.values(), repeats), columns=[*columns, "repeat"]
        ).assign(experiment=name)
        rng = generator(f"{key}/{claim.id}/{name}/{truth}")
        rows["feasible"] = rows["drew"] = True
        for check in claim.checks:
            for column, wanted in getattr(check, "where", {}).items():
                if column in metrics.METRICS:
                    rows[column] = wanted
        for check in own:
            if check.test == "share":
                rows[check.metric] = of_event(check, happened(check, truth, len(rows), rng))
        above = levels(own, truth, columns)
        for metric in {place[0] for place in above}:
            rank, spread, offset = np.zeros((3, len(rows)))
            factor, most = np.ones(len(rows)), 1
            for (measured, spreads, column), ranks in above.items():
                if measured != metric:
                    continue
                level = {value: known for value, (known, _) in ranks.items()}
                known = rows[column].map(level).fillna(0).to_numpy()
                most = max(most, known.max() + 1)
                if spreads:
                    spread += known
                else:
                    rank += known
                for value, (_, off) in ranks.items():
                    if off is not None:
                        there = rows[column] == value
                        factor[there] *= 1 + off[0] if off[1] else 1
                        offset[there] += 0 if off[1] else off[0]
            if metric in TRUTHS:
                # Of every cell the very share, in a random order.
                places = (
                    rows.assign(at=rng.random(len(rows)))
                    .groupby([column for column in columns if column != "layout"])["at"]
                    .rank(pct=True)
                    .to_numpy()
                )
                rows[metric] = places <= (rank + 0.5) / max(most, 2)
                continue
            centre = 100 * STEP**rank * factor + offset
            rows[metric] = centre * (1 + NOISE * STEP ** (2 * spread) * rng.normal(size=len(rows)))
        others = [column for column in columns if column != "method"]
        rows["condition"] = [",".join(map(str, values)) for values in rows[others].to_numpy()]
        if "problem" not in rows:
            rows["problem"] = "only"
        for metric in {"length", "objective"}.difference(rows):
            rows[metric] = rng.random(len(rows))
        results[name] = Results(
            rows, dict.fromkeys(rows["problem"].unique(), PROBLEM), pd.DataFrame()
        )
    return results


def verdict(key, claim, results, printed=None) -> pd.Series:
    own = study(key)
    functions = study_code.load_functions(own.code_for("functions"))
    own_claims = [
        claim.but(
            variants={name: own[:1] for name, own in claim.variants.items()}, variant_names=[]
        )
    ]
    repeats = dict.fromkeys(results, 10)
    of_study = for_claims(key)._replace(claims=own_claims, repeats=repeats, labels={})
    material = Material(of_study, results, printed or published(key), functions)
    return judge.judge_claims(material)[0].iloc[0]


@pytest.fixture
def columns_alone(monkeypatch):
    """Every metric is a column of the runs, and draws are few."""
    monkeypatch.setattr(
        metrics,
        "METRICS",
        {name: metric._replace(compute=None, needs=()) for name, metric in metrics.METRICS.items()},
    )
    monkeypatch.setattr(statistics, "DRAWS", 200)


@pytest.mark.parametrize("truth", [True, False])
@pytest.mark.parametrize(("key", "identity"), GENERATED)
def test_a_true_sentence_is_supported_and_a_false_one_is_not(key, identity, truth, columns_alone):
    claim = claim_of(key, identity)
    row = verdict(key, claim, made(key, claim, truth))
    shown = row[["verdict", "holds", "where_it_holds", "reason"]].to_list()
    assert row["verdict"] in ({"supported"} if truth else FALSE_VERDICTS), shown


# Seconds differ from machine to machine, and with what else a machine does.


def planners(key, check) -> set[str]:
    """The planners of the methods that a check compares."""
    groups = check.groups_named if check.cells == "method" else []
    return {study(key).methods[name].planner for name in groups}


@pytest.mark.parametrize(("key", "identity"), CASES)
def test_no_claim_is_decided_by_seconds(key, identity):
    """Whether a check names them or a variant does: they are those of our code."""
    claim = claim_of(key, identity)
    first, *_ = assignments = variants.list_variants(claim)
    for assignment in assignments:
        for check in variants.apply_variant(claim.checks, first, assignment):
            assert not (check.primary and variants.split_work(check)[0].timed)


@pytest.mark.parametrize(("key", "identity"), CASES)
def test_counted_work_decides_between_methods_of_one_planner_only(key, identity):
    """An evaluation of another planner is another thing, and settings fix how many there are: two
    groups without variance.
    """
    claim = claim_of(key, identity)
    for check in deciding(key, claim):
        if check.metric in ("evaluations", "points_evaluated"):
            assert len(planners(key, check)) <= 1


# Claims that ask a function, or printed numbers.


def results_of(rows: pd.DataFrame, *names: str, **columns) -> dict[str, Results]:
    """The same rows as runs of experiments of these names, with further columns."""
    described = {
        "condition": "only",
        "problem": "only",
        "workspace": "only",
        "drew": True,
        "feasible": True,
        "length": 1.0,
    } | columns
    rows = rows.assign(
        **{column: value for column, value in described.items() if column not in rows}
    )
    return {
        name: Results(
            rows.assign(experiment=name), dict.fromkeys(rows["problem"], PROBLEM), pd.DataFrame()
        )
        for name in names
    }


def q_statistics(monkeypatch, truth):
    tables = published("elhoseny2017")
    alike = tables["table1"].copy()
    alike.iloc[1, 1:] = alike.iloc[0, 1:]
    return {}, None if truth else tables | {"table1": alike}


def printed_lengths(monkeypatch, truth):
    fields = pd.DataFrame(
        itertools.product(("case1", "case2"), (5, 10, 15, 20, 25)), columns=["route", "obstacles"]
    )
    fields = fields.assign(workspace="published_like", method="mga", repeat=0)
    fields["problem"] = fields["route"] + fields["obstacles"].astype(str)
    made = {}
    for name, side in (("fields100", 100), ("fields200", 200)):
        made |= results_of(fields.assign(octile_bound=1.6 * side), name, side=side)
    numbers = published("elhoseny2017")
    below = {
        name: numbers[name].assign(value=numbers[name]["value"].clip(upper=2 * side))
        for name, side in (("table2", 100), ("table3", 200))
    }
    return made, numbers | below if truth else numbers


def loops(monkeypatch, truth):
    rows = pd.DataFrame({"repeat": range(10), "loops": 40, "endless_loops": 38 if truth else 2})
    return results_of(rows, "endless", method="mga_50"), None


def swarms(monkeypatch, truth):
    rows = pd.DataFrame(
        itertools.product(range(5, 55, 5), range(20)), columns=["particles", "repeat"]
    )
    rows["objective"] = 10 + 0.01 * rows["repeat"] + abs(rows["particles"] - (40 if truth else 10))
    return results_of(rows, "particles", method="cpso2_singer", profile="default"), None


def surface(monkeypatch, truth):
    grid = np.linspace(-1, 1, tharwat2018.GRID)
    x, y = (each.ravel() for each in np.meshgrid(grid, grid, indexing="ij"))
    fitness = np.hypot(x, y) + (0.2 * np.cos(20 * x) * np.cos(20 * y) if truth else 0.0)
    monkeypatch.setattr(
        tharwat2018,
        "compute_landscape",
        lambda results: pd.DataFrame({"x": x, "y": y, "objective": fitness}),
    )
    rows = pd.DataFrame({"repeat": [0], "workspace": "equal", "profile": "default"})
    return results_of(rows, "maps", method="cpso2_singer"), None


def classes(monkeypatch, truth):
    """False: all that converge come to one class; single runs that pass elsewhere do not count."""
    monkeypatch.setitem(
        metrics.METRICS, "homotopy", metrics.METRICS["homotopy"]._replace(compute=None)
    )
    rows = pd.DataFrame({"repeat": range(80), "workspace": "equal", "profile": "default"})
    rows["homotopy"] = np.where(rows["repeat"] < (40 if truth else 1), 1.0, 2.0)
    return results_of(rows, "maps", method="cpso2_singer"), None


def boxes(monkeypatch, truth):
    """One run in ten lies far off: of every map but Singer, or of Singer alone."""
    return outliers_of({"singer"} ^ set(tharwat2018.CHAOTIC) if truth else {"singer"}), None


def outliers_of(maps):
    rows = pd.DataFrame(
        itertools.product(("cpso1", "cpso2"), tharwat2018.CHAOTIC, range(200)),
        columns=["variant", "map", "repeat"],
    )
    far = (rows["repeat"] % 10 == 0) & rows["map"].isin([*maps])
    rows["method"] = rows["variant"] + "_" + rows["map"]
    rows["objective"] = 10.0 + 0.1 * (rows["repeat"] % 7) + 50 * far
    return results_of(rows, "maps", workspace="equal", profile="default")


def sequences(monkeypatch, truth):
    if truth:
        own = tharwat2018.chaotic_maps.compute_sequence

        def low(*given):
            found = own(*given)
            return found._replace(values=0.7 * found.values)

        monkeypatch.setattr(tharwat2018.chaotic_maps, "compute_sequence", low)
    return {}, None


def starts(monkeypatch, truth):
    """All maps are like the logistic map, or like the circle map, which forgets its start."""
    own, like = tharwat2018.chaotic_maps.compute_sequence, "logistic" if truth else "circle"
    monkeypatch.setattr(
        tharwat2018.chaotic_maps, "compute_sequence", lambda _, *given: own(like, *given)
    )
    return {}, None


def corners(monkeypatch, truth):
    """A way round an occupied cell, and BCA's way in between: with a detour that could be left out,
    or without.
    """
    grid = from_lines(["....", ".#..", "...."], 1.0, "cell")
    problem = {"environment1": Problem("environment1", grid, (0.0, 0.0), (4.0, 0.0))}
    way = (
        [(0, 0), (1, 0.9), (2, 0.1), (3, 0.9), (4, 0)]
        if truth
        else [(0, 2), (1, 2), (2, 2), (4, 2)]
    )
    steps = np.diff(np.array(way, dtype=float), axis=0)
    rivals = ("aco", "ga", "aco_ga", "asfa_ga")
    rows = pd.DataFrame({"method": [*rivals, "bca"], "repeat": 0})
    rows["path_points"] = [np.ravel(way).astype(float).tolist()] * len(rows)
    rows["path_curve"] = ["polyline"] * 4 + ["bezier"]
    rows["length"] = [float(np.hypot(*steps.T).sum())] * 4 + [3.9]
    made = results_of(rows, "environments", workspace="environment1", problem="environment1")
    return {name: each._replace(problems=problem) for name, each in made.items()}, None


def fluctuations(monkeypatch, truth):
    """Of 1 % of the mean, or of 40 %."""
    rows = pd.DataFrame({"repeat": range(80), "method": "mga"})
    rows["length"] = rows["evaluations"] = 100.0 + (rows["repeat"] % 2) * (2 if truth else 80)
    return results_of(rows, "reruns", "reruns_dense"), None


def clearances(monkeypatch, truth):
    """Rows of one cell beside a path: BCA-Q passes at 0.4 cells, the others at 0.1; or the other
    way round.
    """
    grid = from_lines(["....", "....", "####"], 1.0, "cell")
    problem = {"environment1": Problem("environment1", grid, (0.0, 0.0), (4.0, 0.0))}
    methods = ("aco", "ga", "aco_ga", "asfa_ga", "bca", "bca_q")
    rows = pd.DataFrame(itertools.product(methods, range(80)), columns=["method", "repeat"])
    apart = np.where((rows["method"] == "bca_q") == truth, 0.4, 0.1) + 0.0001 * rows["repeat"]
    rows["path_points"] = [[0.0, 1 + each, 4.0, 1 + each] for each in apart]
    rows = rows.assign(path_curve="polyline", length=4.0 + 0.01 * rows["repeat"])
    both = [
        rows.assign(workspace=name, condition=name, problem="environment1")
        for name in ("environment1", "environment2")
    ]
    (found,) = results_of(pd.concat(both, ignore_index=True), "environments").values()
    return {"environments": found._replace(problems=problem)}, None


def quoted(monkeypatch, truth):
    tables = published("ma2020")
    other = tables["text_numbers"].assign(value=lambda rows: rows["value"] + 1)
    return {}, None if truth else tables | {"text_numbers": other}


BY_HAND = {
    ("elhoseny2017", "C10"): fluctuations,
    ("elhoseny2017", "C20"): q_statistics,
    ("elhoseny2017", "C23"): printed_lengths,
    ("elhoseny2017", "C33"): loops,
    ("tharwat2018", "C3"): swarms,
    ("tharwat2018", "C16"): surface,
    ("tharwat2018", "C17"): classes,
    ("tharwat2018", "C20"): boxes,
    ("tharwat2018", "C39"): sequences,
    ("tharwat2018", "C46"): starts,
    ("ma2020", "C6"): clearances,
    ("ma2020", "C18"): quoted,
    ("ma2020", "C27"): corners,
}


def test_every_claim_is_tried_each_way():
    assert {*GENERATED, *BY_HAND} == set(CASES)
    assert not set(GENERATED) & set(BY_HAND)


@pytest.mark.parametrize(("key", "identity"), UNTESTABLE)
def test_what_nothing_tests_is_untestable_and_says_why(key, identity):
    claim = claim_of(key, identity)
    row = verdict(key, claim, {})
    deciding, *secondary = claim.checks
    assert all(check.secondary for check in secondary)
    assert (row["verdict"], row["reason"]) == ("untestable", deciding.reason)


@pytest.mark.parametrize("truth", [True, False])
@pytest.mark.parametrize(("key", "identity"), BY_HAND)
def test_claims_by_hand_each_way(key, identity, truth, monkeypatch):
    results, printed = BY_HAND[key, identity](monkeypatch, truth)
    row = verdict(key, claim_of(key, identity), results, printed)
    assert row["verdict"] == ("supported" if truth else "contradicted"), row.to_dict()


@pytest.mark.parametrize("maps", [(), tharwat2018.CHAOTIC])
def test_maps_that_are_all_alike_say_nothing_about_outliers_of_singer(maps):
    row = verdict("tharwat2018", claim_of("tharwat2018", "C20"), outliers_of(maps))
    assert row["verdict"] == "no effect"
    assert abs(row["effect"]) < 0.05


@pytest.mark.parametrize(("truth", "word"), [(True, "holds"), (False, "fails")])
def test_a_claim_that_is_judged_by_a_criterion_of_ours_says_so_first(columns_alone, truth, word):
    claim = claim_of("song2016", "C3")
    results = made("song2016", claim, truth)
    row = verdict("song2016", claim, results)
    assert row["reason"].startswith(f"{word} by our criterion alone")
    if truth:  # in one of its two problems
        runs = results["routes"].runs
        runs.loc[runs["problem"] == "0_255", "generation_5pct"] = 99
        row = verdict("song2016", claim, results)
        assert row["reason"].startswith("holds in part by our criterion alone")
