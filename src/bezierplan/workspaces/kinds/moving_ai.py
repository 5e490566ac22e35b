"""A map of the MovingAI benchmarks."""

from pathlib import Path
from typing import ClassVar

from pydantic import Field

from bezierplan.workspaces import moving_ai
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import File, Workspace, naming


class Options(Workspace):
    """Keys of a workspace."""

    made: ClassVar[str] = "grid"

    file: File = Field(description="a .map file in the study's folder")


def load(description: dict, folder: Path) -> Grid:
    """The cells of a .map file."""
    with naming(description["file"]):
        return moving_ai.read(folder / description["file"], description["unit"])
