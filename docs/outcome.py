"""The outcome that the repository keeps in docs/outcome and in the README, from the results of two
scales.

Verdicts and numbers are those of scale extended: they are about the methods, not about the papers'
samples. Next to each verdict stands the verdict at the paper's own number of runs, from scale full.
`make outcome` writes it; the site reads it. Sentences stand in `templates`: `outcome` for a paper,
`identified`, `families` for a table of methods, and `readme`.
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
from bezierplan.figures.page import build
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
MARKS = ("\\*", "†", "‡", "§")
"""Beside printed numbers that prove nothing about the paper, one for each reason."""


def main() -> None:
    """Write docs/outcome and the README's table. Raises FileNotFoundError for results that
    `make outcome` has not made yet.
    """
    studies = read_studies()
    shutil.copyfile(RESULTS / IDENTIFIED_PATHS, KEPT / "identified.png")
    copy_tables(studies)
    answers = fill_texts(KEPT, studies)
    pd.DataFrame(
        [(key, each.title, each.text) for key, each in answers.items()],
        columns=["study", "title", "text"],
    ).to_csv(KEPT / TEXTS, index=False)
    tables = [pd.read_csv(KEPT / name) for name in TABLES]
    numbers_picture.save(tables[0], KEPT)
    pages = {KEPT / "identified.md": build_identified_page(KEPT, studies)}
    for key, answer in answers.items():
        own = (table[table["study"] == key] for table in tables)
        pages[KEPT / f"{key}.md"] = build_paper_page(studies[key], answer, *own)
    for file, page in pages.items():
        file.write_text(f"{page}\n", encoding="utf-8")
    readme = README.read_text(encoding="utf-8")
    README.write_text(replace_block(readme, BLOCK, build_block(KEPT, studies)), encoding="utf-8")
    if faults := [f"{key}: {line}" for key, each in answers.items() for line in each.faults]:
        raise ValueError("texts of verdict.yaml: " + "; ".join(faults))


def fill_template(name: str, **values: Any) -> str:
    """Fill a template with values."""
    environment = build.build_environment(RESULTS, Path(__file__).parent / "templates")
    environment.filters["cell"] = escape_cell
    environment.globals |= {"table": format_table, "signs_mean": comparison.SIGNS_MEAN}
    return environment.get_template(f"{name}.md.jinja").render(values).strip()


def fill_texts(folder: Path, studies: Mapping[str, Study]) -> dict[str, facts.FilledText]:
    """Return the answer to each paper that has one, from the tables of a folder."""
    return {
        key: facts.fill(texts.read(file), facts.read_outcome_tables(folder, key))
        for key, study in studies.items()
        if (file := study.verdict_file())
    }


def copy_tables(studies: Mapping[str, Study]) -> None:
    """Copy the tables of results into docs/outcome, beside one of all settings. Raises
    FileNotFoundError if results are missing.
    """
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
    pd.DataFrame(
        [(key, *row) for key, study in studies.items() for row in list_settings(study)],
        columns=["study", "of", "setting", "value"],
    ).to_csv(KEPT / "settings.csv", index=False)


def build_paper_page(
    study: Study,
    answer: facts.FilledText,
    numbers: pd.DataFrame,
    claims: pd.DataFrame,
    of_problems: pd.DataFrame,
) -> str:
    """Return the page of a paper, as markdown: the answer, its main claims, its method beside the
    rounded shortest path, and its tables with the printed number beside ours in each cell.

    numbers, claims, of_problems: rows of this paper in `TABLES`.
    """
    declared = {claim.id: claim for claim in study.claims}
    main = claims[claims["primary"] & claims["main"].astype(bool)].to_dict("records")
    own = of_problems[~of_problems["method"].isin(study.variants())]
    tables = []
    for name, table in study.find_published_tables().items():
        ours, laid = (
            pd.read_csv(
                RESULTS / study.key / PAPER / f"{name}{kind}.csv", dtype=str, keep_default_na=False
            )
            for kind in ("", ".comparison")
        )
        # Both list the printed numbers in the same order.
        laid["counted"] = numbers.loc[numbers["table"] == name, "counted"].to_numpy()
        told, marks = mark_worthless(laid.loc[laid["position"] != comparison.NO_RANGE, "reason"])
        tables.append((name, table, told, *lay_beside(ours, laid, marks, table.index)))
    return fill_template(
        "outcome",
        study=study,
        answer=answer,
        claims=[row | {"why": describe_where_or_why(row, declared[row["id"]])} for row in main],
        methods=build_methods_table(own, {study.key: study}),
        tables=tables,
    )


def mark_worthless(reasons: pd.Series) -> tuple[str, dict[str, str]]:
    """Say why numbers of a table prove nothing about the paper, and return the mark of each reason.

    If all have the same reason, the sentence alone says so. reasons: of the numbers, empty where
    there is none.

    >>> mark_worthless(pd.Series(["no exact map is printed", ""]))[0]
    '\\\\* proves nothing about the paper: no exact map is printed.'
    """
    marks = dict(zip(filter(None, reasons.unique()), MARKS))
    if len(marks) == 1 and "" not in {*reasons}:
        (reason,) = marks
        return f"These numbers prove nothing about the paper: {reason}.", {}
    told = [f"{mark} proves nothing about the paper: {each}." for each, mark in marks.items()]
    return " ".join(told), marks


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
    found = []
    for key, study in studies.items():
        rules = tuple(
            entry.because
            for table in study.find_tables_of_runs().values()
            for entry in table.identify
        )
        rows = pd.read_csv(folder / f"{key}_audit.csv", dtype=str, keep_default_na=False)
        own = [row for row in rows.to_dict("records") if row["rule"].startswith(rules)]
        found += [(study, own)] if own else []
    return fill_template("identified", found=found, name_place=name_place)


def name_place(place: str, labels: naming.Labels) -> str:
    """Name the place of a printed number by the labels of its problem, method and statistic.

    >>> name_place("problem=0_15, method=smooth, metric=length", {"smooth": "smooth path"})
    '0_15, smooth path'
    """
    values = re.sub(r"(, )?metric=\w+|\w+=", "", place)
    return re.sub(r"\w+", lambda name: labels.get(name[0], name[0]), values)


def lay_beside(
    ours: pd.DataFrame, numbers: pd.DataFrame, marks: Mapping[str, str], index: list[str]
) -> tuple[list[str], list[list[str]]]:
    """Return heads and rows of a table with the printed number before our range in each cell, or
    before ours.

    ours, numbers: the table and its comparison, all text. index: the columns that name the rows,
    which come first in our table.
    """
    heads = len(index)
    names, values = ours.iloc[:, :heads], ours.iloc[:, heads:]
    # The paper prints nothing in these cells.
    cells = values.map(lambda text: f"– ours {text}" if text else "").to_numpy()
    for number in numbers.to_dict("records"):
        place = int(number["table_row"]), int(number["table_column"])
        signed = comparison.describe_range(number)
        text = signed or f"ours {values.iat[place]}"
        if not number["counted"]:
            text = text[text.index("ours") :]
        # Whatever our map, no runs have such numbers.
        impossible = number["possible"] == "False"
        mark = " (impossible)" if impossible else marks.get(signed and number["reason"], "")
        cells[place] = f"{number['as_printed']}{mark} {text}"
    # The paper may print no head.
    head = ", ".join(filter(str.strip, names)) or ", ".join(index)
    rows = [[", ".join(own), *row] for own, row in zip(names.to_numpy(), cells)]
    return [head, *values], rows


def build_block(folder: Path, studies: Mapping[str, Study]) -> str:
    """Return the README's answers, picture and table of methods, from a folder's tables."""
    numbers, claims, of_problems = (pd.read_csv(folder / name) for name in TABLES)
    rows, place = methods.group_by_family(of_problems), ["study", "family"]
    rounded = rows[rows["method"] == "rounded"]
    own = rows[rows["proposed"].astype(bool)].merge(rounded, on=place, suffixes=("", "_rounded"))
    # Where every straight line is free, nobody can be shorter.
    blocked = ~of_problems.groupby(place)["straight"].all()
    rivals = own[(own["both"] > 0) & own.join(blocked, on=place)["straight"]]
    return fill_template(
        "readme",
        answers=pd.read_csv(folder / TEXTS).to_dict("records"),
        said=[headline.describe_numbers(numbers), headline.describe_claims(claims)],
        times=[rounded["cpu_ms"], own["cpu_ms"]],
        own=own,
        faster=own.loc[own["cpu_ms"] < own["cpu_ms_rounded"], "study"],
        rivals=rivals,
        better=rivals[rivals["adds"] > 0].to_dict("records"),
        methods=build_methods_table(of_problems[of_problems["proposed"]], studies),
    )


def build_methods_table(of_problems: pd.DataFrame, studies: Mapping[str, Any]) -> str:
    """Return a table of methods, those of each family together, and the meaning of its columns.

    studies: with their labels; of several, each is named.
    """
    rows = methods.group_by_family(of_problems)
    named = {
        f"{key}/{name}": f"{naming.format_heading(key)}, {label}" if len(studies) > 1 else label
        for key, study in studies.items()
        for name, label in study.labels.items()
    }
    groups = rows.groupby(["study", "family"], sort=False)
    laid = methods.format_table(rows.iloc[groups.ngroup().argsort(kind="stable")], named)
    return fill_template("families", laid=laid, rounded="rounded" in {*rows["method"]})


def format_table(heads: Iterable[Any], rows: Iterable[Iterable[Any]]) -> str:
    """Return a table in Markdown from its heads and rows."""
    heads = [*heads]
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(map(escape_cell, line))} |" for line in lines)


def escape_cell(value: Any) -> str:
    """Return a value as the text of a cell, in which a bar would end it."""
    return " ".join(str(value).replace("|", "\\|").split())


def add_papers_size(claims: pd.DataFrame, full: pd.DataFrame) -> pd.DataFrame:
    """Return claims of scale extended with one more column after the verdict,
    `verdict_papers_size`.

    It has the verdict of the same claim at scale full.
    """
    keys = ["study", "id", "variant"]
    theirs = claims[keys].merge(full, on=keys, how="left", validate="one_to_one")["verdict"]
    claims.insert(claims.columns.get_loc("verdict") + 1, "verdict_papers_size", theirs)
    return claims


def replace_block(text: str, name: str, block: str) -> str:
    """Return the text with the part between `<!-- name -->` and `<!-- /name -->` replaced.

    Raises ValueError if there is no such part.
    """
    before, begin, rest = text.partition(f"<!-- {name} -->\n")
    _, end, after = rest.partition(f"<!-- /{name} -->")
    if not end:
        raise ValueError(f"no part between <!-- {name} --> and <!-- /{name} -->")
    return f"{before}{begin}{block}\n{end}{after}"


if __name__ == "__main__":
    main()
