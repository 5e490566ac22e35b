"""Run time of each planner beside the least that its evaluations cost.

A run is made once more with its kernels as plain Python functions, all but the inner ones, which
stay compiled and whose calls are counted: nothing is added to a kernel. The least is what that many
operations cost in kernels that do nothing else.
"""

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache, partial
from types import ModuleType
from typing import Any
from unittest import mock

import frame
import numpy as np
from numba import njit
from numba.core.dispatcher import Dispatcher

from bezierplan.geometry import cell_length
from bezierplan.planners import Plan, abc_ep, ant_colony, bca, binary_genetic, grid_genetic
from bezierplan.planners.parts import cell_paths, gene_curves, penalised
from bezierplan.workspaces import ground

_SAMPLES, _POINTS, _OBSTACLES = 100, 9, 10

Count = Callable[..., dict[str, int]]


# --------------------------------------------------------------------------------------------------
# What one operation costs: kernels that do nothing else and leave a trace, so that none of it is
# optimised away

OPERATIONS = {
    "terms": "a control point's share of a sample, in x and y",
    "roots": "a chord's length",
    "obstacles": "a sample and a circle or box",
    "edges": "a point and an edge, or a segment and a circle",
    "cells": "a cell looked up",
}


@njit(cache=True)
def _terms(weights, points, x, y):
    for k in range(0, len(points), 3):
        a, b, c = points[k], points[k + 1], points[k + 2]
        for s in range(len(x)):
            x[s] = x[s] + weights[k, s] * a[0] + weights[k + 1, s] * b[0] + weights[k + 2, s] * c[0]
            y[s] = y[s] + weights[k, s] * a[1] + weights[k + 1, s] * b[1] + weights[k + 2, s] * c[1]


@njit(cache=True)
def _roots(x, y, chords):
    for s in range(len(chords)):
        dx, dy = x[s + 1] - x[s], y[s + 1] - y[s]
        chords[s] = np.sqrt(dx * dx + dy * dy)


@njit(cache=True)
def _obstacles(x, y, circles, found):
    for k in range(len(circles)):
        inside = 0
        column, row, square = circles[k, 0], circles[k, 1], circles[k, 2]
        for s in range(len(x)):
            dx, dy = x[s] - column, y[s] - row
            inside += dx * dx + dy * dy < square
        found[0] += inside


@njit(cache=True)
def _edges(x, y, edges, found):
    for s in range(len(x)):
        nearest = np.inf
        for k in range(len(edges)):
            dx, dy = edges[k, 2] - edges[k, 0], edges[k, 3] - edges[k, 1]
            share = ((x[s] - edges[k, 0]) * dx + (y[s] - edges[k, 1]) * dy) / (dx * dx + dy * dy)
            share = min(max(share, 0.0), 1.0)
            nearest = min(
                nearest,
                (edges[k, 0] + share * dx - x[s]) ** 2 + (edges[k, 1] + share * dy - y[s]) ** 2,
            )
        found[s] = nearest


@njit(cache=True)
def _cells(x, y, occupied, columns, numbers, found):
    for s in range(len(x)):
        numbers[s] = np.int32(y[s]) * columns + np.int32(x[s])
    for s in range(len(x)):
        found[0] += occupied[numbers[s]]


@njit(cache=True)
def _repeat(kernel, arguments, times):
    for _ in range(times):
        kernel(*arguments)


def costs() -> dict[str, float]:
    """CPU seconds of one operation of each kind."""
    rng = np.random.default_rng(0)
    x, y = 16 * rng.random((2, _SAMPLES))
    zeros, count = np.zeros((3, _SAMPLES)), np.zeros(1, dtype=np.int64)
    weights, points = rng.random((_POINTS, _SAMPLES)), rng.random((_POINTS, 2))
    boxes, occupied = 16 * rng.random((_OBSTACLES, 4)), rng.random(256) < 0.2
    works = {
        "terms": (_terms, (weights, points, zeros[0], zeros[1]), _POINTS * _SAMPLES),
        "roots": (_roots, (x, y, np.empty(_SAMPLES - 1)), _SAMPLES - 1),
        "obstacles": (_obstacles, (x, y, boxes[:, :3].copy(), count), _OBSTACLES * _SAMPLES),
        "edges": (_edges, (x, y, boxes, zeros[2]), _OBSTACLES * _SAMPLES),
        "cells": (_cells, (x, y, occupied, 16, np.zeros(_SAMPLES, np.int32), count), _SAMPLES),
    }
    times = 5_000
    return {
        name: frame.cpu_seconds(partial(_repeat, kernel, arguments, times)) / (times * number)
        for name, (kernel, arguments, number) in works.items()
    }


# --------------------------------------------------------------------------------------------------
# What a run is asked to do: the operations of a call, from its result and its arguments


def _written_samples(_, points, last, first, stride, count, *__):
    return {"terms": count * len(points)}


def _violation(_, curve, objective, __):
    x, y = curve[0], curve[1]
    polygons = objective.polygons
    done = Counter(obstacles=(len(objective.balls) + len(polygons.deepest)) * len(x))
    for (left, right, bottom, top), edges in zip(polygons.boxes, np.diff(polygons.first)):
        done["edges"] += int(((left < x) & (x < right) & (bottom < y) & (y < top)).sum() * edges)
    return done


def _measured_by_bca(found, genes, cells, curve, scratch, with_clearance):
    samples = curve.ends.shape[1]
    done = Counter(terms=len(genes) * samples, roots=samples - 1, cells=samples)
    if with_clearance and found[1] == 0:
        rows, columns = cells.occupied.shape
        at = columns * np.minimum(scratch[1].astype(int), rows - 1) + np.minimum(
            scratch[0].astype(int), columns - 1
        )
        done["obstacles"] += int((cells.first[at + 1] - cells.first[at]).sum())
    return done


def _stretch(_, cells, occupied, columns, places, basis, stretch, *__):
    first_point, last_point, first, last = stretch
    return {
        "terms": (last_point - first_point + 1) * (last - first + 1),
        "roots": last - first,
        "cells": last - first,
    }


class _Looked:
    """Cells that count how often one is looked up."""

    def __init__(self, occupied: np.ndarray) -> None:
        self.occupied, self.shape, self.times = occupied, occupied.shape, 0

    def __getitem__(self, place: tuple[int, int]) -> bool:
        self.times += 1
        return self.occupied[place]


def _leg(_, occupied, *ends, is_free_leg=cell_length.is_free_leg.py_func):
    looked = _Looked(occupied)
    is_free_leg(looked, *ends)
    return {"cells": looked.times}


def _cells_of_walk(size, rng, walker, walk, count, goal):
    return {"cells": 8 * ((size or count + walker.longest_walk) - count)}


COUNTS: dict[Dispatcher, Count] = {
    cell_length.write_samples: _written_samples,
    cell_length.sum_of_steps: lambda _, x, *__: {"roots": max(len(x) - 1, 0)},
    cell_length.occupied_cells: lambda _, columns, *__: {"cells": len(columns)},
    cell_length.is_free_leg: _leg,
    gene_curves._reach: lambda *_: {"cells": 1},
    penalised.write_curve: lambda _, particle, objective, *__: {"terms": objective.free.size},
    penalised.length: lambda _, curve, *__: {"roots": curve.shape[1] - 1},
    penalised.violation: _violation,
    bca._measure: _measured_by_bca,
    binary_genetic._measure: _stretch,
    abc_ep._length: lambda *_: {"roots": 1},
    ant_colony._walk: lambda _, rng, lattice, trail, heuristic, rules, path, visits, ant: {
        "cells": 8 * int((visits == ant).sum())
    },
    cell_paths.length: lambda _, path, lattice: {"cells": len(path)},
    cell_paths.step_between: lambda *_: {"cells": 8},
    cell_paths.forage: lambda *_: {"cells": 8},
    grid_genetic._extend: _cells_of_walk,
    grid_genetic._cost: lambda _, path, count, *__: {"cells": count},
    ground.obstacles_on: lambda *_: {"cells": 1},
    ground.edge_energy: lambda *_: {"cells": 1},
}


def operations(run: Callable[[], Plan]) -> tuple[Plan, Counter]:
    """The plan of a run and the operations that it was asked for, by kind."""
    done: Counter = Counter()

    def counting(kernel: Dispatcher, count: Count) -> Callable:
        def call(*arguments: Any) -> Any:
            found = kernel(*arguments)
            done.update(count(found, *arguments))
            return found

        return call

    counted = {kernel: counting(kernel, count) for kernel, count in COUNTS.items()}
    own = [module for name, module in sys.modules.items() if name.startswith("bezierplan.")]
    kernels = [
        (module, name, each)
        for module in own
        for name, each in vars(module).items()
        if isinstance(each, Dispatcher)
    ]
    plain = [
        (module, name, counted.get(kernel, kernel.py_func))
        for module, name, kernel in kernels
        if _leads_to_one(kernel)
    ]
    with ExitStack() as stack, np.errstate(all="ignore"):
        for module, name, function in plain:
            stack.enter_context(mock.patch.object(module, name, function))
        return run(), done


@cache
def _leads_to_one(kernel: Dispatcher) -> bool:
    """Whether a kernel counts, or calls one that does, itself or through others."""
    return kernel in COUNTS or any(map(_leads_to_one, _called(kernel)))


def _called(kernel: Dispatcher) -> Iterator[Dispatcher]:
    names, known = kernel.py_func.__code__.co_names, kernel.py_func.__globals__
    own = [known[name] for name in names if name in known]
    for module in [each for each in own if isinstance(each, ModuleType)]:
        own += [getattr(module, name) for name in names if hasattr(module, name)]
    return (each for each in own if isinstance(each, Dispatcher) and each is not kernel)


# Beside the first method of each planner of a study: those whose work is of another kind.
ALSO = {
    "song2016": ["smooth_cubic", "smooth_single", "nonsmooth"],
    "elhoseny2017": ["mga_plain", "mga_c"],
    "ma2020": ["bca_q", "aco_strong", "ga_strong", "aco_ga_strong"],
    "tharwat2018": ["cpso2_singer"],
}


COLUMNS = ("a run", "ms", "least ms", "ratio", *(f"1000 {name}" for name in OPERATIONS))


def _chosen(study: frame.Study) -> Iterator[tuple[str, str]]:
    """Experiment and method of the first method of each planner, and of those of `ALSO`."""
    seen = set()
    for experiment, method in frame.methods(study):
        planner = study.planner(method)
        if planner not in seen or method in ALSO.get(study.key, []):
            seen.add(planner)
            yield experiment, method


def rows(small: bool) -> Iterator[frame.Row]:
    """Cost of each operation; run time, the least that its evaluations cost, and their ratio, under
    the first condition of a method's first experiment; of a method that tests nothing in a kernel,
    no ratio.
    """
    cost = costs()
    for name, seconds in cost.items():
        yield (f"{OPERATIONS[name]} ({name})", 1e3 * seconds, *[""] * (len(COLUMNS) - 2))
    for study in frame.studies(small):
        for experiment, method in [*_chosen(study)][: 1 if small else None]:
            _, run = frame.first_run(study, experiment, method)
            seconds = frame.cpu_seconds(partial(run, 0))
            plan, done = operations(partial(run, 0))
            if plan.objective != run(0).objective:
                sys.exit(f"{study.key} {method}: the run with counters ends in another path")
            least = sum(cost[name] * number for name, number in done.items())
            numbers = [done[name] / 1e3 for name in OPERATIONS]
            ratio = seconds / least if least else np.nan
            yield (f"{study.key} {method}", 1e3 * seconds, 1e3 * least, ratio, *numbers)
