"""binary_genetic beside the bare minimum of work that its runs ask for: a compiled loop that
evaluates as many curves of the same kind, with the same sparsity, measures them and looks up the
same number of cells, and does nothing else.
"""

import numpy as np
from numba import njit
from timing import cpu_seconds

from bezierplan.geometry import curves
from bezierplan.planners import binary_genetic
from bezierplan.study import reading
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Problem


@njit(cache=True)
def bare_minimum(cells, occupied, basis, first_point, last_point, first_sample, x, y):
    """Total length and occupied samples of the curves of all chromosomes (n, control points): no
    search, no bookkeeping.
    """
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
    study = reading.load(reading.read_config({"studies": ["song2016"]}))["song2016"]
    grid = files.load(study.workspaces["figure2"].plain(), study.folder)
    problem = Problem("0_240", grid, grid.centre(0), grid.centre(240))
    runs = 20
    print(
        f"{'binary_genetic':16}{'evaluations/s':>16}{'ms a run':>12}"
        f"{'bare minimum/s':>16}{'times the minimum':>20}"
    )
    for method in study.experiments["routes"].methods:
        settings = study.resolved(method)
        evaluations = runs * settings["population"] * (settings["generations"] + 1)
        seconds = cpu_seconds(
            lambda: [
                binary_genetic.plan(problem, np.random.default_rng(seed), **settings)  # noqa: B023
                for seed in range(runs)
            ]
        )
        basis = curves.sample_matrix(settings["curve"], settings["genes"] + 2, settings["samples"])
        stretches = binary_genetic.stretches(basis)
        cells = np.random.default_rng(0).integers(
            0, grid.occupied.size, (evaluations // runs, settings["genes"] + 2)
        )
        first_sample = np.append(stretches[:, 2], len(basis))
        x, y = np.empty((2, len(basis)))
        arguments = (
            cells,
            grid.occupied,
            np.ascontiguousarray(basis.T),
            stretches[:, 0],
            stretches[:, 1],
            first_sample,
            x,
            y,
        )
        least = runs * cpu_seconds(lambda: bare_minimum(*arguments))  # noqa: B023
        print(
            f"  {method:14}{evaluations / seconds:16,.0f}{1000 * seconds / runs:12.1f}"
            f"{evaluations / least:16,.0f}{seconds / least:20.2f}"
        )
