"""The description of a job that builds problems."""

from typing import Any, NamedTuple


class Descriptions(NamedTuple):
    """Plain values from which the problems of an experiment are built, beside map files."""

    study: str
    problems: dict[str, dict[str, Any]]
    """Name -> the problem, without the settings that belong to it."""
    workspaces: dict[str, dict[str, Any]]
    """Name -> a workspace of these problems, as the study's file describes it."""

    @property
    def homes(self) -> dict[str, str]:
        """Return the name of each problem's workspace, by problem."""
        return {name: problem["workspace"] for name, problem in self.problems.items()}
