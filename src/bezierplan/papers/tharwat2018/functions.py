"""tharwat2018: claims that a comparison of runs cannot judge, data of its figures without runs, and
    an audit of its tables and text.

Numbers of equations, sections, tables and figures are the paper's.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics, statistics
from bezierplan.analysis.claims.effects import (
    LEAST_WITHOUT_EXAMPLE,
    compute_interval_of_draws,
    mark_share,
)
from bezierplan.analysis.results import Results, select
from bezierplan.geometry import curves
from bezierplan.planners.parts import chaotic_maps
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, FunctionResult, Published
    from bezierplan.analysis.claims.kinds.function import Options as FunctionCheck

# The three control points (x, y), in units, of the best known single Bézier curve among the three
# circles, which is 9.3436 long: the best of 120 long runs, each improved by sequential quadratic
# programming.
BEST_KNOWN = ((-0.9955, 3.0857), (1.4285, 3.8218), (-2.2136, 6.6105))

MOVED = 1  # the one that moves in Figures 10 and 11: the middle one
GRID = 201  # places along each side of the field
RIM = 0.01  # least height of a valley's edge above its lowest node, as a share of its value

SEQUENCES = 100  # of the Gauss map
FIRST_VALUES = 10  # discarded from each of them
DIVERGING, LONG = 20, 500  # sequences of each map whose exponents are taken, and their lengths

WHISKER = 1.5  # interquartile ranges from a box to the ends of its whiskers
RESAMPLES, BOXES = 200, 500  # of our runs, and box plots drawn from each
# Runs that end within this share of the shortest path of their class have reached its optimum.
CONVERGED = 0.01

# The maps of Section 3.3, in its order.
CHAOTIC = chaotic_maps.MAPS[:8]


def chaotic_sequences(*, iterations: int, singer_mu: float) -> pd.DataFrame:
    """Compute Figure 3: one row per map of the paper and iteration.

    Columns: map, iteration (from 1), value. Each map has one random start.

    singer_mu: mu of the Singer map.
    """
    rng = generator("tharwat2018/figure3")
    frames = []
    for name in CHAOTIC:
        start = chaotic_maps.draw_start(rng, name, singer_mu)
        values = chaotic_maps.compute_sequence(name, start, iterations, singer_mu).values
        frames.append(
            pd.DataFrame({"map": name, "iteration": np.arange(1, iterations + 1), "value": values})
        )
    return pd.concat(frames, ignore_index=True)


def gauss_above(
    check: "FunctionCheck", results: "Experiments", published: "Published", *, limit: float
) -> "FunctionResult":
    """Judge claim C39 by the share of values above a limit in long sequences of the Gauss map.

    The first values are left out. The share tends to 1 - log2(1 + limit), which is 0.234 for 0.7,
    since the map's values have the density 1 / ((1 + x) ln 2). The interval is the one of the mean
    over sequences, each one unit.
    """
    rng = generator("tharwat2018/C39")
    shares = []
    for _ in range(SEQUENCES):
        start = chaotic_maps.draw_start(rng, "gauss", math.nan)
        values = chaotic_maps.compute_sequence("gauss", start, 1000, math.nan).values[FIRST_VALUES:]
        shares.append(np.mean(values > limit))
    share, ends = _estimate_mean(np.array(shares))
    return "-" if share > 0 else "+", share, ends, SEQUENCES


def _estimate_mean(values: np.ndarray) -> tuple[float, tuple[float, float]]:
    """Return the mean of values (n,) and its interval, from a normal distribution."""
    mean, reach = values.mean(), 1.96 * values.std(ddof=1) / math.sqrt(len(values))
    return float(mean), (float(mean - reach), float(mean + reach))


def sensitive_to_start(
    check: "FunctionCheck",
    results: "Experiments",
    published: "Published",
    *,
    of: str,
    apart: float,
    iterations: int,
    singer_mu: float,
) -> "FunctionResult":
    """Judge claim C46: a map of the paper is sensitive to its first value.

    The effect is the map's Lyapunov exponent: the mean logarithm by which a difference grows in an
    iteration, measured with differences of `apart`. The interval is the one of the mean over
    sequences, each one unit. + if it lies above 0, - if a difference grows less than e-fold in as
    many iterations as a run has.

    of: the map.
    singer_mu: mu of the Singer map.
    """
    rng = generator(f"tharwat2018/C46/{of}")
    exponents = [_estimate_exponent(rng, of, apart, singer_mu) for _ in range(DIVERGING)]
    mean, (low, high) = _estimate_mean(np.array(exponents))
    mark = "+" if low > 0 else "-" if high < 1 / iterations else "?"
    return mark, mean, (low, high), DIVERGING


def _estimate_exponent(
    rng: np.random.Generator, name: str, apart: float, singer_mu: float
) -> float:
    """Return the Lyapunov exponent, per iteration, of a map's sequence from a random start."""
    start = chaotic_maps.draw_start(rng, name, singer_mu)
    values = chaotic_maps.compute_sequence(name, start, LONG, singer_mu).values
    # Towards the middle, so that the neighbour stays within [0, 1].
    beside = np.where(values[:-1] < 0.5, values[:-1] + apart, values[:-1] - apart)
    following = [
        chaotic_maps.compute_sequence(name, each, 2, singer_mu).values[1] for each in beside
    ]
    grown = np.abs(np.array(following) - values[1:]) / np.abs(beside - values[:-1])
    # Two values may be mapped to one: the logarithm of 0 would spoil the mean.
    return float(np.log(np.maximum(grown, np.finfo(float).tiny)).mean())


def bowl_with_local_minima(
    check: "FunctionCheck", results: "Experiments", published: "Published"
) -> "FunctionResult":
    """Judge claim C16: the fitness over one control point is a bowl with several local minima.

    The effect is Spearman's correlation, over the nodes of `compute_landscape`, of the fitness with
    the distance to the best node. A bowl has more than 0.5, and a second valley means several
    minima: + if both hold, - if either fails.
    """
    from scipy import stats

    found = results[check.experiment]
    surface = compute_landscape(found._replace(runs=select(found.runs, check.where)))
    best = surface.loc[surface["objective"].idxmin()]
    distance = np.hypot(surface["x"] - best["x"], surface["y"] - best["y"])
    correlation = float(stats.spearmanr(surface["objective"], distance).statistic)
    minima = int(find_valleys(surface["objective"].to_numpy().reshape(GRID, GRID)).sum())
    return "+" if correlation > 0.5 and minima > 1 else "-", correlation, None, len(surface)


def fitness_landscape(results: Results) -> pd.DataFrame:
    """Compute Figures 10 to 12: `compute_landscape` of runs, with its minima.

    Columns: part, x, y, objective; parts: node, minimum (of a valley), lowest (the lowest node),
        fixed (control points that do not move).
    """
    surface = compute_landscape(results)
    minima = surface[find_valleys(surface["objective"].to_numpy().reshape(GRID, GRID)).ravel()]
    stay = np.delete(BEST_KNOWN, MOVED, axis=0)
    parts = {
        "node": surface,
        "minimum": minima,
        "lowest": surface.loc[[surface["objective"].idxmin()]],
        "fixed": pd.DataFrame(stay, columns=["x", "y"]),
    }
    return pd.concat([frame.assign(part=part) for part, frame in parts.items()], ignore_index=True)


def compute_landscape(results: Results) -> pd.DataFrame:
    """Compute the objective of a Bézier curve with one control point moving over the field, the
    others as in `BEST_KNOWN` (Figures 10 and 11).

    Problem and settings are those of the first run of the swarms. One row per node of a square
    grid, y changing fastest; columns: x, y and objective, in units.
    """
    run = results.runs[results.runs["planner"] == "chaotic_pso"].iloc[0]
    problem = results.problems[run["problem"]]
    x_low, x_high, y_low, y_high = problem.workspace.bounds
    x, y = np.meshgrid(
        np.linspace(x_low, x_high, GRID), np.linspace(y_low, y_high, GRID), indexing="ij"
    )
    paths = np.empty((GRID * GRID, len(BEST_KNOWN) + 2, 2))
    paths[:] = [problem.start, *BEST_KNOWN, problem.target]
    paths[:, MOVED + 1] = np.stack([x.ravel(), y.ravel()], axis=1)
    # In parts, to save memory.
    values = [
        compute_fitness(part, problem, int(run["samples"]), float(run["beta"]))
        for part in np.array_split(paths, GRID)
    ]
    return pd.DataFrame({"x": x.ravel(), "y": y.ravel(), "objective": np.concatenate(values)})


def compute_fitness(paths: np.ndarray, problem: Problem, samples: int, beta: float) -> np.ndarray:
    """Return the fitness (n,), in units, of Bézier curves with control points (n, k, 2), start and
    target included: length L (1 + beta V).

    The violation V is the sum over circles of the mean depth of the samples inside the circle, as a
    share of its radius (eqs. 19 to 22, whose penalty is not printed).
    """
    points = curves.sample_matrix("bezier", paths.shape[1], samples) @ paths
    length = np.hypot(*np.moveaxis(np.diff(points, axis=1), -1, 0)).sum(axis=1)
    violation = np.zeros(len(paths))
    for centre, radius in zip(problem.workspace.centres, problem.workspace.radii):
        distance = np.hypot(*np.moveaxis(points - centre, -1, 0))
        violation += np.maximum(1 - distance / radius, 0).mean(axis=1)
    return length * (1 + beta * violation)


def find_local_minima(values: np.ndarray) -> np.ndarray:
    """Tell which values of a grid (n, m) are below all eight neighbours, never those at its
    edge.
    """
    from scipy import ndimage

    around = np.ones((3, 3), dtype=bool)
    around[1, 1] = False
    return values < ndimage.minimum_filter(
        values.astype(float), footprint=around, mode="constant", cval=-np.inf
    )


def find_valleys(values: np.ndarray) -> np.ndarray:
    """Tell which values of a grid (n, m) are the lowest of a valley of their own: (n, m).

    A local minimum belongs to another's valley if a path over neighbouring nodes leads from it to a
    lower node and climbs by no more than `RIM`. A narrow valley oblique to the grid has many such
    minima.
    """
    from scipy import ndimage

    lowest = find_local_minima(values)
    for node in zip(*np.nonzero(lowest)):
        valley, _ = ndimage.label(values <= values[node] * (1 + RIM), structure=np.ones((3, 3)))
        lowest[node] = values[valley == valley[node]].min() == values[node]
    return lowest


def several_homotopy_classes(
    check: "FunctionCheck", results: "Experiments", published: "Published"
) -> "FunctionResult":
    """Judge claim C17 by the number of classes in which runs converge; two paths of one class pass
    every circle on the same side.

    A class counts if two or more runs end within 1 % of the shortest path that any run has in it:
    they have reached the same optimum.
    """
    found = results[check.experiment]
    runs = select(found.runs, check.where)
    classes = metrics.compute_values(runs, "homotopy", found.problems)
    least = runs.groupby(classes)["length"].transform("min")
    converged = classes[runs["length"] <= least * (1 + CONVERGED)].value_counts()
    number = int((converged > 1).sum())
    few = len(runs) < LEAST_WITHOUT_EXAMPLE
    return "+" if number > 1 else "?" if few else "-", float(number), None, len(runs)


def least_above(
    check: "FunctionCheck", results: "Experiments", published: "Published", *, limit: int
) -> "FunctionResult":
    """Judge claim C3: the least mean value belongs to more particles than a limit.

    The effect is the share of bootstrap draws from our repeats in which it does; repeats with equal
    numbers start alike and are drawn together.
    """
    runs = select(results[check.experiment].runs, check.where)
    values = runs.pivot_table(index="repeat", columns="particles", values=check.metric).dropna()
    rng = generator("tharwat2018/C3")
    means = values.to_numpy()[rng.integers(len(values), size=(statistics.DRAWS, len(values)))].mean(
        axis=1
    )
    share = float((values.columns.to_numpy()[means.argmin(axis=1)] > limit).mean())
    return mark_share(share), share, None, len(values)


def fewer_outliers(
    check: "FunctionCheck",
    results: "Experiments",
    published: "Published",
    *,
    runs_drawn: int,
    margin: float,
) -> "FunctionResult":
    """Judge claim C20: box plots of as many runs as the paper's show outliers for Singer less often
    than for the other maps.

    One figure without any for Singer says little: with ten runs, any map shows none in many draws.
    The effect is the share of draws of `runs_drawn` runs in which neither variant has an outlier,
    for Singer less the mean of the other maps; its interval comes from resamples of our runs.
    """
    runs = select(results[check.experiment].runs, check.where)
    rng = generator("tharwat2018/C20")
    clear = {}
    for name in CHAOTIC:
        inside = np.ones((RESAMPLES, BOXES), dtype=bool)
        for variant in ("cpso1", "cpso2"):
            values = runs.loc[runs["method"] == f"{variant}_{name}", check.metric].to_numpy()
            resampled = values[rng.integers(len(values), size=(RESAMPLES, len(values)))]
            drawn = resampled[
                np.arange(RESAMPLES)[:, None, None],
                rng.integers(len(values), size=(RESAMPLES, BOXES, runs_drawn)),
            ]
            low, high = np.quantile(drawn, [0.25, 0.75], axis=-1, keepdims=True)
            reach = WHISKER * (high - low)
            inside &= ((low - reach <= drawn) & (drawn <= high + reach)).all(axis=-1)
        clear[name] = inside.mean(axis=1)
    effects = clear.pop("singer") - np.mean(list(clear.values()), axis=0)
    effect, (low, high) = float(effects.mean()), compute_interval_of_draws(effects)
    within = "0" if -margin <= low and high <= margin else "?"
    mark = (
        "+" if effect >= margin and low > 0 else "-" if effect <= -margin and high < 0 else within
    )
    return mark, effect, (low, high), len(runs) // (2 * len(CHAOTIC))
