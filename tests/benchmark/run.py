"""Speed of the inner loops: `make benchmark`. CPU seconds of one core, the best of several rounds; ratios carry over to other machines.

binary_genetic is set beside the bare minimum of work that its runs ask for: a compiled loop that evaluates as many curves of the same kind,
with the same sparsity, measures them and looks up the same number of cells, and does nothing else. Checks and bounds are timed by kind and
size of workspace, start-up in processes of its own.
"""

import itertools
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "src"))

import numpy as np
from numba import njit

from bezierplan import curves, study_file
from bezierplan.exact import bounds, checker
from bezierplan.exact.region import region
from bezierplan.planners import binary_genetic, chaotic_pso, node_genetic
from bezierplan.problem import Path as Curve
from bezierplan.problem import Problem, Workspace, planner_module
from bezierplan.workspaces import files, random_field
from bezierplan.workspaces.circles import Circles
from bezierplan.workspaces.grid import Grid

ROUNDS = 5
SOURCE = sys.path[0]


def cpu_seconds(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """CPU seconds of the fastest of several rounds, after one that compiles."""
    work()
    seconds = []
    for _ in range(rounds):
        before = time.process_time()
        work()
        seconds.append(time.process_time() - before)
    return min(seconds)


@njit(cache=True)
def bare_minimum(cells, occupied, basis, first_point, last_point, first_sample, x, y):
    """Total length and occupied samples of the curves of all chromosomes (n, control points): no search, no bookkeeping."""
    columns = occupied.shape[1]
    length, bad = 0.0, 0
    for i in range(len(cells)):
        x[:] = 0.0
        y[:] = 0.0
        for k in range(len(first_point)):
            for p in range(first_point[k], last_point[k] + 1):
                column, row = cells[i, p] % columns + 0.5, cells[i, p] // columns + 0.5
                for s in range(first_sample[k], first_sample[k + 1]):
                    x[s] += basis[p, s] * column
                    y[s] += basis[p, s] * row
        for s in range(len(x)):
            bad += occupied[int(y[s]), int(x[s])]
        for s in range(len(x) - 1):
            x[s] = np.sqrt((x[s + 1] - x[s]) ** 2 + (y[s + 1] - y[s]) ** 2)
        for s in range(len(x) - 1):
            length += x[s]
    return length, bad


def benchmark_binary_genetic() -> None:
    """Each method of song2016 on its longest route."""
    study = study_file.load(study_file.read_config({"studies": ["song2016"]}))["song2016"]
    grid = files.load(study.workspaces["figure2"], study.folder)
    problem = Problem("0_240", grid, grid.centre(0), grid.centre(240))
    runs = 20
    print(f"{'binary_genetic':16}{'evaluations/s':>16}{'ms a run':>12}{'bare minimum/s':>16}{'times the minimum':>20}")
    for method in study.experiments["routes"]["methods"]:
        settings = study.resolved(method)
        evaluations = runs * settings["population"] * (settings["generations"] + 1)
        seconds = cpu_seconds(lambda: [binary_genetic.plan(problem, np.random.default_rng(seed), **settings) for seed in range(runs)])  # noqa: B023
        basis = curves.sample_matrix(settings["curve"], settings["genes"] + 2, settings["samples"])
        stretches = binary_genetic.stretches(basis)
        cells = np.random.default_rng(0).integers(0, grid.occupied.size, (evaluations // runs, settings["genes"] + 2))
        first_sample = np.append(stretches[:, 2], len(basis))
        x, y = np.empty((2, len(basis)))
        arguments = (cells, grid.occupied, np.ascontiguousarray(basis.T), stretches[:, 0], stretches[:, 1], first_sample, x, y)
        least = runs * cpu_seconds(lambda: bare_minimum(*arguments))  # noqa: B023
        rates = f"{evaluations / seconds:16,.0f}{1000 * seconds / runs:12.1f}{evaluations / least:16,.0f}"
        print(f"  {method:14}{rates}{seconds / least:20.2f}")


def benchmark_chaotic_pso() -> None:
    """Methods of tharwat2018 among its three circles, without the early stop."""
    study = study_file.load(study_file.read_config({"studies": ["tharwat2018"]}))["tharwat2018"]
    circles = files.load(study.workspaces["equal"], study.folder)
    problem = Problem("equal", circles, (0.0, 0.0), (4.0, 6.0))
    runs = 200
    print(f"\n{'chaotic_pso':16}{'evaluations/s':>16}{'ms a run':>12}")
    for method in ("pso", "cpso1_singer", "cpso2_singer"):
        settings = study.resolved(method) | {"stall_limit": 0}
        evaluations = runs * settings["particles"] * (settings["iterations"] + 1)
        seconds = cpu_seconds(lambda: [chaotic_pso.plan(problem, np.random.default_rng(seed), **settings) for seed in range(runs)])  # noqa: B023
        print(f"  {method:14}{evaluations / seconds:16,.0f}{1000 * seconds / runs:12.2f}")


def benchmark_fields() -> None:
    """Methods of elhoseny2017 from corner to corner of its fields with 15 obstacles, small and large ones."""
    study = study_file.load(study_file.read_config({"studies": ["elhoseny2017"]}))["elhoseny2017"]
    runs = 10
    print(f"\n{'random fields':16}{'evaluations/s':>16}{'ms a run':>12}{'side':>8}  obstacles")
    for side, home in itertools.product((100, 200), ("published_like", "dense")):
        described = {"side": side, "start": (0, 0), "target": (side, side), "obstacles": 15}
        fields = [random_field.field(study.workspaces[home], described | {"layout": i}, home) for i in range(runs)]
        problems = [Problem(home, grid, (0.0, 0.0), (float(side), float(side))) for grid in fields]
        for method in study.experiments["fields100"]["methods"]:
            planner, settings = planner_module(study.planner(method)), study.resolved(method)
            plans = [planner.plan(each, np.random.default_rng(0), **settings) for each in problems]
            seconds = cpu_seconds(lambda: [planner.plan(each, np.random.default_rng(0), **settings) for each in problems])  # noqa: B023
            rate = f"{sum(each.evaluations for each in plans) / seconds:16,.0f}"
            print(f"  {method:14}{rate}{1000 * seconds / runs:12.2f}{side:8}  {home}")


def random_grid(side: int, rng: np.random.Generator) -> Grid:
    """A grid of that many rows and columns with 25 rectangular blocks, two corners free."""
    occupied = np.zeros((side, side), dtype=bool)
    for row, column in rng.integers(1, side - 1, (25, 2)):
        height, width = rng.integers(1, max(2, side // 8), 2)
        occupied[row : row + height, column : column + width] = True
    occupied[0, 0] = occupied[-1, -1] = False
    return Grid(occupied, 1.0, "cell")


def random_discs(count: int, rng: np.random.Generator) -> Circles:
    """Discs in a square, two corners free."""
    centres = rng.uniform(2, 18, (count, 2))
    return Circles((0.0, 20.0, 0.0, 20.0), centres, rng.uniform(0.3, 1.0, count), "unit")


def workspaces() -> Iterator[tuple[str, Workspace]]:
    """Workspaces of every kind, small and large, by name."""
    rng = np.random.default_rng(0)
    for count in (3, 10, 25):
        yield f"circles {count}", random_discs(count, rng)
    for side in (16, 20, 100, 200):
        yield f"cells {side} x {side}", random_grid(side, rng)
    for file in sorted((Path(__file__).parents[1] / "data" / "maps" / "imr").glob("*.geojson")):
        yield f"polygons {file.stem}", files.polygons_from_geojson(file.read_text(), "m")


def benchmark_node_genetic() -> None:
    """The proposed mutation of meledje on the maps of the study, and on random maps of growing size.

    Prepared once a map: the least energy of all paths, and up to `node_genetic.TABLE_CELLS` cells a table of all edges, whose size is told.
    """
    study = study_file.load(study_file.read_config({"studies": ["meledje"]}))["meledje"]
    maps = {name: (files.load(study.workspaces[name], study.folder), study.problems[name]["settings"]) for name in list(study.problems)[:4]}
    maps |= {f"{side} x {side}": (_grid_in_the_way(side), {}) for side in (16, 32, 64, 128)}
    print(f"\n{'node_genetic':16}{'prepared in s':>16}{'ms a run':>12}{'MB of edges':>16}")
    for name, (grid, own) in maps.items():
        settings = study.resolved("proposed") | own
        problem = Problem(name, grid, grid.centre(0), grid.centre(grid.occupied.size - 1))
        ground = node_genetic.ground_of(grid, settings["friction"])
        prepared = cpu_seconds(lambda: _prepare(grid, settings["friction"]), rounds=1)  # noqa: B023
        runs = 20
        seconds = cpu_seconds(lambda: [node_genetic.plan(problem, np.random.default_rng(seed), **settings) for seed in range(runs)])  # noqa: B023
        print(f"  {name:14}{prepared:16.3f}{1000 * seconds / runs:12.2f}{(ground.met.nbytes + ground.energy.nbytes) / 1e6:16.1f}")


def _grid_in_the_way(side: int) -> Grid:
    """A random grid whose corners do not see each other, so that there is something to search."""
    grids = (random_grid(side, np.random.default_rng(seed)) for seed in itertools.count(side))
    return next(each for each in grids if node_genetic.obstacles_met(node_genetic.ground_of(each, 1.0), 0, side * side - 1))


def _prepare(grid: Grid, friction: float) -> None:
    node_genetic._ground.cache_clear()
    node_genetic.cheapest(node_genetic.ground_of(grid, friction), 0, grid.occupied.size - 1)


def benchmark_geometry() -> None:
    """Microseconds a check (median over random curves, half of them short) and milliseconds a bound from corner to corner."""
    print(f"\n{'workspace':26}{'check: median us':>18}{'99 % us':>10}{'colliding':>11}{'bound: ms':>12}")
    rng = np.random.default_rng(1)
    for name, workspace in workspaces():
        blocked = region(workspace)
        x_low, x_high, y_low, y_high = workspace.bounds
        seconds, colliding = [], 0
        for trial in range(401):
            first = rng.uniform((x_low, y_low), (x_high, y_high))
            reach = (x_high - x_low) * (0.05 if trial % 2 else 1.0)
            points = np.clip(first + rng.uniform(-reach, reach, (6, 2)), (x_low, y_low), (x_high, y_high))
            pieces = curves.bezier_pieces(Curve(("bezier", "piecewise_quadratic")[trial // 2 % 2], points))
            before = time.perf_counter()
            found = checker.check(pieces, blocked)
            seconds.append(time.perf_counter() - before)
            colliding += not found.feasible
        times = 1e6 * np.array(seconds[1:])
        inset = 0.5 * getattr(workspace, "cell", 0.02)
        corners = Problem("bound", workspace, (x_low + inset, y_low + inset), (x_high - inset, y_high - inset))
        bound = 1e3 * cpu_seconds(lambda: bounds.shortest_path(corners))  # noqa: B023
        print(f"  {name:24}{np.median(times):18.0f}{np.quantile(times, 0.99):10.0f}{colliding / 401:11.2f}{bound:12.2f}")


def benchmark_start() -> None:
    """CPU seconds of what every run job imports, of the check of the configuration, and of `bezierplan list`."""
    print(f"\n{'start-up':26}{'CPU s':>18}")
    for name, command in {
        "imports of a run job": ["-c", "import pyarrow.parquet; from bezierplan import problems, running"],
        "bezierplan list": ["-m", "bezierplan", "list"],
    }.items():
        seconds = []
        for _ in range(ROUNDS):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.executable, *command], env=os.environ | {"PYTHONPATH": SOURCE}, stdout=subprocess.DEVNULL, check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        print(f"  {name:24}{min(seconds):18.2f}")


if __name__ == "__main__":
    benchmark_binary_genetic()
    benchmark_chaotic_pso()
    benchmark_node_genetic()
    benchmark_fields()
    benchmark_geometry()
    benchmark_start()
