"""Way points: a problem becomes one from each to the next, and their answers become one path."""

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from bezierplan.geometry import checker, curves, shortest_paths, transitions
from bezierplan.geometry.curvature_bound import largest_curvature
from bezierplan.geometry.region import Region, region
from bezierplan.planners import Plan, dubins_search, rounded_shortest_path
from bezierplan.planners.parts.settings import filled
from bezierplan.running import problems
from bezierplan.running.problems import Placed, Regions
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.frames import Frame
from bezierplan.workspaces.grown import original
from bezierplan.workspaces.limits import SMALLEST_FEATURE
from bezierplan.workspaces.problem import Path, Problem, Workspace

ROUNDED, DRIVEN = "rounded_shortest_path", "dubins_search"
TURNING = (ROUNDED, DRIVEN)
"""Planners of this package that keep a turning radius: they get the exact shortest path and the
region, which are known already.
"""
HEADINGS = ("start_heading", "target_heading")
"""Settings that are directions in the world."""
CHAINED = (*TURNING, "shortest_path")
"""Planners whose paths can be joined: chains of pieces."""

SHARE = 0.02
"""The turning radius without a wish, as a share of the longer side of the map itself."""

# Two directions that differ by less, in radians, are no corner.
_STRAIGHT = 1e-8

# A radius that is smaller by less, as a share, is the same.
_SAME = 1e-9

# Headings at a way point, relative to that of the shortest path from there, which are tried where
# the one in which the robot arrives leads nowhere.
_BESIDE = tuple(share * math.pi / 4 for share in (0, 1, -1, 2, -2))

# An offset is kept up to this share.
_OFF_CIRCLE = 1e-3

SMOOTH = ("arcs", "continuous")
"""Whether a path turns along arcs, or with a curvature that changes continuously."""

# A jump of the curvature by less, as a share of the largest one, is rounding.
_NO_JUMP = 1e-6


def default(settings: Collection[str]) -> str:
    """The planner without a wish, which has these settings."""
    return DRIVEN if set(HEADINGS) & set(settings) else ROUNDED


def check_planner(
    planner: str,
    name: str,
    via: Sequence[tuple[float, float]],
    strict: bool,
    smooth: str = SMOOTH[0],
) -> None:
    """Raise ValueError for way points, a strict turning radius or continuous curvature with a
    planner that does not have them.

    planner: its name in this package, empty for another one; name: how it is told.
    """
    if via and planner not in CHAINED:
        raise ValueError(
            f"via: only for {', '.join(CHAINED[:-1])} and {CHAINED[-1]}; the planner is {name}"
        )
    if smooth not in SMOOTH:
        raise ValueError(f"smooth: {smooth!r}; expected {' or '.join(SMOOTH)}")
    if smooth == "continuous" and planner not in TURNING:
        raise ValueError(
            f"smooth: only for {' and '.join(TURNING)}, "
            f"whose paths have arcs; the planner is {name}"
        )
    if strict and planner not in TURNING:
        raise ValueError(
            f"strict: only for {' and '.join(TURNING)}, "
            f"which have a turning radius; the planner is {name}"
        )


def preset(planner: str, workspace: Workspace) -> dict[str, Any]:
    """Settings of a planner with a turning radius where none are given, the same for a map that has
    grown by a robot's radius.
    """
    x_low, x_high, y_low, y_high = original(workspace).bounds
    radius = {"turning_radius": SHARE * max(x_high - x_low, y_high - y_low)}
    return radius | ({"offset": 0.0} if planner == ROUNDED else dict.fromkeys(HEADINGS))


def inward(settings: Mapping[str, Any], frame: Frame) -> dict[str, Any]:
    """Settings in the frame of a map."""
    headings = {
        name: frame.inward_heading(settings[name])
        for name in HEADINGS
        if settings.get(name) is not None
    }
    return {**settings, **headings}


def legs(
    problem: Placed, via: Sequence[tuple[float, float]], regions: Regions = region
) -> list[Problem]:
    """The problems from start to the first way point, and so on to the target, in the map's frame.

    via: in the world. Raises ValueError for a way point that is not free.
    """
    near = problem.near
    places = [near.start]
    for point in via:
        try:
            way_point = problems.build(
                "", {"start": point, "target": point}, near.workspace, regions, problem.frame
            ).start
        except ValueError as error:
            raise ValueError(f"via{str(error).removeprefix('start')}") from None
        if way_point == places[-1]:
            raise ValueError(f"via: {point}: the same place as the one before; expected another")
        places.append(way_point)
    if via and places[-1] == near.target:
        raise ValueError(f"via: {via[-1]}: the same place as the target; expected another")
    ends = [*places, near.target]
    return [near._replace(start=start, target=target) for start, target in pairwise(ends)]


def shortest(parts: Sequence[Problem], blocked: Region) -> list[shortest_paths.Bound]:
    """The exact shortest path of each leg. blocked: the region of their map."""
    return [shortest_paths.shortest_path(part, blocked=blocked) for part in parts]


def whole(bounds: Sequence[shortest_paths.Bound]) -> shortest_paths.Bound:
    """The exact shortest path through all legs."""
    return shortest_paths.Bound(
        sum(bound.length for bound in bounds), np.concatenate([bound.points for bound in bounds])
    )


def solved(
    planner: str,
    parts: Sequence[Problem],
    bounds: Sequence[shortest_paths.Bound],
    blocked: Region,
    settings: dict[str, Any],
    smooth: str = SMOOTH[0],
) -> Plan:
    """The answer of a planner with a turning radius to all legs. With an offset, it has an extra
    column more: least_offset, how much of it is kept.
    """
    plan = _solved(planner, parts, bounds, blocked, settings, smooth)
    if planner == ROUNDED and plan.path is not None and settings["offset"] > 0:
        kept = _least_offset(plan.path, parts, bounds)
        plan = plan._replace(extra=plan.extra | {"least_offset": kept})
    return plan


def _least_offset(
    path: Path, parts: Sequence[Problem], bounds: Sequence[shortest_paths.Bound]
) -> float:
    """Least distance of a path from what the shortest path turns around; infinite without turns."""
    turns = [
        rounded_shortest_path.turns_of(bound.points, part.workspace)
        for part, bound in zip(parts, bounds)
    ]
    centres = np.concatenate([each.corner for each in turns])
    if not len(centres):
        return math.inf
    radii = np.concatenate([each.radius for each in turns])
    x_low, x_high, y_low, y_high = parts[0].workspace.bounds
    margin = 2 * (x_high - x_low + y_high - y_low)  # no path is as close to the border of this
    around = (x_low - margin, x_high + margin, y_low - margin, y_high + margin)
    verdict = checker.check(
        curves.bezier_pieces(path), region(Circles(around, centres=centres, radii=radii, unit=""))
    )
    return verdict.clearance


def _solved(
    planner: str,
    parts: Sequence[Problem],
    bounds: Sequence[shortest_paths.Bound],
    blocked: Region,
    settings: dict[str, Any],
    smooth: str,
) -> Plan:
    """The same, without this column. If rounding leaves a corner at a way point, legs are searched.

    With `continuous` curvature, transitions go before and after arcs wherever there is room. They
    shift arcs inwards, so these are planned wider and as much farther from the corners.
    """
    if smooth == "continuous":
        radius = settings["turning_radius"] * (1 + transitions.SHIFT) * (1 + transitions.EXCESS)
        wide = settings | {"turning_radius": radius}
        if planner == ROUNDED:
            wide["offset"] = settings["offset"] + transitions.SHIFT * radius
        arcs = _solved(planner, parts, bounds, blocked, wide, SMOOTH[0])
        return _eased(planner, arcs, parts, blocked)
    if planner == DRIVEN:
        return joined(_driven(parts, bounds, blocked, settings))
    rounded = joined(
        [
            rounded_shortest_path.gentlest(part, None, bound, blocked, **settings)
            for part, bound in zip(parts, bounds)
        ]
    )
    radius = settings["turning_radius"]
    if (
        len(parts) == 1
        or rounded.path is None
        or radius < SMALLEST_FEATURE
        or keeps_radius(radius, rounded.extra["least_radius"])
    ):
        return rounded
    driven = joined(
        _driven(
            parts, bounds, blocked, preset(DRIVEN, parts[0].workspace) | {"turning_radius": radius}
        )
    )
    if driven.path is None:
        return rounded
    return driven._replace(
        extra={"turns": rounded.extra["turns"], "tight_turns": 0, "least_radius": radius}
    )


def _eased(planner: str, plan: Plan, parts: Sequence[Problem], blocked: Region) -> Plan:
    """The same path with transitions, and what is told of it."""
    if plan.path is None:
        return plan
    path = transitions.eased(plan.path, blocked, [part.start for part in parts[1:]])
    length, extra = curves.length(path), plan.extra
    if planner == ROUNDED and 0 < extra["least_radius"] < math.inf:
        extra = extra | {"least_radius": 1 / largest_curvature(curves.bezier_pieces(path)).bound}
    return plan._replace(path=path, objective=length, history=np.array([length]), extra=extra)


def _driven(
    parts: Sequence[Problem],
    bounds: Sequence[shortest_paths.Bound],
    blocked: Region,
    settings: dict[str, Any],
) -> list[Plan]:
    """A search on each leg, which begins with the heading in which the one before ends; up to the
    first one that finds nothing.

    The leg before may end where there is no way on, as in front of a wall. Then it is searched
    again with other headings at its end: that of the shortest path from there, and beside it.
    """

    def leg(number: int, start: float | None, end: float | None) -> Plan:
        ends = {"start_heading": start, "target_heading": end}
        given = filled(dubins_search.Settings, settings | ends)
        return dubins_search.searched(parts[number], given, bounds[number], blocked)

    answers: list[Plan] = []
    starts = [settings["start_heading"]]  # of each leg
    for number, bound in enumerate(bounds):
        last = settings["target_heading"] if number == len(parts) - 1 else None
        answer = leg(number, starts[number], last)
        if answer.path is None and answers:
            x, y = (bound.points[1] - bound.points[0]).tolist()
            for beside in _BESIDE:
                towards = math.remainder(math.atan2(y, x) + beside, math.tau)
                other = leg(number - 1, starts[number - 1], towards)
                onward = leg(number, towards, last) if other.path else other
                if onward.path:
                    answers[-1], starts[number], answer = other, towards, onward
                    break
        answers.append(answer)
        if answer.path is None:
            break
        along = np.diff(answer.path.points[-2:], axis=0)[0]
        starts.append(math.atan2(along[1], along[0]))
    return answers


def kept(planner: str, plan: Plan, settings: dict[str, Any]) -> float:
    """Radius of a path's tightest turn; nan without a path, and of planners without a radius."""
    if planner == ROUNDED:
        return plan.extra["least_radius"]
    return settings["turning_radius"] if planner == DRIVEN and plan.path is not None else math.nan


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


def is_continuous(jump: float, curvature: float) -> bool:
    """Whether a largest jump of the curvature is none, beside the largest curvature."""
    return jump <= _NO_JUMP * curvature


def check_continuous(smooth: str, jump: float, curvature: float, unit: str) -> None:
    """Raise ValueError if the curvature should be continuous and jumps. jump, curvature: the
    largest of the path, nan without one.
    """
    if smooth == "continuous" and not is_continuous(jump, curvature):
        raise ValueError(
            f"smooth: continuous: the curvature jumps by {jump:.3g} / {unit}, no room; expected "
            "room, or not strict"
        )


def keeps_radius(asked: float, kept: float) -> bool:
    """Whether a turning radius is kept."""
    return kept >= asked * (1 - _SAME)


def keeps_offset(asked: float, kept: float) -> bool:
    """Whether an offset is kept; arcs are cubic pieces, which lie a little off their circles."""
    return kept >= asked * (1 - _OFF_CIRCLE)


def check_offset(asked: float | None, kept: float, unit: str) -> None:
    """Raise ValueError if a path does not keep the offset asked for. kept: nan where none was."""
    if asked and not math.isnan(kept) and not keeps_offset(asked, kept):
        raise ValueError(
            f"offset: {asked:g} {unit} asked, {kept:.6g} {unit} kept; expected one that can be "
            "kept, or not strict"
        )


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
