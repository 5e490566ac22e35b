"""What a paper leaves open, and what readings of it are scored by (`readings`): plain values, of
which a job is made.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from bezierplan.analysis.table_kinds import Pivot
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.schema.model import one_or_list

READ = 100
"""Runs of each method on each problem that score a reading; where layouts are drawn, in `LAYOUTS`
together, and in each no more than the paper's.
"""
LAYOUTS, FEWER = 30, 10
"""Layouts that score a reading where a printed number is of one of them, and where it is a mean
over several; the others print the numbers of hidden readings.
"""

Reading = dict[str, Any]
"""Id of a choice -> its alternative; {} for the default."""


class Choice(NamedTuple):
    """What a paper leaves open: the alternatives of a setting, or of a key of workspaces.

    along: by method whose setting it is, further settings that go with an alternative. problems:
    those on which alone it changes; all if none are named. workspaces: name -> key. excluded_by:
    the place of the paper that excludes the alternatives, or ''.
    """

    id: str
    alternatives: list[Any]
    setting: str | None
    along: dict[str, dict[str, Any]]
    problems: list[str]
    workspaces: dict[str, str]
    excluded_by: str


class Experiment(NamedTuple):
    """Chunks by method, those whose runs score a reading and those that print a hidden one's
    numbers; descriptions of the problems; and whether a number is of one layout.
    """

    scoring: dict[str, Chunk]
    printing: dict[str, Chunk]
    descriptions: Descriptions
    in_one_layout: bool


def voting(
    tables: Mapping[str, Pivot], votes: dict[str, dict[str, dict[str, Any]]]
) -> dict[str, Pivot]:
    """The tables of which printed numbers vote, with the rows alone of which any does.

    votes: table -> metric -> column -> the values whose numbers vote; all if none are named.
    """
    chosen = {}
    for name, metrics in votes.items():
        rows = [*metrics.values()]
        where = {
            column: [value for each in rows for value in one_or_list(each[column])]
            for column in set.intersection(*map(set, rows))
        }
        chosen[name] = tables[name].but(where=tables[name].where | where)
    return chosen


def experiment(
    chunks: dict[str, Chunk], tables: list[Pivot], size: int, descriptions: Descriptions
) -> Experiment:
    """The runs of an experiment by which readings are scored: the methods of tables, in the paper's
    interpretation of the world.

    chunks: the first of each method. size: repeats of the paper.
    """

    def shown(column: str, value: Any) -> bool:
        return any(
            value in one_or_list((table.where | table.primary).get(column, value))
            for table in tables
        )

    in_one_layout = any(table.within for table in tables)
    layouts = LAYOUTS if in_one_layout else FEWER
    scoring, printing = {}, {}
    for method, chunk in chunks.items():
        if not shown("method", method):
            continue
        vary = {key: [each for each in own if shown(key, each)] for key, own in chunk.vary.items()}
        met = {
            name: place
            for name, place in chunk.problems.items()
            if shown("problem", name) and shown("workspace", place["workspace"])
        }
        first = {name: place for name, place in met.items() if place.get("layout", 0) < layouts}
        others = {name: place for name, place in met.items() if name not in first} or met
        drawn = any("layout" in place for place in met.values())
        last = min(READ // LAYOUTS, size) if drawn else READ
        scoring[method] = chunk._replace(vary=vary, problems=first, repeats=[0, last])
        printing[method] = chunk._replace(vary=vary, problems=others, repeats=[last, last + size])
    return Experiment(scoring, printing, descriptions, in_one_layout)
