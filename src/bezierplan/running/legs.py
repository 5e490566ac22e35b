"""Way points: a problem becomes one problem from each to the next, and their answers become one path."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.region import Region
from bezierplan.planners import Plan
from bezierplan.running import problems
from bezierplan.running.problems import Regions, near_region
from bezierplan.workspaces import shifted
from bezierplan.workspaces.problem import Path, Problem

ROUNDED = "rounded_shortest_path"
CHAINED = (ROUNDED, "shortest_path")
"""Planners whose paths can be joined: chains of pieces."""

# Two directions that differ by less, in radians, are no corner.
_STRAIGHT = 1e-9


def check_planner(planner: str, via: Sequence[tuple[float, float]], strict: bool) -> None:
    """Raise ValueError for way points or a strict turning radius with a planner that does not have them."""
    own = planner.removeprefix("bezierplan.planners.")
    if via and own not in CHAINED:
        raise ValueError(f"via: only for {' and '.join(CHAINED)}; the planner is {own}")
    if strict and own != ROUNDED:
        raise ValueError(f"strict: only for {ROUNDED}, which has a turning radius; the planner is {own}")


def legs(problem: Problem, via: Sequence[tuple[float, float]], regions: Regions = near_region) -> list[Problem]:
    """The problems from start to the first way point, and so on to the target, on the map where it is computed with.

    Raises ValueError for a way point that is not free.
    """
    places = [problem.start]
    for point in via:
        try:
            placed = problems.build("", {"start": point, "target": point}, problem.workspace, regions).start
        except ValueError as error:
            raise ValueError(f"via{str(error).removeprefix('start')}") from None
        if placed == places[-1]:
            raise ValueError(f"via: {point}: the same place as the one before; expected another")
        places.append(placed)
    if via and places[-1] == problem.target:
        raise ValueError(f"via: {via[-1]}: the same place as the target; expected another")
    near = shifted.near_problem(problem)
    shift = shifted.shift_of(problem.workspace)
    ends = [shifted.lowered(place, shift) for place in (*places, problem.target)]
    return [near._replace(start=start, target=target) for start, target in pairwise(ends)]


def shortest(parts: Sequence[Problem], blocked: Region) -> list[shortest_paths.Bound]:
    """The exact shortest path of each leg. blocked: the region of their map."""
    return [shortest_paths.shortest_path(part, blocked=blocked) for part in parts]


def whole(bounds: Sequence[shortest_paths.Bound]) -> shortest_paths.Bound:
    """The exact shortest path through all legs."""
    return shortest_paths.Bound(sum(bound.length for bound in bounds), np.concatenate([bound.points for bound in bounds]))


def joined(answers: Sequence[Plan]) -> Plan:
    """One answer to all legs. At a way point where the direction changes, a corner is left, which counts as a turn."""
    if len(answers) == 1:
        return answers[0]
    paths = [answer.path for answer in answers]
    lost = next((answer for answer in answers if answer.path is None), None)
    if lost:
        return lost
    corners = sum(_has_corner(one, other) for one, other in pairwise(paths))
    extra = answers[0].extra
    if "least_radius" in extra:
        extra = {name: sum(answer.extra[name] for answer in answers) + corners for name in ("turns", "tight_turns")}
        extra["least_radius"] = 0.0 if corners else min(answer.extra["least_radius"] for answer in answers)
    objective = sum(answer.objective for answer in answers)
    return answers[0]._replace(
        path=Path(paths[0].curve, np.concatenate([paths[0].points, *(path.points[1:] for path in paths[1:])])),
        objective=objective,
        claimed_feasible=all(answer.claimed_feasible for answer in answers),
        evaluations=sum(answer.evaluations for answer in answers),
        history=np.array([objective]),
        extra=extra,
    )


def _has_corner(one: Path, other: Path) -> bool:
    """Whether the direction of travel changes between two chains."""
    arriving, leaving = np.diff(one.points[-2:], axis=0)[0], np.diff(other.points[:2], axis=0)[0]
    cross = arriving[0] * leaving[1] - arriving[1] * leaving[0]
    return abs(math.atan2(cross, float(arriving @ leaving))) > _STRAIGHT


def check_kept(asked: float, kept: float, unit: str) -> None:
    """Raise ValueError if the tightest turn of a path is tighter than asked."""
    if kept < asked * (1 - 1e-9):
        raise ValueError(f"turning_radius: {asked:g} {unit} asked, {kept:.6g} {unit} kept; expected one that can be kept, or not strict")
