"""The caption of a table or figure: the same on page and site, in LaTeX, text and report."""

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from bezierplan.analysis.words import WORDS

MOST_FINDINGS = 2


class Finding(NamedTuple):
    """What a claim says of a table or figure.

    told: its verdict in words, empty if only the claims of the scale know it. runs: those of the
    scale that it is judged on, 0 if none is.
    """

    claim: str
    statement: str
    told: str
    runs: int


class Caption(NamedTuple):
    """says: what the paper says of its own, where no claim does. note: which runs means leave out.
    behind: the runs that it shows.
    """

    title: str
    says: str
    findings: list[Finding]
    note: str
    behind: str

    @property
    def is_open(self) -> bool:
        """Whether only the claims of the scale know a verdict."""
        return not all(finding.told for finding in self.findings)

    def judge(self, verdicts: Mapping[str, str]) -> list[Finding]:
        """Return the findings whose verdict is known; verdicts: of the scale's claims, by id."""
        judged = [
            each._replace(told=each.told or tell(verdicts.get(each.claim, ""), each.runs, "these "))
            for each in self.findings
        ]
        return [each for each in judged if each.told]

    def write(self, verdicts: Mapping[str, str] = MappingProxyType({})) -> str:
        """Return the caption as one line."""
        findings = [f"{each.statement}: {each.told}" for each in self.judge(verdicts)]
        says = f"In the paper: {self.says}" if self.says else ""
        shown = f"Shown: {self.behind}" if self.behind else ""
        parts = filter(None, [self.title, says, *findings, self.note, shown])
        return " ".join(f"{part}." for part in parts)


def tell(verdict: str, runs: int, which: str = "") -> str:
    """Return a verdict in words with the runs that it rests on; nothing of none.

    >>> tell("contradicted", 4000), tell("undecided", 10, "these ")
    ('contradicted by 4,000 runs', 'not decided by these 10 runs')
    """
    if not verdict:
        return ""
    words = {0: "our calculation", 1: "this run" if which else "1 run"}
    return WORDS[verdict].caption.format(words.get(runs, f"{which}{runs:,} runs"))


def tell_both(verdict: str, runs: int, shown: str, runs_shown: int) -> str:
    """Return the verdict of many runs, after that of the runs shown where it differs.

    >>> tell_both("contradicted", 4000, "undecided", 10)
    'not decided by these 10 runs, contradicted by 4,000'
    """
    many = tell(verdict, runs)
    if shown == verdict or not _counts(shown) or verdict == "untestable":
        return many
    first = tell(shown, runs_shown, "these ")
    if _counts(verdict):
        return f"{first}, {many.removesuffix(' runs')}"
    return f"{first}, {'and' if shown == 'undecided' else 'but'} {many}"


def _counts(verdict: str) -> bool:
    """Whether a verdict is told with a number of runs."""
    return bool(verdict) and "{}" in WORDS[verdict].caption


def read_verdicts(files: Iterable[str | Path]) -> dict[str, str]:
    """Return the verdicts of claims in their primary variant, by id, from files claims.csv."""
    verdicts = {}
    for file in files:
        with open(file, encoding="utf-8", newline="") as rows:
            own = csv.DictReader(rows)
            verdicts |= {row["id"]: row["verdict"] for row in own if row["primary"] == "True"}
    return verdicts
