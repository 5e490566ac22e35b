"""Columns of the runs tables: of `execution`, and of drives (`rides`)."""

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
