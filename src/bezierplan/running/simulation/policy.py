"""What a robot does when its world changes."""

from typing import Literal, NamedTuple


class Policy(NamedTuple):
    """Rules of a robot.

    replan: when it plans again: never, at every `every`-th step, when its way is blocked, or when
    the world changes. warm: whether a plan starts from an earlier one. waits: whether it stops in
    front of what is in its way. sees: circles as they are at the beginning of a step or where they
    will be at its end. knows: their positions alone, or also their velocities, with which it looks
    ahead. check_margin: how far circles must stay away from the rest of its way, in units.
    plan_margins: by how much circles are grown for a plan, one value after the other until there is
    a plan. brake: how far ahead, in units, its way must be clear for it to move. horizon: how far
    ahead along its way it checks, in units. evades: whether it steps aside, among circles, where it
    would stop and one is about to come there. spacing: length of the chords that stand for a curve,
    in units. start: a plan begins where the robot is, or at the centre of its cell, to which it
    first drives; from a cell that has become occupied it first drives back. step_seconds: how long
    a step lasts, for the count of plans that take longer.
    """

    replan: Literal["never", "every_step", "when_blocked", "when_changed"]
    every: int
    warm: bool
    waits: bool
    sees: Literal["before", "after"]
    knows: Literal["positions", "velocities"]
    check_margin: float
    plan_margins: tuple[float, ...]
    brake: float
    horizon: float
    evades: bool
    spacing: float
    start: Literal["position", "centre"]
    step_seconds: float
