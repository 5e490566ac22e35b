"""Mean ranks and what tells them apart, held against Demsar's own example; boxes whose published
means lie far away.
"""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from panels import options_of, panels_of

from bezierplan.analysis.results import Results
from bezierplan.figures import sheet
from bezierplan.figures.panels import Sources, boxes, critical_difference, panel_of
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
C45 = [
    0.763,
    0.599,
    0.954,
    0.628,
    0.882,
    0.936,
    0.661,
    0.583,
    0.775,
    1.0,
    0.940,
    0.619,
    0.972,
    0.957,
]
WITH_M = [
    0.768,
    0.591,
    0.971,
    0.661,
    0.888,
    0.931,
    0.668,
    0.583,
    0.838,
    1.0,
    0.962,
    0.666,
    0.981,
    0.978,
]
WITH_CF = [
    0.771,
    0.590,
    0.968,
    0.654,
    0.886,
    0.916,
    0.609,
    0.563,
    0.866,
    1.0,
    0.965,
    0.614,
    0.9751,
    0.946,
]
WITH_BOTH = [
    0.798,
    0.569,
    0.967,
    0.657,
    0.898,
    0.931,
    0.685,
    0.625,
    0.875,
    1.0,
    0.962,
    0.669,
    0.975,
    0.970,
]
DEMSAR = {
    name: [1 - value for value in values]
    for name, values in {
        "c45": C45,
        "with_m": WITH_M,
        "with_cf": WITH_CF,
        "with_both": WITH_BOTH,
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
    bars = [line.get_xdata() for line in axes.lines if line.get_label() == "critical difference"]
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


def drawn(found: Results, panel: dict, folder) -> list[str]:
    file = str(folder / "figure.csv")
    sheet.write_data(sheet.data(panels_of([panel]), Sources({"routes": found})), file)
    figure = sheet.draw(
        panels_of([panel]),
        sheet.read_data(file),
        sheet.Scene({"routes": found.problems}, {}, {"c45": "C4.5"}, "m"),
        1,
    )
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


def printed(metric: str, values: dict[str, float]) -> pd.DataFrame:
    rows = [
        {"table": "table5", "method": method, "metric": metric, "statistic": "mean", "value": value}
        for method, value in values.items()
    ]
    return pd.DataFrame(rows).assign(n=10, unit="-")


def test_published_ranks_stand_beside_ours(tmp_path):
    found = results(
        DEMSAR,
        pd.concat(
            [printed("rank", {"c45": 2.5}), printed("rank", {"c45": 9.9}).assign(table="table3")]
        ),
    )
    panel = {"kind": "critical_difference", "experiment": "routes", "printed": "table5"}
    assert "published mean rank" in drawn(found, panel, tmp_path)
    assert "published mean rank" not in drawn(
        found, {key: panel[key] for key in ("kind", "experiment")}, tmp_path
    )
    axes = Figure().subplots()
    frame = critical_difference.data(found, options_of(critical_difference, printed="table5"))
    critical_difference.draw(axes, frame, sheet.Scene({}, {}, {}, "m"), panel_of(panel))
    (mark,) = [line for line in axes.lines if line.get_label() == "published mean rank"]
    assert (mark.get_xdata().tolist(), mark.get_ydata()) == ([2.5], [3]), (
        "in the row of its method, the last one"
    )


def test_far_published_means_stand_at_the_edge(tmp_path):
    found = results(
        {"near": [8.0, 9.0, 10.0], "far": [8.0, 8.5, 9.0]},
        printed("objective", {"near": 9.5, "far": 30.25}),
    )
    panel = {"kind": "boxes", "experiment": "routes", "metric": "objective", "limits": True}
    words = drawn(found, panel, tmp_path)
    assert {"30.25", "published mean", "published mean, off the scale"} <= set(words)
    axes = Figure().subplots()
    near = results(
        {"near": [8.0, 9.0, 10.0], "far": [8.0, 8.5, 9.0]},
        printed("objective", {"near": 10.4, "far": 30.25}),
    )
    drawn_frame = boxes.data(near, options_of(boxes, metric="objective"))
    boxes.draw(axes, drawn_frame, sheet.Scene({}, {}, {}, "m"), panel_of(panel))
    assert axes.get_xlim()[0] < 8 < 10.4 < axes.get_xlim()[1] < 11, "what is not far stays in sight"
    frame = boxes.data(found, options_of(boxes, metric="objective", limits=True)).query(
        "method.isna()"
    )
    assert dict(zip(frame["part"], frame["value"])) == {"reference": 2.5, "bound": 2.0}
    assert {"best known path of the same kind", "exact shortest path"} <= set(words)
