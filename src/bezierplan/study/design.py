"""The planned runs of experiments: methods, problems, settings, and what files can select."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import pandas as pd

from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.results import select
from bezierplan.planners import load_planner
from bezierplan.running.columns import DRIVE_JOINED, DRIVE_RESULTS, JOINED, PLANNED, RESULTS
from bezierplan.running.execution import identify_run
from bezierplan.schema.checked import Fault, check_known
from bezierplan.schema.model import convert_to_list, is_number
from bezierplan.study.definition import Study
from bezierplan.study.jobs import build_chunk

# Columns that are left out when bounds are joined, or are no numbers to choose by.
_LEFT_OUT = ("least_length", "bound_path")


class Design(NamedTuple):
    """The planned runs of experiments at scale full."""

    name: str
    """The names of the experiments, as messages show them."""
    rows: pd.DataFrame
    """One row for each condition and method, with the columns that are known before a run (repeat
    0).
    """
    types: dict[str, str]
    """Column -> type of its values: flag, number, word, list or name; `reported` for columns that
    only a planner reports.
    """
    kinds: set[str]
    """Kinds of workspace; empty for drives."""
    repeats: int

    def check_column(self, column: str, kind: str, location: str) -> None:
        """Raise Fault, beginning with a location, unless a column exists and has the type that is
        asked for.

        kind: `column` for one that is known before a run, `number column` for such a column of
        numbers, `quantity` for any column of numbers.
        """
        fit = [
            name
            for name, each in self.types.items()
            if (kind == "quantity" or name in self.rows)
            and (kind == "column" or each in ("number", "reported"))
        ]
        if column in self.types and column not in fit:
            wanted = "a column of numbers" if kind != "column" else "a column"
            wanted += "" if kind == "quantity" else " that is known before a run"
            raise Fault(f"{location}: {column}: a {self.types[column]}; expected {wanted}")
        check_known(column, fit, location)

    def check_metric(self, metric: str, location: str) -> None:
        """Raise Fault, beginning with a location, unless the runs can have a metric."""
        check_known(metric, METRICS, location)
        described, none = METRICS[metric], f"{location}: {metric}: no run of {self.name} has it"
        needed = described.needs or ((metric,) if described.compute is None else ())
        for lacking in (name for name in needed if name not in self.types):
            raise Fault(f"{none}: its runs table has no column {lacking}")
        if described.on and self.kinds and not self.kinds & set(described.on):
            raise Fault(f"{none}: it is for workspaces of kind {' or '.join(described.on)}")

    def check_where(self, where: dict[str, Any], location: str, claim: bool = False) -> None:
        """Raise Fault, beginning with a location, unless a selection names existing columns and
        values, and some planned run has all of them.

        claim: it may also select by a metric.
        """
        for column, wanted in where.items():
            key, known = f"{location}: {column}", column in self.rows
            if claim and column not in self.types and column in METRICS:
                self.check_metric(column, location)
                continue
            check_known(column, self.types, location)
            if not known and self.types[column] in ("number", "list", "name"):
                raise Fault(
                    f"{key}: {wanted}: a {self.types[column]} that a run finds out is not selected "
                    "by its value; expected another column"
                )
            for value in convert_to_list(wanted):
                kind = {"flag": bool, "word": str}.get(self.types[column], object)
                if not isinstance(value, kind):
                    raise Fault(f"{key}: {value}: expected a {self.types[column]}")
                if column == "repeat":
                    self.check_repeat(value, key)
                elif known:
                    check_known(value, self.values(column), key)
        planned = {
            column: wanted
            for column, wanted in where.items()
            if column in self.rows and column != "repeat"
        }
        if select(self.rows, planned).empty:
            raise Fault(
                f"{location}: no run of {self.name} has all of "
                f"{', '.join(f'{key} {value}' for key, value in planned.items())}"
            )

    def check_repeat(self, repeat: Any, location: str) -> None:
        """Raise Fault, beginning with a location, unless a repeat is run."""
        if repeat not in range(self.repeats):
            raise Fault(f"{location}: {repeat}: expected a repeat from 0 to {self.repeats - 1}")

    def values(self, column: str) -> list[Any]:
        """Return all values of a column that is known before a run."""
        return self.rows[column].dropna().unique().tolist()


def build_design(study: Study, experiment: str) -> Design:
    """Return the planned runs of an experiment."""
    methods, moves = study.methods_of(experiment), study.moves(experiment)
    chunks = [build_chunk(study, experiment, method, "full", 0) for method in methods]
    rows = [identify_run(chunk, each, 0) for chunk in chunks for each in chunk.conditions()]
    # As objects, because a column with gaps would turn 20 into 20.0, another value of a setting.
    frame = pd.DataFrame(rows, dtype=object).drop(columns="id")
    planners = () if moves else (load_planner(study.planner(method)) for method in methods)
    reported = {name: "reported" for each in planners for name in getattr(each, "extra", ())}
    joined = JOINED | (DRIVE_RESULTS | DRIVE_JOINED if moves else reported)
    problems = study.experiments[experiment].problems
    return Design(
        experiment,
        frame,
        {name: each for name, each in joined.items() if name not in _LEFT_OUT}
        | {name: _choose_type(frame[name].dropna().unique()) for name in frame}
        | (PLANNED | RESULTS),
        {study.kind_of(problem) for problem in problems} if not moves else set(),
        study.experiments[experiment].repeats["full"],
    )


def join_designs(designs: list[Design], without: Iterable[str]) -> Design:
    """Return the planned runs of several experiments, without those of some methods."""
    rows = pd.concat([each.rows for each in designs])
    return Design(
        ", ".join(each.name for each in designs),
        rows[~rows["method"].isin([*without])],
        {name: kind for each in designs for name, kind in each.types.items()},
        set().union(*(each.kinds for each in designs)),
        max(each.repeats for each in designs),
    )


def _choose_type(values: Iterable[Any]) -> str:
    """Return the type of a column of settings or places with these values: flag, number or word."""
    values = [*values]
    if values and all(isinstance(value, bool) for value in values):
        return "flag"
    return "number" if values and all(map(is_number, values)) else "word"
