"""A map whose cells change at random; `obstacles` of a problem says how many at a time."""

from typing import ClassVar

from pydantic import Field

from bezierplan.schema.model import Count
from bezierplan.workspaces.kinds import File, Size, World


class Options(World):
    """Keys of a workspace."""

    drawn: ClassVar[str] = "grid"

    file: File = Field(description="a map file in the study's folder")
    cell: Size = Field(description="the side of a cell, a number of at least 1e-6")
    every: Count = Field(description="after how many steps as many cells change as a problem has obstacles, a whole number of at least 1")
