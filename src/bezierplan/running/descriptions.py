"""What a job that builds problems is made from."""

from typing import Any, NamedTuple


class Descriptions(NamedTuple):
    """What the problems of an experiment are built from, beside map files, as plain values."""

    study: str
    problems: dict[str, dict[str, Any]]
    """By name, the problem without the settings that belong to it."""
    workspaces: dict[str, dict[str, Any]]
    """By name, those of the problems, as their files describe them."""

    @property
    def homes(self) -> dict[str, str]:
        """Problem -> the name of its workspace."""
        return {name: problem["workspace"] for name, problem in self.problems.items()}
