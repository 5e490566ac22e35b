"""Accidents: a full disk, a foreign file in the place of results, damaged compiled code, two
workflows at once.
"""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import starts
from snakemake.iocontainers import OutputFiles

from bezierplan.running.jobs import log

ROOT = Path(__file__).parents[1]


@pytest.fixture
def job(tmp_path, monkeypatch):
    """A job of this process, which need not end with its parent, and its output."""
    monkeypatch.setattr(log, "end_with_parent", lambda: None)
    folder = tmp_path / "results"
    folder.mkdir()
    output = OutputFiles(fromdict={"one": str(folder / "one.csv")})
    return SimpleNamespace(log=[str(tmp_path / "log")], input=[], output=output)


FILLS = """
import sys
from types import SimpleNamespace
from pathlib import Path
from snakemake.iocontainers import OutputFiles
from bezierplan.running.jobs import log
log.end_with_parent = lambda: None
folder = sys.argv[1]
output = OutputFiles(fromdict={"one": folder + "/one.csv"})
with log.run_job(SimpleNamespace(log=[folder + "/log"], input=[], output=output)) as parts:
    Path(parts.one).write_bytes(b"x" * 10_000_000)
"""


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
def test_write_without_space_ends_a_job_with_one_line_and_leaves_no_part(job, number, capsys):
    folder = Path(job.output.one).parent

    def write_a_part():
        with log.run_job(job) as parts:
            Path(parts.one).write_text("a part")
            try:
                raise OSError(number, os.strerror(number))
            finally:  # as a library does that closes its file
                raise AttributeError("pos")

    with pytest.raises(SystemExit, match=r"^1$"):
        write_a_part()
    line = capsys.readouterr().err
    assert line.startswith(f"OSError: [Errno {number}] {os.strerror(number)} (full account: ")
    assert line.count("\n") == 1
    assert os.listdir(folder) == []


def test_full_disk_ends_a_job_with_one_line_and_leaves_no_part(tmp_path):
    """On a real disk of 200 kB, which the log shares; it goes with the namespace that it is mounted
    in.
    """
    namespace = ["unshare", "--mount", *([] if os.geteuid() == 0 else ["--map-root-user"])]
    try:
        subprocess.run(
            [*namespace, "mount", "-t", "tmpfs", "tmpfs", tmp_path], capture_output=True, check=True
        )
    except (FileNotFoundError, subprocess.CalledProcessError):
        # Nothing else gives a test a small disk. The test above needs none: there the system's call
        # fails.
        pytest.skip(
            "no disk can be mounted here: macOS has no namespaces, and some containers forbid them"
        )
    fill = 'mount -t tmpfs -o size=200k tmpfs "$1" && { "$2" -c "$3" "$1"; echo $?; ls "$1"; }'
    done = subprocess.run(
        [*namespace, "sh", "-c", fill, "sh", tmp_path, sys.executable, FILLS],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr.startswith(f"OSError: [Errno {errno.ENOSPC}] No space left on device")
    assert done.stderr.count("\n") == 1
    assert done.stdout.split() == ["1", "log"]


SWAPS = """
import os
os.access = lambda *_: False  # the tree cannot be written, so compiled code goes below the home
import numpy as np
from bezierplan.planners.parts import genetic
one, other = np.arange(8), np.arange(8, 16)
genetic.swap_tails(one, other, 5, 2)
print(one, other)
"""


def test_damaged_compiled_code_is_compiled_again(tmp_path):
    home = {"HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / ".cache")}
    first = starts.python(SWAPS, tmp_path, **home)
    for which, content in (("*.nbi", b"garbage" * 100), ("*.nbc", b"")):
        files = list((tmp_path / ".cache").rglob(which))
        assert files
        for file in files:
            file.write_bytes(content)
        assert starts.python(SWAPS, tmp_path, **home) == first
        assert all(file.read_bytes() != content for file in files), which


# A start with the settings of the default profile.
OF_DEFAULT = ("--workflow-profile", ROOT / "profiles/default", "--cores", "1")
SNAKEFILE = """
rule one:
    output: "results/a.txt"
    shell: "while [ ! -e go ]; do sleep 0.1; done; date > {output}"
"""


def test_second_workflow_in_a_folder_ends_at_once_and_the_first_goes_on(tmp_path):
    """With the settings of the default profile, none of which weakens Snakemake's lock."""
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    command = [sys.executable, "-m", "snakemake", *OF_DEFAULT]
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as first:
        deadline = time.monotonic() + 120
        while not list((tmp_path / ".snakemake").glob("locks/*")):
            assert time.monotonic() < deadline
            time.sleep(0.1)
        second = starts.snakemake(tmp_path, *OF_DEFAULT)
        (tmp_path / "go").touch()
        assert first.wait(120) == 0
    assert second.returncode == 1
    assert "LockException" in second.stderr
    assert (tmp_path / "results/a.txt").stat().st_size > 0


FAILS = """
rule one:
    output: "results/a.txt"
    log: "one.log"
    script: "fails.py"
"""


def test_reason_of_a_failed_job_is_the_last_line_and_a_lock_is_explained_in_one(tmp_path):
    (tmp_path / "Snakefile").write_text(FAILS)
    reason = "run a: planner b: [red]wrong"
    (tmp_path / "fails.py").write_text(
        f"open(snakemake.log[0], 'w').write('Traceback\\\\n2026 CRITICAL {reason}')\nraise "
        "SystemExit(1)\n"
    )
    failed = starts.snakemake(tmp_path, *OF_DEFAULT)
    assert failed.returncode == 1
    assert failed.stderr.strip().splitlines()[-1] == reason
    assert "RuleException" not in failed.stderr
    assert "Traceback" not in failed.stderr
    locks = tmp_path / ".snakemake" / "locks"
    locks.mkdir(exist_ok=True)
    (locks / "0.output.lock").write_text("results/a.txt\n")
    locked = starts.snakemake(tmp_path, *OF_DEFAULT)
    (line,) = [line for line in locked.stderr.splitlines() if "LockException" in line]
    assert "`snakemake --unlock`" in line


def test_a_job_that_succeeds_when_tried_again_has_not_failed(tmp_path):
    (tmp_path / "Snakefile").write_text(FAILS.replace("results/", "results/full/one/"))
    (tmp_path / "fails.py").write_text(
        "from pathlib import Path\n"
        "if not Path('once').exists():\n"
        "    Path('once').touch()\n"
        "    open(snakemake.log[0], 'w').write('2026 CRITICAL first attempt')\n"
        "    raise SystemExit(1)\n"
        "open(snakemake.output[0], 'w').write('whole')\n"
    )
    done = starts.snakemake(tmp_path, *OF_DEFAULT, "--retries", "1")
    assert done.returncode == 0, done.stderr
    assert done.stderr.strip().splitlines()[-1].startswith("Time: ")
    assert "1 of 1 jobs, " in done.stderr
    assert "first attempt" not in done.stderr
