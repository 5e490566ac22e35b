"""Genetic algorithm for paths over the cells of a grid (GA), a competing method in ma2020 (Section
4.1; its reference 29, no parameters given).

With the coding `via_cells` a chromosome is a sequence of free cells, joined to a path by inserted
midpoints. Roulette, crossover between genes and elitism are those of BCA. Beside the path, two
things differ: a chromosome whose cells cannot be joined has a fixed length instead of a surcharge
for its collisions, and mutation draws another cell, unless it flips a bit as in BCA. With `rows` a
chromosome is itself a path, initially one through a random free cell of each row.
"""

import itertools
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from bezierplan.kernels import compile_kernel
from bezierplan.planners import About, Plan, Problem, Range
from bezierplan.planners.parts import cell_paths
from bezierplan.planners.parts.genetic import breed, change_gene, check_pairs
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.planners.parts.settings import SHARE, with_settings
from bezierplan.workspaces.lattice import Corners, Lattice

workspaces = ("grid",)
exact = True

# Number of times one cell is drawn in each row until these can be joined.
_MOST_DRAWS = 10_000
# Length, in cells, of a chromosome whose cells cannot be joined.
_UNDECODABLE = 200.0


Coding = IntEnum("Coding", "via_cells rows")
Initial = IntEnum("Initial", "uniform sorted")
Mutation = IntEnum("Mutation", "cell bit_flip")


class Settings(NamedTuple):
    """Settings of the search; ma2020 gives none. The coding rows does not use genes, initial or
    mutation.
    """

    corners: Annotated[
        Corners, About("how many of the two cells beside a diagonal step may be occupied")
    ]
    coding: Annotated[
        Coding, About("a chromosome is a sequence of free cells to be joined, or a path")
    ]
    genes: Annotated[int, Range(0, 60), About("free cells of a chromosome")]
    initial: Annotated[Initial, About("genes are drawn uniformly, or also sorted by column + row")]
    longest_join: Annotated[int, Range(2), About("most cells of a path, repeated ones included")]
    population: Annotated[int, Range(2), About("chromosomes of a generation")]
    generations: Annotated[int, Range(0), About("generations after the first")]
    crossover_probability: Annotated[
        float, SHARE, About("of a pair of parents, cut between two genes or at a shared cell")
    ]
    mutation_probability: Annotated[
        float, SHARE, About("of a chromosome, in one gene or (rows) one section")
    ]
    mutation: Annotated[
        Mutation,
        About(
            "a gene becomes a random free cell, or a bit of its binary number is flipped such that "
            "it stays a free cell"
        ),
    ]
    elitism: Annotated[int, SHARE, About("how many of the best so far replace a chromosome")]


check = check_pairs


@with_settings(Settings)
def plan(problem: Problem, rng: np.random.Generator, settings: Settings) -> Plan:
    """Return the shortest path found over the 8-connected lattice of a grid.

    Parameters
    ----------
    problem : Problem
        On a grid.
    rng : numpy.random.Generator
        The only source of random numbers.

    Returns
    -------
    Plan
        Its objective is its length in units, infinite if there is no path.

    Raises
    ------
    ValueError
        If start or target is not in a free cell.

    References
    ----------
    ma2020, Section 4.1, reference 29.
    """
    places = cell_paths.build_lattice(problem, settings.corners)
    starts, moves = rng.spawn(2)
    if places.start == places.target:
        # No search needed: one chromosome without genes.
        settings = settings._replace(population=1, generations=0, genes=0)
    population, genes = settings.population, settings.genes
    if settings.coding == Coding.via_cells:
        free = np.flatnonzero(~places.occupied)
        cells = np.empty((population, genes + 2), np.int64)
        cells[:, 0], cells[:, -1] = places.start, places.target
        drawn = free[starts.integers(0, len(free), size=(population, genes))]
        if settings.initial == Initial.sorted:
            # A stable sort: cells of the same sum keep the order in which they were drawn.
            order = np.argsort((places.row + places.column)[drawn], axis=1, kind="stable")
            drawn = np.take_along_axis(drawn, order, axis=1)
        cells[:, 1:-1] = drawn
        best, history = _search(moves, places, free, cells, settings)
    else:
        paths, sizes = _draw_first_paths(starts, places, population, settings.longest_join)
        best, history = np.empty(0, np.int64), np.array([np.inf])
        if sizes.all():
            rules = cell_paths.Rules(
                settings.crossover_probability,
                settings.mutation_probability,
                settings.elitism,
                cell_paths.RECONNECT,
                settings.longest_join,
                shorter_parts=False,
            )
            best, history = cell_paths.evolve(
                moves, places, paths, sizes, settings.generations, rules
            )
    return cell_paths.plan_of(problem, best, history, population * len(history), "generations")


@compile_kernel
def _search(rng, lattice, free, cells, rules):
    """Run the genetic algorithm on sequences of cells; return the shortest path (n,), empty if none
    can be decoded, and the history.

    The history (generations + 1,) holds the shortest length so far.

    cells: (population, genes + 2), including start and target.
    free: (n,) cells.
    """
    population, genes = cells.shape[0], cells.shape[1] - 2
    bits = 1 + int(np.log2(len(lattice.row)))
    # A flipped bit may give a number that is no cell, so there is an entry for every number.
    legal = np.zeros(1 << bits, np.bool_)
    legal[free] = True
    parents = np.empty_like(cells)
    path = np.empty(rules.longest_join, np.int64)
    marks = np.zeros(len(lattice.row), np.int64)
    lengths = np.empty(population)
    best, best_path, best_length = cells[0].copy(), path[:0].copy(), np.inf
    history = np.empty(rules.generations + 1)

    for generation in range(rules.generations + 1):
        for i in range(population):
            size = cell_paths.join(lattice, cells[i], path, marks)
            lengths[i] = cell_paths.measure_length(path[:size], lattice) if size else _UNDECODABLE
            # The best is one with a path, whatever the fixed length of the others is.
            if size and lengths[i] < best_length:
                cell_paths.put(cells[i], best, 0)
                best_path, best_length = path[:size].copy(), lengths[i]
        history[generation] = best_length
        if generation == rules.generations:
            break

        cells, parents = parents, cells
        breed(rng, parents, lengths, cells, 1, rules.crossover_probability, bits, bits)
        for i in range(population):
            if genes and rng.random() < rules.mutation_probability:
                flips = rules.mutation == Mutation.bit_flip
                change_gene(rng, cells[i, 1:-1], bits, free, legal, flips)
        if rules.elitism:
            cell_paths.put(best, cells[0], 0)
    return best_path, history


def _draw_first_paths(
    rng: np.random.Generator, places: Lattice, population: int, longest: int
) -> tuple[np.ndarray, np.ndarray]:
    """Draw paths (population, longest) from start to target through a random free cell of each row
    between them.

    Returns them and their sizes (population,); 0 from the first one that cannot be found.
    """
    first, last = places.row[places.start], places.row[places.target]
    step = 1 if first < last else -1
    rows = [
        np.flatnonzero((places.row == row) & ~places.occupied)
        for row in range(first + step, last, step)
    ]
    paths = np.zeros((population, longest), np.int64)
    sizes = np.zeros(population, np.int64)
    if all(map(len, rows)):
        ends = np.cumsum([0, *map(len, rows)])
        _join_rows(rng, places, np.array([*itertools.chain(*rows)], np.int64), ends, paths, sizes)
    return paths, sizes


@compile_kernel
def _join_rows(rng, lattice, free, ends, paths, sizes):
    """Fill in paths and their sizes, in place, until one cannot be found.

    free: (n,) the free cells, row by row. ends: (rows + 1,) where each row begins and the last
    ends.
    """
    marks = np.zeros(len(lattice.row), np.int64)
    cells = np.empty(len(ends) + 1, np.int64)
    cells[0], cells[-1] = lattice.start, lattice.target
    for i in range(len(paths)):
        for _ in range(_MOST_DRAWS):
            for row in range(len(ends) - 1):
                cells[row + 1] = free[draw_integer(rng, ends[row], ends[row + 1])]
            sizes[i] = cell_paths.join(lattice, cells, paths[i], marks)
            if sizes[i]:
                break
        # Too few first paths are none, so the rest need not be drawn.
        if sizes[i] == 0:
            break
