"""Figures: what is drawn stands in the table beside them, and can be read in print."""

import inspect
import subprocess
import sys
from pathlib import Path as File

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from bezierplan import curves, figures, sheet, style
from bezierplan.analysis.results import Results
from bezierplan.checked import SCHEMAS
from bezierplan.figures import along_path, convergence, paths, workspace
from bezierplan.problem import Path, Problem, Workspace
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.polygons import Polygons

LOWEST = {"lowest": "objective"}


def grid() -> Grid:
    return from_lines(["....", ".##.", "..#.", "...."], 10.0, "unit")


def results(feasible: tuple[bool, ...] = (True, True, False), curve: str = "piecewise_quadratic") -> Results:
    """Runs of one method on one problem, the later the shorter; the last one stops a generation early."""
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
    circles = Circles((-10.0, 10.0, -5.0, 5.0), np.array([[0.0, 1.0], [4.0, -2.0]]), np.array([1.0, 2.0]), "m")
    square = np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 4.0], [1.0, 4.0]])
    hole = np.array([[3.0, 2.0], [5.0, 2.0], [5.0, 3.0], [3.0, 3.0]])
    return {"circles": circles, "polygons": Polygons((0.0, 10.0, 0.0, 5.0), ((square, hole),), "m")}


def scene(found: Results) -> sheet.Scene:
    workspaces = {"map": grid(), "narrow": from_lines(["..."] * 4, 10.0, "unit"), **other_workspaces()}
    return sheet.Scene({"routes": found.problems}, workspaces, {"smooth": "smooth (quadratic pieces)"}, "unit")


def panels() -> list[dict]:
    run = {"experiment": "routes", "where": {"problem": "0_15", "method": "smooth"}, "pick": LOWEST}
    return [
        {"kind": "paths", "title": "0 to 15", **run},
        {"kind": "convergence", "title": "0 to 15", **run},
        {"kind": "along_path", "title": "0 to 15", **run, "quantity": "curvature", "limit": 0.1},
        {"kind": "workspace", "title": "embedded", "workspace": "narrow", "numbers": "all", "embed": True},
        {"kind": "workspace", "title": "circles", "workspace": "circles"},
    ]


def drawn(found: Results, own: list[dict], columns: int, folder: File) -> Figure:
    """A figure as the workflow makes it: by way of the csv."""
    file = str(folder / "figure.csv")
    sheet.write_data(sheet.data(own, {"routes": found}, scene(found).workspaces), file)
    return sheet.draw(own, sheet.read_data(file), scene(found), columns)


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


def test_csv_keeps_every_number(tmp_path):
    found = results()
    frame = sheet.data(panels(), {"routes": found}, scene(found).workspaces)
    assert frame.columns[0] == "panel"
    assert sorted(frame["panel"].unique()) == [0, 1, 2, 3, 4]
    sheet.write_data(frame, str(tmp_path / "figure.csv"))
    read = sheet.read_data(str(tmp_path / "figure.csv"))
    for column in ("x", "y", "t", "value", "median"):
        np.testing.assert_array_equal(read[column], frame[column])


def test_paths_data_holds_all_that_is_drawn():
    found = results()
    frame = paths.data(found, pick=LOWEST)
    assert set(frame["run"]) == {"study/routes/0_15/smooth/1"}, "the shortest run is not feasible"
    parts = {part: points[["x", "y"]].to_numpy() for part, points in frame.groupby("part")}
    assert set(parts) == {"start", "target", "bound", "hull", "control", "path"}
    np.testing.assert_array_equal(parts["control"].ravel(), found.runs["path_points"][1])
    np.testing.assert_array_equal(parts["bound"], [[5, 5], [10, 30], [35, 35]])
    np.testing.assert_allclose(parts["path"][[0, -1]], [[5, 5], [35, 35]])
    np.testing.assert_array_equal(parts["hull"][0], parts["hull"][-1])


def test_paths_meet_the_corners_of_a_polyline():
    frame = paths.data(results(curve="polyline"), pick=LOWEST)
    points = {part: {tuple(point) for point in own[["x", "y"]].round(9).to_numpy()} for part, own in frame.groupby("part")}
    assert points["control"] <= points["path"]


def test_convergence_prolongs_runs_that_stopped_early():
    frame = convergence.data(results(), pick=LOWEST)
    assert list(frame["generation"]) == [0, 1, 2]
    assert list(frame["objective"]) == [90, 70, 59]
    assert frame["median"].iloc[2] == 60
    np.testing.assert_allclose(frame["quantile90"].iloc[2], np.quantile([60, 59, 70], 0.9))


def test_along_path_leaves_out_where_the_curve_stands_still(tmp_path):
    found = results()
    frame = along_path.data(found, pick=LOWEST, quantity="curvature", limit=0.1)
    still = frame.loc[frame["value"].isna(), "t"]
    assert (frame["value"].dropna() >= 0).all()
    assert len(still) > 0
    assert still.between(0.66, 0.67).all(), "two equal control points stop the curve where its second piece ends"
    figure = drawn(found, panels()[2:3], 1, tmp_path)
    assert any(f"{len(still)} of 1001 samples left out" in text for text in words(figure))


@pytest.mark.parametrize(("numbers", "printed"), [("all", 16), ("free", 13), ("none", 0)])
def test_workspace_numbers(numbers, printed):
    frame = workspace.data(grid(), numbers=numbers)
    assert frame["number"].notna().sum() == printed
    centre = frame[frame["number"] == 7]
    if printed:
        assert (centre["x"].item(), centre["y"].item()) == grid().centre(7)


def test_embedding_marks_surplus_cells():
    frame = workspace.data(from_lines(["..."] * 3, 10.0, "unit"), numbers="all", embed=True)
    assert set(frame.loc[frame["part"] == "surplus", "number"]) == {3, 7, 11, 12, 13, 14, 15}


@pytest.mark.parametrize(("name", "parts"), [("circles", {"corner", "circle"}), ("polygons", {"corner", "ring"})])
def test_workspaces_without_cells(name, parts, tmp_path):
    assert set(workspace.data(other_workspaces()[name])["part"]) == parts
    with pytest.raises(ValueError, match="kind grid"):
        workspace.data(other_workspaces()[name], embed=True)
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
    assert set(paths.data(found, pick=LOWEST)["part"]) == {"start", "target"}
    figure = drawn(found, panels()[:3], 2, tmp_path)
    assert sum("no feasible run among 2" in text for text in words(figure)) == 3


def test_absent_repeat_is_said(tmp_path):
    figure = drawn(results(), [panels()[1] | {"pick": {"repeat": 7}}], 1, tmp_path)
    assert any("no such run among 3" in text for text in words(figure))


def test_counts_stay_whole_beside_panels_without_runs(tmp_path):
    assert any("2 of 3 runs are feasible" in text for text in words(drawn(results(), panels(), 2, tmp_path)))


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
        paths.data(found, pick=LOWEST)


def test_peak_far_above_the_limit_is_cut_and_said(tmp_path):
    found = results()
    found.runs["path_points"] = [[5, 5, 35, 5, 5, 5.1, 5, 35, 35, 35.0]] * 3
    figure = drawn(found, panels()[2:3], 1, tmp_path)
    highest = along_path.data(found, pick=LOWEST, quantity="curvature", limit=0.1)["value"].max()
    assert highest > 1
    assert figure.axes[0].get_ylim()[1] == pytest.approx(0.4)
    assert any(f"highest {highest:.3g} 1/unit" in text for text in words(figure))


@pytest.mark.parametrize(("columns", "width"), [(1, 85), (2, 174), (3, 174)])
def test_every_sheet_is_fit_for_print(columns, width, tmp_path):
    figure = drawn(results(), panels(), columns, tmp_path)
    assert figure.get_figwidth() * 25.4 == pytest.approx(width)
    figure.draw_without_rendering()
    seen = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    assert min(text.get_fontsize() for text in seen) >= style.SMALLEST_TEXT
    for text in seen:
        extent = text.get_window_extent()
        assert 0 <= extent.x0 <= extent.x1 <= figure.bbox.width, text
        assert 0 <= extent.y0 <= extent.y1 <= figure.bbox.height, text
    boxes = [axes.get_tightbbox() for axes in figure.axes if axes.get_visible()]
    assert not any(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[:i])


def test_axes_have_units(tmp_path):
    figure = drawn(results(), panels(), 2, tmp_path)
    labels = [label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label]
    assert len(labels) == 8, "four panels with scales"
    assert all(label.endswith(("(unit)", "(1/unit)", "(m)", "(-)")) for label in labels)


def test_panels_have_letters_and_the_reading_of_the_curve(tmp_path):
    figure = drawn(results(), panels(), 2, tmp_path)
    assert "(a) 0 to 15, smooth (quadratic pieces)" in [axes.get_title(loc="left") for axes in figure.axes]
    assert "(e) circles" in words(figure)


def save(folder: File) -> None:
    sheet.save(drawn(results(), panels()[1:4], 2, folder), str(folder / "figure.svg"), str(folder / "figure.png"))


def test_equal_data_gives_equal_bytes_in_another_process(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    save(here)
    command = "import sys; from pathlib import Path; from test_figures import save; save(Path(sys.argv[1]))"
    subprocess.run([sys.executable, "-c", command, str(there)], check=True, cwd=File(__file__).parent)
    for name in ("figure.svg", "figure.png", "figure.csv"):
        assert (here / name).read_bytes() == (there / name).read_bytes(), name
    assert "generation (-)" in (here / "figure.svg").read_text(), "words of a figure stay words"


def described_options(kind):
    """Options of a kind by the schema: all, and those that a panel must have."""
    schema = yaml.safe_load((SCHEMAS / "artefacts.schema.yaml").read_text())["$defs"]["panel"]
    assert kind in schema["properties"]["kind"]["enum"]
    for rule in schema["allOf"]:
        condition = rule["if"]["properties"]["kind"]
        if kind in condition.get("enum", [condition.get("const")]):
            return set(rule["then"]["properties"]) - set(sheet.PANEL_KEYS), set(rule["then"]["required"]) - set(sheet.PANEL_KEYS)
    return None


@pytest.mark.parametrize("kind", sorted(file.stem for file in File(figures.__file__).parent.glob("[!_]*.py")))
def test_schema_gives_the_options_of_a_kind(kind):
    parameters = inspect.signature(sheet.kind_module(kind).data).parameters.values()
    options = {parameter.name: parameter.default for parameter in parameters if parameter.kind is inspect.Parameter.KEYWORD_ONLY}
    needed = {name for name, default in options.items() if default is inspect.Parameter.empty}
    assert described_options(kind) == (set(options), needed)
