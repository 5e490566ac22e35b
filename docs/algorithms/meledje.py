"""The genetic algorithm of meledje with the proposed mutation (Sections 2 and 3, Table 1): the
default reading in plain Python. `planners/node_genetic.py` finds the same paths, bit for bit, much
faster. A chromosome is a list of cells from start to target; energies are in cells until the end.
"""

from itertools import pairwise

import numpy as np

from bezierplan.workspaces.ground import build_ground

METHOD = "meledje/proposed"


def plan(
    problem,
    rng,
    *,
    population=60,  # Section 4, first environment
    crossover_probability=1.0,
    mutation_probability=0.3,
    penalty=15.0,  # the weight Gamma
    friction=1.0,
    most_nodes=12,
    generations=100,
):
    """Return the nodes (n, 2) of the best path of the last generation, in units, and the lowest
    fitness so far after each generation (generations + 1,). From the start the target must not be
    visible.
    """
    grid = problem.workspace
    ground = build_ground(grid, friction)  # eq. 2: epsilon = energy[i, j]; eq. 3: beta = met[i, j]
    energy, beta, weight = ground.energy, ground.encounters, penalty / grid.cell
    columns = grid.occupied.shape[1]
    ends = (grid.cell_of(*point) for point in (problem.start, problem.target))
    start, target = (row * columns + column for row, column in ends)
    free = np.flatnonzero(~grid.occupied)
    free = free[(free != start) & (free != target)]
    starts, moves = rng.spawn(2)

    def fitness(path):
        """Eqs. 1 to 3."""
        edges = list(pairwise(path))
        return np.cumsum([energy[e] for e in edges])[-1] + weight * sum(int(beta[e]) for e in edges)

    paths = [first_path(starts, start, target, free, beta, most_nodes) for _ in range(population)]
    lowest, history = np.inf, []
    for generation in range(generations + 1):
        values = np.array([fitness(path) for path in paths])
        if values.min() < lowest - 1e-9:
            lowest = values.min()
        history.append(lowest * grid.cell)
        if generation == generations:
            break
        # Section 2.5: parents by a roulette wheel over ranks.
        order = np.argsort(values, kind="stable")
        wheel = np.cumsum(np.arange(population, 0.0, -1))
        drawn = np.searchsorted(wheel, moves.random(population) * wheel[-1], side="right")
        parents = [paths[i] for i in order[np.minimum(drawn, population - 1)]]
        # Section 2.6: the fragments behind one point are swapped.
        paths = []
        for one, other in zip(parents[::2], parents[1::2]):
            cut = len(one), len(other)
            if moves.random() < crossover_probability:
                cut = 2 * (1 + below(moves, min(cut) - 1),)
            paths += [one[: cut[0]] + other[cut[1] :], other[: cut[1]] + one[cut[0] :]]
        for path in paths:
            if moves.random() < mutation_probability and len(path) > 2:
                mutate(moves, path, grid.occupied, energy, beta, weight)
    best = paths[values.argmin()]
    return np.array([grid.centre(cell) for cell in best]), np.array(history)


def below(rng, count):
    """A random whole number below `count`."""
    return int(rng.random() * count)


def first_path(rng, start, target, free, beta, most_nodes):
    """Return a random feasible path (Section 2.3): from each node to a random visible cell that is
    not yet part of it, until the target is visible; once more from the start if it gets too long.
    """
    path = [start]
    while beta[path[-1], target] > 0:
        sees = beta[path[-1]] == 0
        sees[path] = False
        visible = free[sees[free]]
        if len(path) > most_nodes or not len(visible):
            path = [start]
            continue
        drawn = (free[below(rng, len(free))] for _ in range(len(free)))  # as long as that pays
        node = next((node for node in drawn if sees[node]), None)
        if node is None:
            node = visible[below(rng, len(visible))]
        path.append(node)
    return [*path, target]


def mutate(rng, path, occupied, energy, beta, weight):
    """Table 1, in place."""
    # Step 1: a random inner node that precedes an obstacle; without one, any inner node.
    nodes = [k for k in range(1, len(path) - 1) if beta[path[k], path[k + 1]] > 0]
    nodes = nodes or range(1, len(path) - 1)
    k = nodes[below(rng, len(nodes))]
    # Step 2: the free cells around it.
    rows, columns = occupied.shape
    own_row, own_column = divmod(path[k], columns)
    neighbours = [
        row * columns + column
        for row in range(max(own_row - 1, 0), min(own_row + 2, rows))
        for column in range(max(own_column - 1, 0), min(own_column + 2, columns))
        if (row, column) != (own_row, own_column) and not occupied[row, column]
    ]
    # Steps 3 and 4: the one that makes the fittest path, even if the node itself is fitter.
    before, after, least = path[k - 1], path[k + 1], np.inf
    for cell in neighbours:
        met = int(beta[before, cell]) + int(beta[cell, after])
        cost = energy[before, cell] + energy[cell, after] + weight * met
        if cost < least - 1e-12:
            path[k], least = cell, cost
