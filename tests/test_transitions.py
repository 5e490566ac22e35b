"""Curvature-continuous paths: transitions in closed form, curvature certified by subdivision, and
what is told where there is no room.
"""

import math

import numpy as np
import pytest
from fields import BENCHMARK_MAPS

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.geometry import curves, transitions
from bezierplan.geometry.curvature_bound import CURVATURE_TOLERANCE, largest_curvature


@pytest.mark.parametrize("angle", [1e-3, 0.01, 0.1, 0.2, transitions.MOST_ANGLE])
def test_a_transition_rises_from_no_curvature_to_that_of_its_arc(angle):
    inner, second, third, before = transitions._transition(1.0, angle)
    end = np.array([before + inner * math.sin(angle), 1.0 - inner * math.cos(angle)])
    handle = np.hypot(*(end - (third, 0.0)))
    piece = np.array([(0, 0), (second, 0), (third, 0), end])
    assert np.arctan2(*(end - (third, 0.0))[::-1]) == pytest.approx(angle, abs=1e-12)
    assert handle > 0
    kappa, _ = curves.curvatures(np.repeat(piece[None], 1001, axis=0), np.linspace(0, 1, 1001))
    assert kappa[0] == pytest.approx(0, abs=1e-9)
    assert kappa[-1] == pytest.approx(1 / inner, rel=1e-9)
    assert np.all(np.diff(kappa) > -1e-9)
    assert largest_curvature(piece[None]).bound <= (1 + transitions.EXCESS) / inner


@pytest.mark.parametrize("seed", range(8))
def test_the_largest_curvature_is_between_dense_samples_and_a_millionth_more(seed):
    rng = np.random.default_rng(seed)
    degree = int(rng.integers(2, 12))
    pieces = rng.normal(size=(3, degree + 1, 2))
    found = largest_curvature(pieces)
    t = np.linspace(0, 1, 200_001)
    with np.errstate(invalid="ignore", divide="ignore"):
        first = degree * np.einsum(
            "sk,nkd->nsd", curves.bernstein(degree - 1, t), np.diff(pieces, axis=1)
        )
        second = (
            degree
            * (degree - 1)
            * np.einsum(
                "sk,nkd->nsd", curves.bernstein(degree - 2, t), np.diff(pieces, n=2, axis=1)
            )
        )
        kappa = (
            np.abs(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0])
            / np.hypot(*first.transpose(2, 0, 1)) ** 3
        )
    assert kappa.max() <= found.bound
    assert found.attained <= found.bound <= found.attained * (1 + CURVATURE_TOLERANCE) * (1 + 1e-12)
    assert found.attained <= kappa.max() * 1.001


def test_the_largest_curvature_of_a_parabola_of_lines_and_of_a_cusp():
    parabola = largest_curvature(np.array([[(-3.0, 9.0), (0.0, -9.0), (3.0, 9.0)]]))  # y = x^2
    assert parabola.attained == pytest.approx(2, rel=1e-6)
    assert 2 <= parabola.bound <= 2 * (1 + 2e-6)
    assert largest_curvature(np.array([[(0.0, 0.0), (1.0, 3.0)]])) == (0, 0)
    assert (
        largest_curvature(
            1e4 + np.array([[(0.0, 0.0), (1 / 3, 1.0), (2 / 3, 2.0), (1.0, 3.0)]])
        ).bound
        < 1e-6
    )
    assert (
        largest_curvature(np.array([[(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)]])).bound
        == math.inf
    )


WALL = bp.Polygons(
    (0.0, 10.0, 0.0, 6.0), ((np.array([(4.0, 0.0), (6.0, 0.0), (6.0, 3.0), (4.0, 3.0)]),),), "m"
)


@pytest.mark.parametrize("radius", [0.2, 0.5, 0.9])
def test_a_continuous_path_keeps_the_turning_radius(radius):
    problem = bp.Problem("", WALL, (1.0, 1.0), (9.0, 1.0))
    arcs = bp.plan(problem, robot_radius=0.1, turning_radius=radius)
    smooth = bp.plan(
        problem, robot_radius=0.1, turning_radius=radius, smooth="continuous", strict=True
    )
    assert smooth.feasible
    assert smooth.clearance >= 0.1 - 1e-8
    assert smooth.turning_radius >= radius
    assert smooth.curvature_bound <= 1 / radius
    assert smooth.curvature_jump <= 1e-9 / radius
    assert arcs.curvature_jump > 0.5 / radius
    assert arcs.length < smooth.length < arcs.length + 0.2 * radius


@pytest.mark.parametrize(
    ("name", "start", "target"),
    [
        ("back_and_forth", (1.0, 1.25), (1.0, 8.75)),
        ("bugtrap1", (12.6, 14.4), (22.4, 24.2)),
        ("complex2", (1.0, 1.0), (19.0, 19.0)),
        ("gaps", (2.0, 10.0), (18.0, 10.0)),
        ("hidden_U", (10.0, 3.0), (10.0, 27.0)),
        ("square_spiral", (2.5, 2.5), (12.5, 7.5)),
    ],
)
def test_on_the_six_maps_the_curvature_is_continuous_and_its_bound_holds(name, start, target):
    problem = bp.Problem(name, bp.read_map(BENCHMARK_MAPS / f"{name}.geojson"), start, target)
    arcs = bp.plan(problem, turning_radius=0.1)
    found = bp.plan(problem, turning_radius=0.1, smooth="continuous", strict=True)
    assert found.feasible
    assert found.curvature <= found.curvature_bound <= 10
    assert found.curvature_jump <= 1e-6 * found.curvature_bound
    assert arcs.curvature_jump > 5
    assert arcs.length < found.length < 1.01 * arcs.length


def test_where_there_is_no_line_the_jump_is_told_and_strict_refuses_it(capsys, tmp_path):
    map_file = tmp_path / "room.txt"
    map_file.write_text("........\n" * 8)
    words = [
        "plan",
        str(map_file),
        "--start",
        "1,1,0",
        "--target",
        "3,3,1.5707963267948966",
        "--settings",
        "{turning_radius: 1}",
    ]
    main([*words, "--smooth", "continuous"])
    told = {row[:16].strip(): row[16:] for row in capsys.readouterr().out.splitlines()}
    assert told["curvature"].endswith("/ cell where transitions have no room")
    with pytest.raises(SystemExit) as found:
        main([*words, "--smooth", "continuous", "--strict"])
    assert found.value.code == 1
    error = capsys.readouterr().err
    assert error.startswith("--smooth: continuous: the curvature jumps by 0.98")
    assert error.count("\n") == 1
    with pytest.raises(SystemExit) as found:
        main(
            [
                "plan",
                str(map_file),
                "--start",
                "1,1",
                "--target",
                "3,3",
                "--planner",
                "prm",
                "--smooth",
                "continuous",
            ]
        )
    assert found.value.code == 2
    assert capsys.readouterr().err.startswith(
        "--smooth: only for rounded_shortest_path and dubins_search"
    )
    with pytest.raises(ValueError, match="smooth: 'very'; expected arcs or continuous"):
        bp.plan(bp.Problem("", WALL, (1.0, 1.0), (9.0, 1.0)), smooth="very")
