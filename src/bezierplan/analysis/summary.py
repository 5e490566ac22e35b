"""All studies together: every published number next to ours, every claim, and how many of them are confirmed."""

import numpy as np
import pandas as pd

from bezierplan.analysis import explained, worth
from bezierplan.analysis.claims.judge import CLAIM_COLUMNS
from bezierplan.analysis.claims.verdicts import VERDICTS
from bezierplan.analysis.metrics import METRICS

HEADING = "# Outcome at scale "
NUMBERS = ("identified", "reproduced", "not told apart", "cannot fail", "not reproduced")


def read_claims(files: list[str]) -> pd.DataFrame:
    """The claims of all studies, from the files of those that have any."""
    tables = [pd.read_csv(file) for file in files]
    return (
        pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=CLAIM_COLUMNS).astype({"primary": bool, "finding": bool})
    )


def numbers(
    comparisons: dict[tuple[str, str], pd.DataFrame], variants: dict[str, list[str]], deciding: dict[tuple[str, str], dict] | None = None
) -> pd.DataFrame:
    """Every row of comparisons that has a published number.

    comparisons: (study, table) -> `comparison.compare`. variants: study -> its methods that are another reading of a published one.
    deciding: (study, table) -> column -> the value whose rows are the primary reading. Columns: study, table, primary (the row is not
    another reading), counted (it is primary, can be judged, and adds information: `_counted`), then those of the comparisons, key columns
    first.
    """
    frames = []
    for (study, table), frame in comparisons.items():
        printed = frame[frame["value_published"].notna()]
        primary = pd.Series(True, index=printed.index)
        if "method" in printed:
            primary &= ~printed["method"].isin(variants[study])
        for column, value in (deciding or {}).get((study, table), {}).items():
            primary &= printed[column] == value
        frames.append(printed.assign(study=study, table=table, primary=primary))
    everything = pd.concat(frames, ignore_index=True)
    last = list(everything.columns[everything.columns.get_loc("metric") :].drop(["study", "table", "primary"], errors="ignore"))
    keys = [column for column in everything.columns if column not in last and column not in ("study", "table", "primary")]
    everything = everything.assign(counted=_counted(everything, keys))
    return everything[["study", "table", "primary", "counted", *keys, *last]]


def _counted(numbers: pd.DataFrame, keys: list[str]) -> np.ndarray:
    """Which rows (n,) count in the denominator: those that are primary and judged, except numbers that are impossible on any map,
    repetitions of a number in another table, and the last of several counts that add up to the number of runs.
    """
    # A length below the bound is impossible on our map alone.
    of_map = numbers["metric"].map(lambda metric: isinstance(METRICS[metric].least, str)).astype(bool)
    possible = numbers["possible"].astype("boolean").fillna(True) | of_map
    counted = (numbers["primary"] & numbers["reproduced"].notna() & possible).to_numpy(dtype=bool)
    same = ["study", "metric", "statistic", "value_published", *({"method"} & set(keys))]
    for _, rows in numbers[counted].groupby(same, dropna=False, sort=False):
        for n, (index, row) in enumerate(rows.iterrows()):
            earlier = rows.iloc[:n]
            if any(each["table"] != row["table"] and _same_place(each, row, keys) for _, each in earlier.iterrows()):
                counted[numbers.index.get_loc(index)] = False
    place = ["study", "table", "n_published", *keys]
    counts = numbers[counted & (numbers["statistic"] == "count").to_numpy()]
    for _, rows in counts.groupby(place, dropna=False, sort=False):
        if len(rows) > 1 and rows["value_published"].sum() == rows["n_published"].iloc[0]:
            counted[numbers.index.get_loc(rows.index[-1])] = False
    return counted


def _same_place(one: pd.Series, other: pd.Series, keys: list[str]) -> bool:
    """Whether two rows have the same key columns as far as both have them."""
    return all(one[key] == other[key] for key in keys if not (pd.isna(one[key]) or pd.isna(other[key])))


def outcome(numbers: pd.DataFrame, claims: pd.DataFrame) -> pd.DataFrame:
    """One row per study: the published numbers that count, in total and by verdict of the test (`comparison`), and claims by verdict.

    numbers: as from `numbers`. claims: as from `claims.judge`. Only primary readings and variants count.
    """
    judged = numbers[numbers["counted"]]
    deciding = claims[claims["primary"] & ~claims["finding"].astype(bool)]
    verdicts = pd.crosstab(deciding["study"], deciding["verdict"]).reindex(columns=VERDICTS, fill_value=0)
    counts = pd.crosstab(judged["study"], judged["verdict"]).reindex(columns=NUMBERS, fill_value=0)
    counts.insert(0, "numbers", counts.sum(axis=1))
    table = counts.join(verdicts, how="outer").fillna(0).astype(int)
    return table.join(_stable(deciding)) if "readings" in deciding else table


def with_readings(claims: pd.DataFrame, tried: pd.DataFrame) -> pd.DataFrame:
    """Claims with one more column after the verdict: `readings`, how many readings agree with it, such as `9 of 12`: the one in force and
    each alternative that was tried and under which the claim is decided; empty for a claim on which none was, and for one that is undecided
    as read here.

    tried: as from `sensitivity.sensitivity`, of all studies.
    """
    tried = tried[tried["changed"].notna()]
    unchanged = (tried["changed"].astype(str) == "False").groupby([tried["study"], tried["claim"]]).agg(["sum", "size"]) + 1
    words = {key: f"{agree} of {total}" for key, agree, total in unchanged.itertuples()}
    readings = [
        words.get((study, identity), "") if primary else "" for study, identity, primary in claims[["study", "id", "primary"]].to_numpy()
    ]
    columns = list(claims)
    columns.insert(columns.index("verdict") + 1, "readings")
    return claims.assign(readings=readings)[columns]


def with_papers_size(claims: pd.DataFrame, full: pd.DataFrame) -> pd.DataFrame:
    """Claims of scale extended with one more column after the verdict: `verdict_papers_size`, that of the same claim at scale full."""
    keys = ["study", "id", "variant"]
    theirs = full[[*keys, "verdict"]].rename(columns={"verdict": "verdict_papers_size"})
    both = claims.merge(theirs, on=keys, how="left", validate="one_to_one")
    columns = list(claims)
    columns.insert(columns.index("verdict") + 1, "verdict_papers_size")
    return both[columns]


def _stable(claims: pd.DataFrame) -> pd.Series:
    """How many of a study's claims have the same verdict under all readings, out of those on which alternatives were tried, as text."""
    tried = claims[claims["readings"].fillna("") != ""]
    agree = tried["readings"].str.split(" of ")
    stable = (agree.str[0] == agree.str[1]).groupby(tried["study"]).agg(["sum", "size"])
    return pd.Series({study: f"{same} of {total}" for study, same, total in stable.itertuples()}, name="stable", dtype=object)


def markdown(table: pd.DataFrame) -> str:
    """A table as markdown, its index first."""
    rows = [[table.index.name or "", *table.columns], ["---"] * (table.shape[1] + 1)]
    rows += [[name, *values] for name, values in zip(table.index, table.to_numpy().tolist(), strict=True)]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows)


def report(
    numbers: pd.DataFrame,
    claims: pd.DataFrame,
    measured: pd.DataFrame,
    titles: dict[str, str],
    scale: str,
    readings: tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame] | None = None,
) -> str:
    """The summary of a scale as markdown: the outcome of each study, what its methods are worth, then its claims with their
    verdicts.

    measured: rows with the columns `worth.COLUMNS`. readings: the tables of `explained`, if the search for readings has been made.
    """
    parts = [
        f"{HEADING}{scale}",
        "`numbers`: published numbers that can be judged and say something new. `identified`: those that are to the last digit the length "
        "of a path that an enumeration finds (`audit.csv` names it). `reproduced`: those within the central 95 % of what our runs give by "
        "chance in an experiment of the paper's size, where that range refuses at least half of the numbers that the paper prints of other "
        "methods in the same place (where it prints none, a number 10 % lower or higher). `not told apart`: within the "
        "range, which refuses fewer of them. `cannot fail`: within the range, which on the printed number's side of ours has no end, or "
        "ends where nothing possible lies beyond. `not reproduced`: outside. The other columns count claims by verdict; our own findings "
        "are not among them. `stable`: claims with the same verdict under every reading of what the paper leaves open, out of those on "
        "which other readings were tried, at the paper's number of runs. `verdict_papers_size`: the verdict from as many runs as the paper "
        "made; `replication_probability`: how often an experiment of that size shows what the claim says. Readings that do not decide are "
        "left out here; `numbers.csv` and `claims.csv` have them.",
        markdown(outcome(numbers, claims)),
        *worth.section(measured, titles),
        *(explained.section(*readings, titles) if readings else []),
    ]
    for study, title in titles.items():
        own = claims[(claims["study"] == study) & claims["primary"]].set_index("id")
        found = own["finding"].astype(bool)
        if not own.empty:
            parts += [f"## {title}", _listed(own[~found])]
        if found.any():
            parts += ["Our own findings, no sentences of the paper:", _listed(own[found])]
    return "\n\n".join(parts) + "\n"


def _listed(claims: pd.DataFrame) -> str:
    """Claims with their verdicts, as markdown."""
    columns = ["statement", "verdict", "verdict_papers_size", "replication_probability", "readings", "holds", "where_it_holds"]
    columns += ["units_to_decide", "published", "effect", "size", "n"]
    shown = claims[[name for name in columns if name in claims]].astype(object).fillna("")
    for column in shown.columns.intersection(["effect", "replication_probability"]):
        shown[column] = [f"{value:.3g}" if isinstance(value, float) else value for value in shown[column]]
    # Read from a file with gaps, whole numbers are floats.
    for column in shown.columns.intersection(["units_to_decide", "n"]):
        shown[column] = [f"{value:.0f}" if isinstance(value, float) else value for value in shown[column]]
    return markdown(shown)


def with_block(text: str, name: str, block: str) -> str:
    """The text with the part between `<!-- name -->` and `<!-- /name -->` replaced. Raises ValueError if there is no such part."""
    begin, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    if not 0 <= text.find(begin) < text.find(end):
        raise ValueError(f"no part between {begin} and {end}")
    return f"{text[: text.find(begin)]}{begin}\n{block}\n{text[text.find(end) :]}"
