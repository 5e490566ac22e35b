"""What the files of a study mean, and how a configuration names studies."""

import shutil
from pathlib import Path

import pytest
import tables_of_keys as keys
from studies import KEYS, study
from trees import edit

from bezierplan.places import TREE
from bezierplan.running import execution
from bezierplan.running.chunk import Condition
from bezierplan.schema import checked, model
from bezierplan.schema.checked import Fault
from bezierplan.study import artefacts, jobs, loading

SONG = Path(__file__).parents[1] / "config" / "studies" / "song2016"


@pytest.fixture
def folder(tmp_path):
    """A copy of song2016 to be spoilt."""
    return Path(shutil.copytree(SONG, tmp_path / "song2016"))


EXPERIMENTS = "experiments.yaml"


def test_the_same_study_twice_is_told():
    with pytest.raises(Fault, match="name song2016 is there already"):
        loading.load([SONG, SONG])


def test_settings_of_a_problem_stand_between_those_of_the_study_and_of_a_method(folder):
    place = "\n  0_255: {workspace: figure2,"
    edit(
        folder / EXPERIMENTS,
        place,
        f"{place} settings: {{genes: 5, samples: 7, generations: 9}},",
    )
    study = loading.load([folder])["song2016"]
    job = jobs.build_chunk(study, "routes", "smooth", "smoke", 0)
    first, second = (
        execution.resolve_settings(job, Condition(problem, {})) for problem in ("0_15", "0_255")
    )
    assert (first["genes"], first["generations"], first["samples"]) == (6, 100, 501)
    assert second == first | {"genes": 5, "generations": 9}  # the method has samples of its own
    assert execution.resolve_settings(job, Condition("0_255", {"genes": 4}))["genes"] == 4
    assert (
        "settings"
        not in jobs.build_chunk(study, "routes", "shortest_path", "smoke", 0).problems["0_255"]
    )
    assert all(
        "settings" not in problem
        for problem in jobs.build_problems_job(study, "routes", "smoke").problems.values()
    )


def test_panels_that_are_written_once_are_those_written_out():
    def panels(*given):
        figure = {"title": "A figure", "columns": 1, "panels": list(given)}
        return (
            model.parse(artefacts.ArtefactsFile, {"figures": {"figure1": figure}}, "here")
            .figures["figure1"]
            .panels
        )

    shared = {"kind": "boxes", "experiment": "routes", "metric": "length"}
    first = {"title": "one", "where": {"method": "smooth", "problem": ["0_15"]}, "context": True}
    second = {"where": {"problem": ["15_255"], "method": "smooth"}}
    each = [
        {"title": "one", "where": {"problem": ["0_15"]}, "context": True},
        {"where": {"problem": ["15_255"]}},
    ]
    last = {"kind": "workspace", "workspace": "figure2"}
    once = panels(shared | {"where": {"method": "smooth"}, "each": each}, last)
    assert [panel.plain() for panel in once] == [shared | first, shared | second, last]
    assert [panel.place for panel in once] == ["0: each: 0", "0: each: 1", "1"]


def test_tables_of_keys_are_those_of_the_models():
    """`python docs/tables_of_keys.py` renews them."""
    text = keys.README.read_text(encoding="utf-8")
    assert keys.update(text) == text
    assert text.count("<!-- keys of ") == 21


def test_settings_of_a_planner_stand_between_those_of_the_study_and_of_a_method(folder):
    own = "  binary_genetic: {generations: 7, samples: 7}\n  genes: 6"
    edit(folder / EXPERIMENTS, "  genes: 6", own)
    study = loading.load([folder])["song2016"]
    resolved = study.resolve_settings("smooth")
    assert (resolved["generations"], resolved["samples"], resolved["genes"]) == (7, 501, 6)
    assert study.resolve_settings("shortest_path") == {}


def test_a_paper_is_cited_alike_by_its_study_and_by_this_software():
    cited = checked.read(TREE / "CITATION.cff")["references"]
    studies = {key: study(key).paper for key in KEYS}
    assert {each["notes"].split(":")[0].strip(): each["title"] for each in cited} == {
        key: paper.title for key, paper in studies.items()
    }
    assert {each.get("doi") for each in cited} == {paper.doi for paper in studies.values()}
