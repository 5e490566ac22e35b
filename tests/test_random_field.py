"""Random fields of cells: as described, drawn from their names alone, written and read back."""

import numpy as np
import pytest

from bezierplan.geometry import shortest_paths
from bezierplan.workspaces import random_field

FIELD = {"kind": "random_field", "radius": 0.06, "clear_ends": 2.0, "unit": "cell"}
PROBLEM = {
    "workspace": "dense",
    "side": 100,
    "start": [0, 0],
    "target": [100, 100],
    "obstacles": 25,
    "layout": 0,
}


def drawn(name="dense", described=FIELD, **changed):
    """The field of a workspace of a name, for the problem but for some changes."""
    return random_field.field(described, PROBLEM | changed, f"study/{name}")


def test_a_field_is_drawn_from_its_name_alone():
    one, again = drawn(), drawn()
    assert np.array_equal(one.occupied, again.occupied)
    for change in (
        {"layout": 1},
        {"obstacles": 24},
        {"side": 120},
        {"start": [0, 100], "target": [100, 0]},
    ):
        assert not np.array_equal(one.shapes.centres[:20], drawn(**change).shapes.centres[:20])
    assert not np.array_equal(one.shapes.centres, drawn("other").shapes.centres)


def test_nested_fields_stay_nested_where_draws_are_repeated():
    """Circles that large cut off the target in many draws, after different numbers of circles."""
    nested = FIELD | {"nested": True, "radius": 0.12}
    centres = {
        (count, layout): drawn(described=nested, obstacles=count, layout=layout).shapes.centres
        for count in (17, 18)
        for layout in range(60)
    }
    firsts = [drawn(described=nested, obstacles=1, layout=layout) for layout in range(60)]
    drawn_again = [
        not np.array_equal(centres[17, layout][0], first.shapes.centres[0])
        for layout, first in enumerate(firsts)
    ]
    alike = [np.array_equal(centres[17, n], centres[18, n][:17]) for n in range(60)]
    assert 5 < sum(drawn_again) < 55
    assert sum(each and again for each, again in zip(alike, drawn_again)) > 3


def test_radius_is_a_share_of_the_side_that_is_named():
    for side, named, radius in ((100, "own", 6.0), (200, "own", 12.0), (200, 100, 6.0)):
        described = FIELD | {"radius_side": named}
        field = drawn(described=described, side=side, target=[side, side], obstacles=5)
        assert set(field.shapes.radii) == {radius}


def test_cells_are_those_whose_centres_lie_in_circles():
    grid = drawn()
    assert grid.occupied.shape == (101, 101)
    assert grid.bounds == (-0.5, 100.5, -0.5, 100.5)
    assert len(grid.shapes.radii) == 25
    assert set(grid.shapes.radii) == {6.0}
    x, y = np.meshgrid(np.arange(101), np.arange(101))
    inside = (
        np.hypot(x[..., None] - grid.shapes.centres[:, 0], y[..., None] - grid.shapes.centres[:, 1])
        <= 6.0
    ).any(axis=-1)
    assert np.array_equal(grid.occupied, inside)
    assert grid.centre(102) == (1.0, 1.0)
    assert grid.cell_of(100, 0) == (0, 100)


def test_circles_keep_clear_of_the_ends():
    for number in range(200):
        grid = drawn(described=FIELD | {"radius": 0.025}, obstacles=5, layout=number)
        for end in ((0, 0), (100, 100)):
            assert np.hypot(*(grid.shapes.centres - end).T).min() >= 2.5 + 2


def test_fields_that_cut_off_the_target_are_drawn_again():
    crowded = FIELD | {"radius": 0.11}
    for number in range(5):
        grid = drawn("crowded", crowded, layout=number)
        assert np.isfinite(
            shortest_paths.lattice_path(grid.occupied, (0, 0), (100, 100), 1.5, "free").length
        )
    with pytest.raises(
        ValueError,
        match=r"radius: 0[.]15: start and target are cut off from each other in 200 fields",
    ):
        drawn("walled", FIELD | {"radius": 0.15}, obstacles=60, side=40, target=[40, 40])
    with pytest.raises(ValueError, match="radius: no circle keeps"):
        drawn("covered", FIELD | {"radius": 1.5})
