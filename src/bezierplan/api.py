"""The public interface: `import bezierplan as bp`, then `bp.plan`, `bp.check`, `bp.shortest_path`
and the rest.

The command line and the documentation use the same functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache, partial
from pathlib import Path as File
from types import ModuleType
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from bezierplan.analysis import judgement
from bezierplan.figures import drawn_path, style
from bezierplan.geometry import path_files, samples, shortest_paths
from bezierplan.places import STUDIES, require_extra
from bezierplan.planners import is_file, list_planners, load_planner
from bezierplan.running import planning
from bezierplan.running import problems as problem_files
from bezierplan.running.answer import read_path
from bezierplan.running.guard import interface
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.schema.checked import check_all, check_known
from bezierplan.workspaces import map_files, robot
from bezierplan.workspaces.circles import Circles as Circles
from bezierplan.workspaces.grid import Grid as Grid
from bezierplan.workspaces.grown import original
from bezierplan.workspaces.kinds import naming
from bezierplan.workspaces.limits import Place
from bezierplan.workspaces.polygons import Polygons as Polygons
from bezierplan.workspaces.problem import Path, Problem, Workspace
from bezierplan.workspaces.sound import check_map

# What plots and studies need takes long to import, so functions import it.
if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

Method = str | Callable[..., Any] | ModuleType
Entry = Method | None | tuple[Method | None, Mapping[str, Any]]


@dataclass(frozen=True, kw_only=True)
class Judgement:
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
        True if the path stays out of every obstacle and within the border.
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
    curvature_jump : float
        Its largest jump between two pieces of the path; infinite at a corner.
    corners : bool
        True if the direction of travel jumps somewhere.
    shortest : float
        Length of the exact shortest path, through the way points; infinite if there is none.
    shortest_points : ndarray
        Its points, (n, 2).
    via : tuple of tuple of float
        Way points (x, y) between start and target.
    """

    problem: Problem = field(repr=False)
    path: Path | None = field(repr=False, default=None)
    length: float = math.nan
    feasible: bool = False
    collision: Place | None = None
    depth: float = math.nan
    clearance: float = math.nan
    curvature: float = math.nan
    curvature_jump: float = math.nan
    corners: bool = False
    shortest: float
    shortest_points: np.ndarray = field(repr=False)
    robot_radius: float
    via: tuple[Place, ...] = ()

    @property
    def gap(self) -> float:
        """Return how much longer the path is than the exact shortest one, as a share of that."""
        # Where the start is the target, the shortest path has no length.
        return self.length / self.shortest - 1 if self.shortest else 0.0

    def sample(self, n: int | None = None, *, step: float | None = None) -> samples.Samples:
        """Return points at equal distances along the path, with heading and curvature.

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

        Examples
        --------
        >>> room = Grid(np.zeros((4, 4), dtype=bool), cell=1.0, unit="m")
        >>> answer = plan(Problem("room", room, start=(0.5, 0.5), target=(3.5, 0.5)))
        >>> answer.sample(3).x.round(9).tolist()
        [0.5, 2.0, 3.5]
        """
        if self.path is None:
            raise ValueError("no path was found, so there is nothing to sample or to write")
        return samples.sample_along(self.path, n, step)

    def plot(self, axes: Axes | None = None, *, map: bool = True, **look: Any) -> Axes:
        """Draw the path on its map, with the exact shortest path.

        Parameters
        ----------
        axes : Axes, optional
            Matplotlib's, by default new ones.
        map : bool
            Draw the map, its ends and the exact shortest path as well.
        **look
            Properties of the path's line, such as `label` and `color`.

        Returns
        -------
        Axes
        """
        problem = self.problem._replace(workspace=original(self.problem.workspace))
        parts = self.path, self.shortest_points, self.collision
        return drawn_path.draw(problem, axes, *parts, map=map, **look)

    def save(self, file: str | File, *, step: float | None = None) -> None:
        """Write the path into a file of the kind that its suffix names.

        Parameters
        ----------
        file : str or Path
            What `plot` draws, with a legend (.svg, .png, .pdf); distance, x, y, heading and
            curvature along the path (.csv); a line with the verdict (.geojson); a `nav_msgs/Path`
            message as `ros2 topic pub` reads it (.yaml); or all fields of the answer (.json), in
            which null is what JSON has no number for.
        step : float, optional
            Distance of points, as in `sample`; by default a thousandth of the length.

        Raises
        ------
        ValueError
            For points without a path.
        """
        file, values = File(file), {each.name: getattr(self, each.name) for each in fields(self)}
        del values["problem"]
        if file.suffix in path_files.WRITERS:
            # A path of no length has two samples, whatever their distance.
            points = self.sample(step=(self.length / 1000 or 1.0) if step is None else step)
            path_files.WRITERS[file.suffix](file, points, values)
        elif file.suffix == ".json":
            path_files.write_json(file, values | {"gap": self.gap})
        else:
            drawn_path.save(file, self.plot)

    def _repr_html_(self) -> str:
        """Return the picture and what the command line prints, for notebooks."""
        return drawn_path.build_html(judgement.write_html(self), self.plot)


@dataclass(frozen=True, kw_only=True)
class Answer(Judgement):
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
        Radius of the tightest round turn, where the planner is `rounded_shortest_path`: infinite
        without turns, 0 if all of them are corners; nan of other planners.
    cpu_s : float
        CPU time of the planner, in seconds; nan of a run of a study.
    """

    method: str
    settings: dict[str, Any] = field(default_factory=dict)
    claimed_feasible: bool
    objective: float
    evaluations: int
    history: np.ndarray = field(repr=False)
    stop: str
    turning_radius: float = math.nan
    cpu_s: float = math.nan


@dataclass(frozen=True)
class Comparison:
    """Answers of several methods to the same problems.

    Attributes
    ----------
    answers : dict of str to list of Answer
        By the label of the method, in the order of problems and seeds.
    """

    answers: dict[str, list[Answer]]

    @property
    def runs(self) -> pd.DataFrame:
        """Return the fields of all answers, one row each, with method (its label) and problem (its
        name).
        """
        import pandas as pd

        return pd.DataFrame(
            vars(each) | {"method": label, "problem": each.problem.name}
            for label, own in self.answers.items()
            for each in own
        )

    @property
    def table(self) -> pd.DataFrame:
        """Return a row for each method, the best one first.

        Columns: problems, runs, and feasible, the share of runs whose path is free. Length, excess
        (over the exact shortest path, as a share) and curvature are medians over the free paths;
        evaluations and cpu_s are medians over all runs. Rank is the mean rank on a problem: by the
        share of free paths, then by the excess.
        """
        from bezierplan.analysis.numbers import benchmark

        return benchmark.rank_methods(benchmark.compute_summaries(self.runs))

    def plot(self, axes: Axes | None = None, problem: str = "") -> Axes:
        """Draw the best path of each method on one map, with a legend: the shortest free one.

        Parameters
        ----------
        axes : Axes, optional
            Matplotlib's, by default new ones.
        problem : str, optional
            Its name, by default that of the first one.

        Returns
        -------
        Axes
        """
        draws = self._draws()
        problem = problem or next(iter(draws))
        check_known(problem, draws, "problem")
        axes = draws[problem](axes)
        drawn_path.add_legend(axes.figure)
        return axes

    def save(self, file: str | File) -> None:
        """Save what `plot` draws, for at most 12 problems, as a picture (.svg, .png, .pdf)."""
        drawn_path.save(File(file), *self._draws().values())

    def _draws(self) -> dict[str, partial]:
        """Return the function that draws each problem, by its name."""
        names = (each.problem.name for own in self.answers.values() for each in own)
        return {name: partial(self._draw, name) for name in names}

    def _draw(self, problem: str, axes: Axes | None) -> Axes:
        """Draw the best path of each method on a problem."""
        looks = style.choose_line_styles([*self.answers], style.LOOK_OF_PLANNER)
        for number, (label, answered) in enumerate(self.answers.items()):
            own = [each for each in answered if each.problem.name == problem]
            # Without a path the length is nan, which no order ranks, so a path comes before none.
            best = max(own, key=lambda each: (each.feasible, each.path is not None, -each.length))
            named = {"label": label + " (no free path)" * (not best.feasible), "marker": ""}
            # The first path brings the map and the exact shortest path for all.
            axes = best.plot(axes, map=not number, **looks[number] | named)
            axes.set_title(problem)
        return axes

    def _repr_html_(self) -> str:
        """Return the picture and the table, for notebooks."""
        return drawn_path.build_html(
            self.table.to_html(float_format="%.4g"), *self._draws().values()
        )


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
) -> Workspace:
    """Read a map from a file.

    Parameters
    ----------
    file : str or Path
        GeoJSON polygons (.geojson, .json); an occupancy map of ROS's map_server (.yaml), or an
        image alone (.png, .pgm, .bmp); or cells as text (.txt).
    cell : float, optional
        Side of a cell. Text has cells, by default of side 1. Polygons become a grid, for methods
        that need cells.
    rule : {"overlap", "centre"}, optional
        Which cells polygons occupy; overlap by default.
    robot_radius : float, optional
        Radius of the robot, in the map's unit: obstacles grow by it and the border shrinks.
        Verdicts tell the clearance to the map itself.
    unit : str, optional
        Name of the unit of length; by default m, of grids cell.
    margin : float, optional
        For GeoJSON without a border: how far the border lies from the obstacles, in the map's unit.
    resolution : float, optional
        For an image alone: side of a pixel, in the map's unit. The lower left corner of the image
        is at 0, 0, and dark pixels are occupied.
    unknown : {"occupied", "free"}, optional
        How unknown pixels of a ROS map or an image count; occupied by default.

    Returns
    -------
    Grid or Polygons
        With a `robot_radius`, a grid has the grown obstacles as polygons in its field `shapes`.

    Raises
    ------
    ValueError
        Names file, place and what is expected.

    Examples
    --------
    >>> room = read_map(example_map("gaps"))
    >>> room.bounds, len(room.obstacles)
    ((0.0, 20.0, 0.0, 20.0), 6)
    >>> read_map(example_map("gaps"), cell=1.0, robot_radius=0.3).occupied.shape
    (20, 20)
    """
    described = map_files.describe(
        File(file),
        cells=cell is not None,
        cell=cell,
        rule=rule,
        unit=unit,
        margin=margin,
        resolution=resolution,
        unknown=unknown,
    )
    return map_files.read(File(file), described, robot_radius)


def example_map(name: str) -> File:
    """Return the file of a map of the studies, such as ``"gaps"`` or ``"figure2"``. Raises
    ValueError.

    >>> example_map("gaps").name
    'gaps.geojson'
    """
    files = {file.stem: file for file in STUDIES.glob("*/workspaces/*.[gt]*")}
    check_known(name, files, "map")
    return files[name]


def shortest_path(problem: Problem) -> shortest_paths.Bound:
    """Return the exact shortest path of a point from start to target.

    Parameters
    ----------
    problem : Problem
        A map with start and target.

    Returns
    -------
    Bound
        Its length, in the map's unit (infinite without a free path), and its points (n, 2): among
        circles a polyline within 1e-6 of the path.

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
    _check_problem(problem)
    return shortest_paths.shortest_path(problem_files.place_problem(problem))


def check(problem: Problem, path: Path) -> Judgement:
    """Judge any path by exact geometry.

    Parameters
    ----------
    problem : Problem
    path : Path
        A curve kind and its control points (n, 2); its ends need not be those of the problem.

    Returns
    -------
    Judgement

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
    _check_problem(problem)
    if not isinstance(path, Path) or not _has_numbers(path.points, len(path.points), 2):
        raise ValueError("path: expected a Path whose points are an array of numbers, (n, 2)")
    plain = read_path(Path(path.curve, np.array(path.points, dtype=float)))
    home = problem_files.place_problem(problem)
    bound = shortest_paths.shortest_path(home)
    # The verdict is about the plain copy; the caller gets the path that was given.
    return Judgement(**judgement.compute_judgement(home, bound, plain) | {"path": path})


def plan(
    problem: Problem,
    method: Method | None = None,
    *,
    seed: int = 0,
    robot_radius: float = 0.0,
    via: Sequence[Place] = (),
    **settings: Any,
) -> Answer:
    """Plan one path and judge it by exact geometry.

    Parameters
    ----------
    problem : Problem
    method : str, module or callable, optional
        A study's method such as ``"song2016/smooth"``, whose settings are the defaults; a planner
        such as ``"prm"``, with the settings of the first study, by name, that uses it; the path of
        a planner's file; or a planner's module or its function ``plan``. By default the exact
        shortest path with rounded corners.
    seed : int
        Seed of the random numbers.
    robot_radius : float
        Radius of the robot, in the map's unit: obstacles grow by it and the border shrinks. 0 if
        the map was read with one.
    via : sequence of tuple of float
        Way points (x, y), in their order: the path joins paths from one to the next, with a corner
        where their directions differ. For the planner without a method and `shortest_path`.
    **settings
        Settings in place of the method's own. If no method is given: `turning_radius`, the smallest
        radius that turns should have, and `excess`, the share by which the path may be longer than
        the shortest. With neither, turns are as wide as a path at most 1 % longer allows.

    Returns
    -------
    Answer

    Raises
    ------
    ValueError
        For an unknown method, a wrong setting, a start in an obstacle, or a map that the planner
        does not serve; names the argument or the setting and what is expected.
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
    (True, 9.247, 0.5)
    """
    (answer,) = _answer([problem], method, 1, settings, seed, robot_radius, via)
    return answer


def compare(
    problem: Problem | Mapping[str, Problem],
    methods: Sequence[Entry] | Mapping[str, Entry],
    *,
    repeats: int = 20,
    **options: Any,
) -> Comparison:
    """Plan by several methods, and judge all paths by exact geometry.

    Parameters
    ----------
    problem : Problem or dict of str to Problem
        One, or several such as `problems` gives.
    methods : sequence or dict
        Each as in `plan`, or a pair of a method and its settings; with labels as keys, or under
        their names.
    repeats : int
        Runs of each method on each problem; one of a method that draws no random numbers.
    **options
        `seed` of the first run (the next one has the next), `robot_radius` and `via`, as in `plan`.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError
        For the same faults as in `plan`.
    TypeError
        For the same faults as in `plan`.

    Examples
    --------
    >>> wall = np.zeros((8, 8), dtype=bool)
    >>> wall[2:6, 3:5] = True
    >>> room = Grid(wall, cell=1.0, unit="m")
    >>> problem = Problem("a block", room, start=(0.5, 4.0), target=(7.5, 4.0))
    >>> compared = compare(problem, ["shortest_path", "straight_line"])
    >>> compared.table["feasible"].to_dict()
    {'shortest_path': 1.0, 'straight_line': 0.0}
    """
    asked = [problem]
    if isinstance(problem, Mapping):
        # Answers are told apart by the names of their problems, so those must be the keys.
        asked = [each._replace(name=name) for name, each in problem.items()]
    pairs = methods.items() if isinstance(methods, Mapping) else ((None, each) for each in methods)
    answers: dict[str, list[Answer]] = {}
    for label, entry in pairs:
        method, settings = entry if isinstance(entry, tuple) else (entry, {})
        label = label or _name(method)
        if label in answers:
            raise ValueError(f"methods: {label}: twice; expected a dict with a label for each")
        answers[label] = _answer(asked, method, repeats, settings, **options)
    return Comparison(answers)


def _answer(
    problems: Sequence[Problem],
    method: Method | None,
    repeats: int,
    settings: Mapping[str, Any],
    seed: int = 0,
    robot_radius: float = 0.0,
    via: Sequence[Place] = (),
) -> list[Answer]:
    """Return the answers of a method to problems: `repeats` for each, with seeds in a row, or one
    if the method draws no random numbers.

    Raises ValueError and TypeError as `plan` does.
    """
    for name, value, least in (("seed", seed, 0), ("repeats", repeats, 1)):
        if not _has_numbers(value) or value < least or value % 1:
            raise ValueError(f"{name}: {value!r}; expected a whole number of at least {least}")
    if not _has_numbers(robot_radius):
        raise ValueError(f"robot_radius: {robot_radius!r}; expected a number of at least 0")
    if np.shape(via) != (0,) and not _has_numbers(via, len(np.atleast_1d(via)), 2):
        raise ValueError(f"via: {via!r}; expected places, each of x and y")
    places = tuple(map(tuple, np.array(via, dtype=float).tolist()))
    label, (planner, module, preset) = _name(method), _find_planner(method)
    if planner == planning.ROUNDED:
        preset |= planning.choose_rounding(settings)
    if places and planner not in planning.CHAINED:
        raise ValueError(f"via: only for {' and '.join(planning.CHAINED)}; the planner is {label}")
    settings = preset | {
        # numpy's numbers become Python's, which the types of settings accept.
        name: each.item() if isinstance(each, np.generic) else each
        for name, each in settings.items()
    }
    runs: list[planning.Run] = []
    for problem in problems:
        _check_problem(problem)
        grown = problem._replace(workspace=robot.grow(problem.workspace, float(robot_radius)))
        home = problem_files.place_problem(grown, getattr(module, "workspaces", None))
        check_settings(label, module, settings, home)
        legs = planning.split_into_legs(home, places)
        which = f"method: {label}" + f": {problem.name}" * (len(problems) > 1)
        run = planning.Run(which, home, legs, planning.find_shortest(legs), settings, int(seed))
        # Without random numbers, all repeats would be equal.
        again = 1 if getattr(module, "deterministic", False) else int(repeats)
        runs += [run._replace(seed=run.seed + number) for number in range(again)]
    answered: list[Answer] = []
    try:
        # An empty name lets the planner run in this process.
        for run, plan, cpu_s in planning.yield_plans(module.plan, runs, planner * is_file(planner)):
            judged = judgement.compute_judgement(
                run.problem, run.bound, plan.path
            ) | judgement.list_planner_fields(plan)
            # This checks our own geometry, not the planner.
            if judged.get("feasible") and judged["length"] < shortest_paths.least_length(run.bound):
                raise ValueError(
                    f"its path is {judged['length']:.12g} long and feasible, but no free path is "
                    f"shorter than {run.bound.length:.12g}: the checker or the bound is wrong"
                )
            answered.append(
                Answer(**judged, method=label, settings=settings, via=places, cpu_s=cpu_s)
            )
    except PlannerFailure as failure:
        raise ValueError(str(failure)) from failure
    except ValueError as fault:
        # Answers come in the order of runs, so the fault is of the first run without one.
        raise ValueError(f"{runs[len(answered)].label}: {fault}") from None
    return answered


def plan_all(
    workspace: Workspace, file: str | File, method: Method | None = None, **options: Any
) -> pd.DataFrame:
    """Plan and judge a path for each problem of a list.

    Parameters
    ----------
    workspace : Grid, Circles or Polygons
    file : str or Path
        A .csv file with the columns start_x, start_y, target_x, target_y, in the map's unit.
    method : str, module or callable, optional
        As in `plan`.
    **options
        As in `plan`.

    Returns
    -------
    DataFrame
        The file's rows with feasible, length, shortest, clearance, curvature and cpu_s.

    Raises
    ------
    ValueError
        For a missing column, and for the faults of `plan`, with the row of the file, from 1.
    """
    import pandas as pd

    rows, made = pd.read_csv(file), []
    ends = ["start_x", "start_y", "target_x", "target_y"]
    check_all(ends, rows, f"{file}: column")
    for number, (a, b, c, d) in enumerate(rows[ends].to_numpy().tolist(), 1):
        with naming(f"{file}: row {number}"):
            made.append(plan(Problem("", workspace, (a, b), (c, d)), method, **options))
    names = ["feasible", "length", "shortest", "clearance", "curvature", "cpu_s"]
    return rows.join(pd.DataFrame(map(vars, made), columns=names))


def _check_problem(problem: Problem) -> None:
    """Raise TypeError for anything but a problem on a map, and ValueError for ends without two
    numbers.
    """
    if not isinstance(problem, Problem) or not isinstance(problem.workspace, Workspace):
        raise TypeError(f"problem: {problem!r:.80}; expected a Problem on a map")
    check_map(problem.workspace)
    for name in ("start", "target"):
        place = getattr(problem, name)
        if not _has_numbers(place, 2):
            raise ValueError(f"{name}: {place!r}; expected x and y, two numbers")


def _has_numbers(values: Any, *shape: int) -> bool:
    """Return whether values are numbers in an array of a shape."""
    array = np.asarray(values)
    return array.dtype.kind in "fiu" and array.shape == shape


def _name(method: Method | None) -> str:
    """Return how messages call a method."""
    if method is None or isinstance(method, str):
        return method or planning.ROUNDED
    return getattr(method, "__name__", repr(method))


def _find_planner(method: Method | None) -> tuple[str, Any, dict[str, Any]]:
    """Return the planner of a method (a name of this package or a file, otherwise empty), the
    planner's module, and the method's settings.
    """
    if method is None or method == planning.ROUNDED:
        return planning.ROUNDED, load_planner(planning.ROUNDED), {}
    if isinstance(method, str):
        planner, preset = find_method(method)
        return planner, interface.load_planner_module(planner, f"method: {method}"), preset
    module = method
    if not isinstance(method, ModuleType):
        # A function alone gets a module, because checks read a planner's traits from one.
        module = ModuleType("planner_of_a_program")
        module.plan = method
    if fault := interface.find_interface_fault(module):
        raise TypeError(f"method: {_name(method)}: {fault}")
    return "", module, {}


def find_method(method: str) -> tuple[str, dict[str, Any]]:
    """Return the planner of a method, as a name of this package or a file, and its settings. The
    settings of a planner are those in the first study that uses it.

    method: ``STUDY/METHOD``, where STUDY is one of this project or a folder; a planner's name or
    file. Raises ValueError.
    """
    if is_file(method):
        return method, {}
    if method in list_planners():
        uses = [use for use, planner in _list_planners().items() if planner == method]
        return find_method(uses[0]) if uses else (method, {})
    key, _, name = method.rpartition("/")
    # A slip in the name of a method, or a study alone, is answered by the methods of that study.
    studies = [
        each
        for each in (key, method)
        if each and (_find_folder(each) / "experiments.yaml").is_file()
    ]
    known = [f"{study}/{each}" for study in studies for each in _read_study(study).methods]
    check_known(method, known or [*_list_planners(), *list_planners()], "method")
    return _read_study(key).planner(name), _read_study(key).resolve_settings(name)


def _find_folder(key: str) -> File:
    """Return the folder of a study of this project, or any other folder."""
    return STUDIES / key if key in _list_keys() else File(key)


@cache
def _read_study(key: str) -> Any:
    """Read the experiments of a study of this project, or of a folder; once in a process."""
    from bezierplan.study import experiments

    return experiments.read(_find_folder(key))


def _list_keys() -> list[str]:
    """Return the names of this project's studies."""
    return sorted(file.parent.name for file in STUDIES.glob("*/experiments.yaml"))


def check_settings(name: str, module: Any, settings: Mapping[str, Any], problem: Problem) -> None:
    """Raise ValueError unless a planner takes exactly these settings and serves this problem."""
    interface.refuse_unknown(module, settings, "settings")
    interface.check_settings(module, dict(settings), "settings")
    served = getattr(module, "workspaces", None)
    kind = interface.KINDS[type(problem.workspace)]
    if served is not None and kind not in served:
        cells = "grid" in served and kind == "polygons"
        raise ValueError(
            f"method: {name}: serves workspaces of kind {', '.join(served)}, and the map is {kind}"
            + ("; read it with a cell to have a grid" if cells else "")
        )
    if hasattr(module, "serves"):
        interface.ask(module.serves, f"method: {name}", problem)


def methods(*, all: bool = False) -> dict[str, tuple[str, ...]]:
    """Return the methods that the papers propose, each with the kinds of map that it serves, by
    ``"study/method"``.

    Parameters
    ----------
    all : bool
        Return all methods of the studies: rivals, variants and baselines as well.

    Examples
    --------
    >>> methods()["song2016/smooth"]
    ('grid',)
    """
    compared = {key: _read_study(key).baseline_comparison for key in _list_keys()}
    proposed = [f"{key}/{each.proposed}" for key, each in compared.items() if each]
    return {
        name: tuple(getattr(load_planner(planner), "workspaces", interface.KINDS.values()))
        for name, planner in _list_planners().items()
        if all or name in proposed
    }


def _list_planners() -> dict[str, str]:
    """Return the planners of the methods of the project's studies, by ``"study/method"``."""
    return {
        f"{key}/{name}": _read_study(key).planner(name)
        for key in _list_keys()
        for name in _read_study(key).methods
    }


def problems(experiment: str) -> dict[str, Problem]:
    """Return the problems of an experiment of the project's studies, by name.

    Parameters
    ----------
    experiment : str
        Such as ``"song2016/routes"``.

    Returns
    -------
    dict of str to Problem

    Raises
    ------
    ValueError
        For an unknown one.

    Examples
    --------
    >>> routes = problems("song2016/routes")
    >>> [*routes][:2], routes["0_15"].start
    (['0_15', '15_255'], (5.0, 5.0))
    """
    from bezierplan.study.experiments import build_problems_job

    key, _, name = experiment.partition("/")
    check_known(key, _list_keys(), "experiment: study")
    known = [f"{key}/{each}" for each in _read_study(key).experiments]
    check_known(experiment, known, "experiment")
    described = build_problems_job(_read_study(key), name, "full")
    return problem_files.build_all(described, _read_study(key).folder)[0]


def results(folder: str | File, experiment: str) -> pd.DataFrame:
    """Return the runs of an experiment as one table, with the bounds of their problems and their
    times.

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
    with require_extra():
        from bezierplan.analysis.results import read_folder

    return read_folder(File(folder), experiment).runs


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

    Examples
    --------
    >>> answer = replay("song2016/routes/15_240/shortest_path/0")
    >>> answer.feasible, round(answer.length, 3)
    (True, 220.849)
    """
    with require_extra():
        from bezierplan.study import replays

    reproduced = replays.replay(run, {key: _read_study(key) for key in _list_keys()})
    if reproduced.worlds:
        raise ValueError(f"run: {run}: is a drive; expected another, or `bezierplan replay`")
    return answer_of(reproduced, run)


def answer_of(rerun: Any, run: str) -> Answer:
    """Return the answer in the results of one run, by its name."""
    return Answer(**judgement.judge_run(rerun, run))


# Maps and problems lie in a layer below that of figures.
for kind in (Problem, *get_args(Workspace)):
    kind.plot = drawn_path.draw
    kind._repr_html_ = lambda home: drawn_path.build_html("", home.plot)
