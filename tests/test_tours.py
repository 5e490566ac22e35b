"""The order of way points, and the speed along a path."""

from itertools import pairwise, permutations

import numpy as np
import pytest

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.geometry import samples
from bezierplan.running.tours import shortest_order

ROOM = """........
.####...
.#......
.#.###..
...#....
"""
ENDS = ("--start", "0.5,0.5", "--target", "7.5,4.5")
PLACES = [(7.5, 0.5), (0.5, 4.5), (2.5, 2.5), (6.5, 2.5), (2.5, 0.5)]


@pytest.fixture
def room(tmp_path):
    file = tmp_path / "room.txt"
    file.write_text(ROOM)
    return file


@pytest.mark.parametrize("seed", range(5))
def test_no_order_is_shorter(seed):
    lengths = np.random.default_rng(seed).random((8, 8))
    lengths += lengths.T

    def length(order):
        return sum(lengths[one, other] for one, other in pairwise([0, *order, 7]))

    found = shortest_order(lengths)
    assert sorted(found) == list(range(1, 7))
    assert length(found) == pytest.approx(min(map(length, permutations(range(1, 7)))), rel=1e-12)


def test_without_an_order_in_which_all_can_be_reached_each_place_is_still_there_once():
    assert sorted(shortest_order(np.full((5, 5), np.inf))) == [1, 2, 3]


@pytest.mark.parametrize("radius", [0.0, 0.2])
def test_a_tour_is_the_shortest_of_all_orders_around_the_obstacles(room, radius):
    problem = bp.Problem("room", bp.read_map(room), (0.5, 0.5), (7.5, 4.5))
    tour = bp.plan(
        problem, "shortest_path", via=PLACES[:4], via_order="shortest", robot_radius=radius
    )
    assert set(tour.via) == set(PLACES[:4])
    lengths = [
        bp.plan(problem, "shortest_path", via=order, robot_radius=radius).length
        for order in permutations(PLACES[:4])
    ]
    assert tour.feasible
    assert tour.length == pytest.approx(min(lengths), rel=1e-12)


def test_the_command_and_the_function_pass_places_in_the_same_order(room, capsys):
    words = [word for x, y in PLACES for word in ("--via", f"{x},{y}")]
    main(["plan", str(room), *ENDS, *words, "--via-order", "shortest"])
    problem = bp.Problem("room", bp.read_map(room), (0.5, 0.5), (7.5, 4.5))
    tour = bp.plan(problem, via=PLACES, via_order="shortest")
    told = " ".join(f"{x},{y}" for x, y in tour.via)
    printed = capsys.readouterr().out
    assert f"way points      {told}\n" in printed
    assert f"shortest path   {tour.shortest:.6g} cell" in printed


def test_a_footprint_passes_places_in_the_order_of_its_smallest_disc(room):
    problem = bp.Problem("room", bp.read_map(room), (0.5, 0.5), (7.5, 4.5))
    square = [(0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)]
    tour = bp.plan(problem, via=PLACES, via_order="shortest", footprint=square)
    slim = bp.plan(problem, via=PLACES, via_order="shortest", robot_radius=0.1)
    assert tour.feasible
    assert tour.via == slim.via


def turn(radius):
    """Samples of a straight line, half a circle to the left, and a straight line."""
    distance = np.linspace(0, 20, 2001)
    curved = (distance >= 8) & (distance <= 12)
    return samples.Samples(
        distance, distance, 0 * distance, 0 * distance, np.where(curved, 1 / radius, 0.0)
    )


def test_speed_is_limited_by_curvature_and_reached_with_the_acceleration():
    along = turn(2.0)
    speed = samples.speeds(along, 3.0, lateral=2.0, acceleration=1.0)
    assert speed[0] == speed[-1] == 0
    assert speed.max() == 3.0
    assert speed[1000] == 2.0  # the root of 2 m/s^2 times 2 m
    gain = np.diff(speed**2) / (2 * np.diff(along.distance))
    assert np.abs(gain).max() == pytest.approx(1.0, rel=1e-9)
    # It brakes from 3 to 2 m/s over (9 - 4) / 2 m.
    assert speed[along.distance <= 5.5 + 1e-9][-1] == pytest.approx(3.0)
    assert speed[570] < 3.0


def test_the_time_of_a_start_from_rest_is_exact():
    straight = turn(np.inf)
    time = samples.times(straight, samples.speeds(straight, 2.0, acceleration=1.0))
    # 2 s and 2 m each to start and to stop, the 16 m between at 2 m/s
    assert time[-1] == pytest.approx(12.0, rel=1e-9)
    assert (np.diff(time) > 0).all()


def test_without_an_acceleration_the_robot_is_fast_from_the_first_point(room, tmp_path):
    out = tmp_path / "path.csv"
    limits = ("--speed", "2", "--lateral-acceleration", "0.5")
    settings = ("--settings", "{turning_radius: 0.3}")
    main(["plan", str(room), *ENDS, *settings, *limits, "--step", "0.01", "--out", str(out)])
    table = np.genfromtxt(out, delimiter=",", names=True)
    names = ("distance", "x", "y", "heading", "curvature", "speed", "time")
    assert table.dtype.names == names
    bends = np.abs(table["curvature"])
    assert bends.max() > 1
    allowed = np.minimum(2.0, np.sqrt(0.5 / np.maximum(bends, 1e-9)))
    assert table["speed"] == pytest.approx(allowed, rel=1e-6)
    assert table["time"][-1] == pytest.approx(
        2 * np.sum(np.diff(table["distance"]) / (table["speed"][1:] + table["speed"][:-1])),
        rel=1e-6,
    )


REFUSED = {
    "no places": (("--via-order", "shortest"), "--via-order: shortest: there are no way points"),
    "places": (
        ("--via-order", "shortest", *("--via", "0.5,0.6") * 13),
        "--via-order: shortest: 13 way points; expected at most 12",
    ),
    "the same place": (
        ("--via-order", "shortest", "--via", "7.5,0.5", "--via", "0.5,4.5", "--via", "7.5,0.5"),
        "--via: (7.5, 0.5): the same place as the one before",
    ),
    "ros": (("--speed", "1", "--out", "a.yaml"), "--speed: 1: only for --out with a file"),
    "no file": (("--speed", "1"), "--speed: 1: only for --out with a file that ends in .csv"),
    "no speed": (
        ("--acceleration", "1", "--out", "a.csv"),
        "--acceleration: 1: without a speed; expected one beside it",
    ),
    "standing": (
        ("--speed", "0", "--out", "a.csv"),
        "--speed: 0; expected a number above 0",
    ),
    "nan": (
        ("--speed", "1", "--lateral-acceleration", "nan", "--out", "a.csv"),
        "--lateral-acceleration: nan; expected a number above 0",
    ),
    "corners": (
        (
            *("--speed", "1", "--lateral-acceleration", "1", "--out", "a.csv"),
            *("--planner", "shortest_path"),
        ),
        "--lateral-acceleration: 1: the path has corners",
    ),
    "two samples": (
        ("--speed", "1", "--acceleration", "1", "--step", "100", "--out", "a.csv"),
        "--step: the robot rests at two samples in a row; expected a smaller one",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_told_in_one_line(room, tmp_path, monkeypatch, capsys, name):
    words, told = REFUSED[name]
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(["plan", str(room), *ENDS, *words])
    # Only the path tells that it has corners, or where it is sampled.
    assert ended.value.code == (1 if name in ("corners", "two samples") else 2)
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line
