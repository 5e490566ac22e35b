"""Maps of ROS that are turned: the same paths as on the map as it was, turned with it."""

import math

import numpy as np
import pytest
import shapely
from PIL import Image
from shapely import affinity

import bezierplan as bp
from bezierplan.__main__ import main

ORIGIN = (-3.0, 2.0)
CELL = 0.25
YAWS = (0.3, math.pi / 2, -2.0, 3.0)


def room(folder, yaw, origin=ORIGIN, pixels=None):
    cells = np.zeros((24, 40), dtype=bool)
    cells[0:14, 12:15] = True
    cells[8:24, 25:28] = True
    if pixels is not None:
        cells = pixels
    Image.fromarray(np.where(cells[::-1], 0, 254).astype(np.uint8)).save(folder / "room.pgm")
    (folder / "room.yaml").write_text(
        f"image: room.pgm\nresolution: {CELL}\norigin: [{origin[0]}, {origin[1]}, {yaw}]\n"
    )
    return folder / "room.yaml"


def turned(points, yaw, origin=ORIGIN):
    """Points (n, 2) of the map as it was, where they are on the map that is turned."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (np.array(points) - origin) @ np.array([[cos, sin], [-sin, cos]]) + origin


def problem(folder, yaw, origin=ORIGIN):
    ends = np.array([(1.0, 1.0), (9.0, 5.0)]) + origin
    start, target = turned(ends, yaw, origin).tolist()
    return bp.Problem("room", bp.read_map(room(folder, yaw, origin)), tuple(start), tuple(target))


@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("radius", [0.0, 0.4])
def test_lengths_do_not_depend_on_the_yaw_and_clearance_is_kept(tmp_path, yaw, radius):
    straight = bp.plan(problem(tmp_path, 0.0), robot_radius=radius, turning_radius=0.5)
    answer = bp.plan(problem(tmp_path, yaw), robot_radius=radius, turning_radius=0.5)
    assert answer.feasible
    assert answer.shortest == pytest.approx(straight.shortest, rel=1e-8)
    assert answer.length == pytest.approx(straight.length, rel=1e-6)
    along, before = answer.sample(200), straight.sample(200)
    there = turned(np.column_stack([before.x, before.y]), yaw)
    assert np.column_stack([along.x, along.y]) == pytest.approx(there, abs=1e-4)
    x, y = ORIGIN
    walls = [
        affinity.rotate(
            shapely.box(x + left, y + low, x + right, y + high), yaw, ORIGIN, use_radians=True
        )
        for left, right, low, high in ((3, 3.75, 0, 3.5), (6.25, 7, 2, 6))
    ]
    line = shapely.LineString(np.column_stack([along.x, along.y]))
    assert min(line.distance(wall) for wall in walls) >= radius - 1e-3  # chords of 200 points


def test_headings_are_those_of_the_world(tmp_path):
    yaw = 0.7
    given = {"turning_radius": 0.5, "target_heading": None}
    straight = bp.plan(problem(tmp_path, 0.0), start_heading=1.0, **given)
    answer = bp.plan(problem(tmp_path, yaw), start_heading=1.0 + yaw, **given)
    assert answer.sample(10).heading[0] == pytest.approx(1.0 + yaw, abs=1e-9)
    assert answer.shortest == pytest.approx(straight.shortest, rel=1e-8)
    assert answer.feasible


def test_outside_of_the_turned_border_nothing_is_free(tmp_path):
    home = bp.read_map(room(tmp_path, 0.3))
    x, y = home.bounds[0] + 1e-3, home.bounds[2] + 1e-3
    with pytest.raises(ValueError, match="in an obstacle"):
        bp.shortest_path(bp.Problem("room", home, (x, y), ORIGIN))


def test_a_turned_map_far_from_the_origin(tmp_path):
    far = (391000.0, 5820000.0)
    near = bp.shortest_path(problem(tmp_path, 0.3)).length
    assert bp.shortest_path(problem(tmp_path, 0.3, far)).length == pytest.approx(near, rel=1e-7)


def test_a_turned_map_at_the_command_line(tmp_path, capsys):
    (start, target) = problem(tmp_path, 0.3)[2:]
    out = tmp_path / "path.csv"
    words = [f"--{end}={x},{y}" for end, (x, y) in {"start": start, "target": target}.items()]
    main(["plan", str(tmp_path / "room.yaml"), *words, "--out", str(out)])
    assert "feasible        yes" in capsys.readouterr().out
    table = np.genfromtxt(out, delimiter=",", names=True)
    assert (table["x"][0], table["y"][0]) == pytest.approx(start)
    assert (table["x"][-1], table["y"][-1]) == pytest.approx(target)


def test_cells_with_too_many_corners_are_refused_in_one_line(tmp_path):
    noise = np.random.default_rng(0).random((60, 60)) < 0.3
    with pytest.raises(ValueError, match=r"room\.yaml: origin: yaw 0\.3: .*1,000 corners"):
        bp.read_map(room(tmp_path, 0.3, pixels=noise))
