"""What a method adds to the rounded shortest path: planted runs beside the line over its radii."""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from panels import options_of

import bezierplan as bp
from bezierplan.analysis.results import Results
from bezierplan.figures.panels import trade
from bezierplan.geometry.tightest_turn import largest_curvature
from bezierplan.planners.rounded_shortest_path import plan
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem

NARROW, WIDE = np.zeros((10, 10), dtype=bool), np.zeros((10, 10), dtype=bool)
NARROW[0:6, 4] = NARROW[4:10, 7] = WIDE[0:6, 5] = True
PROBLEMS = {
    name: Problem(name, Grid(occupied, 1.0, "cell"), (0.5, 0.5), (9.5, 9.5))
    for name, occupied in (("narrow", NARROW), ("wide", WIDE))
}
BOUNDS = {name: bp.plan(each, "shortest_path").length for name, each in PROBLEMS.items()}
RADIUS = 0.7


def runs_of(method, factor, problem="narrow", radius=RADIUS, free=10, planner="mine"):
    """Ten runs whose paths are the shortest one with a turning radius, of which some are free; with
    an excess that is a multiple of that path's.
    """
    found = plan(
        PROBLEMS[problem], np.random.default_rng(0), turning_radius=radius, excess=math.inf
    )
    bound = BOUNDS[problem]
    own = {"method": method, "problem": problem, "planner": planner, "cpu_s": 0.01, "bound": bound}
    own |= {"length": bound + factor * (found.objective - bound) if radius else factor * bound}
    own |= {"path_curve": found.path.curve, "path_points": found.path.points.ravel()}
    return [
        own | {"id": f"{method}/{problem}/{n}", "condition": problem, "feasible": n < free}
        for n in range(10)
    ]


def drawn(*runs, **options):
    table = pd.DataFrame([run for own in runs for run in own])
    frame = trade.data(Results(table, PROBLEMS, pd.DataFrame()), options_of(trade, **options))
    return frame[frame["part"] == "line"], frame[frame["part"] == "method"].set_index("method")


def test_the_line_gets_longer_as_it_gets_smoother_from_sharp_to_the_widest():
    line, _ = drawn(runs_of("above", 2))
    line = line.sort_values("radius")
    assert line["radius"].iloc[[0, -1]].tolist() == [0, math.inf]
    assert (line["x"].iloc[0], line["y"].iloc[0]) == (math.inf, pytest.approx(0, abs=1e-9))
    assert (np.diff(line["x"]) <= 0).all()
    assert (np.diff(line["y"]) > -1e-3).all()
    within = line[(line["radius"] > 0) & np.isfinite(line["radius"])]
    assert within["x"].to_numpy() == pytest.approx(1 / within["radius"].to_numpy(), rel=0.03)


@pytest.mark.parametrize("radius", [0.3, 0.7, 0.73, 1.1])
def test_a_method_adds_something_only_under_the_line_and_if_it_is_free(radius):
    under = {"factor": 0.5, "radius": radius}
    _, own = drawn(
        runs_of("under", **under),
        runs_of("above", 1.02, radius=radius),
        runs_of("seldom", **under, free=9),
        runs_of("rounded", **under, planner="rounded_shortest_path"),
    )
    assert own["adds"].drop("rounded").to_dict() == {"under": 1, "above": 0, "seldom": 0}
    assert math.isnan(own["adds"]["rounded"])
    assert own["free"]["seldom"] == 0.9
    _, in_time = drawn(runs_of("under", **under), x="cpu_s")
    assert in_time["x"]["under"] == 0.01
    assert "adds" not in in_time


def test_a_note_names_the_methods_that_add_something():
    _, own = drawn(runs_of("under", 0.5), runs_of("above", 2), runs_of("never", 2, free=0))
    scene = SimpleNamespace(labels={"under": "Under"})
    for table, said in ((own, "no free path: never; adds something: Under"), (own[:1], ": none")):
        assert trade._write_note(table.reset_index(), scene).caption.endswith(said)


def test_paths_with_corners_are_counted_and_enter_no_median():
    smooth = runs_of("mixed", 0.5)
    mixed = [*smooth[:3], *runs_of("mixed", 1.5, radius=0)[3:]]
    _, own = drawn(mixed, runs_of("cornered", 1.5, radius=0), runs_of("smooth", 0.5))
    assert own["cornered"].to_dict() == {"mixed": 7, "cornered": 10, "smooth": 0}
    assert own["x"]["mixed"] == own["x"]["smooth"] < math.inf
    assert own["y"]["mixed"] == own["y"]["smooth"]
    assert own["x"]["cornered"] == math.inf
    assert own["y"]["cornered"] == pytest.approx(0.5)
    assert own["adds"].to_dict() == {"mixed": 0, "cornered": 0, "smooth": 1}


def test_of_a_family_the_problems_are_counted_each_beside_its_own_line():
    line, own = drawn(
        runs_of("once", 0.5),
        runs_of("once", 3, "wide"),
        runs_of("twice", 0.5),
        runs_of("twice", 0.5, "wide"),
    )
    assert own[["adds", "problems"]].to_dict("index") == {
        "once": {"adds": 1, "problems": 2},
        "twice": {"adds": 2, "problems": 2},
    }
    apart = [drawn(runs_of("once", 1, name))[0].set_index("radius") for name in PROBLEMS]
    both = line.set_index("radius").loc[1.0, "y"]
    assert both == pytest.approx(sum(each.loc[1.0, "y"] for each in apart) / 2)


def test_a_straight_path_bends_nowhere_and_cannot_be_beaten():
    free = Problem("free", PROBLEMS["wide"].workspace, (0.5, 0.5), (0.5, 9.5))
    found = bp.plan(free, "shortest_path")
    assert largest_curvature(found.path) == 0
    line = trade._compute_lines({"free": free}, pd.Series({"free": found.length}))
    assert line[["x", "y"]].to_numpy() == pytest.approx(0, abs=1e-9)
    assert not trade.adds(line[["x", "y"]].to_numpy(), 0.0, 0.0, 1.0)
