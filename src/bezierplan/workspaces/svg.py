"""Polygons from an SVG drawing: its shapes are obstacles, and its `viewBox` is the border.

Paths, polygons, rectangles, circles and ellipses count, with their transforms and fill rules,
whatever their colour. Curves become polygons that are off by at most `FLATNESS` of the border's
longer side. Coordinates are user units times a scale, from the lower left corner of the border,
upwards. What has another shape than it seems, such as text, images, lines, and what is clipped, is
refused by name.
"""

import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree as ET

import numpy as np

from bezierplan.workspaces import geojson
from bezierplan.workspaces.geojson import Shape
from bezierplan.workspaces.limits import FARTHEST, check_bounds, check_numbers
from bezierplan.workspaces.polygons import Polygons, parts
from bezierplan.workspaces.text_file import number

if TYPE_CHECKING:
    import shapely

FLATNESS = 1e-5
"""By how much a polygon is off its curve, at most, as a share of the border's longer side."""

_SHAPES = {
    "path": (),
    "polygon": (),
    "polyline": (),
    "rect": ("width", "height"),
    "circle": ("r",),
    "ellipse": ("rx", "ry"),
}
"""Elements that are obstacles, and the lengths without which an element is not drawn."""

_PLACES = {"rect": ("x", "y", "rx", "ry"), "circle": ("cx", "cy"), "ellipse": ("cx", "cy")}
_GROUPS = ("svg", "g", "a")
_NOT_DRAWN = ("defs", "title", "desc", "metadata", "style")
_ALTERING = ("clip-path", "mask", "filter")
"""Properties that change what is seen of a shape."""

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_CALL = re.compile(
    rf"\s*([a-zA-Z]+)\s*\(\s*({_NUMBER}(?:[\s,]+{_NUMBER}|(?=[-+]){_NUMBER})*)\s*\)[\s,]*", re.ASCII
)
_ARGUMENTS = {
    "matrix": (6,),
    "translate": (1, 2),
    "scale": (1, 2),
    "rotate": (1, 3),
    "skewX": (1,),
    "skewY": (1,),
}
"""Transforms, and with how many numbers each is written."""

_PATH = re.compile(r"\s*([Mm][MmZzLlHhVvCcSsQqTtAa\d\s.,eE+-]*)?", re.ASCII)

# Points closer than this, as a share of the flatness, are one.
_SAME_POINT = 1e-7

_SIDES = 10_000
"""Most sides of a polygon for one curve."""


class _Style(NamedTuple):
    """What an element has from those around it: properties by name, and all transforms' words."""

    properties: dict[str, str]
    transform: str


def polygons_from_svg(text: str, unit: str, scale: float = 1.0) -> Polygons:
    """Polygons from the text of an SVG file. scale: length of a user unit, in units. Warns of
    obstacles that are cut at the border.

    Raises ValueError, naming the element, for text that is not SVG, a drawing without a `viewBox`
    or a size in user units, elements that are no shapes, transforms and paths that cannot be read,
    and obstacles that are too thin for the checker.
    """
    root = _root(text)
    left, top, width, height = _view_box(root)
    limits = 0.0, scale * width, 0.0, scale * height
    check_numbers(np.array(limits), "viewBox", FARTHEST)
    check_bounds(limits)
    obstacles: list[Shape] = []
    for name, element, style in _drawn(root, _styled("svg", root, _Style({}, ""))):
        outlines = _rings(name, element, style, FLATNESS * max(width, height))
        rings = [(ring * (1, -1) + (-left, top + height)) * scale for ring in outlines]
        faces = _filled(rings, style.properties["fill-rule"] == "evenodd")
        obstacles += [Shape("obstacle", name, geojson.rings_of(face)) for face in faces]
    if sum(len(ring) for shape in obstacles for ring in shape.rings) > geojson.MOST_POSITIONS:
        raise ValueError(
            f"more than {geojson.MOST_POSITIONS:,} positions; expected at most so many"
        )
    for shape in obstacles:
        check_numbers(np.concatenate(shape.rings), shape.name, FARTHEST)
    return Polygons(limits, tuple(geojson.within(limits, obstacles)), unit)


def _root(text: str) -> ET.Element:
    if "<!ENTITY" in text:
        raise ValueError(
            "not an SVG drawing that is read: it declares entities; expected one without"
        )
    try:
        root = ET.fromstring(text)
    except ET.ParseError as error:
        raise ValueError(f"not an SVG drawing ({error})") from None
    if _tag(root) != "svg":
        raise ValueError(f"not an SVG drawing: begins with {str(root.tag)[:60]}; expected svg")
    return root


def _tag(element: ET.Element) -> str:
    """The name of an element, without SVG's namespace."""
    return str(element.tag).removeprefix("{http://www.w3.org/2000/svg}")


def _view_box(root: ET.Element) -> list[float]:
    """x, y, width and height of the drawing, in user units."""
    try:
        if "viewBox" in root.attrib:
            left, top, width, height = (
                number(word) for word in re.split(r"[\s,]+", root.attrib["viewBox"].strip())
            )
        else:
            left, top, width, height = (
                0.0,
                0.0,
                *(
                    number(root.attrib[side].strip().removesuffix("px"))
                    for side in ("width", "height")
                ),
            )
    except (KeyError, ValueError):
        told = root.attrib.get("viewBox", "missing")
        raise ValueError(
            f"viewBox: {told[:60]}; expected four numbers, or a width and a height without a unit"
        ) from None
    if not (width > 0 and height > 0):
        raise ValueError(
            f"viewBox: {root.attrib.get('viewBox', '')}: "
            f"{width:g} x {height:g}; expected numbers above 0"
        )
    return [left, top, width, height]


def _drawn(
    element: ET.Element, around: _Style, depth: int = 0
) -> Iterator[tuple[str, ET.Element, _Style]]:
    """The shapes of a drawing with their names and what they have from the elements around them."""
    if depth > 200:
        raise ValueError("elements are nested too deeply; expected at most 200 levels")
    for count, child in enumerate(element, start=1):
        tag = _tag(child)
        if tag.startswith("{") or not isinstance(child.tag, str) or tag in _NOT_DRAWN:
            continue  # of another program, or a comment
        name = f"{tag} {child.attrib.get('id', count)}"
        style = _styled(name, child, around)
        if style.properties["display"] == "none":
            continue
        if tag in _GROUPS[1:]:
            yield from _drawn(child, style, depth + 1)
        elif tag in _SHAPES:
            yield name, child, style
        else:
            raise ValueError(
                f"{name}: has no outline that is read; expected only {', '.join(_SHAPES)} and "
                "groups of these"
            )


def _styled(name: str, element: ET.Element, around: _Style) -> _Style:
    pairs = (
        pair.split(":", 1) for pair in element.attrib.get("style", "").split(";") if ":" in pair
    )
    attributes = element.attrib | {key.strip(): value.strip() for key, value in pairs}
    for altering in _ALTERING:
        if attributes.get(altering, "none") != "none":
            raise ValueError(
                f"{name}: {altering}: it changes what is seen of a shape; expected none"
            )
    transform = attributes.get("transform", "")
    if "transform" in attributes:
        _check_transform(name, transform)
    inherited = {
        key: attributes.get(key, around.properties.get(key, ""))
        for key in ("fill", "fill-rule", "display")
    }
    return _Style(inherited, f"{around.transform} {transform}".strip())


def _check_transform(name: str, words: str) -> None:
    """Raise ValueError for a transform that svgelements would leave out without a word."""
    at, where = 0, f"{name}: transform: {words[:60]}"
    while at < len(words.rstrip()):
        call = _CALL.match(words, at)
        if not call or call[1] not in _ARGUMENTS:
            raise ValueError(f"{where}; expected {', '.join(_ARGUMENTS)} with numbers")
        if len(re.findall(_NUMBER, call[2])) not in _ARGUMENTS[call[1]]:
            raise ValueError(
                f"{where}; expected {' or '.join(map(str, _ARGUMENTS[call[1]]))} "
                f"numbers for {call[1]}"
            )
        at = call.end()


def _rings(name: str, element: ET.Element, style: _Style, flatness: float) -> list[np.ndarray]:
    """The outlines (n, 2) of a shape, in user units."""
    import svgelements

    path = _path(name, element)
    if path is None:
        return []
    path = svgelements.Path(path) * svgelements.Matrix(style.transform)
    path.reify()
    rings: list[list[Any]] = []
    for segment in path:
        if isinstance(segment, svgelements.Move):
            rings.append([segment.end])
        elif isinstance(segment, svgelements.Line | svgelements.Close):
            rings[-1].append(segment.end)
        else:
            count = _sides(name, segment, flatness)
            rings[-1] += [segment.point(step / count) for step in range(1, count)] + [segment.end]
    arrays = [
        np.array([(float(point.x), float(point.y)) for point in ring if point is not None])
        for ring in rings
    ]
    arrays = [_distinct(ring, _SAME_POINT * flatness) for ring in arrays if len(ring) > 1]
    if style.properties["fill"] == "none" and any(np.any(ring[0] != ring[-1]) for ring in arrays):
        raise ValueError(f"{name}: a line that is open and not filled; expected closed outlines")
    return arrays


def _distinct(ring: np.ndarray, apart: float) -> np.ndarray:
    """A ring (n, 2) without points as good as the one before: arcs end where rounding puts them."""
    ring = ring[np.append(True, np.hypot(*np.diff(ring, axis=0).T) > apart)]
    if math.dist(ring[0], ring[-1]) <= apart:
        ring[-1] = ring[0]
    return ring


def _path(name: str, element: ET.Element) -> Any:
    """The outline of a shape, as svgelements takes it; None of one that is not drawn."""
    import svgelements

    tag = _tag(element)
    if tag == "path":
        words = element.attrib.get("d", "")
        if not _PATH.fullmatch(words):
            raise ValueError(
                f"{name}: d: {words[:60]}: cannot be read; expected commands of a path and numbers"
            )
        try:
            return svgelements.Path(words) if words.strip() else None
        except (ValueError, AttributeError, IndexError, TypeError):
            raise ValueError(
                f"{name}: d: {words[:60]}: cannot be read; "
                "expected commands of a path with their numbers"
            ) from None
    if tag in ("polygon", "polyline"):
        numbers = re.split(r"[\s,]+|(?<=\d)(?=[-+])", element.attrib.get("points", "").strip())
        try:
            points = np.array([number(word) for word in numbers if word]).reshape(-1, 2)
        except ValueError:
            raise ValueError(
                f"{name}: points: {element.attrib.get('points', '')[:60]}; "
                "expected pairs of numbers"
            ) from None
        closed = tag == "polygon" or len(points) == 0
        lines = " L ".join(f"{x!r},{y!r}" for x, y in points.tolist())
        return svgelements.Path(f"M {lines}{' Z' if closed else ''}") if len(points) else None
    lengths = {}
    for key in (*_SHAPES[tag], *_PLACES[tag]):
        try:
            lengths[key] = (
                number(element.attrib[key].strip().removesuffix("px"))
                if key in element.attrib
                else 0.0
            )
        except ValueError:
            raise ValueError(
                f"{name}: {key}: {element.attrib[key][:60]}; expected a number of user units"
            ) from None
    if min(lengths[key] for key in _SHAPES[tag]) < 0:
        raise ValueError(
            f"{name}: {', '.join(f'{key}: {lengths[key]:g}' for key in _SHAPES[tag])}; expected "
            "numbers of at least 0"
        )
    if min(lengths[key] for key in _SHAPES[tag]) == 0:
        return None
    if tag == "rect":  # of two radii, the one that is not given is the other
        rx, ry = (lengths[key] if key in element.attrib else None for key in ("rx", "ry"))
        lengths |= {
            "rx": rx if rx is not None else ry or 0.0,
            "ry": ry if ry is not None else rx or 0.0,
        }
    return {"rect": svgelements.Rect, "circle": svgelements.Circle, "ellipse": svgelements.Ellipse}[
        tag
    ](**lengths)


def _sides(name: str, segment: Any, flatness: float) -> int:
    """How many sides a polygon needs for a curve, by its largest second derivative or radius."""
    import svgelements

    if isinstance(segment, svgelements.Arc):
        radius = max(segment.rx, segment.ry)
        count = abs(segment.sweep) / (2 * math.acos(1 - min(flatness / radius, 1))) if radius else 1
    else:
        points = np.array(
            [(float(point.x), float(point.y)) for point in segment if point is not None]
        )
        degree = len(points) - 1
        bend = degree * (degree - 1) * np.hypot(*np.diff(points, n=2, axis=0).T).max(initial=0.0)
        count = math.sqrt(bend / (8 * flatness))
    if not count <= _SIDES:
        raise ValueError(f"{name}: a curve far larger than the border; expected one of its size")
    return max(1, math.ceil(count))


def _filled(rings: list[np.ndarray], even_odd: bool) -> list["shapely.Polygon"]:
    """The polygons that rings (n, 2) fill, which may cross: the faces around which they wind."""
    import shapely

    closed = [np.vstack([ring, ring[:1]]) for ring in rings if len(np.unique(ring, axis=0)) > 2]
    if not closed:
        return []
    faces = shapely.get_parts(
        shapely.polygonize([shapely.union_all([shapely.LineString(ring) for ring in closed])])
    )
    inside = []
    for face in faces:
        point = face.representative_point()
        winding = sum(_winding(ring, point.x, point.y) for ring in closed)
        if winding % 2 if even_odd else winding:
            inside.append(face)
    return parts(shapely.union_all(inside))


def _winding(ring: np.ndarray, x: float, y: float) -> int:
    """How often a closed ring (n, 2) winds around a point, by the sides that cross a ray from it to
    the right.
    """
    begin, end = ring[:-1], ring[1:]
    upward = (begin[:, 1] <= y) & (end[:, 1] > y)
    downward = (begin[:, 1] > y) & (end[:, 1] <= y)
    crossing = upward | downward
    a, b = begin[crossing], end[crossing]
    right = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]) > x
    return int(upward[crossing][right].sum()) - int(downward[crossing][right].sum())
