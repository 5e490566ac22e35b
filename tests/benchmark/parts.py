"""What `make benchmark` measures: names, and the works behind them."""

import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import frame
import numpy as np
import yaml

from bezierplan.geometry import shortest_paths
from bezierplan.places import TREE
from bezierplan.running.guard import interface
from bezierplan.study import jobs, page
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.polygons import Polygons
from bezierplan.workspaces.problem import Problem, Workspace

Works = Iterator[tuple[str, frame.Work]]
SMOKE = TREE / "results" / "smoke"
CLAIMS = "song2016"
"""The study whose claims are judged: those of all would take too long."""
GROWN = "growth: "
"""How the names of costs begin that are measured on demand."""


def short() -> Works:
    """What is measured each time, in less than a minute."""
    for name, words in {
        "list": ["list"],
        "dry run of one figure": ["run", "-n", "song2016_figure4"],
        "dry run": ["run", "-n"],
    }.items():
        yield f"start: {name}", partial(_start, words)
    kinds = {}
    for planner, problem, work in frame.first_runs():
        yield f"planner: {planner}", work
        kinds.setdefault(interface.KINDS[type(problem.workspace)], problem)
    for kind, problem in kinds.items():
        yield f"bound: {kind}", partial(shortest_paths.shortest_path, problem)
    studies = {study.key: study for study in frame.studies()}
    claims = jobs.build_claims(studies[CLAIMS], "smoke")
    yield f"claims: {CLAIMS}", partial(_run, claims, CLAIMS, "claims", "checks")
    yield "page", partial(_run, page.build_page(studies, "smoke", root=""), "", "page")


def _start(words: list[str]) -> None:
    """A command, started in an empty folder, where there are no results."""
    with tempfile.TemporaryDirectory() as folder:
        frame.start("-m", "bezierplan", *words, folder=folder)


def _run(job: Any, study: str, *outputs: str) -> None:
    """A job on the results of scale smoke, which writes elsewhere."""
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
        summary=[SMOKE / f"{name}.csv" for name in ("numbers", "claims", "methods")],
        verified=SMOKE / "verified.json",
    )
    with tempfile.TemporaryDirectory() as folder:
        job.run(given, SimpleNamespace(**{name: f"{folder}/{name}" for name in outputs}))


# --------------------------------------------------------------------------------------------------
# How cost grows


def grown() -> Works:
    """With obstacles, cells, methods and runs."""
    for kind, draw in (("circles", _discs), ("squares", _squares)):
        for side in (16, 32, 63):
            work = partial(shortest_paths.shortest_path, _across(_room(side, draw), side))
            yield f"{GROWN}bound among {side**2:,} {kind}", work
    for side in (250, 500, 1000):
        work = partial(shortest_paths.shortest_path, _across(_blocks(side), side))
        yield f"{GROWN}bound on {side:,} x {side:,} cells", work
    for methods in (30, 100, 300):
        yield f"{GROWN}dry run of {methods} methods", partial(_study, methods, 10, "-n")
    for runs in (1_000, 10_000, 100_000):
        yield f"{GROWN}a study of {runs:,} runs", partial(_study, 1, runs)


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
