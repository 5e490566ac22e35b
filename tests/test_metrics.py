"""Metrics: closed forms of paths and histories, and which runs count."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.analysis import metrics
from bezierplan.papers.elhoseny2017 import metrics as elhoseny2017
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path, Problem

# One occupied cell, x and y from 10 to 20.
GRID = from_lines(["....", "....", ".#..", "...."], 10.0, "unit")
PROBLEMS = {"across": Problem("across", GRID, (5.0, 5.0), (35.0, 35.0))}

histories = st.lists(st.lists(st.floats(1, 1000), min_size=1, max_size=40), min_size=1, max_size=5)


def runs(paths=(), **columns) -> pd.DataFrame:
    """A runs table of feasible runs, with other columns as given."""
    count = len(paths) or len(next(iter(columns.values())))
    table = {"problem": ["across"] * count, "feasible": [True] * count, **columns}
    if paths:
        table["path_curve"] = [curve for curve, _ in paths]
        table["path_points"] = [np.ravel(points).astype(float) for _, points in paths]
    return pd.DataFrame(table)


def values(name: str, *paths, problems=PROBLEMS, **columns) -> list[float]:
    return metrics.compute_values(runs(paths, **columns), name, problems).to_list()


def value(name: str, curve: str, points: list) -> float:
    return values(name, (curve, points))[0]


def history_values(name: str, *history: list[float]) -> list[float]:
    return values(name, history=list(history))


def about(*expected):
    return pytest.approx(list(expected), nan_ok=True)


@pytest.mark.parametrize(
    ("points", "spare"),
    [
        ([(25, 5), (35, 35)], 0),
        ([(5, 5), (5, 35), (35, 35)], 0),  # the leg past the corner would enter the occupied cell
        ([(5, 15), (5, 25), (15, 25)], 1),  # it may touch the cell's corner
        ([(25, 5), (30, 5), (35, 5), (35, 35)], 1),  # a node on a straight way is no corner
        ([(5, 5), (20, 5), (20, 20), (35, 35)], 1),
        ([(25, 5), (25, 5)], 0),
    ],
)
def test_corners_that_can_be_left_out(points, spare):
    assert value("spare_corners", "polyline", points) == spare


def test_a_curve_has_no_corners_to_leave_out():
    assert math.isnan(value("spare_corners", "bezier", [(5, 5), (35, 5), (35, 35)]))


def test_infeasible_run_has_no_length_but_an_objective():
    table = {"objective": [3.0, 9.0], "length": [3.0, 2.0], "bound": [2.0, 2.0]}
    table |= {"feasible": [True, False]}
    assert values("length", **table) == about(3.0, math.nan)
    assert values("gap", **table) == about(0.5, math.nan)
    assert values("objective", **table) == [3.0, 9.0]
    assert values("feasible", **table) == [1.0, 0.0]


def test_gap_best_is_against_the_best_feasible_run_of_the_same_method_and_condition():
    found = values(
        "gap_best",
        experiment=["e"] * 5,
        condition=[*"aaaba"],
        method=["m", "m", "m", "m", "other"],
        length=[4.0, 5.0, 1.0, 7.0, 9.0],
        feasible=[True, True, False, True, True],
    )
    assert found == about(0.0, 0.25, math.nan, 0.0, 0.0)


def test_generations_of_an_early_stop_are_held():
    early, late = [200.0, 104.0, 100.0], [400.0, 300.0, 106.0, 105.0, 101.0, 100.5, 100.0]
    assert history_values("generation_improved", early, late) == [2, 6]
    assert history_values("generation_1pct", early, late) == [2, 4]
    assert history_values("generation_5pct", early, late) == [1, 3]


@given(histories)
def test_generations_agree_with_their_definition(drawn):
    history = [np.minimum.accumulate(values) for values in drawn]
    expected = [
        next(g for g, best in enumerate(values) if best <= values[-1] * 1.05) for values in history
    ]
    assert history_values("generation_5pct", *history) == expected


def test_curvature_of_a_parabola():
    # y = x^2 / 2 from x = -1 to 1: largest curvature 1, at the vertex.
    assert value("max_curvature", "bezier", [[-1, 0.5], [0, -0.5], [1, 0.5]]) == pytest.approx(1)


def test_curvature_jumps_at_corners_alone():
    points = [[5, 5], [5, 25], [25, 5], [35, 35], [5, 35]]
    assert value("curvature_jump", "bezier", points) == 0
    assert value("curvature_jump", "polyline", points) == math.inf


def test_curvature_is_never_infinite():
    points = [[5, 5], [5, 5], [25, 5], [35, 35]]
    assert math.isfinite(value("max_curvature", "bezier", points))


def test_distinct_control_points():
    assert value("distinct_points", "bezier", [[5, 5], [15, 5], [5, 5], [35, 35], [15, 5]]) == 3


def test_occupied_control_points():
    # On the lower and left side of the occupied cell, inside, and on its upper and right side,
    # which belong to the next cells.
    assert (
        value("occupied_points", "bezier", [[15, 10], [10, 15], [15, 15], [15, 20], [20, 15]]) == 3
    )


def map_of(*lines: str, cell: float = 10.0) -> dict:
    return {"across": PROBLEMS["across"]._replace(workspace=from_lines([*lines], cell, "unit"))}


def test_a_cell_is_its_column_and_its_row():
    """The third cell from the left in the lowest row, and not the first one in the third row."""
    grid = map_of("....", "....", "....", "..#.")
    paths = ("bezier", [[25, 5], [5, 25], [5, 5]]), ("bezier", [[5, 25], [5, 25], [5, 5]])
    assert values("occupied_points", *paths, problems=grid) == [1, 0]


def test_a_polygon_may_be_blocked_where_its_path_is_free():
    grid = map_of("..#..", ".....", ".....", ".....", ".....")
    over, under = ([[5, 5], [25, height], [45, 5]] for height in (48, 38))
    paths = [("bezier", points) for points in (over, under, under)]
    found = values("free_polygon", *paths, problems=grid, feasible=[True, True, False])
    assert found == [False, True, False]


@pytest.mark.parametrize("name", ["distinct_points", "occupied_points", "max_curvature"])
def test_run_without_a_path_has_no_value(name):
    found = values(name, ("", []), ("bezier", [[5, 5], [5, 35]]))
    assert np.isnan(found).tolist() == [True, False]


@pytest.mark.parametrize("name", ["length", "generation_1pct", "max_curvature", "gap_best"])
def test_no_runs_have_no_values(name):
    assert metrics.compute_values(runs(history=[[1.0]]).iloc[:0], name, PROBLEMS).empty


def test_index_of_the_runs_is_kept():
    table = runs(history=[[2.0, 1.0], [1.0], [3.0, 2.0, 1.0]], feasible=[True, False, True]).iloc[
        [2, 0, 1]
    ]
    assert metrics.compute_values(table, "generation_improved", PROBLEMS).to_dict() == {
        2: 2,
        0: 1,
        1: 0,
    }


def test_units():
    assert metrics.find_unit("length", "m") == "m"
    assert metrics.find_unit("max_curvature", "cell") == "1/cell"
    assert metrics.find_unit("evaluations", "m") == "-"


def test_an_obstacle_is_in_the_way_of_what_is_longer_than_rounding_says():
    longer = np.array([0.0, 0.5e-9, 2e-9, 0.1])
    found = values("blocked", bound=math.hypot(30, 30) * (1 + longer))
    assert found == [False, False, True, True]


CORNERED = [(0, 0), (5, 5), (15, 5), (15, 5), (25, 15), (35, 25)]


@pytest.mark.parametrize(
    ("name", "of_polyline", "of_curve"),
    [
        ("heading_max", math.pi / 4, pytest.approx(0.001, abs=0.009)),
        ("turning", math.pi / 2, pytest.approx(math.pi / 2, abs=2e-3)),
        ("corners", 2, 0),
    ],
)
def test_headings(name, of_polyline, of_curve):
    """A curve turns from its first to its last leg, here without an inflection, and has no
    corner.
    """
    assert value(name, "polyline", CORNERED) == pytest.approx(of_polyline)
    assert value(name, "bezier", [(5, 5), (5, 35), (35, 35)]) == of_curve


def test_a_point_and_a_line_do_not_turn():
    for points in ([(5, 5), (5, 5)], [(5, 5), (15, 15), (35, 35)]):
        found = [value(name, "polyline", points) for name in ("heading_max", "turning", "corners")]
        assert found == pytest.approx([0, 0, 0])


def test_pieces_of_a_smooth_curve_have_no_corners():
    assert value("corners", "piecewise_quadratic", [(5, 5), (5, 35), (35, 35), (35, 5)]) == 0
    # A repeated control point stops the curve, which then turns.
    assert value("corners", "piecewise_quadratic", [(5, 5), (5, 35), (5, 35), (35, 35)]) == 1


@pytest.mark.parametrize(
    ("points", "clearance"),
    [
        ([(0, 0), (0, 40)], 10.0),
        ([(0, 0), (5, 5), (5, 35)], 5.0),
        ([(0, 40), (40, 40)], 20.0),
        ([(0, 30), (30, 0)], 0.0),
        ([(25, 35), (35, 25)], 10 * math.sqrt(2)),
    ],
)
def test_clearance_to_occupied_cells_does_not_count_the_border(points, clearance):
    assert value("obstacle_clearance", "polyline", points) == pytest.approx(clearance, abs=1e-8)


def test_only_paths_that_keep_the_safety_distance_have_that_length():
    paths = [("polyline", [(0, 0), (0, 40)])] * 3
    distances = {"length": [40.0] * 3, "safety_distance": [9.0, 11.0, math.nan]}
    assert values("length_at_distance", *paths, **distances) == about(40.0, math.nan, math.nan)


def test_clearance_in_an_empty_grid_is_infinite():
    path = ("polyline", [(0, 0), (40, 40)])
    assert values("obstacle_clearance", path, problems=map_of("..", "..", cell=20.0)) == [math.inf]


def test_equal_objectives_share_the_mean_of_their_ranks():
    """Two methods that tie for the first rank get rank 1.5 each (tharwat2018, Section 5.1), in
    every repeat for itself.
    """
    table = {"objective": [4.0, 1.0, 1.0, 2.0, 5.0, 5.0, 5.0, 1.0], "repeat": [0] * 4 + [1] * 4}
    assert values("rank", **table, feasible=[True, False] * 4) == [4, 1.5, 1.5, 3, 3, 3, 3, 1]


def rounded_corner(radius):
    """A leg of length 5, a quarter of a circle as one cubic piece, a leg of length 5."""
    k = 4 / 3 * math.tan(math.pi / 8) * radius
    x = [0, 5 / 3, 10 / 3, 5, 5 + k, 5 + radius, 5 + radius, 5 + radius, 5 + radius, 5 + radius]
    y = [0, 0, 0, 0, 0, radius - k, radius, radius + 5 / 3, radius + 10 / 3, radius + 5]
    return Path("cubic_chain", np.column_stack([x, y]).astype(float))


@pytest.mark.parametrize("radius", [1.0, 2.0, 4.0])
def test_bending_of_an_arc_is_its_angle_over_its_radius_and_its_largest_turn_that_of_one_part(
    radius,
):
    path = rounded_corner(radius)
    assert elhoseny2017.bending(path) == pytest.approx(math.pi / 2 / radius, rel=0.05)
    assert elhoseny2017.max_turn(path) == pytest.approx(
        math.degrees(elhoseny2017.BENDING_PART / radius), rel=0.05
    )


def test_a_corner_bends_by_its_squared_angle_over_the_length_of_a_part():
    corner = Path("polyline", np.array([[0.0, 0], [3, 0], [3, 3]]))
    assert elhoseny2017.bending(corner) == pytest.approx(
        (math.pi / 2) ** 2 / elhoseny2017.BENDING_PART
    )
    assert elhoseny2017.max_turn(corner) == pytest.approx(90)


def test_what_is_straight_does_not_bend():
    for path in (
        Path("polyline", np.array([[0.0, 0], [1, 1], [4, 4]])),
        Path("bezier", np.array([[0.0, 0], [1, 2], [4, 8]])),
    ):
        assert elhoseny2017.bending(path) == pytest.approx(0, abs=1e-12)
        assert elhoseny2017.max_turn(path) == pytest.approx(0, abs=1e-5)
    assert elhoseny2017.bending(Path("polyline", np.zeros((2, 2)))) == 0
