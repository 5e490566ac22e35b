"""Operators on paths over a lattice of cells, and a genetic algorithm that uses them.

A path is an array (n,) of cell numbers, each a neighbour of the one before on a lattice
(`workspaces.lattice.Lattice`). `marks` is scratch (cells,) of integers: all 0 between operators.
"""

from typing import NamedTuple

import numpy as np

from bezierplan.kernels import allocation_free, compile_inline, compile_kernel
from bezierplan.planners import Path, Plan, Problem
from bezierplan.planners.parts.genetic import draw_parents
from bezierplan.planners.parts.random_integers import draw_integer
from bezierplan.workspaces.lattice import Corners, Lattice, build_grid_lattice, list_points

ONE_CELL, RECONNECT, WALK = range(3)


class Rules(NamedTuple):
    """Settings of `evolve`.

    crossover_probability: for a pair of parents.
    mutation_probability: for a child.
    elitism: 1 if the best so far replaces a child, else 0.
    mutation: ONE_CELL, RECONNECT or WALK.
    longest_part: most cells of a part made by the last two.
    tries: see `choose_cell_for_prey`.
    shorter_parts: if true, the first child gets the shorter head and the shorter tail, the second
        is parent 2, and children lose their loops; otherwise tails are swapped.
    """

    crossover_probability: float
    mutation_probability: float
    elitism: int
    mutation: int
    longest_part: int
    tries: int = 0
    shorter_parts: bool = True


def build_lattice(problem: Problem, corners: int) -> Lattice:
    """Build the lattice of a problem on a grid.

    Raises ValueError like `build_grid_lattice`.
    """
    return build_grid_lattice(
        problem.workspace, problem.start, problem.target, Corners(corners).name
    )


def plan_of(
    problem: Problem, cells: np.ndarray, history: np.ndarray, evaluations: int, stop: str
) -> Plan:
    """Build the plan whose path leads through cells (n,) of a grid; without a path if n is 0.

    history: in cells.
    stop: why the search ended if it found a path.
    """
    grid, solved = problem.workspace, len(cells) > 0
    path = (
        Path("polyline", list_points(grid, problem.start, problem.target, cells))
        if solved
        else None
    )
    return Plan(
        path=path,
        objective=history[-1] * grid.cell,
        claimed_feasible=solved,
        evaluations=evaluations,
        history=history * grid.cell,
        stop=stop if solved else "no path",
        extra={},
    )


@compile_kernel
def evolve(rng, lattice, paths, sizes, generations, rules):
    """Improve some paths by a genetic algorithm.

    Returns the shortest path (n,), and the shortest length so far (generations + 1,).

    paths: (population, longest path) with sizes: (population,); overwritten. A child that would not
        fit stays a copy of its parent.
    """
    population, longest = paths.shape
    parents, parent_sizes = np.empty_like(paths), np.empty_like(sizes)
    # A crossover writes at most two paths, a mutation a path and a part.
    child = np.empty(longest + max(longest, rules.longest_part), np.int64)
    part = np.empty(rules.longest_part, np.int64)
    marks = np.zeros(len(lattice.row), np.int64)
    lengths = np.empty(population)
    best, best_size, best_length = paths[0].copy(), sizes[0], np.inf
    history = np.empty(generations + 1)

    for generation in range(generations + 1):
        for i in range(population):
            lengths[i] = measure_length(paths[i, : sizes[i]], lattice)
            if lengths[i] < best_length:
                best_size, best_length = put(paths[i, : sizes[i]], best, 0), lengths[i]
        history[generation] = best_length
        if generation == generations:
            break

        paths, parents = parents, paths
        sizes, parent_sizes = parent_sizes, sizes
        drawn = draw_parents(rng, 1.0 / lengths, population)
        for i in range(population):
            sizes[i] = put(parents[drawn[i], : parent_sizes[drawn[i]]], paths[i], 0)
        for i in range(0, population, 2):
            if rng.random() < rules.crossover_probability:
                father = parents[drawn[i], : parent_sizes[drawn[i]]]
                mother = parents[drawn[i + 1], : parent_sizes[drawn[i + 1]]]
                k, m = draw_common_cell(rng, father, mother, marks)
                if k == 0:
                    continue
                if rules.shorter_parts:
                    head = _choose_shorter(father[: k + 1], mother[: m + 1], lattice)
                    tail = _choose_shorter(father[k:], mother[m:], lattice)
                    size = put(tail, child, put(head[:-1], child, 0))
                else:
                    size = put(father[k:], child, put(mother[:m], child, 0))
                    _replace(paths, sizes, i + 1, child[:size], rules, marks)
                    size = put(mother[m:], child, put(father[:k], child, 0))
                _replace(paths, sizes, i, child[:size], rules, marks)
        for i in range(population):
            if rng.random() < rules.mutation_probability:
                size = _make_mutant(rng, lattice, paths[i, : sizes[i]], rules, child, part, marks)
                if size:
                    _replace(paths, sizes, i, child[:size], rules, marks)
        if rules.elitism:
            sizes[0] = put(best[:best_size], paths[0], 0)
    return best[:best_size], history


@allocation_free
def put(part, path, size):
    """Write a part after the first `size` cells of a path and return the new size."""
    for k in range(len(part)):
        path[size + k] = part[k]
    return size + len(part)


@compile_inline
def _choose_shorter(one, other, lattice):
    """Return the shorter of two parts, the first of equal ones."""
    return one if measure_length(one, lattice) <= measure_length(other, lattice) else other


@allocation_free
def _replace(paths, sizes, i, child, rules, marks):
    """Write a child over a path, in place, unless it is longer than there is room; by some rules
    its loops are cut first.
    """
    size = cut_loops(child, marks) if rules.shorter_parts else len(child)
    if size <= paths.shape[1]:
        sizes[i] = put(child[:size], paths[i], 0)


@compile_kernel
def _make_mutant(rng, lattice, path, rules, child, part, marks):
    """Make a mutant of a path and return its size, or 0 if nothing changed."""
    if rules.mutation == ONE_CELL:
        return change_cell(rng, lattice, path, child)
    k, m = draw_integer(rng, 0, len(path)), draw_integer(rng, 0, len(path))
    first, last = min(k, m), max(k, m)
    if last - first < 2:
        return 0
    if rules.mutation == RECONNECT:
        size = join_through_random_cell(rng, lattice, path[first], path[last], part, marks)
    else:
        size = forage(rng, lattice, path[first], path[last], rules.tries, part, marks)
    if size == 0:
        return 0
    # Head, new part and tail, each written behind the one before.
    return put(path[last + 1 :], child, put(part[:size], child, put(path[:first], child, 0)))


@allocation_free
def measure_length(path, lattice):
    """Return the length in cells, including the way from the start and to the target.

    Equal numbers of steps give equal lengths, whatever their order.
    """
    diagonal = 0
    for k in range(1, len(path)):
        one, other = path[k - 1], path[k]
        # Steps are counted before they are weighed, or the sum would depend on their order.
        diagonal += (
            lattice.row[one] != lattice.row[other] and lattice.column[one] != lattice.column[other]
        )
    return len(path) - 1 - diagonal + diagonal * lattice.diagonal + lattice.ends


@allocation_free
def step_between(lattice, one, other):
    """Return which of the eight steps leads from one cell to another, -1 if none does."""
    for step in range(8):
        if lattice.neighbours[one, step] == other:
            return step
    return -1


@allocation_free
def join(lattice, cells, path, marks):
    """Join cells (n,) to a path by inserting midpoints, and return its size, 0 if they cannot be
    joined within len(path) cells.

    Starting with the first pair, the middle cell, with row and column rounded down, is inserted
    between two cells that are not neighbours. If it is occupied or equal to one of the two, the
    first free cell around it, in the order of `workspaces.lattice.STEPS`, that is not yet in the
    list is used instead. Consecutive equal cells are merged.
    """
    if len(cells) > len(path):
        return 0
    # The cells that wait, the next one first, fill the end of the path.
    size, first = 0, len(path) - len(cells)
    for k in range(len(cells)):
        path[first + k] = cells[k]
        marks[cells[k]] = 1
    while first < len(path):
        cell = path[first]
        if size == 0 or step_between(lattice, path[size - 1], cell) >= 0:
            path[size] = cell
            size += 1
            first += 1
        elif cell == path[size - 1]:
            first += 1
        else:
            between = _find_cell_between(lattice, path[size - 1], cell, marks)
            if between < 0 or size == first:
                break
            first -= 1
            path[first] = between
            marks[between] = 1
    for k in range(size):
        marks[path[k]] = 0
    for k in range(first, len(path)):
        marks[path[k]] = 0
    return 0 if first < len(path) else size


@allocation_free
def _find_cell_between(lattice, start, end, marks):
    """Return the cell that `join` inserts between two cells, -1 if there is none."""
    # Cells are numbered row by row, so the last one gives the number of columns.
    columns = lattice.column[-1] + 1
    row = (lattice.row[start] + lattice.row[end]) // 2
    column = (lattice.column[start] + lattice.column[end]) // 2
    middle = columns * row + column
    if not lattice.occupied[middle] and middle != start and middle != end:
        return middle
    for cell in lattice.around[middle]:
        if cell >= 0 and not marks[cell]:
            return cell
    return -1


@allocation_free
def draw_common_cell(rng, first, second, marks):
    """Draw an inner cell of one path that is also inside another; return its index in each.

    In the second path it is the index of its last occurrence. (0, 0) if there is no such cell.
    """
    for m in range(1, len(second) - 1):
        marks[second[m]] = m
    common = 0
    for k in range(1, len(first) - 1):
        common += marks[first[k]] > 0
    k = m = 0
    if common:
        wanted = draw_integer(rng, 0, common)
        while wanted >= 0:
            k += 1
            wanted -= marks[first[k]] > 0
        m = marks[first[k]]
    for cell in second:
        marks[cell] = 0
    return k, m


@allocation_free
def cut_loops(path, marks):
    """Remove, in place, all that lies between two visits to a cell, starting with the first
    revisit.

    Returns the new size.
    """
    size = 0
    for cell in path:
        if marks[cell]:
            for k in range(marks[cell], size):
                marks[path[k]] = 0
            size = marks[cell]
        else:
            path[size] = cell
            size += 1
            marks[cell] = size
    for k in range(size):
        marks[path[k]] = 0
    return size


@allocation_free
def change_cell(rng, lattice, path, child):
    """Replace a random inner cell by another random cell that neighbours both adjacent cells of the
    path.

    If there is none and these two are neighbours, the cell is dropped. Returns the child's size, or
    0 if nothing changed, which is always so for paths of fewer than 4 cells.
    """
    if len(path) < 4:
        return 0
    k = draw_integer(rng, 1, len(path) - 1)
    chosen, candidates = -1, 0
    for cell in lattice.neighbours[path[k - 1]]:
        if cell >= 0 and cell != path[k] and step_between(lattice, cell, path[k + 1]) >= 0:
            candidates += 1
            # Each candidate so far stays chosen with equal probability.
            if draw_integer(rng, 0, candidates) == 0:
                chosen = cell
    if candidates:
        put(path, child, 0)
        child[k] = chosen
        return len(path)
    if step_between(lattice, path[k - 1], path[k + 1]) >= 0:
        return put(path[k + 1 :], child, put(path[:k], child, 0))
    return 0


@compile_kernel
def join_through_random_cell(rng, lattice, first, last, part, marks):
    """Join two cells through a random cell of their bounding box.

    Returns the part's size, or 0 if that cell is occupied or out of reach.
    """
    rows = (lattice.row[first], lattice.row[last])
    columns = (lattice.column[first], lattice.column[last])
    row = draw_integer(rng, min(rows), max(rows) + 1)
    cell = row * (lattice.column[-1] + 1) + draw_integer(rng, min(columns), max(columns) + 1)
    if lattice.occupied[cell]:
        return 0
    return join(lattice, np.array([first, cell, last]), part, marks)


@allocation_free
def forage(rng, lattice, first, last, tries, part, marks):
    """Walk like a foraging fish from one cell until another is reached, write the cells to `part`
    and return how many there are.

    It is 0 if the walk ends early or would exceed the part.
    """
    part[0] = first
    marks[first] = 1
    size = 1
    while part[size - 1] != last and size < len(part):
        cell = choose_cell_for_prey(rng, lattice, part[size - 1], last, tries, marks)
        if cell < 0:
            break
        part[size] = cell
        marks[cell] = 1
        size += 1
    for k in range(size):
        marks[part[k]] = 0
    return size if part[size - 1] == last else 0


@allocation_free
def choose_cell_for_prey(rng, lattice, cell, target, tries, visited):
    """Choose a fish's next cell when it looks for prey (ma2020, reference 31), or -1 if all are
    visited.

    It is the first of `tries` random neighbours that is unvisited and nearer to the target,
    otherwise a random unvisited neighbour.
    """
    neighbours = lattice.neighbours[cell]
    present = unvisited = 0
    for neighbour in neighbours:
        present += neighbour >= 0
        unvisited += neighbour >= 0 and not visited[neighbour]
    if unvisited == 0:
        return -1
    near = compute_distance_square(lattice, cell, target)
    for _ in range(tries):
        wanted = draw_integer(rng, 0, present)
        for neighbour in neighbours:
            wanted -= neighbour >= 0
            if wanted < 0:
                break
        if not visited[neighbour] and compute_distance_square(lattice, neighbour, target) < near:
            return neighbour
    wanted = draw_integer(rng, 0, unvisited)
    for neighbour in neighbours:
        wanted -= neighbour >= 0 and not visited[neighbour]
        if wanted < 0:
            break
    return neighbour


@allocation_free
def compute_distance_square(lattice, one, other):
    """Return the square of the distance between the centres of two cells, an integer."""
    return (lattice.row[one] - lattice.row[other]) ** 2 + (
        lattice.column[one] - lattice.column[other]
    ) ** 2
