"""Printed lengths that are those of paths through cell centres: free polylines to the last digit,
or straight and diagonal moves to the decimals of a rounded square root of two.

Lengths of polylines between cell centres are sums of a few square roots of whole numbers, so a
length with four decimals can tell which paths it belongs to. `find_polylines` enumerates every free
polyline with a limited number of edges between two cells, keeps those whose length rounds to the
printed one, and says how likely a number nearby would match by chance.

Lengths are in cells throughout. An edge is free if it passes through no occupied cell; it may touch
one.
"""

import itertools
import math
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis.audit import possible
from bezierplan.analysis.audit.rows import build_audit_row, describe_cell
from bezierplan.analysis.results import list_key_columns
from bezierplan.analysis.table_kinds import Identify
from bezierplan.schema.model import convert_to_list
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem

NEARBY = 0.05
"""Numbers up to this far from the printed one, in cells, are what chance may have printed in its
place.
"""

MOST_SHOWN = 4

MOST_PATHS = 10_000
"""More matching paths than this are not listed."""

_ROUNDING = 1e-9


class Identification(NamedTuple):
    """Paths whose length rounds to a printed one.

    paths: the cells of each of those with fewest edges, or numbers of moves. chance: share of the
    numbers nearby, as printed, that some path matches. length: of the first path, in cells; NaN
    without one. moves: the words for numbers of moves, with {} for each; empty for cells.
    """

    paths: list[tuple[int, ...]]
    chance: float
    length: float
    moves: str = ""


class Ways(NamedTuple):
    """Free edges between cells. cells: numbers (n,) of the free ones. lengths: (n, n), in cells,
    infinite where an edge is not free.
    """

    cells: np.ndarray
    lengths: np.ndarray


@lru_cache(maxsize=4)
def list_edges(grid: Grid) -> Ways:
    """List all free edges between centres of free cells. No edge passes along others, because an
    edge is what a planner draws.
    """
    import shapely

    cells = np.flatnonzero(~grid.occupied)
    centres = np.argwhere(~grid.occupied)[:, ::-1] + 0.5
    first, second = np.triu_indices(len(cells), 1)
    edges = shapely.linestrings(np.stack([centres[first], centres[second]], axis=1))
    # Slightly smaller cells, so that an edge may touch a side or a corner.
    y, x = np.nonzero(grid.occupied)
    blocked = shapely.union_all(
        shapely.box(x + _ROUNDING, y + _ROUNDING, x + 1 - _ROUNDING, y + 1 - _ROUNDING)
    )
    shapely.prepare(blocked)
    free = ~shapely.intersects(blocked, edges)
    lengths = np.full((len(cells), len(cells)), np.inf)
    found = np.hypot(*(centres[first] - centres[second]).T)[free]
    lengths[first[free], second[free]] = lengths[second[free], first[free]] = found
    return Ways(cells, lengths)


def find_polylines(
    problem: Problem, value: float, decimals: int, edges: int
) -> Identification | None:
    """Find the free polylines from start to target whose length, in the problem's unit, is printed
    as this value.

    edges: the most edges of a polyline. None unless start and target are centres of cells of a
    grid.
    """
    grid = problem.workspace
    if not isinstance(grid, Grid):
        return None
    ends = grid.in_cells(problem.ends)
    if not np.allclose(ends % 1, 0.5):
        return None
    column, row = ends.astype(int).T
    printed, half = value / grid.cell, 0.5 * 10.0**-decimals / grid.cell
    free = list_edges(grid)
    cells = row * grid.occupied.shape[1] + column
    first, last = map(int, np.searchsorted(free.cells, cells))
    # Longer than the printed number too: the chance of a match is that of numbers nearby.
    reached = _list_reachable_lengths(free, first, printed + NEARBY + half, last, edges)
    every = np.unique(np.concatenate([level[last] for level in reached]))
    paths = _trace_paths(free, reached, last, printed, half)
    legs = itertools.pairwise(paths[0]) if paths else ()
    return Identification(
        [tuple(int(free.cells[place]) for place in path) for path in paths],
        _compute_chance(every, printed, half),
        sum(free.lengths[one, other] for one, other in legs) if paths else math.nan,
    )


def find_moves(problem: Problem, value: float, diagonal: float) -> Identification:
    """Find the straight and diagonal moves from start to target whose length is printed as this
    value, cut off after the decimals of the diagonal move.

    Each of the two differences between start and target says how many moves there are at least;
    their sum says whether the number of straight ones is even.
    """
    cell = problem.workspace.cell
    apart = [round(abs(b - a) / cell) for a, b in zip(problem.start, problem.target)]
    places = possible.find_last_place(str(diagonal))
    unit, value = 10.0**-places, value / cell
    # A quotient of decimals may lie just below the whole number that it stands for.
    printed = math.floor(value / unit + _ROUNDING) * unit
    most = int(value + NEARBY) + 1
    moves = [
        (straight, rest)
        for rest in range(most)
        for straight in range(sum(apart) % 2, most, 2)
        if straight + 2 * rest >= sum(apart) and straight + rest >= max(apart)
    ]
    lengths = np.array([straight + diagonal * rest for straight, rest in moves])
    paths = [moves[each] for each in np.flatnonzero(_is_near(lengths, printed, unit / 2))]
    length = paths[0][0] + diagonal * paths[0][1] if paths else math.nan
    chance = _compute_chance(np.sort(lengths), printed, unit / 2)
    told = f"{{}} straight moves and {{}} diagonal ones of {diagonal:g}"
    return Identification(paths, chance, length, told)


def describe_paths(identification: Identification) -> str:
    """Describe the matching paths and the chance of a match in one line."""
    paths, moves = identification.paths, identification.moves
    shown = [
        moves.format(*path) if moves else f"cells {' '.join(map(str, path))}"
        for path in paths[:MOST_SHOWN]
    ]
    more = len(paths) - len(shown)
    shown += [f"{more} others"] if more else []
    return (
        f"{' or '.join(shown) or 'no such path'}; of the numbers nearby, "
        f"{100 * identification.chance:.2g} % match by chance"
    )


def check_declared_paths(
    item: str, published: pd.DataFrame, entries: list[Identify], problems: dict[str, Problem]
) -> Iterator[dict]:
    """Check the published numbers for which an enumeration is declared; yield a row for each, and
    one row a declaration with the chance of all.

    published: as from `results.read_printed_numbers`. problems: by name; a number's problem is in
    its column `problem`. A number that no path has is no contradiction.
    """
    keys = list_key_columns(published)
    for entry in entries:
        tries, named = [], {"statistic": entry.statistic} if entry.statistic else {}
        where = entry.where | named
        what = (
            f"a free polyline of at most {entry.edges} edges through cell centres"
            if entry.diagonal is None
            else f"straight moves and diagonal ones of {entry.diagonal:g}"
        )
        rule = f"{entry.because}: the length of {what}"
        for row in published.to_dict("records"):
            problem = problems.get(row.get("problem", row.get("workspace")))
            declared = all(
                row.get(column) in convert_to_list(wanted)
                for column, wanted in [("metric", entry.metric), *where.items()]
            )
            if not declared or problem is None:
                continue
            if entry.diagonal is None:
                decimals = possible.find_last_place(row["as_printed"])
                path = find_polylines(problem, row["value"], decimals, entry.edges)
            else:
                path = find_moves(problem, row["value"], entry.diagonal)
            if path is None:
                continue
            tries.append(path)
            location = describe_cell(row, [*keys, "metric", *named])
            limit, fits = path.length * problem.workspace.cell, True if path.paths else None
            yield build_audit_row(
                item, location, rule, row["value"], limit, fits, describe_paths(path)
            )
        if tries:
            matched = sum(bool(path.paths) for path in tries)
            chance = compute_chance_of_at_least(matched, [path.chance for path in tries])
            told = (
                f"{matched} of {len(tries)} are such lengths; the chance of as many: {chance:.2g}"
            )
            location = ", ".join(
                f"{key}={' or '.join(map(str, convert_to_list(wanted)))}"
                for key, wanted in where.items()
            )
            rule, fits = f"{entry.because}: all numbers together", matched == len(tries) or None
            yield build_audit_row(item, location, rule, matched, len(tries), fits, told)


def compute_chance_of_at_least(count: int, chances: list[float]) -> float:
    """Compute the chance that at least so many of independent events happen."""
    exactly = np.ones(1)
    for chance in chances:
        exactly = np.convolve(exactly, [1 - chance, chance])
    return float(exactly[count:].sum())


def _list_reachable_lengths(
    ways: Ways, first: int, most: float, last: int, edges: int
) -> list[list[np.ndarray]]:
    """List the lengths of polylines from the first cell, by number of edges and cell, each once, as
    far as they can still reach the last cell within `most`.
    """
    from scipy.sparse import csgraph

    left = (
        most
        - csgraph.dijkstra(np.where(np.isfinite(ways.lengths), ways.lengths, 0), indices=last)
        + _ROUNDING
    )
    count = len(ways.cells)
    levels = [[np.zeros(1) if cell == first else np.empty(0) for cell in range(count)]]
    neighbours = [np.flatnonzero(np.isfinite(row)) for row in ways.lengths]
    for _ in range(edges):
        before, level = levels[-1], []
        for cell in range(count):
            parts = [
                before[other] + ways.lengths[other, cell]
                for other in neighbours[cell]
                if len(before[other])
            ]
            found = np.concatenate(parts) if parts else np.empty(0)
            # The same edges in another order have a sum with other last bits.
            level.append(np.unique(np.round(found[found <= left[cell]], 8)))
        levels.append(level)
    return levels


def _trace_paths(
    ways: Ways, levels: list[list[np.ndarray]], last: int, printed: float, half: float
) -> list[tuple[int, ...]]:
    """Trace the matching polylines with fewest edges backwards from their ends; return the places
    of their cells.
    """

    def extend(left: int, path: tuple[int, ...], length: float) -> Iterator[tuple[int, ...]]:
        """Extend a path, given from its end, in all ways that leave the rest of its length
        reachable with `left` more edges.
        """
        if not left:
            yield path[::-1]
            return
        for other in np.flatnonzero(np.isfinite(ways.lengths[path[-1]])):
            rest = length - ways.lengths[path[-1], other]
            if _is_near(levels[left - 1][other], rest, half).any():
                yield from extend(left - 1, (*path, int(other)), rest)

    for edges in range(1, len(levels)):
        if _is_near(levels[edges][last], printed, half).any():
            return list(itertools.islice(extend(edges, (last,), printed), MOST_PATHS))
    return []


def _is_near(lengths: np.ndarray, printed: float, half: float) -> np.ndarray:
    """Return which lengths round to a printed one."""
    # Sums are rounded to 8 decimals at each edge, which adds up to less than 1e-7.
    return np.abs(lengths - printed) <= half + 1e-7


def _compute_chance(lengths: np.ndarray, printed: float, half: float) -> float:
    """Compute the share of the printed numbers within `NEARBY` to which some length rounds."""
    count = round(NEARBY / (2 * half))
    numbers = printed + 2 * half * np.arange(-count, count + 1)
    at = np.searchsorted(lengths, numbers)
    # Infinite ends, so that the least and the largest length have two neighbours as well.
    padded = np.concatenate([[-np.inf], lengths, [np.inf]])
    return float(np.mean(np.minimum(numbers - padded[at], padded[at + 1] - numbers) <= half + 1e-7))
