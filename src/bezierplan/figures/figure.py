"""The model of a figure: its panels on one sheet."""

from typing import Annotated, Any, Literal

from pydantic import Field, PlainValidator, TypeAdapter

from bezierplan.figures.panels import EACH, MOST_PANELS, Panel, list_kinds
from bezierplan.schema.model import (
    Line,
    Model,
    build_choice_type,
    build_error,
    build_expectation,
    convert_to_list,
    show_value,
)

_PANELS = TypeAdapter(dict[str, Annotated[Panel, build_choice_type("kind", list_kinds())]])


def _merge_keys(part: dict[str, Any], common: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a part and of all parts; a part's value wins, and mappings are merged."""
    # Mappings such as `where` may be given for a part and for all.
    both = {
        key: _merge_keys(part[key], common[key])
        for key in part.keys() & common
        if isinstance(part[key], dict) and isinstance(common[key], dict)
    }
    return common | part | both


def _expand_entry(place: int, entry: Any) -> dict[str, Any]:
    """Return the panels of an entry in a list, each by the keys that lead to it.

    An entry with `each` gives several panels. Raises an error of the file if `each` is no list of
    at least two mappings.
    """
    if not isinstance(entry, dict) or "each" not in entry:
        return {f"{place}": entry}
    shared = {key: value for key, value in entry.items() if key != "each"}
    parts = entry["each"]
    several = isinstance(parts, list) and len(parts) > 1
    if not several or not all(isinstance(part, dict) for part in parts):
        raise build_error(f"each: {show_value(parts)}: expected {EACH}")
    return {f"{place}: each: {n}": _merge_keys(part, shared) for n, part in enumerate(parts)}


def _read_panels(entries: Any) -> list[Panel]:
    """Return the panels of a figure, each with its place in the list of the file.

    Raises an error of the file for anything but a list, and for too many panels.
    """
    if not isinstance(entries, list) or not entries:
        raise build_expectation("a list of panels")
    placed: dict[str, Any] = {}
    for number, entry in enumerate(entries):
        placed |= _expand_entry(number, entry)
    # By place, so that a fault is told with the keys that lead to it.
    panels = _PANELS.validate_python(placed)
    for place, panel in panels.items():
        panel._place = place
    if len(panels) > MOST_PANELS:
        raise build_error(f"{len(panels)} panels; expected at most {MOST_PANELS}, one a letter")
    return [*panels.values()]


class Figure(Model):
    """Panels on one sheet."""

    title: Line = Field(description="one line")
    columns: Literal[1, 2, 3, 4, 5] = Field(description="panels side by side, 1 to 5")
    width: Literal["one", "two"] = Field(
        "two", description="of the sheet, in columns of a journal: one (8.5 cm) or two (17 cm)"
    )
    panels: Annotated[list[Panel], PlainValidator(_read_panels)] = Field(
        description="a list of panels"
    )

    def _collect_names(self, key: str) -> list[str]:
        """Return the values of a key of its panels, in alphabetical order."""
        return sorted({name for each in self.panels if (name := getattr(each, key, None))})

    @property
    def workspaces(self) -> list[str]:
        """Return the names of the workspaces that are drawn without runs."""
        return self._collect_names("workspace")

    @property
    def problems(self) -> list[str]:
        """Return the names of the problems that are drawn without runs."""
        return self._collect_names("problem")

    @property
    def rerun(self) -> list[str]:
        """Return the names of the experiments whose runs are repeated, because no table keeps what
        is drawn.
        """
        return sorted({panel.experiment for panel in self.panels if panel.rerun})

    @property
    def claims(self) -> list[str]:
        """Return the ids of the claims that are drawn under all alternatives."""
        return self._collect_names("claim")

    @property
    def code(self) -> list[str]:
        """Return the parts of a study's code that its panels call."""
        called, drawing = map(self._collect_names, ("data", "function"))
        return ["metrics", *(["functions"] if called else []), *(["panels"] if drawing else [])]

    @property
    def names_any(self) -> bool:
        """Tell whether its legend names values that a function returns, which may be any method."""
        return any(
            getattr(panel, "data", None) and getattr(panel, "hue", None) for panel in self.panels
        )

    def draws(self, table: str) -> bool:
        """Tell whether it draws the numbers of a published table."""
        return any(
            table
            in (getattr(panel, "printed", None), *convert_to_list(getattr(panel, "published", [])))
            for panel in self.panels
        )
