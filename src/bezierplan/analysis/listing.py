"""Tables without runs: what a paper prints besides its results, what a study's function computes,
and published numbers next to ours.
"""

from collections.abc import Callable, Mapping

import pandas as pd

from bezierplan.analysis.results import published_table, select
from bezierplan.analysis.table_kinds import Comparison, FunctionTable, Transcribed

# What a table of kind `comparison` shows next to the keys: columns of `comparison.compare`, and
# their headings.
_SHOWN = {
    "metric": "metric",
    "statistic": "statistic",
    "n_published": "runs of the paper",
    "value_published": "published",
    "n_ours": "our runs",
    "value_ours": "ours",
    "value_ours_scaled": "ours at the paper's number of runs",
    "low95_predicted": "95 % prediction interval, from",
    "high95_predicted": "to",
    "quantile_published": "quantile of the published",
    "in_range": "within",
    "verdict": "verdict",
    "why": "why inconclusive",
}
_DECIMALS = 3


def table(
    spec: Transcribed | FunctionTable | Comparison,
    files: Mapping[str, str],
    functions: Mapping[str, Callable[..., pd.DataFrame]],
    labels: Mapping[str, str],
) -> pd.DataFrame:
    """A transcribed table (every cell as written), that of a function (called with all published
    tables by file name, and with its arguments), or a comparison (`beside`).

    files: of published numbers, by table; for a transcribed table its only file; for a comparison
    those of its tables.
    """
    if isinstance(spec, Transcribed):
        (file,) = files.values()
        return pd.read_csv(file, dtype=str, keep_default_na=False)
    if isinstance(spec, Comparison):
        return beside(spec, {name: pd.read_csv(file) for name, file in files.items()}, labels)
    published = {name: published_table(file) for name, file in files.items()}
    return functions[spec.function](published, **spec.arguments)


def beside(
    spec: Comparison, comparisons: dict[str, pd.DataFrame], labels: Mapping[str, str]
) -> pd.DataFrame:
    """Published numbers of several tables next to ours, with prediction intervals for experiments
    of the paper's size.

    comparisons: as from `comparison.compare`, by table; the `where` of the spec holds for those
    that have the column. labels: how names are printed.
    """
    shown = []
    for name, rows in comparisons.items():
        keys = rows.columns[: rows.columns.get_loc("metric")].to_list()
        where = {key: value for key, value in spec.where.items() if key in keys}
        rows = select(rows[rows["value_published"].notna()], where | {"metric": spec.metrics})
        shown.append(rows[[*keys, *_SHOWN]].assign(table=name))
    table = pd.concat(shown, ignore_index=True)
    keys = [column for column in table.columns if column not in (*_SHOWN, "table")]
    for key in (*keys, "metric"):
        table[key] = [
            labels.get(value, value) if isinstance(value, str) else value for value in table[key]
        ]
    counted = table.select_dtypes("float").columns.difference(["quantile_published"])
    table = table.round(dict.fromkeys([*counted, "quantile_published"], _DECIMALS))
    return table[["table", *keys, *_SHOWN]].rename(columns=_SHOWN)
