"""meledje: an audit of its Tables 2 to 5.

Numbers of equations, sections, tables and figures are the paper's.
"""

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis.audit import rules
from bezierplan.analysis.audit.rows import build_audit_row, compare_with_limit

# The counts of `said` that Fisher's exact test compares, its level, and the sign of what counts as
# best.
TESTED = ("optimal", "infeasible")
ALPHA = 0.05
SIGN = {"highest": 1, "lowest": -1}
# Quantities by which environment 2 is said to confirm environment 1, and their words.
RANKED = {"optimal": "optima", "objective": "mean fitness", "cpu_s": "mean solution time"}


def audit(published: dict[str, pd.DataFrame]) -> list[dict]:
    """List numbers in Tables 2 to 5 that contradict others.

    The three counts of a row add up to the trials. The sentences of Section 4 about the proposed
    mutation are checked against the numbers, by value alone and, for counts, by Fisher's exact
    test, with Holm's correction over the paper's twelve comparisons. The other tables rank the
    operators as Table 2 does, by optima, mean fitness and time.
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
    rows = rules.check_rules(published)
    for sentence in said:
        if sentence.quantity in TESTED:
            rows += _test_counts(tables, trials, others, sentence)
    pairs = list(itertools.combinations(operators, 2))
    for metric, words in RANKED.items():
        for name in ("table3", "table4", "table5"):
            agree = sum(
                np.sign(tables[name][one, metric] - tables[name][other, metric])
                == np.sign(tables["table2"][one, metric] - tables["table2"][other, metric])
                for one, other in pairs
            )
            rule = f"pairs of operators that rank by {words} as in Table 2 (Section 4): all"
            rows.append(compare_with_limit(name, f"metric={metric}", rule, agree, "==", len(pairs)))
    # A table of drives would say when the environment changes.
    drives = sum(not {"after", "moment"}.isdisjoint(table) for table in published.values())
    rule = (
        "the title speaks of dynamic environments: some table has drives during which the "
        "environment changes"
    )
    return [*rows, compare_with_limit("text", "title", rule, drives, ">=", 1)]


def _test_counts(
    tables: dict[str, pd.Series], trials: dict[str, int], others: list[str], sentence: Any
) -> Iterator[dict]:
    """Test whether the proposed mutation's count differs from each other one by more than chance;
    and from that of ref12 over all maps together, by the test of Cochran, Mantel and Haenszel with
    its correction for continuity, a map a stratum.

    sentence: its quantity, whether the highest or lowest is best, and its words.
    """
    from scipy import stats

    metric, sign = sentence.quantity, SIGN[sentence.best]
    pairs, apart, p = list(itertools.product(tables, others)), [], []
    for name, other in pairs:
        own, theirs = (tables[name][method, metric] for method in ("proposed", other))
        square = [[count, trials[name] - count] for count in (own, theirs)]
        apart.append(own - theirs)
        p.append(stats.fisher_exact(square).pvalue)
    rule = (
        f"the proposed mutation has the {sentence.words} beyond chance: p of Fisher's test, "
        "corrected by Holm"
    )
    for (name, other), more, value in zip(pairs, apart, correct_by_holm(np.array(p)).tolist()):
        location, fits = f"metric={metric}, proposed and {other}", value < ALPHA and sign * more > 0
        yield build_audit_row(name, location, rule, value, ALPHA, bool(fits))
    ours, theirs, size = np.array(
        [
            [table["proposed", metric], table["ref12", metric], trials[name]]
            for name, table in tables.items()
        ]
    ).T
    both = ours + theirs
    off = float((ours - both / 2).sum())
    variance = float((both * (2 * size - both) / (4 * (2 * size - 1))).sum())
    chi_square = max(abs(off) - 0.5, 0.0) ** 2 / variance
    chance = float(stats.chi2.sf(chi_square, 1))
    told = (
        f"{ours.sum():.0f} against {theirs.sum():.0f} of {size.sum():.0f}; chi-square "
        f"{chi_square:.2g}, p = {chance:.2g}"
    )
    rule = (
        f"over all maps the proposed mutation has as often the {sentence.words} as ref12, but for "
        "chance: p of the test of Cochran, Mantel and Haenszel"
    )
    location, fits = f"metric={metric}, all maps", bool(chance >= ALPHA)
    yield build_audit_row(", ".join(tables), location, rule, chance, ALPHA, fits, told)


def correct_by_holm(p: np.ndarray) -> np.ndarray:
    """Correct the p (n,) of a family by Holm's step-down procedure: (n,)."""
    order = np.argsort(p)
    corrected = np.empty(len(p))
    # The running maximum: a larger p is never corrected to a smaller one.
    corrected[order] = np.minimum(np.maximum.accumulate(np.sort(p) * np.arange(len(p), 0, -1)), 1)
    return corrected
