"""Searches for a path with a turning radius: that they end, what they tell, and that a larger wish
never gives a tighter turn.
"""

import inspect
import math
import re
from itertools import pairwise

import numpy as np
import pytest
from fields import BENCHMARK_MAPS
from PIL import Image

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.geometry import samples
from bezierplan.geometry.any_collision import collides
from bezierplan.geometry.checker import first_collision
from bezierplan.geometry.region import from_origin, region
from bezierplan.places import PACKAGE
from bezierplan.planners import dubins_search, rounded_shortest_path

ENDS = {
    "complex2": ((1.0, 1.0), (19.0, 19.0)),
    "gaps": ((2.0, 10.0), (18.0, 10.0)),
    "hidden_U": ((10.0, 3.0), (10.0, 27.0)),
}


def on(name, radius=None):
    room = bp.read_map(BENCHMARK_MAPS / f"{name}.geojson", robot_radius=radius)
    return bp.Problem(name, room, *ENDS[name])


def noise(side, share, seed=4):
    """A map of cells of which a share is occupied, from corner to corner."""
    occupied = np.random.default_rng(seed).random((side, side)) < share
    occupied[:3, :3] = occupied[-3:, -3:] = False
    far = side - 1.0
    return bp.Problem("noise", bp.Grid(occupied, 1.0, "m"), (1.0, 1.0), (far, far))


DISCS = bp.Circles(
    (0.0, 10.0, 0.0, 10.0),
    centres=np.array([[3.0, 3.0], [6.0, 7.0]]),
    radii=np.array([1.5, 2.0]),
    unit="m",
)


@pytest.mark.parametrize(
    "workspace",
    [on("complex2").workspace, noise(20, 0.2).workspace, DISCS],
    ids=lambda home: type(home).__name__,
)
def test_whether_there_is_a_collision_is_what_the_first_one_says(workspace):
    blocked, rng = region(workspace), np.random.default_rng(2)
    x_low, x_high, y_low, y_high = workspace.bounds
    seen = set()
    for reach in np.geomspace(0.01, 10.0, 400):
        middle = rng.uniform((x_low, y_low), (x_high, y_high))
        chain = middle + rng.uniform(-reach, reach, (7, 2))
        pieces = from_origin(np.stack([chain[:4], chain[3:]]), blocked)
        hit = first_collision(pieces, blocked)[0] < math.inf
        assert collides(pieces, blocked) == hit
        seen.add(hit)
    assert seen == {True, False}


@pytest.mark.parametrize("problem", [on("complex2"), on("complex2", 0.2), on("gaps")])
def test_a_larger_wish_keeps_no_less(problem):
    kept = [bp.plan(problem, turning_radius=wish).turning_radius for wish in (1.0, 3.0, 9.0, 1e5)]
    assert kept[0] == 1.0
    assert all(larger >= smaller for smaller, larger in pairwise(kept))
    assert kept[-1] > 3.0


@pytest.mark.parametrize("wish", [1e3, 1e5])
def test_no_wish_is_too_large_to_be_answered(wish):
    answer = bp.plan(on("hidden_U", 0.2), turning_radius=wish)
    assert answer.feasible
    assert not answer.corners
    assert 12.0 < answer.turning_radius < wish
    assert answer.curvature == pytest.approx(1 / answer.turning_radius, rel=1e-3)


@pytest.mark.parametrize("radius", [1e-5, 0.05])
def test_small_turns_on_a_large_map_are_found_by_way_of_wider_ones(radius):
    problem = noise(100, 0.1)
    loose = bp.plan(problem, turning_radius=radius, start_heading=math.pi, target_heading=0.0)
    assert loose.feasible
    assert loose.gap < 0.15
    assert loose.curvature <= (1 + 1e-4) / radius


def test_the_search_of_a_hopeless_wish_ends_after_its_limit(monkeypatch):
    """With a smaller limit, so that the test is short; the count, not a clock, ends it."""
    problem = noise(60, 0.35, seed=1)
    free = bp.plan(problem, turning_radius=3.0, start_heading=0.0)
    assert free.path is None
    assert free.evaluations <= 1 + dubins_search.MOST_EXPANDED
    monkeypatch.setattr(dubins_search, "MOST_EXPANDED", 500)
    assert bp.plan(problem, turning_radius=3.0, start_heading=0.0).evaluations <= 501


def test_no_circle_is_shrunk_further_once_it_is_too_small(monkeypatch):
    """The same answer, after fewer paths than if each wish were rounded to the end."""
    problem, room = noise(60, 0.3), region(noise(60, 0.3).workspace)
    bound = bp.shortest_path(problem)
    settings = rounded_shortest_path.Settings(turning_radius=4.0, offset=0.0)
    first = rounded_shortest_path._answer(problem, bound, room, settings)
    short = rounded_shortest_path._largest(problem, bound, room, settings, first)
    monkeypatch.setattr(rounded_shortest_path, "_may_fit", lambda *_: (True, 0))
    whole = rounded_shortest_path._largest(problem, bound, room, settings, first)
    assert np.array_equal(short.path.points, whole.path.points)
    assert short.extra == whole.extra
    assert short.evaluations < whole.evaluations


def planned(capsys, *words):
    main(["plan", str(BENCHMARK_MAPS / "gaps.geojson"), "--start", "2,10", *words])
    return {line[:16].strip(): line[16:] for line in capsys.readouterr().out.splitlines()}


def test_it_is_told_how_far_was_searched(capsys):
    wide = ("--target", "18,10", "--settings", "{turning_radius: 30}")
    told = planned(capsys, *wide)["turning radius"]
    assert re.fullmatch(
        r"30 m asked, 3\.\d+ m kept: no more in a search of [\d,]+ paths and places", told
    )
    with pytest.raises(SystemExit) as found:
        planned(capsys, "--target", "18,10,0", *wide[2:])
    assert found.value.code == 1
    told = capsys.readouterr()
    assert re.search(r"^path +none \(none found in a search of [\d,]+ places\)$", told.out, re.M)
    assert told.err == "--planner: dubins_search: found no path\n"


def test_an_offset_without_room_is_told(capsys):
    asked = ("--target", "18,10", "--settings")
    assert planned(capsys, *asked, "{offset: 0.3}")["offset"] == "0.3 m asked and kept"
    assert "offset" not in planned(capsys, *asked, "{turning_radius: 1}")
    told = planned(capsys, *asked, "{offset: 5}")["offset"]
    assert re.fullmatch(r"5 m asked, 1\.\d+ m kept at a corner: no room", told)
    with pytest.raises(SystemExit) as found:
        planned(capsys, *asked, "{offset: 5}", "--strict")
    assert found.value.code == 1
    assert re.fullmatch(
        r"--settings: offset: 5 m asked, 1\.\d+ m kept; "
        r"expected one that can be kept, or not strict\n",
        capsys.readouterr().err,
    )
    answer = bp.plan(on("gaps"), offset=5.0)
    assert answer.offset == pytest.approx(float(told.split()[3]), rel=1e-5)
    assert math.isnan(bp.plan(on("gaps")).offset)
    with pytest.raises(ValueError, match="offset: 5 m asked"):
        bp.plan(on("gaps"), offset=5.0, strict=True)


def test_a_path_that_goes_nowhere(tmp_path):
    problem = on("gaps")._replace(target=ENDS["gaps"][0])
    for smooth in ("arcs", "continuous"):
        answer = bp.plan(problem, smooth=smooth)
        assert (answer.length, answer.feasible) == (0.0, True)
        along = answer.sample(step=0.1)
        assert (along.heading == 0).all()
        assert (along.curvature == 0).all()


def test_the_interface_documents_every_function_of_samples():
    documented = (PACKAGE.parents[1] / "docs" / "api.md").read_text(encoding="utf-8")
    for name, function in inspect.getmembers(samples, inspect.isfunction):
        if function.__module__ == samples.__name__ and not name.startswith(("_", "check_")):
            assert f"bezierplan.geometry.samples.{name}\n" in documented


WRONG = {
    "so many points": (
        ("--step", "1e-9", "--out", "path.csv"),
        "--step: 1e-09: more than 10,000,000 points on 16 units; expected at least 1.6e-06",
    ),
    "a rest at both ends": (
        ("--speed", "1", "--acceleration", "1", "--step", "90", "--out", "path.csv"),
        "--step: the robot rests at two samples in a row; expected a smaller one",
    ),
    "no text": (("--like", ""), "--like: ''; expected some text"),
    "a large footprint": (
        ("--footprint", "[[-11, -11], [11, -11], [11, 11], [-11, 11]]"),
        "--footprint: the circle within it, of radius 11: no place of the map is that far from",
    ),
    "text in a footprint": (
        ("--footprint", "[[0, 0], [1, 0], ['1', 1]]"),
        "--footprint: [[0, 0], [1, 0], ['1', 1]]; expected [[x, y], ...]",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_be_is_told_in_one_line(case, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words, expected = WRONG[case]
    with pytest.raises(SystemExit) as ended:
        planned(capsys, "--target", "18,10", *words)
    told = capsys.readouterr()
    # Only the path tells where it is sampled.
    assert ended.value.code == (1 if case == "a rest at both ends" else 2)
    assert told.err.startswith(expected)
    assert told.err.count("\n") == 1
    assert told.out == ""


def test_the_map_itself_is_never_overwritten(capsys, tmp_path):
    file = tmp_path / "gaps.geojson"
    before = (BENCHMARK_MAPS / file.name).read_bytes()
    file.write_bytes(before)
    out = tmp_path / "." / "gaps.geojson"
    with pytest.raises(SystemExit) as ended:
        main(["plan", str(file), "--start", "2,10", "--target", "18,10", "--out", str(out)])
    assert ended.value.code == 2
    assert "is the map itself; expected another file" in capsys.readouterr().err
    assert file.read_bytes() == before


def test_nor_is_the_image_of_a_map(capsys, tmp_path, caplog):
    Image.new("L", (20, 20), 254).save(tmp_path / "room.png")
    file = tmp_path / "room.yaml"
    file.write_text("image: room.png\nresolution: 0.5\norigin: [0, 0, -nan]\n", encoding="utf-8")
    before = (tmp_path / "room.png").read_bytes()
    for out in ("room.png", "room.yaml"):
        words = ["--start", "1,1", "--target", "9,9", "--out", str(tmp_path / out)]
        with pytest.raises(SystemExit):
            main(["plan", str(file), *words])
        assert "is the map itself" in capsys.readouterr().err
        assert len(caplog.messages) == 1  # of the yaw: the file is looked into twice
        caplog.clear()
    assert (tmp_path / "room.png").read_bytes() == before


def test_a_margin_that_no_map_can_have(capsys, tmp_path):
    ring = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]
    file = tmp_path / "block.geojson"
    file.write_text(f'{{"type": "Polygon", "coordinates": [{ring}]}}', encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["plan", str(file), "--start", "1,5", "--target", "9,5", "--margin", "1e300"])
    assert capsys.readouterr().err == "--margin: 1e+300; expected at most 100000\n"
