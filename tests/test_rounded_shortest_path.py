"""The rounded shortest path: free on every kind of workspace, as round as there is room for, and
nearly as short as possible. `test_relations` has what a larger radius, robot or map changes.
"""

import math

import numpy as np
import pytest
from fields import benchmark
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.geometry import curves
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region
from bezierplan.geometry.shortest_paths import shortest_path
from bezierplan.planners import rounded_shortest_path
from bezierplan.workspaces import robot
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem

MAPS = ["back_and_forth", "bugtrap1", "complex2", "gaps", "hidden_U", "square_spiral"]
# An arc of 45 degrees is curved by up to this much more than its circle, relatively.
ARC = 1e-3


def rounded(problem, turning_radius=math.inf, excess=math.inf):
    return rounded_shortest_path.plan(
        problem, np.random.default_rng(0), turning_radius=turning_radius, excess=excess
    )


def most_curved(path):
    return np.nanmax(np.abs(curves.curvature(path, 4001)[0]))


def one_corner():
    """A square beside the way from (0, 0) to (10, 0), so that the path turns at its corners (4, 2)
    and (6, 2), by symmetry alike.
    """
    square = np.array([[4.0, -5.0], [6.0, -5.0], [6.0, 2.0], [4.0, 2.0]])
    return Problem(
        "", Polygons((-5.0, 15.0, -5.0, 15.0), ((square,),), "m"), (0.0, 0.0), (10.0, 0.0)
    )


def assert_sound(problem, plan):
    """Free by the certified check, from start to target, no tighter than it says, and not shorter
    than possible.
    """
    assert check(curves.bezier_pieces(plan.path), build_region(problem.workspace)).feasible
    assert plan.path.points[0].tolist() == list(problem.start)
    assert plan.path.points[-1].tolist() == list(problem.target)
    assert plan.objective >= shortest_path(problem).length - 1e-6
    if plan.extra["corners"] == 0:
        assert most_curved(plan.path) <= (1 + ARC) / plan.extra["least_radius"]
        assert math.isfinite(curves.curvature_jump(plan.path))


@pytest.mark.parametrize("name", MAPS)
@pytest.mark.parametrize("turning_radius", [0.3, 3.0])
def test_benchmark_maps(name, turning_radius):
    problem, _ = benchmark(name)
    plan = rounded(problem, turning_radius)
    assert_sound(problem, plan)
    if turning_radius == 0.3:
        assert plan.extra["least_radius"] == 0.3
        assert plan.objective < 1.01 * shortest_path(problem).length


@pytest.mark.parametrize("name", MAPS)
def test_without_a_radius_turns_are_as_wide_as_a_path_one_percent_longer_allows(name):
    """A rung of the ladder more, on all turns, is too long or not free."""
    problem, _ = benchmark(name)
    plan = rounded(problem, excess=0.01)
    assert_sound(problem, plan)
    bound = shortest_path(problem).length
    assert plan.objective <= 1.01 * bound * (1 + 1e-6)
    wider = rounded(problem, 1.0201 * plan.extra["least_radius"])
    assert (
        wider.objective > 1.01 * bound
        or wider.extra["least_radius"] < 1.02 * (plan.extra["least_radius"])
    )


@pytest.mark.parametrize("settings", [{"turning_radius": 0.0}, {"excess": 0.0}])
def test_without_any_roundness_it_is_the_shortest_path(settings):
    problem, _ = benchmark("complex2")
    plan = rounded(problem, **settings)
    assert plan.objective == pytest.approx(shortest_path(problem).length, abs=1e-12)
    assert plan.extra == {"turns": 7, "corners": 7, "least_radius": 0.0}


def test_two_corners_by_hand():
    """Legs from (0, 0) and to (10, 0) touch circles of radius 1 below the corners; the arc between
    them is flat. The pull on a circle halves the angle between its legs.
    """
    plan = rounded(one_corner(), 1.0)
    assert plan.extra == {"turns": 2, "corners": 0, "least_radius": 1.0}
    inward = np.array([math.sin(math.atan2(2, 4) / 2), -math.cos(math.atan2(2, 4) / 2)])
    for _ in range(50):
        centre = np.array([4.0, 2.0]) + inward
        leg = math.sqrt(centre @ centre - 1)
        heading = math.atan2(centre[1], centre[0]) + math.asin(1 / math.hypot(*centre))
        inward = np.array([math.sin(heading / 2), -math.cos(heading / 2)])
    assert plan.objective == pytest.approx(2 * (leg + heading) + 10 - 2 * centre[0], rel=1e-5)


def test_corners_of_a_walls_end_share_a_circle():
    """Of radius 2, through both corners, a tenth to each side."""
    wall = np.array([[4.9, -5.0], [5.1, -5.0], [5.1, 8.0], [4.9, 8.0]])
    problem = Problem(
        "", Polygons((-5.0, 15.0, -5.0, 15.0), ((wall,),), "m"), (2.0, 0.0), (8.0, 0.0)
    )
    plan = rounded(problem, 2.0)
    assert_sound(problem, plan)
    assert plan.extra == {"turns": 2, "corners": 0, "least_radius": 2.0}
    centre = np.array([3.0, 8 - math.sqrt(2**2 - 0.1**2)])  # from the start
    leg = math.sqrt(centre @ centre - 4)
    heading = math.atan2(centre[1], centre[0]) + math.asin(2 / math.hypot(*centre))
    assert plan.objective == pytest.approx(2 * (leg + 2 * heading), rel=1e-5)


def test_one_circle_is_gone_round_by_its_own_arc():
    """The tangents and the arc of a unit circle are 2 sqrt 3 + pi / 3 long; a larger turn touches
    the circle at its top alone.
    """
    disc = Problem(
        "",
        Circles((-5.0, 5.0, -5.0, 5.0), np.zeros((1, 2)), np.ones(1), "m"),
        (-2.0, 0.0),
        (2.0, 0.0),
    )
    plan = rounded(disc, 0.5)
    assert plan.objective == pytest.approx(2 * math.sqrt(3) + math.pi / 3, rel=1e-5)
    assert plan.extra == {"turns": 1, "corners": 0, "least_radius": 1.0}
    wide = rounded(disc, 1.5)
    assert_sound(disc, wide)
    assert check(curves.bezier_pieces(wide.path), build_region(disc.workspace)).clearance < 1e-4


@given(st.integers(0, 10_000), st.sampled_from([0.2, 1.0, 4.0]))
def test_random_circles(seed, turning_radius):
    rng = np.random.default_rng(seed)
    centres, radii = rng.uniform(-9, 9, (12, 2)), rng.uniform(0.3, 2.5, 12)
    start, target = (-9.5, -9.5), (9.5, 9.5)
    problem = Problem("", Circles((-10.0, 10.0, -10.0, 10.0), centres, radii, "m"), start, target)
    plan = rounded(problem, turning_radius)
    if plan.path is None:
        assert plan.objective == shortest_path(problem).length == math.inf
    else:
        assert_sound(problem, plan)


def test_path_ends_at_the_target_to_the_last_bit():
    """In this world the last leg, begun at its first point, misses the target by a bit."""
    rng = np.random.default_rng(869)
    problem = Problem(
        "",
        Circles((-10.0, 10.0, -10.0, 10.0), rng.uniform(-9, 9, (9, 2)), np.full(9, 1.5), "m"),
        (0.0, 0.0),
        (4.0, 6.0),
    )
    assert_sound(problem, rounded(problem, 0.4))


GAP = [".......", "...#...", "...#...", ".......", "...#...", "...#...", "......."]


@pytest.mark.parametrize("turning_radius", [0.0, 0.14, 1.0])
def test_a_robot_as_wide_as_a_gap_in_which_it_turns(turning_radius):
    """The round corners of the grown map touch there, and none can be wider."""
    grid = from_lines(GAP, 1.0, "cell")
    wide = robot.grow(grid, 0.5)
    problem = Problem("gap", wide, (0.5, 6.5), (6.5, 0.5))
    plan = rounded(problem, turning_radius)
    assert check(curves.bezier_pieces(plan.path), build_region(wide)).feasible
    assert plan.objective == pytest.approx(shortest_path(problem).length, rel=1e-4)
