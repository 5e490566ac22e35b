"""Each line, band, bar and box of a panel is drawn from the column that it is named after: small
tables, every column unlike the others.
"""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from panels import options_of

from bezierplan.figures import sheet
from bezierplan.figures.panels import along_path, boxes, convergence, dots, lines
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem

GRID = from_lines(["..", ".."], 1.0, "m")
SCENE = sheet.Scene(
    {"first": {"across": Problem("across", GRID, (0.5, 0.5), (1.5, 1.5))}}, {}, {}, "m"
)
COUNTS = {"runs": 10, "feasible_runs": 9}


def drawn(kind, frame, **keys):
    axes = Figure().add_subplot()
    kind.draw(axes, frame, SCENE, options_of(kind, experiment="first", **keys))
    return axes


def labelled(axes, label):
    """x and y of the one line of a label."""
    (line,) = [line for line in axes.lines if line.get_label() == label]
    return [np.asarray(each, dtype=float).tolist() for each in line.get_data()]


def band(axes):
    """x, lowest and highest y of the first filled band."""
    corners = axes.collections[0].get_paths()[0].vertices
    x = sorted(set(corners[:, 0].tolist()))
    ends = [corners[corners[:, 0] == place, 1] for place in x]
    return x, [each.min() for each in ends], [each.max() for each in ends]


def statistics(method):
    own = {"a": 0.0, "b": 100.0}[method]
    numbers = {
        "points": [2, 3, 5],
        "value": [own + 4, own + 5, own + 7],
        "low95": [own + 1, own + 2, own + 3],
    }
    return pd.DataFrame(
        {
            **numbers,
            "high95": [own + 8, own + 9, own + 10],
            "part": "statistic",
            "method": method,
            "n": COUNTS["runs"],
            **COUNTS,
        }
    )


def test_a_line_is_the_statistic_in_the_band_of_its_interval():
    repeats = pd.DataFrame(
        {"points": [2, 3, 5], "value": [20.0, 30.0, 50.0], "part": "repeat", "repeat": 1}
    )
    frame = pd.concat([statistics("a").drop(columns="method"), repeats])
    axes = drawn(lines, frame, x="points", metric="length", statistic="median")
    (single,) = [line for line in axes.lines if line.get_label() == "single runs"]
    assert [each.tolist() for each in single.get_data()] == [[2, 3, 5], [20, 30, 50]]
    (line,) = [line for line in axes.lines if line is not single]
    assert [each.tolist() for each in line.get_data()] == [[2, 3, 5], [4, 5, 7]]
    assert band(axes) == ([2, 3, 5], [1, 2, 3], [8, 9, 10])


def test_each_line_is_that_of_its_group():
    axes = drawn(
        lines,
        pd.concat(map(statistics, "ab")).assign(repeat=np.nan),
        x="points",
        metric="length",
        hue="method",
    )
    assert [labelled(axes, method) for method in "ab"] == [
        [[2, 3, 5], [4, 5, 7]],
        [[2, 3, 5], [104, 105, 107]],
    ]


def history():
    columns = {
        "objective": [9.0, 7.0, 6.0],
        "median": [19.0, 17.0, 16.0],
        "quartile1": [4.0, 3.0, 2.0],
        "quartile3": [29.0, 28.0, 27.0],
    }
    columns |= {"low95": [8.0, 6.5, 5.5], "high95": [10.0, 7.5, 6.5]}
    run = {
        "problem": "across",
        "method": "a",
        "id": "s/first/across/a/3",
        "repeat": 3,
        "curve": "bezier",
        "length": 6.0,
    }
    return pd.DataFrame(
        {
            "generation": [0, 1, 2],
            **columns,
            "bound": 1.5,
            "reference": 1.75,
            **run,
            **COUNTS,
            "feasible": True,
        }
    )


def test_convergence_shows_the_run_the_median_and_the_band(monkeypatch):
    monkeypatch.setattr(convergence, "run_note", lambda *_: "")
    monkeypatch.setattr(convergence, "feasible_note", lambda *_: "")
    axes = drawn(convergence, history(), pick={"repeat": 3})
    assert labelled(axes, "run shown") == [[0, 1, 2], [9, 7, 6]]
    assert labelled(axes, "median of all runs") == [[0, 1, 2], [19, 17, 16]]
    assert band(axes) == ([0, 1, 2], [4, 3, 2], [29, 28, 27])
    assert labelled(axes, "exact shortest path")[1] == [1.5, 1.5]
    assert labelled(axes, "best known path of the same kind")[1] == [1.75, 1.75]


def test_convergence_of_groups_shows_their_objectives():
    other = history().assign(method="b", objective=[49.0, 48.0, 44.0])
    axes = drawn(convergence, pd.concat([history(), other]), hue="method")
    curves = [
        line.get_ydata().tolist()
        for line in axes.lines
        if len(line.get_xdata()) == 3 and line.get_transform() == axes.transData
    ]
    assert curves == [[9, 7, 6], [49, 48, 44]]
    assert band(axes) == ([0, 1, 2], [8, 6.5, 5.5], [10, 7.5, 6.5])


def test_a_box_has_its_parts_where_they_lie():
    parts = {
        "low": 1.0,
        "quartile1": 3.0,
        "median": 4.0,
        "quartile3": 7.0,
        "high": 9.0,
        "mean": 5.0,
        "beyond": 20.0,
        "published": 6.0,
    }
    frame = pd.DataFrame(
        [{"method": "a", "part": part, "value": value, **COUNTS} for part, value in parts.items()]
    )
    axes = drawn(boxes, frame, metric="objective")
    (box,) = axes.patches
    assert sorted(set(box.get_path().vertices[:, 0].tolist())) == [3, 7]
    vertical = [
        line.get_xdata()[0]
        for line in axes.lines
        if len(line.get_xdata()) == 2 and line.get_xdata()[0] == line.get_xdata()[1]
    ]
    along = [
        sorted(line.get_xdata())
        for line in axes.lines
        if len(line.get_xdata()) == 2 and line.get_xdata()[0] != line.get_xdata()[1]
    ]
    assert sorted(vertical) == [1, 4, 9]
    assert sorted(along) == [[1, 3], [7, 9]]
    assert labelled(axes, "mean") == [[5], [0]]
    assert labelled(axes, "published mean") == [[6], [0]]
    assert labelled(axes, "outlier") == [[20], [0]]


def test_a_dot_stands_at_its_statistic():
    frame = (
        pd.concat(map(statistics, "ab"))
        .drop(columns="part")
        .assign(bound=0.5, published=[np.nan] * 5 + [104.5], feasible_runs=10)
    )
    axes = drawn(dots, frame, x="points", hue="method", metric="length")
    (a, rows_a), (b, rows_b) = (labelled(axes, name) for name in "ab")
    assert (a, b) == ([4, 5, 7], [104, 105, 107])
    assert [round((low + high) / 2, 9) for low, high in zip(rows_a, rows_b)] == [0, 1, 2], (
        "side by side about their row"
    )
    assert labelled(axes, "published") == [[104.5], [rows_b[2]]] or np.isnan(
        labelled(axes, "published")[0][0]
    )
    spans = [
        sorted(path.vertices[:, 0].tolist())
        for drawn in axes.collections
        for path in drawn.get_paths()
    ]
    for low, high in [(1, 8), (2, 9), (3, 10), (101, 108), (102, 109), (103, 110)]:
        assert [low, high] in spans
    assert spans.count([0.5, 0.5]) == 3


def test_a_quantity_along_a_path_stands_over_the_parameter(monkeypatch):
    monkeypatch.setattr(along_path, "run_note", lambda *_: "")
    frame = pd.DataFrame(
        {
            "t": [0.0, 0.5, 1.0],
            "value": [0.25, 0.75, 0.5],
            "limit": 0.6,
            "problem": "across",
            "quantity": "curvature",
        }
    ).assign(pieces=2)
    axes = drawn(along_path, frame, pick={"repeat": 3}, quantity="curvature")
    assert labelled(axes, "path") == [[0, 0.5, 1], [0.25, 0.75, 0.5]]
    assert labelled(axes, "largest magnitude") == [[0.5], [0.75]]
    assert labelled(axes, "joint of two pieces")[0] == [0.5, 0.5]
    assert labelled(axes, "published limit: 0.6 1/m, for turns to either side")[1] == pytest.approx(
        [0.6, 0.6]
    )
