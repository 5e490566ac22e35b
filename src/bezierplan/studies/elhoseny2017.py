"""elhoseny2017: the worked example of the Q statistic, claims on printed numbers, and an audit of its tables and text.

Numbers of equations, sections, tables and figures are the paper's.
"""

import itertools

import numpy as np
import pandas as pd

from bezierplan.analysis.results import Results, select
from bezierplan.cell_length import DIAGONAL
from bezierplan.search.diversity import q_of_rows, q_statistic

# Section 3.3.1 prints these Q statistics, the mean to two decimals, and these counts N11, N00, N10, N01 of the first pair.
SAID_Q = {("S1", "S2"): 0.0, ("S1", "S3"): 0.0, ("S2", "S3"): -1 / 3}
SAID_MEAN_Q = -0.11
SAID_COUNTS = {"N11": 3, "N00": 2, "N10": 3, "N01": 2}

# Sections 3.3 and 4.2.2.
ETA, ETA_DECAY, ITERATIONS = 0.8, 0.99, 80


def solutions(published: dict[str, pd.DataFrame]) -> dict[str, np.ndarray]:
    """Table 1: the genes (10,) of each solution."""
    return {name: rows.sort_values("gene")["value"].to_numpy() for name, rows in published["table1"].groupby("solution")}


def counts(one: np.ndarray, other: np.ndarray) -> dict[str, int]:
    """Section 3.3: the numbers of genes that have these values in one solution and in the other."""
    return {f"N{a}{b}": int(((one == a) & (other == b)).sum()) for a, b in ((1, 1), (0, 0), (1, 0), (0, 1))}


def q_table(published: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Table 1 with what follows from it: genes of the solutions, counts and Q (equation 10) of their pairs, and the mean Q."""
    genes = solutions(published)
    rows = [{"solutions": name, **{f"gene {gene}": value for gene, value in enumerate(values, 1)}} for name, values in genes.items()]
    pairs = [
        {"solutions": f"{one}, {other}", **counts(genes[one], genes[other]), "Q": q_of_rows(genes[one], genes[other])}
        for one, other in itertools.combinations(genes, 2)
    ]
    mean = {"solutions": "mean", "Q": np.mean([pair["Q"] for pair in pairs])}
    whole = [column for row in rows + pairs for column in row if column not in ("solutions", "Q")]
    table = pd.DataFrame([*rows, *pairs, mean])
    return table.astype(dict.fromkeys(whole, "Int64")).round({"Q": 4})


def q_example(check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame]) -> tuple[str, float, None, int]:
    """Claim C20: do the Q statistics of Table 1 agree with the text? The effect is the largest difference from a printed value."""
    genes = solutions(published)
    found = {pair: q_of_rows(genes[pair[0]], genes[pair[1]]) for pair in SAID_Q}
    mean = float(np.mean(list(found.values())))
    differences = [abs(found[pair] - said) for pair, said in SAID_Q.items()]
    holds = max(differences) < 1e-12 and round(mean, 2) == SAID_MEAN_Q
    return "+" if holds else "-", max(*differences, abs(mean - SAID_MEAN_Q)), None, len(found)


def printed_over_bound(check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame]) -> tuple[str, float, None, int]:
    """Claim C23: is no printed length of a rival larger than such fields explain?

    A path that never turns back in x or in y counts at most two cells for every cell of the side. Shortest paths among such obstacles do
    not turn back, so a printed mean above that is more than the fields explain. The effect is the largest printed length over the mean of
    the least path of cells in our fields; the units are the fields.
    """
    ratios, explained, fields = [], [], 0
    for name, table in (("fields100", "table2"), ("fields200", "table3")):
        problems = select(results[name].runs, check.get("where", {})).drop_duplicates("problem")
        fields += len(problems)
        least = problems.groupby(["route", "obstacles"])["bound8"].mean()
        rivals = published[table][published[table]["method"] != "mga"]
        printed = rivals.set_index(["route", "obstacles"])["value"]
        ratios.append((printed / least.reindex(printed.index)).max())
        explained.append(bool((printed <= 2 * problems["side"].iloc[0]).all()))
    return "+" if all(explained) else "-", float(max(ratios)), None, fields


def audit(published: dict[str, pd.DataFrame]) -> list[dict]:
    """What of the printed numbers does not fit the text, other tables or the rule by which lengths are counted.

    A straight diagonal counts 1.5 cells for each of the side, which no path between opposite corners falls below; a path that never turns
    back counts at most 2. Sentences of Section 4.6 stand beside the tables: PRM the longest, the proposed method cheaper than all others
    in all cases. Two tables print times of methods of the same name. Section 3.3.1 counts pairs of its example, and Section 3.3 has eta
    decrease linearly to 0.
    """
    rows = []
    for table, side in (("table2", 100), ("table3", 200)):
        cells = published[table]
        for row in cells.itertuples():
            rule = f"no path between opposite corners counts less than {DIAGONAL:g} cells for each of the side"
            rows.append(_row(table, _place(row), rule, row.value, DIAGONAL * side, row.value >= DIAGONAL * side))
            rule = "a path that never turns back counts at most 2 cells for each of the side"
            rows.append(_row(table, _place(row), rule, row.value, 2 * side, row.value <= 2 * side))
        for (route, obstacles), column in cells.groupby(["route", "obstacles"]):
            lengths = column.set_index("method")["value"]
            place = f"route={route}, obstacles={obstacles}"
            others = lengths.drop("prm").max()
            rows.append(_row(table, f"{place}, method=prm", "the text has PRM the longest", lengths["prm"], others, lengths["prm"] > others))
            least = lengths.drop("mga").min()
            rule = "the text has the proposed method the shortest"
            rows.append(_row(table, f"{place}, method=mga", rule, lengths["mga"], least, lengths["mga"] < least))
            if table == "table2":
                rivals = lengths.drop(["mga", "ga"]).min()
                rule = "the text has GA second"
                rows.append(_row(table, f"{place}, method=ga", rule, lengths["ga"], rivals, lengths["mga"] < lengths["ga"] < rivals))
    means = {name: published[name].query("statistic == 'mean'").set_index(["method", "obstacles"])["value"] for name in ("table5", "table6")}
    for table, times in means.items():
        for (method, obstacles), time in times.drop("mga").items():
            ours = times["mga", obstacles]
            rule = "the text has the proposed method cheaper than all others in all cases"
            rows.append(_row(table, f"method=mga, obstacles={obstacles}, beside {method}", rule, ours, time, ours < time))
    for obstacles, time in means["table5"]["mga"].items():
        other = means["table6"]["mga", obstacles]
        rule = "Tables 5 and 6 print the same time of the proposed method"
        rows.append(_row("table5", f"method=mga, obstacles={obstacles}", rule, time, other, time == other))
        time, other = means["table5"]["mga_plain", obstacles], means["table6"]["ga", obstacles]
        rule = "Tables 5 and 6 print the same time of what both call GA"
        rows.append(_row("table5", f"method=GA, obstacles={obstacles}", rule, time, other, time == other))
    genes = solutions(published)
    for name, found in counts(genes["S1"], genes["S2"]).items():
        rows.append(_row("table1", f"S1, S2: {name}", "the text counts as it defines", SAID_COUNTS[name], found, SAID_COUNTS[name] == found))
    said = q_statistic(SAID_COUNTS["N11"], SAID_COUNTS["N00"], SAID_COUNTS["N10"], SAID_COUNTS["N01"])
    rows.append(_row("table1", "S1, S2: Q", "Q of the counts in the text is the printed one", SAID_Q["S1", "S2"], said, said == 0))
    last = ETA * ETA_DECAY**ITERATIONS
    rows.append(_row("text", "3.3, 4.2.2", f"eta decreases to 0 over the {ITERATIONS} iterations", 0.0, round(last, 4), last < 0.005))
    half = ETA * (1 - ETA_DECAY ** (ITERATIONS // 2))
    rule = "eta decreases linearly: half of the way in half of the iterations"
    rows.append(_row("text", "3.3, 4.2.2", rule, 0.5, round(half / (ETA - last), 4), abs(half / (ETA - last) - 0.5) < 0.005))
    return rows


def _row(item: str, place: str, rule: str, printed: float, limit: float, consistent: bool) -> dict:
    return {"item": item, "place": place, "rule": rule, "printed": printed, "limit": limit, "consistent": bool(consistent)}


def _place(row: tuple) -> str:
    """Which cell of Table 2 or 3 a printed number is."""
    return f"route={row.route}, obstacles={row.obstacles}, method={row.method}"
