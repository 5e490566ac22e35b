"""What the search of the page finds: an entry for each paper, claim, number, table, figure,
underspecified detail and run shown.
"""

from collections.abc import Iterator
from typing import NamedTuple

from bezierplan.figures.page.addresses import address, heading
from bezierplan.figures.page.answer import IN_SHORT
from bezierplan.figures.page.content import Number, Page, Shown, Study
from bezierplan.figures.page.glossary import WORDS


class Entry(NamedTuple):
    """A place of the page. kind, text: as shown. more: further words that find it. later: whether
    it stands behind the others.
    """

    kind: str
    address: str
    text: str
    more: str
    later: bool = False


SECTIONS = (
    Entry(
        "section",
        "page-use",
        "What should I use?",
        "instead recommended recommendation best planner method alternative baseline plan command",
    ),
    Entry(
        "section",
        "page-paths",
        "Path viewer: inspect a single run, and replay it",
        "rerun repeat again reproduce drive path command one single",
    ),
    Entry(
        "section", "page-words", "What the words mean", "glossary legend verdict meaning definition"
    ),
    Entry(
        "section",
        "page-about",
        "The data of this page",
        "json csv download schema readme cite citation version commit doi",
    ),
)


def entries(page: Page) -> list[Entry]:
    """All entries, in the order of the page."""
    of_studies = [entry for key, study in page.studies.items() for entry in _of_study(key, study)]
    words = [
        Entry(
            "word",
            address("page-word", word),
            f"{word}: {meaning}",
            "what means meaning definition",
        )
        for word, meaning in WORDS.items()
    ]
    use = [SECTIONS[0]] if any(study.baseline_comparison for study in page.studies.values()) else []
    return [*use, *SECTIONS[1:], *words, *of_studies]


def _of_study(key: str, study: Study) -> Iterator[Entry]:
    yield Entry("paper", study.address, study.title, key)
    for method in study.methods:
        name, does = study.labels.get(method.name, _words(method.name)), method.about[0]
        yield Entry(
            "method",
            method.address,
            f"{name}: {does}",
            f"{key} method planner {method.name} {method.planner}",
            True,
        )
    for claim in study.claims:
        compared = " ".join(each.name for each in claim.comparisons)
        said = IN_SHORT.get(claim.verdict, "undecided")
        more = (
            f"{key} claims {said} "
            f"{said.replace('hold', 'holds').replace('fail', 'fails')} {compared}"
        )
        yield Entry(f"claim, {claim.verdict}", claim.address, f"{claim.id} {claim.statement}", more)
    for table in study.tables:
        yield Entry("table", table.address, f"{heading(table.name)}: {table.title}", key)
        yield from (
            _of_number(number, table.name, f"{key} {table.title}")
            for number in table.numbers
            if number.published is not None
        )
    for row in study.baseline_comparison:
        text = (
            f"{study.labels.get(row.method, _words(row.method))} compared with the exact "
            "shortest path with rounded corners"
        )
        yield Entry("comparison", row.address, text, f"{key} baseline {row.method}", True)
    for figure in study.figures:
        yield Entry("figure", figure.address, f"{heading(figure.name)}: {figure.title}", key)
    for choice in study.assumptions:
        yield Entry(
            "underspecified detail",
            choice.address,
            f"{choice.id} {choice.detail}",
            f"{key} open choice {choice.setting}",
        )
    for shown in study.shown:
        yield from _of_runs(key, shown, study.labels)


def _of_number(number: Number, table: str, more: str) -> Entry:
    ours = "–" if number.ours is None else f"{number.beside:.4g}"
    values = f"{number.published:.4g} → {ours} {number.verdict}"
    column = number.column
    if number.statistic not in column:
        column += f", {number.statistic}"
    keys = " ".join(str(value) for value in number.keys.values())
    more = f"{more} published reproduced {number.metric} {number.statistic} {keys}"
    return Entry(
        f"number, {table}",
        number.address,
        f"{number.row}: {column}: {values}",
        more,
        not number.primary,
    )


def _of_runs(key: str, shown: Shown, labels: dict[str, str]) -> Iterator[Entry]:
    where = (
        f"on {labels.get(shown.problem, _words(shown.problem))}"
        if shown.problem
        else "on all problems"
    )
    method = labels.get(shown.method, _words(shown.method))
    for which, run in (("best", shown.best), ("median", shown.median), ("worst", shown.worst)):
        if run:
            text = f"{which} feasible run of {method} {where}, {_words(shown.experiment)}"
            yield Entry("path", run, text, f"{key} {shown.method}", bool(shown.problem))


def _words(name: str) -> str:
    return name.replace("_", " ")
