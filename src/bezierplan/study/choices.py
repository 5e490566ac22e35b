"""The grid of interpretations of a paper: every choice that it leaves open and that governs its
published numbers.
"""

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from bezierplan.analysis.metrics import METRICS
from bezierplan.analysis.search_job import Choice, Part, Search, Stage, TableRuns
from bezierplan.analysis.statistics import LEAST_RUNS
from bezierplan.analysis.table_kinds import Pivot
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.digest import content_digest
from bezierplan.schema.model import one_or_list
from bezierplan.study import alternatives, jobs
from bezierplan.study.definition import Study, relative
from bezierplan.study.experiments import SCALES
from bezierplan.workspaces.kinds import file_keys

STAGES = ("screened", "judged", "finalists", "fresh")
"""What an interpretation is judged by: a share of the runs in the search, all of them if it may be
the best, `MANY` others if it is a finalist, and once more so many others if it is chosen.
"""

SCREENED = 4
"""The search judges interpretations by one of so many of the runs by which those are judged that
may be the best.
"""

MANY = 1000
"""Runs of each method on each problem, or on all fields drawn together, that choose among the
finalists; so many others judge the chosen one anew.
"""


def printed_tables(study: Study) -> dict[str, Pivot]:
    """The tables of runs that have published numbers, except those of nothing but seconds, which no
    interpretation explains, or of nothing that the paper defines.
    """
    printed = {
        name: table
        for name, table in study.compared().items()
        if table.published and any(entry.defined for entry in table.values)
    }
    return {
        name: table
        for name, table in printed.items()
        if {row["unit"] for row in _published(study, name)} != {"s"}
    }


def _published(study: Study, table: str) -> list[dict[str, str]]:
    """A table's published numbers, as text by column: pandas would slow every start."""
    with Path(study.published_file(table)).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def choices(study: Study) -> list[Choice]:
    """All choices: settings that assumptions govern, and worlds that the tables leave open."""
    tables = printed_tables(study)
    printed = {method for name, table in tables.items() for method in _methods(study, name, table)}
    compared = {
        table.reads.get(row["metric"], row["metric"])
        for name, table in tables.items()
        for row in _published(study, name)
    }
    compared -= {
        entry.metric for table in tables.values() for entry in table.values if not entry.defined
    }
    known: list[Choice] = []
    for assumption in study.assumptions:
        governs: dict[str, Any] = {}
        if (
            isinstance(assumption.default, str)
            and assumption.default in compared
            and METRICS.keys() >= set(assumption.alternatives)
        ):
            governs["metric"] = assumption.default
        methods = (
            [method for method in alternatives.concerned(study, assumption) if method in printed]
            if assumption.setting
            else []
        )
        if methods:
            along = {
                method: assumption.along[method] for method in methods if method in assumption.along
            }
            governs |= {"setting": assumption.setting, "methods": methods, "along": along}
            governs |= {"problems": assumption.problems} if assumption.problems else {}
        if assumption.workspace:
            governs["workspace"] = assumption.workspace
        if assumption.table:
            governs["table"] = assumption.table
        values = [
            value for value in assumption.alternatives if value not in assumption.not_searched
        ]
        if governs and values:
            governs["printed"] = assumption.source == "published"
            known.append(Choice(assumption.id, assumption.detail, [None, *values], **governs))
    worlds: dict[str, list] = {}
    for table in tables.values():
        for column, value in table.primary.items():
            values = worlds.setdefault(column, [value])
            values += [
                other for other in one_or_list(table.where.get(column, [])) if other not in values
            ]
    governed = (
        {"workspace"} if any(assumption.workspace for assumption in study.assumptions) else set()
    )
    # Workspaces of which a key is varied already are not exchanged as well.
    open_worlds = {
        column: values
        for column, values in worlds.items()
        if column not in governed and len(values) > 1
    }
    return known + [_world(study, column, values, known) for column, values in open_worlds.items()]


def _world(study: Study, column: str, values: list, settings: list[Choice]) -> Choice:
    """The choice between worlds, the default first. settings: the choices of settings."""
    made = {
        str(value): study.presets.get(column, {}).get(str(value).lower(), {})
        for value in values[1:]
    }
    overrules = {
        value: [choice.id for choice in settings if choice.setting in own]
        for value, own in made.items()
    }
    return Choice(
        column,
        f"Which {column} the tables show",
        [None, *values[1:]],
        column=column,
        overrules=overrules,
    )


def _methods(study: Study, name: str, table: Pivot) -> list[str]:
    """Methods of a table that are the paper's own: no baselines, no variants, none without a
    printed number unless all are compared.
    """
    methods = one_or_list(table.where.get("method", study.experiments[table.experiment].methods))
    candidates = [
        method
        for method in methods
        if method not in study.baselines and not study.methods[method].variant_of
    ]
    rows = _published(study, name)
    return (
        [method for method in candidates if method in {row["method"] for row in rows}]
        if _apart(table, rows)
        else candidates
    )


def _apart(table: Pivot, rows: list[dict[str, str]]) -> bool:
    """Whether each published number is one method's alone, whatever the others do."""
    compared = any(
        METRICS[table.reads.get(row["metric"], row["metric"])].among_rows for row in rows
    )
    return "method" in rows[0] and not compared


def search_job(study: Study) -> Search:
    """What the search for an interpretation depends on."""
    tables = printed_tables(study)
    along = {name: table.monotone[0].along for name, table in tables.items() if table.monotone}
    return Search(
        study.key,
        most=study.interpretations_tried,
        most_finalists=study.interpretations_finalists,
        parts=_parts(study),
        along=along,
        stages={stage: interpretations_job(study, stage) for stage in STAGES},
    )


def interpretations_job(study: Study, stage: str = "judged") -> Stage:
    """What interpretations are judged by in a stage.

    Those screened have a share of the runs of those judged, though at least as many as are judged
    at all. Where there is one run in each layout, it is a share of the layouts, of which twice
    those of scale full judge an interpretation. Repeats of the later stages, and layouts where
    there is one run in each, come after all those of the stages before.
    """
    tables, worlds = {}, {}
    for name, table in printed_tables(study).items():
        content = study.experiments[table.experiment]
        drawn = next(
            (
                study.problems[each].layouts
                for each in content.problems
                if study.problems[each].layouts
            ),
            None,
        )
        by_layout = drawn is not None and content.interpretations is None
        repeats = content.interpretations or content.repeats["full"]
        layouts = _layouts(drawn, stage) if by_layout else None
        placed = _with_layouts(study, table.experiment, layouts.stop) if by_layout else study
        methods = _methods(study, name, table)
        world = _on_layouts(jobs.problems_job(placed, table.experiment, "full"), layouts)
        share = 1 if by_layout else SCREENED
        many = -(-MANY // _in_one_world(table, world)) if drawn else MANY
        stages = {
            "screened": [0, _share(repeats, share, 1 if drawn else LEAST_RUNS)],
            "judged": [0, repeats],
            "finalists": [repeats, repeats + many],
            "fresh": [repeats + many, repeats + 2 * many],
        }
        chunks = {
            method: _on_layouts(
                jobs.job(placed, table.experiment, method, "full", 0), layouts
            )._replace(repeats=stages[stage])
            for method in methods
        }
        # What the paper does not define has no vote.
        voting = [entry for entry in table.values if entry.defined]
        spec = table.but(where=table.where | {"method": methods}, values=voting)
        tables[name] = TableRuns(table.experiment, spec, chunks)
        worlds[table.experiment] = world
    return Stage(study.key, tables, choices(study), worlds, content_digest(*maps(study)))


D = TypeVar("D", Chunk, Descriptions)


def _on_layouts(described: D, layouts: range | None) -> D:
    """A description with those of its problems alone that have one of these layouts; None for
    all.
    """
    problems = {
        name: place
        for name, place in described.problems.items()
        if layouts is None or place.get("layout") in layouts
    }
    return described._replace(problems=problems)


def _layouts(drawn: dict[str, int], stage: str) -> range:
    """Numbers of the fields on which interpretations are judged in a stage: the finalists, and then
    the chosen one, on fields that no interpretation met before.
    """
    judged, most = min(2 * drawn["full"], drawn["extended"]), drawn["extended"]
    many = max(judged, most - judged)
    return {
        "screened": range(_share(judged, SCREENED, LEAST_RUNS)),
        "judged": range(judged),
        "finalists": range(judged, judged + many),
        "fresh": range(judged + many, judged + 2 * many),
    }[stage]


def _with_layouts(study: Study, experiment: str, layouts: int) -> Study:
    """A study whose problems of an experiment have so many layouts at every scale."""
    drawn = {
        name: study.problems[name].but(layouts=dict.fromkeys(SCALES, layouts))
        for name in study.experiments[experiment].problems
        if study.problems[name].layouts
    }
    return replace(study, problems=study.problems | drawn)


def _in_one_world(table: Pivot, world: Descriptions) -> int:
    """How many problems belong to the paper's own interpretation of the world."""
    return sum(
        all(problem.get(column, value) == value for column, value in table.primary.items())
        for problem in world.problems.values()
    )


def _share(whole: int, share: int, least: int) -> int:
    return min(whole, max(least, -(-whole // share)))


def maps(study: Study) -> list[str]:
    """Map files of the problems on which interpretations are judged, under any of them."""
    experiments = {table.experiment for table in printed_tables(study).values()}
    names = {
        problem["workspace"]
        for name in sorted(experiments)
        for problem in study.problems_of(name, "full").values()
    }
    workspaces = [
        relative(study.folder / value)
        for assumption in study.assumptions
        for workspace, key in assumption.workspace.items()
        for value in assumption.alternatives
        if key in file_keys(type(study.workspaces[workspace]))
    ]
    return sorted({*study.maps(names), *workspaces})


def _parts(study: Study) -> list[Part]:
    """Methods that no metric of a table compares with each other, and for each such part the
    choices that it depends on.
    """
    groups: list[set[str]] = []
    for name, table in printed_tables(study).items():
        methods = _methods(study, name, table)
        for group in (
            [{method} for method in methods]
            if _apart(table, _published(study, name))
            else [set(methods)]
        ):
            joined = [other for other in groups if other & group]
            groups = [other for other in groups if not other & group] + [group.union(*joined)]
    known = choices(study)
    order = list(study.methods)
    return [
        Part(
            sorted(group, key=order.index),
            [choice.id for choice in known if group & set(choice.methods or group)],
        )
        for group in sorted(groups, key=lambda group: min(map(order.index, group)))
    ]
