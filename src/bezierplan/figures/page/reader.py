"""The content of the page for each study: rows of a scale's csv files, as mappings whose empty
cells are None. Columns keep their names, and functions say which keys they add to a row.
"""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis import naming
from bezierplan.analysis.claims import sentences
from bezierplan.analysis.naming import Labels
from bezierplan.analysis.numbers import methods
from bezierplan.analysis.results import list_key_columns
from bezierplan.analysis.table_kinds import Pivot, TableEntry
from bezierplan.figures.caption import Caption
from bezierplan.figures.page import charts
from bezierplan.figures.page.addresses import build_address
from bezierplan.figures.page.page_job import PageJob, StudyView
from bezierplan.running.columns import Row
from bezierplan.running.inputs import choose_tree


def read(file: str | Path) -> pd.DataFrame:
    """Read a csv file, in which only an empty cell is a missing value."""
    # Digits are a part of a printed number, such as the last zero of 1.50.
    texts = {"as_printed": str}
    # Each column is read whole: in blocks, pandas may find two types in one.
    return pd.read_csv(file, dtype=texts, keep_default_na=False, na_values=[""], low_memory=False)


def list_rows(table: pd.DataFrame) -> list[Row]:
    """Return the rows of a table, with None for a missing or infinite value."""
    # Only columns of objects can hold None.
    table = table.replace([np.inf, -np.inf], np.nan).astype(object)
    return table.where(table.notna(), None).to_dict("records")


class Evidence(NamedTuple):
    """The results of many runs of all studies: numbers, claims, methods by problem, and comparisons
    of claims.
    """

    numbers: pd.DataFrame
    claims: pd.DataFrame
    methods: pd.DataFrame
    checks: pd.DataFrame

    def select(self, study: str) -> "Evidence":
        """Return the evidence about a study."""
        return Evidence(*(table[table["study"] == study] for table in self))


def read_study_results(
    job: PageJob,
    folder: Path,
    summary: list[pd.DataFrame],
    evidence: Evidence | None = None,
) -> dict[str, SimpleNamespace]:
    """Read the results of all studies from the folder of a scale.

    summary: numbers, claims and methods by problem of all studies, if the scale has them. evidence:
    stands in place of the scale's own positions and verdicts.
    """
    nothing = pd.DataFrame(columns=["study", "table"])
    numbers, _, measured = summary or [nothing] * 3
    pages = {}
    for key, view in job.studies.items():
        files = dict.fromkeys(("claims", "claim_checks", "audit"), nothing)
        files |= {name: read(folder / key / f"{name}.csv") for name in view.files}
        counted, of_problems = (table[table["study"] == key] for table in (numbers, measured))
        many = Evidence(*[nothing] * 4)
        if evidence and key in job.outcome:
            many = evidence.select(key)
            files |= {"claims": many.claims, "claim_checks": many.checks}
            of_problems = many.methods
        pages[key] = SimpleNamespace(
            key=key,
            job=view,
            claims=_list_claims(key, view, files),
            tables=[
                _describe_table(
                    _describe_artefact(key, name, caption), spec, folder, view.labels, counted, many
                )
                for name, (caption, spec) in view.tables.items()
            ],
            figures=[
                _describe_figure(_describe_artefact(key, name, caption), folder)
                for name, caption in view.figures.items()
            ],
            methods=[_describe_method(key, name, each) for name, each in view.methods.items()],
            assumptions=[_describe_assumption(key, each, view.labels) for each in view.assumptions],
            audit=list_rows(files["audit"]),
            families=_describe_families(of_problems, view.labels),
        )
    return pages


def _describe_families(of_problems: pd.DataFrame, labels: Labels) -> pd.DataFrame | None:
    """Return the methods of a study on each family of its problems, as words; None if there are
    none.
    """
    if of_problems.empty:
        return None
    rows = methods.group_by_family(of_problems)
    return methods.format_table(rows, labels) if len(rows) else None


def _describe_method(study: str, name: str, method: Any) -> Row:
    """Return a method, with the paragraphs on its planner."""
    return method._asdict() | {
        "name": name,
        "address": build_address(study, "method", name),
        "about": [" ".join(each.replace("`", "").split()) for each in method.about.split("\n\n")],
    }


def _describe_artefact(study: str, name: str, caption: Caption) -> Row:
    """Return the caption's parts of a table or figure, its address, and the path of its files
    without endings.
    """
    return caption._asdict() | {
        "name": name,
        "address": build_address(study, name),
        "stem": f"{study}/{choose_tree(name)}/{name}",
        "of_paper": choose_tree(name) == "paper",
    }


def _describe_figure(row: Row, folder: Path) -> Row:
    """Return a figure with its notes: the runs that it shows, and what can be counted in it."""
    text = (folder / f"{row['stem']}.txt").read_text(encoding="utf-8")
    # The first line is the caption, which the page has from its job.
    _, runs, *counts = text.split("\n", 2)
    return row | {"runs": runs, "counts": "".join(counts).strip()}


def _describe_table(
    row: Row,
    spec: TableEntry,
    folder: Path,
    labels: Labels,
    counted: pd.DataFrame,
    evidence: Evidence,
) -> Row:
    """Return a table: its numbers next to published ones if a paper prints it, or its columns and
    rows.
    """
    printed = isinstance(spec, Pivot) and bool(spec.published)
    row["csv"] = f"{row['stem']}{'.comparison' * printed}.csv"
    table = read(folder / row["csv"])
    if not printed:
        return row | {"numbers": [], "laid": None, "columns": list(table), "rows": list_rows(table)}
    counted, many = (rows[rows["table"] == row["name"]] for rows in (counted, evidence.numbers))
    cells = _list_numbers(row["address"], table, spec, counted, many, labels)
    return row | {
        "numbers": cells,
        "laid": _lay_out_table(folder / f"{row['stem']}.csv", spec, cells),
    }


def _lay_out_table(file: Path, spec: Pivot, numbers: list[Row]) -> Row:
    """Read a table in the paper's layout from its csv file, with the printed number beside ours in
    each cell.

    head: names of its columns. rows: names of each, and its cells as (ours, number), where the
    number is None if nothing is published.
    """
    ours = pd.read_csv(file, dtype=str, keep_default_na=False)
    heads = len(spec.index)
    placed = {(cell["table_row"], cell["table_column"]): cell for cell in numbers}
    rows = []
    for row, texts in enumerate(ours.to_numpy().tolist()):
        cells = [(text, placed.get((row, n))) for n, text in enumerate(texts[heads:])]
        rows.append((texts[:heads], cells))
    return {"head": list(ours), "rows": rows, "note": spec.note}


def _list_numbers(
    table: str,
    comparison: pd.DataFrame,
    spec: Pivot,
    counted: pd.DataFrame,
    many: pd.DataFrame,
    labels: Labels,
) -> list[Row]:
    """Return the cells of a table, each with a published number.

    many: rows of the evidence, which replace the table's own values. Added keys: row, column
    (printed names), address, beside (ours for the paper's number of runs), bar (`charts.add_bars`).
    """
    keys = list_key_columns(comparison)
    names = [*keys, "metric", "statistic"]
    # `summary.list_numbers` keeps the order of a table's rows.
    comparison["counted"] = counted["counted"].to_numpy() if len(counted) else False
    cells = list_rows(comparison)
    by_place = {build_address(*(row[name] for name in names)): row for row in list_rows(many)}
    for cell in cells:
        place = build_address(*(cell[name] for name in names))
        # The evidence has the same columns, of many runs.
        row = by_place.get(place, {})
        cell |= {name: value for name, value in row.items() if name in cell}
        scaled = cell["value_ours_scaled"]
        cell |= {
            "row": ", ".join(format_key(key, cell[key], labels) for key in keys),
            "column": _format_heading(cell["metric"], cell["statistic"], spec, labels),
            "address": f"{table}/{place}",
            "beside": cell["value_ours"] if scaled is None else scaled,
        }
    charts.add_bars(cells)
    return cells


def format_key(column: str, value: Any, labels: Labels) -> str:
    """Return the value of a key column as printed; a number stands with its name."""
    if value is None or isinstance(value, bool):
        return "" if value is None else str(value)
    return naming.format_value(value, column, labels)


def _format_heading(metric: str, statistic: str, spec: Pivot, labels: Labels) -> str:
    """Return metric and statistic as the table prints them.

    An unstated statistic stands beside our median.
    """
    beside = {statistic, "median"} if statistic == "unstated" else {statistic}
    for value in spec.values:
        if value.metric == metric and beside & set(value.statistics):
            return value.label + (f": {statistic}" if len(value.statistics) > 1 else "")
    return f"{naming.name_column(metric, labels)}: {statistic}"


def _list_claims(study: str, content: StudyView, files: dict[str, pd.DataFrame]) -> list[Row]:
    """Return claims in their primary variant, each with its other variants (`others`)."""
    names = sentences.name_variants([*content.claims.values()], content.labels)
    rows, checks = list_rows(files["claims"]), list_rows(files["claim_checks"])
    claims = []
    for row in rows:
        if row["primary"]:
            others = [
                each | {"variant": names.get(each["variant"], each["variant"])}
                for each in rows
                if each["id"] == row["id"] and not each["primary"]
            ]
            place = row["id"], row["variant"]
            own = [check for check in checks if (check["id"], check["variant"]) == place]
            named = {"variant": names.get(row["variant"] or "", ""), "others": others}
            claims.append(_describe_claim(study, row, own, content) | named)
    return claims


def _describe_claim(study: str, claim: Row, comparisons: list[Row], content: StudyView) -> Row:
    """Return a claim with its comparisons.

    Added keys: address, rule (the meaning of its count), comparisons, shown_in.
    """
    described = content.claims.get(claim["id"])
    # What docs/outcome keeps may be of a check that the study does not have any more.
    checks = dict(enumerate(described.checks if described else (), 1))
    for row in comparisons:
        check = checks.get(row["check"])
        row["reference"] = sentences.find_threshold(check) if check else 0.0
        row["name"] = sentences.name_comparison(row, check, content.labels)
    there = {*content.tables, *content.figures}
    return claim | {
        "address": build_address(study, claim["id"]),
        "rule": sentences.describe_count(described, claim["verdict"], claim["holds"]),
        "comparisons": comparisons,
        "shown_in": [name for name in (claim["artefact"] or "").split(", ") if name in there],
    }


def _describe_assumption(study: str, row: Row, labels: Labels) -> Row:
    """Return a detail that the paper leaves open.

    default: one for all, or each with the names that have it.
    """
    default = row["default"]
    if isinstance(default, dict):
        one, *others = {*map(str, default.values())}
        each = (f"{labels.get(name, name)}: {value}" for name, value in default.items())
        default = ", ".join(each) if others else one
    return row | {"address": build_address(study, row["id"]), "default": default}
