"""The outcome kept in the repository: docs/outcome and the README's table, both from results at scale full."""

import shutil
from argparse import ArgumentParser
from pathlib import Path

import pandas as pd

from bezierplan.analysis import summary

RESULTS, KEPT, README = Path("results/full"), Path("docs/outcome"), Path("README.md")
FILES = ("summary.md", "numbers.csv", "claims.csv", "worth.csv")
PICTURE = "song2016/figures/figure3.png"
BLOCK = "outcome"


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Write docs/outcome and the README's table from results/full. Raises FileNotFoundError."""
    parser.parse_args(words)
    write()


def write() -> None:
    """Copy the outcome of results at scale full, and insert its table into the README. Raises FileNotFoundError if results are missing."""
    KEPT.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        shutil.copyfile(RESULTS / name, KEPT / name)
    for file in sorted(RESULTS.glob("*/sensitivity.csv")):
        shutil.copyfile(file, KEPT / f"{file.parent.name}_sensitivity.csv")
    shutil.copyfile(RESULTS / PICTURE, KEPT / "song2016_figure3.png")
    README.write_text(summary.with_block(README.read_text(encoding="utf-8"), BLOCK, table(KEPT)), encoding="utf-8")


def table(kept: Path) -> str:
    """The README's table, from the numbers and claims in a folder."""
    return summary.markdown(summary.outcome(pd.read_csv(kept / "numbers.csv"), pd.read_csv(kept / "claims.csv")))
