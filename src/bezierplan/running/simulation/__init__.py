"""Drives of a robot through a world that changes: it follows plans, sees what has changed, and
plans again, waits, or drives on.

The robot covers the world's pace in every step, along polylines. It plans with any planner; its
policy says when (`policy`). Afterwards `motion_check` decides, exactly and without the planner,
whether it collided. `bounds` gives what no robot can beat. Nothing here names a paper or a planner.
"""
