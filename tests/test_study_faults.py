"""Bad input: every fault of a study's files ends in one line before the first run."""

import shutil
from pathlib import Path

import pytest
from commands import refused
from trees import edit

from bezierplan.schema import checked
from bezierplan.study import checks, loading

pytestmark = pytest.mark.usefixtures("planners_are_read_here")

DATA, STUDIES = Path(__file__).parent / "data", Path(__file__).parents[1] / "config" / "studies"
FILE = checked.read(DATA / "faults.yaml")
PLANNERS = FILE.pop("planners")
FAULTS = {
    f"{study}: {name}": (study, fault)
    for study, faults in FILE.items()
    for name, fault in faults.items()
}


def copy(study, folder):
    """A study's folder to be spoilt."""
    home = STUDIES if (STUDIES / study).exists() else DATA
    return Path(shutil.copytree(home / study, folder / study))


def faults(folder):
    """The faults that loading a study tells: lines that can be printed, and that are no longer than
    a screen.
    """
    with pytest.raises(checked.Fault) as caught:
        loading.load([folder])
    assert all(line.isprintable() and len(line) < 1600 for line in caught.value.lines)
    return caught.value.lines


def told(folder):
    """The first of them."""
    return faults(folder)[0]


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_in_one_line(name, tmp_path):
    study, (file, *old, new, expected) = FAULTS[name]
    folder = copy(study, tmp_path)
    edit(folder / file, *old, new) if old else (folder / file).write_text(new)
    message = told(folder)
    assert expected in message
    assert Path(file).name in message or ".csv" in message


@pytest.mark.parametrize("name", PLANNERS)
def test_a_planner_that_is_none_is_told_in_one_line(name, tmp_path):
    folder, (text, expected) = copy("walks", tmp_path), PLANNERS[name]
    (folder / "walk.py").write_text(text)
    message = told(folder)
    assert expected in message
    assert "experiments.yaml: " in message


@pytest.mark.parametrize("name", ["experiments.yaml", "published/lengths.csv", "room.txt"])
@pytest.mark.parametrize("kind", ["folder", "elsewhere", "missing", "bytes"])
def test_what_is_no_file_of_the_study(kind, name, tmp_path):
    folder = copy("walks", tmp_path)
    file = folder / name
    file.unlink()
    match kind:
        case "folder":
            file.mkdir()
        case "elsewhere":
            file.symlink_to(tmp_path / "secret")
        case "bytes":
            file.write_bytes(b"\xff\xfe")
    assert Path(name).name in told(folder)


@pytest.mark.parametrize("name", ["artifacts.yaml", "claims.yml", "Layout.yaml"])
def test_a_file_of_a_study_that_nothing_reads_is_told(name, tmp_path):
    folder = copy("walks", tmp_path)
    (folder / name).write_text("{}")
    assert f"{name}: no file of a study; did you mean " in told(folder)


@pytest.mark.parametrize("name", ["my study", "müller", "2016", "x[1]", "all", "song2016"])
def test_a_name_that_run_refuses_is_refused_by_check_study(name, tmp_path, capsys):
    shutil.copytree(DATA / "walks", tmp_path / name)
    said = refused(capsys, "check-study", tmp_path / name)
    assert "rename the folder" in said or "another name" in said


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("experiments.yaml", "mine: {planner: walk.py", "mine: {planer: walk.py"),
        ("experiments.yaml", "settings: {tries: 20}", "settings: {tries: many}"),
        ("experiments.yaml", "vary: {tries:", "vary: {trees:"),
        ("artefacts.yaml", "tables:", "table:"),
        ("walk.py", "def plan", "import nothing_of_this_name\n\ndef plan"),
        ("walk.py", "def plan", "extra = ('length',)\n\ndef plan"),
        ("walk.py", "def plan", "extra = ('steps')\n\ndef plan"),
    ],
)
def test_a_fault_is_told_without_what_follows_from_it(file, old, new, tmp_path):
    folder = copy("walks", tmp_path)
    edit(folder / file, old, new)
    assert len(faults(folder)) == 1


PROBLEMS = """problems:
  inn: {workspace: rom, start_cell: 0, target_cell: 63}
  out: {workspace: rom, start_cell: 63, target_cell: 0}
  far: {workspace: room, start: [0.5, 0.5], target: [99, 7.5]}
  off: {workspace: room, start: [1.5, 0.5], target: [99, 7.5]}"""
TABLE = """: {title: Again, kind: pivot, experiment: first, index: [method], columns: [value],
    values: [{metric: lenght, statistic: median, label: length, decimals: 2}]}"""


def test_equal_faults_of_several_entries_and_what_fails_after_them_are_all_told(
    tmp_path, monkeypatch
):
    folder = copy("walks", tmp_path)
    for name, key, more in (
        ("experiments.yaml", "problems:", PROBLEMS),
        ("experiments.yaml", "problems:\n", "problems:\n  bad: {workspace: room, start: 3}\n"),
        ("experiments.yaml", "settings: {tries: 40}", "settings: {trys: 40}"),
        ("artefacts.yaml", "tables:", f"tables:\n  one{TABLE}\n  two{TABLE}"),
    ):
        edit(folder / name, key, more)
    monkeypatch.setattr(checks.Checks, "check_labels", lambda self: 1 / 0)
    lines = faults(folder)
    for part in ("workspace: rom: unknown", "target: [99, 7.5]: outside", "metric: lenght"):
        assert sum(part in line for line in lines) == 2
    assert sum("start: 3" in line or "trys: unknown" in line for line in lines) == 2
    assert sum("ZeroDivisionError" in line for line in lines) == 1
    assert len(lines) == 9
