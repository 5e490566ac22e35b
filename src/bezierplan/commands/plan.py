"""One path on a map: `python -m bezierplan plan MAP --start X,Y --target X,Y`."""

import math
import re
import sys
import tempfile
from argparse import Action, ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path as File
from typing import Any

import numpy as np

from bezierplan import api
from bezierplan.commands import of_study, settings_in
from bezierplan.geometry import checker, samples
from bezierplan.planners import is_file, known_planners, planner_module
from bezierplan.running import interface, legs, planning, problems
from bezierplan.running.problems import Regions
from bezierplan.schema.checked import Fault, closest
from bezierplan.schema.model import is_line
from bezierplan.workspaces import map_files, robot, ros
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

PICTURES = (".svg", ".png")
OUT = (*PICTURES, ".csv", ".geojson", ".yaml", ".yml")

MANUAL = f"""
Plans one path on a map and checks it by exact geometry. Prints its length, its excess over the
exact shortest path, its largest curvature, its clearance from the map's own obstacles and border,
whether it is feasible and if not where it enters an obstacle, and the CPU time of the planner. The
exit status is 0 for a feasible path, 1 if there is or was found none that is as asked, and 2 for
wrong input.

the robot:
  --robot-radius R  every path keeps the distance R from the obstacles and the border of the map, on
                    maps of all kinds: obstacles grow by R, round at corners to a ten-thousandth of
                    R, and the shortest path is that of the robot's centre. Cells with more than
                    {robot.MOST_CORNERS:,} corners grow by whole cells
  turning radius    a setting of the default planner. Where rounding has no room for it, the radius
                    that is kept is printed next to it. With --strict such a path is refused
  --via X,Y         way points in the given order, with a corner where the path turns there

maps:
  .geojson   polygons, as GIS programs write them, in a unit of length: what
             has no properties.role is an obstacle; the border is the polygon with the role border,
             of any shape, or the file's bbox, or --margin around the obstacles; planners that need
             cells get --cell and --rule
  .yaml      an occupancy map of ROS's map_server, beside its image; unknown pixels count as
             occupied, or with --unknown free as free
  .png .pgm  an image alone, also .bmp, .jpg and .tif, with --resolution; dark pixels are occupied,
             and the lower left corner is at 0,0
  .map       a MovingAI grid
  .txt       cells of . (free) and # (occupied), the top row first, of the side --cell

planners:
  Without --planner it is the exact shortest path with rounded corners. A planner takes its settings
  from the first study of this project, by name, that has it, or from --like STUDY/METHOD;
  --settings changes some of them. `python -m bezierplan list` names studies and methods.

files:
  .svg, .png       a picture
  .csv             distance, x, y, heading and curvature at equal distances along the path, at most
                   --step apart
  .geojson         the same points as a line; .yaml  as a nav_msgs/Path message of ROS
"""

EXAMPLES = """
examples:
  The exact shortest path through a maze, its corners rounded to a radius of 0.3 m, as a picture:
    python -m bezierplan plan config/studies/elhoseny2017/workspaces/gaps.geojson \\
        --start 2,10 --target 18,10 --settings '{turning_radius: 0.3}' --out path.svg

  The same problem by the genetic algorithm of elhoseny2017, on cells of 0.5 m, as points:
    python -m bezierplan plan config/studies/elhoseny2017/workspaces/gaps.geojson \\
        --start 2,10 --target 18,10 --like elhoseny2017/mga_c --cell 0.5 --out path.csv

  The path of a robot with a radius of 0.4 m, which turns no tighter than 0.5 m, as points
  0.1 m apart:
    python -m bezierplan plan config/studies/elhoseny2017/workspaces/gaps.geojson \\
        --start 2,10 --target 18,10 --robot-radius 0.4 --settings '{turning_radius: 0.5}' \\
        --strict --step 0.1 --out robot.csv
"""


class NoPath(Fault):
    """There is no path as asked, or none was found; the input is right, so the status is 1."""


class _Once(Action):
    """Stores a value; of an option that is given twice, argparse would drop the first without a
    word.
    """

    def __call__(
        self,
        parser: ArgumentParser,
        namespace: Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        """Raises Fault for an option that was given before."""
        seen = vars(namespace).setdefault("seen", set())
        if self.dest in seen:
            raise Fault(f"{option_string}: given twice; expected once")
        seen.add(self.dest)
        setattr(namespace, self.dest, values)


def _joined(words: list[str]) -> list[str]:
    """Words of a command line, in which coordinates that begin with a minus belong to their option:
    argparse takes them for another one.
    """
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in ("--start", "--target", "--via") and re.match(r"-[0-9.]", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Plan, print, and write the requested files; without a feasible path the process ends with
    status 1. Raises ValueError for wrong input.
    """
    parser.register("action", None, _Once)
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.description, parser.epilog = MANUAL.strip(), EXAMPLES.strip()
    parser.add_argument("map", type=File, metavar="MAP", help="a map file")
    parser.add_argument(
        "--start",
        metavar="X,Y",
        help="where the path begins, in the map's unit",
    )
    parser.add_argument("--target", metavar="X,Y", help="where it ends")
    parser.add_argument(
        "--via",
        action="append",
        default=[],
        metavar="X,Y",
        help="a place to pass on the way; may be given several times",
    )
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument(
        "--planner",
        metavar="NAME",
        help="a planner, or the path of a planner's file (default: rounded_shortest_path)",
    )
    chosen.add_argument(
        "--like", metavar="STUDY/METHOD", help="planner and settings of a study's method"
    )
    parser.add_argument(
        "--settings",
        default="{}",
        metavar="'{NAME: VALUE, ...}'",
        help="settings in place of the planner's own",
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="of the random numbers (default: 0)"
    )
    parser.add_argument(
        "--cell",
        type=float,
        metavar="SIDE",
        help=f"side of a cell (default: 1; of polygons the longer side / {map_files.CELLS})",
    )
    parser.add_argument(
        "--rule",
        choices=("overlap", "centre"),
        help="which cells obstacles occupy (default: overlap)",
    )
    parser.add_argument(
        "--robot-radius",
        type=float,
        metavar="R",
        help="the distance that the path keeps from obstacles and border",
    )
    parser.add_argument(
        "--strict",
        action="store_true",
        help="refuse a path that turns tighter than the turning radius",
    )
    parser.add_argument(
        "--margin",
        type=float,
        metavar="D",
        help="how far the border lies from the obstacles of a .geojson without one",
    )
    parser.add_argument(
        "--resolution",
        type=float,
        metavar="SIDE",
        help="side of a pixel of an image without a YAML file",
    )
    parser.add_argument(
        "--unknown",
        choices=("occupied", "free"),
        help="what unknown pixels count as (default: occupied)",
    )
    parser.add_argument("--most-pixels", type=int, metavar="N", help="the most pixels of an image")
    parser.add_argument(
        "--unit",
        metavar="NAME",
        help="the unit of length that is printed (default: m, of grids cell)",
    )
    parser.add_argument(
        "--out",
        type=File,
        metavar="FILE",
        help="the path as a picture (.svg, .png), points (.csv), a .geojson line, or ROS's "
        "message (.yaml)",
    )
    parser.add_argument(
        "--step",
        type=float,
        metavar="D",
        help="largest distance between points in the file (default: the length / 1000)",
    )
    try:
        _plan(parser.parse_args(_joined(words)))
    except NoPath as told:
        print(told, file=sys.stderr)
        sys.exit(1)


def _plan(arguments: Namespace) -> None:
    _check_words(arguments)
    with _as_options(arguments):
        places = {end: map_files.point(end, getattr(arguments, end)) for end in ("start", "target")}
    planner, settings = _planner(arguments)
    module, regions = planner_module(planner), problems.remembered()
    with _as_options(arguments):
        legs.check_planner(planner, planner, arguments.via, arguments.strict)
        via = [map_files.point("via", text) for text in arguments.via]
        described, home = _map(arguments, planner)
        _check_no_input(arguments, described)
        problem = _problem(planner, places, home, regions)
        if arguments.step is not None:  # known before planning: no path is shorter than that
            samples.check_step(arguments.step, math.dist(problem.start, problem.target))
        course = planning.course(problem, via, regions)
    if planner == legs.ROUNDED:
        settings = legs.preset(problem.workspace) | settings
    interface.check_settings(module, settings, "--settings")
    if hasattr(module, "serves"):
        interface.asked(module.serves, f"--planner: {planner}", problem)
    _check_reached(course)
    task = planning.Task(
        f"--planner: {planner}",
        planner,
        module.plan,
        settings,
        arguments.seed,
        foreign=is_file(planner),
        timed=True,
    )
    answer, seconds = api.answered(task, planner, course, regions)
    if arguments.strict:
        try:
            with _as_options(arguments):
                api.check_strict(answer)
        except ValueError as told:
            raise NoPath(str(told)) from None
    if arguments.out and answer.path:  # what cannot be written is told alone
        try:
            with _as_options(arguments):
                _write(arguments, answer)
        except OSError as error:  # such as a disk that is full by now
            raise _unwritable(arguments.out, error) from None
    for name, text in _told(answer, seconds):
        print(f"{name:16}{text}")
    if answer.path is None:
        unwritten = f"; {arguments.out} is not written" if arguments.out else ""
        raise NoPath(f"--planner: {planner}: found no path{unwritten}")
    if not answer.feasible:
        raise NoPath(f"--planner: {planner}: its path is not feasible")


def _check_reached(course: planning.Course) -> None:
    """Raise NoPath for a target to which no free way leads."""
    if not np.isfinite(course.shortest.length):
        x, y = course.problem.target
        raise NoPath(
            f"--target: {x:.12g},{y:.12g}: no free way leads there from the start; expected one "
            "that can be reached"
        )


def _check_words(arguments: Namespace) -> None:
    """Raise Fault for options that are wrong whatever the map is."""
    for name in ("like", "planner", "start", "target"):
        if getattr(arguments, name) == "":
            raise Fault(f"--{name}: ''; expected some text")
    if arguments.out:
        _check_out(arguments.out)
    if arguments.unit is not None and not is_line(arguments.unit):
        raise Fault(f"--unit: {arguments.unit!r}; expected a name of one line")
    if arguments.seed < 0:
        raise Fault(f"--seed: {arguments.seed}; expected a whole number of at least 0")
    if arguments.step is not None and not 0 < arguments.step < math.inf:
        raise Fault(f"--step: {arguments.step:g}; expected a number above 0")
    if arguments.step is not None and (
        arguments.out is None or arguments.out.suffix.lower() in PICTURES
    ):
        raise Fault(
            f"--step: {arguments.step:g}: only for --out with a file that ends in "
            f"{', '.join(OUT[len(PICTURES) :])}"
        )


@contextmanager
def _as_options(arguments: Namespace) -> Iterator[None]:
    """Have the message of a ValueError that begins with a name begin with the option of that name,
    or with that of settings.
    """
    try:
        yield
    except ValueError as error:
        name, colon, told = str(error).partition(":")
        if colon and name in vars(arguments):
            raise Fault(f"--{name.replace('_', '-')}:{told}") from None
        if colon and name == "turning_radius":
            raise Fault(f"--settings: {name}:{told}") from None
        raise


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


def _check_no_input(arguments: Namespace, described: dict[str, Any]) -> None:
    """Raise Fault for a file to write that is the map, or the image of a map."""
    inputs = [arguments.map]
    if described["kind"] == "ros_map":
        inputs.append(ros.image_of(arguments.map, arguments.map.parent))
    if arguments.out and arguments.out.resolve() in [file.resolve() for file in inputs]:
        raise Fault(f"--out: {arguments.out}: is the map itself; expected another file")


def _unwritable(out: File, error: OSError) -> Fault:
    return Fault(f"--out: {out}: cannot be written ({error.strerror or type(error).__name__})")


def _told(answer: api.Answer, seconds: float) -> list[tuple[str, str]]:
    """The names and values to print. seconds: of CPU time that the planner took."""
    home, planner, settings = answer.problem.workspace, answer.method, answer.settings
    unit = home.unit
    told = ", ".join(
        f"{name} {'any' if value is None else value}" for name, value in settings.items()
    )
    lines = [("planner", planner), ("settings", told or "none")]
    if answer.robot_radius:
        whole = (
            f", by whole cells of {home.cell:g} {unit}"
            if isinstance(home, Grid) and not home.drawn
            else ""
        )
        lines.append(("robot radius", f"{answer.robot_radius:g} {unit}{whole}"))
    lines.append(("shortest path", f"{answer.shortest:.6g} {unit}"))
    if len(answer.via) > 1:
        order = " ".join(f"{x:.12g},{y:.12g}" for x, y in answer.via)
        lines.append(("way points", order))
    if answer.path is None:
        return [*lines, ("path", f"none ({answer.stop})"), ("CPU time", f"{seconds:.3g} s")]
    gap = _told_number(100 * abs(answer.gap), 3)
    side = "below" if answer.gap < 0 and gap != "0" else "above"
    lines.append(("length", f"{answer.length:.6g} {unit}, {gap} % {side} the shortest path"))
    lines.append(("curvature", _told_curvature(answer)))
    if planner == legs.ROUNDED:
        asked = settings["turning_radius"]
        kept = answer.turning_radius
        met = legs.keeps_radius(asked, kept)
        lines.append(
            (
                "turning radius",
                f"{asked:.6g} {unit} asked"
                + (" and kept" if met else f", {kept:.6g} {unit} kept: no room for more"),
            )
        )
    lines.append(("clearance", f"{_told_number(answer.clearance, 6)} {unit}"))
    if answer.feasible:
        lines.append(("feasible", "yes"))
    else:
        x, y = answer.collision
        what = (
            "comes closer to an obstacle than the robot's radius"
            if answer.clearance > 0
            else "enters an obstacle"
        )
        lines.append(
            ("feasible", f"no: {what} at {x:.6g},{y:.6g}, at most {answer.depth:.6g} {unit} deep")
        )
    return [*lines, ("CPU time", f"{seconds:.3g} s")]


def _told_curvature(judged: api.Judged) -> str:
    unit, bound = judged.problem.workspace.unit, judged.curvature_bound
    if math.isfinite(bound):
        told = f"at most {_told_number(bound, 6)} / {unit}"
    else:
        told = (
            f"at most {_told_number(judged.curvature, 6)} / {unit} at samples, without a bound "
            "where the path stands still"
        )
    if judged.corners:
        return f"{told}, and corners"
    return told


def _told_number(value: float, digits: int) -> str:
    """A number with some digits; 0 if it is within the checker's tolerance, where it says
    nothing.
    """
    return f"{value:.{digits}g}" if abs(value) > checker.TOLERANCE else "0"


def _planner(arguments: Namespace) -> tuple[str, dict[str, Any]]:
    """The planner and its settings, as far as they are known without the map."""
    changed = settings_in(arguments.settings)
    if arguments.like:
        planner, preset = _like(arguments.like)
    else:
        planner = arguments.planner or legs.ROUNDED
        if not is_file(planner) and planner not in known_planners():
            raise Fault(f"--planner: {planner}: unknown{closest(planner, known_planners())}")
        interface.loaded(planner, f"--planner: {planner}")
        preset = {} if planner == legs.ROUNDED or is_file(planner) else api.first_use(planner)
    interface.refuse_unknown(planner_module(planner), changed, "--settings")
    return planner, preset | changed


def _like(name: str) -> tuple[str, dict[str, Any]]:
    """Planner and settings of a method of a study."""
    key, _, method = name.rpartition("/")
    if not key:
        raise Fault(f"--like: {name}; expected STUDY/METHOD, such as song2016/smooth")
    return of_study(key, method, f"--like: {name}: methods")


def _map(arguments: Namespace, planner: str) -> tuple[dict[str, Any], Workspace]:
    """The map's description, and the map, as a grid if the planner needs cells."""
    served = getattr(planner_module(planner), "workspaces", None)
    if arguments.robot_radius is not None:
        robot.check_radius(arguments.robot_radius)
    names = ("cell", "rule", "unit", "margin", "resolution", "unknown", "most_pixels")
    options = {name: getattr(arguments, name) for name in names}
    described = map_files.described(arguments.map, **options, cells=map_files.needs_cells(served))
    return described, map_files.read(arguments.map, described, arguments.robot_radius)


def _problem(
    planner: str,
    places: dict[str, tuple[float, float]],
    home: Workspace,
    regions: Regions,
) -> Problem:
    """The map with start and target."""
    served = getattr(planner_module(planner), "workspaces", None)
    met = "polygons" if isinstance(robot.suited(home, served), Polygons) else "grid"
    if served is not None and met not in served:
        raise Fault(
            f"--planner: {planner}: "
            f"serves workspaces of kind {', '.join(served)}, and a map is {met}"
        )
    return problems.placed(Problem("", home, places["start"], places["target"]), regions, served)


def _write(arguments: Namespace, judged: api.Judged) -> None:
    """The path as a picture, as points with heading and curvature, as a GeoJSON line, or as a
    message of ROS.
    """
    out, step = arguments.out, arguments.step
    suffix = out.suffix.lower()
    if suffix in PICTURES:
        judged.to_picture(out)
    elif suffix == ".csv":
        judged.to_csv(out, step=step)
    elif suffix == ".geojson":
        judged.to_geojson(out, step=step)
    else:
        judged.to_ros(out, step=step)
