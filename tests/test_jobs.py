"""Jobs of the workflow: what they are made of, names of studies and targets, and what the small
subset holds.
"""

import os
import re
from pathlib import Path

import pytest
from docutils.core import publish_parts
from snakemake.iocontainers import OutputFiles
from studies import studies, study

from bezierplan.analysis import rst
from bezierplan.running.inputs import BEYOND, PAPER
from bezierplan.running.jobs import log
from bezierplan.study import captions, evidence, jobs, loading, page, runs_behind

SONG = study("song2016")
STUDIES = {"song2016": SONG}


def elsewhere(tmp_path, key):
    folder = tmp_path / key
    folder.mkdir()
    return {key: SONG.but(key=key, folder=folder)}


def test_names_of_studies_of_the_project_and_fresh_ones_are_taken(tmp_path):
    """Others: `test_a_name_that_run_refuses_is_refused_by_check_study`."""
    loading.check_names(STUDIES | elsewhere(tmp_path, "my-study_2"))


HOSTILE = (
    "a title\n\n.. include:: /etc/passwd\n\n <b>x</b> `code`_ *bold* |sub| http://a.b {{ 7 }} \\"
)


def test_caption_is_one_line_that_says_just_what_it_says():
    html = publish_parts(rst.escape_rst(HOSTILE), writer="html")["body"]
    assert re.fullmatch("<p>[^<>]*</p>", html.strip())
    plain = html.replace("&lt;", "<").replace("&gt;", ">").strip()
    assert plain == f"<p>{' '.join(HOSTILE.split())}</p>"


def test_a_study_with_another_setting_is_marked_as_changed():
    """The others are not: the settings of the outcome are those of today."""
    assert [own.key for own in studies().values() if evidence.list_changes(own)] == []
    turned = SONG.but(settings=SONG.settings | {"population": 198})
    assert "population of smooth is 198, in the README's outcome 200" in evidence.list_changes(
        turned
    )


# Files that jobs write


def outputs(folder, *names):
    return OutputFiles(fromdict={name: str(folder / f"{name}.csv") for name in names})


def test_files_appear_when_all_are_written(tmp_path):
    """What a killed job left goes, and nothing of another job."""
    for name in ("one.csv", "another_one.csv"):
        left = tmp_path / f".part-{name}-killed"
        left.mkdir()
        (left / name).write_text("half")
    with log.write_whole_files(outputs(tmp_path, "one", "two")) as parts:
        for part in (parts.one, parts[1]):
            Path(part).write_text("x")
            assert not list(tmp_path.glob("*.csv"))
    assert sorted(os.listdir(tmp_path)) == [".part-another_one.csv-killed", "one.csv", "two.csv"]


# What jobs are made of


def test_a_table_and_its_caption_have_the_repeats_of_their_scale():
    repeats = SONG.experiments[SONG.tables["table1"].experiment].repeats
    assert repeats["smoke"] != repeats["full"]
    for scale in ("smoke", "full"):
        assert jobs.build_table_of_runs(SONG, scale, "table1").repeats == repeats[scale]
        told = captions.build_caption(SONG, "table1", scale).write()
        assert f"{repeats[scale]} runs of each method" in told


@pytest.mark.parametrize("key", studies())
def test_what_shows_a_method_shows_all_that_are_judged_with_it(key):
    own = study(key)
    shown = [
        runs_behind.list_methods(own, name) for name in (*own.find_tables_of_runs(), *own.figures)
    ]
    shown.append(jobs.build_claims(own, "full").shows)
    for experiment in own.experiments:
        methods = own.methods_of(experiment)
        groups = jobs.group_methods(own, "full", experiment, methods)
        assert sorted(name for group in groups for name in group) == sorted(methods)
        for group in map(set, groups):
            assert all(
                group <= {*by[experiment]} or group.isdisjoint(by[experiment])
                for by in shown
                if experiment in by
            )


def test_the_papers_own_are_the_numbered_ones():
    for own in studies().values():
        names = own.list_names(PAPER)
        assert all(re.fullmatch(r"(table|figure)\d+", name) for name in names)
        assert sorted([*names, *own.list_names(BEYOND)]) == sorted([*own.tables, *own.figures])
    counts = [len(own.list_names(PAPER)) for own in studies().values()]
    assert counts == [6, 20, 28, 7, 11]


# The scenarios of the papers, by experiment, with the methods that they compare.
SCENARIOS = {
    "elhoseny2017/fields100": {"mga", "ga", "prm"},
    "elhoseny2017/fields200": {"mga", "abc_ep"},
    "elhoseny2017/maps": {"mga"},
    "elhoseny2017/population": {"mga"},
    "elhoseny2017/iterations": {"mga"},
    "meledje/operators": {"proposed", "random"},
    "song2016/routes": {"smooth", "nonsmooth"},
    "ma2020/environments": {"bca_q"},
    "tharwat2018/maps": {"cpso1_singer", "cpso2_sine", "cpso2_tent"},
    "tharwat2018/control_points": {"cpso2_singer"},
    "tharwat2018/obstacles": {"cpso2_singer"},
    "tharwat2018/particles": {"cpso2_singer"},
    "tharwat2018/iterations": {"cpso2_singer"},
}


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_small_subset_holds_every_scenario(scenario):
    """What varies in each stands in the digests of scale smoke, and in the layouts of what the
    papers print.
    """
    assert SCENARIOS[scenario] <= page.find_results(studies(), "smoke")[scenario].keys()
