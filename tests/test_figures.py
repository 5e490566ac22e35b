"""Figures: what is drawn stands in the table beside them, and can be read in print."""

import inspect
import subprocess
import sys
from dataclasses import replace
from pathlib import Path as File

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from panels import options_of, panels_of

from bezierplan.analysis import metrics
from bezierplan.analysis.results import Results
from bezierplan.figures import panels as kinds_of_panel
from bezierplan.figures import sheet, style
from bezierplan.figures.panels import (
    Sources,
    along_path,
    boxes,
    clearance,
    convergence,
    dots,
    drawing,
    lines,
    paths,
    workspace,
)
from bezierplan.geometry import curves
from bezierplan.workspaces import ground, random_field
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


def scene(found: Results) -> sheet.Scene:
    workspaces = {
        "map": grid(),
        "narrow": from_lines(["..."] * 4, 10.0, "unit"),
        **other_workspaces(),
    }
    return sheet.Scene(
        {"routes": found.problems}, workspaces, {"smooth": "smooth (quadratic pieces)"}, "unit"
    )


def panels() -> list[dict]:
    run = {"experiment": "routes", "where": {"problem": "0_15", "method": "smooth"}, "pick": LOWEST}
    return [
        {"kind": "paths", "title": "0 to 15", **run},
        {"kind": "convergence", "title": "0 to 15", **run},
        {"kind": "along_path", "title": "0 to 15", **run, "quantity": "curvature", "limit": 0.1},
        {
            "kind": "workspace",
            "title": "embedded",
            "workspace": "narrow",
            "numbers": "all",
            "embed": True,
        },
        {"kind": "workspace", "title": "circles", "workspace": "circles"},
    ]


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
    short, long = (
        pd.DataFrame({"map": "short", "k": range(9)}),
        pd.DataFrame({"map": "long", "k": range(300)}),
    )
    return pd.concat([short, long]).assign(value=lambda table: np.sin(table["k"]))


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


def comparing_panels() -> list[dict]:
    runs = {"experiment": "routes", "where": {"method": ["smooth", "coarse", "random"]}}
    smooth = {"experiment": "routes", "where": {"method": "smooth"}}
    return [
        {"kind": "convergence", "title": "methods", **runs, "hue": "method"},
        {
            "kind": "convergence",
            "title": "points",
            **smooth,
            "hue": "points",
            "statistic": "median",
        },
        {
            "kind": "lines",
            "title": "points",
            **smooth,
            "x": "points",
            "metric": "objective",
            "repeats": [0, 1],
        },
        {
            "kind": "lines",
            "title": "methods",
            **runs,
            "x": "points",
            "metric": "length",
            "hue": "method",
        },
        {
            "kind": "lines",
            "title": "sequence",
            "data": "sequence",
            "where": {"map": "long"},
            "x": "k",
            "metric": "value",
        },
        {
            "kind": "dots",
            "title": "points",
            **runs,
            "x": "points",
            "hue": "method",
            "metric": "length",
        },
        {
            "kind": "paths",
            "title": "explicit",
            "explicit": {"curve": "bezier", "points": [[0, 0], [1, 2], [3, 0]]},
        },
        {"kind": "boxes", "title": "methods", **runs, "metric": "objective"},
        {"kind": "drawing", "title": "marks", "data": "marks"},
        {"kind": "drawing", "title": "marks in a field", "data": "marks", "workspace": "circles"},
    ]


def gallery(panels: int) -> list[dict]:
    run = {
        "experiment": "routes",
        "where": {"method": "smooth", "points": 3},
        "pick": {"median": "length"},
    }
    return [
        {"kind": "paths", "title": f"n = {n}", **run, "control": "points", "view": [-9, 9, -4, 5]}
        for n in range(panels)
    ]


def sources(found: Results) -> Sources:
    """What panels of a figure draw from."""
    return Sources(
        {"routes": found}, scene(found).workspaces, {"sequence": sequence, "marks": marks}
    )


def drawn(found: Results, own: list[dict], columns: int, folder: File) -> Figure:
    """A figure as the workflow makes it: by way of the csv."""
    file = str(folder / "figure.csv")
    sheet.write_data(sheet.data(panels_of(own), sources(found)), file)
    return sheet.draw(panels_of(own), sheet.read_data(file), scene(found), columns)


def words(figure: Figure) -> list[str]:
    """All texts of a figure, and its caption."""
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()] + [
        figure.get_label()
    ]


def test_csv_keeps_every_number(tmp_path):
    found = results()
    frame = sheet.data(panels_of(panels()), sources(found))
    assert frame.columns[0] == "panel"
    assert sorted(frame["panel"].unique()) == [0, 1, 2, 3, 4]
    sheet.write_data(frame, str(tmp_path / "figure.csv"))
    read = sheet.read_data(str(tmp_path / "figure.csv"))
    for column in ("x", "y", "t", "value", "median"):
        np.testing.assert_array_equal(read[column], frame[column])


def test_paths_data_holds_all_that_is_drawn():
    found = results()
    frame = paths.data(found, options_of(paths, pick=LOWEST))
    assert set(frame["run"]) == {"study/routes/0_15/smooth/1"}, "the shortest run is not feasible"
    parts = {part: points[["x", "y"]].to_numpy() for part, points in frame.groupby("part")}
    assert set(parts) == {"start", "target", "bound", "hull", "control", "path"}
    np.testing.assert_array_equal(parts["control"].ravel(), found.runs["path_points"][1])
    np.testing.assert_array_equal(parts["bound"], [[5, 5], [10, 30], [35, 35]])
    np.testing.assert_allclose(parts["path"][[0, -1]], [[5, 5], [35, 35]])
    np.testing.assert_array_equal(parts["hull"][0], parts["hull"][-1])


def test_points_of_a_polyline_are_nodes():
    """Not control points, which are not on the curve; and no node is told to be one of several in
    one place.
    """
    found = results()
    runs = found.runs.assign(path_curve="polyline")
    frame = paths.data(found._replace(runs=runs), options_of(paths, pick=LOWEST, control="points"))
    nodes = frame.loc[frame["part"] == "nodes", ["x", "y"]].to_numpy()
    np.testing.assert_array_equal(nodes.ravel(), found.runs["path_points"][1])
    assert "points" not in set(frame["part"])
    assert not any("distinct" in line for line in paths._note(frame, "m"))


def test_paths_side_by_side(tmp_path):
    found = results()
    other = found.runs.assign(
        method="other",
        id=found.runs["id"].str.replace("smooth", "other"),
        length=found.runs["length"] + 1,
    )
    both = found._replace(runs=pd.concat([found.runs, other], ignore_index=True))
    frame = paths.data(both, options_of(paths, pick=LOWEST, hue="method"))
    assert set(frame["part"]) == {"start", "target", "bound", "path"}, "no control points"
    for method, own in frame.groupby("method"):
        alone = paths.data(
            both._replace(runs=both.runs[both.runs["method"] == method]),
            options_of(paths, pick=LOWEST, control="none"),
        )
        pd.testing.assert_frame_equal(own.reset_index(drop=True)[alone.columns], alone)
    panel = {
        "kind": "paths",
        "experiment": "routes",
        "pick": LOWEST,
        "hue": "method",
        "where": {"method": ["other", "smooth"]},
    }
    figure = drawn(both, [panel], 1, tmp_path)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    expected = ["other", "smooth (quadratic pieces)", "exact shortest path", "start", "target"]
    assert [text for text in legend if "cell" not in text] == expected
    length = found.runs["length"].iloc[1]
    wanted = (
        f"length (unit): other {round(length + 1, 2):g}, smooth (quadratic pieces) "
        f"{round(length, 2):g}"
    )
    assert any(wanted in " ".join(text.split()) for text in words(figure))


def test_paths_side_by_side_say_who_has_none(tmp_path):
    found = results(feasible=(False, False, False))
    panel = {"kind": "paths", "experiment": "routes", "pick": LOWEST, "hue": "method"}
    told = words(drawn(found, [panel], 1, tmp_path))
    assert any("(quadratic pieces) no path" in " ".join(text.split()) for text in told)
    assert "0 of 1 have a path" in told
    assert not any("have a path" in text for text in words(drawn(results(), [panel], 1, tmp_path)))


def test_paths_side_by_side_give_the_measure_that_is_asked_for(tmp_path):
    found = results()
    found.runs["clearance"] = [1.25, 2.5, 3.75]
    panel = {
        "kind": "paths",
        "experiment": "routes",
        "pick": LOWEST,
        "hue": "method",
        "measure": "clearance",
    }
    assert any(
        "clearance (unit): smooth (quadratic pieces) 2.5" in " ".join(text.split())
        for text in words(drawn(found, [panel], 1, tmp_path))
    )


def test_a_bare_field_shows_no_path(tmp_path):
    panel = panels()[0] | {"bare": True, "letters": ["S", "T"]}
    assert set(paths.data(results(), options_of(paths, pick=LOWEST, bare=True))["part"]) == {
        "start",
        "target",
    }
    figure = drawn(results(), [panel], 1, tmp_path)
    assert {"S", "T", "start", "target"} <= set(words(figure))
    assert not any("run" in text or "path" in text for text in words(figure))


def test_only_runs_that_have_some_of_a_metric_are_picked():
    found = results((True, True, True))
    # The second one is the centre of an occupied cell.
    inside = [
        5.0,
        5.0,
        25.0,
        15.0,
        5.0,
        35.0,
        5.0,
        35.0,
        35.0,
        35.0,
    ]
    found.runs.at[0, "path_points"] = inside
    best, having = (
        paths.data(found, options_of(paths, pick=LOWEST | more))
        for more in ({}, {"having": "occupied_points"})
    )
    assert best["run"].iloc[0].endswith("/2")
    assert having["run"].iloc[0].endswith("/0")
    assert having.loc[having["part"] == "occupied", ["x", "y"]].to_numpy().tolist() == [[25, 15]]
    assert "occupied" not in set(best["part"])


def test_cells_that_changed_are_marked(tmp_path):
    found = results()
    other = found.problems["0_15"]._replace(
        name="before", workspace=from_lines(["....", ".#..", "..##", "...."], 10.0, "unit")
    )
    found = found._replace(problems=found.problems | {"before": other})
    frame = paths.data(found, options_of(paths, pick=LOWEST, changed_from="before"))
    changed = {
        part: own[["x", "y"]].to_numpy().tolist()
        for part, own in frame.groupby("part")
        if part in ("appeared", "vanished")
    }
    now, before = found.problems["0_15"].workspace.occupied, other.workspace.occupied
    assert {part: len(cells) for part, cells in changed.items()} == {
        "appeared": (now & ~before).sum(),
        "vanished": (before & ~now).sum(),
    }
    for part, cells in changed.items():
        for cell in cells:
            at = other.workspace.cell_of(*cell)
            assert now[at] == (part == "appeared") != before[at]
    figure = drawn(found, [panels()[0] | {"changed_from": "before"}], 1, tmp_path)
    assert {"occupied since the change", "free since the change"} <= set(words(figure))
    with pytest.raises(ValueError, match="changed_from: gone: not a problem of the experiment"):
        paths.data(found, options_of(paths, pick=LOWEST, changed_from="gone"))


def test_the_shortest_path_from_cell_to_cell_has_the_length_of_the_optimum(tmp_path):
    found = results()
    frame = paths.data(found, options_of(paths, pick=LOWEST, cell_optimum=True))
    way = frame.loc[frame["part"] == "optimum", ["x", "y"]].to_numpy()
    np.testing.assert_array_equal(way[[0, -1]], [[5, 5], [35, 35]])
    least = ground.least_energy(grid(), 1.0, False, 0, 15)
    assert np.hypot(*np.diff(way, axis=0).T).sum() == pytest.approx(10 * least), "cells of 10 units"
    note = f"shortest between cell centres {10 * least:.2f}, at any angle"
    panel = panels()[0] | {"cell_optimum": True}
    assert any(note in " ".join(text.split()) for text in words(drawn(found, [panel], 1, tmp_path)))


def test_a_path_stands_beside_the_shortest_one_printed(tmp_path):
    numbers = {
        "table": ["table1", "table1", "table2"],
        "method": "smooth",
        "metric": "length",
        "statistic": ["min", "max", "min"],
    }
    found = results()._replace(published=pd.DataFrame({**numbers, "value": [44.125, 70.0, 1.0]}))
    panel = panels()[0] | {"printed": "table1"}
    assert set(paths.data(found, options_of(paths, pick=LOWEST, printed="table1"))["printed"]) == {
        44.125
    }
    assert any(
        "shortest printed 44.12 units" in text for text in words(drawn(found, [panel], 1, tmp_path))
    )


def test_large_fields_are_drawn_by_their_circles():
    circles = Circles((0.0, 40.0, 0.0, 40.0), np.array([[10.0, 20.0]]), np.array([3.0]), "cell")
    small = workspace.parts(random_field.from_circles(circles))
    assert small["part"].value_counts().to_dict() == {
        "free": 1681 - 29,
        "occupied": 29,
        "corner": 2,
        "circle": 1,
    }
    large = workspace.parts(
        random_field.from_circles(replace(circles, bounds=(0.0, 100.0, 0.0, 100.0)))
    )
    assert large["part"].tolist() == ["corner", "corner", "circle"]
    assert large["x"].tolist() == [-0.5, 100.5, 10.0]


def test_functions_get_the_published_tables_that_they_ask_for():
    def double(published):
        return published["table1"].assign(value=2 * published["table1"]["value"])

    published = {"table1": pd.DataFrame({"k": [1, 2], "value": [3.0, 4.0]})}
    panel = {"kind": "lines", "data": "double", "published": True, "x": "k", "metric": "value"}
    assert sheet.data(
        panels_of([panel]), Sources(functions={"double": double}, published=published)
    )["value"].tolist() == [6, 8]


def test_paths_meet_the_corners_of_a_polyline():
    frame = paths.data(results(curve="polyline"), options_of(paths, pick=LOWEST))
    points = {
        part: {tuple(point) for point in own[["x", "y"]].round(9).to_numpy()}
        for part, own in frame.groupby("part")
    }
    assert points["control"] <= points["path"]


def test_convergence_prolongs_runs_that_stopped_early():
    frame = convergence.data(results(), options_of(convergence, pick=LOWEST))
    assert list(frame["generation"]) == [0, 1, 2]
    assert list(frame["objective"]) == [90, 70, 59]
    assert frame["median"].iloc[2] == 60
    np.testing.assert_allclose(frame["quartile3"].iloc[2], np.quantile([60, 59, 70], 0.75))


def test_convergence_of_groups_holds_last_values():
    frame = convergence.data(comparison(), options_of(convergence, hue="method"))
    assert set(frame["method"]) == {"smooth", "coarse", "random"}
    assert list(frame["problem"].unique()) == ["field"]
    assert set(frame["runs"]) == {24}
    assert set(frame["feasible_runs"]) == {18}
    coarse = frame.loc[frame["method"] == "coarse", "objective"]
    middle = 20 + np.mean([2, 3, 5]) + np.mean(range(8))
    np.testing.assert_allclose(coarse, [middle + 9, middle, middle])
    median = convergence.data(
        comparison(), options_of(convergence, hue="points", statistic="median")
    )
    np.testing.assert_allclose(median.loc[median["points"] == 3, "objective"].iloc[-1], 33 + 3.5)


def test_convergence_goes_on_to_the_end_that_is_asked_for():
    frame = convergence.data(comparison(), options_of(convergence, hue="method", until=5))
    coarse = frame[frame["method"] == "coarse"]
    assert list(coarse["generation"]) == [0, 1, 2, 3, 4, 5]
    assert coarse["objective"].iloc[2:].nunique() == 1
    assert list(
        convergence.data(results(), options_of(convergence, pick=LOWEST, until=4))["objective"]
    ) == [90, 70, 59, 59, 59]
    assert list(
        convergence.data(results(), options_of(convergence, pick=LOWEST, until=1))["generation"]
    ) == [0, 1, 2], "no run is cut"


def test_convergence_of_groups_has_the_interval_of_its_statistic():
    frame = convergence.data(comparison(), options_of(convergence, hue="method", until=5))
    assert (frame["low95"] < frame["objective"]).all()
    assert (frame["objective"] < frame["high95"]).all()
    assert (
        frame[frame["generation"] > 2]
        .groupby("method")[["low95", "high95"]]
        .nunique()
        .eq(1)
        .all(axis=None)
    )
    # Histories differ by a constant from generation 0 to the last one, so do intervals from the
    # same draws.
    width = (frame["high95"] - frame["low95"]).groupby(frame["method"]).agg(["first", "last"])
    np.testing.assert_allclose(width["first"], width["last"])


def test_convergence_marks_the_printed_means_of_one_table(tmp_path):
    published = pd.concat(
        [printed_means().assign(table="table3"), printed_means().assign(table="table4", value=1.0)],
        ignore_index=True,
    )
    found = comparison(published[published["points"].isna()])
    frame = convergence.data(
        found, options_of(convergence, hue="method", until=5, printed="table3")
    )
    marked = frame[frame["printed"].notna()]
    assert marked[["method", "generation", "printed"]].to_numpy().tolist() == [["smooth", 5, 36.5]]
    panel = {"kind": "convergence", "experiment": "routes", "hue": "method", "printed": "table3"}
    figure = drawn(found, [panel], 1, tmp_path)
    assert "published final mean" in words(figure)
    (strip,) = figure.axes[0].child_axes
    (mark,) = [line for line in strip.lines if line.get_label() == "published final mean"]
    assert mark.get_ydata() == [36.5]
    assert "printed" not in convergence.data(
        comparison(), options_of(convergence, hue="method", printed="table3")
    )


def test_last_values_stand_beside_the_lines_with_their_intervals(tmp_path):
    panel = comparing_panels()[0]
    figure = drawn(comparison(), [panel], 1, tmp_path)
    frame = (
        convergence.data(comparison(), options_of(convergence, hue="method"))
        .groupby("method")
        .last()
    )
    (strip,) = figure.axes[0].child_axes
    marks = [line for line in strip.lines if line.get_marker() not in ("", "None")]
    assert [line.get_ydata()[0] for line in marks] == pytest.approx(
        list(frame.loc[panel["where"]["method"], "objective"])
    )
    spans = [sorted(line.get_ydata()) for line in strip.lines if len(line.get_ydata()) == 2]
    assert spans == [
        pytest.approx(list(ends))
        for ends in frame.loc[panel["where"]["method"], ["low95", "high95"]].to_numpy()
    ]
    assert strip.get_ylim() == figure.axes[0].get_ylim()


def test_at_most_five_bands_lie_on_each_other():
    runs = comparison().runs
    many = pd.concat(
        [
            runs.assign(method=f"m{n}", objective=runs["objective"] + n, history=runs["history"])
            for n in range(6)
        ]
    )
    for count, banded in ((5, True), (6, False)):
        own = comparison()._replace(
            runs=many[many["method"].isin([f"m{n}" for n in range(count)])].reset_index(drop=True)
        )
        for kind, options in (
            (convergence, {"hue": "method"}),
            (lines, {"x": "points", "metric": "objective", "hue": "method"}),
        ):
            axes = Figure().subplots()
            panel = options_of(kind, **options)
            kind.draw(axes, kind.data(own, panel), sheet.Scene({}, {}, {}, "m"), panel)
            bands = [each for each in axes.collections if isinstance(each, PolyCollection)]
            assert len(bands) == (count if banded else 0)


def test_lines_have_intervals_and_single_repeats():
    frame = lines.data(
        comparison(), options_of(lines, x="points", metric="length", hue="method", repeats=[1])
    )
    statistic = frame[frame["part"] == "statistic"]
    assert len(statistic) == 9
    assert set(statistic["n"]) == {6}, "lengths are of feasible runs"
    assert (statistic["low95"] < statistic["value"]).all()
    assert (statistic["value"] < statistic["high95"]).all()
    coarse = frame[(frame["part"] == "repeat") & (frame["method"] == "coarse")]
    assert list(coarse["value"]) == [23, 24, 26]
    with pytest.raises(ValueError, match="equal points"):
        lines.data(comparison(), options_of(lines, x="points", metric="length", repeats=[1]))


def test_order_of_runs_changes_no_bit():
    found = comparison()
    other = found._replace(runs=found.runs.sample(frac=1, random_state=1).reset_index(drop=True))
    for kind, options in (
        (lines, {"x": "points", "hue": "method"}),
        (dots, {"x": "points", "hue": "method"}),
        (boxes, {}),
    ):
        panel = options_of(kind, metric="objective", **options)
        pd.testing.assert_frame_equal(kind.data(found, panel), kind.data(other, panel))
    panel = options_of(convergence, hue="method")
    pd.testing.assert_frame_equal(convergence.data(found, panel), convergence.data(other, panel))


def test_lines_draw_the_table_of_a_function(tmp_path):
    own = [comparing_panels()[4] | {"where": {"map": name}} for name in ("short", "long")]
    figure = drawn(comparison(), own, 2, tmp_path)
    joined = [axes.lines[0].get_linestyle() for axes in figure.axes]
    assert [len(axes.lines[0].get_xdata()) for axes in figure.axes] == [9, 300]
    assert joined == ["-", "None"], "many points are not joined"


def test_few_points_of_a_table_are_marked_and_the_exact_path_looks_as_everywhere():
    table = pd.DataFrame({"points": [1, 2, 3, 4] * 2, "value": [9.0, 8, 7.5, 7.2] + [7.1] * 4})
    table["path"] = ["best found"] * 4 + ["exact shortest path"] * 4
    panel = options_of(lines, data="any", x="points", metric="value", hue="path")
    axes = Figure().subplots()
    lines.draw(axes, lines.data(table, panel), scene(results()), panel)
    looks = {line.get_label(): line for line in axes.lines}
    assert looks["best found"].get_marker() == "s"
    assert looks["exact shortest path"].get_marker() == ""
    assert looks["exact shortest path"].get_color() == style.BOUND["color"]


def test_axes_name_their_values_in_full():
    """No offset such as +1.414e2 above the axis, on which the subtitle stands."""
    with mpl.rc_context(style.SETTINGS):
        figure = Figure()
        axes = figure.add_subplot()
        axes.plot([10, 100], [141.4213, 141.4685])
        FigureCanvasAgg(figure).draw()
    assert axes.yaxis.get_offset_text().get_text() == ""
    assert all(label.get_text().startswith("141.4") for label in axes.get_yticklabels())


def test_what_has_no_order_is_not_joined(tmp_path):
    panel = {
        "kind": "lines",
        "experiment": "routes",
        "x": "points",
        "metric": "length",
        "hue": "method",
        "joined": False,
    }
    axes = drawn(comparison(), [panel], 1, tmp_path).axes[0]
    marks = [
        line
        for line in axes.lines
        if len(line.get_xdata()) == 3 and line.get_markerfacecolor() != style.FREE
    ]
    assert [line.get_linestyle() for line in marks] == ["None"] * 3
    places = np.array([line.get_xdata() for line in marks])
    np.testing.assert_allclose(places.mean(axis=0), [2, 3, 5])
    assert (np.diff(places, axis=0) > 0.1).all(), "groups stand beside each other"
    assert list(axes.get_xticks()) == [2, 3, 5]


def test_what_has_no_order_can_be_sorted_by_a_number(tmp_path):
    found = comparison()
    found.runs["bound"] = found.runs["points"].map({2: 18.0, 3: 19.0, 5: 17.0})
    panel = {
        "kind": "lines",
        "experiment": "routes",
        "x": "points",
        "metric": "length",
        "hue": "method",
        "joined": False,
        "sorted_by": "bound",
    }
    axes = drawn(found, [panel], 1, tmp_path).axes[0]
    assert list(axes.get_xticks()) == [0, 1, 2]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["5", "2", "3"]
    assert axes.get_xlabel() == "points, sorted by bound"
    frame = lines.data(found, panels_of([panel])[0])
    assert frame.groupby("points")["place"].unique().map(list).to_dict() == {2: [1], 3: [2], 5: [0]}


def test_names_that_lines_join_are_not_sorted():
    with pytest.raises(ValueError, match="sorted_by: needs experiment and joined: false"):
        options_of(lines, x="points", metric="length", sorted_by="bound")


@pytest.mark.parametrize(("metric", "hollow"), [("length", True), ("objective", False)])
@pytest.mark.parametrize("joined", [True, False])
def test_a_statistic_of_some_runs_has_an_open_mark(metric, hollow, joined, tmp_path):
    """Of the comparison's runs three quarters are feasible, and only these have a length."""
    panel = {"kind": "lines", "experiment": "routes", "x": "points", "metric": metric}
    figure = drawn(comparison(), [panel | {"hue": "method", "joined": joined}], 1, tmp_path)
    assert ("hollow: some runs are not feasible" in words(figure)) == hollow
    opened = [
        line
        for line in figure.axes[0].lines
        if line.get_markerfacecolor() == style.FREE and len(line.get_xdata())
    ]
    assert [len(line.get_xdata()) for line in opened] == ([3, 3, 3] if hollow else [])


@pytest.mark.parametrize(("slowest", "unit"), [(0.02, "ms"), (2.0, "s")])
def test_all_panels_of_a_figure_have_one_unit_of_time(slowest, unit, tmp_path):
    found = comparison()
    slow = found.runs["method"] == "random"
    times = np.where(slow, slowest, 0.001)
    found = found._replace(
        runs=found.runs.assign(cpu_s=times, evaluations=100, condition="field", bound=24.0)
    )
    kinds = [
        {"kind": "lines", "x": "points"},
        {"kind": "boxes"},
        {"kind": "dots", "x": "points", "hue": "method"},
    ]
    own = [
        panel | {"experiment": "routes", "metric": "cpu_s", "where": {"method": methods}}
        for panel in kinds
        for methods in (["random"], ["coarse"])
    ]
    own += [
        {"kind": "expected_running_time", "experiment": "routes", "cost": cost}
        for cost in ("cpu_s", "evaluations")
    ]
    axes = drawn(found, own, 2, tmp_path).axes
    measured = [each.get_ylabel() for each in axes[:2]] + [each.get_xlabel() for each in axes[2:7]]
    assert all(label.endswith(f"({unit})") for label in measured), measured
    assert axes[7].get_xlabel() == "expected evaluations"


def test_boxes_show_published_ends_and_a_limit(tmp_path):
    ends = pd.DataFrame(
        {
            "method": "smooth",
            "metric": "objective",
            "statistic": ["min", "max"],
            "value": [31.0, 44.0],
        }
    )
    frame = boxes.data(comparison(ends), options_of(boxes, metric="objective", limit=33.5))
    assert frame.loc[frame["part"] == "published_end", ["method", "value"]].to_numpy().tolist() == [
        ["smooth", 31.0],
        ["smooth", 44.0],
    ]
    assert frame.loc[frame["part"] == "limit", "value"].tolist() == [33.5]
    panel = {"kind": "boxes", "experiment": "routes", "metric": "objective", "limit": 33.5}
    figure = drawn(comparison(ends), [panel], 1, tmp_path)
    assert {"published minimum and maximum", "published limit: 33.5 units"} <= set(words(figure))


def test_boxes_of_feasible_runs_alone_say_how_many_there_are(tmp_path):
    found = comparison()
    found.runs.loc[found.runs["method"] == "coarse", "feasible"] = True
    named = {}
    for metric in ("length", "objective"):
        panel = {"kind": "boxes", "experiment": "routes", "metric": metric}
        axes = drawn(found, [panel], 1, tmp_path).axes[0]
        named[metric] = [label.get_text() for label in axes.get_yticklabels()]
    assert named["length"] == ["coarse", "random (75 %)", "smooth (quadratic pieces) (75 %)"]
    assert named["objective"] == ["coarse", "random", "smooth (quadratic pieces)"]


def test_a_share_is_not_rounded_up_to_all():
    counts = pd.DataFrame({"runs": [1000, 1000, 10], "feasible_runs": [999, 1000, 0]})
    assert boxes._partial_shares(counts) == {0: "99 %", 2: "0 %"}


def test_intervals_on_a_logarithmic_axis_stay_within_the_panel(tmp_path):
    found = comparison()
    found.runs["length"] *= np.where(found.runs["method"] == "random", 1e3, 1)
    found.runs.loc[found.runs["repeat"] == 1, "length"] *= 30
    for kind in ("lines", "dots"):
        panel = {"kind": kind, "experiment": "routes", "x": "points", "hue": "method"}
        (panel,) = panels_of([panel | {"metric": "length"}])
        frame = kinds_of_panel.kind_module(kind).data(found, panel)
        axes = sheet.draw([panel], frame.assign(panel=0), scene(found), 1).axes[0]
        scale, ends = (
            (axes.get_yscale(), axes.get_ylim())
            if kind == "lines"
            else (axes.get_xscale(), axes.get_xlim())
        )
        assert scale == "log"
        assert ends[0] < frame["low95"].min() < frame["high95"].max() < ends[1], kind


def test_the_end_of_a_drive_says_whether_it_arrived():
    drives = {"mine": [3.0, 2.0, 1.0], "other": [3.0, -1.0]}
    frame = pd.concat(
        pd.DataFrame(
            {
                "method": method,
                "run": f"study/moving/field/{method}/0",
                "step": range(1, len(clear) + 1),
                "clearance": clear,
                "arrived": method == "mine",
            }
        )
        for method, clear in drives.items()
    )
    axes = Figure().subplots()
    clearance.draw(axes, frame, scene(results()), options_of(clearance))
    ends = [line for line in axes.lines if line.get_marker() != "" and len(line.get_xdata()) == 1]
    assert [(*line.get_xydata()[0],) for line in ends] == [(3, 1), (2, -1)]
    assert [line.get_markerfacecolor() == style.FREE for line in ends] == [False, True]
    assert "hollow: ends without arrival" in axes.get_legend_handles_labels()[1]


def test_boxes_end_at_the_last_value_within_reach():
    found = comparison()
    values = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 90.0])
    found.runs["objective"] = np.tile(values, 9)
    frame = boxes.data(found, options_of(boxes, metric="objective"))
    parts = frame[frame["method"] == "smooth"].groupby("part")["value"].agg(list)
    assert parts["quartile1"] == [pytest.approx(np.quantile(np.tile(values, 3), 0.25))]
    assert (parts["low"], parts["high"], parts["beyond"]) == ([0], [6], [90] * 3)
    assert parts["mean"] == [values.mean()]


def test_boxes_show_the_published_means_of_their_runs(tmp_path):
    found = comparison(printed_means())
    frame = boxes.data(found, options_of(boxes, metric="objective"))
    shown = frame.loc[frame["part"] == "published", ["method", "value"]].to_numpy().tolist()
    assert shown == [["smooth", 36.5]], "not that of one of their conditions"
    three = found._replace(runs=found.runs[found.runs["points"] == 3])
    assert list(
        boxes.data(three, options_of(boxes, metric="objective")).query("part == 'published'")[
            "value"
        ]
    ) == [36.5]
    assert "published" not in set(
        boxes.data(comparison(), options_of(boxes, metric="objective"))["part"]
    )
    figure = drawn(found, comparing_panels()[7:], 1, tmp_path)
    assert "published mean" in words(figure)


def test_published_means_off_the_scale_are_told_by_their_range(tmp_path):
    """One text for each row and edge: several would lie on each other."""
    far = pd.DataFrame(
        {
            "method": ["smooth", "smooth", "smooth", "coarse", "random"],
            "metric": "objective",
            "statistic": "mean",
            "n": 10,
            "value": [150.0, 240.0, 180.0, 0.25, 200.0],
        }
    )
    told = words(
        drawn(
            comparison(far),
            [{"kind": "boxes", "experiment": "routes", "metric": "objective"}],
            1,
            tmp_path,
        )
    )
    numbers = {"150 to 240", "0.25", "200", "150", "180", "240"}
    assert sorted(text for text in told if text in numbers) == ["0.25", "150 to 240", "200"]
    assert "published mean, off the scale" in told


def test_dots_say_who_has_no_feasible_run_and_know_the_bound(tmp_path):
    found = comparison()
    found.runs.loc[found.runs["method"] == "random", "feasible"] = False
    frame = dots.data(found, options_of(dots, x="points", hue="method", metric="length"))
    assert len(frame) == 9
    assert set(frame.loc[frame["method"] != "random", "bound"]) == {18.5}
    assert frame.loc[frame["method"] == "random", "bound"].isna().all()
    assert frame.loc[frame["method"] == "random", "value"].isna().all()
    assert (
        dots.data(
            found, options_of(dots, x="points", hue="method", metric="feasible", statistic="share")
        )["bound"]
        .isna()
        .all()
    )
    said = words(drawn(found, comparing_panels()[5:6], 1, tmp_path))
    assert {"hollow: some runs are not feasible", "no feasible run"} <= set(said)
    found.runs["feasible"] = True
    assert not {"hollow: some runs are not feasible", "no feasible run"} & set(
        words(drawn(found, comparing_panels()[5:6], 1, tmp_path))
    )


def test_dots_without_a_bound_name_none(tmp_path):
    own = comparing_panels()[5] | {"metric": "feasible", "statistic": "share"}
    assert "exact shortest path" not in words(drawn(comparison(), [own], 1, tmp_path))


def test_dots_show_what_the_paper_prints_of_their_runs():
    frame = dots.data(
        comparison(printed_means().iloc[1:]),
        options_of(dots, x="points", hue="method", metric="objective"),
    )
    printed = frame.set_index(["method", "points"])["published"]
    assert printed.dropna().to_dict() == {("smooth", 5): 38.0}


def test_lines_show_what_the_paper_prints_where_it_belongs():
    printed = printed_means().assign(table="table6").iloc[1:2]
    options = {"x": "points", "metric": "objective", "hue": "method", "printed": "table6"}
    frame = lines.data(
        comparison(pd.concat([printed, printed.assign(table="table7", value=1.0)])),
        options_of(lines, **options),
    )
    shown = frame[frame["part"] == "published"]
    assert shown[["method", "points", "value"]].to_numpy().tolist() == [["smooth", 5, 38.0]]
    axes = Figure().subplots()
    lines.draw(axes, frame, sheet.Scene({}, {}, {}, "m"), options_of(lines, **options))
    (mark,) = [
        line
        for line in axes.lines
        if line.get_marker() == style.PUBLISHED_MARK["marker"] and len(line.get_xdata()) == 1
    ]
    assert (mark.get_xdata().tolist(), mark.get_ydata().tolist()) == ([5], [38.0])


def test_dots_and_lines_keep_the_order_of_where(tmp_path):
    figure = drawn(comparison(), comparing_panels()[5:6], 1, tmp_path)
    named = [
        text for text in words(figure) if text in ("smooth (quadratic pieces)", "coarse", "random")
    ]
    assert named == ["smooth (quadratic pieces)", "coarse", "random"]


def test_tangents_are_no_control_points(tmp_path):
    found = results()
    found.runs["path_curve"] = "ferguson"
    found.runs["path_points"] = [[5, 5, 30, 0, 5, 25, 0, 30, 35, 35, 30, 0.0]] * 3
    assert set(paths.data(found, options_of(paths, pick=LOWEST))["part"]) == {
        "start",
        "target",
        "bound",
        "path",
    }
    drawing = words(drawn(found, panels()[:1], 1, tmp_path))
    assert not any("no path" in text or "distinct" in text for text in drawing)
    assert "hull" not in set(
        paths.data(results(curve="spline"), options_of(paths, pick=LOWEST))["part"]
    )


def test_control_points_alone_or_not_at_all():
    parts = {
        control: set(paths.data(results(), options_of(paths, pick=LOWEST, control=control))["part"])
        for control in ("all", "points", "none")
    }
    assert parts["all"] - parts["none"] == {"control", "hull"}
    assert parts["points"] - parts["none"] == {"points"}


def test_explicit_path_needs_no_run(tmp_path):
    frame = paths.data(
        None, options_of(paths, explicit={"curve": "bezier", "points": [[0, 0], [1, 2], [3, 0]]})
    )
    assert frame.loc[frame["part"] == "target", ["x", "y"]].to_numpy().tolist() == [[3, 0]]
    figure = drawn(comparison(), comparing_panels()[6:7], 1, tmp_path)
    assert figure.axes[0].get_xlabel() == "x (unit)"


def test_view_cuts_what_is_drawn_but_not_what_is_listed(tmp_path):
    figure = drawn(comparison(), gallery(1), 1, tmp_path)
    assert (*figure.axes[0].get_xlim(), *figure.axes[0].get_ylim()) == (-9, 9, -4, 5)
    assert all(line.get_clip_on() for line in figure.axes[0].lines)


def test_narrow_panels_have_short_notes_and_name_axes_once(tmp_path):
    figure = drawn(comparison(), gallery(10), 5, tmp_path)
    assert words(figure).count("length 36.00 m") == 10, "a third line has room for it"
    assert "(a), (b), (c)" in figure.get_label(), "what panels have in common is told once"
    assert "run study/routes/field,points=3/smooth/03; " in figure.get_label()
    assert [axes.get_ylabel() for axes in figure.axes] == [*["y (m)", "", "", "", ""] * 2]
    assert [axes.get_xlabel() for axes in figure.axes] == [""] * 5 + ["x (m)"] * 5
    assert figure.axes[0].get_title(loc="left") == "(a) n = 0, smooth\n(quadratic pieces)"


@pytest.mark.parametrize(
    ("own", "columns"),
    [
        (gallery(2), 1),
        (gallery(3), 2),
        (panels()[1:3], 1),
        (comparing_panels()[:1] * 6, 1),
        (comparing_panels()[2:3] * 4, 1),
        (comparing_panels()[2:3] * 5, 2),
        (panels()[1:2] * 6, 2),
    ],
)
def test_a_narrow_sheet_is_no_longer_than_a_page_where_half_a_column_is_enough(own, columns):
    assert sheet.narrow_columns(panels_of(own)) == columns


def test_a_method_stands_on_a_line_of_its_own_if_one_line_is_too_short(tmp_path):
    named = panels()[0] | {"title": "from 0 to 15"}
    figure = drawn(results(), [named, panels()[1], panels()[1]], 3, tmp_path)
    titles = [axes.get_title(loc="left") for axes in figure.axes[:2]]
    assert titles[0] == "(a) from 0 to 15,\nsmooth (quadratic pieces)"


def test_panels_of_one_metric_have_one_kind_of_axis(tmp_path):
    """In one of them values differ by more than ten."""
    found = comparison()
    found.runs["length"] *= np.where(found.runs["method"] == "random", 1e3, 1)
    own = [
        {"kind": kind, "experiment": "routes", "x": "points", "hue": "method", "metric": metric}
        | {"where": {"method": methods}}
        for kind, metric, methods in (
            ("dots", "length", ["smooth", "coarse"]),
            ("dots", "length", ["smooth", "random"]),
            ("dots", "objective", ["smooth", "coarse"]),
        )
    ]
    figure = drawn(found, own, 3, tmp_path)
    assert [axes.get_xscale() for axes in figure.axes] == ["log", "log", "linear"]
    assert all(axes.get_xlabel() for axes in figure.axes), "also those that are drawn again"
    assert [len(axes.get_yticks()) for axes in figure.axes] == [3, 3, 3]


def test_boxes_that_reach_zero_are_seen_beside_large_ones(tmp_path):
    found = comparison()
    exact = found.runs["method"] == "random"
    found.runs["length"] = np.where(exact, 18.5, 18.5 + 0.01 * 4.0 ** found.runs["repeat"])
    panel = {"kind": "boxes", "experiment": "routes", "metric": "gap"}
    figure = drawn(found, [panel], 1, tmp_path)
    (axes,) = figure.axes
    assert axes.get_xscale() == "symlog"
    assert axes.get_xlim()[0] < 0 < axes.get_xlim()[1]
    assert axes.get_xticks()[0] == 0
    assert "the axis is linear up to the first number after 0" in figure.get_label()


def test_a_row_without_a_box_says_why(tmp_path):
    found = comparison()
    found.runs["feasible"] &= found.runs["method"] != "random"
    panel = {"kind": "boxes", "experiment": "routes", "metric": "length"}
    (axes,) = drawn(found, [panel], 1, tmp_path).axes
    assert [(*text.get_position(), text.get_text()) for text in axes.texts] == [
        (0.5, 1, "no feasible run")
    ]
    assert axes.get_yticklabels()[1].get_text() == "random (0 %)"


@pytest.mark.parametrize(
    ("lines", "offset"),
    [
        ([[8.0, 0.5]], (5, 13)),
        ([[0.5, 8.0]], (13, 5)),
        ([[8.0, 0.2], [0.2, 8.0]], (11, 11)),
        ([], (13, 5)),
    ],
)
def test_a_letter_stands_aside_of_the_lines_that_end_there(lines, offset):
    axes = Figure().subplots()
    axes.set(xlim=(0, 40), ylim=(0, 40))
    paths._write_letter(axes, np.zeros(2), "S", np.reshape(lines, (-1, 2)))
    assert tuple(axes.texts[0].xyann) == offset


def test_along_path_leaves_out_where_the_curve_stands_still(tmp_path):
    found = results()
    frame = along_path.data(
        found, options_of(along_path, pick=LOWEST, quantity="curvature", limit=0.1)
    )
    still = frame.loc[frame["value"].isna(), "t"]
    assert frame["value"].abs().max() == 0, "it is straight"
    assert len(still) > 0
    assert still.between(0.66, 0.67).all(), (
        "two equal control points stop the curve where its second piece ends"
    )
    figure = drawn(found, panels()[2:3], 1, tmp_path)
    assert any(f"{len(still)} of {len(frame)} samples left out" in text for text in words(figure))


@pytest.mark.parametrize(("numbers", "printed"), [("all", 16), ("free", 13), ("none", 0)])
def test_workspace_numbers(numbers, printed):
    frame = workspace.data(grid(), options_of(workspace, numbers=numbers))
    assert frame["number"].notna().sum() == printed
    centre = frame[frame["number"] == 7]
    if printed:
        assert (centre["x"].item(), centre["y"].item()) == grid().centre(7)


@pytest.mark.parametrize(("heights", "named"), [([0, 1, 2, 3], 4), (range(12), 2)])
def test_every_height_is_named_unless_there_are_many(heights, named):
    from matplotlib.figure import Figure

    cells = pd.DataFrame({"part": "free", "x": 0.5, "y": 0.5, "size": 1.0, "height": [*heights]})
    axes = Figure().add_subplot()
    workspace._draw_heights(axes, cells)
    labels = [each.get_label() for each in axes.collections]
    assert sum(label.startswith("height ") for label in labels) == named


def test_wide_grids_number_every_third_column():
    frame = workspace.data(
        from_lines(["." * 16], 1.0, "cell"), options_of(workspace, numbers="all")
    )
    assert frame["number"].dropna().tolist() == [0, 3, 6, 9, 12, 15]


def test_embedding_marks_surplus_cells():
    frame = workspace.data(
        from_lines(["..."] * 3, 10.0, "unit"), options_of(workspace, numbers="all", embed=True)
    )
    assert set(frame.loc[frame["part"] == "surplus", "number"]) == {3, 7, 11, 12, 13, 14, 15}


@pytest.mark.parametrize(
    ("name", "parts"), [("circles", {"corner", "circle"}), ("polygons", {"corner", "ring"})]
)
def test_workspaces_without_cells(name, parts, tmp_path):
    assert set(workspace.data(other_workspaces()[name], options_of(workspace))["part"]) == parts
    with pytest.raises(ValueError, match="kind grid"):
        workspace.data(other_workspaces()[name], options_of(workspace, embed=True))
    figure = drawn(results(), [{"kind": "workspace", "workspace": name}], 1, tmp_path)
    assert "x (m)" in words(figure)


def test_holes_of_polygons_stay_open(tmp_path):
    figure = drawn(results(), [{"kind": "workspace", "workspace": "polygons"}], 1, tmp_path)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    colours = np.asarray(canvas.buffer_rgba())
    to_pixel = figure.axes[0].transData.transform
    brightness = {}
    for name, point in {"hole": (4, 2.5), "obstacle": (7, 2.5)}.items():
        x, y = to_pixel(point).astype(int)
        brightness[name] = colours[len(colours) - y, x, 0]
    assert brightness["hole"] == 255
    assert brightness["obstacle"] < 200


def test_no_feasible_run_is_said(tmp_path):
    found = results(feasible=(False, False))
    assert set(paths.data(found, options_of(paths, pick=LOWEST))["part"]) == {"start", "target"}
    figure = drawn(found, panels()[:3], 2, tmp_path)
    assert figure.get_label() == "(a), (b), (c) no feasible run among 2."


def test_absent_repeat_is_said(tmp_path):
    figure = drawn(results(), [panels()[1] | {"pick": {"repeat": 7}}], 1, tmp_path)
    assert any("no such run among 3" in text for text in words(figure))


def test_counts_stay_whole_beside_panels_without_runs(tmp_path):
    assert any(
        "2 of 3 runs are feasible" in text
        for text in words(drawn(results(), panels(), 2, tmp_path))
    )


def test_picked_run_that_is_not_feasible_is_marked(tmp_path):
    figure = drawn(results(), [panels()[0] | {"pick": {"repeat": 2}}, panels()[4]], 2, tmp_path)
    assert any("smooth/2 (not feasible)" in text for text in words(figure))


def test_run_without_a_path_is_said(tmp_path):
    found = results(feasible=(False,))
    found.runs["path_curve"] = ""
    own = [panel | {"pick": {"repeat": 0}} for panel in panels()[:3:2]]
    figure = drawn(found, own, 2, tmp_path)
    assert sum("no path" in text for text in words(figure)) == 2


def test_path_of_one_point_is_said(tmp_path):
    found = results()
    found.runs["path_points"] = [[5.0] * 10] * 3
    figure = drawn(found, panels()[:3:2], 2, tmp_path)
    assert any("the curve is a single point" in text for text in words(figure))


@pytest.mark.parametrize("column", ["problem", "method"])
def test_one_run_needs_one_problem_and_one_method(column):
    found = results()
    found.runs.loc[0, column] = "another"
    with pytest.raises(ValueError, match=f"exactly one {column}"):
        paths.data(found, options_of(paths, pick=LOWEST))


def test_peak_far_above_the_limit_is_cut_and_said(tmp_path):
    found = results()
    found.runs["path_points"] = [[5, 5, 35, 5, 5, 5.1, 5, 35, 35, 35.0]] * 3
    figure = drawn(found, panels()[2:3], 1, tmp_path)
    highest = along_path.data(
        found, options_of(along_path, pick=LOWEST, quantity="curvature", limit=0.1)
    )["value"].max()
    assert highest > 1
    assert figure.axes[0].get_ylim()[1] == pytest.approx(0.4)
    assert any(f"largest {highest:.3g} 1/unit" in text for text in words(figure))


def ticks_beyond(axes):
    """Labels of ticks outside of what an axis shows, which are not drawn."""
    found = []
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        found += [
            tick.label1
            for tick in axis.get_major_ticks()
            if not low - 1e-9 <= tick.get_loc() <= high + 1e-9
        ]
    return found


@pytest.mark.parametrize(
    ("found", "own", "columns", "width"),
    [
        *(
            (results(), panels(), columns, width)
            for columns, width in ((1, 85), (2, 174), (3, 174))
        ),
        *(
            (comparison(printed_means()), comparing_panels(), columns, width)
            for columns, width in ((1, 85), (2, 174))
        ),
        *((comparison(), gallery(10), columns, 174) for columns in (4, 5)),
    ],
)
def test_every_sheet_is_fit_for_print(found, own, columns, width, tmp_path):
    figure = drawn(found, own, columns, tmp_path)
    assert figure.get_figwidth() * 25.4 == pytest.approx(width)
    figure.draw_without_rendering()
    beyond = [label for axes in figure.axes for label in ticks_beyond(axes)]
    seen = [
        text
        for text in figure.findobj(Text)
        if text.get_text() and text.get_visible() and text not in beyond
    ]
    assert min(text.get_fontsize() for text in seen) >= style.SMALLEST_TEXT
    for text in seen:
        extent = text.get_window_extent()
        assert 0 <= extent.x0 <= extent.x1 <= figure.bbox.width, text
        assert 0 <= extent.y0 <= extent.y1 <= figure.bbox.height, text
    boxes = [axes.get_tightbbox() for axes in figure.axes if axes.get_visible()]
    assert not any(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[:i])


def test_axes_have_units(tmp_path):
    figure = drawn(results(), panels(), 2, tmp_path)
    labels = [
        label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label
    ]
    assert len(labels) == 8, "four panels with scales"
    assert all(
        label.endswith(("(unit)", "(1/unit)", "(m)"))
        or label in ("generation", "curve parameter t")
        for label in labels
    )


def test_panels_have_letters_and_the_interpretation_of_the_curve(tmp_path):
    figure = drawn(results(), panels(), 2, tmp_path)
    assert "(a) 0 to 15, smooth (quadratic pieces)" in [
        axes.get_title(loc="left") for axes in figure.axes
    ]
    assert "(e) circles" in words(figure)


def test_a_drawing_shows_the_marks_of_its_function_in_their_order(tmp_path):
    figure = drawn(
        results(), [{"kind": "drawing", "data": "marks", "workspace": "circles"}], 1, tmp_path
    )
    axes = figure.axes[0]
    assert [text.get_text() for text in axes.texts if text.get_text()] == ["7"]
    assert [line.get_label() for line in axes.lines][:1] == ["before"]
    np.testing.assert_allclose(axes.lines[0].get_xydata(), [[2.0, 2.5], [8.0, 4.5]])
    assert axes.get_xlabel() == "x (m)", "the workspace gives the scale"


def test_a_mark_that_cannot_be_drawn_is_told():
    with pytest.raises(ValueError, match="has no mark star; known: cell"):
        drawing.data(pd.DataFrame({"mark": ["star"], "x": [0], "y": [0]}), options_of(drawing))
    with pytest.raises(ValueError, match="mark circle needs radius"):
        drawing.data(pd.DataFrame({"mark": ["circle"], "x": [0], "y": [0]}), options_of(drawing))


def save(folder: File) -> None:
    figure = drawn(results(), panels()[1:4], 2, folder)
    sheet.save(figure, *(str(folder / f"figure.{ending}") for ending in ("svg", "png", "pdf")))


def test_equal_data_gives_equal_bytes_in_another_process(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    save(here)
    command = (
        "import sys; from pathlib import Path; from test_figures import save; "
        "save(Path(sys.argv[1]))"
    )
    subprocess.run(
        [sys.executable, "-c", command, str(there)], check=True, cwd=File(__file__).parent
    )
    for name in ("figure.svg", "figure.png", "figure.pdf", "figure.csv"):
        assert (here / name).read_bytes() == (there / name).read_bytes(), name
    assert "generation" in (here / "figure.svg").read_text(), "words of a figure stay words"
    assert (
        "run study/routes/0_15/smooth/1; 2 of 3 runs are feasible"
        in (here / "figure.svg").read_text()
    ), "and it has its caption"


@pytest.mark.parametrize("kind", kinds_of_panel.kinds())
def test_options_stand_in_the_options_of_a_kind_alone(kind):
    """`data` and `draw` get them as they are read, and declare none."""
    module = kinds_of_panel.kind_module(kind)
    assert list(inspect.signature(module.data).parameters)[1:] == ["options"]
    assert list(inspect.signature(module.draw).parameters) == ["axes", "frame", "scene", "options"]


def test_a_panel_of_a_job_has_the_defaults_of_its_kind():
    panel = kinds_of_panel.panel_of(
        {"kind": "boxes", "experiment": "routes", "metric": "objective"}
    )
    assert (panel.by, panel.limits, panel.limit) == ("method", False, None)
    assert kinds_of_panel.panel_of(panel.plain()) == panel


def test_a_function_is_called_once_for_panels_that_draw_the_same_table():
    calls = []

    def table(*workspaces, first=0):
        calls.append((len(workspaces), first))
        return marks(*workspaces)

    one = {"kind": "drawing", "data": "table"}
    given = [
        one,
        one | {"title": "again"},
        one | {"workspace": "circles"},
        one | {"arguments": {"first": 1}},
    ]
    sheet.data(panels_of(given), Sources(workspaces=other_workspaces(), functions={"table": table}))
    assert calls == [(0, 0), (1, 0), (0, 1)]


def test_a_band_around_occupied_cells_is_shaded_and_the_clearance_written(tmp_path):
    found = results((True, True, True))
    frame = paths.data(found, options_of(paths, pick=LOWEST, band=2.5))
    clearance = frame["obstacle_clearance"].iloc[0]
    assert clearance == pytest.approx(
        metrics.values(found.runs, "obstacle_clearance", found.problems).iloc[-1]
    )
    figure = drawn(found, [panels()[0] | {"band": 2.5}], 1, tmp_path)
    assert any(f"clearance {clearance:.3f}" in text for text in words(figure))
    assert not any("clearance" in text for text in words(drawn(found, panels()[:1], 1, tmp_path)))
    (axes, *_) = figure.axes
    band = [patch for patch in axes.patches if patch.get_zorder() == 0.6]
    (left, bottom), (right, top) = band[0].get_path().get_extents().get_points()
    # The occupied cells fill 10 to 30 in x and in y.
    assert (left, bottom, right, top) == pytest.approx((7.5, 7.5, 32.5, 32.5))


def test_a_band_needs_occupied_cells():
    found = comparison()
    with pytest.raises(ValueError, match="band: field: not a grid"):
        paths.data(
            found._replace(runs=found.runs[found.runs["method"] == "smooth"]),
            options_of(paths, pick=LOWEST, band=1.0),
        )
