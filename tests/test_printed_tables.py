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


def test_example_and_maps_of_elhoseny2017():
    """The cells of tables of numbers are asked where they lie beside ours, in `test_layout`."""
    for table in ("table1", "table4"):
        rows = [list(row.values()) for row in transcribed("elhoseny2017", table)]
        assert rows == printed("elhoseny2017", table)


@pytest.mark.parametrize("number", [1, 2])
def test_the_text_of_ma2020_repeats_numbers_of_its_tables(number):
    rows, said = (
        {
            tuple(row[key] for key in ("workspace", "method", "metric", "statistic", "value"))
            for row in transcribed("ma2020", name)
            if row["workspace"] == f"environment{number}"
        }
        for name in (f"table{number}", "text_numbers")
    )
    assert said <= rows
    assert len(rows) == len(transcribed("ma2020", f"table{number}"))


@pytest.mark.parametrize("table", ["table2", "table3", "table4", "table5"])
def test_meledje_counts_out_of_100_trials(table):
    for _, *texts in printed("meledje", table):
        assert sum(int(text) for text in texts[:3]) == 100


# How many runs a number is of, and in which unit of length.
RUNS = {
    "elhoseny2017": ("10", "cell"),
    "ma2020": ("30", "cell"),
    "meledje": ("100", "cell"),
    "song2016": ("", "unit"),
    "tharwat2018": ("10", "m"),
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
    "ma2020/environment1": "334f3f839fe950b09d95bee6d60ec1d16929e700d0857da4019603fd64d72a92",
    "ma2020/environment2": "e71b322765f751c9f20c40f6442439ab5fa6de1d2dc147224051ec4f08da45fa",
    "meledje/env1_initial": "6b8b33a0d27f269694b8940139bb8d63d5befe699189dd14d2d6dc364667325d",
    "meledje/env1_modified": "497a6bbf570625621a7b709cef136e30e77b704e034fe733c0e6fd84f47e8a6a",
    "meledje/env2_initial": "08914ac402d2bad4883e4a4e837684d098444b7c6c84abeb842b424c442bc45e",
    "meledje/env2_modified": "a81fd6240106ffd784568baf251a6cd2be1d3ec4367eafd396aaba8685f71560",
}


@pytest.mark.parametrize("name", DIGESTS)
def test_maps_are_those_that_were_drawn(name):
    study, _, name = name.partition("/")
    content = (STUDIES / study / "workspaces" / f"{name}.txt").read_bytes()
    assert hashlib.sha256(content).hexdigest() == DIGESTS[f"{study}/{name}"]
