"""How well the readings of a paper make its printed numbers likely.

A reading gives one assumption, of what the paper leaves open, another value than the default. Its
score is the mean, over the printed numbers that vote, of the logarithm of their density under our
runs:

- A mean or median: its relative error has a Student t of `FREEDOM` degrees of freedom, whose scale
  holds the standard error of the printed number, that of ours, and `DISCREPANCY`: no model of an
  experiment is exact. So a number that is far off says that the reading is wrong, and not by how
  much.
- A count or share: beta-binomial, as if ours came from `WORTH` runs, however many there are; with
  the probability `ANY`, it can be any.

Extremes and seconds have no vote.

Columns: study; reading; excluded_by (the place of the paper that excludes it); score; error
(standard error by the choice of seeds, by the jackknife over `BLOCKS` parts of the runs); numbers.
"""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import comparison, metrics
from bezierplan.analysis.assumptions import Assumption, Experiment, Reading
from bezierplan.analysis.results import Results, joined, published_table, select
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.planners import planner_module
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Chunk
from bezierplan.running.guard.interface import check_settings
from bezierplan.running.inputs import Files
from bezierplan.running.jobs import log
from bezierplan.schema.checked import Fault
from bezierplan.workspaces.problem import Problem

DISCREPANCY, FREEDOM = 0.03, 4
WORTH, ANY = 50, 0.05
BLOCKS = 5
VOTING = {
    **{name: name for name in ("mean", "median", "count")},
    "share": "count",
}
"""Statistics of printed numbers that vote -> what ours are."""


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


def under(chunk: Chunk, reading: Reading, assumptions: list[Assumption]) -> Chunk:
    """A chunk of runs under a reading."""
    settings = dict(chunk.settings)
    places = {name: dict(place) for name, place in chunk.problems.items()}
    changed = [each for each in assumptions if each.id in reading and chunk.method in each.along]
    named = {each.setting for each in changed}
    for each in sorted(changed, key=lambda assumption: len(assumption.problems)):
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

    assumptions: list[Assumption]
    experiments: dict[str, Experiment]
    folder: Path
    defaults: dict[str, tuple[dict[str, Problem], pd.DataFrame]]
    runs: dict[str, pd.DataFrame]

    def fits(self, reading: Reading) -> bool:
        """Whether its settings do not exclude each other."""
        try:
            for _, chunk in self.chunks(reading):
                for condition in chunk.conditions():
                    settings = execution.settings_in(chunk, condition)
                    check_settings(planner_module(chunk.planner), settings, "")
        except Fault:
            return False
        return True

    def chunks(self, reading: Reading) -> Iterator[tuple[str, Chunk]]:
        """The chunks under a reading, each with what tells its runs apart from others."""
        for name, each in self.experiments.items():
            world = name_of(reading) if self._changed(name, reading) else ""
            for chunk in each.chunks.values():
                read = under(chunk, reading, self.assumptions)
                yield f"{world}: {read}", read

    def results(self, reading: Reading) -> dict[str, Results]:
        """Runs under a reading, by experiment."""
        chunks = [*self.chunks(reading)]
        results = {}
        for name in self.experiments:
            own = [(key, chunk) for key, chunk in chunks if chunk.experiment == name]
            made, bounds = self._world(name, reading, own[0][1].problems)
            for key, chunk in own:
                if key not in self.runs:
                    self.runs[key] = execution.run_chunk(made, chunk)[0].to_pandas()
            runs = pd.concat([self.runs[key] for key, _ in own], ignore_index=True)
            results[name] = joined(runs, made, bounds)
        return results

    def _changed(self, experiment: str, reading: Reading) -> dict[str, dict[str, Any]]:
        """The descriptions of workspaces that a reading changes."""
        described = self.experiments[experiment].descriptions
        return {
            name: described.workspaces[name] | {key: reading[each.id]}
            for each in self.assumptions
            if each.id in reading
            for name, key in each.workspaces.items()
            if name in described.workspaces
        }

    def _world(
        self, experiment: str, reading: Reading, names: Iterable[str]
    ) -> tuple[dict[str, Problem], pd.DataFrame]:
        """Problems under a reading, and their bounds."""
        described = self.experiments[experiment].descriptions
        changed = self._changed(experiment, reading)
        if not changed:
            return self.defaults[experiment]
        wanted = {name: described.problems[name] for name in names}
        homes = {place["workspace"] for place in wanted.values()}
        workspaces = {name: (described.workspaces | changed)[name] for name in sorted(homes)}
        made = problems.build_all(
            described._replace(problems=wanted, workspaces=workspaces), self.folder
        )
        return made, problems.bounds_of(made).to_pandas()


# --------------------------------------------------------------------------------------------------
# The search


def listed(assumptions: list[Assumption]) -> list[Reading]:
    """The default, and each alternative alone."""
    alone = [{each.id: value} for each in assumptions for value in each.alternatives]
    return list({name_of(each): each for each in ({}, *alone)}.values())


def of_study(study: str, voting: list[Quantity], runner: Runner) -> pd.DataFrame:
    """The scores of the readings of a study."""
    assumptions, printed = runner.assumptions, _of_paper(voting)
    excluding = {each.id: each.excluded_by for each in assumptions if each.excluded_by}
    rows, readings = [], [each for each in listed(assumptions) if runner.fits(each)]
    sizes = {key: chunk.runs for each in readings for key, chunk in runner.chunks(each)}
    for number, reading in enumerate(readings, 1):
        done = sum(sizes[key] for key in runner.runs)
        # Each may take minutes, so whoever waits sees it in the terminal.
        place = f"{study}: reading {number} of {len(readings)}, {name_of(reading)}"
        log.say(f"{place}: {done} of {sum(sizes.values())} runs done")
        score, error = scored(voting, printed, measured(voting, runner.results(reading)))
        rows.append(
            {
                "study": study,
                "reading": name_of(reading),
                "excluded_by": "; ".join(excluding[each] for each in reading if each in excluding),
                "score": score,
                "error": error,
                "numbers": len(printed),
            }
        )
    return pd.DataFrame(rows)


def _of_paper(voting: list[Quantity]) -> np.ndarray:
    """The numbers that the paper prints (k,)."""
    return np.concatenate([each.printed["value"].astype(float) for each in voting])


def read_problems(files: dict[str, Files]) -> dict[str, tuple[dict[str, Problem], pd.DataFrame]]:
    """Problems and bounds by experiment, from their files."""
    return {
        name: (problems.read(each.problems), pd.read_parquet(each.bounds))
        for name, each in files.items()
    }
