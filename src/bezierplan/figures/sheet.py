"""A figure: its panels on one sheet, and the table of everything drawn on it.

A kind of panel is a module of `figures.panels`, which says what each has.
"""

import math
import string
import textwrap
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bezierplan.figures import style
from bezierplan.figures.layout import Layout
from bezierplan.figures.panels import Panel, Sources, load_kind
from bezierplan.workspaces.problem import Problem, Workspace

# A panel narrower than this, in inches, has smaller marks and fewer ticks.
_NARROW_PANEL, _SMALLER = 2.0, 0.6

# Width of a letter of the smallest text, and what labels beside a panel take, in inches.
_LETTER, _BESIDE = 0.057, 0.45

# Rounds after which the sheet is as high as what is on it: a lower sheet is laid out anew, so one
# cut leaves some empty room.
_ROUNDS = 2


class FigureScene(NamedTuple):
    """Everything that drawings need beside the table of data.

    problems: by experiment, then by name. workspaces, places: workspaces and problems that are
    drawn without runs, by name. labels: name -> printed name. unit: the study's unit of length.
    looks: method -> the name of its look (`style.LOOKS`). functions: the study's functions that
    draw, by name. layout: the form of the paper's figure.
    """

    problems: dict[str, dict[str, Problem]]
    workspaces: dict[str, Workspace]
    labels: dict[str, str]
    unit: str
    looks: Mapping[str, str] = {}
    functions: Mapping[str, Callable[..., Any]] = {}
    layout: Layout | None = None
    places: Mapping[str, Problem] = {}


def collect_data(panels: list[Panel], sources: Sources) -> pd.DataFrame:
    """Return the rows of all panels in one table, whose first column is the panel number (0, 1,
    ...).

    Raises ValueError for options or runs that a kind of panel cannot draw.
    """
    frames = []
    for number, panel in enumerate(panels):
        frame = load_kind(panel.kind).data(panel.source(sources), panel)
        frame.insert(0, "panel", number)
        frames.append(frame)
    return pd.concat(frames, ignore_index=True)


def store_data(frame: pd.DataFrame, file: str) -> pd.DataFrame:
    """Write the table of data as csv, and return it read back, every number to its last bit."""
    frame.to_csv(file, index=False, lineterminator="\n")
    return pd.read_csv(file, low_memory=False)  # each column read whole, with one type


def draw(
    panels: list[Panel], frame: pd.DataFrame, scene: FigureScene, columns: int, width: str = "two"
) -> Figure:
    """Draw the figure of a table that `collect_data` made.

    The figure's label has notes: which runs each panel shows and counts; in a second line, things
    that are plain to the eye.
    frame: preferably as from `store_data`, so that the figure shows exactly the content of the
    file. columns: panels per row. width: a key of `style.WIDTHS`.
    """
    rows, inches = math.ceil(len(panels) / columns), style.WIDTHS[width]
    # A dollar would begin a formula of matplotlib.
    labels = {name: text.replace("$", r"\$") for name, text in scene.labels.items()}
    scene = scene._replace(labels=labels)
    letters = [f"({letter})" for letter in string.ascii_lowercase[: len(panels)]]
    if len(panels) == 1:
        letters = [""]
    several = "method" in frame and frame["method"].nunique() > 1
    with mpl.rc_context(style.SETTINGS):
        # Higher than needed, so that the width limits the panels.
        figure = Figure(figsize=(inches, 2 + 1.4 * inches * rows / columns), layout="compressed")
        # This canvas remembers how wide texts are; a figure's bare one measures them each time.
        FigureCanvasAgg(figure)
        notes = []
        for number, (letter, panel) in enumerate(zip(letters, panels)):
            kind, rows_of_panel = load_kind(panel.kind), frame[frame["panel"] == number]
            projection = getattr(kind, "PROJECTION", None)
            axes = figure.add_subplot(rows, columns, number + 1, projection=projection)
            notes.append(kind.draw(axes, rows_of_panel, scene, panel))
            if scene.layout:
                scene.layout.apply_to(axes, number)
            methods = rows_of_panel["method"].dropna().unique() if several else []
            # A method is named only where other panels have others.
            method = labels.get(methods[0], methods[0]) if len(methods) == 1 else ""
            title = (panel.title or "").replace("$", r"\$")
            first = ", ".join(filter(None, [title, method]))
            heading = "\n".join(filter(None, [first, notes[-1].heading]))
            _fit(axes, f"{letter} {heading}".lstrip(), inches / columns)
        _name_axes_once(figure.axes[: len(panels)], columns)
        _draw_legend(figure, scene.layout.names if scene.layout else {})
        _fit_height(figure)
    caption = _join_clauses(letters, [note.caption for note in notes])
    glance = _join_clauses(letters, [note.glance for note in notes])
    caption = " ".join(filter(None, [caption, _describe_equal_paths(letters, frame)]))
    figure.set_label("\n".join(filter(None, [caption, glance])))
    return figure


def _fit(axes: Axes, heading: str, width: float) -> None:
    """Give a panel its heading and its shape, with texts broken to fit a width in inches."""
    room = width - _BESIDE
    axes.set_title(_break_lines(heading, room))
    # Panels of a row begin at one height, whatever their shapes.
    axes.set_anchor("N")
    # A panel in space is a box of three sides, which one ratio cannot shape.
    if axes.name == "3d":
        return
    if axes.get_aspect() == "auto" and axes.get_box_aspect() is None:
        axes.set_box_aspect(style.PANEL_HEIGHT)
    high = room * (axes.get_box_aspect() or 1)
    axes.set_xlabel(_break_lines(axes.get_xlabel(), room))
    axes.set_ylabel(_break_lines(axes.get_ylabel(), high))
    if width < _NARROW_PANEL:
        for line in axes.get_lines():
            line.set_markersize(_SMALLER * line.get_markersize())
        if axes.get_aspect() != "auto":
            axes.locator_params(nbins=4, integer=True)


def _break_lines(text: str, room: float) -> str:
    """Break text into lines that fit a width in inches."""
    letters = max(10, int(room / _LETTER))
    return "\n".join(textwrap.fill(line, letters) for line in text.splitlines())


def _name_axes_once(panels: list[Axes], columns: int) -> None:
    """Remove names of axes inside the sheet if all panels share them."""
    if len({axes.get_ylabel() for axes in panels}) == 1:
        for number, axes in enumerate(panels):
            if number % columns:
                axes.set_ylabel("")
    if len({axes.get_xlabel() for axes in panels}) == 1:
        for axes in panels[:-columns]:
            axes.set_xlabel("")


def _draw_legend(figure: Figure, names: Mapping[Any, str]) -> None:
    """Draw one legend below all panels, with each label once, in as few rows as the width allows.

    Entries that the paper's figure names come first, in its order; the entries of `style.LAST` come
    last.
    """
    found = {}
    for axes in figure.axes:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            found.setdefault(names.get(label, label), handle)
    others = sorted(found, key=lambda label: label.startswith(style.LAST))
    order = dict.fromkeys([*names.values(), *others])
    handles = {label: found[label] for label in order if label in found}
    for columns in range(len(handles), 0, -1):
        legend = figure.legend(
            handles.values(), handles.keys(), loc="outside lower center", ncols=columns
        )
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def _fit_height(figure: Figure) -> None:
    """Cut empty room above the panels, and between them and the legend."""
    layout = figure.get_layout_engine()
    for _ in range(_ROUNDS):
        layout.execute(figure)
        boxes = [axes.get_tightbbox() for axes in figure.axes]
        floor = max([legend.get_window_extent().y1 for legend in figure.legends], default=0.0)
        empty = figure.bbox.height - max(box.y1 for box in boxes) + min(box.y0 for box in boxes)
        figure.set_figheight(figure.get_figheight() - (empty - floor) / figure.dpi + 0.1)
    layout.execute(figure)
    # Laid out once: each of the three files would do it again.
    figure.set_layout_engine(None)


def _join_clauses(letters: list[str], clauses: list[str]) -> str:
    """Return what the panels say, each with its letter; panels that say the same share one."""
    same: dict[str, list[str]] = {}
    for letter, clause in zip(letters, clauses):
        same.setdefault(clause, []).append(letter)
    return " ".join(f"{', '.join(same[each])} {each}.".lstrip() for each in filter(None, same))


def _describe_equal_paths(letters: list[str], frame: pd.DataFrame) -> str:
    """Say which panels show the same path."""
    if "part" not in frame:
        return ""
    same: dict[bytes, list[str]] = {}
    for number, path in frame[frame["part"] == "path"].groupby("panel"):
        same.setdefault(path[["x", "y"]].to_numpy().tobytes(), []).append(letters[number])
    return " ".join(
        f"{', '.join(own)} show the same path." for own in same.values() if len(own) > 1
    )


def save(figure: Figure, *files: str) -> None:
    """Save a figure in files, each as its ending says: svg, png (300 dots per inch) or pdf.

    Equal drawings give equal bytes at any time. Each picture has its caption in its metadata.
    """
    caption = figure.get_label() or None
    # A date or a version would make equal drawings differ in their bytes.
    kinds = {
        "svg": {"Date": None, "Creator": None, "Description": caption},
        "png": {"Software": None} | ({"Description": caption} if caption else {}),
        "pdf": {"CreationDate": None, "Creator": None, "Producer": None, "Subject": caption},
    }
    with mpl.rc_context(style.SETTINGS):
        for file in files:
            kind = file.rpartition(".")[2]
            figure.savefig(file, dpi=300 if kind == "png" else "figure", metadata=kinds[kind])
