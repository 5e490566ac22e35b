"""How likely are a paper's published numbers under an interpretation of what it leaves open?
`search` looks for the best interpretation.

An interpretation assigns a value to some choices (`study.choices`), by id; all others keep the
default. It is scored by the joint likelihood of the numbers of each table and part: whole
experiments are drawn from our runs, so that numbers from the same runs stay correlated, and the
published numbers are placed in the multivariate t distribution of these draws. Numbers of different
parts, which are methods that no metric compares with each other, count as independent given the
interpretation. Beside the score stands how many published numbers lie in the central 95 % of what
experiments of the paper's size would print (`statistics.prediction`). An interpretation under which
a printed mean or extreme lies below the exact bound of its map is ruled out, whatever its score: no
runs at all could have it.
"""

import hashlib
import json
import logging
import math
import multiprocessing
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet

from bezierplan.analysis import comparison, explained, metrics, statistics, tables
from bezierplan.analysis.explained import Evaluated, Interpretation, name_of, together
from bezierplan.analysis.results import Results, joined, select
from bezierplan.analysis.search import Evaluate, Task, confirm, search, within_reach
from bezierplan.analysis.search_job import WITHOUT, Choice, Part, Search, Stage
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.planners import planner_module
from bezierplan.running import execution, rows
from bezierplan.running import problems as problem_files
from bezierplan.running.chunk import Chunk
from bezierplan.running.digest import module_of, source_digest
from bezierplan.running.watchdog import end_with_parent
from bezierplan.workspaces.seeds import generator

logger = logging.getLogger(__name__)

# Statistics that cannot lie below the least value of a run, but for a relative rounding error.
_BOUNDED, _ROUNDING = ("mean", "median", "min", "max"), 1e-9
# Draws of whole experiments.
EXPERIMENTS = 500
# How often the runs of an interpretation are resampled for the error of its score.
RESAMPLES = 25
# So many times as many interpretations as there are finalists may be judged by all runs before.
JUDGED = 3


# One interpretation.


def chunk_under(chunk: Chunk, interpretation: Interpretation, choices: list[Choice]) -> Chunk:
    """A chunk of runs under an interpretation: with its settings, and only in the world that it
    names.
    """
    settings, problems = (
        dict(chunk.settings),
        {name: dict(place.get("settings", {})) for name, place in chunk.problems.items()},
    )
    # Choices for some problems alone are stronger than those for all.
    for choice in sorted(choices, key=lambda choice: bool(choice.problems)):
        if choice.id in interpretation and chunk.method in choice.methods:
            made = {choice.setting: interpretation[choice.id]}
            made |= choice.along.get(chunk.method, {})
            if choice.problems:
                for name in problems.keys() & set(choice.problems):
                    problems[name] |= made
                continue
            settings |= made
            for own in problems.values():
                own.pop(choice.setting, None)
    bare = {
        name: {key: value for key, value in place.items() if key != "settings"}
        for name, place in chunk.problems.items()
    }
    met = {
        name: place | ({"settings": problems[name]} if problems[name] else {})
        for name, place in bare.items()
    }
    return chunk._replace(settings=settings, problems=met)


def in_world(spec: Pivot, chunk: Chunk, interpretation: Interpretation) -> tuple[Pivot, Chunk]:
    """A table's description and one of its chunks, restricted to the paper's interpretation of the
    world.
    """
    world = {column: interpretation.get(column, value) for column, value in spec.primary.items()}
    where = spec.where | world

    def wanted(column: str, value: Any) -> bool:
        given = where.get(column, value)
        return value in (given if isinstance(given, list) else [given])

    problems = {
        name: place
        for name, place in chunk.problems.items()
        if wanted("problem", name)
        and all(wanted(column, place[column]) for column in place if column != "settings")
    }
    vary = {
        column: [value for value in values if wanted(column, value)]
        for column, values in chunk.vary.items()
    }
    return spec.but(where=where), chunk._replace(problems=problems, vary=vary)


def under_metrics(
    spec: Pivot, published: pd.DataFrame, interpretation: Interpretation, choices: list[Choice]
) -> tuple[Pivot, pd.DataFrame]:
    """A table's description and its published numbers, with the metrics that an interpretation
    assigns to printed words, and the keys that it changes.

    A metric that the table has in another entry already stays once.
    """
    metric = {
        choice.metric: interpretation[choice.id]
        for choice in choices
        if choice.metric and choice.id in interpretation
    }
    renamed = [entry.but(metric=metric.get(entry.metric, entry.metric)) for entry in spec.values]
    entries = {(entry.metric, str(entry.statistic)): entry for entry in renamed}
    keys = {
        choice.table: None if interpretation[choice.id] == WITHOUT else interpretation[choice.id]
        for choice in choices
        if choice.table and choice.id in interpretation
    }
    return spec.but(**keys, values=[*entries.values()]), comparison.as_read(published, metric)


def numbers_of(
    results: Results, spec: Pivot, published: pd.DataFrame, name: str, resamples: int = 0
) -> tuple[pd.DataFrame, float, np.ndarray]:
    """The published numbers of a table under an interpretation, the logarithm of their joint
    likelihood, and what it is by resampled runs (resamples,).

    results: the runs of the table's methods. spec: its description, restricted to the
    interpretation's world. published: as from `comparison.read_published`. name: seeds the draws,
    so that interpretations are resampled alike. Columns: the table's keys, metric, statistic,
    value_published, low, high, in_range, possible (it does not lie below what every run has at
    least). Seconds are left out. Where most runs fail, so that fewer than half of them count and
    fewer than `statistics.LEAST_RUNS`, low and high are nan, and no number is in range.
    """
    keys_printed = published.columns[: published.columns.get_loc("metric")].to_list()
    keys = keys_printed + [key for key in spec.key_columns if key not in keys_printed]
    ours = tables.cells(results, spec, keys).assign(printed=lambda table: table["statistic"])
    ours["statistic"] = ours["statistic"].replace("unstated", "median")
    theirs = published.assign(statistic=published["statistic"].replace("unstated", "median"))
    theirs = theirs.astype({key: ours[key].dtype for key in keys_printed}).rename(
        columns={"value": "value_published"}
    )
    both = theirs.merge(
        ours.drop(columns="value"), on=[*keys_printed, "metric", "statistic"], how="left"
    )
    runs = select(results.runs, spec.where)
    measured = {
        metric: metrics.values(runs, metric, results.problems) for metric in both["metric"].unique()
    }
    # A constant that nothing lies below, such as the first rank, tells no interpretation from
    # another.
    bounded = {
        entry.metric
        for entry in spec.values
        if isinstance(entry.least or metrics.METRICS[entry.metric].least, str)
    }
    described_by = [*keys_printed, "metric", "statistic", "value_published"]
    rows, samples, least = [], [], []
    for number, row in both.iterrows():
        if metrics.METRICS[row["metric"]].unit == "s" or not isinstance(row["numbers"], np.ndarray):
            continue
        size = None if pd.isna(row["n"]) else int(row["n"])
        half = 0.0 if pd.isna(row["decimals"]) else 0.5 * 10.0 ** -int(row["decimals"])
        value, single = row["value_published"], (row["least"], row["most"])
        rng, groups = generator(f"{name}/{number}"), row["groups"] or None
        *_, low, high = statistics.prediction(
            row["statistic"], row["numbers"], value, size, None, rng, single, groups
        )
        # An interpretation under which most runs fail explains nothing.
        enough = len(row["numbers"]) >= min(statistics.LEAST_RUNS, math.ceil(row["asked"] / 2))
        if not enough:
            low = high = math.nan
        described = {key: row[key] for key in described_by}
        inside = bool(low - half <= value <= high + half)
        below = (
            row["metric"] in bounded
            and row["statistic"] in _BOUNDED
            and value + half < row["least"] * (1 - _ROUNDING)
        )
        rows.append(
            described
            | {"low": low - half, "high": high + half, "in_range": inside, "possible": not below}
        )
        own = runs[np.logical_and.reduce([runs[key] == row[key] for key in keys_printed])].assign(
            value=measured[row["metric"]]
        )
        samples.append(_Sample(_units(own, row), row["statistic"], size, name, number, enough))
        least.append(max(half / math.sqrt(3), _least_of_count(row, size)))
    columns = [*described_by, "low", "high", "in_range", "possible"]
    frame = pd.DataFrame(rows, columns=columns)
    printed, floors = frame["value_published"].to_numpy(dtype=float), np.array(least)
    drawn = np.array([_experiments(sample) for sample in samples])
    again = [
        [_experiments(_resampled(sample, number)) for sample in samples]
        for number in range(resamples)
    ]
    likelihood, *others = (
        _likelihood(printed, np.array(each), floors, results) for each in (drawn, *again)
    )
    return frame, likelihood, np.array(others)


class _Sample(NamedTuple):
    """What experiments that print a number are drawn from. units: our values (n,), one a unit, or,
    if an experiment lies within a group, those of each group. size: runs of the paper's experiment.
    table, number: which number of which table it is. enough: whether the units suffice.
    """

    units: np.ndarray | list[np.ndarray]
    statistic: str
    size: int | None
    table: str
    number: int
    enough: bool


def _units(runs: pd.DataFrame, row: pd.Series) -> np.ndarray | list[np.ndarray]:
    """The units of a number: repeats, layouts, or groups of these. runs: with the metric of each as
    `value`.
    """
    if row["groups"]:
        return [*row["groups"]]
    return runs.groupby(_unit_columns(runs))["value"].mean().to_numpy()


def _resampled(sample: _Sample, number: int) -> _Sample:
    """A sample whose units are drawn from its own with replacement: the same ones for all numbers
    of a table and under all interpretations.
    """
    count = len(sample.units)
    chosen = generator(f"{sample.table}/resampled/{number}").integers(1 << 30, size=count) % count
    return sample._replace(
        units=[sample.units[place] for place in chosen]
        if isinstance(sample.units, list)
        else sample.units[chosen]
    )


def _experiments(sample: _Sample) -> np.ndarray:
    """A number of a table in experiments of the paper's size, drawn as a whole from its runs
    (EXPERIMENTS,): the same units, which are repeats or layouts, for all numbers of the table.
    Experiments within a group are drawn for each number alone. Nan without enough units.
    """
    units, size, statistic = sample.units, sample.size, sample.statistic
    if not sample.enough:
        return np.full(EXPERIMENTS, np.nan)
    if isinstance(units, list):
        drawn = statistics.predicted_within(
            statistic, units, size, generator(f"{sample.table}/{sample.number}/within")
        )
        return drawn[:: len(drawn) // EXPERIMENTS][:EXPERIMENTS]
    # Of a number of runs that is not stated, a single one, as `statistics.prediction` has it.
    chosen = generator(f"{sample.table}/experiments").integers(
        1 << 30, size=(EXPERIMENTS, size or 1)
    ) % len(units)
    if not np.isnan(units).any():
        return statistics.STATISTICS[statistic](units[chosen])
    drawn = np.array(
        [statistics.statistic(statistic, own[~np.isnan(own)]) for own in units[chosen]]
    )
    # An experiment all of whose runs fail prints no number; the one in print did.
    printed = ~np.isnan(drawn)
    if printed.any():
        drawn[~printed] = np.resize(drawn[printed], (~printed).sum())
    return drawn


def _unit_columns(runs: pd.DataFrame) -> list[str]:
    """Columns that number the independent units of an experiment."""
    return [column for column in ("layout", "repeat") if column in runs]


def _least_of_count(row: pd.Series, size: int | None) -> float:
    """The least spread of a count or share, 0 for other statistics.

    If none of our n runs has an event, its probability may still be some 3 / n, so that a printed 2
    of 100 is no wonder: that of Jeffreys' prior (Brown, Cai and DasGupta 2001, "Interval estimation
    for a binomial proportion").
    """
    if row["statistic"] not in ("count", "share"):
        return 0.0
    runs = row["numbers"]
    share = (runs.sum() + 0.5) / (len(runs) + 1)
    asked = size or 1
    spread = math.sqrt(share * (1 - share) * (1 / asked + 1 / (len(runs) + 1)))
    return spread * (asked if row["statistic"] == "count" else 1)


def _likelihood(
    published: np.ndarray, draws: np.ndarray, least: np.ndarray, results: Results
) -> float:
    """Logarithm of the density of the published numbers (k,) in the multivariate t distribution of
    draws (k, EXPERIMENTS).

    The draws come from n units, which cannot determine k x k covariances: they are shrunk to the
    diagonal by k / (k + n), and the distribution has n - 1 degrees of freedom. A spread is at least
    that of `least` (k,) and a thousandth of the number.
    """
    known = ~np.isnan(draws).any(axis=1) if len(draws) else np.zeros(0, dtype=bool)
    units = max(len(results.runs[_unit_columns(results.runs)].drop_duplicates()), 2)
    # A number that cannot be predicted is as unlikely as one ten standard deviations away.
    missing = -50.0 * float((~known).sum())
    if not known.any():
        return missing
    draws, published, least = draws[known], published[known], least[known]
    k, centre = len(draws), draws.mean(axis=1)
    spread = np.maximum.reduce([draws.std(axis=1), least, 1e-3 * np.maximum(np.abs(centre), 1e-3)])
    with np.errstate(invalid="ignore"):  # a number without spread is correlated with none
        correlation = (
            np.nan_to_num(np.atleast_2d(np.corrcoef(draws)), nan=0.0) if k > 1 else np.eye(1)
        )
    shrunk = (1 - k / (k + units)) * correlation
    np.fill_diagonal(shrunk, 1.0)
    away = (published - centre) / spread
    freedom = units - 1
    distance = float(away @ np.linalg.solve(shrunk, away))
    logarithms = np.log(spread).sum() + 0.5 * np.linalg.slogdet(shrunk)[1]
    constant = (
        math.lgamma((freedom + k) / 2)
        - math.lgamma(freedom / 2)
        - 0.5 * k * math.log(freedom * math.pi)
    )
    return missing + constant - logarithms - 0.5 * (freedom + k) * math.log1p(distance / freedom)


class Evaluator:
    """Evaluates parts of interpretations on the runs that they need. Runs are kept in a folder
    under the digest of their job, so that an interrupted search continues, and interpretations that
    agree on a method share its runs.
    """

    def __init__(
        self, stage: Stage, files: dict[str, str], maps: Path, folder: Path, resamples: int = 0
    ) -> None:
        """files: published numbers, by table. maps: where map files are looked up. resamples: how
        often runs are resampled for the error of the score.
        """
        self.stage, self.maps, self.folder, self.resamples = stage, maps, folder, resamples
        published = {
            name: comparison.read_published(files[name], table.spec)
            for name, table in stage.tables.items()
        }
        # Mean ranks that no runs have are no evidence for any interpretation.
        self.published = {
            name: printed[~comparison.impossible_ranks(printed, stage.tables[name].spec)]
            for name, printed in published.items()
        }
        self.worlds: dict[str, tuple[dict, pd.DataFrame]] = {}

    def __call__(self, methods: list[str], interpretation: Interpretation) -> Evaluated | None:
        """The part of an interpretation that some methods' numbers decide; None if its settings
        exclude each other or no workspace is like that.
        """
        evaluated = []
        choices = self.stage.choices
        for name, table in self.stage.tables.items():
            judged = [method for method in table.jobs if method in methods]
            if not judged:
                continue
            placed = [
                in_world(
                    table.spec,
                    chunk_under(table.jobs[method], interpretation, choices),
                    interpretation,
                )
                for method in judged
            ]
            if any(_excluded(chunk) for _, chunk in placed):
                return None
            try:
                problems, bounds, changes = self._world(
                    table.experiment, [*placed[0][1].problems], interpretation
                )
            except ValueError as error:  # no such workspace can be drawn
                logger.info("%s: %s", name_of(interpretation), error)
                return None
            runs = pd.concat(
                [self._runs(chunk, problems, changes) for _, chunk in placed], ignore_index=True
            )
            spec, published = under_metrics(
                placed[0][0], self._printed(name, interpretation), interpretation, choices
            )
            if len(judged) < len(table.jobs):
                spec = spec.but(where=spec.where | {"method": judged})
                published = published[published["method"].isin(judged)]
            numbers, likelihood, resampled = numbers_of(
                joined(runs, problems, bounds),
                spec,
                published,
                f"{self.stage.study}/{name}",
                self.resamples,
            )
            evaluated.append(
                Evaluated(interpretation, numbers.assign(table=name), {name: likelihood}, resampled)
            )
        whole = together(interpretation, evaluated)
        logger.info(
            "%s: %s: %.2f, %d of %d",
            ", ".join(methods),
            name_of(interpretation),
            whole.score,
            *_in_range(whole),
        )
        return whole

    def _printed(self, name: str, interpretation: Interpretation) -> pd.DataFrame:
        """The published numbers of a table; a column that names the default world names that of the
        interpretation.
        """
        published = self.published[name]
        return published.assign(
            **{column: value for column, value in interpretation.items() if column in published}
        )

    def _world(
        self, experiment: str, names: list[str], interpretation: Interpretation
    ) -> tuple[dict, pd.DataFrame, list]:
        """Some problems of an experiment under an interpretation, their bounds, and what the
        interpretation changes in their workspaces.
        """
        described = self.stage.worlds[experiment]
        wanted = {name: described.problems[name] for name in names}
        used = {problem["workspace"] for problem in wanted.values()}
        changes = [
            (workspace, key, interpretation[choice.id])
            for choice in self.stage.choices
            for workspace, key in choice.workspace.items()
            if choice.id in interpretation and workspace in used
        ]
        described_world = json.dumps([experiment, names, changes])
        if described_world not in self.worlds:
            workspaces = {name: dict(described.workspaces[name]) for name in sorted(used)}
            for workspace, key, value in changes:
                workspaces[workspace][key] = value
            made = problem_files.build_all(
                described._replace(problems=wanted, workspaces=workspaces), self.maps
            )
            bounds = problem_files.bounds_of(made).to_pandas(use_threads=False)
            self.worlds[described_world] = made, bounds
        return *self.worlds[described_world], changes

    def _runs(self, chunk: Chunk, problems: dict, changes: list) -> pd.DataFrame:
        key = (
            source_digest(module_of(chunk.planner))
            + self.stage.maps
            + json.dumps([chunk.plain(), changes], sort_keys=True)
        )
        file = self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.parquet"
        if not file.exists():
            table, times = execution.run_chunk(problems, chunk, timed_alike=False)
            file.parent.mkdir(parents=True, exist_ok=True)
            # Two processes may make the same runs.
            part = Path(f"{file}.{os.getpid()}.part")
            parquet.write_table(table.append_column("cpu_s", times["cpu_s"]), part)
            part.replace(file)
        return rows.read_alone(file).to_pandas(use_threads=False)


def _in_range(found: Evaluated) -> tuple[int, int]:
    return int(found.numbers["in_range"].sum()), len(found.numbers)


@contextmanager
def evaluating(evaluator: Evaluator, parts: list[Part], processes: int) -> Iterator[Evaluate]:
    """Evaluates the tasks of a search, in several processes if there are to be several: on Linux,
    for elsewhere they would begin with the job's script anew.
    """
    if processes == 1 or sys.platform != "linux":
        yield lambda tasks: [
            evaluator(parts[task.part].methods, task.interpretation) for task in tasks
        ]
        return
    with ProcessPoolExecutor(
        processes, multiprocessing.get_context("fork"), _begin, (evaluator, parts)
    ) as pool:
        yield lambda tasks: [*pool.map(_evaluated, tasks)]


_of_process: dict[str, Any] = {}
"""The evaluator of a process of the pool, which keeps the worlds that it has built, and the
parts.
"""


def _begin(evaluator: Evaluator, parts: list[Part]) -> None:
    end_with_parent()
    _of_process.update(evaluator=evaluator, parts=parts)


def _evaluated(task: Task) -> Evaluated | None:
    return _of_process["evaluator"](_of_process["parts"][task.part].methods, task.interpretation)


def found_by(
    job: Search, files: dict[str, str], maps: Path, folder: Path, processes: int
) -> dict[str, pd.DataFrame]:
    """The three tables of `explained`, by name, after the search for a study's best interpretation.

    Few runs judge each interpretation that is tried, so that the best of them owes its score to
    luck as well. So those within its reach are judged by more, then the finalists by many others,
    which choose the best one; and as these runs were kind to the one that they chose, it is judged
    anew by as many with seeds that chose nothing.
    """
    parts, choices, study, most = job.parts, job.choices, job.study, job.most_finalists

    def by(stage: str, resamples: int = 0) -> AbstractContextManager[Evaluate]:
        evaluator = Evaluator(job.stages[stage], files, maps, folder, resamples)
        return evaluating(evaluator, parts, processes)

    with by("screened") as evaluate:
        tried = search(choices, parts, evaluate, study, job.most)
    near = [each.interpretation for each in tried.interpretations]
    for stage, kept in (("screened", JUDGED * most), ("judged", most)):
        with by(stage, RESAMPLES) as evaluate:
            near = within_reach(near, parts, evaluate, kept)
    with by("finalists") as evaluate:
        confirmed = confirm(near, parts, evaluate)
    best = max(confirmed, key=lambda each: each.rank).interpretation
    with by("fresh") as evaluate:
        fresh = confirm([best], parts, evaluate)
    shared = {
        choice.id for choice in choices if sum(choice.id in part.choices for part in parts) > 1
    }
    published = Evaluator(job.stages["finalists"], files, maps, folder).published
    lines = {
        name: (along, explained.yardstick(published[name], along))
        for name, along in job.along.items()
    }
    return {
        "interpretations": explained.interpretations_table(
            study, confirmed, tried.interpretations, tried.tried, fresh, choices
        ),
        "explained": explained.explained_table(study, confirmed, tried.of_parts, shared),
        "leave_one_table_out": explained.leave_one_table_out_table(study, confirmed, lines),
    }


def _excluded(chunk: Chunk) -> bool:
    """Whether a planner refuses a combination of settings."""
    check = getattr(planner_module(chunk.planner), "check", None)
    settings = [execution.settings_in(chunk, condition) for condition in chunk.conditions()]
    try:
        for each in settings if check else []:
            check(each)
    except ValueError:
        return True
    return False
