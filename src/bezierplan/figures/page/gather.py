"""The content of the page, from the csv files of a scale. Columns are read by name, and those that
a file lacks stay empty.
"""

from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Any, TypeVar

import pandas as pd

from bezierplan.analysis import headline, sensitivity
from bezierplan.analysis.claims.check import Check
from bezierplan.analysis.claims.columns import CLAIM_COLUMNS
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.figures import style
from bezierplan.figures.page import content, other, why
from bezierplan.figures.page.addresses import address, of_cells
from bezierplan.figures.page.page_job import (
    FILES,
    AssumptionShown,
    FigureShown,
    StudyShown,
    TableShown,
)
from bezierplan.running.inputs import tree

# Columns of claims.csv that the page shows in places of their own, or that repeat the comparison
# that decides.
_CLAIM_COLUMNS = set(CLAIM_COLUMNS) - {"units_to_decide"}


def read(file: str | Path) -> pd.DataFrame:
    """A csv file in which only an empty cell is a missing value."""
    return pd.read_csv(file, keep_default_na=False, na_values=[""], low_memory=False)


def cell(value: Any) -> content.Cell:
    """A value of a table as JSON knows it: no NaN, no infinite number, no numpy type."""
    if value is None or pd.isna(value) or value in (float("inf"), float("-inf")):
        return None
    return value.item() if hasattr(value, "item") else value


def _number(row: pd.Series, column: str) -> float | None:
    """A number to eight digits; the csv files have the others."""
    value = cell(pd.to_numeric(row.get(column), errors="coerce"))
    return None if value is None else float(f"{value:.8g}")


def _interval(row: pd.Series, low: str, high: str) -> tuple[float | None, float | None]:
    return _number(row, low), _number(row, high)


def _text(row: pd.Series, column: str) -> str:
    value = cell(row.get(column))
    return "" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _flag(row: pd.Series, column: str) -> bool:
    return str(row.get(column)) == "True"


_READ = {
    str: _text,
    bool: _flag,
    float | None: _number,
    content.Cell: lambda row, column: cell(row.get(column)),
}
"""How a field of a record is read from the column of its name, by its type."""

R = TypeVar("R", bound=content.Record)


def _record(kind: type[R], row: pd.Series, /, **more: Any) -> R:
    """A record of a row: fields that are not given are what the columns of their names hold."""
    columns = {
        name: _READ[field.annotation](row, name)
        for name, field in kind.model_fields.items()
        if name not in more and field.annotation in _READ
    }
    return kind(**columns, **more)


def studies(
    job: Mapping[str, StudyShown],
    folder: Path,
    numbers: pd.DataFrame | None,
    claims: pd.DataFrame | None,
    measured: pd.DataFrame | None,
) -> dict[str, content.Study]:
    """All studies without the runs that the viewer shows, from the csv files in the folder of a
    scale.

    numbers, claims, measured: those of all studies (`analysis.summary`,
    `analysis.baseline_comparison`), if the scale has them.
    """
    outcome = (
        headline.outcome(numbers, claims).to_dict("index")
        if numbers is not None and claims is not None
        else {}
    )
    return {
        key: _study(key, own, folder, numbers, measured, outcome.get(key, {}))
        for key, own in job.items()
    }


def _study(
    key: str,
    job: StudyShown,
    folder: Path,
    numbers: pd.DataFrame | None,
    measured: pd.DataFrame | None,
    outcome: dict[str, int],
) -> content.Study:
    files = {name: read(folder / key / FILES[name]) for name in job.files}
    judged = files.get("claims", pd.DataFrame(columns=["study", "id", "primary", "verdict"]))
    choices = _choices(files.get("sensitivity"), judged)
    own = None if numbers is None else numbers[numbers["study"] == key]
    tables = [
        _table(key, name, table, folder, own, job.labels) for name, table in job.tables.items()
    ]
    gaps = [
        number.gap
        for table in tables
        for number in table.numbers
        if number.counted and number.gap is not None
    ]
    return content.Study(
        address=address(key),
        title=job.title,
        paper=content.Paper(**job.paper._asdict()) if job.paper else None,
        methods=[other.of_method(key, name, method) for name, method in job.methods.items()],
        outcome={name: count for name, count in outcome.items() if isinstance(count, int)},
        claims=_claims(key, judged, files.get("checks"), choices, job),
        tables=tables,
        figures=[_figure(key, name, figure, folder) for name, figure in job.figures.items()],
        audit=[_audited(row) for _, row in files["audit"].iterrows()] if "audit" in files else [],
        assumptions=[_assumption(key, each, choices) for each in job.assumptions],
        gap=median(gaps) if gaps else None,
        shown=[],
        labels=job.labels,
        **(other.of_baseline_comparison(key, measured) if measured is not None else {}),
    )


def _figure(study: str, name: str, job: FigureShown, folder: Path) -> content.Figure:
    stem = f"{study}/{tree(name)}/{name}"
    told, _, seen = (folder / f"{stem}.txt").read_text(encoding="utf-8").strip().partition("\n")
    return content.Figure(
        address=address(study, name),
        name=name,
        title=job.title,
        caption=job.caption,
        told=told,
        seen=seen,
        svg=f"{stem}.svg",
        csv=f"{stem}.csv",
    )


def _table(
    study: str,
    name: str,
    job: TableShown,
    folder: Path,
    numbers: pd.DataFrame | None,
    labels: dict[str, str],
) -> content.Table:
    table_address, spec = address(study, name), job.spec
    is_compared = isinstance(spec, Pivot) and spec.published
    file = f"{study}/{tree(name)}/{name}{'.comparison' if is_compared else ''}.csv"
    table = read(folder / file)
    shown: dict[str, Any] = (
        {"numbers": _numbers(table_address, table, spec, numbers, labels)}
        if is_compared
        else {
            "columns": [str(column) for column in table],
            "rows": [[cell(value) for value in row] for row in table.itertuples(index=False)],
        }
    )
    return content.Table(
        address=table_address,
        name=name,
        title=job.title,
        caption=job.caption,
        csv=file,
        latex=f"{study}/{tree(name)}/{name}.tex",
        **shown,
    )


def _numbers(
    table: str,
    compared: pd.DataFrame,
    spec: Pivot,
    numbers: pd.DataFrame | None,
    labels: dict[str, str],
) -> list[content.Number]:
    """The cells of a table: those with a published number, and what other methods have in the same
    column.
    """
    keys = list(compared.columns[: compared.columns.get_loc("metric")])
    published = compared["value_published"].notna()
    compared = compared.assign(counted=False)
    if numbers is not None:
        # `summary.numbers` keeps the order of a table's rows.
        compared.loc[published, "counted"] = numbers.loc[
            numbers["table"] == table.partition("/")[2], "counted"
        ].to_numpy()
    printed = compared.loc[published, ["metric", "statistic"]].drop_duplicates()
    shown = compared.merge(printed, on=["metric", "statistic"])
    places = shown[[*keys, "metric", "statistic"]].to_dict("records")
    addresses = of_cells(table, places, spec.primary)
    cells = []
    for place, name, (_, row) in zip(places, addresses, shown.iterrows(), strict=True):
        cells.append(
            _record(
                content.Number,
                row,
                address=name,
                keys={key: cell(place[key]) for key in keys},
                row=", ".join(printed_key(key, place[key], labels) for key in keys),
                column=_heading(row["metric"], row["statistic"], spec, labels),
                published=_number(row, "value_published"),
                ours=_number(row, "value_ours"),
                scaled=_number(row, "value_ours_scaled"),
                n=_number(row, "n_ours"),
                interval=_interval(row, "low95_ours", "high95_ours"),
                predicted=_interval(row, "low95_predicted", "high95_predicted"),
            )
        )
    return cells


def printed_key(column: str, value: content.Cell, labels: dict[str, str]) -> str:
    """The value of a key column as printed; a number is named."""
    return (
        ""
        if value is None
        else str(value)
        if isinstance(value, bool)
        else style.printed(value, column, labels)
    )


def _heading(metric: str, statistic: str, spec: Pivot, labels: dict[str, str]) -> str:
    """Metric and statistic as the table prints them; one that the paper does not state stands
    beside our median.
    """
    beside = {statistic, "median"} if statistic == "unstated" else {statistic}
    for value in spec.values:
        if value.metric == metric and beside & set(value.statistics):
            return value.label + (f": {statistic}" if len(value.statistics) > 1 else "")
    return f"{style.column_name(metric, labels)}: {statistic}"


def _claims(
    study: str,
    judged: pd.DataFrame,
    checks: pd.DataFrame | None,
    choices: list[content.Choice],
    job: StudyShown,
) -> list[content.Claim]:
    claims, labels, there = [], job.labels, job.tables.keys() | job.figures.keys()
    for identity, rows in judged.groupby("id", sort=False):
        row = rows[rows["primary"].astype(bool)].iloc[0]
        variant = _text(row, "variant")
        compared = (
            checks[
                (checks["id"] == identity)
                & (checks["variant"].astype(object).fillna("") == variant)
            ]
            if checks is not None
            else pd.DataFrame()
        )
        written = job.checks.get(identity, [])
        decisive = next(
            (n for n, (_, each) in enumerate(compared.iterrows()) if _flag(each, "decisive")), None
        )
        claims.append(
            _record(
                content.Claim,
                row,
                address=address(study, identity),
                where=_text(row, "where_it_holds"),
                replication=_number(row, "replication_probability"),
                shown_in=[
                    address(study, name)
                    for name in _text(row, "artefact").replace(",", " ").split()
                    if name in there
                ],
                comparisons=[_comparison(each, labels, written) for _, each in compared.iterrows()],
                decisive=decisive,
                why="" if decisive is None else _why(compared.iloc[decisive], written, labels, row),
                variant=_labelled(variant, labels),
                interpretations=[
                    _record(
                        content.Interpretation,
                        each,
                        variant=_labelled(_text(each, "variant"), labels),
                    )
                    for _, each in rows[~rows["primary"].astype(bool)].iterrows()
                ],
                choices=[choice for choice in choices if choice.claim == identity],
                more={name: cell(row[name]) for name in judged if name not in _CLAIM_COLUMNS},
            )
        )
    return claims


def _why(decisive: pd.Series, checks: list[Check], labels: dict[str, str], claim: pd.Series) -> str:
    """The sentence that says why (`why`), from the decisive comparison; empty for a check that the
    study has no more.
    """
    number = int(decisive["check"])
    if number > len(checks):
        return ""
    words = (_labelled(_text(decisive, name), labels) for name in ("comparison", "condition"))
    return why.why(
        decisive, checks[number - 1], *words, own_criterion=_flag(claim, "own_criterion")
    )


def _comparison(row: pd.Series, labels: dict[str, str], checks: list[Check]) -> content.Comparison:
    number = int(row["check"])
    words = (_labelled(_text(row, name), labels) for name in ("comparison", "condition"))
    return _record(
        content.Comparison,
        row,
        check=number,
        reference=why.reference(checks[number - 1]) if number <= len(checks) else 0.0,
        deciding=_flag(row, "primary"),
        name=", ".join(filter(None, words)),
        mark=_text(row, "mark_family") or _text(row, "mark"),
        interval=_interval(row, "low95", "high95"),
    )


def _labelled(words: str, labels: dict[str, str]) -> str:
    """Words such as `mga lower than prm` or `problem=0_15, obstacles=5` with names as they are
    printed.
    """
    parts = []
    for part in words.split(", "):
        key, equals, value = part.partition("=")
        if equals:
            parts.append(labels.get(value) or f"{style.column_name(key, labels)} {value}")
        else:
            parts.append(" ".join(style.column_name(word, labels) for word in part.split(" ")))
    return ", ".join(parts)


def _choices(tried: pd.DataFrame | None, judged: pd.DataFrame) -> list[content.Choice]:
    """Alternatives tried on claims; those that were judged beside another verdict than today's are
    out of date and left out.
    """
    if tried is None:
        return []
    today = judged[judged["primary"].astype(bool)].set_index("id")["verdict"]
    return [
        content.Choice(
            assumption=row["assumption"],
            alternative=_text(row, "alternative"),
            claim=row["claim"],
            verdict=row["verdict_alternative"],
            changed=sensitivity.changed(row["verdict"], row["verdict_alternative"]) is True,
        )
        for _, row in tried.iterrows()
        if today.get(row["claim"]) == row["verdict"]
    ]


def _assumption(
    study: str, job: AssumptionShown, choices: list[content.Choice]
) -> content.Assumption:
    default = job.default
    if isinstance(default, dict):
        default = ", ".join(f"{name}: {value}" for name, value in default.items())
    return content.Assumption(
        **job._asdict()
        | {
            "address": address(study, job.id),
            "default": str(default),
            "alternatives": [str(value) for value in job.alternatives],
            "setting": job.setting or "",
            "choices": [choice for choice in choices if choice.assumption == job.id],
        }
    )


def _audited(row: pd.Series) -> content.Audited:
    checked = cell(row["consistent"])
    consistent = None if checked is None else str(checked) == "True"
    return _record(content.Audited, row, consistent=consistent)
