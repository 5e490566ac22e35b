"""What a paper leaves open, and what readings of it are scored by (`readings`): plain values, of
which a job is made.
"""

from typing import Any, NamedTuple

from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions

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
    numbers, of which each has one layout, if there are any; and descriptions of the problems.
    """

    scoring: dict[str, Chunk]
    printing: dict[str, Chunk]
    descriptions: Descriptions
