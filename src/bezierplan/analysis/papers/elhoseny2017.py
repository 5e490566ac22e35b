"""elhoseny2017: the worked example of the Q statistic, claims about printed numbers, an audit of
its tables and text, the obstacle radius that fits the printed lengths, and its drawings.

Numbers of equations, sections, tables and figures are the paper's.
"""

import itertools
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bezierplan.analysis.audit_rows import checked, compared
from bezierplan.analysis.papers import rules
from bezierplan.analysis.papers.drawings import marks as marks
from bezierplan.analysis.results import select
from bezierplan.geometry.cell_length import DIAGONAL
from bezierplan.planners.parts.diversity import q_of_rows, q_statistic

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, Judged, Published
    from bezierplan.analysis.claims.kinds.function import Options as Check


def said(published: "Published") -> dict[str, float]:
    """Values in the text, by quantity; a fraction stands for its value."""
    return {
        row.quantity: float(Fraction(str(row.value)))
        for row in published["text_values"].itertuples()
    }


def solutions(published: "Published") -> dict[str, np.ndarray]:
    """Table 1: the genes (10,) of each solution."""
    return {
        name: row.to_numpy() for name, row in published["table1"].set_index("solution").iterrows()
    }


def counts(one: np.ndarray, other: np.ndarray) -> dict[str, int]:
    """Section 3.3: the number of genes with each pair of values in one solution and the other."""
    return {
        f"N{a}{b}": int(((one == a) & (other == b)).sum())
        for a, b in ((1, 1), (0, 0), (1, 0), (0, 1))
    }


def q_table(published: "Published") -> pd.DataFrame:
    """Table 1 and derived quantities: genes of the solutions, counts and Q (equation 10) of their
    pairs, and the mean Q.
    """
    genes = solutions(published)
    rows = [
        {"solutions": name, **{f"gene {gene}": value for gene, value in enumerate(values, 1)}}
        for name, values in genes.items()
    ]
    pairs = [
        {
            "solutions": f"{one}, {other}",
            **counts(genes[one], genes[other]),
            "Q": q_of_rows(genes[one], genes[other]),
        }
        for one, other in itertools.combinations(genes, 2)
    ]
    mean = {"solutions": "mean", "Q": np.mean([pair["Q"] for pair in pairs])}
    whole = [column for row in rows + pairs for column in row if column not in ("solutions", "Q")]
    table = pd.DataFrame([*rows, *pairs, mean])
    return table.astype(dict.fromkeys(whole, "Int64")).round({"Q": 4})


def q_example(check: "Check", results: "Experiments", published: "Published") -> "Judged":
    """Claim C20: whether the Q statistics of Table 1 agree with the text. The effect is the largest
    difference from a printed value.
    """
    genes, printed = solutions(published), said(published)
    q_values = {
        f"Q of {one} and {other}": q_of_rows(genes[one], genes[other])
        for one, other in itertools.combinations(genes, 2)
    }
    mean = float(np.mean(list(q_values.values())))
    differences = [abs(q - printed[pair]) for pair, q in q_values.items()]
    holds = max(differences) < 1e-12 and round(mean, 2) == printed["mean Q"]
    most = max(*differences, abs(mean - printed["mean Q"]))
    return "+" if holds else "-", most, None, len(q_values)


def printed_over_bound(check: "Check", results: "Experiments", published: "Published") -> "Judged":
    """Claim C23: whether no printed length of a competing method is larger than such fields
    explain.

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


def audit(published: "Published") -> list[dict]:
    """Printed numbers that contradict the text, other tables or the rule for counting lengths.

    A straight diagonal counts 1.5 cells per cell of the side, the minimum for a path between
    opposite corners; a path that never turns back counts at most 2. Sentences of Section 4.6 are
    checked against the tables: PRM the longest, the proposed method cheaper than all others in all
    cases. Two tables print times for methods of the same name. Section 3.3.1 counts pairs of its
    example, in Section 3.3 eta decreases linearly to 0 and then accepts more, and in Section 2.2.2
    any mutation leaves the subspace of a crossover.
    """
    parts = (rules.audit, _audit_example, _audit_text, _growth)
    return [row for part in parts for row in part(published)]


def _audit_example(published: "Published") -> Iterator[dict]:
    printed, genes = said(published), solutions(published)
    in_text = {name: int(printed[f"{name} of S1 and S2"]) for name in ("N11", "N00", "N10", "N01")}
    rule = "the text counts as it defines"
    for name, counted in counts(genes["S1"], genes["S2"]).items():
        yield compared("table1", f"S1, S2: {name}", rule, in_text[name], "==", counted)
    rule, q = "Q of the counts in the text is the printed one", q_statistic(*in_text.values())
    yield compared("table1", "S1, S2: Q", rule, printed["Q of S1 and S2"], "==", q)


def _audit_text(published: "Published") -> Iterator[dict]:
    printed = said(published)
    eta, decay, iterations = printed["eta"], printed["decay of eta"], int(printed["iterations"])
    last = eta * decay**iterations
    rule = f"eta decreases to 0 over the {iterations} iterations"
    yield checked("text", "3.3, 4.2.2", rule, 0.0, round(last, 4), last < 0.005)
    half = eta * (1 - decay ** (iterations // 2)) / (eta - last)
    rule = "eta decreases linearly: half of the way in half of the iterations"
    yield checked("text", "3.3, 4.2.2", rule, 0.5, round(half, 4), abs(half - 0.5) < 0.005)
    rule = (
        "3.3: as eta falls, more similar solutions are accepted, though theirs is a Q of at "
        "most eta: eta after an iteration"
    )
    yield compared("text", "3.3", rule, eta * decay, ">=", eta)
    # A crossover keeps the digits that both parents have.
    digits, shared = int(printed["digits of A"]), int(printed["digits of A that B has too"])
    rule = (
        "2.2.2: a change of any digit of A leaves the subspace of its crossover with B: digits "
        "of which that is true"
    )
    yield compared("text", "2.2.2", rule, digits, "==", shared)
    # A table of drives would say how fast the obstacles are.
    drives = sum(not {"speed", "moment"}.isdisjoint(table) for table in published.values())
    rule = "the title speaks of a dynamic field: some table has obstacles that move"
    yield compared("text", "title", rule, drives, ">=", 1)


def _growth(published: "Published") -> Iterator[dict]:
    """Rows of the audit: do the printed lengths of the proposed method grow with the obstacles as
    the counting rule has it?

    A path counts 1.5 cells for each of the side along a free diagonal, else 2, so a mean says how
    many diagonals were blocked.
    """
    from scipy import stats

    printed, fields = _printed_lengths(published), int(published["table2"]["n"].iloc[0])
    blocked = fields * (printed["value"] / printed["side"] - DIAGONAL) / (2 - DIAGONAL)
    whole = int(np.isclose(blocked, blocked.round()).sum())
    blocked_cells, tried = (
        each.groupby(printed["obstacles"]).sum() for each in (blocked, 0 * blocked + fields)
    )
    radius = radius_errors(published).groupby("radius")["relative_error"].mean().idxmin()
    share = (expected_length(1, radius, blocked_cells.index.to_numpy()) - DIAGONAL) / (2 - DIAGONAL)
    rule = (
        f"means of {fields} fields, with {DIAGONAL:g} or 2 cells for each of the side: how "
        "many of the printed can be such"
    )
    location = "table2, table3", "method=mga"
    yield compared(*location, rule, whole, "==", len(printed))
    # The radius is fitted to these lengths.
    freedom = len(blocked_cells) - 1
    chi_square, limit = (
        ((blocked_cells - tried * share) ** 2 / (tried * share * (1 - share))).sum(),
        stats.chi2.ppf(0.95, freedom),
    )
    rule = (
        f"lengths grow with the obstacles as diagonals get blocked: chi-square ({freedom} "
        "degrees of freedom) and its limit at 5 %"
    )
    yield checked(*location, rule, round(chi_square, 1), round(limit, 1), bool(chi_square <= limit))


# --------------------------------------------------------------------------------------------------
# The radius of the obstacles, which the paper does not state, inferred from its lengths


def _sides(published: "Published") -> dict[str, int]:
    """The side of the fields of a table of lengths, in cells."""
    printed = said(published)
    return {table: int(printed[f"side in {table}"]) for table in ("table2", "table3")}


def expected_length(side: int, radius: float, obstacles: np.ndarray | int) -> np.ndarray | float:
    """Mean of `cells4` of paths between opposite corners that never turn back, in cells; radius: a
    share of the side.

    Such a path counts 2 cells per cell of the side, but 1.5 along a free diagonal. A circle with
    its centre uniform in the square leaves the diagonal free with probability (1 - sqrt(2)
    radius)^2: the share of the square farther from the diagonal than the radius.
    """
    free = (1 - np.sqrt(2) * radius) ** (2 * np.asarray(obstacles))
    return side * (2 - (2 - DIAGONAL) * free)


def _printed_lengths(published: "Published") -> pd.DataFrame:
    """Lengths of the proposed method in Tables 2 and 3; columns: side, route, obstacles and value,
    in cells.
    """
    tables = [published[table].assign(side=side) for table, side in _sides(published).items()]
    rows = pd.concat(tables, ignore_index=True)
    return rows.loc[rows["method"] == "mga", ["side", "route", "obstacles", "value"]]


def _errors(printed: pd.DataFrame, side: int, radius: float) -> tuple[float, float]:
    """Mean absolute difference between printed and expected lengths for a side, in cells, and as a
    share of their mean.
    """
    own = printed[printed["side"] == side]
    error = float((own["value"] - expected_length(side, radius, own["obstacles"])).abs().mean())
    return error, error / own["value"].mean()


def radius_fit(published: "Published", *, radii: list[float]) -> pd.DataFrame:
    """The printed lengths of the proposed method, those expected for several obstacle radii (shares
    of the side), and the errors of the latter.

    The last rows have the radius with the least error (relative to the mean length, averaged over
    both sides), in steps of a thousandth of the side.
    """
    printed = _printed_lengths(published)
    errors = radius_errors(published).groupby("radius")["relative_error"].mean()
    best = float(errors.idxmin())
    numbers = sorted(printed["obstacles"].unique())
    rows = []
    for (side, route), own in printed.groupby(["side", "route"]):
        lengths = own.set_index("obstacles")["value"]
        printed_lengths = {f"{n} obstacles": lengths[n] for n in numbers}
        rows.append({"lengths": f"printed, {route}", "side": side, **printed_lengths})
    for name, radius in [("expected", radius) for radius in radii] + [("least error", best)]:
        for side in _sides(published).values():
            cells, share = _errors(printed, side, radius)
            rows.append(
                {
                    "lengths": name,
                    "radius / side": radius,
                    "side": side,
                    **{
                        f"{n} obstacles": round(expected_length(side, radius, n), 1)
                        for n in numbers
                    },
                    "mean error (cell)": round(cells, 2),
                    "mean error / mean length": round(share, 4),
                }
            )
    return pd.DataFrame(rows)[list(rows[-1])]


def radius_lengths(published: "Published", *, radii: list[float]) -> pd.DataFrame:
    """Printed and expected lengths against the number of obstacles; columns: side, lengths (which),
    obstacles, cells4 (in cells).
    """
    printed = _printed_lengths(published).rename(columns={"value": "cells4"})
    printed["lengths"] = "printed, " + printed.pop("route").str.replace("case", "Case ")
    counts = np.arange(printed["obstacles"].min(), printed["obstacles"].max() + 1)
    expected = [
        pd.DataFrame({"obstacles": counts, "cells4": expected_length(side, radius, counts)}).assign(
            side=side, lengths=f"R = {radius:g} N"
        )
        for side in _sides(published).values()
        for radius in radii
    ]
    return pd.concat([printed, *expected], ignore_index=True)


def radius_errors(published: "Published") -> pd.DataFrame:
    """The error of the expected lengths against the radius; columns: radius (a share of the side),
    side, relative_error.
    """
    printed = _printed_lengths(published)
    rows = [
        (thousandths / 1000, side, _errors(printed, side, thousandths / 1000)[1])
        for side in _sides(published).values()
        for thousandths in range(5, 81)
    ]
    return pd.DataFrame(rows, columns=["radius", "side", "relative_error"])
