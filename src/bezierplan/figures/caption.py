"""The caption of a table or figure: the same on page and site, in LaTeX, text and report."""

from typing import NamedTuple

from bezierplan.analysis.legend import WORDS

MOST_FINDINGS = 2


class CaptionClaim(NamedTuple):
    """A claim about a table or figure. words: its verdict, empty if docs/outcome has none."""

    claim: str
    statement: str
    words: str


class Caption(NamedTuple):
    """The parts of a caption.

    remark: the paper's finding where no claim is about it, or the runs that means leave out.
    behind: the runs that are shown.
    """

    title: str
    findings: list[CaptionClaim]
    remark: str
    behind: str

    def write(self) -> str:
        """Return the caption as one line, without claims whose verdict is not known."""
        found = [f"{each.statement}: {each.words}" for each in self.findings if each.words]
        shown = f"Shown: {self.behind}" if self.behind else ""
        return " ".join(f"{part}." for part in (self.title, *found, self.remark, shown) if part)


def describe_verdict(verdict: str, runs: int, which: str = "") -> str:
    """Return a verdict in words with the number of runs behind it.

    >>> describe_verdict("contradicted", 4000), describe_verdict("undecided", 10, "these ")
    ('contradicted by 4,000 runs', 'not decided by these 10 runs')
    """
    words = {0: "our calculation", 1: "this run" if which else "1 run"}
    return WORDS[verdict].caption.format(words.get(runs, f"{which}{runs:,} runs"))


def describe_verdicts(verdict: str, runs: int, verdict_here: str, runs_here: int) -> str:
    """Return the verdict of many runs, preceded by that of the runs shown if the two differ.

    >>> describe_verdicts("contradicted", 4000, "undecided", 10)
    'not decided by these 10 runs, contradicted by 4,000'
    """
    many = describe_verdict(verdict, runs)
    if verdict_here in ("", verdict, "depends", "untestable") or verdict == "untestable":
        return many
    first = describe_verdict(verdict_here, runs_here, "these ")
    if verdict == "depends":
        return f"{first}, {'and' if verdict_here == 'undecided' else 'but'} {many}"
    return f"{first}, {many.removesuffix(' runs')}"
