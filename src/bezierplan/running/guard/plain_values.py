"""Turn planners' results into plain values, for text, and back. Named tuples and arrays keep their
kind and all bits of their numbers.
"""

from typing import Any

import numpy as np

from bezierplan.planners import Plan
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.robot import DrivePlan, Ride
from bezierplan.workspaces.problem import Path

# No column of a planner has a name in capitals.
_KINDS = {each.__name__: each for each in (Plan, Path, Motion, DrivePlan, Ride)}
_ARRAY = "Array"


def pack(value: Any) -> Any:
    """Return a value in a form that text can hold."""
    if isinstance(value, np.ndarray):
        # As text these numbers keep every bit: JSON has the shortest decimals that restore it.
        return {_ARRAY: value.astype(float).tolist()}
    if isinstance(value, tuple(_KINDS.values())):
        return {type(value).__name__: [*map(pack, value)]}
    return [*map(pack, value)] if isinstance(value, list) else value


def unpack(value: Any) -> Any:
    """Return the value that `pack` packed. Raises TypeError or ValueError for any other."""
    if isinstance(value, list):
        return [*map(unpack, value)]
    if not isinstance(value, dict) or len(value) != 1:
        return value
    ((kind, parts),) = value.items()
    if kind == _ARRAY:
        return np.array(parts, dtype=float)
    return _KINDS[kind](*map(unpack, parts)) if kind in _KINDS else value
