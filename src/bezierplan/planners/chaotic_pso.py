"""Particle swarm optimisation of a path's control points, plain (PSO) or with a chaotic sequence
instead of one of its two random numbers: that of the cognitive term (CPSO-I) or of the social term
(CPSO-II) (tharwat2018, Sections 3.2 and 4).

A particle is (x_1, ..., x_n, y_1, ..., y_n), the coordinates of the n free control points of one
curve. The curve is linear in them, so to the kernels every curve kind is a constant matrix.
Obstacles are tested at samples of the curve; the paper's equation (20) names its control points,
which can be free on a path that is not.

All methods draw the same numbers: positions, moves and the start of the chaotic sequence come from
three generators; positions are drawn particle by particle, and for each move r1 before r2; the
number that the chaotic sequence replaces is drawn and discarded.
"""

import math
from enum import IntEnum
from typing import Annotated, Any, NamedTuple

import numpy as np

from bezierplan.geometry import curves
from bezierplan.kernels import allocation_free, compile_kernel
from bezierplan.planners import About, Path, Plan, Problem, Range
from bezierplan.planners.parts import chaotic_maps, penalised
from bezierplan.planners.parts.genetic import copy
from bezierplan.planners.parts.penalised import FEASIBLE, Objective, Penalty
from bezierplan.planners.parts.settings import (
    NOT_NEGATIVE,
    SHARE,
    UNITS,
    fill_settings,
    with_settings,
)

extra = (
    "violation",
    "collisions_a",
    "collisions_b",
    "collisions_c",
    "collisions_d",
    "collisions_e",
    "collisions_f",
    "zeta_collapsed_at",
    "zeta_clipped",
)
workspaces = ("circles", "polygons")

ChaoticTerm = IntEnum("ChaoticTerm", "none cognitive social")
RandomNumbers = IntEnum("RandomNumbers", "dimension particle iteration")
BoundRule = IntEnum("BoundRule", "mirror clamp stop")
Curve = IntEnum("Curve", "bezier spline ferguson")
StartRule = IntEnum("StartRule", "random fixed uniform")
ZetaFor = IntEnum("ZetaFor", "iteration particle dimension")
Tested = IntEnum("Tested", "samples control_points")

# This share of the particles starts around a given path, at a distance of about this share of the
# field's side per coordinate.
_AROUND = 0.5
_SPREAD = 0.05


class Swarm(NamedTuple):
    """Result of a swarm after `done` iterations.

    positions: (done + 1, 2 n) of its best path after iteration 0, 1, ..., done.
    fitness: (done + 1,) of the same paths.
    violation: the last path's.
    infeasible: number of evaluated paths that collide.
    colliding_samples: colliding samples of all evaluated paths, summed over obstacles.
    best_colliding_samples: colliding samples of the best path, summed over the iterations.
        best_infeasible: number of iterations, including the initial one, after which the best path
        collides.
    zeta_clips: number of clipped values of the chaotic sequence.
    zeta_collapsed_at: the iteration at which the sequence collapsed, or 0.
    """

    positions: np.ndarray
    fitness: np.ndarray
    violation: float
    infeasible: int
    colliding_samples: int
    best_colliding_samples: int
    best_infeasible: int
    zeta_clips: int
    zeta_collapsed_at: int


class Settings(NamedTuple):
    """Settings of a swarm (tharwat2018, Table 2 and Sections 3 to 5)."""

    curve: Annotated[
        Curve,
        About(
            "kind of curve; "
            "a ferguson curve's control points alternate between tangents and points",
            "tharwat2018, eqs. 1, 2",
        ),
    ]
    control_points: Annotated[
        int,
        Range(0, 60),
        About("free control points, beside start and target", "tharwat2018, Section 5.1"),
    ]
    samples: Annotated[
        int,
        Range(2),
        About(
            "points of the curve tested and measured, uniform in the parameter, both ends included"
        ),
    ]
    tested: Annotated[
        Tested,
        About(
            "which points must keep out of obstacles: the samples, or the free control points",
            "tharwat2018, eqs. 20 to 22",
        ),
    ]
    penalty: Annotated[
        Penalty,
        About(
            "fitness of length L and violation V: "
            "L (1 + beta V), L + beta V, or (death) beta if V > 0",
            "tharwat2018, eq. 22, which leaves it open",
        ),
    ]
    beta: Annotated[
        float, NOT_NEGATIVE, About("weight of the violation, or fitness of a dead path")
    ]
    d_min: Annotated[
        float, NOT_NEGATIVE, About("added to every radius", "tharwat2018, eq. 21", unit=UNITS)
    ]
    particles: Annotated[int, Range(1), About("particles of the swarm", "tharwat2018, Table 2")]
    iterations: Annotated[int, NOT_NEGATIVE, About("most iterations", "tharwat2018, Table 2")]
    stall_limit: Annotated[
        int,
        NOT_NEGATIVE,
        About(
            "iterations without improvement that end the search, 0 for none",
            "tharwat2018, Section 4.2.1",
        ),
    ]
    c1: Annotated[
        float, NOT_NEGATIVE, About("C1, the cognition learning factor", "tharwat2018, Table 2")
    ]
    c2: Annotated[
        float, NOT_NEGATIVE, About("C2, the social learning factor", "tharwat2018, Table 2")
    ]
    inertia: Annotated[float, NOT_NEGATIVE, About("w of the first iteration")]
    inertia_damping: Annotated[float, SHARE, About("factor of w from one iteration to the next")]
    velocity_limit: Annotated[
        float,
        Range(0, math.inf),
        About("largest step, as a share of the field's side; infinite for no limit"),
    ]
    bound_rule: Annotated[
        BoundRule,
        About(
            "outside the field: moved to its border, the velocity mirrored, kept (clamp) or zero "
            "(stop)"
        ),
    ]
    random_numbers: Annotated[RandomNumbers, About("what gets its own r1 and r2")]
    chaotic_term: Annotated[
        ChaoticTerm,
        About("term whose random number the chaotic sequence replaces", "tharwat2018, eqs. 17, 18"),
    ]
    chaotic_map: Annotated[
        chaotic_maps.Map, About("map of the chaotic sequence", "tharwat2018, eqs. 9 to 16")
    ]
    chaotic_start_rule: Annotated[
        StartRule,
        About(
            "how the chaotic sequence starts: at random, redrawn while it dies (random) or not "
            "(uniform), or fixed",
            "tharwat2018, Figure 3",
        ),
    ]
    chaotic_start: Annotated[
        float,
        SHARE,
        About("first number under the rule fixed; of the map constant every number"),
    ]
    zeta_for: Annotated[
        ZetaFor, About("what gets its own number of the sequence", "tharwat2018, eqs. 17, 18")
    ]
    singer_mu: Annotated[float, Range(0.9, 1.08), About("mu", "tharwat2018, eq. 10")]


def check(settings: dict) -> None:
    """Raise ValueError, naming the setting and what is expected, unless settings that depend on
    each other fit together.
    """
    try:
        curves.piece_matrix(settings["curve"], settings["control_points"] + 2)
    except ValueError as error:
        raise ValueError(
            f"control_points: {settings['control_points']}, beside start and target; {error}"
        ) from None
    if settings["chaotic_map"] == "constant" and settings["chaotic_start_rule"] == "random":
        raise ValueError(
            "chaotic_start_rule: random; a constant map needs fixed, its value is chaotic_start"
        )


@with_settings(Settings)
def plan(
    problem: Problem, rng: np.random.Generator, settings: Settings, start: np.ndarray | None = None
) -> Plan:
    """Return the shortest penalised curve found from start to target with free control points.

    Parameters
    ----------
    problem : Problem
        Among circles or polygons.
    rng : numpy.random.Generator
        The only source of random numbers.
    start : ndarray, (n, 2), optional
        Free control points, in units, at which the first particle starts and half of all particles
        around it; else all start anywhere.

    Returns
    -------
    Plan
        `claimed_feasible`: V at most `FEASIBLE`. Extra columns: violation, the path's V;
        zeta_collapsed_at and zeta_clipped as in `Swarm`; and six interpretations of the paper's
        undefined number of collisions: particles per iteration (a), samples per evaluated path (b),
        samples of the best path, summed over the iterations (c), iterations whose best path
        collides (d), final paths, 0 or 1 (e), evaluated paths in the run (f).

    References
    ----------
    tharwat2018, Algorithm 1 and eqs. 7, 8, 17 to 22.
    """
    swarm = search(problem, rng, settings, start)
    curve, done = Curve(settings.curve).name, len(swarm.fitness) - 1
    evaluations = (1 if settings.control_points == 0 else settings.particles) * (done + 1)
    feasible = swarm.violation <= FEASIBLE
    return Plan(
        path=Path(curve, _place_points(swarm.positions[-1], curve, problem)),
        objective=swarm.fitness[-1],
        claimed_feasible=feasible,
        evaluations=evaluations,
        history=swarm.fitness,
        stop="iterations"
        if done == settings.iterations or settings.control_points == 0
        else "stall",
        extra={
            "violation": swarm.violation,
            "collisions_a": swarm.infeasible / evaluations * settings.particles,
            "collisions_b": swarm.colliding_samples / evaluations,
            "collisions_c": swarm.best_colliding_samples,
            "collisions_d": swarm.best_infeasible,
            "collisions_e": int(not feasible),
            "collisions_f": float(swarm.infeasible),
            "zeta_collapsed_at": swarm.zeta_collapsed_at,
            "zeta_clipped": swarm.zeta_clips,
        },
    )


def track(problem: Problem, rng: np.random.Generator, **settings: Any) -> np.ndarray:
    """Return the control points of the best path after every iteration of the run that `plan` makes
    with the same generator and settings (tharwat2018, Figure 12).

    The array is (iterations done + 1, control points, 2), in units.
    """
    positions = search(problem, rng, fill_settings(Settings, settings)).positions
    return np.array([_place_points(position, settings["curve"], problem) for position in positions])


def search(
    problem: Problem, rng: np.random.Generator, settings: Settings, start: np.ndarray | None = None
) -> Swarm:
    """Run the search behind `plan` and `track`."""
    # Three generators: a swarm with a chaotic sequence starts and moves with the numbers of the
    # plain one.
    initial, moves, chaos = rng.spawn(3)
    particles, iterations, dimensions = (
        settings.particles,
        settings.iterations,
        2 * settings.control_points,
    )
    if dimensions == 0:
        # Without free control points there is one path, the straight line.
        particles, iterations = 1, 0
    objective = _build_objective(problem, settings)
    # All x first, then all y, as in a particle.
    low, high = np.repeat(
        np.reshape(problem.workspace.bounds, (-1, 2)).T, settings.control_points, axis=1
    )
    shares = initial.random((particles, dimensions))
    if start is not None:
        around = int(_AROUND * particles)
        known = (start.T.ravel() - low) / (high - low)
        shares[:around] = np.clip(
            known + _SPREAD * initial.standard_normal((around, dimensions)), 0.0, 1.0
        )
        # The given path itself takes part, so the best one is never worse.
        shares[0] = known
    x = low + (high - low) * shares
    zeta, clips, collapsed_at = _draw_zeta(chaos, (iterations, particles, dimensions), settings)
    return Swarm(
        *_run_swarm(
            moves, x, zeta, low, high, settings.velocity_limit * (high - low), objective, settings
        ),
        clips,
        collapsed_at,
    )


def _build_objective(problem: Problem, settings: Settings) -> Objective:
    """Prepare the fitness of a path for the kernels."""
    ends, free = penalised.compute_basis(
        Curve(settings.curve).name, settings.control_points, settings.samples
    )
    return Objective(
        ends=problem.ends.T @ ends,
        free=free,
        balls=penalised.round_obstacles(problem.workspace, settings.d_min),
        polygons=penalised.grow_polygons(problem.workspace, settings.d_min),
        penalty=settings.penalty,
        beta=settings.beta,
    )


def _place_points(position: np.ndarray, curve: str, problem: Problem) -> np.ndarray:
    """Return the control points (n + 2, 2) of a particle (2 n,)."""
    n = len(position) // 2
    points = np.empty((n + 2, 2))
    points[curves.ends(curve)] = problem.ends
    points[penalised.find_free_points(curve, n)] = position.reshape(2, n).T
    return points


def _draw_zeta(
    chaos: np.random.Generator, size: tuple[int, int, int], settings: Settings
) -> chaotic_maps.Sequence:
    """Draw the chaotic sequence.

    Returns its values (iterations, particles or 1, dimensions or 1), the number of those clipped,
    and the iteration at which it collapsed.
    """
    shape = size[: settings.zeta_for]
    shape += (1,) * (3 - len(shape))
    if settings.chaotic_term == ChaoticTerm.none:
        return chaotic_maps.Sequence(np.zeros(shape), 0, 0)
    name = chaotic_maps.Map(settings.chaotic_map).name
    start = settings.chaotic_start
    if settings.chaotic_start_rule == StartRule.random:
        start = chaotic_maps.draw_start(chaos, name, settings.singer_mu)
    elif settings.chaotic_start_rule == StartRule.uniform:
        start = chaos.random()
    found = chaotic_maps.compute_sequence(name, start, math.prod(shape), settings.singer_mu)
    # From the number at which it collapsed to the iteration that uses this number.
    collapsed_in = math.ceil(found.collapsed_at / math.prod(shape[1:])) if found.collapsed_at else 0
    return chaotic_maps.Sequence(found.values.reshape(shape), found.clips, collapsed_in)


@compile_kernel
def _run_swarm(rng, x, zeta, low, high, limit, objective, rules):
    """Run Algorithm 1 of tharwat2018 and return the first fields of a `Swarm`.

    x: (particles, dimensions), the initial positions; moved in place.
    zeta: (iterations, particles or 1, dimensions or 1).
    low, high, limit: (dimensions,), the field and the largest velocity.
    """
    iterations = len(zeta)
    particles, dimensions = x.shape
    samples = objective.free.shape[1]
    curve, scratch = np.empty((2, samples)), np.empty(samples)
    v = np.zeros_like(x)
    p, p_fitness = np.empty_like(x), np.full(particles, np.inf)
    g, g_fitness = np.empty((iterations + 1, dimensions)), np.full(iterations + 1, np.inf)
    g_violation, g_colliding = np.inf, 0
    r = np.empty(2)
    w = rules.inertia
    infeasible, colliding_samples, best_colliding_samples, best_infeasible = 0, 0, 0, 0
    improved_at = 0

    for t in range(iterations + 1):
        before = max(t - 1, 0)
        copy(g[before], g[t])
        g_fitness[t] = g_fitness[before]
        for i in range(particles):
            penalised.write_curve(x[i], objective, curve)
            tested = curve
            if rules.tested == Tested.control_points:
                tested = x[i].reshape((2, dimensions // 2))
            violation, colliding = penalised.measure_violation(tested, objective, scratch)
            infeasible += violation > FEASIBLE
            colliding_samples += colliding
            # Most paths are too long to be a best one, which a few chords tell.
            fitness = penalised.compute_fitness(penalised.bound_length(curve), violation, objective)
            if fitness < p_fitness[i]:
                length = penalised.measure_length(curve, scratch)
                fitness = penalised.compute_fitness(length, violation, objective)
            if fitness < p_fitness[i]:
                copy(x[i], p[i])
                p_fitness[i] = fitness
            if fitness < g_fitness[t]:
                copy(x[i], g[t])
                g_fitness[t] = fitness
                g_violation, g_colliding = violation, colliding
                improved_at = t
            # Each particle moves at once, with the best of those before it in the same iteration
            # (Algorithm 1).
            if t < iterations:
                if rules.random_numbers == RandomNumbers.particle or (
                    rules.random_numbers == RandomNumbers.iteration and i == 0
                ):
                    r[0], r[1] = rng.random(), rng.random()
                own = zeta[t, min(i, zeta.shape[1] - 1)]
                _move(rng, r, x[i], v[i], p[i], g[t], own, w, limit, rules)
                _hold(x[i], v[i], low, high, rules.bound_rule)
        best_infeasible += g_violation > FEASIBLE
        # The damped inertia is that of the next iteration: the first one moves with `inertia`
        # itself.
        w *= rules.inertia_damping
        if t > 0:
            best_colliding_samples += g_colliding
        # A limit of 0 is none.
        if t - improved_at == rules.stall_limit > 0:
            break
    return (
        g[: t + 1],
        g_fitness[: t + 1],
        g_violation,
        infeasible,
        colliding_samples,
        best_colliding_samples,
        best_infeasible,
    )


@allocation_free
def _move(rng, r, x, v, p, g, zeta, w, limit, rules):
    """Move one particle, in place: its velocity and position (tharwat2018, eqs. 8 and 7; CPSO-I:
    eq. 17, CPSO-II: eq. 18).

    zeta: (dimensions or 1,), this particle's number(s) of the chaotic sequence.
    """
    for d in range(len(x)):
        if rules.random_numbers == RandomNumbers.dimension:
            r[0], r[1] = rng.random(), rng.random()
        r1, r2 = r[0], r[1]
        # The chaotic number replaces one that was drawn: all methods draw the same numbers.
        if rules.chaotic_term == ChaoticTerm.cognitive:
            r1 = zeta[min(d, len(zeta) - 1)]
        elif rules.chaotic_term == ChaoticTerm.social:
            r2 = zeta[min(d, len(zeta) - 1)]
        v[d] = w * v[d] + rules.c1 * r1 * (p[d] - x[d]) + rules.c2 * r2 * (g[d] - x[d])
        v[d] = min(max(v[d], -limit[d]), limit[d])
        x[d] += v[d]


@allocation_free
def _hold(x, v, low, high, bound_rule):
    """Bring one particle back into the field, in place."""
    for d in range(len(x)):
        if not low[d] <= x[d] <= high[d]:
            x[d] = min(max(x[d], low[d]), high[d])
            if bound_rule == BoundRule.mirror:
                v[d] = -v[d]
            elif bound_rule == BoundRule.stop:
                v[d] = 0.0
