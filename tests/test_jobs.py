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
from bezierplan.schema.checked import Fault
from bezierplan.study import captions, evidence, jobs, loading, page, runs_behind

SONG = study("song2016")
STUDIES = {"song2016": SONG}
RULES = ("runs", "table", "all", "default")


def fault(given):
    with pytest.raises(Fault) as caught:
        loading.check_names(given)
    return str(caught.value)


def elsewhere(tmp_path, key):
    folder = tmp_path / key
    folder.mkdir()
    return {key: SONG.but(key=key, folder=folder)}


def test_names_of_studies_of_the_project_and_fresh_ones_are_taken(tmp_path):
    loading.check_names(STUDIES | elsewhere(tmp_path, "my-study_2"))


@pytest.mark.parametrize(
    ("key", "reason"),
    [
        *((key, f"{key}: not a name of a study") for key in ("x[1]", "{scale}", "a b", "2016")),
        *((key, f"{key}: a target has this name already") for key in RULES),
        ("song2016", "has a study song2016 already, whose results this one would overwrite"),
    ],
)
def test_a_name_that_would_clash_is_refused(tmp_path, key, reason):
    assert reason in fault(STUDIES | elsewhere(tmp_path, key))


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


# The scenarios of the papers, each by what tells its runs apart: study, keys of a problem, varied
# settings, methods.
SCENARIOS = {
    "random fields of side 100": ("elhoseny2017", {"side": 100}, set(), {"mga", "ga", "prm"}),
    "random fields of side 200": ("elhoseny2017", {"side": 200}, set(), {"mga", "abc_ep"}),
    "six maps": (
        "elhoseny2017",
        {
            "workspace": {
                "back_and_forth",
                "bugtrap1",
                "complex2",
                "gaps",
                "hidden_u",
                "square_spiral",
            }
        },
        set(),
        {"mga"},
    ),
    "populations": ("elhoseny2017", {}, {"population"}, {"mga"}),
    "iterations": ("elhoseny2017", {}, {"iterations"}, {"mga"}),
    "grids that change": (
        "meledje",
        {"workspace": {"env1_initial", "env1_modified", "env2_initial", "env2_modified"}},
        set(),
        {"proposed", "random"},
    ),
    "a smooth path over grid cells": ("song2016", {}, set(), {"smooth", "nonsmooth"}),
    "two environments": (
        "ma2020",
        {"workspace": {"environment1", "environment2"}},
        set(),
        {"bca_q"},
    ),
    "chaotic maps": ("tharwat2018", {}, set(), {"cpso1_singer", "cpso2_sine", "cpso2_tent"}),
    "control points": ("tharwat2018", {}, {"control_points"}, set()),
    "obstacles": ("tharwat2018", {"obstacles": set(range(1, 11))}, set(), set()),
    "particles": ("tharwat2018", {}, {"particles"}, set()),
    "iterations of swarms": ("tharwat2018", {}, {"iterations"}, set()),
}


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_small_subset_holds_every_scenario(scenario):
    """In one experiment of the jobs of smoke."""
    key, place, varied, methods = SCENARIOS[scenario]
    own = study(key)
    for name, made in page.find_results(studies(), "smoke").items():
        if not name.startswith(f"{key}/") or not methods <= made.keys():
            continue
        experiment = name.partition("/")[2]
        chunk = jobs.build_chunk(own, experiment, next(iter(made)), "smoke", 0)
        places = list(chunk.problems.values())
        described = own.problems_of(experiment, "smoke").values()
        if varied <= chunk.vary.keys() and all(
            (values if isinstance(values, set) else {values})
            <= {each.get(column) for each in (*places, *described)}
            for column, values in place.items()
        ):
            return
    raise AssertionError("no experiment of smoke has it")
