"""Which reading of a paper is its experiment? One score for all of them, and what a true one gets.

A reading gives some choices that the paper leaves open another value than the default. Its score is
the mean, over the printed numbers that vote, of the logarithm of their density under our runs:

- A mean or median: its relative error has a Student t of `FREEDOM` degrees of freedom, whose scale
  holds the standard error of the printed number, that of ours, and `DISCREPANCY`: no model of an
  experiment is exact. So a number that is far off says that the reading is wrong, and not by how
  much.
- A count or share: beta-binomial, as if ours came from `WORTH` runs, however many there are; with
  the probability `ANY`, it can be any.
- A mean over n runs of what only free paths have says that n of n were free, which is a count too.

Extremes and seconds have no vote. The search tries each alternative alone, combinations of a
space-filling design, and then adds to the best reading, one by one, what was best alone.

It is calibrated by hidden readings, of which it gets the numbers that an experiment of the paper's
size prints, from runs with other seeds: which score does the true one have, and which place?

Columns of the scores: reading; excluded_by (the place of the paper that excludes it); score; error
(standard error by the choice of seeds, by the jackknife over `BLOCKS` parts of the runs); numbers.
Columns of the calibration: hidden (whether the numbers are those of a hidden reading; else they are
the paper's); truth; score (of the truth); place (of the truth among all that were tried); default
(the default's score); best; found (the reading that has it, among those that no sentence excludes).
"""

import logging
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import comparison, metrics
from bezierplan.analysis.choices import Choice, Experiment, Reading
from bezierplan.analysis.results import Results, joined, published_table, select
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.planners import planner_module
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Chunk
from bezierplan.running.guard.interface import check_settings
from bezierplan.running.inputs import Files
from bezierplan.schema.checked import Fault
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

logger = logging.getLogger(__name__)

DISCREPANCY, FREEDOM = 0.03, 4
WORTH, ANY = 50, 0.05
BLOCKS = 5
VOTING = {
    **{name: name for name in ("mean", "median", "count")},
    "share": "count",
}
"""Statistics of printed numbers that vote -> what ours are."""
DESIGN, CHANGED = 16, 0.25
"""Combinations that are tried, and the share of the choices that each changes."""
CLIMB = 2
"""Alternatives that are added to the best reading."""
HIDDEN = 20
"""Readings that the search is calibrated with."""
MANY = 10
"""Times the runs of a score from which claims are judged."""


class Quantity(NamedTuple):
    """Printed numbers of one quantity of a table, with the keys of each."""

    experiment: str
    where: dict[str, Any]
    of_runs: dict[str, Any]
    metric: str
    statistic: str
    decimals: int
    within: str | None
    keys: list[str]
    printed: pd.DataFrame


def name_of(reading: Reading) -> str:
    """A reading in words."""
    return ", ".join(f"{choice}={value}" for choice, value in reading.items()) or "default"


# --------------------------------------------------------------------------------------------------
# The score


def quantities(
    tables: dict[str, Pivot], votes: dict[str, dict[str, dict]], files: dict[str, str]
) -> list[Quantity]:
    """The printed numbers that vote. votes: table -> metric -> which of them (column -> value or
    list of values); files: of published numbers.
    """
    all_quantities = []
    for name, spec in tables.items():
        printed = comparison.as_read(published_table(files[Path(spec.published).stem]), spec.reads)
        printed = printed.replace({"statistic": {"unstated": "median"}})
        keys = printed.columns[: printed.columns.get_loc("metric")].to_list()
        for entry in spec.values:
            for statistic in entry.statistics if entry.metric in votes[name] else ():
                statistic = statistic.replace("unstated", "median")
                wanted = {"metric": entry.metric, "statistic": statistic}
                chosen = select(printed, votes[name][entry.metric] | wanted)
                chosen = chosen.assign(n=chosen["n"].fillna(1))
                if statistic == "share":
                    chosen = chosen.assign(value=chosen["value"] * chosen["n"])
                if statistic not in VOTING:
                    continue
                quantity = Quantity(
                    spec.experiment,
                    spec.where | spec.primary,
                    entry.where,
                    entry.metric,
                    VOTING[statistic],
                    entry.decimals,
                    spec.within,
                    keys,
                    chosen,
                )
                all_quantities.append(quantity)
                if statistic == "mean" and metrics.METRICS[entry.metric].feasible_only:
                    free = chosen.assign(value=chosen["n"])
                    all_quantities.append(
                        quantity._replace(
                            metric="feasible", statistic="count", decimals=0, printed=free
                        )
                    )
    return all_quantities


def measured(voting: list[Quantity], results: dict[str, Results]) -> np.ndarray:
    """What our runs say of the k printed numbers: the mean or share, its variance between
    experiments of the paper's size, and the variance of ours; first by all runs, then without each
    of the blocks: (BLOCKS + 1, k, 3). NaN without runs that count, variances with a single one.
    """
    columns = []
    for each in voting:
        found = results[each.experiment]
        runs = select(select(found.runs, each.where), each.of_runs)
        runs = runs.assign(value=metrics.values(runs, each.metric, found.problems))
        block = runs["layout" if "layout" in runs else "repeat"] % BLOCKS
        for row in each.printed.to_dict("records"):
            own = np.logical_and.reduce([runs[key] == row[key] for key in each.keys])
            columns.append(
                [
                    _moments(runs[own & (block != left)], row["n"], each)
                    for left in range(-1, BLOCKS)
                ]
            )
    return np.swapaxes(np.array(columns), 0, 1)


def _moments(runs: pd.DataFrame, size: float, of: Quantity) -> tuple[float, float, float]:
    values, counts = runs["value"].dropna(), of.statistic == "count"
    if counts:
        return values.sum() / max(len(runs), 1), 0.0, 0.0
    counted, centre = max(size * len(values) / max(len(runs), 1), 1), values.agg(of.statistic)
    if len(values) < 2:
        return centre, math.nan, math.nan
    if of.within is None:
        variance = values.var()
        return centre, variance / counted, variance / len(values)
    groups = values.groupby(runs[of.within])
    between = groups.mean().var()
    return centre, between + groups.var().mean() / counted, between / len(groups)


def scored(voting: list[Quantity], printed: np.ndarray, ours: np.ndarray) -> tuple[float, float]:
    """The score of a reading, and its standard error by the choice of seeds.

    printed: the numbers (k,). ours: as from `measured`.
    """
    whole, *parts = (np.nanmean(_densities(voting, printed, each)) for each in ours)
    return float(whole), float(np.std(parts) * math.sqrt(BLOCKS - 1))


def _densities(voting: list[Quantity], printed: np.ndarray, ours: np.ndarray) -> np.ndarray:
    """Logarithms of the densities of printed numbers (k,). ours: (k, 3)."""
    from scipy import stats

    counted = np.concatenate([[each.statistic == "count"] * len(each.printed) for each in voting])
    size = np.concatenate([each.printed["n"] for each in voting])
    step = np.concatenate([[10.0**-each.decimals] * len(each.printed) for each in voting])
    unit = np.maximum(np.abs(printed), step)
    centre, variance, error = ours.T
    relative = np.where(np.isnan(variance), 1.0, (printed - centre) / unit)
    scale = np.sqrt(DISCREPANCY**2 + (np.nan_to_num(variance + error) + step**2 / 12) / unit**2)
    means = stats.t.logpdf(relative / scale, FREEDOM) - np.log(scale)
    true = np.where(counted, centre, 0.0) * WORTH + 0.5
    counts = stats.betabinom.pmf(np.round(printed), size, true, WORTH + 1 - true)
    counts = np.log((1 - ANY) * counts + ANY / (size + 1))
    return np.where(np.isnan(printed), np.nan, np.where(counted, counts, means))


# --------------------------------------------------------------------------------------------------
# Runs of a reading


def under(chunk: Chunk, reading: Reading, choices: list[Choice]) -> Chunk:
    """A chunk of runs under a reading."""
    settings = dict(chunk.settings)
    places = {name: dict(place) for name, place in chunk.problems.items()}
    changed = [each for each in choices if each.id in reading and chunk.method in each.along]
    named = {each.setting for each in changed}
    for each in sorted(changed, key=lambda choice: len(choice.problems)):
        along = {key: value for key, value in each.along[chunk.method].items() if key not in named}
        made = along | {each.setting: reading[each.id]}
        if not each.problems:
            settings |= made
        for name in places.keys() & set(each.problems):
            places[name]["settings"] = places[name].get("settings", {}) | made
    return chunk._replace(settings=settings, problems=places)


class Runner(NamedTuple):
    """Makes the runs of readings. defaults: experiment -> problems by name, and their bounds.
    runs: those that were made, which other readings share that change another method.
    """

    choices: list[Choice]
    experiments: dict[str, Experiment]
    folder: Path
    defaults: dict[str, tuple[dict[str, Problem], pd.DataFrame]]
    runs: dict[str, pd.DataFrame]

    def results(
        self, reading: Reading, layout: int | None = None, size: int = 0
    ) -> dict[str, Results] | None:
        """By experiment: those that score a reading, or, of at most `size` repeats, those that
        print the numbers of a hidden one; None if its settings exclude each other.
        """
        results = {}
        for name, each in self.experiments.items():
            chunks = each.scoring if layout is None else each.printing
            chunks = [under(chunk, reading, self.choices) for chunk in chunks.values()]
            if layout is not None:
                layouts = 1 if each.in_one_layout else size
                chunks = [_in_layouts(_first(chunk, size), layout, layouts) for chunk in chunks]
            try:
                for chunk in chunks:
                    for condition in chunk.conditions():
                        settings = execution.settings_in(chunk, condition)
                        check_settings(planner_module(chunk.planner), settings, "")
            except Fault:
                return None
            made, bounds = self._world(name, reading, chunks[0].problems)
            world = "" if made is self.defaults[name][0] else name_of(reading)
            runs = [self._runs(made, chunk, world) for chunk in chunks]
            results[name] = joined(pd.concat(runs, ignore_index=True), made, bounds)
        return results

    def _runs(self, maps: dict[str, Problem], chunk: Chunk, world: str) -> pd.DataFrame:
        """Runs of a chunk, made once in a world."""
        name = f"{world}: {chunk}"
        if name not in self.runs:
            self.runs[name] = execution.run_chunk(maps, chunk)[0].to_pandas()
        return self.runs[name]

    def _world(
        self, experiment: str, reading: Reading, names: Iterable[str]
    ) -> tuple[dict[str, Problem], pd.DataFrame]:
        """Problems under a reading, and their bounds."""
        described = self.experiments[experiment].descriptions
        changed = {
            name: described.workspaces[name] | {key: reading[each.id]}
            for each in self.choices
            if each.id in reading
            for name, key in each.workspaces.items()
            if name in described.workspaces
        }
        if not changed:
            return self.defaults[experiment]
        wanted = {name: described.problems[name] for name in names}
        homes = {place["workspace"] for place in wanted.values()}
        workspaces = {name: (described.workspaces | changed)[name] for name in sorted(homes)}
        made = problems.build_all(
            described._replace(problems=wanted, workspaces=workspaces), self.folder
        )
        return made, problems.bounds_of(made).to_pandas()


def _first(chunk: Chunk, size: int) -> Chunk:
    """The first repeats of a chunk."""
    first, last = chunk.repeats
    return chunk._replace(repeats=[first, min(first + size, last)])


def _in_layouts(chunk: Chunk, number: int, size: int) -> Chunk:
    """A chunk in some of its layouts alone, others for each number."""
    layouts = sorted({place["layout"] for place in chunk.problems.values() if "layout" in place})
    own = np.roll(layouts, -number * size)[:size]
    return chunk._replace(
        problems={
            name: place
            for name, place in chunk.problems.items()
            if "layout" not in place or place["layout"] in own
        }
    )


# --------------------------------------------------------------------------------------------------
# The search


def listed(study: str, choices: list[Choice]) -> list[Reading]:
    """The default, each alternative alone, and combinations of those that no sentence excludes,
    a Latin hypercube.
    """
    rng, free = generator(study, "readings"), [each for each in choices if not each.excluded_by]
    combined: list[Reading] = [{} for _ in range(DESIGN)]
    for each in free:
        for reading, place in zip(combined, (rng.permutation(DESIGN) + 0.5) / DESIGN / CHANGED):
            if place < 1:
                reading[each.id] = each.alternatives[int(place * len(each.alternatives))]
    alone = [{each.id: value} for each in choices for value in each.alternatives]
    return [*{name_of(each): each for each in ({}, *alone, *combined)}.values()]


def searched(
    start: list[Reading], fits: Callable[[Reading], bool], score: Callable[[Reading], float]
) -> list[tuple[float, Reading]]:
    """Scores of the readings that a search tries, the best first."""
    scores = [(score(each), each) for each in start]
    alone = sorted(
        ((value, each) for value, each in scores if len(each) == 1 and fits(each)),
        key=lambda pair: -pair[0],
    )
    best = max((pair for pair in scores if fits(pair[1])), key=lambda pair: pair[0])
    for _, each in alone[:CLIMB]:
        tried = best[1] | each
        if tried not in [reading for _, reading in scores]:
            scores.append((score(tried), tried))
            best = max(best, scores[-1], key=lambda pair: pair[0])
    return sorted(scores, key=lambda pair: -pair[0])


def of_study(
    study: str, voting: list[Quantity], runner: Runner
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The scores of the readings of a study, and the calibration."""
    choices = runner.choices
    excluding = {each.id: each.excluded_by for each in choices if each.excluded_by}
    by_name: dict[str, np.ndarray | None] = {}

    def of(reading: Reading, printed: np.ndarray) -> tuple[float, float]:
        if (name := name_of(reading)) not in by_name:
            results = runner.results(reading)
            by_name[name] = None if results is None else measured(voting, results)
            logger.info("%s", name)
        ours = by_name[name]
        return (-math.inf, math.nan) if ours is None else scored(voting, printed, ours)

    def allowed(reading: Reading) -> bool:
        return not reading.keys() & excluding.keys()

    start = listed(study, choices)
    possible = [each for each in start if allowed(each)]
    spread = dict.fromkeys(len(possible) * number // HIDDEN for number in range(HIDDEN))
    truths: list[Reading | None] = [None, *(possible[number] for number in spread)]
    rows, scores = [], []
    for number, truth in enumerate(truths):
        numbers = _of_paper(voting) if truth is None else _of_hidden(voting, runner, truth, number)
        if numbers is None:
            continue
        ranking = searched(start, allowed, lambda reading: of(reading, numbers)[0])  # noqa: B023
        best, reading = next(pair for pair in ranking if allowed(pair[1]))
        order = [each for _, each in ranking]
        rows.append(
            {
                "study": study,
                "hidden": truth is not None,
                "truth": None if truth is None else name_of(truth),
                "score": math.nan if truth is None else of(truth, numbers)[0],
                "place": None if truth is None else order.index(truth) + 1,
                "default": of({}, numbers)[0],
                "best": best,
                "found": name_of(reading),
            }
        )
        if truth is None:
            scores = [
                {
                    "study": study,
                    "reading": name_of(each),
                    "excluded_by": "; ".join(
                        excluding[choice] for choice in each if choice in excluding
                    ),
                    **dict(zip(("score", "error"), of(each, numbers))),
                    "numbers": len(numbers),
                }
                for value, each in ranking
                if value > -math.inf
            ]
    calibration = pd.DataFrame(rows).astype({"place": "Int64"})
    return pd.DataFrame(scores), calibration


def _of_paper(voting: list[Quantity]) -> np.ndarray:
    """The numbers that the paper prints (k,)."""
    return np.concatenate([each.printed["value"].astype(float) for each in voting])


def _of_hidden(
    voting: list[Quantity], runner: Runner, truth: Reading, number: int
) -> np.ndarray | None:
    """What an experiment of the paper's size prints under a reading (k,)."""
    size = int(max(each.printed["n"].max() for each in voting))
    results = runner.results(truth, layout=number, size=size)
    if results is None:
        return None
    values = iter(measured(voting, results)[0, :, 0])
    return np.array(
        [
            round(next(values) * size, 0)
            if each.statistic == "count"
            else round(next(values), each.decimals)
            for each in voting
            for size in each.printed["n"]
        ]
    )


# --------------------------------------------------------------------------------------------------
# Claims


def verdicts(
    runner: Runner, scores: pd.DataFrame, judge: Callable[[dict[str, Results]], tuple]
) -> pd.DataFrame:
    """The verdicts on claims under the default and under the best reading that no sentence
    excludes, each from `MANY` times the runs that score a reading; without those that compare what
    has no runs there. scores: as from `of_study`. judge: the tables of claims and of their checks,
    from results.

    Columns: study, id, holds (under the default), default, best, reading (the best), apart (whether
    the scores tell it from the default).
    """
    free = scores[scores["excluded_by"].isna()].set_index("reading")
    best, default = free.iloc[0], free.loc["default"]
    parts = best.name.split(", ")
    reading = {
        each.id: value
        for each in runner.choices
        for value in each.alternatives
        if name_of({each.id: value}) in parts
    }
    experiments = {
        name: each._replace(
            scoring={
                method: chunk._replace(repeats=[0, MANY * chunk.repeats[1]])
                for method, chunk in each.scoring.items()
            }
        )
        for name, each in runner.experiments.items()
    }
    many = runner._replace(experiments=experiments)
    (ours, checks), (theirs, others) = (judge(many.results(each)) for each in ({}, reading))
    empty = {*checks["id"][checks["n"] == 0], *others["id"][others["n"] == 0]}
    return ours.loc[~ours["id"].isin(empty), ["study", "id", "holds"]].assign(
        default=ours["verdict"],
        best=theirs["verdict"],
        reading=best.name,
        apart=best["score"] - default["score"] > 2 * math.hypot(best["error"], default["error"]),
    )


def read_problems(files: dict[str, Files]) -> dict[str, tuple[dict[str, Problem], pd.DataFrame]]:
    """Problems and bounds by experiment, from their files."""
    return {
        name: (problems.read(each.problems), pd.read_parquet(each.bounds))
        for name, each in files.items()
    }
