"""The planned runs of an experiment: methods, problems, settings, and how they are selected or
mixed.
"""

from functools import cache
from typing import Any

from bezierplan.analysis.claims.check import Check
from bezierplan.analysis.metrics import METRICS
from bezierplan.geometry.curves import CURVES
from bezierplan.planners import PLACE, is_file, planner_module
from bezierplan.running.chunk import conditions
from bezierplan.running.columns import (
    DRIVE_JOINED,
    DRIVE_RESULTS,
    JOINED,
    PLANNED,
    RESULTS,
    RUN_COLUMNS,
)
from bezierplan.schema.checked import Fault, check_known, closest
from bezierplan.schema.model import identity, is_number, one_or_list
from bezierplan.study.definition import Study
from bezierplan.study.jobs import job

Row = dict[str, Any]

# Columns with one value per unit of a comparison; several values would silently mix their runs.
_FACTORS = ("experiment", "condition", "method")
# Columns for which the rows of a design do not hold every value.
_MANY = ("repeat", "layout", "problem", "condition", "id")
# Columns that are left out when bounds are joined, or are no numbers to choose by.
_LEFT_OUT = ("least_length", "bound_path")


class Design:
    """The runs of a study's experiments, one row each, without repeats; two layouts represent all
    layouts of a problem that is drawn several times.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.rows = cache(self._rows)
        self.planned = cache(self._planned)
        self.types = cache(self._types)
        self.reported = cache(self._reported)

    def _rows(self, experiment: str) -> list[Row]:
        from bezierplan.running.execution import identity as identity_of

        content, rows = self.study.experiments[experiment], []
        for method in self.study.methods_of(experiment):
            described = job(self.study, experiment, method, "full", 0)
            problems = [
                name for name, problem in described.problems.items() if problem.get("layout", 0) < 2
            ]
            for condition in conditions(problems, content.vary):
                row = identity_of(described, condition, 0)
                rows.append({key: row[key] for key in row if key not in ("id", "study", "repeat")})
        return rows

    def _planned(self, experiment: str) -> dict[str, str]:
        """Columns of the runs table of an experiment that are known before its runs, each with the
        type of its values.
        """
        problems = [
            self.study.problems[name] for name in self.study.experiments[experiment].problems
        ]
        places = {
            key
            for problem in problems
            for key in (*problem.model_fields_set, *(["layout"] if problem.layouts else []))
            if key in PLACE
        }
        settings = {
            setting
            for name in self.study.methods_of(experiment)
            for setting in self.study.resolved(name)
        }
        own = {*places, *settings, *self.study.experiments[experiment].vary} - PLANNED.keys()
        return PLANNED | {
            column: _type([row[column] for row in self.rows(experiment) if column in row])
            for column in sorted(own)
        }

    def _types(self, experiment: str) -> dict[str, str]:
        """All columns of the runs table of an experiment, as it is read, but for those that only
        its planners know.
        """
        joined = JOINED | (DRIVE_RESULTS | DRIVE_JOINED if self.study.moves(experiment) else {})
        return (
            RESULTS
            | {name: each for name, each in joined.items() if name not in _LEFT_OUT}
            | self.planned(experiment)
        )

    def _reported(self, experiment: str) -> frozenset[str] | None:
        """Extra columns that the planners of an experiment report; None if one of them does not say
        which.
        """
        if self.study.moves(experiment):
            return frozenset()
        columns: set[str] = set()
        for method in self.study.methods_of(experiment):
            planner = self.study.planner(method)
            extra = getattr(planner_module(planner), "extra", None if is_file(planner) else ())
            if extra is None:
                return None
            columns.update(extra)
        return frozenset(columns)

    def check_column(self, experiments: list[str], column: str, kind: str, location: str) -> None:
        """A column exists, and has the type that is asked for. Raises Fault, beginning with a
        location.

        kind: `column`, one that is known before a run; `number column`, such a column of numbers;
        `quantity`, any column of numbers.
        """
        types = {
            name: each
            for experiment in experiments
            for name, each in self.types(experiment).items()
        }
        planned = {
            name: each
            for experiment in experiments
            for name, each in self.planned(experiment).items()
            if each != "name"
        }
        fit = {name for name, each in types.items() if each == "number"}
        if kind != "quantity":
            fit = planned.keys() & fit if kind == "number column" else planned.keys()
        if column in fit:
            return
        if column not in types:
            if kind == "quantity" and column in METRICS and METRICS[column].compute is None:
                self.check_metric(experiments, column, location)
                return
            raise Fault(f"{location}: {column}: unknown{closest(column, fit)}")
        kind_found = (
            f"a {types[column]} of each run"
            if column in planned or column == "id"
            else f"a {types[column]} that a run finds out"
        )
        expected = {
            "column": "a column that is known before a run",
            "number column": "a column of numbers that is known before a run",
            "quantity": "a column of numbers",
        }[kind]
        raise Fault(
            f"{location}: {column}: {kind_found}; expected {expected}{closest(column, fit)}"
        )

    def check_metric(self, experiments: list[str], metric: str, location: str) -> None:
        """Runs of each experiment can have a metric. Raises Fault, beginning with a location."""
        for experiment in experiments:
            if (reason := self._lack(experiment, metric)) is not None:
                known = [name for name in METRICS if self._lack(experiment, name) is None]
                raise Fault(
                    f"{location}: {metric}: no run of {experiment} has it: "
                    f"{reason}{closest(metric, known)}"
                )

    def _lack(self, experiment: str, metric: str) -> str | None:
        """Why no run of an experiment has a metric, or None."""
        described, reported = METRICS[metric], self.reported(experiment)
        needed = described.needs or ((metric,) if described.compute is None else ())
        for column in needed:
            if (
                column not in self.types(experiment)
                and reported is not None
                and column not in reported
            ):
                return f"its runs table has no column {column}"
        kinds = {
            self.study.kind_of(problem) for problem in self.study.experiments[experiment].problems
        }
        if described.on and not self.study.moves(experiment) and not kinds & set(described.on):
            return (
                f"it is for workspaces of kind {' or '.join(described.on)}, not "
                f"{', '.join(sorted(kinds))}"
            )
        return None

    def check_repeat(self, experiments: list[str], repeat: int, location: str) -> None:
        """A repeat is run at scale full. Raises Fault, beginning with a location."""
        most = max(self.study.experiments[name].repeats["full"] for name in experiments)
        if repeat >= most:
            raise Fault(
                f"{location}: {repeat}: expected a repeat from 0 to {most - 1}: "
                f"{', '.join(experiments)} has {most} at scale full"
            )

    def check_where(
        self,
        experiments: list[str],
        where: dict[str, Any],
        location: str,
        *,
        baselines: bool = True,
    ) -> None:
        """A selection names existing columns and values, in a combination that some run has. Raises
        Fault, beginning with a location.
        """
        rows = self.selectable(experiments, baselines)
        for column, wanted in where.items():
            for value in one_or_list(wanted):
                where_to = f"{location}: {column}"
                self._check_value(experiments, column, value, rows, where_to, baselines)
        if rows and not any(fits(row, where) for row in rows):
            raise Fault(
                f"{location}: no run of {', '.join(experiments)} has all of "
                f"{', '.join(f'{key} {value}' for key, value in where.items())}"
            )

    def _check_value(
        self,
        experiments: list[str],
        column: str,
        value: Any,
        rows: list[Row],
        location: str,
        baselines: bool,
    ) -> None:
        """A value is one that a column can have, as far as that is known before its runs; only
        claims, which leave out baselines, select by what is computed of runs.
        """
        types = {
            name: each
            for experiment in experiments
            for name, each in self.types(experiment).items()
        }
        planned = {name for experiment in experiments for name in self.planned(experiment)}
        if column not in types:
            if column not in METRICS or (METRICS[column].compute is not None and baselines):
                raise Fault(f"{location}: unknown{closest(column, types)}")
            # A planner's own column.
            self.check_metric(experiments, column, location.rpartition(": ")[0])
            kind = "flag" if METRICS[column].step == 1 else "number"
        else:
            kind = types[column]
        if column == "id" or (column not in planned and kind in ("number", "list")):
            raise Fault(
                f"{location}: {value}: a {kind} that a run finds out is not selected by its "
                "value; expected another column"
            )
        if column not in planned:
            if kind == "flag" and not isinstance(value, bool):
                raise Fault(f"{location}: {value}: expected true or false")
            if kind == "word" and not isinstance(value, str):
                raise Fault(f"{location}: {value}: expected a word")
            if column == "path_curve":
                check_known(value, CURVES, location)
        elif column == "repeat":
            if not is_number(value) or value != int(value) or value < 0:
                raise Fault(f"{location}: {value}: expected a whole number of at least 0")
            self.check_repeat(experiments, value, location)
        else:
            values = self.values(experiments, column, rows)
            if identity(value) not in map(identity, values):
                raise Fault(f"{location}: {value}: unknown{self.hint(value, values)}")

    def selectable(self, experiments: list[str], baselines: bool) -> list[Row]:
        """Rows of experiments; claims do not include those of baselines."""
        rows = [row for name in experiments for row in self.rows(name)]
        return [row for row in rows if baselines or row["method"] not in self.study.baselines]

    def values(self, experiments: list[str], column: str, rows: list[Row]) -> list[Any]:
        """All values of a column in rows of experiments; empty if a design does not hold them."""
        if column in ("problem", "layout", "condition"):
            return [
                value for experiment in experiments for value in self._every(experiment, column)
            ]
        if column in _MANY or all(column not in row for row in rows):
            return []
        return list({repr(row[column]): row[column] for row in rows if column in row}.values())

    def _every(self, experiment: str, column: str) -> list[Any]:
        """All problems, layouts or conditions of an experiment at scale full."""
        described = self.study.problems_of(experiment, "full")
        if column == "condition":
            return [
                condition.name
                for condition in conditions(
                    list(described), self.study.experiments[experiment].vary
                )
            ]
        return (
            list(described)
            if column == "problem"
            else sorted({each["layout"] for each in described.values() if "layout" in each})
        )

    def shown(self, experiment: str, where: dict[str, Any]) -> dict[str, set[str]]:
        """The problems and methods of the runs that a panel selects."""
        methods = one_or_list(where.get("method", self.study.experiments[experiment].methods))
        rows = [
            row for row in self.rows(experiment) if row["method"] in methods and fits(row, where)
        ]
        problems = {row["problem"] for row in rows if "layout" not in row}
        if any("layout" in row for row in rows):
            wanted = {
                key: one_or_list(values)
                for key, values in where.items()
                if key in (*PLACE, "problem")
            }
            for name, problem in self.study.problems_of(experiment, "full").items():
                if "layout" in problem and all(
                    (problem | {"problem": name}).get(key) in values
                    for key, values in wanted.items()
                ):
                    problems.add(name)
        return {"problem": problems, "method": {row["method"] for row in rows}}

    def hint(self, value: Any, values: list[Any]) -> str:
        """`; did you mean ...?` for a value of a column; a baseline named among compared methods is
        pointed out as such.
        """
        if value in self.study.baselines:
            return (
                f" here: a baseline; claims compare methods, known: {', '.join(map(str, values))}"
            )
        return closest(value, values)

    def check_mixtures(self, check: Check, where: dict[str, Any], location: str) -> None:
        """Raise Fault if a unit of a comparison, as identified by the check's columns, would mix
        several values of a column.
        """
        keys = [
            *check.every,
            *getattr(check, "pool", ()),
            *([check.cells] if check.cells else []),
            check.replicate,
        ]
        rows = [
            row for row in self.selectable(check.experiments, baselines=False) if fits(row, where)
        ]
        found: dict[tuple, Row] = {}
        for row in rows:
            first = found.setdefault(tuple(repr(row.get(key)) for key in keys), row)
            for factor in _FACTORS:
                if factor not in keys and row[factor] != first[factor]:
                    values = f"{first[factor]} and {row[factor]}"
                    raise Fault(
                        f"{location}: several values of {factor} are neither told apart nor "
                        f"pooled, such as {values}"
                    )


def _type(values: list[Any]) -> str:
    """The type of a column of settings or places with these values."""
    if values and all(isinstance(value, bool) for value in values):
        return "flag"
    return "number" if values and all(map(is_number, values)) else "word"


def fits(row: Row, where: dict[str, Any]) -> bool:
    """Whether a run matches the conditions of a selection, as far as known before it is run."""
    for column, wanted in where.items():
        outcome = (
            column in METRICS
            or (column in RUN_COLUMNS and column not in row)
            or column in ("repeat", "layout", "condition")
        )
        drawn = column == "problem" and "layout" in row
        if not outcome and not drawn and row.get(column) not in one_or_list(wanted):
            return False
    return True
