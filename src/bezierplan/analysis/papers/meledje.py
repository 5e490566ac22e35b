"""meledje: the drawings of its Figures 2 to 4, and an audit of its Tables 2 to 5.

Numbers of equations, sections, tables and figures are the paper's. Drawings use the operators of
the planner itself.
"""

import itertools
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import shapely

from bezierplan.analysis.audit_rows import checked, compared
from bezierplan.analysis.papers.marks import along, mark, text
from bezierplan.analysis.results import select
from bezierplan.analysis.statistics import holm
from bezierplan.planners import node_genetic, planner_settings
from bezierplan.planners.parts.node_mutation import (
    Direction,
    Mutation,
    ObstacleNode,
    Ref21Test,
    WithoutObstacle,
    mutate,
)
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.ground import (
    MOST_NEIGHBOURS,
    Neighbourhood,
    centres,
    ground_of,
    obstacles_met,
)
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, Judged, Published
    from bezierplan.analysis.claims.kinds.function import Options as Check

# Of a cell: any nearer to the path there is no room for a number.
BESIDE = 0.45
# Draws among which one is sought whose mutation shows what the paper says about the operator.
DRAWS = 1000

# The counts of `said` that Fisher's exact test compares, its level, and the sign of what counts as
# best.
TESTED = ("optimal", "infeasible")
ALPHA = 0.05
SIGN = {"highest": 1, "lowest": -1}
# Quantities by which environment 2 is said to confirm environment 1, and their words.
RANKED = {"optimal": "optima", "objective": "mean fitness", "cpu_s": "mean solution time"}


def chromosome(*, genes: list[int], side: int) -> pd.DataFrame:
    """Figure 2: genes, numbers of cells from 1 (part `genes`), and their path on a grid of side x
    side cells (part `path`).
    """
    row = _genes(genes, 0, ["accent", *["muted"] * (len(genes) - 2), "accent"])
    row += [text(x, -0.9, word) for x, word in ((0, "start"), (3, "passage"), (6, "target"))]
    places = [_place(number, side) for number in genes]
    way = shapely.LineString(places)
    cells = {number: _place(number, side) for number in range(1, side * side + 1)}
    path = [_cell("free", *place) for place in cells.values()]
    # Cells that the path crosses between its nodes show no number, because the path would make it
    # illegible.
    path += [
        text(*place, number)
        for number, place in cells.items()
        if shapely.Point(place).distance(way) > BESIDE
    ]
    path += along("line", "accent", places, group="path", label="path")
    for number, place in zip(genes, places, strict=True):
        path += [_cell("accent", *place), text(*place, number)]
    return pd.DataFrame(
        [each | {"part": "genes"} for each in row] + [each | {"part": "path"} for each in path]
    )


def crossover(*, parents: list[list[int]], cut: int) -> pd.DataFrame:
    """Figure 3: two parents (part `parents`) and their children (part `children`), each parent's
    nodes in a distinct style.

    cut: the number of nodes after which both are cut.
    """
    one, other = (np.array(parent) for parent in parents)
    frames = []
    for part, (first, second) in {
        "parents": parents,
        "children": (_child(one, other, cut), _child(other, one, cut)),
    }.items():
        own = {"parents": (len(first), 0), "children": (cut, cut)}[part]
        looks = [
            ["accent"] * own[0] + ["muted"] * (len(first) - own[0]),
            ["muted"] * (own[1] or len(second)),
        ]
        looks[1] += ["accent"] * (len(second) - len(looks[1]))
        marks = [*_genes(first, 1.5, looks[0]), *_genes(second, 0, looks[1])]
        line = [(cut - 0.5, -0.8), (cut - 0.5, 2.3)]
        marks += along("line", "second", line, group="cut", label="cut")
        frames.append(pd.DataFrame(marks).assign(part=part))
    return pd.concat(frames)


def _child(head: np.ndarray, tail: np.ndarray, cut: int) -> list[int]:
    child = np.empty(len(head) + len(tail), dtype=np.int64)
    return child[: node_genetic.join(head, cut, tail, cut, len(tail), child)].tolist()


def mutations(
    grid: Grid,
    *,
    free_path: list[list[int]],
    blocked_path: list[list[int]],
    any_node: bool,
    beside_obstacle: bool,
    keep_better: bool,
    same_signs: bool,
    whole_path: bool,
    penalty: float,
) -> pd.DataFrame:
    """Figure 4: a path before and after a mutation, by operator, and the cells that were tried
    instead of the node.

    Random mutation makes a feasible path infeasible; reference 12 changes a node that is not before
    the obstacle, and the path stays infeasible; the proposed mutation changes the one that is. The
    first draw with this result is shown.

    free_path, blocked_path: columns and rows of the nodes of a feasible path, and of one whose
    second edge meets an obstacle. The others: settings that the operators read, as in
    `node_genetic.Settings`.
    """
    unread = node_genetic.Settings(
        **{
            name: 0 if each.words else each.kind()
            for name, each in planner_settings(node_genetic).items()
        }
    )
    rules = unread._replace(
        without_obstacle=int(WithoutObstacle.any_node if any_node else WithoutObstacle.none),
        obstacle_node=int(ObstacleNode.neighbour if beside_obstacle else ObstacleNode.edge),
        neighbourhood=int(Neighbourhood.eight),
        keep_better=keep_better,
        direction=int(Direction.same_signs if same_signs else Direction.forward),
        ref21_test=int(Ref21Test.path if whole_path else Ref21Test.edges),
        penalty=penalty,
    )
    frames = []
    for operator, places in (
        ("random", free_path),
        ("ref12", blocked_path),
        ("proposed", blocked_path),
    ):
        before = np.array([column + grid.occupied.shape[1] * row for column, row in places])
        after, k = next(_shown(grid, operator, before, rules))
        frames.append(
            pd.DataFrame(_mutation(grid, operator, before, after, k)).assign(operator=operator)
        )
    return pd.concat(frames)


def _shown(
    grid: Grid, operator: str, before: np.ndarray, rules: node_genetic.Settings
) -> Iterator[tuple[np.ndarray, int]]:
    """Paths after a mutation that shows what the paper says about the operator, each with the index
    of the changed node.
    """
    ground = ground_of(grid, 1.0)
    drawn = np.setdiff1d(np.flatnonzero(~grid.occupied), before[[0, -1]])
    rules = rules._replace(mutation=int(Mutation[operator]))
    for number in range(DRAWS):
        after = before.copy()
        mutate(
            generator("meledje/figure4", operator, number),
            after,
            drawn,
            ground,
            rules,
            np.empty(MOST_NEIGHBOURS, dtype=np.int64),
        )
        for k in np.flatnonzero(after != before).tolist():
            blocked = any(
                obstacles_met(ground, *edge) for edge in itertools.pairwise(after.tolist())
            )
            if blocked != (operator == "proposed"):
                yield after, k


def _mutation(
    grid: Grid, operator: str, before: np.ndarray, after: np.ndarray, k: int
) -> list[dict]:
    """Marks of a path before and after the change of node k."""
    first, second = (centres(grid, path).tolist() for path in (before, after))
    marks = along("line", "third", first, group="before", label="before")
    marks += along("line", "accent", second, group="after", label="after")
    if operator != "random":
        rows, columns = grid.occupied.shape
        row, column = divmod(int(before[k]), columns)
        for above, beside in itertools.product(
            range(max(row - 1, 0), min(row + 2, rows)),
            range(max(column - 1, 0), min(column + 2, columns)),
        ):
            if (above, beside) != (row, column) and not grid.occupied[above, beside]:
                centre = grid.centre(above * columns + beside)
                marks.append(mark("dots", "muted", *centre, group="tried", label="cells tried"))
    marks += along("dots", "third", first[1:k] + first[k + 1 : -1], group="others", label="node")
    for role, label, centre in (
        ("first", "node that changes", first[k]),
        ("accent", "node in its place", second[k]),
        ("start", "start", first[0]),
        ("target", "target", first[-1]),
    ):
        marks.append(mark("dots", role, *centre, group=role, label=label))
    return marks


def _place(number: int, side: int) -> tuple[float, float]:
    """Column and row of a cell of Figure 2, from 1."""
    return (number - 1) % side + 1.0, (number - 1) // side + 1.0


def _genes(numbers: Sequence[int], y: float, roles: Sequence[str]) -> list[dict]:
    """Marks of a chromosome, as a row of boxes."""
    return [
        each
        for x, (number, role) in enumerate(zip(numbers, roles, strict=True))
        for each in (_cell(role, x, y), text(x, y, number))
    ]


def _cell(role: str, x: float, y: float) -> dict:
    return mark("cell", role, x, y, width=1.0, height=1.0)


def less_work_for_a_path(
    check: "Check", results: "Experiments", published: "Published", *, group: str, other: str
) -> "Judged":
    """Claim C7: whether one kind of first population takes less work than another until a run ends
    feasible, in every environment.

    The work is the mean number of evaluations of a run over the share of feasible ones. The effect
    is the largest ratio of both kinds' work, with the least and largest ratio that their
    Clopper-Pearson intervals allow; the units are the runs of the smaller kind.
    """
    runs = select(results[check.experiment].runs, check.where)
    ratios = []
    for _, own in runs.groupby("workspace"):
        (least, typical, most), (least_other, typical_other, most_other) = (
            _work(own[own["initial"] == name]) for name in (group, other)
        )
        ratios.append((typical / typical_other, least / most_other, most / least_other))
    typical, low, high = (max(each) for each in zip(*ratios, strict=True))
    mark = "+" if high < 1 else "-" if low > 1 else "?"
    return mark, typical, (low, high), int(runs.groupby(["workspace", "initial"]).size().min())


def _work(runs: pd.DataFrame) -> tuple[float, float, float]:
    """Evaluations for each feasible path: least, found and most, infinite where no run is
    feasible.
    """
    from scipy import stats

    found = stats.binomtest(int(runs["feasible"].sum()), len(runs))
    share = found.proportion_ci(method="exact")
    with np.errstate(divide="ignore"):
        least, typical, most = (
            float(np.divide(runs["evaluations"].mean(), each))
            for each in (share.high, found.statistic, share.low)
        )
    return least, typical, most


def audit(published: "Published") -> list[dict]:
    """Numbers in Tables 2 to 5 that contradict others.

    The three counts of a row add up to the trials. What Section 4 says about the proposed mutation
    is checked against the numbers, by value alone and, for counts, by Fisher's exact test, with
    Holm's correction over the paper's twelve comparisons. The other tables rank the operators as
    Table 2 does, by optima, mean fitness and time.
    """
    tables = {
        name: table.set_index(["method", "metric"])["value"]
        for name, table in published.items()
        if "problem" in table
    }
    trials = {name: int(published[name]["n"].max()) for name in tables}
    operators = list(published["table2"]["method"].unique())
    others = [method for method in operators if method != "proposed"]
    said = list(published["said"].itertuples())
    rows = []
    for name, table in tables.items():
        for method in ("proposed", *others):
            total = sum(
                table[method, metric] for metric in ("optimal", "near_optimal", "infeasible")
            )
            rule = "the three counts add to the trials"
            rows.append(compared(name, f"method={method}", rule, total, "==", trials[name]))
        for sentence in said:
            sign = SIGN[sentence.best]
            proposed, *theirs = (
                _printed(table, method, sentence.quantity) for method in ("proposed", *others)
            )
            best = sign * max(sign * value for value in theirs)
            place = f"metric={sentence.quantity}"
            rule = f"the proposed mutation has the {sentence.words} (Section 4)"
            relation = {1: ">", -1: "<"}[sign]
            rows.append(compared(name, place, rule, proposed, relation, best))
    for sentence in said:
        if sentence.quantity in TESTED:
            rows += _fisher_rows(
                tables, trials, others, sentence.quantity, sentence.words, SIGN[sentence.best]
            )
    pairs = list(itertools.combinations(operators, 2))
    for metric, words in RANKED.items():
        for name in ("table3", "table4", "table5"):
            agree = sum(
                np.sign(tables[name][one, metric] - tables[name][other, metric])
                == np.sign(tables["table2"][one, metric] - tables["table2"][other, metric])
                for one, other in pairs
            )
            rule = f"pairs of operators that rank by {words} as in Table 2 (Section 4): all"
            rows.append(compared(name, f"metric={metric}", rule, agree, "==", len(pairs)))
    # A table of drives would say when the environment changes.
    drives = sum(not {"after", "moment"}.isdisjoint(table) for table in published.values())
    rule = (
        "the title speaks of dynamic environments: some table has drives during which the "
        "environment changes"
    )
    return [*rows, compared("text", "title", rule, drives, ">=", 1)]


def _fisher_rows(
    tables: dict[str, pd.Series],
    trials: dict[str, int],
    others: list[str],
    metric: str,
    words: str,
    sign: int,
) -> list[dict]:
    """Whether the proposed mutation's count differs from each other one by more than chance."""
    from scipy import stats

    pairs = list(itertools.product(tables, others))
    counts = [
        [tables[name][method, metric] for method in ("proposed", other)] for name, other in pairs
    ]
    squares = [
        [[count, trials[name] - count] for count in both]
        for (name, _), both in zip(pairs, counts, strict=True)
    ]
    p = holm(np.array([stats.fisher_exact(square).pvalue for square in squares]))
    return [
        checked(
            *(name, f"metric={metric}, proposed and {other}"),
            f"the proposed mutation has the {words} beyond chance: "
            "p of Fisher's test, corrected by Holm",
            *(value, ALPHA, bool(value < ALPHA and sign * (own - theirs) > 0)),
        )
        for (name, other), (own, theirs), value in zip(pairs, counts, p.tolist())
    ]


def _printed(table: pd.Series, method: str, metric: str) -> float:
    if metric == "found":
        return table[method, "optimal"] + table[method, "near_optimal"]
    return table[method, metric]
