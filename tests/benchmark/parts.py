"""What `make benchmark` measures: names, and the works behind them."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import frame
import numpy as np
import yaml

from bezierplan.geometry import region, shortest_paths
from bezierplan.places import TREE
from bezierplan.study import jobs, page
from bezierplan.study.definition import Study
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

Costs = Iterator[tuple[str, frame.Measure]]
SMOKE = TREE / "results" / "smoke"
COMPILED = {
    "modified_genetic": ("elhoseny2017", "fields100", "mga"),
    "chaotic_pso": ("tharwat2018", "maps", "pso"),
}
"""Planners that are compiled from nothing, with a run of each: those of all would take minutes."""
BOUNDS = {
    "circles": ("tharwat2018", "maps", "pso"),
    "grid": ("ma2020", "environments", "bca"),
    "polygons": ("elhoseny2017", "maps_polygons", "mga"),
}
DRIVES = {
    "meledje": ("from_current", ["proposed_drives", "shortest_drives"]),
    "tharwat2018": ("moving", ["swarm_warm"]),
}
JUDGED = {"meledje": "from_current", "song2016": "routes", "tharwat2018": "maps"}
TABLES = {"ma2020": "table1", "tharwat2018": "table3"}
FIGURES = {
    "elhoseny2017": "figure10",
    "ma2020": "figure4",
    "meledje": "figure1",
    "song2016": "figure4",
    "tharwat2018": "figure8",
}
CLAIMS = ("song2016", "ma2020")
"""The studies whose claims are judged: those of all would take too long."""
GROWN = "growth: "
"""How the names of costs begin that are measured on demand."""


def short() -> Costs:
    """What is measured each time, in some minutes."""
    for name, words in {
        "list": ["list"],
        "dry run of one figure": ["run", "-n", "song2016_figure4"],
        "dry run": ["run", "-n"],
    }.items():
        yield _timed(f"start: {name}", _start, words)
    yield "most memory, in MB: dry run", partial(_most_memory, ["run", "-n"])
    for planner, place in COMPILED.items():
        yield f"compiling: {planner}", partial(frame.ratio, partial(_compile, place), cold=True)
    for own, experiment, method in frame.first_places():
        _, work = frame.first_run(own, experiment, method)
        yield _timed(f"planner: {own.planner(method)} ({own.key}/{experiment}/{method})", work)
    studies = {study.key: study for study in frame.studies()}
    for kind, (key, *place) in BOUNDS.items():
        problem, _ = frame.first_run(studies[key], *place)
        yield _timed(f"bound: {kind}", _bound, problem)
    for key, (experiment, methods) in DRIVES.items():
        for method in methods:
            work = frame.first_drive(studies[key], experiment, method)
            yield _timed(f"drives: {key}/{experiment}/{method}", work)
    yield from _of_results(studies)


def _of_results(studies: Mapping[str, Study]) -> Costs:
    """What judges and shows the results of scale smoke."""
    for key, experiment in JUDGED.items():
        methods = studies[key].experiments[experiment].methods
        job = jobs.build_judgement(studies[key], "smoke", experiment, methods)
        yield _timed(f"judgement: {key}/{experiment}", _run, job, key)
    for key, table in TABLES.items():
        job = jobs.build_table_of_runs(studies[key], "smoke", table)
        outputs = ("table", "published", "comparison")
        yield _timed(f"table: {key}/{table}", _run, job, key, *outputs)
    for key, figure in FIGURES.items():
        drawn = jobs.build_figure(studies[key], "smoke", figure)
        outputs = ("svg", "png", "pdf", "caption", "data")
        yield _timed(f"figure: {key}/{figure}", _run, drawn, key, *outputs)
    for key in CLAIMS:
        claims = jobs.build_claims(studies[key], "smoke")
        yield _timed(f"claims: {key}", _run, claims, key, "claims", "checks")
    yield _timed("page", _run, page.build_page(studies, "smoke", root=""), "", "page")


def _timed(name: str, work: Callable[..., object], *of: object) -> tuple[str, frame.Measure]:
    """The name of a cost, and what measures it: the CPU time of a work."""
    return name, partial(frame.ratio, partial(work, *of))


def _start(words: list[str]) -> int:
    """A command, started in an empty folder, where there are no results; the most memory that it
    had, in bytes.
    """
    with tempfile.TemporaryDirectory() as folder:
        return frame.start("-m", "bezierplan", *words, folder=folder)


def _most_memory(words: list[str]) -> float:
    return _start(words) / 1e6


def _compile(place: tuple[str, str, str]) -> None:
    """A run, where no kernel has been compiled."""
    with tempfile.TemporaryDirectory() as folder:
        frame.start(frame.__file__, *place, XDG_CACHE_HOME=folder)


def _bound(problem: Problem) -> None:
    """The exact shortest path, in a room that is as good as new."""
    region.build_region.cache_clear()
    shortest_paths.shortest_path(problem)


def _run(job: Any, study: str, *outputs: str) -> None:
    """A job on the results of scale smoke, which writes elsewhere. outputs: names of its files;
    none if it has one without.
    """
    places = [(SMOKE / Path(study, name).parent, Path(name).name) for name in job.shows]
    given = SimpleNamespace(
        problems=[f"{home}/problems/{name}.parquet" for home, name in places],
        bounds=[f"{home}/problems/{name}.bounds.parquet" for home, name in places],
        runs=[
            f"{home}/runs/{name}/{method}/{number}.parquet"
            for (home, name), methods in zip(places, job.shows.values())
            for method, chunks in methods.items()
            for number in range(chunks)
        ],
        sources=job.sources,
        alternatives=[],
        summary=[SMOKE / f"{name}.csv" for name in ("numbers", "claims", "methods")],
        verified=SMOKE / "verified.json",
    )
    with tempfile.TemporaryDirectory() as folder:
        files = {name: f"{folder}/file.{name}" for name in outputs}  # its ending says the kind
        job.run(given, SimpleNamespace(**files) if files else [f"{folder}/file"])


# --------------------------------------------------------------------------------------------------
# How cost grows


def grown() -> Costs:
    """With obstacles, cells, methods and runs."""
    for kind, draw in (("circles", _discs), ("squares", _squares)):
        for side in (16, 32, 63):
            problem = _across(_room(side, draw), side)
            yield _timed(f"{GROWN}bound among {side**2:,} {kind}", _bound, problem)
    for side in (250, 500, 1000):
        problem = _across(_blocks(side), side)
        yield _timed(f"{GROWN}bound on {side:,} x {side:,} cells", _bound, problem)
    for methods in (30, 100, 300):
        yield _timed(f"{GROWN}dry run of {methods} methods", _study, methods, 10, "-n")
    for runs in (1_000, 10_000, 100_000):
        # Its kernels are there, since its planner was measured.
        measure = partial(frame.ratio, partial(_study, 1, runs), cold=True)
        yield f"{GROWN}a study of {runs:,} runs", measure


def _across(workspace: Workspace, side: int) -> Problem:
    """From corner to corner."""
    return Problem("", workspace, (0.05, 0.05), (side - 0.05, side - 0.05))


def _room(side: int, draw: Callable[..., Workspace]) -> Workspace:
    """A room of side x side units with an obstacle in the middle of each, drawn from its bounds,
    centres (n, 2) and radii (n,).
    """
    centres = np.stack(np.meshgrid(*[np.arange(side) + 0.5] * 2), axis=-1).reshape(-1, 2)
    radii = np.random.default_rng(side).uniform(0.2, 0.35, side**2)
    return draw((0.0, float(side), 0.0, float(side)), centres, radii)


def _discs(bounds: tuple, centres: np.ndarray, radii: np.ndarray) -> Circles:
    return Circles(bounds, centres, radii, "unit")


def _squares(bounds: tuple, centres: np.ndarray, radii: np.ndarray) -> Polygons:
    ring = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    rings = ((centre + radius * ring,) for centre, radius in zip(centres, radii))
    return Polygons(bounds, tuple(rings), "unit")


def _blocks(side: int) -> Grid:
    """A grid with 20 % of its cells in square blocks of up to 3 cells, its corners free."""
    rng = np.random.default_rng(2)
    occupied = np.zeros((side, side), dtype=bool)
    while occupied.mean() < 0.2:
        for row, column, size in rng.integers(0, (side, side, 3), (side, 3)):
            occupied[row : row + size + 1, column : column + size + 1] = True
    occupied[:4, :4] = occupied[-4:, -4:] = False
    return Grid(occupied, 1.0, "cell")


def _study(methods: int, runs: int, *options: str) -> None:
    """The workflow of a study of some methods: variants of tharwat2018's swarm, each with a chunk
    of 10,000 runs or less for each of five problems.
    """
    own = frame.study("tharwat2018")
    names = [f"method{number}" for number in range(methods)]
    settings = own.resolve_settings("pso")
    repeats = max(runs // 5, 1)
    scales = ("smoke", "full", "extended")
    content = {
        "title": "Many",
        "methods": {name: {"planner": "chaotic_pso", "settings": settings} for name in names},
        "settings": {},
        "workspaces": {
            "pond": {
                "kind": "circles",
                "bounds": [0, 10, 0, 10],
                "circles": [[5, 5, 1]],
                "unit": "m",
            }
        },
        "problems": {
            f"swim{number}": {"workspace": "pond", "start": [1, 1 + number], "target": [9, 9]}
            for number in range(5)
        },
        "experiments": {
            f"experiment{number}": {
                "problems": [f"swim{number}"],
                "methods": names,
                "repeats": dict.fromkeys(scales, repeats),
                "chunk": dict.fromkeys(scales, min(repeats, 10_000)),
            }
            for number in range(5)
        },
    }
    tables = {
        f"table{number}": {
            "title": "Lengths",
            "kind": "pivot",
            "experiment": f"experiment{number}",
            "index": ["method"],
            "values": [{"metric": "length", "statistic": "mean", "label": "length", "decimals": 2}],
        }
        for number in range(5)
    }
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder, "many")
        home.mkdir()
        (home / "experiments.yaml").write_text(yaml.safe_dump(content))
        (home / "artefacts.yaml").write_text(yaml.safe_dump({"tables": tables, "figures": {}}))
        _start(["run", str(home), "--cores", "2", *options])
