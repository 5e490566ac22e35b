"""Occupancy maps in the format of ROS's map_server: an image and a YAML file that says what its
pixels mean; or an image alone.

A pixel is free if its occupancy is below free_thresh, occupied above occupied_thresh. In between it
is unknown (mode trinary) or occupied in part (mode scale, where transparent pixels are unknown). In
mode raw a pixel's value is its occupancy in percent, and above 100 it is unknown. What is occupied
in part counts as occupied, and so does what is unknown, unless it is asked to be free. The image's
first row is the top of the map.
"""

import difflib
import math
from pathlib import Path, PureWindowsPath
from typing import Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.schema import checked
from bezierplan.schema.model import (
    Line,
    Model,
    NotNegative,
    Positive,
    build_value_type,
    is_number,
    parse,
)
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import MOST_CELLS, check_cells, check_numbers, check_thickness
from bezierplan.workspaces.text_file import read_text

Unknown = Literal["occupied", "free"]
"""What pixels that nobody has seen count as."""


def _is_origin(entry: Any) -> bool:
    """Tell whether an entry is x, y, and a yaw of nearly 0 or nan, which map_saver also writes."""
    try:
        x, y, yaw = entry
        # Written so that a yaw of nan passes.
        turned = abs(math.remainder(float(yaw), math.tau)) > 1e-6
        return is_number(x) and is_number(y) and not turned
    except (TypeError, ValueError):
        return False


Origin: Any = build_value_type(_is_origin, "[x, y, 0], a map that is not turned")


class Content(Model):
    """Keys of a map_server YAML file."""

    image: Line = Field(description="the name of an image beside it")
    resolution: Positive = Field(description="units per pixel, a number above 0")
    origin: Origin = Field(description="[x, y, 0], the lower left pixel's corner and no yaw")
    negate: Literal[0, 1, False, True] = Field(0, description="0 (dark is occupied) or 1")
    occupied_thresh: NotNegative = Field(0.65, description="a number of at least 0")
    free_thresh: NotNegative = Field(0.196, description="a number of at least 0")
    mode: Literal["trinary", "scale", "raw"] = Field("trinary", description="how pixels are read")


def read(file: Path, folder: Path, unit: str, unknown: Unknown) -> Grid:
    """Read the grid of a map_server YAML file, one cell per pixel.

    folder: where the image must lie.

    Raises ValueError, naming the key and what is expected.
    """
    return _build_grid(find_image(file, folder), _read_content(file), unit, unknown)


def read_image(file: Path, resolution: float, unit: str, unknown: Unknown) -> Grid:
    """Read the grid of an image alone, with its lower left corner at 0, 0; dark pixels are
    occupied.

    resolution: side of a pixel, in units.

    Raises ValueError, naming what is wrong.
    """
    content = Content(image=file.name, resolution=resolution, origin=[0.0, 0.0, 0.0])
    return _build_grid(file, content, unit, unknown)


def _build_grid(image: Path, content: Content, unit: str, unknown: Unknown) -> Grid:
    """Build the grid of an image and of the keys that say how to read it."""
    check_thickness(content.resolution, "resolution:")
    x, y, _ = content.origin
    occupied = _find_occupied(image, content, unknown)
    grid = Grid(occupied, float(content.resolution), unit, (float(x), float(y)))
    check_numbers(np.array(grid.bounds), "origin, resolution: the border")
    return grid


def find_image(file: Path, folder: Path) -> Path:
    """Find the image of a map_server YAML file, which lies in a folder.

    ROS's map_saver writes the path at which it saved the image. On another machine, the image of
    that name beside the YAML file is meant.

    Raises ValueError if there is none.
    """
    name = _read_content(file).image
    # A Windows path splits at both kinds of slash.
    for image in (file.parent / name, file.parent / PureWindowsPath(name).name):
        if image.is_file() and image.resolve().is_relative_to(folder.resolve()):
            return image
    raise ValueError(f"image: {name}: no such file in {file.parent}; expected one")


def _read_content(file: Path) -> Content:
    """Read and check the keys of a map_server YAML file.

    Others are ignored, unless one looks like a key that is misspelt.
    """
    content, keys = checked.parse(read_text(file), file.name), Content.model_fields
    if isinstance(content, dict):
        for key in content.keys() - keys:
            # Programs add keys of their own, but a misspelt one would be ignored without a word.
            if difflib.get_close_matches(key.lower(), keys, cutoff=0.7):
                raise checked.Fault(f"{key}: unknown key{checked.describe_known(key, keys)}")
        content = {key: entry for key, entry in content.items() if key in keys}
    return parse(Content, content)


def _find_occupied(file: Path, content: Content, unknown: Unknown) -> np.ndarray:
    """Tell which pixels count as occupied: bool (rows, columns), the bottom row first."""
    from PIL import Image

    try:
        with Image.open(file) as image:
            columns, rows = image.size
            # The size stands in the header: a larger image is not decoded.
            if columns * rows <= MOST_CELLS:
                light, known = _measure_shades(image)
    except Exception as error:  # of a damaged file each format raises another one
        raise ValueError(
            f"image: {file.name}: cannot be read as an image ({type(error).__name__})"
        ) from None
    check_cells(rows, columns)
    if content.mode == "raw":
        share = np.rint(255 * light) / 100
        known &= share <= 1
    else:
        share = light if content.negate else 1.0 - light
    free = (share < content.free_thresh) & known
    if unknown == "free":
        free |= ~known
        if content.mode == "trinary":
            free |= share <= content.occupied_thresh
    # The first row of an image is the top.
    return ~free[::-1]


def _measure_shades(image: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return how light each pixel is (rows, columns), from 0 to 1, the mean of its colours; and
    whether it is known, bool: unless it is transparent.
    """
    # 16 bits a pixel, without colours or transparency.
    if image.mode.startswith("I"):
        light = np.asarray(image, dtype=float) / 65535.0
        return light, np.ones(light.shape, bool)
    colours = np.asarray(image.convert("RGBA"))
    return colours[..., :3].mean(axis=2) / 255.0, colours[..., 3] > 0
