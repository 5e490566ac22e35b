"""Robots in worlds that change: motion, the exact check between steps, policies, and what no robot
can beat.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.planners import Plan, rounded_shortest_path, shortest_path
from bezierplan.running.simulation import bounds, cells, evasion, motion_check
from bezierplan.running.simulation.circles import ARRIVED, STOPPED, is_near
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.robot import drive
from bezierplan.running.simulation.ways import build_way
from bezierplan.workspaces import worlds
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles

BLIND = Policy(replan="never", waits=False)
WAITS = BLIND.but(waits=True, sees="after", brake=1.0)
REPLANS = WAITS.but(replan="when_blocked", check_margin=0.2, plan_margins=(0.5, 0.0))


def circles(*rows, pace=1.0, end=100):
    """A field of 20 x 20 with circles (x, y, radius, x velocity, y velocity)."""
    table = np.array(rows, dtype=float).reshape(-1, 5)
    square = (0.0, 20.0, 0.0, 20.0)
    centres, radii, velocities = table[:, :2], table[:, 2], table[:, 3:]
    return MovingCircles(square, square, centres, velocities, radii, "circles", pace, end, "m")


def collides(motion, world):
    return not math.isnan(motion_check.check(motion, world).collision_at)


def draw_maps(*drawn):
    """Maps of cells of 1 m, each drawn in lines."""
    return tuple(from_lines(lines, 1.0, "m") for lines in drawn)


def across(world, start=(0.0, 10.0), target=(20.0, 10.0)):
    return Problem("across", world.workspace(0), start, target)


def go_through(*points):
    """A plan through some points."""
    return Plan.of_one(Path("polyline", np.array(points)), 1.0, "exact")


def straight(problem, state):
    """A planner that always goes straight."""
    return go_through(problem.start, problem.target), state


def round_about(problem, state):
    """A planner that goes straight or, where a circle is in the way, through one of two points
    beside it.
    """
    for middle in (10.0, 16.0, 4.0):
        between = (problem.start[0] + problem.target[0]) / 2, middle
        plan, home = go_through(problem.start, between, problem.target), problem.workspace
        bare = circles(*((x, y, r, 0, 0) for (x, y), r in zip(home.centres, home.radii)))
        if not collides(Motion(plan.path.points, np.array([0.0, 0.5, 1.0])), bare):
            return plan, state
    return Plan.of_one(None, math.inf, "none"), state


# Worlds


@given(st.floats(0, 10), st.floats(-3, 3), st.integers(0, 200))
def test_a_circle_is_where_step_by_step_reflection_takes_it(x, velocity, steps):
    position, speed = x, velocity
    for _ in range(steps):
        position += speed
        while not 0 <= position <= 10:
            position, speed = (-position, -speed) if position < 0 else (20 - position, -speed)
    walls = np.array([0.0, 10.0, 0.0, 10.0])
    ((there, up),) = worlds.positions(
        np.array([[x, 5.0]]), np.array([[velocity, 0.0]]), walls, steps
    )
    assert there == pytest.approx(position, abs=1e-9)
    assert up == 5.0


# The exact check


@pytest.mark.parametrize(("excess", "hits"), [(-1e-6, True), (1e-6, False)])
@pytest.mark.parametrize("at", [3.25, 3.5, 3.9])
def test_grazing_collisions_between_steps_are_found(excess, hits, at):
    """The robot drives to the right, and the circle to the left and upwards; they are closest at a
    time between two steps.
    """
    velocity, circle = np.array([1.0, 0.0]), np.array([-0.5, 0.8])
    relative = velocity - circle
    normal = np.array([-relative[1], relative[0]]) / np.hypot(*relative)
    robot = np.array([5.0, 10.0])
    meeting = robot + at * velocity + (1.0 + excess) * normal
    world = circles((*(meeting - at * circle), 1.0, *circle))
    points = robot + np.array([[0.0], [7.0]]) * velocity
    verdict = motion_check.check(Motion(points, np.array([0.0, 7.0])), world)
    assert math.isnan(verdict.collision_at) != hits
    assert verdict.clearance[3] == pytest.approx(excess, abs=1e-9)
    if hits:
        # Where the quadratic first falls to the radius: half a chord before the closest approach.
        assert verdict.collision_at == pytest.approx(
            at - math.sqrt(1 - (1 + excess) ** 2) / np.hypot(*relative), abs=1e-5
        )


def test_cells_collide_only_while_they_are_occupied():
    maps = draw_maps(["....", "....", "...."], ["....", ".##.", "...."])
    world = ChangingCells(maps, np.array([2.0]), 1.0, 9)
    line = np.array([[0.5, 1.5], [3.5, 1.5]])
    early, late = (Motion(line, np.array(times)) for times in ([0.0, 2.0], [1.5, 3.0]))
    assert not collides(early, world)
    # At the change it stands at x = 1.5, in a cell that becomes occupied.
    assert motion_check.check(late, world).collision_at == pytest.approx(2.0)
    # One cell is occupied when it comes.
    assert motion_check.check(
        Motion(line, np.array([1.8, 4.8])), world
    ).collision_at == pytest.approx(2.3)


# Policies


def test_a_blind_robot_drives_on_and_a_waiting_one_lets_the_circle_pass():
    world = circles((10, 4, 2, 0, 0.5))
    blind, waiting = (drive(world, across(world), policy, straight) for policy in (BLIND, WAITS))
    assert blind.arrived
    assert collides(blind.motion, world)
    assert (blind.waited, blind.replans) == (0.0, 0)
    assert waiting.arrived
    assert waiting.waited > 0
    assert waiting.motion.times[-1] == pytest.approx(20 + waiting.waited)
    assert waiting.replans == 0


def test_a_robot_that_plans_again_drives_round_a_circle_that_comes_into_its_way():
    world = circles((15, 5, 2, 0, 0.4))
    ride = drive(world, across(world), REPLANS, round_about)
    assert ride.arrived
    assert ride.replans >= 1
    assert not collides(ride.motion, world)
    lengths = np.hypot(*np.diff(ride.motion.points, axis=0).T)
    assert (lengths <= np.diff(ride.motion.times) + 1e-9).all()  # never faster than the pace


def test_a_robot_that_looks_ahead_ignores_a_circle_that_will_have_passed():
    # On the way at step 5, and far above it when the robot comes at step 15.
    world = circles((15, 5, 1, 0, 0.9))
    near, ahead = (
        drive(world, across(world), REPLANS.but(knows=knows), round_about)
        for knows in ("positions", "velocities")
    )
    assert (near.replans > 0, ahead.replans) == (True, 0)


def clearances(points, at, begin, end, centres, drift, pace):
    """Least distance of each circle's centre to a drive between two lengths of way, chord by
    chord.
    """
    lengths = np.concatenate([[begin], at[(at > begin) & (at < end)], [end]])
    places = np.column_stack([np.interp(lengths, at, points[:, axis]) for axis in range(2)])
    relative = places - centres[:, None] - drift[:, None] * ((lengths - begin) / pace)[:, None]
    legs = np.diff(relative, axis=1)
    size = np.maximum((legs**2).sum(axis=-1), 1e-300)
    share = np.clip(-(relative[:, :-1] * legs).sum(axis=-1) / size, 0.0, 1.0)
    return np.linalg.norm(relative[:, :-1] + share[..., None] * legs, axis=-1).min(axis=1)


@given(st.integers(0, 10**6))
def test_what_a_robot_skips_of_its_way_is_out_of_reach(seed):
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.normal(size=(rng.integers(2, 60), 2)), axis=0)
    along, pace, centres = (
        build_way(points),
        rng.uniform(0.2, 3.0),
        rng.normal(scale=8.0, size=(4, 2)),
    )
    drift = rng.normal(scale=rng.choice([0.0, 0.3, 3.0]), size=(4, 2))
    begin, end = np.sort(rng.uniform(0.0, along.length, 2))
    least = clearances(*along, begin, end, centres, drift, pace)
    margin = rng.uniform(0.0, 1.0)
    for off, near in ((1e-9, True), (-1e-9, False)):
        # A circle that just reaches the way, or just does not, among points.
        for k in range(4):
            radii = np.full(4, -margin)
            radii[k] = least[k] + off - margin
            if radii[k] + margin > 0.0:
                assert is_near(*along, begin, end, centres, drift, radii, margin, pace) == near


# A cell in the middle becomes occupied.
HIT = draw_maps(["....", "....", "...."], ["....", "..#.", "...."])


def test_a_robot_in_a_cell_that_becomes_occupied_drives_back():
    motion = Motion(np.array([[0.5, 1.5], [2.5, 1.5]]), np.array([0.0, 2.0]))
    back = cells.find_way_to_start(motion, HIT[1], "centre")
    assert back[0].tolist() == [2.5, 1.5]
    assert back[-1].tolist() == [1.5, 1.5]
    assert cells.find_way_to_start(motion, HIT[0], "centre").tolist() == [[2.5, 1.5], [2.5, 1.5]]
    # A plan may begin anywhere outside the cell.
    assert cells.find_way_to_start(motion, HIT[1], "position")[-1] == pytest.approx(
        [2.0, 1.5], abs=0.01
    )
    assert cells.find_way_to_start(motion, HIT[0], "position").tolist() == [[2.5, 1.5], [2.5, 1.5]]


def around(problem, state):
    """A planner that goes through the upper row of cells."""
    start, target = problem.start, problem.target
    return go_through(start, (start[0], 2.5), (target[0], 2.5), target), state


def change_on_the_spot():
    """A robot that drives straight is in the middle of a cell when that becomes occupied, at step
    2, after it drove without a pause.
    """
    world = ChangingCells(HIT, np.array([2.0]), 1.0, 30)
    return world, across(world, (0.5, 1.5), (3.5, 1.5))


def first_straight(problem, state):
    return (around if problem.workspace.occupied.any() else straight)(problem, state)


@pytest.mark.parametrize("start", ["centre", "position"])
@pytest.mark.parametrize("replan", ["when_blocked", "when_changed", "every_step"])
@pytest.mark.parametrize("waits", [True, False])
def test_a_robot_that_a_cell_hits_drives_back_and_arrives(replan, start, waits):
    world, problem = change_on_the_spot()
    ride = drive(world, problem, BLIND.but(replan=replan, start=start, waits=waits), first_straight)
    assert ride.arrived
    assert ride.waited == 0
    back = np.interp(2.5, ride.motion.times, ride.motion.points[:, 0])
    assert back == pytest.approx(2.0, abs=0.03)
    assert motion_check.check(ride.motion, world).collision_at == 2.0


def test_a_way_out_of_an_occupied_cell_ends_at_its_border():
    grid = from_lines(["....", "..#.", "...."], 1.0, "m")
    assert cells.find_way_out(
        grid, build_way(np.array([[2.5, 1.5], [1.5, 1.5], [0.5, 1.5]]))
    ) == pytest.approx(0.5)
    assert cells.find_way_out(grid, build_way(np.array([[0.5, 1.5], [3.5, 1.5]]))) == 0.0
    # Touching is no way out that is needed.
    assert cells.find_way_out(grid, build_way(np.array([[2.0, 1.5], [3.5, 1.5]]))) == 0.0
    assert cells.find_way_out(grid, build_way(np.array([[2.5, 1.5], [2.6, 1.6]]))) == 0.0


@pytest.mark.parametrize(
    ("replan", "replans"), [("never", 0), ("when_blocked", 0), ("when_changed", 2)]
)
def test_a_robot_plans_again_when_the_world_changes_beside_its_way(replan, replans):
    maps = draw_maps(["....", "....", "...."], ["#...", "....", "...."], ["....", "....", "...."])
    world = ChangingCells(maps, np.array([0.8, 2.0]), 1.0, 30)
    ride = drive(
        world,
        across(world, (0.5, 1.5), (3.5, 1.5)),
        BLIND.but(replan=replan, waits=True),
        straight,
    )
    assert (ride.arrived, ride.replans) == (True, replans)
    assert [plan.time for plan in ride.plans[1:]] == [0.8, 2.0][:replans]


def rounded(problem, state):
    """A planner whose curves touch what they pass."""
    return rounded_shortest_path.plan(
        problem, np.random.default_rng(0), turning_radius=1.0, excess=math.inf
    ), state


@pytest.mark.parametrize("replan", ["never", "when_blocked", "every_step"])
@pytest.mark.parametrize(
    "planner", [rounded, lambda problem, state: (shortest_path.plan(problem, None), state)]
)
def test_a_robot_drives_along_a_plan_that_touches_a_circle(planner, replan):
    world = circles((10, 10.3, 2, 0, 0))
    ride = drive(world, across(world), WAITS.but(replan=replan), planner)
    assert (ride.arrived, ride.waited) == (True, 0.0)
    assert not collides(ride.motion, world)


@pytest.mark.parametrize("replan", ["never", "when_blocked"])
def test_a_robot_drives_along_a_curve_that_touches_a_cell(replan):
    grid = from_lines([".........", ".........", "....#....", ".........", "........."], 1.0, "m")
    world = ChangingCells((grid,), np.empty(0), 1.0, 60)
    ride = drive(
        world,
        across(world, (0.5, 2.5), (8.5, 2.5)),
        BLIND.but(replan=replan, waits=True),
        rounded,
    )
    assert (ride.arrived, ride.waited) == (True, 0.0)
    assert not collides(ride.motion, world)


def test_the_least_plan_from_a_place_goes_from_centre_to_centre():
    grid = from_lines(["....", ".##.", "...."], 1.0, "m")
    motion = Motion(np.array([[0.5, 0.5], [0.5, 1.75]]), np.array([0.0, 1.25]))
    # To (0.5, 1.5), then past the corner at (1, 2), where all centres lie on one side of the
    # straight way, or through (1.5, 2.5).
    expected = 0.25 + math.dist((0.5, 1.5), (1.5, 2.5)) + math.dist((1.5, 2.5), (2.5, 2.5)) + 1.0
    assert cells.bound_plan(motion, grid, (3.5, 2.5)) == pytest.approx(expected)
    assert math.isnan(cells.bound_plan(motion, grid, (3.4, 2.5)))


# What no robot can beat


def gate(moment, *patterns):
    maps = draw_maps(*([pattern] * 3 for pattern in patterns))
    world = ChangingCells(maps, np.array([moment]), 1.0, 20)
    return world, across(world, (0.5, 1.5), (7.5, 1.5))


def test_circles_that_stand_bound_the_way_and_those_that_move_do_not():
    still, moving = circles((10, 10, 2, 0, 0)), circles((10, 10, 2, 0, 0.25))
    assert bounds.find_least_way(moving, across(moving)).length == 20.0
    assert bounds.find_least_way(still, across(still)).length > 20.0
    assert bounds.bound_arrival(circles(pace=0.5), across(moving)) == 40.0


def test_a_change_that_no_robot_can_meet_before_leaves_the_new_map_alone():
    """The wall is 3.5 away: a robot can be there by step 3.5."""
    for moment, least in [(3.4, math.inf), (3.5, math.inf), (3.6, 7.0)]:
        closes, problem = gate(moment, "........", "....#...")
        assert bounds.bound_arrival(closes, problem) == least
        assert bounds.find_least_way(closes, problem).length == 7.0
    opens, problem = gate(2.0, "....#...", "........")
    assert bounds.bound_arrival(opens, problem) == 7.0


# Stepping aside

FORESEES = REPLANS.but(knows="velocities")


def test_a_robot_steps_aside_for_a_circle_that_comes_and_stays_for_one_that_passes():
    coming = circles((10, 6.4, 2, 0, 0.5))
    place = np.array([10.0, 9.0])
    aside = evasion.find_refuge(coming, place, 0, FORESEES)
    assert math.dist(aside, place) == pytest.approx(1.0)
    assert aside[1] > 9.0
    passing = circles((10, 6.0, 2, 0.5, -0.2))
    assert np.array_equal(evasion.find_refuge(passing, place, 0, FORESEES), place)


def test_a_robot_leaves_the_way_of_a_circle_from_which_it_could_flee_for_a_while():
    chasing = circles((6, 10, 2, 0.9, 0))
    place = np.array([9.0, 10.0])
    aside = evasion.find_refuge(chasing, place, 0, FORESEES)
    assert abs(aside[1] - place[1]) > 0.3


def test_a_robot_that_evades_is_not_hit_where_one_that_waits_is():
    """No plan leads on, so both stay, and a circle comes."""
    world = circles((0.5, 3, 2, 0, 0.5), end=30)
    none = lambda problem, state: (straight(problem, state)[0]._replace(path=None), state)  # noqa: E731
    waiting, evading = (
        drive(world, across(world), REPLANS.but(evades=evades), none) for evades in (False, True)
    )
    hit = motion_check.check(waiting.motion, world)
    assert hit.collision_at > 0
    assert not collides(evading.motion, world)
    lengths = np.hypot(*np.diff(evading.motion.points, axis=0).T)
    assert lengths.max() <= 1.0 + 1e-9
    assert lengths.sum() > 0


def test_a_robot_checks_no_farther_than_its_horizon():
    world = circles((15, 10, 2, 0, 0))
    seen, unseen = (
        drive(world, across(world), REPLANS.but(horizon=horizon), straight)
        for horizon in (math.inf, 3.0)
    )
    assert seen.replans > unseen.replans


@pytest.mark.parametrize(("beyond", "outside"), [(1e-4, True), (2e-9, True), (0.0, False)])
def test_a_robot_that_leaves_the_field_by_little_collides(beyond, outside):
    points = np.array([[1.0, 10.0], [20.0 + beyond, 10.0], [1.0, 10.0]])
    verdict = motion_check.check(Motion(points, np.array([0.0, 19.0, 38.0])), circles())
    assert math.isfinite(verdict.collision_at) == outside


@pytest.mark.parametrize(
    ("dx", "dy", "ex", "ey", "nearest"),
    [
        (2.0, 1.0, -4.0, 0.0, 1.0),  # it passes by: the foot of the perpendicular
        (2.0, 1.0, 3.0, 1.0, 5.0**0.5),  # it goes away: where it is
        (5.0, 1.0, -2.0, 0.0, 10.0**0.5),  # it does not come as far: where it ends
    ],
)
def test_nearest_place_on_a_step_to_the_origin(dx, dy, ex, ey, nearest):
    assert motion_check.measure_nearest(dx, dy, ex, ey) == pytest.approx(nearest)


@pytest.mark.parametrize(("waits", "event", "end"), [(False, ARRIVED, 6.0), (True, STOPPED, 1.5)])
def test_only_a_robot_that_waits_stops_before_cells_that_a_new_way_enters(waits, event, end):
    """The way is 6 long and enters a cell after 2.5."""
    shut, other = draw_maps(["...#..."], ["...#..#"])
    world = ChangingCells((shut, other), np.array([30.0]), 1.0, 60)
    policy = Policy(replan="when_blocked", waits=waits, brake=1.0)
    found, times, progress = cells.follow(
        world, build_way(np.array([(0.5, 0.5), (6.5, 0.5)])), 0.0, policy
    )
    assert found == event
    assert (times[-1], progress[-1]) == pytest.approx((end, end))
