"""Contract tests for a planner, from this package or your own: the requirements of `planners`, as
five facts on eight small and degenerate problems.

Every setting of a planner needs a value. The planner counts its own budget: the tests check its
count, not its actual work.
"""

import math
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import chain, cycle
from types import ModuleType
from typing import NamedTuple

import numpy as np

from bezierplan.geometry import checker, curves
from bezierplan.geometry.region import build_region
from bezierplan.planners import Plan, is_file, list_planners
from bezierplan.running import answer
from bezierplan.running.chunk import Settings
from bezierplan.running.columns import TAKEN
from bezierplan.running.guard import interface, plain_values, process, worker
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.schema.checked import Fault, describe_known
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import from_lines
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

LIMIT = 600.0
"""Seconds that one plan may take, compiling included."""

SEEDS = (0, 0, 1, 2)
"""Seeds of a problem's runs; the first two are equal, so their plans must be."""

SEALED = "sealed target"

ELSEWHERE = "another plan in another process; hash(), id() and the order of a set differ"

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


class ContractFinding(NamedTuple):
    """The result of one test of the contract on one problem.

    detail: the fault if it failed, otherwise additional information.
    """

    problem: str
    fact: str
    passed: bool
    detail: str

    def __str__(self) -> str:
        verdict = "ok" if self.passed else "FAILED"
        return f"{verdict:8}{self.problem:40}{self.fact:20}{self.detail}".rstrip()


def check_planner(planner: str, settings: Settings) -> Iterator[ContractFinding]:
    """Test a planner, given as a name or the path of a file, with these settings; yield a finding
    for each fact and problem.

    A planner's file also runs in another process, where `hash`, the order of sets and the addresses
    of objects differ. Raises Fault, in one line, before the first finding: for a file that is not a
    planner, and for missing or invalid settings.
    """
    if not is_file(planner) and planner not in list_planners():
        raise Fault(
            f"{planner}: unknown planner, and not the path of a file that ends in "
            f".py{describe_known(planner, list_planners())}"
        )
    module = interface.load_planner_module(planner, planner)
    interface.refuse_unknown(module, settings, f"{planner}: settings")
    interface.check_settings(module, settings, f"{planner}: settings")
    # A generator of its own, so that the faults above come before the first finding is asked for.
    return _find_faults(planner, module, settings)


# --------------------------------------------------------------------------------------------------
# The problems


def list_problems(module: ModuleType) -> Iterator[Problem]:
    """Yield the problems for a planner, on the kinds of workspace that it serves in turn."""
    kinds = cycle(getattr(module, "workspaces", interface.KINDS.values()))
    for (title, rows), kind in zip(_PICTURES.items(), kinds):
        yield build_drawn_problem(kind, title, rows)


def build_drawn_problem(kind: str, title: str, rows: tuple[str, ...]) -> Problem:
    """Build a problem on a kind of workspace from a picture (`_PICTURES`)."""
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
# Facts


def _find_faults(planner: str, module: ModuleType, settings: Settings) -> Iterator[ContractFinding]:
    """Yield the findings of `check_planner`."""
    by_name = {problem.name: problem for problem in list_problems(module)}
    keeps_best, budget = getattr(module, "keeps_best", True), settings.get("evaluations", math.inf)
    exact, names = getattr(module, "exact", False), {*TAKEN, *settings}
    plans_of: dict[str, list[Plan]] = {}
    draws, paths, free = False, 0, 0
    first, *others = by_name
    # The first problem alone, so that a slow planner's first findings appear early.
    tried = (_run_on_each(planner, settings, few, by_name) for few in ([first], others))
    for name, made in chain.from_iterable(tried):
        if isinstance(made, PlannerFailure):
            yield ContractFinding(name, "plan", False, str(made).splitlines()[0])
            continue
        problem, plans = by_name[name], [each.result for each in made]
        plans_of[name] = plans
        draws |= any(each.drew for each in made)
        first = next(iter(plans_of.values()))[0]
        feasible = _find_free(plans, problem)
        paths += sum(plan.path is not None for plan in plans)
        free += sum(feasible)
        facts = {
            "plan": partial(_check_plans, plans, problem, names, first, is_file(planner)),
            "history": partial(_check_history, plans, keeps_best),
            "budget": partial(_check_budget, plans, budget),
            "claims": partial(_check_claims, plans, feasible, problem, exact),
        }
        for fact, check in facts.items():
            try:
                yield ContractFinding(name, fact, True, check())
            except answer.Unfit as fault:
                yield ContractFinding(name, fact, False, str(fault))
        differs = _compare_repeats(plans[0], plans[1])
        yield ContractFinding(name, "random numbers", not differs, differs)
    if not plans_of:
        return
    if paths and not free:
        # Other units than the map's, or x and y interchanged, show in nothing else.
        lost = f"none of {paths} paths is free; expected points x, y in the map's units"
        yield ContractFinding("all problems", "paths", False, lost)
    # A planner of this package runs in this process alone.
    if is_file(planner):
        met = {name: by_name[name] for name in plans_of}
        for name, (there,) in run_planner(planner, settings, met, SEEDS[:1], 1).items():
            one, again, *_ = plans_of[name]
            if not _compare_repeats(one, again) and _compare_repeats(one, there.result):
                yield ContractFinding(name, "random numbers", False, ELSEWHERE)
    differ = any(len({*map(repr, plans[1:])}) > 1 for plans in plans_of.values())
    if getattr(module, "deterministic", False):
        said = "other plans from other generators, but deterministic = True" if differ else ""
        passed = not differ
    else:
        said, passed = "" if differ else worker.ALIKE[draws], draws or differ
    yield ContractFinding("all problems", "random numbers", passed, said)


def _run_on_each(
    planner: str, settings: Settings, names: Sequence[str], by_name: dict[str, Problem]
) -> Iterator[tuple[str, list[worker.Reply] | PlannerFailure]]:
    """Yield the replies of a planner on each of the named problems, or its failure there: from one
    process, which takes a second to start, or one a problem if any fails.
    """
    try:
        few = {name: by_name[name] for name in names}
        yield from run_planner(planner, settings, few, SEEDS).items()
    except PlannerFailure as failure:
        if len(names) == 1:
            yield names[0], failure
            return
        for name in names:
            yield from _run_on_each(planner, settings, [name], by_name)


def run_planner(
    planner: str,
    settings: Settings,
    by_name: dict[str, Problem],
    seeds: Sequence[int],
    hashing: int = 0,
) -> dict[str, list[worker.Reply]]:
    """Run a planner on problems, once with each seed; return its replies by problem. Raises
    PlannerFailure.

    hashing: the seed of `hash` in the separate process of a planner's file.
    """
    name, work = f"planner {planner}", worker.Work(planner, by_name)
    tasks = [worker.Task(f"{name}: {at}", at, seed, settings) for at in by_name for seed in seeds]
    by_problem: dict[str, list[worker.Reply]] = {}
    for reply in (
        process.run_isolated(work, tasks, (), name, LIMIT, hashing)
        if is_file(planner)
        else worker.run_tasks(work, tasks)
    ):
        task = tasks[reply.number]
        with answer.wrap_errors(task.name):
            plan = answer.convert_answer(reply.result)
            by_problem.setdefault(task.problem, []).append(reply._replace(result=plan))
    return by_problem


# The checks of a fact return a detail on plans, and raise Unfit for the first fault.


def _check_plans(
    plans: list[Plan], problem: Problem, names: set[str], first: Plan, finite: bool
) -> str:
    """Check that plans fit into the runs table; return as text how many have a path."""
    for plan in plans:
        answer.accept_answer(plan, problem, names)
        answer.check_columns(plan, first, finite)
    return f"{sum(plan.path is not None for plan in plans)} paths of {len(plans)} plans"


def _check_history(plans: list[Plan], keeps_best: bool) -> str:
    """Check the histories of plans; return an empty text, because there is nothing to report."""
    for plan in plans:
        answer.check_history(plan, keeps_best)
    return ""


def _check_budget(plans: list[Plan], budget: float) -> str:
    """Check that no plan has more evaluations than the budget, or a longer history than
    evaluations; return the range of evaluations as text.

    The evaluations may differ from seed to seed: a search may end early.
    """
    used = sorted({plan.evaluations for plan in plans})
    if used[-1] > budget:
        raise answer.Unfit(f"{used[-1]} evaluations; expected at most {budget}")
    for plan in plans:
        length = len(plan.history)
        if length > plan.evaluations:
            raise answer.Unfit(f"a history of {length} values from {plan.evaluations} evaluations")
    return " to ".join(map(str, dict.fromkeys((used[0], used[-1])))) + " evaluations"


def _check_claims(plans: list[Plan], feasible: list[bool], problem: Problem, exact: bool) -> str:
    """Check that no free path leads to a sealed target, and that each path which an exact planner
    claims feasible is so; return the counts as text.
    """
    claims = [right for plan, right in zip(plans, feasible) if plan.claimed_feasible]
    detail = f"{len(claims)} paths claimed feasible, {sum(claims)} by the checker"
    if problem.name.endswith(SEALED) and any(feasible):
        raise answer.Unfit("a feasible path to a sealed target")
    if exact and not all(claims):
        raise answer.Unfit(detail)
    return detail


def _find_free(plans: list[Plan], problem: Problem) -> list[bool]:
    """Return for each plan whether the checker finds a path that is free."""
    blocked = build_region(problem.workspace)
    return [
        plan.path is not None and checker.check(curves.bezier_pieces(plan.path), blocked).feasible
        for plan in plans
    ]


def _compare_repeats(first: Plan, again: Plan) -> str:
    """Describe the first field in which two runs with the same seed differ in any bit; empty if
    none does.
    """
    one, other = ([*map(repr, plain_values.pack(plan)["Plan"])] for plan in (first, again))
    field = next((name for name, *two in zip(Plan._fields, one, other) if two[0] != two[1]), "")
    return field and (
        f"{field}: another value from the same generator; all random numbers come from rng, and "
        "nothing from a clock or an earlier run"
    )
