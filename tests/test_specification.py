"""The picture of the scores of readings."""

import pandas as pd

from bezierplan.analysis.choices import Choice
from bezierplan.figures import specification

SCORES = pd.DataFrame(
    {
        "reading": ["O2=fast", "O1=2", "O1=1, O3=5", "default"],
        "excluded_by": ["Section 1", None, None, None],
        "score": [4.0, 3.0, 2.0, 1.0],
        "error": 0.1,
    }
)
HIDDEN = pd.DataFrame(
    {"hidden": [False, True, True], "truth": [None, "default", "O1=2"], "score": [None, 5.0, 6.0]}
)
CHOICES = [
    Choice("O1", [1, 2], "tries", {}, [], {}, ""),
    Choice("O2", ["fast"], "a_rule", {}, [], {}, "Section 1"),
    Choice("O3", [5], None, {}, [], {"field": "radius"}, ""),
]


def test_readings_stand_in_order_above_what_they_choose():
    frame = specification.data(SCORES, HIDDEN)
    plain, excluded, default, best = specification.LOOKS
    true = specification.TRUE
    assert [*frame["part"]] == [excluded, best, plain, default, true, true]
    assert [*frame["score"][-2:]] == [6, 5]
    figure = specification.draw(frame, CHOICES)
    curve, truths, matrix = figure.axes
    names = [label.get_text() for label in matrix.get_yticklabels()]
    assert names == ["tries = 1 (O1)", "tries = 2 (O1)", "a rule = fast (O2)", "radius = 5 (O3)"]
    points = {tuple(map(int, xy)) for line in matrix.get_lines() for xy in line.get_xydata()}
    assert points == {(1, 2), (2, 1), (3, 0), (3, 3)}
    assert {*curve.get_legend_handles_labels()[1]} == {*specification.LOOKS}
    assert [*truths.get_lines()[0].get_ydata()] == [6, 5]
