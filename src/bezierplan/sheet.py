"""A figure: its panels on one sheet, and the table of everything that is drawn there.

A kind of panel is a module of `bezierplan.figures` with two functions:

    data(source, *, <options>) -> DataFrame         what is drawn; the source is Results, or a Workspace where nothing is planned
    draw(axes, frame, scene, panel) -> str          draws the rows of its panel, labels its artists for the legend, fixes the shape of its
                                                    axes, computes no statistics; returns the note printed below the panel's title

The keyword-only arguments of `data` are the options that a panel may have; those without a default value it must have.
"""

import importlib
import inspect
import math
import re
import string
import typing
from pathlib import Path as File
from types import ModuleType
from typing import Any, NamedTuple

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from bezierplan import style
from bezierplan.analysis.results import Results, select
from bezierplan.problem import Problem, Workspace

# Keys that a panel of any kind may have beside the options of its kind.
PANEL_KEYS = ("kind", "title", "experiment", "where", "workspace")


class Scene(NamedTuple):
    """What drawings need beside the table of what is drawn.

    problems: by experiment, then by name. workspaces: those without an experiment, by name. labels: how names are printed.
    unit: name of the study's unit of length.
    """

    problems: dict[str, dict[str, Problem]]
    workspaces: dict[str, Workspace]
    labels: dict[str, str]
    unit: str


def known_kinds() -> list[str]:
    """Names of the kinds of panel."""
    return sorted(file.stem for file in (File(__file__).parent / "figures").glob("*.py") if file.stem != "__init__")


def kind_module(name: str) -> ModuleType:
    """The module of a kind of panel. Raises ModuleNotFoundError if there is none."""
    return importlib.import_module(f"bezierplan.figures.{name}")


def panel_options(kind: str) -> dict[str, Any]:
    """Options of a kind of panel: name -> annotation, in the order of its signature."""
    hints = typing.get_type_hints(kind_module(kind).data, include_extras=True)
    return {parameter.name: hints[parameter.name] for parameter in _option_parameters(kind)}


def required_options(kind: str) -> list[str]:
    """Options that every panel of a kind must have."""
    return [parameter.name for parameter in _option_parameters(kind) if parameter.default is inspect.Parameter.empty]


def _option_parameters(kind: str) -> list[inspect.Parameter]:
    parameters = inspect.signature(kind_module(kind).data).parameters.values()
    return [parameter for parameter in parameters if parameter.kind is inspect.Parameter.KEYWORD_ONLY]


def data(panels: list[dict[str, Any]], results: dict[str, Results], workspaces: dict[str, Workspace]) -> pd.DataFrame:
    """Everything that is drawn: the rows of all panels, the number of the panel (0, 1, ...) in the first column.

    panels: kind, title, experiment with where (as in `analysis.results.select`) or workspace, and options of the kind. results: by
    experiment. workspaces: by name. Raises ValueError for options or runs that a kind cannot draw.
    """
    frames = []
    for number, panel in enumerate(panels):
        options = {name: value for name, value in panel.items() if name not in PANEL_KEYS}
        frame = kind_module(panel["kind"]).data(_source(panel, results, workspaces), **options)
        frame.insert(0, "panel", number)
        frames.append(frame)
    return pd.concat(frames, ignore_index=True)


def _source(panel: dict[str, Any], results: dict[str, Results], workspaces: dict[str, Workspace]) -> Results | Workspace:
    if "experiment" not in panel:
        return workspaces[panel["workspace"]]
    found = results[panel["experiment"]]
    return found._replace(runs=select(found.runs, panel.get("where", {})))


def write_data(frame: pd.DataFrame, file: str) -> None:
    """Write what is drawn as csv."""
    frame.to_csv(file, index=False, lineterminator="\n")


def read_data(file: str) -> pd.DataFrame:
    """What `write_data` wrote, every number to its last bit."""
    return pd.read_csv(file, float_precision="round_trip")


def draw(panels: list[dict[str, Any]], frame: pd.DataFrame, scene: Scene, columns: int) -> Figure:
    """The figure of a table made by `data`: as wide as one text column for one column of panels, as two for more.

    frame: best the csv read back (`read_data`), so that what is drawn is what stands there. columns: panels in a row.
    """
    rows = math.ceil(len(panels) / columns)
    width = style.NARROW if columns == 1 else style.WIDE
    with matplotlib.rc_context(style.SETTINGS):
        figure = Figure(figsize=(width, 1.5 * width * rows / columns), layout="constrained")
        grid = figure.subplots(rows, columns, squeeze=False)
        for number, panel in enumerate(panels):
            own = frame[frame["panel"] == number]
            note = kind_module(panel["kind"]).draw(grid.flat[number], own, scene, panel)
            letter = f"({string.ascii_lowercase[number]}) " if len(panels) > 1 else ""
            _write_head(grid.flat[number], letter + _title(panel, own, scene), note, 72 * width / columns)
        for axes in grid.flat[len(panels) :]:
            axes.set_axis_off()
        legend = _draw_legend(figure)
        _fit_height(figure, grid, legend)
    return figure


def _title(panel: dict[str, Any], frame: pd.DataFrame, scene: Scene) -> str:
    """A panel's title with the method whose runs it shows, if there is one."""
    methods = frame["method"].unique() if "method" in frame else []
    words = [panel.get("title"), *(scene.labels.get(method, method) for method in methods[:1] if len(methods) == 1 and pd.notna(method))]
    return ", ".join(word for word in words if word)


def _write_head(axes: Axes, title: str, note: str, width: float) -> None:
    """Write a panel's title and, below it, its note; width: room of the panel in points."""
    beside = 36  # points that the labels of an upright axis take
    words = _wrapped(note, width - beside, style.SMALLEST_TEXT)
    heading = _wrapped(title, width - beside, style.TITLE_TEXT)
    gap = 4
    lines = words.count("\n") + 1 if words else 0
    axes.annotate(words, (0, 1), xytext=(0, gap), xycoords="axes fraction", textcoords="offset points", va="bottom", linespacing=1.2)
    axes.set_title(heading, loc="left", pad=gap + 1.3 * style.SMALLEST_TEXT * lines)


def _wrapped(text: str, width: float, size: float) -> str:
    """Text broken after spaces, commas and slashes into lines of at most about a width; width and size of the text in points."""
    most = int(width / (0.6 * size))  # a character of this font is 0.6 of its size wide on average
    lines = []
    for paragraph in text.splitlines():
        line = ""
        for word in re.findall(r"[^ ,/]*[ ,/]*", paragraph):
            if line and len(line + word.rstrip()) > most:
                lines.append(line.rstrip())
                line = ""
            line += word
        lines.append(line.rstrip())
    return "\n".join(lines)


def _draw_legend(figure: Figure) -> Legend | None:
    """One legend of all panels below them, each label once, in as few rows as fit the width."""
    handles = {}
    for axes in figure.axes:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    for columns in range(len(handles), 0, -1):
        legend = figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=columns)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return legend
        legend.remove()
    return None


def _fit_height(figure: Figure, grid: np.ndarray, legend: Legend | None) -> None:
    """Cut the sheet to what its panels need: they are as wide as the sheet allows, and their shapes are fixed.

    Two rounds, because a lower sheet moves the panels, and with them how many tick labels there are.
    """
    for _ in range(2):
        figure.draw_without_rendering()
        heights = [max(axes.get_tightbbox().height for axes in row if axes.axison) for row in grid]
        if legend is not None:
            heights.append(legend.get_window_extent().height)
        gap = 0.1 * figure.dpi
        figure.set_figheight((sum(heights) + gap * len(heights)) / figure.dpi)


def save(figure: Figure, svg: str, png: str) -> None:
    """Save a figure as svg and as png of 300 dots per inch; equal drawings give equal bytes, whenever they are made."""
    with matplotlib.rc_context(style.SETTINGS):
        figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": None})
        figure.savefig(png, format="png", dpi=300, metadata={"Software": None})
