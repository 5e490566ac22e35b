"""The genetic algorithm of song2016 (Section III) for smooth paths: the default reading in plain
Python. `planners/binary_genetic.py` finds the same paths, bit for bit, much faster. Lengths are in
cells until the end; sums run from the first term to the last (`np.cumsum`).
"""

import numpy as np

from bezierplan.geometry.curves import sample_matrix
from bezierplan.workspaces.grid import ON_LINE, embed

METHOD = "song2016/smooth"


def plan(
    problem,
    rng,
    *,
    population=200,  # Section IV
    generations=100,
    crossover_probability=0.5,
    mutation_probability=0.1,
    penalty=10.0,  # for each sample in an occupied cell
    genes=6,  # eight control points with start and target
    samples=501,
):
    """Return the control points (n, 2) of the shortest path, in units, and the lowest objective,
    the reciprocal of the fitness, after each generation (generations + 1,).
    """
    grid = problem.workspace
    occupied = embed(grid.occupied)  # Remark 1: sides are powers of two
    bits = (occupied.size - 1).bit_length()  # of a cell's number, 8 in the paper
    ends = grid.in_cells(np.array([problem.start, problem.target]))
    starts, moves = rng.spawn(2)

    # Section III-C: the initial population is a set of binary numbers of 8 n bits.
    numbers = starts.integers(0, occupied.size, size=(population, genes))
    chromosomes = (numbers[:, :, None] >> np.arange(bits)[::-1] & 1).reshape(population, -1)
    lowest, history = np.inf, []
    for generation in range(generations + 1):
        points = control_points(chromosomes, bits, occupied.shape[1], ends)
        objective = objectives(points, occupied, penalty / grid.cell, samples)
        if objective.min() < lowest:
            best, lowest = chromosomes[objective.argmin()].copy(), objective.min()
        history.append(lowest * grid.cell)
        if generation == generations:
            break
        # Proportional selection by a roulette wheel (eq. 10): as many parents as chromosomes.
        wheel = np.cumsum(1 / objective)
        drawn = np.searchsorted(wheel, moves.random(population) * wheel[-1], side="right")
        chromosomes = chromosomes[np.minimum(drawn, population - 1)]
        # Section III-E: swap what lies behind a random point, complement a random bit.
        for pair in np.split(chromosomes, population // 2):
            if moves.random() < crossover_probability:
                cut = moves.integers(1, pair.shape[1])
                pair[:, cut:] = pair[::-1, cut:].copy()
        for chromosome in chromosomes:
            if moves.random() < mutation_probability:
                chromosome[moves.integers(0, len(chromosome))] ^= 1
        chromosomes[0] = best  # elitism, which the paper leaves open
    found = grid.in_units(control_points(best[None], bits, occupied.shape[1], ends)[0])
    # Remark 3: of control points that coincide one remains.
    fixed = problem.start, problem.target
    inner = [point for point in dict.fromkeys(map(tuple, found[1:-1])) if point not in fixed]
    return np.array([problem.start, *inner, problem.target]), np.array(history)


def control_points(chromosomes, bits, columns, ends):
    """Control points (n, genes + 2, 2) of chromosomes (n, bits of all genes): the centres of their
    cells (eq. 7), between start and target.
    """
    powers = 1 << np.arange(bits)[::-1]
    numbers = chromosomes.reshape(len(chromosomes), -1, bits) @ powers
    centres = np.stack([numbers % columns, numbers // columns], axis=2) + 0.5
    return np.array([[ends[0], *own, ends[1]] for own in centres])


def objectives(points, occupied, penalty, samples):
    """The reciprocal of the fitness (eq. 9) of each path: the sum of the lengths of its segments,
    and the penalty for each sample in an occupied cell.
    """
    pieces = points.shape[1] - 3  # cubic segments, with a continuous second derivative (eq. 6)
    weights = sample_matrix("piecewise_cubic", pieces + 3, samples)
    step = (samples - 1) // pieces
    length = bad = 0
    for i in range(pieces):
        w = weights[i * step : (i + 1) * step + 1, i : i + 4]
        p = points[:, None, i : i + 4]
        x, y = (sum(w[:, k] * p[..., k, axis] for k in range(4)) for axis in (0, 1))  # eqs. 1 and 2
        chords = np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2)
        length += np.cumsum(chords, axis=1)[:, -1]
        column, row = (x[:, 1:] + ON_LINE).astype(int), (y[:, 1:] + ON_LINE).astype(int)  # eq. 8
        bad += occupied[row, column].sum(axis=1)
    return length + penalty * bad
