"""Scripts of jobs in forks of one process: what a script sees, and how failures and ends are
reported.
"""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest
from snakemake import benchmark
from snakemake.script import script

from bezierplan.running.jobs.forks import FIRST, LATER, Forks

# Nothing to test elsewhere: a fork of a process that has loaded libraries of macOS may crash, so
# `Forks.script` makes none there.
pytestmark = pytest.mark.skipif(
    sys.platform != "linux",
    reason="jobs are forks on Linux only; elsewhere Snakemake starts an interpreter for each",
)


@pytest.fixture
def forks():
    """One that has not started."""
    return Forks(sys.executable, script)


@pytest.fixture(scope="module")
def started():
    """One for all tests that leave it as it was."""
    forks = Forks(sys.executable, script)
    forks.start()
    return forks


def gone(process, seconds=20):
    """Whether a process ends in time."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        try:
            state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return True
        if state == "Z":
            return True
        time.sleep(0.05)
    return False


def test_what_is_forked_starts_before_the_first_job_again_if_it_was_killed_and_ends_with_us(
    forks, tmp_path
):
    def parent():
        file = tmp_path / "told"
        source = "import os; open(snakemake, 'w').write(str(os.getppid()))"
        assert forks.run_in_fork("parent.py", source, str(file))
        return int(file.read_text())

    forks.start()
    started = forks._process.pid
    forks.start()
    assert parent() == started == forks._process.pid
    os.kill(started, signal.SIGKILL)
    assert gone(started)
    again = parent()
    assert again != started
    del forks._control
    assert gone(again)


def test_script_prints_into_nothing_where_the_stream_is_closed(tmp_path):
    """The next file that is opened has the number of the closed stream."""
    (tmp_path / "start.py").write_text(
        "import sys\n"
        "from bezierplan.running.jobs.forks import Forks\n"
        "victim = open('victim', 'w')\n"
        "assert sys.stdout is None and victim.fileno() == 1\n"
        "assert Forks(sys.executable, open).run_in_fork('prints.py', 'print(1, flush=1)', None)\n"
    )
    subprocess.run(["sh", "-c", f"exec '{sys.executable}' start.py >&-"], cwd=tmp_path, check=True)
    assert not (tmp_path / "victim").read_text()


def test_script_gets_its_object_and_the_folder_of_its_workflow_and_no_input(
    started, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    told = tmp_path / "told"
    source = (
        "import os, sys\nopen(snakemake.output, 'w').write(repr((__name__, __file__, "
        "snakemake.params, sys.stdin.read(), os.getcwd())))"
    )
    assert started.run_in_fork("one.py", source, SimpleNamespace(output=str(told), params={"a": 1}))
    assert told.read_text() == repr(("__main__", "one.py", {"a": 1}, "", str(tmp_path)))


def test_what_the_first_jobs_need_is_imported_before_them_and_the_rest_while_no_job_waits(
    forks, tmp_path
):
    told = tmp_path / "told"
    source = (
        "import os, sys\nfile, names = snakemake\nprint(os.getppid(), set(names) <= "
        "set(sys.modules), file=open(file, 'a'))"
    )
    assert forks.run_in_fork("modules.py", source, (str(told), FIRST))
    assert "True" in told.read_text()
    told.unlink()
    until = time.monotonic() + 120
    while time.monotonic() < until and not (told.exists() and "True" in told.read_text()):
        assert forks.run_in_fork("modules.py", source, (str(told), LATER))
        time.sleep(0.2)
    parents, imported = zip(*map(str.split, told.read_text().splitlines()), strict=True)
    assert imported[-1] == "True"
    assert len(set(parents)) == 1
    assert len(os.listdir(f"/proc/{forks._process.pid}/task")) == 1, (
        "a process that is forked must have one thread"
    )


def test_script_that_does_not_come_to_its_end_fails_and_the_next_one_runs(forks, capfd):
    for source, told in (
        ("import sys; sys.exit('song.yaml: wrong')", "song.yaml: wrong\n"),
        ("raise ValueError('wrong')", "ValueError: wrong\n"),
        ("def broken(", "SyntaxError"),
    ):
        assert not forks.run_in_fork("bad.py", source, None), source
        assert told in capfd.readouterr().err
        assert forks.run_in_fork("good.py", "pass", None)


UNDER_WAY = (
    "from bezierplan.running.jobs import watchdog; watchdog.begin({}, 'run a: planner b'); {}"
)
ENDS = {
    "import os; os._exit(7)": "its process ended itself with exit status 7, before it was done",
    "import ctypes; ctypes.string_at(0)": "its process was ended by signal SIGSEGV",
    # The sum holds Python's lock for minutes.
    "sum(range(10**11))": "not done within the time limit of 1 s; it is ended",
}


@pytest.mark.parametrize("work", ENDS)
def test_an_end_that_a_script_cannot_report_is_told_with_what_was_under_way(
    work, started, tmp_path, capfd
):
    job = SimpleNamespace(log=[str(tmp_path / "log")], output=["out"])
    pause = "watchdog.begin(None, ''); import time; time.sleep(1.2)"
    assert started.run_in_fork("pause.py", UNDER_WAY.format(1, pause), job)
    assert not started.run_in_fork("ends.py", UNDER_WAY.format(1, work), job)
    line = f"run a: planner b: {ENDS[work]} (log: {tmp_path / 'log'})\n"
    assert capfd.readouterr().err == line
    assert (tmp_path / "log").read_text() == f"CRITICAL {line}"


def test_many_scripts_at_once(started, tmp_path):
    source = (
        "import time; time.sleep(0.01 * snakemake[0]); open(snakemake[1], "
        "'w').write('done'); assert snakemake[0] % 3"
    )
    files = [tmp_path / str(k) for k in range(12)]
    with ThreadPoolExecutor(12) as threads:
        ends = list(
            threads.map(
                lambda k: started.run_in_fork("many.py", source, (k, str(files[k]))), range(12)
            )
        )
    assert ends == [k % 3 != 0 for k in range(12)]
    assert all(file.read_text() == "done" for file in files)


def test_a_script_begins_once_it_is_measured(started, monkeypatch):
    """However short it is: a process that has ended cannot be measured."""
    measure = benchmark.benchmarked

    def measure_late(*arguments):
        time.sleep(0.3)
        return measure(*arguments)

    monkeypatch.setattr(benchmark, "benchmarked", measure_late)
    record = benchmark.BenchmarkRecord()
    assert started.run_in_fork("short.py", "pass", None, record)
    assert 0 < record.running_time < 20


def test_large_object_of_a_script_that_does_not_read_it(started):
    assert started.run_in_fork("large.py", "assert len(snakemake) == 10**7", bytes(10**7))


LONG = """
import os, time
open({told!r}, "w").write(str(os.getpid()))
time.sleep(600)
"""
IN_A_FORK = """
import sys
from bezierplan.running.jobs.forks import Forks
Forks(sys.executable, print).run_in_fork("long.py", {job!r}, None)
"""
# As Snakemake starts a script that has an environment of its own.
IN_AN_INTERPRETER = """
import subprocess, sys
subprocess.run([sys.executable, "-c", {job!r}])
"""
RUN_JOB = """
from types import SimpleNamespace
from snakemake.iocontainers import OutputFiles
from bezierplan.running.jobs import log
output = OutputFiles(fromdict={{"one": {told!r} + ".csv"}})
with log.run_job(SimpleNamespace(log=[{told!r} + ".log"], input=[], output=output)):
    exec({job!r})
"""


@pytest.mark.parametrize(
    ("started", "job"),
    [(IN_A_FORK, LONG), (IN_AN_INTERPRETER, RUN_JOB)],
    ids=["fork", "interpreter"],
)
def test_jobs_end_with_a_workflow_that_is_killed(tmp_path, started, job):
    told = tmp_path / "told"
    work = job.format(told=str(told), job=LONG.format(told=str(told)))
    with subprocess.Popen([sys.executable, "-c", started.format(job=work)]) as process:
        while not (told.exists() and told.read_text()):
            assert process.poll() is None
            time.sleep(0.05)
        os.kill(process.pid, signal.SIGKILL)
    assert gone(int(told.read_text()))


def test_time_of_jobs_counts_once_their_workflow_has_ended(tmp_path):
    (tmp_path / "start.py").write_text(
        "from bezierplan.running.jobs.forks import Forks\n"
        "from bezierplan.running.jobs.watchdog import measure_cpu_time\n"
        f"forks = Forks({sys.executable!r}, open)\n"
        "forks.end()\n"  # nothing to end
        "work = 'import time\\nbegin = time.process_time()\\n'\n"
        "work += 'while time.process_time() < begin + 2: pass'\n"
        "assert forks.run_in_fork('works.py', work, None)\n"
        "before = measure_cpu_time()\n"
        "assert before < 2\n"
        "forks.end()\n"
        "assert measure_cpu_time() > before + 2\n"
        "assert forks.run_in_fork('again.py', 'pass', None)\n"
    )
    subprocess.run([sys.executable, "start.py"], cwd=tmp_path, check=True)
