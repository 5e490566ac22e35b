"""Positions of published numbers, and verdicts on claims: how each is said, shown and counted
(`legend.csv`).
"""

import csv
from pathlib import Path
from typing import NamedTuple


class Word(NamedTuple):
    """A position or a verdict.

    on: the kind of thing that has it, `number` or `claim`. group: its group in the counts of the
    outcome. caption: its words in a caption, with braces for the runs. look: the class that colours
    it. symbol: its mark.
    """

    on: str
    group: str
    caption: str
    look: str
    symbol: str
    meaning: str


# Without pandas, because captions need the words at every start of the workflow.
with Path(__file__).with_suffix(".csv").open(encoding="utf-8", newline="") as rows:
    WORDS = {row.pop("word"): Word(**row) for row in csv.DictReader(rows)}
"""In the order in which they are counted and explained."""


def select_words(what: str) -> dict[str, Word]:
    """Select the positions of numbers, or the verdicts on claims. what: `number` or `claim`."""
    return {name: word for name, word in WORDS.items() if word.on == what}
