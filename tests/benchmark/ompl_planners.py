"""Planners of OMPL on our problems, with OMPL's defaults and its path simplifier.

States are points and motions are straight. A motion is valid if the certified checker's own search
for a collision finds none on it, so OMPL needs no resolution and its paths are as exact as ours. A
test is a call from C++ into Python, which runs a compiled kernel.
"""

import math
import time
from collections.abc import Callable, Iterator

import numpy as np
from numba import njit
from ompl import base, geometric, util

from bezierplan.geometry.checker import find_first_collision
from bezierplan.geometry.region import Region, from_origin
from bezierplan.workspaces.problem import Problem

PLANNERS = {
    "PRM*": geometric.PRMstar,
    "BIT*": geometric.BITstar,
    "Informed RRT*": geometric.InformedRRTstar,
}

SegmentTest = Callable[[float, float, float, float], bool]

# OMPL is not asked for less, in seconds: it would do nothing but start and stop.
_SHORTEST_SLICE = 5e-4


def start(seed: int) -> None:
    """Seed OMPL's random numbers, once a process and before anything else of OMPL is used, and
    silence its log.
    """
    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(seed)


def segment_test(blocked: Region) -> SegmentTest:
    """A test whether the segment from (x, y) to (end_x, end_y), in units, stays out of a blocked
    region.

    It is compiled anew for each region, whose numbers become constants: with the region as an
    argument it would take half as long again.
    """
    shift_x, shift_y = from_origin(np.zeros(2), blocked)

    @njit
    def is_free(x, y, end_x, end_y):
        piece = np.array([[[x + shift_x, y + shift_y], [end_x + shift_x, end_y + shift_y]]])
        return find_first_collision(piece, blocked)[0] == math.inf

    is_free(0.0, 0.0, 0.0, 0.0)
    return is_free


class Motions(base.MotionValidator):
    """The test of straight motions as OMPL calls it."""

    def __init__(self, information: base.SpaceInformation, is_free: SegmentTest) -> None:
        super().__init__(information)
        self.is_free = is_free

    def checkMotion(self, begin: base.State, end: base.State) -> bool:
        return self.is_free(begin[0], begin[1], end[0], end[1])


def attempts(
    planner: str, problem: Problem, is_free: SegmentTest, times: np.ndarray
) -> Iterator[tuple[float, np.ndarray | None]]:
    """Paths of one run: polylines (n, 2) in units, or None, each with the CPU seconds that a run
    with that budget takes.

    planner: a key of `PLANNERS`. is_free: the `segment_test` of the problem's region. times: (t,)
    CPU seconds, ascending, after each of which the search is interrupted and gives its path as it
    is, then simplified; None if it has none yet. Simplified paths are copies, of which nothing goes
    back into the search. A user simplifies once, at the end: so a simplification is no part of
    later paths' times.
    """
    begin = time.process_time()
    space = base.RealVectorStateSpace(2)
    information = _information(space, problem, is_free)
    objective = base.PathLengthOptimizationObjective(information)
    definition = base.ProblemDefinition(information)
    definition.setStartAndGoalStates(_state(space, problem.start), _state(space, problem.target))
    definition.setOptimizationObjective(objective)
    search = PLANNERS[planner](information)
    search.setProblemDefinition(definition)
    search.setup()
    simplifier = geometric.PathSimplifier(information, definition.getGoal(), objective)
    searched = time.process_time() - begin

    for until in times:
        while searched < until:
            before = time.process_time()
            # PRM* asks its condition in a second thread, which would wait for ever for Python's
            # lock; so this one, in wall time, is OMPL's.
            search.solve(
                base.timedPlannerTerminationCondition(max(until - searched, _SHORTEST_SLICE))
            )
            searched += time.process_time() - before
        if not definition.hasExactSolution():
            yield searched, None
            continue
        path = definition.getSolutionPath()
        yield searched, _points(path)
        before = time.process_time()
        simplified = geometric.PathGeometric(path)
        simplifier.simplifyMax(simplified)
        yield searched + time.process_time() - before, _points(simplified)


def _information(
    space: base.StateSpace,
    problem: Problem,
    is_free: SegmentTest,
) -> base.SpaceInformation:
    """A space within the bounds of a map, with a test of motions, which is that of states as
    well.
    """
    space.setBounds(_bounds(problem))
    information = base.SpaceInformation(space)
    motions = Motions(information, is_free)
    information.setMotionValidator(motions)
    information.setStateValidityChecker(lambda state: motions.checkMotion(state, state))
    information.setup()
    return information


def _bounds(problem: Problem) -> base.RealVectorBounds:
    bounds = base.RealVectorBounds(2)
    x_low, x_high, y_low, y_high = problem.workspace.bounds
    for axis, (low, high) in enumerate(((x_low, x_high), (y_low, y_high))):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    return bounds


def _state(space: base.RealVectorStateSpace, point: tuple[float, float]) -> base.State:
    state = space.allocState()
    state[0], state[1] = point
    return state


def _points(path: geometric.PathGeometric) -> np.ndarray:
    return np.array([[state[0], state[1]] for state in path.getStates()])
