"""Experiments in worlds that move: a study of a reader's own, equal runs from equal seeds, faults
in one line, and replaying a drive.
"""

import math
import re

import faults
import numpy as np
import pandas as pd
import pytest
from trees import edit

from bezierplan.analysis import metrics, results
from bezierplan.analysis.stored_runs import is_equal
from bezierplan.commands import replay
from bezierplan.geometry import shortest_paths
from bezierplan.running import drives, execution, problems
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.robot import DrivePlan, Ride
from bezierplan.study import loading
from bezierplan.study.jobs import build_chunk, build_problems_job

pytestmark = pytest.mark.usefixtures("planners_are_read_here")

PLANNER = """
from typing import Annotated

import numpy as np

from bezierplan.geometry import shortest_paths
from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan, Range

workspaces = ("grid",)


def plan(problem, rng, *, tries: Annotated[int, Range(1)]):
    grid, best, history = problem.workspace, None, []
    x_low, x_high, y_low, y_high = grid.bounds
    for middle in rng.uniform((x_low, y_low), (x_high, y_high), (tries, 2)):
        path = Path("polyline", np.array([problem.start, middle, problem.target]))
        samples = curves.sample_matrix("polyline", 3, 201) @ path.points
        free = not any(grid.occupied[grid.cell_of(x, y)] for x, y in samples)
        if free and (best is None or curves.length(path) < curves.length(best)):
            best = path
        history.append(np.inf if best is None else curves.length(best))
    return Plan(best, history[-1], best is not None, tries, np.array(history), "tries", {})
"""

RESUMES = """

def resume(problem, rng, last, *, tries: Annotated[int, Range(1)]):
    made = (last or 0) + 1
    return plan(problem, rng, tries=tries)._replace(evaluations=made), made
"""

EXPERIMENTS = """
title: My planner in a room whose door moves
methods:
  mine: {planner: walk.py, policy: replans, settings: {tries: 60}}
  still: {planner: walk.py, settings: {tries: 60}}
settings: {}
policies:
  replans: {replan: when_blocked, start: centre}
workspaces:
  room: {kind: changing_cells, file: first.txt, cell: 1, unit: m,
    changes: [{file: second.txt, at: 2.5}], pace: 1, steps: 60}
  fixed: {kind: grid, file: first.txt, cell: 1, unit: m}
problems:
  across: {workspace: room, start_cell: 14, target_cell: 20}
  there: {workspace: fixed, start_cell: 14, target_cell: 20}
experiments:
  drives: {problems: [across], methods: [mine], repeats: {smoke: 3, full: 3, extended: 3},
    chunk: {smoke: 3, full: 3, extended: 3}}
  plans: {problems: [there], methods: [still], repeats: {smoke: 1, full: 1, extended: 1},
    chunk: {smoke: 1, full: 1, extended: 1}}
"""

FIRST = ".......\n...#...\n.......\n...#...\n...#...\n"
SECOND = ".......\n...#...\n...#...\n...#...\n.......\n"


def written(folder):
    """A study in a folder."""
    home = folder / "mystudy"
    home.mkdir()
    for name, text in {
        "experiments.yaml": EXPERIMENTS,
        "walk.py": PLANNER,
        "first.txt": FIRST,
        "second.txt": SECOND,
    }.items():
        (home / name).write_text(text)
    return home


def build(study):
    return problems.build_all(build_problems_job(study, "drives", "smoke"), study.folder)


def chunk(study):
    made, found = build(study)
    return execution.run_chunk(made, build_chunk(study, "drives", "mine", "smoke", 0), found)


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """The study, and its drives."""
    study = loading.load([written(tmp_path_factory.mktemp("drives"))])["mystudy"]
    return study, chunk(study)


@pytest.fixture(scope="module")
def room(driven):
    """The problem of the drives, and its world."""
    made, found = build(driven[0])
    return made["across"], found["across"]


def test_a_reader_s_planner_drives_by_one_line_of_config(driven):
    runs, times, traces = (table.to_pylist() for table in driven[1])
    assert [run["id"] for run in runs] == [
        f"mystudy/drives/across/mine/{repeat}" for repeat in range(3)
    ]
    assert len(times) == len(traces) == 3
    for run in runs:
        # The gate in its straight way closes at step 2.5, so it plans again.
        assert run["replans"] >= 1
        if run["feasible"]:
            assert run["path_points"][:2] == [0.5, 2.5]
            assert run["path_points"][-2:] == [6.5, 2.5]
            assert run["arrival"] == pytest.approx(run["travelled"] + run["waits"])
            assert run["travelled"] > 6
    assert any(run["feasible"] for run in runs)


def test_equal_seeds_give_equal_drives(driven):
    study, one = driven
    other = chunk(study)
    for number in (0, 2):
        pd.testing.assert_frame_equal(one[number].to_pandas(), other[number].to_pandas())
    stored = one[0].to_pylist()[1]
    found = replay.replay(stored["id"], {"mystudy": study})
    assert is_equal(found.runs.iloc[0], stored)


def resuming(folder, resumes=RESUMES):
    """The study with a planner whose plans start from the last one."""
    home = written(folder)
    edit(home / "experiments.yaml", "start: centre", "start: centre, warm: true")
    edit(home / "walk.py", PLANNER, PLANNER + resumes)
    return loading.load([home])["mystudy"]


def test_a_plan_starts_from_what_the_last_one_kept(tmp_path):
    """Each plan says by what it kept how many came before it; one without a path keeps nothing."""
    for run in chunk(resuming(tmp_path))[0].to_pylist():
        assert run["evaluations"] > run["replans"] + 1 > 1


def test_a_resume_without_a_state_is_told(tmp_path):
    study = resuming(tmp_path, RESUMES.replace("evaluations=made), made", "evaluations=made)"))
    with pytest.raises(RuntimeError, match=r"resume returns a Plan; expected a Plan and what"):
        chunk(study)


def test_a_drive_that_is_made_again_has_the_path_of_its_row(driven, room):
    study, (runs, *_) = driven
    described = build_chunk(study, "drives", "mine", "smoke", 0)
    run = runs.to_pylist()[1]
    ride, _ = execution.drive_again(described, run, *room)
    assert ride.motion.points[-1].tolist() == run["path_points"][-2:]
    with pytest.raises(ValueError, match="its rerun ends in another path"):
        execution.drive_again(described, run | {"repeat": 0}, *room)


def test_a_replayed_drive_is_drawn_at_its_moments(driven, tmp_path):
    study, (runs, *_) = driven
    file = tmp_path / "drive.svg"
    replay.draw_drive(replay.replay("mystudy/drives/across/mine/0", {"mystudy": study}), file)
    end = runs.to_pylist()[0]["travelled"] + runs.to_pylist()[0]["waits"]
    steps = [int(step) for step in re.findall(r"step (\d+)", file.read_text())]
    assert steps == [round(moment * end) for moment in replay.MOMENTS]


def test_files_of_problems_keep_the_world(driven, tmp_path):
    made, found = build(driven[0])
    file = str(tmp_path / "drives.parquet")
    problems.write(made, {"across": "room"}, file, found)
    before, moving = problems.read(file)
    assert moving["across"].workspace(3).occupied[2, 3]
    assert not before["across"].workspace.occupied[2, 3]
    bounds = problems.compute_bounds(made, found).to_pylist()[0]
    assert bounds["bound"] == 6.0
    later = made["across"]._replace(workspace=found["across"].maps[1])
    assert bounds["least_arrival"] == shortest_paths.shortest_path(later).length > 6.0


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "policy: replans",
            "policy: replan",
            "methods: mine: policy: replan: unknown; did you mean replans",
        ),
        (
            "policy: replans, ",
            "",
            "methods: mine: needs a policy, which experiments in worlds that move",
        ),
        (
            "methods: [still]",
            "methods: [mine]",
            "methods: mine: has a policy, which experiments in worlds that move",
        ),
        (
            "problems: [across]",
            "problems: [across, there]",
            "problems: there: its workspace does not move",
        ),
        (
            "replan: when_blocked",
            "replan: sometimes",
            "policies: replans: replan: sometimes: unknown",
        ),
        (
            "start: centre",
            "warm: true",
            "policy: replans: warm, but its planner has no function resume",
        ),
        ("second.txt, at", "third.txt, at", "changes: 0: file: third.txt"),
        (", at: 2.5", "", "changes: 0: expected either after or at"),
        ("at: 2.5", "at: -1", "changes: 0: at: -1: expected"),
        (
            "pace: 1",
            "pace: 0",
            "pace: 0: expected how far a robot drives in a step, in units, a number above 0",
        ),
    ],
)
def test_a_fault_is_told_in_one_line(old, new, told, tmp_path):
    home = written(tmp_path)
    assert told in faults.told(home / "experiments.yaml", old, new, home)


def a_row(room, points, times):
    """The row of a drive by some points at some times, in the room whose door moves at step 2.5."""
    motion = Motion(np.array(points), np.array(times, dtype=float))
    ride = Ride(motion, True, 0.0, [DrivePlan(0.0, None, 6.0, 0.0, 1)])
    return drives.judge_drive(ride, True, *room)[0]


@pytest.mark.parametrize(("end", "feasible"), [((6.5, 2.5), True), ((6.0, 2.5), False)])
def test_a_robot_that_believes_to_have_arrived_elsewhere_is_not_feasible(room, end, feasible):
    row = a_row(room, [(0.5, 2.5), (0.5, 4.5), (6.5, 4.5), end], [0.0, 2.0, 8.0, 10.0])
    assert (row["claimed_feasible"], row["feasible"]) == (True, feasible)


@pytest.mark.parametrize(
    ("clearance", "least", "steps"),
    [([0.2, 0.0, -1e-10], 0.0, 0), ([0.2, -0.3, -0.1], 0.0, 2), ([0.2, 0.1, 0.4], 0.1, 0)],
)
def test_columns_of_a_drive_count_what_is_deeper_than_the_tolerance(
    room, monkeypatch, clearance, least, steps
):
    verdict = drives.motion_check.Verdict(math.nan, np.array(clearance), 0.0, 1e-9)
    monkeypatch.setattr(drives.motion_check, "check", lambda motion, world: verdict)
    row = a_row(room, [(0.5, 2.5), (0.5, 4.5), (6.5, 4.5), (6.5, 2.5)], range(4))
    assert (row["clearance"], row["collision_steps"]) == (least, steps)


@pytest.mark.parametrize(("at", "waiting"), [(1.0, True), (3.0, False), (math.nan, False)])
def test_a_robot_is_hit_waiting_if_it_waited_before(room, monkeypatch, at, waiting):
    verdict = drives.motion_check.Verdict(at, np.zeros(4), 0.0, 1e-9)
    monkeypatch.setattr(drives.motion_check, "check", lambda motion, world: verdict)
    row = a_row(room, [(0.5, 2.5), (0.5, 2.5), (0.5, 4.5)], [0.0, 2.0, 4.0])
    assert row["hit_waiting"] == waiting


# The cell in the middle of the room becomes occupied at step 2.5, when the robot is there.
THERE = (3.5, 2.5)


@pytest.mark.parametrize(
    ("points", "times", "stands"),
    [
        # It drives until it is hit, and stands from then on.
        ([(0.5, 2.5), THERE, THERE], [0.0, 2.5, 9.0], False),
        # It stands for the last half of a step before it is hit, and drives on.
        ([(0.5, 2.5), THERE, THERE, (6.5, 2.5)], [0.0, 2.0, 2.5, 6.0], True),
        # It is hit between two of its vertices.
        ([(0.5, 2.5), (6.5, 2.5)], [0.0, 5.0], False),
        ([(0.5, 2.5), THERE, THERE], [0.0, 2.0, 9.0], True),
    ],
)
def test_a_robot_that_is_hit_was_standing_or_driving_before(points, times, stands, room):
    row = a_row(room, points, times)
    assert row["collision_at"] == pytest.approx(2.5)
    assert row["hit_waiting"] is stands


def test_the_least_last_plan_is_that_of_the_map_and_the_place_of_the_last_plan(room):
    row = a_row(room, [(0.5, 2.5), (6.5, 2.5)], [0.0, 6.0])
    assert row["last_optimum"] == pytest.approx(6.0)


def drives_of(*rows):
    """Runs (method, repeat, arrival) in one world, infeasible without an arrival."""
    table = pd.DataFrame(rows, columns=["method", "repeat", "arrival"])
    feasible = table["arrival"].notna()
    same = {
        "experiment": "drives",
        "condition": "across",
        "problem": "across",
        "length": table["arrival"],
        "claimed_feasible": feasible,
    }
    ids = [
        f"mystudy/drives/across/{method}/{repeat}"
        for method, repeat in zip(table["method"], table["repeat"])
    ]
    return table.assign(id=ids, feasible=feasible, drew=True, **same)


def bounds_table(**values):
    return pd.DataFrame([{"problem": "across", "bound": 6.0, "least_length": 6.0 - 1e-8} | values])


@pytest.mark.parametrize(("arrival", "refused"), [(3.0, False), (2.9999, True)])
def test_no_drive_arrives_before_any_robot_can(arrival, refused):
    runs = drives_of(("mine", 0, arrival)).assign(length=6.0)
    bounds = bounds_table(least_arrival=3.0)
    if not refused:
        assert len(results.join_bounds(runs, {}, bounds).runs) == 1
        return
    with pytest.raises(
        ValueError,
        match=r"across/mine/0 is said to be feasible, "
        r"but its arrival 2\.9999 lies below the bound 3",
    ):
        results.join_bounds(runs, {}, bounds)


def paired_runs():
    """Two robots that both arrive in repeat 0 alone, and one that never does."""
    runs = drives_of(
        ("one", 0, 6.6),
        ("one", 1, 9.0),
        ("other", 0, 7.2),
        ("other", 1, np.nan),
        ("blind", 0, np.nan),
        ("blind", 1, np.nan),
    )
    return results.join_bounds(runs, {}, bounds_table(least_arrival=6.0, octile_bound=np.nan))


def test_delays_are_paired_over_the_worlds_that_all_methods_finish():
    found = paired_runs()
    both = results.select(found.runs, {"method": ["one", "other"]})
    assert metrics.compute_values(both, "paired_gap_least_arrival", {}).tolist() == pytest.approx(
        [0.1, np.nan, 0.2, np.nan], nan_ok=True
    )
    assert metrics.compute_values(found.runs, "paired_gap_least_arrival", {}).isna().all()
