"""What the search for a reading found (`analysis.readings`): three tables and a section of the summary.

Columns of readings.csv, one row per reading, the best first:

| column | meaning |
| --- | --- |
| study, reading | its changes, such as `O2=0.9, O7=clamp`; `in force` without any |
| one column per choice | its value, empty for the one in force |
| in_range, numbers | how many of the published numbers lie in range, and of how many |
| by_chance | how many would if each printed number were exchanged with another of its kind in the same table (expected value) |
| impossible | printed means and extremes below the exact bound of their map under this reading; with one, it is ruled out |
| score | sum of the logarithms of the tables' likelihoods, by which readings that are not ruled out are compared |
| in_range_<table> | the same by table |

Columns of explained.csv, one row per published number, those that no reading gives first: study, table, the table's keys, metric,
statistic, value_published; in_force and best, whether it lies in range under the reading in force and under the best one; readings, under
how many of those tried.

Columns of held_out.csv, one row per table: the reading that is best on all other tables, and how many of this table's numbers lie in range
under that reading (`chosen`), under the one in force (`in_force`) and at most (`most`), of how many (`numbers`).
"""

import math
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

Reading = dict[str, Any]

IN_FORCE = "in force"


class Evaluated(NamedTuple):
    """A reading with its numbers, one row each, as from `numbers_of`, and the logarithm of the likelihood of each table."""

    reading: Reading
    numbers: pd.DataFrame
    likelihoods: dict[str, float]

    @property
    def impossible(self) -> int:
        """Printed numbers that no run could have."""
        return int((~self.numbers["possible"]).sum())

    @property
    def rank(self) -> tuple[bool, float]:
        """By which readings are compared, the higher, the better: whether it is not ruled out, and its score."""
        return not self.impossible, sum(self.likelihoods.values())


def name_of(reading: Reading) -> str:
    """A reading in words."""
    return ", ".join(f"{choice}={value}" for choice, value in sorted(reading.items())) or IN_FORCE


def readings_table(study: str, tried: list[Evaluated], choices: list[dict]) -> pd.DataFrame:
    """readings.csv."""
    rows = []
    for each in sorted(tried, key=lambda each: each.rank, reverse=True):
        numbers = each.numbers
        by_table = numbers.groupby("table")["in_range"].sum()
        rows.append(
            {"study": study, "reading": name_of(each.reading)}
            | {choice["id"]: each.reading.get(choice["id"], "") for choice in choices}
            | {"in_range": int(numbers["in_range"].sum()), "numbers": len(numbers), "by_chance": by_chance(numbers)}
            | {"impossible": each.impossible, "score": sum(each.likelihoods.values())}
            | {f"in_range_{table}": int(count) for table, count in by_table.items()}
        )
    return pd.DataFrame(rows)


def by_chance(numbers: pd.DataFrame) -> float:
    """Expected count of numbers in range if each were exchanged with another of the same table, metric and statistic."""
    expected = 0.0
    for _, group in numbers.groupby(["table", "metric", "statistic"], sort=False):
        values = group["value_published"].to_numpy(dtype=float)
        inside = (group["low"].to_numpy()[:, None] <= values) & (values <= group["high"].to_numpy()[:, None])
        if len(values) > 1:
            expected += (inside.sum() - np.trace(inside)) / (len(values) - 1)
    return float(expected)


def explained_table(study: str, tried: list[Evaluated]) -> pd.DataFrame:
    """explained.csv."""
    best, in_force = max(tried, key=lambda each: each.rank), tried[0]
    described = in_force.numbers.drop(columns=["low", "high", "in_range", "possible"])
    counts = np.sum([each.numbers["in_range"].to_numpy(dtype=int) for each in tried], axis=0)
    found = {"in_force": in_force.numbers["in_range"].to_numpy(), "best": best.numbers["in_range"].to_numpy(), "readings": counts}
    table = described.assign(study=study, **found)[["study", *described.columns, *found]]
    return table.sort_values("readings", kind="stable")


def held_out_table(study: str, tried: list[Evaluated]) -> pd.DataFrame:
    """held_out.csv."""
    rows = []
    for table in tried[0].likelihoods:
        own = [int(each.numbers.loc[each.numbers["table"] == table, "in_range"].sum()) for each in tried]
        others = [(each.rank[0], each.rank[1] - each.likelihoods[table]) for each in tried]
        chosen = max(range(len(tried)), key=lambda n: others[n])
        numbers = int((tried[0].numbers["table"] == table).sum())
        row = {"study": study, "table": table, "reading": name_of(tried[chosen].reading), "chosen": own[chosen]}
        rows.append(row | {"in_force": own[0], "most": max(own), "numbers": numbers})
    return pd.DataFrame(rows)


def section(readings: pd.DataFrame, explained: pd.DataFrame, held_out: pd.DataFrame, titles: dict[str, str]) -> list[str]:
    """Paragraphs of the summary: a heading, what is compared, and a few sentences for each study; none without rows.

    readings, explained, held_out: the three tables, of all studies. titles: of the studies, by name.
    """
    if readings.empty:
        return []
    parts = [
        "## Readings that explain the printed numbers",
        "What a paper leaves open is varied together, and each such reading is scored by the joint likelihood of the printed numbers. How "
        "many lie in the central 95 % of what experiments of the paper's size would print is shown, too; but a reading whose runs vary "
        "widely refuses nothing, so beside it stands how many would if printed numbers were exchanged. Numbers of a quantity that the "
        "paper does not define have no vote. `<study>_readings.csv` has a row for each reading, `<study>_explained.csv` for each printed "
        "number, `<study>_held_out.csv` for each table.",
    ]
    for study, own in readings.groupby("study", sort=False):
        parts.append(f"**{titles[study]}.** {sentences(own, *(each[each['study'] == study] for each in (explained, held_out)))}")
    return parts


def sentences(readings: pd.DataFrame, explained: pd.DataFrame, held_out: pd.DataFrame) -> str:
    """What follows from the tables of one study."""
    best = readings.iloc[0]
    in_force = readings[readings["reading"] == IN_FORCE].iloc[0]
    never = explained[explained["readings"] == 0]
    parts = [f"No reading gives {_by_table(never)}." if len(never) else "Each number is in range under some reading."]
    parts.append(
        f"Of {in_force['numbers']} numbers, {in_force['in_range']} are in range under the reading in force; {in_force['by_chance']:.0f} "
        "would be if numbers of one kind in one table were exchanged."
    )
    ruled_out = int((readings["impossible"] > 0).sum())
    if ruled_out:
        parts.append(
            f"{ruled_out} of {len(readings)} readings {'is' if ruled_out == 1 else 'are'} ruled out: under "
            f"{'it' if ruled_out == 1 else 'them'} a printed mean or extreme lies below the exact bound of its map."
        )
    if best["reading"] == IN_FORCE:
        parts.append(f"None of {len(readings)} readings is more likely.")
    else:
        level = ": it explains their level, not how they differ" if best["in_range"] <= best["by_chance"] + 0.5 else ""
        parts.append(
            f"The most likely of {len(readings)} readings, {best['reading']}, has a likelihood {_times(best['score'] - in_force['score'])} "
            f"that of the one in force, and brings {best['in_range']} into range ({best['by_chance']:.0f} when exchanged{level})."
        )
    if len(held_out) > 1:
        parts.append(
            f"Chosen for each table on the others alone, readings bring {held_out['chosen'].sum()}, that in force "
            f"{held_out['in_force'].sum()}: {_advice(held_out)}."
        )
    return " ".join(parts)


def _times(difference: float) -> str:
    """A ratio of likelihoods in words, from the difference of their logarithms."""
    power = difference / math.log(10)
    return f"{10**power:.1f} times" if power < 2 else f"10^{power:.0f} times"


def _by_table(never: pd.DataFrame) -> str:
    """How many numbers no reading gives, by table."""
    counts = never.groupby("table", sort=False).size()
    return f"{len(never)} of the numbers ({', '.join(f'{count} of {table}' for table, count in counts.items())})"


def _advice(held_out: pd.DataFrame) -> str:
    """Whether the tables that a reading was not chosen on speak for a change of what is in force."""
    worse = held_out[held_out["chosen"] < held_out["in_force"]]
    against = ", ".join(f"{row.table} ({row.chosen} instead of {row.in_force})" for row in worse.itertuples())
    if len(worse):
        return f"held out, {against} {'speaks' if len(worse) == 1 else 'speak'} against a change"
    better = (held_out["chosen"] > held_out["in_force"]).any()
    return f"the tables held out {'agree with a change' if better else 'do not tell them apart'}"
