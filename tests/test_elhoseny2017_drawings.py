"""elhoseny2017: the radius of the obstacles from the printed lengths, and what its drawings
draw.
"""

import math

import numpy as np
import pytest
from fields import field_of
from studies import drawing as drawn
from studies import published, study

from bezierplan.geometry import cell_length
from bezierplan.papers.elhoseny2017 import functions as elhoseny2017
from bezierplan.study import captions, runs_behind
from bezierplan.workspaces.problem import Path

PUBLISHED = published("elhoseny2017")


def test_expected_lengths_are_those_of_free_and_blocked_diagonals():
    rng = np.random.default_rng(0)
    trials = 20_000
    for radius, obstacles in ((0.025, 5), (0.06, 15)):
        x, y = rng.random((2, trials, obstacles))
        free = (abs(x - y) / math.sqrt(2) > radius).all(axis=1)
        lengths = np.where(free, 150.0, 200.0)
        error = lengths.std() / math.sqrt(trials)
        assert elhoseny2017.estimate_length(100, radius, obstacles) == pytest.approx(
            lengths.mean(), abs=4 * error
        )
    assert elhoseny2017.estimate_length(200, 0.025, 0) == 300
    assert elhoseny2017.estimate_length(200, 0.5, 1000) == pytest.approx(400)


def test_the_lengths_along_free_and_blocked_diagonals_are_those_of_cells4():
    empty = field_of(40)
    assert cell_length.length4(
        Path("polyline", np.array([[0.0, 0], [40, 40]])), empty
    ) == elhoseny2017.estimate_length(40, 0.025, 0)
    around = Path("polyline", np.array([[0.0, 0], [14.2, 23.7], [40, 40]]))
    assert cell_length.length4(around, empty) == elhoseny2017.estimate_length(40, 0.7, 1000) == 80


def test_one_radius_fits_both_fields_best():
    by_side = elhoseny2017.radius_errors(PUBLISHED)
    errors = by_side.groupby("radius")["relative_error"].mean()
    assert errors.idxmin() == 0.025
    least = by_side[by_side["radius"] == 0.025]
    assert least["relative_error"].tolist() == pytest.approx([0.0395, 0.0288], abs=5e-5)
    best = by_side.loc[by_side.groupby("side")["relative_error"].idxmin()]
    assert best["radius"].between(0.022, 0.028).all()


def colours(operator):
    marks = drawn("elhoseny2017", "figure1")
    cells = marks[(marks["operator"] == operator) & (marks["mark"] == "cell")]
    assert len(cells) == 16
    return {role: set(own["group"]) for role, own in cells.groupby("role")}


def test_crossover_stays_in_the_subspace_of_its_parents():
    found = colours("crossover")
    assert found["accent"] == {"0011", "0000"}
    # Section 2.2.1 lists these four.
    assert found["accent"] | found["muted"] == {"0010", "0011", "0001", "0000"}


def test_mutation_changes_one_digit():
    found = colours("mutation")
    assert found["accent"] == {"0011"}
    assert found["muted"] == {"1011", "0111", "0001", "0010"}
    marks = drawn("elhoseny2017", "figure1")
    places = marks[marks["mark"] == "cell"].drop_duplicates("group").set_index("group")[["x", "y"]]
    for child in found["muted"]:
        assert np.abs(places.loc[child] - places.loc["0011"]).sum() == 1, "drawn beside its parent"


def test_a_figure_needs_the_methods_that_it_shows():
    own = study("elhoseny2017")
    assert runs_behind.list_methods(own, "figure7") == {}
    assert runs_behind.list_methods(own, "figure10")["fields100"] == ["prm", "abc_ep", "ga", "mga"]
    assert captions.build_caption(own, "figure7", "full").title == own.figures["figure7"].title
