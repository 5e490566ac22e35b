"""The policy of a robot: its decisions when its world changes."""

import math
from typing import Literal

from pydantic import Field

from bezierplan.schema.model import (
    LARGEST,
    Count,
    Model,
    NotNegative,
    Positive,
    build_value_type,
    is_number,
)

Margins = build_value_type(
    lambda given: (
        isinstance(given, list)
        and 0 < len(given) <= 100
        and all(is_number(each) and 0 <= each <= LARGEST for each in given)
    ),
    "",
)


class Policy(Model):
    """When a robot in a dynamic environment replans, and what it knows."""

    replan: Literal["never", "every_step", "when_blocked", "when_changed"] = Field(
        description="when the robot replans: never; every_step, that is at every `every`-th one; "
        "when_blocked, that is when the rest of its path is blocked; or when_changed, that is "
        "when the environment has changed (cells at some moments, circles that move at every step)"
    )
    every: Count = Field(
        1,
        description="of every_step: the number of steps between plans, "
        "a whole number of at least 1; left out: 1",
    )
    warm: bool = Field(
        False,
        description="whether a plan starts from the last one, for planners with a function "
        "`resume`; left out: false",
    )
    waits: bool = Field(
        True,
        description="whether the robot stops in front of an obstacle on its path, "
        "true or false; left out: true",
    )
    sees: Literal["before", "after"] = Field(
        "before",
        description="whether it sees circles as they are before or after they move in a step; "
        "left out: before",
    )
    knows: Literal["positions", "velocities"] = Field(
        "positions",
        description="whether it knows positions alone or also velocities, and looks ahead; left "
        "out: positions",
    )
    check_margin: NotNegative = Field(
        0.0,
        description="the distance that circles must keep from the rest of its path, in units; "
        "left out: 0",
    )
    plan_margins: Margins = Field(
        [0.0],
        description="by how much circles grow for a plan: a list of numbers, tried in this order "
        "until there is a plan; left out: [0]",
    )
    brake: NotNegative = Field(
        0.0,
        description="the look-ahead distance along its path that must be free before it moves, in "
        "units; left out: 0",
    )
    horizon: Positive = Field(
        math.inf,
        description="the distance ahead along its path that it checks, in units; left out: all "
        "of it",
    )
    evades: bool = Field(
        False,
        description="among circles, whether it makes an evasive manoeuvre where it would stop and "
        "a circle is about to arrive; left out: false",
    )
    spacing: Positive = Field(
        0.5,
        description="mean length of the chords that it drives "
        "along a curve, in units; left out: 0.5",
    )
    start: Literal["position", "centre"] = Field(
        "position",
        description="whether a plan begins at the robot's position, or at the centre of its cell, "
        "to which it drives first",
    )
