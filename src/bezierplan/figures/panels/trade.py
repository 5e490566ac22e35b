"""The excess length of methods against their tightest bend, in which the exact shortest path with
rounded corners is a line over all turning radii, or against CPU time: it shows if a method adds
anything to this baseline.

A panel is of one problem, or of a family of drawn ones: then a point is the median of the problems'
medians, and so is the line at each radius. A path with corners bends without limit: it enters no
median, but is counted; only where all have corners the median is of their excess.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field

from bezierplan.analysis import metrics, naming, statistics
from bezierplan.figures import style
from bezierplan.figures.groups import count_runs, describe_axis
from bezierplan.figures.panels import Note, RunsPanel
from bezierplan.running.columns import Row
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from bezierplan.analysis.results import Results
    from bezierplan.workspaces.problem import Problem

_BASELINE = "rounded_shortest_path"

# A method with fewer free paths than this share is drawn hollow, and adds nothing; nor does one
# with fewer that are free and have no corners: medians of the few that succeed would flatter it.
_OFTEN_FREE = 0.95

# Excesses that differ by less are equal.
_EQUAL = 1e-6

# Radii of the line in each decade, and how many times smaller the least is than the largest that
# fits.
_RADII, _RANGE = (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8), 50

# Excess is drawn in proportion up to this, and then by its logarithm; the ticks of its axis.
_LINEAR = 0.01
_TICKS = (0, 0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1)

# Bends at the edges stand apart from all others by this factor; the axis spans at least this
# factor; and its ticks are at least this share of it apart.
_EDGE, _LEAST_SPAN, _APART = 1.6, 5.0, 0.15

# Where a text stands beside its mark, in points.
_BESIDE = (5, 5)


class Options(RunsPanel):
    x: Literal["bend", "cpu_s"] = Field(
        "bend",
        description="what excess length is drawn against: bend, the largest curvature, with the "
        "rounded shortest path as a line over turning radii (left out: this), or cpu_s",
    )


def data(results: Results, options: Options) -> pd.DataFrame:
    """Return one row a method, and one a radius of the line.

    Columns: part (method or line). Methods have method, runs and feasible_runs (counts), free
    (share of paths that the certified checker accepts), cornered (free paths with corners),
    problems, and against bend adds: the number of problems in which no point of the line is as
    short and as smooth as the method. There the method counts with the lower ends of its intervals
    or, in a family, with its medians; the baseline has no such number. The line has radius, in
    units. Both have x, y (medians) and x_low, x_high, y_low, y_high (their 95 % bootstrap
    intervals, those of a single number at it).
    """
    import pandas as pd

    runs = results.runs.sort_values("id")
    of_bend = options.x == "bend"
    runs = runs.assign(
        x=_measure_bends(runs) if of_bend else runs["cpu_s"],
        y=metrics.compute_values(runs, "gap", results.problems),
    )
    bounds = runs.groupby("problem")["bound"].first()
    # Against CPU time the baseline is a point like the others.
    problems = {name: results.problems[name] for name in bounds.index} if of_bend else {}
    lines = _compute_lines(problems, bounds)
    rows: list[Row] = [
        {"part": "line", "radius": radius} | _compute_medians(own, f"{radius}")
        for radius, own in lines.groupby("radius")
    ]
    for method, of_method in runs.groupby("method"):
        places = {
            name: _compute_medians(few, f"{options.x}/{name}/{method}")
            for name, few in of_method.groupby("problem")
        }
        medians = pd.DataFrame(places.values())
        first, *others = places.values()
        row = {
            "part": "method",
            "method": method,
            "problems": len(places),
            **count_runs(of_method),
            "free": of_method["feasible"].mean(),
            "cornered": int(np.isposinf(of_method["x"]).sum()),
            **(_compute_medians(medians, f"{options.x}/{method}") if others else first),
        }
        if of_bend and of_method["planner"].iloc[0] != _BASELINE:
            round_paths = np.isfinite(of_method["x"])
            often = round_paths.groupby(of_method["problem"]).mean().clip(upper=round_paths.mean())
            row["adds"] = 0
            end = "" if others else "_low"
            for name, place in places.items():
                bend, excess = place[f"x{end}"], place[f"y{end}"]
                # Of all points of the line that are as smooth, the shortest. The radius is a little
                # wider than the method's own bend: else rounding errors could make the point's bend
                # the sharper one, and the method would seem to add something.
                radius = 1.001 / bend if bend > 0 else math.inf
                point = _round_shortest_path(results.problems[name], bounds[name], radius)
                line = lines.loc[lines["problem"] == name, ["x", "y"]].to_numpy()
                row["adds"] += adds(np.vstack([line, point]), bend, excess, often[name])
        rows.append(row)
    return pd.DataFrame(rows)


def adds(line: np.ndarray, bend: float, excess: float, often: float) -> bool:
    """Return True if a method adds something to the line.

    No point (bend, excess) of the line (n, 2) is then as smooth and as short, and its paths are
    often free and without corners. often: the share of such paths.
    """
    as_good = (line[:, 0] <= bend) & (line[:, 1] <= excess + _EQUAL)
    return bool(often >= _OFTEN_FREE and not as_good.any())


def _measure_bends(runs: pd.DataFrame) -> np.ndarray:
    """Return the largest curvature (n,) of each free path, infinite with corners, NaN of others."""
    from bezierplan.analysis.results import build_path
    from bezierplan.geometry.tightest_turn import largest_curvature

    cornered = metrics.compute_values(runs, "corners", {}) > 0
    paths = map(build_path, runs[["path_curve", "path_points"]].to_dict("records"))
    return np.array(
        [
            math.nan if not free else math.inf if sharp else largest_curvature(path)
            for path, free, sharp in zip(paths, runs["feasible"], cornered)
        ]
    )


def _compute_lines(problems: dict[str, Problem], bounds: pd.Series) -> pd.DataFrame:
    """Compute the rounded shortest paths, from a sharp one to the roundest, at the same radii in
    all problems.

    Columns: problem, radius that is asked, x (bend) and y (excess). bounds: lengths of the exact
    shortest paths, by problem, in units.
    """
    import pandas as pd

    def build_point(name: str, radius: float) -> tuple[str, float, float, float]:
        return name, radius, *_round_shortest_path(problems[name], bounds[name], radius)

    rows = [build_point(name, math.inf) for name in problems]
    # The roundest path of a problem tells which radii fit.
    widest = [1 / bend for *_, bend, _ in rows if 0 < bend < math.inf]
    low, high = min(widest, default=1) / _RANGE, max(widest, default=0)
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high or low)) + 1)
    ladder = [float(f"{part}e{power}") for power in decades for part in _RADII]
    radii = [0.0, *(radius for radius in ladder if low <= radius <= high)]
    rows += [build_point(*each) for each in itertools.product(problems, radii)]
    return pd.DataFrame(rows, columns=["problem", "radius", "x", "y"])


def _round_shortest_path(problem: Problem, bound: float, radius: float) -> tuple[float, float]:
    """Return tightest bend and excess of the shortest path rounded by a radius, NaN if there is
    none.
    """
    from bezierplan.geometry.tightest_turn import largest_curvature
    from bezierplan.planners import rounded_shortest_path

    draws = generator("trade/rounded")  # unused: the path is exact
    plan = rounded_shortest_path.plan(problem, draws, turning_radius=radius, excess=math.inf)
    if plan.path is None:
        return math.nan, math.nan
    # An arc of a tiny angle may be too short for its curvature to be measured.
    kept = 0.0 if plan.extra["corners"] else plan.extra["least_radius"]
    bend = max(largest_curvature(plan.path), 1 / kept) if kept else math.inf
    return bend, plan.objective / bound - 1


def _compute_medians(points: pd.DataFrame, name: str) -> dict[str, float]:
    """Return medians of points, rows with x and y, with their intervals.

    Points that bend without limit are left out unless all do.
    """
    bounded = points[np.isfinite(points["x"])]
    middle_of = {}
    for axis in "xy":
        numbers = np.sort((points if bounded.empty else bounded)[axis].dropna())
        middle = middle_of[axis] = statistics.compute_statistic("median", numbers)
        ends = middle, middle
        if len(numbers) > 1 and math.isfinite(middle):
            ends = statistics.compute_interval("median", numbers, generator(f"trade/{name}/{axis}"))
        middle_of[f"{axis}_low"], middle_of[f"{axis}_high"] = ends
    return middle_of


def draw(axes: Axes, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the line and a mark with intervals for each method."""
    of_bend = options.x == "bend"
    placed, sides, edges = _place_at_edges(frame)
    groups = style.list_groups(placed[placed["part"] == "method"], "method", options, scene)
    line = placed[placed["part"] == "line"].sort_values("radius") if of_bend else placed[:0]
    _scale_axes(axes, placed, sides, edges, of_bend)
    if len(line):
        (look,) = style.choose_line_styles([_BASELINE], style.LOOK_OF_PLANNER)
        look |= {"marker": "", "label": "rounded shortest path, any turning radius"}
        axes.plot(line["x"], line["y"], **look)
    for _, rows, look in groups:
        _draw_method(axes, rows.iloc[0], look | {"linestyle": "none"})
    bend = f"tightest bend (1/{scene.unit})"
    axes.set_xlabel(bend if of_bend else describe_axis("cpu_s", scene))
    axes.set_ylabel(describe_axis("gap", scene))
    axes.grid(visible=True)
    return _write_note(frame[frame["part"] == "method"], scene)


def _scale_axes(
    axes: Axes, table: pd.DataFrame, sides: list[float], edges: dict[float, str], of_bend: bool
) -> None:
    """Set the ends, scales and ticks of both axes. sides, edges: as from `_place_at_edges`."""
    axes.set_xlim(sides)
    style.scale_axis(axes.xaxis, "log", "" if of_bend else "s")
    top = 1.5 * np.nanmax(table[["y", "y_high"]].to_numpy(), initial=_EQUAL)
    axes.set_yscale("symlog", linthresh=_LINEAR)
    axes.set_ylim(-0.1 * min(top, _LINEAR), top)
    ticks = [tick for tick in _TICKS if not 0 < tick < 0.15 * min(top, _LINEAR) and tick < top]
    axes.set_yticks(ticks, map("{:g}".format, ticks))
    axes.minorticks_off()
    ticks, span = [*edges], math.log(sides[1] / sides[0])
    for tick in axes.get_xticks():
        away = min((abs(math.log(tick / other)) for other in ticks), default=math.inf)
        if sides[0] < tick < sides[1] and away > _APART * span:
            ticks.append(tick)
    names = [edges.get(tick, f"{tick:g}") for tick in ticks]
    axes.set_xticks(ticks, names if of_bend else None)


def _draw_method(axes: Axes, row: pd.Series, look: dict[str, Any]) -> None:
    """Draw the mark of a method, with intervals and the share of free paths beside it."""
    x, x_low, x_high, y, y_low, y_high = row[["x", "x_low", "x_high", "y", "y_low", "y_high"]]
    axes.plot([], [], **look)
    hollow = {"label": None}
    if row["free"] < _OFTEN_FREE:
        hollow["markerfacecolor"] = style.FREE
        axes.plot([], [], label="hollow: fewer than 95 % of the paths are free", **style.HOLLOW)
    errors = {"xerr": [[x - x_low], [x_high - x]], "yerr": [[y - y_low], [y_high - y]]}
    axes.errorbar(x, y, elinewidth=0.7, **errors, **look | hollow)
    if math.isfinite(x) and math.isfinite(y):
        words = {"fontsize": "x-small", "color": look["color"]}
        text = _describe_paths(row)
        axes.annotate(text, (x, y), _BESIDE, textcoords="offset points", **words)


def _place_at_edges(frame: pd.DataFrame) -> tuple[pd.DataFrame, list[float], dict[float, str]]:
    """Move straight paths, and those that bend like corners, to the edges of a logarithmic axis.

    Returns the table; the ends of the axis; and the names of edges at which something stands.
    """
    numbers = frame[["x", "x_low", "x_high"]].where(frame["y"].notna())
    inside = numbers.to_numpy()[np.isfinite(numbers) & (numbers > 0)]
    of_line = frame.loc[(frame["part"] == "line") & (frame["x"] > 0), "x"]
    inside = inside[inside <= _RANGE * of_line.min()] if len(of_line) else inside
    low, high = (inside.min(), inside.max()) if len(inside) else (1.0, 1.0)
    edges = {}
    if (numbers <= 0).any(axis=None):
        edges[low := low / _EDGE] = "0"
    if (numbers > high).any(axis=None):
        edges[high := high * _EDGE] = "sharp"
    wider = max(1.15, math.sqrt(_LEAST_SPAN * low / high))
    return frame.assign(**numbers.clip(low, high)), [low / wider, high * wider], edges


def _describe_paths(row: pd.Series) -> str:
    """Return the share of free paths, if some are not, and how many of these have corners."""
    free = f"{100 * row['free']:.0f} %" if row["free"] < 1 else ""
    some = row["cornered"] > 0
    corners = f"corners, {row['cornered']:.0f} of {row['feasible_runs']:.0f}" if some else ""
    return ", ".join(filter(None, [free, corners]))


def _write_note(table: pd.DataFrame, scene: Any) -> Note:
    """Say how to read the marks, and which methods add something."""
    names = [naming.format_value(name, "method", scene.labels) for name in table["method"]]
    table = table.assign(name=names)
    several = table["problems"].max() > 1
    said = ["median and 95 % interval" + (" of the medians of the problems" if several else "")]
    said.append("beside a mark the share of paths that are free, where not all are")
    if none := ", ".join(table["name"][table["free"] == 0]):
        said.append(f"no free path: {none}")
    if "adds" in table and table["adds"].notna().any():
        told = (
            row.name + (f" in {row.adds:.0f} of {row.problems:.0f}" if several else "")
            for row in table[table["adds"] > 0].itertuples()
        )
        said.append(f"adds something: {', '.join(told) or 'none'}")
    return Note("", "; ".join(said))
