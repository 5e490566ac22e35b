"""Columns of the runs tables: of `execution`, and of drives (`rides`); and names that are taken by them."""

from bezierplan.planners import PLACE

RUN_COLUMNS = (
    *("id", "study", "experiment", "condition", "problem", "workspace", "method", "repeat", "planner"),
    *("objective", "length", "claimed_feasible", "feasible", "collision_at", "collision_depth", "clearance", "clearance_error"),
    *("evaluations", "generations", "stop", "history", "path_curve", "path_points"),
)
"""Columns of every runs table; the settings and a planner's extra columns stand between `planner` and `objective`, and at the end.

objective: the planner's own final value. length: exact arc length of the path, in units (not a number without a path).
claimed_feasible: the planner's own test. feasible, collision_at, collision_depth, clearance, clearance_error: the certified check
(`geometry.checker.Check`). generations: done after the first one. history: best objective after each generation.
path_curve, path_points: the path, its control points flat as x0, y0, x1, y1, ...; empty without a path.
"""

OUTCOMES = (
    *("arrival", "steps", "travelled", "first_plan", "last_plan", "replans", "waits"),
    *("collision_steps", "hit_waiting", "known_at", "avoidable", "clearance_least"),
)
"""Columns of a runs table that only drives have."""

JOINED = (
    *("straight_line", "bound", "least_length", "bound_path", "octile_bound", "clairvoyant_arrival", "clairvoyant_length"),
    *("cpu_s", "wall_s", "replan_mean_s", "replan_95_s", "replan_max_s", "replans_late"),
)
"""Columns that are joined to a runs table when it is read: of `problems.bounds_of` and `rides.bounds_of`, and the times."""

TAKEN = frozenset((*RUN_COLUMNS, *OUTCOMES, *PLACE, *JOINED))
"""Names that no planner's extra column can have; the job's settings and what it varies are others. A setting cannot have them
either."""
