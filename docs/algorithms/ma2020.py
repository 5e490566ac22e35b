"""BCA-Q, the genetic algorithm of ma2020 (Section 3) for Bézier curves that keep a safety distance:
the default reading in plain Python. `planners/bca.py` finds the same paths, bit for bit, much
faster. Lengths are in cells; sums run from the first term to the last (`np.cumsum`).
"""

import math
from itertools import pairwise

import numpy as np

from bezierplan.geometry.curves import sample_matrix
from bezierplan.workspaces.grid import ON_LINE

METHOD = "ma2020/bca_q"


def plan(
    problem,
    rng,
    *,
    population=100,  # Section 4: Q
    generations=50,  # gn of environment 1
    crossover_probability=0.9,  # Re
    mutation_probability=0.1,  # Mu
    length_weight=0.8,  # w1 of environment 1
    safety_weight=0.1,  # w2
    safety_distance=0.25,  # Le
    collision_factor=5.0,
    collision_surcharge=10.0,
    control_points=8,
    samples=201,
):
    """Control points (n, 2) of the best curve, in units, and the lowest cost by generation."""
    grid = problem.workspace
    free = np.flatnonzero(~grid.occupied[::-1].ravel())  # eq. 9; numbered from the top left
    bits = (grid.occupied.size - 1).bit_length()
    straight = math.dist(problem.start, problem.target) / grid.cell
    ends = grid.in_cells(np.array([problem.start, problem.target]))
    weights = sample_matrix("bezier", control_points + 2, samples)  # eqs. 1 and 2
    starts, moves = rng.spawn(2)

    def cost(genes):
        """The reciprocal of eq. 12 with both terms for all paths and the length as a multiple of
        the straight one: as printed, a longer feasible path is the fitter one.
        """
        x, y = ends.T @ weights.T[[0, -1]]
        for k, (px, py) in enumerate(centres(genes, grid), start=1):
            x, y = x + px * weights[:, k], y + py * weights[:, k]
        length = np.cumsum(np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2))[-1]  # eq. 13
        bad = collisions(x, y, grid.occupied)
        fit1 = length * (1 + collision_factor * bad / samples)
        fit1 += collision_surcharge / grid.cell * (bad > 0)
        near = clearance(x, y, grid.occupied) / (safety_distance / grid.cell) if bad == 0 else 0.0
        fit2 = (1 - near) ** 2 if near < 1 else 0.0  # eq. 14
        return length_weight * fit1 / straight + safety_weight * fit2

    chromosomes = free[starts.integers(0, len(free), size=(population, control_points))]
    lowest, history = np.inf, []
    for generation in range(generations + 1):
        costs = np.array([cost(genes) for genes in chromosomes])
        if costs.min() < lowest:
            best, lowest = chromosomes[costs.argmin()].copy(), costs.min()
        history.append(lowest)
        if generation == generations:
            break
        # Section 3.4: roulette (eq. 15), single-point crossover between genes, mutation.
        wheel = np.cumsum(1 / costs)
        drawn = np.searchsorted(wheel, moves.random(population) * wheel[-1], side="right")
        chromosomes = chromosomes[np.minimum(drawn, population - 1)]
        for i in range(0, population, 2):
            if moves.random() < crossover_probability:
                cut = moves.integers(1, control_points)
                chromosomes[i : i + 2, cut:] = chromosomes[i : i + 2, cut:][::-1].copy()
        for genes in chromosomes:
            if moves.random() < mutation_probability:
                k = moves.integers(0, control_points)
                for _ in range(50):  # another bit, until the cell is free
                    code = genes[k] ^ 1 << bits - 1 - moves.integers(0, bits)
                    if code in free:
                        genes[k] = code
                        break
        chromosomes[0] = best  # elitism, which the paper leaves open
    points = grid.in_units(centres(best, grid))
    return np.vstack([problem.start, points, problem.target]), np.array(history)


def centres(genes, grid):
    """Centres (n, 2) of cells (eqs. 10 and 11, counted from 0, with the signs that stay inside)."""
    rows, columns = grid.occupied.shape
    return np.column_stack([genes % columns + 0.5, rows - genes // columns - 0.5])


def collisions(x, y, occupied):
    """Samples inside an occupied cell, or whose chord passes through one; touching is free."""
    rows, columns = (np.minimum(z.astype(int), n - 1) for z, n in zip((y, x), occupied.shape))
    inside, both = occupied[rows, columns], ((x, columns), (y, rows))
    for z, cell in both:
        inside = inside & (cell + ON_LINE < z) & (z < cell + 1 - ON_LINE)
    bad = inside.sum()
    for s in np.flatnonzero((abs(np.diff(columns)) + abs(np.diff(rows)) > 1) & ~inside[1:]):
        crossed = sorted(
            (line - z[s]) / (z[s + 1] - z[s])
            for z, cell in both
            for line in range(min(cell[s : s + 2]) + 1, max(cell[s : s + 2]) + 1)
        )  # where the chord crosses grid lines; between them it is in other cells than its ends
        parts = int(max(abs(z[s + 1] - z[s]) for z, _ in both)) + 1  # seen at their ends, too
        at = [(a + b) / 2 for a, b in pairwise(crossed) if b - a > 1e-12]
        t = np.array([*at, *(k / parts for k in range(1, parts))])
        row, column = ((z[s] + t * (z[s + 1] - z[s])).astype(int) for z in (y, x))
        bad += occupied[row, column].any()
    return bad


def clearance(x, y, occupied):
    """Lmin of eq. 14: least distance of the samples to an occupied cell."""
    row, column = np.nonzero(occupied)
    dx = np.maximum(np.maximum(column - x[:, None], 0.0), x[:, None] - column - 1)
    dy = np.maximum(np.maximum(row - y[:, None], 0.0), y[:, None] - row - 1)
    return np.sqrt((dx * dx + dy * dy).min(initial=np.inf))
