"""Command lines that cannot be meant: one line without control characters, exit code 2, before any
work.
"""

import pytest
from commands import refused

from bezierplan.__main__ import main
from bezierplan.commands import run
from bezierplan.schema.checked import Fault

NO_STUDY = "not a name of a study; expected at most 100 letters, digits, _ and -, a letter first; "
WORDS = {
    "results of two lines": (["verify", "x\ny"], "x\\ny: no runs here"),
    "a misspelt kind": (["list", "metods"], "list: metods: unknown; did you mean methods?"),
    "no core": (["verify", ".", "--cores", "0"], "--cores: 0; expected a number of at least 1"),
    "a study of two lines": (["new", "x\n"], f"x\\n: {NO_STUDY}"),
    "a study of a long name": (["new", "x" * 300], NO_STUDY),
    "a study where nothing can be made": (["new", "/proc/x"], "/proc/x: No such file or directory"),
    "a study in a file": (
        ["new", "a_file/x"],
        "a_file/x: expected a new folder in one that exists",
    ),
}


@pytest.mark.parametrize("case", WORDS)
def test_words_that_cannot_be_meant_end_in_one_line(case, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a_file").touch()
    words, told = WORDS[case]
    line = refused(capsys, *words)
    assert told in line
    assert line.isprintable()
    assert [file.name for file in tmp_path.iterdir()] == ["a_file"]


def test_without_a_word_about_cores_the_workflow_starts(monkeypatch):
    """They are the profile's."""
    started = []

    class Started:
        def __init__(self, words, **_):
            started.append(words)

        def wait(self):
            return 3

    monkeypatch.setattr(run.subprocess, "Popen", Started)
    monkeypatch.setattr(run.signal, "signal", lambda *_: None)
    with pytest.raises(SystemExit) as found:
        main(["run", "mystudy"])
    assert found.value.code == 3
    assert started == [run.build_command(["mystudy"])]
    with pytest.raises(Fault, match=r"^no/where: expected the folder of a study"):
        run.build_command(["results/full/page.html", "--cores", "2", "-n", "a/b", "no/where"])
    with pytest.raises(Fault, match=r"^--scale: expected a target in its place: smoke, all"):
        run.build_command(["mystudy", "--scale=smoke"])
