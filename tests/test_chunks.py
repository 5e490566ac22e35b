"""From a study to its jobs and results: every repeat is run, and read once; which experiments are
compared pair by pair.
"""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from studies import studies

from bezierplan.analysis import results
from bezierplan.analysis.stored_runs import compute_table_digest
from bezierplan.running import columns, problems, table_files
from bezierplan.running.inputs import Files
from bezierplan.study import captions, definition, jobs
from bezierplan.study.experiments import Experiment, Method
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem


def experiment(repeats, chunk, **others):
    return Experiment(
        problems=["across"],
        methods=["mine"],
        **{
            key: dict.fromkeys(("smoke", "full", "extended"), number)
            for key, number in (("repeats", repeats), ("chunk", chunk))
        },
        **others,
    )


@pytest.mark.parametrize(
    ("repeats", "chunk", "count"),
    [(10, 4, 3), (8, 4, 2), (1, 1, 1), (9, 3, 3), (100, 1, 100), (4, 4, 1)],
)
def test_chunks_hold_all_repeats_and_no_chunk_more(repeats, chunk, count):
    own = definition.Study.model_construct(
        experiments={"first": experiment(repeats, chunk)},
        methods={"mine": Method(planner="prm"), "other": Method(planner="straight_line")},
    )
    assert list(jobs.list_chunks(own, "first", "mine", "full")) == list(range(count))
    assert list(jobs.list_chunks(own, "first", "other", "full")) == [0], "draws no random numbers"


@pytest.mark.parametrize(
    ("fewer", "numbers"),
    [({"particles": {"40": 100, "60": 100}}, 10), ({"method": {"cpso2_singer": 100}}, 1)],
)
def test_conditions_with_fewer_runs_leave_the_later_chunks(fewer, numbers):
    """1,000 runs with each of one to ten control points and three numbers of particles."""
    own, name, method = studies()["tharwat2018"], "control_points", "cpso2_singer"
    own = own.but(experiments=own.experiments | {name: own.experiments[name].but(fewer=fewer)})
    chunks = jobs.list_chunks(own, name, method, "extended")
    assert len(chunks) == numbers
    made = [jobs.build_chunk(own, name, method, "extended", number) for number in chunks]
    assert len(made[0].conditions()) == 30
    for chunk in made[1:]:
        assert [each.values["particles"] for each in chunk.conditions()] == 10 * [20]
    assert [chunk.repeats for chunk in made] == [
        [100 * number, 100 * number + 100] for number in chunks
    ]


def test_a_caption_says_where_there_are_fewer_runs():
    own = studies()["song2016"]
    runs = "runs of each method on each problem."
    most, exact = (captions.build_caption(own, "table1", scale) for scale in ("extended", "full"))
    assert most.write().endswith(f"Shown: at most 250 {runs}")
    assert exact.write().endswith(f"Shown: 100 {runs}")


@pytest.mark.parametrize(
    ("seeds", "paired"),
    [
        ({}, False),
        ({"seeds": "own"}, False),
        ({"seeds": "shared"}, True),
        ({"seeds": "common"}, True),
    ],
)
def test_runs_are_pairs_where_methods_share_their_random_numbers(seeds, paired):
    """Runs of two methods with seeds of their own have nothing to do with each other."""
    assert experiment(10, 5, **seeds).paired == paired


# A row with nothing in its columns.
_NOTHING = {"name": "", "word": "", "number": 0, "flag": False, "list": []}
EMPTY = {name: _NOTHING[kind] for name, kind in (columns.PLANNED | columns.RESULTS).items()}


@pytest.fixture
def chunks(tmp_path):
    """The folder of an experiment's results: two chunks of four repeats of two methods, their
    times, problems and bounds.
    """
    grid = from_lines(["..", ".."], 1.0, "m")
    described = {"across": Problem("across", grid, (0.5, 0.5), (1.5, 1.5))}
    problems.write(described, {"across": "square"}, str(tmp_path / "problems.parquet"))
    table_files.write(problems.compute_bounds(described, {}), str(tmp_path / "bounds.parquet"))
    for method in ("mine", "other"):
        folder = tmp_path / "runs" / "first" / method
        folder.mkdir(parents=True)
        for chunk in range(2):
            repeats = np.arange(4 * chunk, 4 * chunk + 4)
            of = {"experiment": "first", "method": method, "problem": "across"}
            runs = [
                EMPTY
                | of
                | {"id": f"{method}{n}", "repeat": int(n), "length": 2.0, "feasible": True}
                | {"drew": True}
                for n in repeats
            ]
            times = [
                {"id": run["id"], "cpu_s": run["repeat"] / 100, "wall_s": run["repeat"] / 50}
                for run in reversed(runs)
            ]
            table_files.write(
                table_files.build_table(runs, columns.Planned, columns.Outcome),
                str(folder / f"{chunk}.parquet"),
            )
            parquet.write_table(
                table_files.build_table(times, columns.Times), folder / f"{chunk}.times.parquet"
            )
    return tmp_path


def read(folder):
    chunks = [str(folder / "runs/first/mine" / f"{chunk}.parquet") for chunk in range(2)]
    return results.read(
        Files({"mine": chunks}, str(folder / "problems.parquet"), str(folder / "bounds.parquet")),
        6,
        "first",
    ).runs


def test_a_digest_is_of_all_rows_in_any_order(chunks):
    files = sorted((chunks / "runs/first/mine").glob("[0-9].parquet"))
    digest = compute_table_digest(files)
    assert compute_table_digest(files[::-1]) == digest
    table = table_files.read(str(files[0])).to_pylist()
    for row in table:
        changed = [each | {"length": 3.0} if each is row else each for each in table]
        table_files.write(
            table_files.build_table(changed, columns.Planned, columns.Outcome), str(files[0])
        )
        assert compute_table_digest(files) != digest


def test_results_are_cut_at_the_number_of_repeats(chunks):
    """Six are asked for, and whole chunks were run."""
    found = read(chunks)
    assert found["repeat"].to_list() == [0, 1, 2, 3, 4, 5]
    assert found["cpu_s"].to_list() == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert found["bound"].to_numpy() == pytest.approx(np.sqrt(2))


MINE = "runs/first/mine"
# A file, what stands in its place (another file, or content), and what is told of it.
MISPLACED = {
    "another method's runs": (
        f"{MINE}/0.parquet",
        "runs/first/other/0.parquet",
        "of method other, not mine",
    ),
    "another chunk's runs": (f"{MINE}/1.parquet", f"{MINE}/0.parquet", "the runs of another chunk"),
    "another chunk's times": (
        f"{MINE}/0.times.parquet",
        f"{MINE}/1.times.parquet",
        "not the times of 0.parquet",
    ),
    "another method's times": (
        f"{MINE}/0.times.parquet",
        "runs/first/other/0.times.parquet",
        "not the times of 0.parquet",
    ),
    "runs for times": (
        f"{MINE}/0.times.parquet",
        f"{MINE}/1.parquet",
        "no column cpu_s",
    ),
    "times for runs": (
        f"{MINE}/0.parquet",
        f"{MINE}/0.times.parquet",
        "no column study",
    ),
    "a csv for runs": (f"{MINE}/0.parquet", b"id,length\n1,2\n", "not a whole Parquet file"),
    "nothing for runs": (f"{MINE}/0.parquet", b"", "not a whole Parquet file"),
    "a csv for times": (f"{MINE}/0.times.parquet", b"id,cpu_s\n", "not a whole Parquet file"),
    "nothing for bounds": ("bounds.parquet", b"", "not a whole Parquet file"),
    "a csv for problems": ("problems.parquet", b"problem\nacross\n", "not a whole Parquet file"),
    "runs for bounds": (
        "bounds.parquet",
        f"{MINE}/0.times.parquet",
        "no column problem",
    ),
    "runs of an earlier version": (
        f"{MINE}/0.parquet",
        {"clearance_error": None},
        "no column clearance_error",
    ),
    "runs with counts as numbers": (
        f"{MINE}/0.parquet",
        {"evaluations": 1.5},
        "column evaluations is of type double, not int64",
    ),
    "times for problems": (
        "problems.parquet",
        f"{MINE}/0.times.parquet",
        "not of the problems that the runs are of",
    ),
}


@pytest.mark.parametrize("fault", MISPLACED)
def test_a_file_in_the_place_of_another_is_told(chunks, fault):
    place, content, told = MISPLACED[fault]
    if isinstance(content, dict):
        table = parquet.read_table(chunks / place)
        for column, value in content.items():
            table = table.drop_columns(column)
            table = (
                table
                if value is None
                else table.append_column(column, pa.array([value] * len(table)))
            )
        table_files.write(table, str(chunks / place))
    else:
        (chunks / place).write_bytes(
            content if isinstance(content, bytes) else (chunks / content).read_bytes()
        )
    with pytest.raises(ValueError, match=told) as found:
        read(chunks)
    assert (
        str(found.value)
        == f"{chunks / place}: {told}; delete it and start again: the workflow reproduces it"
    )
