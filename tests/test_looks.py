"""Looks in print: faint colours, methods that look alike or change their look; and what panels that
compare all planners say.
"""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from studies import studies

from bezierplan.figures import style
from bezierplan.study import jobs

STUDIES = studies()

# Contrasts that the Web Content Accessibility Guidelines 2.1 ask for, of marks and of small text
# (criteria 1.4.11 and 1.4.3).
MARK, TEXT = 3.0, 4.5


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
    marks = [mark for _, _, mark in style.LOOKS.values()]
    assert len(set(marks)) == len(marks)
    for look in style.choose_line_styles([float(number) for number in range(10)], {}):
        assert contrast(look["color"]) >= MARK, look
    for colour in (style.RED, style.BLUE, style.BLACK):
        assert contrast(colour) >= TEXT - 0.5, colour
    assert contrast(style.BLACK, style.OCCUPIED) >= MARK, "words on occupied cells"


@pytest.mark.parametrize("name", STUDIES)
def test_methods_side_by_side_look_different(name):
    looks = jobs.choose_looks(STUDIES[name])
    for key, figure in STUDIES[name].figures.items():
        for panel in figure.panels:
            where = getattr(panel, "where", None) or {}
            methods = where.get("method")
            if isinstance(methods, list):
                own = [
                    (look["color"], look["marker"])
                    for look in style.choose_line_styles(methods, looks)
                ]
                assert len(set(own)) == len(own), (key, dict(zip(methods, own)))


def test_a_chaotic_map_has_one_colour_in_twin_figures():
    own = STUDIES["tharwat2018"]
    colours = []
    for name in ("figure8", "figure9"):
        methods = own.figures[name].panels[0].where["method"]
        looks = style.choose_line_styles(methods, jobs.choose_looks(own))
        colours.append(
            [
                (look["color"], own.layout[name].names[method])
                for look, method in zip(looks, methods)
            ]
        )
    assert colours[0] == colours[1]


def test_a_method_looks_alike_in_all_studies():
    """Methods of one name, such as baselines and rivals, and methods of another study that one
    borrows.
    """
    looks = {name: jobs.choose_looks(study) for name, study in STUDIES.items()}
    for one, other in itertools.combinations(looks.values(), 2):
        for method in one.keys() & other.keys():
            assert one[method] == other[method], method
    for method in ("song2016_smooth", "ma2020_bca", "meledje_proposed"):
        paper, _, own = method.partition("_")
        assert looks["elhoseny2017"][method] == looks[paper][own]


def test_looks_are_declared_once_or_follow_the_planner():
    planners = {
        "mine": "mine.py",
        "other": "other.py",
        "rounded": "rounded_shortest_path",
        "declared": "prm",
    }
    looks = style.choose_looks(planners, {"declared": "sky"})
    assert looks["rounded"] == "black"
    assert looks["declared"] == "sky"
    assert len(set(looks.values())) == 4, (
        "two without a declaration get looks that no other method has"
    )
    twice = style.choose_line_styles(["a", "b"], {"a": "blue", "b": "blue"})
    assert twice[0]["color"] != twice[1]["color"], "two lines in one panel are never alike"
