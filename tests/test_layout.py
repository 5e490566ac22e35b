"""Every artefact of the papers' trees of scale smoke (`make smoke`), and the experiments behind it,
beside what the papers' texts tell of the printed one (`layout.yaml` of each study).
"""

import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pandas as pd
import pytest
from studies import built, studies

from bezierplan.planners.parts import chaotic_maps
from bezierplan.running import problems
from bezierplan.schema.model import convert_to_list, identify
from bezierplan.study.jobs import build_descriptions
from bezierplan.workspaces import files
from bezierplan.workspaces.circles import Circles

SMOKE = Path(__file__).parents[1] / "results/smoke"
PRINTED = Path(__file__).parent / "data" / "printed"
EVERY = [(key, name) for key, own in studies().items() for name in own.layout]
KINDS = {
    "map": {"workspace", "problem", "drawing"},
    "schematic": {"drawing", "paths"},
    "line plot": {"along_path", "lines"},
    "surface": {"surface", "landscape"},
}


def layout_of(study, name):
    return studies()[study].layout[name]


def rows_of(layout):
    return [*(layout.rows if isinstance(layout.rows, list) else layout.rows.values())]


def text(file):
    return pd.read_csv(file, dtype=str, keep_default_na=False)


def digits(cell):
    """Digits behind the point, and significant ones."""
    return len(cell.partition(".")[2]), len(cell.replace(".", "").lstrip("0"))


def faults(study, name, folder):
    """How the files of an artefact differ from its layout, in words."""
    layout = layout_of(study, name)
    if not list(folder.glob(f"{name}.*")):
        return ["there is none: run `make smoke` first"]
    return list((of_table if name.startswith("table") else of_figure)(layout, name, folder))


def of_table(layout, name, folder):
    columns = layout.form["columns"]
    odd = {tuple(where): n for *where, n in layout.form.get("odd", [])}
    kinds = ["", ".published"] if set(columns.values()) != {None} else [""]
    found = []
    for kind in kinds:
        table = text(folder / f"{name}{kind}.csv")
        heads = table.shape[1] - len(columns)
        labels = [": ".join(row) for row in table.iloc[:, :heads].itertuples(index=False)]
        if list(table)[heads:] != list(columns) or labels != rows_of(layout):
            yield f"{name}{kind}.csv: rows or columns"
            return
        printed_heads = [head or " " for head in layout.heads.values()]
        if printed_heads and list(table)[:heads] != printed_heads:
            yield f"{name}{kind}.csv: heads"
        found.append(table.iloc[:, heads:].set_axis(labels))
    if len(found) == 1:
        return
    ours, printed = found
    for (row, column), number in printed.stack().items():
        counted, own = columns[column] == "count", ours.loc[row, column]
        least = 0 if counted else columns[column]
        if number and digits(number)[0] != odd.get((row, column), least):
            yield f"{row}, {column}: {number} printed"
        if own and (digits(own)[0] < least or (float(own) and not counted and digits(own)[1] < 2)):
            yield f"{row}, {column}: {own}"
    for column, cells in ours.items():
        if len({digits(own)[0] for own in cells if own}) > 1:
            yield f"{column}: ragged digits"
    dashes = int((printed == "").to_numpy().sum())
    if dashes != layout.form.get("dashes", 0):
        yield f"{dashes} cells without a number"
    if len(text(folder / f"{name}.comparison.csv")) != printed.size - dashes:
        yield "the comparison has not one row for each number"


def drawn(svg):
    """The entries of a figure's legend in order, and by x, y and z the words at each such axis: its
    name first, then its ticks.
    """
    legend, axes = [], {"x": [], "y": [], "z": []}
    for group in ET.parse(svg).getroot().findall(".//{*}g"):
        kind, _, number = group.get("id", "").rpartition("_")
        if kind == "legend":
            legend += words(group)
        if kind == "matplotlib.axis":
            axes["yx"[int(number) % 2]].append(named(group))
        if kind == "axis3d":
            axes["xyz"[int(number) - 1]].append(named(group))
    return legend, axes


def words(group):
    return [each.text for each in group.findall(".//{*}text") if each.text]


def named(axis):
    """The words at an axis."""
    own = [part for part in axis if part.get("id", "").startswith("text")]
    name = " ".join(word for part in own for word in words(part))
    return [name, *words(axis)]


def of_figure(layout, name, folder):
    panels = text(folder / f"{name}.csv")["panel"].nunique()
    if panels != layout.form.get("panels", panels):
        yield f"{panels} panels"
    legend, axes = drawn(folder / f"{name}.svg")
    for axis, given in layout.axes.items():
        for number, word in enumerate(given):
            unit = layout.units.get(axis, [])[number:][:1]
            fits = [seen for seen in axes[axis] if re.match(rf"{re.escape(word)}( \(|$)", seen[0])]
            if not fits:
                yield f"no {axis} axis of {word}"
            for seen in fits if unit else []:
                in_name, in_ticks = (
                    f"({unit[0]})" in seen[0],
                    any(re.search(rf"[0-9] ?[munµ]?{unit[0]}$", tick) for tick in seen),
                )
                if not in_name and not in_ticks:
                    yield f"{word}: not in {unit[0]}: {seen}"
    if "words" in layout.form:
        cells = text(folder / f"{name}.csv")["text"]
        if (seen := sorted({cell for cell in cells if cell.isalpha()})) != layout.form["words"]:
            yield f"words: {seen}"
    series = [*layout.names.values()] if isinstance(layout.series, dict) else layout.series
    if len(series) > 1 and legend[: len(series)] != series:
        at_axis = any(series == seen[1:][: len(series)] for seen in axes["x"])
        if not at_axis:
            yield f"series: {legend}"
    others = [entry for entry in legend if entry not in series and not re.match(OURS, entry)]
    if others:
        yield f"series that print does not have: {others}"


# What a legend explains beside the series of print.
OURS = re.compile(
    r"start|target|obstacle|occupied cell|surplus cell|control points|height \d|cut\b|95 % "
    r"interval|hollow|published|outlier|mean|largest magnitude|last position|local minimum|"
    r"lowest value|fixed control point|first collision|nodes"
)


@pytest.mark.parametrize(("study", "name"), EVERY)
def test_an_artefact_has_the_form_of_the_printed_one(study, name):
    assert faults(study, name, SMOKE / study / "paper") == []


def test_a_paper_has_exactly_these_artefacts():
    for own in studies().values():
        assert set(own.list_names("paper")) == set(own.layout)


def behind(own, name):
    """What an artefact shows: experiments with the selection of their runs, workspaces and
    problems.
    """
    spec = own.tables.get(name) or own.figures[name]
    for part in getattr(spec, "panels", [spec]):
        if experiment := getattr(part, "experiment", None):
            yield experiment, part.where | getattr(part, "primary", {})
        for kind in ("workspace", "problem"):
            if home := getattr(part, kind, None):
                yield None, {kind: home}


def facts(own, experiment, where):
    """Name and value of everything that print can say of the runs behind an artefact."""
    if "problem" in where and experiment is None:
        plain = own.every_problem()[where["problem"]]
        if plain.get("route") in (where.get("route"), None) or "route" not in where:
            yield from plain.items()
            described = build_descriptions(own, {"it": plain})
            made, _ = problems.build_all(described, own.folder)
            yield from of_workspace(made["it"].workspace)
        return
    if experiment is None:
        yield from of_workspace(files.load(own.workspaces[where["workspace"]].plain(), own.folder))
        return

    def selected(column, value):
        return column not in where or value in convert_to_list(where[column])

    content, layouts, homes = own.experiments[experiment], set(), set()
    for problem, plain in own.problems_of(experiment, "full").items():
        if not all(selected(*each) for each in [*plain.items(), ("problem", problem)]):
            continue
        yield from plain.items()
        yield "grids", f"{plain.get('start_cell')} to {plain.get('target_cell')}"
        layouts.add(plain.get("layout"))
        if plain["workspace"] not in homes:
            homes.add(plain["workspace"])
            yield from of_workspace(built(own, experiment, problem).workspace)
        for method in filter(lambda name: selected("method", name), content.methods):
            settings = own.resolve_settings(method) | plain.get("settings", {})
            for factor, values in content.vary.items():
                settings.pop(factor, None)
                for value in filter(lambda value: selected(factor, value), values):
                    yield factor, value
            yield from settings.items()
    yield "runs", content.repeats["full"] * len(layouts)


def of_workspace(home):
    """What print can say of a workspace."""
    if isinstance(home, Circles):
        yield from [("circles", len(home.centres)), ("bounds", [*home.bounds])]
    else:
        rows, columns = home.occupied.shape
        # From the middles of the first cells to those of the last.
        yield "size", f"{(columns - 1) * home.cell:.1f} x {(rows - 1) * home.cell:.1f}"
        yield "cells", f"{columns} x {rows}"
        yield from [("cell", home.cell), ("cover", 100 * home.occupied.mean())]


def of_drawing(own, name):
    """Name and value of everything that print can say of a figure that shows no runs."""
    for panel in getattr(own.figures.get(name), "panels", []):
        yield from panel.plain().get("arguments", {}).items()
        if panel.plain().get("data") == "chaotic_sequences":
            constants = vars(chaotic_maps).items()
            yield from ((key.lower(), value) for key, value in constants if key.isupper())
        if published := panel.plain().get("published"):
            marks = pd.read_csv(own.folder / "published" / f"{published}.csv")
            yield "obstacles", int((marks["mark"] == "circle").sum())
            if "candidate" in marks:
                yield "candidates", marks["candidate"].nunique()
                rings = marks[marks["group"].astype(str).str.startswith("ring")].groupby("group")[
                    "x"
                ]
                yield from (("r", round(float(r), 9)) for r in (rings.max() - rings.min()) / 2)
            if "part" in marks:
                genes = marks.loc[marks["part"] == "genes", "text"].dropna()
                yield "genes", [int(gene) for gene in genes if gene.isdecimal()]


def unmet(own, name, conditions, where):
    """Printed conditions that what is behind an artefact does not have: name, print and ours. A
    condition that is named like a method or a route is of its runs alone.
    """
    every = [fact for place, only in behind(own, name) for fact in facts(own, place, only | where)]
    every += of_drawing(own, name)
    for key, printed in conditions.items():
        if isinstance(printed, dict):
            column = "method" if key in own.methods else "route"
            yield from unmet(own, name, printed, where | {column: key})
            continue
        values = [value for fact, value in every if fact == key]
        whole = any(isinstance(value, list) for value in values)
        expected = [printed] if whole or not isinstance(printed, list) else printed
        if {*map(identify, values)} != {*map(identify, expected)}:
            yield key, printed, values


@pytest.mark.parametrize(("study", "name"), [each for each in EVERY if layout_of(*each).conditions])
def test_runs_behind_an_artefact_have_the_conditions_of_print(study, name):
    assert list(unmet(studies()[study], name, layout_of(study, name).conditions, {})) == []


FIGURES = [each for each in EVERY if each[1].startswith("figure")]


@pytest.mark.parametrize(("study", "name"), FIGURES)
def test_a_figure_has_the_kind_of_the_printed_one(study, name):
    figure, layout = studies()[study].figures[name], layout_of(study, name)
    for panel in figure.panels:
        if kind := layout.form.get("kind"):
            assert panel.kind in KINDS.get(kind, {kind})
        assert not getattr(panel, "context", False), "nothing but what the paper draws"


NUMBERS = [
    (study, name)
    for study, name in EVERY
    if name.startswith("table") and None not in layout_of(study, name).form["columns"].values()
]


@pytest.mark.parametrize(("study", "name"), NUMBERS)
def test_printed_numbers_are_those_of_a_second_transcription(study, name):
    """tests/data/printed has the tables in the layout of the papers, taken from the papers a second
    time.
    """
    own, layout = studies()[study], layout_of(study, name)
    block = (PRINTED / f"{study}.txt").read_text(encoding="utf-8").split(f"[{name}]\n")[1]
    count = len(layout.form["columns"])
    wanted = [
        [cell.strip().replace("—", "").replace(",", ".") for cell in line.split("|")[-count:]]
        for line in block.split("\n\n")[0].splitlines()
    ]
    laid = text(SMOKE / study / "paper" / f"{name}.published.csv").iloc[:, -count:]
    numbers = text(own.find_published_file(name))
    assert laid.to_numpy().tolist() == wanted
    assert len(numbers) == sum(map(len, wanted)) - layout.form.get("dashes", 0)
