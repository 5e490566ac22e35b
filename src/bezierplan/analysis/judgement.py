"""The judgement of exact geometry on one path, and its description in lines."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.analysis.measures import CURVATURE_SAMPLES
from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import build_region
from bezierplan.planners import Plan, load_planner, read_settings
from bezierplan.running import planning
from bezierplan.running.answer import restore_path
from bezierplan.workspaces import robot
from bezierplan.workspaces.grown import find_growth
from bezierplan.workspaces.problem import Path, Problem

if TYPE_CHECKING:
    from bezierplan.analysis.results import Results

OF_PLANNERS = {"claimed_feasible": bool, "objective": float, "evaluations": int, "stop": str}
"""Fields that are the planner's own, beside the history, and their types."""


def compute_judgement(
    problem: Problem, shortest: shortest_paths.Bound, path: Path | None
) -> dict[str, Any]:
    """Judge a path with exact geometry and return the fields of `api.Judgement`; without a path,
    those of the problem alone.

    shortest: the exact shortest path.
    """
    grown = find_growth(problem.workspace)
    fields: dict[str, Any] = {
        "problem": problem,
        "robot_radius": grown.radius if grown else 0.0,
        "shortest": shortest.length,
        "shortest_points": shortest.points,
    }
    if path is None:
        return fields
    pieces = curves.bezier_pieces(path)
    certified = checker.check(pieces, build_region(problem.workspace))
    # Obstacles are grown by the robot's radius; its distance is to the original ones.
    at_home = checker.check(pieces, build_region(grown.original)) if grown else certified
    jump = curves.curvature_jump(path)
    if certified.feasible:
        assert at_home.clearance >= fields["robot_radius"] - robot.TOLERANCE
    else:
        fields["collision"] = tuple(curves.point_at(path, certified.collision_at).tolist())
    # At least 20 samples on each piece, however many there are.
    kappa, _ = curves.curvature(path, max(CURVATURE_SAMPLES, 20 * len(pieces) + 1))
    return fields | {
        "path": path,
        "length": curves.length(path),
        "feasible": certified.feasible,
        "depth": certified.depth,
        "clearance": at_home.clearance,
        "curvature": float(np.nan_to_num(np.abs(kappa)).max()),
        "curvature_jump": jump,
        "corners": not math.isfinite(jump),
    }


def list_planner_fields(plan: Plan) -> dict[str, Any]:
    """List the fields of `api.Answer` that are the planner's own, with their values."""
    own = {field: getattr(plan, field) for field in (*OF_PLANNERS, "history")}
    return own | {"turning_radius": plan.extra.get("least_radius", math.nan)}


def judge_run(results: Results, name: str) -> dict[str, Any]:
    """Read one run from its results, by its name, and return the fields of `api.Answer`."""
    row, (study, _, _, method, _) = results.runs.iloc[0], name.split("/")
    problem = results.problems[row["problem"]]
    return compute_judgement(
        problem,
        shortest_paths.shortest_path(problem),
        restore_path(row["path_curve"], row["path_points"]),
    ) | {
        "turning_radius": float(row.get("least_radius", math.nan)),
        "method": f"{study}/{method}",
        "settings": {each: row[each] for each in read_settings(load_planner(row["planner"]))},
        "history": np.array(row["history"], dtype=float),
        **{field: kind(row[field]) for field, kind in OF_PLANNERS.items()},
    }


def describe_answer(answer: Any) -> dict[str, str]:
    """Describe an `api.Judgement` or an `api.Answer`: a mapping from the name of each line to its
    text, in the order in which they are printed.
    """
    unit, words = answer.problem.workspace.unit, {}
    if method := getattr(answer, "method", ""):
        settings = ", ".join(f"{name} {value}" for name, value in answer.settings.items())
        words = {"planner": method, "settings": settings or "none"}
    if answer.robot_radius:
        words["robot radius"] = f"{answer.robot_radius:g} {unit}"
    words["shortest path"] = f"{answer.shortest:.6g} {unit}"
    if answer.path is None:
        words["path"] = f"none ({answer.stop})"
    else:
        words |= _describe_path(answer, unit)
    if not math.isnan(seconds := getattr(answer, "cpu_s", math.nan)):
        words["CPU time"] = f"{seconds:.3g} s"
    return words


def write_html(answer: Any) -> str:
    """Write the lines of `describe_answer` as a table of HTML."""
    lined = describe_answer(answer).items()
    return f"<table>{''.join(f'<tr><th>{name}<td>{escape(text)}' for name, text in lined)}</table>"


def _describe_path(answer: Any, unit: str) -> dict[str, str]:
    """Describe the path of an answer: a mapping from the name of each line to its text. unit: of
    the workspace.
    """
    corners = ", and corners" if answer.corners else ""
    words = {
        "length": f"{answer.length:.6g} {unit}",
        "curvature": f"at most {_format_number(answer.curvature, 6)} / {unit} at samples{corners}",
    }
    radius = getattr(answer, "turning_radius", math.nan)
    if not math.isnan(radius):
        asked = answer.settings.get("turning_radius", math.inf)
        kept = math.isinf(asked) or planning.is_radius_kept(asked, radius)
        less = "" if kept else f"; no room for {asked:.6g} {unit}"
        words["turning radius"] = f"{radius:.6g} {unit}{less}"
    words["clearance"] = f"{_format_number(answer.clearance, 6)} {unit}"
    if answer.feasible:
        # A free path may be shorter than the shortest by the checker's tolerance: that is 0 %.
        words["length"] += (
            f", {_format_number(100 * max(answer.gap, 0.0), 3)} % above the shortest path"
        )
        words["feasible"] = "yes"
    else:
        x, y = answer.collision
        what = "comes too close to" if answer.clearance > 0 else "enters"
        deep = f"at most {answer.depth:.6g} {unit} deep"
        words["feasible"] = f"no: {what} an obstacle at {x:.6g},{y:.6g}, {deep}"
    return words


def _format_number(value: float, digits: int) -> str:
    """Format a number with some significant digits. Below the tolerance of free paths digits mean
    nothing, so it is 0.
    """
    return f"{value:.{digits}g}" if abs(value) > robot.TOLERANCE else "0"
