"""The description of a job that makes runs."""

import itertools
from pathlib import Path
from typing import Any, NamedTuple

Settings = dict[str, Any]
"""Name -> value."""


class Condition(NamedTuple):
    """A problem and the values of the varied settings."""

    problem: str
    values: Settings

    @property
    def name(self) -> str:
        """Return the condition as it stands in a run's name."""
        return ",".join([self.problem, *(f"{key}={value}" for key, value in self.values.items())])


class Chunk(NamedTuple):
    """One method on each condition of an experiment, for a block of repeats. It holds, as names and
    plain values, all that the runs depend on beside the problems themselves.
    """

    study: str
    experiment: str
    method: str
    planner: str
    settings: Settings
    """The method's settings, except those that vary."""
    problems: dict[str, Settings]
    """Name -> the problem's workspace, and its layout, obstacles and settings, if it has any."""
    vary: dict[str, list]
    """Setting -> values; each combination of problems and values is a condition."""
    seeds: str
    """Source of a run's seed: its id (`own`), its id without the method (`shared`), or study,
    experiment, layout and repeat alone (`common`: all methods and conditions share random numbers).
    """
    repeats: list[int]
    """[first, last): the repeats to run."""
    time_limit: float | None = None
    """Seconds, compiling included, after which a run ends its job."""
    policy: Settings | None = None
    """The robot's policy, as plain values, if the world moves."""

    def conditions(self) -> list[Condition]:
        """Return each combination of problems and varied values, in the order given."""
        return [
            Condition(problem, dict(zip(self.vary, values, strict=True)))
            for problem in self.problems
            for values in itertools.product(*self.vary.values())
        ]


def find_chunk_files(folder: Path, pattern: str = "**/runs/*/*/*.parquet") -> list[Path]:
    """Return the files of chunks below a folder, without the times and traces beside them."""
    return [file for file in sorted(folder.glob(pattern)) if file.stem.isdecimal()]
