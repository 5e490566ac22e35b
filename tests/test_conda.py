"""The environment of the rules where Snakemake deploys software with conda: its versions are those
of environment.txt, and jobs run in it. A program of the tests plays conda, which takes a network
and minutes; its environment has one interpreter, that of the tests.
"""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from test_module import ARTEFACTS, CLAIMS, EXPERIMENTS

pytestmark = pytest.mark.rare

ROOT = Path(__file__).parents[1]
ENVIRONMENT = ROOT / "workflow" / "envs" / "bezierplan.yaml"
SNAKEFILE = f"""
module paths:
    snakefile: {str(ROOT / "workflow" / "Snakefile")!r}
    config: {{"studies": ["./walk"]}}

use rule * from paths
"""
CONDA = """#!/bin/sh
echo "$@" >> "{told}"
case "$1 $2" in
    "--version ") echo "conda 25.1.0" ;;
    "info --json") echo '{{"conda_prefix": "{base}", "platform": "linux-64"}}' ;;
    "config --get") echo '{{"get": {{"channel_priority": "strict"}}}}' ;;
    "env create")
        for word; do prefix=$word; done
        mkdir -p "$prefix/bin"
        cp "{base}/python" "$prefix/bin/python" ;;
esac
"""
PYTHON = """#!/bin/sh
echo "python of the environment: $*" >> "{told}"
exec "{interpreter}" "$@"
"""


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
    assert [name for name in needed if name not in pinned()] == []


def test_every_rule_with_a_script_names_the_environment():
    rules = [file.read_text(encoding="utf-8") for file in ROOT.glob("workflow/rules/*.smk")]
    with_scripts = [
        rule
        for text in rules
        for rule in re.split(r"^rule ", text, flags=re.M)
        if "script:" in rule
    ]
    assert len(with_scripts) >= 20
    for rule in with_scripts:
        assert 'conda:\n        "../envs/bezierplan.yaml"' in rule, rule.split(":")[0]


def test_jobs_run_in_the_environment(tmp_path):
    base, told, study = tmp_path / "base", tmp_path / "told", tmp_path / "walk"
    (base / "bin").mkdir(parents=True)
    (study / "published").mkdir(parents=True)
    for file, text in {
        base / "bin" / "conda": CONDA.format(told=told, base=base),
        base / "bin" / "activate": 'export PATH="$1/bin:$PATH"\n',
        base / "python": PYTHON.format(told=told, interpreter=sys.executable),
        tmp_path / "Snakefile": SNAKEFILE,
        study / "experiments.yaml": EXPERIMENTS,
        study / "artefacts.yaml": ARTEFACTS,
        study / "claims.yaml": CLAIMS,
        study / "room.txt": "....\n.##.\n....\n",
        study / "published" / "lengths.csv": "method,metric,statistic,n,unit,value\n"
        "around,length,median,2,m,4.2\n",
    }.items():
        file.write_text(text, encoding="utf-8")
    for program in (base / "bin" / "conda", base / "python"):
        program.chmod(0o755)
    runs = "results/smoke/walk/runs/first/line/0.parquet"
    started = subprocess.run(
        [
            *(sys.executable, "-m", "snakemake", runs, "--cores", "1"),
            *("--software-deployment-method", "conda"),
        ],
        cwd=tmp_path,
        env=os.environ | {"PATH": f"{base / 'bin'}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert started.returncode == 0, started.stderr
    assert (tmp_path / runs).is_file()
    words = told.read_text(encoding="utf-8")
    assert "env create" in words
    for script in ("problems", "runs"):
        assert re.search(rf"^python of the environment: .*{script}\.py", words, re.MULTILINE), words
