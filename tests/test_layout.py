"""Every artefact of the papers' trees of scale smoke (`make smoke`) beside what the papers' texts
tell of the form of the printed one.
"""

import re
import shutil
from pathlib import Path

import pandas as pd
import pytest
import yaml
from studies import studies

SMOKE = Path(__file__).parents[1] / "results/smoke"
DATA = Path(__file__).parent / "data"
LAYOUTS = yaml.safe_load((DATA / "layouts.yaml").read_text(encoding="utf-8"))
EVERY = [(study, name) for study, artefacts in LAYOUTS.items() for name in artefacts]
# What a quantity of the papers is called on our axes or above our panels, where the word differs.
WORDS = {
    "average path length": "mean length",
    "average smoothness": "bending",
    "average running time": "CPU time",
    "average total computation time": "CPU time",
    "best fitness": "objective",
    "chaotic map": "method",
    "chaotic value": "value",
    "column of cells": "",  # cells are numbered
    "computing time": "CPU time",
    "fitness": "objective",
    "mean of the best fitness": "mean objective",
    "number of control points n": "control points",
    "number of iterations": "iterations",
    "number of particles": "particles",
    "objective value (1 / fitness)": "objective",
    "path length": "length",
    "position": "x",
    "row of cells": "",
}
KINDS = {
    "map": {"workspace", "paths", "drawing"},
    "schematic": {"drawing", "paths"},
    "line plot": {"along_path"},
    "surface": {"surface", "landscape"},
}


def text(file):
    return pd.read_csv(file, dtype=str, keep_default_na=False)


def digits(cell):
    """Digits behind the point, and significant ones."""
    return len(cell.partition(".")[2]), len(cell.replace(".", "").lstrip("0"))


def faults(study, name, folder):
    """How the files of an artefact differ from its layout, in words."""
    layout = LAYOUTS[study][name]
    files = sorted(folder.glob(f"{name}.*"))
    if not files:
        return ["there is none: run `make smoke` first"]
    return list((of_table if name.startswith("table") else of_figure)(layout, name, folder))


def of_table(layout, name, folder):
    columns, odd = layout["columns"], {tuple(where): n for *where, n in layout.get("odd", [])}
    kinds = ["", ".published"] if set(columns.values()) != {None} else [""]
    found = []
    for kind in kinds:
        table = text(folder / f"{name}{kind}.csv")
        heads = table.shape[1] - len(columns)
        labels = [": ".join(row) for row in table.iloc[:, :heads].itertuples(index=False)]
        if list(table)[heads:] != list(columns) or labels != layout["rows"]:
            yield f"{name}{kind}.csv: rows or columns"
            return
        found.append(table.iloc[:, heads:].set_axis(labels))
    if len(found) == 1:
        return
    ours, printed = found
    for (row, column), number in printed.stack().items():
        counted, own = columns[column] == "count", ours.loc[row, column]
        least = 0 if counted else columns[column]
        if number and digits(number)[0] != odd.get((row, column), least):
            yield f"{row}, {column}: {number} printed"
        if own and (digits(own)[0] < least or (float(own) and not counted and digits(own)[1] < 3)):
            yield f"{row}, {column}: {own}"
    dashes = int((printed == "").to_numpy().sum())
    if dashes != layout.get("dashes", 0):
        yield f"{dashes} cells without a number"
    if len(text(folder / f"{name}.comparison.csv")) != printed.size - dashes:
        yield "the comparison has not one row for each number"


def of_figure(layout, name, folder):
    panels = text(folder / f"{name}.csv")["panel"].nunique()
    if panels != layout.get("panels", panels):
        yield f"{panels} panels"
    drawn = re.findall(r"<text[^>]*>([^<]+)", (folder / f"{name}.svg").read_text(encoding="utf-8"))
    axes = layout.get("x", []) + layout.get("y", [])
    for quantity in [] if "differs" in layout else axes:
        word = WORDS.get(quantity, quantity.removeprefix("position ").partition(" of ")[0])
        if not any(re.search(rf"(^|\W){word}", label) for label in drawn):
            yield f"no axis of {quantity}"


@pytest.mark.parametrize(("study", "name"), EVERY)
def test_an_artefact_has_the_form_of_the_printed_one(study, name):
    assert faults(study, name, SMOKE / study / "paper") == []


@pytest.mark.parametrize("study", LAYOUTS)
def test_a_paper_has_exactly_these_artefacts(study):
    own = studies()[study]
    assert set(own.named("paper")) == set(LAYOUTS[study])


def without_a_row(file):
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:-1]))


def without_a_digit(file):
    file.write_text(file.read_text().rstrip("\n")[:-1] + "\n")


def without_a_panel(file):
    rows = text(file)
    rows[rows["panel"] != rows["panel"].iloc[-1]].to_csv(file, index=False)


@pytest.mark.parametrize(
    ("name", "ending", "spoil"),
    [
        *(
            ("table1", ending, without_a_row)
            for ending in ("csv", "published.csv", "comparison.csv")
        ),
        *(("table1", ending, without_a_digit) for ending in ("csv", "published.csv")),
        ("figure4", "csv", without_a_panel),
    ],
)
def test_a_row_a_digit_or_a_panel_that_is_taken_away_is_seen(tmp_path, name, ending, spoil):
    for file in (SMOKE / "song2016/paper").glob(f"{name}.*"):
        shutil.copy(file, tmp_path)
    assert faults("song2016", name, tmp_path) == []
    spoil(tmp_path / f"{name}.{ending}")
    assert faults("song2016", name, tmp_path)


FIGURES = [each for each in EVERY if each[1].startswith("figure")]


@pytest.mark.parametrize(("study", "name"), FIGURES)
def test_a_figure_has_the_kind_and_the_methods_of_the_printed_one(study, name):
    figure, layout = studies()[study].figures[name], LAYOUTS[study][name]
    assert figure.mirrors.startswith("In print: ")
    for panel in figure.panels:
        if kind := layout.get("kind"):
            assert panel.kind in KINDS.get(kind, {kind})
        across = getattr(panel, "hue", None) or getattr(panel, "by", None)
        series = getattr(panel, "where", {}).get(across)
        assert len(series or []) in (0, layout.get("series", len(series or [])))
        assert not getattr(panel, "context", False), "nothing but what the paper draws"


NUMBERS = [
    (study, name)
    for study, name in EVERY
    if name.startswith("table") and None not in LAYOUTS[study][name]["columns"].values()
]


@pytest.mark.parametrize(("study", "name"), NUMBERS)
def test_printed_numbers_are_those_of_a_second_transcription(study, name):
    """tests/data/printed has the tables in the layout of the papers, taken from the papers a second
    time.
    """
    own, layout = studies()[study], LAYOUTS[study][name]
    block = (DATA / "printed" / f"{study}.txt").read_text(encoding="utf-8").split(f"[{name}]\n")[1]
    count = len(layout["columns"])
    wanted = [
        [cell.strip().replace("—", "").replace(",", ".") for cell in line.split("|")[-count:]]
        for line in block.split("\n\n")[0].splitlines()
    ]
    laid = text(SMOKE / study / "paper" / f"{name}.published.csv").iloc[:, -count:]
    numbers = text(own.published_file(name))
    assert laid.to_numpy().tolist() == wanted
    assert len(numbers) == sum(map(len, wanted)) - layout.get("dashes", 0)
