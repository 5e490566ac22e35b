"""Cells drawn from polygons: which are occupied, and that check and bound see the polygons."""

import logging
from dataclasses import replace

import numpy as np
import pytest
import shapely
from fields import BENCHMARK_MAPS, benchmark
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.figures.panels import workspace as picture
from bezierplan.geometry import shortest_paths
from bezierplan.geometry.checker import check
from bezierplan.geometry.region import build_region
from bezierplan.running import problems
from bezierplan.workspaces import files, raster
from bezierplan.workspaces.polygons import Polygons

# Cells of 0.1 m whose centre lies in an obstacle or on its edge, counted with another program.
OCCUPIED_CENTRES = {
    "back_and_forth": 729,
    "bugtrap1": 7995,
    "complex2": 6272,
    "gaps": 2730,
    "hidden_U": 3872,
    "square_spiral": 2255,
}
WALL = (np.array([[2.0, 0.0], [2.5, 0.0], [2.5, 3.0], [2.0, 3.0]]),)


def drawn(name, cell, rule):
    return files.load(
        {"kind": "raster", "unit": "m", "file": f"{name}.geojson", "cell": cell, "rule": rule},
        BENCHMARK_MAPS,
    )


@pytest.mark.parametrize("name", OCCUPIED_CENTRES)
def test_occupied_cells_of_the_benchmark_maps(name):
    grid = drawn(name, 0.1, "centre")
    assert grid.occupied.sum() == OCCUPIED_CENTRES[name]
    left, right, bottom, top = grid.shapes.bounds
    assert grid.occupied.shape == (round((top - bottom) / 0.1) + 1, round((right - left) / 0.1) + 1)
    # What overlaps is not less, but for cells whose centre lies on an edge.
    assert drawn(name, 0.1, "overlap").occupied.sum() >= grid.occupied.sum() - 4 * sum(
        grid.occupied.shape
    )


@pytest.mark.parametrize("name", OCCUPIED_CENTRES)
def test_the_bound_is_that_of_the_polygons(name):
    problem, length = benchmark(name)
    drawn_map = problem._replace(workspace=drawn(name, 0.5, "overlap"))
    assert shortest_paths.shortest_path(drawn_map).length == pytest.approx(length, abs=1e-5)


@given(st.data())
def test_a_segment_over_free_cells_enters_no_polygon(data):
    name = data.draw(st.sampled_from(["complex2", "gaps"]))
    grid = drawn(name, 0.4, "overlap")
    row, column = data.draw(
        st.sampled_from(np.argwhere(~grid.occupied[:, :-1] & ~grid.occupied[:, 1:]).tolist())
    )
    centres = grid.in_units(np.array([[column, row], [column + 1, row]]) + 0.5)
    assert check(centres[None], build_region(grid)).feasible
    cell = shapely.box(*(centres[0] - 0.2 + 1e-6), *(centres[0] + 0.2 - 1e-6))
    assert not any(shapely.Polygon(*rings[:1]).intersects(cell) for rings in grid.shapes.obstacles)


def test_the_check_sees_the_polygons_and_not_the_cells():
    coarse = replace(drawn("gaps", 0.5, "centre"), occupied=np.zeros((41, 41), dtype=bool))
    through_the_wall = np.array([[[4.0, 10.0], [6.0, 10.0]]])
    assert not check(through_the_wall, build_region(coarse)).feasible


def test_rules():
    polygons = Polygons((0.0, 4.0, 0.0, 4.0), (WALL,), "m")
    for cell, rule, columns in (
        (1.0, "centre", [2]),
        (1.0, "overlap", [2]),
        (0.5, "overlap", [4, 5]),
    ):
        row = raster.from_polygons(polygons, cell, rule).occupied[0]
        assert np.flatnonzero(row).tolist() == columns
    # The centres of the last row and column lie outside a border that is no multiple of the cell.
    beyond = raster.from_polygons(
        replace(polygons, bounds=(0.0, 3.8, 0.0, 4.0)), 1.0, "centre"
    ).occupied
    assert beyond[:, 4].all()
    assert not beyond[:, 3].any()


def test_an_obstacle_without_a_cell_is_told(caplog):
    thin = (np.array([[2.2, 0.0], [2.3, 0.0], [2.3, 3.0]]),)
    with caplog.at_level(logging.WARNING):
        raster.from_polygons(Polygons((0.0, 4.0, 0.0, 4.0), (thin,), "m"), 1.0, "centre")
    assert "obstacle 0 occupies no cell" in caplog.text


def test_too_many_cells_are_refused():
    with pytest.raises(ValueError, match=r"20,001 x 20,001 cells; expected at most 16,000,000"):
        drawn("gaps", 0.001, "overlap")


def test_a_start_in_an_occupied_cell_is_refused():
    described = {"workspace": "gaps", "start": [4.6, 10], "target": [18, 10]}
    assert problems.build("p", described, drawn("gaps", 0.1, "overlap")).start == (4.6, 10.0)
    with pytest.raises(
        ValueError, match=r"start: .*in an occupied cell; expected a free one, or a smaller cell"
    ):
        problems.build("p", described, drawn("gaps", 1.0, "overlap"))


def test_a_fine_raster_is_drawn_as_its_polygons():
    parts = picture.list_workspace_rows(drawn("gaps", 0.1, "overlap"))
    assert set(parts["part"]) == {"corner", "ring"}
    assert parts[parts["part"] == "ring"]["obstacle"].nunique() == len(
        drawn("gaps", 0.1, "overlap").shapes.obstacles
    )
    assert {"free", "occupied", "ring"} <= set(
        picture.list_workspace_rows(drawn("gaps", 1.0, "overlap"))["part"]
    )


def test_a_workspace_that_is_no_file_is_told():
    with pytest.raises(ValueError, match=r"file: nowhere.geojson: cannot be read"):
        drawn("nowhere", 1, "overlap")
