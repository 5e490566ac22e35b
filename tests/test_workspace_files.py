"""Workspaces from descriptions and files: every fault in one line, and back from text bit by
bit.
"""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from fields import BENCHMARK_MAPS, CELLS
from hypothesis import example, given
from hypothesis import strategies as st

from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region, is_blocked
from bezierplan.running import problems
from bezierplan.running.descriptions import Descriptions
from bezierplan.workspaces import files
from bezierplan.workspaces.geojson import read_geojson
from bezierplan.workspaces.kinds import random_circles

SQUARE = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]
BORDER = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]


def geojson(*obstacles, border=BORDER):
    roles = [("border", [border]), *(("obstacle", rings) for rings in obstacles)]
    features = [
        {"properties": {"role": role}, "geometry": {"type": "Polygon", "coordinates": rings}}
        for role, rings in roles
    ]
    return json.dumps({"type": "FeatureCollection", "features": features})


def closed(*positions):
    return [*map(list, positions), list(positions[0])]


def moved(x, y):
    return [[a + x, b + y] for a, b in SQUARE]


def feature(properties, geometry):
    """A GeoJSON file with a border and one further feature."""
    (border,) = json.loads(geojson())["features"]
    return json.dumps({"features": [border, {"properties": properties, "geometry": geometry}]})


def polygon(rings, role="obstacle"):
    return feature({"role": role}, {"type": "Polygon", "coordinates": rings})


EXPECTED = "geometry: expected a Polygon, a MultiPolygon"
POLYGON_FAULTS = {
    "not JSON": ("{", "not GeoJSON"),
    "a key twice": (
        geojson().replace("{", '{"features": [], ', 1),
        "features: this key is given tw",
    ),
    "an open ring": (geojson([SQUARE[:-1]]), "a ring begins at .* and ends at"),
    "a list": ("[]", "not GeoJSON: expected an object"),
    "role misspelt": (
        polygon([SQUARE], "obstacel"),
        "feature 1: properties: role: 'obstacel': unknown; did you mean obstacle?",
    ),
    "no border": (json.dumps({"features": []}), "no border; expected a polygon with role border"),
    "two borders": (polygon([BORDER], "border"), "2 polygons with role border; expected one"),
    "longitudes": (
        json.dumps({"features": [], "crs": {"properties": {"name": "urn:ogc:def:crs:OGC::CRS84"}}}),
        "crs: longitudes and latitudes, in degrees; expected x and y as lengths",
    ),
    "degrees of a country": (
        geojson(border=closed((6, 47), (15, 47), (15, 55))),
        "places about 6, 47 with an extent of 9 look like degrees",
    ),
    "border crossing itself": (
        geojson(border=closed((0, 0), (10, 10), (10, 0), (0, 10))),
        r"feature 0 \(border\): Self-intersection",
    ),
    "hole outside": (polygon([SQUARE, moved(3, 3)]), "Hole lies outside shell"),
    "too few positions": (polygon([[[1, 1], [2, 2]]]), EXPECTED),
    "too large": (
        geojson(border=[[0, 0], [2e5, 0], [2e5, 10], [0, 10], [0, 0]]),
        "200000 is not a coordinate; expected finite numbers of at most 100000",
    ),
    "gap between obstacles": (geojson([SQUARE], [moved(2 + 5e-8, 0)]), "a gap below 1e-07"),
    "gap to the border": (geojson([moved(4 - 5e-8, 0)]), "a gap below 1e-07"),
    "gap between arms": (
        geojson(
            [closed((1, 1), (4, 1), (4, 4), (2, 4), (2, 2), (1.5, 2.5), (2 - 5e-8, 3), (1, 3))]
        ),
        r"feature 1 \(obstacle\): thickness .*e-08; expected at least 1e-06",
    ),
    "thin wall": (
        geojson([closed((5, 0), (5 + 2e-9, 0), (5 + 2e-9, 9), (5, 9))]),
        r"feature 1 \(obstacle\): thickness 2e-09; expected at least 1e-06",
    ),
    "needle": (geojson([closed((1, 1), (9, 1.001), (1, 1.002))]), "an angle below 0.001 rad"),
    "sharp notch": (
        geojson([closed((1, 1), (9, 1), (9, 2.998), (2, 2), (9, 3), (1, 3))]),
        "an angle below 0.001 rad",
    ),
}


@pytest.mark.parametrize("fault", POLYGON_FAULTS)
def test_polygon_fault_is_told(fault):
    text, told = POLYGON_FAULTS[fault]
    with pytest.raises(ValueError, match=told) as caught:
        read_geojson(text, "m")
    assert "\n" not in str(caught.value)


def test_no_obstacle_vanishes():
    """Neither one that shares its id with another, nor the last corner of one."""
    same = [
        {
            "properties": {"role": "obstacle", "id": 1},
            "geometry": {"type": "Polygon", "coordinates": [moved(x, 0)]},
        }
        for x in (-3, 0, 3)
    ]
    border = json.loads(geojson())["features"]
    found = read_geojson(json.dumps({"features": border + same}), "m")
    assert [ring.tolist() for (ring,) in found.obstacles] == [moved(x, 0)[:-1] for x in (-3, 0, 3)]


SHAPE = {"type": "Polygon", "coordinates": [SQUARE]}
FOREIGN = {
    "no role": feature(None, SHAPE),
    "roles of other programs": feature({"building": "yes"}, SHAPE),
    "many parts": feature({}, {"type": "MultiPolygon", "coordinates": [[SQUARE], [moved(3, 3)]]}),
    "a collection": feature(
        {},
        {
            "type": "GeometryCollection",
            "geometries": [SHAPE, {"type": "MultiPolygon", "coordinates": [[SQUARE]]}],
        },
    ),
    "heights": feature(
        {}, {"type": "Polygon", "coordinates": [[[*place, 7.5] for place in SQUARE]]}
    ),
    "a bbox": json.dumps(
        {"type": "FeatureCollection", "bbox": [0, 0, 10, 10], "features": [{"geometry": SHAPE}]}
    ),
    "a bbox with heights": json.dumps(
        {"bbox": [0, 0, -1, 10, 10, 5], "features": [{"type": "Feature", "geometry": SHAPE}]}
    ),
    "one feature": json.dumps({"type": "Feature", "bbox": [0, 0, 10, 10], "geometry": SHAPE}),
    "a bare geometry": json.dumps(SHAPE | {"bbox": [0, 0, 10, 10]}),
}


@pytest.mark.parametrize("form", FOREIGN)
def test_files_of_gis_programs_are_read_as_they_are(form, caplog):
    found = read_geojson(FOREIGN[form], "m")
    assert found.bounds == (0, 10, 0, 10)
    assert found.obstacles[0][0].tolist() == SQUARE[:-1]
    assert len(found.obstacles) == 1 + (form in ("many parts", "a collection"))
    assert not caplog.messages


def test_rows_of_a_table_without_a_geometry_are_skipped_with_a_word(caplog):
    rows = [{"type": "Feature", "properties": None, "geometry": None}, {"geometry": SHAPE}]
    file = json.dumps({"features": rows, "bbox": [0, 0, 10, 10]})
    assert [rings[0].tolist() for rings in read_geojson(file, "m").obstacles] == [SQUARE[:-1]]
    assert caplog.messages == ["feature 0 (obstacle): without a geometry, and skipped"]


def test_what_lies_outside_a_border_of_any_shape_is_blocked():
    ell = closed((0, 0), (10, 0), (10, 4), (4, 4), (4, 10), (0, 10))
    courtyard = json.loads(polygon([ell, closed((1, 1), (3, 1), (3, 3), (1, 3))], "border"))[
        "features"
    ][1]
    found = build_region(read_geojson(json.dumps({"features": [courtyard]}), "m"))
    for point, free in {
        (9, 3): True,
        (2, 9): True,
        (5, 5): False,
        (4.001, 4.001): False,
        (2, 2): False,
        (3.5, 3.5): True,
    }.items():
        assert is_blocked(found, point) != free


def test_obstacles_are_cut_at_the_border_and_that_is_told(caplog):
    found = read_geojson(geojson([moved(5, 0)], [moved(20, 20)], [SQUARE]), "m")
    assert sorted(np.concatenate([ring for (ring,) in found.obstacles]).tolist()) == sorted(
        [[9, 4], [10, 4], [10, 6], [9, 6], *SQUARE[:-1]]
    )
    assert caplog.messages == [
        f"feature {number} (obstacle): beyond the border, and cut there" for number in (1, 2)
    ]


def test_start_and_target_features_are_left_out():
    place = {"type": "Point", "coordinates": [1, 1]}
    assert read_geojson(feature({"role": "start"}, place), "m").obstacles == ()


# The others are in `test_study_faults`.
GRID_FAULTS = {
    "not UTF-8": (b"..\n\xff.\n", "byte 3 is not UTF-8"),
    "too large": (b"." * (2**24 + 1), "expected at most 16,777,216"),
}


def load_cells(folder, cell=1.0):
    return files.load({"kind": "grid", "unit": "m", "file": "map", "cell": cell}, Path(folder))


@pytest.mark.parametrize("fault", GRID_FAULTS)
def test_map_fault_is_told(fault, tmp_path):
    content, told = GRID_FAULTS[fault]
    (tmp_path / "map").write_bytes(content)
    with pytest.raises(ValueError, match=told) as caught:
        load_cells(tmp_path)
    assert "map: " in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("cell", [float("inf"), 1e5])
def test_cell_beyond_all_coordinates_is_told(cell, tmp_path):
    (tmp_path / "map").write_text("..\n")
    with pytest.raises(ValueError, match=r"map: cell: .*: the border: .* is not a coordinate"):
        load_cells(tmp_path, cell)


@pytest.mark.parametrize(
    "obstacles",
    [
        ([SQUARE],),
        ([SQUARE], [moved(2, 0)]),
        ([moved(4, 0)],),
        ([SQUARE, [[4.5, 4.5], [5, 5], [5, 4.5], [4.5, 4.5]]],),
    ],
)
def test_touching_polygons_and_holes_are_accepted(obstacles):
    assert len(read_geojson(geojson(*obstacles), "m").obstacles) == len(obstacles)


# So far out halving ends at units in the last place that are more than a rounding error.
@example(-6.04, np.pi / 2, 0.001, 3e4, "cap")
@given(
    st.floats(-9.5, -0.1),
    st.floats(0, np.pi),
    st.floats(1e-3, 3),
    st.sampled_from([0.0, 3e4]),
    st.sampled_from(["wall", "wedge", "cap"]),
)
def test_the_checker_blocks_the_middle_of_every_polygon_that_is_accepted(
    exponent, turn, length, far, form
):
    thickness = 10**exponent
    shapes = {
        "wall": [(x * length, y * thickness) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
        "wedge": [(-length, -2 * thickness), (2 * length, 0), (-length, 2 * thickness)],
        "cap": [(-length, -thickness), (length, -thickness), (0, 2 * thickness)],
    }
    middle = np.array([far + 5.0, 5.0])
    along = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    corners = (middle + np.array(shapes[form]) @ along).tolist()
    border = closed((far, 0), (far + 10, 0), (far + 10, 10), (far, 10))
    try:
        found = read_geojson(geojson([closed(*corners)], border=border), "m")
    except ValueError:
        assert thickness < 1e-6 or thickness < length * 1e-3
        return
    across = np.stack([middle - along[1] * 1.5 * thickness, middle + along[1] * 4 * thickness])
    assert not check(across[None], build_region(found)).feasible


@given(st.floats(-12, 0), st.integers(0, 3), st.booleans())
def test_the_checker_blocks_occupied_cells_of_every_side_that_is_accepted(exponent, row, falling):
    cell = 10**exponent
    with TemporaryDirectory() as folder:
        (Path(folder) / "map").write_text("....\n.##.\n.##.\n....\n")
        try:
            found = load_cells(folder, cell)
        except ValueError:
            assert cell < 1e-6
            return
    line = (
        np.array([[0.5, 0.5 + row], [3.5, 3.5 - row]])
        if falling
        else np.array([[0.5, 1.5], [3.5, 2.5]])
    )
    assert not check(line[None] * cell, build_region(found)).feasible


CIRCLE_FAULTS = {
    "radius below the tolerance": (
        [-5, 5, -5, 5],
        [[0, 0, 1e-12]],
        "circles: circle 0: radius 1e-12; expected at least 1e-06",
    ),
    "border below the tolerance": ([-5, 5, 0, 1e-9], [], "side 1e-09; expected at least 1e-06"),
    "gap between circles": (
        [-5, 5, -5, 5],
        [[0, 0, 1], [2 + 5e-8, 0, 1]],
        "circle 0: a gap below 1e-07",
    ),
    "gap to the border": ([-5, 5, -5, 5], [[4 - 5e-8, 0, 1]], "circle 0: a gap below 1e-07"),
}


@pytest.mark.parametrize("fault", CIRCLE_FAULTS)
def test_circle_fault_is_told(fault):
    bounds, circles, told = CIRCLE_FAULTS[fault]
    with pytest.raises(ValueError, match=told):
        files.load({"kind": "circles", "unit": "m", "bounds": bounds, "circles": circles}, Path())


def descriptions():
    yield {
        "kind": "circles",
        "unit": "m",
        "bounds": [-1, 1, -1, 1],
        "circles": [[0.1, 0.2, 0.3], [1 / 3, 0, 0.1]],
    }
    yield {"kind": "grid", "unit": "cell", "file": CELLS.name, "cell": 10}
    for file in sorted(BENCHMARK_MAPS.glob("*.geojson")):
        yield {"kind": "polygons", "unit": "m", "file": str(file)}
        yield {"kind": "raster", "unit": "m", "file": str(file), "cell": 0.4, "rule": "overlap"}


@pytest.mark.parametrize(
    "description",
    list(descriptions()),
    ids=lambda each: f"{each['kind']} {Path(each.get('file', '')).stem}",
)
def test_text_gives_a_workspace_back_bit_by_bit(description):
    text = files.write_json(files.load(description, CELLS.parent))
    assert files.write_json(files.read_json(text)) == text


RANDOM = {"bounds": [-10, 10, -10, 10], "radius": 2.0, "circles": 10, "unit": "unit"}
PLACE = {"start": [0, 0], "target": [4, 6], "obstacles": 10, "layout": 0}


def test_layout_depends_on_its_names_alone():
    one, again, other = (
        random_circles.draw(RANDOM, PLACE | {"layout": number}, "study/random").centres
        for number in (3, 3, 4)
    )
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_problems_in_random_circles_have_free_ends():
    """Circles so large and many that one would cover the other end if only one were kept free."""
    described = {"workspace": "close", "start": [-6, 0], "target": [4, 6], "obstacles": 10}
    job = Descriptions(
        "study",
        {f"p{number}": described | {"layout": number} for number in range(20)},
        {"close": RANDOM | {"kind": "random_circles", "radius": 5.0}},
    )
    drawn, _ = problems.build_all(job, Path())
    assert len(drawn) == 20
    for problem in drawn.values():
        assert len(problem.workspace.radii) == 10
        for end in (problem.start, problem.target):
            assert np.hypot(*(problem.workspace.centres - end).T).min() > 5.0


def test_bounds_of_random_circles_beyond_all_coordinates_are_told():
    with pytest.raises(ValueError, match=r"^bounds: 200000 is not a coordinate"):
        random_circles.draw(RANDOM | {"bounds": [0, 2e5, 0, 10]}, PLACE, "study/random")


def test_layout_that_cannot_be_drawn_is_given_up():
    with pytest.raises(ValueError, match="radius: no circle keeps 40 away from start and target"):
        random_circles.draw(RANDOM | {"radius": 40.0}, PLACE, "study/random")
