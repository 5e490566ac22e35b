"""Which reading of what a paper leaves open explains its published numbers? A search over the choices of `study.choices`.

A reading assigns a value to some choices, by id; all others keep the value in force. It is scored by the joint likelihood of the numbers of
each table: whole experiments are drawn from our runs, so that numbers from the same runs stay correlated, and the published numbers are
placed in the multivariate t distribution of these draws. Beside the score stands how many published numbers lie in the central 95 % of what
experiments of the paper's size would print (`statistics.prediction`). A reading under which a printed mean or extreme lies below the exact
bound of its map is ruled out, whatever its score: no runs at all could have it.
"""

import hashlib
import json
import logging
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet

from bezierplan.analysis import comparison, metrics, statistics, tables
from bezierplan.analysis.explained import Evaluated, Reading, name_of
from bezierplan.analysis.results import Results, joined, select
from bezierplan.planners import planner_module
from bezierplan.running import execution
from bezierplan.running.digest import source_digest
from bezierplan.workspaces.seeds import generator

logger = logging.getLogger(__name__)

# Starts of the search where the grid is too large to be searched completely.
STARTS = 3
# Statistics that cannot lie below the least value of a run, but for a relative rounding error.
_BOUNDED, _ROUNDING = ("mean", "median", "min", "max"), 1e-9
# Draws of whole experiments.
EXPERIMENTS = 500


# One reading.


def job_under(job: dict, reading: Reading, choices: list[dict]) -> dict:
    """A job of runs under a reading: with its settings, and only in the world that it names."""
    settings, worlds = dict(job["settings"]), {}
    for choice in choices:
        if "column" in choice:
            worlds[choice["column"]] = reading.get(choice["id"])
        elif choice["id"] in reading and job["method"] in choice.get("methods", []):
            settings |= {choice["setting"]: reading[choice["id"]]} | choice["along"].get(job["method"], {})
    changed = {choice["setting"] for choice in choices if choice["id"] in reading and job["method"] in choice.get("methods", [])}
    problems = {}
    for name, place in job["problems"].items():
        own = {key: value for key, value in place.get("settings", {}).items() if key not in changed}
        problems[name] = {key: value for key, value in place.items() if key != "settings"} | ({"settings": own} if own else {})
    return job | {"settings": settings, "problems": problems}


def in_world(spec: dict, job: dict, reading: Reading) -> tuple[dict, dict]:
    """A table's description and one of its jobs, restricted to the paper's reading of the world."""
    world = {column: reading.get(column, value) for column, value in spec.get("primary", {}).items()}
    where = spec["where"] | world

    def wanted(column: str, value: Any) -> bool:
        given = where.get(column, value)
        return value in (given if isinstance(given, list) else [given])

    problems = {
        name: place
        for name, place in job["problems"].items()
        if wanted("problem", name) and all(wanted(column, place[column]) for column in place if column != "settings")
    }
    vary = {column: [value for value in values if wanted(column, value)] for column, values in job["vary"].items()}
    return spec | {"where": where}, job | {"problems": problems, "vary": vary}


def under_metrics(spec: dict, published: pd.DataFrame, reading: Reading, choices: list[dict]) -> tuple[dict, pd.DataFrame]:
    """A table's description and its published numbers with the metrics that a reading assigns to printed words.

    A metric that the table has in another entry already stays once.
    """
    metric = {choice["metric"]: reading[choice["id"]] for choice in choices if "metric" in choice and choice["id"] in reading}
    renamed = [entry | {"metric": metric.get(entry["metric"], entry["metric"])} for entry in spec["values"]]
    entries = {(entry["metric"], str(entry["statistic"])): entry for entry in renamed}
    return spec | {"values": [*entries.values()]}, published.assign(metric=published["metric"].replace(metric))


def numbers_of(results: Results, spec: dict, published: pd.DataFrame, name: str) -> tuple[pd.DataFrame, float]:
    """The published numbers of a table under a reading, and the logarithm of their joint likelihood.

    results: the runs of the table's methods. spec: its description, restricted to the reading's world. published: as from
    `comparison.read_published`. name: seeds the draws. Columns: the table's keys, metric, statistic, value_published, low, high, in_range,
    possible (it does not lie below what every run has at least).
    Seconds are left out; with fewer than `statistics.LEAST_RUNS` runs no number is in range.
    """
    given = published.columns[: published.columns.get_loc("metric")].to_list()
    keys = given + [key for key in tables.keys(spec) if key not in given]
    ours = tables.cells(results, spec, keys).assign(printed=lambda table: table["statistic"])
    ours["statistic"] = ours["statistic"].replace("unstated", "median")
    theirs = published.assign(statistic=published["statistic"].replace("unstated", "median"))
    theirs = theirs.astype({key: ours[key].dtype for key in given}).rename(columns={"value": "value_published"})
    both = theirs.merge(ours.drop(columns="value"), on=[*given, "metric", "statistic"], how="left")
    runs = select(results.runs, spec["where"])
    measured = {metric: metrics.values(runs, metric, results.problems) for metric in both["metric"].unique()}
    rows, draws = [], []
    for number, row in both.iterrows():
        if metrics.METRICS[row["metric"]].unit == "s" or not isinstance(row["numbers"], np.ndarray):
            continue
        size = None if pd.isna(row["n"]) else int(row["n"])
        half = 0.0 if pd.isna(row["decimals"]) else 0.5 * 10.0 ** -int(row["decimals"])
        value, single = row["value_published"], (row["least"], row["most"])
        *_, low, high = statistics.prediction(
            row["statistic"], row["numbers"], value, size, None, generator(f"{name}/{number}"), single, row["groups"] or None
        )
        # Without enough runs nothing is in range: a reading under which most runs fail explains nothing.
        enough = len(row["numbers"]) >= statistics.LEAST_RUNS
        described = {key: row[key] for key in [*given, "metric", "statistic", "value_published"]}
        inside = bool(enough and low - half <= value <= high + half)
        below = row["statistic"] in _BOUNDED and value + half < row["least"] * (1 - _ROUNDING)
        rows.append(described | {"low": low - half, "high": high + half, "in_range": inside, "possible": not below})
        own = runs[np.logical_and.reduce([runs[key] == row[key] for key in given])].assign(value=measured[row["metric"]])
        draws.append(_experiments(own, row, name) if enough else np.full(EXPERIMENTS, np.nan))
    frame = pd.DataFrame(rows, columns=[*given, "metric", "statistic", "value_published", "low", "high", "in_range", "possible"])
    return frame, _likelihood(frame["value_published"].to_numpy(dtype=float), np.array(draws), results)


def _experiments(runs: pd.DataFrame, row: pd.Series, name: str) -> np.ndarray:
    """A number of a table in experiments of the paper's size, drawn as a whole from its runs (EXPERIMENTS,): the same units, which are
    repeats or layouts, for all numbers of the table. Experiments within a group are drawn for each number alone.

    runs: with the metric of each as `value`.
    """
    size = None if pd.isna(row["n"]) else int(row["n"])
    if row["groups"]:
        drawn = statistics.predicted_within(row["statistic"], row["groups"], size, generator(f"{name}/{row.name}/within"))
        return drawn[:: len(drawn) // EXPERIMENTS][:EXPERIMENTS]
    values = runs.groupby(_unit_columns(runs))["value"].mean().to_numpy()
    chosen = generator(f"{name}/experiments").integers(1 << 30, size=(EXPERIMENTS, size or len(values))) % len(values)
    if not np.isnan(values).any():
        return statistics.STATISTICS[row["statistic"]](values[chosen])
    return np.array([statistics.statistic(row["statistic"], own[~np.isnan(own)]) for own in values[chosen]])


def _unit_columns(runs: pd.DataFrame) -> list[str]:
    """Columns that number the independent units of an experiment."""
    return [column for column in ("layout", "repeat") if column in runs]


def _likelihood(published: np.ndarray, draws: np.ndarray, results: Results) -> float:
    """Logarithm of the density of the published numbers (k,) in the multivariate t distribution of draws (k, EXPERIMENTS).

    The draws come from n units, which cannot determine k x k covariances: they are shrunk to the diagonal by k / (k + n), and the
    distribution has n - 1 degrees of freedom. A spread below a thousandth of the number counts as that.
    """
    known = ~np.isnan(draws).any(axis=1) if len(draws) else np.zeros(0, dtype=bool)
    units = max(len(results.runs[_unit_columns(results.runs)].drop_duplicates()), 2)
    # A number that cannot be predicted is as unlikely as one ten standard deviations away.
    missing = -50.0 * float((~known).sum())
    if not known.any():
        return missing
    draws, published = draws[known], published[known]
    k, centre = len(draws), draws.mean(axis=1)
    spread = np.maximum(draws.std(axis=1), 1e-3 * np.maximum(np.abs(centre), 1e-3))
    with np.errstate(invalid="ignore"):  # a number without spread is correlated with none
        correlation = np.nan_to_num(np.atleast_2d(np.corrcoef(draws)), nan=0.0) if k > 1 else np.eye(1)
    shrunk = (1 - k / (k + units)) * correlation
    np.fill_diagonal(shrunk, 1.0)
    away = (published - centre) / spread
    freedom = units - 1
    distance = float(away @ np.linalg.solve(shrunk, away))
    logarithms = np.log(spread).sum() + 0.5 * np.linalg.slogdet(shrunk)[1]
    constant = math.lgamma((freedom + k) / 2) - math.lgamma(freedom / 2) - 0.5 * k * math.log(freedom * math.pi)
    return missing + constant - logarithms - 0.5 * (freedom + k) * math.log1p(distance / freedom)


class Evaluator:
    """Evaluates readings on the runs that they need. Runs are kept in a folder under the digest of their job, so that an interrupted search
    continues, and readings that agree on a method share its runs.
    """

    def __init__(self, job: dict, problems: dict[str, dict], bounds: dict[str, pd.DataFrame], files: dict[str, str], folder: Path) -> None:
        """job: as from `study.choices.readings_job`. problems, bounds: by experiment. files: published numbers, by table."""
        self.job, self.problems, self.bounds, self.folder = job, problems, bounds, folder
        self.published = {name: comparison.read_published(files[name], table["spec"]) for name, table in job["tables"].items()}

    def __call__(self, reading: Reading) -> Evaluated | None:
        """The reading, evaluated; None if its settings exclude each other."""
        frames, likelihoods = [], {}
        for name, table in self.job["tables"].items():
            runs = []
            for job in table["jobs"].values():
                spec, chunk = in_world(table["spec"], job_under(job, reading, self.job["choices"]), reading)
                if _excluded(chunk):
                    return None
                runs.append(self._runs(chunk))
            experiment = table["experiment"]
            results = joined(pd.concat(runs, ignore_index=True), self.problems[experiment], self.bounds[experiment])
            spec, published = under_metrics(spec, self._printed(name, reading), reading, self.job["choices"])
            numbers, likelihoods[name] = numbers_of(results, spec, published, f"{self.job['study']}/{name}")
            frames.append(numbers.assign(table=name))
        numbers = pd.concat(frames, ignore_index=True)
        logger.info("%s: %d of %d", name_of(reading), numbers["in_range"].sum(), len(numbers))
        return Evaluated(reading, numbers, likelihoods)

    def _printed(self, name: str, reading: Reading) -> pd.DataFrame:
        """The published numbers of a table; a column that names the world in force names that of the reading."""
        published = self.published[name]
        return published.assign(**{column: value for column, value in reading.items() if column in published})

    def _runs(self, job: dict) -> pd.DataFrame:
        key = source_digest(_planner(job["planner"])) + json.dumps(job, sort_keys=True)
        file = self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.parquet"
        if not file.exists():
            table, times = execution.run_chunk(self.problems[job["experiment"]], job)
            file.parent.mkdir(parents=True, exist_ok=True)
            parquet.write_table(table.append_column("cpu_s", times["cpu_s"]), f"{file}.part")
            Path(f"{file}.part").replace(file)
        return parquet.read_table(file).to_pandas()


def _excluded(job: dict) -> bool:
    """Whether a planner refuses a combination of settings."""
    check = getattr(planner_module(job["planner"]), "check", None)
    settings = [execution.settings_in(job, condition) for condition in execution.conditions(list(job["problems"]), job["vary"])]
    try:
        for each in settings if check else []:
            check(each)
    except ValueError:
        return True
    return False


def _planner(planner: str) -> str:
    """A planner as an argument of `source_digest`."""
    return planner if planner.endswith(".py") else f"bezierplan.planners.{planner}"


# The search.


def search(choices: list[dict], evaluate: Callable[[Reading], Evaluated | None], name: str, most: int) -> list[Evaluated]:
    """The readings tried, in the order of trial, that in force first.

    All of them if there are at most `most`; otherwise by coordinate ascent from the reading in force and from random ones, until `most`
    are tried. evaluate: None for a reading whose settings exclude each other. name: seeds the random starts.
    """
    tried: dict[str, Evaluated | None] = {}

    def rank(reading: Reading) -> tuple[bool, float]:
        key = name_of(reading)
        if key not in tried and len(tried) < most:
            tried[key] = evaluate(reading)
        found = tried.get(key)
        return found.rank if found else (False, -math.inf)

    rank({})
    if math.prod(len(choice["values"]) for choice in choices) <= most:
        for reading in _all(choices):
            rank(reading)
    else:
        for start in _starts(choices, name):
            _ascend(start, choices, rank, lambda: len(tried) >= most)
    return [found for found in tried.values() if found]


def _all(choices: list[dict]) -> Iterator[Reading]:
    readings: list[Reading] = [{}]
    for choice in choices:
        readings = [_with(reading, choice["id"], value, choices) for reading in readings for value in choice["values"]]
    yield from readings


def _starts(choices: list[dict], name: str) -> Iterator[Reading]:
    yield {}
    for number in range(1, STARTS):
        rng = generator(f"{name}/start/{number}")
        drawn = {choice["id"]: choice["values"][rng.integers(len(choice["values"]))] for choice in choices}
        yield _settled({choice: value for choice, value in drawn.items() if value is not None}, choices)


def _with(reading: Reading, choice: str, value: Any, choices: list[dict]) -> Reading:
    """A reading with one choice made; None stands for the value in force."""
    rest = {other: kept for other, kept in reading.items() if other != choice}
    return rest if value is None else _settled(rest | {choice: value}, choices)


def _settled(reading: Reading, choices: list[dict]) -> Reading:
    """A reading without the choices that its world makes itself: with another value they would name runs that are not made."""
    worlds = [choice["overrules"].get(str(reading.get(choice["id"])), []) for choice in choices if "column" in choice]
    return {choice: value for choice, value in reading.items() if choice not in set().union(*worlds)}


def _ascend(reading: Reading, choices: list[dict], rank: Callable, spent: Callable[[], bool]) -> None:
    """Change one choice after the other for the better, until none does."""
    best, improved = rank(reading), True
    while improved and not spent():
        improved = False
        for choice in choices:
            for value in choice["values"]:
                other = _with(reading, choice["id"], value, choices)
                found = rank(other)
                if found > best:
                    reading, best, improved = other, found, True
