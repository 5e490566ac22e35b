"""Chaotic particle swarm optimisation (tharwat2018, Algorithm 1 and Section 4), CPSO-I or CPSO-II
with the Singer map: the default reading in plain Python. `planners/chaotic_pso.py` finds the same
paths, bit for bit, much faster. Sums run from the first term to the last (`np.cumsum`).
"""

import numpy as np

from bezierplan.geometry.curves import sample_matrix

METHOD = "tharwat2018/cpso2_singer"


def plan(
    problem,
    rng,
    *,
    chaotic_term="social",  # CPSO-II, eq. 18; cognitive: CPSO-I, eq. 17
    particles=20,  # N, Table 2
    iterations=60,  # Max_iter
    stall_limit=10,  # Section 4.2.1
    c1=1.5,  # C1, C2
    c2=1.5,
    inertia=0.7298,  # w, which is not printed
    control_points=3,  # Section 5.1
    samples=100,
    beta=100.0,
    singer_mu=1.07,
):
    """Control points (control_points + 2, 2) of the best path, and its fitness after each iteration
    (iterations done + 1,).
    """
    circles = np.column_stack([problem.workspace.centres, problem.workspace.radii])
    left, right, bottom, top = problem.workspace.bounds
    low = np.repeat([left, bottom], control_points)
    high = np.repeat([right, top], control_points)
    weights = sample_matrix("bezier", control_points + 2, samples)  # eqs. 1 and 2
    initial, moves, chaos = rng.spawn(3)
    zeta = singer(chaos, iterations, singer_mu)

    # Algorithm 1. Line 1: random positions, no velocity. A particle is (x_1 ... x_n, y_1 ... y_n).
    x = low + (high - low) * initial.random((particles, 2 * control_points))
    v, p, p_fitness = np.zeros_like(x), x.copy(), np.full(particles, np.inf)
    G, G_fitness, history = None, np.inf, []
    for t in range(iterations + 1):  # line 2
        for i in range(particles):  # line 3
            value = fitness(x[i], problem, weights, circles, beta)  # line 4
            if value < p_fitness[i]:  # lines 5 to 7
                p[i], p_fitness[i] = x[i], value
            if value < G_fitness:  # lines 8 to 10
                G, G_fitness, improved = x[i].copy(), value, t
            if t < iterations:  # line 11
                r1, r2 = moves.random(2)
                if chaotic_term == "social":
                    r2 = zeta[t]
                else:
                    r1 = zeta[t]
                v[i] = inertia * v[i] + c1 * r1 * (p[i] - x[i]) + c2 * r2 * (G - x[i])  # eq. 8
                x[i] = np.clip(x[i] + v[i], low, high)  # eq. 7; the velocity stays
        history.append(G_fitness)
        if t - improved == stall_limit:  # line 13
            break
    points = np.vstack([problem.start, G.reshape(2, -1).T, problem.target])
    return points, np.array(history)


def singer(rng, length, mu):
    """The chaotic sequence (length,) of eq. 10, from a random start from which it does not die,
    held in [0, 1].
    """

    def following(x):
        return mu * x * (7.86 + x * (-23.31 + x * (28.75 - 13.3 * x)))

    while True:
        before = x = start = rng.random()
        for _ in range(60):
            before, x = x, following(x)
        if x >= 1e-12 and abs(x - before) >= 1e-12:
            break
    values = [start]
    while len(values) < length:
        values.append(min(max(following(values[-1]), 0.0), 1.0))
    return values


def fitness(particle, problem, weights, circles, beta):
    """Eq. 22, read as L (1 + beta V)."""
    curve = np.array([problem.start, problem.target]).T @ weights.T[[0, -1]]
    for k, point in enumerate(particle.reshape(2, -1).T, start=1):
        curve += np.outer(point, weights[:, k])
    return length(*curve) * (1 + beta * violation(*curve, circles))


def length(x, y):
    """L, the sum of the chords between samples (eq. 19), in four partial sums as in the kernel."""
    chords = np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2)
    fours = len(chords) // 4 * 4
    a, b, c, d = np.cumsum(chords[:fours].reshape(-1, 4), axis=0)[-1]
    for chord in chords[fours:]:
        a += chord
    return (a + b) + (c + d)


def violation(x, y, circles):
    """V (eqs. 20, 21): for each circle the mean depth of the samples in it, by its radius."""
    V = 0.0
    for x0, y0, r in circles:
        depth = np.maximum(1 - np.sqrt((x - x0) ** 2 + (y - y0) ** 2) / r, 0)
        V += np.cumsum(depth)[-1] / len(x)
    return V
