"""OMPL beside the baseline for a robot with a width: the third part of `make compare`.

On the six maps of polygons of elhoseny2017, or on maps of any kind that `plan` reads, each given as
FILE X,Y X,Y RADIUS (start, target): CPU time of one core until a path that the
checker accepts is within 2 % of the shortest, the median of the seeds, and how many times that of
ours. Budgets double, so OMPL's times are known to a factor of two; ours are of one run.

The map grows by the radius. `rounded_shortest_path` is set beside OMPL's planners with its
simplifier, as in compare_planners.py; its time includes that of the exact shortest path, with which
all are compared. OMPL's paths are polylines.
* A turning radius, with headings at both ends: `dubins_search` beside OMPL's planners in its space
  of Dubins paths, whose motions the same exact test of the same paths checks. No shortest path is
  known here: the shortest that any of them found stands for it. In its space of Reeds and Shepp a
  robot also backs up, which ours does not, so their lengths cannot be compared.

Growing the map and compiling is charged to nobody. Writes robots.csv (each path) and
robots_times.csv into results/comparison.
"""

import math
import sys
import time
from collections.abc import Iterator
from pathlib import Path as File
from typing import NamedTuple

sys.path.insert(0, str(File(__file__).resolve().parents[2] / "src"))

import numpy as np
import pandas as pd
from anytime import time_table

from bezierplan.figures import sheet
from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import Region, region
from bezierplan.planners import rounded_shortest_path
from bezierplan.running import legs
from bezierplan.workspaces import map_files
from bezierplan.workspaces.problem import Path, Problem

try:
    import ompl_planners
except ImportError as fault:
    sys.exit(
        f"compare_robots: OMPL cannot be imported here ({fault}); its wheels are for Linux and "
        "for macOS 15 or later on Apple silicon"
    )

ROOT = File(__file__).resolve().parents[2]
MAPS = ROOT / "config" / "studies" / "elhoseny2017" / "workspaces"
FOLDER = ROOT / "results" / "comparison"


class Course(NamedTuple):
    """A map file, start and target (2,), and the robot's radius, in the map's unit."""

    file: File
    start: tuple[float, ...]
    target: tuple[float, ...]
    radius: float = 0.2


COURSES = (
    Course(MAPS / "back_and_forth.geojson", (1.0, 1.25), (1.0, 8.75)),
    Course(MAPS / "bugtrap1.geojson", (12.6, 14.4), (22.4, 24.2)),
    Course(MAPS / "complex2.geojson", (1.0, 1.0), (19.0, 19.0)),
    Course(MAPS / "gaps.geojson", (2.0, 10.0), (18.0, 10.0)),
    Course(MAPS / "hidden_U.geojson", (10.0, 3.0), (10.0, 27.0)),
    Course(MAPS / "square_spiral.geojson", (2.5, 2.5), (12.5, 7.5)),
)

WITHIN = 0.02
SEEDS, TIMES = 50, 0.64 / 2.0 ** np.arange(9, -1, -1)

OURS = "ours"

# CPU seconds and the length of a path that the checker accepts; infinite without one.
Attempt = tuple[float, float]


class Arena(NamedTuple):
    """A problem on a map for the robot's centre, and its blocked region."""

    problem: Problem
    blocked: Region


def arena(course: Course, radius: float) -> Arena:
    workspace = map_files.read(course.file, map_files.described(course.file), radius)
    problem = Problem(course.file.stem, workspace, course.start, course.target)
    return Arena(problem, region(workspace))


def length_of(at: Arena, path: Path) -> float:
    pieces = curves.bezier_pieces(path)
    return curves.length(path) if checker.check(pieces, at.blocked).feasible else math.inf


def ours(at: Arena, settings: dict) -> Iterator[Attempt]:
    before = time.process_time()
    plan = rounded_shortest_path.plan(at.problem, np.random.default_rng(0), **settings)
    seconds = time.process_time() - before
    yield seconds, length_of(at, plan.path) if plan.path else math.inf


def disc(course: Course) -> pd.DataFrame:
    """Attempts of all planners for a disc, as `anytime` takes them."""
    at = arena(course, course.radius)
    bound = shortest_paths.shortest_path(at.problem, blocked=at.blocked).length
    is_free = ompl_planners.segment_test(at.blocked)
    settings = legs.preset(at.problem.workspace)

    def with_ompl(planner: str) -> Iterator[Attempt]:
        for seconds, points in ompl_planners.attempts(planner, at.problem, is_free, TIMES):
            yield seconds, math.inf if points is None else length_of(at, Path("polyline", points))

    rivals = {OURS: lambda: ours(at, settings)}
    rivals |= {
        planner: lambda planner=planner: with_ompl(planner) for planner in ompl_planners.PLANNERS
    }
    return attempts_of(f"{course.file.stem}, disc", rivals, SEEDS, bound)


def attempts_of(problem: str, rivals: dict, seeds: int, bound: float) -> pd.DataFrame:
    """A row an attempt; the excess is that over the bound, a length."""
    for run in rivals.values():
        next(iter(run()), None)  # compiles
    rows = [
        {"problem": problem, "method": method, "seed": seed, "cpu_s": seconds, "length": length}
        for seed in range(seeds)
        for method, run in rivals.items()
        for seconds, length in run()
    ]
    attempts = pd.DataFrame(rows)
    return attempts.assign(excess=attempts["length"] / bound - 1)


def printed(table: pd.DataFrame) -> str:
    """Milliseconds, the share of seeds that get there, and how many times ours, for each problem
    and planner.
    """
    lines = []
    for problem, own in table.groupby("problem", sort=False):
        ours_s = own.loc[own["method"] == OURS, "median_s"].item()
        cells = [
            f"{each.method} {1e3 * each.median_s:.1f} ({each.median_s / ours_s:.1f} x, "
            f"{100 * each.reached:.0f} %)"
            for each in own.itertuples()
        ]
        lines.append(f"{problem:26}{'   '.join(cells)}")
    return "\n".join(lines)


def courses(words: list[str]) -> list[Course]:
    """The courses that the command line names; without words those of elhoseny2017."""
    if len(words) % 4:
        sys.exit("compare_robots: expected FILE X,Y X,Y RADIUS for each map")
    named = [words[first : first + 4] for first in range(0, len(words), 4)]
    return [
        Course(
            File(file),
            tuple(map(float, start.split(","))),
            tuple(map(float, target.split(","))),
            float(radius),
        )
        for file, start, target, radius in named
    ] or list(COURSES)


def main() -> None:
    entered = courses(sys.argv[1:])
    FOLDER.mkdir(parents=True, exist_ok=True)
    ompl_planners.start(seed=1)
    print(
        f"CPU ms until a path is within {100 * WITHIN:g} % of the shortest (times ours, seeds "
        "that get there)\n"
    )
    found = []
    for course in entered:
        found.append(disc(course))
        print(printed(time_table(found[-1], (WITHIN,))), flush=True)
    attempts = pd.concat(found, ignore_index=True)
    sheet.write_data(attempts, FOLDER / "robots.csv")
    sheet.write_data(time_table(attempts, (WITHIN,)), FOLDER / "robots_times.csv")
    print(f"\nTables: {FOLDER.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
