"""What the page says first: the outcome, how many runs its results rest on, what fails, and what to
use on a map of one's own.
"""

from types import SimpleNamespace

from bezierplan.analysis import words
from bezierplan.figures.page.reader import Row


def about_scale(scale: str, repeats: list[list[int]], outcome: bool) -> str:
    """How many runs the results of a scale rest on, and where the evidence of many runs is.

    repeats: of each study, the least and the largest number of runs of a method under a condition.
    outcome: whether the project keeps the outcome of many runs of these studies.
    """
    runs = _span([number for own in repeats for number in own])
    first = {
        "smoke": "a small subset, which shows that everything works",
        "full": "as many runs as the papers report",
        "extended": "enough runs to judge methods",
    }[scale]
    text = f"All of this page is of scale {scale}, {first}: {runs} runs per method and condition."
    if not outcome:
        return text
    return (
        f"{text} It is the mirror: the papers' tables and figures, made again and laid over the "
        "printed ones. The evidence, what many runs say, is kept in docs/outcome, a page a paper; "
        "verdicts there rest on more runs than those here."
    )


def _span(numbers: list[int]) -> str:
    low, high = min(numbers, default=0), max(numbers, default=0)
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def sentences_of_paper(study: SimpleNamespace) -> list[Row]:
    """Claims of the paper, without our own findings."""
    return [claim for claim in study.claims if not claim["finding"]]


def group_of(claim: Row) -> str:
    """What the verdict of a claim counts as."""
    return words.WORDS.get(claim["verdict"], words.OTHER).group


def failing(study: SimpleNamespace) -> list[Row]:
    """Sentences of a paper that fail, also those that do by a criterion of ours."""
    return [claim for claim in sentences_of_paper(study) if group_of(claim) == "fail"]


def counted(study: SimpleNamespace) -> list[Row]:
    """The numbers of a study that count in the outcome."""
    return [cell for table in study.tables for cell in table["numbers"] if cell["counted"]]
