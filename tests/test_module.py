"""The workflow as a module of another one, which has its results elsewhere, and words of a study
that a browser would run.
"""

import re
from pathlib import Path

import pytest
import starts

ROOT = Path(__file__).parents[1]
HOSTILE = "x</script> <script>window.RUN=1</script>"
EXPERIMENTS = """
title: A walk through a room
methods: {line: {planner: straight_line}, around: {planner: shortest_path}}
baselines: {best: {planner: rounded_shortest_path, settings: {turning_radius: 0.1, excess: .inf}}}
settings: {}
workspaces: {room: {kind: grid, file: room.txt, cell: 1, unit: m}}
problems: {across: {workspace: room, start: [0.5, 0.5], target: [3.5, 2.5]}}
experiments:
  first:
    problems: [across]
    methods: [line, around]
    repeats: {smoke: 2, full: 2, extended: 2}
    chunk: {smoke: 2, full: 2, extended: 2}
baseline_comparison: {baseline: best, experiments: [first]}
"""
ARTEFACTS = f"""
labels: {{line: "{HOSTILE}", around: "a < b & c"}}
tables:
  lengths: {{title: "Lengths {HOSTILE}", kind: pivot, experiment: first, published: lengths.csv,
    index: [method], columns: [value], values: [
    {{metric: length, statistic: median, label: "length {HOSTILE}", decimals: 2}}]}}
figures:
  ways: {{title: Ways, columns: 1, panels: [
    {{kind: paths, title: "P<svg onload=window.RUN=2>", experiment: first,
      where: {{method: around}}, pick: {{lowest: length}}}}]}}
"""
CLAIMS = f"""
claims:
  - id: C1
    place: "Table 1 {HOSTILE}"
    statement: "The line is shorter. {HOSTILE}"
    artefact: lengths
    checks: [{{test: lower, experiment: first, metric: length, groups: [line], than: [around],
               direction: lower, margin: 0.01}}]
"""
SNAKEFILE = f"""
module paths:
    snakefile: {str(ROOT / "workflow" / "Snakefile")!r}
    config: {{"studies": ["./walk"]}}
    prefix: "far/away"

use rule * from paths as paths_*
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A workflow that uses this one as a module, after it has made the study's results, and its
    report.
    """
    folder = tmp_path_factory.mktemp("module")
    (folder / "walk" / "published").mkdir(parents=True)
    for name, text in {
        "Snakefile": SNAKEFILE,
        "walk/room.txt": "....\n.##.\n....\n",
        "walk/experiments.yaml": EXPERIMENTS,
        "walk/artefacts.yaml": ARTEFACTS,
        "walk/claims.yaml": CLAIMS,
        "walk/published/lengths.csv": "method,metric,statistic,n,unit,value\n"
        "around,length,median,2,m,4.2\n",
    }.items():
        (folder / name).write_text(text)
    for words in (["paths_all"], ["paths_all", "--report", "report.html"]):
        done = starts.snakemake(folder, *words, "--cores", "2", "--workflow-profile", "none")
        assert done.returncode == 0, done.stderr + done.stdout
    return folder


def test_a_module_with_a_prefix_makes_everything(folder):
    made = folder / "far/away/results/full"
    for name in (
        "methods.csv",
        "index.html",
        "numbers.csv",
        "walk/claims.csv",
        "walk/beyond/ways.svg",
        "walk/beyond/lengths.comparison.csv",
    ):
        assert (made / name).is_file(), name
    assert not (folder / "results").exists()
    done = starts.snakemake(folder, "paths_all", "-n", "--cores", "1", "--workflow-profile", "none")
    assert "Nothing to be done" in done.stdout + done.stderr


def test_no_words_of_a_study_run_in_the_report(folder):
    report = (folder / "report.html").read_text()
    assert "window.RUN" in report
    assert not re.search(r"<(/script>|script>|svg )[^\n]{0,20}window\.RUN", report)
    assert HOSTILE not in report


def test_a_script_gets_the_words_as_they_are(folder):
    table = (folder / "far/away/results/full/walk/beyond/lengths.csv").read_text()
    assert HOSTILE in table
    assert "a < b & c" in table
