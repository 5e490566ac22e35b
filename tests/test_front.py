"""Fronts of two measures and paths near the exact shortest one: small tables whose answers can be
counted.
"""

import numpy as np
import pandas as pd
import pytest
from panels import options_of

from bezierplan.analysis import metrics
from bezierplan.analysis.results import Results
from bezierplan.figures.panels import front


def results(rows) -> Results:
    """Runs (problem, method, length over the bound or None for a path that is not certified),
    numbered within each method.
    """
    runs = pd.DataFrame(rows, columns=["condition", "method", "over"])
    runs["repeat"] = runs.groupby(["condition", "method"]).cumcount()
    runs["id"] = runs["condition"] + "/" + runs["method"] + "/" + runs["repeat"].map(str)
    runs["feasible"] = runs["over"].notna()
    # A path that is not certified can be as short as it likes.
    runs = runs.assign(
        bound=10.0,
        length=10 * runs["over"].fillna(0.5),
        experiment="e",
        problem=runs["condition"],
    )
    return Results(runs, {}, pd.DataFrame())


TWO = results(
    [
        *[("p", "good", over) for over in (1.005, 1.03, None, 1.2)],
        *[("p", "bad", over) for over in (None, 1.5)],
        *[("q", "good", 1.0)] * 2,
        *[("q", "bad", 1.04)] * 2,
    ]
)


def test_a_path_that_is_not_certified_solves_nothing_however_short():
    runs = TWO.runs
    near = {percent: metrics.values(runs, f"within_{percent}pct", {}).sum() for percent in (1, 5)}
    assert near == {1: 3, 5: 6}
    lengths = metrics.values(runs, "certified_length", {})
    assert np.isinf(lengths[~runs["feasible"]]).all()
    assert (lengths[runs["feasible"]] == runs["length"][runs["feasible"]]).all()


def test_a_front_has_what_no_other_method_beats_in_both():
    points = [(1, 4), (2, 2), (4, 1), (3, 3), (2, 4), (2, 2), (np.nan, 0), (0, np.inf)]
    assert front.on_front(np.array(points, dtype=float)).tolist() == [
        *[True, True, True, False, False, True],
        *[False, False],
    ]


def test_a_point_is_a_median_of_free_paths_and_the_share_of_them_is_beside_it():
    runs = TWO.runs.assign(cpu_s=[0.1, 0.3, 0.2, 0.5, 0.01, 0.01, 0.4, 0.3, 0.01, 0.01])
    frame = front.data(TWO._replace(runs=runs), options_of(front)).set_index("method")
    assert frame["y"].to_dict() == pytest.approx({"good": 0.005, "bad": 0.04})
    assert frame["x"].to_dict() == pytest.approx({"good": 0.3, "bad": 0.01})
    assert frame["free"].to_dict() == pytest.approx({"good": 5 / 6, "bad": 3 / 4})
    assert frame["front"].all()
