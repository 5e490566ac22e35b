"""ma2020: its maps, printed numbers, drawings, audit, and the claim about curvature; that its
settings are the paper's.
"""

import math
from functools import partial
from pathlib import Path as File

import numpy as np
import pandas as pd
import pytest
from studies import drawing, problem_of, published

from bezierplan.analysis.audit import audit
from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import build_region
from bezierplan.papers.ma2020 import audit as own_audit
from bezierplan.planners import bca
from bezierplan.schema import checked
from bezierplan.workspaces.problem import Path

FOLDER = File(__file__).parents[1] / "config" / "studies" / "ma2020"
STUDY = checked.read(FOLDER / "experiments.yaml")
PUBLISHED = published("ma2020")
problem = partial(problem_of, "ma2020")

MAPS = {
    # occupied cells; shortest path of 8 neighbours, half diagonals at the ends included, by both
    # rules for corners; exact shortest path
    "environment1": (60, 10 + 15 * math.sqrt(2), 31.7989899, 29.4839057),
    "environment2": (83, 14 + 13 * math.sqrt(2), 34.1421356, 30.0020079),
}


@pytest.mark.parametrize("name", MAPS)
def test_maps(name):
    occupied, one_side, strict, shortest = MAPS[name]
    grid = problem(name).workspace
    assert grid.occupied.shape == (20, 20)
    assert grid.occupied.sum() == occupied
    parameters = PUBLISHED["parameters"].set_index(["workspace", "parameter"])["value"]
    assert (
        occupied
        == parameters[name, "occupied_cells"]
        == pytest.approx(4 * parameters[name, "obstacle_coverage"])
    )
    for rule, length in (("one", one_side), ("none", strict)):
        found = shortest_paths.lattice_path(grid.occupied, (0, 0), (19, 19), math.sqrt(2), rule)
        assert found.length + math.sqrt(2) == pytest.approx(length, abs=1e-7)
    assert shortest_paths.shortest_path(problem(name)).length == pytest.approx(shortest, abs=1e-7)
    # No two blocks touch, not even at a corner: then any two diagonal neighbours share a block's
    # row or column.
    for cells in (grid.occupied, grid.occupied[:, ::-1]):
        apart = cells[1:, 1:] & cells[:-1, :-1] & ~cells[1:, :-1] & ~cells[:-1, 1:]
        assert not apart.any()


# Free control points of the shortest curves found.
BEST_KNOWN = {
    "environment1": [
        (15.5, 3.5),
        (0.5, 1.5),
        (9.5, 2.5),
        (9.5, 5.5),
        (19.5, 17.5),
        (2.5, 0.5),
        (18.5, 14.5),
        (14.5, 13.5),
    ],
    "environment2": [
        (4.5, 14.5),
        (3.5, 0.5),
        (0.5, 12.5),
        (19.5, 14.5),
        (4.5, 1.5),
        (7.5, 12.5),
        (17.5, 18.5),
        (6.5, 15.5),
    ],
}


@pytest.mark.parametrize("name", BEST_KNOWN)
def test_reference_is_the_length_of_a_path_that_can_be(name):
    grid = problem(name).workspace
    assert len(BEST_KNOWN[name]) == STUDY["settings"]["control_points"]
    for x, y in BEST_KNOWN[name]:
        assert (x % 1, y % 1) == (0.5, 0.5)
        assert not grid.occupied[int(y), int(x)]
    path = Path("bezier", np.array([problem(name).start, *BEST_KNOWN[name], problem(name).target]))
    assert curves.length(path) == pytest.approx(STUDY["problems"][name]["reference"], abs=1e-4)
    assert checker.check(curves.bezier_pieces(path), build_region(grid)).feasible


def test_no_run_of_the_outcome_is_shorter_than_the_best_known_curve():
    """The lengths of curves with eight free control points, of which claim C21 asks how near they
    come.
    """
    numbers = pd.read_csv(FOLDER.parents[2] / "docs" / "outcome" / "numbers.csv")
    own = numbers.query(
        "study == 'ma2020' and metric == 'length' and "
        "statistic == 'min' and method in ('bca', 'bca_q')"
    )
    for table, name in (("table1", "environment1"), ("table2", "environment2")):
        lengths = own.loc[own["table"] == table, "value_ours"]
        assert len(lengths) == 2
        assert lengths.min() >= STUDY["problems"][name]["reference"]


def test_audit():
    rows = audit.build_audit("ma2020", own_audit.audit(PUBLISHED))
    wrong = rows[~rows["consistent"].astype(bool)]
    means = wrong[wrong["rule"].str.contains("mean length")]
    assert means["printed"].to_list() == [32.9973]  # of BCA-Q, above that of ASFA-GA
    slow = wrong[wrong["rule"].str.contains("slightly")]
    assert slow["printed"].to_list() == 3 * [293.4417]
    height, selected, quarter, listed = wrong[wrong["item"] == "text"].itertuples()
    assert (height.printed, height.limit) == (0, 400)
    assert (selected.printed, selected.limit) == pytest.approx((20 * math.sqrt(2), 40))
    assert (quarter.printed, quarter.limit) == (0.25, 0.25**2)
    assert "number of control points" in listed.rule
    assert len(wrong) == 1 + 3 + 4


def test_figure_2_swaps_the_genes_behind_the_cut():
    marks = drawing("ma2020", "figure2")
    texts = marks[marks["mark"] == "text"]
    rows = {
        key: [int(text) for text in own.sort_values("x")["text"]]
        for key, own in texts.groupby(["drawn", "y"], sort=False)
    }
    before, after = (
        [rows[panel, height] for height in (1.3, 0.0)] for panel in ("before", "after")
    )
    for own, other, child in zip(before, before[::-1], after):
        assert child == own[:7] + other[7:]
    codes = np.array(before)
    assert codes.min() >= 1
    assert codes.max() <= 400
    assert len(bca.list_code_centres(20, 20)) == 400
