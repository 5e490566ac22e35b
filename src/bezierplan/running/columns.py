"""Columns of the runs tables, each declared once, as an annotated field of a named tuple: its type,
its meaning and its unit. What a file of runs holds (`rows.table`), what is expected of it when it
is read (`rows.fault`), which names are taken, what a study may select by (`study.design`), and the
tables in results/README.md (`python docs/tables_of_keys.py`) follow.

A row is what is known before its run (`Planned`, with the place of its problem after `problem` and
its settings after `planner`), what the run found out (`Outcome`), for a drive more of that
(`DriveOutcome`), and the planner's own columns. Bounds and times are joined when it is read.
"""

import typing
from typing import Annotated, NamedTuple, NewType

from bezierplan.planners import PLACE


class Column(NamedTuple):
    """What a column means, in words for a table in Markdown; its unit, empty for a pure number;
    what it means of a drive, where that is something else.
    """

    meaning: str
    unit: str = ""
    drive: str = ""


RunName = NewType("RunName", str)

UNITS = "units"
STEPS = "steps"
SECONDS = "s"


class Planned(NamedTuple):
    """Known before a run, beside settings."""

    id: Annotated[
        RunName,
        Column("`study/experiment/condition/method/repeat`: all that the run's seed depends on"),
    ]
    study: Annotated[str, Column("the key of the study")]
    experiment: Annotated[str, Column("the name of the experiment")]
    condition: Annotated[str, Column("the problem and the values of varied settings")]
    problem: Annotated[str, Column("the name of the problem")]
    workspace: Annotated[str, Column("the name of its workspace")]
    method: Annotated[str, Column("the name of the method")]
    repeat: Annotated[int, Column("the number of the repeat, from 0")]
    planner: Annotated[str, Column("the method's planner")]


class Outcome(NamedTuple):
    """What every run finds out."""

    objective: Annotated[
        float,
        Column(
            "the planner's final objective value, by its own definition",
            drive="time of arrival times the pace, in units; infinite if it did not arrive",
        ),
    ]
    length: Annotated[
        float,
        Column(
            "exact arc length of the path; not a number without one",
            UNITS,
            "distance travelled, in units",
        ),
    ]
    claimed_feasible: Annotated[
        bool,
        Column(
            "the planner's own verdict on its path, recorded as it is",
            drive="did the robot arrive?",
        ),
    ]
    feasible: Annotated[
        bool,
        Column(
            "the certified check: exact geometry, independent of every planner, of a path that "
            "leads exactly from start to target (any "
            "other path is invalid and stops the job)",
            drive="did it arrive without a collision, by an exact check of its motion, also "
            "between steps?",
        ),
    ]
    collision_at: Annotated[
        float,
        Column(
            "number of the piece plus the parameter within it of the first collision",
            drive="when it first collided, in steps",
        ),
    ]
    collision_depth: Annotated[
        float, Column("depth of the path in obstacles or beyond the border", UNITS)
    ]
    clearance: Annotated[
        float, Column("least distance from the path to obstacles and the border", UNITS)
    ]
    clearance_error: Annotated[float, Column("proven error of the depth and the distance", UNITS)]
    evaluations: Annotated[int, Column("evaluations of the objective")]
    generations: Annotated[
        int, Column("generations after the first one", drive="plans after the first")
    ]
    stop: Annotated[str, Column("why the run ended")]
    history: Annotated[
        list[float],
        Column(
            "best objective after generation 0, 1, ...",
            drive="the distance travelled until each plan plus the length of that plan, in units",
        ),
    ]
    path_curve: Annotated[str, Column("the kind of the path's curve; empty without a path")]
    path_points: Annotated[
        list[float],
        Column(
            "its control points as x0, y0, x1, y1, ...; empty without a path",
            UNITS,
            "the path travelled, a polyline, in units",
        ),
    ]


class DriveOutcome(NamedTuple):
    """What drives find out beside it."""

    arrival: Annotated[float, Column("time of arrival; not a number if it did not arrive", STEPS)]
    steps: Annotated[float, Column("time until the end of the drive", STEPS)]
    travelled: Annotated[float, Column("distance travelled, whether or not it is free", UNITS)]
    first_plan: Annotated[float, Column("length of the first plan", UNITS)]
    last_plan: Annotated[float, Column("length of the last plan", UNITS)]
    last_optimum: Annotated[
        float,
        Column(
            "among cells: the least length that a last plan from cell centre to cell centre could "
            "have, with the distance to the first centre",
            UNITS,
        ),
    ]
    replans: Annotated[int, Column("plans after the first")]
    waits: Annotated[float, Column("time spent waiting", STEPS)]
    collision_steps: Annotated[int, Column("steps in which the robot was in an obstacle", STEPS)]
    hit_waiting: Annotated[bool, Column("did it stand when it first collided?")]
    clearance_least: Annotated[
        float, Column("least distance to an obstacle, negative inside a circle", UNITS)
    ]


class Bound(NamedTuple):
    """A row of a file of bounds."""

    problem: Annotated[str, Column("the name of the problem")]
    straight_line: Annotated[float, Column("distance from start to target", UNITS)]
    bound: Annotated[
        float,
        Column(
            "length of the exact shortest path; infinite without a free one",
            UNITS,
            "length of the shortest path through places that are free at some time, in units",
        ),
    ]
    least_length: Annotated[
        float, Column("the bound less an allowance for the checker's tolerance", UNITS)
    ]
    bound_path: Annotated[list[float], Column("the shortest path as x0, y0, x1, y1, ...", UNITS)]
    octile_bound: Annotated[
        float,
        Column(
            "on grids: the least of all lengths counted in cells, "
            "from cell to cell; otherwise not a number",
            UNITS,
        ),
    ]


class DriveBound(NamedTuple):
    """The rest of that row in a dynamic environment."""

    least_arrival: Annotated[float, Column("no robot arrives earlier", STEPS)]


class Times(NamedTuple):
    """A row of a file of times, which are not reproducible."""

    id: Annotated[RunName, Column("the run")]
    cpu_s: Annotated[float, Column("its CPU time", SECONDS)]
    wall_s: Annotated[float, Column("its wall-clock time", SECONDS)]


class DriveTimes(NamedTuple):
    """The rest of that row for a drive."""

    replan_mean_s: Annotated[float, Column("mean CPU time of the replans", SECONDS)]
    replan_95_s: Annotated[float, Column("their 95th percentile", SECONDS)]
    replan_max_s: Annotated[float, Column("the longest of these", SECONDS)]
    replans_late: Annotated[int, Column("how many took longer than a step")]


class Table(NamedTuple):
    """What declares the columns of a kind of file, and what declares those that it has beside them
    if its runs are drives.
    """

    every: tuple[type, ...]
    drives: type


TABLES = {
    "runs": Table((Planned, Outcome), DriveOutcome),
    "bounds": Table((Bound,), DriveBound),
    "times": Table((Times,), DriveTimes),
}
"""Kind of file -> its columns."""

TYPES = {
    RunName: "name",
    str: "word",
    int: "number",
    float: "number",
    bool: "flag",
    list[float]: "list",
}
"""Type of a value -> its word in studies' faults: a name is one for each run, a word is text, a
flag true or false.
"""


def declared(*tables: type) -> dict[str, tuple[type, Column]]:
    """Columns with the types of their values and what they mean."""
    return {
        name: typing.get_args(annotation)
        for table in tables
        for name, annotation in table.__annotations__.items()
    }


def _types(*tables: type) -> dict[str, str]:
    return {name: TYPES[kind] for name, (kind, _) in declared(*tables).items()}


PLANNED = _types(Planned)
"""Columns of every runs table known before a run, beside settings, with their types (`TYPES`)."""

RESULTS = _types(Outcome)
"""Likewise: those that a run finds out."""

RUN_COLUMNS = (*PLANNED, *RESULTS)
"""Columns of every runs table; the settings and a planner's extra columns stand between `planner`
and `objective`, and at the end.
"""

DRIVE_RESULTS = _types(DriveOutcome)
"""Columns of a runs table that only drives have."""

JOINED = {name: kind for name, kind in _types(Bound, Times).items() if name not in PLANNED}
"""Columns joined to a runs table when it is read: those of `problems.bounds_of`, and the times."""

DRIVE_JOINED = _types(DriveBound, DriveTimes)
"""Columns that are joined to the table of drives: of `worlds.bounds_of`, and the times of plans."""

WORDS = ("value", "statistic", "metric", "n", "unit", "table")
"""Columns of tables of results, beside those of the runs table that tell their rows apart."""

TAKEN = frozenset((*RUN_COLUMNS, *DRIVE_RESULTS, *PLACE, *JOINED, *DRIVE_JOINED))
"""Names that no planner's extra column can have; the job's settings and what it varies are others.
A setting cannot have them either.
"""
