"""Pictures in the page: figures made smaller, and the intervals of a claim's comparisons as
strips.
"""

import re
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

from bezierplan.figures.page.content import Comparison

# Coordinates are in points, so two decimals are finer than any screen or printer.
_TAG, _LONG_NUMBER = re.compile(r"<[^/>][^>]*>"), re.compile(r"-?\d+\.\d{3,}")
_HEAD = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<metadata>.*?</metadata>", re.DOTALL)
_STYLE, _CLIP, _ID, _OUTLINE = (
    re.compile(rf'\b{name}="([^"]*)"') for name in ("style", "clip-path", "id", "d")
)
_STEP, _REFERENCE = re.compile(r"([A-Za-z])([^A-Za-z]*)"), re.compile(r'(?:url\(|href=")#([^)"]*)')
# What may not stand in a quoted attribute as part of a data URI.
_UNSAFE = re.compile(r"""[^-.\w /:;,=<>()'!*@$+?\[\]{}|^`~]""", re.ASCII)


def data_uri(file: Path) -> str:
    """An svg file as the address of an image that needs no other file.

    It says the same in fewer letters, without a minifier, which would take a second and more for
    each figure: each style once, outlines by their steps, short numbers and names, no metadata.
    """
    text = _HEAD.sub("", file.read_text(encoding="utf-8"))
    names = {
        name: f"n{number}" for number, name in enumerate(dict.fromkeys(_REFERENCE.findall(text)))
    }
    styles: dict[str, str] = {}

    def classed(rules: str) -> str:
        return f'class="{styles.setdefault(rules, f"s{len(styles)}")}"'

    def shorter(tag: re.Match) -> str:
        text = tag.group()
        if ' d="' in text:
            text = _OUTLINE.sub(lambda found: f'd="{_stepwise(found.group(1))}"', text)
        if "#" in text:
            clip = _CLIP.search(text)
            if clip and _STYLE.search(text):
                text = _STYLE.sub(
                    lambda found: f'style="{found.group(1)}; clip-path: {clip.group(1)}"',
                    _CLIP.sub("", text),
                )
            text = _REFERENCE.sub(
                lambda found: found.group().replace(
                    f"#{found.group(1)}", f"#{names[found.group(1)]}"
                ),
                text,
            )
        if 'id="' in text:
            text = _ID.sub(
                lambda found: f'id="{names[found.group(1)]}"' if found.group(1) in names else "",
                text,
            )
        if "style=" in text:
            text = _STYLE.sub(lambda found: classed(found.group(1)), text)
        text = (
            " ".join(_LONG_NUMBER.sub(_rounded, text).split())
            .replace(" >", ">")
            .replace(" />", "/>")
        )
        return text if "'" in text else text.replace('"', "'")

    text = _TAG.sub(shorter, text)
    rules = "".join(f".{name}{{{rule}}}" for rule, name in styles.items())
    text = text.replace("</style>", f"{rules}</style>", 1)
    return "data:image/svg+xml," + _UNSAFE.sub(
        lambda letter: quote(letter.group(), safe=""), re.sub(r">\s+<", "><", text.strip())
    )


@lru_cache(maxsize=10_000)  # the outlines of letters and marks come back in every figure
def _stepwise(outline: str) -> str:
    """An outline whose steps (M, L, Q, C and z, each with its name) are relative, in hundredths
    that add up without drift.
    """
    parts, x, y, first = [], 0, 0, (0, 0)
    for name, numbers in _STEP.findall(outline):
        places = [round(100 * float(each)) for each in numbers.split()]
        if not places:
            x, y = first
            parts.append(name)
            continue
        moved = [place - (y if n % 2 else x) for n, place in enumerate(places)]
        x, y = places[-2:]
        first = (x, y) if name == "M" else first
        if name == "L" and 0 in moved:
            name, moved = ("h", moved[:1]) if moved[1] == 0 else ("v", moved[1:])
        parts.append(name.lower() + "".join(map(_hundredths, moved)).lstrip(" "))
    return "".join(parts)


@lru_cache(maxsize=100_000)
def _hundredths(value: int) -> str:
    """A number of hundredths as short as svg allows: a sign separates it from the number before,
    otherwise a space does.
    """
    whole, rest = divmod(abs(value), 100)
    decimals = f".{rest:02d}".rstrip("0") if rest else ""
    return ("-" if value < 0 else " ") + (f"{whole or ''}{decimals}" or "0")


def size(file: Path) -> tuple[int, int]:
    """Width and height of an svg file, in points."""
    head = file.read_text(encoding="utf-8")[:2000]
    width, height = (
        float(re.search(rf'\b{name}="([\d.]+)pt"', head).group(1)) for name in ("width", "height")
    )
    return round(width), round(height)


def _rounded(number: re.Match) -> str:
    return f"{float(number.group()):.2f}".rstrip("0").rstrip(".")


class Strip(NamedTuple):
    """A comparison of a forest plot, all of whose strips share one scale from 0 to 100; None where
    there is nothing to draw.

    low, high: ends of the interval. cut: whether an end lies beyond the strip. margin: the two ends
    of the effects that do not matter. printed: the effect in the paper's own numbers.
    """

    comparison: Comparison
    zero: float
    effect: float | None
    low: float | None
    high: float | None
    cut: bool
    margin: tuple[float, float] | None
    printed: float | None


class Forest(NamedTuple):
    """Comparisons of one check, on one scale."""

    test: str
    metric: str
    statistic: str
    unit: str
    deciding: bool
    strips: list[Strip]


def forests(comparisons: Sequence[Comparison]) -> list[Forest]:
    """Comparisons by check and metric, in order."""
    groups: dict[tuple, list[Comparison]] = {}
    for each in comparisons:
        groups.setdefault(
            (each.check, each.test, each.metric, each.statistic, each.unit, each.deciding), []
        ).append(each)
    return [Forest(*key[1:], _strips(own)) for key, own in groups.items()]


def _strips(comparisons: Sequence[Comparison]) -> list[Strip]:
    """Comparisons on one scale, which holds every effect, also the printed ones, and intervals up
    to three times the largest.
    """
    effects = [
        effect
        for each in comparisons
        for effect in (each.effect, each.effect_published)
        if effect is not None
    ]
    most = 3 * max(map(abs, effects), default=0.0) or 1.0
    ends = [end for each in comparisons for end in each.interval if end is not None]
    reach = [
        *(each.reference for each in comparisons),
        *effects,
        *(min(max(end, -most), most) for end in ends),
    ]
    low, high = min(reach), max(reach)
    pad = 0.06 * (high - low) or 1.0
    low, high = low - pad, high + pad

    def place(value: float | None) -> float | None:
        if value is None:
            return None
        return round(100 * (min(max(value, low), high) - low) / (high - low), 2)

    return [
        Strip(
            each,
            *map(place, (each.reference, each.effect, *each.interval)),
            any(end is not None and not low <= end <= high for end in each.interval),
            (place(-abs(each.margin)), place(abs(each.margin))) if each.margin else None,
            place(each.effect_published),
        )
        for each in comparisons
    ]
