"""A study of a reader's own, outside of the repository: a map, a planner with a module beside it, a
table, a figure, claims, an alternative, and a wrong published number.
"""

import contextlib
import json
import math
import re
from pathlib import Path

import pandas as pd
import pytest
import starts
from commands import refused

from bezierplan.__main__ import main
from bezierplan.analysis.outcome import verification
from bezierplan.commands import verify

PLANNER = """
import numpy as np
import nearby
from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan

workspaces = ("circles",)
extra = ("bent",)

def plan(problem, rng, *, bend: float):
    middle = (np.array(problem.start) + problem.target) / 2
    middle += [0, bend + rng.normal(0, nearby.SPREAD)]
    path = Path("bezier", np.array([problem.start, middle, problem.target]))
    length = curves.length(path)
    return Plan(path, length, claimed_feasible=True, evaluations=1, history=np.array([length]),
                stop="one", extra={"bent": float(middle[1])})
"""

NEARBY = "SPREAD = 0.01\n"

EXPERIMENTS = """
title: A bend round a disc
methods:
  low: {planner: bend.py, settings: {bend: 3.0}}
  high: {planner: bend.py, settings: {bend: 5.0}}
  line: {planner: straight_line}
  lower: {planner: bend.py, settings: {bend: 2.9}, variant_of: low}
baselines:
  shortest_path: {planner: shortest_path}
settings: {}
workspaces:
  disc: {kind: circles, unit: m, bounds: [-5, 5, -5, 5], circles: [[0, 0, 1]]}
problems:
  across: {workspace: disc, start: [-4, 0], target: [4, 0]}
experiments:
  bends:
    problems: [across]
    methods: [low, high, line, lower]
    repeats: {smoke: 2, full: 30, extended: 60}
    chunk: {smoke: 2, full: 30, extended: 60}
  again:
    problems: [across]
    methods: [low, high]
    repeats: {smoke: 2, full: 30, extended: 60}
    chunk: {smoke: 2, full: 30, extended: 60}
"""

# Some labels are those of columns, of statistics, and of each other.
ARTEFACTS = """
labels: {length: length, bent: height}
tables:
  shapes:
    {title: Shapes, labels: {mean: std, std: spread, low: high, high: low},
    kind: pivot, experiment: bends, published: shapes.csv, index: [method],
    columns: [value, statistic], where: {method: [low, high]}, values: [
      {metric: bent, statistic: [min, mean, std], label: bent, decimals: 3},
      {metric: length, statistic: [max, mean], label: height, decimals: 1}]}
  shapes_variants: {title: With variants, kind: pivot, experiment: bends,
    index: [method], columns: [value, statistic], values: [
      {metric: bent, statistic: [min, mean, std], label: bent, decimals: 3},
      {metric: length, statistic: [max, mean], label: height, decimals: 1}]}
  lengths:
    {title: "Lengths </script><b> `x`_ .. include:: bend.py",
    kind: pivot, experiment: bends, published: lengths.csv, index: [method], columns: [value],
    values: [
      {metric: length, statistic: mean, label: length, decimals: 2},
      {metric: feasible, statistic: share, label: feasible, decimals: 2}]}
figures:
  paths: {title: One bend, columns: 1, panels: [
    {kind: paths, experiment: bends, where: {method: low}, pick: {lowest: length}}]}
  figure_alternatives: {title: All, columns: 1, panels: [{kind: alternatives, claim: C2}]}
"""

CLAIMS = """
claims:
  - id: C1
    place: invented
    statement: The low bend is shorter than the high one.
    artefact: lengths
    checks: [{test: lower, experiment: [bends, again], every: [experiment], metric: length,
              groups: [low], than: [high], direction: lower, margin: 0.002}]
  - id: C2
    place: invented
    statement: The high bend is shorter than the low one, which is false.
    artefact: lengths
    checks: [{test: lower, experiment: bends, metric: length, groups: [high], than: [low],
              direction: lower, margin: 0.01}]
"""

ASSUMPTIONS = """
assumptions:
  - {id: O1, detail: How far the low bend goes, setting: bend, methods: [low],
     alternatives: [4.0, 5.0, 6.0], reason: invented, source: assumed}
readings:
  - {name: lower than high, values: {O1: 4.0}, reason: invented, claims: [C1]}
  - {name: as high, values: {O1: 5.0}, reason: invented, claims: [C1]}
  - {name: higher than high, values: {O1: 6.0}, reason: invented, claims: [C1, C2]}
"""

# The first is the length of the parabola of height 1.5 over a base of 8; the second is shorter than
# any path round the disc.
LOW = math.sqrt(64 + 16 * 1.5**2) / 2 + 64 / (8 * 1.5) * math.asinh(4 * 1.5 / 8)
PUBLISHED = f"""problem,method,metric,statistic,n,unit,value
across,low,length,mean,30,m,{LOW:.2f}
across,high,length,mean,30,m,8.00
"""
SHAPES = """method,metric,statistic,n,unit,value
low,bent,min,30,-,2.981
low,bent,mean,30,-,3.003
low,bent,std,30,-,0.012
low,length,max,30,m,8.9
low,length,mean,30,m,8.6
high,bent,min,30,-,4.977
high,bent,mean,30,-,5.004
high,bent,std,30,-,0.013
high,length,max,30,m,9.8
high,length,mean,30,m,9.7
"""


def snakemake(folder, *words, study="bends"):
    done = starts.make(folder, study, *words, "--rerun-triggers", "mtime", "input", "params")
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The folder of results of the invented study, made from a working folder that holds nothing
    else.
    """
    folder = tmp_path_factory.mktemp("own")
    study = folder / "bends"
    (study / "published").mkdir(parents=True)
    for name, text in {
        "bend.py": PLANNER,
        "nearby.py": NEARBY,
        "assumptions.yaml": ASSUMPTIONS,
        "experiments.yaml": EXPERIMENTS,
        "artefacts.yaml": ARTEFACTS,
        "claims.yaml": CLAIMS,
        "published/lengths.csv": PUBLISHED,
        "published/shapes.csv": SHAPES,
    }.items():
        (study / name).write_text(text)
    snakemake(folder, "all")
    return folder / "results" / "full" / "bends"


def test_own_planner_stands_in_the_table_and_the_comparison(results):
    table = pd.read_csv(results / "beyond" / "lengths.csv").set_index("method")
    assert list(table.index) == ["low", "high", "line"]
    assert table.loc["line", "feasible"] == 0
    assert pd.isna(table.loc["line", "length"])
    assert table.loc["low", "feasible"] == 1
    comparison = pd.read_csv(results / "beyond" / "lengths.comparison.csv")
    assert set(comparison["method"]) == {"low", "high"}, "those with a published number"


def test_published_length_below_the_bound_is_audited(results):
    audit = pd.read_csv(results / "audit.csv").query("item == 'lengths'")
    assert audit.set_index("place")["consistent"].to_dict() == {
        f"problem=across, method={method}, metric=length, statistic=mean": method == "low"
        for method in ("low", "high")
    }


def test_claim_that_is_false_is_contradicted_and_its_contrary_supported(results):
    claims = pd.read_csv(results / "claims.csv").set_index("id")
    assert claims.loc["C1", "verdict"] == "supported"
    assert claims.loc["C2", "verdict"] == "contradicted"


@pytest.fixture(scope="module")
def many(results):
    """The results of the study at the scale at which it has readings."""
    folder = results.parents[1] / "extended" / "bends"
    files = ("claims.csv", "beyond/figure_alternatives.csv")
    snakemake(results.parents[2], *(f"{folder.relative_to(results.parents[2])}/{f}" for f in files))
    return folder


def test_a_claim_depends_on_a_reading_that_decides_the_opposite(many):
    claims = pd.read_csv(many / "claims.csv").set_index("id")
    assert claims["verdict"].to_dict() == {"C1": "depends", "C2": "depends"}
    assert claims["readings"].to_dict() == {
        "C1": "supported under lower than high; undecided under as high; "
        "contradicted under higher than high",
        "C2": "supported under higher than high",
    }
    assert claims.loc["C1", "reason"].startswith(
        'supported by default, contradicted under "higher than high"'
    )


def test_claims_by_reading_have_a_row_for_each_check_and_reading(many):
    rows = pd.read_csv(many / "claims_by_reading.csv")
    assert rows["reading"].value_counts().to_dict() == {
        "default": 2,
        "higher than high": 2,
        "lower than high": 1,
        "as high": 1,
    }
    turned = rows.set_index(["id", "reading"]).loc[("C1", "higher than high")]
    assert (turned["verdict_on_check"], turned["holds"]) == ("contradicted", "0 of 2")
    assert turned["effect"] > 0


def test_a_reading_shares_what_it_does_not_change_with_the_default(many):
    made = {file.relative_to(many / "readings") for file in many.glob("readings/*/runs/*/*")}
    assert {tuple(file.parts[2:]) for file in made} == {("bends", "low"), ("again", "low")}
    assert not [*many.glob("readings/*/problems")]


def test_alternatives_are_drawn_with_the_default_first(many):
    frame = pd.read_csv(many / "beyond" / "figure_alternatives.csv")
    assert frame["value"].to_list() == ["default", "6.0", "5.0", "4.0"]
    assert frame["effect"][1:].is_monotonic_increasing
    assert frame["mark"].to_list() == ["-", "+", "0", "-"]


def test_only_an_edit_of_the_code_beside_the_planner_reruns_its_methods(results):
    folder = results.parents[2]
    near = folder / "bends" / "nearby.py"
    near.write_text("# a comment\n" + NEARBY)
    assert "Nothing to be done" in snakemake(folder, "-n", "all")
    near.write_text("SPREAD = 0.02\n")
    printed = snakemake(folder, "-n", "all")
    near.write_text(NEARBY)
    methods = re.findall(r"^rule runs:.*?method=(\w+)", printed, flags=re.M | re.S)
    assert sorted(set(methods)) == ["high", "low", "lower"]


def test_what_was_verified_is_listed_and_can_be_judged_again(results, monkeypatch, capsys):
    judged = json.loads((results.parent / "verified.json").read_text())
    assert f"{results.name}/claims.csv" in judged["sha256"]
    with contextlib.chdir(results.parents[2]):
        monkeypatch.setattr(verification, "find_differences", lambda *given: (0, []))
        verify.main(Path("results/full"), cores=1)
    said = capsys.readouterr().out
    assert f"{judged['runs']} runs in {judged['files']} files: " in said
    assert "made by this code: " in said


def test_every_printed_number_stands_in_every_file_that_shows_printed_numbers(results):
    printed = [line.rpartition(",")[2] for line in SHAPES.splitlines()[1:]]
    compared = pd.read_csv(results / "beyond/shapes.comparison.csv")
    assert compared["position"].notna().sum() == len(printed)
    shown = pd.read_csv(results / "beyond/shapes.published.csv", index_col=0, dtype=str)
    assert sorted(shown.to_numpy().ravel()) == sorted(printed)
    for file in (results / "beyond/shapes.tex", results.parent / "index.html"):
        assert not [number for number in printed if number not in file.read_text()], file


def test_a_variant_stands_beside_the_paper_s_methods_alone(results):
    tables = [
        pd.read_csv(results / f"beyond/{name}.csv") for name in ("lengths", "shapes_variants")
    ]
    assert ["lower" in {*table["method"]} for table in tables] == [False, True]


def test_what_a_job_reads_of_runs_is_an_input_with_its_times(results):
    printed = snakemake(results.parents[2], "-n", "-F", "all")
    read = re.findall(r"^rule (?!judgement)\w+:\n +input: (.*/runs/.*)$", printed, flags=re.M)
    assert len(read) >= 5
    for files in read:
        runs = re.findall(r"[^ ,]*/\d+\.parquet", files)
        assert all(run.replace(".parquet", ".times.parquet") in files for run in runs)


def test_a_further_study_joins_those_on_the_page(results):
    with contextlib.chdir(results.parents[2]):
        main(["new", "walks"])
    printed = snakemake(results.parents[2], "-n", "all", study="walks")
    for rule in ("summary", "page"):
        (inputs,) = re.findall(rf"^rule {rule}:\n +input: (.*)$", printed, flags=re.M)
        for study in ("bends", "walks"):
            assert f"results/full/{study}/claims.csv" in inputs


def test_numbers_of_all_studies_count_the_study(results):
    numbers = pd.read_csv(results.parent / "numbers.csv")
    positions = numbers.loc[numbers["counted"], "position"]
    assert positions.value_counts().to_dict() == {"inside": 10, "below": 2}


def test_a_map_of_one_s_own_may_be_named_like_the_template_s(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "room.txt").write_text("....\n.##.\n....\n....\n")
    ends = ["--start", "0.5,0.5", "--target"]
    far = refused(capsys, "new", "far", "--from", "room.txt", *ends, "99,3.5")
    assert "--target: [99.0, 3.5]: outside" in far
    assert not (tmp_path / "far").exists()
    main(["new", "own", "--from", "room.txt", *ends, "3.5,3.5"])
    main(["check-study", "own"])
    assert (tmp_path / "own/room.txt").read_text() == (tmp_path / "room.txt").read_text()
