"""Tables of keys in config/README.md, generated from the models, and of columns in
results/README.md, from their declarations. Each stands between marks that say what it is of, such
as `<!-- keys of figures.figure.Figure -->`, `<!-- columns of runs -->` and `<!-- columns of runs of
drives -->`. `python docs/tables_of_keys.py` renews them, and a test ensures that they are up to
date.
"""

import re
from importlib import import_module

from pydantic.fields import FieldInfo

from bezierplan.analysis import columns as result_columns
from bezierplan.places import TREE
from bezierplan.running import columns
from bezierplan.schema.model import Model, list_keys

README = TREE / "config" / "README.md"
RESULTS_README = TREE / "results" / "README.md"

# Keys named above a table of kinds.
_ABOVE = ("kind", "test")

# How the type of a column's values is printed: a name is a word.
_PRINTED = {kind: word for word, kind in columns.VALUES.items()} | {columns.RunName: "word"}


def update(text: str) -> str:
    """Return the text of a README with tables that match the current models and declarations."""

    def renew(marks: re.Match) -> str:
        table = (describe_keys if marks[2] == "keys" else describe_columns)(marks[3])
        return f"{marks[1]}\n{table}\n\n{marks[4]}"

    marked = r"(<!-- (keys|columns) of (.*?) -->\n).*?(<!-- /\2 -->)"
    return re.sub(marked, renew, text, flags=re.DOTALL)


def describe_keys(place: str) -> str:
    """Return the table of the keys of a model, or of a mapping of models by kind, as Markdown.

    place: module and name, or the name of a function that returns the mapping.
    """
    module, _, name = place.rpartition(".")
    of = getattr(import_module(f"bezierplan.{module}"), name)
    of = of if isinstance(of, type | dict) else of()
    return _format_by_kind(of) if isinstance(of, dict) else _format_table(of)


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
    rows: dict[str, list[str]] = {}
    for kind, model in models.items():
        for name, field in list_keys(model).items():
            if name not in _ABOVE:
                row = f"{_format_name(name, field)} | {field.description}"
                rows.setdefault(row, []).append(f"`{kind}`")
    most = len(models)
    shared = sorted(rows.items(), key=lambda row: -len(row[1]) if len(row[1]) > most / 2 else 0)
    lines = [f"| {', '.join(own) if len(own) < most else 'all'} | {row} |" for row, own in shared]
    return "\n".join(["| kind | key | means |", "| --- | --- | --- |", *lines])


def _format_name(name: str, field: FieldInfo) -> str:
    """Return the name of a key, bold if it is required."""
    return f"**`{name}`**" if field.is_required() else f"`{name}`"


def describe_columns(name: str) -> str:
    """Return the table of columns of a table of results or of a kind of file, as Markdown.

    For `runs of drives` and the like: columns that mean something else for drives, and those that
    only drives have.
    """
    if name in result_columns.TABLES:
        lines = [
            f"| `{column}` | {_PRINTED[kind]} | {about.meaning} |"
            for column, (kind, about) in columns.read_columns(*result_columns.TABLES[name]).items()
        ]
        return "\n".join(["| column | values | meaning |", "| --- | --- | --- |", *lines])
    name, drives, _ = name.partition(" of drives")
    table = columns.TABLES[name]
    own, lines = columns.read_columns(*table.every), []
    if drives:
        lines = [
            f"| `{column}` | {_PRINTED[kind]} |  | {about.drive} |"
            for column, (kind, about) in own.items()
            if about.drive
        ]
        own = columns.read_columns(table.drives)
    for column, (kind, about) in own.items():
        meaning = "; ".join(filter(None, [about.meaning, about.detail]))
        lines.append(f"| `{column}` | {_PRINTED[kind]} | {about.unit} | {meaning} |")
    return "\n".join(["| column | values | unit | meaning |", "| --- | --- | --- | --- |", *lines])


if __name__ == "__main__":
    for file in (README, RESULTS_README):
        file.write_text(update(file.read_text(encoding="utf-8")), encoding="utf-8")
