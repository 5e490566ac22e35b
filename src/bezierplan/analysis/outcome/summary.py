"""All studies together: every published number next to ours, and every claim."""

import itertools
from collections.abc import Iterable, Mapping

import numpy as np
import pandas as pd

from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.numbers import comparison


def gather(
    comparison_files: Mapping[tuple[str, str], str], claims_files: Iterable[str]
) -> dict[str, pd.DataFrame]:
    """Gather the tables of all studies by name: `numbers` and `claims`.

    comparison_files: by study and table. claims_files: of the studies that have any.
    """
    claims = [pd.read_csv(file) for file in claims_files]
    # Readers select by these columns, which without a row would be of no type.
    none = pd.DataFrame(columns=COLUMNS_OF["claims"]).astype({"primary": bool, "finding": bool})
    return {
        "numbers": list_numbers(
            {name: pd.read_csv(file) for name, file in comparison_files.items()}
        ),
        "claims": pd.concat(claims, ignore_index=True) if claims else none,
    }


def list_numbers(comparisons: dict[tuple[str, str], pd.DataFrame]) -> pd.DataFrame:
    """List every row of comparisons that has a published number, in their order.

    comparisons: (study, table) -> `comparison.compare`. Columns: study, table, counted (the row
    has a range, and adds information: `_is_counted`), then the others of the
    comparisons, key columns first.
    """
    frames = [
        frame.drop(columns=comparison.PLACES, errors="ignore").assign(study=study, table=table)
        for (study, table), frame in comparisons.items()
    ]
    everything = pd.concat(frames, ignore_index=True)
    first = ["study", "table"]
    last = everything.columns[everything.columns.get_loc("metric") :].difference(first, sort=False)
    keys = list(everything.columns.difference([*first, *last], sort=False))
    everything["counted"] = _is_counted(everything, keys)
    return everything[[*first, "counted", *keys, *last]]


def _is_counted(numbers: pd.DataFrame, keys: list[str]) -> np.ndarray:
    """Return which rows (n,), numbered from 0, count in the denominator.

    They have a range. Left out are numbers that are impossible on any map,
    repetitions of a number in another table, and the last of several counts that add up to the
    number of runs.
    """
    # A length below the bound is impossible on our map alone.
    of_map = (
        numbers["metric"].map(lambda metric: isinstance(METRICS[metric].least, str)).astype(bool)
    )
    possible = numbers["possible"].astype("boolean").fillna(True) | of_map
    placed = numbers["position"] != comparison.NO_RANGE
    counted = (placed & possible).to_numpy(dtype=bool)
    same = ["study", "metric", "statistic", "value_published", *({"method"} & set(keys))]
    for _, rows in numbers[counted].groupby(same, dropna=False, sort=False):
        listed = list(rows.iterrows())
        for (_, earlier), (index, row) in itertools.combinations(listed, 2):
            # The first table that prints a number keeps it.
            if earlier["table"] != row["table"] and all(
                pd.isna(one) or pd.isna(other) or one == other
                for one, other in zip(earlier[keys], row[keys])
            ):
                counted[index] = False
    place = ["study", "table", "n_published", *keys]
    counts = numbers[counted & (numbers["statistic"] == "count").to_numpy()]
    for _, rows in counts.groupby(place, dropna=False, sort=False):
        # The last of them follows from the others.
        if len(rows) > 1 and rows["value_published"].sum() == rows["n_published"].iloc[0]:
            counted[rows.index[-1]] = False
    return counted
