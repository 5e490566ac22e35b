"""Polygons in a rectangle."""

from pathlib import Path

from pydantic import Field

from bezierplan.workspaces.geojson import polygons_from_geojson
from bezierplan.workspaces.kinds import File, Workspace, naming, text
from bezierplan.workspaces.polygons import Polygons


class Options(Workspace):
    """Keys of a workspace."""

    file: File = Field(description="a GeoJSON file in the study's folder")


def load(description: dict, folder: Path) -> Polygons:
    """The features of a GeoJSON file, with properties.role `border`, one rectangle, and `obstacle`."""
    content = text(description, "file", folder)
    with naming(description["file"]):
        return polygons_from_geojson(content, description["unit"])
