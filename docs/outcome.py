"""The outcome that the repository keeps in docs/outcome and in the README, from the results of two
scales.

Verdicts and numbers are those of scale extended: they are about the methods, not about the papers'
samples. Next to each verdict stands the verdict at the paper's own number of runs, from scale full.
`make outcome` writes it; the site reads it.
"""

import re
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import facts
import numbers_picture
import pandas as pd

from bezierplan.analysis import naming
from bezierplan.analysis.claims import sentences
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.numbers import comparison, methods
from bezierplan.analysis.outcome import headline, texts
from bezierplan.commands import read_studies
from bezierplan.running.inputs import PAPER
from bezierplan.study.definition import Study
from bezierplan.study.evidence import list_settings

RESULTS, FULL = Path("results/extended"), Path("results/full")
KEPT, README = Path("docs/outcome"), Path("README.md")
BLOCK = "outcome"
TABLES = ("numbers.csv", "claims.csv", "methods.csv")
CHECKS, TEXTS = "claim_checks.csv", "texts.csv"
OF_STUDY = ("audit.csv", "claims_by_reading.csv")
"""Of each study: what its printed numbers say alone, and its claims under readings."""
IDENTIFIED_PATHS = "song2016/beyond/identified.png"
PICTURE = """<picture><source media="(max-width: 600px)" srcset="docs/outcome/numbers_tall.png"><img src="docs/outcome/numbers.png" alt="All printed numbers beside our ranges, a strip per table: how many lie inside, and how far from ours they are"></picture>"""  # noqa: E501
METHODS_NOTE = (
    "Least often free (without a collision) first. Excess of free curves (not counted cells) over "
    "the exact shortest path, and time: medians over the problems. The rounded path turns no "
    "tighter than the method's median free path without corners. The method beats it in a problem "
    "if its median path is shorter, or has wider turns than any rounded path can have. A dash: all "
    "paths have corners."
)
ROUNDED_NOTE = (
    "The row of the rounded shortest path, which is not compared with itself, has the turning "
    "radius that it takes if none is asked; where no arc fits, it keeps a corner."
)
CLAIMS_NOTE = (
    "Most claims are tested by several comparisons, such as one for each map. A claim is not about "
    "one map alone, so maps of ours can test it, though not a printed length. By default: as we "
    "read the paper. In quotes: other ways to read it, or to count ([what they "
    "change](../../config/studies/{}/assumptions.yaml)). No effect: the difference is smaller than "
    "our criterion."
)
OPEN = (
    "No paper prints all that its numbers depend on, so a number that our runs miss does not show "
    "that the paper is wrong."
)
RANGE = "Our range holds 95 % of the results if our program repeats the paper's experiment."

TABLES_NOTE = (
    f"{comparison.SIGNS_MEAN}. A number without a sign does not count: it repeats another one, "
    "follows from others, or is a time, of another machine. Impossible: no runs give it, such as a "
    "mean rank below 1, or mean ranks of m methods whose mean is not (m + 1) / 2. A number outside "
    "our range does not show that the paper is wrong, because it does not print all that its "
    "numbers depend on."
)
MARKS = ("\\*", "†", "‡", "§")
"""Beside printed numbers that prove nothing about the paper, one for each reason."""

IDENTIFIED = (
    "Some printed lengths equal lengths that can be calculated without any run: those of paths "
    "through centres of cells (Song 2016, to the last digit), or sums of straight and diagonal "
    "moves with the root of two rounded to 1.414 (Ma 2020, cut to three decimals). Each row gives "
    "the printed number, the closest such length, its cells or moves, and the chance that a number "
    "drawn nearby would match as well. A row for several numbers says how many of them match."
)
LISTED_NOTE = (
    "Some of its lengths are those of [paths that can be listed](identified.md). That tells what "
    "the paper measured, not whether its method finds such paths."
)
MORE = (
    "More: [what the paper leaves open](../../config/studies/{0}/assumptions.yaml), [its maps, "
    "methods and settings](../../config/studies/{0}/experiments.yaml), [its method in plain "
    "Python](../algorithms/{0}.py), [all claims](claims.csv), [all numbers](numbers.csv)."
)


def main() -> None:
    """Write docs/outcome and the README's table. Raises FileNotFoundError for results that
    `make outcome` has not made yet.
    """
    studies = read_studies()
    settings = pd.DataFrame(
        [(key, *row) for key, each in studies.items() for row in list_settings(each)],
        columns=["study", "of", "setting", "value"],
    )
    tables = {
        key: {
            name: (study.tables[name].title, study.tables[name].index, bool(table.identify))
            for name, table in study.find_tables_of_runs().items()
            if table.published
        }
        for key, study in studies.items()
    }
    titles = {key: study.title for key, study in studies.items()}
    shutil.copyfile(RESULTS / IDENTIFIED_PATHS, KEPT / "identified.png")
    copy_tables(titles, settings)
    answers = fill_texts(KEPT, {key: study.verdict_file() for key, study in studies.items()})
    pd.DataFrame(
        [(key, each.title, each.text) for key, each in answers.items()],
        columns=["study", "title", "text"],
    ).to_csv(KEPT / TEXTS, index=False)
    numbers, claims = (pd.read_csv(KEPT / name) for name in TABLES[:2])
    numbers_picture.save(numbers, {key: key for key in titles}, KEPT)
    labels = {key: study.labels for key, study in studies.items()}
    of_problems = pd.read_csv(KEPT / "methods.csv")
    for key, answer in answers.items():
        own_claims, own_numbers, own_problems = (
            each[each["study"] == key] for each in (claims, numbers, of_problems)
        )
        own_problems = own_problems[~own_problems["method"].isin(studies[key].variants())]
        measured = build_methods_table(own_problems, {key: labels[key]})
        page = build_paper_page(
            titles[key],
            answer,
            own_claims,
            studies[key].claims,
            measured,
            own_numbers,
            RESULTS / key,
            tables[key],
        )
        (KEPT / f"{key}.md").write_text(page, encoding="utf-8")
    (KEPT / "identified.md").write_text(build_identified_page(KEPT, studies), encoding="utf-8")
    readme = README.read_text(encoding="utf-8")
    README.write_text(replace_block(readme, BLOCK, build_block(KEPT, labels)), encoding="utf-8")
    if faults := [f"{key}: {line}" for key, each in answers.items() for line in each.faults]:
        raise ValueError("texts of verdict.yaml: " + "; ".join(faults))


def fill_texts(folder: Path, files: Mapping[str, str | None]) -> dict[str, facts.FilledText]:
    """Return the answer to each paper from the tables of a folder. files: by study, if any."""
    return {
        key: facts.fill(texts.read(file), facts.read_outcome_tables(folder, key))
        for key, file in files.items()
        if file
    }


def copy_tables(studies: Iterable[str], settings: pd.DataFrame) -> None:
    """Copy the tables of results into docs/outcome.

    settings: a table of all methods' settings. Raises FileNotFoundError if results are missing.
    """
    KEPT.mkdir(parents=True, exist_ok=True)
    for name in ("numbers.csv", "methods.csv"):
        shutil.copyfile(RESULTS / name, KEPT / name)
    shutil.copyfile(FULL / "numbers.csv", KEPT / "numbers_papers_size.csv")
    for key in studies:
        for name in OF_STUDY:
            shutil.copyfile(RESULTS / key / name, KEPT / f"{key}_{name}")
    claims = add_papers_size(pd.read_csv(RESULTS / "claims.csv"), pd.read_csv(FULL / "claims.csv"))
    claims.to_csv(KEPT / "claims.csv", index=False)
    checks = pd.concat(pd.read_csv(RESULTS / key / CHECKS) for key in studies)
    primary = claims.loc[claims["primary"], ["study", "id", "variant"]]
    checks.merge(primary).to_csv(KEPT / CHECKS, index=False, float_format="%.6g")
    settings.to_csv(KEPT / "settings.csv", index=False)


def build_paper_page(
    title: str,
    answer: facts.FilledText,
    claims: pd.DataFrame,
    declared: Iterable[Claim],
    measured: str,
    numbers: pd.DataFrame,
    folder: Path,
    tables: Mapping[str, tuple[str, list[str], bool]],
) -> str:
    """Return the page of a paper, as markdown: the answer, its main claims, its method beside the
    rounded shortest path, and its tables with the printed number beside ours in each cell.

    claims, numbers: of this paper. declared: its claims in claims.yaml. measured: the table of
    methods. folder: the study's results. tables: name -> title, which columns name the rows, and
    whether some lengths can be listed; for tables with printed numbers.
    """
    heads = {"id": "claim", "statement": "in our words", "verdict": "verdict"}
    heads |= {"where_it_holds": "where it holds, by which criterion of ours, or why that is open"}
    main = claims[claims["primary"] & claims["main"].astype(bool)]
    by_id = {claim.id: claim for claim in declared}
    main["where_it_holds"] = [
        describe_where_or_why(row, by_id[row["id"]]) for row in main.to_dict("records")
    ]
    main = main[[*heads]]
    parts = [
        f"# {title}",
        f"**{answer.title}.** {answer.text}",
        "## What abstract and conclusion claim",
        write_table(main.rename(columns=heads).set_index("claim")),
        CLAIMS_NOTE.format(folder.name),
        "## Its methods beside the exact shortest path with rounded corners",
        measured,
        "## Its tables",
        MORE.format(folder.name),
        TABLES_NOTE,
    ]
    for name, (table_title, index, is_listed) in tables.items():
        ours = pd.read_csv(folder / PAPER / f"{name}.csv", dtype=str, keep_default_na=False)
        laid = pd.read_csv(folder / PAPER / f"{name}.comparison.csv", dtype={"as_printed": str})
        own = numbers[numbers["table"] == name]
        told, marks = mark_worthless(own[own["position"] != comparison.NO_RANGE])
        # Both list the printed numbers in the same order.
        laid = laid.dropna(subset="table_row").assign(counted=own["counted"].to_numpy(), mark="")
        laid.loc[laid["position"] != comparison.NO_RANGE, "mark"] = marks
        parts += [
            f"### {naming.format_heading(name)}: {table_title}",
            *told,
            *([LISTED_NOTE] if is_listed else []),
            write_table(_place_beside(ours, laid, index)),
        ]
    return "\n\n".join(parts) + "\n"


def mark_worthless(numbers: pd.DataFrame) -> tuple[list[str], list[str]]:
    """Return sentences on why numbers of a table prove nothing about the paper, and the mark of
    each number (n,), empty if it has none.

    If all have the same reason, the sentence alone says so. numbers: n rows with their reason.

    >>> mark_worthless(pd.DataFrame({"reason": ["no exact map is printed", None]}))
    (['\\\\* proves nothing about the paper: no exact map is printed.'], ['\\\\*', ''])
    """
    reasons = dict(zip(numbers["reason"].dropna().unique(), MARKS))
    if reasons and numbers["reason"].nunique(dropna=False) == 1:
        (reason,) = reasons
        return [f"These numbers prove nothing about the paper: {reason}."], [""] * len(numbers)
    told = [f"{mark} proves nothing about the paper: {reason}." for reason, mark in reasons.items()]
    return [" ".join(told)] if told else [], [*numbers["reason"].map(reasons).fillna("")]


def describe_where_or_why(claim: Mapping[str, Any], declared: Claim | None) -> str:
    """Describe where a claim holds, and by which criterion of ours; or why that is open, by the
    first part of the reason.

    declared: the claim in claims.yaml.

    >>> told = {"verdict": "depends", "reason": "partly (O1: 2). It is so."}
    >>> describe_where_or_why(told | {"where_it_holds": ""}, None)
    'partly'
    """
    reason = claim["reason"] if isinstance(claim["reason"], str) else ""
    if claim["verdict"] in ("depends", "untestable"):
        # What a reading changes stands in brackets: the list of claims has it.
        without = re.sub(r" \((?:[^()]|\([^()]*\))*\)", "", reason)
        return re.split(r"; |\.(?: (?=[A-Z])|$)", without)[0]
    count = sentences.describe_count(declared, claim["verdict"], claim["holds"])
    held, _, needs = count.partition("; ")
    told = f"{held} comparisons ({needs})" if needs else f"{held} comparisons"
    if isinstance(claim["where_it_holds"], str):
        told = f"{told}. {claim['where_it_holds']}"
    ours = re.search(r"Ours: (.*?)\.(?: |$)", reason)
    return f"{told}; our criterion: {ours[1]}" if ours else told


def build_identified_page(folder: Path, studies: Mapping[str, Study]) -> str:
    """Return the page of printed lengths that are lengths of listed paths, as markdown.

    folder: has the audits, from which the rows come.
    """
    picture = (
        "![The paths of Song 2016 on their grid, with the numbers of their cells](identified.png)"
    )
    parts = ["# Printed lengths of paths that can be listed", IDENTIFIED, picture]
    for key, study in studies.items():
        rules = tuple(
            entry.because
            for table in study.find_tables_of_runs().values()
            for entry in table.identify
        )
        rows = pd.read_csv(folder / f"{key}_audit.csv", keep_default_na=False)
        if not rules or (rows := rows[rows["rule"].str.startswith(rules)]).empty:
            continue
        # A row for several numbers names no metric, and says in words how many match.
        of_one = rows["place"].str.contains("metric=")
        rows = rows.assign(
            printed=rows["printed"].where(of_one, ""),
            limit=rows["limit"].where(of_one, ""),
            item=rows["item"].map(naming.format_heading),
            place=[name_place(place, study.labels) for place in rows["place"]],
        )
        names = {"item": "in", "place": "number", "limit": "calculated", "arithmetic": "paths"}
        shown = rows[["item", "place", "printed", "limit", "arithmetic"]].rename(columns=names)
        parts += [f"## {format_name(key)}", write_table(shown.astype(str).set_index("in"))]
    return "\n\n".join(parts) + "\n"


def name_place(place: str, labels: naming.Labels) -> str:
    """Name the place of a printed number by the labels of its problem, method and statistic.

    >>> name_place("problem=0_15, method=smooth, metric=length", {"smooth": "smooth path"})
    '0_15, smooth path'
    """
    values = dict(part.split("=", 1) for part in place.split(", "))
    values.pop("metric", None)
    return ", ".join(
        " or ".join(labels.get(name, name) for name in value.split(" or "))
        for value in values.values()
    )


def _place_beside(ours: pd.DataFrame, numbers: pd.DataFrame, index: list[str]) -> pd.DataFrame:
    """Return a table with the printed number before our range in each cell, or before ours.

    index: the columns that name the rows, which come first in our table.
    """
    heads = len(index)
    values = ours.iloc[:, heads:]
    # The paper prints nothing in these cells.
    cells = values.map(lambda text: f"– ours {text}" if text else "").to_numpy()
    for number in numbers.to_dict("records"):
        place = int(number["table_row"]), int(number["table_column"])
        text = comparison.describe_range(number) or f"ours {values.iat[place]}"
        if not number["counted"]:
            text = text[text.index("ours") :]
        # Whatever our map, no runs have such numbers.
        mark = " (impossible)" if str(number["possible"]) == "False" else number["mark"]
        cells[place] = f"{number['as_printed']}{mark} {text}"
    names = ours.iloc[:, :heads].agg(", ".join, axis=1)
    # The paper may print no head.
    head = ", ".join(filter(str.strip, ours.columns[:heads])) or ", ".join(index)
    return pd.DataFrame(cells, pd.Index(names, name=head), ours.columns[heads:])


def build_block(folder: Path, labels: Mapping[str, Mapping[str, str]]) -> str:
    """Return the README's answers, picture and table of methods, from a folder's tables.

    labels: study -> name -> printed name.
    """
    numbers, claims, of_problems = (pd.read_csv(folder / name) for name in TABLES)
    answers = pd.read_csv(folder / TEXTS)
    listed = "\n".join(
        f"- **[{format_name(key)}]({KEPT}/{key}.md): {title}.** {text}"
        for key, title, text in answers.itertuples(index=False)
    )
    said = f"{headline.describe_numbers(numbers)} {headline.describe_claims(claims)}"
    parts = [
        f"**{OPEN} {describe_methods(of_problems)}**",
        listed,
        PICTURE,
        f"*{said} {RANGE}*",
        build_methods_table(of_problems[of_problems["proposed"]], labels),
    ]
    return "\n\n".join(parts)


def describe_methods(of_problems: pd.DataFrame) -> str:
    """Say what the papers' methods are worth beside the exact shortest path with rounded corners.

    of_problems: as from `methods.measure_studies`.
    """
    rows = methods.group_by_family(of_problems)
    own = rows["proposed"].astype(bool)
    times = [
        f"{each.min():.2g} to {each.max():.3g} ms"
        for each in (rows.loc[rows["method"] == "rounded", "cpu_ms"], rows.loc[own, "cpu_ms"])
    ]
    # Where every straight line is free, nobody can be shorter.
    straight = of_problems.groupby(["study", "family"])["straight"].all()
    blocked = [not straight[place] for place in zip(rows["study"], rows["family"])]
    rounded = rows.loc[rows["method"] == "rounded", ["study", "family", "cpu_ms"]]
    beside = rows[own].merge(rounded, on=["study", "family"], suffixes=("", "_rounded"))
    faster = beside.loc[beside["cpu_ms"] < beside["cpu_ms_rounded"], "study"]
    rows = rows[own & (rows["both"] > 0) & pd.Series(blocked, rows.index)]
    others = rows[rows["adds"] > 0]
    told = (
        "A simpler planner, the exact shortest path with rounded corners, needs no random search "
        f"and takes {times[0]} (the papers' methods: {times[1]}, faster than it in {len(faster)} "
        f"of {naming.format_count(len(beside), 'kind')} of scenarios, those of "
        f"{' and '.join(map(format_name, faster.unique()))}). "
        f"In {len(rows) - len(others)} of {naming.format_count(len(rows), 'kind')} of scenarios "
        "with smooth paths and a blocked straight line, the paper's method beats it in no problem"
    )
    better = " and ".join(
        f"{each.adds:.0f} of {each.both:.0f} problems ({format_name(each.study)}, {each.family})"
        for each in others.itertuples()
    )
    return f"{told}. The exceptions: {better}." if better else f"{told}."


def build_methods_table(of_problems: pd.DataFrame, labels: Mapping[str, naming.Labels]) -> str:
    """Return a table of methods, those of each family together, and the meaning of its columns.

    labels: study -> name -> printed name; several studies are named.
    """
    rows = methods.group_by_family(of_problems)
    named = {
        f"{study}/{name}": f"{format_name(study)}, {label}" if len(labels) > 1 else label
        for study, own in labels.items()
        for name, label in own.items()
    }
    groups = rows.groupby(["study", "family"], sort=False)
    laid = methods.format_table(rows.iloc[groups.ngroup().argsort(kind="stable")], named)
    own = f" {ROUNDED_NOTE}" if "rounded" in set(rows["method"]) else ""
    return f"{write_table(laid)}\n\n*{METHODS_NOTE}{own}*"


def format_name(key: str) -> str:
    """Return the name of a study for use in a sentence.

    >>> format_name("song2016"), format_name("meledje")
    ('Song 2016', 'Meledje')
    """
    return re.sub(r"(?<=[a-z])(?=[0-9])", " ", key).capitalize()


def write_table(table: pd.DataFrame) -> str:
    """Write a table as markdown, its index first."""
    rows = [[table.index.name or "", *table.columns], ["---"] * (table.shape[1] + 1)]
    rows += [
        [name, *values] for name, values in zip(table.index, table.to_numpy().tolist(), strict=True)
    ]
    return "\n".join(
        "| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows
    )


def add_papers_size(claims: pd.DataFrame, full: pd.DataFrame) -> pd.DataFrame:
    """Return claims of scale extended with one more column after the verdict,
    `verdict_papers_size`.

    It has the verdict of the same claim at scale full.
    """
    keys = ["study", "id", "variant"]
    theirs = full[[*keys, "verdict"]].rename(columns={"verdict": "verdict_papers_size"})
    both = claims.merge(theirs, on=keys, how="left", validate="one_to_one")
    columns = list(claims)
    columns.insert(columns.index("verdict") + 1, "verdict_papers_size")
    return both[columns]


def replace_block(text: str, name: str, block: str) -> str:
    """Return the text with the part between `<!-- name -->` and `<!-- /name -->` replaced.

    Raises ValueError if there is no such part.
    """
    begin, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    if not 0 <= text.find(begin) < text.find(end):
        raise ValueError(f"no part between {begin} and {end}")
    return f"{text[: text.find(begin)]}{begin}\n{block}\n{text[text.find(end) :]}"


if __name__ == "__main__":
    main()
