"""The particle swarms of tharwat2018: their search against a plain reference, fixed values, frozen
swarms, bad input.
"""

import math

import fields
import numpy as np
import pytest
from fields import among_circles as problem
from hypothesis import given
from hypothesis import strategies as st
from studies import planned, study

from bezierplan.geometry import curves
from bezierplan.planners import chaotic_pso
from bezierplan.planners.parts import chaotic_maps, penalised
from bezierplan.planners.parts.settings import fill_settings
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem

SETTINGS = study("tharwat2018").resolve_settings("pso")

EQUAL, PUBLIC = problem(fields.EQUAL), problem(fields.PUBLIC)


def plan(where=EQUAL, seed=0, **changes):
    return planned("tharwat2018", "pso", where, seed, **SETTINGS | changes)


def judged(points, curve, where, changes):
    """Length, violation and colliding samples, or control points, of a path by numpy alone."""
    settings = SETTINGS | changes
    samples = curves.sample_matrix(curve, len(points), settings["samples"]) @ points
    radii = where.workspace.radii + settings["d_min"]
    tested = samples if settings["tested"] == "samples" else points[1:-1]
    distances = np.hypot(*(tested[:, None] - where.workspace.centres).transpose(2, 0, 1))
    length = np.hypot(*np.diff(samples, axis=0).T).sum()
    return (
        length,
        np.maximum(1 - distances / radii, 0).mean(axis=0).sum(),
        (distances < radii).sum(),
    )


def fitness(length, violation, penalty="multiply", beta=100.0):
    if penalty == "death":
        return beta if violation > 1e-9 else length
    return length * (1 + beta * violation) if penalty == "multiply" else length + beta * violation


def whole_path(particle, where, curve):
    """Control points of a particle; the last but one of a Ferguson curve is the target."""
    free = particle.reshape(2, -1).T
    if curve == "ferguson":
        return np.concatenate([[where.start], free[:-1], [where.target], free[-1:]])
    return np.concatenate([[where.start], free, [where.target]])


def reference(where, seed, **changes):
    """The whole search in plain Python: best fitness after every iteration, best particle,
    collisions a to f.
    """
    s = SETTINGS | changes
    initial, moves, chaos = np.random.default_rng(seed).spawn(3)
    size, dimensions = s["particles"], 2 * s["control_points"]
    x = -10 + 20 * np.array([[initial.random() for _ in range(dimensions)] for _ in range(size)])
    start = {
        "random": lambda: chaotic_maps.draw_start(chaos, s["chaotic_map"], s["singer_mu"]),
        "uniform": chaos.random,
        "fixed": lambda: s["chaotic_start"],
    }[s["chaotic_start_rule"]]()
    zeta = iter(
        chaotic_maps.compute_sequence(
            s["chaotic_map"], start, s["iterations"] * size * dimensions, s["singer_mu"]
        ).values
    )
    v, p, p_fitness = np.zeros_like(x), x.copy(), np.full(size, np.inf)
    best, history, w, since = (np.inf, None, None, None), [], s["inertia"], 0
    infeasible, samples, best_samples, best_infeasible = 0, 0, 0, 0
    for t in range(s["iterations"] + 1):
        improved = False
        for i in range(size):
            length, violation, colliding = judged(
                whole_path(x[i], where, s["curve"]), s["curve"], where, s
            )
            infeasible += violation > 1e-9
            samples += colliding
            f = fitness(length, violation, s["penalty"], s["beta"])
            if f < p_fitness[i]:
                p[i], p_fitness[i] = x[i], f
            if f < best[0]:
                best, improved = (f, x[i].copy(), violation, colliding), True
            if t < s["iterations"]:
                attractor = best[1]
                for d in range(dimensions):
                    if {"dimension": True, "particle": d == 0, "iteration": i == d == 0}[
                        s["random_numbers"]
                    ]:
                        r1, r2 = moves.random(), moves.random()
                    if {"dimension": True, "particle": d == 0, "iteration": i == d == 0}[
                        s["zeta_for"]
                    ]:
                        number = next(zeta)
                    a1 = number if s["chaotic_term"] == "cognitive" else r1
                    a2 = number if s["chaotic_term"] == "social" else r2
                    v[i, d] = (
                        w * v[i, d]
                        + s["c1"] * a1 * (p[i, d] - x[i, d])
                        + s["c2"] * a2 * (attractor[d] - x[i, d])
                    )
                    v[i, d] = np.clip(v[i, d], -20 * s["velocity_limit"], 20 * s["velocity_limit"])
                    x[i, d] += v[i, d]
                    if abs(x[i, d]) > 10:
                        x[i, d] = np.clip(x[i, d], -10, 10)
                        v[i, d] *= {"mirror": -1, "clamp": 1, "stop": 0}[s["bound_rule"]]
        history.append(best[0])
        best_infeasible += best[2] > 1e-9
        w *= s["inertia_damping"]
        if t > 0:
            best_samples += best[3]
        since = 0 if improved else since + 1
        if since == s["stall_limit"] > 0:
            break
    evaluations = size * len(history)
    counts = [
        infeasible / evaluations * size,
        samples / evaluations,
        best_samples,
        best_infeasible,
        int(best[2] > 1e-9),
        infeasible,
    ]
    return history, whole_path(best[1], where, s["curve"]), counts


def collisions(found):
    return [found.extra[f"collisions_{letter}"] for letter in "abcdef"]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"chaotic_term": "cognitive"},
        {"chaotic_term": "social", "chaotic_map": "tent"},
        {"chaotic_term": "social", "zeta_for": "particle"},
        {"chaotic_term": "cognitive", "zeta_for": "dimension", "chaotic_start_rule": "fixed"},
        {"chaotic_term": "social", "chaotic_map": "gauss_printed"},
        {"inertia_damping": 0.98, "velocity_limit": 0.1},
        {"bound_rule": "mirror", "random_numbers": "dimension"},
        {"bound_rule": "stop", "random_numbers": "iteration"},
        {
            "chaotic_term": "social",
            "chaotic_map": "sinusoidal",
            "chaotic_start_rule": "uniform",
            "stall_limit": 0,
        },
        {"penalty": "add", "d_min": 0.3, "samples": 51},
        {"penalty": "death", "beta": 12.0},
        {"curve": "spline"},
        {"curve": "ferguson", "control_points": 4},
        {"tested": "control_points"},
        {"tested": "control_points", "d_min": 0.5, "curve": "spline", "control_points": 5},
        {"stall_limit": 1, "iterations": 60},
        {"stall_limit": 0, "particles": 3, "iterations": 20},
    ],
    ids=lambda changes: "-".join(map(str, changes.values())) or "default",
)
def test_search_is_that_of_a_plain_reference(changes):
    changes = {"particles": 6, "iterations": 8} | changes
    history, points, counts = reference(EQUAL, 5, **changes)
    found = plan(EQUAL, 5, **changes)
    assert found.history == pytest.approx(history, rel=1e-9)
    assert found.path.points == pytest.approx(points, rel=1e-6, abs=1e-9)
    assert found.objective == found.history[-1]
    assert found.evaluations == changes["particles"] * len(history)
    assert collisions(found) == pytest.approx(counts)
    assert found.stop == ("iterations" if len(history) == changes["iterations"] + 1 else "stall")


@pytest.mark.parametrize(
    ("changes", "mean"),
    [
        ({}, 9.237),
        ({"chaotic_term": "cognitive"}, 9.296),
        ({"chaotic_term": "social"}, 9.589),
        (
            {
                "chaotic_term": "social",
                "inertia": 1.0,
                "inertia_damping": 0.98,
                "velocity_limit": 0.1,
            },
            8.662,
        ),
    ],
    ids=["PSO", "CPSO-I", "CPSO-II", "CPSO-II damped"],
)
def test_means_are_those_of_an_independent_implementation(changes, mean):
    """Of 2,000 runs there and 500 here; four standard errors of the difference."""
    ends = [plan(EQUAL, seed, **changes).objective for seed in range(500)]
    assert np.mean(ends) == pytest.approx(
        mean, abs=4 * np.std(ends) * math.sqrt(1 / 500 + 1 / 2000)
    )


def test_a_gauss_sequence_from_one_half_moves_the_swarm_once_and_is_recorded():
    changes = {
        "chaotic_term": "social",
        "chaotic_map": "gauss",
        "chaotic_start_rule": "fixed",
        "chaotic_start": 0.5,
    }
    assert plan(EQUAL, 1, **changes).extra["zeta_collapsed_at"] == 2
    assert plan(EQUAL, 1, zeta_for="particle", **changes).extra["zeta_collapsed_at"] == 1
    assert (
        plan(EQUAL, 1, **(changes | {"chaotic_start": 0.0})).objective
        == plan(EQUAL, 1, iterations=0).objective
    )


def test_clipped_numbers_are_recorded():
    start = {"chaotic_start_rule": "fixed", "chaotic_start": 0.324, "singer_mu": 1.08}
    changes = start | {"chaotic_term": "social", "iterations": 2}
    assert plan(**changes).extra["zeta_clipped"] == 1
    assert plan(**start).extra["zeta_clipped"] == 0


def test_track_gives_the_best_path_of_every_iteration():
    settings = SETTINGS | {"chaotic_term": "social"}
    found = plan(PUBLIC, 4, **settings)
    path = chaotic_pso.track(PUBLIC, np.random.default_rng(4), **settings)
    assert path.shape == (len(found.history), 5, 2)
    assert np.array_equal(path[-1], found.path.points)
    assert [fitness(*judged(points, "bezier", PUBLIC, {})[:2]) for points in path] == pytest.approx(
        found.history.tolist()
    )


# The table of degenerate and bad input.


@pytest.mark.parametrize(
    "changes",
    [{}, {"chaotic_term": "social", "zeta_for": "dimension"}],
)
def test_without_a_free_control_point_the_straight_line_is_judged_once(changes):
    found = plan(control_points=0, **changes)
    assert found.objective == pytest.approx(118.766232, abs=1e-6)
    assert (found.evaluations, len(found.history), found.stop) == (1, 1, "iterations")
    assert found.path.points.tolist() == [[0, 0], [4, 6]]


def test_a_path_a_rounding_error_deep_is_feasible():
    grazed = problem([[2.0, -1.0, 1.0 + 1e-13]], target=(4.0, 0.0))
    found = plan(grazed, control_points=0, samples=101)
    assert 0 < found.extra["violation"] < 1e-12
    assert found.claimed_feasible
    assert collisions(found) == [0, 1, 0, 0, 0, 0]


# Polygons.

SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def among(*obstacles, start=(-4.0, 0.0), target=(4.0, 0.0)):
    return Problem("test", Polygons((-10.0, 10.0, -10.0, 10.0), obstacles, "unit"), start, target)


def violation_of(task, x, y, **changed):
    objective = chaotic_pso._build_objective(
        task, fill_settings(chaotic_pso.Settings, SETTINGS | changed)
    )
    return penalised.measure_violation(np.array([x, y], dtype=float), objective, np.empty(len(x)))


def test_the_violation_of_a_polygon_is_the_mean_depth_as_a_share_of_the_deepest():
    """Points at depths 0 (outside), 0 (on the edge), 0.25, 1 (the middle) and 0.5 of a square whose
    largest circle has radius 1.
    """
    found, colliding = violation_of(among((SQUARE,)), [3, 1, 0.75, 0, 0], [0, 0, 0, 0, -0.5])
    assert found == pytest.approx((0.25 + 1 + 0.5) / 5)
    assert colliding == 3


def test_a_hole_is_free_and_an_indented_polygon_has_an_outside_within_its_box():
    ring = (3 * SQUARE, SQUARE)
    assert violation_of(among(ring), [0, 0.5], [0, 0.5]) == (0.0, 0)
    assert violation_of(among(ring), [2], [0]) == (
        pytest.approx(1.0 / penalised.grow_polygons(among(ring).workspace, 0).deepest[0]),
        1,
    )
    bay = (np.array([[0.0, 0], [6, 0], [6, 6], [4, 6], [4, 2], [2, 2], [2, 6], [0, 6]]),)
    assert violation_of(among(bay), [3, 3], [4, 2.5]) == (0.0, 0)
    assert violation_of(among(bay), [3], [1])[1] == 1


def test_polygons_grow_by_the_safety_distance():
    assert violation_of(among((SQUARE,)), [1.2], [0]) == (0.0, 0)
    found, colliding = violation_of(among((SQUARE,)), [1.2], [0], d_min=0.5)
    assert (found, colliding) == (pytest.approx(0.3 / 1.5), 1)


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=20))
def test_a_polygon_with_many_corners_is_like_the_circle_around_it(points):
    angles = np.linspace(0, math.tau, 721)[:-1]
    x, y = np.array(points).T
    polygon = violation_of(among((2 * np.column_stack([np.cos(angles), np.sin(angles)]),)), x, y)
    assert polygon[0] == pytest.approx(violation_of(problem([[0, 0, 2]]), x, y)[0], abs=1e-4)


def test_a_random_start_that_dies_is_redrawn_unless_it_is_kept():
    """Half of the starts of the Sinusoidal map end at 0."""
    changes = {"chaotic_term": "social", "chaotic_map": "sinusoidal", "stall_limit": 0}

    def died(rule):
        return [
            plan(EQUAL, seed, chaotic_start_rule=rule, **changes).extra["zeta_collapsed_at"] > 0
            for seed in range(20)
        ]

    assert not any(died("random"))
    assert 4 < sum(died("uniform")) < 16
