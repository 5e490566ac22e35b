"""Planners of OMPL beside those of the studies and the baseline `rounded`, on problems of the
studies: the second part of `make compare`.

How close the best path comes to the exact shortest one, against the CPU time of one core, for 50
seeds. Only paths that the certified checker accepts count, whatever their planner says of them.
Budgets double from one attempt to the next, so times are known to a factor of two:

* PRM*, BIT* and Informed RRT*, with OMPL's defaults, are interrupted after times that double, and
  the path of each time is simplified by OMPL's simplifier. The shorter of both counts. A
  simplification is charged to its own path only, as in a run that ends there. Their test of a
  motion is exact (`ompl_planners`) but called in Python: a program in C++ would take less time than
  is stated here.
* A study's planners run anew for each number of generations, with the same seed. The best of all
  budgets so far counts, for some keep no best path. Settings are those of the study; tharwat2018's
  swarm has those of its profile `tuned`, and never stops early.
* `rounded` knows the exact shortest path and rounds its corners; its CPU time includes that of
  finding the shortest path.

Compilation is charged to nobody. Lengths of unlike paths are compared: OMPL's are polylines, at
whose corners a robot has to stop; so are those of meledje and of song2016's non-smooth method. All
others have continuous tangents, for which they must swing out, and those of one Bézier curve
continuous curvature as well. So OMPL solves an easier problem.

Writes planners.csv (each path), planners_times.csv (the table), planners.svg and planners.png into
results/comparison.
"""

import sys
import time
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path as File
from types import MappingProxyType
from typing import Any, NamedTuple

sys.path.insert(0, str(File(__file__).resolve().parents[2] / "src"))

import matplotlib as mpl
import numpy as np
import pandas as pd
from anytime import QUARTILES, quartiles, time_table
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezierplan.figures import sheet, style
from bezierplan.geometry import checker, curves, shortest_paths
from bezierplan.geometry.region import Region, region
from bezierplan.planners import planner_module
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Condition
from bezierplan.study import jobs, reading
from bezierplan.study.definition import Study
from bezierplan.workspaces.problem import Path, Problem

try:
    import ompl_planners
except ImportError as fault:
    sys.exit(
        f"compare_planners: OMPL cannot be imported here ({fault}); its wheels are for Linux and "
        "for macOS 15 or later on Apple silicon"
    )

ROOT = File(__file__).resolve().parents[2]
FOLDER = ROOT / "results" / "comparison"

SEEDS = 50
TIMES = 0.16 / 2.0 ** np.arange(7, -1, -1)  # seconds, at which OMPL is interrupted
WITHIN = (0.1, 0.05, 0.02, 0.01)
BASELINE = "rounded"


class Contest(NamedTuple):
    """A problem of a study with two of its planners.

    budget: the setting that says how long they search. shares: of the study's own budget. values:
    of the factors that the experiment varies. changes: other settings.
    """

    study: str
    experiment: str
    problem: str
    methods: tuple[str, str]
    budget: str
    shares: tuple[float, ...]
    values: Mapping[str, str] = MappingProxyType({})
    changes: Mapping[str, Any] = MappingProxyType({})


def doubling(first: float, last: float) -> tuple[float, ...]:
    """Powers of two from the first to the last."""
    return tuple(2.0 ** np.arange(np.log2(first), np.log2(last) + 1))


CONTESTS = (
    Contest(
        *(
            "tharwat2018",
            "maps",
            "public",
            ("pso", "cpso2_singer"),
            "iterations",
            doubling(1 / 8, 32),
        ),
        values={"profile": "tuned"},
        changes={"stall_limit": 0},
    ),
    Contest(
        "song2016", "routes", "15_240", ("nonsmooth", "smooth"), "generations", doubling(1 / 8, 4)
    ),
    Contest(
        "meledje",
        "operators",
        "env2_modified",
        ("random", "proposed"),
        "generations",
        doubling(1 / 8, 4),
    ),
    Contest(
        "ma2020",
        "environments",
        "environment2",
        ("bca", "bca_q"),
        "generations",
        doubling(1 / 8, 4),
    ),
    Contest("elhoseny2017", "maps", "hidden_u", ("mga", "mga_c"), "iterations", doubling(1 / 8, 1)),
)


class Arena(NamedTuple):
    """What a contest is about: its study, problem, blocked region, and the length of the exact
    shortest path, in units.
    """

    contest: Contest
    study: Study
    problem: Problem
    blocked: Region
    bound: float


def arena(contest: Contest) -> Arena:
    study = reading.load(reading.read_config({"studies": [contest.study]}))[contest.study]
    made = problems.build_all(jobs.problems_job(study, contest.experiment, "full"), study.folder)
    problem = made[contest.problem]
    return Arena(
        contest,
        study,
        problem,
        region(problem.workspace),
        shortest_paths.shortest_path(problem).length,
    )


def planned(
    at: Arena, method: str, shares: tuple[float, ...], seed: int
) -> Iterator[tuple[float, Path | None]]:
    """CPU seconds and path of a run of a study's method for each share of its own budget."""
    contest = at.contest
    job = jobs.job(at.study, contest.experiment, method, "full", 0)
    condition = Condition(contest.problem, dict(contest.values))
    settings = execution.settings_in(job, condition)
    planner = planner_module(job.planner)
    if contest.budget in settings:
        settings |= contest.changes
    for share in shares:
        longer = (
            {contest.budget: max(1, round(share * settings[contest.budget]))}
            if contest.budget in settings
            else {}
        )
        rng = execution.generator(job, condition, seed)
        before = time.process_time()
        plan = planner.plan(at.problem, rng, **settings | longer)
        yield time.process_time() - before, plan.path


def with_ompl(
    at: Arena, planner: str, is_free: ompl_planners.SegmentTest, seed: int
) -> Iterator[tuple[float, Path | None]]:
    """CPU seconds and path for each time at which a planner of OMPL is interrupted. Its random
    numbers are one stream for all seeds.
    """
    for seconds, points in ompl_planners.attempts(planner, at.problem, is_free, TIMES):
        yield seconds, None if points is None else Path("polyline", points)


def excess(at: Arena, path: Path | None) -> float:
    """Length of a path over the exact shortest one's, less 1; infinite unless it joins start and
    target and the checker accepts it.
    """
    if path is None:
        return np.inf
    pieces = curves.bezier_pieces(path)
    joins = (tuple(pieces[0, 0]), tuple(pieces[-1, -1])) == (at.problem.start, at.problem.target)
    return (
        curves.length(path) / at.bound - 1
        if joins and checker.check(pieces, at.blocked).feasible
        else np.inf
    )


def compete(at: Arena) -> pd.DataFrame:
    """Attempts of all planners on a problem, as `anytime` takes them, with columns study, problem,
    length (in units) and budget (share of the study's own; NaN for OMPL). Planners take turns, so
    that what else runs on the machine disturbs all alike.
    """
    contest = at.contest
    is_free = ompl_planners.segment_test(at.blocked)
    rivals = {
        at.study.labels[method]: (partial(planned, at, method, contest.shares), contest.shares)
        for method in contest.methods
    }
    rivals |= {name: (partial(with_ompl, at, name, is_free), ()) for name in ompl_planners.PLANNERS}
    rivals[at.study.labels[BASELINE]] = (partial(planned, at, BASELINE, (1.0,)), (1.0,))
    for run, _ in rivals.values():
        next(run(SEEDS), None)  # compiles
    rows = []
    for seed in range(SEEDS):
        for method, (run, shares) in rivals.items():
            for number, (seconds, path) in enumerate(run(seed)):
                budget = shares[number] if shares else np.nan
                rows.append(
                    {
                        "method": method,
                        "seed": seed,
                        "cpu_s": seconds,
                        "budget": budget,
                        "excess": excess(at, path),
                    }
                )
    attempts = pd.DataFrame(rows)
    attempts.insert(0, "problem", name_of(at))
    attempts["length"] = at.bound * (1 + attempts["excess"])
    return attempts


def name_of(at: Arena) -> str:
    return f"{at.contest.study}, {at.study.labels[at.contest.problem]}"


def draw(attempts: pd.DataFrame) -> Figure:
    """One panel for each problem, and the legend in the place of the last."""
    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(style.WIDE, 0.68 * style.WIDE), layout="constrained")
        panels = figure.subplots(2, 3, sharex=True, sharey=True)
        for number, (axes, (name, own)) in enumerate(
            zip(panels.flat, attempts.groupby("problem", sort=False))
        ):
            draw_problem(axes, own)
            axes.set_title(f"({'abcde'[number]}) {name}", loc="left")
        for axes in panels[:, 0]:
            axes.set_ylabel("length above the exact shortest path (%)")
        for axes in (*panels[1, :2], panels[0, 2]):
            axes.set_xlabel("CPU time (ms)")
            axes.tick_params(labelbottom=True)
        shared = dict(zip(*reversed(panels[0, 0].get_legend_handles_labels())))
        panels[1, 2].axis("off")
        panels[1, 2].legend(shared.values(), shared.keys(), loc="upper left", borderaxespad=0)
        panels[1, 2].text(
            0, 0, NOTE, transform=panels[1, 2].transAxes, va="bottom", linespacing=1.3
        )
    return figure


NOTE = f"""Lines: medians of {SEEDS} seeds; bands: quartiles.
A line begins where half of the seeds
have a path that the checker accepts.
OMPL's paths are polylines with corners."""


def draw_problem(axes: Axes, attempts: pd.DataFrame) -> None:
    """Curves of one problem's planners, those of the study named in the panel itself."""
    of_study = attempts.loc[attempts["budget"].notna(), "method"].unique()[:2].tolist()
    methods = [*of_study, *ompl_planners.PLANNERS]
    named = []
    for method, look in zip(methods, style.lines(methods)):
        own = attempts[attempts["method"] == method]
        look = look | {"marker": ""}
        times = np.geomspace(own["cpu_s"].min(), own.groupby("seed")["cpu_s"].max().median(), 300)
        low, median, high = 100 * quartiles(own, times)
        axes.fill_between(
            1e3 * times,
            np.minimum(low, HIGHEST),
            np.minimum(high, HIGHEST),
            where=np.isfinite(low),
            **style.interval_band(look["color"]),
        )
        (line,) = axes.plot(
            1e3 * times, median, **look, label="_" if method in of_study else f"OMPL's {method}"
        )
        if method in of_study:
            named.append(line)
            until = own.loc[own["budget"] == 1, "cpu_s"].median()
            reached = 100 * quartiles(own, np.array([until]))[QUARTILES.index(0.5)]
            axes.plot(1e3 * until, reached, **OWN_BUDGET | {"color": look["color"], "label": "_"})
    baseline = attempts[~attempts["method"].isin(methods)]
    axes.plot([], [], **OWN_BUDGET)
    axes.plot(1e3 * baseline["cpu_s"].median(), 100 * baseline["excess"].median(), **BASELINE_MARK)
    axes.axhline(0, **style.BOUND, label="exact shortest path")
    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=1, linscale=0.6)
    axes.set(xlim=(0.5, 500), ylim=(-0.15, HIGHEST), xticks=[1, 10, 100], yticks=PERCENTS)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_locator(mpl.ticker.NullLocator())
    axes.grid(axis="y")
    axes.legend(
        named,
        of_study,
        loc="upper right",
        frameon=True,
        framealpha=0.9,
        edgecolor="none",
        borderpad=0.2,
    )


HIGHEST = 500  # room for the names above what is drawn
PERCENTS = [0, 1, 2, 5, 10, 20, 50, 100]
OWN_BUDGET = {
    "color": style.BLACK,
    "linestyle": "",
    "marker": "o",
    "markersize": 4.5,
    "markerfacecolor": "#FFFFFF",
    "label": "the study's own budget",
}
BASELINE_MARK = {
    "color": style.RED,
    "linestyle": "",
    "marker": "D",
    "markersize": 4.5,
    "zorder": 5,
    "clip_on": False,
    "label": "rounded shortest path",
}


def printed(table: pd.DataFrame) -> str:
    """The table as text: for each problem and method, milliseconds and the share of seeds for each
    distance from the exact length.
    """
    lines = [
        f"{'':34}" + "".join(f"{f'within {100 * share:g} %':>18}" for share in WITHIN),
        f"{'':34}" + f"{'ms':>10}{'seeds':>8}" * len(WITHIN),
    ]
    for problem, own in table.groupby("problem", sort=False):
        lines.append(problem)
        for method, cells in own.groupby("method", sort=False):
            shown = (
                f"{1e3 * each.median_s:10.1f}" if np.isfinite(each.median_s) else f"{'-':>10}"
                for each in cells.itertuples()
            )
            lines.append(
                f"  {method:32}"
                + "".join(f"{ms}{100 * there:6.0f} %" for ms, there in zip(shown, cells["reached"]))
            )
    return "\n".join(lines)


def main() -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    ompl_planners.start(seed=1)
    print(
        f"CPU time until a path is near the exact shortest one, median of {SEEDS} seeds, and the "
        "share of seeds that get there\n"
    )
    found = []
    for number, contest in enumerate(CONTESTS):
        at, before = arena(contest), time.process_time()
        found.append(compete(at))
        taken = time.process_time() - before
        print(
            f"problem {number + 1} of {len(CONTESTS)}: {name_of(at)}: {len(found[-1]):,} paths in "
            f"{taken:.0f} CPU s",
            flush=True,
        )
    attempts = pd.concat(found, ignore_index=True)
    table = time_table(attempts, WITHIN)
    sheet.write_data(attempts, FOLDER / "planners.csv")
    sheet.write_data(table, FOLDER / "planners_times.csv")
    sheet.save(draw(attempts), FOLDER / "planners.svg", FOLDER / "planners.png")
    print(f"\n{printed(table)}\n\nFigure and tables: {FOLDER.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
