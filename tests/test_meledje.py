"""The study meledje: its drawings, audit, maps and settings; ground that is not flat; a reader's
own map by configuration alone.
"""

import itertools
import math
from functools import partial
from pathlib import Path as File

import numpy as np
import pandas as pd
import pytest
from panels import options_of
from studies import drawing as drawn
from studies import problem_of, published, study

from bezierplan.figures.panels import drawing
from bezierplan.geometry import shortest_paths
from bezierplan.papers.meledje import audit as meledje
from bezierplan.planners import Plan, node_genetic
from bezierplan.running import execution, problems
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.simulation import motion_check
from bezierplan.running.simulation.motion_check import cut_motion
from bezierplan.running.simulation.robot import drive
from bezierplan.study import loading
from bezierplan.study.jobs import build_chunk, build_problems_job
from bezierplan.workspaces import files, grid
from bezierplan.workspaces.ground import (
    build_ground,
    centres,
    compute_edge_energy,
    count_obstacles_on,
    find_cheapest,
    find_least_energy,
)
from bezierplan.workspaces.problem import Path, Problem

YARD = File(__file__).parent / "data" / "yard"
FOLDER = File(__file__).parents[1] / "config" / "studies" / "meledje"
STUDY = study("meledje")
problem = partial(problem_of, "meledje")
PUBLISHED = published("meledje")


def workspace(name):
    return files.load(STUDY.workspaces[name].plain(), FOLDER)


def test_maps_change_as_the_paper_says():
    """Both environments change somewhere, and the optimum of the initial map is blocked in the
    modified one.
    """
    for environment in ("env1", "env2"):
        before, after = (workspace(f"{environment}_{state}") for state in ("initial", "modified"))
        assert before.occupied.shape == after.occupied.shape == (16, 16)
        _, path = find_cheapest(build_ground(before, 1.0), 0, 255)
        ground = build_ground(after, 1.0)
        assert (
            sum(count_obstacles_on(ground, *edge) for edge in itertools.pairwise(path.tolist()))
            == 2
        )


# Share of the way, of the exact optimum, after which the map changes -> cell (column, row), what
# remains, and that with what was gone; by a program of its own.
DRIVEN = {
    ("env1", 10): ((2, 1), 26.7527, 29.380),
    ("env1", 25): ((6, 2), 22.6296, 29.197),
    ("env1", 50): ((8, 7), 13.1531, 26.287),
    ("env2", 10): ((3, 1), 29.0996, 32.660),
    ("env2", 25): ((9, 2), 23.0285, 31.930),
    ("env2", 50): ((9, 5), 14.1421, 31.945),
}


def cell_path(problem, state):
    """The shortest path over centres of free cells, as a planner."""
    found = shortest_paths.centre_path(problem)
    return Plan.of_one(Path("polyline", found.points), found.length, "exact"), state


@pytest.mark.parametrize(("environment", "percent"), DRIVEN)
def test_the_robot_plans_again_from_the_cell_where_it_is(environment, percent):
    (column, row), remaining, total = DRIVEN[environment, percent]
    name = f"{environment}_at_{percent}"
    described = Descriptions(
        "meledje", {name: STUDY.problems[name].plain()}, {name: STUDY.workspaces[name].plain()}
    )
    made, moving = problems.build_all(described, FOLDER)
    ride = drive(moving[name], made[name], STUDY.policies["replans"], cell_path)
    moment = moving[name].moments[0]
    assert moment == pytest.approx(percent / 100 * ride.plans[0].length)
    here = cut_motion(ride.motion, 0.0, moment).points[-1]
    assert made[name].workspace.cell_of(*here) == (row, column)
    rest = shortest_paths.centre_path(
        Problem(name, moving[name].maps[1], (column + 0.5, row + 0.5), made[name].target)
    ).length
    assert rest == pytest.approx(remaining, abs=1e-4)
    assert moment + rest == pytest.approx(total, abs=1e-3)
    if len(ride.plans) > 1:  # the change blocks its way
        hop = math.dist(here, (column + 0.5, row + 0.5))
        assert ride.plans[1].time == moment
        # It also drives to the centre of its cell.
        assert ride.plans[1].length == pytest.approx(hop + remaining, abs=1e-4)
    assert ride.arrived
    assert math.isnan(motion_check.check(ride.motion, moving[name]).collision_at)


# Drawings


def test_children_of_the_drawn_crossover_exchange_their_tails():
    marks = drawing.data(drawn("meledje", "figure3"), options_of(drawing))
    texts = marks[marks["mark"] == "text"]
    rows = {
        part: [own["text"].astype(int).to_list() for _, own in of.groupby("y", sort=False)]
        for part, of in texts.groupby("part")
    }
    one, other = rows["parents"]
    assert rows["children"] == [one[:3] + other[3:], other[:3] + one[3:]]


# The audit


def test_audit_of_the_published_tables():
    rows = pd.DataFrame(meledje.audit(PUBLISHED))
    wrong = rows[~rows["consistent"]]
    pooled = rows[rows["rule"].str.contains("Cochran")]
    # With the continuity correction, as in R's mantelhaen.test.
    assert pooled["printed"].to_list() == pytest.approx([0.0019, 0.13], rel=0.05)
    assert wrong["rule"].str.contains("near-optimal solutions \\(").sum() == 4
    lowest = wrong["rule"].str.contains("lowest mean fitness")
    assert wrong.loc[lowest, "item"].to_list() == ["table5"]
    fisher = rows[rows["rule"].str.contains("Fisher")].set_index(["item", "place"])["printed"]
    assert fisher["table2", "metric=optimal, proposed and ref12"] == pytest.approx(
        3 * 0.1524, rel=1e-3
    )
    ranked = wrong[wrong["rule"].str.startswith("pairs")]
    assert ranked[["item", "place", "printed"]].values.tolist() == [
        ["table3", "metric=optimal", 5],
        ["table5", "metric=objective", 5],
        ["table4", "metric=cpu_s", 4],
        ["table5", "metric=cpu_s", 5],
    ]
    # The word dynamic stands in the title, and no table has drives.
    assert wrong[wrong["item"] == "text"][["place", "printed", "limit"]].values.tolist() == [
        ["title", 0.0, 1.0]
    ]


# Ground that is not flat


def climbed(path, heights):
    """Climbs along the cells of a path, by 10,001 points of each edge that are no corners of
    cells.
    """
    total = 0.0
    for one, other in itertools.pairwise(path):
        points = np.array(one) + (np.arange(10_001) / 10_000)[:, None] * (np.array(other) - one)
        steps = np.diff(heights[points[:, 1].astype(int), points[:, 0].astype(int)])
        total += steps[steps > 0].sum()
    return total


def test_the_cheapest_path_is_not_the_shortest():
    flat, hill = problem("plain"), problem("hill")
    start, target = 52, 64
    _, shortest = find_cheapest(build_ground(flat.workspace, 1.0), start, target)
    energy, best = find_cheapest(build_ground(hill.workspace, 1.0), start, target)
    lengths = [
        np.hypot(*np.diff(centres(hill.workspace, path), axis=0).T).sum()
        for path in (shortest, best)
    ]
    climbs = [
        climbed(centres(hill.workspace, path).tolist(), hill.workspace.heights)
        for path in (shortest, best)
    ]
    assert lengths[0] < lengths[1]
    assert energy == pytest.approx(lengths[1] + climbs[1])
    assert energy < lengths[0] + climbs[0]


def test_the_search_finds_the_cheapest_path_over_the_hill():
    settings = STUDY.resolve_settings("proposed")
    found = [
        node_genetic.plan(problem("hill"), np.random.default_rng(seed), **settings)
        for seed in range(10)
    ]
    assert any(each.extra["optimal"] for each in found)
    assert all(
        each.objective >= each.extra["optimum"] - 1e-9 for each in found if each.claimed_feasible
    )


@pytest.mark.parametrize("cell", [1.0, 10.0])
def test_energy_is_length_and_climb_over_friction(cell):
    heights = np.array([[0.0, 1.0, 0.5], [0.0, 3.0, 2.0]]) * cell
    home = grid.Grid(np.zeros((2, 3), dtype=bool), cell, "m", heights=heights)
    for friction in (1.0, 0.5):
        ground = build_ground(home, friction)
        assert compute_edge_energy(ground, 0, 2) == 2 + 1 / friction
        assert compute_edge_energy(ground, 2, 0) == 2 + 0.5 / friction
        assert compute_edge_energy(ground, 0, 4) == pytest.approx(math.sqrt(2) + 3 / friction)
        assert compute_edge_energy(ground, 0, 5) == pytest.approx(math.sqrt(5) + 3 / friction)


def test_heights_come_back_from_text_bit_by_bit():
    home = workspace("hill")
    again = files.read_json(files.write_json(home))
    assert again.heights.tobytes() == home.heights.tobytes()
    assert home.heights[8, 0] == 0
    assert home.heights[5, 5] == 3
    assert files.read_json(files.write_json(workspace("plain"))).heights is None


def test_heights_are_a_source_of_a_map(tmp_path):
    description = {"kind": "grid", "file": "map.txt", "cell": 1, "unit": "m", "heights": "hill.txt"}
    assert files.sources(description, tmp_path) == [tmp_path / "map.txt", tmp_path / "hill.txt"]


@pytest.mark.parametrize("text", ["0 0 0", "0 0 0\n0 0", "0 0 0\n0 x 0", "0 0 inf\n0 0 0"])
def test_faults_of_heights_are_told(text, tmp_path):
    (tmp_path / "map.txt").write_text("...\n...")
    (tmp_path / "heights.txt").write_text(text)
    description = {
        "kind": "grid",
        "file": "map.txt",
        "heights": "heights.txt",
        "cell": 1,
        "unit": "m",
    }
    with pytest.raises(ValueError, match=r"heights.txt: .*expected (2 lines of 3|finite) numbers"):
        files.load(description, tmp_path)
    with pytest.raises(ValueError, match=r"heights: none.txt: cannot be read"):
        files.load(description | {"heights": "none.txt"}, tmp_path)


# A reader's own map


def test_an_own_map_of_any_size_needs_configuration_alone():
    study = loading.load([YARD])["yard"]
    made, _ = problems.build_all(build_problems_job(study, "tries", "full"), study.folder)
    for method in ("proposed", "repaired"):
        runs, times = execution.run_chunk(made, build_chunk(study, "tries", method, "full", 0))
        table = runs.to_pandas()
        assert len(table) == len(times) == 3
        assert table["optimal"].dtype == bool
        assert (table["claimed_feasible"] == table["feasible"]).all()
        assert (table["objective"] >= table["optimum"] - 1e-9).all()
        free = table[table["feasible"]]
        assert free["length"].to_numpy() == pytest.approx(free["objective"].to_numpy())


def test_closed_corners_contradict_six_printed_means_on_the_invented_maps():
    """Assumption M19 prints the optima."""
    reason = next(each.reason for each in STUDY.assumptions if each.id == "M19")
    below = 0
    for table, name in (
        ("table2", "env1_initial"),
        ("table3", "env1_modified"),
        ("table4", "env2_initial"),
        ("table5", "env2_modified"),
    ):
        made = workspace(name)
        least = find_least_energy(made, 1.0, True, 0, made.occupied.size - 1)
        assert f"{least:.4f}" in reason
        means = PUBLISHED[table].query("metric == 'objective'")["value"]
        below += int((means < least).sum())
    assert below == 6


def test_holm_against_a_worked_example():
    """Times 4, 3, 2 and 1 from the least p on, never below the one before, and at most 1 (Holm
    1979).
    """
    assert meledje.correct_by_holm(np.array([0.01, 0.04, 0.03, 0.005])) == pytest.approx(
        [0.03, 0.06, 0.06, 0.02]
    )
    assert meledje.correct_by_holm(np.array([0.9, 0.8])) == pytest.approx([1, 1])
    assert len(meledje.correct_by_holm(np.array([]))) == 0
