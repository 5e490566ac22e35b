"""Columns of the runs tables, with the types of their values: of `execution`, of drives (`rides`), and what is joined to them when read;
and names that are taken by them.

| type | values |
| --- | --- |
| name | one for each run |
| word | text |
| number | numbers |
| flag | true or false |
| list | a list of numbers for each run |
"""

from bezierplan.planners import PLACE

PLANNED = {
    "id": "name",
    **dict.fromkeys(("study", "experiment", "condition", "problem", "workspace", "method"), "word"),
    "repeat": "number",
    "planner": "word",
}
"""Columns of every runs table that are known before a run, beside the settings."""

RESULTS = (
    {"objective": "number", "length": "number", "claimed_feasible": "flag", "feasible": "flag"}
    | dict.fromkeys(("collision_at", "collision_depth", "clearance", "clearance_error", "evaluations", "generations"), "number")
    | {"stop": "word", "history": "list", "path_curve": "word", "path_points": "list"}
)
"""Columns of every runs table that a run finds out."""

RUN_COLUMNS = (*PLANNED, *RESULTS)
"""Columns of every runs table; the settings and a planner's extra columns stand between `planner` and `objective`, and at the end.

objective: the planner's own final value. length: exact arc length of the path, in units (not a number without a path).
claimed_feasible: the planner's own test. feasible, collision_at, collision_depth, clearance, clearance_error: the certified check
(`geometry.checker.Check`). generations: done after the first one. history: best objective after each generation.
path_curve, path_points: the path, its control points flat as x0, y0, x1, y1, ...; empty without a path.
"""

DRIVE_RESULTS = dict.fromkeys(
    (
        "arrival",
        "steps",
        "travelled",
        "first_plan",
        "last_plan",
        "last_optimum",
        "replans",
        "waits",
        "collision_steps",
        "known_at",
        "clearance_least",
    ),
    "number",
) | {"hit_waiting": "flag", "avoidable": "flag"}

OUTCOMES = tuple(DRIVE_RESULTS)
"""Columns of a runs table that only drives have."""

JOINED = dict.fromkeys(("straight_line", "bound", "least_length", "octile_bound", "cpu_s", "wall_s"), "number") | {"bound_path": "list"}
"""Columns that are joined to a runs table when it is read: of `problems.bounds_of`, and the times."""

DRIVE_JOINED = dict.fromkeys(
    (
        "least_arrival",
        "best_arrival",
        "clairvoyant_arrival",
        "clairvoyant_length",
        "replan_mean_s",
        "replan_95_s",
        "replan_max_s",
        "replans_late",
    ),
    "number",
)
"""Columns that are joined to the table of drives: of `rides.bounds_of`, and the times of plans."""

WORDS = ("value", "statistic", "metric", "n", "unit", "table")
"""Columns of tables of results, beside those of the runs table that tell their rows apart."""

TAKEN = frozenset((*RUN_COLUMNS, *OUTCOMES, *PLACE, *JOINED, *DRIVE_JOINED))
"""Names that no planner's extra column can have; the job's settings and what it varies are others. A setting cannot have them
either."""
