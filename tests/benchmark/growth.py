"""How cost grows with what there is more of: runs, samples, obstacles, cells, studies. `make
benchmark ARGS=growth`.

Each series is CPU seconds at sizes in a geometric series. The slope of log(cost) over log(size) is
the power of the size that the cost grows with; at most linear is a slope of at most 1. It is fitted
to the upper sizes only, where a constant cost no longer hides growth.
"""

import contextlib
import math
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import gathering
import matplotlib as mpl
import numpy as np
import pandas as pd
import pyarrow.parquet as parquet
from geometry import random_grid
from limits import random_cells
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import linregress
from timing import cpu_seconds_of_each

from bezierplan.analysis import comparison, results, tables
from bezierplan.analysis.claims import job as claims_job
from bezierplan.figures import sheet, style
from bezierplan.figures.page import runs as page_runs
from bezierplan.figures.page.page_job import PageJob
from bezierplan.figures.panels import Sources
from bezierplan.geometry import checker, shortest_paths
from bezierplan.geometry.region import Region, region
from bezierplan.planners import planner_module, planner_settings
from bezierplan.running import execution, problems
from bezierplan.schema import model
from bezierplan.study import jobs, page, reading, stamps, targets
from bezierplan.study.definition import Study
from bezierplan.study.targets import Studies
from bezierplan.workspaces import files
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.ground import _ground, ground_of
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

ROUNDS = 3
FITTED = 4
"""The slope is that of this many of the largest sizes."""
LIMIT = 1.0
"""Largest slope of a cost that grows at most linearly."""
MOST_MEMORY = 2e9
"""Bytes that gathering a study of `RUNS` runs may need."""
RUNS = 100_000
FOLDER = Path(__file__).parents[2] / "results" / "benchmark"

Work = Callable[[], object]


class Series(NamedTuple):
    """What to measure.

    kind: what there is more of, a key of `AXES`. prepare: makes the work of a size, which is not
    measured. reason: why the cost may grow faster than the size.
    """

    kind: str
    name: str
    sizes: Sequence[int]
    prepare: Callable[[int], Work]
    reason: str = ""


class Slope(NamedTuple):
    """Slope of a line through log(seconds) over log(size), its standard error, and the seconds that
    the line gives at size 1.
    """

    value: float
    error: float
    at_one: float

    @property
    def steeper(self) -> bool:
        """Whether the slope lies above `LIMIT` by more than two standard errors."""
        return self.value - 2 * self.error > LIMIT


def _study(key: str) -> Study:
    return reading.load(reading.read_config({"studies": [key]}))[key]


def slope(sizes: Sequence[float], seconds: Sequence[float]) -> Slope:
    """The slope of the `FITTED` largest sizes; both arguments (n,), sizes ascending."""
    line = linregress(np.log(sizes[-FITTED:]), np.log(seconds[-FITTED:]))
    return Slope(line.slope, line.stderr, math.exp(line.intercept))


def geometric(first: int, last: int, number: int = 6) -> list[int]:
    """Whole numbers in a geometric series."""
    return np.rint(np.geomspace(first, last, number)).astype(int).tolist()


# --------------------------------------------------------------------------------------------------
# Repeats: runs of a study, and what is made of them


def _repeats() -> Iterator[Series]:
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield Series(
            "repeats",
            "runs and their checks",
            geometric(16, 256),
            lambda n: partial(_runs, _gathered(16), n),
        )
        made = {
            "tables and comparisons": _tables,
            "data of figures": _figures,
            "claims": _claims,
            "viewer of runs": _viewer,
        }
        for name, make in made.items():
            yield Series(
                "repeats",
                name,
                geometric(128, 4096),
                lambda n, make=make: partial(make, _gathered(n)),
            )


@cache
def _gathered(repeats: int) -> Studies:
    """A study of that many repeats, ten runs each, and the files of its runs in the working
    folder.
    """
    study = reading.read_study(
        gathering.write_study(Path(f"study{repeats}").resolve(), repeats, repeats)
    )
    gathering.write_runs(study)
    return {study.key: study}


def _runs(given: Studies, repeats: int) -> None:
    """A chunk of runs, made and written."""
    (study,) = given.values()
    made = problems.read(targets.shown_by(study, gathering.SCALE, "lengths")["all"].problems)
    runs, _ = execution.run_chunk(
        made, jobs.job(study, "all", "pso", gathering.SCALE, 0)._replace(repeats=[0, repeats])
    )
    parquet.write_table(runs, "runs.parquet")


def _tables(given: Studies) -> None:
    (study,) = given.values()
    found, job = _read(given), jobs.table_job(study, "lengths", gathering.SCALE)
    published = comparison.read_published(study.published_file("lengths"), job.spec)
    comparison.compare(found, job.spec, published, job.variants, job.baselines, job.name)
    tables.pivot(found, job.spec, job.labels)


def _figures(given: Studies) -> None:
    (study,) = given.values()
    published = {Path(file).stem: results.published_table(file) for file in study.published_files()}
    found = _read(given)._replace(published=results.joined_numbers(published))
    for figure in study.figures:
        sheet.data(study.figures[figure].panels, Sources({"all": found}))


def _read(given: Studies) -> results.Results:
    """All runs of a study."""
    (study,) = given.values()
    files = targets.shown_by(study, gathering.SCALE, "lengths")["all"]
    return results.read(files, study.experiments["all"].repeats[gathering.SCALE], "all")


def _claims(given: Studies) -> None:
    (key,) = given
    files = targets.judged_by_claims(given[key], gathering.SCALE)
    published = {Path(file).stem: file for file in given[key].published_files()}
    claims_job.run(
        jobs.claims_job(given[key], given[key].claims, gathering.SCALE),
        files,
        published,
        "claims.csv",
        "checks.csv",
    )


def _viewer(given: Studies) -> None:
    (key,) = given
    job = model.job(PageJob, page.params(given, gathering.SCALE)["job"])
    page_runs.chosen(key, "all", job.studies[key].experiments["all"])


# --------------------------------------------------------------------------------------------------
# Samples of a curve, and its pieces


def _samples() -> Iterator[Series]:
    for study, method, problem in (
        ("tharwat2018", "pso", "equal"),
        ("song2016", "smooth", "0_240"),
        ("ma2020", "bca", "environment1"),
    ):
        own = _study(study)
        yield Series(
            "samples",
            f"run of {own.planner(method)}",
            geometric(101, 3201),
            partial(_run_with_samples, own, method, problem),
        )
    squares = region(_room(6, _squares))
    yield Series(
        "samples",
        "check, by pieces",
        geometric(32, 1024),
        lambda n: partial(checker.check, _along(6, n), squares),
    )


def _run_with_samples(study: Study, method: str, name: str, samples: int) -> Work:
    workspace = files.load(study.workspace_of(name).plain(), study.folder)
    problem = problems.build(name, study.problems[name].plain("settings"), workspace)
    settings = study.resolved(method) | study.problems[name].settings | {"samples": samples}
    return _run(study.planner(method), problem, settings)


def _run(planner: str, problem: Problem, settings: dict) -> Work:
    """A run with always the same random numbers."""
    module = planner_module(planner)
    accepted = {name: value for name, value in settings.items() if name in planner_settings(module)}
    return lambda: module.plan(problem, np.random.default_rng(0), **accepted)


def _along(side: int, pieces: int) -> np.ndarray:
    """Free straight pieces (pieces, 2, 2) of a wave from left to right, between two rows of the
    obstacles of `_room`.
    """
    x = np.linspace(0.1, side - 0.1, pieces + 1)
    points = np.column_stack([x, side // 2 + 0.1 * np.sin(20 * x)])
    return np.stack([points[:-1], points[1:]], axis=1)


# --------------------------------------------------------------------------------------------------
# Obstacles: one in each square of a room


def _obstacles() -> Iterator[Series]:
    sides, rooms = (2, 3, 4, 6, 8, 11, 16, 23), (("circles", _discs), ("polygons", _squares))
    for name, draw in rooms:
        blocked = {side**2: region(_room(side, draw)) for side in sides}
        yield Series(
            "obstacles", f"run of chaotic_pso, {name}", [*blocked], partial(_run_across, draw)
        )
        yield Series(
            "obstacles",
            f"check, {name}",
            [*blocked],
            lambda n, blocked=blocked: _check(math.isqrt(n), blocked[n]),
        )
    reasons = {
        "circles": "a search that may reach any circle",
        "polygons": "lines of sight join pairs of corners",
    }
    for name, draw in rooms:
        # Among fewer polygons than 125, all pairs of corners are tested; beyond, as needed.
        sizes = [side**2 for side in (*sides, 32, 45)]
        yield Series(
            "obstacles",
            f"exact bound, {name}",
            sizes,
            lambda n, draw=draw: _bound(_across(n, draw)),
            reasons[name],
        )


def _run_across(draw: Callable, obstacles: int) -> Work:
    return _run(
        "chaotic_pso",
        _across(obstacles, draw),
        _study("tharwat2018").resolved("pso") | {"stall_limit": 0},
    )


def _check(side: int, blocked: Region) -> Work:
    return partial(checker.check, _along(side, 10), blocked)


def _bound(problem: Problem) -> Work:
    return partial(shortest_paths.shortest_path, problem)


def _across(obstacles: int, draw: Callable) -> Problem:
    """From corner to corner of a room."""
    side = math.isqrt(obstacles)
    return Problem("", _room(side, draw), (0.05, 0.05), (side - 0.05, side - 0.05))


def _room(side: int, draw: Callable) -> Workspace:
    """A room of side x side units with an obstacle in the middle of each, drawn from its bounds,
    centres (n, 2) and radii (n,).
    """
    centres = np.stack(np.meshgrid(*[np.arange(side) + 0.5] * 2), axis=-1).reshape(-1, 2)
    return draw(
        (0.0, float(side), 0.0, float(side)),
        centres,
        np.random.default_rng(side).uniform(0.2, 0.35, side**2),
    )


def _discs(bounds: tuple, centres: np.ndarray, radii: np.ndarray) -> Circles:
    return Circles(bounds, centres, radii, "unit")


def _squares(bounds: tuple, centres: np.ndarray, radii: np.ndarray) -> Polygons:
    ring = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    return Polygons(
        bounds, tuple((centre + radius * ring,) for centre, radius in zip(centres, radii)), "unit"
    )


# --------------------------------------------------------------------------------------------------
# Cells of a square grid


def _cells() -> Iterator[Series]:
    yield Series(
        "cells",
        "exact bound, search",
        _squared(128, 640),
        _bounds,
        "corners wait in a heap, n log n",
    )
    reason = "a graph of pairs of corners; above 5,000 corners there is none"
    yield Series(
        "cells", "exact bound, graph", _squared(12, 60), lambda n: _bound(_diagonal(n)), reason
    )
    yield Series("cells", "check", _squared(32, 512), _check_in_row)
    reason = "edges join pairs of cells; above 2,048 cells there is no table"
    yield Series("cells", "table of edges, meledje", _squared(8, 32), _tabulate_edges, reason)
    for study, method, last in (
        ("elhoseny2017", "octile_bound", 512),
        ("elhoseny2017", "mga_c", 256),
        ("elhoseny2017", "ga", 256),
        ("ma2020", "ga", 128),
        ("ma2020", "aco", 128),
        ("ma2020", "bca", 512),
        ("song2016", "smooth", 512),
        ("meledje", "proposed", 64),
    ):
        own = _study(study)
        name = f"run of {own.planner(method)}"
        yield Series(
            "planners",
            name,
            _squared(16, last),
            lambda n, own=own, method=method: _run_on_cells(own, method, n),
        )


def _bounds(cells: int) -> Work:
    """The exact bounds on several grids, for one may need a search of more of its corners than
    another.
    """
    made = [_from_corner(random_cells(math.isqrt(cells), 1, seed)) for seed in range(4)]
    return lambda: [shortest_paths.shortest_path(problem) for problem in made]


def _squared(first: int, last: int) -> list[int]:
    return [side**2 for side in geometric(first, last)]


def _run_on_cells(study: Study, method: str, cells: int) -> Work:
    """A run on a grid with always the same number of blocks, in which a path may be as many times
    longer as a side of the grid is.
    """
    settings = study.resolved(method)
    grow = math.isqrt(cells) / 16
    settings |= {
        name: int(grow * settings[name])
        for name in ("longest_join", "longest_path")
        if name in settings
    }
    return _run(
        study.planner(method),
        _from_corner(random_grid(math.isqrt(cells), np.random.default_rng(0))),
        settings,
    )


@cache
def _diagonal(cells: int) -> Problem:
    """From corner to corner of a grid with a fifth of its cells occupied, one by one: as many
    corners as there can be.
    """
    return _from_corner(random_cells(math.isqrt(cells), 1))


def _from_corner(grid: Grid) -> Problem:
    side = len(grid.occupied)
    return Problem("", grid, (0.5, 0.5), (side - 0.5, side - 0.5))


def _check_in_row(cells: int) -> Work:
    """The check of ten pieces along the lowest row of a grid, all of it free."""
    side = math.isqrt(cells)
    occupied = _diagonal(cells).workspace.occupied.copy()
    occupied[0] = False
    x = np.linspace(0.5, side - 0.5, 11)
    points = np.column_stack([x, 0.5 + 0.1 * np.sin(x)])
    return partial(
        checker.check,
        np.stack([points[:-1], points[1:]], axis=1),
        region(Grid(occupied, 1.0, "cell")),
    )


def _tabulate_edges(cells: int) -> Work:
    """What node_genetic prepares for a small grid."""
    return lambda: (_ground.cache_clear(), ground_of(_diagonal(cells).workspace, 1.0))


# --------------------------------------------------------------------------------------------------
# Studies: what a start of Snakemake asks of this package


def _studies() -> Iterator[Series]:
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        first = gathering.write_study(Path("study0"), 1000, 250)
        folders = [first, *(shutil.copytree(first, Path(f"study{n}")) for n in range(1, 128))]
        with mock.patch.object(stamps, "STAMPS", Path("stamps")):
            yield Series(
                "studies",
                "read and checked",
                geometric(1, 32),
                lambda n: partial(_read_first, folders[:n]),
            )
            yield Series(
                "studies",
                "read again, jobs listed",
                geometric(4, 128),
                lambda n: partial(_list_jobs, folders[:n]),
            )


def _read_first(folders: list[Path]) -> None:
    """Read and check studies as if never seen before."""
    shutil.rmtree(stamps.STAMPS, ignore_errors=True)
    reading.load(folders)


def _list_jobs(folders: list[Path]) -> None:
    """Inputs and params of every job of studies that were checked before."""
    given = reading.load(folders)
    for key, study in given.items():
        targets.problems_params(given, gathering.SCALE, key, "all")
        for method in study.methods_of("all"):
            for chunk in jobs.chunks(study, "all", method, gathering.SCALE):
                targets.run_params(given, gathering.SCALE, key, "all", method, str(chunk))
    list(gathering.gathering(given))


# --------------------------------------------------------------------------------------------------
# Table and figure


def measured() -> Iterator[tuple[Series, list[float]]]:
    """Every series with its CPU seconds, one for each size."""
    for part in (_repeats, _samples, _obstacles, _cells, _studies):
        for series in part():
            yield (
                series,
                cpu_seconds_of_each([series.prepare(size) for size in series.sizes], ROUNDS),
            )


def benchmark_growth() -> None:
    """The slope of each series beside its limit, the figure, and the memory that gathering many
    runs needs.
    """
    print(f"\n{'growth':40}{'sizes':>20}{'CPU ms':>22}{'slope':>8}{'+-':>7}{'at most':>9}")
    found = []
    for series, seconds in measured():
        line = slope(series.sizes, seconds)
        sizes, costs = (
            f"{series.sizes[0]:,} to {series.sizes[-1]:,}",
            f"{1e3 * seconds[0]:,.2f} to {1e3 * seconds[-1]:,.2f}",
        )
        told = f"   steeper: {series.reason or 'unexplained'}" if line.steeper else ""
        named = f"{series.kind}: {series.name}"
        print(
            f"  {named:38}{sizes:>20}{costs:>22}"
            f"{line.value:8.2f}{line.error:7.2f}{LIMIT:9.1f}{told}",
            flush=True,
        )
        found += [
            (series.kind, series.name, size, cost, *line)
            for size, cost in zip(series.sizes, seconds)
        ]
    FOLDER.mkdir(parents=True, exist_ok=True)
    frame = pd.DataFrame(found, columns=["kind", "name", "size", "seconds", *Slope._fields])
    sheet.write_data(frame, str(FOLDER / "growth.csv"))
    sheet.save(
        draw(sheet.read_data(str(FOLDER / "growth.csv"))),
        str(FOLDER / "growth.svg"),
        str(FOLDER / "growth.png"),
    )
    print(f"  drawn in {os.path.relpath(FOLDER / 'growth.png')}")
    print(f"\n{f'memory to gather {RUNS:,} runs':40}{'MB':>12}{'at most':>12}")
    for script, needed in gathering.peaks(RUNS // 10, RUNS // 100).items():
        print(
            f"  {script:38}{needed / 1e6:12,.0f}{MOST_MEMORY / 1e6:12,.0f}"
            f"{'' if needed <= MOST_MEMORY else '   too much'}"
        )


AXES = {
    "repeats": "repeats",
    "samples": "samples or pieces of a curve",
    "obstacles": "obstacles",
    "cells": "cells of a grid",
    "planners": "cells of a grid",
    "studies": "studies",
}


def draw(frame: pd.DataFrame) -> Figure:
    """A panel for each kind of size: CPU seconds over size, fitted lines, and a grey line of slope
    1. frame: columns as in growth.csv.
    """
    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(style.WIDE, 1.45 * style.WIDE), layout="constrained")
        for letter, (kind, label), axes in zip("abcdef", AXES.items(), figure.subplots(3, 2).flat):
            _draw_panel(axes, frame[frame["kind"] == kind])
            axes.set(xscale="log", yscale="log", xlabel=label, ylabel="CPU time (s)")
            axes.set_title(f"({letter}) {kind}", loc="left")
    return figure


def _draw_panel(axes: Axes, frame: pd.DataFrame) -> None:
    names = frame["name"].unique().tolist()
    for name, look in zip(names, style.lines(names)):
        own = frame[frame["name"] == name]
        upper, first = own[-FITTED:], own.iloc[0]
        label = f"{name}: {first['value']:.2f} \u00b1 {first['error']:.2f}"
        axes.plot(own["size"], own["seconds"], **(look | {"linestyle": ""}))
        axes.plot(
            upper["size"],
            first["at_one"] * upper["size"] ** first["value"],
            **(look | {"marker": ""}),
        )
        axes.plot([], [], label=label, **look)
    ends = np.array([frame["size"].min(), frame["size"].max()])
    axes.plot(
        ends,
        frame["seconds"].min() * ends / ends[0],
        color="0.8",
        linewidth=2.5,
        zorder=0,
        label="slope 1",
    )
    axes.legend(
        loc="upper center",
        bbox_to_anchor=(0.5, -0.25),
        title="slope \u00b1 standard error",
        title_fontsize=style.SMALLEST_TEXT,
    )
