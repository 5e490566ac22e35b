"""Particle swarm optimisation of a path's control points, plain (PSO) or with a chaotic sequence instead of one of its two random numbers:
that of the cognitive term (CPSO-I) or of the social term (CPSO-II) (tharwat2018, Sections 3.2 and 4).

A particle is (x_1, ..., x_n, y_1, ..., y_n), the coordinates of the n free control points of one curve; among spheres, z_1, ..., z_n follow
(Section 6). The curve is linear in them, so to the kernels every curve kind is a constant matrix. Obstacles are tested at samples of the
curve.

All methods draw the same numbers: positions, moves and the start of the chaotic sequence come from three generators; positions are drawn
particle by particle, and for each move r1 before r2; the number that the chaotic sequence replaces is drawn and discarded.
"""

import logging
import math
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple, get_args

import numpy as np

from bezierplan.geometry import curves
from bezierplan.kernels import allocation_free, compiled
from bezierplan.planners import Plan, Range
from bezierplan.planners.parts import chaotic_maps, penalised
from bezierplan.planners.parts.penalised import FEASIBLE, Objective, Penalty
from bezierplan.workspaces.problem import Path, Problem

logger = logging.getLogger(__name__)

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

ChaoticTerm = Literal["none", "cognitive", "social"]
RandomNumbers = Literal["dimension", "particle", "iteration"]
BoundRule = Literal["mirror", "clamp", "stop", "none"]
_NO_TERM, _COGNITIVE, _SOCIAL = range(3)
_EACH_DIMENSION, _EACH_PARTICLE, _EACH_ITERATION = range(3)
_MIRROR, _CLAMP, _STOP, _NO_BOUND = range(4)

# This share of the particles starts around a given path, at a distance of about this share of the field's side per coordinate.
_AROUND = 0.5
_SPREAD = 0.05


class Swarm(NamedTuple):
    """Result of a swarm after `done` iterations.

    positions: (done + 1, d n) in d dimensions, and fitness: (done + 1,) of its best path after iteration 0, 1, ..., done. violation: that
    of the last of them. infeasible: number of evaluated paths that collide; colliding_samples: colliding samples of all evaluated paths,
    summed over obstacles. best_colliding_samples: those of the best path, summed over the iterations. best_infeasible: number of
    iterations, including the initial one, after which the best path collides. zeta_clipped: number of clipped values of the chaotic
    sequence. zeta_collapsed_at: the iteration at which the sequence collapsed, or 0.
    """

    positions: np.ndarray
    fitness: np.ndarray
    violation: float
    infeasible: int
    colliding_samples: int
    best_colliding_samples: int
    best_infeasible: int
    zeta_clipped: int
    zeta_collapsed_at: int


class Settings(NamedTuple):
    """The settings of `plan`, under the same names."""

    curve: str
    control_points: int
    samples: int
    penalty: str
    beta: float
    d_min: float
    particles: int
    iterations: int
    stall_limit: int
    straight_line_particle: bool
    c1: float
    c2: float
    inertia: float
    inertia_damping: float
    velocity_limit: float
    bound_rule: str
    random_numbers: str
    update: str
    chaotic_term: str
    chaotic_map: str
    chaotic_start_rule: str
    chaotic_start: float
    zeta_for: str
    singer_mu: float
    singer_x4: float
    sine_a: float
    piecewise_p: float
    sinusoidal_a: float
    count_collisions: bool


def check(settings: dict) -> None:
    """Rules across several settings. Raises ValueError naming the setting and what is expected; warns if the swarm cannot move."""
    try:
        curves.piece_matrix(settings["curve"], settings["control_points"] + 2)
    except ValueError as error:
        raise ValueError(f"control_points: {settings['control_points']}, beside start and target; {error}") from None
    if settings["chaotic_map"] == "constant" and settings["chaotic_start_rule"] == "random":
        raise ValueError("chaotic_start_rule: random; a constant map needs fixed, its value is chaotic_start")
    if settings["particles"] == 1:
        logger.warning("particles: 1; the only particle is its own best and the swarm's, so it never moves")


def plan(
    problem: Problem,
    rng: np.random.Generator,
    start: np.ndarray | None = None,
    *,
    curve: Literal["bezier", "spline", "ferguson"],
    control_points: Annotated[int, Range(0, 60)],
    samples: Annotated[int, Range(2)],
    penalty: Penalty,
    beta: Annotated[float, Range(0)],
    d_min: Annotated[float, Range(0)],
    particles: Annotated[int, Range(1)],
    iterations: Annotated[int, Range(0)],
    stall_limit: Annotated[int, Range(0)],
    straight_line_particle: bool,
    c1: Annotated[float, Range(0)],
    c2: Annotated[float, Range(0)],
    inertia: Annotated[float, Range(0)],
    inertia_damping: Annotated[float, Range(0, 1)],
    velocity_limit: Annotated[float, Range(0, math.inf)],
    bound_rule: BoundRule,
    random_numbers: RandomNumbers,
    update: Literal["asynchronous", "synchronous"],
    chaotic_term: ChaoticTerm,
    chaotic_map: chaotic_maps.Map,
    chaotic_start_rule: Literal["random", "fixed"],
    chaotic_start: Annotated[float, Range(0, 1)],
    zeta_for: Literal["iteration", "particle", "dimension"],
    singer_mu: Annotated[float, Range(0.9, 1.08)],
    singer_x4: Annotated[float, Range(13, 14)],
    sine_a: Annotated[float, Range(0, 4)],
    piecewise_p: Annotated[float, Range(0.01, 0.49)],
    sinusoidal_a: Annotated[float, Range(0, 4)],
    count_collisions: bool,
) -> Plan:
    """Shortest penalised curve from start to target with the given number of free control points (tharwat2018, Algorithm 1, eqs. 7, 8, 17
    to 22).

    start: (n, 2) free control points, in units, at which the first particle starts, and half of all particles around it; without them all
    start anywhere.

    control_points: number of free ones, in addition to start and target; those of a `ferguson` curve alternate between tangents and points.
    samples: points of the curve that are tested and measured, uniform in the parameter, both ends included. penalty: the fitness of a path
    of length L and violation V is L (1 + beta V), L + beta V, or (death) L if it is feasible and beta otherwise. d_min: added to every
    radius, in units (eq. 21).

    stall_limit: number of iterations without improvement after which the search stops; 0 for never. straight_line_particle: whether the
    first particle starts as the straight line. c1, c2: C1 and C2, the cognition and social learning factors. inertia: w of the first
    iteration; inertia_damping: its factor from one iteration to the next. velocity_limit: largest change of a coordinate per iteration, as
    a share of the field's side; infinite for no limit. bound_rule: a coordinate that leaves the field is moved to its border, and its
    velocity is mirrored, kept (clamp), or set to zero (stop); or it stays outside (none). random_numbers: what gets its own r1 and r2.
    update: the swarm's best path is replaced as soon as a particle finds a better one, or once all have moved.

    chaotic_term: the term in which the chaotic sequence replaces the random number. chaotic_start: first number of the sequence under the
    rule `fixed`; for the map `constant`, every number. zeta_for: what gets its own number of the sequence. singer_mu, ..., sinusoidal_a:
    see `chaotic_maps.Parameters`. count_collisions: if false, paths too long to be an improvement are not tested, which changes no result;
    collisions_a, _b and _f are then nan.

    The planner's own test: V at most `FEASIBLE`. Extra columns: violation, the path's V; zeta_collapsed_at and zeta_clipped as in `Swarm`;
    and six readings of the paper's undefined number of collisions: particles per iteration (a), samples per evaluated path (b), samples of
    the best path, summed over the iterations (c), iterations whose best path collides (d), final paths, 0 or 1 (e), evaluated paths in the
    run (f).
    """
    settings = Settings(
        curve=curve,
        control_points=control_points,
        samples=samples,
        penalty=penalty,
        beta=beta,
        d_min=d_min,
        particles=particles,
        iterations=iterations,
        stall_limit=stall_limit,
        straight_line_particle=straight_line_particle,
        c1=c1,
        c2=c2,
        inertia=inertia,
        inertia_damping=inertia_damping,
        velocity_limit=velocity_limit,
        bound_rule=bound_rule,
        random_numbers=random_numbers,
        update=update,
        chaotic_term=chaotic_term,
        chaotic_map=chaotic_map,
        chaotic_start_rule=chaotic_start_rule,
        chaotic_start=chaotic_start,
        zeta_for=zeta_for,
        singer_mu=singer_mu,
        singer_x4=singer_x4,
        sine_a=sine_a,
        piecewise_p=piecewise_p,
        sinusoidal_a=sinusoidal_a,
        count_collisions=count_collisions,
    )
    swarm = search(problem, rng, settings, start)
    done = len(swarm.fitness) - 1
    evaluations = (1 if control_points == 0 else particles) * (done + 1)
    feasible = swarm.violation <= FEASIBLE
    infeasible = swarm.infeasible if count_collisions else math.nan
    return Plan(
        path=Path(curve, _points(swarm.positions[-1], curve, problem)),
        objective=swarm.fitness[-1],
        claimed_feasible=feasible,
        evaluations=evaluations,
        history=swarm.fitness,
        stop="iterations" if done == iterations or control_points == 0 else "stall",
        extra={
            "violation": swarm.violation,
            "collisions_a": infeasible / evaluations * particles,
            "collisions_b": (swarm.colliding_samples if count_collisions else math.nan) / evaluations,
            "collisions_c": swarm.best_colliding_samples,
            "collisions_d": swarm.best_infeasible,
            "collisions_e": int(not feasible),
            "collisions_f": float(infeasible),
            "zeta_collapsed_at": swarm.zeta_collapsed_at,
            "zeta_clipped": swarm.zeta_clipped,
        },
    )


def track(problem: Problem, rng: np.random.Generator, **settings: Any) -> np.ndarray:
    """Control points (iterations done + 1, control points, d) of the best path after every iteration of the run that `plan` makes with the
    same generator and settings, in units (tharwat2018, Figure 12)."""
    positions = search(problem, rng, Settings(**settings)).positions
    return np.array([_points(position, settings["curve"], problem) for position in positions])


def search(problem: Problem, rng: np.random.Generator, settings: Settings, start: np.ndarray | None = None) -> Swarm:
    """The search behind `plan` and `track`."""
    initial, moves, chaos = rng.spawn(3)
    particles, iterations, dimensions = settings.particles, settings.iterations, len(problem.start) * settings.control_points
    if dimensions == 0:
        particles, iterations = 1, 0
    objective = _objective(problem, settings)
    low, high = np.repeat(np.reshape(problem.workspace.bounds, (-1, 2)).T, settings.control_points, axis=1)
    shares = initial.random((particles, dimensions))
    if start is not None:
        around = int(_AROUND * particles)
        known = (start.T.ravel() - low) / (high - low)
        shares[:around] = np.clip(known + _SPREAD * initial.standard_normal((around, dimensions)), 0.0, 1.0)
        shares[0] = known
    x = low + (high - low) * shares
    if settings.straight_line_particle:
        x[0] = _straight_line(problem, settings.curve, settings.control_points)
    zeta, clipped, collapsed_at = _zeta(chaos, (iterations, particles, dimensions), settings)
    rules = _Rules(
        stall_limit=settings.stall_limit,
        c1=float(settings.c1),  # an integer would recompile the kernels
        c2=float(settings.c2),
        inertia=float(settings.inertia),
        inertia_damping=float(settings.inertia_damping),
        bound_rule=get_args(BoundRule).index(settings.bound_rule),
        random_numbers=get_args(RandomNumbers).index(settings.random_numbers),
        synchronous=settings.update == "synchronous",
        chaotic_term=get_args(ChaoticTerm).index(settings.chaotic_term),
        count_collisions=settings.count_collisions,
    )
    return Swarm(*_swarm(moves, x, zeta, low, high, settings.velocity_limit * (high - low), objective, rules), clipped, collapsed_at)


class _Rules(NamedTuple):
    """Settings of `plan` for the kernels, choices as numbers."""

    stall_limit: int
    c1: float
    c2: float
    inertia: float
    inertia_damping: float
    bound_rule: int
    random_numbers: int
    synchronous: bool
    chaotic_term: int
    count_collisions: bool


def _objective(problem: Problem, settings: Settings) -> Objective:
    ends, free = _basis(settings.curve, settings.control_points, settings.samples)
    return Objective(
        ends=np.array([problem.start, problem.target]).T @ ends,
        free=free,
        balls=penalised.round_obstacles(problem.workspace, settings.d_min),
        polygons=penalised.polygonal_obstacles(problem.workspace, settings.d_min),
        penalty=get_args(Penalty).index(settings.penalty),
        beta=float(settings.beta),
    )


@cache
def _basis(curve: str, control_points: int, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Weights of start and target (2, samples) and of the free control points (n, samples) at the samples of a curve."""
    basis = curves.sample_matrix(curve, control_points + 2, samples).T
    return basis[list(curves.ends(curve))], np.ascontiguousarray(basis[_free(curve, control_points)])


@cache
def _free(curve: str, control_points: int) -> np.ndarray:
    """Which control points of a curve are free (n,)."""
    return np.delete(np.arange(control_points + 2), curves.ends(curve))


def _points(position: np.ndarray, curve: str, problem: Problem) -> np.ndarray:
    """Control points (n + 2, d) of a particle (d n,)."""
    d = len(problem.start)
    n = len(position) // d
    points = np.empty((n + 2, d))
    points[list(curves.ends(curve))] = problem.start, problem.target
    points[_free(curve, n)] = position.reshape(d, n).T
    return points


def _straight_line(problem: Problem, curve: str, control_points: int) -> np.ndarray:
    """The particle (d n,) whose curve is the straight line, traversed at constant speed."""
    start, way = np.array(problem.start), np.subtract(problem.target, problem.start)
    points = np.empty((control_points + 2, len(start)))
    if curve == "ferguson":
        points[::2] = start + np.outer(np.linspace(0, 1, control_points // 2 + 1), way)
        points[1::2] = way / (control_points // 2)
    else:
        points[:] = start + np.outer(np.linspace(0, 1, control_points + 2), way)
    return points[_free(curve, control_points)].T.ravel()


def _zeta(chaos: np.random.Generator, size: tuple[int, int, int], settings: Settings) -> chaotic_maps.Sequence:
    """The chaotic sequence: its values (iterations, particles or 1, dimensions or 1) and the iteration at which it collapsed."""
    shape = size[: {"iteration": 1, "particle": 2, "dimension": 3}[settings.zeta_for]]
    shape += (1,) * (3 - len(shape))
    if settings.chaotic_term == "none":
        return chaotic_maps.Sequence(np.zeros(shape), 0, 0)
    parameters = chaotic_maps.Parameters(
        singer_mu=float(settings.singer_mu),
        singer_x4=float(settings.singer_x4),
        sine_a=float(settings.sine_a),
        piecewise_p=float(settings.piecewise_p),
        sinusoidal_a=float(settings.sinusoidal_a),
    )
    start = settings.chaotic_start
    if settings.chaotic_start_rule == "random":
        start = chaotic_maps.random_start(chaos, settings.chaotic_map, parameters)
    found = chaotic_maps.sequence(settings.chaotic_map, float(start), math.prod(shape), parameters)
    collapsed_in = math.ceil(found.collapsed_at / math.prod(shape[1:])) if found.collapsed_at else 0
    return chaotic_maps.Sequence(found.values.reshape(shape), found.clipped, collapsed_in)


@compiled
def _swarm(rng, x, zeta, low, high, limit, objective, rules):
    """Algorithm 1 of tharwat2018; returns the first fields of a `Swarm`.

    x: (particles, dimensions), the initial positions; moved in place. zeta: (iterations, particles or 1, dimensions or 1). low, high,
    limit: (dimensions,), the field and the largest velocity.
    """
    iterations = len(zeta)
    particles, dimensions = x.shape
    samples = objective.free.shape[1]
    curve, scratch = np.empty((len(objective.ends), samples)), np.empty(samples)
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
        _copy(g[before], g[t])
        g_fitness[t] = g_fitness[before]
        attractor = g[before] if rules.synchronous else g[t]
        for i in range(particles):
            if t > 0:
                if rules.random_numbers == _EACH_PARTICLE or (rules.random_numbers == _EACH_ITERATION and i == 0):
                    _draw(rng, r)
                _move(rng, r, x[i], v[i], p[i], attractor, zeta[before, min(i, zeta.shape[1] - 1)], w, limit, rules)
                _hold(x[i], v[i], low, high, rules.bound_rule)
            length = penalised.length(x[i], objective, curve, scratch)
            if not rules.count_collisions and penalised.least_fitness(length, objective) >= p_fitness[i]:
                continue
            violation, colliding = penalised.violation(curve, objective, scratch)
            infeasible += violation > FEASIBLE
            colliding_samples += colliding
            fitness = penalised.fitness(length, violation, objective)
            if fitness < p_fitness[i]:
                _copy(x[i], p[i])
                p_fitness[i] = fitness
            if fitness < g_fitness[t]:
                _copy(x[i], g[t])
                g_fitness[t] = fitness
                g_violation, g_colliding = violation, colliding
                improved_at = t
        best_infeasible += g_violation > FEASIBLE
        if t > 0:
            best_colliding_samples += g_colliding
            w *= rules.inertia_damping
        if t - improved_at == rules.stall_limit > 0:
            break
    return g[: t + 1], g_fitness[: t + 1], g_violation, infeasible, colliding_samples, best_colliding_samples, best_infeasible


@allocation_free
def _copy(source, target):
    for d in range(len(source)):
        target[d] = source[d]


@allocation_free
def _draw(rng, r):
    r[0] = rng.random()
    r[1] = rng.random()


@allocation_free
def _move(rng, r, x, v, p, g, zeta, w, limit, rules):
    """Velocity and position of one particle, in place (tharwat2018, eqs. 8 and 7; CPSO-I: eq. 17, CPSO-II: eq. 18).

    zeta: (dimensions or 1,), this particle's number(s) of the chaotic sequence.
    """
    for d in range(len(x)):
        if rules.random_numbers == _EACH_DIMENSION:
            _draw(rng, r)
        r1, r2 = r[0], r[1]
        if rules.chaotic_term == _COGNITIVE:
            r1 = zeta[min(d, len(zeta) - 1)]
        elif rules.chaotic_term == _SOCIAL:
            r2 = zeta[min(d, len(zeta) - 1)]
        v[d] = w * v[d] + rules.c1 * r1 * (p[d] - x[d]) + rules.c2 * r2 * (g[d] - x[d])
        v[d] = min(max(v[d], -limit[d]), limit[d])
        x[d] += v[d]


@allocation_free
def _hold(x, v, low, high, bound_rule):
    """Bring one particle back into the field, in place."""
    if bound_rule == _NO_BOUND:
        return
    for d in range(len(x)):
        if not low[d] <= x[d] <= high[d]:
            x[d] = min(max(x[d], low[d]), high[d])
            if bound_rule == _MIRROR:
                v[d] = -v[d]
            elif bound_rule == _STOP:
                v[d] = 0.0
