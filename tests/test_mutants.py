"""The mutants of tests/mutants: each can still be planted, and the test that must catch it
exists. `make mutants` runs them.
"""

import ast

import pytest
from mutants import run

MUTANTS = run.load()


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda each: each.fault)
def test_a_fault_can_be_planted(mutant):
    assert run.planted(mutant) != (run.ROOT / mutant.file).read_text(encoding="utf-8")
    if mutant.file.endswith(".py"):
        ast.parse(run.planted(mutant))
    file, _, name = mutant.test.partition("::")
    tests = {
        node.name
        for node in ast.parse((run.ROOT / file).read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    }
    assert name.partition("[")[0] in tests


def test_faults_are_many_and_each_is_described_once():
    assert len(MUTANTS) >= 60
    assert len({mutant.fault for mutant in MUTANTS}) == len(MUTANTS)
