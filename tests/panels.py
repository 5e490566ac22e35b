"""Panels of figures, from the few keys that a test is about."""

from types import ModuleType
from typing import Any

from bezierplan.figures.panels import Panel, build_panel


def options_of(kind: ModuleType, **given: Any) -> Panel:
    """Options of a panel of a kind, with those that it needs to name what it shows, if none are
    given.
    """
    fields = kind.Options.model_fields
    needed = {
        key: "any" for key in ("data", "workspace") if key in fields and fields[key].is_required()
    }
    if "experiment" in fields and not {"data", "explicit"} & given.keys():
        needed["experiment"] = "routes"
    return kind.Options.model_validate({"kind": kind.__name__.rpartition(".")[2]} | needed | given)


def panels_of(given: list[dict[str, Any]]) -> list[Panel]:
    """Panels as a figure has them."""
    return [build_panel(panel) for panel in given]
