"""Models of `artefacts.yaml`: tables and figures, and how names are printed."""

import re
from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, PlainValidator, TypeAdapter, ValidationError

from bezierplan.analysis.table_kinds import TABLES, Table
from bezierplan.figures import style
from bezierplan.figures.panels import EACH, MOST_PANELS, Panel, kinds
from bezierplan.schema.checked import closest
from bezierplan.schema.model import (
    Line,
    Model,
    Name,
    Setting,
    at_most,
    first_fault,
    listed,
    mapping_or,
    one_of,
    wrong,
)
from bezierplan.study.experiments import Settings


class Each(Model):
    """The part of a panel that makes it several."""

    each: list[dict[str, Any]] = Field(min_length=2, description=EACH)


_PANEL = TypeAdapter(Annotated[Panel, one_of("kind", kinds())])


def _expanded(entry: Any) -> dict[str, Panel]:
    """The panels that an entry in a list of panels stands for, by the keys that lead to them."""
    if not isinstance(entry, dict) or "each" not in entry:
        return {"": _PANEL.validate_python(entry)}
    panels = {}
    for number, part in enumerate(Each(each=entry["each"]).each):
        location = f"each: {number}"
        try:
            joined = _joined(part, entry, location)
            panels[location] = _PANEL.validate_python(
                {key: value for key, value in joined.items() if key != "each"}
            )
        except ValidationError as error:
            path = first_fault(error)
            key = path[0].split(":")[0]
            raise wrong(
                ": ".join(path if key in entry and key not in part else [location, *path])
            ) from None
    return panels


def _joined(part: dict[str, Any], shared: dict[str, Any], location: str) -> dict[str, Any]:
    """The keys of both; mappings that stand in both are joined likewise."""
    joined = part | shared
    for key in part.keys() & shared.keys():
        if not (isinstance(part[key], dict) and isinstance(shared[key], dict)):
            raise wrong(
                f"{location}: {key}: is given beside each as well; "
                "expected it in one of the two places"
            )
        joined[key] = _joined(part[key], shared[key], f"{location}: {key}")
    return joined


_ENTRIES = TypeAdapter(
    Annotated[list[Annotated[Any, PlainValidator(_expanded)]], Field(min_length=1)]
)
_LIST = TypeAdapter(Annotated[list[Any], at_most(MOST_PANELS)], config=ConfigDict(strict=True))


def _panels(given: Any) -> list[Panel]:
    """The panels of a figure, each with its place in the list that is given."""
    panels = []
    for number, entry in enumerate(_ENTRIES.validate_python(_LIST.validate_python(given))):
        for location, panel in entry.items():
            panel._place = f"{number}: {location}" if location else str(number)
            panels.append(panel)
    if len(panels) > MOST_PANELS:
        raise wrong(f"{len(panels)} panels; expected at most {MOST_PANELS}, one a letter")
    return panels


class Figure(Model):
    """Panels on one sheet."""

    title: Line = Field(description="one line")
    columns: Literal[1, 2, 3, 4, 5] = Field(description="panels side by side, 1 to 5")
    width: Literal["one", "two"] = Field(
        "two", description="of the sheet, in columns of a journal: one (8.5 cm) or two (17 cm)"
    )
    panels: Annotated[list[Panel], PlainValidator(_panels)] = Field(description="a list of panels")
    mirrors: Line = Field(
        None,
        description="for the caption: what the paper's figure shows, and whether this one does",
    )


def _look(given: Any) -> str:
    """The name of a look."""
    if not isinstance(given, str) or given not in style.LOOKS:
        raise wrong(f"{given}: unknown{closest(str(given), style.LOOKS)}")
    return given


class ArtefactsFile(Model):
    """The file."""

    labels: dict[Line, Line] = Field({}, description="name → how it is printed")
    looks: dict[Name, Annotated[str, PlainValidator(_look)]] = Field(
        {},
        description="name of a method → how it looks in every figure: "
        + ", ".join(style.LOOKS)
        + "; left out: as its planner does in all "
        "studies, or unlike most other methods",
    )
    tables: dict[Name, Annotated[Table, one_of("kind", TABLES)]] = Field(
        {}, description="name → a table"
    )
    figures: dict[Name, Figure] = Field({}, description="name → title, columns and panels")


class ConfigFile(Model):
    """The file `config/config.yaml`, or what `--config` gives."""

    studies: listed(Line) = Field(
        description="a list of studies, each the name of a folder in `config/studies` or a path"
    )
    settings: dict[Name, dict[Name, Annotated[Any, mapping_or(Settings, Setting)]]] = Field(
        {},
        description="study → settings that override those of the same name in its "
        "`experiments.yaml`",
    )


def in_printed_order(names: Iterable[str]) -> list[str]:
    """Names of tables and figures with the numbered ones first, tables before figures, each by its
    number; the others as they were.

    >>> in_printed_order(["work", "figure11", "figure2", "table6", "table4"])
    ['table4', 'table6', 'figure2', 'figure11', 'work']
    """
    numbered = {
        name: found for name in names if (found := re.fullmatch(r"(table|figure)(\d+)", name))
    }
    first = sorted(
        numbered, key=lambda name: (numbered[name][1] != "table", int(numbered[name][2]))
    )
    return [*first, *(name for name in names if name not in numbered)]
