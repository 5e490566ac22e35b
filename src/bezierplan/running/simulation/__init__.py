"""A robot that drives through a world that changes: it follows plans, sees what has changed, and
plans again, waits, or drives on.

The robot covers the world's pace in every step, along polylines. What it plans with is any planner;
what it does when is its policy (`policy`). Whether it collided is decided afterwards, exactly and
without the planner (`motion_check`). `bounds` tells what no robot can beat. Nothing here names a
paper or a planner.
"""
