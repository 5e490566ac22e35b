"""Mean ranks and what tells them apart, held against Demsar's own example."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from panels import options_of

from bezierplan.analysis.results import Results
from bezierplan.figures import sheet
from bezierplan.figures.panels import critical_difference
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

FIELD = Problem(
    "field",
    Circles((-9.0, 9.0, -9.0, 9.0), np.array([[0.0, 3.0]]), np.array([1.0]), "m"),
    (-1.0, 0.0),
    (1.0, 0.0),
)


def results(table: dict[str, list[float]], published: pd.DataFrame | None = None) -> Results:
    """Runs of methods with these objectives, one a repeat, in any order."""
    runs = pd.DataFrame(
        {
            "id": f"study/routes/field/{method}/{repeat}",
            "condition": "field",
            "problem": "field",
            "method": method,
            "repeat": repeat,
            "objective": value,
            "feasible": True,
            "bound": 2.0,
            "reference": 2.5,
        }
        for method, values in table.items()
        for repeat, value in enumerate(values)
    )
    return Results(
        runs.sample(frac=1, random_state=0).reset_index(drop=True),
        {"field": FIELD},
        pd.DataFrame(),
        published,
    )


# Errors of four classifiers on fourteen data sets (Demsar 2006, Table 6, as 1 minus the accuracies
# that it prints; of two equal ones in the last row but one it ranks the third classifier before the
# fourth).
DEMSAR = {
    name: [1 - float(value) for value in values.split()]
    for name, values in {
        "c45": ".763 .599 .954 .628 .882 .936 .661 .583 .775 1 .940 .619 .972 .957",
        "with_m": ".768 .591 .971 .661 .888 .931 .668 .583 .838 1 .962 .666 .981 .978",
        "with_cf": ".771 .590 .968 .654 .886 .916 .609 .563 .866 1 .965 .614 .9751 .946",
        "with_both": ".798 .569 .967 .657 .898 .931 .685 .625 .875 1 .962 .669 .975 .970",
    }.items()
}


def test_ranks_and_critical_difference_are_demsars():
    frame = critical_difference.data(results(DEMSAR), options_of(critical_difference))
    ranks = frame[frame["part"] == "rank"].set_index("method")["value"]
    assert ranks.round(3).to_dict() == {
        "with_both": 1.964,
        "with_m": 2.000,
        "with_cf": 2.893,
        "c45": 3.143,
    }
    assert list(ranks) == sorted(ranks)
    tested = frame.iloc[0]
    assert (tested["methods"], tested["units"]) == (4, 14)
    # His equation and Table 5.
    assert tested["difference"] == pytest.approx(2.569 * np.sqrt(4 * 5 / (6 * 14)), abs=1e-3)
    ties = 4**3 - 4 + 3 * (2**3 - 2)
    assert tested["chi2"] == pytest.approx(9.28 / (1 - ties / (14 * 4 * (4**2 - 1))), abs=0.02), (
        "his formula does not correct for ties"
    )


def test_bars_overlap_where_ranks_differ_by_at_most_the_critical_difference():
    frame = critical_difference.data(results(DEMSAR), options_of(critical_difference))
    axes = Figure().subplots()
    critical_difference.draw(
        axes, frame, sheet.Scene({}, {}, {}, "m"), options_of(critical_difference)
    )
    (drawn,) = axes.collections
    bars = [path.vertices[:, 0] for path in drawn.get_paths()]
    ranks = frame.loc[frame["part"] == "rank", "value"].to_numpy()
    for one in range(4):
        for other in range(one):
            apart = abs(ranks[one] - ranks[other]) > frame["difference"].iloc[0]
            assert apart == (bars[one][0] > bars[other][1] or bars[other][0] > bars[one][1])


def test_ranks_need_three_methods_in_every_repeat():
    with pytest.raises(ValueError, match="at least three methods"):
        critical_difference.data(
            results({"a": [1, 2], "b": [2, 1]}), options_of(critical_difference)
        )
    found = results({"a": [1, 2], "b": [2, 1], "c": [3, 4]})
    with pytest.raises(ValueError, match="in every repeat"):
        critical_difference.data(
            found._replace(runs=found.runs.iloc[1:]), options_of(critical_difference)
        )


def test_published_ranks_stand_in_the_rows_of_their_methods():
    row = {"table": "table5", "method": "c45", "metric": "rank", "statistic": "mean", "value": 2.5}
    published = pd.DataFrame([row, row | {"table": "table3", "value": 9.9}])
    panel = options_of(critical_difference, printed="table5")
    frame = critical_difference.data(results(DEMSAR, published), panel)
    axes = Figure().subplots()
    critical_difference.draw(axes, frame, sheet.Scene({}, {}, {}, "m"), panel)
    (mark,) = [line for line in axes.lines if line.get_label() == "published mean rank"]
    assert (mark.get_xdata().tolist(), mark.get_ydata()) == ([2.5], [3]), "the last one"
