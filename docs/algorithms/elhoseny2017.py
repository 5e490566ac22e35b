"""The modified genetic algorithm (MGA) of elhoseny2017 (Section 3, Algorithm 2): the default
reading in plain Python, in cells. `planners/modified_genetic.py` finds the same, much faster.
"""

import math

import numpy as np

from bezierplan.geometry.cell_length import list_touched_cells, sample_curve
from bezierplan.workspaces.lattice import compute_distances

METHOD = "elhoseny2017/mga"


def plan(
    problem,
    rng,
    *,
    population=60,  # M, Section 4.2.2
    iterations=80,  # Max_iter
    crossover_probability=0.8,  # Section 4.2
    mutation_rate=0.006,
    eta=0.8,  # Section 4.2.2
    eta_decay=0.99,  # Section 3.3
    most_batches=5,  # line 9 sets no limit
    first_points=5,
    most_points=59,
    first_draws=2_000_000,
    least_distance=2.5,  # r, Figure 4
):
    """Control points (n, 2) of the shortest curve and its length after each iteration, in units."""
    grid = problem.workspace
    corner = np.nextafter(np.array(grid.occupied.shape[::-1], dtype=float), 0.0)
    ends = np.minimum(grid.in_cells(np.array([problem.start, problem.target])), corner)
    # Section 3.2.1: a gene for each of 21 x 21 points; joined by their distance over free cells.
    side = max(grid.occupied.shape)
    walls = np.ones((side, side), dtype=bool)
    walls[: grid.occupied.shape[0], : grid.occupied.shape[1]] = grid.occupied
    steps = np.floor(np.arange(21) * (side - 1) / 20 + 0.5).astype(int)
    column, row = (index.ravel() for index in np.meshgrid(steps, steps, indexing="ij"))
    far = compute_distances(walls, *np.floor(ends[0, ::-1]).astype(int))
    along = np.argsort(far[row, column], kind="stable")
    points = np.column_stack([column, row])[along] + 0.5
    at_end = (points == np.floor(ends[:, None]) + 0.5).all(axis=2).any(axis=0)
    choices = np.flatnonzero(settable := ~walls[row, column][along] & ~at_end)

    def length_of(x):
        """The length of a curve (eqs. 2 and 8), infinite for an invalid one (Section 3.2.2)."""
        near = np.hypot(*(points[x][:, None] - points[x]).T) < least_distance  # Distance Threshold
        if not 0 < x.sum() < 60 or near.sum() > x.sum():
            return np.inf
        xy = sample_curve(np.vstack([ends[:1], points[x], ends[1:]])[None])
        length = np.cumsum(np.sqrt((np.diff(xy) ** 2).sum(axis=0)))[-1]
        return np.inf if walls[list_touched_cells(*xy)[::-1]].any() else length  # Valid Path

    def random_chromosome(most):
        x, wanted = np.zeros(len(points), dtype=bool), rng.integers(1, most + 1)
        while x.sum() < min(wanted, len(choices)):
            x[choices[rng.integers(0, len(choices))]] = True
        return x

    def mutated(x):
        """Each gene but obstacles changes with the mutation rate: gaps of independent trials."""
        gene, unchanged = -1, math.log1p(-mutation_rate)
        while (gene := gene + 1 + int(math.log(1 - rng.random()) / unchanged)) < len(x):
            x[gene] ^= settable[gene]
        return x

    def children(P, wheel):
        """Lines 6 and 7: children, before and after mutation; random ones for invalid ones."""
        for _ in range(population // 2):
            a, b = two_parents(rng, wheel)
            crossed = rng.random() < crossover_probability
            cut = rng.integers(1, len(points)) if crossed else len(points)
            for head, tail in ((a, b), (b, a)):
                for change in (np.copy, mutated):
                    x = change(np.where(along < cut, P[head][0], P[tail][0]))
                    x = x if length_of(x) < np.inf else random_chromosome(most)
                    yield x, length_of(x)

    # Line 1; as long as no chromosome is valid, random ones get up to twice as many points.
    P, most, draws, barren = [], first_points, 0, 0
    while len(P) < population:
        x, draws, barren = random_chromosome(most), draws + 1, barren + 1
        length, best = length_of(x), min([1e9, *(known for _, known in P)])
        if length < np.inf or (barren == 400 and best < 1e9) or draws >= first_draws:
            P, barren = [*P, (x, min(length, 1e9))], 0  # an invalid one never counts
        elif barren == 400:
            most, barren = min(2 * most, most_points), 0
    history = [min(length for _, length in P)]
    for _ in range(iterations):  # line 4
        wheel = np.cumsum([1 / length for _, length in P])  # eq. 9
        for _ in range(1 + most_batches):
            P = P + [child for child in children(P, wheel) if child[1] < np.inf]  # lines 6 and 7
            if mean_q(np.array([x for x, _ in P])) <= eta:  # lines 8 and 9
                break
        P = sorted(P, key=lambda each: each[1])[:population]  # line 15
        history.append(P[0][1])
        eta *= eta_decay  # line 20
    path = np.vstack([problem.start, grid.in_units(points[P[0][0]]), problem.target])
    return path, np.array(history) * grid.cell


def two_parents(rng, wheel):
    """Two different chromosomes by a roulette wheel (Algorithm 1, line 9)."""
    a = min(np.searchsorted(wheel, rng.random() * wheel[-1], side="right"), len(wheel) - 1)
    begin = wheel[a - 1] if a > 0 else 0.0
    at = rng.random() * (wheel[-1] - (wheel[a] - begin))
    at += 0.0 if at < begin else wheel[a] - begin
    return a, min(np.searchsorted(wheel, at, side="right"), len(wheel) - 1)


def mean_q(P):
    """Mean of the Q statistic (eq. 10) over all pairs of chromosomes (n, genes)."""
    ones, zeros = P.astype(float), 1.0 - P
    n11, n10, n01, n00 = ones @ ones.T, ones @ zeros.T, zeros @ ones.T, zeros @ zeros.T
    agree, differ = n11 * n00, n10 * n01
    q = (n10 + n01 == 0).astype(float)  # where eq. 10 divides by 0: 1 for equal ones, else 0
    np.divide(agree - differ, agree + differ, out=q, where=agree + differ > 0)
    return q[np.tril_indices(len(q), -1)].mean()
