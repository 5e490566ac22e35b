"""The content of the page, from the csv files of a scale. Columns are read by name, and those that
a file lacks stay empty.
"""

from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Any

import pandas as pd

from bezierplan.analysis import headline, sensitivity
from bezierplan.analysis.claims.kinds import Check
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.figures import style
from bezierplan.figures.page import content, other, why
from bezierplan.figures.page.addresses import address, of_cells
from bezierplan.figures.page.page_job import AssumptionShown, FigureShown, StudyShown, TableShown

# Columns of claims.csv that the page shows in places of their own, or that repeat the comparison
# that decides.
_CLAIM_COLUMNS = {
    *(
        "study",
        "id",
        "variant",
        "primary",
        "finding",
        "own_criterion",
        "place",
        "statement",
        "verdict",
        "holds",
        "where_it_holds",
        "published",
        "reason",
    ),
    *(
        "effect",
        "effect_size_name",
        "effect_size",
        "low95",
        "high95",
        "n",
        "counted",
        "p",
        "p_family",
        "replication_probability",
        "size",
    ),
    *("artefact", "timed"),
}


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
    files = {name: read(file) for name, file in job.files.items()}
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
        latex=job.latex,
        audit=[_audited(row) for _, row in files["audit"].iterrows()] if "audit" in files else [],
        assumptions=[_assumption(key, each, choices) for each in job.assumptions],
        gap=median(gaps) if gaps else None,
        shown=[],
        labels=job.labels,
        **(other.of_baseline_comparison(key, measured) if measured is not None else {}),
        **(
            other.of_interpretations(
                files["interpretations"], files["explained"], files["leave_one_table_out"]
            )
            if "interpretations" in files
            else {}
        ),
    )


def _figure(study: str, name: str, job: FigureShown, folder: Path) -> content.Figure:
    stem = f"{study}/figures/{name}"
    told, _, seen = (folder / f"{stem}.txt").read_text(encoding="utf-8").strip().partition("\n")
    named = {
        "address": address(study, name),
        "name": name,
        "title": job.title,
        "caption": job.caption,
        "told": told,
        "seen": seen,
    }
    return content.Figure(**named, svg=f"{stem}.svg", csv=f"{stem}.csv")


def _table(
    study: str,
    name: str,
    job: TableShown,
    folder: Path,
    numbers: pd.DataFrame | None,
    labels: dict[str, str],
) -> content.Table:
    file = f"{study}/tables/{name}.csv"
    compared = folder / study / "tables" / f"{name}.comparison.csv"
    named = {
        "address": address(study, name),
        "name": name,
        "title": job.title,
        "caption": job.caption,
        "csv": file,
    }
    if isinstance(job.spec, Pivot) and job.spec.published:
        cells = _numbers(named["address"], read(compared), job.spec, numbers, labels)
        return content.Table(
            **named | {"csv": f"{study}/tables/{name}.comparison.csv"}, numbers=cells
        )
    plain = read(folder / file)
    rows = [[cell(value) for value in row] for row in plain.itertuples(index=False)]
    return content.Table(**named, columns=[str(column) for column in plain], rows=rows)


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
            content.Number(
                address=name,
                keys={key: cell(place[key]) for key in keys},
                row=", ".join(printed_key(key, place[key], labels) for key in keys),
                column=_heading(row["metric"], row["statistic"], spec, labels),
                metric=row["metric"],
                statistic=row["statistic"],
                unit=row["unit"],
                published=_number(row, "value_published"),
                n_published=_number(row, "n_published"),
                ours=_number(row, "value_ours"),
                scaled=_number(row, "value_ours_scaled"),
                n=_number(row, "n_ours"),
                interval=_interval(row, "low95_ours", "high95_ours"),
                predicted=_interval(row, "low95_predicted", "high95_predicted"),
                verdict=_text(row, "verdict"),
                why=_text(row, "why"),
                primary=_flag(row, "primary"),
                counted=_flag(row, "counted"),
                share_feasible=_number(row, "share_feasible"),
                bound=_number(row, "bound"),
                gap=_number(row, "gap"),
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
            content.Claim(
                address=address(study, identity),
                id=identity,
                place=_text(row, "place"),
                statement=_text(row, "statement"),
                finding=_flag(row, "finding"),
                own_criterion=_flag(row, "own_criterion"),
                verdict=_text(row, "verdict"),
                holds=_text(row, "holds"),
                where=_text(row, "where_it_holds"),
                published=_text(row, "published"),
                reason=_text(row, "reason"),
                replication=_number(row, "replication_probability"),
                size=_text(row, "size"),
                shown_in=[
                    address(study, name)
                    for name in _text(row, "artefact").replace(",", " ").split()
                    if name in there
                ],
                comparisons=[_comparison(each, labels, written) for _, each in compared.iterrows()],
                decisive=decisive,
                why=_why(compared.iloc[decisive], written, labels, row)
                if decisive is not None
                else "",
                variant=_labelled(variant, labels),
                interpretations=[
                    _interpretation(each, labels)
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
    words = [
        _labelled(_text(row, "comparison"), labels),
        _labelled(_text(row, "condition"), labels),
    ]
    return content.Comparison(
        check=(number := int(row["check"])),
        reference=why.reference(checks[number - 1]) if number <= len(checks) else 0.0,
        deciding=_flag(row, "primary"),
        test=_text(row, "test"),
        metric=_text(row, "metric"),
        statistic=_text(row, "statistic"),
        unit=_text(row, "unit"),
        name=", ".join(filter(None, words)),
        mark=_text(row, "mark_family") or _text(row, "mark"),
        effect=_number(row, "effect"),
        interval=_interval(row, "low95", "high95"),
        margin=_number(row, "margin"),
        effect_published=_number(row, "effect_published"),
        p=_number(row, "p"),
        n=_number(row, "n"),
        counted=_text(row, "counted"),
        reason=_text(row, "reason"),
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


def _interpretation(row: pd.Series, labels: dict[str, str]) -> content.Interpretation:
    return content.Interpretation(
        variant=_labelled(_text(row, "variant"), labels),
        verdict=_text(row, "verdict"),
        holds=_text(row, "holds"),
    )


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
    return content.Assumption(
        address=address(study, job.id),
        id=job.id,
        detail=job.detail,
        default=", ".join(f"{name}: {value}" for name, value in default.items())
        if isinstance(default, dict)
        else str(default),
        alternatives=[str(value) for value in job.alternatives],
        reason=job.reason,
        source=job.source,
        setting=job.setting or "",
        claims=job.claims,
        choices=[choice for choice in choices if choice.assumption == job.id],
    )


def _audited(row: pd.Series) -> content.Audited:
    checked = cell(row["consistent"])
    return content.Audited(
        item=_text(row, "item"),
        place=_text(row, "place"),
        rule=_text(row, "rule"),
        printed=cell(row["printed"]),
        limit=cell(row["limit"]),
        consistent=None if checked is None else str(checked) == "True",
        arithmetic=_text(row, "arithmetic"),
    )
