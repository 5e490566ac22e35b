"""What was transcribed by hand, held against a second form of it: tables as printed, what papers
say of them, maps as lists of blocks.

tests/data/printed has the tables in the layout of the papers, taken from the papers a second time.
A wrong digit, or two numbers that changed places, stands in one of the two transcriptions only.
"""

import hashlib
import itertools
from pathlib import Path as File

import numpy as np
import pandas as pd
import pytest

from bezierplan.workspaces.grid import from_lines

STUDIES = File(__file__).parents[1] / "config" / "studies"
PRINTED = File(__file__).parent / "data" / "printed"


def printed(study, table):
    """Rows of a table as printed: label and cells."""
    text = (PRINTED / f"{study}.txt").read_text(encoding="utf-8")
    block = text.split(f"[{table}]\n")[1].split("\n\n")[0]
    return [[cell.strip() for cell in line.split("|")] for line in block.splitlines()]


def transcribed(study, table):
    """Rows of a file of published numbers as text, so that a zero at the end counts: a dictionary
    each.
    """
    return pd.read_csv(
        STUDIES / study / "published" / f"{table}.csv", dtype=str, keep_default_na=False
    ).to_dict("records")


# How a label is called in config/.
METHODS = {
    "Proposed Method": "mga",
    "Random mutation": "random",
    "Mutation in Ref. [12]": "ref12",
    "Mutation in Ref. [21]": "ref21",
    "Proposed mutation": "proposed",
}
OBSTACLES = ("5", "10", "15", "20", "25")


def cells(study, table, keys, columns):
    """Set of (key columns, metric, statistic, text) of a printed table. keys: label -> values of
    the key columns; columns: as `COLUMNS`.
    """
    found = set()
    for label, *texts in printed(study, table):
        assert len(texts) == len(columns), label
        for column, text in zip(columns, texts):
            if text != "—":
                found.add((*keys(label), *column, text.replace(",", ".")))
    return found


def own(study, table, *keys):
    rows = [tuple(row[key] for key in (*keys, "value")) for row in transcribed(study, table)]
    assert len(set(rows)) == len(rows)
    return set(rows)


CASES = [(case, number) for case in ("case1", "case2") for number in OBSTACLES]
LENGTH_AND_TIME = [
    (metric, statistic) for metric in ("length", "cpu_s") for statistic in ("min", "max", "mean")
]
TRIALS = [("optimal", "count"), ("near_optimal", "count"), ("infeasible", "count")]
MEANS = [("objective", "mean"), ("generation_improved", "mean"), ("cpu_s", "mean")]
SWARMS = [("collisions_c", "mean"), ("rank", "mean"), ("objective", "mean")]
OF_METHOD = ("method", "metric", "statistic")


def method(label):
    """Others are called what they are, such as `cpso2_sine` for CPSO-II-Sine."""
    name = label.lower().replace("cpso-ii-", "cpso2_").replace("cpso-i-", "cpso1_")
    return (METHODS.get(label, name.replace("-", "_")),)


@pytest.mark.parametrize("table", ["table2", "table3"])
def test_lengths_of_elhoseny2017(table):
    found = own("elhoseny2017", table, "method", "route", "obstacles")
    assert found == cells("elhoseny2017", table, method, CASES)
    assert len(found) == 40


def test_times_of_elhoseny2017():
    columns = [(number,) for number in OBSTACLES]
    assert own("elhoseny2017", "table6", "method", "obstacles") == cells(
        "elhoseny2017", "table6", method, columns
    )
    found, name = set(), ""
    for label, statistic, *texts in printed("elhoseny2017", "table5"):
        name = label or name
        called = {"GA": "mga_plain", "Proposed Method": "mga"}[name]
        found |= {
            (called, number, {"Avg.": "mean", "STD": "std"}[statistic], text)
            for number, text in zip(OBSTACLES, texts)
        }
    assert own("elhoseny2017", "table5", "method", "obstacles", "statistic") == found


def test_example_and_maps_of_elhoseny2017():
    for table in ("table1", "table4"):
        rows = [list(row.values()) for row in transcribed("elhoseny2017", table)]
        assert rows == printed("elhoseny2017", table)


@pytest.mark.parametrize("number", [1, 2])
def test_tables_of_ma2020(number):
    table = f"table{number}"
    assert own("ma2020", table, *OF_METHOD) == cells("ma2020", table, method, LENGTH_AND_TIME)
    assert {row["workspace"] for row in transcribed("ma2020", table)} == {f"environment{number}"}
    # The text repeats some of them.
    rows = {
        tuple(row[key] for key in ("workspace", *OF_METHOD, "value"))
        for row in transcribed("ma2020", table)
    }
    said = {
        tuple(row[key] for key in ("workspace", *OF_METHOD, "value"))
        for row in transcribed("ma2020", "text_numbers")
    }
    assert {row for row in said if row[0] == f"environment{number}"} <= rows


@pytest.mark.parametrize(
    ("table", "problem"),
    [
        ("table2", "env1_initial"),
        ("table3", "env1_modified"),
        ("table4", "env2_initial"),
        ("table5", "env2_modified"),
    ],
)
def test_tables_of_meledje(table, problem):
    assert own("meledje", table, *OF_METHOD) == cells("meledje", table, method, TRIALS + MEANS)
    assert {row["problem"] for row in transcribed("meledje", table)} == {problem}
    # The paper counts out of 100 trials.
    assert [sum(int(text) for text in texts[:3]) for _, *texts in printed("meledje", table)] == [
        100
    ] * 4


def test_table_of_song2016():
    columns = [
        (way, metric)
        for way in ("nonsmooth", "smooth")
        for metric in ("generation_1pct", "objective")
    ]
    found = cells(
        "song2016",
        "table1",
        lambda label: (label.removeprefix("Grid ").replace(" to ", "_"),),
        columns,
    )
    assert own("song2016", "table1", "problem", "method", "metric") == found


@pytest.mark.parametrize(
    ("table", "prefix", "rows"), [("table3", "cpso1", 8), ("table4", "cpso2", 8), ("table5", "", 5)]
)
def test_tables_of_tharwat2018(table, prefix, rows):
    found = cells(
        "tharwat2018",
        table,
        lambda label: (f"{prefix}_{label.lower()}",) if prefix else method(label),
        SWARMS,
    )
    assert own("tharwat2018", table, *OF_METHOD) == found
    # The mean ranks of k methods add to k (k + 1) / 2: to 36 in Tables 3 and 4, up to rounding;
    # those of Table 5 do not add to 15.
    total = sum(float(texts[1]) for _, *texts in printed("tharwat2018", table))
    assert total == pytest.approx({"table3": 36.0, "table4": 36.1, "table5": 13.8}[table])
    assert len(found) == 3 * rows


def test_obstacles_of_tharwat2018():
    found = cells("tharwat2018", "table6", lambda label: (label,), SWARMS)
    assert own("tharwat2018", "table6", "obstacles", "metric", "statistic") == found


# How many runs a number is of, and in which unit of length.
RUNS = {
    "elhoseny2017": ("10", "cell"),
    "ma2020": ("30", "cell"),
    "meledje": ("100", "cell"),
    "song2016": ("", "unit"),
    "tharwat2018": ("10", "unit"),
}


@pytest.mark.parametrize("study", RUNS)
def test_numbers_of_runs_and_units(study):
    rows = [
        row
        for file in (STUDIES / study / "published").glob("table*.csv")
        for row in transcribed(study, file.stem)
        if "metric" in row
    ]
    runs, unit = RUNS[study]
    units = {
        "cpu_s": "s",
        "generation_1pct": "generation",
        "generation_improved": "generation",
        "collisions_c": "samples",
    }
    units |= dict.fromkeys(("objective", "length", "cells4"), unit)
    assert {row["n"] for row in rows} == {runs}
    assert all(row["unit"] == units.get(row["metric"], "-") for row in rows)


# Maps.


def test_free_cells_of_song2016_are_those_with_a_number():
    """Figure 2 prints the number of every free cell, and nothing in the others."""
    numbers = [
        [int(number) for number in line[0].split()] for line in printed("song2016", "figure2")
    ]
    lines = (STUDIES / "song2016/workspaces/figure2.txt").read_text().splitlines()
    free = np.flatnonzero(~from_lines(lines, 1.0, "cell").occupied).tolist()
    assert free == sorted(itertools.chain(*numbers))
    assert len(free) == 192
    # From the top row down, each with sixteen numbers.
    assert [{number // 16 for number in line} for line in numbers] == [
        {row} for row in range(15, -1, -1)
    ]


# The maps of meledje and ma2020 are printed as pictures only. Those here are our own design:
# SHA-256 of the files, noted when they were drawn.
DIGESTS = {
    "ma2020/environment1": "9abdd29a262538e6025466a9ab830e3bf959a1da490c78030dddbd4ae657d378",
    "ma2020/environment2": "93bbabb6d478511e7bedc6f51df4f2ed0c277bb99daed01ac86560ea4d7a8ff5",
    "meledje/env1_initial": "6b8b33a0d27f269694b8940139bb8d63d5befe699189dd14d2d6dc364667325d",
    "meledje/env1_modified": "497a6bbf570625621a7b709cef136e30e77b704e034fe733c0e6fd84f47e8a6a",
    "meledje/env2_initial": "bcfe338304cedaf30b0c0f72d242e0ef06e4fffbc14c2f92b8542e88031d97a2",
    "meledje/env2_modified": "c17b8ba01a5c1b5ebbb87eea9bef6d5c01fb098b290b570872c4519d5cafb793",
}


@pytest.mark.parametrize("name", DIGESTS)
def test_maps_are_those_that_were_drawn(name):
    study, _, name = name.partition("/")
    content = (STUDIES / study / "workspaces" / f"{name}.txt").read_bytes()
    assert hashlib.sha256(content).hexdigest() == DIGESTS[f"{study}/{name}"]
