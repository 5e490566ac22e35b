"""The tables of keys in config/README.md, generated from the models: `python -m bezierplan.study.keys` updates them, and a test ensures
that they are up to date.
"""

import re
from functools import partial

from pydantic.fields import FieldInfo

from bezierplan.analysis.claims import kinds
from bezierplan.figures import panels
from bezierplan.places import TREE
from bezierplan.schema.model import Model, keys
from bezierplan.study import artefacts, claims, experiments
from bezierplan.workspaces import kinds as workspace_kinds
from bezierplan.workspaces.kinds import changing_cells

README = TREE / "config" / "README.md"

GROUPS: dict[str, list[tuple[str, type[Model] | dict[str, type[Model]]]]] = {
    "experiments": [
        ("The file", experiments.ExperimentsFile),
        ("A method or baseline", experiments.Method),
        ("A policy, for experiments in worlds that move", experiments.Policy),
        ("A workspace has `kind`, and by kind", workspace_kinds.kinds()),
        ("A change of `changing_cells`", changing_cells.Change),
        ("A problem", experiments.Problem),
        ("An experiment", experiments.Experiment),
        ("`worth`", experiments.Worth),
    ],
    "artefacts": [
        ("The file", artefacts.ArtefactsFile),
        ("A **table** has `kind`, and by kind", artefacts.TABLES),
        ("An entry of a table's `values`", artefacts.TableValue),
        ("An entry of a table's `monotone`", artefacts.Monotone),
        ("A **figure**", artefacts.Figure),
        ("A panel has `kind`, and by kind", panels.kinds()),
    ],
    "claims": [
        ("A claim", claims.Claim),
        ("A **check** has `test`, its kind, and by kind", kinds.kinds()),
    ],
    "assumptions": [("An assumption", claims.Assumption)],
}
"""File -> its tables: what stands above, and the model of a mapping or those of its kinds."""

# Keys named above a table of kinds.
_ABOVE = ("kind", "test")


def described(name: str) -> str:
    """The tables of a file's keys, as Markdown."""
    return "\n\n".join(f"{above}:\n\n{_by_kind(of) if isinstance(of, dict) else _table(of)}" for above, of in GROUPS[name])


def _table(model: type[Model]) -> str:
    """A row for each key."""
    rows = [f"| {_name(name, field)} | {field.description} |" for name, field in keys(model).items()]
    return "\n".join(["| key | means |", "| --- | --- |", *rows])


def _by_kind(models: dict[str, type[Model]]) -> str:
    """A row for each key, with the kinds in which it has this meaning; first those of all kinds."""
    rows: dict[tuple[str, str | None], list[str]] = {}
    for kind, model in models.items():
        for name, field in keys(model).items():
            if name not in _ABOVE:
                rows.setdefault((_name(name, field), field.description), []).append(f"`{kind}`")
    shared = sorted(rows.items(), key=lambda row: -len(row[1]) if len(row[1]) > len(models) / 2 else 0)
    return "\n".join(
        [
            "| kind | key | means |",
            "| --- | --- | --- |",
            *(f"| {', '.join(kinds) if len(kinds) < len(models) else 'all'} | {name} | {text} |" for (name, text), kinds in shared),
        ]
    )


def _name(name: str, field: FieldInfo) -> str:
    """A required key is bold."""
    return f"**`{name}`**" if field.is_required() else f"`{name}`"


def _between(content: str, marks: re.Match) -> str:
    return f"{marks[1]}\n{content}\n\n{marks[2]}"


def renewed(text: str) -> str:
    """The text of config/README.md with tables that match the current models."""
    for name in GROUPS:
        marked = re.compile(rf"(<!-- keys of {name}\.yaml -->\n).*?(<!-- /keys -->)", re.DOTALL)
        text = marked.sub(partial(_between, described(name)), text)
    return text


if __name__ == "__main__":
    README.write_text(renewed(README.read_text(encoding="utf-8")), encoding="utf-8")
