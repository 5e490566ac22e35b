"""A map whose cells change."""

from pathlib import Path
from typing import ClassVar

from pydantic import Field, model_validator

from bezierplan.schema.model import Model, Positive, wrong
from bezierplan.workspaces.kinds import File, Size, World


class Change(Model):
    """A moment at which the cells of a map change."""

    file: File = Field(description="the map file that is in force from then on")
    after: Positive = Field(
        None, description="when: the share of its way that a robot on the shortest path from cell to cell has then covered, above 0"
    )
    at: Positive = Field(None, description="or when: a step, a number above 0")

    @model_validator(mode="after")
    def _check_moment(self) -> "Change":
        if len(self.model_fields_set & {"after", "at"}) != 1:
            raise wrong("expected either after or at")
        return self


class Options(World):
    """Keys of a workspace."""

    made: ClassVar[str] = "grid"

    file: File = Field(description="a map file in the study's folder")
    cell: Size = Field(description="the side of a cell, a number of at least 1e-6")
    changes: list[Change] = Field(description="a list of {file, after} or {file, at}, in order of time", min_length=1)


def sources(description: dict, folder: Path) -> list[Path]:
    """The map at the beginning, and those of the changes."""
    return [folder / file for file in (description["file"], *(change["file"] for change in description["changes"]))]
