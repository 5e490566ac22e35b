"""Files of a job by what they are of: no job takes paths apart."""

import re
from pathlib import Path

import pytest
from studies import studies

from bezierplan.running import inputs
from bezierplan.running.inputs import Files
from bezierplan.study import targets

SOURCES = Path(__file__).parents[1] / "workflow" / "scripts"


def test_names_of_files_lead_back_to_their_experiments():
    files = {
        "first": Files({"mine": ["a/0", "a/1"], "yours": ["b/0"]}, "problems", "bounds"),
        "second": Files({}, "others", "theirs"),
        "a_study/first": Files({"mine": ["c/0"]}, "made", "exact"),
    }
    named = inputs.of_experiments(files)
    assert named["runs/first/mine"] == ["a/0", "a/1"]
    assert inputs.experiments(named) == files


@pytest.mark.parametrize("scale", ["smoke", "full"])
def test_jobs_of_all_studies_know_the_files_of_each(scale):
    given = studies()
    files = inputs.experiments(targets.baseline_comparison_inputs(given, scale))
    wanted = [
        f"{key}/{name}"
        for key, study in given.items()
        if study.baseline_comparison
        for name in study.baseline_comparison.experiments
    ]
    assert list(files) == wanted
    for name, each in files.items():
        study, experiment = name.split("/")
        assert set(each.runs) == {
            *given[study].experiments[experiment].methods,
            given[study].baseline_comparison.baseline,
        }
        assert all(f"/{study}/" in file for file in (*each.chunks, each.problems, each.bounds))


@pytest.mark.parametrize("script", sorted(SOURCES.glob("*.py")), ids=lambda file: file.stem)
def test_no_script_takes_a_path_apart(script):
    assert not re.search(r"\.(stem|parts|parents|split)\b", script.read_text())
