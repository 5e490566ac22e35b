"""The environment of the rules where Snakemake deploys software with conda: its versions are those
of environment.txt.
"""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.rare

ROOT = Path(__file__).parents[1]
ENVIRONMENT = ROOT / "workflow" / "envs" / "bezierplan.yaml"


def pinned() -> dict[str, str]:
    packages = yaml.safe_load(ENVIRONMENT.read_text(encoding="utf-8"))["dependencies"][-1]["pip"]
    return dict(package.split("==") for package in packages)


def test_versions_are_those_of_the_locked_environment():
    text = (ROOT / "environment.txt").read_text(encoding="utf-8")
    locked = dict(re.findall(r"^([\w.-]+)==([\w.]+)", text, re.MULTILINE))
    assert {name: locked.get(name) for name in pinned()} == pinned()


def test_everything_that_a_job_may_import_is_there():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = project["dependencies"] + project["optional-dependencies"]["workflow"]
    names = [re.match(r"[\w-]+", name)[0] for name in needed]
    assert [name for name in names if name not in pinned()] == []


def test_every_rule_with_a_script_names_the_environment():
    rules = [file.read_text(encoding="utf-8") for file in ROOT.glob("workflow/rules/*.smk")]
    with_scripts = [
        rule
        for text in rules
        for rule in re.split(r"^rule ", text, flags=re.M)
        if "script:" in rule
    ]
    assert len(with_scripts) >= 12
    for rule in with_scripts:
        assert 'conda:\n        "../envs/bezierplan.yaml"' in rule, rule.split(":")[0]
