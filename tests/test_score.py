"""`score`: paths and planners beside the papers' methods, whose summaries are stored."""

import numpy as np
import pandas as pd
import pytest
from commands import refused

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.analysis.numbers import benchmark


def test_summaries_count_free_runs_and_take_the_excess_of_these():
    runs = pd.DataFrame({"problem": "a", "method": ["m"] * 3 + ["n"], "shortest": 10.0})
    runs = runs.assign(length=[12.0, 1.0, 11.0, 11.2], feasible=[True, False, True, True])
    runs = runs.assign(evaluations=5, curvature=1.0, cpu_s=2.0)
    rows = benchmark.compute_summaries(runs).set_index("method")
    assert rows.loc["m"].to_list()[1:] == pytest.approx([3, 2 / 3, 11.5, 0.15, 1, 5, 2])
    # Free more often comes before shorter; of two problems the mean rank.
    other = rows.reset_index().assign(problem="b", feasible=1.0)
    ranks = benchmark.rank_methods(pd.concat([rows.reset_index(), other]))["rank"]
    assert ranks.to_dict() == {"n": 1.0, "m": 2.0}
    tied = benchmark.rank_methods(rows.reset_index().assign(feasible=1.0, excess=np.nan))["rank"]
    assert tied.to_list() == [1.5, 1.5]


@pytest.fixture
def scored(capsys):
    def score(*words):
        main(["score", "song2016/routes", *map(str, words)])
        _, _, *lines = capsys.readouterr().out.splitlines()
        return {name: row for name, *row in map(str.split, lines)}

    return score


def test_a_planner_and_its_paths_score_as_the_paper_s_runs_of_it(scored, tmp_path):
    problems = bp.problems("song2016/routes")
    answers = [bp.plan(each, "song2016/shortest_path") for each in problems.values()]
    file = tmp_path / "paths.csv"
    paths = {
        "problem": list(problems),
        "curve": [each.path.curve for each in answers],
        "points": [" ".join(map(str, each.path.points.ravel().tolist())) for each in answers],
        "evaluations": 1,
    }
    pd.DataFrame(paths).to_csv(file, index=False)
    made = f"--problems={tmp_path}/p.csv --out={tmp_path}/o.csv --plot={tmp_path}/p.svg".split()
    rows = scored(file, "song2016/shortest_path", "--repeats", 1, *made)
    assert pd.read_csv(tmp_path / "o.csv")["method"].to_list() == [*rows]
    assert (tmp_path / "p.svg").read_text().count("15_240") == 1
    assert rows[f"here:{file}"] == rows["here:song2016/shortest_path"]
    listed = pd.read_csv(tmp_path / "p.csv")
    bounds = [bp.plan(each, "song2016/shortest_path").length for each in problems.values()]
    assert listed["bound"].to_list() == pytest.approx(bounds)
    assert listed["problem"].to_list() == list(problems)
    paths["points"][0] = "0 0 1 1"
    pd.DataFrame(paths).to_csv(file, index=False)
    with pytest.raises(SystemExit):
        scored(file)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("problem,points\n0_15,0 0 1 1\n", "columns: curve: unknown"),
        ("problem,curve,points\nnope,polyline,0 0 1 1\n", "problem: nope: unknown"),
        ("problem,curve,points\n0_15,polyline,0 0 1\n", "row 1: points: expected x y"),
        ("problem,curve,points\n0_15,line,0 0 1 1\n", "row 1: curve: line: unknown"),
        ("problem,curve,points\n0_15,polyline,0 0 1 1\n", "0_15: path: start"),
        ("", "is empty"),
    ],
)
def test_a_file_of_paths_that_cannot_be_scored_is_told_in_one_line(text, word, tmp_path, capsys):
    file = tmp_path / "paths.csv"
    file.write_text(text)
    line = refused(capsys, "score", "song2016/routes", file)
    assert word in line
    assert str(file) in line


def test_what_is_stored_is_of_the_problems_that_studies_have():
    drawn = "elhoseny2017/fields100"
    for experiment in ("song2016/routes", "meledje/operators", "elhoseny2017/maps", drawn):
        own = benchmark.read_stored(experiment)
        assert set(own["problem"]) == set(bp.problems(experiment))
