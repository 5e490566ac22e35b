"""What a job of runs is made from."""

import itertools
from pathlib import Path
from typing import Any, NamedTuple


class Condition(NamedTuple):
    """A problem and the values of the varied settings."""

    problem: str
    values: dict[str, Any]

    @property
    def name(self) -> str:
        return ",".join([self.problem, *(f"{key}={value}" for key, value in self.values.items())])


class Chunk(NamedTuple):
    """One method on every condition of an experiment, for a block of repeats: all that the runs
    depend on beside the problems themselves, as names and plain values.
    """

    study: str
    experiment: str
    method: str
    planner: str
    settings: dict[str, Any]
    """Those of the method."""
    problems: dict[str, dict[str, Any]]
    """By name, the problem's workspace and, if present, layout, obstacles and their settings."""
    vary: dict[str, list]
    """Setting or preset -> values; every combination of problems and values is a condition."""
    presets: dict[str, dict[str, dict[str, Any]]]
    """Preset -> value, as text -> settings that go with it."""
    seeds: str
    """A run's seed comes from its id (`own`), from its id without the method (`shared`), or from
    study, experiment, layout and repeat alone (`common`: all methods and conditions share random
    numbers).
    """
    repeats: list[int]
    """[first, last): the repeats to run."""
    time_limit: float | None = None
    """Seconds, including compilation, after which a run ends its job."""
    policy: dict[str, Any] | None = None
    """What the robot does, where the world moves."""

    def conditions(self) -> list[Condition]:
        """Every combination of problems and varied values, in the order given."""
        return [
            Condition(problem, dict(zip(self.vary, values, strict=True)))
            for problem in self.problems
            for values in itertools.product(*self.vary.values())
        ]

    @property
    def runs(self) -> int:
        """How many runs it makes."""
        first, last = self.repeats
        return len(self.conditions()) * (last - first)

    @property
    def name(self) -> str:
        """What the ids of its runs have in common, with a star for conditions."""
        return f"{self.study}/{self.experiment}/*/{self.method}"


def find_chunk_files(folder: Path, pattern: str = "**/runs/*/*/*.parquet") -> list[Path]:
    """The files of chunks below a folder, without the times and traces next to them."""
    return [file for file in sorted(folder.glob(pattern)) if file.stem.isdecimal()]
