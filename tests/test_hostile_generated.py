"""Hostile input that nobody thought of: files of a study and maps, cut, doubled and strewn with
other characters by a generator.

Each is read, or ends in one line that names its file; nothing else may happen.
"""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.schema import checked, model
from bezierplan.schema.checked import Fault
from bezierplan.study.artefacts import ArtefactsFile
from bezierplan.study.claims import AssumptionsFile, ClaimsFile
from bezierplan.study.experiments import ExperimentsFile
from bezierplan.workspaces import files

STUDIES = Path(__file__).parents[1] / "config" / "studies"
MODELS = {
    "experiments": ExperimentsFile,
    "artefacts": ArtefactsFile,
    "claims": ClaimsFile,
    "assumptions": AssumptionsFile,
}
WORDS = [
    *"{}[]:\n'\"\t\0\u202e#",
    ": ",
    "- ",
    "\n  ",
    "&a ",
    "*a",
    "!!x ",
    "null",
    "-1",
    "1e999",
    ".nan",
]
JSON_WORDS = [*'{}[],:"0\0\u202e', "null", "-1", "1e999", "NaN", '"type"', "[[0,0],[1,1]]"]


def spoilt(text, words):
    """A text with up to four places changed: a piece removed, doubled, or a word put in."""

    @st.composite
    def draw_one(draw):
        result = text
        for _ in range(draw(st.integers(1, 4))):
            first = draw(st.integers(0, max(len(result) - 1, 0)))
            last = min(first + draw(st.integers(0, 40)), len(result))
            new = draw(st.sampled_from(["", result[first:last] * 2, *words]))
            result = result[:first] + new + result[last:]
        return result

    return draw_one()


def one_line(caught, name):
    message = str(caught)
    assert message.isprintable()
    assert name in message
    assert len(message) < 3000


@pytest.mark.parametrize("name", MODELS)
def test_spoilt_file_of_a_study(name):
    text = (STUDIES / "song2016" / f"{name}.yaml").read_text()

    @given(spoilt(text, WORDS))
    def told(content):
        try:
            model.parse(MODELS[name], checked.parse(content, f"{name}.yaml"), f"{name}.yaml")
        except Fault as fault:
            one_line(fault, f"{name}.yaml")

    told()


@pytest.mark.parametrize(
    ("source", "kind"),
    [
        ("elhoseny2017/workspaces/gaps.geojson", {"kind": "polygons"}),
        ("song2016/workspaces/figure2.txt", {"kind": "grid", "cell": 1.0}),
    ],
)
def test_spoilt_map(source, kind, tmp_path):
    text, file = (STUDIES / source).read_text(), tmp_path / Path(source).name
    words = JSON_WORDS if file.suffix == ".geojson" else WORDS

    @given(spoilt(text, words))
    def told(content):
        file.write_text(content, encoding="utf-8", newline="")
        try:
            files.load({**kind, "file": file.name, "unit": "m"}, tmp_path)
        except ValueError as fault:
            one_line(fault, file.name)

    told()
