"""`make benchmark` names what has become slower, and fails where it is much; `make compare`."""

import importlib
import math
import subprocess
import sys
from functools import partial
from pathlib import Path

import pandas as pd
import pytest

from bezierplan.geometry import shortest_paths
from bezierplan.planners import list_planners

SCRIPTS = Path(__file__).parent / "benchmark"
NAMES = {file.stem for file in SCRIPTS.glob("*.py")}
STORED = {"start: list": 40.0, "planner: prm": 0.05}


@pytest.fixture
def script(monkeypatch):
    """Imports a script of the benchmark, whose names mean nothing elsewhere."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    yield importlib.import_module
    for name in NAMES & sys.modules.keys():
        del sys.modules[name]


@pytest.fixture
def benchmark(script, monkeypatch, tmp_path, capsys):
    """Runs the benchmark of `STORED`, given the costs of each as they are measured in turn: the
    status and the last lines.
    """
    run = script("run")
    monkeypatch.setattr(run, "TREE", tmp_path)
    monkeypatch.setattr(run, "STORED", tmp_path / "stored.csv")
    monkeypatch.setattr(run, "MADE", tmp_path / "made.csv")
    table = pd.Series(STORED, name="ratio").rename_axis("cost").to_csv()
    run.STORED.write_text(f"# {run.find_processor()}\n{table}")

    def measure(costs, *words):
        measures = {name: partial(next, iter(times)) for name, times in costs.items()}
        monkeypatch.setattr(run.parts, "short", lambda: measures.items())
        status = run.main([*words])
        return status, capsys.readouterr().out.splitlines()[len(costs) :]

    return measure


def times(**factors):
    """Costs as multiples of the stored ones, by a word of their names."""
    return {
        name: [cost * factor for factor in factors.get(name.split()[-1], [1.0])]
        for name, cost in STORED.items()
    }


@pytest.mark.parametrize(
    ("costs", "status", "named"),
    [
        (times(), 0, "nothing is slower"),
        (times(prm=[1.24], list=[0.5]), 0, "nothing is slower"),
        (times(prm=[1.5, 1.6, 1.7]), 0, "planner: prm: 1.50 times as long"),
        (times(prm=[1.9, 1.6, 1.1], list=[3.0, 1.2]), 0, "nothing is slower"),
        (times(list=[3.0, 3.2, 3.1]), 1, "start: list: 3.00 times as long"),
        (times() | {"planner: new": [9.0]}, 0, "nothing is slower"),
    ],
)
def test_what_stays_slow_is_named_and_fails_where_it_is_much(benchmark, costs, status, named):
    found, lines = benchmark(costs)
    assert found == status
    assert lines[0].startswith(named)
    assert lines[1:] == ["made.csv"]


def test_what_is_slow_on_another_processor_is_named_and_no_failure(benchmark, tmp_path):
    file = tmp_path / "stored.csv"
    file.write_text(f"# another{file.read_text().removeprefix('#')}")
    status, lines = benchmark(times(prm=[3.0] * 3))
    assert status == 0
    assert lines[0] == "planner: prm: 3.00 times as long as stored"
    assert lines[1] == "stored on another processor, so this is no failure"


def test_a_stored_copy_is_compared_with_next_time(benchmark, tmp_path):
    assert benchmark(times(list=[3.0]), "store") == (
        0,
        ["nothing is slower than stored", "stored.csv"],
    )
    assert benchmark(times(list=[3.0]))[0] == 0
    assert (tmp_path / "stored.csv").read_text() == (tmp_path / "made.csv").read_text()


def test_a_cost_is_a_multiple_of_the_fixed_work(script):
    frame = script("frame")
    assert 2 < frame.ratio(lambda: [frame.fixed() for _ in range(4)]) < 8


# macOS has no call that makes a process the parent of those that lose their own, so there the
# benchmark misses them (`counted.py`).
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere detached processes do not count")
def test_work_of_processes_that_nobody_waits_for_counts():
    """A process of a process, both detached, that works for three CPU seconds."""
    work = (
        "import os, time\n"
        "for _ in range(2):\n"
        "    if os.fork(): os._exit(0)\n"
        "    os.setsid()\n"
        "while time.process_time() < 3: pass\n"
    )
    # In a process of its own: children of other tests that end meanwhile would count here.
    measure = f"import frame; print(frame.cpu_seconds(lambda: frame.start('-c', {work!r})))"
    done = subprocess.run(
        [sys.executable, "-c", measure], cwd=SCRIPTS, capture_output=True, text=True, check=True
    )
    assert float(done.stdout) == pytest.approx(3, rel=0.15)


def test_a_part_that_takes_three_times_as_long_is_named_and_no_other(script):
    run = script("run")
    stored = {name: 1.0 for name, _ in run.parts.short()}
    for part in (
        "start",
        "compiling",
        "planner",
        "bound",
        "drives",
        "judgement",
        "table",
        "figure",
    ):
        planted = next(name for name in stored if name.startswith(f"{part}: "))
        lines, failed = run.judged(stored | {planted: 3.0}, stored)
        assert failed
        assert lines == [f"{planted}: 3.00 times as long as stored"]


def test_each_planner_is_run_where_a_study_uses_it(script):
    places = script("frame").first_places()
    assert sorted({own.planner(method) for own, _, method in places}) == list_planners()


def test_what_grows(script):
    parts = script("parts")
    for room in (parts._room(3, parts._discs), parts._room(3, parts._squares), parts._blocks(20)):
        side = round(room.bounds[1])
        bound = shortest_paths.shortest_path(parts._across(room, side))
        assert 1 < bound.length / math.hypot(side - 0.1, side - 0.1) < 1.2
    parts._study(2, 10, "-n")


@pytest.mark.parametrize("number", range(5))
def test_contests_of_make_compare_without_the_other_library(script, number):
    compare = script("compare_planners")
    contest = compare.CONTESTS[number]
    attempts = compare.compete(compare.arena(contest), {}, seeds=1)
    assert set(attempts["method"]) == {*contest.methods, "rounded"}
    assert len(attempts) == 2 * len(compare.SHARES) + 1
    (near,) = attempts.loc[attempts["method"] == "rounded", "excess"]
    assert 0 <= near < 0.05


def test_time_until_a_path_is_near_the_shortest_one(script):
    rows = [("p", "m", 0, 3.0, 0.005), ("p", "m", 0, 1.0, 0.08), ("p", "m", 1, 2.0, math.inf)]
    columns = ["problem", "method", "seed", "cpu_s", "excess"]
    table = script("compare_planners").time_table(pd.DataFrame(rows, columns=columns))
    assert table["median_s"].tolist() == [1.0, 3.0, 3.0, 3.0]
    assert table["reached"].tolist() == [0.5] * 4
