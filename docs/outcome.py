"""The outcome that the repository keeps in docs/outcome and in the README, from the results of two
scales.

Verdicts and numbers are those of scale extended: they are about the methods, not about the papers'
samples. Next to each verdict stands the verdict at the paper's own number of runs, from scale full.
`make outcome` writes it; the site reads it.
"""

import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numbers_picture
import pandas as pd

from bezierplan.analysis import naming
from bezierplan.analysis.markdown import table_text
from bezierplan.analysis.numbers import comparison, methods
from bezierplan.analysis.outcome import headline, summary, verdict
from bezierplan.commands import read_studies
from bezierplan.running.inputs import PAPER
from bezierplan.study.page import list_settings

RESULTS, FULL = Path("results/extended"), Path("results/full")
KEPT, README = Path("docs/outcome"), Path("README.md")
BLOCK = "outcome"
# Of each study: what its printed numbers say alone, and its claims under readings.
AUDIT, BY_READING = "audit.csv", "claims_by_reading.csv"
BASELINE_COMPARISON, METHODS = "baseline_comparison.csv", "methods.csv"
WORTH, WHOLES = "worth.csv", "wholes.csv"
TABLES = ("numbers.csv", "claims.csv", BASELINE_COMPARISON)
CHECKS = "claim_checks.csv"
EVIDENCE = (*TABLES, CHECKS, WHOLES)
"""What many runs say: the site takes positions and verdicts from it alone."""
PICTURES = ("song2016/paper/figure3.png", "song2016/beyond/identified.png")
PICTURE = """<picture><source media="(max-width: 600px)" srcset="docs/outcome/numbers_tall.png"><img src="docs/outcome/numbers.png" alt="All printed numbers beside our ranges, a strip per table: how many lie inside, and how far they typically are from ours"></picture>"""  # noqa: E501
GENTLY = (
    "The papers' methods, worst first, with the papers' numbers of runs: medians over the "
    "problems. The exact shortest path with "
    "rounded corners is asked to turn no tighter than the method's median path without corners; "
    "the column after it counts the problems in which the method is shorter than that path, or "
    "turns more gently than it can."
)
RANGE = (
    "Our range is where 95 % of experiments of the paper's size end under our default reading. It "
    "cannot tell where it holds at least half of the paper's other numbers of the same kind."
)
LAID = f"{comparison.SIGNS_MEAN}. Times are of another machine: not compared."

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
            name: (study.tables[name].title, len(study.tables[name].index))
            for name, table in study.find_tables_of_runs().items()
            if table.published and table.printed
        }
        for key, study in studies.items()
    }
    write(*named(studies), settings, tables)
    for picture in PICTURES:
        study, _, name = picture.split("/")
        shutil.copyfile(FULL / picture, KEPT / f"{study}_{name}")


def named(studies: Mapping[str, Any]) -> tuple[dict[str, str], verdict.Files]:
    """Return the titles of studies, and their sentences."""
    titles = {key: study.title for key, study in studies.items()}
    files = {key: (each.verdict_file(), each.labels) for key, each in studies.items()}
    return titles, {key: file for key, file in files.items() if file[0]}


def write(
    titles: Mapping[str, str],
    verdicts: verdict.Files,
    settings: pd.DataFrame,
    tables: Mapping[str, Mapping[str, tuple[str, int]]],
) -> None:
    """Write the tables of docs/outcome, a page for each paper, and the README's part. Raises
    FileNotFoundError if results are missing.

    titles: of studies, by name. verdicts: their sentences. settings: of their methods.
    tables: of each
    study those with printed numbers, name -> title, and how many columns name the rows.
    """
    KEPT.mkdir(parents=True, exist_ok=True)
    numbers, claims = (pd.read_csv(RESULTS / name) for name in TABLES[:2])
    measured = pd.read_csv(FULL / BASELINE_COMPARISON)
    claims = with_papers_size(claims, pd.read_csv(FULL / "claims.csv"))
    for name in ("numbers.csv", WORTH, WHOLES):
        shutil.copyfile(RESULTS / name, KEPT / name)
    # Of the papers' numbers of runs: to measure all turns takes longer than to find the paths.
    for name in (BASELINE_COMPARISON, METHODS):
        shutil.copyfile(FULL / name, KEPT / name)
    shutil.copyfile(FULL / "numbers.csv", KEPT / "numbers_papers_size.csv")
    for key in titles:
        for name in (AUDIT, BY_READING):
            shutil.copyfile(RESULTS / key / name, KEPT / f"{key}_{name}")
    claims.to_csv(KEPT / "claims.csv", index=False)
    checks = pd.concat(pd.read_csv(RESULTS / key / CHECKS) for key in titles)
    primary = claims.loc[claims["primary"], ["study", "id", "variant"]]
    checks.merge(primary).to_csv(KEPT / CHECKS, index=False, float_format="%.6g")
    settings.to_csv(KEPT / "settings.csv", index=False)
    numbers_picture.save(numbers, {key: key for key in titles}, KEPT)
    follow = following(KEPT, verdicts, numbers, claims, measured)
    for key, text in follow.items():
        page = paper(titles[key], text, claims[claims["study"] == key], RESULTS / key, tables[key])
        (KEPT / f"{key}.md").write_text(page, encoding="utf-8")
    readme = README.read_text(encoding="utf-8")
    readme = with_block(readme, BLOCK, table(KEPT, titles, verdicts))
    README.write_text(readme, encoding="utf-8")


def paper(
    title: str,
    text: str,
    claims: pd.DataFrame,
    folder: Path,
    tables: Mapping[str, tuple[str, int]],
) -> str:
    """The page of a paper, as markdown: what follows, its main claims, and its tables
    with the printed number beside ours in each cell.

    text: as from `following`. folder: of the study's results. tables: as for `write`.
    """
    heads = {"id": "claim", "statement": "in our words", "verdict": "verdict"}
    heads |= {"where_it_holds": "where it holds"}
    main = claims.loc[claims["primary"] & claims["main"].astype(bool), [*heads]].fillna("")
    parts = [
        f"# {title}",
        text.strip(),
        "## What abstract and conclusion claim",
        table_text(main.rename(columns=heads).set_index("claim")),
        MORE.format(folder.name),
        LAID,
    ]
    for name, (table_title, heads) in tables.items():
        ours = pd.read_csv(folder / PAPER / f"{name}.csv", dtype=str, keep_default_na=False)
        numbers = pd.read_csv(folder / PAPER / f"{name}.comparison.csv", dtype={"as_printed": str})
        laid = _beside(ours, numbers.dropna(subset="table_row"), heads)
        parts += [f"## {naming.heading(name)}: {table_title}", table_text(laid)]
    return "\n\n".join(parts) + "\n"


def _beside(ours: pd.DataFrame, numbers: pd.DataFrame, heads: int) -> pd.DataFrame:
    """Return a table with the printed number before our range in each cell, or before ours."""
    cells = ours.iloc[:, heads:].to_numpy()
    for number in numbers.to_dict("records"):
        place = int(number["table_row"]), int(number["table_column"])
        text = comparison.beside(number) or f"ours {cells[place]}"
        cells[place] = f"{number['as_printed']} {text}"
    names = ours.iloc[:, :heads].agg(", ".join, axis=1)
    return pd.DataFrame(cells, pd.Index(names, name=""), ours.columns[heads:])


def following(folder: Path, verdicts: verdict.Files, *tables: pd.DataFrame) -> dict[str, str]:
    """By study, what follows, from tables of numbers, claims, measures, and a folder's others."""
    audits = [str(folder / f"{key}_{AUDIT}") for key in verdicts]
    worth = [str(file) for file in folder.glob(WORTH)]
    return summary.verdicts(*tables, pd.read_csv(folder / WHOLES), verdicts, audits, worth)


def table(folder: Path, titles: Mapping[str, str], verdicts: verdict.Files) -> str:
    """The README's headline and sentences, from a folder's tables, and the scale, from its
    summary.
    """
    tables = [pd.read_csv(folder / name) for name in TABLES]
    follow = "\n".join(
        f"- {titles[key].partition(':')[0]}: {sentences(text)[0]}"
        for key, text in following(folder, verdicts, *tables).items()
    )
    pages = {key: f"{KEPT}/{key}.md" for key in verdicts}
    overview = markdown(headline.headline(*tables[:2], titles), pages)
    most = int(tables[0]["n_ours"].max())
    labels = {key: own for key, (_, own) in verdicts.items()}
    rests = f"A verdict rests on up to {most:,} runs of a method."
    return "\n\n".join([overview, methods_by_family(folder, labels), follow, rests])


def methods_by_family(folder: Path, labels: Mapping[str, Mapping[str, str]]) -> str:
    """Return the table of the papers' methods, and what its columns mean. labels: by study."""
    rows = methods.of_families(pd.read_csv(folder / METHODS))
    return f"{table_text(methods.laid_out(rows, labels))}\n\n{GENTLY}"


def sentences(text: str) -> list[str]:
    """What follows for a paper, sentence by sentence: README and the site's home have the first."""
    return re.split(r"(?<=[.])\s+(?=[A-Z0-9])", text.partition("\n\n")[0])


def with_papers_size(claims: pd.DataFrame, full: pd.DataFrame) -> pd.DataFrame:
    """Return claims of scale extended with one more column after the verdict,
    `verdict_papers_size`: that of the same claim at scale full.
    """
    keys = ["study", "id", "variant"]
    theirs = full[[*keys, "verdict"]].rename(columns={"verdict": "verdict_papers_size"})
    both = claims.merge(theirs, on=keys, how="left", validate="one_to_one")
    columns = list(claims)
    columns.insert(columns.index("verdict") + 1, "verdict_papers_size")
    return both[columns]


def with_block(text: str, name: str, block: str) -> str:
    """Return the text with the part between `<!-- name -->` and `<!-- /name -->` replaced. Raises
    ValueError if there is no such part.
    """
    begin, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    if not 0 <= text.find(begin) < text.find(end):
        raise ValueError(f"no part between {begin} and {end}")
    return f"{text[: text.find(begin)]}{begin}\n{block}\n{text[text.find(end) :]}"


def markdown(head: headline.Headline, addresses: Mapping[str, str]) -> str:
    """Return the headline as markdown: the sentences, the papers, and what their words mean.

    addresses: of the studies' pages, by name.
    """
    parts = [f"**{' '.join(head.sentences)}**", PICTURE]
    if not head.papers.empty:
        shown = head.papers.rename(
            columns=headline.PAPERS,
            index=lambda key: f"[{key}]({addresses[key]})" if key in addresses else key,
        )
        parts += [table_text(shown), RANGE]
    return "\n\n".join(parts)


if __name__ == "__main__":
    main()
