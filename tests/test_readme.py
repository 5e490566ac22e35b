"""Every shell command of the README, executed in a copy of the tree whose configuration names
song2016 alone.

As printed: what takes seconds. As dry runs (`snakemake -n`, `make -n`): what takes minutes to
hours.
"""

import functools
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
import starts
import trees

ROOT = Path(__file__).parents[1]
SMOKE = ROOT / "results" / "smoke"
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", README, flags=re.M | re.S)
COMMANDS = [
    re.split(r"\s+# ", line)[0]
    for language, block in BLOCKS
    if language == "sh"
    for line in block.splitlines()
]

DRY = {
    "make reproduce": "make -n reproduce",
    "make test": "make -n test",
    "snakemake song2016": "snakemake -n song2016",
    "snakemake song2016_figure4": "snakemake -n song2016_figure4",
    "snakemake song2016_beyond": "snakemake -n song2016_beyond",
}
# These read results, so they come last.
LATE = [
    command
    for command in COMMANDS
    if any(word in command for word in (" --report ", " digest ", " verify ", " replay "))
]
ORDER = [command for command in COMMANDS if command not in LATE] + LATE


def test_commands_that_are_not_executed_as_printed_stand_in_the_readme():
    assert DRY.keys() <= set(COMMANDS)


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the tree with the small subset, which `make test` makes before the tests; a blank
    in the path.
    """
    assert SMOKE.is_dir(), "run snakemake smoke first"
    tree = trees.copy(tmp_path_factory.mktemp("readme") / "a clone")
    (tree / ".venv").symlink_to(ROOT / ".venv")
    (tree / "results/smoke").symlink_to(SMOKE)
    return tree


@functools.cache
def executed(tree, command):
    """What a command prints, which must succeed; each is executed once. A dry run needs no
    shell.
    """
    if command.startswith("snakemake -n "):
        done = starts.snakemake(tree, *shlex.split(command)[1:])
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr
    environment = os.environ | {"PYTHONPATH": str(tree / "src")}
    done = subprocess.run(
        ["bash", "-c", f". .venv/bin/activate && {command}"],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert not (tree / "bad").exists()
    return done.stdout + done.stderr


@pytest.mark.parametrize("command", ORDER)
def test_command_works_as_printed(tree, command):
    assert executed(tree, DRY.get(command, command)) or command.startswith(". ")


def test_own_study_of_the_readme_was_run(tree):
    """And its progress is shown without a terminal."""
    told = executed(tree, "python -m bezierplan run mystudy")
    assert "Results: results/full, results/full/mystudy" in told
    assert re.search(r"^100 %: (\d+) of \1 jobs, \d+:\d\d:\d\d elapsed$", told, flags=re.M)
    table = (tree / "results/full/mystudy/beyond/lengths.csv").read_text()
    assert "mine" in table
    assert "genetic" in table


def test_example_in_python_works_as_printed(tree):
    (code,) = [block for language, block in BLOCKS if language == "python"]
    (tree / "example.py").write_text(code)
    assert " True " in executed(tree, "python example.py")
