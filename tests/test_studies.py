"""What only one study needs: its functions for claims, its data for figures, and its audit; and
that its files name what exists.
"""

import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from fields import EQUAL, PUBLIC, among_circles
from studies import FOLDER as STUDIES
from studies import KEYS, arguments, drawing, problem_of, published
from studies import study as shared

from bezierplan.analysis import metrics
from bezierplan.analysis.audit import audit, rules
from bezierplan.analysis.results import Results
from bezierplan.papers.tharwat2018 import functions as tharwat2018
from bezierplan.planners import chaotic_pso
from bezierplan.planners.parts import chaotic_maps
from bezierplan.schema import checked
from bezierplan.study import alternatives, checks, jobs, loading

THARWAT = checked.read(STUDIES / "tharwat2018" / "experiments.yaml")
SWARM = {name: value for name, value in THARWAT["settings"].items() if not isinstance(value, dict)}
# Of the planner's settings.
SAMPLES, BETA = 100, 100.0
SEQUENCES = arguments("tharwat2018", "chaotic_sequences")
problem = partial(problem_of, "tharwat2018")


def faults(rows):
    return {(row["item"], row["place"], row["rule"]) for row in rows if not row["consistent"]}


def test_audit_of_song2016():
    rows = rules.check_rules(published("song2016"))
    (row,) = rows
    assert (row["printed"], row["consistent"]) == (8, True)
    late = published("song2016")["table1"].replace({"value": {26.0: 101.0}})
    found = faults(rules.check_rules(published("song2016") | {"table1": late}))
    assert len(found) == (late["value"] == 101).sum() > 0


def test_chaotic_sequences():
    table = tharwat2018.chaotic_sequences(**SEQUENCES)
    assert table.groupby("map").size().to_dict() == dict.fromkeys(tharwat2018.CHAOTIC, 500)
    assert table["value"].between(0, 1).all()
    for name, own in table.groupby("map"):
        again = chaotic_maps.compute_sequence(
            name, own["value"].iloc[0], 500, SEQUENCES["singer_mu"]
        )
        assert again.values.tolist() == own["value"].to_list()
        assert again.collapsed_at == 0


def test_parameters_of_the_maps_are_those_in_force():
    assert SEQUENCES["singer_mu"] == SWARM["singer_mu"]


def test_gauss_above():
    """The exact share is 1 - log2(1.7)."""
    mark, share, (low, high), sequences = tharwat2018.gauss_above({}, {}, {}, limit=0.7)
    assert (mark, sequences) == ("-", tharwat2018.SEQUENCES)
    assert low < 1 - math.log2(1.7) < high
    assert low < share < high
    assert high - low < 0.01


WORLDS = {"equal": among_circles(EQUAL), "public": among_circles(PUBLIC)}
# Control points x, then y, and the fitness among both.
FIXED = {
    "straight": ([1, 2, 3], [1.5, 3, 4.5], 118.766232, 95.050708),
    "far": ([6, 6, 6], [0, 3, 6], 10.665079, 10.665079),
    "loop": ([-4, -2, 2], [2, 8, 8], 12.543342, 12.543342),
    "public best": ([0.7197, -0.1836, 2.2284], [2.1662, 2.8501, 1.1334], 113.744577, 7.518209),
    "corner": ([10, 10, 10], [-10, -10, -10], 32.359578, 27.685773),
}


def fitness(points, world=None):
    """Of a curve from start to target with some control points between them, on a map of the study
    unless told otherwise.
    """
    path = np.array([[(0, 0), *points, (4, 6)]], dtype=float)
    return tharwat2018.compute_fitness(path, world or problem("equal"), SAMPLES, BETA)[0]


@pytest.mark.parametrize("name", FIXED)
@pytest.mark.parametrize(("world", "column"), [("equal", 2), ("public", 3)])
def test_fitness(name, world, column):
    x, y, *_ = FIXED[name]
    assert fitness(zip(x, y), WORLDS[world]) == pytest.approx(FIXED[name][column], abs=2e-6)


def test_fitness_is_that_of_the_planner():
    settings = SWARM | {"chaotic_term": "none"}
    for seed in range(5):
        plan = chaotic_pso.plan(
            problem("equal"),
            np.random.default_rng(seed),
            **settings | {"particles": 5, "iterations": 2},
        )
        assert fitness(plan.path.points[1:-1]) == pytest.approx(plan.objective, rel=1e-12)


def test_best_known_curve():
    # Its coordinates are rounded.
    assert fitness(tharwat2018.BEST_KNOWN) == pytest.approx(9.3436, abs=3e-4)


def test_local_minima():
    bowl = np.add.outer(np.arange(-4, 5) ** 2, np.arange(-3, 6) ** 2)
    assert np.argwhere(tharwat2018.find_local_minima(bowl)).tolist() == [[4, 3]]
    ridges = np.array([0.0, 1.0, 0.0, 1.0, 0.0])
    assert tharwat2018.find_local_minima(-np.outer(ridges, ridges)).sum() == 4
    assert not tharwat2018.find_local_minima(np.zeros((5, 5))).any(), "not strict"


def test_nodes_of_one_valley_are_one_minimum():
    """A narrow valley oblique to the grid has many local minima, two wells that a ridge parts are
    two.
    """
    x, y = np.meshgrid(np.linspace(-1, 1, 81), np.linspace(-1, 1, 81), indexing="ij")
    valley = 10 + np.abs(y - 0.37 * x) + 0.01 * x**2
    assert tharwat2018.find_local_minima(valley).sum() > 1
    assert np.abs(np.argwhere(tharwat2018.find_valleys(valley)) - 40).max() <= 1
    assert tharwat2018.find_valleys(valley).sum() == 1
    wells = 10 + np.minimum((x - 0.5) ** 2, 0.1 + (x + 0.5) ** 2) + y**2
    assert np.argwhere(tharwat2018.find_valleys(wells)).tolist() == [[20, 40], [60, 40]]
    assert not tharwat2018.find_local_minima(np.add.outer(np.arange(5), np.arange(5))).any(), (
        "at the edge"
    )


def results_of(runs):
    """Results of the experiment `maps` with some rows."""
    return Results(pd.DataFrame(runs), {"equal": problem("equal")}, pd.DataFrame())


def on_maps(where):
    """A check on the experiment `maps`, as far as a function of the study asks it."""
    return SimpleNamespace(experiment="maps", where=where)


def test_landscape():
    """Numbers of an independent computation; the correlation is that of
    `bowl_with_local_minima`.
    """
    known = {"planner": "chaotic_pso", "drew": True, "problem": "equal", "workspace": "equal"}
    found = results_of([known | {"samples": SAMPLES, "beta": BETA}])
    surface = tharwat2018.compute_landscape(found)
    side = tharwat2018.GRID
    assert len(surface) == side**2
    values = surface["objective"].to_numpy().reshape(side, side)
    assert values.min() >= math.dist((0, 0), (4, 6))
    assert tharwat2018.find_local_minima(values).sum() == 1
    place = surface.iloc[[17 * side + 150]]
    points = np.array(tharwat2018.BEST_KNOWN)
    points[tharwat2018.MOVED] = place[["x", "y"]].to_numpy()[0]
    assert fitness(points) == pytest.approx(place["objective"].iloc[0], rel=1e-12)
    check = on_maps({"workspace": "equal"})
    mark, effect, interval, nodes = tharwat2018.bowl_with_local_minima(check, {"maps": found}, {})
    assert (mark, interval, nodes) == ("-", None, side**2)
    assert effect == pytest.approx(0.17, abs=0.01)
    drawn = tharwat2018.fitness_landscape(found)
    assert drawn["part"].value_counts().to_dict() == {
        "node": side**2,
        "minimum": 1,
        "lowest": 1,
        "fixed": 2,
    }
    shown = drawn[drawn["part"] == "minimum"].set_index(["x", "y"]).index
    lowest = surface[tharwat2018.find_local_minima(values).ravel()].set_index(["x", "y"]).index
    assert shown.isin(lowest).all()
    assert drawn.loc[drawn["part"] == "lowest", "objective"].item() == values.min()


# Round the circles of the workspace `equal`: above all, below all, and between them.
WAYS = {
    "above": [(-4, 2), (-2, 8), (2, 8)],
    "below": [(6, 0), (6, 3), (6, 6)],
    "between": [(-0.4768, 4.5057), (1.8022, 0.8887), (3.1746, 4.9328)],
}


def run(way, feasible=True, length=8.0):
    points = np.ravel([(0, 0), *WAYS[way], (4, 6)]).astype(float).tolist()
    path = {"path_curve": "bezier", "path_points": points, "length": length}
    return {"problem": "equal", "feasible": feasible} | path


def test_homotopy_class():
    """A circle to the left of the path is swept counterclockwise. Circle 0 is the upper one, 1 the
    right one, 2 the one near the start.
    """
    found = metrics.compute_values(
        pd.DataFrame([run(way) for way in WAYS]), "homotopy", {"equal": problem("equal")}
    )
    assert dict(zip(WAYS, found)) == {"above": 0, "below": 7, "between": 1}
    made = pd.DataFrame([run("between"), run("above"), run("between", feasible=False)])
    made["bound_path"] = [np.ravel([(0, 0), *WAYS["between"], (4, 6)])] * 3
    assert metrics.compute_values(made, "best_corridor", {"equal": problem("equal")}).to_list() == [
        1,
        0,
        0,
    ]


@pytest.mark.parametrize(
    ("runs", "mark", "classes", "counted"),
    [
        ([run("above"), run("above")], "?", 1, 2),
        ([run("above")] * 59, "-", 1, 59),
        ([run("above"), run("below"), run("between"), run("above"), run("below")], "+", 2, 5),
        (
            [run("above"), run("above", feasible=False), run("below"), run("below", length=8.2)],
            "?",
            0,
            3,
        ),
    ],
)
def test_several_homotopy_classes(runs, mark, classes, counted):
    check = on_maps({"feasible": True})
    found = results_of(runs)
    assert tharwat2018.several_homotopy_classes(check, {"maps": found}, {}) == (
        mark,
        classes,
        None,
        counted,
    )


def test_ends_are_those_of_the_problems():
    marks = drawing("tharwat2018", "figure5").set_index("role")[["x", "y"]]
    for described in THARWAT["problems"].values():
        assert marks.loc["start"].to_list() == described["start"]
        assert marks.loc["target"].to_list() == described["target"]


def test_movement_follows_equation_8():
    """The parts of each velocity join head to tail from the particle's place to its next one; C1
    and C2 are the defaults.
    """
    inertia, c1, c2 = (SWARM[name] for name in ("inertia", "c1", "c2"))
    marks = drawing("tharwat2018", "figure2")
    best = marks.loc[marks["group"] == "G 0", "x"].item()
    # Of each particle: place, velocity, its best place, and two random numbers.
    particles = ((1, 1.5, 3, 0.5, 0.3), (13, -1, 11.5, 0.6, 0.25))
    for number, (x, v, p, r1, r2) in enumerate(particles):
        arrows = [
            marks[marks["group"] == f"{part} {number}"]["x"].to_list()
            for part in ("inertia", "cognition", "social part")
        ]
        assert arrows[0][0] == x
        assert [head for _, head in arrows[:-1]] == [tail for tail, _ in arrows[1:]]
        moved = x + inertia * v + c1 * r1 * (p - x) + c2 * r2 * (best - x)
        assert arrows[-1][1] == pytest.approx(moved)
        assert marks.loc[marks["group"] == f"new x {number}", "x"].item() == pytest.approx(moved)


def test_flow_chart_has_a_box_around_every_step():
    marks = drawing("tharwat2018", "figure4")
    boxes = marks[marks["mark"] == "cell"]
    words = marks[(marks["mark"] == "text") & ~marks["text"].isin(["yes", "no"])]
    assert boxes[["x", "y"]].to_numpy().tolist() == words[["x", "y"]].to_numpy().tolist()
    heads = marks[marks["mark"] == "arrow"].groupby("group").last()[["x", "y"]].to_numpy()
    for x, y in heads:
        inside = (np.abs(boxes["x"] - x) <= boxes["width"] / 2) & (
            np.abs(boxes["y"] - y) <= boxes["height"] / 2
        )
        assert inside.sum() == 1, "every arrow ends at a box"


def test_audit_of_tharwat2018():
    study = shared("tharwat2018")
    specs = jobs.build_audit(study, "full").tables
    tables = published("tharwat2018")
    compared = {name: audit.read_printed_numbers(study.find_published_file(name)) for name in specs}
    rows = audit.build_audit(
        "tharwat2018", rules.check_rules(tables) + audit.check_any_paper(compared, specs)
    )
    wrong = rows[rows["consistent"].map(str) == "False"]
    sums = rows[rows["rule"].str.contains("add to")].set_index("item")
    # Those of Tables 3 and 4 add up.
    assert sums["printed"].round(1).to_dict() == {
        "table3, table4": 2,
        "table5": 13.8,
        "table6": 32.2,
    }
    assert sums["limit"].to_dict() == {"table3, table4": 2, "table5": 15, "table6": 55}
    assert sums["consistent"].to_dict() == {
        "table3, table4": True,
        "table5": False,
        "table6": False,
    }
    below_one = wrong[wrong["rule"].str.startswith("a mean rank of")]
    assert below_one["place"].to_list() == [
        f"method=cpso2_singer, obstacles={k}, metric=rank" for k in (1, 2)
    ]
    said = wrong[wrong["rule"].str.startswith("the text")]
    # Logistic before Sine; Circle and Sinusoidal before Piecewise; CPSO-II Gauss and Piecewise
    # before CPSO-I.
    assert len(said) == 5
    # With two obstacles and with five, the printed best value is better than with one less.
    shorter = wrong[wrong["rule"].str.startswith("objective goes up along obstacles")]
    assert shorter["arithmetic"].to_list() == ["8.04 <= 7.71", "8.45 <= 8.29"]
    assert len(wrong) == 2 + 2 + 5 + 1 + 2
    (repeated,) = rows[rows["rule"].str.startswith("Table 5 has")]["printed"]
    assert repeated == 8


def test_methods_of_tharwat2018():
    """Eight maps in each variant, of which the Tent map has a fixed start of its own; the collapsed
    sequence never moves.
    """
    for variant, term in (("cpso1", "cognitive"), ("cpso2", "social")):
        for name in tharwat2018.CHAOTIC:
            own = THARWAT["methods"][f"{variant}_{name}"]["settings"]
            assert own == {"chaotic_term": term, "chaotic_map": name} | (
                {"chaotic_start": 0.6} if name == "tent" else {}
            )
    frozen = SWARM | THARWAT["methods"]["cpso2_gauss_collapsed"]["settings"]
    plan = chaotic_pso.plan(problem("equal"), np.random.default_rng(0), **frozen)
    assert plan.extra["zeta_collapsed_at"] == 1
    assert set(plan.history.tolist()) == {plan.objective}


@pytest.mark.parametrize("key", KEYS)
def test_study_is_free_of_faults(key):
    """All checks pass, and no test has changed the copy that all of them share."""
    study = loading.load([STUDIES / key])[key]
    assert not checks.Checks(study).check()
    assert study == shared(key)


def test_the_default_of_an_assumption_is_what_the_study_uses():
    """One knob turned in experiments.yaml turns it, too; some problems may have their own."""
    study = shared("ma2020")
    own = {each.id: alternatives.find_default(study, each) for each in study.assumptions}
    assert own["O2"] == study.settings["control_points"]
    assert own["O14h"]["ga"] == study.methods["ga"].settings["generations"]
    assert own["O7"]["bca"] == study.settings["elitism"]
    turned = study.but(settings=study.settings | {"control_points": 5})
    assert not checks.Checks(turned).check()
    first = next(each for each in study.assumptions if each.id == "O2")
    assert alternatives.find_default(turned, first) == 5
