"""A figure: its panels on one sheet, and the table of everything drawn on it.

A kind of panel is a module of `figures.panels`, which says what each has.
"""

import functools
import itertools
import math
import re
import string
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from bezierplan.figures import style
from bezierplan.figures.panels import Note, Panel, Sources, kind_module
from bezierplan.workspaces.problem import Problem, Workspace


class Scene(NamedTuple):
    """What drawings need in addition to the table of what is drawn.

    problems: by experiment, then by name. workspaces: those without an experiment, by name. labels:
    how names are printed. unit: name of the study's unit of length. looks: method -> the name of
    its look (`style.LOOKS`). Set by `draw`: narrow, whether panels are too narrow for more than the
    shortest notes; milliseconds, whether all panels print lengths of time in these; and wide, the
    metrics whose axes are logarithmic in all panels, because one of them needs it.
    """

    problems: dict[str, dict[str, Problem]]
    workspaces: dict[str, Workspace]
    labels: dict[str, str]
    unit: str
    looks: Mapping[str, str] = MappingProxyType({})
    narrow: bool = False
    milliseconds: bool = False
    wide: frozenset[str] = frozenset()


def data(panels: list[Panel], sources: Sources) -> pd.DataFrame:
    """Everything that is drawn: the rows of all panels, with the panel number (0, 1, ...) in the
    first column. Raises ValueError for options or runs that a kind cannot draw.
    """
    frames = []
    for number, panel in enumerate(panels):
        frame = kind_module(panel.kind).data(panel.source(sources), panel)
        frame.insert(0, "panel", number)
        frames.append(frame)
    return pd.concat(frames, ignore_index=True)


def write_data(frame: pd.DataFrame, file: str) -> None:
    """Write what is drawn as csv."""
    frame.to_csv(file, index=False, lineterminator="\n")


def read_data(file: str) -> pd.DataFrame:
    """What `write_data` wrote, every number to its last bit."""
    return pd.read_csv(file, low_memory=False)  # each column read whole, with one type


def draw(
    panels: list[Panel], frame: pd.DataFrame, scene: Scene, columns: int, width: float | None = None
) -> Figure:
    """The figure of a table made by `data`. Its label is its caption: for each panel the run that
    it shows, and what it counts; in a second line, if anything can be told of it, what is seen.

    frame: preferably the csv file read back (`read_data`), so that the figure shows exactly its
    content. columns: panels per row. width: of the sheet, in inches; left out: one text column for
    one column of panels, otherwise two.
    """
    rows = math.ceil(len(panels) / columns)
    width = width or (style.NARROW if columns == 1 else style.WIDE)
    labels = {name: _plain(label) for name, label in scene.labels.items()}
    scene = scene._replace(
        labels=labels,
        narrow=width / columns < style.NARROW_PANEL,
        milliseconds=style.are_short(_seconds(panels, frame)),
    )
    with mpl.rc_context(style.SETTINGS):
        figure = Figure(figsize=(width, width * rows / columns))
        FigureCanvasAgg(
            figure
            # Remembers the extents of texts, which the bare canvas of a figure measures anew for
            # each question.
        )
        grid = _places(figure, panels, rows, columns)
        rows_of = [frame[frame["panel"] == number] for number in range(len(panels))]
        drawn = list(zip(grid.flat, rows_of, panels))
        notes = [
            kind_module(panel.kind).draw(axes, own, scene, panel) for axes, own, panel in drawn
        ]
        scene = scene._replace(wide=_wide(grid, panels))
        for number, (axes, own, panel) in enumerate(drawn):
            if panel.measured in scene.wide and _is_linear(axes):
                axes.clear()
                notes[number] = kind_module(panel.kind).draw(axes, own, scene, panel)
        titles = [_title(panel, own, scene) for _, own, panel in drawn]
        for axes in grid.flat[len(panels) :]:
            axes.set_visible(False)
        if scene.narrow:
            _name_axes_once(grid)
        legend = _draw_legend(figure)
        _lay_out(figure, grid, legend, _ROUNDS)
        room = 72 * figure.get_figwidth() * grid.flat[0].get_position(original=True).width
        letters = (
            [f"({letter}) " for letter in string.ascii_lowercase[: len(panels)]]
            if len(panels) > 1
            else [""]
        )
        most = _MOST_NARROW_LINES if scene.narrow else _MOST_LINES
        headings = [_heading(*each, room, most) for each in zip(letters, titles, notes)]
        for first in range(0, len(panels), columns):
            _write_headings(grid.flat[first : first + columns], headings[first : first + columns])
        lines = [
            _caption(letters, [heading.told for heading in headings]),
            _caption(letters, [[note.seen] if note.seen else [] for note in notes]),
        ]
        figure.set_label("\n".join(filter(None, lines)))
        _lay_out(figure, grid, legend, 2)  # headings change only the heights of rows
    return figure


def _wide(grid: np.ndarray, panels: list[Panel]) -> frozenset[str]:
    """The metrics that some panel shows on a logarithmic axis."""
    return frozenset(
        panel.measured
        for axes, panel in zip(grid.flat, panels)
        if panel.measured is not None and not _is_linear(axes)
    )


def _is_linear(axes: Axes) -> bool:
    return {axes.get_xscale(), axes.get_yscale()} == {"linear"}


def _seconds(panels: list[Panel], frame: pd.DataFrame) -> list[float]:
    """The lengths of time that panels show: one unit for all of them lets them be compared."""
    timed = [number for number, panel in enumerate(panels) if panel.timed]
    return frame.loc[frame["panel"].isin(timed), "value"].to_list() if timed else []


# The most panels without names or last values beside them below each other, and of those the most
# that are as high as a map.
_MOST_BELOW, _MOST_MAPS_BELOW = 4, 2


def narrow_columns(panels: list[Panel]) -> int:
    """Panels side by side on a sheet of one text column: one, or two of many, which would make the
    sheet longer than a page.
    """
    if any(panel.named_rows for panel in panels):
        return 1
    maps = sum(panel.to_scale for panel in panels)
    return 1 if len(panels) <= _MOST_BELOW and maps <= _MOST_MAPS_BELOW else 2


def _places(figure: Figure, panels: list[Panel], rows: int, columns: int) -> np.ndarray:
    """Axes (rows, columns) for panels, row by row, including empty places in the last row."""
    projections = [getattr(kind_module(panel.kind), "PROJECTION", None) for panel in panels]
    projections += [None] * (rows * columns - len(panels))
    places = [
        figure.add_subplot(rows, columns, number + 1, projection=projection)
        for number, projection in enumerate(projections)
    ]
    return np.array(places).reshape(rows, columns)


def _title(panel: Panel, frame: pd.DataFrame, scene: Scene) -> list[str]:
    """A panel's title, and the method whose runs it shows, if there is only one: it says how to
    read the curve.
    """
    words = [_plain(panel.title)] if panel.title else []
    methods = frame["method"].dropna().unique() if "method" in frame else []
    return [*words, scene.labels.get(methods[0], methods[0])] if len(methods) == 1 else words


def _plain(text: str) -> str:
    """Text that matplotlib prints as it stands: a dollar begins no formula."""
    return text.replace("$", r"\$")


# Lines above a panel, of its title and the few words below it, and above a narrow one.
_MOST_LINES, _MOST_NARROW_LINES = 2, 3

# Rounds after which panels and the labels beside them fit each other.
_ROUNDS = 3


class _Heading(NamedTuple):
    """The title of a panel, the few words below it, and what the caption says of it."""

    title: str
    words: str
    told: list[str]


def _lines(title: str, room: float) -> int:
    return _broken(title, room, style.TITLE_TEXT).count("\n") + 1


def _heading(letter: str, title: list[str], note: Note, room: float, most: int) -> _Heading:
    """What stands above a panel, in at most so many lines of a width in points: its title, with its
    method if that fits, and, if a line is left, the few words. The caption has the rest.
    """
    named = _lines(letter + ", ".join(title), room) <= most
    told = [*([] if named else title[1:]), *([note.told] if note.told else [])]
    shown = title if named else title[:1]
    # With the method on a line of its own, if that takes no more lines.
    apart = _broken(letter + ",\n".join(shown), room, style.TITLE_TEXT)
    heading = _broken(letter + ", ".join(shown), room, style.TITLE_TEXT)
    if apart.count("\n") <= heading.count("\n"):
        heading = apart
    words = _broken(note.shown, room, style.SMALLEST_TEXT)
    if words and heading.count("\n") + words.count("\n") + 2 > most:
        return _Heading(heading, "", [note.shown, *told])
    return _Heading(heading, words, told)


def _write_headings(row: np.ndarray, headings: list[_Heading]) -> None:
    """Write the titles of a row of panels at one height, and their words between them and the
    panels.
    """
    lines = max(len(heading.words.splitlines()) for heading in headings)
    top = 3 + 1.25 * style.SMALLEST_TEXT * lines
    anchor = {
        "xy": (0, 1),
        "xycoords": "axes fraction",
        "xytext": (0, top),
        "textcoords": "offset points",
        "va": "top",
    }
    for axes, heading in zip(row, headings):
        axes.set_title(heading.title, loc="left", pad=top + 3)
        if heading.words:
            axes.annotate(heading.words, linespacing=1.1, **anchor)


def _caption(letters: list[str], told: list[list[str]]) -> str:
    """What the panels tell, each with its letter, those that tell the same together."""
    same: dict[str, list[str]] = {}
    for letter, clauses in zip(letters, told):
        if clauses:
            same.setdefault("; ".join(" ".join(clause.split()) for clause in clauses), []).append(
                letter.strip()
            )
    return " ".join(
        f"{', '.join(filter(None, own))} {words}.".lstrip() for words, own in same.items()
    )


def _name_axes_once(grid: np.ndarray) -> None:
    """Keep axis names only at the left and lower edge of the panels (rows, columns) where a row or
    a column shares them.
    """
    for row in grid:
        if len({axes.get_ylabel() for axes in row if axes.get_visible()}) == 1:
            for axes in row[1:]:
                axes.set_ylabel("")
    for column in grid.T:
        shown = [axes for axes in column if axes.get_visible()]
        if len({axes.get_xlabel() for axes in shown}) == 1:
            for axes in shown[:-1]:
                axes.set_xlabel("")


@functools.cache
def _width(text: str, size: float) -> float:
    """Width of a line of text, in points."""
    return text_to_path.get_text_width_height_descent(
        text.replace(r"\$", "$"), FontProperties(size=size), ismath=False
    )[0]


def _broken(text: str, room: float, size: float) -> str:
    """Text broken after spaces, commas and slashes, but not at a minus, into lines that fit a
    width; width and text size in points.
    """
    lines = []
    for paragraph in text.splitlines():
        line = ""
        for word in re.findall(r"[^ ,/]*(?: - [^ ,/]*)?[ ,/]*", paragraph):
            if line and _width(line + word.rstrip(), size) > room:
                lines.append(line.rstrip())
                line = ""
            line += word
        lines.append(line.rstrip())
    return "\n".join(lines)


def _draw_legend(figure: Figure) -> float:
    """One legend for all panels below them, with each label once, in as few rows as the width
    allows; returns the room for it in inches.
    """
    handles = {}
    for part in itertools.chain.from_iterable((axes, *axes.child_axes) for axes in figure.axes):
        for handle, label in zip(*part.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    for columns in range(len(handles), 0, -1):
        legend = figure.legend(handles.values(), handles.keys(), loc="lower center", ncols=columns)
        extent = legend.get_window_extent()
        if columns == 1 or extent.width <= figure.bbox.width:
            return extent.y1 / figure.dpi + style.GAP / 2
        legend.remove()
    return 0.0


def _lay_out(figure: Figure, grid: np.ndarray, legend: float, rounds: int) -> None:
    """Place panels (rows, columns), all as wide as the sheet allows, the tops of each row level,
    and fit the sheet's height to them.

    Takes rounds, because the labels beside a panel depend on its size: ticks, and names of axes,
    which are broken to fit its sides. Ticks may change to and fro with the size that they leave, so
    each round has room for those of the one before as well. legend: room for it, in inches. Raises
    ValueError if labels leave no room.
    """
    names = {axes: (_joined(axes.get_xlabel()), _joined(axes.get_ylabel())) for axes in grid.flat}
    before = np.zeros((*grid.shape, 4))
    for _ in range(rounds):
        measured = np.array([[_margins(axes) for axes in row] for row in grid])
        margins, before = np.maximum(measured, before) + style.GAP / 2, measured
        left, right = margins[:, :, :2].max(axis=0).T
        bottom, top = margins[:, :, 2:].max(axis=1).T
        sheet_width = figure.get_figwidth()
        width = (sheet_width - (left + right).sum()) / len(left)
        if width <= 0:
            raise ValueError(
                "the labels leave no room for the panels; shorten them, or put fewer panels side "
                "by side (columns)"
            )
        heights = width * np.array([[_shape(axes) for axes in row] for row in grid])
        depths = np.cumsum(top + heights.max(axis=1) + bottom)
        sheet_height = depths[-1] + legend
        figure.set_figheight(sheet_height)
        x = np.cumsum(left + width + right) - width - right
        y = sheet_height - depths + bottom + heights.max(axis=1)
        for (row, column), axes in np.ndenumerate(grid):
            height = heights[row, column]
            corner = x[column] / sheet_width, (y[row] - height) / sheet_height
            axes.set_position([*corner, width / sheet_width, height / sheet_height])
            if axes.name != "3d":
                along, upwards = names[axes]
                axes.set_xlabel(_broken(along, 72 * width, style.SMALLEST_TEXT))
                axes.set_ylabel(_broken(upwards, 72 * height, style.SMALLEST_TEXT))


def _joined(name: str) -> str:
    """The name of an axis in one line, as it was before it was broken (`_broken`)."""
    return " ".join(name.splitlines())


def _margins(axes: Axes) -> tuple[float, float, float, float]:
    """How far labels extend beyond a panel to the left, to the right, below and above, in
    inches.
    """
    outer = axes.get_tightbbox(for_layout_only=True)
    if outer is None:  # a place without a panel
        return 0.0, 0.0, 0.0, 0.0
    inner = axes.get_window_extent()
    dots = np.array(
        [inner.x0 - outer.x0, outer.x1 - inner.x1, inner.y0 - outer.y0, outer.y1 - inner.y1]
    )
    return tuple(np.maximum(dots, 0) / axes.figure.dpi)


def _shape(axes: Axes) -> float:
    """Height of a panel as a share of its width: to scale or as its kind requires, otherwise the
    same for all.
    """
    if axes.name == "3d":
        return style.HIGH_PANEL_HEIGHT
    if axes.get_box_aspect() is not None:
        return axes.get_box_aspect()
    return (
        style.PANEL_HEIGHT
        if axes.get_aspect() == "auto"
        else axes.get_data_ratio() * axes.get_aspect()
    )


def save(figure: Figure, svg: str, png: str | None = None, pdf: str | None = None) -> None:
    """Save a figure as svg and, if they are asked for, as png of 300 dots per inch and as pdf;
    equal drawings give equal bytes at any time. Each picture has its caption in its metadata.
    """
    told = figure.get_label() or None
    with mpl.rc_context(style.SETTINGS):
        figure.savefig(
            svg, format="svg", metadata={"Date": None, "Creator": None, "Description": told}
        )
        if png:
            figure.savefig(
                png,
                format="png",
                dpi=300,
                metadata={"Software": None} | ({"Description": told} if told else {}),
            )
        if pdf:
            figure.savefig(
                pdf,
                format="pdf",
                metadata={"CreationDate": None, "Creator": None, "Producer": None, "Subject": told},
            )
