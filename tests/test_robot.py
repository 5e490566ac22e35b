"""A robot with a width and a turning radius: lengths in closed form, clearance by shapely, way
points, and what is refused in one line.
"""

import math

import numpy as np
import pytest
import shapely
from commands import refused
from PIL import Image
from test_plan_command import planned
from test_workspace_files import geojson

import bezierplan as bp
from bezierplan.workspaces import files, robot

ARCS = 2 / 3 * robot.ARC_EXCESS
"""By what share tangents at a corner are longer than its arc, at most."""


def box(left, right, bottom, top):
    return (np.array([(left, bottom), (right, bottom), (right, top), (left, top)], dtype=float),)


def room_with(*obstacles):
    return bp.Polygons((0.0, 10.0, 0.0, 10.0), obstacles, "m")


WALL = ("--start", "0.3,1", "--target", "1.7,1")


def wall(half_length, half_width, half_height, radius):
    """Length of the shortest path of a disc around one end of a wall, between points in its middle,
    at both sides; and of its arcs.
    """
    a, h = half_length - half_width, half_height
    turn = math.asin(radius / math.hypot(a, h)) + math.atan2(h, a)
    return 2 * math.sqrt(
        a**2 + h**2 - radius**2
    ) + 2 * radius * turn + 2 * half_width, 2 * radius * turn


def one_wall(kind, folder):
    """A wall from 0.95 to 1.05 m and from 0.5 to 1.5 m in a room of 2 m, as a map of a kind."""
    cells = np.zeros((40, 40), dtype=bool)
    cells[10:30, 19:21] = True
    if kind == "ros":
        Image.fromarray(np.where(cells, 0, 254).astype(np.uint8)).save(folder / "wall.pgm")
        (folder / "wall.yaml").write_text("image: wall.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
        return folder / "wall.yaml", ()
    rows = ["".join("#" if cell else "." for cell in row) for row in cells]
    if kind == "text":
        (folder / "wall.txt").write_text("\n".join(rows) + "\n")
        return folder / "wall.txt", ("--cell", "0.05", "--unit", "m")
    ring = [[0.95, 0.5], [1.05, 0.5], [1.05, 1.5], [0.95, 1.5], [0.95, 0.5]]
    frame = [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]
    (folder / "wall.geojson").write_text(geojson([ring], border=frame))
    return folder / "wall.geojson", ()


def least_distance(file, obstacles, bounds):
    """Distance of a written path from obstacles and border, by shapely."""
    points = np.loadtxt(file, delimiter=",", skiprows=1)[:, 1:3]
    line = shapely.LineString(points)
    left, right, bottom, top = bounds
    return min(
        line.distance(shapely.union_all(obstacles)),
        line.distance(shapely.box(left, bottom, right, top).exterior),
    )


@pytest.mark.parametrize("radius", [0.02, 0.05, 0.0500001, 0.12, 0.2, 0.22])
@pytest.mark.parametrize("kind", ["ros", "text", "geojson"])
def test_around_a_wall_the_length_is_that_of_tangents_and_arcs(capsys, tmp_path, kind, radius):
    file, options = one_wall(kind, tmp_path)
    out = tmp_path / "path.csv"
    words = [file, *WALL, "--robot-radius", radius, *options, "--step", 0.001, "--out", out]
    found = planned(capsys, *words)
    assert found["robot radius"] == f"{radius:g} m"
    assert found["feasible"] == "yes"
    length, arcs = wall(0.7, 0.05, 0.5, radius)
    assert -1e-5 < float(found["shortest path"].removesuffix(" m")) - length < arcs * ARCS + 1e-5
    distance = least_distance(out, [shapely.box(0.95, 0.5, 1.05, 1.5)], (0, 2, 0, 2))
    assert distance >= radius - robot.TOLERANCE
    assert float(found["clearance"].removesuffix(" m")) == pytest.approx(radius, rel=2e-4)


def test_around_circles_the_length_is_exact():
    circles = bp.Circles(
        (-5.0, 5.0, -5.0, 5.0), centres=np.array([[0.0, 0.0]]), radii=np.array([1.0]), unit="m"
    )
    problem = bp.Problem("disc", circles, (-2.0, 0.0), (2.0, 0.0))
    answer = bp.plan(problem, robot_radius=0.5, turning_radius=0.1)
    assert answer.shortest == pytest.approx(
        2 * math.sqrt(4 - 1.5**2) + 3 * math.asin(0.75), rel=1e-12
    )
    assert answer.clearance == pytest.approx(0.5, abs=robot.TOLERANCE)
    assert answer.turning_radius == 1.5


def test_around_a_corner_the_length_is_that_of_tangents_and_an_arc():
    corner = room_with(box(0, 5, 5, 10))
    answer = bp.plan(
        bp.Problem("corner", corner, (1.0, 4.0), (6.0, 9.0)), robot_radius=1.0, turning_radius=1.0
    )
    assert 8 + math.pi / 2 <= answer.shortest + 1e-8 <= 8 + math.pi / 2 * (1 + ARCS) + 2e-8
    assert answer.length == pytest.approx(8 + math.pi / 2, abs=1e-3)
    assert answer.turning_radius == pytest.approx(1.0, rel=2e-4)


@pytest.mark.parametrize("as_cells", [False, True])
@pytest.mark.parametrize("origin", [0.0, 0.1])
def test_a_slot_exactly_as_wide_as_the_robot_is_a_way_and_a_narrower_one_is_not(as_cells, origin):
    if as_cells:
        cells = np.zeros((40, 80), dtype=bool)
        cells[:17, 38:42] = cells[23:, 38:42] = True
        room = bp.Grid(cells, 0.05, "m", (origin, origin))
    else:
        walls = (
            box(origin + 1.9, origin + 2.1, origin, origin + 0.85),
            box(origin + 1.9, origin + 2.1, origin + 1.15, origin + 2),
        )
        room = bp.Polygons((origin, origin + 4.0, origin, origin + 2.0), walls, "m")
    problem = bp.Problem("slot", room, (origin + 0.5, origin + 1.0), (origin + 3.5, origin + 1.0))
    answer = bp.plan(problem, robot_radius=0.15)
    assert answer.length == pytest.approx(3.0, abs=1e-8)
    assert answer.feasible
    assert answer.clearance == pytest.approx(0.15, abs=robot.TOLERANCE)
    assert bp.plan(problem, robot_radius=0.15 + 1e-6).path is None


@pytest.mark.parametrize("seed", range(12))
def test_on_random_maps_no_written_path_comes_closer_than_the_radius(tmp_path, seed):
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.05, 0.45)
    if seed % 2:
        cells = rng.random((20, 20)) < 0.08
        cells[:3, :3] = cells[-3:, -3:] = False
        room = bp.Grid(cells, 0.5, "m", (-3.0, 4.0))
        row, column = np.nonzero(cells)
        obstacles = shapely.box(
            column * 0.5 - 3, row * 0.5 + 4, column * 0.5 - 2.5, row * 0.5 + 4.5
        )
        ends = (-2.45, 4.55), (6.45, 13.45)
    else:
        centres, reach = rng.uniform(1.5, 8.5, (10, 2)), rng.uniform(0.1, 0.9, (10, 3))
        rings = [
            centre + size[:, None] * [[1, 0], [-0.6, 0.9], [-0.5, -0.8]]
            for centre, size in zip(centres, reach, strict=True)
        ]
        room = room_with(*((ring,) for ring in rings))
        obstacles = [shapely.Polygon(ring) for ring in rings]
        ends = (0.6, 0.6), (9.4, 9.4)
    radius = min(
        radius, 0.99 * shapely.distance(shapely.points(ends), shapely.union_all(obstacles)).min()
    )
    answer = bp.plan(
        bp.Problem("random", room, *ends),
        robot_radius=radius,
        turning_radius=rng.choice([0.1, 1.0]),
    )
    if answer.path is None:
        return
    assert answer.feasible
    answer.save(tmp_path / "path.csv", step=0.001)
    distance = least_distance(tmp_path / "path.csv", obstacles, room.bounds)
    assert distance >= radius - 2e-8
    assert distance == pytest.approx(answer.clearance, abs=1e-4)


def test_a_grown_map_is_the_same_after_it_was_stored():
    grown = robot.grow(room_with(box(0, 5, 5, 10)), 0.5)
    text = files.write_json(grown)
    again = files.read_json(text)
    assert files.write_json(again) == text
    assert again.growth.radius == 0.5
    assert files.write_json(again.growth.original) == files.write_json(grown.growth.original)


def test_cells_with_many_corners_grow_by_whole_cells():
    cells = np.zeros((70, 70), dtype=bool)
    cells[4:-4:3, 4:-4:3] = True
    grown = robot.grow(bp.Grid(cells, 1.0, "m"), 0.5)
    assert grown.shapes is None
    assert grown.growth.radius == 0.5
    answer = bp.plan(
        bp.Problem("dots", bp.Grid(cells, 1.0, "m"), (2.0, 2.0), (68.0, 68.0)), robot_radius=0.5
    )
    assert answer.feasible
    assert answer.clearance >= 0.5


def test_a_planner_of_cells_keeps_the_radius_too():
    block = np.zeros((16, 16), dtype=bool)
    block[4:12, 7:9] = True
    problem = bp.Problem("block", bp.Grid(block, 1.0, "m"), (2.5, 8.0), (13.5, 8.0))
    answer = bp.plan(
        problem, "song2016/smooth", seed=1, robot_radius=0.7, population=60, generations=60
    )
    assert answer.robot_radius == 0.7
    assert not answer.feasible or answer.clearance >= 0.7 - robot.TOLERANCE
    assert type(answer.problem.workspace) is bp.Grid


def two_walls():
    return bp.Problem(
        "walls",
        room_with(box(0, 7, 3, 4), box(3, 10, 6, 7)),
        (1.0, 1.0),
        (9.0, 9.0),
    )


def test_a_turning_radius_is_kept_where_there_is_room_and_what_is_kept_is_told():
    kept = bp.plan(two_walls(), turning_radius=1.5)
    assert kept.feasible
    assert kept.turning_radius == 1.5
    assert kept.curvature == pytest.approx(1 / 1.5, rel=1e-3)
    tight = bp.plan(two_walls(), turning_radius=3.0)
    assert tight.feasible
    assert 0 < tight.turning_radius < 3


def test_way_points_are_passed_in_their_order():
    via = [(9.0, 5.0), (1.0, 5.0)]
    answer = bp.plan(two_walls(), via=via, turning_radius=0.3)
    assert answer.feasible
    along = answer.sample(step=0.01)
    line = shapely.LineString(np.column_stack([along.x, along.y]))
    places = [line.project(shapely.Point(point)) for point in via]
    assert all(line.distance(shapely.Point(point)) < 1e-2 for point in via)
    assert 0 < places[0] < places[1] < line.length
    legs = zip([(1.0, 1.0), *via], [*via, (9.0, 9.0)], strict=True)
    parts = [
        bp.shortest_path(two_walls()._replace(start=start, target=target)).length
        for start, target in legs
    ]
    assert answer.shortest == pytest.approx(sum(parts), rel=1e-12)
    assert answer.turning_radius == 0.3
    assert answer.corners  # way points
    assert bp.plan(two_walls(), "shortest_path", via=via).length == pytest.approx(
        sum(parts), rel=1e-9
    )


REFUSED = {
    "start": (
        (*WALL, "--robot-radius", "0.4"),
        "--start: (0.3, 1.0): 0.3 from an obstacle or the border; expected at least the robot's",
    ),
    "nothing": (
        (*WALL, "--robot-radius", "1"),
        "--robot-radius: 1: no place of the map is that far from its obstacles and its border",
    ),
    "via planner": (
        (*WALL, "--method", "prm", "--via", "1,1.8"),
        "--via: only for rounded_shortest_path and shortest_path",
    ),
    "via in an obstacle": (
        (*WALL, "--via", "1,1"),
        "--via: (1.0, 1.0): in an obstacle; expected a free place",
    ),
    "via outside": ((*WALL, "--via", "-1,1"), "--via: (-1.0, 1.0): outside the workspace"),
    "via twice": (
        (*WALL, "--via", "1,1.8", "--via", "1,1.8"),
        "--via: (1.0, 1.8): the same place as the one before",
    ),
    "via within the radius": (
        (*WALL, "--robot-radius", "0.2", "--via", "1,1.6"),
        "--via: (1.0, 1.6): 0.1 from an obstacle or the border",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_told_in_one_line(capsys, tmp_path, name):
    words, told = REFUSED[name]
    assert told in refused(capsys, "plan", one_wall("geojson", tmp_path)[0], *words)
