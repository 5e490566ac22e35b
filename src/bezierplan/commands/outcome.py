"""The outcome kept in the repository: docs/outcome and the README's table, both from results at scale full.

Next to each verdict stands how many readings of what the paper leaves open agree with it.
"""

import shutil
from argparse import ArgumentParser
from pathlib import Path

import pandas as pd

from bezierplan.analysis import summary
from bezierplan.commands import forecast
from bezierplan.study import reading

RESULTS, KEPT, README = Path("results/full"), Path("docs/outcome"), Path("README.md")
PICTURE = "song2016/figures/figure3.png"
BLOCK = "outcome"
SENSITIVITY = "sensitivity.csv"
WORTH = "worth.csv"


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Write docs/outcome and the README's table from results/full. Raises FileNotFoundError."""
    parser.parse_args(words)
    write()


def write() -> None:
    """Copy the outcome, and insert its table into the README. Raises FileNotFoundError if results are missing."""
    KEPT.mkdir(parents=True, exist_ok=True)
    tried = [pd.read_csv(file) for file in sorted(RESULTS.glob(f"*/{SENSITIVITY}"))]
    claims = summary.with_readings(pd.read_csv(RESULTS / "claims.csv"), pd.concat(tried))
    numbers = pd.read_csv(RESULTS / "numbers.csv")
    studies = reading.load(reading.read_config({}))
    titles = {key: study.title for key, study in studies.items()}
    measured = pd.read_csv(RESULTS / WORTH)
    numbers.to_csv(KEPT / "numbers.csv", index=False)
    claims.to_csv(KEPT / "claims.csv", index=False)
    (KEPT / "summary.md").write_text(summary.report(numbers, claims, measured, titles, RESULTS.name), encoding="utf-8")
    for frame in tried:
        frame.to_csv(KEPT / f"{frame['study'].iloc[0]}_{SENSITIVITY}", index=False)
    shutil.copyfile(RESULTS / WORTH, KEPT / WORTH)
    forecast.keep(studies, Path())
    shutil.copyfile(RESULTS / PICTURE, KEPT / PICTURE.replace("/figures/", "_"))
    README.write_text(summary.with_block(README.read_text(encoding="utf-8"), BLOCK, table(KEPT)), encoding="utf-8")


def table(kept: Path) -> str:
    """The README's table, from the numbers and claims in a folder."""
    return summary.markdown(summary.outcome(pd.read_csv(kept / "numbers.csv"), pd.read_csv(kept / "claims.csv")))
