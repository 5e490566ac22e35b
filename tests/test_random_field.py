"""Random fields of cells: as described, drawn from their names alone, written and read back."""

import numpy as np
import pytest

from bezierplan.geometry import shortest_paths
from bezierplan.geometry.region import blocks, region
from bezierplan.running import problems
from bezierplan.running.descriptions import Descriptions
from bezierplan.workspaces import files, random_field
from bezierplan.workspaces.circles import Circles

FIELD = {"kind": "random_field", "radius": 0.06, "clear_ends": 2.0, "unit": "cell"}
PROBLEM = {
    "workspace": "dense",
    "side": 100,
    "start": [0, 0],
    "target": [100, 100],
    "obstacles": 25,
    "layout": 0,
}


def test_a_field_is_drawn_from_its_name_alone():
    one, again = (random_field.field(FIELD, PROBLEM, "study/dense") for _ in range(2))
    assert np.array_equal(one.occupied, again.occupied)
    for change in (
        {"layout": 1},
        {"obstacles": 24},
        {"side": 120},
        {"start": [0, 100], "target": [100, 0]},
    ):
        other = random_field.field(FIELD, PROBLEM | change, "study/dense")
        assert not np.array_equal(one.drawn.centres[:20], other.drawn.centres[:20])
    assert not np.array_equal(
        one.drawn.centres, random_field.field(FIELD, PROBLEM, "study/other").drawn.centres
    )


def test_nested_fields_differ_in_their_last_circles():
    nested = FIELD | {"nested": True}
    many = random_field.field(nested, PROBLEM, "study/dense").drawn.centres
    few = random_field.field(nested, PROBLEM | {"obstacles": 5}, "study/dense").drawn.centres
    assert np.array_equal(few, many[:5])
    other = random_field.field(nested, PROBLEM | {"layout": 1}, "study/dense").drawn.centres
    assert not np.array_equal(many, other)


def test_nested_fields_stay_nested_where_draws_are_repeated():
    """Circles that large cut off the target in many draws, after different numbers of circles."""
    nested = FIELD | {"nested": True, "radius": 0.12}
    centres = {
        (count, layout): random_field.field(
            nested, PROBLEM | {"obstacles": count, "layout": layout}, "study/dense"
        ).drawn.centres
        for count in (17, 18)
        for layout in range(60)
    }
    firsts = [
        random_field.field(nested, PROBLEM | {"obstacles": 1, "layout": layout}, "study/dense")
        for layout in range(60)
    ]
    drawn_again = [
        not np.array_equal(centres[17, layout][0], first.drawn.centres[0])
        for layout, first in enumerate(firsts)
    ]
    alike = [np.array_equal(centres[17, n], centres[18, n][:17]) for n in range(60)]
    assert 5 < sum(drawn_again) < 55
    assert sum(each and again for each, again in zip(alike, drawn_again)) > 3


def test_radius_is_a_share_of_the_side_that_is_named():
    for side, named, radius in ((100, "own", 6.0), (200, "own", 12.0), (200, 100, 6.0)):
        field = random_field.field(
            FIELD | {"radius_side": named},
            PROBLEM | {"side": side, "target": [side, side], "obstacles": 5},
            "study/dense",
        )
        assert set(field.drawn.radii) == {radius}


def test_cells_are_those_whose_centres_lie_in_circles():
    grid = random_field.field(FIELD, PROBLEM, "study/dense")
    assert grid.occupied.shape == (101, 101)
    assert grid.bounds == (-0.5, 100.5, -0.5, 100.5)
    assert len(grid.drawn.radii) == 25
    assert set(grid.drawn.radii) == {6.0}
    x, y = np.meshgrid(np.arange(101), np.arange(101))
    inside = (
        np.hypot(x[..., None] - grid.drawn.centres[:, 0], y[..., None] - grid.drawn.centres[:, 1])
        <= 6.0
    ).any(axis=-1)
    assert np.array_equal(grid.occupied, inside)
    assert grid.centre(102) == (1.0, 1.0)
    assert grid.cell_of(100, 0) == (0, 100)


def test_a_circle_over_the_border_and_one_that_reaches_no_centre():
    grid = random_field.from_circles(
        Circles((0, 9, 0, 9), np.array([[0.0, 9.0], [4.5, 4.5]]), np.array([1.0, 0.3]), "cell")
    )
    row, column = np.nonzero(grid.occupied)
    assert sorted(zip(column, row)) == [(0, 8), (0, 9), (1, 9)]


def test_circles_keep_clear_of_the_ends():
    for number in range(200):
        grid = random_field.field(
            FIELD | {"radius": 0.025}, PROBLEM | {"obstacles": 5, "layout": number}, "study/dense"
        )
        for end in ((0, 0), (100, 100)):
            assert np.hypot(*(grid.drawn.centres - end).T).min() >= 2.5 + 2


def test_no_obstacles_leave_an_empty_field():
    assert not random_field.field(FIELD, PROBLEM | {"obstacles": 0}, "study/empty").occupied.any()


def test_fields_that_cut_off_the_target_are_drawn_again():
    crowded = FIELD | {"radius": 0.11}
    for number in range(5):
        grid = random_field.field(crowded, PROBLEM | {"layout": number}, "study/crowded")
        assert np.isfinite(
            shortest_paths.lattice_path(grid.occupied, (0, 0), (100, 100), 1.5, "free").length
        )
    with pytest.raises(
        ValueError,
        match=r"radius: 0[.]15: start and target are cut off from each other in 200 fields",
    ):
        random_field.field(
            FIELD | {"radius": 0.15},
            PROBLEM | {"obstacles": 60, "side": 40, "target": [40, 40]},
            "study/walled",
        )
    with pytest.raises(ValueError, match="radius: no circle keeps"):
        random_field.field(FIELD | {"radius": 1.5}, PROBLEM, "study/covered")


def test_ends_outside_are_told():
    with pytest.raises(
        ValueError, match=r"target: \[101, 100\]: outside the field; expected x and y from 0 to 100"
    ):
        random_field.field(FIELD, PROBLEM | {"target": [101, 100]}, "study/dense")


def test_a_field_is_written_and_read_bit_by_bit(tmp_path):
    job = Descriptions("study", {"case1_0_25": PROBLEM}, {"dense": FIELD})
    made = problems.build_all(job, tmp_path)
    problems.write(made, job.homes, tmp_path / "problems.parquet")
    (one,), (again,) = made.values(), problems.read(tmp_path / "problems.parquet").values()
    assert np.array_equal(one.workspace.occupied, again.workspace.occupied)
    assert np.array_equal(one.workspace.drawn.centres, again.workspace.drawn.centres)
    assert one.workspace.origin == again.workspace.origin
    assert files.to_json(one.workspace) == files.to_json(again.workspace)


def test_bounds_of_a_moved_grid_are_those_of_the_same_cells_at_the_origin(tmp_path):
    job = Descriptions("study", {"case1_0_25": PROBLEM}, {"dense": FIELD})
    (moved,) = problems.build_all(job, tmp_path).values()
    at_origin = moved._replace(
        workspace=type(moved.workspace)(moved.workspace.occupied, 1.0, "cell"),
        start=(0.5, 0.5),
        target=(100.5, 100.5),
    )
    one, other = shortest_paths.shortest_path(moved), shortest_paths.shortest_path(at_origin)
    assert one.length == other.length
    np.testing.assert_allclose(one.points + 0.5, other.points, rtol=0, atol=1e-12)
    table = problems.bounds_of({"a": moved}).to_pydict()
    assert table["octile_bound"][0] >= 150
    assert table["bound"][0] == one.length
    centre = moved.workspace.drawn.centres[0]
    assert blocks(region(moved.workspace), tuple(np.rint(np.clip(centre, 0, 100))))
