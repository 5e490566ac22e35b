"""What the search for an interpretation found (`analysis.search`): three tables and a section of
the summary.

Columns of interpretations.csv, one row per interpretation, the best first:

- study, interpretation: its changes, such as `O2=0.9, O7=clamp`; `default` without any
- in_words: what the paper's experiment would have been: each choice made, in words, and whether it
  departs from what the paper prints
- confirmed: whether it was a finalist, or the default, which are judged by many runs; only these
  are compared in what follows
- one column per choice: its value, empty for the default
- in_range, numbers: how many of the published numbers lie in range, and of how many
- by_chance: how many would if the printed numbers of one kind were permuted within their table
  (expected value)
- impossible: printed means and extremes below the exact bound of their map under this
  interpretation; with one, it is ruled out
- score: sum of the logarithms of the tables' likelihoods, by which interpretations that are not
  ruled out are compared
- in_range_<table>: in_range by table
- fresh_in_range, fresh_score: those of the best interpretation and of the default by as many runs
  with other seeds, that chose nothing
- tried: in the first row, how many interpretations were tried; of those with one score only the one
  with the fewest choices has a row, and only the best 500 have

Columns of explained.csv, one row per published number, those that no interpretation gives first:
study, table, the table's keys, metric, statistic, value_published; default and best, whether it
lies in range under the default interpretation and under the best one; tried, how many
interpretations of the choices that concern it were tried, and interpretations, in how many of these
it is in range; settings, how many different settings of its methods alone were among them;
missed_by, how far it lies out of range under the interpretation that comes nearest, which is named
by nearest, and so what it would take to explain the number.

Columns of leave_one_table_out.csv, one row per table: the interpretation that is best on all other
tables, and how many of this table's numbers lie in range under that interpretation (`chosen`),
under the default (`default`) and at most (`most`), of how many (`numbers`); the logarithm of the
likelihood of the table under the best interpretation (`score_best`) and under the default
(`score_default`); and, where the paper says that its numbers rise or fall along a column, that of a
straight line there (`score_line`, along `line_along`; see `yardstick`).
"""

import itertools
import math
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis.search_job import Choice

Interpretation = dict[str, Any]

DEFAULT = "default"


class Evaluated(NamedTuple):
    """An interpretation with its numbers, one row each, as from `numbers_of`, and the logarithm of
    the likelihood of each table; resampled: the scores that resampled runs give, if asked for.
    """

    interpretation: Interpretation
    numbers: pd.DataFrame
    likelihoods: dict[str, float]
    resampled: np.ndarray = np.zeros(0)

    @property
    def impossible(self) -> int:
        """Printed numbers that no run could have."""
        return int((~self.numbers["possible"]).sum())

    @property
    def score(self) -> float:
        """Sum of the logarithms of the likelihoods."""
        return sum(self.likelihoods.values())

    @property
    def rank(self) -> tuple[bool, float]:
        """By which interpretations are compared, the higher, the better: whether it is not ruled
        out, and its score.
        """
        return not self.impossible, self.score


def name_of(interpretation: Interpretation) -> str:
    """An interpretation in words."""
    return (
        ", ".join(f"{choice}={value}" for choice, value in sorted(interpretation.items()))
        or DEFAULT
    )


def together(interpretation: Interpretation, parts: list[Evaluated]) -> Evaluated:
    """An interpretation from what is known of its parts, whose numbers follow each other."""
    likelihoods: dict[str, float] = {}
    for each in parts:
        for table, likelihood in each.likelihoods.items():
            likelihoods[table] = likelihoods.get(table, 0.0) + likelihood
    return Evaluated(
        interpretation,
        pd.concat([each.numbers for each in parts], ignore_index=True),
        likelihoods,
        sum(each.resampled for each in parts),
    )


def in_words(interpretation: Interpretation, choices: list[Choice]) -> str:
    """The choices that an interpretation makes, each with what the paper leaves open."""
    made = [
        f"{choice.detail}: {interpretation[choice.id]}"
        + (" (not as printed)" if choice.printed else "")
        for choice in choices
        if choice.id in interpretation
    ]
    return "; ".join(made)


def interpretations_table(
    study: str,
    confirmed: list[Evaluated],
    screened: list[Evaluated],
    tried: int,
    fresh: list[Evaluated],
    choices: list[Choice],
) -> pd.DataFrame:
    """interpretations.csv. confirmed: the default and the finalists, judged by many runs. screened:
    the best of all, of which those confirmed are left out. tried: how many all are. fresh: the
    default and the best finalist, judged by as many runs with other seeds.
    """
    rows, again = [], {name_of(evaluated.interpretation) for evaluated in confirmed}
    rest = [evaluated for evaluated in screened if name_of(evaluated.interpretation) not in again]
    ordered = [
        sorted(given, key=lambda evaluated: evaluated.rank, reverse=True)
        for given in (confirmed, rest)
    ]
    for evaluated in itertools.chain(*ordered):
        numbers = evaluated.numbers
        by_table = numbers.groupby("table")["in_range"].sum()
        name = name_of(evaluated.interpretation)
        rows.append(
            {
                "study": study,
                "interpretation": name,
                "in_words": in_words(evaluated.interpretation, choices),
                "confirmed": name in again,
                **{choice.id: evaluated.interpretation.get(choice.id, "") for choice in choices},
                "in_range": int(numbers["in_range"].sum()),
                "numbers": len(numbers),
                "by_chance": by_chance(numbers),
                "impossible": evaluated.impossible,
                "score": evaluated.score,
                **{f"in_range_{table}": int(count) for table, count in by_table.items()},
            }
        )
    rows[0]["tried"] = tried
    by_name = {row["interpretation"]: row for row in rows}
    for evaluated in fresh:
        by_name[name_of(evaluated.interpretation)] |= {
            "fresh_in_range": int(evaluated.numbers["in_range"].sum()),
            "fresh_score": evaluated.score,
        }
    return pd.DataFrame(rows).astype({"fresh_in_range": "Int64", "tried": "Int64"})


def by_chance(numbers: pd.DataFrame) -> float:
    """Expected count of numbers in range if those of the same table, metric and statistic were
    permuted.
    """
    expected = 0.0
    for _, group in numbers.groupby(["table", "metric", "statistic"], sort=False):
        values = group["value_published"].to_numpy(dtype=float)
        inside = (group["low"].to_numpy()[:, None] <= values) & (
            values <= group["high"].to_numpy()[:, None]
        )
        if len(values) > 1:
            expected += (inside.sum() - np.trace(inside)) / (len(values) - 1)
    return float(expected)


def explained_table(
    study: str, confirmed: list[Evaluated], of_parts: list[list[Evaluated]], shared: set[str]
) -> pd.DataFrame:
    """explained.csv. confirmed: the default first. of_parts: as from the search, in whose order the
    numbers stand. shared: ids of the choices that concern several parts.
    """
    best, default = max(confirmed, key=lambda each: each.rank), confirmed[0]
    described = default.numbers.drop(columns=["low", "high", "in_range", "possible"])
    explained_by = {
        "default": default.numbers["in_range"].to_numpy(),
        "best": best.numbers["in_range"].to_numpy(),
    }
    parts = []
    for tried in of_parts:
        settings_made = [
            {choice: each.interpretation[choice] for choice in each.interpretation.keys() - shared}
            for each in tried
        ]
        missed = np.array([_missed(each.numbers) for each in tried])
        least, nearest = missed.min(axis=0), missed.argmin(axis=0)
        columns = {
            "interpretations": np.sum(
                [each.numbers["in_range"].to_numpy(dtype=int) for each in tried], axis=0
            ),
            "tried": len(tried),
            "settings": len(set(map(name_of, settings_made))),
            "missed_by": np.where(np.isinf(least), np.nan, least),
            "nearest": [name_of(tried[place].interpretation) for place in nearest],
        }
        parts.append(pd.DataFrame(columns))
    told = pd.concat(parts).set_index(described.index)
    table = described.assign(study=study, **explained_by, **told)[
        ["study", *described.columns, *explained_by, *told]
    ]
    return table.sort_values("interpretations", kind="stable")


def _missed(numbers: pd.DataFrame) -> np.ndarray:
    """By how much printed numbers (n,) miss the range of what would be printed, each in its unit;
    infinite where nothing would be.
    """
    value = numbers["value_published"].to_numpy(dtype=float)
    below, above = numbers["low"].to_numpy() - value, value - numbers["high"].to_numpy()
    missed = np.maximum(np.maximum(below, above), 0.0)
    return np.where(np.isnan(missed), np.inf, missed)


def leave_one_table_out_table(
    study: str, confirmed: list[Evaluated], lines: dict[str, tuple[str, float]]
) -> pd.DataFrame:
    """leave_one_table_out.csv. confirmed: the default first. lines: of some tables, along which
    column a line is laid, and how likely it makes them (`yardstick`).
    """
    rows, best = [], max(confirmed, key=lambda each: each.rank)
    for table in confirmed[0].likelihoods:
        counts = [
            int(each.numbers.loc[each.numbers["table"] == table, "in_range"].sum())
            for each in confirmed
        ]
        others = [(each.rank[0], each.score - each.likelihoods[table]) for each in confirmed]
        chosen = max(range(len(confirmed)), key=lambda n: others[n])
        numbers = int((confirmed[0].numbers["table"] == table).sum())
        along, score = lines.get(table, ("", math.nan))
        rows.append(
            {
                "study": study,
                "table": table,
                "interpretation": name_of(confirmed[chosen].interpretation),
                "chosen": counts[chosen],
                "default": counts[0],
                "most": max(counts),
                "numbers": numbers,
                "score_best": best.likelihoods[table],
                "score_default": confirmed[0].likelihoods[table],
                "score_line": score,
                "line_along": along,
            }
        )
    return pd.DataFrame(rows)


def yardstick(published: pd.DataFrame, along: str) -> float:
    """How likely printed numbers are by a straight line alone: the logarithm of the likelihood of
    each, as predicted from the others of its row by least squares, summed. No interpretation
    explains numbers that it does not make more likely than this.

    published: as from `comparison.read_published`. along: the column that the line runs along. Rows
    with fewer than four numbers, which leave no degree of freedom to predict one from, and seconds
    are left out.
    """
    from scipy.stats import t

    keys = [key for key in published.columns[: published.columns.get_loc("metric")] if key != along]
    total = 0.0
    for _, row in published[published["unit"] != "s"].groupby(
        [*keys, "metric", "statistic"], sort=False
    ):
        if len(row) < 4:
            continue
        x, y = row[along].to_numpy(dtype=float), row["value"].to_numpy(dtype=float)
        for left_out in range(len(row)):
            rest = np.arange(len(row)) != left_out
            design = np.column_stack([np.ones(rest.sum()), x[rest]])
            line, *_ = np.linalg.lstsq(design, y[rest], rcond=None)
            freedom = rest.sum() - 2
            variance = ((y[rest] - design @ line) ** 2).sum() / freedom
            at = np.array([1.0, x[left_out]])
            spread = math.sqrt(
                max(
                    variance * (1 + at @ np.linalg.solve(design.T @ design, at)),
                    (1e-3 * y[left_out]) ** 2,
                )
            )
            total += float(t.logpdf(y[left_out], freedom, at @ line, spread))
    return total


def section(
    interpretations: pd.DataFrame,
    explained: pd.DataFrame,
    leave_one_table_out: pd.DataFrame,
    titles: dict[str, str],
) -> list[str]:
    """Paragraphs of the summary: a heading, what is compared, and a few sentences for each study;
    none without rows.

    interpretations, explained, leave_one_table_out: the three tables, of all studies. titles: of
    the studies, by name.
    """
    if interpretations.empty:
        return []
    parts = [
        "## Interpretations that explain the printed numbers",
        "An interpretation fills in the details that a paper leaves open. Each one is scored by "
        "the joint likelihood of the printed numbers among what experiments of the paper's size "
        "would print. A search judges many by few runs. Those that may be the best, given the "
        "error of their scores, are finalists: 1,000 runs with new seeds choose among them, and "
        "the chosen one is judged again by 1,000 runs that chose nothing. A number is in range if "
        "it lies in the central 95 % of these. An interpretation whose runs vary widely excludes "
        "nothing, so each count is given with the one expected by chance, if printed numbers of "
        "one kind are permuted within their table. Numbers of a quantity that the paper does not "
        "define have no vote. `<study>_interpretations.csv` has a row for each interpretation, "
        "`<study>_explained.csv` for each printed number, `<study>_leave_one_table_out.csv` for "
        "each table.",
    ]
    for study, own in interpretations.groupby("study", sort=False):
        others = (table[table["study"] == study] for table in (explained, leave_one_table_out))
        parts.append(f"**{titles[study]}.** {sentences(own, *others)}")
    return parts


def brief(interpretations: pd.DataFrame) -> pd.DataFrame:
    """One row for each study, in a few words: the most likely interpretation, and what it explains
    beside the default.

    interpretations: the tables of all studies.
    """
    rows = {}
    for study, own in interpretations.groupby("study", sort=False):
        best, default = own.iloc[0], own[own["interpretation"] == DEFAULT].iloc[0]
        named = _named(best)
        ratio = "impossible" if default["impossible"] else _times(_gain(best, default))
        rows[study] = {
            "most likely interpretation": named,
            "numbers in range": f"{best['in_range']} of {best['numbers']}",
            "with new seeds": f"{best['fresh_in_range']:.0f}",
            "by chance": f"{best['by_chance']:.0f}",
            "default in range": f"{default['in_range']}",
            "likelihood over the default's": "1" if named == "the default" else ratio,
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("study")


def _named(best: pd.Series) -> str:
    """The most likely interpretation, by its distance from the default."""
    if best["impossible"]:
        return "none is possible"
    if best["interpretation"] == DEFAULT:
        return "the default"
    choices = len(best["interpretation"].split(", "))
    return f"{choices} {'choice differs' if choices == 1 else 'choices differ'} from the default"


def sentences(
    interpretations: pd.DataFrame, explained: pd.DataFrame, leave_one_table_out: pd.DataFrame
) -> str:
    """The verdict, from the tables of one study."""
    best, default = (
        interpretations.iloc[0],
        interpretations[interpretations["interpretation"] == DEFAULT].iloc[0],
    )
    told = [
        _most_likely(best, default),
        _judged_anew(best),
        "" if best["interpretation"] == DEFAULT else _by_table(leave_one_table_out),
        _beside_a_line(leave_one_table_out),
        _never(explained),
        _searched(explained),
        _ruled_out(interpretations),
        _leave_one_table_out(leave_one_table_out),
    ]
    return " ".join(filter(None, told))


def _most_likely(best: pd.Series, default: pd.Series) -> str:
    """Which experiment the numbers are most likely from, and how much more likely than from the
    default.
    """
    tried = f"{int(best['tried']):,}"
    if best["impossible"]:
        return f"Under each of {tried} interpretations some printed number is impossible."
    if best["interpretation"] == DEFAULT:
        return (
            "The printed numbers are most likely from the experiment of the default "
            f"interpretation: none of {tried} interpretations is more likely. It has "
            f"{_counted(default)}."
        )
    level = (
        ": it explains their level, not how they differ"
        if best["in_range"] <= best["by_chance"] + 0.5
        else ""
    )
    against = (
        "under the default, some printed number is impossible"
        if default["impossible"]
        else _ratio(best, default)
    )
    return (
        f"Of {tried} interpretations, the printed numbers are most likely from an experiment in "
        f"which these choices differ from ours: {best['in_words']} ({best['interpretation']}); "
        f"{against}. It has {_counted(best)}{level}; the default has {_counted(default)}."
    )


def _judged_anew(best: pd.Series) -> str:
    """Whether the best interpretation keeps its score by runs that did not choose it."""
    if best["impossible"]:
        return ""
    return (
        f"Judged again by runs with new seeds, it has {best['fresh_in_range']:.0f} of "
        f"{best['numbers']} in range and a log-likelihood of "
        f"{best['fresh_score']:.1f} (by the runs that chose it, {best['score']:.1f})."
    )


def _ratio(best: pd.Series, default: pd.Series) -> str:
    """How much more likely than under the default interpretation the numbers are."""
    difference = _gain(best, default)
    return (
        "log-likelihood ratio against the default, by runs that chose neither, "
        f"{difference:+.1f} ({_times(difference)} as likely)"
    )


def _gain(best: pd.Series, default: pd.Series) -> float:
    """What the best interpretation gains in log-likelihood over the default, by runs that did not
    choose it.
    """
    return best["fresh_score"] - default["fresh_score"]


def _counted(row: pd.Series) -> str:
    """How many numbers are in range under an interpretation."""
    return (
        f"{row['in_range']} of {row['numbers']} numbers in range ({row['by_chance']:.0f} by chance)"
    )


def _by_table(leave_one_table_out: pd.DataFrame) -> str:
    """Which tables gain by the best interpretation, and which lose."""
    gains = leave_one_table_out.assign(
        gain=leave_one_table_out["score_best"] - leave_one_table_out["score_default"]
    ).sort_values("gain", ascending=False)
    if len(gains) < 2:
        return ""
    named = ", ".join(f"{row.table} {row.gain:+.1f}" for row in gains.itertuples())
    return f"By table, by the runs that chose it, it gains {named}."


def _beside_a_line(leave_one_table_out: pd.DataFrame) -> str:
    """The best interpretation beside a description that explains nothing."""
    told = leave_one_table_out[leave_one_table_out["score_line"].notna()]
    if told.empty:
        return ""
    along = " and ".join(dict.fromkeys(told["line_along"]))
    difference = told["score_best"].sum() - told["score_line"].sum()
    verdict = (
        "so the interpretation describes them worse than a line that explains nothing"
        if difference < 0
        else "so the interpretation describes them better than such a line"
    )
    return (
        f"A straight line in the column {along}, which predicts each number from the others of its "
        f"row, has a log-likelihood {abs(difference):.1f} {'above' if difference < 0 else 'below'} "
        f"that of the most likely interpretation: {verdict}."
    )


def _never(explained: pd.DataFrame) -> str:
    """Which numbers no interpretation explains, by table and method."""
    never = explained[
        (explained["interpretations"] == 0) & ~explained[["default", "best"]].any(axis=1)
    ]
    if never.empty:
        return "Each number is in range under some interpretation."
    keys = ["table", "method"] if "method" in never else ["table"]
    counts = never.groupby(keys, sort=False).size()
    named = ", ".join(
        f"{count} of {' for '.join(map(str, key if isinstance(key, tuple) else (key,)))}"
        for key, count in counts.items()
    )
    share = (never["missed_by"] / never["value_published"].abs()).median()
    nearest = (
        ""
        if math.isnan(share)
        else f" The nearest misses them by {100 * share:.2g} % of their value (median)."
    )
    return f"No interpretation explains {len(never)} of the numbers: {named}.{nearest}"


def _searched(explained: pd.DataFrame) -> str:
    """How widely each method was tried."""
    if "method" not in explained:
        return ""
    settings = explained.groupby("method", sort=True)["settings"].max()
    if settings.nunique() == 1:
        return f"Each method was tried under {settings.iloc[0]} different settings of its own."
    return (
        "Number of settings tried for each method alone: "
        f"{', '.join(f'{method} {count}' for method, count in settings.items())}."
    )


def _ruled_out(interpretations: pd.DataFrame) -> str:
    """How many interpretations are impossible."""
    ruled_out = int((interpretations["impossible"] > 0).sum())
    if not ruled_out:
        return ""
    return (
        f"{ruled_out} of {len(interpretations)} interpretations "
        f"{'is' if ruled_out == 1 else 'are'} ruled out: under "
        f"{'it' if ruled_out == 1 else 'them'} a printed mean or extreme lies below the exact "
        "bound of its map."
    )


def _leave_one_table_out(leave_one_table_out: pd.DataFrame) -> str:
    """Whether the tables that an interpretation was not chosen on agree with it."""
    if len(leave_one_table_out) < 2:
        return ""
    return (
        "Chosen for each table on the others alone, interpretations bring "
        f"{leave_one_table_out['chosen'].sum()} into range, the default "
        f"{leave_one_table_out['default'].sum()}: {_advice(leave_one_table_out)}."
    )


def _times(difference: float) -> str:
    """A ratio of likelihoods in words, from the difference of their logarithms."""
    power = difference / math.log(10)
    return f"{10**power:.1f} times" if power < 2 else f"10^{power:.0f} times"


def _advice(leave_one_table_out: pd.DataFrame) -> str:
    """Whether the tables that an interpretation was not chosen on speak for a change of the
    default.
    """
    worse = leave_one_table_out[leave_one_table_out["chosen"] < leave_one_table_out["default"]]
    against = ", ".join(
        f"{row.table} ({row.chosen} instead of {row.default})" for row in worse.itertuples()
    )
    if len(worse):
        return f"left out, {against} {'speaks' if len(worse) == 1 else 'speak'} against a change"
    better = (leave_one_table_out["chosen"] > leave_one_table_out["default"]).any()
    return f"the tables left out {'agree with a change' if better else 'do not tell them apart'}"
