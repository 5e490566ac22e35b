"""The modified genetic algorithm (MGA) of elhoseny2017 (Section 3, Algorithm 2): the default
reading in plain Python. `planners/modified_genetic.py` finds the same paths, bit for bit, much
faster. Lengths are in cells until the end; sums run from the first term to the last (`np.cumsum`).
"""

import math

import numpy as np

from bezierplan.geometry.cell_length import parts, sample, touched_cells

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
    first_points=5,
    least_distance=2.5,  # r, Figure 4
):
    """Control points (n, 2) of the shortest curve and its length after each iteration, in units."""
    grid = problem.workspace
    rows, columns = grid.occupied.shape
    ends = grid.in_cells(np.array([problem.start, problem.target], dtype=float))
    ends = np.minimum(ends, np.nextafter([float(columns), float(rows)], 0.0))
    # Section 3.2.1: a gene for each of 21 x 21 points; joined in their order along the way.
    steps = np.floor(np.arange(21) * (max(rows, columns) - 1) / 20 + 0.5).astype(int)
    column, row = (index.ravel() for index in np.meshgrid(steps, steps, indexing="ij"))
    points, settable = np.column_stack([column, row]) + 0.5, (column < columns) & (row < rows)
    settable[settable] = ~grid.occupied[row[settable], column[settable]]
    settable &= (points != np.floor(ends[:, None]) + 0.5).any(axis=2).all(axis=0)
    choices, way, apart = np.flatnonzero(settable), ends[1] - ends[0], points - ends[0]
    along = np.lexsort((way[1] * apart[:, 0] - way[0] * apart[:, 1], apart @ way))

    def polygon(x):
        return np.vstack([ends[:1], points[along[x[along]]], ends[1:]])

    def random_chromosome():
        x = np.zeros(len(points), dtype=bool)
        wanted = min(rng.integers(1, first_points + 1), len(choices))
        while x.sum() < wanted:
            x[choices[rng.integers(0, len(choices))]] = True
        return x

    def validated(x, draws):
        """Section 3.2.2: a chromosome and its length, in place of an invalid one a random one."""
        length = validate(polygon(x), least_distance, grid.occupied)
        again = length == np.inf and draws > 0
        return validated(random_chromosome(), draws - 1) if again else (x, length)

    def mutated(x):
        """Each gene but obstacles changes with the mutation rate: gaps of independent trials."""
        gene, unchanged = -1, math.log1p(-mutation_rate)
        while (gene := gene + 1 + int(math.log(1 - rng.random()) / unchanged)) < len(x):
            x[gene] ^= settable[gene]
        return x

    def children(P, wheel):
        """Lines 6 and 7: the children of pairs, before and after mutation."""
        for _ in range(population // 2):
            a, b = two_parents(rng, wheel)
            crossed = rng.random() < crossover_probability
            cut = rng.integers(1, len(points)) if crossed else len(points)
            for head, tail in ((a, b), (b, a)):
                for change in (np.copy, mutated):
                    yield validated(change(np.concatenate([P[head][0][:cut], P[tail][0][cut:]])), 1)

    P = [validated(random_chromosome(), 399) for _ in range(population)]  # line 1
    history = [min(length for _, length in P)]
    for _ in range(iterations):  # line 4
        wheel, total, before = np.cumsum([1 / length for _, length in P]), 0.0, 0  # eq. 9
        for _ in range(2):  # at most one more batch
            P = P + [child for child in children(P, wheel) if child[1] < np.inf]  # lines 6 and 7
            total += sum_of_q(np.array([x for x, _ in P]), before)  # line 8
            before = len(P)
            if total / (before * (before - 1) / 2) <= eta:  # line 9
                break
        P = sorted(P, key=lambda each: each[1])[:population]  # line 15
        history.append(P[0][1])
        eta *= eta_decay  # line 20
    inner = grid.in_units(polygon(P[0][0])[1:-1])
    return np.vstack([problem.start, inner, problem.target]), np.array(history) * grid.cell


def two_parents(rng, wheel):
    """Two different chromosomes by a roulette wheel (Algorithm 1, line 9)."""
    a = min(np.searchsorted(wheel, rng.random() * wheel[-1], side="right"), len(wheel) - 1)
    begin = wheel[a - 1] if a > 0 else 0.0
    at = rng.random() * (wheel[-1] - (wheel[a] - begin))
    at += 0.0 if at < begin else wheel[a] - begin
    return a, min(np.searchsorted(wheel, at, side="right"), len(wheel) - 1)


def validate(polygon, least_distance, occupied):
    """The length of a curve (eqs. 2 and 8), infinite for an invalid one (Section 3.2.2)."""
    inner = polygon[1:-1]
    near = np.hypot(*(inner[:, None] - inner).T) < least_distance  # Distance Threshold
    if not 0 < len(inner) < 60 or near.sum() > len(inner):
        return np.inf
    x, y = sample(polygon, parts(polygon))
    length = np.cumsum(np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2))[-1]
    return np.inf if occupied[touched_cells(x, y)[::-1]].any() else length  # Valid Path


def sum_of_q(P, first):
    """Sum of the Q statistic (eq. 10) of the pairs with a chromosome from `first` on."""
    ones, zeros = P.astype(float), 1.0 - P
    n11, n10 = ones[first:] @ ones.T, ones[first:] @ zeros.T
    n01, n00 = zeros[first:] @ ones.T, zeros[first:] @ zeros.T
    agree, differ = n11 * n00, n10 * n01
    q = (n10 + n01 == 0).astype(float)  # where eq. 10 divides by 0: 1 for equal ones, else 0
    np.divide(agree - differ, agree + differ, out=q, where=agree + differ > 0)
    return np.cumsum(q[np.tril_indices(len(q), first - 1, len(P))])[-1]
