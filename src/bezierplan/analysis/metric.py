"""The model of a metric, and the decorators by which a function becomes one (`measures`)."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from bezierplan.running import columns

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.workspaces.problem import Path, Problem, Workspace

    Problems = dict[str, Problem]
    Compute = Callable[[pd.DataFrame, Problems], Any]

# Measures of paths that a process remembers, since several checks of claims ask for the same ones:
# up to some 200 MB.
MEASURES_KEPT = 250_000


class Metric(NamedTuple):
    """A quantity that is measured of each run.

    Attributes
    ----------
    unit : str
        `u` stands for the workspace's unit of length, `-` for a number without unit.
    meaning : str
        One phrase.
    compute : callable or None
        (runs, problems) -> one number per run (n,), where runs is a table of at least one run; None
        for a column of the runs table.
    feasible_only : bool
        Whether it is taken over the runs whose path the certified checker accepts, otherwise over
        all runs.
    among_rows : bool
        Whether it compares the methods of a table with each other, so that variants and baselines
        outside the table have none.
    least : float or str
        The smallest value that a run can have, or the column of the runs table that holds it.
    most : float
        The largest value that a run can have.
    bound : str
        The column with the bound for this kind of length.
    gap : str
        The metric of the gap to that bound.
    step : float or None
        The distance between possible values of a run, 1 for whole numbers; None if there is none.
    needs : tuple of str
        Columns that only some runs tables have; with none, and without compute, the column of its
        own name.
    on : tuple of str
        Kinds of workspace; () for all.
    own : bool
        Whether a study outside this project declares it; then it is finite, or nan.
    """

    unit: str
    meaning: str
    compute: Compute | None = None
    feasible_only: bool = False
    among_rows: bool = False
    least: float | str = -np.inf
    most: float = np.inf
    bound: str = "bound"
    gap: str = "gap"
    step: float | None = None
    needs: tuple[str, ...] = ()
    on: tuple[str, ...] = ()
    own: bool = False


class Metrics(dict[str, Metric]):
    """Metrics by name: those of every study once `metrics` is imported, and those of a study's own
    code once that is loaded. Any other name is a column of the runs table.
    """

    def __missing__(self, name: str) -> Metric:
        """Return the metric of a column of the runs table that has no own one."""
        return Metric("-", name.replace("_", " "))


METRICS = Metrics()
COLUMNS = columns.read_columns(
    *(table for own in columns.TABLES.values() for table in (*own.every, own.drives))
)
ALL_STUDIES: set[str] = set()
"""Names of the metrics of every study, which no study declares anew."""


def register(functions: dict[str, Metric]) -> None:
    """Add metrics to `METRICS`. Raises ValueError for a name of every study's."""
    for name in ALL_STUDIES.intersection(functions):
        raise ValueError(f"metric {name}: every study has one of this name; choose another")
    METRICS.update(functions)


def build_count(meaning: str, compute: Compute | None = None, **more: Any) -> Metric:
    """Build the metric of a count of every run, or of something that is true of it: 1 or 0."""
    return Metric("-", meaning, compute, step=1.0, **more)


def build_column_metric(name: str, **more: Any) -> Metric:
    """Build the metric of a column that every table of runs, of drives or of their bounds and times
    has; unit and meaning are those of the column.
    """
    values, column = COLUMNS[name]
    unit = {"units": "u", "": "-"}.get(column.unit, column.unit)
    whole = {"step": 1.0} if values in (int, bool) else {}
    return Metric(unit, column.meaning, **whole, **more)


def build_generation(meaning: str, compute: Compute) -> Metric:
    """Build the metric of the number of a generation of every run."""
    return Metric("generation", meaning, compute, least=0.0, step=1.0)


F = TypeVar("F", bound=Callable[..., Any])


def metric(
    unit: str,
    meaning: str,
    adapter: Callable[[F], Compute] = lambda function: function,
    **facts: Any,
) -> Callable[[F], F]:
    """Return a decorator that makes a function the metric of its own name.

    facts: fields of `Metric`. adapter: turns the function into one of (runs, problems).
    """

    def register_function(function: F) -> F:
        """Register the metric of a function, and return the function unchanged."""
        # Metrics of this project may be infinite, such as a curvature jump; those of others may
        # not.
        own = not function.__module__.startswith("bezierplan.")
        metric = Metric(unit, meaning, adapter(function), **facts, own=own)
        register({function.__name__: metric})
        return function

    return register_function


def of_path(unit: str, meaning: str, **facts: Any) -> Callable[[F], F]:
    """Return a decorator like `metric` for a measure of a path; over feasible runs unless said
    otherwise.
    """
    return metric(
        unit,
        meaning,
        lambda measure: partial(measure_on_maps, lambda path, _: measure(path)),
        **{"feasible_only": True} | facts,
    )


def on_map(unit: str, meaning: str, *kinds: str, **facts: Any) -> Callable[[F], F]:
    """Return a decorator like `metric` for a measure of a path and its workspace, over feasible
    runs. kinds: of workspace, for which it is defined.
    """
    facts |= {"feasible_only": True, "on": kinds}
    return metric(unit, meaning, lambda measure: partial(measure_on_maps, measure), **facts)


def measure_on_maps(
    measure: Callable[[Path, Any], float], runs: pd.DataFrame, problems: Problems
) -> list[float]:
    """Measure each run's path in its workspace; NaN where the run has none. Equal measures of equal
    paths are taken once.

    problems: none for a measure of paths alone.
    """
    workspaces = [problems[name].workspace if problems else None for name in runs["problem"]]
    return [
        # Bytes, because an array cannot be a key of the cache.
        _measure(measure, curve, np.asarray(points, dtype=float).tobytes(), workspace)
        for curve, points, workspace in zip(runs["path_curve"], runs["path_points"], workspaces)
    ]


@lru_cache(MEASURES_KEPT)
def _measure(
    measure: Callable[[Path, Any], float], curve: str, points: bytes, workspace: Workspace | None
) -> float:
    """Measure a path, given by its curve kind and the bytes of its points, by which results are
    remembered.
    """
    from bezierplan.workspaces.problem import Path

    if not curve:
        return np.nan
    return measure(Path(curve, np.frombuffer(points).reshape(-1, 2)), workspace)
