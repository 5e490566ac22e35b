"""One path on a map: `python -m bezierplan plan MAP --start X,Y --target X,Y`."""

import re
import tempfile
import time
from argparse import Action, ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path as File
from types import ModuleType
from typing import Any

import numpy as np

from bezierplan.analysis.measures import CURVATURE_SAMPLES
from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import region
from bezierplan.places import TREE
from bezierplan.planners import Plan, known_planners, planner_module
from bezierplan.running import answer, interface, problems, watchdog
from bezierplan.running.columns import TAKEN
from bezierplan.running.loans import lend
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault, closest
from bezierplan.schema.model import is_line
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Path, Problem, Workspace
from bezierplan.workspaces.text_file import is_count, number

KINDS = {".geojson": "polygons", ".json": "polygons", ".yaml": "ros_map", ".yml": "ros_map", ".map": "moving_ai", ".txt": "grid"}
"""Suffix of a map file -> the kind of workspace that it is read as."""

OUT = (".svg", ".png", ".csv", ".geojson")

APPLIES = {
    "scenario": ("moving_ai",),
    "cell": ("grid", "raster"),
    "rule": ("raster",),
    "robot_radius": ("ros_map",),
    "most_pixels": ("ros_map",),
}
"""Options that count for some kinds of workspace only: with others they would do nothing."""
_KIND_NAMES = {
    "grid": "cells of a text",
    "moving_ai": "a MovingAI grid",
    "polygons": "polygons",
    "raster": "polygons for a planner that needs cells",
    "ros_map": "a ROS map",
}

# Cells along the longer side of a map of polygons, for planners that need cells, and the baseline's turning radius as a share of that side.
_CELLS = 200
_TURNING_SHARE = 0.02

_SAMPLES = 2001

MANUAL = """
Plans one path on a map and checks it by exact geometry. Prints its length, how far that lies above the exact shortest path, its largest
curvature and clearance, whether it is free of obstacles and if not where it enters one, and the CPU time of the planner.

maps:
  .geojson   polygons: features with properties.role border (a rectangle) and obstacle; planners that need cells get --cell and --rule
  .yaml      an occupancy map of ROS's map_server, beside its image; unknown pixels count as occupied, --robot-radius makes obstacles grow
  .map       a MovingAI grid; --scenario FILE:NUMBER in place of --start and --target
  .txt       cells of . (free) and # (occupied), the top row first, of the side --cell

planners:
  Without --planner it is the exact shortest path with rounded corners. A planner takes its settings from the first study of this project
  that has it, or from --like STUDY/METHOD; --settings changes some of them. `python -m bezierplan list` names studies and methods.
"""

EXAMPLES = """
examples:
  The exact shortest path through a maze, its corners rounded to a radius of 0.3 m, as a picture:
    python -m bezierplan plan config/studies/elhoseny2017/workspaces/gaps.geojson --start 2,10 --target 18,10 \\
        --settings '{turning_radius: 0.3}' --out path.svg

  The same way by the genetic algorithm of song2016, on cells of 0.5 m, as points:
    python -m bezierplan plan config/studies/elhoseny2017/workspaces/gaps.geojson --start 2,10 --target 18,10 \\
        --like song2016/smooth --cell 0.5 --out path.csv
"""


class _Once(Action):
    """Stores a value; of an option that is given twice, argparse would drop the first without a word."""

    def __call__(self, parser: ArgumentParser, namespace: Namespace, values: Any, option_string: str | None = None) -> None:
        """Raises Fault for an option that was given before."""
        seen = vars(namespace).setdefault("seen", set())
        if self.dest in seen:
            raise Fault(f"{option_string}: given twice; expected once")
        seen.add(self.dest)
        setattr(namespace, self.dest, values)


def _joined(words: list[str]) -> list[str]:
    """Words of a command line, in which coordinates that begin with a minus belong to their option: argparse takes them for another one."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in ("--start", "--target") and re.match(r"-[0-9.]", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Plan, print, and write the requested files. Raises ValueError for wrong input."""
    parser.register("action", None, _Once)
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.description, parser.epilog = MANUAL.strip(), EXAMPLES.strip()
    parser.add_argument("map", type=File, metavar="MAP", help="a map file")
    parser.add_argument("--start", metavar="X,Y", help="where the path begins, in the map's unit")
    parser.add_argument("--target", metavar="X,Y", help="where it ends")
    parser.add_argument("--scenario", metavar="FILE:NUMBER", help="start and target of a MovingAI scenario, numbered from 1")
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument("--planner", metavar="NAME", help="a planner, or the path of a planner's file (default: rounded_shortest_path)")
    chosen.add_argument("--like", metavar="STUDY/METHOD", help="planner and settings of a study's method")
    parser.add_argument("--settings", default="{}", metavar="'{NAME: VALUE, ...}'", help="settings in place of the planner's own")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of the random numbers (default: 0)")
    parser.add_argument("--cell", type=float, metavar="SIDE", help=f"side of a cell (default: 1; of polygons the longer side / {_CELLS})")
    parser.add_argument("--rule", choices=("overlap", "centre"), help="which cells obstacles occupy (default: overlap)")
    parser.add_argument("--robot-radius", type=float, metavar="R", help="by how much the obstacles of a ROS map grow")
    parser.add_argument("--most-pixels", type=int, metavar="N", help="the most pixels of a ROS map's image")
    parser.add_argument("--unit", metavar="NAME", help="the unit of length that is printed (default: m, of grids cell)")
    parser.add_argument(
        "--out", type=File, metavar="FILE", help="the path as a picture (.svg, .png), as points (.csv), or as a .geojson line"
    )
    _plan(parser.parse_args(_joined(words)))


def _plan(given: Namespace) -> None:
    if given.out:
        _check_out(given.out)
    if given.unit is not None and not is_line(given.unit):
        raise Fault(f"--unit: {given.unit!r}; expected a name of one line")
    if given.seed < 0:
        raise Fault(f"--seed: {given.seed}; expected a whole number of at least 0")
    if given.scenario and (given.start or given.target):
        raise Fault(f"--scenario: {given.scenario}: has a start and a target of its own; expected no --start and no --target beside it")
    planner, settings = _planner(given)
    problem = _problem(given, planner)
    bound = shortest_paths.shortest_path(problem)
    if not np.isfinite(bound.length):
        raise Fault(f"--target: {given.target or given.scenario}: no free way leads there from the start; expected one that can be reached")
    if planner == "rounded_shortest_path":
        x_low, x_high, y_low, y_high = problem.workspace.bounds
        settings = {"turning_radius": _TURNING_SHARE * max(x_high - x_low, y_high - y_low), "offset": 0.0} | settings
    interface.check_settings(planner_module(planner), settings, "--settings")
    module = planner_module(planner)
    if hasattr(module, "serves"):
        interface.asked(module.serves, f"--planner: {planner}", problem)
    for _ in range(2):  # the first run also loads compiled code, so only the second is timed
        plan, seconds = _answer(module, problem, planner, settings, given.seed)
    _, check = answer.verdict(plan.path, region(problem.workspace))
    if check.feasible and curves.length(plan.path) < shortest_paths.least_length(bound):
        raise Fault(
            f"--planner: {planner}: its path is {curves.length(plan.path):.12g} long and feasible, but no free path is shorter than"
            f" {bound.length:.12g}: the checker or the bound is wrong"
        )
    for name, text in _told(problem, planner, settings, plan, check, bound.length, seconds):
        print(f"{name:14}{text}")
    if given.out and plan.path is None:
        raise Fault(f"--out: {given.out}: not written, {planner} found no path")
    if given.out:
        try:
            _write(given.out, problem, plan.path, check, bound.points)
        except OSError as error:  # such as a disk that is full by now
            raise _unwritable(given.out, error) from None


def _check_out(out: File) -> None:
    """Raise Fault unless a file can be written: before planning, which may take long."""
    if out.suffix.lower() not in OUT:
        raise Fault(f"--out: {out}; expected a file that ends in {', '.join(OUT)}")
    if not out.parent.is_dir():
        raise Fault(f"--out: {out}: no folder {out.parent}; expected one that exists")
    try:
        if out.exists():
            out.open("ab").close()
        else:
            tempfile.TemporaryFile(dir=out.parent).close()
    except OSError as error:
        raise _unwritable(out, error) from None


def _unwritable(out: File, error: OSError) -> Fault:
    return Fault(f"--out: {out}: cannot be written ({error.strerror or type(error).__name__})")


def _answer(module: ModuleType, problem: Problem, planner: str, settings: dict[str, Any], seed: int) -> tuple[Plan, float]:
    """A planner's answer, through the door of all answers, and its CPU seconds. Raises Fault, in one line, however the planner fails."""
    loan = lend({problem.name: problem})[problem.name]
    try:
        with watchdog.watching(None) as watch, watchdog.executing(f"--planner: {planner}", watch):
            begin = time.process_time()
            given = module.plan(loan.problem, np.random.default_rng(seed), **settings)
            seconds = time.process_time() - begin
        plan = answer.accepted(given, problem, {*TAKEN, *settings})
    except answer.Unfit as fault:
        raise Fault(f"--planner: {planner}: its answer: {fault}") from None
    except watchdog.PlannerFailure as failure:
        raise Fault(str(failure)) from None
    if fault := loan.thorough_fault():
        raise Fault(f"--planner: {planner}: {fault}")
    return plan, seconds


def _told(
    problem: Problem, planner: str, settings: dict[str, Any], plan: Plan, check: checker.Check, shortest: float, seconds: float
) -> list[tuple[str, str]]:
    """The names and values to print."""
    unit = problem.workspace.unit
    lines = [("planner", planner), ("settings", ", ".join(f"{name} {value}" for name, value in settings.items()) or "none")]
    lines.append(("shortest path", f"{shortest:.6g} {unit}"))
    if plan.path is None:
        return [*lines, ("path", f"none ({plan.stop})"), ("CPU time", f"{seconds:.3g} s")]
    length = curves.length(plan.path)
    lines.append(
        ("length", f"{length:.6g} {unit}, {_told_number(100 * (length / shortest - 1) if shortest else 0.0, 3)} % above the shortest path")
    )
    kappa, _ = curves.curvature(plan.path, max(CURVATURE_SAMPLES, 20 * len(curves.bezier_pieces(plan.path)) + 1))
    corners = "" if np.isfinite(curves.curvature_jump(plan.path)) else ", and corners"
    lines.append(("curvature", f"at most {_told_number(np.nan_to_num(np.abs(kappa)).max(), 6)} / {unit}{corners}"))
    lines.append(("clearance", f"{_told_number(check.clearance, 6)} {unit}"))
    if check.feasible:
        lines.append(("feasible", "yes"))
    else:
        x, y = curves.point_at(plan.path, check.collision_at)
        lines.append(("feasible", f"no: enters an obstacle at {x:.6g},{y:.6g}, at most {check.depth:.6g} {unit} deep"))
    return [*lines, ("CPU time", f"{seconds:.3g} s")]


def _told_number(value: float, digits: int) -> str:
    """A number with some digits; 0 if it is within the checker's tolerance, where it says nothing."""
    return f"{value:.{digits}g}" if abs(value) > checker.TOLERANCE else "0"


def _planner(given: Namespace) -> tuple[str, dict[str, Any]]:
    """The planner and its settings, as far as they are known without the map."""
    own = checked.parse(given.settings, "--settings")
    if not isinstance(own, dict):
        raise Fault(f"--settings: {given.settings}: expected '{{name: value, ...}}'")
    if given.like:
        planner, preset = _like(given.like)
    else:
        planner = given.planner or "rounded_shortest_path"
        if not planner.endswith(".py") and planner not in known_planners():
            raise Fault(f"--planner: {planner}: unknown{closest(planner, known_planners())}")
        interface.loaded(planner, f"--planner: {planner}")
        preset = {} if planner == "rounded_shortest_path" or planner.endswith(".py") else _preset(planner)
    interface.refuse_unknown(planner_module(planner), own, "--settings")
    return planner, preset | own


def _like(name: str) -> tuple[str, dict[str, Any]]:
    """Planner and settings of a method of a study."""
    from bezierplan.study import reading

    key, _, method = name.rpartition("/")
    if not key:
        raise Fault(f"--like: {name}; expected STUDY/METHOD, such as song2016/smooth")
    (study,) = reading.load(reading.read_config({"studies": [key]})).values()
    if method not in study.methods:
        raise Fault(f"--like: {name}: the study has no method {method}{closest(method, study.methods)}")
    return study.planner(method), study.resolved(method)


def _preset(planner: str) -> dict[str, Any]:
    """A planner's settings in the first study of this project that uses it as a method."""
    from bezierplan.study import reading

    # Away from the project's folder no configuration is found.
    named = {} if File("config/config.yaml").is_file() else checked.read(TREE / "config" / "config.yaml")
    for study in reading.load(reading.read_config(named)).values():
        for method in study.methods:
            if study.planner(method) == planner:
                return study.resolved(method)
    return {}


def _problem(given: Namespace, planner: str) -> Problem:
    """The map with start and target; as a grid if the planner needs cells."""
    kind = KINDS.get(given.map.suffix.lower())
    if not kind:
        raise Fault(f"{given.map}: unknown kind of map; expected a file that ends in {', '.join(KINDS)}")
    _check_numbers(given)
    served = getattr(planner_module(planner), "workspaces", None)
    described = {"kind": kind, "file": given.map.name, "unit": given.unit or ("m" if kind in ("polygons", "ros_map") else "cell")}
    drawn = kind == "polygons" and served is not None and kind not in served
    _check_options(given, "raster" if drawn else kind)
    if drawn:
        x_low, x_high, y_low, y_high = _load(described, given.map).bounds
        cell = max(x_high - x_low, y_high - y_low) / _CELLS if given.cell is None else given.cell
        described |= {"kind": "raster", "cell": cell, "rule": given.rule or "overlap"}
    elif kind == "grid":
        described["cell"] = 1.0 if given.cell is None else given.cell
    elif kind == "ros_map":
        options = {name: getattr(given, name) for name in ("robot_radius", "most_pixels")}
        described |= {name: value for name, value in options.items() if value is not None}
    workspace = _load(described, given.map)
    met = "polygons" if described["kind"] == "polygons" else "grid"
    if served is not None and met not in served:
        raise Fault(f"--planner: {planner}: serves workspaces of kind {', '.join(served)}, and a map is {met}")
    if given.scenario:
        return problems.build("", _scenario(given, described, workspace), workspace)
    ends = {end: _point(end, getattr(given, end)) for end in ("start", "target")}
    return problems.build("", ends, workspace)


def _check_numbers(given: Namespace) -> None:
    """Raise Fault for a number that is none of a side, a radius or a count of pixels."""
    if given.cell is not None and not 0 < given.cell < np.inf:
        raise Fault(f"--cell: {given.cell:g}; expected a number above 0")
    if given.robot_radius is not None and not 0 <= given.robot_radius < np.inf:
        raise Fault(f"--robot-radius: {given.robot_radius:g}; expected a number of at least 0")
    if given.most_pixels is not None and given.most_pixels < 1:
        raise Fault(f"--most-pixels: {given.most_pixels}; expected a whole number of at least 1")


def _check_options(given: Namespace, kind: str) -> None:
    """Raise Fault for an option that would do nothing on a map of a kind."""
    for name, kinds in APPLIES.items():
        if getattr(given, name) is not None and kind not in kinds:
            wanted = " or ".join(_KIND_NAMES[each] for each in kinds)
            raise Fault(f"--{name.replace('_', '-')}: only for {wanted}; {given.map} is {_KIND_NAMES[kind]}")


def _load(described: dict[str, Any], map_file: File) -> Workspace:
    """The workspace of a map. Raises Fault, beginning with the map as it was given."""
    try:
        return files.load(described, map_file.parent)
    except ValueError as error:
        told = str(error).removeprefix("file: ").removeprefix(f"{described['file']}: ")
        raise Fault(f"{map_file}: {told}") from None


def _scenario(given: Namespace, described: dict, workspace: Workspace) -> dict:
    """Start and target of a scenario, as a problem describes them."""
    file, _, number = given.scenario.rpartition(":")
    if not (file and is_count(number)):
        raise Fault(f"--scenario: {given.scenario}; expected FILE:NUMBER of a .scen file, numbered from 1")
    return problems.scenario(described | {"scenarios": str(File(file).resolve())}, int(number), workspace, given.map.parent)


def _point(end: str, text: str | None) -> tuple[float, float]:
    try:
        x, y = (number(word.strip()) for word in (text or "").split(","))
    except ValueError:
        raise Fault(f"--{end}: {text or 'missing'}; expected X,Y, two numbers such as 2.5,10") from None
    return x, y


def _write(out: File, problem: Problem, path: Path, check: checker.Check, shortest: np.ndarray) -> None:
    """The path as a picture, as points with their curvature, or as a GeoJSON line."""
    samples = curves.sample_matrix(path.curve, len(path.points), _SAMPLES) @ path.points
    if out.suffix.lower() == ".csv":
        kappa, _ = curves.curvature(path, _SAMPLES)
        rows = np.column_stack([samples, np.nan_to_num(kappa)])
        np.savetxt(out, rows, fmt="%.9g", delimiter=",", header="x,y,curvature", comments="")
    elif out.suffix.lower() == ".geojson":
        import json

        line = {"type": "LineString", "coordinates": samples.tolist()}
        out.write_text(json.dumps({"type": "Feature", "properties": {"feasible": check.feasible}, "geometry": line}) + "\n")
    else:
        _draw(out, problem, path, check, shortest)


def _draw(out: File, problem: Problem, path: Path, check: checker.Check, shortest: np.ndarray) -> None:
    """Draw a figure in the style of the studies: the path, the exact shortest path, and the first collision, if any."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from bezierplan.figures import style
    from bezierplan.figures.panels import paths, workspace

    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(style.NARROW, style.NARROW), layout="constrained")
        axes = figure.add_subplot()
        workspace.shade(axes, workspace.parts(problem.workspace))
        workspace.scale(axes, problem.workspace.unit)
        drawn = {"path": paths.steps(path), "bound": shortest, "start": [problem.start], "target": [problem.target]}
        if not check.feasible:
            drawn["collision"] = [curves.point_at(path, check.collision_at)]
        paths.draw_parts(axes, paths.table(drawn), narrow=False, clip=True)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        figure.savefig(out, dpi=300)
