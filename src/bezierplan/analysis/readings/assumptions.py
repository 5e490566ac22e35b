"""What a paper leaves open, and the runs by which its readings are judged (`readings`): plain
values, of which a job is made.
"""

from typing import Any, NamedTuple

from bezierplan.analysis.table_kinds import Pivot
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.schema.model import one_or_list

TIMES, LEAST = 5, 100
"""Repeats of each method on each problem, if config does not say how many: so many times the
paper's, and at least so many.
"""
LAYOUTS, IN_EACH = 50, 3
"""Random layouts, and repeats in each, at most."""

Reading = dict[str, Any]
"""Id of an assumption -> its value; {} for the default."""


class Alternatives(NamedTuple):
    """What a paper leaves open: the other values of a setting, or of a key of workspaces.

    along: by method whose setting it is, further settings that go with another value. problems:
    those on which alone it changes; all if none are named. workspaces: name -> key. excluded_by:
    the place of the paper that excludes the other values, or ''.
    """

    id: str
    detail: str
    alternatives: list[Any]
    setting: str | None
    along: dict[str, dict[str, Any]]
    problems: list[str]
    workspaces: dict[str, str]
    excluded_by: str


class ReadingRuns(NamedTuple):
    """The runs of a reading: chunks by method, and descriptions of the problems."""

    chunks: dict[str, Chunk]
    descriptions: Descriptions


def experiment(
    chunks: dict[str, Chunk],
    tables: list[Pivot],
    size: int,
    repeats: int | None,
    descriptions: Descriptions,
) -> ReadingRuns:
    """The runs of an experiment by which readings are judged: of the methods and in the conditions
    that tables show.

    chunks: the first of each method. size: repeats of the paper. repeats: of ours, if config says.
    """

    def shown(column: str, value: Any) -> bool:
        return any(
            value in one_or_list((table.where | table.primary).get(column, value))
            for table in tables
        )

    repeats = repeats or max(TIMES * size, LEAST)
    own_chunks = {}
    for method, chunk in chunks.items():
        if not shown("method", method):
            continue
        vary = {key: [each for each in own if shown(key, each)] for key, own in chunk.vary.items()}
        met = {
            name: place
            for name, place in chunk.problems.items()
            if shown("problem", name)
            and shown("workspace", place["workspace"])
            and place.get("layout", 0) < LAYOUTS
        }
        drawn = any("layout" in place for place in met.values())
        last = min(IN_EACH, size) if drawn else repeats
        own_chunks[method] = chunk._replace(vary=vary, problems=met, repeats=[0, last])
    return ReadingRuns(own_chunks, descriptions)
