"""What the job that draws a figure is made from, beside its input files: names and plain values."""

from typing import Annotated, Any, NamedTuple

from pydantic import PlainValidator

from bezierplan.figures.panels import Panel, panel_of
from bezierplan.running.chunk import Chunk


class FigureJob(NamedTuple):
    """A figure."""

    study: str
    columns: int
    panels: list[Annotated[Panel, PlainValidator(panel_of)]]
    module: str | None
    """That of the study, with the functions that panels name."""
    labels: dict[str, str]
    """Name -> how it is printed."""
    looks: dict[str, str]
    """Method -> the name of its look."""
    workspaces: dict[str, dict[str, Any]]
    """By name, those that are drawn without runs, as their files describe them."""
    repeats: dict[str, int]
    """By experiment."""
    chunks: dict[str, dict[str, Chunk]]
    """Those whose runs the figure reruns, to draw what no table keeps, by experiment and method."""
    unit: str
    """That of lengths."""
