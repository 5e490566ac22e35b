"""Kernels without compilation (NUMBA_DISABLE_JIT), for debuggers and coverage: the same answers,
bit for bit.
"""

import json
import pkgutil
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import starts
from studies import study

import bezierplan
from bezierplan.analysis.stored_runs import format_row
from bezierplan.commands import replay
from bezierplan.geometry import shortest_paths
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import Region, build_region
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid, from_lines
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem

ROOT = Path(__file__).resolve().parents[1]
BOUNDS = (0.0, 6.0, 0.0, 4.0)
RUN = "song2016/routes/0_15/straight_line/0"
ENDS = np.array([[0.5, 0.5], [5.5, 3.5]])


def workspaces() -> dict[str, Grid | Circles | Polygons]:
    """One of each kind of region, with the same field around it."""
    ring = np.array([[2.1, 1.2], [3.9, 0.9], [3.4, 2.8], [2.9, 1.9], [2.3, 2.7]])
    return {
        "grid": from_lines(["......", "..##..", "...#..", "......"], 1.0, "m"),
        "circles": Circles(BOUNDS, np.array([[3.0, 2.0], [4.4, 1.1]]), np.array([0.8, 0.5]), "m"),
        "polygons": Polygons(BOUNDS, ((ring,),), "m"),
    }


def paths() -> list[np.ndarray]:
    """Pieces of a straight line, of curves of degrees 2 to 5 around and through the middle, and of
    a polyline that touches a cell.
    """
    rng = np.random.default_rng(7)
    found = [ENDS[None]]
    for degree in (2, 3, 5):
        inner = rng.uniform((0.2, 0.2), (5.8, 3.8), (2, degree - 1, 2))
        found += [np.concatenate([ENDS[:1], each, ENDS[1:]])[None] for each in inner]
    found.append(np.array([ENDS[0], [0.5, 3.8], ENDS[1]])[None])
    corners = np.array([ENDS[0], [2.0, 1.0], [2.0, 3.0], ENDS[1]])
    return [*found, np.stack([corners[:-1], corners[1:]], axis=1)]


def digits(numbers: Iterable[float]) -> str:
    """Numbers with all digits, of whatever type: compiled code returns those of Python, the others
    are numpy's.
    """
    return " ".join(float(number).hex() for number in numbers)


def answers() -> dict[str, list[str]]:
    """What the checker and the exact shortest paths answer, with all digits."""
    found = {}
    for name, workspace in workspaces().items():
        built: Region = build_region(workspace)
        found[name] = [digits(check(pieces, built)) for pieces in paths()]
        shortest = shortest_paths.shortest_path(
            Problem(name, workspace, *map(tuple, ENDS.tolist()))
        )
        found[name].append(digits((shortest.length, *shortest.points.ravel())))
    return found


def modules() -> list[str]:
    """All modules of the package but the one that is a program."""
    walk = pkgutil.walk_packages(bezierplan.__path__, "bezierplan.")
    return [each.name for each in walk if not each.name.endswith("__main__")]


def run_again() -> str:
    """A run, as text, without the times."""
    made = replay.replay(RUN, {"song2016": study("song2016")})
    run = made.runs.iloc[0]
    return format_row({name: value for name, value in run.to_dict().items() if name != "cpu_s"})


def test_the_checker_and_a_run_answer_the_same_without_compilation():
    """In a process that has imported all modules."""
    imports = "import importlib, json, test_uncompiled as own"
    code = "[importlib.import_module(name) for name in own.modules()]"
    code += "; print(json.dumps([own.answers(), own.run_again()]))"
    said = starts.python(f"{imports}; {code}", ROOT, ROOT / "tests", NUMBA_DISABLE_JIT="1")
    assert json.loads(said) == [answers(), run_again()]
