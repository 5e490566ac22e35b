"""Bad input: every fault of a study's files ends in one line before the first run."""

import shutil
from pathlib import Path

import pytest
from faults import told

from bezierplan.schema import checked

DATA, STUDIES = Path(__file__).parent / "data", Path(__file__).parents[1] / "config" / "studies"
FAULTS = {
    f"{study}: {name}": (study, *fault)
    for study, faults in checked.read(DATA / "faults.yaml").items()
    for name, fault in faults.items()
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_in_one_line(name, tmp_path):
    study, file, old, new, expected = FAULTS[name]
    home = STUDIES if (STUDIES / study).exists() else DATA
    folder = Path(shutil.copytree(home / study, tmp_path / study))
    message = told(folder / file, old, new, folder)
    assert expected in message
    assert Path(file).name in message
