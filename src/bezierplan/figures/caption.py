"""The caption of a table or figure: the same on page and site, in LaTeX, text and report."""

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from bezierplan.analysis.words import WORDS

MOST_FINDINGS = 2


class CaptionClaim(NamedTuple):
    """A claim about a table or figure.

    words: its verdict, empty if only the claims of the scale know it. runs: those of the
    scale that it is judged on, 0 if none is.
    """

    claim: str
    statement: str
    words: str
    runs: int


class Caption(NamedTuple):
    """remark: what the paper shows, where no claim is about it, or which runs means leave out.
    behind: the runs that it shows.
    """

    title: str
    findings: list[CaptionClaim]
    remark: str
    behind: str

    @property
    def is_open(self) -> bool:
        """Whether only the claims of the scale know a verdict."""
        return not all(finding.words for finding in self.findings)

    def judge(self, verdicts: Mapping[str, str]) -> list[CaptionClaim]:
        """Return the findings whose verdict is known. verdicts: of the scale's claims, by id."""
        return [
            each._replace(words=each.words or tell(verdicts[each.claim], each.runs, "these "))
            for each in self.findings
            if each.words or each.claim in verdicts
        ]

    def write(self, files: Iterable[str | Path] = ()) -> str:
        """Return the caption as one line. files: the claims of the scale, if it is open."""
        found = [f"{each.statement}: {each.words}" for each in self.judge(read_verdicts(files))]
        shown = f"Shown: {self.behind}" if self.behind else ""
        return " ".join(f"{part}." for part in (self.title, *found, self.remark, shown) if part)


def read_verdicts(files: Iterable[str | Path]) -> dict[str, str]:
    """Return the verdicts of claims in their primary variant, by id, from files claims.csv."""
    rows = (
        row for file in files for row in csv.DictReader(Path(file).read_text("utf-8").splitlines())
    )
    return {row["id"]: row["verdict"] for row in rows if row["primary"] == "True"}


def tell(verdict: str, runs: int, which: str = "") -> str:
    """Return a verdict in words with the runs that it rests on.

    >>> tell("contradicted", 4000), tell("undecided", 10, "these ")
    ('contradicted by 4,000 runs', 'not decided by these 10 runs')
    """
    words = {0: "our calculation", 1: "this run" if which else "1 run"}
    return WORDS[verdict].caption.format(words.get(runs, f"{which}{runs:,} runs"))


def tell_both(verdict: str, runs: int, verdict_here: str, runs_here: int) -> str:
    """Return the verdict of many runs, after that of those shown if it differs.

    >>> tell_both("contradicted", 4000, "undecided", 10)
    'not decided by these 10 runs, contradicted by 4,000'
    """
    many = tell(verdict, runs)
    if verdict_here in ("", verdict, "depends", "untestable") or verdict == "untestable":
        return many
    first = tell(verdict_here, runs_here, "these ")
    if verdict == "depends":
        return f"{first}, {'and' if verdict_here == 'undecided' else 'but'} {many}"
    return f"{first}, {many.removesuffix(' runs')}"
