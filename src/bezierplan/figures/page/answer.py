"""What the page says first: the outcome, how many runs its results rest on, what fails, and what to
use on a map of one's own.
"""

from types import SimpleNamespace
from typing import Any

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


def kind_of(workspace: dict[str, Any]) -> str:
    """The kind and size of a map in words."""
    left, right, bottom, top = workspace["bounds"]
    if workspace.get("rows"):
        return f"grid of {len(workspace['rows'][0])} × {len(workspace['rows'])} cells"
    shapes = "circles" if workspace["kind"] == "circles" else "polygons"
    return f"{shapes} in {right - left:.4g} × {top - bottom:.4g} {workspace['unit']}"


def by_map(studies: dict[str, SimpleNamespace], data: dict[str, Any]) -> list[Row]:
    """By kind and size of map, of the methods whose runs are shown on them: those that always find
    a free path, or else the one that does most often, the shortest paths first.

    Rows: map, studies, methods (number), best (study, method, share of feasible runs, gap: median
    length over the exact bound, less 1; CPU time over the baseline's, of the whole study).
    """
    by_kind: dict[str, dict[tuple[str, str], list[Row]]] = {}
    for key, study in studies.items():
        for each in study.shown:
            if each["problem"]:
                problem = data["problems"][f"{key}/{each['experiment']}/{each['problem']}"]
                if problem["world"] is None:
                    kind = kind_of(data["workspaces"][problem["workspace"]])
                    by_kind.setdefault(kind, {}).setdefault((key, each["method"]), []).append(each)
    rows = []
    for kind, methods in sorted(by_kind.items()):
        measured = [
            _measured(studies[key], method, shown) for (key, method), shown in methods.items()
        ]
        best = max(measured, key=lambda row: (row["feasible"], -row["gap"]))
        always = sum(row["feasible"] == 1 for row in measured)
        keys = list(dict.fromkeys(key for key, _ in methods))
        rows.append(
            {"map": kind, "studies": keys, "methods": len(methods), "always": always, "best": best}
        )
    return rows


def _measured(study: SimpleNamespace, method: str, rows: list[Row]) -> Row:
    """A method on the maps of a kind."""
    gaps = [each["gap"] for each in rows if each["gap"] is not None]
    cpu = next((row["cpu"] for row in study.baseline if row["method"] == method), None)
    return {
        "study": study,
        "method": method,
        "feasible": sum(each["feasible"] for each in rows) / sum(each["count"] for each in rows),
        "gap": sum(gaps) / len(gaps) if gaps else float("inf"),
        "cpu": cpu,
    }
