"""Figures: what is drawn stands in the table beside them, and can be read in print."""

import functools
import itertools
import tempfile
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from panels import options_of, panels_of

from bezierplan.analysis.results import Results
from bezierplan.figures import panels as kinds_of_panel
from bezierplan.figures import sheet, style
from bezierplan.figures.panels import (
    Sources,
    along_path,
    bars,
    boxes,
    convergence,
    lines,
    paths,
    workspace,
)
from bezierplan.geometry import curves
from bezierplan.workspaces import random_field
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Path, Problem, Workspace

LOWEST = {"lowest": "objective"}


def grid() -> Grid:
    return from_lines(["....", ".##.", "..#.", "...."], 10.0, "unit")


def results(
    feasible: tuple[bool, ...] = (True, True, False), curve: str = "piecewise_quadratic"
) -> Results:
    """Runs of one method on one problem, the later the shorter; the last one stops a generation
    early.
    """
    problem = Problem("0_15", grid(), (5.0, 5.0), (35.0, 35.0))
    points = np.array([problem.start, (5.0, 25.0), (5.0, 35.0), (5.0, 35.0), problem.target])
    runs = pd.DataFrame(
        {
            "id": f"study/routes/0_15/smooth/{repeat}",
            "problem": "0_15",
            "method": "smooth",
            "repeat": repeat,
            "objective": 60.0 - repeat,
            "length": curves.length(Path(curve, points)),
            "feasible": feasible[repeat],
            "collision_at": np.nan if feasible[repeat] else 1.5,
            "bound": 45.0,
            "history": [90.0, 70.0, 60.0 - repeat][: 2 if repeat == len(feasible) - 1 else 3],
            "path_curve": curve,
            "path_points": points.ravel().tolist(),
        }
        for repeat in range(len(feasible))
    )
    bounds = pd.DataFrame({"bound_path": [[5.0, 5.0, 10.0, 30.0, 35.0, 35.0]]}, index=["0_15"])
    return Results(runs, {"0_15": problem}, bounds)


def other_workspaces() -> dict[str, Workspace]:
    circles = Circles(
        (-10.0, 10.0, -5.0, 5.0), np.array([[0.0, 1.0], [4.0, -2.0]]), np.array([1.0, 2.0]), "m"
    )
    square = np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 4.0], [1.0, 4.0]])
    hole = np.array([[3.0, 2.0], [5.0, 2.0], [5.0, 3.0], [3.0, 3.0]])
    return {"circles": circles, "polygons": Polygons((0.0, 10.0, 0.0, 5.0), ((square, hole),), "m")}


def scene(found: Results) -> sheet.FigureScene:
    workspaces = {
        "map": grid(),
        "narrow": from_lines(["..."] * 4, 10.0, "unit"),
        **other_workspaces(),
    }
    return sheet.FigureScene(
        {"routes": found.problems}, workspaces, {"smooth": "smooth (quadratic pieces)"}, "unit"
    )


RUN = {"experiment": "routes", "where": {"problem": "0_15", "method": "smooth"}, "pick": LOWEST}
CURVATURE = {"kind": "along_path", **RUN, "limit": 0.1}
METHODS = {"experiment": "routes", "where": {"method": ["smooth", "coarse", "random"]}}
CLOSE = {"control": "points", "view": [-9, 9, -4, 5], "pick": {"median": "length"}}
OF_THREE = {"experiment": "routes", "where": {"method": "smooth", "points": 3}}


def comparison(published: pd.DataFrame | None = None) -> Results:
    """Runs of three methods with two, three and five points, in a workspace of circles; objectives
    are methods' bases plus the repeat.
    """
    problem = Problem("field", other_workspaces()["circles"], (-9.0, 0.0), (9.0, 0.0))
    points = np.array([problem.start, (0.0, 9.0), problem.target])
    runs = pd.DataFrame(
        {
            "id": f"study/routes/field,points={number}/{method}/{repeat:02}",
            "problem": "field",
            "method": method,
            "points": number,
            "repeat": repeat,
            "objective": base + number + repeat,
            "length": base + number + repeat,
            "feasible": repeat % 4 > 0,
            "collision_at": np.nan if repeat % 4 else 0.5,
            "bound": 18.5,
            "history": [
                base + number + repeat + 9.0,
                *([base + number + repeat] * (1 + repeat % 2)),
            ],
            "path_curve": "bezier",
            "path_points": points.ravel().tolist(),
        }
        for method, base in (("smooth", 30.0), ("coarse", 20.0), ("random", 40.0))
        for number in (2, 3, 5)
        for repeat in range(8)
    )
    bounds = pd.DataFrame({"bound_path": [[-9.0, 0.0, 9.0, 0.0]]}, index=["field"])
    return Results(runs, {"field": problem}, bounds, published)


def printed_means() -> pd.DataFrame:
    """Published numbers: a mean of a method, one of a method with five points, and what is no mean
    of the objective.
    """
    return pd.DataFrame(
        {
            "method": ["smooth", "smooth", "coarse", "coarse"],
            "points": [np.nan, 5, np.nan, np.nan],
            "metric": ["objective", "objective", "length", "objective"],
            "statistic": ["mean", "mean", "mean", "median"],
            "n": 10,
            "unit": "m",
            "value": [36.5, 38.0, 1.0, 2.0],
        }
    )


def sequence() -> pd.DataFrame:
    """A table of a study's function: two sequences of numbers, one of them long."""
    k = np.r_[0:9, 0:300]
    return pd.DataFrame({"map": ["short"] * 9 + ["long"] * 300, "k": k, "value": np.sin(k)})


def marks(home: Workspace | None = None) -> pd.DataFrame:
    """A drawing of a study's function: every mark once, about the middle of a workspace where there
    is one.
    """
    x, y = (home.bounds[1] / 2, home.bounds[3] / 2) if home else (0.0, 0.0)
    rows = [
        {"mark": "cell", "role": "obstacle", "x": x, "y": y, "width": 4.0, "height": 2.0},
        {"mark": "circle", "role": "accent", "x": x, "y": y, "radius": 1.0, "label": "distance r"},
        {"mark": "line", "role": "first", "x": x - 3, "y": y, "label": "before"},
        {"mark": "line", "role": "first", "x": x + 3, "y": y + 2, "label": "before"},
        {"mark": "arrow", "role": "note", "x": x, "y": y},
        {"mark": "arrow", "role": "note", "x": x + 2, "y": y + 2},
        {"mark": "dots", "role": "start", "x": x - 3, "y": y},
        {"mark": "text", "role": "note", "x": x, "y": y + 1, "text": "7"},
    ]
    return pd.DataFrame(rows)


# Sheets by name: runs, panels, and panels side by side.
SHEETS = {
    "run": (
        results(),
        [
            {"kind": "paths", "title": "0 to 15", "letters": ["S", "T"], "context": True, **RUN},
            {"kind": "convergence", "title": "0 to 15", "context": True, **RUN},
            CURVATURE | {"title": "0 to 15", "context": True},
            {"kind": "workspace", "workspace": "narrow", "numbers": "all", "embed": True},
            {"kind": "workspace", "title": "circles", "workspace": "circles"},
        ],
        2,
    ),
    "methods": (
        comparison(printed_means().assign(table="table3")),
        [
            {"kind": "convergence", "title": "methods", **METHODS, "hue": "method"},
            {"kind": "lines", **METHODS, "x": "points", "metric": "length", "hue": "method"},
            {"kind": "lines", "title": "sequence", "data": "sequence", "x": "k", "metric": "value"},
            {"kind": "bars", **METHODS, "x": "points", "hue": "method", "metric": "length"},
            {"kind": "boxes", **METHODS, "metric": "objective", "printed": "table3"},
            {
                "kind": "drawing",
                "title": "marks in a field",
                "data": "marks",
                "workspace": "circles",
            },
            {
                "kind": "paths",
                "title": "explicit",
                "explicit": {"curve": "bezier", "points": [[0, 0], [1, 2], [3, 0]]},
            },
        ],
        2,
    ),
    "gallery": (
        comparison(),
        [{"kind": "paths", "title": f"n = {n}", **OF_THREE, **CLOSE} for n in range(10)],
        5,
    ),
}


def sources(found: Results) -> Sources:
    """What panels of a figure draw from."""
    return Sources(
        {"routes": found}, scene(found).workspaces, {"sequence": sequence, "marks": marks}
    )


def drawn(found: Results, *own: dict, columns: int = 1) -> Figure:
    """A figure as the workflow makes it: by way of the csv."""
    shown = panels_of(list(own))
    with tempfile.NamedTemporaryFile() as file:
        frame = sheet.store_data(sheet.collect_data(shown, sources(found)), file.name)
    return sheet.draw(shown, frame, scene(found), columns)


@functools.cache
def sheet_of(name: str) -> Figure:
    """A sheet, drawn once for all tests."""
    found, own, columns = SHEETS[name]
    return drawn(found, *own, columns=columns)


def words(figure: Figure) -> str:
    """All texts of a figure, and its caption, in one line."""
    texts = [text.get_text() for text in figure.findobj(Text)]
    return " ".join(" | ".join([*texts, figure.get_label()]).split())


def parts(frame: pd.DataFrame) -> dict[str, list]:
    """Places by the part that they belong to."""
    return {part: own[["x", "y"]].to_numpy().tolist() for part, own in frame.groupby("part")}


def of_run(found: Results, **keys) -> pd.DataFrame:
    return paths.data(found, options_of(paths, **{"pick": LOWEST} | keys))


# Paths


def test_csv_keeps_every_number(tmp_path):
    found, own, _ = SHEETS["run"]
    frame = sheet.collect_data(panels_of(own), sources(found))
    assert frame.columns[0] == "panel"
    assert sorted(frame["panel"].unique()) == [0, 1, 2, 3, 4]
    read = sheet.store_data(frame, str(tmp_path / "figure.csv"))
    for column in ("x", "y", "t", "value", "median"):
        np.testing.assert_array_equal(read[column], frame[column])


def test_a_path_is_drawn_with_its_points_and_the_exact_shortest_one():
    found = results()
    frame = of_run(found, context=True)
    assert set(frame["run"]) == {"study/routes/0_15/smooth/1"}, "the shortest run is not feasible"
    places = parts(frame)
    assert set(places) == {"start", "target", "bound", "hull", "control", "path"}
    np.testing.assert_array_equal(np.ravel(places["control"]), found.runs["path_points"][1])
    assert places["bound"] == [[5, 5], [10, 30], [35, 35]]
    np.testing.assert_allclose(np.array(places["path"])[[0, -1]], [[5, 5], [35, 35]])
    assert places["hull"][0] == places["hull"][-1]


@pytest.mark.parametrize(
    ("curve", "control", "expected"),
    [
        ("piecewise_quadratic", "all", {"control", "hull"}),
        ("piecewise_quadratic", "points", {"points"}),
        ("piecewise_quadratic", "none", set()),
        ("polyline", "all", set()),  # whose corners lie on it
        ("spline", "all", {"control"}),
        ("ferguson", "all", set()),  # tangents are no control points
    ],
)
def test_points_of_a_path(curve, control, expected):
    found = results()
    found.runs["path_curve"] = curve
    if curve == "ferguson":
        found.runs["path_points"] = [[5, 5, 30, 0, 5, 25, 0, 30, 35, 35, 30, 0.0]] * 3
    assert set(parts(of_run(found, control=control))) == {"start", "target", "path"} | expected


def test_paths_meet_the_corners_of_a_polyline():
    found = results(curve="polyline")
    places = parts(of_run(found).round(9))
    corners = np.reshape(found.runs["path_points"].iloc[0], (-1, 2)).tolist()
    assert all(corner in places["path"] for corner in corners)


def test_paths_side_by_side():
    found = results()
    other = found.runs.assign(
        method="other",
        id=found.runs["id"].str.replace("smooth", "other"),
        length=found.runs["length"] + 1,
    )
    both = found._replace(runs=pd.concat([found.runs, other], ignore_index=True))
    frame = of_run(both, hue="method")
    assert set(frame["part"]) == {"start", "target", "path"}, "no control points"
    for method, own in frame.groupby("method"):
        alone = both._replace(runs=both.runs[both.runs["method"] == method])
        same = of_run(alone, control="none")
        pd.testing.assert_frame_equal(own.reset_index(drop=True)[same.columns], same)
    panel = RUN | {"kind": "paths", "hue": "method", "where": {"method": ["other", "smooth"]}}
    length = found.runs["length"].iloc[1]
    caption = f"other {length + 1:.2f}, smooth (quadratic pieces) {length:.2f}"
    assert f"length (unit): {caption}" in words(drawn(both, panel))
    assert f"objective (unit): other {59:.2f}" in words(
        drawn(both, panel | {"measure": "objective"})
    )
    none = results(feasible=(False, False))
    assert "(quadratic pieces) no path" in words(drawn(none, panel))
    assert "0 of 1 have a path" in words(drawn(none, panel))


def test_a_problem_is_drawn_without_a_run():
    place = results().problems["0_15"]
    (panel,) = panels_of([{"kind": "problem", "problem": "0_15", "letters": ["S", "T"]}])
    frame = sheet.collect_data([panel], Sources(problems={"0_15": place}))
    assert frame[["part", "x", "y"]].to_numpy().tolist() == [
        ["start", 5.0, 5.0],
        ["target", 35.0, 35.0],
    ]
    own = sheet.FigureScene({}, {}, {}, "unit", places={"0_15": place})
    text = words(sheet.draw([panel], frame, own, 1))
    assert text.startswith("S | T | ")
    assert "occupied cell" in text


def test_only_runs_that_have_some_of_a_metric_are_picked():
    found = results((True, True, True))
    # The second one is the centre of an occupied cell.
    inside = [5.0, 5.0, 25.0, 15.0, 5.0, 35.0, 5.0, 35.0, 35.0, 35.0]
    found.runs.at[0, "path_points"] = inside
    best, having = (
        of_run(found, pick=LOWEST | more) for more in ({}, {"having": "occupied_points"})
    )
    assert best["run"].iloc[0].endswith("/2")
    assert having["run"].iloc[0].endswith("/0")


def test_cells_that_changed_are_marked():
    found = results()
    before = from_lines(["....", ".#..", "..##", "...."], 10.0, "unit")
    other = found.problems["0_15"]._replace(name="before", workspace=before)
    found = found._replace(problems=found.problems | {"before": other})
    places = parts(of_run(found, changed_from="before"))
    now = found.problems["0_15"].workspace.occupied
    cells = {
        part: [before.cell_of(*at) for at in places[part]] for part in ("appeared", "vanished")
    }
    assert sorted(cells["appeared"]) == list(zip(*np.nonzero(now & ~before.occupied)))
    assert sorted(cells["vanished"]) == list(zip(*np.nonzero(before.occupied & ~now)))
    figure = drawn(found, {"kind": "paths", **RUN, "changed_from": "before"})
    assert "occupied since the change" in words(figure)


def test_a_path_stands_beside_the_shortest_one_printed():
    numbers = {
        "table": ["table1", "table1", "table2"],
        "method": "smooth",
        "metric": "length",
        "statistic": ["min", "max", "min"],
    }
    found = results()._replace(published=pd.DataFrame({**numbers, "value": [44.125, 70.0, 1.0]}))
    assert set(of_run(found, printed="table1")["printed"]) == {44.125}
    panel = {"kind": "paths", **RUN, "printed": "table1"}
    assert "shortest printed 44.12 unit" in words(drawn(found, panel))


@pytest.mark.parametrize(
    ("change", "pick", "said"),
    [
        ({"feasible": False}, LOWEST, "no feasible run among 3"),
        ({}, {"repeat": 7}, "no such run among 3"),
        ({}, {"repeat": 2}, "smooth/2 (not feasible)"),
        ({"path_curve": ""}, {"repeat": 0}, "no path"),
        ({"path_points": [[5.0] * 10] * 3}, {"repeat": 0}, "the curve is a single point"),
    ],
)
def test_what_there_is_not_is_said(change, pick, said):
    found = results()
    found = found._replace(runs=found.runs.assign(**change))
    own = [{"kind": "paths", **RUN, "pick": pick}, CURVATURE | {"pick": pick}]
    assert said in words(drawn(found, *own, columns=2))


@pytest.mark.parametrize("column", ["problem", "method"])
def test_one_run_needs_one_problem_and_one_method(column):
    found = results()
    found.runs.loc[0, column] = "another"
    with pytest.raises(ValueError, match=f"exactly one {column}"):
        of_run(found)


def test_curvature_leaves_out_where_the_curve_stands_still():
    frame = along_path.data(results(), panels_of([CURVATURE])[0])
    still = frame.loc[frame["value"].isna(), "t"]
    assert frame["value"].abs().max() == 0, "it is straight"
    assert len(still) > 0
    assert still.between(0.66, 0.67).all(), (
        "two equal control points stop the curve where its second piece ends"
    )
    assert f"{len(still)} of {len(frame)} samples left out" in words(sheet_of("run"))


def test_peak_far_above_the_limit_is_cut_and_said():
    found = results()
    found.runs["path_points"] = [[5, 5, 35, 5, 5, 5.1, 5, 35, 35, 35.0]] * 3
    highest = along_path.data(found, panels_of([CURVATURE])[0])["value"].max()
    assert highest > 1
    figure = drawn(found, CURVATURE)
    assert figure.axes[0].get_ylim()[1] == pytest.approx(0.4)
    assert f"largest {highest:.3g} 1/unit" in words(figure)


# Groups of runs


def test_convergence_prolongs_runs_that_stopped_early():
    frame = convergence.data(results(), options_of(convergence, pick=LOWEST))
    assert list(frame["generation"]) == [0, 1, 2]
    assert list(frame["objective"]) == [90, 70, 59]
    assert frame["median"].iloc[2] == 60
    np.testing.assert_allclose(frame["quartile3"].iloc[2], np.quantile([60, 59, 70], 0.75))
    for until, expected in ((4, [90, 70, 59, 59, 59]), (1, [90, 70, 59])):
        own = options_of(convergence, pick=LOWEST, until=until)
        assert list(convergence.data(results(), own)["objective"]) == expected, "no run is cut"


def test_convergence_of_groups_holds_last_values_and_their_intervals():
    frame = convergence.data(comparison(), options_of(convergence, hue="method", until=5))
    assert set(frame["runs"]) == {24}
    assert set(frame["feasible_runs"]) == {18}
    coarse = frame.loc[frame["method"] == "coarse", "objective"]
    middle = 20 + np.mean([2, 3, 5]) + np.mean(range(8))
    np.testing.assert_allclose(coarse, [middle + 9, *[middle] * 5])
    assert frame.eval("low95 < objective < high95").all()
    # Histories differ by a constant from generation 0 to the last one, so do intervals from the
    # same draws.
    width = (frame["high95"] - frame["low95"]).groupby(frame["method"]).agg(["first", "last"])
    np.testing.assert_allclose(width["first"], width["last"])
    mean = convergence.data(comparison(), options_of(convergence, hue="points"))
    assert mean.loc[mean["points"] == 3, "objective"].iloc[-1] == pytest.approx(36.5)


def test_order_of_runs_changes_no_bit():
    found = comparison()
    other = found._replace(runs=found.runs.sample(frac=1, random_state=1).reset_index(drop=True))
    hue = {"hue": "method"}
    for panel in (
        options_of(lines, metric="objective", x="points", **hue),
        options_of(bars, metric="objective", x="points", **hue),
        options_of(boxes, metric="objective"),
        options_of(convergence, **hue),
    ):
        data = kinds_of_panel.load_kind(panel.kind).data
        pd.testing.assert_frame_equal(data(found, panel), data(other, panel))


@pytest.mark.parametrize("kind", [lines, bars])
def test_statistics_have_intervals_and_what_the_paper_prints_where_it_belongs(kind):
    keys = {"x": "points", "hue": "method", "printed": "table6"}
    printed = printed_means().assign(table="table6").iloc[1:2]
    found = comparison(pd.concat([printed, printed.assign(table="table7", value=1.0)]))
    frame = kind.data(found, options_of(kind, metric="length", **keys))
    own = frame[frame["part"] == "statistic"] if kind is lines else frame
    assert len(own) == 9
    assert set(own["n"]) == {6}, "lengths are of feasible runs"
    assert own.eval("low95 < value < high95").all()
    frame = kind.data(found, options_of(kind, metric="objective", **keys))
    if kind is lines:
        frame = frame.query("part == 'published'").assign(published=frame["value"])
    shown = frame[frame["published"].notna()]
    assert shown[["method", "points", "published"]].to_numpy().tolist() == [["smooth", 5, 38.0]]


def test_bars_have_the_bound_of_their_feasible_runs():
    found = comparison()
    found.runs.loc[found.runs["method"] == "random", "feasible"] = False
    own = {"x": "points", "hue": "method"}
    frame = bars.data(found, options_of(bars, metric="length", **own)).set_index("method")
    assert set(frame["bound"].drop("random")) == {18.5}
    assert frame.loc["random", ["bound", "value"]].isna().all(axis=None)
    share = bars.data(found, options_of(bars, metric="feasible", statistic="share", **own))
    assert share["bound"].isna().all(), "no length"


def test_boxes_end_at_the_last_value_within_reach():
    found = comparison()
    values = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 90.0])
    found.runs["objective"] = np.tile(values, 9)
    found.runs["reference"] = 20.0
    frame = boxes.data(found, options_of(boxes, metric="objective", context=True))
    own = frame[frame["method"] == "smooth"].groupby("part")["value"].agg(list)
    assert own["quartile1"] == [pytest.approx(np.quantile(np.tile(values, 3), 0.25))]
    assert (own["low"], own["high"], own["beyond"]) == ([0], [6], [90] * 3)
    assert own["mean"] == [values.mean()]
    alone = frame[frame["method"].isna()]
    assert dict(zip(alone["part"], alone["value"])) == {"reference": 20.0, "bound": 18.5}


def test_boxes_show_the_published_means_of_their_runs():
    printed = printed_means().assign(table="table3")
    frame = boxes.data(
        comparison(pd.concat([printed, printed.head(1).assign(statistic="max", value=50.0)])),
        options_of(boxes, metric="objective", printed="table3"),
    ).query("part.str.startswith('published')")
    shown = frame[["method", "part", "value"]].to_numpy().tolist()
    assert shown == [["smooth", "published", 36.5], ["smooth", "published_end", 50.0]], (
        "not that of one of their conditions"
    )


def test_a_statistic_of_some_runs_has_an_open_mark():
    """Of the comparison's runs three quarters are feasible, and only these have a length."""
    for metric, hollow in (("length", True), ("objective", False)):
        panel = {"kind": "lines", **METHODS, "x": "points", "metric": metric, "hue": "method"}
        assert (style.HOLLOW_LABEL in words(drawn(comparison(), panel))) == hollow


# Workspaces and drawings


def test_large_fields_are_drawn_by_their_circles():
    circles = Circles((0.0, 40.0, 0.0, 40.0), np.array([[10.0, 20.0]]), np.array([3.0]), "cell")
    small = workspace.list_workspace_rows(random_field.from_circles(circles))
    counts = {"free": 1681 - 29, "occupied": 29, "corner": 2, "circle": 1}
    assert small["part"].value_counts().to_dict() == counts
    large = workspace.list_workspace_rows(
        random_field.from_circles(replace(circles, bounds=(0.0, 100.0, 0.0, 100.0)))
    )
    assert large["part"].tolist() == ["corner", "corner", "circle"]
    assert large["x"].tolist() == [-0.5, 100.5, 10.0]


@pytest.mark.parametrize(("numbers", "printed"), [("all", 16), ("free", 13), ("none", 0)])
def test_workspace_numbers(numbers, printed):
    frame = workspace.data(grid(), options_of(workspace, numbers=numbers))
    assert frame["number"].notna().sum() == printed
    centre = frame[frame["number"] == 7]
    if printed:
        assert (centre["x"].item(), centre["y"].item()) == grid().centre(7)


def test_all_256_numbers_can_be_read_in_one_column():
    home = from_lines(["." * 16] * 16, 10.0, "unit")
    panel = options_of(workspace, workspace="map", numbers="all")
    own = sheet.FigureScene({}, {"map": home}, {}, "unit")
    figure = sheet.draw([panel], workspace.data(home, panel).assign(panel=0), own, 1, "one")
    numbers = [text for text in figure.axes[0].texts if text.get_text()]
    assert sorted(int(text.get_text()) for text in numbers) == list(range(256))
    boxes_of_text = [text.get_window_extent() for text in numbers]
    assert not any(a.overlaps(b) for a, b in itertools.pairwise(boxes_of_text))


def test_embedding_marks_surplus_cells():
    frame = workspace.data(
        from_lines(["..."] * 3, 10.0, "unit"), options_of(workspace, numbers="all", embed=True)
    )
    assert set(frame.loc[frame["part"] == "surplus", "number"]) == {3, 7, 11, 12, 13, 14, 15}


@pytest.mark.parametrize(
    ("name", "expected"), [("circles", {"corner", "circle"}), ("polygons", {"corner", "ring"})]
)
def test_workspaces_without_cells(name, expected):
    assert set(workspace.data(other_workspaces()[name], options_of(workspace))["part"]) == expected
    with pytest.raises(ValueError, match="kind grid"):
        workspace.data(other_workspaces()[name], options_of(workspace, embed=True))


def test_holes_of_polygons_stay_open():
    figure = drawn(results(), {"kind": "workspace", "workspace": "polygons"})
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    colours = np.asarray(canvas.buffer_rgba())
    brightness = []
    for point in ((4, 2.5), (7, 2.5)):
        x, y = figure.axes[0].transData.transform(point).astype(int)
        brightness.append(colours[len(colours) - y, x, 0])
    assert brightness[0] == 255
    assert brightness[1] < 200


def test_a_drawing_shows_the_marks_of_its_function_in_their_order():
    axes = sheet_of("methods").axes[5]
    assert [text.get_text() for text in axes.texts if text.get_text()] == ["7"]
    np.testing.assert_allclose(axes.lines[0].get_xydata(), [[2.0, 2.5], [8.0, 4.5]])
    assert axes.get_xlabel() == "x (m)", "the workspace gives the scale"


# What is drawn, number by number: small tables, every column unlike the others

GRID = from_lines(["..", ".."], 1.0, "m")
SCENE = sheet.FigureScene(
    {"first": {"across": Problem("across", GRID, (0.5, 0.5), (1.5, 1.5))}}, {}, {}, "m"
)
COUNTS = {"runs": 10, "feasible_runs": 10, "n": 10}


def axes_of(kind, frame, **keys):
    axes = Figure().add_subplot()
    kind.draw(axes, frame, SCENE, options_of(kind, experiment="first", **keys))
    return axes


def labelled(axes, label):
    """x and y of the line of a label that has points."""
    (line,) = [line for line in axes.lines if line.get_label() == label and len(line.get_xdata())]
    return [np.asarray(each, dtype=float).tolist() for each in line.get_data()]


def spans(axes):
    """Ends of the vertical lines of collections."""
    return [
        path.vertices[:, 1].tolist() for drawn in axes.collections for path in drawn.get_paths()
    ]


def statistics(method):
    numbers = np.array([[4, 1, 8], [5, 2, 9], [7, 3, 10]]) + {"a": 0.0, "b": 100.0}[method]
    frame = pd.DataFrame(numbers, columns=["value", "low95", "high95"])
    return frame.assign(points=[2, 3, 5], part="statistic", method=method, **COUNTS)


BOTH = pd.concat(map(statistics, "ab"), ignore_index=True)


def test_each_line_is_the_statistic_of_its_group_with_its_interval():
    axes = axes_of(lines, BOTH, x="points", metric="length", hue="method")
    assert [labelled(axes, method)[1] for method in "ab"] == [[4, 5, 7], [104, 105, 107]]
    assert spans(axes)[:3] == [[1, 8], [2, 9], [3, 10]]


def test_each_bar_is_as_high_as_its_statistic():
    frame = BOTH.assign(bound=0.5, published=[np.nan] * 5 + [104.5])
    axes = axes_of(bars, frame, x="points", hue="method", metric="length", context=True)
    heights = [[bar.get_height() for bar in group] for group in axes.containers[:2]]
    assert heights == [[4, 5, 7], [104, 105, 107]]
    assert spans(axes)[:6] == [[1, 8], [2, 9], [3, 10], [101, 108], [102, 109], [103, 110]]
    at, heights = labelled(axes, "published")
    assert dict(zip(heights, at))[104.5] == pytest.approx(2.2), "on its bar"
    assert [0.5, 0.5] in spans(axes)


def history(**more):
    columns = {
        "objective": [9.0, 7.0, 6.0],
        "median": [19.0, 17.0, 16.0],
        "quartile1": [4.0, 3.0, 2.0],
        "quartile3": [29.0, 28.0, 27.0],
        "low95": [8.0, 6.5, 5.5],
        "high95": [10.0, 7.5, 6.5],
        "bound": 1.5,
        "reference": 1.75,
        "method": "a",
        "run": "s/first/across/a/3",
        "feasible": True,
    }
    return pd.DataFrame({"generation": [0, 1, 2], **columns, **COUNTS} | more)


def band(axes):
    """Lowest and highest y of the first filled band."""
    corners = axes.collections[0].get_paths()[0].vertices
    ends = [corners[corners[:, 0] == place, 1] for place in sorted(set(corners[:, 0]))]
    return [each.min() for each in ends], [each.max() for each in ends]


def test_convergence_shows_the_run_and_in_context_the_median_and_the_band():
    axes = axes_of(convergence, history(), pick={"repeat": 3}, context=True)
    assert labelled(axes, "run shown") == [[0, 1, 2], [9, 7, 6]]
    assert labelled(axes, "median of all runs") == [[0, 1, 2], [19, 17, 16]]
    assert band(axes) == ([4, 3, 2], [29, 28, 27])
    assert labelled(axes, "exact shortest path")[1] == [1.5, 1.5]
    assert labelled(axes, "best known path of the same kind")[1] == [1.75, 1.75]
    alone = axes_of(convergence, history(), pick={"repeat": 3})
    assert [list(line.get_ydata()) for line in alone.lines] == [[9, 7, 6]]
    assert not alone.get_legend_handles_labels()[1], "a single line needs no legend"


def test_convergence_of_groups_shows_their_objectives_and_printed_means():
    groups = [history(), history(method="b", objective=[49.0, 48.0, 44.0])]
    axes = axes_of(convergence, pd.concat(groups).assign(printed=6.25), hue="method")
    assert [labelled(axes, method)[1] for method in "ab"] == [[9, 7, 6], [49, 48, 44]]
    assert band(axes) == ([8, 6.5, 5.5], [10, 7.5, 6.5])
    assert [6.25] * 3 in [list(line.get_ydata()) for line in axes.lines]
    assert "published final mean" in axes.get_legend_handles_labels()[1]


def test_a_box_has_its_parts_where_they_lie():
    own = {"low": 1.0, "quartile1": 3.0, "median": 4.0, "quartile3": 7.0, "high": 9.0}
    own |= {"mean": 5.0, "beyond": 20.0, "published": 6.0, "limit": 11.0}
    frame = pd.DataFrame({"method": "a", "part": own.keys(), "value": own.values(), **COUNTS})
    axes = axes_of(boxes, frame, metric="objective", limit=11.0)
    (box,) = axes.patches
    assert sorted(set(box.get_path().vertices[:, 1].tolist())) == [3, 7]
    level = {line.get_ydata()[0] for line in axes.lines if len(set(line.get_ydata())) == 1}
    assert {1, 4, 9, 11} <= level
    upright = {
        tuple(sorted(line.get_ydata())) for line in axes.lines if len(set(line.get_ydata())) == 2
    }
    assert upright == {(1, 3), (7, 9)}
    for label, value in (("mean", 5), ("published mean", 6), ("outlier", 20)):
        assert labelled(axes, label) == [[0], [value]]


def test_a_quantity_along_a_path_stands_over_the_parameter():
    values = {"t": [0.0, 0.5, 1.0], "value": [0.25, 0.75, 0.5], "limit": 0.6, "pieces": 2}
    frame = pd.DataFrame(values).assign(problem="across", run="r", feasible=True, **COUNTS)
    axes = axes_of(along_path, frame, pick={"repeat": 3}, context=True)
    assert labelled(axes, "path") == [[0, 0.5, 1], [0.25, 0.75, 0.5]]
    assert labelled(axes, "largest magnitude") == [[0.5], [0.75]]
    assert labelled(axes, "joint of two pieces")[0] == [0.5, 0.5]
    assert labelled(axes, "published limit: 0.6 1/m")[1] == pytest.approx([0.6, 0.6])


# Print


def visible(figure: Figure) -> list[Text]:
    """Texts of a figure, without labels of ticks outside of what an axis shows."""
    beyond = []
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            beyond += [
                tick.label1
                for tick in axis.get_major_ticks()
                if not low - 1e-9 <= tick.get_loc() <= high + 1e-9 or not axes.axison
            ]
    return [
        text
        for text in figure.findobj(Text)
        if text.get_text().strip() and text.get_visible() and text not in beyond
    ]


@pytest.mark.parametrize("name", SHEETS)
def test_every_sheet_is_fit_for_print(name):
    figure = sheet_of(name)
    assert figure.get_figwidth() * 25.4 == pytest.approx(170)
    figure.draw_without_rendering()
    texts = visible(figure)
    assert min(text.get_fontsize() for text in texts) >= style.SMALLEST_TEXT
    extents = [text.get_window_extent() for text in texts]
    for text, box in zip(texts, extents):
        assert -1 <= box.x0 <= box.x1 <= figure.bbox.width + 1, text
        assert -1 <= box.y0 <= box.y1 <= figure.bbox.height + 1, text
    for (one, a), (other, b) in itertools.combinations(zip(texts, extents), 2):
        wide, high = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        # A drawing's own numbers, and a tick at the corner of two axes, may touch by a hair.
        assert wide <= 2 or high <= 2, (one.get_text(), other.get_text())


def test_panels_have_letters_units_and_the_method_if_it_is_not_that_of_all():
    figure = sheet_of("run")
    assert "(a) 0 to 15 length" in words(figure)
    panel = {"kind": "boxes", "experiment": "routes", "metric": "objective"}
    own = [panel | {"where": {"method": method}} for method in ("smooth", "coarse")]
    assert "(a) smooth (quadratic pieces)" in words(drawn(comparison(), *own, columns=2))
    assert "(e) circles" in words(figure)
    labels = [label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel())]
    assert {label.split(" (")[-1] for label in filter(None, labels)} == {
        "unit)",
        "1/unit)",
        "m)",
        "generation",
        "curve parameter t",
    }
    assert "run study/routes/0_15/smooth/1; 2 of 3 runs are feasible" in figure.get_label()


def test_axes_that_all_panels_share_are_named_once_and_views_cut_what_is_drawn():
    panels = sheet_of("gallery").axes
    assert [bool(axes.get_ylabel()) for axes in panels] == [True, *[False] * 4] * 2
    assert [bool(axes.get_xlabel()) for axes in panels] == [False] * 5 + [True] * 5
    assert (*panels[0].get_xlim(), *panels[0].get_ylim()) == (-9, 9, -4, 5)
    assert all(line.get_clip_on() for line in panels[0].lines)


def test_a_bar_that_is_missing_says_so_and_a_logarithmic_axis_has_points():
    frame = BOTH.assign(bound=np.nan, published=np.nan, value=[4.0, np.nan, 7.0, 1.0, 2.0, 3.0])
    keys = {"x": "points", "hue": "method", "metric": "length"}
    assert [text.get_text() for text in axes_of(bars, frame, **keys).texts] == ["no free path"]
    axes = axes_of(bars, frame, **keys, scale="log")
    assert not axes.patches
    assert labelled(axes, "b")[1] == [1, 2, 3]
