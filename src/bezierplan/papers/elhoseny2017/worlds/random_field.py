"""Fields of cells with circles at random places."""

from typing import Literal

from pydantic import Field

from bezierplan.schema.model import NotNegative, Positive
from bezierplan.workspaces import random_field
from bezierplan.workspaces.kinds import Workspace


class Options(Workspace):
    """Keys of a workspace."""

    drawn_kind = "grid"
    with_side = True

    radius: Positive = Field(
        description="the radius of every circle as a share of the field's side, a number above 0"
    )
    clear_ends: NotNegative = Field(
        description="how many cells stay free between a circle and start or target, at least 0"
    )
    radius_side: Literal["own"] | Positive = Field(
        "own",
        description="the side of which the radius is a share: own, that of each field, or a number "
        "of cells above 0, the same for all",
    )
    nested: bool = Field(
        False,
        description="whether a field with more circles is one with fewer and some more, true or "
        "false",
    )


draw = random_field.field
