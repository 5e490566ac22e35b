"""Positions of published numbers, and verdicts on claims: how each is said, shown and counted
(`words.csv`).
"""

import csv
from pathlib import Path
from typing import NamedTuple


class Word(NamedTuple):
    """A position or a verdict.

    on: what it is on, `number` or `claim`. group: what it counts as in the outcome. counted: how a
    count says it. caption: how a caption does, with braces for the runs. look: the class that
    colours it. symbol, sign: its mark on a page, and in print.
    """

    on: str
    group: str
    counted: str
    caption: str
    look: str
    symbol: str
    sign: str
    meaning: str


with Path(__file__).with_suffix(".csv").open(encoding="utf-8", newline="") as rows:
    WORDS = {row.pop("word"): Word(**row) for row in csv.DictReader(rows)}
"""In the order in which they are counted and explained."""

OTHER = Word("", "open", "", "", "open", "·", "", "")
"""How any other text is shown."""


def on(what: str) -> dict[str, Word]:
    """Return the positions of numbers, or the verdicts on claims."""
    return {name: word for name, word in WORDS.items() if word.on == what}


def groups(what: str) -> dict[str, str]:
    """Return what each position or verdict counts as."""
    return {name: word.group for name, word in on(what).items()}
