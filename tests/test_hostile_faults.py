"""Hostile input: files that are no YAML, that never end, that lie elsewhere; planners that are
none; names and numbers that cannot be meant. Each ends in one line that names file and key, before
the first job.
"""

import os
import pstats
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import starts

from bezierplan.schema.checked import LONGEST_FILE, Fault
from bezierplan.study import reading

ROOT = Path(__file__).parents[1]
SONG = ROOT / "config" / "studies" / "song2016"
E, A, C, S = "experiments.yaml", "artefacts.yaml", "claims.yaml", "assumptions.yaml"
T, M = "published/table1.csv", "workspaces/figure2.txt"
PLANNER = """
def plan(problem, rng, *, tries: int):
    pass
"""


@pytest.fixture
def folder(tmp_path):
    """A copy of song2016 to be spoilt."""
    return Path(shutil.copytree(SONG, tmp_path / "song2016"))


def told(folder):
    """What loading a study tells: one line, of printable characters, not longer than a screen."""
    with pytest.raises(Fault) as caught:
        reading.load([folder])
    message = str(caught.value)
    assert message.isprintable()
    assert len(message) < 1500
    return message


def bomb(presets=12):
    """YAML whose aliases stand for ten times as many values at every level."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, presets)]
    return "\n".join(lines)


# A file's whole text, and the line that reports it.
TEXTS = {
    "nothing": (E, "", "experiments.yaml: None: expected a mapping with title, methods"),
    "a list": (E, "- a\n- b\n", "experiments.yaml: ['a', 'b']: expected a mapping"),
    "a word": (E, "hello\n", "experiments.yaml: 'hello': expected a mapping"),
    "NUL": (E, "title: a\0b\n", "experiments.yaml: not YAML"),
    "another control character": (E, "title: a\x07b\n", "experiments.yaml: not YAML"),
    "bytes that are no text": (
        E,
        b"title: \xff\xfe\n",
        "experiments.yaml: cannot be read; expected text in UTF-8",
    ),
    "deep nesting of lists": (
        E,
        "title: " + "[" * 100_000,
        "experiments.yaml: line 1: nested more than 20 levels deep",
    ),
    "deep nesting of mappings": (
        E,
        "{a: " * 5000,
        "experiments.yaml: line 1: nested more than 20 levels deep",
    ),
    "deep nesting by indentation": (
        E,
        "".join(" " * n + "a:\n" for n in range(500)),
        "nested more than 20 levels deep",
    ),
    "aliases of aliases": (
        E,
        bomb(),
        "more than 200000 values, aliases counted as what they stand for",
    ),
    "aliases of aliases in claims": (C, bomb(), "claims.yaml: line 6: more than 200000 values"),
    "an alias of itself": (
        E,
        "a: &a [*a]\n",
        "experiments.yaml: line 1: *a: stands for nothing before it, or for itself",
    ),
    "an alias of nothing": (
        E,
        "a: *b\n",
        "experiments.yaml: line 1: *b: stands for nothing before it",
    ),
    "a list as key": (
        E,
        "? [a, b]\n: c\n",
        "experiments.yaml: line 1: a key is a list or a mapping; expected a name",
    ),
    "a mapping as key": (
        E,
        "? {a: b}\n: c\n",
        "experiments.yaml: line 1: a key is a list or a mapping; expected a name",
    ),
    "a tag of truth": (
        E,
        "title: !!bool maybe\n",
        "experiments.yaml: line 1: tag:yaml.org,2002:bool: tags are not read",
    ),
    "a tag of a number": (E, "title: !!int many\n", "tags are not read; write the plain value"),
    "a tag of Python": (
        E,
        "title: !!python/object/apply:os.system [echo]\n",
        "tag:yaml.org,2002:python/object/apply:os.system: tags are not",
    ),
    "a tag of time": (E, "title: !!timestamp x\n", "tags are not read"),
    "a tag of bytes": (E, "title: !!binary x\n", "tags are not read"),
    "a tag of a set": (E, "title: !!set {a}\n", "tags are not read"),
    "a tag of one's own": (E, "title: !mine a\n", "!mine: tags are not read"),
    "two documents": (
        E,
        "title: a\n---\ntitle: b\n",
        "experiments.yaml: line 2: but found another document",
    ),
    "a tab": (E, "title: a\n\tmethods: {}\n", "experiments.yaml: line 2: "),
    "an open quote": (E, "title: 'a\n", "experiments.yaml: line 2: "),
    "an open bracket": (E, "title: [a\n", "experiments.yaml: line 2: "),
    "no claims": (C, "claims: []\n", "claims.yaml: claims: []: expected a list of claims"),
    "empty claims": (C, "", "claims.yaml: None: expected a mapping with claims"),
    "claims that are no list": (
        C,
        "claims: 3\n",
        "claims.yaml: claims: 3: expected a list of claims",
    ),
    "a claim that is a word": (
        C,
        "claims: [C1]\n",
        "claims.yaml: claims: 0: 'C1': expected a mapping with id",
    ),
    "empty assumptions": (S, "", "assumptions.yaml: None: expected a mapping with assumptions"),
    "empty artefacts": (A, "", "artefacts.yaml: None: expected a mapping"),
    "a table that is a word": (
        A,
        "tables: {table1: x}\n",
        "artefacts.yaml: tables: table1: 'x': expected a mapping with kind",
    ),
    "a table without a kind": (
        A,
        "tables: {table1: {}}\n",
        "artefacts.yaml: tables: table1: kind: missing key; one of comparison",
    ),
    "a kind that is a list": (
        A,
        "tables: {table1: {kind: [pivot]}}\n",
        "artefacts.yaml: tables: table1: kind: ['pivot']: unknown",
    ),
    "an empty file of published numbers": (
        T,
        "",
        "table1.csv: line 1: the file is empty; expected a header",
    ),
    "published bytes": (T, b"\xff\xff", "table1.csv: cannot be read; expected text in UTF-8"),
    "published NUL": (
        T,
        "metric,statistic,n,unit,value\na\0,b,c,d,e\n",
        "table1.csv: line 2: has the character '\\x00'; expected csv",
    ),
    "a field of a million characters": (
        T,
        "metric,statistic,n,unit,value\n" + "a" * 1_000_000 + ",b,c,d,e\n",
        "table1.csv: line 2: not csv (field larger than field limit",
    ),
    "an empty map": (M, "", "figure2.txt: the map is empty"),
    "a map of bytes": (
        M,
        b"\xff\xff",
        "workspaces/figure2.txt: cannot be read: byte 0 is not UTF-8",
    ),
    "a map with NUL": (M, "..\0.\n", "figure2.txt: has a NUL character in line 1"),
}

# A file, words in it, what stands in their place, and the line that reports it.
WORDS = {
    # Text
    "a title of two lines": (E, 'title: "', 'title: "a\\nb', "experiments.yaml: title: 'a\\nb"),
    "a title with an escape": (E, 'title: "', 'title: "\\e[31m', "experiments.yaml: title: "),
    "a title that turns the line": (E, 'title: "', 'title: "\\u202e', "experiments.yaml: title: "),
    "a title of nothing": (
        E,
        'title: "',
        'title: "" #',
        "experiments.yaml: title: '': expected one line",
    ),
    "a title that is a number": (
        E,
        'title: "',
        "title: 3 #",
        "experiments.yaml: title: 3: expected one line",
    ),
    "a title of a figure of two lines": (
        A,
        "title: The workspace",
        'title: "a\\n.. include:: /etc/passwd"',
        "figures: figure2: title: ",
    ),
    "a long title": (
        A,
        "title: The workspace",
        f"title: {'a' * 5000}",
        "figures: figure2: title: 'aaa",
    ),
    "a label of two lines": (
        A,
        "smooth: smooth",
        'smooth: "a\\nb" #',
        "artefacts.yaml: labels: smooth: 'a\\nb': expected one line of text",
    ),
    "a key of two lines": (
        E,
        "  nonsmooth:",
        '  "a\\nb":',
        "experiments.yaml: methods: a\\nb: 'a\\nb': expected a name",
    ),
    "a key that is empty": (E, "  nonsmooth:", '  "":', "experiments.yaml: methods: "),
    "a name with a slash": (
        E,
        "  nonsmooth:",
        "  a/b:",
        "experiments.yaml: methods: a/b: 'a/b': expected a name",
    ),
    "a name with dots": (
        E,
        "  routes:",
        "  ..:",
        "experiments.yaml: experiments: ..: '..': expected a name",
    ),
    "a name with brackets": (
        E,
        "  figure2:",
        "  x[1]:",
        "experiments.yaml: workspaces: x[1]: 'x[1]': expected a name",
    ),
    "a name with capitals": (
        A,
        "  table1:",
        "  Table1:",
        "artefacts.yaml: tables: Table1: 'Table1': expected a name",
    ),
    "a long name": (A, "  table1:", f"  {'t' * 101}:", "artefacts.yaml: tables: ttt"),
    # Numbers
    "repeats of 1e9": (
        E,
        "full: 100,",
        "full: 1000000000,",
        "repeats: full: 1000000000: expected a whole number from 1 to 1000000",
    ),
    "repeats of 0": (
        E,
        "full: 100,",
        "full: 0,",
        "experiments: routes: repeats: full: 0: expected a whole number from 1 to 1000000",
    ),
    "repeats below 0": (
        E,
        "full: 100,",
        "full: -1,",
        "experiments: routes: repeats: full: -1: expected",
    ),
    "repeats that are true": (
        E,
        "full: 100,",
        "full: true,",
        "experiments: routes: repeats: full: True: expected",
    ),
    "repeats in words": (
        E,
        "full: 100,",
        "full: many,",
        "experiments: routes: repeats: full: 'many': expected",
    ),
    "repeats of nothing": (
        E,
        "full: 100,",
        "full: ,",
        "experiments: routes: repeats: full: has no value; expected",
    ),
    "repeats that are a list": (
        E,
        "repeats: {",
        "repeats: [1] #{",
        "experiments: routes: repeats: [1]: expected a mapping with smoke",
    ),
    "more chunks than jobs": (
        E,
        "extended: 250}\n    chunk: {smoke: 2, full: 50, extended: 125}",
        "extended: 1000000}\n    chunk: {smoke: 2, full: 50, extended: 1}",
        "experiments: routes: chunk: extended: 1: 1000000 repeats are more than 10000 chunks",
    ),
    "a cell thinner than the checker's tolerance": (
        E,
        "cell: 10,",
        "cell: 1e-9,",
        "figure2: cell: 1e-09: expected the side of a cell",
    ),
    "a cell of 0": (
        E,
        "cell: 10,",
        "cell: 0,",
        "workspaces: figure2: cell: 0: expected the side of a cell, a number of at least 1e-6",
    ),
    "a cell that is no number": (
        E,
        "cell: 10,",
        "cell: .nan,",
        "workspaces: figure2: cell: nan: expected",
    ),
    "an infinite cell": (E, "cell: 10,", "cell: .inf,", "workspaces: figure2: cell: inf: expected"),
    "a cell of many digits": (
        E,
        "cell: 10,",
        f"cell: {'9' * 5000},",
        "workspaces: figure2: cell: inf: expected",
    ),
    "a cell that is true": (
        E,
        "cell: 10,",
        "cell: true,",
        "workspaces: figure2: cell: True: expected",
    ),
    "a cell number below 0": (
        E,
        "start_cell: 0,",
        "start_cell: -1,",
        "problems: 0_15: start_cell: -1: expected",
    ),
    "a cell number of 1e9": (
        E,
        "start_cell: 0,",
        "start_cell: 1000000000,",
        "problems: 0_15: start_cell: 1000000000: expected",
    ),
    "half a cell number": (
        E,
        "start_cell: 0,",
        "start_cell: 0.5,",
        "problems: 0_15: start_cell: 0.5: expected",
    ),
    "a point of three": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start: [1, 2, 3], target: [5, 5]}",
        "problems: 0_15: start: [1, 2, 3]: expected [x, y]",
    ),
    "a point of words": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start: [a, b], target: [5, 5]}",
        "problems: 0_15: start: 0: 'a': expected a number",
    ),
    "a point that is no number": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start: [.nan, 1], target: [5, 5]}",
        "start: 0: nan: expected a number",
    ),
    "a point at infinity": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start: [.inf, 1], target: [5, 5]}",
        "start: 0: inf: expected a number",
    ),
    "a setting of 1e9": (
        E,
        "population: 200",
        "population: 1000000000",
        "settings: population: 1000000000: expected",
    ),
    "a setting that is no number": (
        E,
        "penalty: 10.0",
        "penalty: .nan",
        "settings: penalty: nan: expected a word, a number",
    ),
    "a setting that is a list": (
        E,
        "penalty: 10.0",
        "penalty: [10.0]",
        "settings: penalty: [10.0]: expected a word, a number",
    ),
    "a setting that is text": (
        E,
        "elitism: 1",
        "elitism: '1'",
        "elitism: '1'; expected a whole number",
    ),
    "a setting that is true": (
        E,
        "elitism: 1",
        "elitism: true",
        "elitism: True; expected a whole number",
    ),
    "a reference of 0": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0, target_cell: 15, reference: 0}",
        "reference: 0: expected the length",
    ),
    "decimals below 0": (
        A,
        "decimals: 0",
        "decimals: -1",
        "tables: table1: values: 0: decimals: -1: expected how many decimals",
    ),
    "1e9 columns of panels": (
        A,
        "columns: 2",
        "columns: 1000000000",
        "figures: figure1: columns: 1000000000: expected panels side by side",
    ),
    "a threshold that is no number": (
        C,
        "threshold: 0.5",
        "threshold: .nan",
        "claims: 2: checks: 0: threshold: nan: expected a share",
    ),
    "a threshold above 1": (
        C,
        "threshold: 0.5",
        "threshold: 1.5",
        "claims: 2: checks: 0: threshold: 1.5: expected a share",
    ),
    "a threshold in words": (
        C,
        "threshold: 0.5",
        "threshold: half",
        "claims: 2: checks: 0: threshold: 'half': expected a share",
    ),
    "a threshold without a side": (
        C,
        "threshold: 0.5, direction: at_least",
        "threshold: 0.5",
        "threshold: 0.5: needs a direction",
    ),
    "a margin that is no number": (
        C,
        "margin: 0.1",
        "margin: .nan",
        "claims: 0: checks: 0: margin: nan: expected the smallest effect",
    ),
    "an infinite margin": (
        C,
        "margin: 0.1",
        "margin: .inf",
        "claims: 0: checks: 0: margin: inf: expected the smallest effect",
    ),
    "a margin of a misspelt share": (
        C,
        "margin: 0.1",
        "margin: {publised: 0.1}",
        "margin: publised: unknown key; did you mean published?",
    ),
    "two events": (
        C,
        "event: {at_most: 30}",
        "event: {at_most: 30, below: 3}",
        "event: 2 keys; expected one of below",
    ),
    "an event of nothing": (
        C,
        "event: {at_most: 30}",
        "event: {}",
        "event: 0 keys; expected one of below",
    ),
    # Names
    "a planner of a number": (
        E,
        "{planner: binary_genetic, settings: {curve: polyline",
        "{planner: 3, settings: {curve: polyline",
        "planner: 3: expected",
    ),
    "a planner in the folder above": (
        E,
        "planner: binary_genetic",
        "planner: ../walk.py",
        "planner: ../walk.py: lies outside the study's folder",
    ),
    "a planner of the system": (
        E,
        "planner: binary_genetic",
        "planner: /etc/walk.py",
        "planner: /etc/walk.py: lies outside the study's folder",
    ),
    "a planner of the package": (
        E,
        "planner: binary_genetic",
        "planner: os",
        "planner: os: unknown",
    ),
    "a variant of nothing": (
        E,
        "variant_of: smooth}",
        "variant_of: smoth}",
        "methods: smooth_cubic: variant_of: smoth: unknown; did you mean smooth?",
    ),
    "a baseline of the name of a method": (
        E,
        "  shortest_path: {",
        "  smooth: {",
        "experiments.yaml: baselines: smooth: a method has this name already",
    ),
    "a baseline in an experiment": (
        E,
        "methods: [nonsmooth,",
        "methods: [shortest_path,",
        "methods: shortest_path: a baseline; it joins by itself",
    ),
    "a comparison with a method that is no baseline": (
        E,
        "baseline_comparison: {baseline: rounded",
        "baseline_comparison: {baseline: smooth",
        "baseline_comparison: baseline: smooth: unknown",
    ),
    "a comparison with the baseline in an unknown experiment": (
        E,
        "rounded, experiments: [routes]",
        "rounded, experiments: [route]",
        "baseline_comparison: experiments: route: unknown; did you mean routes?",
    ),
    "a comparison with a baseline that stays out": (
        E,
        "baseline_comparison: {baseline: rounded, experiments: [routes]}\n\n"
        "experiments:\n  routes:\n",
        "baseline_comparison: {baseline: random_search, experiments: [routes]}\n\n"
        "experiments:\n  routes:\n    vary: {population: [10]}\n",
        "baseline_comparison: experiments: routes: the baseline random_search does not join it; "
        "leave it out",
    ),
    "no methods": (
        E,
        "methods: [nonsmooth, smooth, smooth_cubic, smooth_single]",
        "methods: []",
        "routes: methods: []: expected a list of methods",
    ),
    "a method twice": (
        E,
        "methods: [nonsmooth,",
        "methods: [smooth,",
        "routes: methods: ['smooth', 'smooth'",
    ),
    "no problems": (
        E,
        "problems: [0_15, 15_255, 240_255, 0_240, 0_255, 15_240]",
        "problems: []",
        "routes: problems: []: expected a list of problems",
    ),
    "an unknown way of seeds": (
        E,
        "    repeats:",
        "    seeds: none\n    repeats:",
        "experiments: routes: seeds: none: unknown; known: common, own, shared",
    ),
    "an unknown setting varied": (
        E,
        "    repeats:",
        "    vary: {gene: [6]}\n    repeats:",
        "routes: vary: gene: unknown; did you mean genes?",
    ),
    "a setting varied by nothing": (
        E,
        "    repeats:",
        "    vary: {genes: []}\n    repeats:",
        "routes: vary: genes: []: expected a list of at least 1",
    ),
    "a setting varied by one value": (
        E,
        "    repeats:",
        "    vary: {genes: 6}\n    repeats:",
        "routes: vary: genes: 6: expected a list",
    ),
    "a wrong value varied": (
        E,
        "    repeats:",
        "    vary: {genes: [6, many]}\n    repeats:",
        "routes: vary: 0_15,genes=many: nonsmooth: settings: genes: 'many'",
    ),
    "a misspelt setting of a preset": (
        E,
        "\nworkspaces:",
        "\npresets: {profile: {tuned: {gene: 7}}}\nworkspaces:",
        "presets: profile: tuned: gene: unknown; did you mean genes?",
    ),
    "a preset that is a list": (
        E,
        "\nworkspaces:",
        "\npresets: {profile: {tuned: [7]}}\nworkspaces:",
        "presets: profile: tuned: [7]: expected",
    ),
    "an unknown value of a preset": (
        E,
        "    repeats:",
        "    vary: {profile: [tuned]}\n    repeats:",
        "experiments: routes: vary: profile: unknown",
    ),
    "settings of no planner": (
        E,
        "  genes: 6",
        "  binary_genetc: {genes: 6}\n  genes: 6",
        "settings: binary_genetc: no method of this study has this planner; did",
    ),
    "a misspelt setting of a planner": (
        E,
        "  genes: 6",
        "  binary_genetic: {gene: 6}\n  genes: 6",
        "settings: binary_genetic: gene: unknown; did you mean genes?",
    ),
    "three missing settings": (
        E,
        "  elitism: 1\n  penalty: 10.0 ",
        "  #",
        "settings: elitism, penalty: missing; binary_genetic needs them",
    ),
    "a map outside the folder": (
        E,
        "workspaces/figure2.txt",
        "../figure2.txt",
        "workspaces: figure2: file: ../figure2.txt: lies outside",
    ),
    "a map of the system": (
        E,
        "workspaces/figure2.txt",
        "/etc/passwd",
        "workspaces: figure2: file: /etc/passwd: lies outside the study's folder",
    ),
    "a map that never ends": (
        E,
        "workspaces/figure2.txt",
        "/dev/zero",
        "workspaces: figure2: file: /dev/zero: lies outside the study's folder",
    ),
    "a map that is a folder": (
        E,
        "workspaces/figure2.txt",
        "workspaces",
        "workspaces: figure2: file: workspaces: not a regular file",
    ),
    "a map with NUL in its name": (
        E,
        "workspaces/figure2.txt",
        '"a\\0b"',
        "workspaces: figure2: file: ",
    ),
    "a map of a long name": (
        E,
        "workspaces/figure2.txt",
        "a" * 5000,
        "workspaces: figure2: file: ",
    ),
    "layouts of a fixed map": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0, target_cell: 15, layouts: {smoke: 1, full: 1, extended: 1}, "
        "obstacles: [1]}",
        "layouts and obstacles need a workspace of kind",
    ),
    "layouts without obstacles": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0, target_cell: 15, layouts: {smoke: 1, full: 1, extended: 1}}",
        "layouts and obstacles go together",
    ),
    "1e9 layouts": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0, target_cell: 15, layouts: {smoke: 1, full: 1000000000, extended: 1}, "
        "obstacles: [1]}",
        "layouts: full: 1000000000: expected",
    ),
    "1e9 obstacles": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0, target_cell: 15, layouts: "
        "{smoke: 1, full: 1, extended: 1}, obstacles: [1000000000]}",
        "obstacles: 0: 1000000000: expected",
    ),
    "a side of 1e9": (
        E,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0, target_cell: 15, side: 1000000000}",
        "side: 1000000000: expected the side",
    ),
    # Artefacts
    "an unknown argument of a function": (
        C,
        "arguments: {bits: 8, genes: 6}",
        "arguments: {bits: 8, gene: 6}",
        "checks: 0: arguments: gene: unknown; did you mean genes?",
    ),
    "an argument too few": (
        C,
        "arguments: {bits: 8, genes: 6}",
        "arguments: {bits: 8}",
        "arguments: genes: missing; genes_in_range needs it",
    ),
    "an argument in words": (
        C,
        "arguments: {bits: 8, genes: 6}",
        "arguments: {bits: eight, genes: 6}",
        "arguments: bits: 'eight': expected",
    ),
    "an unknown metric of boxes": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: boxes, experiment: routes, metric: lenght}",
        "panels: 0: metric: lenght: unknown; did you mean length?",
    ),
    "an unknown column of boxes": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: boxes, experiment: routes, metric: length, by: methd}",
        "panels: 0: by: methd: unknown; did you mean method?",
    ),
    "an unknown x of lines": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: lines, experiment: routes, metric: length, x: gene}",
        "panels: 0: x: gene: unknown; did you mean genes?",
    ),
    "an unknown hue of lines": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: lines, experiment: routes, metric: length, x: genes, hue: methd}",
        "panels: 0: hue: methd: unknown; did you mean method?",
    ),
    "lines of nothing": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: lines, metric: length, x: genes}",
        "panels: 0: neither: expected either experiment or data",
    ),
    "lines of two sources": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: lines, experiment: routes, data: x, metric: length, x: genes}",
        "experiment and data: expected either",
    ),
    "the look of an unknown method": (
        A,
        "  nonsmooth: vermilion",
        "  nonsmoth: vermilion",
        "looks: nonsmoth: unknown; did you mean nonsmooth?",
    ),
    "an unknown look": (
        A,
        "  nonsmooth: vermilion",
        "  nonsmooth: vermillion",
        "looks: nonsmooth: vermillion: unknown; did you mean vermilion?",
    ),
    "an unknown hue of dots": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: dots, experiment: routes, metric: length, x: problem, hue: methods}",
        "panels: 0: hue: methods: unknown; did you mean method?",
    ),
    "an unknown hue of convergence": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: convergence, experiment: routes, hue: curves}",
        "panels: 0: hue: curves: unknown; did you mean curve?",
    ),
    "a statistic without hue": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: convergence, experiment: routes, pick: {repeat: 1}, statistic: mean}",
        "panels: 0: statistic: needs hue",
    ),
    "convergence of nothing": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: convergence, experiment: routes}",
        "panels: 0: neither: expected either pick or hue",
    ),
    "an unknown metric of tracks": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: tracks, experiment: routes, by: lenght, runs: 2}",
        "panels: 0: by: lenght: unknown; did you mean length?",
    ),
    "each of nothing": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, each: []}",
        "panels: 0: each: []: expected a list of at least two mappings",
    ),
    "each of words": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, each: [figure2, figure2]}",
        "panels: 0: each: 0: 'figure2': expected a mapping",
    ),
    "a key of one panel misspelt": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, each: [{workspace: figure2}, {worksace: figure2}]}",
        "panels: 0: each: 1: worksace: unknown key; did you mean workspace?",
    ),
    "a key of all panels misspelt": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbrs: free, each: [{workspace: figure2}, {workspace: figure2}]}",
        "panels: 0: numbrs: unknown key; did you mean numbers?",
    ),
    "a wrong value for all panels": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: 3, each: [{workspace: figure2}, {workspace: figure2}]}",
        "panels: 0: numbers: 3: expected which cells show their number",
    ),
    "an unknown name in one panel": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, each: [{workspace: figure2}, {workspace: narow}]}",
        "panels: 0: each: 1: workspace: narow: unknown; did you mean narrow?",
    ),
    "a key both in each and beside it": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, each: [{workspace: figure2}, {workspace: figure2, "
        "numbers: all}]}",
        "panels: 0: each: 1: numbers: is given beside each as well; "
        "expected it in one of the two places",
    ),
    "a column both in each and beside it": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: boxes, experiment: routes, metric: length, where: {method: smooth}, each: "
        "[{title: one}, {where: {method: nonsmooth}}]}",
        "panels: 0: each: 1: where: method: is given beside each as well",
    ),
    "each within each": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, each: [{workspace: figure2}, {each: [{workspace: "
        "figure2}, {workspace: figure2}]}]}",
        "panels: 0: each: 1: each: is given beside each as well",
    ),
    "each misspelt": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: workspace, numbers: free, eahc: [{workspace: figure2}, {workspace: narrow}]}",
        "panels: 0: eahc: unknown key; did you mean each?",
    ),
    "1e9 runs of tracks": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: tracks, experiment: routes, by: length, runs: 1000000000}",
        "panels: 0: runs: 1000000000: expected of how many",
    ),
    "an unknown function of a drawing": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: drawing, data: nothing}",
        "panels: 0: data: nothing: unknown",
    ),
    "an unknown function of a landscape": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: landscape, experiment: routes, data: nothing}",
        "panels: 0: data: nothing: unknown",
    ),
    "an unknown workspace of a panel": (
        A,
        "workspace: narrow,",
        "workspace: narow,",
        "panels: 1: workspace: narow: unknown; did you mean narrow?",
    ),
    "an unknown curve": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: paths, explicit: {curve: beziers, points: [[0, 0], [1, 1]]}}",
        "explicit: curve: beziers: unknown; did you mean bezier?",
    ),
    "a path of one point": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: paths, explicit: {curve: bezier, points: [[0, 0]]}}",
        "explicit: points: [[0, 0]]: expected a list of two to 100",
    ),
    "a path of words": (
        A,
        "{kind: workspace, workspace: figure2, numbers: free}",
        "{kind: paths, explicit: {curve: bezier, points: [[0, 0], [a, 1]]}}",
        "points: 1: 0: 'a': expected a number",
    ),
    "a pick of two ways": (
        A,
        "pick: {lowest: objective}",
        "pick: {lowest: objective, repeat: 1}",
        "pick: 2 keys; expected {lowest: column}",
    ),
    "a pick of an unknown column": (
        A,
        "pick: {lowest: objective}",
        "pick: {lowest: objectiv}",
        "pick: lowest: objectiv: unknown; did you mean objective?",
    ),
    "a pick of a repeat in words": (
        A,
        "pick: {lowest: objective}",
        "pick: {repeat: first}",
        "pick: repeat: 'first': expected a whole number",
    ),
    "no panels": (
        A,
        "panels:\n      - {kind: workspace, workspace: figure2, numbers: free}",
        "panels: []",
        "figures: figure2: panels: []: expected a list of panels",
    ),
    "a figure of the name of a table": (
        A,
        "  figure2:",
        "  table1:",
        "artefacts.yaml: figures: table1: a table has this name already",
    ),
    "a selection of no method": (
        A,
        "where: {problem: 0_255, method: smooth}",
        "where: {problem: 0_255, method: smoth}",
        "where: method: smoth: unknown; did you mean smooth?",
    ),
    "a selection of no value": (
        A,
        "where: {problem: 0_255, method: smooth}",
        "where: {curve: spline, method: smooth}",
        "where: curve: spline: unknown",
    ),
    "a selection of no run": (
        A,
        "where: {problem: 0_255, method: smooth}",
        "where: {curve: polyline, method: smooth}",
        "where: no run of routes has all of curve polyline, method smooth",
    ),
    "a table of no run": (
        A,
        "where: {problem: [0_15, 15_255, 240_255, 0_240], method: [nonsmooth, smooth, "
        "smooth_cubic, smooth_single]}",
        "where: {curve: bezier, method: [smooth]}",
        "tables: table1: where: no run of routes",
    ),
    "an unknown index": (
        A,
        "index: [problem]",
        "index: [problm]",
        "tables: table1: index: problm: unknown; did you mean problem?",
    ),
    "a transcribed table of no file": (
        A,
        "figures:\n",
        "  table9: {title: a, kind: transcribed, published: none.csv}\nfigures:\n",
        "published: none.csv: no such file in published",
    ),
    "a transcribed file outside": (
        A,
        "figures:\n",
        "  table9: {title: a, kind: transcribed, published: ../../x.csv}\nfigures:\n",
        "published: '../../x.csv': expected a file in the study's folder",
    ),
    "a comparison of no table": (
        A,
        "figures:\n",
        "  table9: {title: a, kind: comparison, of: [feasibility], metrics: [length]}\nfigures:\n",
        "of: feasibility: unknown; known: table1",
    ),
    "a comparison of no metric": (
        A,
        "figures:\n",
        "  table9: {title: a, kind: comparison, of: [table1], metrics: [lenght]}\nfigures:\n",
        "metrics: lenght: unknown; did you mean length?",
    ),
    # Published numbers
    "n of 0": (
        T,
        "unstated,,generation,26",
        "unstated,0,generation,26",
        "table1.csv: line 2: n: '0'; expected how many runs",
    ),
    "n of 2.5": (
        T,
        "unstated,,generation,26",
        "unstated,2.5,generation,26",
        "table1.csv: line 2: n: '2.5'; expected how many runs",
    ),
    "n below 0": (
        T,
        "unstated,,generation,26",
        "unstated,-3,generation,26",
        "table1.csv: line 2: n: '-3'; expected how many runs",
    ),
    "n in other digits": (
        T,
        "unstated,,generation,26",
        "unstated,٣,generation,26",
        "table1.csv: line 2: n: '٣'; expected how many runs",
    ),
    "another unit": (
        T,
        "unstated,,generation,26",
        "unstated,,s,26",
        "table1.csv: line 2: unit: 's'; expected generation, the unit of generation_1pct",
    ),
    "an infinite number": (
        T,
        ",225.4982",
        ",inf",
        "table1.csv: line 3: value: 'inf'; expected a number",
    ),
    "a number too large": (
        T,
        ",225.4982",
        ",1e999",
        "table1.csv: line 3: value: '1e999'; expected a number",
    ),
    "a statistic that the table lacks": (
        T,
        "unstated,,generation,26",
        "max,,generation,26",
        "table1.csv: line 2: statistic: max: the table has none of generation_1pct",
    ),
    "an unknown statistic": (
        T,
        "unstated,,generation,26",
        "meen,,generation,26",
        "table1.csv: line 2: statistic: meen: unknown; did you mean mean?",
    ),
    "a row twice": (
        T,
        "0_15,nonsmooth,objective",
        "0_15,nonsmooth,generation_1pct,unstated,,generation,7\n0_15,nonsmooth,objective",
        "the same keys, metric and statistic as line 2",
    ),
    "a column twice": (
        T,
        "problem,method,",
        "problem,problem,",
        "table1.csv: line 1: column problem is listed twice",
    ),
    "a row that is too long": (
        T,
        "unstated,,generation,26",
        "unstated,,generation,26,27",
        "table1.csv: line 2: 8 values; expected 7 values",
    ),
    # Claims
    "a claim twice": (
        C,
        "id: C2",
        "id: C1",
        "claims.yaml: claims: C1: another one has this id already",
    ),
    "a claim of another name": (
        C,
        "id: C2",
        "id: two",
        "claims.yaml: claims: 1: id: 'two': expected C and a number",
    ),
    "a long statement": (
        C,
        "statement: Smooth paths are",
        f"statement: {'a' * 200} #",
        "claims.yaml: claims: 0: statement: 'aaa",
    ),
    "a baseline as a group": (
        C,
        "groups: [smooth], than",
        "groups: [shortest_path], than",
        "group: shortest_path: unknown here: a baseline; claims compare methods",
    ),
    "a baseline in a selection": (
        C,
        "where: {method: smooth, problem: [0_255",
        "where: {method: random_search, problem: [0_255",
        "where: method: random_search: unknown here: a baseline",
    ),
    "runs of several problems": (
        C,
        "where: {problem: [0_15, 15_255, 240_255, 0_240]}, every: [problem]}",
        "where: {problem: [0_15, 15_255]}}",
        "several values of condition are neither told apart nor pooled, such as 0_15 and",
    ),
    "runs of several methods": (
        C,
        "where: {method: smooth, problem: [0_255, 15_240]}",
        "where: {method: [smooth, smooth_cubic], problem: [0_255, 15_240]}",
        "several values of method are neither told apart nor pooled",
    ),
    "a selection of a claim that is empty": (
        C,
        "where: {method: smooth, problem: [0_255, 15_240]}",
        "where: {}",
        "where: {}: expected column of the runs table",
    ),
    "a selection of a claim by no value": (
        C,
        "where: {method: smooth, problem: [0_255, 15_240]}",
        "where: {method: smooth, curve: polyline}",
        "where: no run of routes has all of",
    ),
    "an unknown replicate of a claim": (
        C,
        "threshold: 0.5,",
        "threshold: 0.5, replicate: layout,",
        "replicate: layout: unknown",
    ),
    "an unknown metric of a pick": (
        C,
        "threshold: all, pick: {lowest: objective}",
        "threshold: all, pick: {lowest: objectiv}",
        "pick: lowest: objectiv: unknown; did you mean objective?",
    ),
    "a variant of one value": (
        C,
        "variants: {method: [smooth, smooth_cubic, smooth_single]}",
        "variants: {method: [smooth]}",
        "variants: method: ['smooth']: expected a list of at least 2",
    ),
    "an unknown metric of a variant": (
        C,
        "metric: [length, objective]}",
        "metric: [length, objectiv]}",
        "variants: metric: objectiv: unknown; did you mean objective?",
    ),
    "a report of no": (
        C,
        "secondary: true}",
        "secondary: false}",
        "secondary: False: expected true: shown, but not counted",
    ),
    # Assumptions
    "a default that is not used": (
        S,
        "    default: 6\n",
        "    default: 7\n",
        "assumptions.yaml: assumptions: O2: default: 7: not the one that is used; genes is 6",
    ),
    "a default of a method that is not used": (
        S,
        "default: {nonsmooth: 701,",
        "default: {nonsmooth: 700,",
        "O3: default: nonsmooth: 700: not the one that is used; its samples is 701",
    ),
    "a default of an unknown method": (
        S,
        "default: {nonsmooth: 701,",
        "default: {nonsmoth: 701,",
        "O3: default: nonsmoth: unknown; did you mean nonsmooth?",
    ),
    "a default of nothing": (
        S,
        "    default: 6\n",
        "    default:\n",
        "assumptions.yaml: assumptions: 1: default: has no value; expected the value that runs use",
    ),
    "an assumption twice": (
        S,
        "id: O2\n",
        "id: O1\n",
        "assumptions.yaml: assumptions: O1: another one has this id already",
    ),
    "an assumption of another name": (
        S,
        "id: O2\n",
        "id: X2\n",
        "assumptions.yaml: assumptions: 1: id: 'X2': expected O or M and a number",
    ),
    "an unknown source": (
        S,
        "source: inferred",
        "source: guessed",
        "assumptions.yaml: assumptions: 0: source: guessed: unknown; known: assumed",
    ),
    "claims without a setting": (
        S,
        "    setting: curve\n",
        "",
        "assumptions.yaml: assumptions: 0: setting: missing key; with and claims need",
    ),
    "an alternative twice": (
        S,
        "alternatives: [piecewise_cubic, bezier]",
        "alternatives: [bezier, bezier]",
        "alternatives: ['bezier', 'bezier']: 'bezier' is listed twice",
    ),
    "an alternative of nothing": (
        S,
        "alternatives: [8]",
        "alternatives: [many]",
        "O2: alternatives: many: nonsmooth: settings: genes: 'many'; expected a whole number",
    ),
}

# A planner's file, and the line that reports it.
PLANNERS = {
    "a planner that is not Python": ("def plan(:\n", "walk.py: line 1: SyntaxError: "),
    "a planner that is empty": (
        "",
        "walk.py: no function plan; expected plan(problem, rng, *, <settings>)",
    ),
    "a planner that imports nothing": (
        "import nothing_of_this_name\n",
        "walk.py: line 1: ModuleNotFoundError: No module named",
    ),
    "a planner that fails": (
        "x = 1\ny = x / 0\n",
        "walk.py: line 2: ZeroDivisionError: division by zero",
    ),
    "a planner that ends the program": ("raise SystemExit(3)\n", "walk.py: line 1: sys.exit: 3"),
    "a planner that tells lines": ("raise ValueError('a\\nb')\n", "walk.py: line 1: ValueError: a"),
    "a planner that calls itself": (
        "def f():\n    f()\nf()\n",
        "walk.py: line 2: RecursionError: ",
    ),
    "a planner with NUL": ("\0", "walk.py: "),
    "a plan that is a number": ("plan = 3\n", "walk.py: no function plan"),
    "a plan of nothing": (
        "def plan():\n    pass\n",
        "walk.py: function plan: expected plan(problem, rng, *, <settings>)",
    ),
    "a plan of one argument": (
        "def plan(problem):\n    pass\n",
        "walk.py: function plan: expected plan(problem, rng",
    ),
    "a plan with settings by position": (
        "def plan(problem, rng, tries: int):\n    pass\n",
        "walk.py: function plan: expected plan(problem, rng",
    ),
    "a plan of anything": (
        "def plan(problem, rng, **settings):\n    pass\n",
        "walk.py: function plan: expected plan(problem, rng",
    ),
    "a setting without annotation": (
        "def plan(problem, rng, *, tries):\n    pass\n",
        "walk.py: setting tries: has no annotation; expected bool, int",
    ),
    "a setting of text": (
        "def plan(problem, rng, *, tries: str):\n    pass\n",
        "walk.py: setting tries: is annotated with str; expected bool, int",
    ),
    "a setting of a list": (
        "def plan(problem, rng, *, tries: list[int]):\n    pass\n",
        "walk.py: setting tries: is annotated with list[int]; expected",
    ),
    "an annotation of nothing": (
        "def plan(problem, rng, *, tries: 'Nothing'):\n    pass\n",
        "walk.py: function plan: its annotations cannot be read",
    ),
    "a default value": (
        "def plan(problem, rng, *, tries: int = 3):\n    pass\n",
        "walk.py: setting tries: has a default value; a study gives",
    ),
    "a setting of the name of a column": (
        "def plan(problem, rng, *, length: int):\n    pass\n",
        "walk.py: its setting length is a column of the runs table",
    ),
    "a setting of the name of a column that is joined": (
        "def plan(problem, rng, *, bound: int):\n    pass\n",
        "walk.py: its setting bound is a column of the runs table, "
        "or joined to it; give it another name",
    ),
    "a setting without a value": (
        "def plan(problem, rng, *, tries: int, more: int):\n    pass\n",
        "settings: more: missing; walk.py needs it",
    ),
    "unknown workspaces": (
        "workspaces = ('gird',)\n" + PLANNER,
        "walk.py: workspaces: gird: unknown; did you mean grid?",
    ),
    "workspaces that are a word": (
        "workspaces = 'grid'\n" + PLANNER,
        "walk.py: workspaces: 'grid': expected kinds among grid",
    ),
    "other workspaces": (
        "workspaces = ('circles',)\n" + PLANNER,
        "methods: nonsmooth: its planner serves workspaces of kind circles, not grid",
    ),
    "a check that fails": (
        "def check(settings):\n    settings['none']\n" + PLANNER,
        "settings: check of its planner fails (KeyError: 'none')",
    ),
    "a check that refuses": (
        "def check(settings):\n    raise ValueError('tries: too few')\n" + PLANNER,
        "nonsmooth: settings: tries: too few",
    ),
    "a problem that is refused": (
        "def serves(problem):\n    raise ValueError('start: too far')\n" + PLANNER,
        "methods: nonsmooth: problem 0_15: start: too far",
    ),
    "a look at a problem that fails": (
        "def serves(problem):\n    problem.none\n" + PLANNER,
        "problem 0_15: serves of its planner fails (AttributeError",
    ),
}


def write(file: Path, content) -> None:
    file.write_bytes(content) if isinstance(content, bytes) else file.write_text(
        content, encoding="utf-8", newline=""
    )


@pytest.mark.parametrize("fault", TEXTS)
def test_a_file_of_anything(fault, folder):
    name, content, expected = TEXTS[fault]
    write(folder / name, content)
    assert expected in told(folder)


@pytest.mark.parametrize("fault", WORDS)
def test_words_that_cannot_be_meant(fault, folder):
    name, old, new, expected = WORDS[fault]
    text = (folder / name).read_text()
    assert old in text
    write(folder / name, text.replace(old, new, 1))
    message = told(folder)
    assert expected in message
    assert re.search(r"(experiments|artefacts|claims|assumptions)\.yaml|table1\.csv", message)


def with_planner(folder, text):
    """The study with a planner of its own in the place of the first."""
    write(folder / "walk.py", text)
    file = folder / E
    method = "{planner: binary_genetic, settings: {curve: polyline, samples: 701}}"
    assert method in file.read_text()
    file.write_text(file.read_text().replace(method, "{planner: walk.py, settings: {tries: 2}}", 1))
    (folder / S).unlink()


@pytest.mark.parametrize("fault", PLANNERS)
def test_a_planner_that_is_none(fault, folder):
    text, expected = PLANNERS[fault]
    with_planner(folder, text)
    message = told(folder)
    assert expected in message
    assert "experiments.yaml: " in message


def test_a_planner_that_is_one(folder):
    with_planner(folder, PLANNER)
    assert reading.load([folder])["song2016"].resolved("nonsmooth") == {"tries": 2}


@pytest.mark.parametrize("name", [E, A, C, S, T, M])
@pytest.mark.parametrize("kind", ["endless", "pipe", "folder", "huge", "elsewhere"])
def test_what_is_no_file_of_the_study(kind, name, folder, tmp_path):
    """A link to /dev/zero, a pipe that nobody writes, a folder, a file of gigabytes, and one of
    somebody else.
    """
    file = folder / name
    file.unlink()
    match kind:
        case "endless":
            file.symlink_to("/dev/zero")
        case "pipe":
            os.mkfifo(file)
        case "folder":
            file.mkdir()
        case "huge":
            with file.open("wb") as sparse:
                sparse.truncate(LONGEST_FILE + 1)
        case "elsewhere":
            (tmp_path / "secret").write_text("a: b\n")
            file.symlink_to(tmp_path / "secret")
    expected = {
        "endless": "cannot be read (not a regular file)|lies outside the study's folder",
        "pipe": "not a regular file",
        "folder": "not a regular file",
        "huge": f"{LONGEST_FILE + 1} bytes; expected at most {LONGEST_FILE}",
        "elsewhere": "lies outside the study's folder",
    }[kind]
    message = told(folder)
    assert any(words in message for words in expected.split("|"))
    assert name.rpartition("/")[2] in message


SPOILT = {
    "YAML": (E, "{"),
    "a bomb": (E, bomb()),
    "NUL": (E, "title: \0"),
    "a tag": (E, "title: !!bool maybe\n"),
    "nesting": (E, "[" * 100_000),
    "a pipe": (E, None),
    "claims": (C, "claims: [C1]\n"),
    "a kind": (A, "tables: {table1: {kind: [pivot]}}\n"),
    "a map": (M, "x"),
    "numbers": (T, "metric\n"),
}


def started(place, study):
    """A dry run of a study from a folder: how it ended, and its calls of functions, which are its
    work on any machine, however busy.
    """
    words = (
        "-s",
        ROOT / "Snakefile",
        "--workflow-profile",
        "none",
        "-n",
        "--cores",
        "1",
        "--config",
        f"studies=[{study}]",
    )
    done = starts.snakemake(place, *words, calls=place / "calls")
    return done, pstats.Stats(str(place / "calls")).total_calls


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """Calls in a dry run of the study without a fault."""
    done, calls = started(tmp_path_factory.mktemp("sound"), "song2016")
    assert done.returncode == 0, done.stderr
    return calls


@pytest.mark.parametrize("fault", SPOILT)
def test_snakemake_ends_in_one_line(fault, folder, sound):
    """Exit code 2, and of the whole output one line: no traceback, whatever the file holds; after
    less work than a sound start takes.
    """
    name, content = SPOILT[fault]
    (folder / name).unlink()
    os.mkfifo(folder / name) if content is None else write(folder / name, content)
    done, calls = started(folder.parent, folder)
    assert done.returncode == 2
    assert calls < sound
    assert "Traceback" not in done.stderr + done.stdout
    lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
    assert len(lines) == 1, lines
    assert name.rpartition("/")[2] in lines[0]


def test_a_program_that_stops_reading_gets_no_complaint():
    command = f"'{sys.executable}' -m bezierplan list | true"
    done = subprocess.run(
        ["bash", "-c", command], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
