"""Bad input for ma2020: every fault of its maps and of its methods' settings ends in one line
before the first run.
"""

import shutil
from pathlib import Path

import pytest
from faults import told

FOLDER = Path(__file__).parents[1] / "config" / "studies" / "ma2020"
EXPERIMENTS, MAP = "experiments.yaml", "workspaces/environment1.txt"


@pytest.fixture
def folder(tmp_path):
    """A copy of the study to be spoilt."""
    return Path(shutil.copytree(FOLDER, tmp_path / "ma2020"))


FAULTS = {
    "an unknown character": (
        MAP,
        "..#.",
        "..x.",
        "environment1.txt: line 1: unknown character 'x'; a cell is . (free) or # (occupied)",
    ),
    "a ragged line": (
        MAP,
        "..#.",
        "..#",
        "environment1.txt: line 2 has 20 cells, the first line has 19",
    ),
    "a start outside the map": (
        EXPERIMENTS,
        "start: [0, 0]",
        "start: [-1, 0]",
        "start: [-1, 0]: outside the workspace",
    ),
    "a target in an obstacle": (
        EXPERIMENTS,
        "target: [20, 20]",
        "target: [2.5, 19.5]",
        "target: [2.5, 19.5]: in an obstacle",
    ),
    "an odd population": (
        EXPERIMENTS,
        "population: 100 ",
        "population: 99 ",
        "population: 99; parents are crossed in pairs",
    ),
    "a population of none": (
        EXPERIMENTS,
        "population: 100 ",
        "population: 0 ",
        "population: 0; expected a whole number at least 2",
    ),
    "generations below 0": (
        EXPERIMENTS,
        "generations: 50 ",
        "generations: -1 ",
        "generations: -1; expected a whole number at least 0",
    ),
    "a probability above 1": (
        EXPERIMENTS,
        "crossover_probability: 0.9",
        "crossover_probability: 1.9",
        "1.9; expected a number from 0 to 1",
    ),
    "a safety distance below 0": (
        EXPERIMENTS,
        "safety_distance: 0.25",
        "safety_distance: -0.25",
        "-0.25; expected a number at least 0",
    ),
    "no ants": (
        EXPERIMENTS,
        "  ants: 20\n",
        "  ants: 0\n",
        "ants: 0; expected a whole number at least 1",
    ),
    "no iterations": (
        EXPERIMENTS,
        "iterations: 50 ",
        "iterations: 0 ",
        "iterations: 0; expected a whole number at least 1",
    ),
    "an evaporation above 1": (
        EXPERIMENTS,
        "  evaporation: 0.1\n",
        "  evaporation: 1.1\n",
        "evaporation: 1.1; expected a number from 0 to 1",
    ),
    "an unknown rule for corners": (
        EXPERIMENTS,
        "  corners: one\n",
        "  corners: two\n",
        "corners: 'two'; expected one of free, one, none",
    ),
    "an unknown coding": (
        EXPERIMENTS,
        "coding: rows",
        "coding: row",
        "coding: 'row'; expected one of via_cells, rows",
    ),
    "no fish": (
        EXPERIMENTS,
        "  fish: 20\n",
        "  fish: 0\n",
        "fish: 0; expected a whole number at least 1",
    ),
    "half a try": (
        EXPERIMENTS,
        "  tries: 8\n",
        "  tries: 0.5\n",
        "tries: 0.5; expected a whole number",
    ),
    "a map of blocks without a side": (
        EXPERIMENTS,
        "workspace: blocks60, side: 20,",
        "workspace: blocks60,",
        "blocks60: side is needed",
    ),
    "a target outside a map of blocks": (
        EXPERIMENTS,
        "side: 20, start: [0, 0], target: [20, 20]",
        "side: 20, start: [0, 0], target: [20, 21]",
        "target: [20, 21]: outside the map; expected x and y from 0 to 20",
    ),
    "more cells than blocks can occupy": (
        EXPERIMENTS,
        "obstacles: [60]",
        "obstacles: [390]",
        "obstacles: 390: of 500 maps none has so many",
    ),
    "blocks of no cell": (
        EXPERIMENTS,
        "largest_block: 4",
        "largest_block: 0",
        "largest_block: 0: expected the most cells of a block's side",
    ),
    "blocks without a rule for corners": (
        EXPERIMENTS,
        "corners: none, lattice_length: 31.2132",
        "lattice_length: 31.2132",
        "corners: missing",
    ),
}


@pytest.mark.parametrize("fault", FAULTS, ids=str)
def test_a_fault_is_told_in_one_line(fault, folder):
    name, old, new, expected = FAULTS[fault]
    assert expected in told(folder / name, old, new, folder)
