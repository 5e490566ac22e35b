"""The footprint of a robot along its path: clearance in closed form, judged beside dense samples by
shapely, and what is refused.
"""

import math

import numpy as np
import pytest
import shapely
from shapely import affinity

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.geometry import curves
from bezierplan.geometry.checker.footprint import CLEARANCE_SHARE, check_footprint
from bezierplan.geometry.region import region
from bezierplan.planners.parts import dubins
from bezierplan.running import footprints
from bezierplan.workspaces.footprint import footprint

CAR = [(0.9, 0.25), (-0.1, 0.25), (-0.1, -0.25), (0.9, -0.25)]
"""The point that follows the path is that of the rear axle."""


def box(left, right, bottom, top):
    return (np.array([(left, bottom), (right, bottom), (right, top), (left, top)], dtype=float),)


def judged(workspace, path, corners):
    ends = [tuple(map(float, path.points[k])) for k in curves.ends(path.curve)]
    return bp.check(bp.Problem("", workspace, *ends), path, footprint=corners)


def line(*points):
    return bp.Path("polyline", np.array(points, dtype=float))


def arc(centre, radius, begin, end):
    """An arc to the left about a centre as cubic pieces."""
    start = np.array(
        [
            centre[0] + radius * math.cos(begin),
            centre[1] + radius * math.sin(begin),
            begin + math.pi / 2,
        ]
    )
    target = np.array(
        [centre[0] + radius * math.cos(end), centre[1] + radius * math.sin(end), end + math.pi / 2]
    )
    word = np.array(
        [1.0, radius * (end - begin), 0, 0, 0, 0, begin + math.pi / 2, radius * (end - begin)]
    )
    pieces = np.empty((dubins.MOST_PIECES, 4, 2))
    count = dubins.pieces_of(start, target, word, radius, pieces)
    return bp.Path(
        "cubic_chain", np.concatenate([pieces[0, :1], pieces[:count, 1:].reshape(-1, 2)])
    )


def test_sizes_of_a_footprint():
    car = footprint([*CAR[::-1], (0.9, 0.0), CAR[-1]])
    assert len(car.corners) == 4
    assert car.inscribed == pytest.approx(0.1, abs=1e-15)
    assert car.circumscribed == pytest.approx(math.hypot(0.9, 0.25), abs=1e-15)
    assert car.middle == pytest.approx([0.4, 0.0], abs=1e-15)
    assert car.thickness == pytest.approx(0.25, abs=1e-15)
    assert footprint([(1, 0), (2, 0), (2, 1)]).inscribed == 0


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0])
def test_along_a_wall_the_clearance_is_the_distance_less_half_the_width(angle):
    room = bp.Circles(
        (-10.0, 10.0, -10.0, 10.0),
        np.array([(20 * math.sin(angle), -20 * math.cos(angle))]),
        np.array([19.0]),
        "m",
    )
    wall = -1.0  # the disc is a wall but for its sagitta
    start, target = (np.array([math.cos(angle), math.sin(angle)]) * s for s in (-0.4, 1e-6 - 0.4))
    found = judged(room, line(start, target), CAR)
    assert found.feasible
    assert found.clearance == pytest.approx(-wall - 0.25, abs=2e-6)


@pytest.mark.parametrize(("width", "free"), [(0.5 - 1e-4, True), (0.5, True), (0.5 + 1e-4, False)])
def test_a_slot_exactly_as_wide_as_the_robot_is_wide_enough(width, free):
    slot = bp.Polygons((0.0, 6.0, 0.0, 2.0), (box(2, 4, 0, 0.75), box(2, 4, 1.25, 2)), "m")
    corners = [(0.3, width / 2), (-0.3, width / 2), (-0.3, -width / 2), (0.3, -width / 2)]
    found = judged(slot, line((0.5, 1), (5.5, 1)), corners)
    assert found.feasible == free
    if free:
        assert found.clearance == pytest.approx((0.5 - width) / 2, abs=1e-6)
    else:
        assert found.collision[0] == pytest.approx(1.7, abs=1e-6)
        assert found.depth == 0


def test_the_same_slot_of_cells_and_far_from_the_origin():
    cells = np.zeros((8, 24), dtype=bool)
    cells[:3, 8:16] = cells[5:, 8:16] = True
    for origin in ((0.0, 0.0), (391_000.0, 5_820_000.0)):
        slot = bp.Grid(cells, 0.25, "m", origin)
        path = line(*(np.array([(0.5, 1), (5.5, 1)]) + origin))
        corners = [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)]
        assert judged(slot, path, corners).clearance == pytest.approx(0.05, abs=1e-6)
        wide = judged(slot, path, [(x, 1.3 * y) for x, y in corners])
        assert wide.collision == pytest.approx((1.7 + origin[0], 1 + origin[1]), abs=1e-6)


@pytest.mark.parametrize("radius", [0.8, 2.0])
def test_on_an_arc_the_side_is_nearest_to_the_centre_and_a_corner_to_what_is_outside(radius):
    path = arc((0, 0), radius, 0.2, 1.9)
    bounds = (-10.0, 10.0, -10.0, 10.0)
    disc = bp.Circles(bounds, np.array([(0.0, 0.0)]), np.array([0.3]), "m")
    within = judged(disc, path, CAR)
    assert within.clearance == pytest.approx(radius - 0.25 - 0.3, abs=1e-5)
    swept = math.hypot(radius + 0.25, 0.9)
    post = bp.Circles(bounds, np.array([(0.0, swept + 0.2)]), np.array([0.1]), "m")
    assert judged(post, path, CAR).clearance == pytest.approx(0.1, abs=1e-5)
    near = bp.Circles(bounds, np.array([(0.0, swept + 0.0999)]), np.array([0.1]), "m")
    hit = judged(near, path, CAR)
    assert not hit.feasible
    assert hit.clearance == 0


def test_at_a_corner_of_the_path_the_robot_turns_on_the_spot():
    path = line((2, 5), (5, 5), (5, 8))
    # On the spot the front corners sweep a circle about the corner; nothing else comes here.
    reach, angle = math.hypot(0.9, 0.25), math.pi / 4
    place = np.array([5, 5]) + (reach + 0.1) * np.array([math.cos(angle), math.sin(angle)])
    post = bp.Circles((0.0, 10.0, 0.0, 10.0), place[None], np.array([0.05]), "m")
    assert judged(post, path, CAR).clearance == pytest.approx(0.05, abs=1e-5)
    wide = bp.Circles((0.0, 10.0, 0.0, 10.0), place[None], np.array([0.11]), "m")
    hit = judged(wide, path, CAR)
    assert hit.collision == pytest.approx((5, 5), abs=1e-9)


def test_an_obstacle_within_the_footprint_and_one_around_it_are_seen():
    small = bp.Polygons((0.0, 10.0, 0.0, 10.0), (box(4.4, 4.5, 5.05, 5.1),), "m")
    wide = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    assert not judged(small, line((4, 5), (4.1, 5)), wide).feasible
    ahead = bp.Polygons((0.0, 10.0, 0.0, 10.0), (box(5, 9, 0, 10),), "m")
    assert not judged(ahead, line((1, 5), (2, 5)), [(6, 1), (5, 1), (5, -1), (6, -1)]).feasible
    assert judged(
        ahead, line((1, 5), (2, 5)), [(2.9, 1), (2, 1), (2, -1), (2.9, -1)]
    ).clearance == pytest.approx(0.1, abs=1e-5)


def test_where_the_heading_is_not_known_the_circle_around_the_footprint_is_judged():
    room = bp.Polygons((0.0, 10.0, 0.0, 10.0), (), "m")
    reach = math.hypot(0.9, 0.25)
    still = line((reach + 0.1, 5), (reach + 0.1, 5))
    assert judged(room, still, CAR).clearance == pytest.approx(0.1, abs=1e-6)
    assert not judged(room, line((reach - 0.1, 5), (reach - 0.1, 5)), CAR).feasible


def obstacles(rng, kind):
    bounds = (0.0, 10.0, 0.0, 10.0)
    if kind == "circles":
        centres, radii = rng.uniform(0, 10, (5, 2)), rng.uniform(0.1, 0.8, 5)
        return bp.Circles(bounds, centres, radii, "m"), [
            shapely.Point(c).buffer(r, 256) for c, r in zip(centres, radii)
        ]
    if kind == "polygons":
        low = rng.uniform(0.5, 8.5, (5, 2))
        boxes = [(x, x + 0.7, y, y + 0.4) for x, y in low.round(2).tolist()]
        return bp.Polygons(bounds, tuple(box(*each) for each in boxes), "m"), [
            shapely.box(a, c, b, d) for a, b, c, d in boxes
        ]
    cells = rng.random((20, 20)) < 0.02
    return bp.Grid(cells, 0.5, "m"), [
        shapely.box(x / 2, y / 2, x / 2 + 0.5, y / 2 + 0.5) for y, x in np.argwhere(cells)
    ]


@pytest.mark.parametrize("kind", ["circles", "polygons", "grid"])
def test_verdicts_agree_with_dense_samples(kind):
    """The certified clearance is at most that of samples, and not less than that by more than the
    motion between two of them.
    """
    rng = np.random.default_rng([7, len(kind)])
    verdicts = []
    for _ in range(25):
        workspace, shapes = obstacles(rng, kind)
        path = bp.Path("piecewise_cubic", rng.uniform(1.5, 8.5, (6, 2)))
        shape = footprint(
            0.4
            * shapely.get_coordinates(shapely.MultiPoint(rng.normal(size=(6, 2))).convex_hull)[:-1]
        )
        pieces = curves.bezier_pieces(path)
        found = check_footprint(pieces, region(workspace), shape)
        blocked = shapely.union_all([*shapes, shapely.box(0, 0, 10, 10).exterior])
        shapely.prepare(blocked)
        t = np.linspace(0, 1, 400)
        least = math.inf
        for number, piece in enumerate(pieces):
            points, slopes = (
                curves.bernstein(3, t) @ piece,
                curves.bernstein(2, t) @ np.diff(piece, axis=0),
            )
            for at, (x, y), slope in zip(t, points, slopes):
                if number + at > found.collision_at:
                    break
                turned = affinity.rotate(
                    shapely.Polygon(shape.corners),
                    math.atan2(slope[1], slope[0]),
                    origin=(0, 0),
                    use_radians=True,
                )
                least = min(least, affinity.translate(turned, x, y).distance(blocked))
        verdicts.append(found.feasible)
        if found.feasible:
            # Circles are polygons to shapely.
            assert found.clearance <= least + CLEARANCE_SHARE * shape.circumscribed + 1e-4
            assert found.clearance >= least - 0.05
        else:
            assert least < 0.05
    assert 2 < sum(verdicts) < 23


def test_a_plan_is_the_first_one_on_which_the_footprint_is_free():
    room = bp.Polygons((0.0, 10.0, 0.0, 6.0), (box(4, 6, 0, 3),), "m")
    problem = bp.Problem("", room, (1.5, 1.5), (8.5, 1.5))
    found = bp.plan(problem, footprint=CAR, turning_radius=0.5, strict=True)
    assert found.feasible
    assert found.robot_radius == pytest.approx(0.1)
    assert found.planned_radius in [
        pytest.approx(each) for each in footprints.radii(footprint(CAR))[1:]
    ]
    assert found.clearance == pytest.approx(
        bp.check(problem, found.path, footprint=CAR).clearance, abs=1e-9
    )
    thin = bp.plan(problem, robot_radius=0.1, turning_radius=0.5)
    assert found.shortest == thin.shortest
    assert not bp.check(problem, thin.path, footprint=CAR).feasible
    assert thin.length < found.length
    around = bp.plan(problem, robot_radius=math.hypot(0.9, 0.25), turning_radius=0.5)
    assert found.length <= around.length + 1e-9


def test_a_square_passes_where_its_circle_does_not():
    slot = bp.Polygons((0.0, 6.0, 0.0, 2.0), (box(2, 4, 0, 0.7), box(2, 4, 1.3, 2)), "m")
    problem = bp.Problem("", slot, (0.5, 1.0), (5.5, 1.0))
    square = [(0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25)]
    found = bp.plan(problem, footprint=square)
    assert found.planned_radius == 0.25
    assert found.clearance == pytest.approx(0.05, abs=1e-6)
    with pytest.raises(ValueError, match="no path was found along which it is free"):
        bp.plan(problem, footprint=[(x * 8, y) for x, y in square], via=[(5.0, 0.5)], strict=True)


@pytest.mark.parametrize(
    ("corners", "told"),
    [
        ("[[0, 0], [1, 0]]", "expected [[x, y], ...], at least three corners"),
        ("[[0, 0], [1, 0], [2, 0]]", "its corners lie on one line"),
        ("[[0, 0], [2, 0], [1, 0.2], [1, 2]]", "not convex at [1, 0.2]"),
        ("[[0, 1], [0.6, -0.8], [-0.95, 0.3], [0.95, 0.3], [-0.6, -0.8]]", "its sides cross"),
        ("[[0, 0], [1, 0], [1, .nan]]", "expected finite numbers"),
        ("[[0, 0], [1, 0], [1, 1e9]]", "expected finite numbers"),
        ("[[0, 0], [1, 0], [1, 1, 1]]", "expected [[x, y], ...]"),
        ("square", "expected [[x, y], ...]"),
        ("[[0, 0], [1, 0], [1, 1.0e-7]]", "thick; expected at least"),
        ("{a: 1}", "expected [[x, y], ...]"),
    ],
)
def test_what_is_no_convex_polygon_is_refused_in_one_line(capsys, tmp_path, corners, told):
    map_file = tmp_path / "room.txt"
    map_file.write_text("....\n" * 4)
    with pytest.raises(SystemExit) as found:
        main(["plan", str(map_file), "--start", "1,1", "--target", "3,3", "--footprint", corners])
    error = capsys.readouterr().err
    assert found.value.code == 2
    assert error.startswith("--footprint: ")
    assert error.count("\n") == 1
    assert told in error


def test_a_footprint_beside_a_radius_is_refused(capsys, tmp_path):
    map_file = tmp_path / "room.txt"
    map_file.write_text("....\n" * 4)
    words = [
        "plan",
        str(map_file),
        "--start",
        "1,1",
        "--target",
        "3,3",
        "--footprint",
        str([list(each) for each in CAR]),
    ]
    with pytest.raises(SystemExit) as found:
        main([*words, "--robot-radius", "0.2"])
    assert found.value.code == 2
    assert (
        capsys.readouterr().err
        == "--footprint: given beside --robot-radius, which is a footprint of its own; expected "
        "one of them\n"
    )
    with pytest.raises(SystemExit) as found:
        main([word.replace("1,1", "0.05,1") for word in words])
    assert found.value.code == 2
    assert "the robot's radius, 0.1" in capsys.readouterr().err
    room = bp.Grid(np.zeros((4, 4), dtype=bool), 1.0, "m")
    with pytest.raises(ValueError, match="given beside robot_radius"):
        bp.plan(bp.Problem("", room, (1.0, 1.0), (3.0, 3.0)), footprint=CAR, robot_radius=0.2)


def test_the_command_tells_for_which_disc_it_planned(capsys, tmp_path):
    map_file = tmp_path / "room.txt"
    map_file.write_text("........\n" * 2 + "...##...\n" * 4 + "........\n" * 2)
    words = [
        "plan",
        str(map_file),
        "--start",
        "1,4",
        "--target",
        "7,4",
        "--settings",
        "{turning_radius: 0.5}",
    ]
    main(
        [
            *words,
            "--footprint",
            "[[0.6, 0.2], [-0.6, 0.2], [-0.6, -0.2], [0.6, -0.2]]",
            "--strict",
            "--out",
            str(tmp_path / "p.svg"),
        ]
    )
    told = {row[:16].strip(): row[16:] for row in capsys.readouterr().out.splitlines()}
    assert told["footprint"] == "4 corners, circles of 0.2 cell within and 0.632456 around it"
    assert told["planned for"].startswith("a disc of 0.")
    assert told["feasible"] == "yes"
    assert told["clearance"].endswith(" cell of the footprint")
    with pytest.raises(SystemExit) as found:
        main([*words, "--footprint", "[[3, 0.2], [-3, 0.2], [-3, -0.2], [3, -0.2]]"])
    assert found.value.code == 1
    told = {row[:16].strip(): row[16:] for row in capsys.readouterr().out.splitlines()}
    assert told["feasible"].startswith("no: the footprint enters an obstacle at ")
