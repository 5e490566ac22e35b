"""The swarm of `chaotic_pso`, which can start from the path of an earlier plan: for robots that plan again while their world changes."""

from typing import Any

import numpy as np

from bezierplan.geometry import curves
from bezierplan.planners import Plan
from bezierplan.planners.chaotic_pso import check, plan, track, workspaces
from bezierplan.workspaces.problem import Problem

__all__ = ["check", "plan", "resume", "track", "workspaces"]

# This share of the particles starts around the last path, at a distance of about this share of the field's side per coordinate.
_AROUND = 0.5
_SPREAD = 0.05


class _Places:
    """Random positions of particles, as shares of the field, the first of which repeat a known one and others of which lie around it."""

    def __init__(self, rng: np.random.Generator, known: np.ndarray) -> None:
        self.rng, self.known = rng, known

    def random(self, size: tuple[int, int]) -> np.ndarray:
        """Positions (particles, dimensions)."""
        shares = self.rng.random(size)
        around = int(_AROUND * len(shares))
        shares[:around] = np.clip(self.known + _SPREAD * self.rng.standard_normal((around, size[1])), 0.0, 1.0)
        shares[0] = self.known
        return shares


class _Generator:
    """A random generator whose first child places particles around a known position."""

    def __init__(self, rng: np.random.Generator, known: np.ndarray) -> None:
        self.rng, self.known = rng, known

    def spawn(self, count: int) -> list[Any]:
        """Child generators."""
        first, *others = self.rng.spawn(count)
        return [_Places(first, self.known), *others]


def resume(problem: Problem, rng: np.random.Generator, last: np.ndarray | None, **settings: Any) -> tuple[Plan, np.ndarray | None]:
    """A plan of a swarm that starts from what the last call returned second: one particle at the last free path's control points, half of
    the others around it, the rest anywhere. None for the first plan, which is that of `plan`.
    """
    found = plan(problem, rng if last is None else _Generator(rng, _shares(last, problem)), **settings)
    free = np.delete(found.path.points, curves.ends(found.path.curve), axis=0)
    return found, free if found.claimed_feasible else last


def _shares(points: np.ndarray, problem: Problem) -> np.ndarray:
    """Free control points (n, 2) as a particle (2 n,), in shares of the field."""
    low, high = np.reshape(problem.workspace.bounds, (2, 2)).T
    return ((points - low) / (high - low)).T.ravel()
