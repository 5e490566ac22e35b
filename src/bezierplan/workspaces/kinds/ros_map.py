"""An image with the YAML file of ROS's map_server."""

from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from bezierplan.schema.model import NotNegative, value
from bezierplan.workspaces import ros
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import File, Workspace, naming


class Options(Workspace):
    """Keys of a workspace."""

    made: ClassVar[str] = "grid"

    file: File = Field(description="the YAML file of a map_server map in the study's folder")
    robot_radius: NotNegative = Field(
        0,
        description="a robot's radius: cells that come closer to an obstacle or the border are "
        "occupied, a number of at least 0",
    )
    most_pixels: (
        Annotated[int, value(lambda given: type(given) is int and given >= 1, "")] | None
    ) = Field(None, description="the most pixels of an image, a whole number of at least 1")
    unknown: Literal["occupied", "free"] | None = Field(
        None, description="what pixels count as that are unknown; occupied without it"
    )


def load(description: dict, folder: Path) -> Grid:
    """The image that a YAML file names, which lies in the same folder."""
    with naming(description["file"]):
        options = {
            key: description[key]
            for key in ("robot_radius", "most_pixels", "unknown")
            if key in description
        }
        return ros.read(folder / description["file"], folder, description["unit"], **options)


def sources(description: dict, folder: Path) -> list[Path]:
    """The YAML file and its image. Raises ValueError if it names none."""
    file = folder / description["file"]
    with naming(description["file"]):
        return [file, ros.image_of(file, folder)]
