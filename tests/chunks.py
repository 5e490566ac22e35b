"""Chunks of runs that need no study: straight lines past a circle, and through it; and bends below
one.
"""

import numpy as np

from bezierplan.running.chunk import Chunk
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

CIRCLES = Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 5.0]]), np.array([1.0]), "m")
MADE = {
    "free": Problem("free", CIRCLES, (1.0, 8.0), (9.0, 8.0)),
    "blocked": Problem("blocked", CIRCLES, (1.0, 5.0), (9.0, 5.0)),
}
CHUNK = Chunk(
    study="s",
    experiment="e",
    method="line",
    planner="straight_line",
    settings={},
    problems={name: {"workspace": "field"} for name in MADE},
    vary={},
    seeds="own",
    repeats=[0, 2],
)
DISC = Problem(
    "disc",
    Circles((0.0, 10.0, 0.0, 10.0), np.array([[5.0, 8.0]]), np.array([1.0]), "m"),
    (1.0, 5.0),
    (9.0, 5.0),
)
BENDS = CHUNK._replace(
    study="study",
    experiment="bends",
    method="bend",
    planner="bend",
    problems={"disc": {"workspace": "field"}},
)

# A claim of the small studies whose experiment is `bends`.
CLAIMS = """
claims:
  - {id: C1, place: Table 1, statement: The line is shorter., artefact: table1, checks: [
      {test: lower, experiment: bends, metric: length, groups: [line], than: [bend],
       direction: lower, margin: 0.01}]}
"""
