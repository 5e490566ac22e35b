"""Polygons in a rectangle."""

from pathlib import Path

from pydantic import Field

from bezierplan.schema.model import NotNegative
from bezierplan.workspaces.geojson import read_geojson
from bezierplan.workspaces.kinds import File, Workspace, naming, text
from bezierplan.workspaces.polygons import Polygons


class Options(Workspace):
    """Keys of a workspace of kind `polygons`."""

    file: File = Field(description="a GeoJSON file in the study's folder")
    margin: NotNegative | None = Field(
        None,
        description="in a file without a border, how far the border lies from the obstacles, in "
        "units, a number of at least 0",
    )


def load(description: dict, folder: Path) -> Polygons:
    """Read the border and the obstacles of a GeoJSON file.

    A file without a border needs a margin:

    >>> from tempfile import TemporaryDirectory
    >>> shape = '{"type": "Polygon", "coordinates": [[[0, 0], [2, 0], [2, 1], [0, 0]]]}'
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "map.geojson").write_text(shape)
    ...     room = load({"file": "map.geojson", "margin": 1, "unit": "m"}, Path(folder))
    >>> room.bounds, room.obstacles[0][0].tolist()
    ((-1.0, 3.0, -1.0, 2.0), [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])
    """
    content = text(description, "file", folder)
    with naming(description["file"]):
        return read_geojson(content, description["unit"], description.get("margin"))
