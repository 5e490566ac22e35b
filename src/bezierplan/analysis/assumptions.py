"""What a paper leaves open, and what readings of it are scored by (`readings`): plain values, of
which a job is made.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from bezierplan.analysis.table_kinds import Pivot
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.schema.model import one_or_list

LAYOUTS, FEWER = 30, 10
"""Layouts that score a reading where a printed number is of one of them, and where it is a mean
over several.
"""

Reading = dict[str, Any]
"""Id of an assumption -> its value; {} for the default."""


class Assumption(NamedTuple):
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
    """The runs that score a reading: chunks by method, and descriptions of the problems."""

    chunks: dict[str, Chunk]
    descriptions: Descriptions


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
    chunks: dict[str, Chunk],
    tables: list[Pivot],
    size: int,
    read: int,
    descriptions: Descriptions,
) -> Experiment:
    """The runs of an experiment by which readings are scored: the methods of tables, in the paper's
    world.

    chunks: the first of each method. size: repeats of the paper. read: runs of each method on each
    problem; where layouts are drawn, in `LAYOUTS` together, and in each no more than the paper's.
    """

    def shown(column: str, value: Any) -> bool:
        return any(
            value in one_or_list((table.where | table.primary).get(column, value))
            for table in tables
        )

    layouts = LAYOUTS if any(table.within for table in tables) else FEWER
    own_chunks = {}
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
        drawn = any("layout" in place for place in met.values())
        last = min(max(read // LAYOUTS, 1), size) if drawn else read
        own_chunks[method] = chunk._replace(vary=vary, problems=first, repeats=[0, last])
    return Experiment(own_chunks, descriptions)
