"""What Python programs may give to the functions of the interface, and what they are told."""

import functools
import json

import numpy as np
import pytest

import bezierplan as bp

ROOM = bp.Grid(np.zeros((8, 8), dtype=bool), 1.0, "m")
PROBLEM = bp.Problem("room", ROOM, (0.5, 0.5), (7.5, 7.5))
DIAGONAL = 7 * 2**0.5


def planned(problem, rng):
    from bezierplan.planners import Plan

    return Plan.of_one(bp.Path("polyline", np.array([problem.start, problem.target])), 1.0, "one")


class Planner:
    def plan(self, problem, rng):
        return planned(problem, rng)


@pytest.mark.parametrize("method", [planned, Planner().plan, functools.partial(planned)])
def test_what_can_be_called_is_a_method(method):
    assert bp.plan(PROBLEM, method).length == pytest.approx(DIAGONAL)


@pytest.mark.parametrize(
    ("method", "told"),
    [
        (np, "method: numpy: no function plan; expected plan"),
        (print, "method: print: function plan: expected plan"),
        (dict, "method: dict: no function plan; expected plan"),
        (lambda problem: None, "method: <lambda>: function plan: expected plan"),
        (3, "method: 3: no function plan"),
    ],
)
def test_what_is_no_method_is_told(method, told):
    with pytest.raises(TypeError, match=f"^{told}"):
        bp.plan(PROBLEM, method)


def test_a_file_that_is_no_planner_is_told(tmp_path):
    """What else it may be is in `test_study_faults`."""
    file = tmp_path / "broken.py"
    file.write_text("def plan(:\n")
    with pytest.raises(ValueError, match=f"^method: {file}: SyntaxError: .*line 1"):
        bp.plan(PROBLEM, str(file))


@pytest.mark.parametrize("via", [[(5.0, 2.0)], np.array([[5.0, 2.0]]), ((5, 2),)])
def test_way_points_of_any_sequence(via):
    assert bp.plan(PROBLEM, via=via).via == ((5.0, 2.0),)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"via": (5.0, 5.0)}, r"via: \(5.0, 5.0\); expected places"),
        ({"via": "5,5"}, "via: '5,5'; expected places"),
        ({"via": None}, "via: None; expected places"),
        ({"via": [(1.0, 1.0, 0.0)]}, r"via: .*; expected places"),
        ({"robot_radius": "0.1"}, "robot_radius: '0.1'; expected a number"),
        ({"robot_radius": True}, "robot_radius: True; expected a number"),
        ({"robot_radius": None}, "robot_radius: None; expected a number"),
    ],
)
def test_wrong_arguments_are_told_by_name(arguments, told):
    with pytest.raises(ValueError, match=f"^{told}"):
        bp.plan(PROBLEM, **arguments)


@pytest.mark.parametrize("value", [np.int64(1), np.float32(1.0), 1])
def test_numbers_of_numpy_are_settings(value):
    assert bp.plan(PROBLEM, turning_radius=value).settings["turning_radius"] == 1


@pytest.mark.parametrize("function", [bp.plan, bp.shortest_path])
@pytest.mark.parametrize("place", [None, "ab", (1.0,), (1.0, 1.0, 1.57), ("2", "1"), (1j, 0.0)])
def test_a_place_is_two_numbers(function, place):
    """A third one, such as a heading, is not dropped in silence."""
    with pytest.raises(ValueError, match=r"^start: .*; expected x and y, two numbers"):
        function(PROBLEM._replace(start=place))


@pytest.mark.parametrize("place", [(1, 1), [1.0, 1.0], np.array([1.0, 1.0])])
def test_places_of_any_sequence(place):
    assert bp.shortest_path(PROBLEM._replace(start=place)).length == pytest.approx(6.5 * 2**0.5)


def test_a_map_is_a_map():
    with pytest.raises(TypeError, match=r"^problem: .*; expected a Problem on a map"):
        bp.plan(PROBLEM._replace(workspace="room.txt"))


def test_points_of_a_path_may_be_whole_or_listed():
    for points in ([[1, 1], [3, 1]], np.array([[1, 1], [3, 1]])):
        assert bp.check(PROBLEM, bp.Path("polyline", points)).length == 2.0


@pytest.mark.parametrize(
    ("path", "told"),
    [
        (None, "expected a Path"),
        (bp.Path("polyline", np.zeros((3, 2), complex)), "expected a Path"),
        (bp.Path("bow", np.ones((3, 2))), "curve: 'bow'; expected one of"),
    ],
)
def test_a_path_that_is_none_is_told(path, told):
    """What else may be wrong in one, `test_answer` asks of planners."""
    with pytest.raises(ValueError, match=f"^path: {told}"):
        bp.check(PROBLEM, path)


@pytest.mark.parametrize("name", ["*", "", "[a-z]*"])
def test_an_experiment_is_a_name_and_no_pattern(name, tmp_path):
    (tmp_path / "runs" / "routes" / "smooth").mkdir(parents=True)
    (tmp_path / "runs" / "routes" / "smooth" / "0.parquet").write_bytes(b"")
    with pytest.raises(ValueError, match=r"^experiment: .*no runs of it"):
        bp.results(tmp_path, name)


@pytest.mark.parametrize("arguments", [{"step": "1"}, {"step": 0}])
def test_wrong_numbers_of_a_file_are_told_by_name(arguments, tmp_path):
    name = [*arguments][-1]
    with pytest.raises(ValueError, match=f"^{name}: .*; expected a number above 0"):
        bp.plan(PROBLEM).save(tmp_path / "path.csv", **arguments)


@pytest.mark.parametrize("step", [1e-308, 1e-9])
def test_a_tiny_step_is_told(step):
    with pytest.raises(ValueError, match=f"^step: {step}; expected at most .* samples"):
        bp.plan(PROBLEM).sample(step=step)


BORDER = (-5.0, 5.0, -5.0, 5.0)
SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def circles(centres, radii, bounds=BORDER):
    return bp.Circles(bounds, np.array(centres), np.array(radii), "m")


def polygon(*rings):
    return bp.Polygons(BORDER, (rings,), "m")


@pytest.mark.parametrize(
    ("room", "fault"),
    [
        (circles([(0.0, 0.0)], [np.nan]), "circles: nan is not a coordinate"),
        (circles([(0.0, 0.0)], [-1.0]), "radii: least -1"),
        (circles([(0.0, 0.0)], [1.0, 2.0]), "centres: an array"),
        (circles([(0.0, 0.0)], [1.0], (5.0, -5.0, -5.0, 5.0)), "bounds: .* low below high"),
        (polygon(SQUARE[:2]), "obstacles: 0: A linearring"),
        (polygon(SQUARE, 3 * SQUARE), "obstacles: 0: Hole lies outside"),
        (polygon(SQUARE * [1, np.inf]), "obstacles: 0: -?inf is not a coordinate"),
        (bp.Grid(np.zeros((4, 4), bool), -1.0, "m"), "cell: -1"),
        (bp.Grid(np.zeros(4, bool), 1.0, "m"), "occupied: an array"),
    ],
)
@pytest.mark.parametrize("function", [bp.plan, bp.shortest_path])
def test_a_map_that_a_program_makes_is_checked_at_one_door(room, fault, function):
    with pytest.raises(ValueError, match=f"^{fault}"):
        function(bp.Problem("room", room, (-2.0, 0.0), (2.0, 0.0)))


def test_a_list_of_problems_is_planned_in_one_call(tmp_path):
    file = tmp_path / "problems.csv"
    file.write_text("name,start_x,start_y,target_x,target_y\na,2,10,18,10\nb,2,11,18,10\n")
    rows = bp.plan_all(bp.read_map(bp.example_map("gaps")), file, robot_radius=0.3)
    assert rows["name"].to_list() == ["a", "b"]
    assert rows["feasible"].all()
    assert rows["clearance"].to_numpy() == pytest.approx(0.3, abs=1e-4)


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("x,y\n1,2\n", "column: start_x: unknown"),
        ("start_x,start_y,target_x,target_y\n2,10,18,10\n,1,2,3\n", r"row 2: start: \(nan, 1"),
        ("start_x,start_y,target_x,target_y\na,1,2,3\n", r"row 1: start: \('a', 1\); expected x"),
    ],
)
def test_a_fault_of_a_list_of_problems_names_file_and_row(rows, told, tmp_path):
    file = tmp_path / "problems.csv"
    file.write_text(rows)
    with pytest.raises(ValueError, match=f"^{file}: {told}"):
        bp.plan_all(bp.read_map(bp.example_map("gaps")), file)


@pytest.mark.parametrize("seed", [-1, 1.5, float("nan"), "1"])
def test_a_seed_is_a_whole_number(seed):
    with pytest.raises(ValueError, match=r"^seed: .*expected a whole number"):
        bp.plan(PROBLEM, seed=seed)


def test_an_answer_is_json_and_a_picture_in_a_notebook(tmp_path):
    answer = bp.plan(PROBLEM)
    answer.save(tmp_path / "path.json")
    values = json.loads((tmp_path / "path.json").read_text())
    assert values["path"]["points"][0] == [0.5, 0.5]
    assert values["feasible"] is True
    assert values["collision"] is None
    for shown in (answer, bp.check(PROBLEM, answer.path), PROBLEM, PROBLEM.workspace):
        html = shown._repr_html_()
        assert html.startswith("<img")
        assert len(html) < 60_000
    assert "% above the shortest path" in answer._repr_html_()


def test_methods_are_compared_on_one_map_with_one_legend():
    room = bp.Grid(np.arange(9).reshape(3, 3) == 4, 1.0, "m")
    problem = bp.Problem("around", room, (0.5, 1.5), (2.5, 1.5))
    compared = bp.compare(problem, {"ours": None, "straight": ("straight_line", {})})
    (legend,) = compared.plot().figure.legends
    names = sorted(text.get_text() for text in legend.get_texts())
    assert names == [
        "exact shortest path",
        "first collision",
        "occupied cell",
        "ours",
        "start",
        "straight (no free path)",
        "target",
    ]
