"""Workspaces from descriptions and files: every fault in one line, and back from text bit by bit."""

import json
from pathlib import Path

import numpy as np
import pytest
from fields import BENCHMARK_MAPS

from bezierplan.workspaces import files, random_circles

MAPS = Path(__file__).parent / "data" / "maps"
SQUARE = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]
BORDER = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]


def geojson(*obstacles, border=BORDER):
    roles = [("border", [border]), *(("obstacle", rings) for rings in obstacles)]
    features = [{"properties": {"role": role}, "geometry": {"type": "Polygon", "coordinates": rings}} for role, rings in roles]
    return json.dumps({"type": "FeatureCollection", "features": features})


def moved(x, y):
    return [[a + x, b + y] for a, b in SQUARE]


POLYGON_FAULTS = {
    "not JSON": ("{", "not a GeoJSON feature collection"),
    "no features": ("{}", "not a GeoJSON feature collection"),
    "no role": (json.dumps({"features": [{"properties": {}, "geometry": {"coordinates": []}}]}), "not a GeoJSON feature collection"),
    "no border": (json.dumps({"features": []}), "0 features with role border"),
    "border no rectangle": (geojson(border=[[0, 0], [10, 0], [5, 10], [0, 0]]), "expected a rectangle"),
    "crossing itself": (geojson([[[1, 1], [3, 3], [3, 1], [1, 3], [1, 1]]]), "Self-intersection"),
    "over the border": (geojson([moved(5, 0)]), "reaches over the border"),
    "not finite": (geojson([[[1, 1], [3, 1], [float("nan"), 3], [1, 1]]]), "is not a coordinate"),
    "too large": (geojson(border=[[0, 0], [2e5, 0], [2e5, 10], [0, 10], [0, 0]]), "is not a coordinate"),
    "gap between obstacles": (geojson([SQUARE], [moved(2 + 5e-8, 0)]), "a gap below 1e-07"),
    "gap to the border": (geojson([moved(4 - 5e-8, 0)]), "a gap below 1e-07"),
}


@pytest.mark.parametrize("fault", POLYGON_FAULTS)
def test_polygon_fault_is_told(fault):
    text, told = POLYGON_FAULTS[fault]
    with pytest.raises(ValueError, match=told) as caught:
        files.polygons_from_geojson(text, "m")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "obstacles", [([SQUARE],), ([SQUARE], [moved(2, 0)]), ([moved(4, 0)],), ([SQUARE, [[4.5, 4.5], [5, 5], [5, 4.5], [4.5, 4.5]]],)]
)
def test_touching_polygons_and_holes_are_accepted(obstacles):
    assert len(files.polygons_from_geojson(geojson(*obstacles), "m").obstacles) == len(obstacles)


CIRCLE_FAULTS = {
    "radius of 0": ([-5, 5, -5, 5], [[0, 0, 0]], "circle 0: radius 0; expected above 0"),
    "bounds exchanged": ([5, -5, -5, 5], [], "low below high"),
    "not finite": ([-5, 5, -5, 5], [[0, float("inf"), 1]], "is not a coordinate"),
    "gap between circles": ([-5, 5, -5, 5], [[0, 0, 1], [2 + 5e-8, 0, 1]], "circle 0: a gap below 1e-07"),
    "gap to the border": ([-5, 5, -5, 5], [[4 - 5e-8, 0, 1]], "circle 0: a gap below 1e-07"),
}


@pytest.mark.parametrize("fault", CIRCLE_FAULTS)
def test_circle_fault_is_told(fault):
    bounds, circles, told = CIRCLE_FAULTS[fault]
    with pytest.raises(ValueError, match=told):
        files.load({"kind": "circles", "unit": "m", "bounds": bounds, "circles": circles}, Path())


def descriptions():
    yield {"kind": "circles", "unit": "m", "bounds": [-1, 1, -1, 1], "circles": [[0.1, 0.2, 0.3], [1 / 3, 0, 0.1]]}
    yield {"kind": "grid", "unit": "cell", "file": "song2016.txt", "cell": 10}
    for file in sorted(BENCHMARK_MAPS.glob("*.geojson")):
        yield {"kind": "polygons", "unit": "m", "file": str(file)}
        yield {"kind": "raster", "unit": "m", "file": str(file), "cell": 0.4, "rule": "overlap"}


@pytest.mark.parametrize("description", list(descriptions()), ids=lambda each: f"{each['kind']} {Path(each.get('file', '')).stem}")
def test_text_gives_a_workspace_back_bit_by_bit(description):
    text = files.to_json(files.load(description, MAPS))
    assert files.to_json(files.from_json(text)) == text


RANDOM = {"bounds": [-10, 10, -10, 10], "radius": 2.0, "circles": 10, "unit": "unit"}


def test_layout_depends_on_its_names_alone_and_is_nested():
    one, again = (random_circles.layout(RANDOM, "study/random", 3, [(0, 0), (4, 6)]) for _ in range(2))
    assert np.array_equal(one.centres, again.centres)
    assert np.array_equal(random_circles.first(one, 4).centres, one.centres[:4])
    assert not np.array_equal(one.centres, random_circles.layout(RANDOM, "study/random", 4, [(0, 0), (4, 6)]).centres)


def test_layouts_leave_the_ends_free():
    for number in range(200):
        centres = random_circles.layout(RANDOM, "study/random", number, [(0, 0), (4, 6)]).centres
        assert min(np.hypot(*(centres - end).T).min() for end in [(0, 0), (4, 6)]) > 2.0


def test_layout_that_cannot_be_drawn_is_given_up():
    with pytest.raises(ValueError, match="no circle leaves start and target free"):
        random_circles.layout(RANDOM | {"radius": 40.0}, "study/random", 0, [(0, 0), (4, 6)])
