"""Occupancy maps in the format of ROS's map_server: an image and a YAML file that says what its
pixels mean; or an image alone.

YAML keys: image (a file beside it, or elsewhere in the folder of the maps), resolution (units per
pixel), origin [x, y, yaw] of the lower left pixel's corner, negate (0: dark pixels are occupied),
occupied_thresh, free_thresh, and mode. A pixel is free if its occupancy is below free_thresh,
occupied above occupied_thresh. In between it is unknown (mode trinary) or occupied in part (mode
scale, where transparent pixels are unknown). In mode raw a pixel's value is its occupancy in
percent, and above 100 it is unknown. What is occupied in part counts as occupied, and so does what
is unknown, unless it is asked to be free. The image's first row is the top of the map.
"""

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PureWindowsPath
from typing import Any, Literal, NamedTuple

import numpy as np

from bezierplan.schema import checked
from bezierplan.workspaces import robot
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.limits import check_numbers, check_thickness
from bezierplan.workspaces.text_file import number, read_text

logger = logging.getLogger(__name__)

Unknown = Literal["occupied", "free"]
"""What pixels that nobody has seen count as."""

MOST_PIXELS = 16_000_000
"""Most pixels of an image unless the description says otherwise: 4,000 x 4,000."""

_KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_DEFAULTS: dict[str, Any] = {
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
    "negate": 0,
    "mode": "trinary",
}
_MODES = ("trinary", "scale", "raw")
_TRUTHS = {
    "0": False,
    "1": True,
    "false": False,
    "true": True,
    "no": False,
    "yes": True,
    "off": False,
    "on": True,
}
"""What ROS reads as a truth value: YAML 1.1 has more of them than the YAML of this project."""

SMALLEST_YAW = 1e-6
"""A map that is turned by less, in radians, counts as not turned: over 1,000 m it is a
millimetre.
"""


class Shades(NamedTuple):
    """light: from 0 to 1. known: whether the place is known. of_pixels: (rows, columns) the number
    of the shade of each pixel, where there are few; None where each pixel has its own.
    """

    light: np.ndarray
    known: np.ndarray
    of_pixels: np.ndarray | None


def read(
    file: Path,
    folder: Path,
    unit: str,
    robot_radius: float = 0.0,
    most_pixels: int = MOST_PIXELS,
    unknown: Unknown = "occupied",
) -> Grid:
    """The grid of a map_server YAML file, one cell per pixel.

    folder: where the image must lie, also through links. robot_radius: in units; cells that come
    closer than that to an occupied cell or to the border also count as occupied.

    Raises ValueError, naming the key and what is expected.
    """
    content = _content(file)
    *corner, yaw = content["origin"]
    if math.isnan(yaw):
        logger.warning(
            "%s: origin: yaw %s counts as 0; "
            "map_saver writes it for an orientation that is not valid",
            file.name,
            yaw,
        )
        yaw = 0.0
    _expect(yaw == 0, "origin", f"yaw {yaw}", "a yaw of 0: a map that is not turned")
    content["origin"] = [*corner, yaw]
    grid = _grid(image_of(file, folder, content), content, unit, most_pixels, unknown)
    check_numbers(np.array(grid.bounds), "origin, resolution: the border")
    robot.check_radius(robot_radius)
    return robot.by_cells(grid, robot_radius) if robot_radius > 0 else grid


def read_image(
    file: Path,
    resolution: float,
    unit: str,
    most_pixels: int = MOST_PIXELS,
    unknown: Unknown = "occupied",
) -> Grid:
    """The grid of an image without a YAML file, with its lower left corner at 0, 0. resolution:
    units per pixel.

    Raises ValueError, naming the key and what is expected.
    """
    if not file.is_file():
        raise ValueError("cannot be read (no such file)")
    content = _DEFAULTS | {"image": file.name, "resolution": resolution, "origin": [0.0, 0.0, 0.0]}
    grid = _grid(file, content, unit, most_pixels, unknown)
    check_numbers(np.array(grid.bounds), "resolution: the border")
    return grid


def _grid(
    image: Path, content: dict[str, Any], unit: str, most_pixels: int, unknown: Unknown
) -> Grid:
    check_thickness(content["resolution"], "resolution:")
    occupied = _occupied(image, content, most_pixels, unknown)
    return Grid(
        occupied,
        float(content["resolution"]),
        unit,
        (float(content["origin"][0]), float(content["origin"][1])),
    )


def image_of(file: Path, folder: Path, content: dict[str, Any] | None = None) -> Path:
    """The image of a map_server YAML file, a regular file in a folder, also through links. Raises
    ValueError if there is none.

    ROS's map_saver writes the path at which it saved the image. On another machine, the image of
    that name beside the YAML file is meant.
    """
    name = (content or _content(file))["image"]
    for image in (
        file.parent / name,
        file.parent / Path(name).name,
        file.parent / PureWindowsPath(name).name,
    ):
        if _is_file_in(folder, image):
            return image
    raise ValueError(
        f"image: {name}: no such file in {file.parent}; expected the image beside its YAML file, "
        "not a link out of there"
    )


def _is_file_in(folder: Path, file: Path) -> bool:
    try:
        return file.is_file() and file.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError):  # a name that no file can have
        return False


def _content(file: Path) -> dict[str, Any]:
    """The keys of a map_server YAML file, checked; of its yaw, nan is kept."""
    content = checked.parse(read_text(file), file.name)
    if not isinstance(content, dict) or "image" not in content:
        raise ValueError(
            f"image: missing; expected the keys {', '.join(_KEYS)} of a ROS map_server file"
        )
    content = _DEFAULTS | content
    _expect(isinstance(content["image"], str), "image", content["image"], "the name of an image")
    for key in ("resolution", "occupied_thresh", "free_thresh"):
        _expect(_is_number(content.get(key)), key, content.get(key), "a number")
    _expect(
        0 < content["resolution"] < math.inf,
        "resolution",
        content["resolution"],
        "a number above 0",
    )
    _expect(
        0 <= content["occupied_thresh"] <= 1,
        "occupied_thresh",
        content["occupied_thresh"],
        "a number from 0 to 1",
    )
    free = content["free_thresh"]
    _expect(
        0 <= free <= content["occupied_thresh"],
        "free_thresh",
        free,
        "a number from 0 to occupied_thresh",
    )
    negate = _TRUTHS.get(str(content["negate"]).lower())
    _expect(negate is not None, "negate", content["negate"], "0 or 1")
    _expect(content["mode"] in _MODES, "mode", content["mode"], f"one of {', '.join(_MODES)}")
    origin: Any = content.get("origin")
    _expect(
        isinstance(origin, list) and len(origin) == 3 and all(map(_is_number, origin[:2])),
        "origin",
        origin,
        "[x, y, yaw]",
    )
    yaw = origin[2]
    if str(yaw).lower().lstrip("-+.") == "nan":
        yaw = math.nan
    else:
        _expect(_is_number(yaw), "origin", f"yaw {_told(yaw)}", "a number of radians")
        yaw = math.remainder(yaw, math.tau)
    return content | {
        "negate": negate,
        "origin": [*origin[:2], 0.0 if abs(yaw) <= SMALLEST_YAW else yaw],
    }


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _told(value: Any) -> str:
    """A value as its file has it: a number in quotes, which is text, with these."""
    if isinstance(value, str):
        with suppress(ValueError):
            number(value)
            return repr(value)
    return "missing" if value is None else str(value)


def _expect(right: bool, key: str, value: Any, wanted: str) -> None:
    if not right:
        raise ValueError(f"{key}: {_told(value)}; expected {wanted}")


def _occupied(
    file: Path, content: dict[str, Any], most_pixels: int, unknown: Unknown
) -> np.ndarray:
    """Which pixels count as occupied: bool (rows, columns), the bottom row first."""
    from PIL import Image

    with _without_limit(Image):
        try:
            with Image.open(file) as image:
                columns, rows = image.size
                shades = _shades(image) if columns * rows <= most_pixels else None
        except MemoryError:
            raise ValueError(
                f"image: {columns:,} x {rows:,} pixels: "
                "more than there is memory for; expected a smaller image"
            ) from None
        except Exception as error:  # of a damaged file each format raises another one
            raise ValueError(
                f"image: {content['image']}: cannot be read as an image ({type(error).__name__})"
            ) from None
    if shades is None:
        raise _too_large(columns, rows, most_pixels)
    free = _free(shades, content, unknown)
    return ~(free if shades.of_pixels is None else free[shades.of_pixels])[::-1]


def _free(shades: Shades, content: dict[str, Any], unknown: Unknown) -> np.ndarray:
    """Which shades count as free: bool, of their shape."""
    light, known = shades.light, shades.known
    if content["mode"] == "raw":
        share = np.rint(255 * light) / 100
        known = known & (share <= 1)
    else:
        share = light if content["negate"] else 1.0 - light
    free = (share < content["free_thresh"]) & known
    if unknown == "free":
        free |= ~known
        if content["mode"] == "trinary":
            free |= share <= content["occupied_thresh"]
    return free


@contextmanager
def _without_limit(reader: Any) -> Iterator[None]:
    """Without Pillow's own limit of pixels, which `most_pixels` could not raise."""
    limit, reader.MAX_IMAGE_PIXELS = reader.MAX_IMAGE_PIXELS, None
    try:
        yield
    finally:
        reader.MAX_IMAGE_PIXELS = limit


def _too_large(columns: int, rows: int, most_pixels: int) -> ValueError:
    size = f"{columns:,} x {rows:,} pixels"
    return ValueError(
        f"image: {size}; expected at most {most_pixels:,}; most_pixels raises the limit, as far "
        "as memory goes"
    )


def _shades(image: Any) -> Shades:
    """The shades of an image; the lightness of a pixel is the mean of its colours, and it is known
    unless it is transparent.
    """
    if image.mode.startswith("I"):
        return Shades(
            np.asarray(image, dtype=float) / 65535.0, np.ones(image.size[::-1], dtype=bool), None
        )
    transparent = "A" in image.getbands() or "transparency" in image.info
    if transparent or image.mode == "P":
        image = image.convert("RGBA")
    elif image.mode not in ("L", "RGB"):
        image = image.convert("L")
    values = np.asarray(image)
    if values.ndim == 2:
        return Shades(np.arange(256) / 255.0, np.ones(256, dtype=bool), values)
    known = values[..., 3] > 0 if values.shape[2] == 4 else np.ones(values.shape[:2], dtype=bool)
    return Shades(values[..., :3].mean(axis=2) / 255.0, known, None)
