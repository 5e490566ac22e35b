"""Drawings as maps: shapes, transforms and fill rules in closed form, and what is refused in one
line.
"""

import math
import re

import numpy as np
import pytest
import shapely

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.workspaces.svg import FLATNESS, polygons_from_svg

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">'


def area_of(content, head=HEAD, scale=1.0):
    """Area and bounds of what is blocked in a drawing."""
    polygons = polygons_from_svg(f"{head}{content}</svg>", "m", scale)
    union = shapely.union_all(
        [shapely.Polygon(outer, holes) for outer, *holes in polygons.obstacles]
    )
    return union.area, union.bounds


SQUARE = '<rect width="2" height="2"/>'

SHAPES = {
    "rect": ('<rect x="1" y="2" width="3" height="4"/>', 12, (1, 4, 4, 8)),
    "round rect": (
        '<rect x="1" y="2" width="4" height="4" rx="1"/>',
        16 - 4 + math.pi,
        (1, 4, 5, 8),
    ),
    "circle": ('<circle cx="5" cy="4" r="2"/>', 4 * math.pi, (3, 4, 7, 8)),
    "ellipse": ('<ellipse cx="5" cy="4" rx="2" ry="1"/>', 2 * math.pi, (3, 5, 7, 7)),
    "polygon": ('<polygon points="1,1 4,1 4,5"/>', 6, (1, 5, 4, 9)),
    "path": ('<path d="M1 1h3v3h-3z"/>', 9, (1, 6, 4, 9)),
    "open path that is filled": ('<path d="M1 1h3v3h-3"/>', 9, (1, 6, 4, 9)),
    "quadratic": ('<path d="M1 5 Q3 1 5 5 z"/>', 16 / 3, (1, 5, 5, 7)),
    "hole by direction": ('<path d="M1 1h6v6h-6z M2 2v2h2v-2z"/>', 32, (1, 3, 7, 9)),
    "no hole in one direction": ('<path d="M1 1h6v6h-6z M2 2h2v2h-2z"/>', 36, (1, 3, 7, 9)),
    "hole by even-odd": (
        '<path fill-rule="evenodd" d="M1 1h6v6h-6z M2 2h2v2h-2z"/>',
        32,
        (1, 3, 7, 9),
    ),
    "crosses itself": ('<path d="M1 1 L5 5 L5 1 L1 5 z"/>', 8, (1, 5, 5, 9)),
    "arc": ('<path d="M3 5 A2 2 0 0 1 7 5 z"/>', 2 * math.pi, (3, 5, 7, 7)),
    "group": ('<g transform="translate(1,2)"><rect width="3" height="4"/></g>', 12, (1, 4, 4, 8)),
    "scale, then move": (
        '<rect transform="translate(1 2) scale(2)" width="2" height="1"/>',
        8,
        (1, 6, 5, 8),
    ),
    "turned": (
        '<rect transform="rotate(90 5 5)" x="5" y="5" width="3" height="1"/>',
        3,
        (4, 2, 5, 5),
    ),
    "matrix": ('<circle transform="matrix(2 0 0 1 5 5)" r="1"/>', 2 * math.pi, (3, 4, 7, 6)),
    "not drawn": (
        '<defs><rect width="1" height="1"/></defs><rect display="none" width="9" '
        'height="9"/><rect width="2" height="2"/>',
        4,
        (0, 8, 2, 10),
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_have_their_area_and_their_place(name):
    content, area, bounds = SHAPES[name]
    found, box = area_of(content)
    assert found == pytest.approx(area, abs=10 * 10 * FLATNESS * 2)
    assert box == pytest.approx(bounds, abs=10 * FLATNESS)


def test_curves_are_off_by_less_than_is_said():
    polygons = polygons_from_svg(f'{HEAD}<circle cx="5" cy="5" r="4"/></svg>', "m")
    ring = shapely.Polygon(polygons.obstacles[0][0]).exterior
    circle = [
        (5 + 4 * math.cos(a), 5 + 4 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 3_001)
    ]
    assert max(shapely.distance(shapely.points(circle), ring)) <= 10 * FLATNESS


def test_the_border_is_the_view_box_scaled_and_from_its_lower_left_corner():
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="20cm" viewBox="-5 -5 20 10">'
    polygons = polygons_from_svg(f'{head}<rect x="-5" y="3" width="2" height="2"/></svg>', "m", 0.5)
    assert polygons.bounds == (0, 10, 0, 5)
    assert shapely.Polygon(polygons.obstacles[0][0]).bounds == pytest.approx(
        (0, 0, 1, 1), abs=1e-12
    )
    assert polygons_from_svg('<svg width="20px" height="10"/>', "m").bounds == (0, 20, 0, 10)


def test_a_drawing_is_planned_on_by_a_planner_of_polygons_and_one_of_cells(capsys, tmp_path):
    file = tmp_path / "Room.SVG"
    file.write_text(f'{HEAD}<!-- a wall --><rect x="4" y="0" width="2" height="6"/></svg>')
    main(["plan", str(file), "--start", "1,8", "--target", "9,8"])
    told = capsys.readouterr().out
    length = 2 * math.hypot(3, 4) + 2
    assert f"shortest path   {length:.6g} m" in told
    assert "feasible        yes" in told
    main(
        [
            "plan",
            str(file),
            "--start",
            "1,8",
            "--target",
            "9,8",
            "--like",
            "song2016/smooth",
            "--resolution",
            "1",
            "--cell",
            "0.5",
        ]
    )
    assert f"shortest path   {length:.6g} m" in capsys.readouterr().out
    wide = bp.read_map(file, robot_radius=0.5, resolution=2.0)
    assert wide.bounds == pytest.approx((0.5, 19.5, 0.5, 19.5), abs=1e-8)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("<text>wall</text>", "text 1: has no outline that is read; expected only path, polygon"),
        ('<image href="a.png"/>', "image 1: has no outline"),
        ('<use href="#a"/>', "use 1: has no outline"),
        ('<line x2="1"/>', "line 1: has no outline"),
        (
            '<rect id="wall" transform="spin(3)" width="1" height="1"/>',
            "rect wall: transform: spin(3); expected matrix",
        ),
        ('<g transform="translate(3mm)"/>', "g 1: transform: translate(3mm); expected"),
        (
            '<g transform="matrix(1 2)"/>',
            "g 1: transform: matrix(1 2); expected 6 numbers for matrix",
        ),
        (
            '<rect clip-path="url(#a)" width="1" height="1"/>',
            "rect 1: clip-path: it changes what is seen",
        ),
        ('<rect style="mask: url(#a)" width="1" height="1"/>', "rect 1: mask: it changes"),
        ('<rect width="10%" height="1"/>', "rect 1: width: 10%; expected a number"),
        ('<circle r="-1"/>', "circle 1: r: -1; expected numbers of at least 0"),
        ('<path d="M0 0 L1"/>', "path 1: d: M0 0 L1: cannot be read"),
        ('<path d="M0 0 L1 1 wall"/>', "path 1: d: M0 0 L1 1 wall: cannot be read"),
        ('<path d="L1 1 2 2"/>', "path 1: d: L1 1 2 2: cannot be read"),
        ('<path fill="none" d="M1 1 L2 2 L3 1"/>', "path 1: a line that is open and not filled"),
        ('<polygon points="1,1 2"/>', "polygon 1: points: 1,1 2; expected pairs"),
        ('<rect width="1e300" height="1"/>', "is not a coordinate"),
        ('<rect width="1e-8" height="1"/>', "expected at least 1e-06"),
        ("<g>", "not an SVG drawing (mismatched tag"),
    ],
)
def test_what_has_no_outline_is_refused_in_one_line(capsys, tmp_path, content, told):
    file = tmp_path / "room.svg"
    file.write_text(f"{HEAD}{content}</svg>")
    with pytest.raises(SystemExit) as found:
        main(["plan", str(file), "--start", "1,1", "--target", "9,9"])
    error = capsys.readouterr().err
    assert found.value.code == 2
    assert error.startswith(f"{file}: ")
    assert error.count("\n") == 1
    assert told in error


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("<svg/>", "viewBox: missing; expected four numbers"),
        ('<svg viewBox="0 0 10"/>', "viewBox: 0 0 10; expected four numbers"),
        ('<svg viewBox="0 0 0 10"/>', "0 x 10; expected numbers above 0"),
        ('<svg width="10cm" height="10cm"/>', "viewBox: missing"),
        ("<html/>", "begins with html; expected svg"),
        ('<!DOCTYPE svg [<!ENTITY a "b">]><svg/>', "it declares entities"),
        ("wall", "not an SVG drawing (syntax error"),
    ],
)
def test_what_is_no_drawing_with_a_border_is_refused(text, told):
    with pytest.raises(ValueError, match=re.escape(told)) as found:
        polygons_from_svg(text, "m")
    assert "\n" not in str(found.value)


def test_options_of_other_maps_are_refused(tmp_path):
    file = tmp_path / "room.svg"
    file.write_text(f"{HEAD}</svg>")
    with pytest.raises(ValueError, match=r"margin: only for polygons; .* is an SVG drawing"):
        bp.read_map(file, margin=1.0)
    with pytest.raises(ValueError, match="unknown: only for"):
        bp.read_map(file, unknown="free")
