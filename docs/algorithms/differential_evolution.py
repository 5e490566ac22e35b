"""Differential evolution (Storn and Price 1997, DE/rand/1/bin) on the objective of tharwat2018's
swarm, in plain Python. `planners/differential_evolution.py` finds the same paths, bit for bit.
"""

import numpy as np
import tharwat2018

from bezierplan.geometry.curves import sample_matrix

METHOD = "tharwat2018/differential_evolution"


def plan(
    problem,
    rng,
    *,
    population=20,  # NP, the swarm's particles
    generations=60,
    weight=0.7,  # F
    crossover=0.9,  # CR
    control_points=3,
    samples=100,
    factor=100.0,  # beta
):
    """Control points (control_points + 2, 2) of the best path, and the least cost after each
    generation (generations + 1,).
    """
    circles = np.column_stack([problem.workspace.centres, problem.workspace.radii])
    left, right, bottom, top = problem.workspace.bounds
    low = np.repeat([left, bottom], control_points)
    high = np.repeat([right, top], control_points)
    weights = sample_matrix("bezier", control_points + 2, samples)
    starts, moves = rng.spawn(2)

    def cost(vector):
        return tharwat2018.fitness(vector, problem, weights, circles, factor)

    # A vector is (x_1 ... x_n, y_1 ... y_n).
    x = low + (high - low) * starts.random((population, 2 * control_points))
    costs = np.array([cost(vector) for vector in x])
    history = [costs.min()]
    for _ in range(generations):
        trials = x.copy()
        for i in range(population):
            a, b, c = three_others(moves, i, population)
            forced = moves.integers(0, len(low))
            for k in range(len(low)):
                if moves.random() < crossover or k == forced:
                    trials[i, k] = np.clip(x[a, k] + weight * (x[b, k] - x[c, k]), low[k], high[k])
        for i in range(population):
            value = cost(trials[i])
            if value <= costs[i]:
                x[i], costs[i] = trials[i], value
        history.append(costs.min())
    best = x[costs.argmin()]
    return np.vstack([problem.start, best.reshape(2, -1).T, problem.target]), np.array(history)


def three_others(rng, i, population):
    """Three different vectors, none of which is i."""
    chosen = [i]
    while len(chosen) < 4:
        drawn = int(rng.integers(0, population))
        if drawn not in chosen:
            chosen.append(drawn)
    return chosen[1:]
