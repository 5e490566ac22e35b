"""The grid of readings of a paper: every choice that it leaves open and that governs its published numbers.

A choice is a mapping of plain values: id; detail; values, the one in force first (None, as methods may differ in it); and what it governs:

    setting, methods, along   a setting of some methods, and further settings that go with it, method -> settings
    column, overrules         the column of the tables whose value is the paper's world, and value -> ids of the choices of settings that it
                              makes itself
    metric                    the metric with which a printed word is compared
"""

import csv
from pathlib import Path
from typing import Any

from bezierplan.analysis.metrics import METRICS
from bezierplan.schema.model import one_or_list
from bezierplan.study import alternatives, jobs
from bezierplan.study.artefacts import Pivot
from bezierplan.study.definition import Study


def printed_tables(study: Study) -> dict[str, Pivot]:
    """The tables of runs that have published numbers, except those of nothing but seconds, which no reading explains, or of nothing that
    the paper defines."""
    printed = {name: table for name, table in study.compared().items() if table.published and any(entry.defined for entry in table.values)}
    return {name: table for name, table in printed.items() if {row["unit"] for row in _published(study, name)} != {"s"}}


def _published(study: Study, table: str) -> list[dict[str, str]]:
    """A table's published numbers, as text by column: pandas would slow every start."""
    with Path(study.published_file(table)).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def choices(study: Study) -> list[dict[str, Any]]:
    """All choices: settings that assumptions govern, and worlds between which the tables leave the choice."""
    tables = printed_tables(study)
    printed = {method for name, table in tables.items() for method in _methods(study, name, table)}
    compared = {table.reads.get(row["metric"], row["metric"]) for name, table in tables.items() for row in _published(study, name)}
    compared -= {entry.metric for table in tables.values() for entry in table.values if not entry.defined}
    found = []
    for assumption in study.assumptions:
        governs: dict[str, Any] = {}
        if isinstance(assumption.default, str) and assumption.default in compared and METRICS.keys() >= set(assumption.alternatives):
            governs["metric"] = assumption.default
        methods = [method for method in alternatives.concerned(study, assumption) if method in printed] if assumption.setting else []
        if methods:
            along = {method: assumption.along[method] for method in methods if method in assumption.along}
            governs |= {"setting": assumption.setting, "methods": methods, "along": along}
        values = [value for value in assumption.alternatives if value not in assumption.not_searched]
        if governs and values:
            found.append({"id": assumption.id, "detail": assumption.detail, "values": [None, *values]} | governs)
    worlds: dict[str, list] = {}
    for table in tables.values():
        for column, value in table.primary.items():
            values = worlds.setdefault(column, [value])
            values += [other for other in one_or_list(table.where.get(column, [])) if other not in values]
    return found + [_world(study, column, values, found) for column, values in worlds.items()]


def _world(study: Study, column: str, values: list, settings: list[dict[str, Any]]) -> dict[str, Any]:
    """The choice between worlds, the one in force first. settings: the choices of settings."""
    made = {str(value): study.presets.get(column, {}).get(str(value).lower(), {}) for value in values[1:]}
    overrules = {value: [choice["id"] for choice in settings if choice.get("setting") in own] for value, own in made.items()}
    detail = f"Which {column} the tables show"
    return {"id": column, "detail": detail, "values": [None, *values[1:]], "column": column, "overrules": overrules}


def _methods(study: Study, name: str, table: Pivot) -> list[str]:
    """Methods of a table that are the paper's own: no baselines and no variants."""
    methods = one_or_list(table.where.get("method", study.experiments[table.experiment].methods))
    return [method for method in methods if method not in study.baselines and not study.methods[method].variant_of]


def readings_job(study: Study, scale: str) -> dict[str, Any]:
    """What the search for a reading depends on, in addition to problems, bounds and the files of published numbers."""
    tables = {}
    for name, table in printed_tables(study).items():
        content = study.experiments[table.experiment]
        methods = _methods(study, name, table)
        chunk_jobs = {method: jobs.job(study, table.experiment, method, scale, 0) for method in methods}
        for job in chunk_jobs.values():
            job["repeats"] = [0, content.readings or content.repeats[scale]]
        # What the paper does not define has no vote.
        voting = [entry.plain() for entry in table.values if entry.defined]
        spec = table.plain() | {"where": table.where | {"method": methods}, "values": voting}
        tables[name] = {"experiment": table.experiment, "spec": spec, "jobs": chunk_jobs}
    experiments = list(dict.fromkeys(table["experiment"] for table in tables.values()))
    return {"study": study.key, "tables": tables, "choices": choices(study), "most": study.readings_tried, "experiments": experiments}
