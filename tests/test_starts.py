"""A start checks only what has changed, and only the studies that it is asked for."""

import contextlib
import os
import shutil
from pathlib import Path

import pytest

from bezierplan.places import STUDIES
from bezierplan.schema.checked import Fault
from bezierplan.study import checks, loading

pytestmark = pytest.mark.usefixtures("planners_are_read_here")

WALKS = Path(__file__).parent / "data" / "walks"


@pytest.fixture
def checked(monkeypatch, tmp_path):
    """Studies that were checked; what is known of earlier checks lies in a folder of its own."""
    names, check = [], checks.Checks.check
    monkeypatch.setattr(loading, "find_cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(
        checks.Checks, "check", lambda self: names.append(self.study.key) or check(self)
    )
    return names


@pytest.fixture
def walks(tmp_path):
    return Path(shutil.copytree(WALKS, tmp_path / "walks"))


def test_what_was_checked_is_not_checked_again(checked, walks):
    first, second = loading.load([walks]), loading.load([walks])
    assert checked == ["walks"]
    assert first == second


@pytest.mark.parametrize(
    "name", ["experiments.yaml", "artefacts.yaml", "walk.py", "room.txt", "published/lengths.csv"]
)
def test_an_edit_of_any_file_is_checked(checked, walks, name):
    loading.load([walks])
    file = walks / name
    date = file.stat().st_mtime_ns
    file.write_bytes(file.read_bytes() + b"\n")
    os.utime(file, ns=(date, date))
    with contextlib.suppress(Fault):  # an empty line of a map is one
        loading.load([walks])
    assert checked == ["walks", "walks"]


def test_a_file_behind_a_link_a_setting_and_the_package_are_checked(checked, walks, monkeypatch):
    loading.load([walks])
    shutil.move(walks / "room.txt", walks.parent / "room.txt")
    (walks / "room.txt").symlink_to(walks.parent / "room.txt")
    with pytest.raises(Fault, match="lies outside the study's folder"):
        loading.load([walks])
    (walks / "room.txt").unlink()
    shutil.move(walks.parent / "room.txt", walks / "room.txt")
    loading.load([walks])
    assert len(checked) == 2
    with pytest.raises(Fault, match="triez: unknown"):
        loading.load({walks: {"triez": 3}})
    monkeypatch.setattr(loading, "_describe_package", lambda: ["another"])
    loading.load([walks])
    assert len(checked) == 4


def test_a_study_with_a_fault_is_told_each_time(checked, walks):
    (walks / "room.txt").write_text("no map")
    for _ in range(2):
        with pytest.raises(Fault, match=r"room\.txt"):
            loading.load([walks])
    assert checked == ["walks", "walks"]


def test_without_a_place_to_keep_it_a_study_is_checked_each_time(checked, walks, tmp_path):
    (tmp_path / "cache").write_text("")
    assert loading.load([walks]) == loading.load([walks])
    assert checked == ["walks", "walks"]


@pytest.mark.parametrize(
    ("targets", "expected"),
    [
        ([], {"song2016", "ma2020"}),
        (["song2016"], {"song2016"}),
        (["song2016_figure4"], {"song2016"}),
        (["results/full/ma2020/paper/table1.csv"], {"ma2020"}),
        (["ma2020_table1", "song2016_beyond"], {"song2016", "ma2020"}),
        (["ma2020_table1", "smoke"], {"song2016", "ma2020"}),
        (["results/full/index.html"], {"song2016", "ma2020"}),
        (["song2016b"], {"song2016", "ma2020"}),
    ],
)
def test_targets_of_one_study_ask_for_no_other(targets, expected):
    folders = {STUDIES / name: {} for name in ("song2016", "ma2020")}
    assert {folder.name for folder in loading.select_studies(folders, targets)} == expected
