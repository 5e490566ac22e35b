"""Contract tests for a planner, from this package or your own: the requirements of `planners`, on
small and degenerate problems.

Every setting of a planner needs a value. The planner counts its own budget: the tests check its
count, not its actual work.
"""

import hashlib
import itertools
import json
import math
import os
import random
import subprocess
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.geometry.region import Region, region
from bezierplan.kernels import allocation_free
from bezierplan.planners import Plan, is_file, known_planners
from bezierplan.running import answer, interface, watchdog
from bezierplan.running.columns import TAKEN
from bezierplan.running.loans import lend
from bezierplan.running.tampering import left_alone
from bezierplan.schema.checked import Fault, closest
from bezierplan.schema.words import told
from bezierplan.workspaces import grid
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

LIMIT = 600.0
"""Seconds that one plan may take, compilation included."""

# Number of generators, with one plan for each.
_GENERATORS = 3

_UNIT = "unit"


class Finding(NamedTuple):
    """The result of one test of the contract on one problem. detail: the fault if it failed,
    otherwise additional information.
    """

    problem: str
    fact: str
    passed: bool
    detail: str

    def __str__(self) -> str:
        verdict = "ok" if self.passed else "FAILED"
        return f"{verdict:8}{self.problem:40}{self.fact:20}{self.detail}".rstrip()


def check_planner(planner: str, settings: dict[str, Any]) -> Iterator[Finding]:
    """Findings on a planner, given as a name or the path of a file, with these settings; computed
    lazily.

    Raises Fault, in one line, before the first finding: for a file that is not a planner, and for
    missing or invalid settings.
    """
    module = _loaded(planner)
    first = _check_settings(module, settings, planner)
    return itertools.chain(first, _findings(module, settings))


def check_elsewhere(planner: str, settings: dict[str, Any]) -> Iterator[Finding]:
    """Findings, one a problem, on whether a planner that passes `check_planner` gives the same bits
    in another process, where `hash`, the order of sets and the addresses of objects differ.
    """
    hashing = "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"
    command = [sys.executable, "-m", __name__, planner, json.dumps(settings)]
    there = subprocess.run(
        command,
        env=os.environ | {"PYTHONHASHSEED": hashing},
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    elsewhere = dict(line.split("\t", 1) for line in there.stdout.splitlines() if "\t" in line)
    for problem, bits in first_answers(planner, settings):
        same = elsewhere.get(problem) == bits
        yield Finding(
            problem,
            "another process",
            same,
            "" if same else "another plan there; hash(), id() and the order of a set differ",
        )


def first_answers(planner: str, settings: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Each problem with a digest of a planner's plan from the first generator; of its exception, if
    it raises one.
    """
    module = interface.loaded(planner, planner)
    for problem in _problems(module):
        try:
            with (
                watchdog.watching(LIMIT) as watch,
                watchdog.executing(f"{planner}: {problem.name}", watch),
            ):
                found = repr(_bits(module.plan(problem, np.random.default_rng(0), **settings)))
        except watchdog.PlannerFailure as failure:
            found = type(failure.__cause__).__name__
        yield problem.name, hashlib.sha256(found.encode()).hexdigest()


# --------------------------------------------------------------------------------------------------
# Before a planner is run: its module and its settings


def _loaded(planner: str) -> ModuleType:
    if not is_file(planner) and planner not in known_planners():
        raise Fault(
            f"{planner}: unknown planner, and not the path of a file that ends in "
            f".py{closest(planner, known_planners())}"
        )
    return interface.loaded(planner, planner)


def _check_settings(module: ModuleType, settings: dict[str, Any], planner: str) -> list[Finding]:
    """Findings from the check of settings: whether the planner's own check, if any, leaves them
    unchanged. Raises Fault.
    """
    interface.refuse_unknown(module, settings, f"{planner}: settings")
    interface.check_settings(module, settings, f"{planner}: settings")
    if not hasattr(module, "check"):
        return []
    handed = dict(settings)
    module.check(handed)
    return [
        Finding(
            "any problem",
            "settings unchanged",
            handed == settings,
            "" if handed == settings else "check(settings) changes them",
        )
    ]


# --------------------------------------------------------------------------------------------------
# The problems

_IN_THE_WAY = "obstacle in the way"
_SAME = "start is target"
_BESIDE = "target beside start"
_SEALED = "sealed target"
_ON_BOUNDARY = "start on a boundary"
_FAR = "far from the origin"

# Rows from the top; S start, T target, B both. Start and target are cell centres, the only places
# that grid planners support; so no start lies on a boundary.
_GRIDS = {
    "open": ("......", ".S..T.", "..#...", "......"),
    _IN_THE_WAY: ("......", ".S#.T.", "..#...", "......"),
    _SAME: ("......", "..B#..", "......"),
    _BESIDE: ("......", ".ST#..", "......"),
    _SEALED: ("...###", ".S.#T#", "...###"),
    "no obstacles": ("......", ".S..T.", "......"),
    "3 x 5": ("..#..", "S.#.T", "....."),
    _FAR: ("......", "..#...", ".S#.T.", "......"),
}
# The grid of a map file begins at the origin; only large cells can extend far from it.
_LARGE_CELL = 15_000.0

# The other workspaces are this field, shifted for the problem far from the origin.
_FIELD = (0.0, 10.0, 0.0, 10.0)
_MOVED = (90_000.0, -70_000.0)

_ENDS = {
    "open": ((1.0, 5.0), (9.0, 5.0)),
    _IN_THE_WAY: ((1.0, 5.0), (9.0, 5.0)),
    _SAME: ((1.0, 5.0), (1.0, 5.0)),
    _BESIDE: ((1.0, 5.0), (1.001, 5.0)),
    _SEALED: ((1.0, 5.0), (7.0, 5.0)),
    _ON_BOUNDARY: ((3.0, 5.0), (9.0, 5.0)),
    "no obstacles": ((1.0, 5.0), (9.0, 5.0)),
    _FAR: ((1.0, 5.0), (9.0, 5.0)),
}

_EIGHTHS = np.arange(8) * math.tau / 8
_DISC = np.array([[5.0, 5.0, 2.0]])
_RING = np.column_stack([7 + 2 * np.cos(_EIGHTHS), 5 + 2 * np.sin(_EIGHTHS), np.ones(8)])
_CIRCLES = {"open": np.array([[5.0, 8.0, 1.0]]), _SEALED: _RING, "no obstacles": np.empty((0, 3))}


def _box(middle: tuple[float, float], half: float) -> np.ndarray:
    return np.array(middle) + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])


_BLOCK = ((_box((5, 5), 2),),)
_POLYGONS = {
    "open": ((_box((5, 8), 1),),),
    _SEALED: ((_box((7, 5), 2), _box((7, 5), 1)),),
    "no obstacles": (),
}


def _grid_problems() -> Iterator[Problem]:
    for title, rows in _GRIDS.items():
        text = "".join(reversed(rows))
        start, target = (
            next(cell for cell, mark in enumerate(text) if mark in end) for end in ("SB", "TB")
        )
        lines = ["".join("#" if mark == "#" else "." for mark in row) for row in rows]
        workspace = grid.from_lines(lines, _LARGE_CELL if title == _FAR else 1.0, _UNIT)
        yield Problem(
            f"grid: {title}", workspace, workspace.centre(start), workspace.centre(target)
        )


def _circle_problems() -> Iterator[Problem]:
    for title in _ENDS:
        circles = _CIRCLES.get(title, _DISC)
        move = _move(title)
        yield _moved(
            f"circles: {title}",
            title,
            Circles(_bounds(move), circles[:, :2] + move, circles[:, 2].copy(), _UNIT),
        )


def _polygon_problems() -> Iterator[Problem]:
    for title in _ENDS:
        move = _move(title)
        obstacles = tuple(
            tuple(ring + move for ring in rings) for rings in _POLYGONS.get(title, _BLOCK)
        )
        yield _moved(f"polygons: {title}", title, Polygons(_bounds(move), obstacles, _UNIT))


def _move(title: str) -> np.ndarray:
    return np.array(_MOVED if title == _FAR else (0.0, 0.0))


def _bounds(move: np.ndarray) -> tuple[float, float, float, float]:
    x_low, x_high, y_low, y_high = (np.array(_FIELD) + np.repeat(move, 2)).tolist()
    return x_low, x_high, y_low, y_high


def _moved(name: str, title: str, workspace: Workspace) -> Problem:
    start, target = (tuple((np.array(end) + _move(title)).tolist()) for end in _ENDS[title])
    return Problem(name, workspace, start, target)


PROBLEMS = {"grid": _grid_problems, "circles": _circle_problems, "polygons": _polygon_problems}
"""The problems of a kind of workspace, small ones, as an iterator that makes them anew."""


# --------------------------------------------------------------------------------------------------
# Runs. Only numpy's legacy functions, which ruff (NPY002) warns about, give access to the state of
# its global generator.


class _Run(NamedTuple):
    """plan: the answer. used: global generators whose state changed. changed: whether the planner
    altered the problem. rng: the state of its own generator afterwards; None if nothing was drawn.
    """

    plan: Any
    used: list[str]
    changed: bool
    rng: str | None


class _Case(NamedTuple):
    """A planner's plans for one problem, all of them valid.

    blocked: the region of the problem. plans: one per generator. again: the first of them
    reproduced. reseeded: likewise, with the global generators in another state. runs: all of these.
    columns: names of extra columns on the first problem. exact, keeps_best: what the planner
    declares.
    """

    problem: Problem
    blocked: Region
    settings: dict[str, Any]
    plans: list[Plan]
    again: Plan
    reseeded: Plan
    runs: list[_Run]
    columns: set[str]
    exact: bool
    keeps_best: bool


def _findings(module: ModuleType, settings: dict[str, Any]) -> Iterator[Finding]:
    columns = None
    differ, drawn, sound = [], False, True
    for problem in _problems(module):
        blocked = region(problem.workspace)
        runs, fault = _runs(module, problem, settings)
        yield Finding(problem.name, "plan", not fault, fault)
        if fault == watchdog.LEFT:
            return  # later runs may wait for what has been ended
        if fault:
            continue
        plan, again, reseeded, *others = (run.plan for run in runs)
        columns = set(plan.extra) if columns is None else columns
        declared = getattr(module, "exact", False), getattr(module, "keeps_best", True)
        case = _Case(
            problem, blocked, settings, [plan, *others], again, reseeded, runs, columns, *declared
        )
        for name, fact in _FACTS.items():
            finding = Finding(problem.name, name, *fact(case))
            sound = sound and finding.passed
            yield finding
        if problem.name.endswith(_SEALED):
            yield Finding(problem.name, "no way", *_finds_no_way(case))
        differ.append(next((field for other in others if (field := _difference(plan, other))), ""))
        left = [run.rng for run in (runs[0], *runs[3:])]
        drawn = drawn or (None not in left and len({*left}) == len(left))
    # One that has another fault, such as to draw from a global generator, is not blamed twice.
    if differ and sound:
        yield Finding(
            "all problems",
            "generators",
            *_heeds_generators(differ, drawn, getattr(module, "deterministic", False)),
        )


def _problems(module: ModuleType) -> Iterator[Problem]:
    for kind in getattr(module, "workspaces", PROBLEMS):
        yield from PROBLEMS[kind]()


def _heeds_generators(differ: list[str], drawn: bool, deterministic: bool) -> tuple[bool, str]:
    """differ: for each problem the first field in which plans of different generators differ; empty
    if none does. drawn: whether on some problem all generators were drawn from and left in
    different states: then the plans may be the same because the problems are easy.
    """
    field = next(filter(None, differ), "")
    if deterministic:
        return (
            not field,
            f"{field}: another value from another generator, but deterministic = True"
            if field
            else "",
        )
    return (
        drawn or bool(field),
        ""
        if drawn or field
        else "the same plans from every generator; draw from rng as it comes, or say "
        "deterministic = True",
    )


def _runs(module: ModuleType, problem: Problem, settings: dict[str, Any]) -> tuple[list[_Run], str]:
    """Runs in the order that `_findings` expects, or the fault that left none to inspect."""
    runs = []
    for seed, surroundings in [
        (0, 0),
        (0, 0),
        (0, 1),
        *((seed, 0) for seed in range(1, _GENERATORS)),
    ]:
        name = f"planner {module.__spec__.origin}: {problem.name}"
        try:
            with (
                watchdog.watching(LIMIT) as watch,
                watchdog.executing(name, watch),
                left_alone(name),
            ):
                runs.append(_run(module, problem, settings, seed, surroundings))
        except watchdog.PlannerFailure as failure:
            cause = failure.__cause__
            return [], f"raises {told(cause)}" if cause else str(failure).removeprefix(f"{name}: ")
        try:
            runs[-1] = runs[-1]._replace(plan=answer.plain(runs[-1].plan))
        except answer.Unfit as fault:
            return [], str(fault)
    return runs, ""


def _run(
    module: ModuleType, problem: Problem, settings: dict[str, Any], seed: int, surroundings: int
) -> _Run:
    """One run on a copy of a problem, as the workflow makes it. surroundings: seed of the global
    generators, whose state is restored afterwards.
    """
    loan = lend({problem.name: problem})[problem.name]
    kept = np.random.get_state(), random.getstate()  # noqa: NPY002
    try:
        np.random.seed(surroundings)  # noqa: NPY002
        random.seed(surroundings)
        _seed_compiled(surroundings)
        before = _global_states()
        rng = np.random.default_rng(seed)
        fresh = _state(rng)
        plan = module.plan(loan.problem, rng, **settings)
        used = [name for name, state in _global_states().items() if state != before[name]]
    finally:
        np.random.set_state(kept[0])  # noqa: NPY002
        random.setstate(kept[1])
    left = _state(rng)
    return _Run(plan, used, bool(loan.thorough_fault()), None if left == fresh else left)


def _state(rng: np.random.Generator) -> str:
    """What tells whether a generator was drawn from or split."""
    return f"{rng.bit_generator.state} {rng.bit_generator.seed_seq.n_children_spawned}"


def _global_states() -> dict[str, tuple]:
    name, keys, *rest = np.random.get_state()  # noqa: NPY002
    return {"numpy.random": (name, keys.tobytes(), *rest), "random": random.getstate()}


@allocation_free
def _seed_compiled(seed: int) -> None:
    """Seed the global generators of compiled code, which numba keeps apart from Python's. Their
    state cannot be read.
    """
    np.random.seed(seed)  # noqa: NPY002
    random.seed(seed)


# --------------------------------------------------------------------------------------------------
# Facts: each returns whether it holds for a case, and a detail


def _has_its_ends(case: _Case) -> tuple[bool, str]:
    for plan in case.plans:
        try:
            answer.check_ends(plan, case.problem)
        except answer.Unfit as fault:
            return False, str(fault)
    found = sum(plan.path is not None for plan in case.plans)
    return True, f"{found} paths of {len(case.plans)} plans"


def _history_falls(case: _Case) -> tuple[bool, str]:
    for plan in case.plans:
        # Written so that NaN fails as well.
        if not (plan.history[1:] <= plan.history[:-1]).all():
            return False, "rises; expected the best objective so far"
        if (
            plan.path is not None
            and plan.history[-1] != plan.objective
            and (case.keeps_best or plan.history[-1] > plan.objective)
        ):
            return False, f"ends with {plan.history[-1]}; expected the objective, {plan.objective}"
    return True, ""


def _extra_is_free(case: _Case) -> tuple[bool, str]:
    for plan in case.plans:
        try:
            answer.plain(plan, {*TAKEN, *case.settings})
        except answer.Unfit as fault:
            return False, str(fault)
        if plan.extra.keys() != case.columns:
            return (
                False,
                f"{min(plan.extra.keys() ^ case.columns)}: not in every plan; a table needs the "
                "same columns in each row",
            )
    return True, ""


def _repeats(case: _Case) -> tuple[bool, str]:
    different = _difference(case.plans[0], case.again)
    return not different, f"{different}: another value from the same generator" if different else ""


def _draws_from_its_own(case: _Case) -> tuple[bool, str]:
    """A result that no rerun would reproduce is not blamed on the global generators."""
    used = next((run.used for run in case.runs if run.used), [])
    if used:
        return False, f"uses {' and '.join(used)}; expected rng alone"
    different = _difference(case.plans[0], case.reseeded)
    if different and not _difference(case.plans[0], case.again):
        return False, f"{different}: depends on a global generator; expected rng alone"
    return True, ""


def _leaves_problem(case: _Case) -> tuple[bool, str]:
    changed = any(run.changed for run in case.runs)
    return (
        not changed,
        "the problem is another after the run; copy what is to be changed" if changed else "",
    )


def _keeps_budget(case: _Case) -> tuple[bool, str]:
    """The number of evaluations may differ from generator to generator: a search may end early."""
    used = sorted(int(plan.evaluations) for plan in case.plans)
    budget = case.settings.get("evaluations", math.inf)
    if used[-1] > budget:
        return False, f"{used[-1]} evaluations; expected at most {budget}"
    for plan in case.plans:
        if len(plan.history) > plan.evaluations:
            return (
                False,
                f"a history of {len(plan.history)} values from {plan.evaluations} evaluations",
            )
    return True, f"{used[0]} evaluations" if used[0] == used[
        -1
    ] else f"{used[0]} to {used[-1]} evaluations"


def _claims_hold(case: _Case) -> tuple[bool, str]:
    """Only a planner that declares itself exact can fail."""
    claims = [plan for plan in case.plans if plan.claimed_feasible]
    agreed = _feasible(claims, case.blocked)
    return agreed == len(
        claims
    ) or not case.exact, f"{len(claims)} paths claimed feasible, {agreed} by the checker"


def _finds_no_way(case: _Case) -> tuple[bool, str]:
    feasible = _feasible(case.plans, case.blocked)
    return not feasible, "a feasible path to a sealed target" if feasible else ""


def _feasible(plans: list[Plan], blocked: Region) -> int:
    """Number of plans whose path the checker accepts as feasible."""
    return sum(
        plan.path is not None and checker.check(curves.bezier_pieces(plan.path), blocked).feasible
        for plan in plans
    )


def _difference(one: Plan, other: Plan) -> str:
    """The first field in which two plans differ bitwise; empty if there is none."""
    bits = zip(_bits(one).items(), _bits(other).values(), strict=True)
    return next((field for (field, value), counterpart in bits if value != counterpart), "")


def _bits(plan: Plan) -> dict[str, Any]:
    """The fields of a plan as values that are equal exactly when their bits are."""
    return {
        "path": plan.path and (plan.path.curve, plan.path.points.shape, plan.path.points.tobytes()),
        "objective": np.float64(plan.objective).tobytes(),
        "claimed_feasible": bool(plan.claimed_feasible),
        "evaluations": int(plan.evaluations),
        "history": plan.history.tobytes(),
        "stop": plan.stop,
        "extra": {name: np.float64(value).tobytes() for name, value in plan.extra.items()},
    }


_FACTS = {
    "path": _has_its_ends,
    "history": _history_falls,
    "extra columns": _extra_is_free,
    "same bits": _repeats,
    "global generators": _draws_from_its_own,
    "problem unchanged": _leaves_problem,
    "budget": _keeps_budget,
    "claims": _claims_hold,
}


if __name__ == "__main__":
    for answered in first_answers(sys.argv[1], json.loads(sys.argv[2])):
        print(*answered, sep="\t")
