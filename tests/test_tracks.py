"""Figures of a landscape and of tracks on it: reproduced runs pass through what they passed
through.
"""

import numpy as np
import pandas as pd
import pytest
from panels import options_of, panels_of
from studies import study

from bezierplan.analysis import metrics, results
from bezierplan.figures import sheet
from bezierplan.figures.panels import Sources
from bezierplan.papers.tharwat2018.panels import landscape, tracks
from bezierplan.planners import chaotic_pso
from bezierplan.planners.parts import penalised
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Chunk
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

SETTINGS = study("tharwat2018").resolve_settings("pso")
FIELD = Problem(
    "field",
    Circles((-10.0, 10.0, -10.0, 10.0), np.array([[2.0, 3.0]]), np.array([1.0]), "m"),
    (0.0, 0.0),
    (4.0, 6.0),
)
CHUNK = Chunk(
    study="study",
    experiment="routes",
    method="swarm",
    planner="chaotic_pso",
    settings=SETTINGS | {"iterations": 20},
    problems={"field": {"workspace": "field"}},
    vary={"inertia": [1.0, 0.7]},
    seeds="common",
    repeats=[0, 6],
)


def surface(found: results.Results) -> pd.DataFrame:
    """A bowl with two minima over a small grid, and a control point that stays."""
    x, y = (
        side.ravel()
        for side in np.meshgrid(np.linspace(-10, 10, 9), np.linspace(-10, 10, 7), indexing="ij")
    )
    nodes = pd.DataFrame({"part": "node", "x": x, "y": y, "objective": 1 + x**2 + y**2})
    places = pd.DataFrame(
        {"part": ["minimum", "lowest", "fixed"], "x": [5.0, 0.0, 1.0], "y": [5.0, 0.0, 2.0]}
    )
    return pd.concat([nodes, places], ignore_index=True)


@pytest.fixture(scope="module")
def found() -> results.Results:
    table, _ = execution.run_chunk({"field": FIELD}, CHUNK)
    bounds = problems.compute_bounds({"field": FIELD}, {}).to_pandas()
    runs = table.to_pandas()
    runs["path_points"] = runs["path_points"].map(list)
    return results.join_bounds(runs[runs["inertia"] == 0.7], {"field": FIELD}, bounds)._replace(
        jobs={"swarm": CHUNK}
    )


BY = {"by": "homotopy"}


def test_ways_are_those_of_the_runs(found):
    """The objective along the way of all control points is the run's history: nothing but the run
    itself can do that.
    """
    ways = [
        tracks.data(found, options_of(tracks, **BY, point=point)).query("part == 'way'")
        for point in range(5)
    ]
    first = ways[0]["run"].iloc[0]
    ways = [way[way["run"] == first] for way in ways]
    points = np.stack([way[["x", "y"]].to_numpy() for way in ways], axis=1)
    run = found.runs.set_index("id").loc[first]
    again = chaotic_pso._build_objective(FIELD, fill_settings(chaotic_pso.Settings, CHUNK.settings))
    curve, scratch = np.empty((2, SETTINGS["samples"])), np.empty(SETTINGS["samples"])
    for best, position in zip(run["history"], points[:, 1:-1]):
        penalised.write_curve(position.T.ravel(), again, curve)
        length = penalised.measure_length(curve, scratch)
        violation, _ = penalised.measure_violation(curve, again, scratch)
        assert penalised.compute_fitness(length, violation, again) == pytest.approx(best, rel=1e-12)
    np.testing.assert_array_equal(points[-1].ravel(), run["path_points"])


def test_the_best_run_of_each_of_the_commonest_values_is_drawn(found):
    runs = found.runs.assign(group=metrics.compute_values(found.runs, "homotopy", found.problems))
    runs = runs.query("feasible")
    counts = runs["group"].value_counts()
    assert len(counts) == 2, "paths pass the circle on either side"
    best = {runs.loc[own["objective"].idxmin(), "id"] for _, own in runs.groupby("group")}
    frame = tracks.data(found, options_of(tracks, **BY, point=1))
    assert set(frame["run"].dropna()) == best
    assert set(frame["groups"]) == {2}
    commonest = frame["run"].dropna().iloc[0]
    assert runs.set_index("id")["group"][commonest] == counts.index[0] or counts.nunique() == 1


def test_faults_of_panels_are_said(found):
    other = found._replace(jobs={"swarm": CHUNK._replace(settings=CHUNK.settings | {"c1": 1.4})})
    two = found._replace(runs=pd.concat([found.runs, found.runs.assign(problem="other")]))
    for source, point, fault in (
        (other, 1, r"study/routes/field,inertia=0.7/swarm/\d: its rerun ends in another path"),
        (found, 5, "point: 5; expected less than 5"),
        (two, 1, "exactly one problem"),
    ):
        with pytest.raises(ValueError, match=fault):
            tracks.data(source, options_of(tracks, **BY, point=point))
    with pytest.raises(ValueError, match="exactly one problem"):
        landscape.data((two, surface(two)), options_of(landscape))


def test_landscape_and_tracks_fit_on_a_sheet(found, tmp_path):
    runs = {"experiment": "routes", "where": {"method": "swarm"}}
    own = panels_of(
        [
            {"kind": "surface", "title": "surface", **runs, "data": "surface"},
            {"kind": "landscape", "title": "landscape", **runs, "data": "surface"},
            {"kind": "tracks", "title": "point", **runs, **BY, "point": 1},
        ]
    )
    frame = sheet.collect_data(own, Sources({"routes": found}, functions={"surface": surface}))
    read = sheet.store_data(frame, str(tmp_path / "figure.csv"))
    figure = sheet.draw(own, read, sheet.FigureScene({"routes": found.problems}, {}, {}, "m"), 2)
    assert [axes.name for axes in figure.axes][:2] == ["3d", "rectilinear"]
    legend = {text.get_text() for text in figure.legends[0].get_texts()}
    ends = {"first position", "last position", "start", "target"}
    assert {"first run", "second run", "local minimum"} | ends <= legend
    for axes in figure.axes:
        extent = axes.get_tightbbox()
        assert -1 <= extent.x0 <= extent.x1 <= figure.bbox.width + 1
        assert -1 <= extent.y0 <= extent.y1 <= figure.bbox.height + 1


def test_round_numbers_below_one():
    assert landscape.choose_round_numbers(np.array([0.05, 0.3])) == pytest.approx([0.05, 0.1, 0.2])
