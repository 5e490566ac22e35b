"""Rules that printed numbers should obey, as a study's file `published/rules.csv` lists them.

| column | meaning |
| --- | --- |
| item, place, rule | table, cell and rule, as the audit shows them |
| cell | the numbers that are added and compared; left out: the place |
| relation | how they should compare: <, <=, ==, >= or > |
| limit | with what, or by what factor with that of `of` |
| of | the numbers that are added for the limit; left out: none |

A cell is `column=value, ...` of the item, or of another table that stands before it, as in
`table6: method=ga`; values between which | stands are all meant.
"""

import re

import pandas as pd

from bezierplan.analysis.audit.rows import compare_with_limit, merge_rows


def check_rules(published: dict[str, pd.DataFrame]) -> list[dict]:
    """Check the rules that a study's file lists, and return the rows of the audit;
    none without such a file.

    published: tables of printed numbers, by file name, with the rules.
    """
    if "rules" not in published:
        return []
    # A rule may leave these out: its cell is then its place, and the factor 1.
    rules = published["rules"].fillna({"cell": "", "of": "", "limit": 1.0})
    return merge_rows(
        compare_with_limit(
            rule.item,
            rule.place,
            rule.rule,
            _sum_cells(published, rule.item, rule.cell or rule.place),
            rule.relation,
            rule.limit * (_sum_cells(published, rule.item, rule.of) if rule.of else 1),
        )
        for rule in rules.itertuples()
    )


def _sum_cells(published: dict[str, pd.DataFrame], item: str, cell: str) -> float:
    """Sum the printed numbers that a cell names."""
    table, _, columns = cell.rpartition(": ")
    rows = published[table or item]
    for column, values in re.findall(r"(\w+)=([^,]+)", columns):
        rows = rows[rows[column].astype(str).isin(values.split("|"))]
    return float(rows["value"].sum())
