"""The planned runs of an experiment: methods, problems, settings, and how they are selected or mixed."""

from functools import cache
from typing import Any

from bezierplan.analysis.claims.kinds import Check
from bezierplan.analysis.metrics import METRICS
from bezierplan.planners import PLACE
from bezierplan.running.columns import OUTCOMES, RUN_COLUMNS
from bezierplan.schema.checked import Fault, closest
from bezierplan.schema.model import one_or_list
from bezierplan.study.claims import Claim
from bezierplan.study.definition import Study
from bezierplan.study.jobs import job

Row = dict[str, Any]

# Columns with one value per unit of a comparison; several values would silently mix their runs.
_FACTORS = ("experiment", "condition", "method")
# Columns for which a design does not hold every value.
_MANY = ("repeat", "layout", "problem", "condition", "id")


class Design:
    """The runs of a study's experiments, one row each, without repeats; two layouts represent all layouts of a problem that is drawn
    several times.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.rows = cache(self._rows)
        self.columns = cache(self._columns)

    def _rows(self, experiment: str) -> list[Row]:
        from bezierplan.running.execution import conditions, settings_in

        content, rows = self.study.experiments[experiment], []
        for method in self.study.methods_of(experiment):
            described = job(self.study, experiment, method, "full", 0)
            problems = [name for name, problem in described["problems"].items() if problem.get("layout", 0) < 2]
            for condition in conditions(problems, content.vary):
                place = {key: value for key, value in described["problems"][condition.problem].items() if key != "settings"}
                names = {"experiment": experiment, "condition": condition.name, "problem": condition.problem, "method": method}
                rows.append(names | place | settings_in(described, condition) | condition.values | {"planner": described["planner"]})
        return rows

    def _columns(self, experiment: str) -> frozenset[str]:
        """Columns of the runs table of an experiment that a selection may name."""
        methods = self.study.methods_of(experiment)
        problems = [self.study.problems[name] for name in self.study.experiments[experiment].problems]
        places = {
            key for problem in problems for key in (*problem.model_fields_set, *(["layout"] if problem.layouts else [])) if key in PLACE
        }
        settings = {setting for name in methods for setting in self.study.resolved(name)}
        return frozenset(
            {
                "straight_line",
                "bound",
                "octile_bound",
                "study",
                "experiment",
                *RUN_COLUMNS,
                *(OUTCOMES if self.study.moves(experiment) else ()),
                *places,
                *settings,
                *self.study.experiments[experiment].vary,
            }
        )

    def check_where(self, experiments: list[str], where: dict[str, Any], place: str, *, baselines: bool = True) -> None:
        """A selection names existing columns and values, in a combination that some run has. Raises Fault, beginning with a place."""
        known = frozenset().union(*map(self.columns, experiments))
        rows = self.selectable(experiments, baselines)
        for column, wanted in where.items():
            # A condition may also concern an outcome, which only some planners report.
            if column not in known and column not in METRICS:
                raise Fault(f"{place}: {column}: unknown{closest(column, known)}")
            values = self.values(experiments, column, rows)
            for value in one_or_list(wanted) if values else []:
                if value not in values:
                    raise Fault(f"{place}: {column}: {value}: unknown{self.hint(value, values)}")
        if rows and not any(_fits(row, where) for row in rows):
            raise Fault(
                f"{place}: no run of {', '.join(experiments)} has all of {', '.join(f'{key} {value}' for key, value in where.items())}"
            )

    def selectable(self, experiments: list[str], baselines: bool) -> list[Row]:
        """Rows of experiments; claims do not include those of baselines."""
        rows = [row for name in experiments for row in self.rows(name)]
        return [row for row in rows if baselines or row["method"] not in self.study.baselines]

    def values(self, experiments: list[str], column: str, rows: list[Row]) -> list[Any]:
        """All values of a column in rows of experiments; empty if a design does not hold them."""
        if column == "problem":
            return [name for experiment in experiments for name in self.study.problems_of(experiment, "full")]
        if column in _MANY or all(column not in row for row in rows):
            return []
        return list({repr(row[column]): row[column] for row in rows if column in row}.values())

    def hint(self, value: Any, values: list[Any]) -> str:
        """`; did you mean ...?` for a value of a column; a baseline named among compared methods is pointed out as such."""
        if value in self.study.baselines:
            return f" here: a baseline; claims compare methods, known: {', '.join(map(str, values))}"
        return closest(value, values)

    def check_mixtures(self, check: Check, where: dict[str, Any], place: str) -> None:
        """Raise Fault if a unit of a comparison, as identified by the check's columns, would mix several values of a column."""
        keys = [*check.every, *getattr(check, "pool", ()), *([check.cells] if check.cells else []), check.replicate]
        rows = [row for row in self.selectable(check.experiments, baselines=False) if _fits(row, where)]
        found: dict[tuple, Row] = {}
        for row in rows:
            first = found.setdefault(tuple(repr(row.get(key)) for key in keys), row)
            for factor in _FACTORS:
                if factor not in keys and row[factor] != first[factor]:
                    values = f"{first[factor]} and {row[factor]}"
                    raise Fault(f"{place}: several values of {factor} are neither told apart nor pooled, such as {values}")


def _fits(row: Row, where: dict[str, Any]) -> bool:
    """Whether a run matches the conditions of a selection, as far as that is known before it is run."""
    for column, wanted in where.items():
        outcome = column in METRICS or (column in RUN_COLUMNS and column not in row) or column in ("repeat", "layout")
        drawn = column == "problem" and "layout" in row
        if not outcome and not drawn and row.get(column) not in one_or_list(wanted):
            return False
    return True


def in_first_variant(claim: Claim, check: Check) -> dict[str, Any]:
    """The selection of a check in the primary variant: a column whose first value no check names becomes one more condition."""
    extra = {}
    for column, values in claim.variants.items():
        firsts = one_or_list(values[0])
        if column not in ("metric", "experiment") and not any(_names(each, column, firsts) for each in claim.checks):
            extra[column] = values[0]
    return getattr(check, "where", {}) | extra


def judged_only(job: dict, claims: list[Claim]) -> dict:
    """A chunk of runs without the problems and varied values that no check of these claims selects in its primary variant."""
    wheres = [in_first_variant(claim, check) for claim in claims for check in claim.checks if job["experiment"] in check.experiments]

    def wanted(column: str, value: Any) -> bool:
        return any(value in one_or_list(where.get(column, [value])) for where in wheres)

    def met(place: dict) -> bool:
        columns = place.keys() & set(PLACE)
        return any(all(place[column] in one_or_list(where.get(column, [place[column]])) for column in columns) for where in wheres)

    problems = {name: place for name, place in job["problems"].items() if met(place) and ("layout" in place or wanted("problem", name))}
    return job | {
        "problems": problems,
        "vary": {column: [value for value in values if wanted(column, value)] for column, values in job["vary"].items()},
    }


def _names(check: Check, column: str, values: list[Any]) -> bool:
    named = one_or_list(getattr(check, "where", {}).get(column, []))
    if column == getattr(check, "across", None):
        named = [*named, *check.groups_named]
    return any(value in named for value in values)
