"""Sheets that are read in print: texts that lie on each other, small letters, faint colours, and
methods that change their look.
"""

import itertools

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text
from panels import panels_of
from studies import study
from test_figures import (
    comparing_panels,
    comparison,
    gallery,
    panels,
    printed_means,
    results,
    scene,
    sources,
    ticks_beyond,
)

from bezierplan.figures import sheet, style
from bezierplan.figures.panels import (
    critical_difference,
    expected_running_time,
    panel_of,
    performance_profile,
)
from bezierplan.study import jobs

STUDIES = {
    name: study(name) for name in ("song2016", "elhoseny2017", "ma2020", "tharwat2018", "meledje")
}

# Width of a text column of a narrow journal, in inches, and the smallest letters that can be read,
# in points.
COLUMN, READABLE = 8 / 2.54, 6

# Contrasts that the Web Content Accessibility Guidelines 2.1 ask for, of marks and of small text
# (criteria 1.4.11 and 1.4.3).
MARK, TEXT = 3.0, 4.5


def all_kinds() -> pd.DataFrame:
    """Tables of kinds that compare methods: ranks, times some of which are infinite, and
    profiles.
    """
    methods = ["smooth", "coarse", "random"]
    ranks = pd.DataFrame({"method": methods, "part": "rank", "value": [1.2, 1.9, 2.9]})
    ranks = pd.concat([ranks, ranks.assign(part="published", value=[2.2, 1.5, 2.3])])
    ranks = ranks.assign(methods=3, units=12, chi2=8.0, p_value=0.02, difference=0.96)
    times = pd.DataFrame(
        itertools.product(methods, (0.01, 0.02, 0.05, 0.1)), columns=["method", "within"]
    )
    times["value"] = [
        np.inf,
        9000.0,
        700.0,
        300.0,
        np.inf,
        np.inf,
        np.inf,
        4e5,
        np.inf,
        np.inf,
        np.inf,
        np.inf,
    ]
    times = times.assign(
        low95=times["value"] / 2,
        high95=times["value"] * 3,
        problems=6,
        reached=3,
        runs=60,
        successes=12,
    )
    profile = pd.DataFrame(
        {
            "method": methods,
            "ratio": [1.0, 1.3, 1.0],
            "share": [1.0, 0.5, 0.0],
            "problems": 6,
            "reached": 3,
            "solved": 6,
        }
    )
    return pd.concat([ranks.assign(panel=0), times.assign(panel=1), profile.assign(panel=2)])


COMPARED = [
    {"kind": "critical_difference", "title": "mean ranks by length", "experiment": "routes"},
    {
        "kind": "expected_running_time",
        "title": "evaluations",
        "experiment": "routes",
        "cost": "evaluations",
    },
    {"kind": "performance_profile", "title": "length", "experiment": "routes", "cost": "length"},
]


def drawn(found, own, columns, folder, width=None) -> Figure:
    if own is COMPARED:
        return sheet.draw(panels_of(own), all_kinds(), scene(found), columns, width)
    file = str(folder / "figure.csv")
    sheet.write_data(sheet.data(panels_of(own), sources(found)), file)
    return sheet.draw(panels_of(own), sheet.read_data(file), scene(found), columns, width)


SHEETS = [
    (results(), panels(), 2, None),
    (comparison(printed_means()), comparing_panels(), 2, None),
    (
        comparison(printed_means()),
        comparing_panels(),
        sheet.narrow_columns(panels_of(comparing_panels())),
        style.NARROW,
    ),
    (comparison(), gallery(10), 5, None),
    (comparison(), gallery(10), sheet.narrow_columns(panels_of(gallery(10))), style.NARROW),
    (results(), COMPARED, 2, None),
    (results(), COMPARED, sheet.narrow_columns(panels_of(COMPARED)), style.NARROW),
]


@pytest.mark.parametrize(("found", "own", "columns", "width"), SHEETS)
def test_texts_do_not_overlap_and_can_be_read_in_a_narrow_column(
    found, own, columns, width, tmp_path
):
    figure = drawn(found, own, columns, tmp_path, width)
    figure.draw_without_rendering()
    every = [*figure.axes, *itertools.chain.from_iterable(axes.child_axes for axes in figure.axes)]
    beyond = [label for axes in every if axes.axison for label in ticks_beyond(axes)]
    seen = [
        text
        for text in figure.findobj(Text)
        if text.get_text().strip() and text.get_visible() and text not in beyond
    ]
    declared = style.NARROW if figure.get_figwidth() < style.WIDE else style.WIDE
    printed = COLUMN / style.NARROW if declared == style.NARROW else 1
    assert min(text.get_fontsize() for text in seen) * printed >= READABLE
    boxes = [(text, text.get_window_extent()) for text in seen]
    for (one, a), (other, b) in itertools.combinations(boxes, 2):
        wide, high = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        # A drawing's own numbers, and a tick at the corner of two axes, may touch by a hair.
        assert wide <= 2 or high <= 2, (one.get_text(), other.get_text())


@pytest.mark.parametrize(("found", "own", "columns", "width"), SHEETS)
@pytest.mark.parametrize("dpi", [100, 150])
def test_no_text_is_cut_and_titles_stay_within_their_panels(
    found, own, columns, width, dpi, tmp_path
):
    """At any number of dots per inch, although the sheet is laid out at one."""
    figure = drawn(found, own, columns, tmp_path, width)
    figure.set_dpi(dpi)
    with mpl.rc_context(style.SETTINGS):
        figure.draw_without_rendering()
        beyond = [label for axes in figure.axes if axes.axison for label in ticks_beyond(axes)]
        texts = [
            text
            for text in figure.findobj(Text)
            if text.get_text().strip() and text.get_visible() and text not in beyond
        ]
        for text in texts:
            box = text.get_window_extent()
            assert box.x0 >= 0, text.get_text()
            assert box.x1 <= figure.bbox.x1, text.get_text()
        for axes in figure.axes:
            title = axes.title if axes.get_title() else axes._left_title
            if title.get_text():
                assert title.get_window_extent().x1 <= axes.get_window_extent().x1 + 1, (
                    title.get_text()
                )


def test_a_long_title_leaves_its_panel_two_lines_and_the_caption_the_rest(tmp_path):
    own = [
        panels()[0]
        | {"title": "from the first cell to the last one by quadratic pieces, of which each"},
        panels()[1],
    ]
    figure = drawn(results(), own, 2, tmp_path)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert max(title.count("\n") for title in titles) <= 1
    assert not any("run" in title for title in titles)
    told = figure.get_label()
    assert told.startswith("(a) ")
    assert "run study/routes/0_15/smooth/1" in told
    assert "2 of 3 runs are feasible" in told


@pytest.mark.parametrize("name", STUDIES)
def test_titles_of_panels_fit_into_two_lines(name):
    for figure in STUDIES[name].figures.values():
        room = (72 * (style.NARROW if figure.columns == 1 else style.WIDE) / figure.columns) - 36
        for panel in figure.panels:
            assert sheet._lines(f"(a) {panel.title or ''}", room) <= 2, panel.title


def luminance(colour) -> float:
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(colour, ground="#FFFFFF") -> float:
    """The contrast ratio of WCAG 2.1."""
    light, dark = sorted([luminance(colour), luminance(ground)], reverse=True)
    return (light + 0.05) / (dark + 0.05)


def test_marks_and_words_stand_out_from_paper():
    for name, (colour, *_) in style.LOOKS.items():
        assert contrast(colour) >= MARK, name
    for look in style.lines([float(number) for number in range(10)]):
        assert contrast(look["color"]) >= MARK, look
    for colour in (style.RED, style.BLUE, style.BLACK):
        assert contrast(colour) >= TEXT - 0.5, colour
    assert contrast(style.BLACK, style.OCCUPIED) >= MARK, "words on occupied cells"


# What eyes without the pigment for long and for medium waves see of linear red, green and blue
# (Machado, Oliveira and Fernandes 2009).
BLIND = {
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
}


def lab(colour, eyes=None) -> np.ndarray:
    """A colour in CIELAB as some eyes see it."""
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    if eyes:
        linear = np.clip(np.array(BLIND[eyes]) @ linear, 0, 1)
    xyz = (
        np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
        @ linear
        / [0.9505, 1.0, 1.089]
    )
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("eyes", [None, *BLIND])
def test_looks_differ_in_colour_or_in_mark_and_dashes_for_all_eyes(eyes):
    marks = [mark for _, _, mark in style.LOOKS.values()]
    assert len(set(marks)) == len(marks)
    for (one, a), (other, b) in itertools.combinations(style.LOOKS.items(), 2):
        apart = float(np.linalg.norm(lab(a[0], eyes) - lab(b[0], eyes)))
        assert apart >= 10 or a[1] != b[1], (
            f"{one} and {other} are {apart:.0f} apart, and both lines have the same dashes"
        )


@pytest.mark.parametrize("name", STUDIES)
def test_methods_side_by_side_look_different(name):
    looks = jobs.looks(STUDIES[name])
    for key, figure in STUDIES[name].figures.items():
        for panel in figure.panels:
            where = getattr(panel, "where", None) or {}
            methods = where.get("method")
            if isinstance(methods, list):
                own = [looks[method] for method in methods]
                assert len(set(own)) == len(own), (key, dict(zip(methods, own)))


def test_a_method_looks_alike_in_all_studies():
    """Methods of one name, such as baselines and rivals, and methods of another study that one
    borrows.
    """
    looks = {name: jobs.looks(study) for name, study in STUDIES.items()}
    for one, other in itertools.combinations(STUDIES, 2):
        for method in looks[one].keys() & looks[other].keys():
            assert looks[one][method] == looks[other][method], (one, other, method)
    borrowed = {
        "song2016_smooth": ("song2016", "smooth"),
        "ma2020_bca": ("ma2020", "bca"),
        "meledje_proposed": ("meledje", "proposed"),
    }
    for method, (paper, own) in borrowed.items():
        assert looks["elhoseny2017"][method] == looks[paper][own]
    drives = {
        method: method.removesuffix("_drives")
        for method in looks["meledje"]
        if method.endswith("_drives")
    }
    assert all(
        looks["meledje"][drive] == looks["meledje"][own]
        for drive, own in drives.items()
        if own in looks["meledje"]
    )


def test_looks_are_declared_once_or_follow_the_planner():
    planners = {
        "mine": "mine.py",
        "other": "other.py",
        "rounded": "rounded_shortest_path",
        "declared": "prm",
    }
    looks = style.looks_of(planners, {"declared": "sky"})
    assert looks["rounded"] == "black"
    assert looks["declared"] == "sky"
    assert len(set(looks.values())) == 4, (
        "two without a declaration get looks that no other method has"
    )
    shown = style.lines(["other", "rounded", "mine"], looks)
    assert [each["color"] for each in shown] == [
        style.LOOKS[looks[name]][0] for name in ("other", "rounded", "mine")
    ]
    twice = style.lines(["a", "b"], {"a": "blue", "b": "blue"})
    assert twice[0]["color"] != twice[1]["color"], "two lines in one panel are never alike"


def test_kinds_of_comparison_say_in_the_caption_how_to_read_them():
    notes = [
        kind.draw(
            Figure().subplots(),
            all_kinds().query("panel == @number"),
            scene(results()),
            panel_of(panel),
        )
        for number, (kind, panel) in enumerate(
            zip((critical_difference, expected_running_time, performance_profile), COMPARED)
        )
    ]
    assert [note.shown for note in notes] == ["", "", ""]
    assert "methods whose bars overlap cannot be distinguished" in notes[0].told
    assert "never: at least half of them are not solved" in notes[1].told
    assert notes[2].told == "6 problems; solved by the median run of any method: 6"


def test_marks_of_profiles_lie_on_their_lines():
    """Not before the last step, where the line is lower."""
    profile = all_kinds().query("panel == 2").drop(columns="panel")
    late = pd.concat([profile, profile.head(1).assign(ratio=1.31, share=0.9)])
    axes = Figure().subplots()
    performance_profile.draw(axes, late, scene(results()), panel_of(COMPARED[2]))
    marks = [line for line in axes.lines if len(line.get_xdata()) == 1]
    lines = [line for line in axes.lines if len(line.get_xdata()) > 1]
    assert len(marks) == len(lines) == 3
    for mark, line in zip(marks, lines):
        (at,), (height,) = mark.get_xdata(), mark.get_ydata()
        step = np.searchsorted(line.get_xdata(), at, side="right") - 1
        assert line.get_ydata()[step] == height
