"""tharwat2018: the claims that a comparison of runs cannot judge, what its Figure 3 draws, and an audit of its tables and text.

Numbers of equations, sections, tables and figures are the paper's.
"""

import math

import numpy as np
import pandas as pd

from bezierplan import curves
from bezierplan.analysis.results import Results, path_of, select
from bezierplan.problem import Path, Problem
from bezierplan.search import chaotic_maps

# Parameters of the maps in common use, where the paper gives a range or nothing.
PARAMETERS = chaotic_maps.Parameters(singer_mu=1.07, singer_x4=13.302875, sine_a=4.0, piecewise_p=0.4, sinusoidal_a=2.3)

# The three control points (x, y), in units, of the best single Bezier curves that are known, by workspace: of 300 long runs the ends were
# improved by sequential quadratic programming. Their lengths are 7.7263 and 7.5180.
BEST_KNOWN = {
    "equal": ((-0.4768, 4.5057), (1.8022, 0.8887), (3.1746, 4.9328)),
    "public": ((0.7197, 2.1662), (-0.1836, 2.8501), (2.2284, 1.1334)),
}
MOVED = 1  # which of them moves in Figures 10 and 11: the middle one
GRID = 201  # places along each side of the field

SEQUENCES = 100  # of the Gauss map
FIRST_VALUES = 10  # left out of each of them
CLASS_SAMPLES = 2001  # of a path, by which its way round the circles is told

# Section 5.1: of so many rows each table's ranks are taken; Table 6 ranks the numbers of obstacles.
RANKED = {"table3": 8, "table4": 8, "table5": 5, "table6": 10}
PARTICLES = 20  # Table 2

# The maps of Section 3.3, in its order.
CHAOTIC = chaotic_maps.MAPS[:8]

# What the text says of best values: (place, method said to be better, method said to be worse).
SAID = (
    ("5.3, Fig 8", "cpso1_singer", "cpso1_logistic"),
    ("5.3, Fig 8", "cpso1_logistic", "cpso1_sine"),
    *(
        ("5.3, Fig 8", f"cpso1_{name}", f"cpso1_{worst}")
        for name in CHAOTIC
        for worst in ("tent", "piecewise")
        if name not in ("tent", "piecewise")
    ),
    *(("5.4", better, "pso") for better in ("cpso1_singer", "cpso1_sine", "cpso2_singer", "cpso2_sine")),
    *(("5.4, 5.6, 6", f"cpso2_{name}", f"cpso1_{name}") for name in CHAOTIC),
)


def chaotic_sequences() -> pd.DataFrame:
    """Figure 3: a row for each map of the paper and iteration; columns: map, iteration (1 to 500), value. One random start for each map."""
    rng = np.random.default_rng(0)
    frames = []
    for name in CHAOTIC:
        start = chaotic_maps.random_start(rng, name, PARAMETERS)
        values = chaotic_maps.sequence(name, start, 500, PARAMETERS).values
        frames.append(pd.DataFrame({"map": name, "iteration": np.arange(1, 501), "value": values}))
    return pd.concat(frames, ignore_index=True)


def gauss_above(
    check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame]
) -> tuple[str, float, tuple[float, float] | None, int]:
    """Claim C39: the share of values above 0.7 in long sequences of the Gauss map, their first values left out.

    It has a limit, 1 - log2(1.7) = 0.234, since the map's values have the density 1 / ((1 + x) ln 2). The interval is that of the mean over
    sequences, each of which is one unit.
    """
    rng = np.random.default_rng(0)
    shares = []
    for _ in range(SEQUENCES):
        start = chaotic_maps.random_start(rng, "gauss", PARAMETERS)
        values = chaotic_maps.sequence("gauss", start, 1000, PARAMETERS).values[FIRST_VALUES:]
        shares.append(np.mean(values > 0.7))
    share = float(np.mean(shares))
    reach = 1.96 * float(np.std(shares, ddof=1)) / math.sqrt(SEQUENCES)
    return "-" if share > 0 else "+", share, (share - reach, share + reach), SEQUENCES


def bowl_with_local_minima(
    check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame]
) -> tuple[str, float, tuple[float, float] | None, int]:
    """Claim C16: is the fitness over one control point a bowl, and are there several local minima in it?

    The effect is Spearman's correlation, over the nodes of `landscape`, of the fitness with the distance to the best node. A bowl has more
    than 0.5, and a second strict minimum makes several: + if both hold, - if either fails.
    """
    from scipy import stats

    runs = select(results[check["experiment"]].runs, check.get("where", {}))
    run = runs[runs["planner"] == "chaotic_pso"].iloc[0]
    surface = landscape(results[check["experiment"]].problems[run["problem"]], run["workspace"], int(run["samples"]), float(run["beta"]))
    best = surface.loc[surface["fitness"].idxmin()]
    distance = np.hypot(surface["x"] - best["x"], surface["y"] - best["y"])
    correlation = float(stats.spearmanr(surface["fitness"], distance).statistic)
    minima = local_minima(surface["fitness"].to_numpy().reshape(GRID, GRID))
    return "+" if correlation > 0.5 and minima > 1 else "-", correlation, None, len(surface)


def landscape(problem: Problem, workspace: str, samples: int, beta: float) -> pd.DataFrame:
    """Figures 10 and 11: fitness of a Bezier curve of which one control point moves over the field, the others as in `BEST_KNOWN`.

    One row a node of a square grid, y changing fastest; columns: x, y and fitness, in units. samples, beta: settings of the planner.
    """
    x_low, x_high, y_low, y_high = problem.workspace.bounds
    x, y = np.meshgrid(np.linspace(x_low, x_high, GRID), np.linspace(y_low, y_high, GRID), indexing="ij")
    paths = np.empty((GRID * GRID, len(BEST_KNOWN[workspace]) + 2, 2))
    paths[:] = [problem.start, *BEST_KNOWN[workspace], problem.target]
    paths[:, MOVED + 1] = np.stack([x.ravel(), y.ravel()], axis=1)
    values = [fitness(part, problem, samples, beta) for part in np.array_split(paths, GRID)]  # of parts, to save memory
    return pd.DataFrame({"x": x.ravel(), "y": y.ravel(), "fitness": np.concatenate(values)})


def fitness(paths: np.ndarray, problem: Problem, samples: int, beta: float) -> np.ndarray:
    """Fitness (n,), in units, of Bezier curves with control points (n, k, 2), start and target included: length L (1 + beta V).

    The violation V is, summed over circles, the mean depth of the samples below a circle's edge as a share of its radius (eqs. 19 to 22,
    whose penalty is not printed).
    """
    points = curves.sample_matrix("bezier", paths.shape[1], samples) @ paths
    length = np.hypot(*np.moveaxis(np.diff(points, axis=1), -1, 0)).sum(axis=1)
    violation = np.zeros(len(paths))
    for centre, radius in zip(problem.workspace.centres, problem.workspace.radii):
        distance = np.hypot(*np.moveaxis(points - centre, -1, 0))
        violation += np.maximum(1 - distance / radius, 0).mean(axis=1)
    return length * (1 + beta * violation)


def local_minima(values: np.ndarray) -> int:
    """How many inner values of a grid (n, m) are below all their eight neighbours."""
    inner = values[1:-1, 1:-1]
    rows, columns = inner.shape
    lower = np.ones(inner.shape, dtype=bool)
    for i in range(3):
        for j in range(3):
            if (i, j) != (1, 1):
                lower &= inner < values[i : i + rows, j : j + columns]
    return int(lower.sum())


def several_homotopy_classes(
    check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame]
) -> tuple[str, float, tuple[float, float] | None, int]:
    """Claim C17: among how many classes the final paths are; two paths of one class pass every circle on the same side."""
    found = results[check["experiment"]]
    runs = select(found.runs, check.get("where", {}))
    classes = {homotopy_class(path_of(run), found.problems[run["problem"]]) for _, run in runs.iterrows()}
    return "+" if len(classes) > 1 else "-", float(len(classes)), None, len(runs)


def homotopy_class(path: Path, problem: Problem) -> tuple[bool, ...]:
    """Of each circle, whether the angle that a path sweeps about its centre is positive: whether it leaves the centre to its left.

    Enough to tell classes apart where no path winds round a circle, and where all have the same ends.
    """
    points = curves.sample_matrix(path.curve, len(path.points), CLASS_SAMPLES) @ path.points
    signs = []
    for centre in problem.workspace.centres:
        ahead = points - centre
        angles = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        signs.append(bool(angles[-1] > angles[0]))
    return tuple(signs)


def audit(published: dict[str, pd.DataFrame]) -> list[dict]:
    """What of the printed numbers cannot be, or does not fit what is printed elsewhere.

    Ranks: of k rows the mean ranks add to k (k + 1) / 2, and none is below 1 (Section 5.1 defines them). Collisions: 20 particles have at
    most 20 that collide. No path is shorter than the straight line. Table 5 repeats rows of Tables 3 and 4. What the text says of best
    values and of the second population of Section 5.5 stands beside the tables, and beside itself.
    """
    tables = {name: published[name] for name in RANKED}
    rows = []
    for name, count in RANKED.items():
        total = float(_cells(tables[name], "rank")["value"].sum())
        limit = count * (count + 1) / 2
        consistent = abs(total - limit) <= count * 0.05 + 1e-9  # each of them is printed to one decimal
        rows.append(_row(name, "all rows", f"mean ranks of {count} rows add to {limit:g}, up to rounding", total, limit, consistent))
    straight = float(_said(published, "straight_line_length")[0])
    for name, table in tables.items():
        for metric, rule, limit, sign in (
            ("rank", "a rank is at least 1", 1, 1),
            ("collisions_a", f"of {PARTICLES} particles at most {PARTICLES} collide in an iteration", PARTICLES, -1),
            ("objective", "no path is shorter than the straight line", straight, 1),
        ):
            for row in _cells(table, metric).itertuples():
                rows.append(_row(name, _place(row), rule, row.value, limit, sign * (row.value - limit) >= 0))
    before = pd.concat([tables["table3"], tables["table4"]])
    for metric in ("collisions_a", "objective"):
        first = _by_method(before, metric)
        for row in _cells(tables["table5"], metric).itertuples():
            if row.method in first:
                rule = "Table 5 has the number of Table 3 or 4"
                rows.append(_row("table5", _place(row), rule, row.value, first[row.method], row.value == first[row.method]))
    best = _by_method(pd.concat(list(tables.values())[:3]).drop_duplicates(["method", "metric"]), "objective")
    for place, better, worse in SAID:
        table = "table5" if worse == "pso" else "table4" if better.startswith("cpso2") else "table3"
        rule = f"the text ({place}) has {better} better than {worse}"
        rows.append(_row(table, f"method={better}, metric=objective", rule, best[better], best[worse], best[better] < best[worse]))
    first, second = _said(published, "population_of_second_experiment")
    rows.append(_row("text", "5.5", "one number for the second population of Section 5.5", first, second, first == second))
    return rows


def _row(item: str, place: str, rule: str, printed: float, limit: float, consistent: bool) -> dict:
    return {"item": item, "place": place, "rule": rule, "printed": printed, "limit": limit, "consistent": bool(consistent)}


def _cells(table: pd.DataFrame, metric: str) -> pd.DataFrame:
    """Printed numbers of one metric."""
    return table[table["metric"] == metric]


def _place(row: tuple) -> str:
    """Which cell a printed number is."""
    obstacles = f", obstacles={row.obstacles}" if hasattr(row, "obstacles") else ""
    return f"method={row.method}{obstacles}, metric={row.metric}"


def _by_method(table: pd.DataFrame, metric: str) -> dict[str, float]:
    """Printed numbers of one metric, by method."""
    cells = _cells(table, metric)
    return dict(zip(cells["method"], cells["value"]))


def _said(published: dict[str, pd.DataFrame], quantity: str) -> list[float]:
    """The values that the text gives a quantity, in its order."""
    text = published["text_values"]
    return text.loc[text["quantity"] == quantity, "value"].to_list()
