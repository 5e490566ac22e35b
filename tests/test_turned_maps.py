"""Maps of ROS that are turned: the same paths as on the map as it was, turned with it, and all that
is said is said in the world.
"""

import json
import math
import time

import numpy as np
import pytest
import shapely
import yaml as yaml_files
from PIL import Image
from shapely import affinity

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.workspaces import files
from bezierplan.workspaces.frames import WORLD, frame_of, inward_map, outward_map

ORIGIN = (-3.0, 2.0)
CELL = 0.25
YAWS = (0.3, math.pi / 2, -2.0, 3.0)
# Places that no path ties at, on the map before it is turned, less its origin.
ENDS = ((1.03, 1.07), (9.01, 5.02))
FOOTPRINT = [(0.5, 0.3), (-0.5, 0.3), (-0.5, -0.3), (0.5, -0.3)]


def two_walls():
    cells = np.zeros((24, 40), dtype=bool)
    cells[0:14, 12:15] = True
    cells[8:24, 25:28] = True
    return cells


def ros_map(folder, yaw, origin=ORIGIN, cells=None, grey=0):
    """The YAML file of a map whose occupied cells have a grey value."""
    cells = two_walls() if cells is None else cells
    Image.fromarray(np.where(cells[::-1], grey, 254).astype(np.uint8)).save(folder / "room.pgm")
    (folder / "room.yaml").write_text(
        f"image: room.pgm\nresolution: {CELL}\norigin: [{origin[0]}, {origin[1]}, {yaw}]\n"
    )
    return folder / "room.yaml"


def turned(points, yaw, origin=ORIGIN):
    """Points (..., 2) of the map as it was, less its origin, where they are in the world."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array(points) @ np.array([[cos, sin], [-sin, cos]]) + origin


def problem(folder, yaw, origin=ORIGIN, cells=None, ends=ENDS):
    start, target = map(tuple, turned(ends, yaw, origin).tolist())
    home = bp.read_map(ros_map(folder, yaw, origin, cells))
    return bp.Problem("room", home, start, target)


def block(yaw, origin=(0.0, 0.0), unit="m"):
    """A room of 10 x 10 with a wall from 4 to 5 that is 6 high."""
    cells = np.zeros((10, 10), dtype=bool)
    cells[:6, 4] = True
    return bp.Grid(cells, 1.0, unit, origin, yaw=yaw)


def test_the_shortest_path_over_a_wall_at_30_degrees():
    yaw, origin = math.pi / 6, (100.0, -20.0)
    places = turned([(2.0, 3.0), (4.0, 6.0), (5.0, 6.0), (8.0, 3.0)], yaw, origin)
    home = bp.Problem("block", block(yaw, origin), tuple(places[0]), tuple(places[-1]))
    found = bp.shortest_path(home)
    assert found.length == pytest.approx(math.hypot(2, 3) + 1 + math.hypot(3, 3), rel=1e-14)
    assert found.points == pytest.approx(places, abs=1e-12)


def test_a_straight_way_at_30_degrees_has_that_heading(tmp_path):
    yaw = math.pi / 6
    start, target = map(tuple, turned([(1.0, 8.0), (9.0, 8.0)], yaw, (0.0, 0.0)).tolist())
    answer = bp.plan(
        bp.Problem("block", block(yaw), start, target),
        turning_radius=1.0,
        start_heading=yaw,
        target_heading=yaw,
    )
    assert answer.length == pytest.approx(8.0, rel=1e-9)
    assert answer.settings["start_heading"] == yaw
    assert answer.sample(9).heading == pytest.approx(np.full(9, yaw), abs=1e-6)


def test_where_a_path_collides_is_told_in_the_world():
    yaw = math.pi / 6
    start, target, hit = map(
        tuple, turned([(2.0, 3.0), (8.0, 3.0), (4.0, 3.0)], yaw, (0.0, 0.0)).tolist()
    )
    home = bp.Problem("block", block(yaw), start, target)
    judged = bp.check(home, bp.Path("polyline", np.array([start, target])))
    assert not judged.feasible
    assert judged.collision == pytest.approx(hit, abs=1e-8)
    assert (judged.length, judged.depth) == pytest.approx((6.0, 0.5))
    assert judged.path.points.tolist() == [list(start), list(target)]


def test_tangents_of_a_path_are_turned_and_not_moved():
    pairs = np.array([(2.0, 8.0), (3.0, 1.0), (8.0, 8.0), (3.0, -1.0)])
    found = []
    for yaw, origin in ((0.0, (0.0, 0.0)), (0.7, (40.0, -9.0))):
        points = turned(pairs, yaw, origin)
        points[1::2] -= origin
        home = bp.Problem("block", block(yaw, origin), tuple(points[0]), tuple(points[2]))
        found.append(bp.check(home, bp.Path("ferguson", points)))
    straight, judged = found
    assert judged.length == pytest.approx(straight.length, rel=1e-12)
    assert judged.clearance == pytest.approx(straight.clearance, rel=1e-9)


def test_the_border_is_turned_too():
    yaw, (start, target) = 0.4, turned([(0.1, 0.1), (0.1, 9.9)], 0.4, (0.0, 0.0))
    home = bp.Problem("block", block(yaw), tuple(start), tuple(target))
    along = bp.check(home, bp.Path("polyline", np.array([start, target])))
    assert along.feasible
    assert along.clearance == pytest.approx(0.1, abs=1e-12)
    beyond = np.array([start, turned((-0.5, 5.0), yaw, (0.0, 0.0)), target])
    assert not bp.check(home, bp.Path("polyline", beyond)).feasible


@pytest.mark.parametrize("corner", [(0, 0), (10, 0), (10, 6), (0, 6)])
def test_a_path_may_begin_in_a_corner_of_the_border(tmp_path, corner):
    for yaw in YAWS:
        home = problem(tmp_path, yaw, ends=(corner, ENDS[1]))
        assert math.isfinite(bp.shortest_path(home).length)


@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("radius", [0.0, 0.4])
def test_lengths_do_not_depend_on_the_yaw_and_clearance_is_kept(tmp_path, yaw, radius):
    straight = bp.plan(problem(tmp_path, 0.0), robot_radius=radius, turning_radius=0.5)
    answer = bp.plan(problem(tmp_path, yaw), robot_radius=radius, turning_radius=0.5)
    assert answer.feasible
    assert answer.shortest == pytest.approx(straight.shortest, rel=1e-12)
    assert answer.length == pytest.approx(straight.length, rel=1e-12)
    assert answer.clearance == pytest.approx(straight.clearance, abs=1e-12)
    there = turned(straight.path.points - ORIGIN, yaw)
    assert answer.path.points == pytest.approx(there, abs=1e-9)
    along = answer.sample(200)
    x, y = ORIGIN
    walls = [
        affinity.rotate(
            shapely.box(x + left, y + low, x + right, y + high), yaw, ORIGIN, use_radians=True
        )
        for left, right, low, high in ((3, 3.75, 0, 3.5), (6.25, 7, 2, 6))
    ]
    line = shapely.LineString(np.column_stack([along.x, along.y]))
    assert min(line.distance(wall) for wall in walls) >= radius - 1e-3  # chords of 200 points


@pytest.mark.parametrize("seed", range(6))
def test_random_cells_turned_by_any_angle(tmp_path, seed):
    random = np.random.default_rng(seed)
    yaw, origin = random.uniform(-math.pi, math.pi), tuple(random.uniform(-50, 50, 2).tolist())
    cells = random.random((30, 30)) < 0.2
    ends = random.uniform(0.0, 7.5, (2, 2))
    for x, y in ends:
        cells[int(y / CELL), int(x / CELL)] = False
    straight, answer = (
        bp.shortest_path(problem(tmp_path, angle, origin, cells, ends)) for angle in (0.0, yaw)
    )
    assert answer.length == pytest.approx(straight.length, rel=1e-12)
    if math.isfinite(straight.length):
        there = turned(straight.points - origin, yaw, origin)
        assert answer.points == pytest.approx(there, abs=1e-9)


def test_a_map_that_grew_when_it_was_read_is_the_same(tmp_path):
    home = problem(tmp_path, 0.3)
    grown = bp.read_map(tmp_path / "room.yaml", robot_radius=0.4)
    first, second = bp.plan(home, robot_radius=0.4), bp.plan(home._replace(workspace=grown))
    assert second.length == pytest.approx(first.length, rel=1e-12)
    assert second.robot_radius == 0.4
    assert (grown.yaw, grown.drawn.grown.original.yaw) == (0.3, 0.3)


def test_the_map_of_an_answer_can_be_judged_on_again(tmp_path):
    answer = bp.plan(problem(tmp_path, -1.0), robot_radius=0.4)
    again = bp.check(answer.problem, answer.path)
    assert type(answer.problem.workspace) is bp.Grid
    assert answer.problem.workspace.yaw == -1.0
    assert (again.length, again.clearance, again.shortest) == pytest.approx(
        (answer.length, answer.clearance, answer.shortest), rel=1e-9
    )


def test_a_footprint_way_points_in_the_shortest_order_and_continuous_curvature(tmp_path):
    places = [(8.52, 0.87), (5.11, 5.13), (2.23, 5.31)]
    for given in ({"footprint": FOOTPRINT}, {"via_order": "shortest"}, {"smooth": "continuous"}):
        found = []
        for yaw in (0.0, 1.1):
            way = [tuple(place) for place in turned(places, yaw).tolist()]
            via = {"via": way} if "via_order" in given else {}
            answer = bp.plan(problem(tmp_path, yaw), turning_radius=0.1, **via, **given)
            found.append((answer, [way.index(place) for place in answer.via]))
        (straight, order), (answer, other_order) = found
        assert order == other_order
        assert order == ([2, 1, 0] if "via_order" in given else [])
        assert answer.feasible
        assert answer.length == pytest.approx(straight.length, rel=1e-9)
        assert answer.curvature_bound == pytest.approx(straight.curvature_bound, rel=1e-4)


def test_headings_are_those_of_the_world(tmp_path):
    yaw = 0.7
    given = {"turning_radius": 0.5, "target_heading": None}
    answer = bp.plan(problem(tmp_path, yaw), start_heading=1.0 + yaw, **given)
    assert answer.sample(10).heading[0] == pytest.approx(1.0 + yaw, abs=1e-9)
    assert answer.feasible


def test_a_planner_of_cells_gets_the_map_as_it_was(tmp_path):
    settings = {"seed": 1, "population": 60, "generations": 40}
    straight, answer = (
        bp.plan(
            problem(tmp_path, yaw, ends=((1.0, 1.0), (9.0, 5.0))), "song2016/smooth", **settings
        )
        for yaw in (0.0, math.pi / 2)
    )
    there = turned(straight.path.points - ORIGIN, math.pi / 2)
    assert answer.path.points == pytest.approx(there, abs=1e-9)


def test_unknown_cells_of_a_turned_map(tmp_path):
    band = np.zeros((24, 40), dtype=bool)
    band[:, 20:22] = True
    start, target = map(tuple, turned(ENDS, 0.3).tolist())
    file = ros_map(tmp_path, 0.3, cells=band, grey=205)
    lengths = [
        bp.shortest_path(bp.Problem("band", bp.read_map(file, unknown=unknown), start, target))
        for unknown in ("occupied", "free")
    ]
    assert lengths[0].length == math.inf
    assert lengths[1].length == pytest.approx(math.dist(*ENDS), rel=1e-12)


def test_places_that_are_not_free_are_told_in_the_world(tmp_path):
    home = problem(tmp_path, math.pi / 2)  # x to 2 - y, y to -3 + x
    with pytest.raises(ValueError, match=r"start: \(-2\.0, 1\.5\): outside") as told:
        bp.shortest_path(home._replace(start=(-2.0, 1.5)))
    assert "whose corners are -3,2 -3,12 -9,12 -9,2" in str(told.value)
    with pytest.raises(ValueError, match=r"target: \(-4\.0, 5\.5\): in an obstacle"):
        bp.shortest_path(home._replace(target=(-4.0, 5.5)))
    with pytest.raises(ValueError, match=r"via: \(-4\.0, 5\.5\): in an obstacle"):
        bp.plan(home, via=[(-4.0, 5.5)])
    with pytest.raises(ValueError, match=r"start: \(-4\.0, 4\.75\): 0\.25 from an obstacle"):
        bp.plan(home._replace(start=(-4.0, 4.75)), robot_radius=0.4)


def test_outside_of_the_turned_border_nothing_is_free(tmp_path):
    home = bp.read_map(ros_map(tmp_path, 0.3))
    place = (ORIGIN[0] - 1e-3, ORIGIN[1] + 1e-3)
    with pytest.raises(ValueError, match="outside the workspace"):
        bp.shortest_path(bp.Problem("room", home, place, ORIGIN))


@pytest.mark.parametrize("radius", [0.0, 0.4])
def test_a_turned_map_far_from_the_origin(tmp_path, radius):
    far = (391000.25, 5820000.5)
    near = bp.plan(problem(tmp_path, 0.3), robot_radius=radius)
    answer = bp.plan(problem(tmp_path, 0.3, far), robot_radius=radius)
    assert answer.length == pytest.approx(near.length, rel=1e-8)
    assert answer.path.points - far == pytest.approx(near.path.points - ORIGIN, abs=1e-7)


def test_a_map_that_is_too_wide_is_refused_where_it_is_turned_too():
    wide = bp.Grid(np.zeros((1, 3), dtype=bool), 5e4, "m", yaw=0.1)
    with pytest.raises(ValueError, match="the border: 150000 x 50000 units; expected at most"):
        bp.shortest_path(bp.Problem("wide", wide, (1.0, 1.0), (2.0, 2.0)))


@pytest.mark.parametrize("yaw", [math.nan, math.inf])
def test_a_yaw_that_is_no_number(yaw):
    with pytest.raises(ValueError, match=f"yaw: {yaw}; expected a finite number of radians"):
        block(yaw)


def test_a_turned_map_as_text():
    home = block(0.3, (1.0, 2.0))
    again = files.from_json(files.to_json(home))
    assert (again.yaw, again.origin) == (0.3, (1.0, 2.0))
    assert "yaw" not in files.to_json(block(0.0))


def test_a_map_in_its_frame_and_back(tmp_path):
    home = bp.read_map(ros_map(tmp_path, 0.3), robot_radius=0.4)
    frame = frame_of(home)
    near = inward_map(home, frame)
    assert (near.yaw, near.origin, near.drawn.grown.original.yaw) == (0.0, (0.0, 0.0), 0.0)
    assert frame_of(near) == WORLD
    back = outward_map(near, frame)
    assert (back.yaw, back.origin) == (home.yaw, home.origin)
    assert back.drawn.bounds == pytest.approx(home.drawn.bounds, abs=1e-12)


def words_of(home, folder):
    ends = {"start": home.start, "target": home.target}
    return [
        "plan",
        str(folder / "room.yaml"),
        *(f"--{end}={x},{y}" for end, (x, y) in ends.items()),
    ]


def test_a_turned_map_at_the_command_line(tmp_path, capsys):
    home = problem(tmp_path, 0.3)
    for name in ("path.csv", "path.geojson", "path.yaml", "path.svg", "path.png"):
        main([*words_of(home, tmp_path), "--robot-radius=0.4", "--out", str(tmp_path / name)])
    assert "feasible        yes" in capsys.readouterr().out
    table = np.genfromtxt(tmp_path / "path.csv", delimiter=",", names=True)
    points = np.column_stack([table["x"], table["y"]])
    assert points[[0, -1]] == pytest.approx(np.array([home.start, home.target]))
    along = np.diff(points, axis=0)
    middle = 0.5 * (table["heading"][1:] + table["heading"][:-1])
    assert np.arctan2(along[:, 1], along[:, 0]) == pytest.approx(middle, abs=5e-3)
    line = json.loads((tmp_path / "path.geojson").read_text())["geometry"]["coordinates"]
    assert np.array(line) == pytest.approx(points, abs=1e-7)
    pose = yaml_files.safe_load((tmp_path / "path.yaml").read_text())["poses"][0]["pose"]
    assert (pose["position"]["x"], pose["position"]["y"]) == pytest.approx(home.start)
    facing = 2 * math.atan2(pose["orientation"]["z"], pose["orientation"]["w"])
    assert facing == pytest.approx(table["heading"][0], abs=1e-8)


def test_words_about_places_at_the_command_line_are_of_the_world(tmp_path, capsys):
    home = problem(tmp_path, math.pi / 2)
    outside = [*words_of(home, tmp_path)[:2], "--start=-2,1.5", "--target=-4,3"]
    with pytest.raises(SystemExit):
        main(outside)
    told = capsys.readouterr().err
    assert "--start: (-2.0, 1.5): outside the workspace" in told
    assert "-3,2 -3,12 -9,12 -9,2" in told
    own = tmp_path / "line.py"
    own.write_text(
        "import numpy as np\nfrom bezierplan.planners import Path, Plan\n\n\n"
        "def plan(problem, rng):\n"
        "    ends = np.array([problem.start, problem.target])\n"
        "    return Plan(Path('polyline', ends), 1.0, True, 1, np.array([1.0]), 'done', {})\n"
    )
    across = [*words_of(home, tmp_path)[:2], "--start=-4,3", "--target=-4,7"]
    with pytest.raises(SystemExit):
        main([*across, "--planner", str(own)])
    assert "no: enters an obstacle at -4,5, at most" in capsys.readouterr().out


def test_a_picture_shows_the_map_turned(tmp_path):
    import matplotlib.pyplot as plt

    yaw = 1.0
    for factor in (1, 8):  # squares, and pixels of an image
        cells = np.kron(two_walls(), np.ones((factor, factor), dtype=bool))
        home = bp.Grid(cells, CELL / factor, "m", ORIGIN, yaw=yaw)
        ends = turned(ENDS, yaw)
        figure, axes = plt.subplots(figsize=(8, 8), dpi=100)
        bp.plan(bp.Problem("room", home, tuple(ends[0]), tuple(ends[1]))).plot(axes)
        figure.canvas.draw()
        drawn = np.asarray(figure.canvas.buffer_rgba())[::-1, :, :3].astype(int)
        wall, free, outside = (
            drawn[tuple(axes.transData.transform(turned(place, yaw)).astype(int)[::-1])].sum()
            for place in ((3.3, 1.1), (5.1, 1.1), (-0.4, 3.0))
        )
        corners = turned([(0, 0), (10, 0), (10, 6), (0, 6)], yaw)
        plt.close(figure)
        assert wall < 600 < free
        assert free == outside == 3 * 255
        limits = np.array([axes.get_xlim(), axes.get_ylim()]).T
        assert limits == pytest.approx(np.array([corners.min(axis=0), corners.max(axis=0)]))


def test_a_million_cells_take_seconds(tmp_path):
    rooms = np.zeros((1000, 1000), dtype=bool)
    rooms[::25], rooms[:, ::25] = True, True
    rooms[12::25], rooms[13::25], rooms[:, 12::25], rooms[:, 13::25] = (False,) * 4  # doors
    rooms[:, 0] = rooms[0] = False
    ends = np.array([(3.0, 4.0), (997.5, 991.0)]) * CELL
    before = time.process_time()
    answer = bp.plan(problem(tmp_path, 0.3, cells=rooms, ends=ends), turning_radius=0.3)
    assert time.process_time() - before < 20  # and compiling
    straight = bp.shortest_path(problem(tmp_path, 0.0, cells=rooms, ends=ends))
    assert answer.feasible
    assert answer.shortest == pytest.approx(straight.length, rel=1e-12)
