"""The readings of a paper: which of them its own numbers exclude, how well the others fit, and what
they make of its claims.

A reading is the default with another value for one assumption, of what the paper leaves open, or
for two that config names as a pair, because they trade off. It is excluded

- by a printed sentence (`excluded_by`), and is not run then;
- by a printed mean below the exact optimum of its map;
- if the proposed method returns no path in at least half of the runs behind a printed number of
  its.

For the others there is a p of fit (`fit`), which decides no number, as most maps are ours.

Columns of the readings: study; reading; meaning (what it changes, in words); excluded_by; p (how
well the printed numbers that vote fit; empty if it was not run); order (`lowest_order`); numbers
(how many vote). Columns of claims by reading: study; id (of the claim); reading; verdict. Columns
of numbers by reading, of those on a map that some readings change, under each that nothing
excludes: table; key columns; metric; statistic; reading; in_range (as in `comparison`).
"""

import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics
from bezierplan.analysis.numbers import comparison
from bezierplan.analysis.readings import fit
from bezierplan.analysis.readings.assumptions import Alternatives, Reading, ReadingRuns
from bezierplan.analysis.results import Results, joined, keys_of, select
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.planners import planner_module
from bezierplan.running import execution, problems
from bezierplan.running.chunk import Chunk
from bezierplan.running.guard.interface import check_settings
from bezierplan.running.inputs import Files
from bezierplan.running.jobs import log
from bezierplan.schema.checked import Fault
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

VOTING = {"mean": "mean", "median": "median", "count": "count", "share": "count"}
"""Statistics of printed numbers that vote -> what ours are."""
LEAST_P = 0.01
"""A reading with a lower p does not fit."""
LEAST_ORDERED = 5
"""Means whose order says something."""
LOST = 0.5
"""Share of runs without a path from which the proposed method is said to return none."""


class Quantity(NamedTuple):
    """Printed numbers of one quantity of a table.

    where, of_runs: the runs, and those of them that count. least: the column of runs that none of
    their values can lie below, if any. keys: columns of runs that tell the numbers apart. printed:
    these keys, value, n (of the paper's runs, layouts or fields) and votes.
    """

    experiment: str
    where: dict[str, Any]
    of_runs: dict[str, Any]
    metric: str
    statistic: str
    decimals: int
    least: str | None
    keys: list[str]
    printed: pd.DataFrame


def name_of(reading: Reading) -> str:
    """A reading as it is written in tables."""
    return ", ".join(f"{name}={value}" for name, value in reading.items()) or "default"


def quantities(
    tables: dict[str, Pivot], votes: dict[str, dict[str, dict]], files: dict[str, str]
) -> list[Quantity]:
    """The printed numbers of tables. votes: table -> metric -> which of them vote (column -> value
    or list of values); files: of published numbers.
    """
    all_quantities = []
    for name, spec in tables.items():
        printed = comparison.read_published(files[Path(spec.published).stem], spec)
        keys = keys_of(printed)
        printed = printed.replace({"statistic": {"unstated": "median"}})
        for entry in spec.values:
            for named in entry.statistics:
                statistic = named.replace("unstated", "median")
                rows = select(printed, {"metric": entry.metric, "statistic": statistic})
                if statistic not in VOTING or rows.empty:
                    continue
                voting = select(rows, votes[name].get(entry.metric, {"metric": []}))
                numbers = rows["value"].astype(float)
                size = rows["n"].fillna(1)
                if statistic == "share":
                    numbers = numbers * size
                all_quantities.append(
                    Quantity(
                        spec.experiment,
                        spec.where | spec.primary,
                        entry.where,
                        entry.metric,
                        VOTING[statistic],
                        entry.decimals,
                        entry.least,
                        keys,
                        rows[keys].assign(
                            value=numbers,
                            n=1 if spec.within else size,
                            votes=rows.index.isin(voting.index),
                        ),
                    )
                )
    return all_quantities


# --------------------------------------------------------------------------------------------------
# What the printed numbers say of our runs


def by_unit(quantity: Quantity, results: Results, column: str = "") -> pd.DataFrame:
    """Our values, or those of a column, one row for each printed number and one column for each
    unit (layout, or repeat); NaN without a value.
    """
    runs = select(results.runs, quantity.where)
    counts = runs.index.isin(select(runs, quantity.of_runs).index)
    values = runs[column] if column else metrics.values(runs, quantity.metric, results.problems)
    values = values.astype(float).where(counts)
    unit = runs["layout" if "layout" in runs else "repeat"]
    table = values.groupby([runs[key] for key in quantity.keys] + [unit]).mean().unstack()
    wanted = quantity.printed.set_index(quantity.keys).index
    return table.reindex(wanted)


def groups(quantities: list[Quantity], results: dict[str, Results]) -> list[fit.Numbers]:
    """The numbers that vote, those of the same problems together."""
    together: dict[tuple, list[tuple[Quantity, pd.DataFrame]]] = {}
    for quantity in quantities:
        voting = quantity._replace(printed=quantity.printed[quantity.printed["votes"]])
        if len(voting.printed):
            outcome = results[quantity.experiment]
            problem = select(outcome.runs, quantity.where)["problem"].unique()
            values = by_unit(voting, outcome)
            together.setdefault((quantity.experiment, *sorted(problem)), []).append(
                (voting, values)
            )
    return [_joined(own) for own in together.values()]


def _joined(own: list[tuple[Quantity, pd.DataFrame]]) -> fit.Numbers:
    printed = pd.concat([each.printed for each, _ in own])
    lengths = [len(each.printed) for each, _ in own]
    statistic = np.repeat([each.statistic for each, _ in own], lengths)
    values = np.concatenate([values.to_numpy() for _, values in own]).T
    (size,) = printed["n"].unique()
    return fit.Numbers(
        np.where(statistic == "count", np.nan_to_num(values), values),
        printed["value"].to_numpy(),
        np.repeat([10.0**-each.decimals for each, _ in own], lengths),
        statistic == "count",
        statistic == "median",
        int(size),
    )


def excluded(quantities: list[Quantity], results: dict[str, Results], proposed: str | None) -> str:
    """Why the printed numbers exclude the reading that runs were made under; empty if they do
    not.
    """
    below, lost = False, False
    for quantity in quantities:
        outcome, printed = results[quantity.experiment], quantity.printed
        if quantity.least and quantity.statistic == "mean":
            least = by_unit(quantity, outcome, quantity.least).min(axis=1).to_numpy()
            below |= bool((printed["value"] + 0.5 * 10.0**-quantity.decimals < least).any())
        if "method" in printed and metrics.METRICS[quantity.metric].feasible_only:
            own = quantity._replace(printed=printed[printed["method"] == proposed])
            runs = outcome.runs.assign(lost=outcome.runs["length"].isna())
            shares = by_unit(own, outcome._replace(runs=runs), "lost").mean(axis=1)
            lost |= bool((shares >= LOST).any())
    reasons = {
        "a printed mean lies below the exact optimum": below,
        "the proposed method returns no path": lost,
    }
    return "; ".join(reason for reason, holds in reasons.items() if holds)


def lowest_order(quantities: list[Quantity], results: dict[str, Results]) -> float:
    """The lowest rank correlation of printed means with ours, of those with `LEAST_ORDERED` methods
    or conditions; NaN without such.
    """
    orders = [
        each.printed["value"].corr(
            by_unit(each, results[each.experiment]).mean(axis=1).set_axis(each.printed.index),
            method="spearman",
        )
        for each in quantities
        if each.statistic == "mean" and each.printed["votes"].sum() >= LEAST_ORDERED
    ]
    return min(orders, default=math.nan)


# --------------------------------------------------------------------------------------------------
# Runs of a reading


def under(chunk: Chunk, reading: Reading, assumptions: list[Alternatives]) -> Chunk:
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


def _without_reference(chunk: Chunk) -> Chunk:
    """A chunk on other maps, whose best path is not known."""
    places = {
        name: place | {"reference": math.nan}
        for name, place in chunk.problems.items()
        if "reference" in place
    }
    return chunk._replace(problems=chunk.problems | places)


class RunsOfMethod(NamedTuple):
    """Runs of a method in an experiment under a reading. own: whether they are others than those of
    the default.
    """

    experiment: str
    chunk: Chunk
    own: bool


class Runner(NamedTuple):
    """Makes the runs of readings. defaults: experiment -> problems by name, and their bounds.
    shared_runs: by experiment and method, the runs of the default, which other readings share.
    """

    assumptions: list[Alternatives]
    experiments: dict[str, ReadingRuns]
    folder: Path
    defaults: dict[str, tuple[dict[str, Problem], pd.DataFrame]]
    shared_runs: dict[tuple[str, str], pd.DataFrame]

    def chunks(self, reading: Reading) -> list[RunsOfMethod]:
        """What is run under a reading; nothing if its settings exclude each other."""
        made = []
        for name, each in self.experiments.items():
            moved = name in self.moved(reading)
            for default in each.chunks.values():
                chunk = under(default, reading, self.assumptions)
                if moved:
                    chunk = _without_reference(chunk)
                made.append(RunsOfMethod(name, chunk, moved or chunk != default))
        try:
            for chunk in (each.chunk for each in made):
                for condition in chunk.conditions():
                    settings = execution.settings_in(chunk, condition)
                    check_settings(planner_module(chunk.planner), settings, "")
        except Fault:
            return []
        return made

    def results(self, reading: Reading, chunks: list[RunsOfMethod]) -> dict[str, Results]:
        """The runs of chunks under a reading, by experiment."""
        results = {}
        for name in self.experiments:
            own = [each for each in chunks if each.experiment == name]
            world, bounds = self._world(name, reading, own[0].chunk.problems)
            runs = pd.concat([self._runs(world, each) for each in own], ignore_index=True)
            results[name] = joined(runs, world, bounds)
        return results

    def _runs(self, world: dict[str, Problem], part: RunsOfMethod) -> pd.DataFrame:
        place = (part.experiment, part.chunk.method)
        if part.own:
            return execution.run_chunk(world, part.chunk)[0].to_pandas()
        if place not in self.shared_runs:
            self.shared_runs[place] = execution.run_chunk(world, part.chunk)[0].to_pandas()
        return self.shared_runs[place]

    def moved(self, reading: Reading) -> list[str]:
        """The experiments whose maps are others under a reading."""
        return [name for name in self.experiments if self._changed(name, reading)]

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
        described = described._replace(problems=wanted, workspaces=workspaces)
        made, moving = problems.build_all(described, self.folder)
        return made, problems.bounds_of(made, moving).to_pandas()


def read_problems(files: dict[str, Files]) -> dict[str, tuple[dict[str, Problem], pd.DataFrame]]:
    """Problems and bounds by experiment, from their files."""
    return {
        name: (problems.read(each.problems)[0], pd.read_parquet(each.bounds))
        for name, each in files.items()
    }


# --------------------------------------------------------------------------------------------------
# All readings


def listed(assumptions: list[Alternatives], pairs: list[Reading]) -> list[Reading]:
    """The default, each other value of an assumption, and the pairs."""
    alone = [{each.id: value} for each in assumptions for value in each.alternatives]
    return [{}, *alone, *pairs]


def of_study(
    study: str,
    quantities: list[Quantity],
    runner: Runner,
    pairs: list[Reading],
    proposed: str | None,
    judge: Callable[[dict[str, Results], int], pd.DataFrame],
    compare: Callable[[dict[str, Results]], pd.DataFrame],
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """The readings of a study; its claims by reading, but under those that do not fit where one
    does; and its numbers by reading.

    judge: the verdicts on claims (id, verdict) from the results of one of so many readings.
    compare: the numbers of tables beside the results of some experiments.
    """
    by_id = {each.id: each for each in runner.assumptions}
    tried = []
    for reading in listed(runner.assumptions, pairs):
        sentences = [by_id[each].excluded_by for each in reading if by_id[each].excluded_by]
        chunks = [] if sentences else runner.chunks(reading)
        why = "; ".join(sentences) or ("" if chunks else "its settings exclude each other")
        runs = sum(made.chunk.runs for made in chunks if made.own or not reading)
        tried.append((reading, chunks, why, runs))
    rows, verdicts, numbers, fits, done = [], [], [], False, 0
    on_open_maps = {name for reading, *_ in tried for name in runner.moved(reading)}
    among = sum(not why for *_, why, _ in tried)
    every = sum(runs for *_, runs in tried)
    for number, (reading, chunks, why, runs) in enumerate(tried, 1):
        name, p, order = name_of(reading), math.nan, math.nan
        if chunks:
            # Each may take minutes, so whoever waits sees it in the terminal.
            place = f"{study}: reading {number} of {len(tried)}, {name}"
            log.say(f"{place}: {done} of {every} runs done")
            results = runner.results(reading, chunks)
            why, done = excluded(quantities, results, proposed), done + runs
            p = fit.p_of_fit(groups(quantities, results), generator(f"{study}/{name}/fit"))
            order = lowest_order(quantities, results)
            fits |= p >= LEAST_P and not why
            if on_open_maps and not why:
                compared = compare({each: results[each] for each in on_open_maps})
                numbers.append(compared.assign(reading=name))
            if not why and (p >= LEAST_P or not fits):
                verdicts.append(judge(results, among).assign(study=study, reading=name))
        rows.append(
            {
                "study": study,
                "reading": name,
                "meaning": "; ".join(f"{by_id[each].detail}: {reading[each]}" for each in reading),
                "excluded_by": why,
                "p": p,
                "order": order,
                "numbers": int(sum(each.printed["votes"].sum() for each in quantities)),
            }
        )
    columns = ["study", "id", "reading", "verdict"]
    none = pd.DataFrame(columns=["table", "metric", "statistic", "reading", "in_range"])
    return (
        pd.DataFrame(rows),
        pd.concat(verdicts, ignore_index=True)[columns],
        pd.concat(numbers, ignore_index=True) if numbers else none,
    )
