"""Names of studies and targets, words for the report, and files that jobs write."""

import dataclasses
import os
import re
from types import SimpleNamespace

import pytest
from docutils.core import publish_parts
from snakemake.iocontainers import OutputFiles
from studies import studies, study

from bezierplan.running import log
from bezierplan.schema.checked import Fault
from bezierplan.study import design, experiments, jobs, reading, targets

SONG = study("song2016")
STUDIES = {"song2016": SONG}
RULES = ("runs", "table", "all", "default")


def fault(studies):
    with pytest.raises(Fault) as caught:
        reading.check_names(studies, RULES)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def elsewhere(tmp_path, key):
    folder = tmp_path / key
    folder.mkdir()
    return {key: dataclasses.replace(SONG, key=key, folder=folder)}


def test_studies_of_the_project_have_names_of_their_own():
    reading.check_names(STUDIES, RULES)


def test_fresh_name_is_taken(tmp_path):
    reading.check_names(elsewhere(tmp_path, "my-study_2") | STUDIES, RULES)


@pytest.mark.parametrize("key", ["x[1]", "{scale}", "a b", "2016", "$(date)", "..x"])
def test_folder_that_is_no_name_is_told(tmp_path, key):
    assert f"{key}: not a name of a study" in fault(elsewhere(tmp_path, key))


@pytest.mark.parametrize("key", RULES)
def test_folder_named_like_a_target_is_told(tmp_path, key):
    assert f"{key}: the workflow has a target of this name already" in fault(
        elsewhere(tmp_path, key)
    )


def test_folder_named_like_a_target_of_another_study_is_told(tmp_path):
    told = fault(STUDIES | elsewhere(tmp_path, "song2016_table1"))
    assert "song2016_table1: study song2016 has a target of this name already" in told


def test_folder_that_would_overwrite_results_of_a_study_is_told(tmp_path):
    assert "has a study song2016 already, whose results this one would overwrite" in fault(
        elsewhere(tmp_path, "song2016")
    )


def test_results_that_cannot_be_written_are_told(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    reading.check_start(1)
    (tmp_path / "results").touch()
    with pytest.raises(Fault, match="results: cannot be written"):
        reading.check_start(1)


HOSTILE = (
    "a title\n\n.. include:: /etc/passwd\n\n.. raw:: html\n\n   <b>x</b> </script> `code`_ "
    "*bold* |sub| http://a.b {{ 7 * 7 }} \\"
)


def test_caption_is_one_line_that_says_just_what_it_says():
    html = publish_parts(targets.escaped(HOSTILE), writer="html")["body"]
    assert re.fullmatch("<p>[^<>]*</p>", html.strip())
    plain = (
        html.replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", '"')
        .replace("&amp;", "&")
        .strip()
    )
    assert plain == f"<p>{' '.join(HOSTILE.split())}</p>"


def test_files_appear_when_all_are_written(tmp_path):
    names = OutputFiles(
        fromdict={"one": str(tmp_path / "one.csv"), "two": str(tmp_path / "two.csv")}
    )
    with log.whole_files(names) as parts:
        for part in (parts.one, parts[1]):
            assert part.endswith(".csv")
            with open(part, "w") as file:
                file.write("x")
            assert not list(tmp_path.glob("*.csv"))
    assert sorted(os.listdir(tmp_path)) == ["one.csv", "two.csv"]


def test_what_a_killed_job_left_is_removed_when_it_runs_again(tmp_path):
    for name in ("one.csv", "another_one.csv"):
        left = tmp_path / f".part-{name}-killed"
        left.mkdir()
        (left / name).write_text("half")
    names = OutputFiles(fromdict={"one": str(tmp_path / "one.csv")})
    with log.whole_files(names) as parts, open(parts.one, "w") as file:
        file.write("x")
    assert sorted(os.listdir(tmp_path)) == [".part-another_one.csv-killed", "one.csv"]


def test_failed_job_leaves_no_file_and_names_a_damaged_input(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(log, "end_with_parent", lambda: None)
    monkeypatch.setattr(log.watchdog, "supervise", lambda *_: None)
    damaged = tmp_path / "cut.parquet"
    damaged.write_bytes(b"PAR1")
    output = OutputFiles(fromdict={"one": str(tmp_path / "one.csv")})
    given = SimpleNamespace(log=[str(tmp_path / "log")], input=[str(damaged)], output=output)
    with pytest.raises(SystemExit, match=r"^1$"), log.job(given):
        raise ValueError("no footer")
    assert (
        capsys.readouterr().err == f"{damaged}: not a whole Parquet file; "
        "delete it and start again: the workflow reproduces it\n"
    )
    assert sorted(os.listdir(tmp_path)) == ["cut.parquet"]
    given.input = []
    with pytest.raises(SystemExit, match=r"^1$"), log.job(given):
        raise ValueError("no footer")
    assert capsys.readouterr().err.startswith("ValueError: no footer")


@pytest.fixture
def once():
    """song2016 with as many repeats at each scale."""
    content = SONG.experiments["routes"]
    sizes = {name: dict.fromkeys(experiments.SCALES, 50) for name in ("repeats", "chunk")}
    return dataclasses.replace(SONG, experiments={"routes": content.but(**sizes)})


@pytest.mark.parametrize(
    ("scale", "kept"), [("smoke", "smoke"), ("full", "full"), ("extended", "full")]
)
def test_experiment_of_the_same_size_runs_once_for_both_scales(once, scale, kept):
    (files,) = targets.judged_by_claims(once, scale).values()
    assert {file.split("/")[1] for file in (*files.chunks, files.problems, files.bounds)} == {kept}


def test_experiment_with_more_repeats_keeps_its_own_runs():
    (files,) = targets.judged_by_claims(SONG, "extended").values()
    assert {file.split("/")[1] for file in files.chunks} == {"extended"}


def test_extended_leaves_out_what_would_be_as_at_full(once):
    drawings = {"figure1", "figure2", "identified"}  # without runs
    assert targets.artefacts_of(SONG, "full") == [*SONG.tables, *SONG.figures]
    assert (
        set(targets.artefacts_of(SONG, "full")) - set(targets.artefacts_of(SONG, "extended"))
        == drawings
    )
    assert targets.artefacts_of(once, "extended") == []
    assert targets.artefacts_of(once, "full") == [*SONG.tables, *SONG.figures]


def test_a_table_and_its_caption_have_the_repeats_of_their_scale():
    repeats = SONG.experiments[SONG.tables["table1"].experiment].repeats
    assert repeats["smoke"] != repeats["full"]
    for scale in ("smoke", "full"):
        assert jobs.table_job(SONG, "table1", scale).repeats == repeats[scale]
        assert f"{repeats[scale]} runs of each method" in jobs.caption(SONG, "table1", scale)


def test_a_figure_that_shows_published_numbers_depends_on_their_files(monkeypatch):
    monkeypatch.setattr(targets, "content_digest", lambda *files: files)
    drawn = 0
    for key, own in studies().items():
        for figure in own.figures:
            if jobs.published_drawn(own, figure):
                drawn += 1
                assert set(own.published_files()) <= set(
                    targets.figure_params({key: own}, "smoke", key, figure)["sources"]
                )
    assert drawn


def test_two_layouts_stand_for_all():
    own, found = studies()["meledje"], set()
    for experiment in own.experiments:
        found |= {row["layout"] for row in design.Design(own).rows(experiment) if "layout" in row}
    assert found == {0, 1}
