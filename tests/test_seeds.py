"""A chunk of runs: which names a seed is made of, which runs are done, and in which order."""

import ast
import hashlib
from pathlib import Path

import chunks
import numpy as np
import pytest

from bezierplan.running import execution
from bezierplan.running.chunk import Condition
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.problem import Problem

ROOT = Path(__file__).resolve().parent.parent

# The first two have one layout in common.
CHUNK = chunks.CHUNK._replace(
    problems={
        name: {"workspace": "w", "layout": layout}
        for name, layout in (("p", 3), ("q", 3), ("r", 4))
    },
    vary={"x": [1, 2]},
    seeds="common",
    repeats=[0, 3],
)


def first_number(seeds, problem="p", x=1, repeat=0, **changes):
    chunk = CHUNK._replace(seeds=seeds, **changes)
    return execution.build_task(chunk, Condition(problem, {"x": x}), repeat).generator().random()


CHANGES = {
    "study": {"study": "other"},
    "experiment": {"experiment": "second"},
    "method": {"method": "rival"},
    "value": {"x": 2},
    "problem": {"problem": "q"},
    "problem and layout": {"problem": "r"},
    "repeat": {"repeat": 1},
}


@pytest.mark.parametrize(
    ("seeds", "without"),
    [("own", set()), ("shared", {"method"}), ("common", {"method", "value", "problem"})],
    ids=["own", "shared", "common"],
)
def test_a_seed_depends_on_what_its_rule_names_and_on_nothing_else(seeds, without):
    same = {
        what
        for what, change in CHANGES.items()
        if first_number(seeds, **change) == first_number(seeds)
    }
    assert same == without


@pytest.mark.parametrize("repeat", [7, 999, 1000, 12345])
def test_a_seed_is_the_sha256_of_the_name_of_its_run(repeat):
    name = f"s/e/p,x=1/line/{repeat}"
    assert execution.run_id(CHUNK, Condition("p", {"x": 1}), repeat) == name
    seed = int(hashlib.sha256(name.encode()).hexdigest(), 16)
    assert first_number("own", repeat=repeat) == np.random.default_rng(seed).random()


PLANNER = """
import numpy as np
from bezierplan.planners import Path, Plan

def plan(problem, rng):
    middle = rng.uniform(0.5, 1.5, 2)
    path = Path("polyline", np.array([problem.start, middle, problem.target]))
    return Plan(path, float(middle[0]), True, 1, np.full(3, middle[0]), "tries", {})
"""


@pytest.fixture
def job(tmp_path):
    (tmp_path / "random_point.py").write_text(PLANNER)
    return CHUNK._replace(planner=str(tmp_path / "random_point.py"), seeds="own", repeats=[4, 7])


PROBLEMS = {
    name: Problem(name, from_lines(["....", "...."], 1.0, "cell"), (0.5, 0.5), (3.5, 1.5))
    for name in "pqr"
}


def test_a_chunk_is_every_condition_with_all_its_repeats(job):
    runs, times = (table.to_pandas() for table in execution.run_chunk(PROBLEMS, job))
    expected = [
        f"s/e/{problem},x={x}/line/{repeat}"
        for problem in "pqr"
        for x in (1, 2)
        for repeat in (4, 5, 6)
    ]
    assert runs["id"].to_list() == times["id"].to_list() == expected
    assert runs["repeat"].to_list() == [4, 5, 6] * 6
    assert runs["generations"].to_list() == [2] * 18
    assert (times["wall_s"] > 0).all()
    # Each run has the numbers of its own generator, whatever ran before it.
    for run in runs.itertuples():
        assert run.objective == 0.5 + first_number("own", run.problem, run.x, run.repeat)


def test_nothing_that_is_judged_or_drawn_depends_on_a_number_as_seed():
    """Seeds come from names, in what claims and drawings draw as in runs."""
    folders = [ROOT / "src/bezierplan" / name for name in ("analysis", "figures", "study")]
    numbered = [
        f"{file.name}:{node.lineno}"
        for folder in folders
        for file in folder.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call)
        and getattr(node.func, "attr", "") in ("default_rng", "RandomState", "seed")
    ]
    assert numbered == []
