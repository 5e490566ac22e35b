"""The Makefile's set-up, as far as it can be tried without a network."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
LOCKS = ("environment-build.txt", "environment.txt", "environment-dev.txt")
TARGETS = {
    "help",
    "reproduce",
    "smoke",
    "digests",
    "beyond",
    "extended",
    "test",
    "docs",
    "image",
    "wheel",
    "lint",
    "benchmark",
    "compare",
    "archive",
    "outcome",
    "cluster",
    "lock",
    "newest",
    "clean",
    "distclean",
    "mutants",
}


def make(folder: Path, *arguments: str) -> subprocess.CompletedProcess:
    command = ["make", "--no-print-directory", *arguments]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=60, check=False
    )


def executable(file: Path, text: str) -> Path:
    file.write_text(text, encoding="utf-8")
    file.chmod(0o755)
    return file


@pytest.fixture
def tree(tmp_path):
    """A copy of what set-up reads, without an environment."""
    folder = tmp_path / "tree"
    folder.mkdir()
    for name in ("Makefile", *LOCKS):
        shutil.copy2(ROOT / name, folder)
    return folder


@pytest.fixture
def finished(tree):
    """The same with a finished set-up, in which nothing is installed."""
    (tree / ".venv" / "bin").mkdir(parents=True)
    (tree / ".venv" / "bin" / "python").symlink_to(sys.executable)
    (tree / ".venv" / "ready").touch()
    (tree / ".venv" / "ready-dev").touch()
    return tree


def missing_module(name: str) -> str:
    """An interpreter like this one in which a module cannot be imported, as on a Debian without
    python3-venv.
    """
    return f"""#!{sys.executable}
import sys
sys.modules["{name}"] = None
exec(sys.argv[sys.argv.index("-c") + 1])
"""


def other_version(major: int, minor: int) -> str:
    return f"""#!{sys.executable}
import sys
sys.version_info = ({major}, {minor}, 0, "final", 0)
exec(sys.argv[sys.argv.index("-c") + 1])
"""


def test_make_alone_lists_every_target(tree):
    answer = make(tree)
    assert answer.returncode == 0
    assert {line.split()[1] for line in answer.stdout.splitlines()} == TARGETS
    assert all(len(line.split()) > 3 for line in answer.stdout.splitlines())


@pytest.mark.parametrize("target", ["reproduce", "smoke", "test", "lint", "benchmark"])
def test_every_target_starts_with_the_set_up(tree, target):
    """The steps of set-up come first in what make would do."""
    assert (
        "Setting up .venv"
        in make(tree, "-n", target, f"PYTHON={sys.executable}").stdout.splitlines()[0]
    )


@pytest.mark.parametrize(
    "interpreter",
    [
        None,
        "#!/bin/sh\nexit 127\n",
        other_version(3, 10),
        other_version(3, 14),
        missing_module("venv"),
        missing_module("ensurepip"),
    ],
    ids=["none", "broken", "3.10", "3.14", "without venv", "without ensurepip"],
)
def test_no_fitting_python_ends_with_one_line_that_says_what_to_do(tree, tmp_path, interpreter):
    python = tmp_path / "python"
    if interpreter:
        executable(python, interpreter)
    answer = make(tree, "smoke", f"PYTHON={python}")
    assert answer.returncode != 0
    assert answer.stdout == ""
    assert len(answer.stderr.splitlines()) == 1
    assert (
        "bezierplan needs Python 3.11 to 3.13 with venv. On Debian or Ubuntu: sudo apt install "
        "python3 python3-venv" in answer.stderr
    )
    assert not (tree / ".venv").exists()


@pytest.mark.parametrize("name", ["$(touch bad)", "`touch bad`", 'a"b'])
def test_a_folder_whose_name_is_a_command_is_refused(tree, name):
    tree = tree.rename(tree.parent / name)
    answer = make(tree, "smoke", f"PYTHON={sys.executable}")
    assert answer.returncode != 0
    assert len(answer.stderr.splitlines()) == 1
    assert "bezierplan cannot be set up in" in answer.stderr
    assert not (tree / "bad").exists()


# A Python that installs nothing, but writes down with what it was asked to.
INSTALLER = """#!/bin/sh
case "$*" in
    "-m venv .venv") mkdir -p .venv/bin && cp "$0" .venv/bin/python ;;
    *" install "*) echo "$2 $*" >> installed.txt; [ "$2" != uv ] || exit {code} ;;
esac
"""


@pytest.mark.parametrize(
    ("code", "asked"),
    [(0, ["pip", "uv", "uv"]), (2, ["pip", "uv", "pip", "uv", "pip"])],
    ids=["uv", "uv fails"],
)
def test_uv_installs_what_is_locked_and_pip_where_uv_cannot(tree, tmp_path, code, asked):
    python = executable(tmp_path / "python", INSTALLER.format(code=code))
    answer = make(tree, ".venv/ready-dev", f"PYTHON={python}")
    assert answer.returncode == 0, answer.stderr
    lines = (tree / "installed.txt").read_text().splitlines()
    assert [line.split()[0] for line in lines] == asked
    assert list(dict.fromkeys(line.split()[-1] for line in lines)) == list(LOCKS)
    assert all("--require-hashes --only-binary :all:" in line for line in lines)
    assert (tree / ".venv" / "ready").exists()


def test_a_finished_set_up_is_not_done_again(finished):
    assert make(finished, "-q", ".venv/ready-dev").returncode == 0


@pytest.mark.parametrize("target", ["reproduce", "smoke", "image", "cluster"])
def test_the_workflow_needs_no_tools_of_tests(finished, target):
    (finished / ".venv" / "ready-dev").unlink()
    assert "environment-dev.txt" not in make(finished, "-n", target).stdout
    assert "environment-dev.txt" in make(finished, "-n", "test").stdout


@pytest.mark.parametrize("name", LOCKS)
def test_another_environment_is_set_up_anew(finished, name):
    later = (finished / ".venv" / "ready").stat().st_mtime + 10
    os.utime(finished / name, (later, later))
    assert make(finished, "-q", ".venv/ready-dev", f"PYTHON={sys.executable}").returncode == 1


def test_an_environment_whose_python_has_gone_is_set_up_anew(finished):
    python = finished / ".venv" / "bin" / "python"
    python.unlink()
    python.symlink_to("/nowhere/python3")
    assert make(finished, "-q", ".venv/ready", f"PYTHON={sys.executable}").returncode == 1


def test_clean_keeps_the_environment_and_what_is_tracked(finished):
    for file in (
        "results/README.md",
        "results/smoke/a",
        "results/full/a",
        "results/extended/a",
        "results/comparison/a",
        "results/benchmark.csv",
        ".snakemake/a",
        ".cache/a",
    ):
        (finished / file).parent.mkdir(parents=True, exist_ok=True)
        (finished / file).touch()
    assert make(finished, "clean").returncode == 0
    assert [file.name for file in (finished / "results").iterdir()] == ["README.md"]
    assert not (finished / ".snakemake").exists()
    assert not (finished / ".cache").exists()
    assert (finished / ".venv" / "ready").exists()
    assert make(finished, "distclean").returncode == 0
    assert not (finished / ".venv").exists()
