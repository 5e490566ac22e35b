"""One run again, from its name alone."""

import re

import pandas as pd
import pytest
from studies import study

from bezierplan.__main__ import main
from bezierplan.analysis.stored_runs import is_equal
from bezierplan.commands import replay
from bezierplan.running import execution, problems
from bezierplan.schema.checked import Fault
from bezierplan.study.jobs import build_chunk, build_problems_job

STUDIES = {"song2016": study("song2016")}


def test_run_made_again_equals_the_row_of_its_chunk(tmp_path):
    study = STUDIES["song2016"]
    described = build_chunk(study, "routes", "straight_line", "smoke", 0)
    made, _ = problems.build_all(build_problems_job(study, "routes", "smoke"), study.folder)
    runs, _ = execution.run_chunk(made, described)
    for row in runs.to_pylist():
        assert is_equal(replay.replay(row["id"], STUDIES).runs.iloc[0], row)


def test_a_run_is_described_and_drawn_with_its_first_collision(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    main(["replay", "song2016/routes/0_15/rounded/0", "--studies", "song2016"])
    assert re.search(r"^feasible +yes$", capsys.readouterr().out, re.MULTILINE)
    main(["replay", "song2016/routes/0_15/straight_line/0", "--studies", "song2016"])
    printed = capsys.readouterr().out
    assert re.search(r"^feasible +no: enters an obstacle at [\d.]+,[\d.]+, at most ", printed, re.M)
    picture = tmp_path / "results/replay/song2016/routes/0_15/straight_line/0.svg"
    assert "collision" in picture.read_text()


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("song2016/routes/0_15/smooth", "expected study/experiment/condition/method/repeat"),
        ("song2061/routes/0_15/smooth/0", "study: song2061: unknown; did you mean song2016"),
        ("song2016/route/0_15/smooth/0", "experiment: route: unknown; did you mean routes"),
        ("song2016/routes/0_16/smooth/0", "condition: 0_16: unknown; did you mean 0_15"),
        ("song2016/routes/0_15/smoth/0", "method: smoth: unknown; did you mean smooth"),
        ("song2016/routes/0_15/smooth/first", "repeat: first; expected a whole number"),
    ],
)
def test_unknown_part_of_a_name_is_told(name, told):
    with pytest.raises(Fault, match=told):
        replay.replay(name, STUDIES)


@pytest.mark.parametrize(
    ("column", "other"),
    [("feasible", False), ("collision_at", 0.5), ("path_points", [0.0, 0.0, 3.0, 3.0])],
)
def test_a_run_of_equal_length_but_another_verdict_or_path_is_not_equal(column, other):
    stored = {
        "length": 3.0,
        "feasible": True,
        "collision_at": 1.0,
        "path_points": [0.0, 0.0, 1.0, 2.0],
    }
    assert is_equal(pd.Series(stored), stored)
    assert not is_equal(pd.Series(stored), stored | {column: other})
    # A column that only other problems of the chunk have.
    assert is_equal(pd.Series(stored), stored | {"reference": None})
    assert not is_equal(pd.Series(stored), stored | {"reference": 3.0})
