"""What jobs and Snakemake note of their time, and the table made from it."""

import base64
import json
import logging
import subprocess
import sys
import time
from argparse import ArgumentParser
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from bezierplan.commands import effort as command
from bezierplan.running import effort
from bezierplan.running.effort import Session
from bezierplan.running.forks import Forks

SESSION = Session(started=1000.0, ended=1100.0, cores=2, snakemake=20.0, forked=5.0, forks=15.5)


@pytest.fixture
def spent(monkeypatch):
    monkeypatch.setattr(effort, "spent", type(effort.spent)())
    return effort.spent


def work(seconds):
    """Use the CPU for a time."""
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def test_a_block_within_another_counts_once(spent):
    with effort.spending("compiling"):
        work(0.02)
        with effort.spending("importing"):
            work(0.02)
    with effort.spending("importing"):
        time.sleep(0.1)
    assert 0.04 <= spent["compiling"] < 0.5
    assert spent["importing"] < 0.05


def test_imports_are_timed_with_all_that_they_import(tmp_path):
    (tmp_path / "outer.py").write_text("import inner\n")
    (tmp_path / "inner.py").write_text("sum(range(10_000_000))\n")
    code = (
        "from bezierplan.running import effort\neffort.spent['importing'] = "
        "60.0\neffort.begin()\nimport outer\nprint(effort.line())"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    noted = json.loads(done.stdout.removeprefix("effort "))
    assert 0.03 < noted["importing"] < noted["cpu"]


def test_a_log_holds_what_its_job_noted(tmp_path, caplog, spent):
    with caplog.at_level(logging.INFO), effort.spending("compiling"):
        logging.info(effort.line())
    file = tmp_path / "job.log"
    file.write_text(
        "2026-01-01 00:00:00,000 INFO all 2 runs done\n2026-01-01 00:00:00,000 INFO "
        f"{caplog.messages[-1]}\n"
    )
    assert effort.of_job(file)["cpu"] > 0
    file.write_text("2026-01-01 00:00:00,000 INFO an effort\n")
    assert effort.of_job(file) is None
    assert effort.of_job(tmp_path / "missing.log") is None


def job(folder: Path, rule: str, name: str, started: float, outputs: list[str], **noted: float):
    """What Snakemake and a job leave behind."""
    log = f"results/smoke/song2016/logs/{name}.log"
    (folder / log).parent.mkdir(parents=True, exist_ok=True)
    (folder / log).write_text(f"2026-01-01 00:00:00,000 INFO effort {json.dumps(noted)}\n")
    for output in outputs:
        metadata = folder / ".snakemake" / "metadata" / base64.b64encode(output.encode()).decode()
        metadata.parent.mkdir(parents=True, exist_ok=True)
        metadata.write_text(
            json.dumps({"rule": rule, "log": [log], "starttime": started, "endtime": started + 1})
        )


def test_table_of_a_start(tmp_path):
    chunk = "results/smoke/song2016/runs/routes/smooth/0"
    noted = {
        "cpu": 10.0,
        "importing": 1.0,
        "loading kernels": 0.5,
        "compiling": 2.0,
        "waiting": 7.0,
    }
    job(
        tmp_path,
        "runs",
        "runs/routes/smooth/0",
        1001.0,
        [f"{chunk}.parquet", f"{chunk}.times.parquet"],
        **noted,
    )
    (tmp_path / chunk).parent.mkdir(parents=True)
    parquet.write_table(
        pa.table({"id": ["a", "b"], "cpu_s": [2.0, 3.0], "wall_s": [2.5, 3.5]}),
        tmp_path / f"{chunk}.times.parquet",
    )
    figures = [
        f"results/smoke/song2016/figures/figure4.{ending}" for ending in ("svg", "png", "csv")
    ]
    job(tmp_path, "figure", "figures/figure4", 1050.0, figures, cpu=4.0, importing=1.0)
    # Of an earlier start.
    job(
        tmp_path,
        "figure",
        "figures/figure5",
        900.0,
        ["results/smoke/song2016/figures/figure5.svg"],
        cpu=50.0,
    )
    found, jobs, waited = command.spent(SESSION, tmp_path)
    expected = {
        "planning": 5.0,
        "importing": 2.0,
        "loading kernels": 0.5,
        "compiling": 2.0,
        "drawing figures": 3.0,
    }
    expected |= {
        "checking paths, warm-up, files of runs": 1.5,
        "Snakemake itself": 20.0,
        "importing once for all jobs, forking": 5.0,
    }
    expected |= {"starting and ending processes of jobs": 1.5}
    assert (found, jobs, waited) == (expected, 2, 7.0)
    table = command.lines(SESSION, found, jobs, waited)
    assert (
        table[0]
        == "2 jobs in 100 s on 2 cores; jobs waited 7 s for kernels that another job compiled"
    )
    assert "| planning | 5.0 | 2.5% |" in table
    assert table[-1] == "| cores idle, or busy with other programs | 159.5 | 79.8% |"


def test_every_rule_with_a_script_has_its_row():
    rules = Path(__file__).parents[1] / "workflow" / "rules"
    named = [part for file in rules.glob("*.smk") for part in file.read_text().split("\nrule ")[1:]]
    assert {part.partition(":")[0] for part in named if "script:" in part} == set(command.WORK)


def test_without_a_start(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FileNotFoundError, match="start `snakemake` first"):
        command.main(ArgumentParser(), [])


def test_a_note_of_snakemake_counts_the_process_that_is_forked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".snakemake").mkdir()
    with subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import time; sum(range(10_000_000)); print(flush=True); time.sleep(60)",
        ],
        stdout=subprocess.PIPE,
    ) as fork:
        fork.stdout.readline()
        effort.keep(3, fork.pid)
        fork.kill()
    noted = effort.last(tmp_path)
    assert (noted.cores, noted.forked > 0.03, noted.snakemake > 0, noted.started < noted.ended) == (
        3,
        True,
        True,
        True,
    )


# Elsewhere there is no fork to count: libraries may not survive one there, so Snakemake starts an
# interpreter for each job (test_forks.py).
@pytest.mark.skipif(
    sys.platform != "linux",
    reason="jobs are forks on Linux only; elsewhere there are none to count",
)
def test_a_note_of_snakemake_counts_all_forks_to_their_end(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".snakemake").mkdir()
    forks = Forks(sys.executable, lambda: None)
    source = (
        "import sys, time; from bezierplan.running import effort; sum(range(10_000_000)); "
        "snakemake.write_text(effort.line())"
    )
    noted = [tmp_path / str(number) for number in range(3)]
    assert all(forks.succeeds("work.py", source, file) for file in noted)
    effort.keep(2, forks.process)
    by_themselves = [json.loads(file.read_text().partition(" ")[2])["cpu"] for file in noted]
    assert min(by_themselves) > 0.03
    # Linux counts it in hundredths of a second.
    assert 0.8 * sum(by_themselves) < effort.last(tmp_path).forks < sum(by_themselves) + 5


def test_a_note_that_cannot_be_made_is_left_out(tmp_path, monkeypatch):
    """The workflow has ended well: neither a killed process nor a missing folder may say
    otherwise.
    """
    monkeypatch.chdir(tmp_path)
    with subprocess.Popen([sys.executable, "-c", ""]) as gone:
        pass
    effort.keep(2, gone.pid)
    (tmp_path / ".snakemake").mkdir()
    effort.keep(2, gone.pid)
    assert effort.last(tmp_path).forked == 0.0
    effort.keep(2, None)
    assert effort.last(tmp_path).forks == 0.0
