"""meledje: an audit of its Tables 2 to 5.

Numbers of equations, sections, tables and figures are the paper's.
"""

import itertools
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bezierplan.analysis.audit import rules
from bezierplan.analysis.audit.rows import build_audit_row, compare_with_limit

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Published

# The counts of `said` that Fisher's exact test compares, its level, and the sign of what counts as
# best.
TESTED = ("optimal", "infeasible")
ALPHA = 0.05
SIGN = {"highest": 1, "lowest": -1}
# Quantities by which environment 2 is said to confirm environment 1, and their words.
RANKED = {"optimal": "optima", "objective": "mean fitness", "cpu_s": "mean solution time"}


def audit(published: "Published") -> list[dict]:
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
            rows += _test_by_fisher(
                tables, trials, others, sentence.quantity, sentence.words, SIGN[sentence.best]
            )
            rows.append(_test_all_maps(tables, trials, sentence.quantity, sentence.words))
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


def _test_by_fisher(
    tables: dict[str, pd.Series],
    trials: dict[str, int],
    others: list[str],
    metric: str,
    words: str,
    sign: int,
) -> list[dict]:
    """Test whether the proposed mutation's count differs from each other one by more than chance.

    sign: 1 if a higher count is better, -1 if a lower one is.
    """
    from scipy import stats

    pairs, apart, p = list(itertools.product(tables, others)), [], []
    for name, other in pairs:
        own, theirs = (tables[name][method, metric] for method in ("proposed", other))
        square = [[count, trials[name] - count] for count in (own, theirs)]
        apart.append(own - theirs)
        p.append(stats.fisher_exact(square).pvalue)
    rule = (
        f"the proposed mutation has the {words} beyond chance: p of Fisher's test, corrected by "
        "Holm"
    )
    return [
        build_audit_row(
            name,
            f"metric={metric}, proposed and {other}",
            rule,
            value,
            ALPHA,
            bool(value < ALPHA and sign * more > 0),
        )
        for (name, other), more, value in zip(pairs, apart, correct_by_holm(np.array(p)).tolist())
    ]


def _test_all_maps(
    tables: dict[str, pd.Series], trials: dict[str, int], metric: str, words: str
) -> dict:
    """Test whether the proposed mutation's counts of all maps together differ from those of ref12
    by more than chance.

    The test of Cochran, Mantel and Haenszel with its correction for continuity, a map a stratum.
    """
    from scipy import stats

    ours, theirs, size = np.array(
        [
            [table["proposed", metric], table["ref12", metric], trials[name]]
            for name, table in tables.items()
        ]
    ).T
    both = ours + theirs
    apart = float((ours - both / 2).sum())
    variance = float((both * (2 * size - both) / (4 * (2 * size - 1))).sum())
    chi_square = max(abs(apart) - 0.5, 0.0) ** 2 / variance
    p = float(stats.chi2.sf(chi_square, 1))
    told = (
        f"{ours.sum():.0f} against {theirs.sum():.0f} of {size.sum():.0f}; chi-square "
        f"{chi_square:.2g}, p = {p:.2g}"
    )
    rule = (
        f"over all maps the proposed mutation has as often the {words} as ref12, but for chance: p "
        "of the test of Cochran, Mantel and Haenszel"
    )
    return build_audit_row(
        ", ".join(tables), f"metric={metric}, all maps", rule, p, ALPHA, bool(p >= ALPHA), told
    )


def correct_by_holm(p: np.ndarray) -> np.ndarray:
    """Correct the p (n,) of a family by Holm's step-down procedure: (n,)."""
    order = np.argsort(p)
    corrected = np.empty(len(p))
    # The running maximum: a larger p is never corrected to a smaller one.
    corrected[order] = np.minimum(np.maximum.accumulate(np.sort(p) * np.arange(len(p), 0, -1)), 1)
    return corrected
