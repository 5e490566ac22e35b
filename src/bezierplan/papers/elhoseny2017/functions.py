"""elhoseny2017: the worked example of the Q statistic, claims about printed numbers, and the
obstacle radius that fits the printed lengths.

Numbers of equations, sections, tables and figures are the paper's.
"""

import itertools
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bezierplan.analysis.results import select
from bezierplan.analysis.statistics import compute_interval
from bezierplan.geometry.cell_length import DIAGONAL
from bezierplan.planners.parts.diversity import compute_q_statistic
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, FunctionResult, Published
    from bezierplan.analysis.claims.kinds.function import Options as FunctionCheck


def read_text_values(published: "Published") -> dict[str, float]:
    """Read the values in the text, by quantity; a fraction stands for its value."""
    return {
        row.quantity: float(Fraction(str(row.value)))
        for row in published["text_values"].itertuples()
    }


def read_solutions(published: "Published") -> dict[str, np.ndarray]:
    """Read Table 1: the genes (10,) of each solution."""
    return {name: row.to_numpy() for name, row in published["table1"].set_index(" ").iterrows()}


def count_pairs(one: np.ndarray, other: np.ndarray) -> dict[str, int]:
    """Count the genes with each pair of values in one solution and the other (Section 3.3).

    >>> count_pairs(np.array([1, 1, 0]), np.array([1, 0, 0]))
    {'N11': 1, 'N00': 1, 'N10': 1, 'N01': 0}
    """
    return {
        f"N{a}{b}": int(((one == a) & (other == b)).sum())
        for a, b in ((1, 1), (0, 0), (1, 0), (0, 1))
    }


def compute_q(one: np.ndarray, other: np.ndarray) -> float:
    """Return Q of two solutions (n,) of 0 and 1 (equation 10)."""
    return compute_q_statistic(*count_pairs(one, other).values())


def q_table(published: "Published") -> pd.DataFrame:
    """Compute Table 1 and its derived quantities: genes of the solutions, counts and Q (equation
    10) of their pairs, and the mean Q.
    """
    genes = read_solutions(published)
    rows = [
        {"solutions": name, **{f"gene {gene}": value for gene, value in enumerate(values, 1)}}
        for name, values in genes.items()
    ]
    pairs = [
        {
            "solutions": f"{one}, {other}",
            **count_pairs(genes[one], genes[other]),
            "Q": compute_q(genes[one], genes[other]),
        }
        for one, other in itertools.combinations(genes, 2)
    ]
    mean = {"solutions": "mean", "Q": np.mean([pair["Q"] for pair in pairs])}
    whole = [column for row in rows + pairs for column in row if column not in ("solutions", "Q")]
    table = pd.DataFrame([*rows, *pairs, mean])
    return table.astype(dict.fromkeys(whole, "Int64")).round({"Q": 4})


def q_example(
    check: "FunctionCheck", results: "Experiments", published: "Published"
) -> "FunctionResult":
    """Judge claim C20: the Q statistics of Table 1 agree with the text.

    The effect is the largest difference from a printed value.
    """
    genes, printed = read_solutions(published), read_text_values(published)
    q_values = {
        f"Q of {one} and {other}": compute_q(genes[one], genes[other])
        for one, other in itertools.combinations(genes, 2)
    }
    mean = float(np.mean(list(q_values.values())))
    differences = [abs(value - printed[pair]) for pair, value in q_values.items()]
    # Single values are printed in full, the mean with two decimals.
    holds = max(differences) < 1e-12 and round(mean, 2) == printed["mean Q"]
    most = max(*differences, abs(mean - printed["mean Q"]))
    return "+" if holds else "-", most, None, len(q_values)


def fluctuation(
    check: "FunctionCheck", results: "Experiments", published: "Published", *, most: float
) -> "FunctionResult":
    """Judge claim C10: runs on the same field differ, but their standard deviation is at most a
    share of their mean.

    The effect is the coefficient of variation on the field where its bootstrap interval ends
    highest; the units are the runs on it.
    """
    fields = []
    for name in check.experiments:
        values = select(results[name].runs, check.where)[check.metric].dropna().to_numpy()
        ends = compute_interval("std", values, generator(f"elhoseny2017/C10/{check.metric}/{name}"))
        fields.append(np.array([values.std(), *ends]) / values.mean())
    effect, low, high = map(float, max(fields, key=max))
    mark = "+" if 0 < high <= most else "-" if low > most or high == 0 else "?"
    return mark, effect, (low, high), len(values)


def endless_loops(
    check: "FunctionCheck", results: "Experiments", published: "Published", *, least: float
) -> "FunctionResult":
    """Judge claim C33: at least a share of the iterations of a run that enter the loop of Algorithm
    2 do not end it by themselves.

    The effect is the mean of that share over the runs, with its bootstrap interval.
    """
    runs = select(results[check.experiments[0]].runs, check.where)
    # A run that never enters the loop says nothing about how it ends.
    shares = (runs["endless_loops"] / runs["loops"]).dropna().to_numpy()
    low, high = map(float, compute_interval("mean", shares, generator("elhoseny2017/C33")))
    mark = "+" if low >= least else "-" if high < least else "?"
    return mark, float(shares.mean()), (low, high), len(shares)


def printed_over_bound(
    check: "FunctionCheck", results: "Experiments", published: "Published"
) -> "FunctionResult":
    """Judge claim C23: no printed length of a competing method is larger than such fields explain.

    A path that never turns back in x or in y counts at most two cells for every cell of the side.
    Shortest paths among such obstacles do not turn back, so the fields cannot explain a larger
    printed mean. The effect is the largest printed length over the mean length of the shortest path
    of cells in our fields; the units are the fields.
    """
    ratios, explained, fields = [], [], 0
    for name, table in (("fields100", "table2"), ("fields200", "table3")):
        problems = select(results[name].runs, check.where).drop_duplicates("problem")
        fields += len(problems)
        least = problems.groupby(["route", "obstacles"])["octile_bound"].mean()
        rivals = published[table][published[table]["method"] != "mga"]
        printed = rivals.set_index(["route", "obstacles"])["value"]
        ratios.append((printed / least.reindex(printed.index)).max())
        explained.append(bool((printed <= 2 * problems["side"].iloc[0]).all()))
    return "+" if all(explained) else "-", float(max(ratios)), None, fields


# --------------------------------------------------------------------------------------------------
# The radius of the obstacles, which the paper does not state, inferred from its lengths


def estimate_length(side: int, radius: float, obstacles: np.ndarray | int) -> np.ndarray | float:
    """Return the mean of `cells4` of paths between opposite corners that never turn back, in cells.

    Such a path counts 2 cells per cell of the side, but 1.5 along a free diagonal. A circle with
    its centre uniform in the square leaves the diagonal free with probability (1 - sqrt(2)
    radius)^2: the share of the square farther from the diagonal than the radius.

    radius: a share of the side.
    """
    free = (1 - np.sqrt(2) * radius) ** (2 * np.asarray(obstacles))
    return side * (2 - (2 - DIAGONAL) * free)


def read_printed_lengths(published: "Published") -> pd.DataFrame:
    """Read the lengths of the proposed method in Tables 2 and 3; columns: side, route, obstacles
    and value, in cells.
    """
    printed = read_text_values(published)
    tables = [
        published[table].assign(side=int(printed[f"side in {table}"]))
        for table in ("table2", "table3")
    ]
    rows = pd.concat(tables, ignore_index=True)
    return rows.loc[rows["method"] == "mga", ["side", "route", "obstacles", "value"]]


def radius_errors(published: "Published") -> pd.DataFrame:
    """Compute the error of the expected lengths against the radius, as a share of their mean.

    Columns: radius (a share of the side), side, relative_error.
    """
    rows = []
    for side, printed in read_printed_lengths(published).groupby("side"):
        for radius in np.arange(5, 81) / 1000:
            apart = printed["value"] - estimate_length(side, radius, printed["obstacles"])
            rows.append((radius, side, apart.abs().mean() / printed["value"].mean()))
    return pd.DataFrame(rows, columns=["radius", "side", "relative_error"])
