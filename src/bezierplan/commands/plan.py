"""Plan one path on a map, and check it by exact geometry."""

import math
import sys
from pathlib import Path
from typing import Any

from bezierplan import api
from bezierplan.analysis import judgement
from bezierplan.commands import arguments
from bezierplan.commands.arguments import OutFile, Place
from bezierplan.geometry import path_files
from bezierplan.schema.checked import Fault

PASSES_ON = (api.read_map, api.plan)
FILES = (".svg", ".png", ".json", *path_files.WRITERS)
# A planner that takes at most so many CPU seconds is called again, because the first call loads its
# kernels and would be timed with that.
_LONG = 2.0


def main(
    map: Path,
    *,
    start: Place | None = None,
    target: Place | None = None,
    out: OutFile | None = None,
    step: float | None = None,
    **options: Any,
) -> None:
    """Plan one path on a map, and check it by exact geometry.

    Prints its length, its excess over the exact shortest path, its largest curvature, its clearance
    from the map's own obstacles and border, whether it is feasible and if not where it enters an
    obstacle, and the CPU time of the planner. The exit status is 0 for a feasible path, 1 if there
    is or was found none, and 2 for wrong input.

    Parameters
    ----------
    map : Path
        GeoJSON polygons, in a unit of length (.geojson): what has no properties.role is an
        obstacle, the border is the polygon with the role border, or the file's bbox; an occupancy
        map of ROS (.yaml); an image alone; cells of . (free) and # (occupied), the top row first
        (.txt); or the name of a map of the studies, such as gaps
    start : tuple of float
        where the path begins, in the map's unit
    target : tuple of float
        where it ends
    out : Path, optional
        a file of the path: a picture (.svg, .png), distance, x, y, heading and curvature (.csv), a
        line (.geojson), a nav_msgs/Path message of ROS (.yaml), or the verdict with the control
        points (.json)
    step : float, optional
        largest distance between points in that file (default: the length / 1000)

    Examples
    --------
    The exact shortest path through a maze, its corners rounded to a radius of 0.3 m, as a picture:
      plan gaps --start 2,10 --target 18,10 --settings '{turning_radius: 0.3}' --out path.svg

    The same problem by the genetic algorithm of elhoseny2017, on cells of 0.5 m, as points:
      plan gaps --start 2,10 --target 18,10 --method elhoseny2017/mga --cell 0.5 --out path.csv

    The path of a robot with a radius of 0.4 m, which turns no tighter than 0.5 m, as points
    0.1 m apart:
      plan gaps --start 2,10 --target 18,10 --robot-radius 0.4 --step 0.1 \\
        --settings '{turning_radius: 0.5}' --out robot.csv
    """
    if out:
        # Before planning, which may take long.
        arguments.check_suffix("out", out, FILES)
        # A ROS map's image lies beside it, mostly under its name, and must not be lost.
        there = map.exists() and out.exists()
        if there and out.resolve().with_suffix("") == map.resolve().with_suffix(""):
            raise Fault(f"out: {out}: is there, with the map's name; expected another file")
    if not map.suffix and not map.exists():
        map = api.example_map(str(map))
    names = {parameter.name for parameter, *_ in arguments.read_parameters(api.read_map)}
    room = api.read_map(map, **{name: options.pop(name) for name in names & options.keys()})
    problem = api.Problem("", room, start, target)
    settings = options.pop("settings", {})
    answer = api.plan(problem, **options, **settings)
    if answer.cpu_s < _LONG:
        answer = api.plan(problem, **options, **settings)
    lines = judgement.describe_answer(answer)
    if out and answer.path:
        answer.save(out, step=step)
        lines["file"] = str(out)
    for name, text in lines.items():
        print(f"{name:16}{text}")
    # The input is right, but there is no path: status 1.
    if not math.isfinite(answer.shortest):
        sys.exit(f"--target: {target[0]:g},{target[1]:g}: no free way leads there from the start")
    if answer.path is None:
        sys.exit(f"{answer.method}: found no path{f'; {out} is not written' if out else ''}")
    if not answer.feasible:
        sys.exit(f"{answer.method}: its path is not feasible")
