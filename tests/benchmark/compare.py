"""The chaotic swarm beside other libraries: `make compare`, in an environment of its own
(requirements.txt).

The first part; the second sets OMPL beside the planners of all studies (compare_planners.py).

All search the same path, between the three circles of tharwat2018 with the public radii, with the
same number of evaluations of the same objective: ours, compiled, of a whole swarm at once where a
library takes that. So the difference in speed is their loop against ours. Velocity limit, inertia
and learning factors are those of the study's profile `tuned` where a library has them, else its
inertia is 0.73; how a bound is kept is its own affair.

Evaluations a second of one core's CPU time, how often ours is as fast, and how good the paths are
over 100 seeds: the share in the good corridor (shorter than 8 units and free of collisions; the
next one begins above 9), median and quartiles of the objective.
"""

import logging
import math
import operator
import random
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

import numpy as np
from deap import base, creator, tools
from mealpy import FloatVar, Optimizer
from mealpy.evolutionary_based.GA import BaseGA
from mealpy.swarm_based.PSO import OriginalPSO
from numba import njit
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem as PymooProblem
from pymoo.optimize import minimize
from pyswarms.single import GlobalBestPSO

from bezierplan.planners import chaotic_pso
from bezierplan.planners.parts import penalised
from bezierplan.planners.parts.settings import filled
from bezierplan.study import reading
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Problem

SEEDS = 100
GOOD = 8.0

STUDY = reading.load(reading.read_config({"studies": ["tharwat2018"]}))["tharwat2018"]
PROBLEM = Problem(
    "public", files.load(STUDY.workspaces["public"].plain(), STUDY.folder), (0.0, 0.0), (4.0, 6.0)
)
SETTINGS = STUDY.resolved("pso") | STUDY.presets["profile"]["tuned"] | {"stall_limit": 0}
PARTICLES, ITERATIONS, DIMENSIONS = (
    SETTINGS["particles"],
    SETTINGS["iterations"],
    2 * SETTINGS["control_points"],
)
EVALUATIONS = PARTICLES * (ITERATIONS + 1)
LOW, HIGH = np.repeat(np.reshape(PROBLEM.workspace.bounds, (2, 2)).T, DIMENSIONS // 2, axis=1)
LIMIT = SETTINGS["velocity_limit"] * (HIGH - LOW)
OBJECTIVE = chaotic_pso._objective(PROBLEM, filled(chaotic_pso.Settings, SETTINGS))


@njit(cache=True)
def _fitness(z, objective):
    """Fitness (k,) of particles (k, dimensions), as the swarm's own kernel computes it."""
    samples = objective.free.shape[1]
    curve, scratch = np.empty((2, samples)), np.empty(samples)
    fitness = np.empty(len(z))
    for i in range(len(z)):
        length = penalised.length(z[i], objective, curve, scratch)
        violation, _ = penalised.violation(curve, objective, scratch)
        fitness[i] = penalised.fitness(length, violation, objective)
    return fitness


def fitness(positions: np.ndarray) -> np.ndarray:
    return _fitness(positions, OBJECTIVE)


# Each takes a seed and gives the objective of the best path.


def ours(method: str) -> Callable[[int], float]:
    settings = STUDY.resolved(method) | STUDY.presets["profile"]["tuned"] | {"stall_limit": 0}
    return lambda seed: chaotic_pso.plan(PROBLEM, np.random.default_rng(seed), **settings).objective


def with_pyswarms(seed: int) -> float:
    np.random.seed(seed)  # noqa: NPY002, it draws from the global generator
    options = {"w": 0.73, "c1": SETTINGS["c1"], "c2": SETTINGS["c2"]}
    swarm = GlobalBestPSO(
        PARTICLES, DIMENSIONS, options, bounds=(LOW, HIGH), velocity_clamp=(-LIMIT, LIMIT)
    )
    best, _ = swarm.optimize(fitness, ITERATIONS + 1, verbose=False)
    return float(best)


class Curves(PymooProblem):
    def __init__(self) -> None:
        super().__init__(n_var=DIMENSIONS, n_obj=1, xl=LOW, xu=HIGH)

    def _evaluate(self, x: np.ndarray, out: dict, *args, **kwargs) -> None:
        out["F"] = fitness(np.ascontiguousarray(x))


def with_pymoo(algorithm: Callable) -> Callable[[int], float]:
    return lambda seed: float(
        minimize(Curves(), algorithm(), ("n_eval", EVALUATIONS), seed=seed).F[0]
    )


def pymoo_pso() -> PSO:
    share = SETTINGS["velocity_limit"]
    return PSO(
        PARTICLES,
        w=0.73,
        c1=SETTINGS["c1"],
        c2=SETTINGS["c2"],
        adaptive=False,
        max_velocity_rate=share,
        pertube_best=False,
    )


def with_deap(seed: int) -> float:
    """The swarm of DEAP's documentation (examples/pso/basic), with inertia, positions kept in the
    field and one evaluation a particle.
    """
    random.seed(seed)
    swarm = [
        creator.Particle(random.uniform(low, high) for low, high in zip(LOW, HIGH))
        for _ in range(PARTICLES)
    ]
    for particle in swarm:
        particle.speed, particle.best = [0.0] * DIMENSIONS, None
    best, inertia = None, SETTINGS["inertia"]
    for _ in range(ITERATIONS + 1):
        for particle in swarm:
            particle.fitness.values = TOOLBOX.evaluate(particle)
            if particle.best is None or particle.best.fitness < particle.fitness:
                particle.best = TOOLBOX.clone(particle)
            if best is None or best.fitness < particle.fitness:
                best = TOOLBOX.clone(particle)
        for particle in swarm:
            TOOLBOX.update(particle, best, inertia)
        inertia *= SETTINGS["inertia_damping"]
    return best.fitness.values[0]


def _update(particle: list, best: list, inertia: float) -> None:
    own = (random.uniform(0, SETTINGS["c1"]) * (p - x) for p, x in zip(particle.best, particle))
    social = (random.uniform(0, SETTINGS["c2"]) * (g - x) for g, x in zip(best, particle))
    moved = map(operator.add, (inertia * v for v in particle.speed), map(operator.add, own, social))
    particle.speed = [max(-limit, min(limit, v)) for v, limit in zip(moved, LIMIT)]
    particle[:] = [
        max(low, min(high, x + v)) for x, v, low, high in zip(particle, particle.speed, LOW, HIGH)
    ]


def _copy(particle: list) -> list:
    copy = creator.Particle(particle)
    copy.fitness.values = particle.fitness.values
    return copy


creator.create("Shortest", base.Fitness, weights=(-1.0,))
creator.create("Particle", list, fitness=creator.Shortest, speed=list, best=None)
TOOLBOX = base.Toolbox()
TOOLBOX.register("clone", _copy)
TOOLBOX.register("update", _update)
TOOLBOX.register("evaluate", lambda particle: (float(fitness(np.array([particle]))[0]),))


def deap_genetic(seed: int) -> float:
    """DEAP's simple genetic algorithm: two-point crossover, Gaussian mutation, tournaments of
    three.
    """
    from deap import algorithms

    random.seed(seed)
    swarm = [
        creator.Particle(random.uniform(low, high) for low, high in zip(LOW, HIGH))
        for _ in range(PARTICLES)
    ]
    best, evaluated = tools.HallOfFame(1), 0
    toolbox = base.Toolbox()
    toolbox.register("evaluate", TOOLBOX.evaluate)
    toolbox.register("mate", tools.cxTwoPoint)
    toolbox.register("mutate", tools.mutGaussian, mu=0, sigma=1.0, indpb=0.2)
    toolbox.register("select", tools.selTournament, tournsize=3)
    while evaluated < EVALUATIONS:
        swarm, log = algorithms.eaSimple(
            swarm, toolbox, 0.7, 0.3, 1, halloffame=best, verbose=False
        )
        evaluated += sum(log.select("nevals"))
    return best[0].fitness.values[0]


def with_mealpy(algorithm: Callable[[], Optimizer]) -> Callable[[int], float]:
    field = {
        "obj_func": lambda z: float(fitness(z[None])[0]),
        "bounds": FloatVar(lb=LOW, ub=HIGH),
        "minmax": "min",
        "log_to": None,
    }
    return lambda seed: (
        algorithm().solve(field, seed=seed, termination={"max_fe": EVALUATIONS}).target.fitness
    )


def mealpy_pso() -> OriginalPSO:
    """Its velocities have no limit, a particle moves only to improve, and a coordinate beyond the
    field is drawn anew.
    """
    return OriginalPSO(ITERATIONS, PARTICLES, c1=SETTINGS["c1"], c2=SETTINGS["c2"], w=0.73)


LIBRARIES: dict[str, Callable[[int], float]] = {
    "bezierplan pso": ours("pso"),
    "bezierplan cpso1": ours("cpso1_singer"),
    "bezierplan cpso2": ours("cpso2_singer"),
    "pyswarms pso": with_pyswarms,
    "pymoo pso": with_pymoo(pymoo_pso),
    "pymoo genetic": with_pymoo(lambda: GA(pop_size=PARTICLES)),
    "deap pso": with_deap,
    "deap genetic": deap_genetic,
    "mealpy pso": with_mealpy(mealpy_pso),
    "mealpy genetic": with_mealpy(lambda: BaseGA(ITERATIONS, PARTICLES)),
}


def main() -> None:
    logging.disable(logging.INFO)
    print(f"{EVALUATIONS} evaluations a run, {SEEDS} seeds\n")
    print(
        f"{'':20}{'evaluations/s':>16}{'ours is faster':>16}{'share < 8':>12}"
        f"{'quartile 1':>12}{'median':>10}{'quartile 3':>12}"
    )
    fastest = math.nan
    for name, run in LIBRARIES.items():
        run(0)
        before = time.process_time()
        found = np.array([run(seed) for seed in range(SEEDS)])
        rate = SEEDS * EVALUATIONS / (time.process_time() - before)
        fastest = rate if name == "bezierplan pso" else fastest
        low, median, high = np.quantile(found, [0.25, 0.5, 0.75])
        print(
            f"{name:20}{rate:16,.0f}{fastest / rate:16.1f}{np.mean(found < GOOD):12.2f}"
            f"{low:12.3f}{median:10.3f}{high:12.3f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
