"""More of this never gives less of that: what a radius, a robot, an obstacle, or another place of
the map changes on the shortest path and on the rounded one, over random maps of each kind.
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from test_exact_properties import mapped

from bezierplan.geometry.shortest_paths import shortest_path
from bezierplan.planners import rounded_shortest_path
from bezierplan.workspaces import robot
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem

KINDS = ("cells", "circles", "polygons")
SIDE = 12.0
ENDS = ((0.5, 0.5), (11.5, 11.5))
RADII = (0.1, 0.3, 0.7, 1.5, 2.5, 4.0, 8.0)
# One rung of the ladder of radii, and what lengths may differ by.
RUNG, LENGTH = 1.0201, 1e-3


def random_map(kind, seed, obstacles):
    """Some obstacles of a map; of a larger number, the first are the same."""
    rng = np.random.default_rng(seed)
    if kind == "cells":
        occupied = np.zeros((12, 12), dtype=bool)
        for row, column in rng.integers(0, 12, (obstacles, 2)):
            occupied[row, column] = 0 < row + column < 22
        return Grid(occupied, 1.0, "m")
    drawn = rng.uniform(size=(obstacles, 9))
    centres = 1.5 + 9 * drawn[:, :2]
    if kind == "circles":
        return Circles((0.0, SIDE, 0.0, SIDE), centres, 0.2 + drawn[:, 2], "m")
    angles = np.sort(math.tau * drawn[:, 3:7], axis=1)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=2)
    rings = centres[:, None] + (0.4 + drawn[:, 2, None, None]) * around
    return Polygons((0.0, SIDE, 0.0, SIDE), tuple((ring,) for ring in rings), "m")


def problems(kind, count=12):
    """Random problems that have a way, each with a further obstacle as well."""
    few = 30 if kind == "cells" else 9
    for seed in range(count):
        one, more = (
            Problem("", random_map(kind, seed, few + k), *map(tuple, ENDS)) for k in (0, 1)
        )
        if shortest_path(one).length < math.inf:
            yield one, more


def rounded(problem, turning_radius=math.inf, excess=math.inf):
    return rounded_shortest_path.plan(problem, None, turning_radius=turning_radius, excess=excess)


def kept(plan, asked):
    return min(plan.extra["least_radius"], asked)


def corners(problem):
    """What the shortest path turns around, one after the other."""
    bound = shortest_path(problem)
    if math.isinf(bound.length):
        return None
    turns = rounded_shortest_path.find_turns(bound.points, problem.workspace)
    return np.column_stack([turns.corner, turns.side]).round(6).tolist()


@pytest.mark.parametrize("kind", KINDS)
def test_a_larger_radius_is_kept_as_far_as_a_smaller_one_and_no_path_is_shorter_for_it(kind):
    for problem, _ in problems(kind):
        plans = [(asked, rounded(problem, asked)) for asked in RADII]
        plans.sort(key=lambda plan: kept(plan[1], plan[0]))
        for (few, tight), (many, wide) in pairwise(plans):
            assert wide.objective >= tight.objective * (1 - LENGTH)
            assert few < many or kept(tight, few) * RUNG >= kept(wide, many)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("change", ["obstacle", "robot"])
def test_less_room_gives_no_wider_turn_and_no_shorter_path(kind, change):
    """Turns are compared as long as the path keeps its way: another one may have more room."""
    same_way = 0
    for problem, narrower in problems(kind):
        if change == "robot":
            try:
                grown = robot.choose_suitable(robot.grow(problem.workspace, 0.15), None)
            except ValueError:
                continue
            narrower = problem._replace(workspace=grown)
        assert shortest_path(narrower).length >= shortest_path(problem).length * (1 - 1e-12)
        if corners(narrower) != corners(problem):
            continue
        same_way += 1
        for asked in RADII:
            plan, less = rounded(problem, asked), rounded(narrower, asked)
            assert kept(less, asked) <= RUNG * kept(plan, asked)
            if kept(less, asked) == kept(plan, asked):
                assert less.objective >= plan.objective * (1 - LENGTH)
    assert same_way


def moved(workspace, by, scale):
    """The same map at another place and in another unit."""
    low = np.repeat(by, 2)
    bounds = tuple(low + scale * np.array(workspace.bounds))
    if isinstance(workspace, Grid):
        return Grid(workspace.occupied, scale * workspace.cell, "m", tuple(by))
    if isinstance(workspace, Circles):
        return Circles(bounds, by + scale * workspace.centres, scale * workspace.radii, "m")
    rings = tuple(tuple(by + scale * ring for ring in rings) for rings in workspace.obstacles)
    return Polygons(bounds, rings, "m")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("by", "scale"), [((16.0, -32.0), 1.0), ((0.0, 0.0), 1.02**35)])
def test_a_map_elsewhere_or_in_another_unit_has_the_same_path(kind, by, scale):
    """The ladder of radii has the same rungs if the unit changes by a power of its step."""
    for problem, _ in problems(kind, 6):
        ends = [tuple(by + scale * np.array(end)) for end in ENDS]
        other = Problem("", moved(problem.workspace, np.array(by), scale), *ends)
        for settings in ({"excess": 0.01}, {"turning_radius": 1.5}):
            plan = rounded(problem, **settings)
            if "turning_radius" in settings:
                settings = {"turning_radius": scale * settings["turning_radius"]}
            again = rounded(other, **settings)
            assert again.objective == pytest.approx(scale * plan.objective, rel=1e-6)
            assert again.extra["least_radius"] == pytest.approx(
                scale * plan.extra["least_radius"], rel=1e-6
            )


@pytest.mark.parametrize("kind", KINDS)
def test_a_transposed_map_has_the_transposed_path(kind):
    for problem, _ in problems(kind, 6):
        other = mapped(problem.workspace, "diagonal")
        plan, again = (
            rounded(each, excess=0.01) for each in (problem, problem._replace(workspace=other))
        )
        assert again.objective == pytest.approx(plan.objective, rel=1e-6)
        assert again.extra["least_radius"] == pytest.approx(plan.extra["least_radius"], rel=1e-6)


@pytest.mark.parametrize("kind", KINDS[1:])
def test_wider_margins_take_nothing_away(kind):
    """Without a radius the path knows neither the margins nor the size of the map."""
    for problem, _ in problems(kind, 6):
        wide = replace(problem.workspace, bounds=(-30.0, 40.0, -20.0, 50.0))
        plan, wider = (
            rounded(each, excess=0.01) for each in (problem, problem._replace(workspace=wide))
        )
        assert shortest_path(problem._replace(workspace=wide)).length <= (
            shortest_path(problem).length * (1 + 1e-12)
        )
        if corners(problem) == corners(problem._replace(workspace=wide)):
            assert wider.extra["least_radius"] * RUNG >= plan.extra["least_radius"]
