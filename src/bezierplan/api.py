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
from bezierplan.workspaces.footprint import Footprint
from bezierplan.workspaces.footprint import footprint as outline_of
from bezierplan.workspaces.grid import Grid as Grid
from bezierplan.workspaces.polygons import Polygons as Polygons
from bezierplan.workspaces.problem import Path, Problem, Workspace

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.geometry.samples import Samples
    from bezierplan.planners import Plan
    from bezierplan.running.planning import Course, Task
    from bezierplan.running.problems import Placed, Regions

__all__ = bezierplan.__all__

Method = str | Callable[..., Any] | ModuleType
Via = Sequence[tuple[float, float]]
Corners = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Judged:
    """A path and the certified checker's verdict on it.

    Attributes
    ----------
    problem : Problem
        On the map for the robot's centre: of the kind that was given, and if that is turned, so.
    path : Path or None
        In the world, as all points and headings are; None if there is none to judge.
    length : float
        Exact arc length, in the map's unit; nan without a path.
    feasible : bool
        Whether the path stays out of every obstacle and within the border; with a footprint,
        whether that does.
    collision : tuple of float or None
        The first point (x, y) of the path at which it or the footprint enters an obstacle.
    depth : float
        How deeply the path itself enters, in the map's unit; 0 if it does not.
    clearance : float
        Least distance of the path, or of the footprint along it, to an obstacle or the border of
        the map itself, in the map's unit; 0 if it enters one.
    robot_radius : float
        The clearance that a feasible path keeps, in the map's unit; of a footprint, the radius of
        the circle within it.
    footprint : Footprint or None
        The robot's outline, which turns with the direction of travel.
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
    footprint: Footprint | None
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
        from bezierplan.geometry import curves, samples
        from bezierplan.workspaces.frames import frame_of

        frame = frame_of(self.problem.workspace)
        found = samples.along(curves.inward(self._path(), frame), n, step)
        x, y = frame.outward(np.column_stack([found.x, found.y])).T
        return found._replace(x=x, y=y, heading=frame.outward_headings(found.heading))

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
        placed = problems.placed(self.problem, regions)
        parts = legs.legs(placed, self.via, regions)
        bound = legs.whole(legs.shortest(parts, regions(placed.near.workspace)))
        own = self.problem._replace(workspace=original(self.problem.workspace))
        shortest = placed.frame.outward(bound.points)
        drawn_path.draw(axes, own, self.path, shortest, self.collision)
        return axes

    def to_picture(self, file: str | File) -> None:
        """Draw the same with a legend into a file whose suffix matplotlib knows, such as .svg or
        .png.
        """
        from bezierplan.figures import drawn_path

        drawn_path.save(File(file), self.plot)

    def to_csv(
        self,
        file: str | File,
        *,
        step: float | None = None,
        speed: float | None = None,
        lateral_acceleration: float | None = None,
        acceleration: float | None = None,
    ) -> None:
        """Write distance, x, y, heading and curvature along the path, and with a speed also speed
        and time.

        Parameters
        ----------
        file : str or Path
            A .csv file.
        step : float, optional
            As in `sample`, by default a thousandth of the length.
        speed : float, optional
            The largest speed, in the map's unit a second.
        lateral_acceleration : float, optional
            The largest acceleration across the path, in units a second squared: speed is at most
            the root of this over the curvature.
        acceleration : float, optional
            The largest acceleration along the path, in units a second squared; with one, the path
            begins and ends at rest.

        Raises
        ------
        ValueError
            If there is no path, for a number that is not above 0, for an acceleration without a
            speed, and for a lateral one on a path with corners, where none is small enough.
        """
        from bezierplan.geometry import path_files, samples

        limits = {"lateral_acceleration": lateral_acceleration, "acceleration": acceleration}
        samples.check_limits(speed, limits)
        if lateral_acceleration is not None and self.corners:
            raise ValueError(
                f"lateral_acceleration: {lateral_acceleration:g}: the path has corners, which no "
                f"speed keeps it at; expected a turning radius that is kept"
            )
        points = self._spaced(step)
        more = {}
        if speed is not None:
            allowed = samples.speeds(
                points, speed, lateral_acceleration or math.inf, acceleration or math.inf
            )
            more = {"speed": allowed, "time": samples.times(points, allowed)}
        path_files.write_csv(File(file), points, more)

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
        Radius of the tightest turn, where the planner is `rounded_shortest_path` or
        `dubins_search`: 0 where a corner is left, infinite without turns; nan of other planners.
    planned_radius : float
        Radius of the disc for which the path was planned, in the map's unit: with a footprint, from
        the circle within it to that around it.
    offset : float
        Least distance of the path from what the shortest path turns around, where the setting
        `offset` asks for one; nan elsewhere.
    """

    method: str
    settings: dict[str, Any]
    claimed_feasible: bool
    objective: float
    evaluations: int
    history: np.ndarray = field(repr=False)
    stop: str
    turning_radius: float
    planned_radius: float
    offset: float = math.nan


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
        GeoJSON polygons (.geojson, .json), as GIS programs write them, also in projected
        coordinates; an occupancy map of ROS's map_server (.yaml), or an image alone (.png, .pgm,
        .bmp); a MovingAI grid (.map), cells as text (.txt), or shapes of a drawing (.svg).
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
        dark pixels are occupied. Of a drawing: length of a user unit, 1 by default.
    unknown : {"occupied", "free"}, optional
        What pixels of a ROS map or an image count as that are unknown; occupied by default.
    most_pixels : int, optional
        The most pixels of an image.

    Returns
    -------
    Grid or Polygons
        With a `robot_radius`, a grid has the grown obstacles as polygons in its field `drawn`. A
        ROS map that is turned is a grid with a `yaw`: its cells, bounds and polygons are told as
        before it is turned about its `origin`, but start, target, way points and headings, and all
        that is answered, are in the world.

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
    _, near, frame = problems.placed(problem, regions)
    bound = shortest_paths.shortest_path(near, blocked=regions(near.workspace))
    return Shortest(bound.length, frame.outward(bound.points))


def check(problem: Problem, path: Path, footprint: Corners | None = None) -> Judged:
    """Judge any path by exact geometry.

    Parameters
    ----------
    problem : Problem
    path : Path
        A curve kind and its control points (n, 2); its ends need not be those of the problem.
    footprint : sequence of tuple of float, optional
        Corners (x, y) of the robot, a convex polygon, in the map's unit: x ahead and y to the left
        of the point that follows the path. At a corner of the path the robot turns on the spot.

    Returns
    -------
    Judged

    Raises
    ------
    ValueError
        For a curve kind that is unknown, points of the wrong shape, or coordinates that are not
        finite or too large; for a footprint that is not convex, or on a map that has grown by a
        robot's radius.

    Examples
    --------
    >>> room = Grid(np.zeros((4, 4), dtype=bool), cell=1.0, unit="m")
    >>> across = Problem("room", room, (0.5, 0.5), (3.5, 0.5))
    >>> bend = Path("bezier", np.array([(0.5, 0.5), (2.0, 3.0), (3.5, 0.5)]))
    >>> judged = check(across, bend)
    >>> judged.feasible, round(judged.length, 3), round(judged.clearance, 3)
    (True, 4.071, 0.5)
    """
    from bezierplan.geometry import curves, shortest_paths
    from bezierplan.running import answer, footprints, problems

    _check_problem(problem)
    _check_path(path)
    regions = problems.remembered()
    outline = None if footprint is None else outline_of(footprint)
    footprints.check_map(outline, problem.workspace, 0.0)
    placed = problems.placed(problem, regions)
    bound = shortest_paths.shortest_path(placed.near, blocked=regions(placed.near.workspace))
    points = np.array(path.points, dtype=float)
    inward = answer.path_of(curves.inward(Path(path.curve, points), placed.frame))
    judged = verdict(placed, inward, bound.length, regions, footprint=outline)
    return Judged(**judged | {"path": path})


def verdict(
    problem: Placed,
    path: Path | None,
    shortest: float,
    regions: Regions,
    via: Via = (),
    footprint: Footprint | None = None,
) -> dict[str, Any]:
    """The fields of `Judged` for a path, or for none.

    path: in the frame of the map. shortest: length of the exact shortest path. regions: the blocked
    regions of maps. Raises ValueError if the path is feasible and yet closer to the map's own
    obstacles than the robot's radius, so that the checker is wrong.
    """
    from bezierplan.analysis.measures import CURVATURE_SAMPLES
    from bezierplan.geometry import checker, curves
    from bezierplan.geometry.checker.footprint import check_footprint
    from bezierplan.geometry.curvature_bound import largest_curvature
    from bezierplan.workspaces import robot
    from bezierplan.workspaces.grown import grown_of, original

    world, near, frame = problem
    grown = grown_of(near.workspace)
    asked = {
        "problem": world,
        "robot_radius": grown.radius if grown else 0.0,
        "via": tuple(via),
        "shortest": shortest,
        "footprint": footprint,
    }
    if path is None:
        numbers = ("length", "depth", "clearance", "curvature", "curvature_bound", "curvature_jump")
        nothing = {"path": None, "feasible": False, "collision": None, "corners": False}
        return asked | nothing | dict.fromkeys(numbers, math.nan)
    pieces = curves.bezier_pieces(path)
    verdict = checker.check(pieces, regions(near.workspace))
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
    feasible, collision_at = verdict.feasible, verdict.collision_at
    if footprint and feasible:
        feasible, collision_at, clearance, _ = check_footprint(
            pieces, regions(original(near.workspace)), footprint
        )
    collision = None if feasible else frame.outward(curves.point_at(path, collision_at))
    return asked | {
        "path": curves.outward(path, frame),
        "length": curves.length(path),
        "feasible": feasible,
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
    footprint: Corners | None = None,
    via: Via = (),
    via_order: str = "given",
    smooth: str = "arcs",
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
    footprint : sequence of tuple of float, optional
        In place of a radius: corners (x, y) of the robot, a convex polygon, x ahead and y to the
        left of the point that follows the path. Discs are planned for, from the circle within the
        footprint to that around it, until the footprint itself is free along the path.
    via : sequence of tuple of float
        Way points (x, y), in their order: the path joins paths from one to the next. For the
        planners without a method, `dubins_search` and `shortest_path`.
    via_order : {"given", "shortest"}
        Whether the path passes the way points as they are given, or in the order in which the exact
        shortest path through all of them is shortest; of at most 12.
    smooth : {"arcs", "continuous"}
        Whether the path turns along arcs, or with a curvature that rises and falls along
        transitions, wherever there is room for these. For the planners without a method and
        `dubins_search`.
    strict : bool
        Whether a turning radius that cannot be kept everywhere is an error, a footprint that is
        free along no path, and a curvature that should be continuous and jumps. For the planners
        without a method and `dubins_search`.
    **settings
        Settings in place of the method's own. Without a method: `turning_radius`; `start_heading`
        and `target_heading`, directions at the ends, in radians counterclockwise from the x-axis,
        None for any.

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
    from bezierplan.running import footprints, legs, planning, problems, tours

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
    (name, module, preset), regions = _method(method, problem, settings), problems.remembered()
    planner = _own_name(module)
    legs.check_planner(planner, planner or name, via, strict, smooth)
    tours.check_order(via_order, via)
    outline = None if footprint is None else outline_of(footprint)
    footprints.check_map(outline, problem.workspace, robot_radius)
    chosen = preset | settings

    def place(radius: float, first: Course | None) -> Course:
        grown = _grown(problem, robot_radius if outline is None else radius)
        placed = problems.placed(grown, regions, getattr(module, "workspaces", None))
        if first is None:
            _check_settings(name, module, chosen, placed.near)
        order = first.via if first else tours.ordered(via_order, placed, via, regions)
        return planning.course(placed, order, regions)

    # A user's file is executed in this process, as all that a program imports.
    task = planning.Task(f"planner {name}", planner, module.plan, chosen, smooth, seed)
    answer, _ = answered(task, name, outline, place, regions)
    if strict:
        check_strict(answer, smooth)
    return answer


def answered(
    task: Task,
    method: str,
    outline: Footprint | None,
    place: Callable[[float, Course | None], Course],
    regions: Regions,
) -> tuple[Answer, float]:
    """The answer to a task, by the name of a method, and the CPU seconds that the planner took.

    outline: the robot's footprint, for which paths are planned for larger and larger discs, until
    the footprint is free along one. place: the course for a disc of a radius, which it may ignore
    without an outline; it also gets the course for the smallest disc, None for that one itself,
    whose map and shortest path all are judged by. It raises ValueError for a disc without room.
    Raises ValueError, beginning with the task's name, if the planner fails or the verdict on its
    path is impossible.
    """
    from bezierplan.running import footprints, planning
    from bezierplan.running.watchdog import PlannerFailure

    def attempt(radius: float, first: tuple | None) -> tuple[Course, Answer, float] | None:
        try:
            course = place(radius, first[0] if first else None)
        except ValueError:
            if first is None:
                raise
            return None
        try:
            plan, seconds = planning.planned(task, course)
        except PlannerFailure as failure:
            raise ValueError(str(failure)) from failure
        if first and plan.path is None:
            return None
        home = first[0] if first else course
        return course, _judged(task, method, course, plan, home, regions, outline), seconds

    if outline is None:
        found = attempt(0.0, None)
    else:
        found = footprints.first_that_holds(outline, attempt, lambda each: each[1].feasible)
    _, answer, seconds = found
    return answer, seconds


def check_strict(answer: Answer, smooth: str) -> None:
    """Raise ValueError, beginning with a name, for a path that is not all that was asked for.
    smooth: as it was asked for.
    """
    from bezierplan.running import footprints, legs

    unit, settings = answer.problem.workspace.unit, answer.settings
    footprints.check_held(answer.footprint, answer.feasible)
    legs.check_continuous(smooth, answer.curvature_jump, answer.curvature_bound, unit)
    legs.check_kept(settings["turning_radius"], answer.turning_radius, unit)
    legs.check_offset(settings.get("offset"), answer.offset, unit)


def _judged(
    task: Task,
    method: str,
    course: Course,
    plan: Plan,
    home: Course,
    regions: Regions,
    outline: Footprint | None,
) -> Answer:
    """The answer with its verdict. home: the course on whose map and by whose shortest path the
    path is judged.
    """
    from bezierplan.geometry import shortest_paths
    from bezierplan.running import legs
    from bezierplan.workspaces.grown import grown_of

    shortest, grown = home.shortest, grown_of(course.problem.near.workspace)
    try:
        judged = verdict(home.problem, plan.path, shortest.length, regions, course.via, outline)
    except ValueError as fault:
        raise ValueError(f"{task.name}: {fault}") from None
    if judged["feasible"] and judged["length"] < shortest_paths.least_length(shortest):
        raise ValueError(
            f"{task.name}: its path is {judged['length']:.12g} long and feasible, but no free path "
            f"is shorter than {shortest.length:.12g}: the checker or the bound is wrong"
        )
    return Answer(
        **judged,
        turning_radius=legs.kept(task.planner, plan, task.settings),
        planned_radius=grown.radius if grown else 0.0,
        offset=plan.extra.get("least_offset", math.nan),
        method=method,
        settings=task.settings,
        claimed_feasible=plan.claimed_feasible,
        objective=plan.objective,
        evaluations=plan.evaluations,
        history=plan.history,
        stop=plan.stop,
    )


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


def _grown(problem: Problem, radius: float) -> Problem:
    from bezierplan.workspaces import robot

    return problem._replace(workspace=robot.grow(problem.workspace, radius))


class _Function:
    """A planner's function in the place of its module."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.plan = function


def _method(
    method: Method | None, problem: Problem, settings: Mapping[str, Any]
) -> tuple[str, Any, dict[str, Any]]:
    """Name, module and settings of a method; without one, of a planner that has the given
    settings.
    """
    from bezierplan.planners import is_file, known_planners, planner_module
    from bezierplan.running import interface, legs
    from bezierplan.schema.checked import closest

    if method is None:
        method = legs.default(settings)
    if isinstance(method, str) and method in legs.TURNING:
        return method, planner_module(method), legs.preset(method, problem.workspace)
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
    home = problems.Placed(problem, problem)
    judged = verdict(home, path_of(row), shortest_path(problem).length, problems.remembered())
    return Answer(
        **judged,
        turning_radius=float(row.get("least_radius", math.nan)),
        planned_radius=judged["robot_radius"],
        method=f"{study}/{method}",
        settings={name: row[name] for name in names},
        claimed_feasible=bool(row["claimed_feasible"]),
        objective=float(row["objective"]),
        evaluations=int(row["evaluations"]),
        history=np.array(row["history"], dtype=float),
        stop=str(row["stop"]),
    )
