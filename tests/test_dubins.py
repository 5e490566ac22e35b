"""Paths that turn no tighter than a radius: Dubins paths in closed form, and the search among
obstacles, judged by others than itself.
"""

import itertools
import math

import numpy as np
import pytest
import shapely
from fields import BENCHMARK_MAPS
from scipy.optimize import brentq

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.geometry import curves
from bezierplan.planners.parts import dubins
from bezierplan.workspaces.problem import Path

ROOM = bp.Polygons((0.0, 20.0, 0.0, 20.0), (), "m")
ANY = math.nan


def words(a, b, radius=1.0):
    found = np.empty((dubins.WORDS, 8))
    dubins.words_between(np.array(a, dtype=float), np.array(b, dtype=float), radius, found)
    return found


def shortest(a, b, radius=1.0):
    return words(a, b, radius)[:, 7].min()


def end_of(a, word, radius):
    """The pose at the end of a word, by its parts."""
    x, y, heading = a[0], a[1], word[6]
    for turn, length in word[:6].reshape(3, 2):
        if turn == 0:
            x, y = x + length * math.cos(heading), y + length * math.sin(heading)
            continue
        centre = x - turn * radius * math.sin(heading), y + turn * radius * math.cos(heading)
        heading += turn * length / radius
        x, y = (
            centre[0] + turn * radius * math.sin(heading),
            centre[1] - turn * radius * math.cos(heading),
        )
    return x, y, heading


CLOSED = {
    "ahead": ((0, 0, 0.3), (3 * math.cos(0.3), 3 * math.sin(0.3), 0.3), 1.0, 3.0),
    "nowhere": ((1, 2, 0.5), (1, 2, 0.5), 1.0, 0.0),
    "a U-turn": ((0, 0, math.pi / 2), (-2, 0, -math.pi / 2), 1.0, math.pi),
    "a U-turn to the right": ((0, 0, math.pi / 2), (3, 0, -math.pi / 2), 1.5, 1.5 * math.pi),
    "a wide U-turn": ((0, 0, math.pi / 2), (-5, 0, -math.pi / 2), 1.0, math.pi + 3),
    "a quarter": ((0, 0, 0), (2, 2, math.pi / 2), 2.0, math.pi),
    "a quarter, then ahead": ((0, 0, 0), (1, 4, ANY), 1.0, math.pi / 2 + 3),
    "a change of lanes": ((0, 0, 0), (2, 2, 0), 1.0, math.pi),
    "back on the spot": ((0, 0, 0), (0, 0, math.pi), 1.0, 7 * math.pi / 3),
    "behind": (
        (0, 0, 0),
        (-4, 0, ANY),
        1.0,
        math.pi + math.acos(1 / math.hypot(4, 1)) * -1 + math.atan2(1, 4) * -1 + math.pi / 2 + 4,
    ),
    "without headings": ((1, 1, ANY), (4, 5, ANY), 1.0, 5.0),
}


@pytest.mark.parametrize("case", CLOSED)
def test_lengths_in_closed_form(case):
    a, b, radius, length = CLOSED[case]
    if (
        case == "behind"
        # An arc and its tangent through the point: 1 - cos t + sin t (line) and so on, solved by
        # another way.
    ):
        t = brentq(
            lambda t: (1 - math.cos(t)) * math.cos(t) - (math.sin(t) + 4) * math.sin(t),
            math.pi / 2,
            2 * math.pi,
        )
        length = t + math.hypot(4 + math.sin(t), 1 - math.cos(t))
    assert shortest(a, b, radius) == pytest.approx(length, abs=1e-9)


def test_every_word_ends_where_it_should_and_backwards_is_as_long():
    rng = np.random.default_rng(3)
    used = set()
    for number in range(600):
        a, b, radius = rng.uniform(-4, 4, 3), rng.uniform(-4, 4, 3), rng.uniform(0.3, 3)
        a[2], b[2] = (ANY if number % 4 == 1 else a[2]), (ANY if number % 4 == 2 else b[2])
        found = words(a, b, radius)
        used.add(int(found[:, 7].argmin()))
        for word in found[found[:, 7] < np.inf]:
            x, y, heading = end_of(a, word, radius)
            assert math.hypot(x - b[0], y - b[1]) < 1e-9
            assert math.isnan(b[2]) or abs(math.remainder(heading - b[2], math.tau)) < 1e-9
            assert math.isnan(a[2]) or word[6] == a[2]
        back = shortest((*b[:2], b[2] + math.pi), (*a[:2], a[2] + math.pi), radius)
        assert back == pytest.approx(found[:, 7].min(), rel=1e-9)
    assert used == set(range(dubins.WORDS))


def test_no_chain_of_arcs_and_lines_is_shorter():
    """Of all chains left, straight or right with three parts, on a grid of lengths, none arrives
    sooner than the shortest word.
    """
    lengths = np.linspace(0, 3, 6)
    for turns in itertools.product((-1.0, 0.0, 1.0), repeat=3):
        for sizes in itertools.product(lengths, repeat=3):
            word = np.array([*itertools.chain(*zip(turns, sizes, strict=True)), 0.2, sum(sizes)])
            if len(set(sizes)) == 3:
                assert shortest((0, 0, 0.2), end_of((0, 0), word, 1.0)) <= sum(sizes) + 1e-9


def test_pieces_keep_the_curvature_and_the_length():
    rng = np.random.default_rng(4)
    pieces = np.empty((dubins.MOST_PIECES, 4, 2))
    for _ in range(100):
        a, b, radius = rng.uniform(-4, 4, 3), rng.uniform(-4, 4, 3), rng.uniform(0.3, 3)
        found = words(a, b, radius)
        word = found[found[:, 7].argmin()]
        count = dubins.pieces_of(a, b, word, radius, pieces)
        path = Path(
            "cubic_chain", np.concatenate([pieces[0, :1], pieces[:count, 1:].reshape(-1, 2)])
        )
        kappa, _ = curves.curvature(path, 3001)
        assert np.nanmax(np.abs(kappa)) * radius < 1 + dubins.CURVATURE_EXCESS
        assert curves.length(path) == pytest.approx(word[7], rel=1e-6)
        assert math.isfinite(curves.curvature_jump(path))


def densest(answer):
    """Largest curvature of dense samples."""
    return np.abs(answer.sample(step=answer.length / 20_000).curvature).max()


def heads(answer):
    along = answer.sample(step=0.05)
    return along.heading[0], along.heading[-1]


def test_in_free_space_the_answer_is_the_dubins_path():
    problem = bp.Problem("free", ROOM, (12.0, 10.0), (8.0, 10.0))
    answer = bp.plan(
        problem, start_heading=math.pi / 2, target_heading=-math.pi / 2, turning_radius=2.0
    )
    assert (answer.method, answer.stop, answer.feasible, answer.corners) == (
        "dubins_search",
        "direct",
        True,
        False,
    )
    assert answer.length == pytest.approx(2 * math.pi, rel=1e-6)
    assert answer.turning_radius == 2.0
    assert heads(answer) == pytest.approx((math.pi / 2, -math.pi / 2), abs=1e-9)
    assert densest(answer) < 0.5 * (1 + dubins.CURVATURE_EXCESS)
    assert bp.plan(problem, "dubins_search", turning_radius=2.0).length == pytest.approx(
        4.0, rel=1e-12
    )


def test_in_a_corridor_the_robot_cannot_turn_and_drives_on_to_where_it_can():
    """A corridor 1 m wide ends in a room: who looks the wrong way there, and turns in 1 m, drives
    out, turns, and comes back.
    """
    walls = [(0.0, 12.0, 0.0, 4.5), (0.0, 12.0, 5.5, 10.0)]
    rings = tuple((np.array([(a, c), (b, c), (b, d), (a, d)]),) for a, b, c, d in walls)
    home = bp.Polygons((0.0, 20.0, 0.0, 10.0), rings, "m")
    problem = bp.Problem("corridor", home, (2.0, 5.0), (6.0, 5.0))
    ahead = bp.plan(problem, start_heading=0.0, target_heading=0.0, turning_radius=1.0)
    assert ahead.length == pytest.approx(4.0, rel=1e-9)
    back = bp.plan(problem, start_heading=0.0, target_heading=math.pi, turning_radius=1.0)
    assert (back.feasible, back.stop, back.corners) == (True, "search", False)
    assert heads(back) == pytest.approx((0.0, math.pi), abs=1e-9) or heads(back) == pytest.approx(
        (0.0, -math.pi), abs=1e-9
    )
    assert densest(back) < 1 + dubins.CURVATURE_EXCESS
    # Out and back to the corridor's mouth, and there a loop of 7/3 pi radii, less what the width of
    # the corridor allows.
    assert 10 + 6 + 5 < back.length < 10 + 6 + 9.5
    none = bp.plan(problem, start_heading=math.pi, target_heading=0.0, turning_radius=1.0)
    assert (none.path, none.feasible, none.stop) == (None, False, "none found")
    with pytest.raises(
        ValueError,
        match="turning_radius: 1 m asked: no path was found; "
        "expected one that can be kept, or not strict",
    ):
        bp.plan(problem, start_heading=math.pi, target_heading=0.0, turning_radius=1.0, strict=True)


@pytest.mark.parametrize(
    "name", ["back_and_forth", "bugtrap1", "complex2", "gaps", "hidden_U", "square_spiral"]
)
def test_on_the_six_maps_a_path_with_headings_is_found(name):
    room = bp.read_map(BENCHMARK_MAPS / f"{name}.geojson")
    ends = {
        "back_and_forth": ((1, 1.25), (1, 8.75)),
        "bugtrap1": ((12.6, 14.4), (22.4, 24.2)),
        "complex2": ((1, 1), (19, 19)),
    }
    ends |= {
        "gaps": ((2, 10), (18, 10)),
        "hidden_U": ((10, 3), (10, 27)),
        "square_spiral": ((2.5, 2.5), (12.5, 7.5)),
    }
    problem = bp.Problem(name, room, *(tuple(map(float, end)) for end in ends[name]))
    for start, target in ((math.pi, math.pi), (math.pi / 2, -math.pi / 2)):
        answer = bp.plan(problem, start_heading=start, target_heading=target, turning_radius=0.4)
        assert answer.feasible
        assert answer.claimed_feasible
        assert not answer.corners
        assert answer.gap < 0.08
        assert densest(answer) < 2.5 * (1 + dubins.CURVATURE_EXCESS)
        assert [
            math.remainder(one - other, math.tau)
            for one, other in zip(heads(answer), (start, target))
        ] == pytest.approx([0, 0], abs=1e-9)
        again = bp.plan(problem, start_heading=start, target_heading=target, turning_radius=0.4)
        assert np.array_equal(again.path.points, answer.path.points)


def test_with_a_radius_the_written_path_keeps_its_distance(capsys, tmp_path):
    file = BENCHMARK_MAPS / "gaps.geojson"
    words = [
        "--start",
        "2,10,1.5",
        "--target",
        "18,10",
        "--robot-radius",
        "0.3",
        "--settings",
        "{turning_radius: 0.5}",
        "--strict",
    ]
    main(["plan", str(file), *words, "--step", "0.002", "--out", str(tmp_path / "path.csv")])
    told = capsys.readouterr().out
    assert "planner         dubins_search" in told
    assert "start_heading 1.5, target_heading any" in told
    assert "turning radius  0.5 m asked and kept" in told
    rows = np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1)
    obstacles = shapely.union_all(
        [shapely.Polygon(outer, holes) for outer, *holes in bp.read_map(file).obstacles]
    )
    line = shapely.LineString(rows[:, 1:3])
    # Chords of arcs.
    assert (
        min(line.distance(obstacles), line.distance(shapely.box(0, 0, 20, 20).exterior))
        > 0.3 - 1e-5
    )
    assert rows[0, 3] == pytest.approx(1.5, abs=1e-8)
    assert np.abs(rows[:, 4]).max() < 2 * (1 + dubins.CURVATURE_EXCESS)


def test_on_cells_and_among_circles():
    cells = np.zeros((20, 20), dtype=bool)
    cells[5:15, 9:11] = True
    grid = bp.Grid(cells, 0.5, "m", (-3.0, 40.0))
    discs = bp.Circles(
        (-5.0, 5.0, -5.0, 5.0),
        centres=np.array([[0.0, 0.0], [1.0, 2.0]]),
        radii=np.array([1.0, 0.7]),
        unit="m",
    )
    for home, start, target in ((grid, (0.0, 45.0), (4.0, 45.0)), (discs, (-3.0, 0.0), (3.0, 0.0))):
        answer = bp.plan(
            bp.Problem("", home, start, target),
            start_heading=0.0,
            target_heading=0.0,
            turning_radius=0.8,
        )
        assert answer.feasible
        assert answer.claimed_feasible
        assert densest(answer) < 1.25 * (1 + dubins.CURVATURE_EXCESS)
        assert answer.gap < 0.15


def test_way_points_are_passed_without_a_corner():
    via = [(10.0, 4.0), (4.0, 12.0)]
    answer = bp.plan(
        bp.Problem("free", ROOM, (2.0, 2.0), (18.0, 18.0)),
        via=via,
        start_heading=0.0,
        turning_radius=1.5,
    )
    assert not answer.corners
    along = answer.sample(step=0.01)
    line = shapely.LineString(np.column_stack([along.x, along.y]))
    assert all(line.distance(shapely.Point(point)) < 1e-4 for point in via)
    assert densest(answer) < (1 + dubins.CURVATURE_EXCESS) / 1.5
