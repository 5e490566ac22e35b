"""From a check of a claim to its comparisons: which runs are compared, and the published numbers of
the same cells.
"""

import itertools
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import PurePath

import numpy as np
import pandas as pd

from bezierplan.analysis import metrics
from bezierplan.analysis.claims import effects
from bezierplan.analysis.claims.check import GROUP_KEYS, ClaimCheck, OfRuns
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.effects import Contrast
from bezierplan.analysis.claims.material import Display, Material, Untestable
from bezierplan.analysis.claims.published import (
    PrintedTable,
    average_printed,
    find_cell,
    select_metric,
)
from bezierplan.analysis.numbers import comparison
from bezierplan.analysis.results import is_repeated, pick, select
from bezierplan.schema.checked import Fault
from bezierplan.schema.model import convert_to_list

REST = "rest"
# Columns with one value per unit of a comparison; several values would silently mix their runs.
_FACTORS = ["experiment", "condition", "method"]


def fill_rest(check: ClaimCheck, claim: Claim, material: Material) -> ClaimCheck:
    """Replace `rest` in a check by the groups of the claim's artefact that the check does not name.

    Variants of methods are left out, because a sentence of the paper is about its own methods.
    """
    named = check.groups_named
    if REST not in named:
        return check
    left_out = {*named, *(material.study.variant_of if check.cells == "method" else ())}
    rest = [each for each in _list_groups(check, claim, material) if each not in left_out]
    return check.but(
        **{
            key: _replace_rest(getattr(check, key), rest)
            for key in GROUP_KEYS
            if key in check.model_fields_set
        }
    )


def _replace_rest(groups: list, rest: list) -> list:
    """Replace `rest` in a list of groups, or in lists of them, by other groups."""
    parts = [
        [_replace_rest(each, rest)] if isinstance(each, list) else rest if each == REST else [each]
        for each in groups
    ]
    return list(itertools.chain.from_iterable(parts))


def _list_displays(check: OfRuns, names: Iterable[str], material: Material) -> list[Display]:
    """List the tables and figure panels of artefacts, given by name, that show runs of the check's
    experiments.
    """
    return [
        part
        for name in names
        for part in material.study.artefacts.get(name, [])
        if part.experiment in check.experiments
    ]


def _list_groups(check: OfRuns, claim: Claim, material: Material) -> list:
    """List the groups that an artefact shows, each once, in its order; all groups of the experiment
    if it does not select any.
    """
    across = check.cells
    groups = []
    for where in [part.where for part in _list_displays(check, claim.artefacts, material)] or [{}]:
        if across in where:
            groups += convert_to_list(where[across])
        else:
            made = [name for name in check.experiments if name in material.results]
            every = [material.results[name].runs[across].dropna() for name in made]
            # Sorted, because a set of texts has another order in each process.
            groups += sorted(set(itertools.chain(*every)))
    return list(dict.fromkeys(groups))


def build_comparisons(check: OfRuns, claim: Claim, material: Material) -> list[Contrast]:
    """Build the comparisons of a check without `rest`, in an order independent of that of the runs.

    Raises Untestable if its experiment was not run, has no such metric, or has no run that
    satisfies its `where`; Fault if runs of several conditions would be mixed.
    """
    runs = _measure_runs(check, claim, material)
    if runs.empty:
        raise Untestable("no run is of the conditions that the claim names")
    column, every, pool = check.cells, check.every, check.pool
    tables = _list_published_tables(check, claim, material)
    of_tables = [key for table in tables for key in table.keys if key in runs]
    keys = list(dict.fromkeys(["experiment", *list_unit_columns(check)[:-1], *of_tables]))
    runs = runs[list(dict.fromkeys([*keys, *_FACTORS, check.replicate, "value"]))]
    if factor := find_mixed_factor(check, runs):
        what = f"claim {claim.id}: {check.test} of {check.metric}"
        raise Fault(f"{what}: several values of {factor} are neither told apart nor pooled")
    paired = check.paired
    # Equal units belong together if they share a start or a random workspace.
    if paired is None:
        paired = "replicate" in check.model_fields_set or all(
            material.study.paired.get(name, False) for name in check.experiments
        )
    metric_runs = material.results[check.experiments[0]].runs
    # Averaged over the runs of a unit, a boolean is a number like others.
    boolean = (
        check.replicate == "repeat"
        and check.metric in metric_runs
        and pd.api.types.is_bool_dtype(metric_runs[check.metric])
    )
    comparison_list = []
    # Published numbers are found by the places of the runs, each once.
    places = runs[keys].drop_duplicates(ignore_index=True)
    records = places.to_dict("records")
    for (_, rows), (_, shown) in zip(_split(runs, every), _split(places, every), strict=True):
        units = _average_units(check, rows)
        conditions = [[records[place] for place in part.index] for _, part in _split(shown, pool)]
        outcomes = _count_outcomes(check, rows)
        compared = list(check.list_cells(rows))
        printed_cells = {
            cell: [
                find_cell(
                    [row for row in part if column is None or row[column] == cell],
                    tables,
                    material.study.variant_of,
                )
                for part in conditions
            ]
            for cell in dict.fromkeys(cell for _, cells in compared for cell in cells)
        }
        pooled = rows.groupby(column or "method")["condition"].nunique().max()
        for terms, cells in compared:
            strata = {
                name: effects.mark_events(check, np.array([means[cell] for cell in cells]).T)
                for name, means in units.items()
            }
            numbers, number_of_runs = average_printed(
                check, list(zip(*(printed_cells[cell] for cell in cells)))
            )
            comparison_list.append(
                Contrast(
                    terms=terms,
                    # NaN does not equal itself, so a text takes its place.
                    place=tuple(
                        (key, "nan" if (value := rows[key].iloc[0]) != value else value)
                        for key in every
                    ),
                    cells=tuple(cells),
                    strata=strata,
                    printed=numbers,
                    paper_units=number_of_runs or material.study.repeats.get(check.experiments[0]),
                    boolean=boolean,
                    paired=paired,
                    note=_note_success_rates(outcomes, cells),
                    conditions=int(pooled),
                )
            )
    return comparison_list


def _measure_runs(check: OfRuns, claim: Claim, material: Material) -> pd.DataFrame:
    """Select the runs of a check's conditions and add the column `value`, which is NaN where a run
    does not count.

    A condition on an outcome, such as `feasible: true`, keeps the other runs without a value (or as
    failed, if failures rank last), so that a place where no run satisfies it is kept.
    """
    where = check.where
    # Conditions select runs; outcomes only decide which of these have a value.
    conditions = {
        column: wanted for column, wanted in where.items() if column not in metrics.METRICS
    }
    outcomes = {column: wanted for column, wanted in where.items() if column in metrics.METRICS}
    frames = []
    for name in check.experiments:
        if name not in material.results:
            raise Untestable(f"the experiment {name} was not run")
        runs, problems, *_ = material.results[name]
        if check.metric == "rank":
            # Ranks are taken among all rows of the artefact, whichever of them the check compares.
            for part in _list_displays(check, claim.artefacts, material)[:1]:
                runs = select(runs, part.where)
        else:
            runs = select(runs, conditions)
        if metrics.METRICS[check.metric].compute is None and check.metric not in runs:
            raise Untestable(f"the runs of {name} have no {check.metric}")
        counting = runs
        # Runs that a metric ranks among each other need those of all groups.
        if check.groups_named and not metrics.METRICS[check.metric].among_rows:
            counting = runs[runs[check.cells].isin(check.groups_named)]
        if check.pick:
            of_method = counting.groupby(_FACTORS)
            picked = [pick(own, check.pick.plain()) for _, own in of_method]
            counting = counting.loc[[run.name for run in picked if run is not None]]
        values = metrics.compute_values(counting, check.metric, problems).fillna(
            _choose_failure_value(check)
        )
        computed = {
            column: metrics.compute_values(counting, column, problems)
            for column in outcomes
            if column not in counting
        }
        chosen = select(counting.assign(**computed), outcomes)
        values = values.loc[chosen.index].reindex(runs.index)
        # This includes runs that do not satisfy a condition on an outcome.
        if check.failures == "last":
            values = values.fillna(np.inf)
        # Ranked runs are selected only now, after they were ranked among all.
        runs = select(runs.assign(value=values), conditions)
        # A share counts each run once.
        frames.append(runs if check.cells else runs[~is_repeated(runs)])
    return pd.concat(frames, ignore_index=True)


def _choose_failure_value(check: OfRuns) -> float:
    """Return the value of a run without one: NaN to drop it, infinite if it is worse than any
    other, or a value for which the event is false.
    """
    if check.failures == "drop":
        return np.nan
    # Infinitely far on the side of the limit where the event is false.
    above = check.limit is not None and check.limit[0] in ("above", "at_least")
    return -np.inf if above and check.failures == "count" else np.inf


def list_unit_columns(check: OfRuns) -> list[str]:
    """List the columns that identify a unit of a comparison; the number of the unit is last."""
    return [*check.every, *check.pool, *filter(None, [check.cells]), check.replicate]


def find_mixed_factor(check: OfRuns, runs: pd.DataFrame) -> str:
    """Find a factor (experiment, condition or method) of which a unit of a comparison mixes several
    values; empty if there is none.
    """
    keys = list_unit_columns(check)
    factors = [factor for factor in _FACTORS if factor not in keys]
    distinct = runs[[*keys, *factors]].drop_duplicates()
    several = distinct[distinct.duplicated(keys, keep=False)]
    return next((factor for factor in factors if several[factor].nunique() > 1), "")


def _split(rows: pd.DataFrame, columns: list[str]) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield the rows of each combination of values of the columns, with its name, sorted."""
    if not columns:
        yield "", rows
        return
    for values, part in rows.groupby(columns, dropna=False):
        yield ", ".join(f"{column}={value}" for column, value in zip(columns, values)), part


def _average_units(check: OfRuns, rows: pd.DataFrame) -> dict[str, dict[str, np.ndarray]]:
    """Average the values of each unit (units,): by the name of what is pooled, then by cell. A run
    that counts as failed makes its unit fail. A cell without runs has NaN alone, which
    `effects.explain_too_few` names.
    """
    keys = [*check.pool, check.replicate, *filter(None, [check.cells])]
    means = rows.groupby(keys, dropna=False)["value"].mean()
    # A check without groups has one cell, whose name is empty.
    table = means.unstack(check.cells) if check.cells else means.to_frame("")
    return {
        name: defaultdict(partial(np.full, len(part), np.nan), zip(part, part.to_numpy().T))
        for name, part in _split(table, check.pool)
    }


def _count_outcomes(check: OfRuns, rows: pd.DataFrame) -> list[Counter]:
    """Count by cell the runs that succeed, and those that fail; nothing if a check does not compare
    successes alone.
    """
    feasible_only = metrics.METRICS[check.metric].feasible_only
    if check.cells is None or check.failures != "drop" or not feasible_only:
        return []
    failed = rows["value"].isna()
    return [Counter(rows.loc[each, check.cells]) for each in (~failed, failed)]


def _note_success_rates(outcomes: list[Counter], cells: list) -> str:
    """Return a note if two groups are compared on their successful runs but differ in success rate
    (Fisher's exact test); otherwise an empty text.
    """
    if len(cells) != 2 or not outcomes:
        return ""
    from scipy import stats

    counts = [[count[cell] for count in outcomes] for cell in cells]
    return (
        "compared on successes alone, which are of different number"
        if stats.fisher_exact(counts).pvalue < effects.ALPHA
        else ""
    )


def _list_published_tables(check: OfRuns, claim: Claim, material: Material) -> list[PrintedTable]:
    """List the published numbers of each table of the check's experiments, the claim's artefacts
    first.
    """
    names = dict.fromkeys([*claim.artefacts, *material.study.artefacts])
    return [
        select_metric(
            part.experiment,
            comparison.assign_metrics(
                material.published[PurePath(part.published).stem], part.reads
            ),
            check.printed_metric,
        )
        for part in _list_displays(check, names, material)
        if part.published
    ]
