"""The outcome that the repository keeps in docs/outcome and in the README, from the results of two
scales.

Verdicts and numbers are those of scale extended: they are about the methods, not about the papers'
samples. Next to each verdict stands the verdict at the paper's own number of runs, from scale full.
"""

import re
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

import pandas as pd

from bezierplan.analysis import benchmark, headline, summary

RESULTS, FULL = Path("results/extended"), Path("results/full")
KEPT, README = Path("docs/outcome"), Path("README.md")
BLOCK = "outcome"
# Of each study: what its printed numbers say alone; and its readings, if they are scored.
AUDIT, READINGS = "audit.csv", ("readings.csv", "claims_by_reading.csv")
BASELINE_COMPARISON, WORTH, WHOLES = "baseline_comparison.csv", "worth.csv", "wholes.csv"
TABLES = ("numbers.csv", "claims.csv", BASELINE_COMPARISON)
SCALES = {
    "full": "the papers' own numbers of runs.",
    "extended": "a verdict is about a method, not about the few runs that a paper could afford.",
}


def write(
    titles: Mapping[str, str],
    verdicts: Mapping[str, str],
    settings: pd.DataFrame,
    experiments: Iterable[str],
) -> None:
    """Write the tables of docs/outcome and the README's part. Raises FileNotFoundError if results
    are missing.

    titles: of studies, by name. verdicts: the files of their sentences. settings: of their methods.
    experiments: those on whose problems others can be scored, each `study/name`.
    """
    KEPT.mkdir(parents=True, exist_ok=True)
    numbers, claims, measured = (pd.read_csv(RESULTS / name) for name in TABLES)
    claims = summary.with_papers_size(claims, pd.read_csv(FULL / "claims.csv"))
    for name in ("numbers.csv", BASELINE_COMPARISON, WORTH, WHOLES):
        shutil.copyfile(RESULTS / name, KEPT / name)
    shutil.copyfile(FULL / "numbers.csv", KEPT / "numbers_papers_size.csv")
    for key in titles:
        shutil.copyfile(RESULTS / key / AUDIT, KEPT / f"{key}_{AUDIT}")
        for name in READINGS:
            if (file := RESULTS / key / name).exists():
                shutil.copyfile(file, KEPT / f"{key}_{name}")
    claims.to_csv(KEPT / "claims.csv", index=False)
    settings.to_csv(KEPT / "settings.csv", index=False)
    scored = benchmark.of_results(FULL, experiments)
    scored.to_csv(KEPT / benchmark.STORED.name, index=False, float_format="%.6g")
    follow = following(KEPT, verdicts, numbers, claims, measured)
    whole = pd.read_csv(KEPT / WHOLES)
    report = summary.report(numbers, claims, measured, whole, titles, follow, RESULTS.name)
    (KEPT / "summary.md").write_text(report, encoding="utf-8")
    readme = README.read_text(encoding="utf-8")
    readme = summary.with_block(readme, BLOCK, table(KEPT, titles, verdicts))
    README.write_text(readme, encoding="utf-8")


def following(folder: Path, verdicts: Mapping[str, str], *tables: pd.DataFrame) -> dict[str, str]:
    """By study, what follows, from tables of numbers, claims, measures, and a folder's others."""
    audits = [str(folder / f"{key}_{AUDIT}") for key in verdicts]
    readings = sorted(map(str, folder.glob(f"*_{READINGS[0]}")))
    return summary.verdicts(*tables, pd.read_csv(folder / WHOLES), verdicts, audits, readings)


def table(folder: Path, titles: Mapping[str, str], verdicts: Mapping[str, str]) -> str:
    """The README's headline and sentences, from a folder's tables, and the scale, from its
    summary.
    """
    tables = [pd.read_csv(folder / name) for name in TABLES]
    follow = "\n".join(
        f"- {titles[key].partition(':')[0]}: {first_sentence(text)}"
        for key, text in following(folder, verdicts, *tables).items()
    )
    heading = (folder / "summary.md").read_text(encoding="utf-8").splitlines()[0]
    scale = heading.removeprefix(summary.HEADING)
    overview = headline.markdown(headline.headline(*tables, titles))
    return f"{overview}\n\n{follow}\n\nScale `{scale}`: {SCALES[scale]}"


def first_sentence(text: str) -> str:
    """The first of some sentences: of a paper the README and the site's home have that alone."""
    return re.split(r"(?<=[.])\s+(?=[A-Z0-9])", text)[0]
