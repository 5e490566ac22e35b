"""Maps with blocks of cells at random places."""

from typing import ClassVar, Literal

from pydantic import Field

from bezierplan.schema.model import Count, Positive
from bezierplan.workspaces import random_blocks
from bezierplan.workspaces.kinds import Workspace


class Options(Workspace):
    """Keys of a workspace."""

    drawn: ClassVar[str] = "grid"
    with_side: ClassVar[bool] = True

    largest_block: Count = Field(
        description="the most cells of a block's side, a whole number of at least 1"
    )
    clear_ends: Count = Field(
        description="a whole number of at least 1: 1 keeps the cells of start and target free"
    )
    corners: Literal["free", "one", "none"] = Field(
        description="how many of the two cells that a diagonal step passes between may be occupied"
    )
    lattice_length: Positive | None = Field(
        None, description="the length that the shortest lattice path must have, a number above 0"
    )


candidates = random_blocks.maps
