"""Tables of keys in config/README.md, generated from the models, and of columns in
results/README.md, from their declarations. `python docs/tables_of_keys.py` updates them, and a test
ensures that they are up to date.
"""

import re

from pydantic.fields import FieldInfo

from bezierplan.analysis import columns as result_columns
from bezierplan.analysis import table_kinds
from bezierplan.analysis.claims import kinds
from bezierplan.analysis.claims.claim import Claim
from bezierplan.figures import figure, layout, panels
from bezierplan.places import TREE
from bezierplan.running import columns
from bezierplan.schema.model import Model, list_keys
from bezierplan.study import artefacts, claims, experiments
from bezierplan.workspaces import kinds as workspace_kinds
from bezierplan.workspaces.kinds import changing_cells

README = TREE / "config" / "README.md"
RESULTS_README = TREE / "results" / "README.md"

GROUPS: dict[str, list[tuple[str, type[Model] | dict[str, type[Model]]]]] = {
    "experiments": [
        ("The file", experiments.ExperimentsFile),
        ("A method or baseline", experiments.Method),
        ("A policy, for experiments in dynamic environments", experiments.Policy),
        ("A workspace has `kind`, and by kind", workspace_kinds.kinds()),
        ("A change of `changing_cells`", changing_cells.Change),
        ("A problem", experiments.ProblemEntry),
        ("An experiment", experiments.Experiment),
        ("`baseline_comparison`", experiments.BaselineEntry),
    ],
    "artefacts": [
        ("The file", artefacts.ArtefactsFile),
        ("A **table** has `kind`, and by kind", table_kinds.TABLES),
        ("An entry of a table's `values`", table_kinds.TableValue),
        ("An entry of a table's `monotone`", table_kinds.Monotone),
        ("A **figure**", figure.Figure),
        ("A panel has `kind`, and by kind", panels.list_kinds()),
    ],
    "layout": [
        ("The file", artefacts.LayoutFile),
        ("A table or figure", layout.Layout),
    ],
    "claims": [
        ("A claim", Claim),
        ("A **check** has `test`, its kind, and by kind", kinds.list_kinds()),
    ],
    "assumptions": [
        ("The file", claims.AssumptionsFile),
        ("An assumption", claims.AssumptionEntry),
        ("A joint reading", claims.ReadingEntry),
    ],
}
"""File -> its tables: what stands above, and the model of a mapping or those of its kinds."""

# Keys named above a table of kinds.
_ABOVE = ("kind", "test")


def describe_keys(name: str) -> str:
    """Return the tables of a file's keys, as Markdown."""
    return "\n\n".join(
        f"{above}:\n\n{_format_by_kind(of) if isinstance(of, dict) else _format_table(of)}"
        for above, of in GROUPS[name]
    )


def _format_table(model: type[Model]) -> str:
    """Return a table with a row for each key of a model."""
    rows = [
        f"| {_format_name(name, field)} | {field.description} |"
        for name, field in list_keys(model).items()
    ]
    return "\n".join(["| key | means |", "| --- | --- |", *rows])


def _format_by_kind(models: dict[str, type[Model]]) -> str:
    """Return a table with a row for each key and meaning, and the kinds that share it.

    Keys of more than half of the kinds come first.
    """
    rows: dict[tuple[str, str | None], list[str]] = {}
    for kind, model in models.items():
        for name, field in list_keys(model).items():
            if name not in _ABOVE:
                rows.setdefault((_format_name(name, field), field.description), []).append(
                    f"`{kind}`"
                )
    shared = sorted(
        rows.items(), key=lambda row: -len(row[1]) if len(row[1]) > len(models) / 2 else 0
    )
    return "\n".join(
        [
            "| kind | key | means |",
            "| --- | --- | --- |",
            *(
                f"| {', '.join(kinds) if len(kinds) < len(models) else 'all'} | {name} | {text} |"
                for (name, text), kinds in shared
            ),
        ]
    )


def _format_name(name: str, field: FieldInfo) -> str:
    """Return the name of a key, bold if it is required."""
    return f"**`{name}`**" if field.is_required() else f"`{name}`"


# How the type of a column's values is printed: a name is a word.
_PRINTED = {kind: word for word, kind in columns.VALUES.items()} | {columns.RunName: "word"}


def describe_columns(table: columns.Table) -> str:
    """Return the table of columns of a kind of file, as Markdown."""
    return _format_columns(
        [
            (name, kind, about.unit, _join_meaning(about))
            for name, (kind, about) in columns.read_columns(*table.every).items()
        ]
    )


def describe_columns_of_drives(table: columns.Table) -> str:
    """Return columns that mean something else for drives, and those that only drives have."""
    every, own = columns.read_columns(*table.every), columns.read_columns(table.drives)
    other = [(name, kind, "", about.drive) for name, (kind, about) in every.items() if about.drive]
    return _format_columns(
        [
            *other,
            *(
                (name, kind, about.unit, _join_meaning(about))
                for name, (kind, about) in own.items()
            ),
        ]
    )


def _join_meaning(about: columns.Column) -> str:
    """Return the meaning of a column with its detail."""
    return "; ".join(filter(None, [about.meaning, about.detail]))


def describe_columns_of_results(parts: tuple[type, ...]) -> str:
    """Return the table of columns of a table of results, as Markdown."""
    lines = [
        f"| `{name}` | {_PRINTED[kind]} | {about.meaning} |"
        for name, (kind, about) in columns.read_columns(*parts).items()
    ]
    return "\n".join(["| column | values | meaning |", "| --- | --- | --- |", *lines])


def _format_columns(rows: list[tuple[str, type, str, str]]) -> str:
    """Return a table with name, type, unit and meaning of each column."""
    lines = [
        f"| `{name}` | {_PRINTED[kind]} | {unit} | {meaning} |"
        for name, kind, unit, meaning in rows
    ]
    return "\n".join(["| column | values | unit | meaning |", "| --- | --- | --- | --- |", *lines])


def update_keys(text: str) -> str:
    """Return the text of config/README.md with tables that match the current models."""
    return _update_tables(text, {f"{name}.yaml": describe_keys(name) for name in GROUPS}, "keys")


def update_columns(text: str) -> str:
    """Return the text of results/README.md with tables that match the current declarations."""
    every = {name: describe_columns(table) for name, table in columns.TABLES.items()}
    drives = {
        f"{name} of drives": describe_columns_of_drives(table)
        for name, table in columns.TABLES.items()
    }
    of_results = {
        name: describe_columns_of_results(parts) for name, parts in result_columns.TABLES.items()
    }
    return _update_tables(text, every | drives | of_results, "columns")


def _update_tables(text: str, tables: dict[str, str], what: str) -> str:
    """Replace the tables between marks, such as `<!-- keys of claims.yaml -->` and `<!-- /keys
    -->`.
    """
    for name, table in tables.items():
        marked = re.compile(
            rf"(<!-- {what} of {re.escape(name)} -->\n).*?(<!-- /{what} -->)", re.DOTALL
        )
        text = marked.sub(lambda marks, table=table: f"{marks[1]}\n{table}\n\n{marks[2]}", text)
    return text


if __name__ == "__main__":
    for file, change in ((README, update_keys), (RESULTS_README, update_columns)):
        file.write_text(change(file.read_text(encoding="utf-8")), encoding="utf-8")
