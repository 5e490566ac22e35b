"""Way points: a problem becomes one from each to the next, and their answers become one path."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.region import Region, region
from bezierplan.planners import Plan
from bezierplan.running import problems
from bezierplan.running.problems import Regions
from bezierplan.workspaces.grown import original
from bezierplan.workspaces.problem import Path, Problem, Workspace

ROUNDED = "rounded_shortest_path"
"""The planner without a wish, and the one with a turning radius."""

CHAINED = (ROUNDED, "shortest_path")
"""Planners whose paths can be joined: chains of pieces."""

SHARE = 0.02
"""The turning radius without a wish, as a share of the longer side of the map itself."""

# Two directions that differ by less, in radians, are no corner.
_STRAIGHT = 1e-8

# A radius that is smaller by less, as a share, is the same.
_SAME = 1e-9


def check_planner(
    planner: str, name: str, via: Sequence[tuple[float, float]], strict: bool
) -> None:
    """Raise ValueError for way points or a strict turning radius with a planner that does not have
    them.

    planner: its name in this package, empty for another one; name: how messages call it.
    """
    if via and planner not in CHAINED:
        raise ValueError(f"via: only for {' and '.join(CHAINED)}; the planner is {name}")
    if strict and planner != ROUNDED:
        raise ValueError(
            f"strict: only for {ROUNDED}, which has a turning radius; the planner is {name}"
        )


def preset(workspace: Workspace) -> dict[str, Any]:
    """Settings of the planner with a turning radius where none are given, the same for a map that
    has grown by a robot's radius.
    """
    x_low, x_high, y_low, y_high = original(workspace).bounds
    return {"turning_radius": SHARE * max(x_high - x_low, y_high - y_low), "offset": 0.0}


def legs(
    problem: Problem, via: Sequence[tuple[float, float]], regions: Regions = region
) -> list[Problem]:
    """The problems from start to the first way point, and so on to the target.

    Raises ValueError for a way point that is not free.
    """
    places = [problem.start]
    for point in via:
        try:
            way_point = problems.build(
                "", {"start": point, "target": point}, problem.workspace, regions
            ).start
        except ValueError as error:
            raise ValueError(f"via{str(error).removeprefix('start')}") from None
        if way_point == places[-1]:
            raise ValueError(f"via: {point}: the same place as the one before; expected another")
        places.append(way_point)
    if via and places[-1] == problem.target:
        raise ValueError(f"via: {via[-1]}: the same place as the target; expected another")
    ends = [*places, problem.target]
    return [problem._replace(start=start, target=target) for start, target in pairwise(ends)]


def shortest(parts: Sequence[Problem], blocked: Region) -> list[shortest_paths.Bound]:
    """The exact shortest path of each leg. blocked: the region of their map."""
    return [shortest_paths.shortest_path(part, blocked=blocked) for part in parts]


def whole(bounds: Sequence[shortest_paths.Bound]) -> shortest_paths.Bound:
    """The exact shortest path through all legs."""
    return shortest_paths.Bound(
        sum(bound.length for bound in bounds), np.concatenate([bound.points for bound in bounds])
    )


def kept(planner: str, plan: Plan) -> float:
    """Radius of a path's tightest turn; nan without a path, and of planners without a radius."""
    return plan.extra["least_radius"] if planner == ROUNDED else math.nan


def joined(answers: Sequence[Plan]) -> Plan:
    """One answer to all legs. A corner that is left at a way point counts as a turn."""
    if len(answers) == 1:
        return answers[0]
    paths = [answer.path for answer in answers]
    lost = next((answer for answer in answers if answer.path is None), None)
    if lost:
        return lost
    corners = sum(_has_corner(one, other) for one, other in pairwise(paths))
    extra = {name: sum(answer.extra[name] for answer in answers) for name in answers[0].extra}
    if "least_radius" in extra:
        extra["least_radius"] = (
            0.0 if corners else min(answer.extra["least_radius"] for answer in answers)
        )
        extra |= {name: extra[name] + corners for name in ("turns", "tight_turns")}
    objective = sum(answer.objective for answer in answers)
    return answers[0]._replace(
        path=Path(
            paths[0].curve,
            np.concatenate([paths[0].points, *(path.points[1:] for path in paths[1:])]),
        ),
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


def keeps_radius(asked: float, kept: float) -> bool:
    """Whether a turning radius is kept."""
    return kept >= asked * (1 - _SAME)


def check_kept(asked: float, kept: float, unit: str) -> None:
    """Raise ValueError if a path's tightest turn is tighter than asked, or there is no path."""
    if math.isnan(kept):
        raise ValueError(
            f"turning_radius: {asked:g} {unit} asked: no path was found; expected one that can be "
            "kept, or not strict"
        )
    if not keeps_radius(asked, kept):
        raise ValueError(
            f"turning_radius: {asked:g} {unit} asked, {kept:.6g} {unit} kept; expected one that "
            "can be kept, or not strict"
        )
