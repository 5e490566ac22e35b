"""Random maps of blocks: as described, drawn from their names alone, and chosen by their shortest
lattice path.
"""

import itertools
import math

import numpy as np
import pytest
from scipy import ndimage

from bezierplan.geometry import shortest_paths
from bezierplan.papers.ma2020.worlds import random_blocks
from bezierplan.running import problems
from bezierplan.running.descriptions import Descriptions

MAP = {
    "kind": "random_blocks",
    "largest_block": 4,
    "clear_ends": 2,
    "corners": "none",
    "unit": "cell",
}
PROBLEM = {
    "workspace": "blocks",
    "side": 20,
    "start": [0, 0],
    "target": [20, 20],
    "obstacles": 60,
    "layout": 0,
}


def maps(count, description=MAP, problem=PROBLEM, name="study/blocks"):
    return [
        grid.occupied
        for grid in itertools.islice(random_blocks.draw_maps(description, problem, name), count)
    ]


def built(count, obstacles=60, **changes):
    """The maps of an experiment's first layouts."""
    described = {
        f"blocks_{layout}": PROBLEM | {"layout": layout, "obstacles": obstacles}
        for layout in range(count)
    }
    job = Descriptions("study", described, {"blocks": MAP | changes})
    return [problem.workspace.occupied for problem in problems.build_all(job, None)[0].values()]


def test_maps_are_drawn_from_names_and_numbers_alone():
    one, again = maps(3), maps(3)
    assert np.array_equal(one, again)
    assert not np.array_equal(one[0], one[1])
    for change in ({"layout": 1}, {"start": [1, 0]}, {"obstacles": 59}):
        assert not np.array_equal(one, maps(3, problem=PROBLEM | change))
    assert not np.array_equal(one, maps(3, name="study/others"))


@pytest.mark.parametrize("cells", [60, 83])
def test_a_map_has_blocks_that_do_not_touch(cells):
    for occupied in maps(10, problem=PROBLEM | {"obstacles": cells}):
        assert occupied.sum() == cells
        assert not occupied[:2, :2].any()
        assert not occupied[-2:, -2:].any()
        # Cells that touch, if only by a corner, are one block: a full rectangle.
        names, _ = ndimage.label(occupied, structure=np.ones((3, 3)))
        for block in ndimage.find_objects(names):
            assert occupied[block].all()
            assert max(occupied[block].shape) <= 4


def test_blocks_have_all_sizes_and_reach_all_borders():
    shapes, together = set(), np.zeros((20, 20), dtype=bool)
    for occupied in maps(60):
        together |= occupied
        names, _ = ndimage.label(occupied, structure=np.ones((3, 3)))
        shapes |= {occupied[block].shape for block in ndimage.find_objects(names)}
    assert shapes == set(itertools.product(range(1, 5), range(1, 5)))
    together[:2, :2] = together[-2:, -2:] = True
    assert together.all()


@pytest.mark.parametrize(
    ("obstacles", "length"), [(60, 10 + 15 * math.sqrt(2)), (83, 14 + 13 * math.sqrt(2))]
)
def test_maps_are_drawn_until_their_shortest_lattice_path_has_the_wanted_length(obstacles, length):
    for occupied in built(3, obstacles, lattice_length=round(length, 4)):
        found = shortest_paths.lattice_path(
            occupied, (0, 0), (19, 19), math.sqrt(2), "none"
        ).length + math.sqrt(2)
        assert found == pytest.approx(length)


def test_without_a_wanted_length_the_first_map_with_a_path_is_taken():
    assert np.array_equal(
        built(1)[0], next(iter(random_blocks.draw_maps(MAP, PROBLEM, "study/blocks"))).occupied
    )


def test_maps_without_a_block_are_empty():
    assert not built(1, obstacles=0)[0].any()


@pytest.mark.parametrize(
    ("obstacles", "changes", "asked"),
    [
        (60, {"lattice_length": 28.0}, "a shortest lattice path of lattice_length 28"),
        (300, {}, "a path from start to target"),
    ],
)
def test_what_no_map_can_be_is_told(obstacles, changes, asked, monkeypatch):
    monkeypatch.setattr(random_blocks, "MOST_MAPS", 50)
    told = f"obstacles: {obstacles}: of 50 maps none has so many occupied cells and {asked}"
    with pytest.raises(ValueError, match=told):
        built(1, obstacles, **changes)
