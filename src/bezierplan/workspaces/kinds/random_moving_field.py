"""Fields of cells with circles that move from random places in random directions."""

from typing import ClassVar

from pydantic import Field

from bezierplan.schema.model import Positive
from bezierplan.workspaces.kinds import RandomMoving


class Options(RandomMoving):
    """Keys of a workspace."""

    drawn: ClassVar[str] = "grid"
    with_side: ClassVar[bool] = True

    radius: Positive = Field(description="the radius of every circle as a share of the field's side, a number above 0")
