"""The public interface: `import bezierplan as bp`, then `bp.plan`, `bp.check`, `bp.shortest_path`
and the rest.

The command line and the documentation use the same functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from glob import escape
from numbers import Real
from pathlib import Path as File
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

import bezierplan
from bezierplan.workspaces.circles import Circles as Circles
from bezierplan.workspaces.grid import Grid as Grid
from bezierplan.workspaces.polygons import Polygons as Polygons
from bezierplan.workspaces.problem import Path, Problem, Workspace

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.geometry.samples import Samples
    from bezierplan.running.planning import Course, Task
    from bezierplan.running.problems import Regions

__all__ = bezierplan.__all__

Method = str | Callable[..., Any] | ModuleType
Via = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Judged:
    """A path and the certified checker's verdict on it.

    Attributes
    ----------
    problem : Problem
        On the map for the robot's centre.
    path : Path or None
        None if there is none to judge.
    length : float
        Exact arc length, in the map's unit; nan without a path.
    feasible : bool
        Whether the path stays out of every obstacle and within the border.
    collision : tuple of float or None
        The first point (x, y) of the path at which it enters an obstacle.
    depth : float
        How deeply the path itself enters, in the map's unit; 0 if it does not.
    clearance : float
        Least distance of the path to an obstacle or the border of the map itself, in the map's
        unit; 0 if it enters one.
    robot_radius : float
        The clearance that a feasible path keeps, in the map's unit.
    curvature : float
        Largest absolute curvature of samples, in 1/unit; corners have none.
    curvature_bound : float
        What it is nowhere more than, certified by subdivision; infinite at a cusp, and where the
        curve stands still.
    curvature_jump : float
        Its largest jump between two pieces of the path; infinite at a corner.
    corners : bool
        Whether the direction of travel jumps somewhere.
    shortest : float
        Length of the exact shortest path, through the way points; infinite if there is none.
    via : tuple of tuple of float
        Way points (x, y) between start and target.
    """

    problem: Problem = field(repr=False)
    path: Path | None = field(repr=False)
    length: float
    feasible: bool
    collision: tuple[float, float] | None
    depth: float
    clearance: float
    curvature: float
    curvature_bound: float
    curvature_jump: float
    corners: bool
    shortest: float
    robot_radius: float
    via: tuple[tuple[float, float], ...]

    @property
    def gap(self) -> float:
        """How much longer the path is than the exact shortest one, as a share of that."""
        return self.length / self.shortest - 1 if self.shortest else 0.0

    def sample(self, n: int | None = None, *, step: float | None = None) -> Samples:
        """Points at equal distances along the path, with heading and curvature.

        Parameters
        ----------
        n : int, optional
            Number of points, both ends included.
        step : float, optional
            Largest distance between two points, in the map's unit. Exactly one of `n` and `step` is
            given.

        Returns
        -------
        Samples

        Raises
        ------
        ValueError
            If there is no path, or for an `n` or `step` out of range.
        """
        from bezierplan.geometry import samples

        return samples.along(self._path(), n, step)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw map, path and exact shortest path on matplotlib's `axes`, or on new ones, which are
        returned.
        """
        from bezierplan.figures import drawn_path
        from bezierplan.running import legs, problems
        from bezierplan.workspaces.grown import original

        if axes is None:
            import matplotlib.pyplot as plt

            axes = plt.figure(layout="constrained").add_subplot()
        regions = problems.remembered()
        parts = legs.legs(self.problem, self.via, regions)
        bound = legs.whole(legs.shortest(parts, regions(self.problem.workspace)))
        own = self.problem._replace(workspace=original(self.problem.workspace))
        drawn_path.draw(axes, own, self.path, bound.points, self.collision)
        return axes

    def to_picture(self, file: str | File) -> None:
        """Draw the same with a legend into a file whose suffix matplotlib knows, such as .svg or
        .png.
        """
        from bezierplan.figures import drawn_path

        drawn_path.save(File(file), self.plot)

    def to_csv(self, file: str | File, *, step: float | None = None) -> None:
        """Write distance, x, y, heading and curvature along the path.

        Parameters
        ----------
        file : str or Path
            A .csv file.
        step : float, optional
            As in `sample`, by default a thousandth of the length.

        Raises
        ------
        ValueError
            If there is no path.
        """
        from bezierplan.geometry import path_files

        path_files.write_csv(File(file), self._spaced(step))

    def to_geojson(self, file: str | File, *, step: float | None = None) -> None:
        """Write the path as a GeoJSON feature of kind LineString, with the verdict among its
        properties.
        """
        from bezierplan.geometry import path_files

        verdict = {"feasible": self.feasible, "length": self.length, "clearance": self.clearance}
        path_files.write_geojson(File(file), self._spaced(step), verdict)

    def to_ros(self, file: str | File, *, step: float | None = None, frame: str = "map") -> None:
        """Write the path as a `nav_msgs/Path` message in YAML, as `ros2 topic pub` reads it."""
        from bezierplan.geometry import path_files

        path_files.write_ros(File(file), self._spaced(step), frame)

    def _spaced(self, step: float | None) -> Samples:
        """Samples for a file. A path of no length has two, whatever their distance."""
        return self.sample(step=(self.length / 1000 or 1.0) if step is None else step)

    def _path(self) -> Path:
        if self.path is None:
            raise ValueError(
                "no path was found, so there is nothing to sample, to draw or to write"
            )
        return self.path


@dataclass(frozen=True)
class Answer(Judged):
    """What a method answered to a problem, with the certified checker's verdict.

    Attributes
    ----------
    method : str
        Name of the method or the planner.
    settings : dict
        All settings that were used.
    claimed_feasible : bool
        The planner's own verdict.
    objective : float
        Its final objective value, by its own definition.
    evaluations : int
        Number of paths whose objective it evaluated.
    history : ndarray
        Best objective after each generation, (generations + 1,).
    stop : str
        Why it ended.
    turning_radius : float
        Radius of the tightest turn, where the planner is `rounded_shortest_path`: 0 where a corner
        is left, infinite without turns; nan of other planners.
    """

    method: str
    settings: dict[str, Any]
    claimed_feasible: bool
    objective: float
    evaluations: int
    history: np.ndarray = field(repr=False)
    stop: str
    turning_radius: float


@dataclass(frozen=True)
class Shortest:
    """The exact shortest path: its length, in the map's unit (infinite without a free path), and
    its points (n, 2).

    Among circles the points are the vertices of a chain of chords and tangents that is within 1e-6
    of the path.
    """

    length: float
    points: np.ndarray = field(repr=False)


def read_map(
    file: str | File,
    *,
    cell: float | None = None,
    rule: str | None = None,
    robot_radius: float | None = None,
    unit: str | None = None,
    margin: float | None = None,
    resolution: float | None = None,
    unknown: str | None = None,
    most_pixels: int | None = None,
) -> Workspace:
    """Read a map from a file.

    Parameters
    ----------
    file : str or Path
        GeoJSON polygons (.geojson, .json); an occupancy map of ROS's map_server (.yaml), or an
        image alone (.png, .pgm, .bmp); a MovingAI grid (.map), or cells as text (.txt).
    cell : float, optional
        Side of a cell. Of text, 1 by default. Of polygons: makes a grid of them, for methods that
        need cells.
    rule : {"overlap", "centre"}, optional
        Which cells polygons occupy; overlap by default.
    robot_radius : float, optional
        Radius of the robot, in the map's unit: obstacles grow by it and the border shrinks.
        Verdicts tell the clearance to the map itself.
    unit : str, optional
        Name of the unit of length; by default m, of grids cell.
    margin : float, optional
        Of GeoJSON without a border: how far the border lies from the obstacles, in the map's unit.
    resolution : float, optional
        Of an image alone: side of a pixel, in the map's unit. Its lower left corner is at 0, 0, and
        dark pixels are occupied.
    unknown : {"occupied", "free"}, optional
        What pixels of a ROS map or an image count as that are unknown; occupied by default.
    most_pixels : int, optional
        The most pixels of an image.

    Returns
    -------
    Grid or Polygons
        With a `robot_radius`, a grid has the grown obstacles as polygons in its field `drawn`.

    Raises
    ------
    ValueError
        Names file, place and what is expected.
    """
    from bezierplan.workspaces import map_files

    source = File(file)
    pixels = {"resolution": resolution, "unknown": unknown, "most_pixels": most_pixels}
    description = map_files.described(
        source, cell=cell, rule=rule, unit=unit, margin=margin, **pixels, cells=cell is not None
    )
    return map_files.read(source, description, robot_radius)


def shortest_path(problem: Problem) -> Shortest:
    """The exact shortest path of a point from start to target.

    Parameters
    ----------
    problem : Problem
        A map with start and target.

    Returns
    -------
    Shortest
        Its length and a polyline along it.

    Raises
    ------
    ValueError
        For a start or target outside or in an obstacle.

    Examples
    --------
    >>> bounds = (-5.0, 5.0, -5.0, 5.0)
    >>> disc = Circles(bounds, centres=np.array([[0.0, 0.0]]), radii=np.array([1.0]), unit="m")
    >>> round(shortest_path(Problem("disc", disc, (-2.0, 0.0), (2.0, 0.0))).length, 5)
    4.5113
    """
    from bezierplan.geometry import shortest_paths
    from bezierplan.running import problems

    _check_problem(problem)
    regions = problems.remembered()
    placed = problems.placed(problem, regions)
    bound = shortest_paths.shortest_path(placed, blocked=regions(placed.workspace))
    return Shortest(bound.length, bound.points)


def check(problem: Problem, path: Path) -> Judged:
    """Judge any path by exact geometry.

    Parameters
    ----------
    problem : Problem
    path : Path
        A curve kind and its control points (n, 2); its ends need not be those of the problem.

    Returns
    -------
    Judged

    Raises
    ------
    ValueError
        For a curve kind that is unknown, points of the wrong shape, or coordinates that are not
        finite or too large.

    Examples
    --------
    >>> room = Grid(np.zeros((4, 4), dtype=bool), cell=1.0, unit="m")
    >>> across = Problem("room", room, (0.5, 0.5), (3.5, 0.5))
    >>> bend = Path("bezier", np.array([(0.5, 0.5), (2.0, 3.0), (3.5, 0.5)]))
    >>> judged = check(across, bend)
    >>> judged.feasible, round(judged.length, 3), round(judged.clearance, 3)
    (True, 4.071, 0.5)
    """
    from bezierplan.geometry import shortest_paths
    from bezierplan.running import answer, problems

    _check_problem(problem)
    _check_path(path)
    regions = problems.remembered()
    placed = problems.placed(problem, regions)
    bound = shortest_paths.shortest_path(placed, blocked=regions(placed.workspace))
    points = np.array(path.points, dtype=float)
    judged = verdict(placed, answer.path_of(Path(path.curve, points)), bound.length, regions)
    return Judged(**judged | {"path": path})


def verdict(
    problem: Problem,
    path: Path | None,
    shortest: float,
    regions: Regions,
    via: Via = (),
) -> dict[str, Any]:
    """The fields of `Judged` for a path, or for none.

    shortest: length of the exact shortest path. regions: the blocked regions of maps. Raises
    ValueError if the path is feasible and yet closer to the map's own obstacles than the robot's
    radius, so that the checker is wrong.
    """
    from bezierplan.analysis.measures import CURVATURE_SAMPLES
    from bezierplan.geometry import checker, curves
    from bezierplan.geometry.curvature_bound import largest_curvature
    from bezierplan.workspaces import robot
    from bezierplan.workspaces.grown import grown_of

    grown = grown_of(problem.workspace)
    asked = {
        "problem": problem,
        "robot_radius": grown.radius if grown else 0.0,
        "via": tuple(via),
        "shortest": shortest,
    }
    if path is None:
        numbers = ("length", "depth", "clearance", "curvature", "curvature_bound", "curvature_jump")
        nothing = {"path": None, "feasible": False, "collision": None, "corners": False}
        return asked | nothing | dict.fromkeys(numbers, math.nan)
    pieces = curves.bezier_pieces(path)
    verdict = checker.check(pieces, regions(problem.workspace))
    clearance = (
        checker.check(pieces, regions(grown.original)).clearance if grown else verdict.clearance
    )
    if grown and verdict.feasible and clearance < grown.radius - robot.TOLERANCE:
        raise ValueError(
            f"its path is feasible, but {clearance:.12g} from an obstacle, less than the robot's "
            "radius: the checker is wrong"
        )
    jump = curves.curvature_jump(path)
    kappa, _ = curves.curvature(path, max(CURVATURE_SAMPLES, 20 * len(pieces) + 1))
    collision = None if verdict.feasible else curves.point_at(path, verdict.collision_at)
    return asked | {
        "path": path,
        "length": curves.length(path),
        "feasible": verdict.feasible,
        "collision": None if collision is None else tuple(collision.tolist()),
        "depth": verdict.depth,
        "clearance": clearance,
        "curvature": float(np.nan_to_num(np.abs(kappa)).max()),
        "curvature_bound": largest_curvature(pieces).bound,
        "curvature_jump": jump,
        "corners": not math.isfinite(jump),
    }


def plan(
    problem: Problem,
    method: Method | None = None,
    *,
    seed: int = 0,
    robot_radius: float = 0.0,
    via: Via = (),
    strict: bool = False,
    **settings: Any,
) -> Answer:
    """Plan one path and judge it by exact geometry.

    Parameters
    ----------
    problem : Problem
    method : str, module or callable, optional
        A study's method such as ``"song2016/smooth"``, whose settings are the defaults; a planner
        such as ``"prm"``, with the settings of the first study, by name, that uses it; the path of
        a planner's file; or a planner's module or its function ``plan``. Without it, the exact
        shortest path with rounded corners.
    seed : int
        Of the random numbers.
    robot_radius : float
        Radius of the robot, in the map's unit: obstacles grow by it and the border shrinks. 0 if
        the map was read with one.
    via : sequence of tuple of float
        Way points (x, y), in their order: the path joins paths from one to the next, with a corner
        where their directions differ. For the planner without a method and `shortest_path`.
    strict : bool
        Whether a turning radius that cannot be kept everywhere is an error. For the planner
        without a method.
    **settings
        Settings in place of the method's own. Without a method: `turning_radius` and `offset`.

    Returns
    -------
    Answer

    Raises
    ------
    ValueError
        Names the argument or the setting and what is expected: an unknown method, a wrong setting,
        a start in an obstacle, a map that the planner does not serve, a turning radius that cannot
        be kept where `strict` asks for it.
    TypeError
        For a problem that is no `Problem`, or a method that is none of the above.

    Examples
    --------
    >>> wall = np.zeros((8, 8), dtype=bool)
    >>> wall[2:6, 3:5] = True
    >>> room = Grid(wall, cell=1.0, unit="m")
    >>> problem = Problem("a block", room, start=(0.5, 4.0), target=(7.5, 4.0))
    >>> answer = plan(problem, turning_radius=0.5)
    >>> answer.feasible, round(answer.length, 3), round(answer.gap, 4)
    (True, 8.416, 0.0015)
    >>> wide = plan(problem, robot_radius=0.5)
    >>> wide.feasible, round(wide.length, 3), round(wide.clearance, 6)
    (True, 9.156, 0.5)
    """
    from bezierplan.running import legs, planning, problems
    from bezierplan.workspaces import robot

    if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or seed < 0:
        raise ValueError(f"seed: {seed!r}; expected a whole number of at least 0")
    _check_problem(problem)
    if not _is_number(robot_radius):
        raise ValueError(f"robot_radius: {robot_radius!r}; expected a number of at least 0")
    if isinstance(via, str) or not isinstance(via, Sequence | np.ndarray):
        raise ValueError(f"via: {via!r}; expected places, each of x and y")
    for point in via:
        _check_place(point, "via")
    via = [tuple(map(float, point)) for point in via]
    settings = {setting: _plain(value) for setting, value in settings.items()}
    (name, module, preset), regions = _method(method, problem), problems.remembered()
    planner = _own_name(module)
    legs.check_planner(planner, planner or name, via, strict)
    chosen = preset | settings
    grown = problem._replace(workspace=robot.grow(problem.workspace, robot_radius))
    placed = problems.placed(grown, regions, getattr(module, "workspaces", None))
    _check_settings(name, module, chosen, placed)
    course = planning.course(placed, via, regions)

    # A user's file is executed in this process, as all that a program imports.
    task = planning.Task(f"planner {name}", planner, module.plan, chosen, seed)
    answer, _ = answered(task, name, course, regions)
    if strict:
        check_strict(answer)
    return answer


def answered(task: Task, method: str, course: Course, regions: Regions) -> tuple[Answer, float]:
    """The answer to a task, by the name of a method, and the CPU seconds that the planner took.

    Raises ValueError, beginning with the task's name, if the planner fails or the verdict on its
    path is impossible.
    """
    from bezierplan.geometry import shortest_paths
    from bezierplan.running import legs, planning
    from bezierplan.running.watchdog import PlannerFailure

    shortest = course.shortest
    try:
        plan, seconds = planning.planned(task, course)
        judged = verdict(course.problem, plan.path, shortest.length, regions, course.via)
    except PlannerFailure as failure:
        raise ValueError(str(failure)) from failure
    except ValueError as fault:
        raise ValueError(f"{task.name}: {fault}") from None
    if judged["feasible"] and judged["length"] < shortest_paths.least_length(shortest):
        raise ValueError(
            f"{task.name}: its path is {judged['length']:.12g} long and feasible, but no free path "
            f"is shorter than {shortest.length:.12g}: the checker or the bound is wrong"
        )
    answer = Answer(
        **judged,
        turning_radius=legs.kept(task.planner, plan),
        method=method,
        settings=task.settings,
        claimed_feasible=plan.claimed_feasible,
        objective=plan.objective,
        evaluations=plan.evaluations,
        history=plan.history,
        stop=plan.stop,
    )
    return answer, seconds


def check_strict(answer: Answer) -> None:
    """Raise ValueError, beginning with a name, for a path that does not keep its turning radius."""
    from bezierplan.running import legs

    unit = answer.problem.workspace.unit
    legs.check_kept(answer.settings["turning_radius"], answer.turning_radius, unit)


def _own_name(module: Any) -> str:
    """The name of a planner of this package; empty of another one, whatever it is called."""
    from bezierplan.planners import known_planners, planner_module

    name = getattr(module, "__name__", "").rpartition(".")[2]
    return name if name in known_planners() and module is planner_module(name) else ""


def _check_problem(problem: Problem) -> None:
    """Raise TypeError for what is no problem, and ValueError for places that are none."""
    if not isinstance(problem, Problem):
        raise TypeError(f"problem: is a {type(problem).__name__}; expected a Problem")
    if not isinstance(problem.workspace, Workspace):
        raise TypeError(
            f"problem: workspace: is a {type(problem.workspace).__name__}; expected a map"
        )
    for end in ("start", "target"):
        _check_place(getattr(problem, end), end)


def _check_place(place: Any, name: str) -> None:
    if not (
        isinstance(place, Sequence | np.ndarray) and len(place) == 2 and all(map(_is_number, place))
    ):
        raise ValueError(f"{name}: {place!r}; expected x and y, two numbers")


def _check_path(path: Any) -> None:
    """Raise TypeError for what is no path, and ValueError for points that are none."""
    if not isinstance(path, Path):
        raise TypeError(f"path: is a {type(path).__name__}; expected a Path")
    points = np.asarray(path.points)
    if points.dtype.kind not in "fiu" or points.ndim != 2 or points.shape[1] != 2:
        raise ValueError("path: points: expected an array of numbers, (n, 2)")


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def _plain(value: Any) -> Any:
    """A setting's value, of numpy's types as one of Python's."""
    return value.item() if isinstance(value, np.generic) else value


class _Function:
    """A planner's function in the place of its module."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.plan = function


def _method(method: Method | None, problem: Problem) -> tuple[str, Any, dict[str, Any]]:
    """Name, module and settings of a method."""
    from bezierplan.planners import is_file, known_planners, planner_module
    from bezierplan.running import interface, legs
    from bezierplan.schema.checked import closest

    if method is None:
        method = legs.ROUNDED
    if method == legs.ROUNDED:
        return method, planner_module(method), legs.preset(problem.workspace)
    if isinstance(method, ModuleType) or callable(method):
        name = getattr(method, "__name__", "a function")
        module = method if isinstance(method, ModuleType) else _Function(method)
        if fault := interface.interface_fault(module):
            raise TypeError(f"method: {name}: {fault}")
        return name, module, {}
    if not isinstance(method, str):
        raise TypeError(
            f"method: is a {type(method).__name__}; "
            "expected a name, a planner's module, or its function plan"
        )
    if is_file(method):
        if not File(method).is_file():
            raise ValueError(f"method: {method}: no such file")
        module, fault = interface.imported(method)
        if fault:
            raise ValueError(f"method: {method}: {fault}")
        return method, module, {}
    if method in known_planners():
        return method, planner_module(method), first_use(method)
    key, _, name = method.partition("/")
    if key not in _keys() or name not in _study(key).methods:
        raise ValueError(
            f"method: {method}: unknown{closest(method, [*methods(), *known_planners()])}"
        )
    return method, planner_module(_study(key).planner(name)), _study(key).resolved(name)


@cache
def _study(key: str) -> Any:
    """A study of this project, which its tests have checked."""
    from bezierplan.places import STUDIES
    from bezierplan.study import reading

    return reading.read_study(STUDIES / key)


def _keys() -> list[str]:
    from bezierplan.places import STUDIES

    return sorted(file.parent.name for file in STUDIES.glob("*/experiments.yaml"))


def first_use(planner: str) -> dict[str, Any]:
    """A planner's settings in the first study of this project, by name, that uses it; none if none
    does.
    """
    for study in map(_study, _keys()):
        for name in study.methods:
            if study.planner(name) == planner:
                return study.resolved(name)
    return {}


def _check_settings(name: str, module: Any, settings: Mapping[str, Any], problem: Problem) -> None:
    """Raise ValueError unless a planner takes exactly these settings and serves this problem."""
    from bezierplan.running import interface

    interface.refuse_unknown(module, settings, name)
    interface.check_settings(module, dict(settings), f"{name}: settings")
    served = getattr(module, "workspaces", None)
    kind = interface.KINDS[type(problem.workspace)]
    if served is not None and kind not in served:
        hint = (
            "; read the map with a cell to have a grid"
            if "grid" in served and kind == "polygons"
            else ""
        )
        raise ValueError(
            f"problem: {name} serves workspaces of kind {', '.join(served)}, "
            f"and this one is {kind}{hint}"
        )
    if hasattr(module, "serves"):
        module.serves(problem)


def methods() -> dict[str, str]:
    """The methods of the project's studies: ``"study/method"`` -> planner.

    Examples
    --------
    >>> methods()["song2016/smooth"]
    'binary_genetic'
    """
    return {
        f"{key}/{name}": study.planner(name)
        for key in _keys()
        for study in [_study(key)]
        for name in study.methods
    }


def results(folder: str | File, experiment: str) -> pd.DataFrame:
    """The runs of an experiment as one table, with the bounds of their problems and their times.

    Parameters
    ----------
    folder : str or Path
        Results of a study at a scale, such as ``"results/full/song2016"``.
    experiment : str
        Name of one of its experiments, such as ``"routes"``.

    Returns
    -------
    DataFrame
        A row a run; results/README.md explains the columns.

    Raises
    ------
    ValueError
        If there are no such results, or they are damaged.
    """
    from bezierplan.running.chunk import chunk_files
    from bezierplan.schema.checked import closest

    runs_folder = File(folder) / "runs"
    if not runs_folder.is_dir():
        raise ValueError(
            f"folder: {folder}: no runs here; expected results of a study, such as "
            "results/full/song2016"
        )
    runs: dict[str, list[str]] = {}
    for chunk in chunk_files(runs_folder, f"{escape(experiment) or '-'}/*/*.parquet"):
        runs.setdefault(chunk.parent.name, []).append(str(chunk))
    if not runs:
        known = [each.name for each in runs_folder.iterdir()]
        raise ValueError(
            f"experiment: {experiment}: no runs of it in {runs_folder}{closest(experiment, known)}"
        )
    from bezierplan.analysis import results as stored
    from bezierplan.running.inputs import Files

    made = File(folder) / "problems" / experiment
    return stored.read(
        Files(runs, f"{made}.parquet", f"{made}.bounds.parquet"), 10**9, experiment
    ).runs


def replay(run: str) -> Answer:
    """Run one run of the project's studies again, bit for bit.

    Parameters
    ----------
    run : str
        Its name: ``"study/experiment/condition/method/repeat"``.

    Returns
    -------
    Answer

    Raises
    ------
    ValueError
        States the unknown part of the name; a drive through a moving world has no single path and
        is replayed at the command line.
    """
    from bezierplan.analysis.results import path_of
    from bezierplan.planners import planner_module, planner_settings
    from bezierplan.running import problems
    from bezierplan.study import replays

    made = replays.replay(run, {key: _study(key) for key in _keys()})
    row, study, method = made.runs.iloc[0], run.split("/")[0], run.split("/")[3]
    if made.worlds:
        raise ValueError(
            f"run: {run}: is a drive; "
            "expected a run in a world that stands still, or `bezierplan replay`"
        )
    names = planner_settings(planner_module(row["planner"]))
    problem = made.problems[row["problem"]]
    judged = verdict(problem, path_of(row), shortest_path(problem).length, problems.remembered())
    return Answer(
        **judged,
        turning_radius=float(row.get("least_radius", math.nan)),
        method=f"{study}/{method}",
        settings={name: row[name] for name in names},
        claimed_feasible=bool(row["claimed_feasible"]),
        objective=float(row["objective"]),
        evaluations=int(row["evaluations"]),
        history=np.array(row["history"], dtype=float),
        stop=str(row["stop"]),
    )
