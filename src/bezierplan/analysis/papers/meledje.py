"""meledje: the drawings of its Figures 2 to 4, and an audit of its Tables 2 to 5.

Numbers of equations, sections, tables and figures are the paper's. Drawings use the operators of the planner itself.
"""

import itertools
from collections.abc import Iterator, Sequence
from typing import get_args

import numpy as np
import pandas as pd
import shapely

from bezierplan.analysis.statistics import holm
from bezierplan.planners import node_genetic
from bezierplan.planners.parts.node_mutation import Mutation, mutate
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.ground import centres, ground_of, obstacles_met

# Figure 2: cells of a grid of 10 x 10, numbered from 1.
CHROMOSOME = (1, 41, 65, 35, 38, 60, 100)
SIDE = 10
BESIDE = 0.45  # of a cell: any nearer to the path there is no room for a number

# Figure 3: a second parent in addition to that of Figure 2, and the number of nodes after which both are cut.
OTHER = (1, 22, 54, 77, 100)
CUT = 3

# Figure 4, on the map `operators`: columns and rows of the nodes of a feasible path, and of one whose second edge meets an obstacle.
FREE_PATH = ((0, 0), (2, 4), (5, 5), (9, 6))
BLOCKED_PATH = ((0, 0), (1, 2), (6, 5), (8, 5), (9, 6))
# The settings in force that the operators read.
RULES = node_genetic.Rules(
    mutation=0,
    population=2,
    generations=0,
    stall=1,
    initial=0,
    most_nodes=1,
    selection=0,
    crossover_probability=1.0,
    one_cut=True,
    mutation_probability=1.0,
    each_node=False,
    any_node=True,
    beside_obstacle=False,
    keep_better=False,
    same_signs=False,
    whole_path=False,
    penalty=15.0,
    elitism=0,
    best_so_far=False,
)
# Number of seeds to search for one whose mutation shows what the paper says about the operator.
SEEDS = 1000

TRIALS = 100  # Section 4
ALPHA = 0.05
OTHERS = ("random", "ref12", "ref21")

# What Section 4 says about the proposed mutation: (metric, words, 1 if the highest value is meant, -1 if the lowest).
SAID = (
    ("optimal", "most optimal solutions", 1),
    ("found", "most optimal and near-optimal solutions together", 1),
    ("near_optimal", "most near-optimal solutions", 1),
    ("infeasible", "fewest infeasible solutions", -1),
    ("objective", "lowest mean fitness", -1),
    ("generation_improved", "lowest mean generation number", -1),
    ("cpu_s", "highest mean solution time", 1),
)


def chromosome() -> pd.DataFrame:
    """Figure 2: the genes (part `genes`), and their path on a grid of 10 x 10 cells (part `path`)."""
    genes = _genes(CHROMOSOME, 0, ["accent", *["muted"] * (len(CHROMOSOME) - 2), "accent"])
    names = [{"mark": "text", "role": "note", "x": x, "y": -0.9, "text": word} for x, word in ((0, "start"), (3, "passage"), (6, "target"))]
    places = [_place(number) for number in CHROMOSOME]
    way = shapely.LineString(places)
    # Cells that the path crosses between its nodes show no number, because the path would make it illegible.
    numbers = [number for number in range(1, SIDE * SIDE + 1) if shapely.Point(_place(number)).distance(way) > BESIDE]
    cells = [{"mark": "cell", "role": "free", **_box(*_place(number))} for number in range(1, SIDE * SIDE + 1)]
    others = [{"mark": "text", "role": "note", **_words(number, *_place(number))} for number in numbers]
    nodes = [mark for number in CHROMOSOME for mark in _gene(number, *_place(number), "accent")]
    path = [*cells, *others, *_path(places, "accent", "path"), *nodes]
    return pd.concat([pd.DataFrame([*genes, *names]).assign(part="genes"), pd.DataFrame(path).assign(part="path")])


def crossover() -> pd.DataFrame:
    """Figure 3: two parents (part `parents`) and their children (part `children`), each parent's nodes in a distinct style."""
    one, other = np.array(CHROMOSOME), np.array(OTHER)
    frames = []
    for part, (first, second) in {"parents": (CHROMOSOME, OTHER), "children": (_child(one, other), _child(other, one))}.items():
        own = {"parents": (len(first), 0), "children": (CUT, CUT)}[part]
        looks = [["accent"] * own[0] + ["muted"] * (len(first) - own[0]), ["muted"] * (own[1] or len(second))]
        looks[1] += ["accent"] * (len(second) - len(looks[1]))
        marks = [*_genes(first, 1.5, looks[0]), *_genes(second, 0, looks[1])]
        cut = [{"mark": "line", "role": "second", "group": "cut", "x": CUT - 0.5, "y": y, "label": "cut"} for y in (-0.8, 2.3)]
        frames.append(pd.DataFrame([*marks, *cut]).assign(part=part))
    return pd.concat(frames)


def _child(head: np.ndarray, tail: np.ndarray) -> tuple[int, ...]:
    child = np.empty(len(head) + len(tail), dtype=np.int64)
    return tuple(child[: node_genetic.join(head, CUT, tail, CUT, len(tail), child)].tolist())


def mutations(grid: Grid) -> pd.DataFrame:
    """Figure 4: a path before and after a mutation, by operator, and the cells that were tried instead of the node.

    Random mutation makes a feasible path infeasible; reference 12 changes a node that is not before the obstacle, and the path stays
    infeasible; the proposed mutation changes the one that is. The first seed with this result is used.
    """
    frames = []
    for operator, places in (("random", FREE_PATH), ("ref12", BLOCKED_PATH), ("proposed", BLOCKED_PATH)):
        before = np.array([column + grid.occupied.shape[1] * row for column, row in places])
        after, k = next(_shown(grid, operator, before))
        frames.append(pd.DataFrame(_mutation(grid, operator, before, after, k)).assign(operator=operator))
    return pd.concat(frames)


def _shown(grid: Grid, operator: str, before: np.ndarray) -> Iterator[tuple[np.ndarray, int]]:
    """Paths after a mutation that shows what the paper says about the operator, each with the index of the changed node."""
    ground = ground_of(grid, 1.0)
    drawn = np.setdiff1d(np.flatnonzero(~grid.occupied), before[[0, -1]])
    rules = RULES._replace(mutation=get_args(Mutation).index(operator))
    for seed in range(SEEDS):
        after = before.copy()
        mutate(np.random.default_rng(seed), after, drawn, ground, rules)
        for k in np.flatnonzero(after != before).tolist():
            blocked = any(obstacles_met(ground, *edge) for edge in itertools.pairwise(after.tolist()))
            if blocked != (operator == "proposed"):
                yield after, k


def _mutation(grid: Grid, operator: str, before: np.ndarray, after: np.ndarray, k: int) -> Iterator[dict]:
    """Marks of a path before and after the change of node k."""
    first, second = (centres(grid, path).tolist() for path in (before, after))
    yield from _path(first, "third", "before")
    yield from _path(second, "accent", "after")
    if operator != "random":
        column, row = before[k] % grid.occupied.shape[1], before[k] // grid.occupied.shape[1]
        for up, across in itertools.product((-1, 0, 1), repeat=2):
            cell = grid.occupied.shape[1] * (row + up) + column + across
            if (up, across) != (0, 0) and not grid.occupied.flat[cell]:
                x, y = grid.centre(int(cell))
                yield {"mark": "dots", "role": "muted", "x": x, "y": y, "group": "tried", "label": "cells tried"}
    for role, label, (x, y) in (("first", "node that changes", first[k]), ("start", "start", first[0]), ("target", "target", first[-1])):
        yield {"mark": "dots", "role": role, "x": x, "y": y, "group": role, "label": label}


def _place(number: int) -> tuple[float, float]:
    """Column and row of a cell of Figure 2, from 1."""
    return (number - 1) % SIDE + 1.0, (number - 1) // SIDE + 1.0


def _genes(numbers: Sequence[int], y: float, roles: Sequence[str]) -> Iterator[dict]:
    """Marks of a chromosome, as a row of boxes."""
    for x, (number, role) in enumerate(zip(numbers, roles, strict=True)):
        yield from _gene(number, x, y, role)


def _gene(number: int, x: float, y: float, role: str) -> Iterator[dict]:
    yield {"mark": "cell", "role": role, **_box(x, y)}
    yield {"mark": "text", "role": "note", **_words(number, x, y)}


def _box(x: float, y: float) -> dict:
    return {"x": x, "y": y, "width": 1.0, "height": 1.0}


def _words(number: int, x: float, y: float) -> dict:
    return {"x": x, "y": y, "text": str(number)}


def _path(places: Sequence[tuple[float, float]], role: str, label: str) -> Iterator[dict]:
    """Marks of a line through places and of its nodes."""
    for x, y in places:
        yield {"mark": "line", "role": role, "group": label, "x": x, "y": y, "label": label}


def audit(published: dict[str, pd.DataFrame]) -> list[dict]:
    """Numbers in Tables 2 to 5 that contradict others.

    The three counts of a row add up to the trials. What Section 4 says about the proposed mutation is checked against the numbers, by value
    alone and, for counts, by Fisher's exact test, with Holm's correction over the paper's twelve comparisons. Environment 2 ranks the
    operators by optima as environment 1 does.
    """
    tables = {name: table.set_index(["method", "metric"])["value"] for name, table in published.items() if "problem" in table}
    rows = []
    for name, table in tables.items():
        for method in ("proposed", *OTHERS):
            total = sum(table[method, metric] for metric in ("optimal", "near_optimal", "infeasible"))
            rows.append(_row(name, f"method={method}", "the three counts add to the trials", total, TRIALS, total == TRIALS))
        for metric, words, sign in SAID:
            own, *theirs = (_printed(table, method, metric) for method in ("proposed", *OTHERS))
            best = sign * max(sign * value for value in theirs)
            rule = f"the proposed mutation has the {words} (Section 4)"
            rows.append(_row(name, f"metric={metric}", rule, own, best, sign * (own - best) > 0))
    for metric, words, sign in SAID[:4:3]:
        rows += _fisher_rows(tables, metric, words, sign)
    ranks = {name: [table[method, "optimal"] for method in ("proposed", *OTHERS)] for name, table in tables.items()}
    pairs = list(itertools.combinations(range(len(OTHERS) + 1), 2))
    for name in ("table3", "table4", "table5"):
        agree = sum(np.sign(ranks[name][i] - ranks[name][j]) == np.sign(ranks["table2"][i] - ranks["table2"][j]) for i, j in pairs)
        rule = "pairs of operators that rank by optima as in Table 2 (Section 4): all"
        rows.append(_row(name, "metric=optimal", rule, agree, len(pairs), agree == len(pairs)))
    # A table of drives would say when the environment changes.
    drives = sum(not {"after", "moment"}.isdisjoint(table) for table in published.values())
    rule = "the title speaks of dynamic environments: some table has drives during which the environment changes"
    rows.append(_row("text", "title", rule, drives, 1, drives >= 1))
    return rows


def _fisher_rows(tables: dict[str, pd.Series], metric: str, words: str, sign: int) -> list[dict]:
    """Whether the proposed mutation's count differs from each other one by more than chance."""
    from scipy import stats

    pairs = list(itertools.product(tables, OTHERS))
    counts = [[tables[name][method, metric] for method in ("proposed", other)] for name, other in pairs]
    p = holm(np.array([stats.fisher_exact([[count, TRIALS - count] for count in both]).pvalue for both in counts]))
    return [
        _row(
            *(name, f"metric={metric}, proposed and {other}"),
            f"the proposed mutation has the {words} beyond chance: p of Fisher's test, corrected by Holm",
            *(value, ALPHA, value < ALPHA and sign * (own - theirs) > 0),
        )
        for (name, other), (own, theirs), value in zip(pairs, counts, p.tolist())
    ]


def _printed(table: pd.Series, method: str, metric: str) -> float:
    if metric == "found":
        return table[method, "optimal"] + table[method, "near_optimal"]
    return table[method, metric]


def _row(item: str, place: str, rule: str, printed: float, limit: float, consistent: bool) -> dict:
    return {"item": item, "place": place, "rule": rule, "printed": float(printed), "limit": float(limit), "consistent": bool(consistent)}
