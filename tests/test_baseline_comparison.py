"""Methods beside a baseline: ratios of synthetic runs, and the sentence that follows from them."""

import math

import numpy as np
import pandas as pd
import pytest

from bezierplan.analysis import measures, metrics
from bezierplan.analysis.numbers import baseline_comparison
from bezierplan.analysis.results import Results
from bezierplan.papers.elhoseny2017 import metrics as elhoseny2017
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Path, Problem

SQUARE_CORNER = ("polyline", [0.0, 0, 1, 0, 1, 1])
STRAIGHT = ("polyline", [0.0, 0, 2, 0])


def arc(radius):
    """A quarter of a circle, as one cubic piece; its largest curvature is within 2 % of 1 /
    radius.
    """
    k = 4 / 3 * math.tan(math.pi / 8)
    return "bezier", [radius * each for each in (0.0, 0, k, 0, 1, 1 - k, 1, 1)]


def run(condition, method, length, path, *, cpu=1.0, feasible=True):
    values = {
        "problem": condition,
        "condition": condition,
        "method": method,
        "length": length,
        "cpu_s": cpu,
        "feasible": feasible,
        "bound": 1.0,
        "evaluations": 1,
    }
    return values | {"path_curve": path[0], "path_points": path[1]}


def rows(*runs):
    return baseline_comparison.measured(
        {"only": Results(pd.DataFrame(runs), {}, pd.DataFrame())}, "base"
    ).set_index("method")


def test_ratios_of_medians_and_their_median():
    found = rows(
        *(run("a", "base", 10.0, arc(1.0), cpu=2.0) for _ in range(3)),
        *(run("b", "base", 20.0, arc(2.0), cpu=4.0) for _ in range(3)),
        *(run("c", "base", 5.0, arc(0.5), cpu=1.0) for _ in range(3)),
        *(run("a", "tried", length, arc(2.0), cpu=20.0) for length in (11.0, 12.0, 99.0)),
        *(run("b", "tried", length, arc(8.0), cpu=8.0) for length in (20.0, 22.0, 23.0)),
        *(run("c", "tried", length, arc(0.5), cpu=5.0) for length in (5.0, 5.0, 6.0)),
    )
    assert found.index.tolist() == ["tried"]
    row = found.loc["tried"]
    assert (row["conditions"], row["compared"], row["bent"]) == (3, 3, 3)
    assert row["length"] == 1.1  # of 1.2, 1.1, 1.0
    assert row["curvature"] == pytest.approx(0.5)  # of 0.5, 0.25, 1
    assert row["cpu"] == 5.0  # of 10, 2, 5


def test_failed_runs_count_in_the_share_and_in_the_time_but_not_in_the_length():
    found = rows(
        run("a", "base", 10.0, arc(1.0)),
        run("b", "base", 10.0, arc(1.0)),
        run("a", "tried", 12.0, arc(1.0), cpu=2.0),
        run("a", "tried", 1.0, arc(0.1), cpu=4.0, feasible=False),
        run("b", "tried", 1.0, arc(0.1), cpu=5.0, feasible=False),
        run("b", "tried", 1.0, arc(0.1), cpu=5.0, feasible=False),
    ).loc["tried"]
    assert (
        found["feasible"],
        found["feasible_baseline"],
        found["conditions"],
        found["compared"],
    ) == (0.25, 1.0, 2, 1)
    assert (found["length"], found["curvature"], found["cpu"]) == (1.2, 1.0, 4.0)


def test_corners_curve_without_limit_and_a_straight_baseline_is_no_measure():
    found = rows(
        run("a", "base", 10.0, arc(1.0)),
        run("b", "base", 2.0, STRAIGHT),
        run("c", "base", 2.0, SQUARE_CORNER),
        run("a", "cornered", 10.0, SQUARE_CORNER),
        run("b", "cornered", 3.0, arc(1.0)),
        run("c", "cornered", 2.0, arc(1.0)),
        run("b", "elsewhere", 3.0, arc(1.0)),
    )
    assert found.loc["cornered", ["compared", "bent", "curvature"]].tolist() == [3, 1, math.inf]
    assert found.loc["elsewhere", "bent"] == 0
    assert math.isnan(found.loc["elsewhere", "curvature"])


def test_an_arc_has_the_energy_of_its_angle_over_its_radius():
    for radius in (0.5, 2.0):
        path = Path("bezier", np.reshape(arc(radius)[1], (-1, 2)))
        assert measures.bending_energy(path) == pytest.approx(math.pi / 2 / radius, rel=1e-3)
    assert measures.bending_energy(Path("polyline", np.reshape(SQUARE_CORNER[1], (-1, 2)))) == 0


def test_experiments_are_paired_each_with_its_own_baseline():
    found = {
        name: Results(
            pd.DataFrame([run("a", "base", base, arc(1.0)), run("a", "tried", tried, arc(1.0))]),
            {},
            pd.DataFrame(),
        )
        for name, base, tried in (("one", 10.0, 20.0), ("other", 100.0, 400.0))
    }
    assert baseline_comparison.measured(found, "base")["length"].tolist() == [3.0]


def test_a_path_along_an_obstacle_has_no_length_that_counts_cells():
    """Its cells would be those of either side, as rounding has it."""
    grid = from_lines(["....", ".##.", "...."], cell=1.0, unit="m")
    problem = Problem("room", grid, (1.5, 0.5), (3.5, 2.5))
    along, clear = (
        np.array([1.5, 0.5, 1, 1, 1, 2, 3.5, 2.5]),
        np.array([1.5, 0.5, 3.5, 0.5, 3.5, 2.5]),
    )
    runs = pd.DataFrame(
        {
            "id": ["along", "clear"],
            "problem": "room",
            "path_curve": "polyline",
            "path_points": [along, clear],
        }
    )
    runs = runs.assign(octile_bound=3.5, feasible=True)
    for name in ("cells4", "cells8"):
        found = metrics.values(runs, name, {"room": problem})
        assert math.isnan(found[0]), name
        assert found[1] in (3.5, 4.0), name
    with pytest.raises(ValueError, match="run clear is said to be feasible"):
        elhoseny2017.measure_in_cells("length4", runs.assign(octile_bound=6.0), {"room": problem})
