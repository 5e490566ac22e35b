"""Forecasts: how long jobs take on some cores, from what jobs like them took."""

import base64
import functools
import json
import operator
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from studies import studies

from bezierplan.commands import forecast
from bezierplan.commands.forecast import Step
from bezierplan.running import records
from bezierplan.running.records import Job, Record
from bezierplan.schema.checked import Fault

ROOT = Path(__file__).parents[1]


def steps(**needs):
    """Steps by name, each with the names of those that it waits for."""
    return [
        Step(name, frozenset(f"{each}.out" for each in needed), (f"{name}.out",))
        for name, needed in needs.items()
    ]


def test_duration_is_that_of_the_cores_and_of_the_longest_chain():
    independent, seconds = steps(a=[], b=[], c=[], d=[]), dict.fromkeys("abcd", 10.0)
    assert [forecast.duration(independent, seconds, cores) for cores in (1, 2, 3, 4, 99)] == [
        40,
        20,
        20,
        10,
        10,
    ]
    chain = steps(c=["b"], b=["a"], a=[], d=[])
    assert [forecast.duration(chain, seconds, cores) for cores in (1, 2, 99)] == [40, 30, 30]
    assert forecast.duration(steps(a=["elsewhere"]), {"a": 5.0}, 1) == 5
    assert forecast.duration([], {}, 1) == 0


def test_job_of_a_log_file():
    assert records.job_of("results/full/song2016/logs/runs/routes/smooth/3.log") == Job(
        "full", "song2016/runs/routes/smooth", 3
    )
    assert records.job_of("results/smoke/song2016/logs/figures/figure4.log") == Job(
        "smoke", "song2016/figures/figure4", None
    )
    assert records.job_of("results/full/summary.log") == Job("full", "summary", None)
    assert records.job_of("elsewhere.log") is None


def test_more_runs_take_longer_but_a_job_starts_once():
    record = Record(10, records.START + 20.0, 2.0)
    assert record.scaled(30) == Record(30, records.START + 60.0, 6.0)
    assert record.scaled(10) is record
    assert Record(10, 0.1, 1.0).scaled(20).seconds == records.START


def noted(folder, log, output, seconds, times=None):
    """Note a job in a working folder as Snakemake does."""
    file = folder / output
    file.parent.mkdir(parents=True, exist_ok=True)
    if times:
        cpu, wall = zip(*times)
        parquet.write_table(
            pa.table({"id": list(map(str, range(len(cpu)))), "cpu_s": cpu, "wall_s": wall}), file
        )
    else:
        file.write_bytes(b"x" * 1_000_000)
    (folder / records.METADATA).mkdir(parents=True, exist_ok=True)
    name = base64.b64encode(output.encode()).decode()
    (folder / records.METADATA / name).write_text(
        json.dumps({"log": [log], "starttime": 100.0, "endtime": 100.0 + seconds})
    )


def test_records_of_a_working_folder(tmp_path):
    """Runs count by their CPU time, a repeated one once; other jobs by the clock, corrected by the
    share of a core that runs had.
    """
    for chunk, cpu in enumerate((2.0, 4.0)):
        place = f"results/full/s/runs/e/m/{chunk}"
        noted(
            tmp_path,
            f"results/full/s/logs/runs/e/m/{chunk}.log",
            f"{place}.times.parquet",
            99.0,
            [(cpu, 2 * cpu), (cpu, 2 * cpu)],
        )
    noted(tmp_path, "results/full/s/logs/tables/t.log", "results/full/s/tables/t.csv", 10.0)
    (tmp_path / records.METADATA / "broken").write_text("{")
    (tmp_path / records.METADATA / base64.b64encode(b"other").decode()).write_text(
        json.dumps({"log": []})
    )
    found = records.measured(tmp_path, lambda job: 1 if job.chunk is None else 7)
    assert found.keys() == {("full", "s/runs/e/m"), ("full", "s/tables/t")}
    assert found["full", "s/runs/e/m"][:2] == (7, records.START + 3.0)
    assert found["full", "s/tables/t"] == Record(1, 5.0, 1.0)
    assert records.measured(tmp_path / "nowhere", lambda job: 1) == {}


def test_kept_records_are_read_back(tmp_path):
    records.keep({"b": Record(3, 1.5, 0.25), "a": Record(1, 12.0, 0.0)}, tmp_path / "times.csv")
    assert records.kept(tmp_path / "times.csv") == {
        "a": Record(1, 12.0, 0.0),
        "b": Record(3, 1.5, 0.25),
    }


def test_most_runs_of_tables_are_recorded():
    """A fresh clone forecasts from the kept file alone; what came later is little."""
    kept = records.kept(ROOT / records.KEPT)
    wanted = {
        f"{key}/runs/{table.experiment}/{method}"
        for key, study in studies().items()
        for table in study.compared().values()
        for method in study.methods_of(table.experiment)
    }
    assert len(wanted & kept.keys()) > 0.8 * len(wanted)


def test_units_are_runs():
    own = studies()["song2016"].experiments["routes"]
    conditions, size = len(own.problems), own.chunk["full"]
    assert (
        forecast.units_of(studies(), Job("full", "song2016/runs/routes/smooth", 1))
        == conditions * size
    )
    assert (
        forecast.units_of(studies(), Job("full", "song2016/runs/routes/straight_line", 1))
        == conditions
    )
    for name, chunk in {
        "song2016/tables/table1": None,
        "gone/runs/a/b": 0,
        "song2016/runs/gone/b": 0,
        "song2016/runs/routes/gone": 0,
    }.items():
        assert forecast.units_of(studies(), Job("full", name, chunk)) == 1


def test_targets_by_scale():
    assert forecast.files(studies(), "all", "extended") == ["extended"]
    assert forecast.files(studies(), "alternatives", "full") == ["alternatives"]
    assert (
        forecast.files(studies(), "song2016_figure4", "extended")[0]
        == "results/extended/song2016/figures/figure4.svg"
    )
    assert "results/smoke/song2016/claims.csv" in forecast.files(studies(), "song2016", "smoke")
    assert forecast.files(studies(), "results/full/summary.md", "full") == [
        "results/full/summary.md"
    ]
    with pytest.raises(Fault, match=r"song206: no target; did you mean song2016\?"):
        forecast.files(studies(), "song206", "full")


def test_what_is_printed():
    given = steps(a=[], b=["a"], c=[])
    found = {"a": Record(1, 60.0, 10.0), "b": Record(1, 120.0, 20.0), "c": None}
    assert forecast.lines("all", given, found, 2) == [
        "all: 3 jobs, 4 min of CPU time",
        "on 2 cores: about 3 min",
        "disk: about 30 MB",
        "not recorded: 1 jobs, counted as 90 s each",
        "the longest jobs:",
        "      2 min  b",
        "      2 min  c",
        "       60 s  a",
    ]
    assert forecast.lines("all", [], {}, 2) == ["all: nothing is left to do"]


def test_forecast_of_a_figure_in_a_clone(tmp_path, monkeypatch, capsys):
    """What a dry run of Snakemake lists, in a folder without results."""
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "config.yaml").write_text("studies: [song2016]\n")
    monkeypatch.chdir(tmp_path)
    found = forecast.planned(["results/full/song2016/figures/figure4.svg"], anew=False)
    names = sorted(records.job_of(step.log).name for step in found)
    runs = [
        f"song2016/runs/routes/{method}"
        for method in ("smooth", "smooth_cubic", "smooth_single")
        for _ in range(2)
    ]
    assert names == [
        "song2016/bounds/routes",
        "song2016/figures/figure4",
        "song2016/problems/routes",
        *runs,
    ]
    estimated = forecast.estimates(studies(), found, tmp_path)
    assert all(estimated.values())
    seconds = {log: record.seconds for log, record in estimated.items()}
    # One after another, as `duration` adds them: sum() has less error from Python 3.12 on.
    alone = functools.reduce(operator.add, seconds.values())
    assert (
        max(seconds.values())
        < forecast.duration(found, seconds, 4)
        < forecast.duration(found, seconds, 1)
        == alone
    )
    with pytest.raises(Fault, match=r"MissingRuleException|No rule to produce"):
        forecast.planned(["results/full/nothing.csv"], anew=False)
