"""Paths among spheres: the exact check, lengths and bounds against closed forms and the plane; the
swarm; the panel and its faults.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from studies import study

from bezierplan.figures import sheet
from bezierplan.figures.panels import Sources
from bezierplan.geometry import checker, curves, shortest_paths, spheres
from bezierplan.geometry.region import region
from bezierplan.planners import chaotic_pso
from bezierplan.planners.parts import penalised
from bezierplan.planners.parts.settings import filled
from bezierplan.study import jobs
from bezierplan.workspaces import files
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Path, Problem
from bezierplan.workspaces.spheres import Spheres

BOX = (-10.0, 10.0, -10.0, 10.0, -10.0, 10.0)
SETTINGS = study("tharwat2018").resolved("pso") | {
    "inertia_damping": 0.98,
    "velocity_limit": 0.1,
    "stall_limit": 0,
}

# Fractions of powers of two, so that curves can touch obstacles exactly.
number = st.integers(-64, 64).map(lambda n: n / 16)


def points(count, dimensions=3):
    return st.lists(
        st.lists(number, min_size=dimensions, max_size=dimensions), min_size=count, max_size=count
    ).map(np.array)


def among(*table):
    table = np.array(table, dtype=float).reshape(-1, 4)
    return Spheres(BOX, table[:, :3], table[:, 3], "unit")


def line(start, target):
    return np.array([[start, target]], dtype=float)


@st.composite
def turned(draw):
    """An orthogonal matrix (3, 3)."""
    q, _ = np.linalg.qr(draw(points(3)) + 20 * np.eye(3))
    return q


# The exact check.


@pytest.mark.parametrize(
    ("height", "free"),
    [
        (1.0, True),
        (1 - 5e-10, True),
        (1 - 2.5e-9, False),
        (1 - 1e-6, False),
        (0.0, False),
        (1 + 1e-6, True),
    ],
)
def test_a_line_over_a_sphere_is_free_down_to_the_tolerance(height, free):
    assert (
        spheres.is_free(line((-3, 0.125, height), (5, 0.125, height)), among((0.3, 0.125, 0, 1)))
        is free
    )


def test_a_dip_between_the_planners_samples_is_found():
    """A parabola whose lowest point lies 1e-6 in a sphere whose size is a thousandth of the
    distance of its samples.
    """
    # z = (x^2 + 1) / 2 - 1/2 at its middle: 0.
    parabola = np.array([[[-1, 0, 1], [0, 0, -1], [1, 0, 1.0]]])
    for below, free in ((1e-6, False), (-1e-6, True)):
        assert spheres.is_free(parabola, among((0, 0, below - 1e-3, 1e-3))) is free


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("side", [-1, 1])
def test_a_curve_may_touch_the_walls_and_not_leave(axis, side):
    curve = np.zeros((1, 3, 3))
    curve[0, :, (axis + 1) % 3] = -1, 0, 1
    curve[0, 1, axis] = 20 * side  # the middle is half as far out
    assert spheres.is_free(curve, among())
    curve[0, 1, axis] += 1e-6 * side
    assert not spheres.is_free(curve, among())


@given(points(4), points(3).map(np.abs), turned())
def test_in_a_plane_the_verdict_is_that_of_the_checker_in_two_dimensions(control, table, turn):
    """Circles in a tilted plane, as the equators of spheres."""
    flat, circles = control[:, :2], table + np.array([0, 0, 0.25])
    check = checker.check(
        flat[None],
        region(Circles((-50.0, 50.0, -50.0, 50.0), circles[:, :2], circles[:, 2], "unit")),
    )
    # Turning rounds, so nothing may graze.
    assume((check.clearance if check.feasible else check.depth) > 1e-6)
    lifted = np.pad(flat, ((0, 0), (0, 1))) @ turn
    centres = np.pad(circles[:, :2], ((0, 0), (0, 1))) @ turn
    assert (
        spheres.is_free(lifted[None], Spheres((-50.0, 50.0) * 3, centres, circles[:, 2], "unit"))
        == check.feasible
    )


# Lengths and bounds.


def test_the_shortest_path_around_a_sphere_has_a_closed_form():
    """Two tangents of length sqrt(3) and a sixth of a great circle."""
    found = spheres.shortest_around((-2, 0, 0), (2, 0, 0), (0, 0, 0), 1.0)
    assert found == pytest.approx(2 * math.sqrt(3) + math.pi / 3, rel=1e-14)
    assert spheres.shortest_around((-2, 0, 1), (2, 0, 1), (0, 0, 0), 1.0) == 4.0
    assert spheres.shortest_around((1, 0, 0), (0, 0, 1), (0, 0, 0), 1.0) == pytest.approx(
        math.pi / 2, rel=1e-14
    )


@given(points(3, 2), number.map(lambda n: abs(n) / 4 + 0.25), turned())
def test_it_is_that_around_a_circle_in_its_plane(ends, radius, turn):
    start, target, centre = ends
    assume(min(math.dist(start, centre), math.dist(target, centre)) > radius + 1e-6)
    circle = Circles((-50.0, 50.0, -50.0, 50.0), centre[None], np.array([radius]), "unit")
    flat = shortest_paths.shortest_path(
        Problem("", circle, tuple(start.tolist()), tuple(target.tolist()))
    ).length
    lifted = np.pad(ends, ((0, 0), (0, 1))) @ turn
    assert spheres.shortest_around(*lifted, radius) == pytest.approx(flat, rel=1e-9, abs=1e-9)


@given(points(4, 2), turned())
def test_the_length_of_a_curve_is_that_in_its_plane(control, turn):
    lifted = np.pad(control, ((0, 0), (0, 1))) @ turn
    assert spheres.length(lifted[None]) == pytest.approx(
        curves.length(Path("bezier", control)), rel=1e-8, abs=1e-8
    )


def test_the_bound_is_the_longest_way_around_one_sphere():
    small, large = (-4, 0, 0, 0.5), (0, 0, 0, 2)
    ends = (-8.0, 0.0, 0.0), (8.0, 0.0, 0.0)
    assert spheres.least_length(among(small, large), *ends) == spheres.shortest_around(
        *ends, (0, 0, 0), 2.0
    )
    assert spheres.least_length(among(), *ends) == 16.0


# The swarm.


@given(points(3, 2), points(2).map(np.abs))
def test_in_the_plane_objectives_are_equal_to_the_last_bit(free, table):
    """Three dimensions add terms that are zero."""
    circles = table + np.array([0, 0, 0.25])
    flat = Problem(
        "", Circles(BOX[:4], circles[:, :2], circles[:, 2], "unit"), (-4.0, 0.0), (4.0, 1.0)
    )
    lifted = Problem(
        "",
        Spheres(BOX, np.insert(circles[:, :2], 2, 0.0, axis=1), circles[:, 2], "unit"),
        (-4.0, 0.0, 0.0),
        (4.0, 1.0, 0.0),
    )
    found = []
    for task, position in (
        (flat, free.T.ravel()),
        (lifted, np.append(free.T.ravel(), np.zeros(3))),
    ):
        objective = chaotic_pso._objective(task, filled(chaotic_pso.Settings, SETTINGS))
        curve, scratch = (
            np.empty((len(task.start), SETTINGS["samples"])),
            np.empty(SETTINGS["samples"]),
        )
        length = penalised.length(position, objective, curve, scratch)
        found.append((length, *penalised.violation(curve, objective, scratch)))
    assert found[0] == found[1]


def test_the_violation_of_a_sphere_is_the_mean_depth_as_a_share_of_its_radius():
    """Points at the centre, halfway along each axis, on the surface, and outside along z alone."""
    task = Problem("", among((0, 0, 0, 2)), (-4.0, 0.0, 0.0), (4.0, 0.0, 0.0))
    objective = chaotic_pso._objective(task, filled(chaotic_pso.Settings, SETTINGS))
    curve = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 2], [0, 0, 3.0]]).T.copy()
    assert penalised.violation(curve, objective, np.empty(6)) == (
        pytest.approx((1 + 3 * 0.5) / 6),
        4,
    )


# The panel.


def job():
    return jobs.Figure.of({"tharwat2018": study("tharwat2018")}, "smoke", "tharwat2018", "spheres")


def test_the_figure_shows_what_its_runs_are():
    described = job()
    panels = described.panels
    bare = {
        name: files.load(each, study("tharwat2018").folder)
        for name, each in described.workspaces.items()
    }
    frame = sheet.data(panels, Sources(workspaces=bare, study=described.study))
    for _, own in frame.groupby("panel"):
        runs = own[own["part"] == "run"]
        assert list(runs["run"]) == [f"tharwat2018/spheres/pso/{repeat}" for repeat in range(20)]
        free = runs[runs["feasible"].astype(bool)]
        assert 0 < len(free) < runs["claimed_feasible"].sum()  # samples miss what lies between them
        control = own[own["part"] == "control"][["x", "y", "z"]].to_numpy()
        assert spheres.is_free(control[None], bare["spheres"])
        assert (
            own["straight_line"].iloc[0]
            < own["bound"].iloc[0]
            < spheres.length(control[None])
            == free["length"].min()
        )
        path = own[own["part"] == "path"]
        gaps = np.linalg.norm(
            path[["x", "y", "z"]].to_numpy()[:, None] - bare["spheres"].centres, axis=2
        )
        np.testing.assert_allclose(path["clearance"], (gaps - bare["spheres"].radii).min(axis=1))
        assert path["clearance"].min() > -spheres.TOLERANCE
        assert path["along"].iloc[[0, -1]].to_list() == [0, 1]
        assert path["along"].is_monotonic_increasing
    *axes, clearance = sheet.draw(panels, frame, sheet.Scene({}, bare, {}, "unit"), 3).axes
    assert clearance.get_ylabel() == "clearance (unit)"
    assert clearance.lines[0].get_ydata().tolist() == path["clearance"].to_list()
    assert [(each.get_xlabel(), each.get_ylabel()) for each in axes] == [
        ("x (unit)", "y (unit)"),
        ("x (unit)", "z (unit)"),
    ]
    drawn = [
        next(line for line in each.lines if line.get_label() == "control points").get_xydata()
        for each in axes
    ]
    np.testing.assert_array_equal(drawn[0], control[:, [0, 1]])
    np.testing.assert_array_equal(drawn[1], control[:, [0, 2]])
