"""Results read back: which runs, and that none of them beats the bound."""

import numpy as np
import pandas as pd
import pytest

from bezierplan.analysis import results
from bezierplan.analysis.audit import audit
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.problem import Problem

DISC = Problem(
    "disc",
    Circles((-5.0, 5.0, -5.0, 5.0), np.array([[0.0, 0.0]]), np.array([1.0]), "m"),
    (-2.0, 0.0),
    (2.0, 0.0),
)
BOUND = 2 * np.sqrt(3) + np.pi / 3
BOUNDS = pd.DataFrame(
    {
        "problem": ["disc"],
        "straight_line": 4.0,
        "bound": BOUND,
        "least_length": BOUND - 1e-8,
        "bound_path": [[]],
    }
)


def runs(lengths, feasible=True):
    rows = {
        "id": [f"s/e/disc/m/{i}" for i in range(len(lengths))],
        "problem": "disc",
        "repeat": range(len(lengths)),
        "length": lengths,
    }
    return pd.DataFrame(rows | {"feasible": feasible, "objective": lengths, "drew": True})


def join(table: pd.DataFrame) -> pd.DataFrame:
    """The runs with the bounds of their problem."""
    return results.join_bounds(table, {"disc": DISC}, BOUNDS).runs


def test_feasible_path_below_the_bound_stops_with_the_name_of_its_run():
    told = r"run s/e/disc/m/1 is said to be feasible, but its length 4\.5 lies below the bound"
    with pytest.raises(ValueError, match=told):
        join(runs([5.0, 4.5, 6.0]))


def test_a_run_stands_for_each_repeat_where_nothing_was_drawn_and_all_are_equal():
    """Of a method that ran once, of one whose repeats are equal, and of one whose repeats differ,
    whatever its generator was for: by their paths, or by their searches alone.
    """
    rows = [
        *(("a", 0, True, 1.0), ("a", 1, True, 1.0), ("b", 0, False, 1.0)),
        *(("c", 0, False, 1.0), ("c", 1, False, 1.0), ("d", 0, False, 1.0), ("d", 1, False, 2.0)),
    ]
    made = pd.DataFrame(rows, columns=["method", "repeat", "drew", "found"]).assign(
        id=[f"s/e/disc/{method}/{repeat}" for method, repeat, *_ in rows],
        condition="disc",
        problem="disc",
        length=5.0,
        feasible=True,
        evaluations=1,
        path_curve="bezier",
    )
    for varied, same in (("path_points", "history"), ("history", "path_points")):
        lists = {varied: [[each] for each in made["found"]], same: [[0.0]] * len(made)}
        joined = join(made.assign(**lists))
        repeats = joined["method"] + joined["repeat"].astype(str)
        assert repeats.to_list() == ["a0", "a1", "b0", "b1", "c0", "c1", "d0", "d1"]
        runs_shown = joined["id"].str[-3:].to_list()
        assert runs_shown == ["a/0", "a/1", "b/0", "b/0", "c/0", "c/0", "d/0", "d/1"]
        assert np.flatnonzero(results.is_repeated(joined)).tolist() == [3, 5]


def test_colliding_path_may_be_shorter_than_the_bound():
    assert len(join(runs([5.0, 4.0], feasible=[True, False]))) == 2


def test_bound_itself_and_what_the_tolerance_leaves_of_it_are_accepted():
    assert join(runs([BOUND, BOUND - 5e-9]))["bound"].tolist() == [BOUND, BOUND]


@pytest.mark.parametrize(
    ("which", "repeat"),
    [({"lowest": "objective"}, 2), ({"median": "objective"}, 0), ({"repeat": 3}, 3)],
)
def test_picked_run(which, repeat):
    table = runs([6.0, 7.0, 5.0, 4.0, 8.0], feasible=[True, True, True, False, True])
    assert results.pick(table, which)["repeat"] == repeat


def test_no_feasible_run_is_no_pick():
    assert results.pick(runs([5.0], feasible=False), {"lowest": "objective"}) is None


def test_of_equal_runs_the_first_repeat_is_picked():
    assert results.pick(runs([5.0, 5.0]).iloc[::-1], {"lowest": "objective"})["repeat"] == 0


def test_published_length_is_audited_against_the_bound_of_its_problem():
    """A row names its problem or workspace, the table's interpretation does, or the experiment has
    only one; spreads are no lengths.
    """
    table = pd.DataFrame(
        {
            "method": "a",
            "metric": ["length", "length", "length", "cpu_s"],
            "statistic": ["min", "mean", "std", "mean"],
            "as_printed": ["8.9", "9.1", "0.5", "0.1"],
        }
    )
    table["value"] = table["as_printed"].astype(float)
    two = pd.DataFrame({"bound": [9.0, 5.0]}, index=["disc", "other"])
    one = two.iloc[:1]

    def audited(table, bounds, primary):
        return [row["consistent"] for row in audit.check_lengths("t", table, bounds, primary)]

    assert audited(table, one, {}) == [False, True]
    assert audited(table, two, {}) == []
    assert audited(table, two, {"workspace": "other"}) == [True, True]
    assert audited(table.assign(workspace="disc"), two, {}) == [False, True]
    assert audited(table.assign(problem="other"), two, {}) == [True, True]
    assert audited(table.assign(problem="elsewhere"), one, {}) == []
