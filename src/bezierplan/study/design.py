"""The planned runs of an experiment: methods, problems, settings, and what can be selected."""

from functools import cache
from typing import Any

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

# Columns for which the rows of a design do not hold every value.
_MANY = ("repeat", "id")
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
        columns = {key for problem in problems for key in problem.model_fields_set if key in PLACE}
        columns |= {"layout" for problem in problems if problem.layouts}
        columns |= {
            name
            for method in self.study.methods_of(experiment)
            for name in self.study.resolved(method)
        }
        columns |= self.study.experiments[experiment].vary.keys()
        return PLANNED | {
            column: _type([row[column] for row in self.rows(experiment) if column in row])
            for column in sorted(columns - PLANNED.keys())
        }

    def _types(self, experiments: list[str]) -> tuple[dict[str, str], set[str]]:
        """All columns of the runs tables of experiments with the types of their values, but for
        those that only their planners know; and those that are known before a run.
        """
        types, planned = {}, set()
        for experiment in experiments:
            joined = JOINED | (DRIVE_RESULTS | DRIVE_JOINED if self.study.moves(experiment) else {})
            joined = {name: each for name, each in joined.items() if name not in _LEFT_OUT}
            types |= RESULTS | joined | self.planned(experiment)
            planned |= self.planned(experiment).keys() - {"id"}
        return types, planned

    def check_column(self, experiments: list[str], column: str, kind: str, location: str) -> None:
        """A column exists, and has the type that is asked for. Raises Fault, beginning with a
        location.

        kind: `column`, one that is known before a run; `number column`, such a column of numbers;
        `quantity`, any column of numbers.
        """
        types, planned = self._types(experiments)
        numbers = {name for name, each in types.items() if each == "number"}
        fit = {"column": planned, "number column": planned & numbers, "quantity": numbers}[kind]
        if column in fit:
            return
        if kind == "quantity" and column in METRICS and METRICS[column].compute is None:
            self.check_metric(experiments, column, location)
        elif column in types:
            wanted = "a column of numbers" if kind != "column" else "a column"
            wanted += "" if kind == "quantity" else " that is known before a run"
            raise Fault(f"{location}: {column}: a {types[column]}; expected {wanted}")
        else:
            raise Fault(f"{location}: {column}: unknown{closest(column, fit)}")

    def check_metric(self, experiments: list[str], metric: str, location: str) -> None:
        """Runs of each experiment can have a metric. Raises Fault, beginning with a location."""
        described = METRICS[metric]
        for experiment in experiments:
            types, reported = self._types([experiment])[0], self._reported(experiment)
            needed = described.needs or ((metric,) if described.compute is None else ())
            lacking = [name for name in needed if name not in types and name not in reported]
            content = self.study.experiments[experiment]
            kinds = {self.study.kind_of(problem) for problem in content.problems}
            if lacking and None not in reported:
                raise Fault(
                    f"{location}: {metric}: no run of {experiment} has it: its runs table has no "
                    f"column {lacking[0]}"
                )
            if described.on and not self.study.moves(experiment) and not kinds & set(described.on):
                raise Fault(
                    f"{location}: {metric}: no run of {experiment} has it: it is for workspaces "
                    f"of kind {' or '.join(described.on)}"
                )

    def _reported(self, experiment: str) -> set[str | None]:
        """Extra columns that the planners of an experiment report; with None if one of them does
        not say which.
        """
        columns: set[str | None] = set()
        for method in self.study.methods_of(experiment):
            planner = self.study.planner(method)
            if not self.study.moves(experiment):
                unsaid = (None,) if is_file(planner) else ()
                columns.update(getattr(planner_module(planner), "extra", unsaid))
        return columns

    def check_where(
        self,
        experiments: list[str],
        where: dict[str, Any],
        location: str,
        *,
        baselines: bool = True,
    ) -> None:
        """A selection names existing columns and values, in a combination that some run has. Raises
        Fault, beginning with a location. baselines: whether it includes their runs, as those of
        claims do not, which may select by what is computed of runs.
        """
        types, planned = self._types(experiments)
        for column, wanted in where.items():
            key = f"{location}: {column}"
            if column not in types:
                computed = METRICS[column].compute is not None if column in METRICS else True
                if column not in METRICS or (computed and baselines):
                    raise Fault(f"{key}: unknown{closest(column, types)}")
                self.check_metric(experiments, column, location)
            elif column not in planned and types[column] in ("number", "list", "name"):
                raise Fault(
                    f"{key}: {wanted}: a {types[column]} that a run finds out is not selected by "
                    "its value; expected another column"
                )
            for value in one_or_list(wanted):
                kind = {"flag": bool, "word": str}.get(types.get(column, ""), object)
                if not isinstance(value, kind):
                    raise Fault(f"{key}: {value}: expected a {types[column]}")
                if column == "path_curve":
                    check_known(value, CURVES, key)
                elif column == "repeat":
                    self.check_repeat(experiments, value, key)
                elif column in planned and column not in _MANY:
                    values = self.values(experiments, column, baselines)
                    if identity(value) not in map(identity, values):
                        raise Fault(f"{key}: {value}: unknown{closest(value, values)}")
        rows = self._selectable(experiments, baselines)
        if rows and not any(fits(row, where) for row in rows):
            raise Fault(
                f"{location}: no run of {', '.join(experiments)} has all of "
                f"{', '.join(f'{key} {value}' for key, value in where.items())}"
            )

    def check_repeat(self, experiments: list[str], repeat: Any, location: str) -> None:
        """A repeat is run at scale full. Raises Fault, beginning with a location."""
        most = max(self.study.experiments[name].repeats["full"] for name in experiments)
        if not is_number(repeat) or repeat not in range(most):
            raise Fault(f"{location}: {repeat}: expected a repeat from 0 to {most - 1}")

    def _selectable(self, experiments: list[str], baselines: bool) -> list[Row]:
        """Rows of experiments, with those of baselines or without."""
        rows = [row for name in experiments for row in self.rows(name)]
        return [row for row in rows if baselines or row["method"] not in self.study.baselines]

    def values(self, experiments: list[str], column: str, baselines: bool = True) -> list[Any]:
        """All values of a column in rows of experiments."""
        if column not in ("problem", "layout", "condition"):
            rows = self._selectable(experiments, baselines)
            return list({repr(row[column]): row[column] for row in rows if column in row}.values())
        values: dict[Any, None] = {}
        for experiment in experiments:
            described = self.study.problems_of(experiment, "full")
            vary = self.study.experiments[experiment].vary
            every = {
                "problem": described,
                "layout": [each["layout"] for each in described.values() if "layout" in each],
                "condition": [each.name for each in conditions(list(described), vary)],
            }
            values |= dict.fromkeys(every[column])
        return list(values)


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
