"""Experiments in worlds that move: a study of a reader's own, equal runs from equal seeds, faults in one line, and replaying a drive."""

import math

import numpy as np
import pandas as pd
import pytest
from PIL import Image, ImageSequence

from bezierplan.commands import replay
from bezierplan.figures import animation
from bezierplan.running import problems, rides, worlds
from bezierplan.running.execution import Condition
from bezierplan.running.simulation.motion_check import Motion
from bezierplan.running.simulation.robot import Planned, Ride
from bezierplan.schema.checked import Fault
from bezierplan.study import reading
from bezierplan.study.jobs import job, problems_job

PLANNER = """
from typing import Annotated

import numpy as np

from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan, Range

workspaces = ("grid",)


def plan(problem, rng, *, tries: Annotated[int, Range(1)]):
    grid, best, history = problem.workspace, None, []
    x_low, x_high, y_low, y_high = grid.bounds
    for middle in rng.uniform((x_low, y_low), (x_high, y_high), (tries, 2)):
        path = Path("polyline", np.array([problem.start, middle, problem.target]))
        cells = [grid.cell_of(x, y) for x, y in curves.sample_matrix("polyline", 3, 201) @ path.points]
        if not any(grid.occupied[cell] for cell in cells) and (best is None or curves.length(path) < curves.length(best)):
            best = path
        history.append(np.inf if best is None else curves.length(best))
    return Plan(best, history[-1], best is not None, tries, np.array(history), "tries", {})
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
  room: {kind: changing_cells, file: first.txt, cell: 1, unit: m, changes: [{file: second.txt, at: 2.5}], pace: 1, steps: 60}
  fixed: {kind: grid, file: first.txt, cell: 1, unit: m}
problems:
  across: {workspace: room, start_cell: 14, target_cell: 20}
  there: {workspace: fixed, start_cell: 14, target_cell: 20}
experiments:
  drives: {problems: [across], methods: [mine], repeats: {smoke: 3, full: 3, extended: 3}, chunk: {smoke: 3, full: 3, extended: 3}}
  plans: {problems: [there], methods: [still], repeats: {smoke: 1, full: 1, extended: 1}, chunk: {smoke: 1, full: 1, extended: 1}}
"""

FIRST = ".......\n...#...\n.......\n...#...\n...#...\n"
SECOND = ".......\n...#...\n...#...\n...#...\n.......\n"


def written(folder, old="", new=""):
    """A study in a folder, with a text of its experiments replaced."""
    assert old in EXPERIMENTS
    home = folder / "mystudy"
    home.mkdir()
    for name, text in {
        "experiments.yaml": EXPERIMENTS.replace(old, new),
        "walk.py": PLANNER,
        "first.txt": FIRST,
        "second.txt": SECOND,
    }.items():
        (home / name).write_text(text)
    return home


def chunk(study):
    made, _, found = worlds.build_all(problems_job(study, "drives", "smoke"), study.folder)
    return rides.run_chunk(made, found, job(study, "drives", "mine", "smoke", 0))


def test_a_reader_s_planner_drives_by_one_line_of_config(tmp_path):
    study = reading.load([written(tmp_path)])["mystudy"]
    runs, times, traces = (table.to_pylist() for table in chunk(study))
    assert [run["id"] for run in runs] == [f"mystudy/drives/across/mine/{repeat}" for repeat in range(3)]
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


def test_equal_seeds_give_equal_drives(tmp_path):
    study = reading.load([written(tmp_path)])["mystudy"]
    one, other = chunk(study), chunk(study)
    for number in (0, 2):
        pd.testing.assert_frame_equal(one[number].to_pandas(), other[number].to_pandas())
    stored = one[0].to_pylist()[1]
    found = replay.replay(stored["id"], {"mystudy": study})
    assert replay.equal(found.runs.iloc[0], stored)


def test_animation_begins_at_the_start_and_ends_at_the_end_of_the_drive(tmp_path):
    study = reading.load([written(tmp_path)])["mystudy"]
    file = tmp_path / "drive.gif"
    replay.animate(replay.replay("mystudy/drives/across/mine/0", {"mystudy": study}), file)
    assert file.stat().st_size < 500_000
    with Image.open(file) as found:
        frames = [np.asarray(frame.convert("RGB")).astype(int) for frame in ImageSequence.Iterator(found)]
        # Frames in which nothing moves are one, shown longer.
        shown = sum(frame.info["duration"] for frame in ImageSequence.Iterator(found))
    assert shown == (animation.FRAMES - 1) * animation.EACH + animation.LAST
    # The way so far is red: none at first, the longest in the end.
    red = [np.count_nonzero((frame[..., 0] - frame[..., 1:].max(axis=2)) > 80) for frame in frames]
    assert red[0] < red[len(red) // 2] < red[-1]


def test_files_of_problems_keep_the_world(tmp_path):
    study = reading.load([written(tmp_path)])["mystudy"]
    made, workspaces, found = worlds.build_all(problems_job(study, "drives", "smoke"), study.folder)
    file = str(tmp_path / "drives.parquet")
    worlds.write(made, workspaces, found, file)
    assert worlds.read(file)["across"].workspace(3).occupied[2, 3]
    assert not problems.read(file)["across"].workspace.occupied[2, 3]
    bounds = rides.bounds_of(made, found).to_pylist()[0]
    assert bounds["bound"] == 6.0
    assert 6.0 < bounds["clairvoyant_arrival"] < math.inf


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("policy: replans", "policy: replan", "methods: mine: policy: replan: unknown; did you mean replans"),
        ("policy: replans, ", "", "methods: mine: has no policy, which a world that moves needs"),
        ("methods: [still]", "methods: [mine]", "methods: mine: has a policy, but nothing moves here"),
        ("problems: [across]", "problems: [across, there]", "problems: there: its workspace does not move"),
        ("replan: when_blocked", "replan: sometimes", "policies: replans: replan: sometimes: unknown"),
        ("start: centre", "warm: true", "policy: replans: warm, but planner walk.py has no function resume"),
        ("second.txt, at", "third.txt, at", "changes: 0: file: third.txt"),
        (", at: 2.5", "", "changes: 0: expected either after or at"),
        ("at: 2.5", "at: -1", "changes: 0: at: -1: expected"),
        ("pace: 1", "pace: 0", "pace: 0: expected how far a robot drives in a step, in units, a number above 0"),
    ],
)
def test_a_fault_is_told_in_one_line(old, new, told, tmp_path):
    with pytest.raises(Fault) as fault:
        reading.load([written(tmp_path, old, new)])
    assert told in str(fault.value)
    assert "\n" not in str(fault.value)


@pytest.mark.parametrize(("end", "feasible"), [((6.5, 2.5), True), ((6.0, 2.5), False)])
def test_a_robot_that_believes_to_have_arrived_elsewhere_is_not_feasible(tmp_path, end, feasible):
    study = reading.load([written(tmp_path)])["mystudy"]
    made, _, found = worlds.build_all(problems_job(study, "drives", "smoke"), study.folder)
    around = np.array([(0.5, 2.5), (0.5, 4.5), (6.5, 4.5), end])
    times = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(around, axis=0).T))])
    plan = Planned(0.0, None, float(times[-1]), 0.0, 0.0, 1)
    ride = Ride(Motion(around, times), True, 0.0, [plan])
    described = job(study, "drives", "mine", "smoke", 0)
    row, _ = rides.row(described, Condition("across", {}), 0, ride, made["across"], found["across"])
    assert (row["claimed_feasible"], row["feasible"]) == (True, feasible)


@pytest.mark.parametrize(
    ("clearance", "least", "steps"), [([0.2, 0.0, -1e-10], 0.0, 0), ([0.2, -0.3, -0.1], 0.0, 2), ([0.2, 0.1, 0.4], 0.1, 0)]
)
def test_columns_of_a_drive_count_what_is_deeper_than_the_tolerance(tmp_path, monkeypatch, clearance, least, steps):
    study = reading.load([written(tmp_path)])["mystudy"]
    made, _, found = worlds.build_all(problems_job(study, "drives", "smoke"), study.folder)
    points = np.array([(0.5, 2.5), (0.5, 4.5), (6.5, 4.5), (6.5, 2.5)])
    ride = Ride(Motion(points, np.arange(4.0)), True, 0.0, [Planned(0.0, None, 10.0, 0.0, 0.0, 1)])
    verdict = rides.motion_check.Verdict(math.nan, np.array(clearance), 0.0, 1e-9)
    monkeypatch.setattr(rides.motion_check, "check", lambda motion, world: verdict)
    row, _ = rides.row(job(study, "drives", "mine", "smoke", 0), Condition("across", {}), 0, ride, made["across"], found["across"])
    assert (row["clearance"], row["collision_steps"]) == (least, steps)
