"""Contract tests for a planner, from this package or your own: the requirements of `planners`, as
six facts on eight small and degenerate problems.

Every setting of a planner needs a value. The planner counts its own budget: the tests check its
count, not its actual work.
"""

import math
import random
from collections.abc import Callable, Iterator
from itertools import cycle
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.geometry.region import region
from bezierplan.kernels import allocation_free
from bezierplan.planners import Plan, is_file, known_planners, planner_module
from bezierplan.running.columns import TAKEN
from bezierplan.running.guard import interface, process, worker
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.running.judge import answer
from bezierplan.schema.checked import Fault, closest
from bezierplan.schema.words import told
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

LIMIT = 600.0
"""Seconds that one plan may take, compilation included."""

SEEDS = (0, 0, 1, 2)
"""Of the generators of a problem's runs. Before each, the global generators get another state."""

SEALED = "sealed target"

# Rows from the top; S start, T target, B both, each in the middle of its cell.
_PICTURES = {
    "open": ("......", ".S..T.", "..#...", "......"),
    "obstacle in the way": ("......", ".S#.T.", "..#...", "......"),
    "start is target": ("......", "..B#..", "......"),
    "target beside start": ("......", ".ST#..", "......"),
    SEALED: ("...###", ".S.#T#", "...###"),
    "no obstacles": ("......", ".S..T.", "......"),
    "narrow": ("..#..", "S.#.T", "....."),
    "far from the origin": ("......", "..#...", ".S#.T.", "......"),
}
_CELLS = {"far from the origin": 1_500.0}
# Half the side of a square, and the radius of a disc, in place of an occupied cell of side 1: next
# to each other they overlap.
_HALF = 0.55


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


def check_planner(
    planner: str, settings: dict[str, Any], elsewhere: bool = True
) -> Iterator[Finding]:
    """Findings on a planner, given as a name or the path of a file, with these settings; computed
    lazily. elsewhere: whether it is run in another process as well, where `hash`, the order of sets
    and the addresses of objects differ.

    Raises Fault, in one line, before the first finding: for a file that is not a planner, and for
    missing or invalid settings.
    """
    if not is_file(planner) and planner not in known_planners():
        raise Fault(
            f"{planner}: unknown planner, and not the path of a file that ends in "
            f".py{closest(planner, known_planners())}"
        )
    module = interface.loaded(planner, planner)
    interface.refuse_unknown(module, settings, f"{planner}: settings")
    interface.check_settings(module, settings, f"{planner}: settings")
    return _findings(planner, module, settings, elsewhere)


# --------------------------------------------------------------------------------------------------
# The problems


def problems(module: ModuleType) -> Iterator[Problem]:
    """The problems of a planner, on the kinds of workspace that it serves in turn."""
    kinds = cycle(getattr(module, "workspaces", interface.KINDS.values()))
    for (title, rows), kind in zip(_PICTURES.items(), kinds):
        yield drawn_problem(kind, title, rows)


def drawn_problem(kind: str, title: str, rows: tuple[str, ...]) -> Problem:
    """A picture as a problem on a kind of workspace."""
    cell = _CELLS.get(title, 1.0)
    lines = ["".join("#" if mark == "#" else "." for mark in row) for row in rows]
    home = from_lines(lines, cell, "unit")
    text = "".join(reversed(rows))
    start, target = (
        home.centre(next(n for n, mark in enumerate(text) if mark in end)) for end in ("SB", "TB")
    )
    middles = np.array([home.centre(n) for n, mark in enumerate(text) if mark == "#"])
    middles, half = middles.reshape(-1, 2), _HALF * cell
    around = half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    made: dict[str, Workspace] = {
        "grid": home,
        "circles": Circles(home.bounds, middles, np.full(len(middles), half), "unit"),
        "polygons": Polygons(home.bounds, tuple((at + around,) for at in middles), "unit"),
    }
    return Problem(f"{kind}: {title}", made[kind], start, target)


# --------------------------------------------------------------------------------------------------
# Runs


def answered(
    begin: Callable[[str], None], planner: str, settings: dict[str, Any], seeds: list[int]
) -> Iterator[list[Any]]:
    """For each problem: its runs, or what is wrong with one of them, and whether the problem is
    another afterwards. A run is a plan as plain values, and the state of its generator if that was
    drawn from or split.
    """
    module = planner_module(planner)
    for problem in problems(module):
        before, runs = worker.packed_problems({"": problem}), []
        for surroundings, seed in enumerate(seeds):
            begin(f"planner {planner}: {problem.name}")
            _seed(surroundings)
            rng = np.random.default_rng(seed)
            fresh = _state(rng)
            try:
                plan = answer.plain(module.plan(problem, rng, **settings))
            except answer.Unfit as fault:
                runs = str(fault)
                break
            except Exception as error:
                runs = f"raises {told(error)}"
                break
            state = _state(rng)
            runs.append([answer.packed(plan), None if state == fresh else state])
        yield [runs, worker.packed_problems({"": problem}) != before]


def _state(rng: np.random.Generator) -> str:
    return f"{rng.bit_generator.state} {rng.bit_generator.seed_seq.n_children_spawned}"


def _seed(seed: int) -> None:
    """Seed the global generators, those of compiled code too, which numba keeps apart."""
    np.random.seed(seed)  # noqa: NPY002
    random.seed(seed)
    _seed_compiled(seed)


@allocation_free
def _seed_compiled(seed: int) -> None:
    np.random.seed(seed)  # noqa: NPY002
    random.seed(seed)


def _elsewhere(
    planner: str, settings: dict[str, Any], seeds: tuple[int, ...], hashing: int
) -> list[list[Any]]:
    """`answered` in a process of its own. Raises PlannerFailure."""
    file = str(Path(planner).resolve()) if is_file(planner) else planner
    given = {"planner": file, "settings": settings, "seeds": seeds}
    return process.answers("guard.contract.answered", given, f"planner {planner}", LIMIT, hashing)


# --------------------------------------------------------------------------------------------------
# Facts


def _findings(
    planner: str, module: ModuleType, settings: dict[str, Any], elsewhere: bool
) -> Iterator[Finding]:
    try:
        cases = (
            _elsewhere(planner, settings, SEEDS, 0)
            if is_file(planner)
            else answered(lambda name: None, planner, settings, list(SEEDS))
        )
        again = _elsewhere(planner, settings, SEEDS[:1], 1) if elsewhere else []
    except PlannerFailure as failure:
        yield Finding("all problems", "plan", False, str(failure))
        return
    columns, differ, drawn = None, False, False
    for number, (problem, (runs, changed)) in enumerate(zip(problems(module), cases)):
        yield Finding(
            problem.name,
            "problem unchanged",
            not changed,
            "the problem is another after the run; copy what is to be changed" if changed else "",
        )
        if isinstance(runs, str):
            yield Finding(problem.name, "plan", False, runs)
            continue
        plans = [answer.unpacked(plan) for plan, _ in runs]
        columns = plans[0].extra.keys() if columns is None else columns
        for fact, detail, fault in (
            ("plan", *_is_valid(plans, problem, {*TAKEN, *settings}, columns)),
            ("history", "", _history_fault(plans, getattr(module, "keeps_best", True))),
            ("budget", *_budget(plans, settings.get("evaluations", math.inf))),
            ("claims", *_claims(plans, problem, getattr(module, "exact", False))),
            ("random numbers", "", _repeats(runs, again[number : number + 1])),
        ):
            yield Finding(problem.name, fact, not fault, fault or detail)
        bits, states = [repr(plan) for plan, _ in runs[1:]], [state for _, state in runs[1:]]
        differ = differ or len({*bits}) > 1
        # If all are left in different states, the plans may be the same because all are easy.
        drawn = drawn or (None not in states and len({*states}) == len(states))
    if columns is not None:
        fault = (
            ""
            if differ or drawn
            else "the same plans from every generator; draw from rng as it "
            "comes, or say deterministic = True"
        )
        if getattr(module, "deterministic", False):
            fault = "other plans from other generators, but deterministic = True" if differ else ""
        yield Finding("all problems", "random numbers", not fault, fault)


def _is_valid(
    plans: list[Plan], problem: Problem, taken: set[str], columns: Any
) -> tuple[str, str]:
    for plan in plans:
        try:
            answer.accepted(plan, problem, taken)
        except answer.Unfit as fault:
            return "", str(fault)
        if plan.extra.keys() != columns:
            return "", (
                f"extra: {min(plan.extra.keys() ^ columns)}: not in every plan; a table needs the "
                "same columns in each row"
            )
    return f"{sum(plan.path is not None for plan in plans)} paths of {len(plans)} plans", ""


def _history_fault(plans: list[Plan], keeps_best: bool) -> str:
    for plan in plans:
        if (plan.history[1:] > plan.history[:-1]).any():
            return "rises; expected the best objective so far"
        last = plan.history[-1]
        if (
            plan.path is not None
            and last != plan.objective
            and (keeps_best or last > plan.objective)
        ):
            return f"ends with {last}; expected the objective, {plan.objective}"
    return ""


def _budget(plans: list[Plan], budget: float) -> tuple[str, str]:
    """The number of evaluations may differ from generator to generator: a search may end early."""
    used = sorted({plan.evaluations for plan in plans})
    if used[-1] > budget:
        return "", f"{used[-1]} evaluations; expected at most {budget}"
    for plan in plans:
        if len(plan.history) > plan.evaluations:
            return "", (
                f"a history of {len(plan.history)} values from {plan.evaluations} evaluations"
            )
    return " to ".join(map(str, dict.fromkeys((used[0], used[-1])))) + " evaluations", ""


def _claims(plans: list[Plan], problem: Problem, exact: bool) -> tuple[str, str]:
    """Only a planner that declares itself exact can fail for its claims; no way leads to a sealed
    target.
    """
    blocked = region(problem.workspace)
    feasible = [
        plan.path is not None and checker.check(curves.bezier_pieces(plan.path), blocked).feasible
        for plan in plans
    ]
    claims = [right for plan, right in zip(plans, feasible) if plan.claimed_feasible]
    detail = f"{len(claims)} paths claimed feasible, {sum(claims)} by the checker"
    if problem.name.endswith(SEALED) and any(feasible):
        return detail, "a feasible path to a sealed target"
    return detail, detail if exact and not all(claims) else ""


def _repeats(runs: list[list[Any]], elsewhere: list[list[Any]]) -> str:
    """What is wrong if runs with the same generator do not have the same bits."""
    (plan, _), (again, _), *_ = runs
    if repr(again) != repr(plan):
        field = next(name for name in plan if repr(plan[name]) != repr(again[name]))
        return (
            f"{field}: another value from the same generator; all random numbers come from rng, "
            "and nothing from a clock or an earlier run"
        )
    for there, _ in elsewhere:
        if isinstance(there, str) or repr(there[0][0]) != repr(plan):
            return "another plan in another process; hash(), id() and the order of a set differ"
    return ""
