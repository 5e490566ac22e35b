"""Robots in worlds that change: motion, the exact check between steps, policies, and what no robot
can beat.
"""

import itertools
import math
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.geometry.region import build_region
from bezierplan.planners import Plan, rounded_shortest_path, shortest_path
from bezierplan.running.simulation import bounds, cells, evasion, motion_check
from bezierplan.running.simulation.circles import (
    ARRIVED,
    BLOCKED,
    DUE,
    ENDED,
    STOPPED,
    follow,
    is_near,
)
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.policy import Policy
from bezierplan.running.simulation.robot import drive
from bezierplan.running.simulation.ways import (
    build_drivable,
    build_polyline,
    build_way,
    find_first_collision,
)
from bezierplan.schema import checked
from bezierplan.workspaces import worlds
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.worlds import ChangingCells, MovingCircles

DATA = checked.read(File(__file__).parent / "data" / "drives.yaml")
EVENTS = {"arrived": ARRIVED, "blocked": BLOCKED, "due": DUE, "stopped": STOPPED, "ended": ENDED}
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


@pytest.mark.parametrize("seed", range(12))
def test_a_motion_is_judged_as_at_many_moments(seed):
    """Of a robot that sometimes stands, among circles that meet walls."""
    rng = np.random.default_rng(seed)
    centres, speeds = rng.uniform(5, 15, (3, 2)), rng.uniform(-4, 4, (3, 2))
    world = circles(*np.column_stack([centres, rng.uniform(0.3, 1.5, 3), speeds]))
    first = 1.0 + seed % 3 / 3
    times = np.sort(np.append(rng.uniform(first, 7, 6), [first, 3.0, 3.0, 7.0]))
    points = np.clip(10 + np.cumsum(rng.normal(size=(10, 2)), axis=0), 0, 20)
    # A vertex may stand twice, at one time or at two.
    twice = np.searchsorted(times, 3.0)
    points[[twice + 1, -1]] = points[[twice, -2]]
    verdict = motion_check.check(Motion(points, times), world)
    moments = np.linspace(first, 7, 6001)
    robot = np.column_stack([np.interp(moments, times, points[:, axis]) for axis in range(2)])
    steps = np.minimum(np.floor(moments).astype(int), 6)
    there = np.array([world.at(step) for step in range(9)])
    part = (moments - steps)[:, None, None]
    places = there[steps] + part * (there[steps + 1] - there[steps])
    apart = (np.linalg.norm(robot[:, None] - places, axis=-1) - world.radii).min(axis=1)
    least = [apart[steps == step].min() for step in range(int(first), 7)]
    assert verdict.clearance == pytest.approx(least, abs=0.02)
    if min(least) > 0:
        assert math.isnan(verdict.collision_at)
    else:
        assert verdict.collision_at == pytest.approx(moments[apart < 0][0], abs=0.002)
        assert verdict.depth == pytest.approx(-min(least), abs=0.02)


def test_cells_collide_only_while_they_are_occupied():
    maps = draw_maps(["....", "....", "...."], ["....", ".##.", "...."])
    world = ChangingCells(maps, np.array([2.0]), 1.0, 9)
    line = np.array([[0.5, 1.5], [3.5, 1.5]])
    early, late = (Motion(line, np.array(times)) for times in ([0.0, 2.0], [1.5, 3.0]))
    assert not collides(early, world)
    # At the change it stands at x = 1.5, in a cell that becomes occupied.
    assert motion_check.check(late, world).collision_at == pytest.approx(2.0)
    # It turns within a step, and enters a cell after a third more of a step.
    bend = Motion(np.array([[0.5, 0.5], [0.5, 1.5], [3.5, 1.5]]), np.array([2.2, 2.4, 4.4]))
    assert motion_check.check(bend, world).collision_at == pytest.approx(2.4 + 1 / 3)
    assert motion_check.check(bend, world).clearance == pytest.approx([0, 0, 0], abs=1e-6)
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
    """Least distance of each circle's centre to a drive between two lengths of way."""
    lengths = np.concatenate([[begin], at[(at > begin) & (at < end)], [end]])
    places = np.column_stack([np.interp(lengths, at, points[:, axis]) for axis in range(2)])
    relative = places - centres[:, None] - drift[:, None] * ((lengths - begin) / pace)[:, None]
    return shapely.distance(shapely.linestrings(relative), shapely.Point(0.0, 0.0))


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


@pytest.mark.parametrize(("circle", "changed", "event", "progress"), DATA["followed"])
def test_a_robot_follows_its_way_until_there_is_something_to_decide(
    circle, changed, event, progress
):
    """Ten steps, from the third on, for a way of 20."""
    world = circles(DATA["circles"][circle], end=13)
    policy = Policy.model_validate({"replan": "when_blocked", "waits": False} | changed)
    way = build_way(np.array([(0.0, 10.0), (20.0, 10.0)]))
    found, _, lengths = follow(world, way, 3, policy)
    assert (found, lengths.tolist()) == (EVENTS[event], progress)


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
    wall = from_lines(["...", ".##"], 1.0, "m")
    bend = np.array([[1.5, 0.5], [2.5, 0.5], [2.5, 1.5]])
    assert cells.find_way_out(wall, build_way(bend)) == pytest.approx(1.5)
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


@pytest.mark.parametrize(("replan", "pace", "plans", "arrival", "waited"), DATA["at a gate"])
def test_a_robot_stands_before_a_gate_until_it_opens(replan, pace, plans, arrival, waited):
    """Of 7 to its target the robot drives 2.5 before: the gate begins 1 farther."""
    world, problem = gate(5.5, "....#...", "........")
    policy = Policy(replan=replan, every=2, brake=1.0)
    ride = drive(replace(world, pace=pace), problem, policy, straight)
    assert (ride.arrived, ride.waited, ride.motion.times[-1]) == pytest.approx((1, waited, arrival))
    assert [plan.time for plan in ride.plans] == plans
    lengths = [plan.length for plan in ride.plans]
    assert lengths == pytest.approx([7.5 - ride.motion.at(time)[0] for time in plans])
    late = drive(replace(world, pace=pace, end=6), problem, policy, straight)
    assert (late.arrived, late.motion.times[-1]) == (False, 6.0)
    assert late.motion.at(6.0)[0] == pytest.approx(3.0 + 0.5 * pace)


@pytest.mark.parametrize(("replan", "every", "time", "event"), DATA["events"])
def test_the_next_event_is_a_change_a_plan_or_the_end(replan, every, time, event):
    world = ChangingCells(draw_maps(["."], ["."], ["."]), np.array([2.0, 5.5]), 1.0, 9)
    assert cells.find_next_event(world, time, Policy(replan=replan, every=every)) == event


@pytest.mark.parametrize(("begin", "blocked"), [(0, 2.5), (1, 2.5), (3.5, 5.5), (6.5, math.inf)])
def test_a_way_is_blocked_where_it_next_enters_a_cell(begin, blocked):
    grid = from_lines([".....", "....#", ".....", "...#."], 1.0, "m")
    way = build_way(np.array([(0.5, 0.5), (4.5, 0.5), (4.5, 3.5)]))
    assert cells.find_blocked_length(grid, way, begin) == pytest.approx(blocked)


def test_a_way_leaves_out_points_that_repeat_the_last_one():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    assert [each.tolist() for each in build_way(points)] == [points[[0, 1, 3]].tolist(), [0, 1, 2]]


@pytest.mark.parametrize(("curve", "spacing", "count"), DATA["chords"])
def test_chords_of_a_curve_are_as_long_as_their_spacing(curve, spacing, count):
    """Of legs of 10 in all; two chords of each piece at least."""
    points = np.array([[0.0, 10.0], [5.0, 10.0], [5.0, 7.0], [7.0, 7.0]])
    found = build_polyline(Path(curve, points), spacing)
    assert len(found) == count
    assert found[[0, -1]].tolist() == points[[0, -1]].tolist()


def test_only_curves_get_further_points_where_chords_enter_an_obstacle():
    """A quarter of a circle around one that it touches; a polyline is driven as it is."""
    k = 10 + 2 * 4 / 3 * math.tan(math.pi / 8)
    arc = Path("bezier", np.array([[12.0, 10.0], [12.0, k], [k, 12.0], [10.0, 12.0]]))
    bare = build_region(circles((10, 10, 1.999, 0, 0)).obstacles(0))
    found = build_drivable(arc, 0.5, bare)
    assert len(found) > len(build_polyline(arc, 0.5))
    assert math.isinf(find_first_collision(found, bare))
    straight_through = Path("polyline", arc.points[[0, 3]])
    assert build_drivable(straight_through, 0.5, bare) is straight_through.points


# Stepping aside

FORESEES = REPLANS.but(knows="velocities")


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("sees", ["before", "after"])
@pytest.mark.parametrize("knows", ["positions", "velocities"])
def test_a_refuge_is_at_the_end_of_the_best_step(seed, sees, knows):
    """Of all directions, lengths and moments."""
    rng = np.random.default_rng(seed)
    robot = rng.uniform((0, 4), (4, 16))
    centres, speeds = robot + rng.normal(scale=3, size=(3, 2)), rng.uniform(-1, 1, (3, 2))
    world = circles(*np.column_stack([centres, [0.5, 1.0, 1.5], speeds]), pace=0.8)
    policy = FORESEES.but(sees=sees, knows=knows, check_margin=0.3)
    looked = 4 + (sees == "after")
    drift = (world.at(looked + 1) - world.at(looked)) * (knows == "velocities")
    begin = world.at(looked) - drift * (sees == "after")
    moments = np.linspace(0, 20, 4001)
    best, place = (-math.inf, 0.0, 0.0), robot
    for k, steps in itertools.product(range(-1, 32), (1, 2, 4, 8)):
        turn = math.pi * k / 16
        move = 0.8 * steps * (k >= 0) * np.array([math.cos(turn), math.sin(turn)])
        move = (np.clip(robot + move, 0, 20) - robot) / steps
        drive = np.minimum(moments, steps)[:, None] * move
        relative = (robot + drive)[:, None] - begin - moments[:, None, None] * drift
        apart = (np.linalg.norm(relative, axis=-1) - world.radii).min(axis=1)
        met = moments[apart < 0.3 - 1e-9]
        free = min(met, default=20.0)
        rank = min(apart[moments <= 1].min(), 0.0), free, apart[200]
        if rank > best:
            best, place = rank, robot + move
        if k < 0 and rank[:2] == (0.0, 20.0):
            break
    assert evasion.find_refuge(world, robot, 4, policy) == pytest.approx(place)


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


@pytest.mark.parametrize(("beyond", "outside"), [(1e-4, True), (2e-9, True), (0.0, False)])
def test_a_robot_that_leaves_the_field_by_little_collides(beyond, outside):
    points = np.array([[1.0, 10.0], [20.0 + beyond, 10.0], [1.0, 10.0]])
    verdict = motion_check.check(Motion(points, np.array([0.0, 19.0, 38.0])), circles())
    assert math.isfinite(verdict.collision_at) == outside


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
