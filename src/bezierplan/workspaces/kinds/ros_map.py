"""An image with the YAML file of ROS's map_server."""

from pathlib import Path

from pydantic import Field

from bezierplan.workspaces import ros
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import UNKNOWN, File, Workspace, naming


class Options(Workspace):
    """Keys of a workspace of kind `ros_map`."""

    given_kind = "grid"

    file: File = Field(description="the YAML file of a map_server map in the study's folder")
    unknown: ros.Unknown = Field("occupied", description=UNKNOWN)


def load(description: dict, folder: Path) -> Grid:
    """Read the image that a YAML file names, which lies in the same folder."""
    with naming(description["file"]):
        unknown = description.get("unknown", "occupied")
        return ros.read(folder / description["file"], folder, description["unit"], unknown)


def sources(description: dict, folder: Path) -> list[Path]:
    """List the YAML file and its image.

    Raises ValueError if it names none.
    """
    file = folder / description["file"]
    with naming(description["file"]):
        return [file, ros.find_image(file, folder)]
