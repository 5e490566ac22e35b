"""The page's first words: the outcome, the number of runs behind it, failures, and which method to
use on a map of one's own.
"""

from types import SimpleNamespace

from bezierplan.analysis import legend
from bezierplan.running.columns import Row


def describe_scale(scale: str, repeats: list[list[int]], evidence: bool) -> str:
    """Say how many runs the results of a scale rest on, and where the evidence of many runs is.

    repeats: by study, the least and the largest number of runs of a method under a condition.
    evidence: tells if positions and verdicts are those of many runs.
    """
    runs = _format_span([number for own in repeats for number in own])
    first = {
        "smoke": "a small subset, which shows that everything works",
        "full": "as many runs as the papers report",
        "extended": "enough runs to judge methods",
    }[scale]
    made = f"scale {scale}, {first}: {runs} runs per method and condition"
    if not evidence:
        return f"All of this page is of {made}."
    return (
        f"Tables, figures and paths are of {made}. Ranges, positions and verdicts are those of "
        "many runs, which docs/outcome keeps; the tick in a bar is what was made here. A study "
        "whose settings were changed since has its own, and says so."
    )


def _format_span(numbers: list[int]) -> str:
    """Return the range of numbers, such as "10 to 1,000", or the one number."""
    low, high = min(numbers, default=0), max(numbers, default=0)
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def select_claims_of_paper(study: SimpleNamespace) -> list[Row]:
    """Return the claims of the paper, without our own findings."""
    return [claim for claim in study.claims if not claim["finding"]]


def select_failing(study: SimpleNamespace) -> list[Row]:
    """Return the claims of a paper that fail, also those that do by a criterion of ours."""
    return [
        claim
        for claim in select_claims_of_paper(study)
        if legend.WORDS[claim["verdict"]].group == "fail"
    ]


def select_counted(study: SimpleNamespace) -> list[Row]:
    """Return the numbers of a study that count in the outcome."""
    return [cell for table in study.tables for cell in table["numbers"] if cell["counted"]]
