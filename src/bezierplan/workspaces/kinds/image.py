"""An image, whose pixels are cells."""

from pathlib import Path

from pydantic import Field

from bezierplan.workspaces import ros
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.kinds import UNKNOWN, File, Size, Workspace, naming


class Options(Workspace):
    """Keys of a workspace of kind `image`."""

    given_kind = "grid"

    file: File = Field(description="an image in the study's folder; dark pixels are occupied")
    resolution: Size = Field(description="the side of a pixel, a number of at least 1e-6")
    unknown: ros.Unknown = Field("occupied", description=UNKNOWN)


def load(description: dict, folder: Path) -> Grid:
    """Read the pixels of an image as cells, with its lower left corner at 0, 0.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "map.pgm").write_text("P2 2 2 255  255 0  255 255")
    ...     room = load({"file": "map.pgm", "resolution": 0.05, "unit": "m"}, Path(folder))
    >>> room.occupied.tolist()  # the bottom row first
    [[False, False], [False, True]]
    """
    with naming(description["file"]):
        unknown = description.get("unknown", "occupied")
        image = folder / description["file"]
        return ros.read_image(image, description["resolution"], description["unit"], unknown)
