"""A study is checked once for each content: what was checked before is only read."""

import contextlib
import io
import os
import pickle
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import starts

from bezierplan.schema.checked import Fault
from bezierplan.study import checks as study_checks
from bezierplan.study import reading, stamps

SONG2016 = Path(__file__).parents[1] / "config" / "studies" / "song2016"


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.setattr(stamps, "STAMPS", tmp_path / "stamps")
    return Path(shutil.copytree(SONG2016, tmp_path / "song2016"))


@pytest.fixture
def checks(monkeypatch):
    """Keys of the studies that were checked."""
    checked, check = [], study_checks.check
    monkeypatch.setattr(
        study_checks, "check", lambda study: (checked.append(study.key), check(study))
    )
    return checked


def test_equal_content_is_checked_once(study, checks):
    told = []
    reading.load([study], lambda: told.append(list(checks)))
    reading.load([study], lambda: told.append(list(checks)))
    assert checks == ["song2016"]
    assert told == [[]], "to be told before the check, and of this one alone"


def test_a_study_that_is_not_needed_is_checked_another_time(study, checks):
    assert reading.load([study], is_needed=lambda folder: False) == {}
    assert checks == []
    assert list(reading.load([study])) == ["song2016"]
    assert list(reading.load([study], is_needed=lambda folder: False)) == ["song2016"]
    assert checks == ["song2016"]


FOLDERS = [Path("config/studies/walk"), Path("config/studies/walk_far"), Path("elsewhere/swim")]


@pytest.mark.parametrize(
    ("targets", "needed"),
    [
        ([], ["walk", "walk_far", "swim"]),
        (["all"], ["walk", "walk_far", "swim"]),
        (["walk"], ["walk"]),
        (["swim_figure4"], ["swim"]),
        (["swim_figure4", "walk"], ["walk", "swim"]),
        (["swim_figure4", "smoke"], ["walk", "walk_far", "swim"]),
        # A table of one, or a figure of the other.
        (["walk_far_1"], ["walk", "walk_far"]),
        (["results/full/swim/claims.csv"], ["swim"]),
        (["results/full/swim"], ["swim"]),
        (["results/full/index.html"], ["walk", "walk_far", "swim"]),
        (["swimming_1"], ["walk", "walk_far", "swim"]),
    ],
)
def test_a_target_needs_the_studies_that_it_is_named_after(targets, needed):
    assert [
        folder.name for folder in FOLDERS if reading.asked_for(folder, targets, FOLDERS)
    ] == needed


def test_a_target_of_one_study_starts_beside_a_fault_in_another(tmp_path):
    """Everything together does not."""
    shutil.copytree(SONG2016, tmp_path / "bad")
    (tmp_path / "bad" / "claims.yaml").write_text("claims: many\n")
    words = [
        *("--snakefile", str(SONG2016.parents[2] / "Snakefile")),
        *("--workflow-profile", "none", "--cores", "1", "--dry-run"),
        *("--config", "studies=[song2016, ./bad]"),
    ]
    codes = [
        starts.snakemake(tmp_path, *words, *targets).returncode
        for targets in (["--", "song2016_table1"], [])
    ]
    assert codes == [0, 2]


# What jobs need and a start does not: to import it would take as long as all else that a start
# does.
HEAVY = {"matplotlib", "numba", "pandas", "pyarrow", "scipy", "seaborn", "shapely"}
START = """
import sys
from bezierplan.study import page, reading, targets
studies = reading.load(reading.read_config({}))
assert targets.files_of_scale(studies, "full")
print(*sys.modules)
"""


def test_a_start_imports_nothing_that_only_jobs_need():
    reading.load(reading.read_config({}))
    done = subprocess.run(
        [sys.executable, "-c", START],
        cwd=SONG2016.parents[2],
        capture_output=True,
        text=True,
        check=True,
    )
    assert not HEAVY & {*done.stdout.split()}


@pytest.mark.parametrize("name", ["claims.yaml", "workspaces/figure2.txt", "published/table1.csv"])
def test_any_change_of_a_file_is_checked(study, checks, name):
    reading.load([study])
    file = study / name
    file.write_text(file.read_text() + "\n")
    with contextlib.suppress(Fault):
        reading.load([study])
    assert checks == ["song2016"] * 2


def test_a_new_or_renamed_file_and_a_changed_package_are_checked(study, checks, monkeypatch):
    reading.load([study])
    (study / "other.txt").write_text("")
    reading.load([study])
    (study / "other.txt").rename(study / "renamed.txt")
    reading.load([study])
    monkeypatch.setattr(stamps, "_package", lambda: "changed")
    reading.load([study])
    assert checks == ["song2016"] * 4


def test_a_fault_is_found_every_time(study):
    file = study / "workspaces" / "figure2.txt"
    file.write_text(file.read_text().replace(".", "x", 1))
    messages = []
    for _ in range(2):
        with pytest.raises(Fault) as caught:
            reading.load([study])
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


def test_what_cannot_be_known_has_no_stamp(study, monkeypatch):
    assert stamps.stamp_of(study)
    monkeypatch.setattr(stamps, "MOST_READ", 100)
    assert stamps.stamp_of(study) is None
    monkeypatch.undo()
    os.mkfifo(study / "pipe")
    assert stamps.stamp_of(study) is None
    (study / "pipe").unlink()
    (study / "link").symlink_to(study / "claims.yaml")
    assert stamps.stamp_of(study) is None


def test_stamps_that_cannot_be_written_do_no_harm(study, checks, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(stamps, "STAMPS", tmp_path / "file" / "stamps")
    reading.load([study])
    reading.load([study])
    assert checks == ["song2016"] * 2


def test_a_study_that_was_remembered_is_the_same_wherever_it_lies(
    study, checks, monkeypatch, tmp_path
):
    first = reading.load([study])["song2016"]
    moved = Path(shutil.move(study, tmp_path / "elsewhere" / "song2016"))
    monkeypatch.setattr(reading, "read_study", None)
    assert reading.load([moved])["song2016"] == replace(first, folder=moved)


@pytest.mark.parametrize("length", [0, 100])
def test_a_damaged_stamp_counts_as_none(study, checks, length):
    first = reading.load([study])
    stamp = stamps.stamp_of(study)
    stamp.write_bytes(stamp.read_bytes()[:length])
    assert reading.load([study]) == reading.load([study]) == first
    assert checks == ["song2016"] * 2


def test_a_stamp_knows_what_a_configuration_changes(study):
    assert stamps.stamp_of(study, "settings") not in (
        stamps.stamp_of(study),
        stamps.stamp_of(study, "other settings"),
    )


class Call:
    """Writes a file when it comes out of a pickle."""

    def __init__(self, file):
        self.file = file

    def __reduce__(self):
        return os.mkdir, (str(self.file),)


def stamp_of(study):
    reading.load([study])
    (stamp,) = stamps.STAMPS.iterdir()
    return stamp


def test_a_stamp_calls_nothing(study, checks, tmp_path):
    stamp = stamp_of(study)
    stamp.write_bytes(pickle.dumps(Call(tmp_path / "called")))
    reading.load([study])
    assert checks == ["song2016"] * 2
    assert not (tmp_path / "called").exists()


@pytest.mark.parametrize(
    "name",
    [
        "bezierplan.running.digest os.mkdir",
        "bezierplan.study.stamps remember",
        "builtins eval",
        "os mkdir",
    ],
)
def test_a_stamp_is_made_of_models_alone(name):
    with pytest.raises(pickle.UnpicklingError, match="no part of a study"):
        stamps._Unpickler(io.BytesIO()).find_class(*name.split())


@pytest.mark.parametrize("of", ["the folder", "the stamp"])
def test_a_stamp_that_others_could_have_written_is_not_read(study, checks, of):
    stamp = stamp_of(study)
    (stamp if of == "the stamp" else stamp.parent).chmod(0o777)
    assert stamps.remembered(stamp, study) is None
    reading.load([study])
    assert checks == ["song2016"] * 2
    assert stamps.remembered(stamp, study) is not None
