"""Words, numbers and selections of a study that no job could use: each ends in one line that names
file and key, before the first job.
"""

import re
import shutil
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bezierplan.analysis import headline, metrics, statistics, summary
from bezierplan.figures import sheet
from bezierplan.machine import digest
from bezierplan.running.jobs import watchdog
from bezierplan.schema.checked import Fault
from bezierplan.study import reading, targets

E, A, C, S, T = (
    "experiments.yaml",
    "artefacts.yaml",
    "claims.yaml",
    "assumptions.yaml",
    "published/lengths.csv",
)

FILES = {
    E: """
title: Walks in a room
methods:
  mine: {planner: walk.py, settings: {tries: 20}}
  line: {planner: walk.py, settings: {tries: 4}}
  more: {planner: walk.py, settings: {tries: 40}}
baselines:
  straight: {planner: straight_line}
settings: {}
workspaces:
  room: {kind: grid, file: room.txt, cell: 1, unit: m}
  pond: {kind: circles, bounds: [0, 10, 0, 10], circles: [[5, 5, 1]], unit: m}
problems:
  across: {workspace: room, start_cell: 0, target_cell: 63}
  back: {workspace: room, start_cell: 63, target_cell: 0}
  swim: {workspace: pond, start: [1, 1], target: [9, 9]}
experiments:
  first: {problems: [across], methods: [mine, line], repeats: {smoke: 2, full: 12, extended: 12},
    chunk: {smoke: 2, full: 6, extended: 6}}
  both: {problems: [across, back], methods: [more], vary: {tries: [4, 8]},
    repeats: {smoke: 2, full: 2, extended: 2}, chunk: {smoke: 2, full: 2, extended: 2}}
  water: {problems: [swim], methods: [mine], repeats: {smoke: 2, full: 2, extended: 2},
    chunk: {smoke: 2, full: 2, extended: 2}}
""",
    A: """
labels: {mine: my walk}
tables:
  lengths: {title: Lengths, kind: pivot, experiment: first, index: [method], columns: [value],
    published: lengths.csv, values: [
    {metric: length, statistic: [median, min], label: length, decimals: 2},
    {metric: feasible, statistic: [share, count], label: share, decimals: 2}]}
  printed: {title: Printed, kind: transcribed, published: other.csv}
  beside: {title: Both, kind: comparison, of: [lengths], metrics: [length]}
figures:
  paths: {title: Paths, columns: 2, panels: [
    {kind: paths, title: mine, experiment: first, where: {method: mine}, pick: {lowest: length}},
    {kind: dots, experiment: first, metric: length, x: method, hue: problem},
    {kind: lines, experiment: both, metric: length, x: tries, hue: problem, repeats: [1]},
    {kind: boxes, experiment: first, metric: length, by: method},
    {kind: convergence, experiment: first, hue: method}]}
""",
    C: """
claims:
  - {id: C1, place: Table 1, statement: The walk with fewer tries is longer., artefact: lengths,
     checks: [
      {test: lower, experiment: first, metric: length,
       groups: [line], than: [mine], direction: higher, margin: 0.1}]}
  - {id: C2, place: Table 1, statement: More tries are shorter., artefact: lengths, checks: [
      {test: trend, experiment: both, metric: length,
       x: tries, direction: down, margin: 0.1, every: [problem]}]}
  - {id: C4, place: Table 1, statement: Most walks end., artefact: lengths, checks: [
      {test: share, experiment: first, metric: feasible, threshold: 0.5, direction: at_least,
       where: {method: mine}}]}
""",
    S: """
assumptions:
  - {id: O1, detail: how many tries, default: {mine: 20}, alternatives: [10], with: {mine: {}},
    reason: none, source: assumed, setting: tries, claims: [C1]}
""",
    T: """method,metric,statistic,n,unit,value
mine,length,median,10,m,13.1
line,length,median,10,m,14.2
mine,feasible,share,10,-,0.9
mine,feasible,count,10,-,9
""",
    "published/other.csv": "name,value\na,1\nb,2\n",
    "walk.py": """
extra = ("roads",)


def plan(problem, rng, *, tries: int):
    pass
""",
    "room.txt": "........\n.##.....\n.##..##.\n.....##.\n..#.....\n..#..##.\n.....##.\n........\n",
}

LENGTHS, FIGURE, PANEL = (
    "index: [method], columns: [value]",
    "columns: 2, panels: [",
    "{kind: paths, title: mine, experiment: first",
)
LOWER, TREND = (
    "groups: [line], than: [mine], direction: higher, margin: 0.1",
    "x: tries, direction: down, margin: 0.1, every: [problem]",
)
PATHS = "where: {method: mine}, pick: {lowest: length}}"
DOTS, LINES, BOXES = (
    "x: method, hue: problem}",
    "x: tries, hue: problem, repeats: [1]}",
    "metric: length, by: method}",
)
HUE = "{kind: convergence, experiment: first, hue: method}"
VALUES = "{metric: length, statistic: [median, min], label: length, decimals: 2}"
CHUNK = "chunk: {smoke: 2, full: 6, extended: 6}"
ROW = "mine,length,median,10,m,13.1"
ASSUMED = "alternatives: [10], with: {mine: {}}"
KNOWN = "known before a run"
RESULT = "that a run finds out; expected a column that is known before a run"
BY_VALUE = "that a run finds out is not selected by its value"
DIGITS = "expected a number in ASCII digits"


def panel(text):
    """A panel in the place of the first."""
    return A, FIGURE, f"{FIGURE}{text}, "


def table(text):
    """Keys of the first table, in the place of its index and columns."""
    return A, LENGTHS, text


def lower(text):
    """Keys of the first check, in the place of what it compares."""
    return C, LOWER, text


# A file, words in it, what stands in their place, and the line that reports it.
FAULTS = {
    # Columns that tell runs apart
    **{
        f"{key} by {column}": (*edit, f"{place}: {column}: a {kind}")
        for column, kind in {
            "history": "list",
            "path_points": "list",
            "id": "name",
            "length": "number",
            "stop": "word",
            "feasible": "flag",
            "clearance": "number",
        }.items()
        for key, edit, place in (
            ("an index", table(f"index: [{column}], columns: [value]"), "tables: lengths: index"),
            ("columns", table(f"index: [method], columns: [{column}]"), "tables: lengths: columns"),
            ("within", table(f"{LENGTHS}, within: {column}"), "tables: lengths: within"),
            ("dots", (A, DOTS, f"x: {column}, hue: method}}"), "panels: 1: x"),
            ("colours of dots", (A, DOTS, f"x: method, hue: {column}}}"), "panels: 1: hue"),
            ("lines", (A, LINES, f"x: {column}}}"), "panels: 2: x"),
            ("boxes", (A, BOXES, f"metric: length, by: {column}}}"), "panels: 3: by"),
            ("a convergence", (A, HUE, HUE.replace("method", column)), "panels: 4: hue"),
            ("every", lower(f"{LOWER}, every: [{column}]"), "C1: checks: 0: every"),
            ("a replicate", lower(f"{LOWER}, replicate: {column}"), "C1: checks: 0: replicate"),
            ("a trend", (C, TREND, TREND.replace("tries", column)), "C2: checks: 0: x"),
        )
    },
    **{
        f"published numbers by {column}": (
            T,
            "method,",
            f"{column},",
            f"lengths.csv: line 1: column: {column}: a {kind}",
        )
        for column, kind in {
            "history": "list",
            "length": "number",
            "feasible": "flag",
            "id": "name",
        }.items()
    },
    "lines along words": (
        A,
        LINES,
        "x: method}",
        "panels: 2: x: method: a word of each run; expected a column of numbers that is known",
    ),
    "lines along a workspace": (
        A,
        LINES,
        "x: workspace}",
        "panels: 2: x: workspace: a word of each run",
    ),
    "a trend along words": (
        C,
        TREND,
        TREND.replace("tries", "method"),
        "C2: checks: 0: x: method: a word of each run",
    ),
    "a trend along one value": (
        C,
        TREND,
        TREND + ", where: {tries: 4}",
        "C2: checks: 0: x: tries: has the only value 4; a trend needs",
    ),
    **{
        f"a pick of {column}": (
            A,
            "{lowest: length}",
            f"{{{way}: {column}}}",
            f"panels: 0: pick: {way}: {column}: a {kind}",
        )
        for way, column, kind in (
            ("lowest", "history", "list"),
            ("median", "path_points", "list"),
            ("lowest", "feasible", "flag"),
            ("median", "stop", "word"),
            ("lowest", "id", "name"),
            ("lowest", "method", "word"),
        )
    },
    "a pick of a computed metric": (
        A,
        "{lowest: length}",
        "{lowest: gap}",
        "panels: 0: pick: lowest: gap: unknown",
    ),
    "an unknown column": (
        *table("index: [methd], columns: [value]"),
        "index: methd: unknown; did you mean method?",
    ),
    "a column in index and columns": (
        *table("index: [method], columns: [value, method]"),
        "columns: method: in index already",
    ),
    "a label twice": (
        A,
        "label: share",
        "label: length",
        "tables: lengths: values: 1: label: length: another entry has this label",
    ),
    # Metrics that no run has
    "a metric of another planner": (
        A,
        VALUES,
        VALUES.replace("metric: length", "metric: bad_samples"),
        "metric: bad_samples: no run of first",
    ),
    "a metric of drives": (
        A,
        VALUES,
        VALUES.replace("metric: length", "metric: arrival"),
        "metric: arrival: no run of first has it",
    ),
    "a metric of a reference": (
        A,
        BOXES,
        "metric: gap_reference}",
        "panels: 3: metric: gap_reference: no run of first has it: its runs",
    ),
    "a metric of grids in water": (
        *panel("{kind: boxes, experiment: water, metric: cells4}"),
        "panels: 0: metric: cells4: no run of water has it: "
        "it is for workspaces of kind grid, not circles",
    ),
    "a metric of circles in a room": (
        A,
        BOXES,
        "metric: homotopy}",
        "metric: homotopy: no run of first has it: it is for workspaces of",
    ),
    "a metric of a claim": (
        C,
        "metric: length,\n       groups",
        "metric: near_optimal,\n       groups",
        "C1: checks: 0: metric: near_optimal: no run of",
    ),
    "a pick of drives": (
        A,
        "{lowest: length}",
        "{median: arrival}",
        "panels: 0: pick: median: arrival: ",
    ),
    "runs that have a metric of others": (
        A,
        "{lowest: length}",
        "{lowest: length, having: optimal}",
        "pick: having: optimal: no run of",
    ),
    "a metric of a comparison": (
        A,
        "metrics: [length]",
        "metrics: [cpu_s]",
        "tables: beside: metrics: cpu_s: unknown",
    ),
    # Selections
    **{
        f"a selection by {column} {value}": (
            A,
            "where: {method: mine}, pick",
            f"where: {{method: mine, {column}: {value}}}, pick",
            told,
        )
        for column, value, told in (
            (
                "repeat",
                "99",
                "where: repeat: 99: expected a repeat from 0 to 11: first has 12 at scale full",
            ),
            ("repeat", "abc", "where: repeat: abc: expected a whole number of at least 0"),
            ("repeat", "1.5", "where: repeat: 1.5: expected a whole number"),
            ("repeat", "true", "where: repeat: True: expected a whole number"),
            ("repeat", "-1", "where: repeat: -1: expected a whole number"),
            (
                "length",
                "13.1",
                "where: length: 13.1: a number that a run finds out is not selected by its value",
            ),
            ("history", "3", "where: history: 3: a list that a run finds out"),
            ("id", "a", "where: id: a: a name that a run finds out"),
            ("cpu_s", "1", "where: cpu_s: 1: a number that a run finds out"),
            ("feasible", "1", "where: feasible: 1: expected true or false"),
            ("feasible", "yes", "where: feasible: yes: expected true or false"),
            ("stop", "3", "where: stop: 3: expected a word"),
            ("path_curve", "bezir", "where: path_curve: bezir: unknown; did you mean bezier?"),
            ("gap", "0", "where: gap: unknown"),
            ("optimal", "true", "where: optimal: no run of first has it"),
            ("problem", "acros", "where: problem: acros: unknown; did you mean across?"),
            ("condition", "nowhere", "where: condition: nowhere: unknown"),
            ("tries", "21", "where: tries: 21: unknown"),
            ("tries", "true", "where: tries: True: unknown"),
            ("tries", "'20'", "where: no run of first has all of"),
            ("workspace", "pond", "where: workspace: pond: unknown"),
            ("layout", "1", "where: layout: unknown"),
            ("arrival", "3", "where: arrival: "),
        )
        if column != "tries" or value != "'20'"
    },
    "a table of a repeat that is not run": (
        *table(f"where: {{repeat: 99}}, {LENGTHS}"),
        "tables: lengths: where: repeat: 99: expected",
    ),
    "a table by an outcome": (
        *table(f"where: {{length: 13.1}}, {LENGTHS}"),
        f"where: length: 13.1: a number {BY_VALUE}",
    ),
    "a claim of a repeat that is not run": (
        *lower(f"{LOWER}, where: {{repeat: 77}}"),
        "C1: checks: 0: where: repeat: 77: expected a repeat",
    ),
    "a claim by an outcome": (
        *lower(f"{LOWER}, where: {{history: 1}}"),
        f"where: history: 1: a list {BY_VALUE}",
    ),
    "a value that selects no runs": (
        A,
        VALUES,
        VALUES[:-1] + ", where: {repeat: 50}}",
        "values: 0: where: repeat: 50: expected a repeat",
    ),
    "a pick of a repeat that is not run": (
        A,
        "{lowest: length}",
        "{repeat: 99}",
        "panels: 0: pick: repeat: 99: expected a repeat from 0",
    ),
    "a line of a repeat that is not run": (
        A,
        "repeats: [1]",
        "repeats: [1, 2]",
        "panels: 2: repeats: 2: expected a repeat from 0 to 1",
    ),
    "a comparison of no method": (
        A,
        "metrics: [length]",
        "metrics: [length], where: {method: zzz}",
        "beside: where: method: zzz: unknown",
    ),
    "a comparison by no column": (
        A,
        "metrics: [length]",
        "metrics: [length], where: {tries: 4}",
        "beside: where: tries: unknown; known: method",
    ),
    "a paper's interpretation by no column": (
        *table(f"{LENGTHS}, primary: {{tries: 4}}"),
        "lengths: primary: tries: unknown; known: method",
    ),
    "a paper's interpretation of no value": (
        *table(f"{LENGTHS}, primary: {{method: zzz}}"),
        "lengths: primary: method: zzz: unknown",
    ),
    # Panels of one run
    "one run of two methods": (
        A,
        "where: {method: mine}, pick",
        "pick",
        "panels: 0: where: selects 2 values of method (line, mine, ...)",
    ),
    "one run of two problems": (
        *panel("{kind: paths, experiment: both, pick: {lowest: length}}"),
        "selects 2 values of problem (across",
    ),
    "runs of two problems a line": (
        *panel("{kind: paths, experiment: both, hue: method, pick: {lowest: length}}"),
        "2 values of problem",
    ),
    "curvature of two methods": (
        *panel(
            "{kind: along_path, experiment: first, pick: {lowest: length}, quantity: curvature}"
        ),
        "panels: 0: where: selects 2 values of method",
    ),
    "a convergence of two methods": (
        *panel("{kind: convergence, experiment: first, pick: {lowest: length}}"),
        "selects 2 values of method",
    ),
    "tracks of two methods": (
        *panel("{kind: tracks, experiment: first, by: length, runs: 1}"),
        "selects 2 values of method",
    ),
    "tracks of a planner without one": (
        *panel("{kind: tracks, experiment: first, where: {method: mine}, by: length, runs: 1}"),
        "panels: 0: where: method: mine: its planner walk.py has no function track",
    ),
    "a moment where nothing moves": (
        *panel(
            "{kind: snapshot, experiment: first, where: {method: mine}, pick: {repeat: 0}, at: 0.5}"
        ),
        "panels: 0: experiment: first: nothing moves there",
    ),
    "clearance where nothing moves": (
        *panel("{kind: clearance, experiment: first}"),
        "panels: 0: experiment: first: nothing moves there",
    ),
    "ranks of two methods": (
        *panel("{kind: critical_difference, experiment: first, metric: length}"),
        "expected at least 3 methods",
    ),
    "ranks of an unknown table": (
        *panel("{kind: convergence, experiment: first, hue: method, printed: table9}"),
        "printed: table9: unknown",
    ),
    "a change from an unknown problem": (
        A,
        PATHS,
        PATHS[:-1] + ", changed_from: bak}",
        "panels: 0: changed_from: bak: unknown; known: across",
    ),
    "dots of one colour": (
        A,
        DOTS,
        "x: method, hue: method}",
        "panels: 1: hue: method: is x already; expected another column",
    ),
    "lines of one point": (
        A,
        LINES,
        "x: tries, hue: tries}",
        "panels: 2: hue: tries: is x already",
    ),
    "numbers of no cells": (
        *panel("{kind: workspace, workspace: pond, numbers: all}"),
        "panels: 0: numbers: pond: a workspace of kind circles",
    ),
    "cells embedded that are none": (
        *panel("{kind: workspace, workspace: pond, embed: true}"),
        "panels: 0: embed: pond: a workspace of kind",
    ),
    # Sizes of drawings
    "a reversed view": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [8, 0, 8, 0]}",
        "panels: 0: view: [8, 0, 8, 0]: expected [lowest x, highest x",
    ),
    "an empty view": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [1, 1, 1, 1]}",
        "view: [1, 1, 1, 1]: expected [lowest x",
    ),
    "a view of nothing": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [0, 1e-300, 0, 1]}",
        "view: 1: 1e-300: expected a size from 1e-12 to 1e+12",
    ),
    "a view of everything": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [-1e308, 1e308, 0, 1]}",
        "view: 0: -1e+308: expected a size",
    ),
    "a far view": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [-1e7, 1e7, 0, 1e7]}",
        "view: [-10000000.0, 10000000.0, 0, 10000000.0]: expected",
    ),
    "a view that is a line": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [0, 1000, 0, 1]}",
        "one side at most 100 times the other",
    ),
    "a view of three": (
        A,
        PATHS,
        PATHS[:-1] + ", view: [0, 1, 0]}",
        "panels: 0: view: [0, 1, 0]: expected what is seen",
    ),
    "a limit of boxes": (
        A,
        BOXES,
        BOXES[:-1] + ", limit: 1e308}",
        "panels: 3: limit: 1e+308: expected a size from 1e-12 to 1e+12",
    ),
    "a limit of curvature": (
        *panel(
            "{kind: along_path, experiment: first, where: {method: mine}, pick: {lowest: length}, "
            "quantity: curvature, limit: 1e308}"
        ),
        "panels: 0: limit: 1e+308: expected a size",
    ),
    "a path far away": (
        *panel("{kind: paths, explicit: {curve: bezier, points: [[0, 0], [1e308, 1]]}}"),
        "points: 1: 0: 1e+308: expected",
    ),
    "a path beyond all workspaces": (
        *panel("{kind: paths, explicit: {curve: bezier, points: [[0, 0], [1e6, 1]]}}"),
        "explicit: points: expected coordinates of at most 100000 in absolute value",
    ),
    "a path of many points": (
        *panel(
            f"{{kind: paths, explicit: {{curve: bezier, points: "
            f"[{', '.join(['[0, 0], [1, 1]'] * 1000)}]}}}}"
        ),
        "explicit: points: 2000 entries; expected at most 100",
    ),
    "a path of places in space": (
        *panel("{kind: paths, explicit: {curve: bezier, points: [[0, 0, 0], [1, 1, 1]]}}"),
        "explicit: points: 0: [0, 0, 0]: expected [x, y]",
    ),
    "400 panels": (
        A,
        FIGURE,
        FIGURE + "{kind: workspace, workspace: room}, " * 400,
        "figures: paths: panels: 405 entries; expected at most 26",
    ),
    "400 panels in one": (
        *panel(f"{{kind: workspace, workspace: room, each: [{', '.join(['{title: a}'] * 400)}]}}"),
        "figures: paths: panels: 405 panels; expected at most 26",
    ),
    "40 panels in two": (
        *panel(
            ", ".join(
                [f"{{kind: workspace, workspace: room, each: [{', '.join(['{title: a}'] * 20)}]}}"]
                * 2
            )
        ),
        "figures: paths: panels: 45 panels; expected at most 26",
    ),
    "a table without rows that are told apart": (
        *table("index: [], columns: [value]"),
        "lengths: index: []: expected at least one column",
    ),
    "a label of another method": (
        A,
        "labels: {mine: my walk}",
        "labels: {mine: line}",
        "labels: mine: line: mine and line of experiment first would both be printed so",
    ),
    "a label of nothing": (
        A,
        "labels: {mine: my walk}",
        "labels: {mine_of: my walk}",
        "labels: mine_of: unknown; did you mean mine?",
    ),
    "a label of two problems": (
        A,
        "labels: {mine: my walk}",
        "labels: {across: way, back: way}",
        "labels: back: way: across and back of experiment both would both be printed so",
    ),
    "a label of 600 letters": (A, "my walk", "W" * 600, "artefacts.yaml: labels: mine: 'WWW"),
    "a label of blanks": (
        A,
        "my walk",
        "'   '",
        "artefacts.yaml: labels: mine: '   ': expected one line of text",
    ),
    "a title of blanks": (
        E,
        "title: Walks in a room",
        "title: '   '",
        "experiments.yaml: title: '   ': expected one line",
    ),
    "a title of a panel of 200 letters": (
        A,
        "title: mine",
        f"title: {'W' * 200}",
        "panels: 0: title: 'WWW",
    ),
    "a label of a value of 200 letters": (
        A,
        "label: length",
        f"label: {'W' * 200}",
        "values: 0: label: 'WWW",
    ),
    "a million decimals": (
        A,
        "decimals: 2},\n    {",
        "decimals: 1000000},\n    {",
        "values: 0: decimals: 1000000: expected how many decimals",
    ),
    "sixteen decimals": (
        A,
        "decimals: 2},\n    {",
        "decimals: 16},\n    {",
        "values: 0: decimals: 16: expected how many decimals are printed, a whole",
    ),
    # Names
    "a name with a newline": (
        E,
        "  more: {planner",
        '  "more\\n": {planner',
        "experiments.yaml: methods: more\\n: 'more\\n': expected a name",
    ),
    "a name of a problem with a newline": (
        E,
        "  swim: {work",
        '  "swim\\n": {work',
        "problems: swim\\n: 'swim\\n': expected a name",
    ),
    "a name of a device": (
        E,
        "  more: {planner",
        "  con: {planner",
        "methods: con: con: the name of a device on Windows",
    ),
    "a name of a device in a table": (
        A,
        "  printed: {title",
        "  lpt1: {title",
        "tables: lpt1: lpt1: the name of a device on Windows",
    ),
    "an id with a newline": (
        C,
        "id: C1,",
        'id: "C1\\n",',
        "claims: 0: id: 'C1\\n': expected C and a number",
    ),
    "an id of an assumption with a newline": (
        S,
        "id: O1,",
        'id: "O1\\n",',
        "assumptions: 0: id: 'O1\\n': expected O or M",
    ),
    "a map with braces": (
        E,
        "file: room.txt",
        "file: 'ro{scale}om.txt'",
        "workspaces: room: file: 'ro{scale}om.txt': expected",
    ),
    "a planner with braces": (
        E,
        "more: {planner: walk.py",
        "more: {planner: 'w{0}.py'",
        "methods: more: planner: 'w{0}.py': expected",
    ),
    "a map with a star": (
        E,
        "file: room.txt",
        "file: 'ro*.txt'",
        "workspaces: room: file: 'ro*.txt': expected",
    ),
    "a map of a drive": (
        E,
        "file: room.txt",
        "file: 'c:\\room.txt'",
        "workspaces: room: file: 'c:\\\\room.txt': expected",
    ),
    "a map of a device": (
        E,
        "file: room.txt",
        "file: maps/nul.txt",
        "workspaces: room: file: 'maps/nul.txt': expected",
    ),
    "a map with a blank at the end": (
        E,
        "file: room.txt",
        "file: 'room.txt '",
        "workspaces: room: file: 'room.txt ': expected",
    ),
    "published numbers in a folder": (
        A,
        "published: lengths.csv",
        "published: more/lengths.csv",
        "published: 'more/lengths.csv': expected a file",
    ),
    "published numbers of another kind": (
        A,
        "published: lengths.csv",
        "published: lengths.txt",
        "published: 'lengths.txt': expected a file in",
    ),
    "published numbers with braces": (
        A,
        "published: lengths.csv",
        "published: 'l{x}.csv'",
        "published: 'l{x}.csv': expected a file in the",
    ),
    "a preset of the name of a setting": (
        E,
        "workspaces:\n",
        "presets: {tries: {a: {}}}\nworkspaces:\n",
        "presets: tries: a planner's setting",
    ),
    "a preset of the name of a column": (
        E,
        "workspaces:\n",
        "presets: {length: {a: {}}}\nworkspaces:\n",
        "presets: length: a column of results",
    ),
    "a value of a preset with a slash": (
        E,
        "workspaces:\n",
        "presets: {p: {a/b: {}}}\nworkspaces:\n",
        "presets: p: a/b: 'a/b': expected a word",
    ),
    "a varied value with a slash": (
        E,
        "tries: [4, 8]",
        "tries: [4, a/b]",
        "both: vary: tries: 'a/b': is part of a run's name; expected",
    ),
    "a varied value with a comma": (
        E,
        "tries: [4, 8]",
        "tries: [4, 'a,b']",
        "both: vary: tries: 'a,b': is part of a run's name",
    ),
    "a varied value twice": (
        E,
        "tries: [4, 8]",
        "tries: [4, 4.0]",
        "both: vary: tries: [4, 4.0]: 4.0 is listed twice",
    ),
    **{
        f"a setting named {name}": (
            "walk.py",
            "tries: int",
            f"tries: int, {name}: int",
            f"walk.py: its setting {name} is a column of",
        )
        for name in (
            "bound",
            "least_length",
            "cpu_s",
            "straight_line",
            "layout",
            "arrival",
            "value",
            "statistic",
            "least_arrival",
        )
    },
    "a variant of itself": (
        E,
        "tries: 40}}",
        "tries: 40}, variant_of: more}",
        "methods: more: variant_of: more: unknown",
    ),
    # Sizes of experiments
    "a chunk of more than all repeats": (
        E,
        CHUNK,
        CHUNK.replace("full: 6", "full: 1000000"),
        "first: chunk: full: 1000000: expected at most 12",
    ),
    "fewer runs that are half a chunk": (
        E,
        CHUNK,
        f"{CHUNK}, fewer: {{method: {{mine: 3}}}}",
        "first: fewer: method: mine: 3: expected a multiple of 6, the chunk, below 12, the repeats",
    ),
    "no fewer runs": (
        E,
        CHUNK,
        f"{CHUNK}, fewer: {{method: {{mine: 12}}}}",
        "first: fewer: method: mine: 12: expected a multiple of 6, the chunk, below 12",
    ),
    "fewer runs by an unknown factor": (
        E,
        CHUNK,
        f"{CHUNK}, fewer: {{methods: {{mine: 6}}}}",
        "experiments: first: fewer: methods: unknown; did you mean method?",
    ),
    "fewer runs of an unknown method": (
        E,
        CHUNK,
        f"{CHUNK}, fewer: {{method: {{mined: 6}}}}",
        "experiments: first: fewer: method: mined: unknown; did you mean mine?",
    ),
    "a short time limit": (
        E,
        CHUNK,
        f"{CHUNK}, time_limit: 1e-9",
        "experiments: first: time_limit: 1e-09: expected seconds after which",
    ),
    "a time limit of half a second": (
        E,
        CHUNK,
        f"{CHUNK}, time_limit: 0.5",
        "first: time_limit: 0.5: expected seconds after which",
    ),
    "a huge reference": (
        E,
        "target_cell: 63}",
        "target_cell: 63, reference: 1e308}",
        "problems: across: reference: 1e+308: expected a size",
    ),
    "a long reference": (
        E,
        "target_cell: 63}",
        "target_cell: 63, reference: 1e9}",
        "problems: across: reference: 1000000000.0: expected",
    ),
    "a reference below the straight line": (
        E,
        "target_cell: 63}",
        "target_cell: 63, reference: 3}",
        "problems: across: reference: 3: expected",
    ),
    "a tiny cell": (
        E,
        "cell: 1,",
        "cell: 1e-320,",
        "room: cell: 1e-320: expected the side of a cell, a number of at least 1e-6",
    ),
    "a unit of nothing": (
        E,
        "cell: 1, unit: m",
        "cell: 1, unit: '-'",
        "workspaces: room: unit: '-': expected",
    ),
    "a unit of blanks": (
        E,
        "cell: 1, unit: m",
        "cell: 1, unit: ' '",
        "workspaces: room: unit: ' ': expected",
    ),
    "a unit that is a group": (
        E,
        "cell: 1, unit: m",
        "cell: 1, unit: '\\1'",
        "workspaces: room: unit: '\\\\1': expected",
    ),
    "a long unit": (
        E,
        "cell: 1, unit: m",
        f"cell: 1, unit: {'m' * 200}",
        "workspaces: room: unit: 'mmm",
    ),
    "a circle outside the border": (
        E,
        "[[5, 5, 1]]",
        "[[5, 5, 1], [50, 50, 3]]",
        "workspaces: pond: circles: circle 1: lies outside the bounds",
    ),
    "a circle of 1e308": (
        E,
        "[[5, 5, 1]]",
        "[[5, 5, 1e308]]",
        "workspaces: pond: circles: 0: 2: 1e+308: expected a size",
    ),
    "many conditions": (
        E,
        "tries: [4, 8]",
        f"tries: [{', '.join(map(str, range(1, 1500)))}]",
        "both: vary: tries: 1499 entries; expected at most 1000",
    ),
    # Claims
    "a group compared with itself": (
        *lower("groups: [mine], than: [mine], direction: higher, margin: 0.1"),
        "claims: 0: checks: 0: than: mine: is compared with itself",
    ),
    "a group among others": (
        *lower("groups: [mine, line], than: [line], direction: higher, margin: 0.1"),
        "line: is compared with itself",
    ),
    "a tier twice": (
        C,
        "test: lower, experiment: first, metric: length,\n       " + LOWER,
        "test: lower, experiment: first, metric: length, order: [[mine], [line], [mine, line]], "
        "direction: lower, margin: 0.1",
        "claims: 0: checks: 0: order: line: is compared with itself",
    ),
    "equal groups": (
        C,
        "test: lower, experiment: first, metric: length,\n       " + LOWER,
        "test: equal_within, experiment: first, metric: length, groups: [mine], than: [mine], "
        "statistic: mean, margin: 0.1",
        "claims: 0: checks: 0: than: mine: is compared with itself",
    ),
    "methods that are averaged": (
        *lower(f"{LOWER}, pool: [method]"),
        "claims: 0: checks: 0: across: method: is in pool already",
    ),
    "repeats that are averaged": (
        *lower(f"{LOWER}, pool: [repeat]"),
        "claims: 0: checks: 0: replicate: repeat: is in pool already",
    ),
    "a column pooled and told apart": (
        *lower(f"{LOWER}, every: [problem], pool: [problem]"),
        "pool: problem: is in every already",
    ),
    "replicates that are methods": (
        *lower(f"{LOWER}, replicate: method"),
        "replicate: method: is in across already",
    ),
    "variants of an unknown method": (
        C,
        "checks: [\n      {test: lower",
        "variants: {method: [mine, mne]}, checks: [\n      {test: lower",
        "C1: variants: method: mne: unknown; did you mean mine?",
    ),
    "variants of an unknown column": (
        C,
        "checks: [\n      {test: lower",
        "variants: {zzz: [1, 2]}, checks: [\n      {test: lower",
        "C1: variants: zzz: unknown",
    ),
    "variants by an outcome": (
        C,
        "checks: [\n      {test: lower",
        "variants: {length: [1, 2]}, checks: [\n      {test: lower",
        f"C1: variants: length: 1: a number {BY_VALUE}",
    ),
    "variants of an absent metric": (
        C,
        "checks: [\n      {test: lower",
        "variants: {metric: [gap, length]}, checks: [\n      {test: lower",
        "C1: variants: metric: gap: not in a check; expected first what the checks name: length",
    ),
    "variants of an absent experiment": (
        C,
        "checks: [\n      {test: lower",
        "variants: {experiment: [both, first]}, checks: [\n      {test: lower",
        "C1: variants: experiment: both: not in a check; expected first",
    ),
    "variants of printed numbers": (
        C,
        "checks: [\n      {test: published",
        "variants: {method: [mine, line]}, checks: [\n      {test: published",
        "C3: variants: method: no check of the claim is about runs",
    ),
    "variants of unequal length": (
        C,
        "checks: [\n      {test: lower",
        "variants: {method: [[mine, line], [mine]]}, checks: [\n      {test: lower",
        "variants: method: expected values, or lists of them that are equally long",
    ),
    "many variants": (
        C,
        "checks: [\n      {test: lower",
        f"variants: {{repeat: {list(range(101))}}}, checks: [\n      {{test: lower",
        "variants: expected at most 100 combinations",
    ),
    "a printed margin without printed numbers": (
        C,
        TREND,
        TREND.replace("0.1", "{published: 0.1}"),
        "C2: checks: 0: margin: published: no table of both has printed",
    ),
    "a tiny margin": (
        *lower(LOWER.replace("0.1", "1e-320")),
        "claims: 0: checks: 0: margin: 1e-320: expected a size from 1e-12",
    ),
    "a huge least effect": (
        *lower(f"{LOWER}, least: 1e308"),
        "claims: 0: checks: 0: least: 1e+308: expected a size",
    ),
    "many checks": (
        *lower("}, {test: lower, experiment: first, metric: length, ".join([LOWER] * 102)),
        "claims: 0: checks: 102 entries; expected at most 100",
    ),
    "an increase of zero": (
        C,
        "form: difference, equals: 1.1,\n       of: [{table: lengths, method: mine, statistic: "
        "median}",
        "form: increase_percent, equals: 1.1, of: [{table: words, name: b}",
        "of: 0: table=words, name=b: is 0; expected",
    ),
    # Assumptions
    "an alternative that is the default": (
        S,
        "alternatives: [10]",
        "alternatives: [20]",
        "assumptions: 0: alternatives: 20: is the default",
    ),
    "an alternative that is the default as a decimal": (
        S,
        "alternatives: [10]",
        "alternatives: [20.0]",
        "alternatives: 20.0: is the default",
    ),
    "an alternative twice": (
        S,
        "alternatives: [10]",
        "alternatives: [10, 10.0]",
        "alternatives: [10, 10.0]: 10.0 is listed twice",
    ),
    "an alternative with a slash": (
        S,
        "alternatives: [10]",
        "alternatives: [a/b]",
        "alternatives: 'a/b': is part of a file's name",
    ),
    "an unknown method beside": (
        S,
        "with: {mine: {}}",
        "with: {mne: {tries: 3}}",
        "O1: with: mne: unknown; did you mean mine?",
    ),
    "an unknown setting beside": (
        S,
        "with: {mine: {}}",
        "with: {mine: {trys: 3}}",
        "O1: with: mine: trys: unknown",
    ),
    "the same setting beside": (
        S,
        "with: {mine: {}}",
        "with: {mine: {tries: 3}}",
        "O1: with: mine: tries: unknown",
    ),
    "another method beside": (
        S,
        "with: {mine: {}}",
        "with: {line: {tries: 3}}",
        "O1: with: line: unknown; did you mean mine?",
    ),
    "1000 alternatives": (
        S,
        "alternatives: [10]",
        f"alternatives: [{', '.join(map(str, range(100, 1100)))}]",
        "alternatives: 1000 entries; expected at most 100",
    ),
    # Published numbers
    "interpretations of an unknown metric": (
        *table(f"reads: {{lenght: length}}, {LENGTHS}"),
        "lengths: reads: lenght: unknown; did you mean length?",
    ),
    "interpretations of no numbers": (
        A,
        "published: lengths.csv, values",
        "reads: {length: length}, values",
        "reads: the table has no published numbers",
    ),
    "an order of no numbers": (
        *table(
            f"monotone: [{{metric: length, statistic: min, along: method, direction: up, because: "
            f"so}}], {LENGTHS}"
        ),
        "lengths: monotone: 0: ",
    ),
    **{
        f"a value {value[:20]}": (
            T,
            ROW,
            f"mine,length,median,10,m,{value}",
            f"lengths.csv: line 2: value: {value[:30]!r}; {DIGITS}",
        )
        for value in (
            "1_3.1",
            "１３.1",
            "0x10",
            "nan",
            "inf",
            "1e99",
            "1e-400",
            "1" * 300,
            "13,1".replace(",", " "),
            "+-3",
            "1e13",
            " 13.1",
            "",
        )
    },
    "a negative length": (
        T,
        ROW,
        "mine,length,median,10,m,-13.1",
        "lengths.csv: line 2: value: -13.1: expected a number of at least 0",
    ),
    "a share above 1": (
        T,
        ",0.9",
        ",90",
        "lengths.csv: line 4: value: 90: "
        "expected a number of at least 0, at most 1, as the share of",
    ),
    "a negative share": (
        T,
        ",0.9",
        ",-0.1",
        "lengths.csv: line 4: value: -0.1: expected a number of at least 0",
    ),
    "half a count": (
        T,
        "count,10,-,9",
        "count,10,-,8.5",
        "line 5: value: 8.5: expected a whole number, as the count of feasible is",
    ),
    "a share of lengths": (
        C,
        "{test: share, experiment: first, metric: feasible",
        "{test: share, experiment: first, metric: length",
        "checks: 0: event: missing key; length is no truth: expected one of below, above, "
        "at_most, at_least, equals",
    ),
    "a count above n": (
        T,
        "10,-,9\n",
        "10,-,11\n",
        "lengths.csv: line 5: value: 11: expected a number of at least 0, at most 10",
    ),
    **{
        f"n {n[:12]}": (
            T,
            ROW,
            f"mine,length,median,{n},m,13.1",
            f"lengths.csv: line 2: n: {n[:30]!r}; expected how many runs",
        )
        for n in ("0", "-1", "1.5", "1000001", "100000000", "9" * 5000, "１０", "ten", "1e2")
    },
    "a repeat that is not run": (
        T,
        "method,metric,statistic,n,unit,value\nmine,",
        "repeat,metric,statistic,n,unit,value\n99,",
        "lengths.csv: line 2: repeat: '99': unknown",
    ),
    "a word for a number": (
        T,
        "method,metric,statistic,n,unit,value\nmine,",
        "tries,metric,statistic,n,unit,value\nabc,",
        "lengths.csv: line 2: tries: 'abc': unknown",
    ),
    "another number for a number": (
        T,
        "method,metric,statistic,n,unit,value\nmine,",
        "tries,metric,statistic,n,unit,value\n21,",
        "lengths.csv: line 2: tries: '21': unknown",
    ),
    "an unknown workspace": (
        T,
        "method,metric,statistic,n,unit,value\nmine,",
        "workspace,metric,statistic,n,unit,value\npond,",
        "lengths.csv: line 2: workspace: 'pond': unknown",
    ),
    "many rows": (
        T,
        ROW,
        "\n".join([ROW] * 6000),
        "lengths.csv: line 5002: expected at most 5000 rows",
    ),
    "many columns": (
        "published/other.csv",
        "name,value\n",
        ",".join(f"c{n}" for n in range(200)) + "\n",
        "other.csv: line 1: 200 columns",
    ),
    "bytes beside": (
        "published/other.csv",
        "b,2",
        "\x01,2",
        "other.csv: line 3: has the character '\\x01'",
    ),
    "a ragged table": (
        "published/other.csv",
        "b,2",
        "b,2,3",
        "other.csv: line 3: 3 values; expected 2 values, one a column",
    ),
    "a short row": (
        "published/other.csv",
        "b,2",
        "b",
        "other.csv: line 3: 1 values; expected 2 values",
    ),
    "an empty table": (
        "published/other.csv",
        "name,value\na,1\nb,2\n",
        "",
        "other.csv: line 1: the file is empty",
    ),
    "a table without rows": (
        "published/other.csv",
        "a,1\nb,2\n",
        "",
        "other.csv: line 1: has no rows below it",
    ),
    "a column without a name": (
        "published/other.csv",
        "name,value",
        "name,",
        "other.csv: line 1: column 2 has no name",
    ),
    "a column twice": (
        "published/other.csv",
        "name,value",
        "name,name",
        "other.csv: line 1: column name is listed twice",
    ),
    "an open quote": ("published/other.csv", "b,2", '"b,2', "other.csv: line 3: not csv"),
}


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """The study without a fault."""
    folder = tmp_path_factory.mktemp("sound") / "walks"
    for name, text in {
        **FILES,
        "published/words.csv": "name,value\na,x\nb,0\n",
        "published/names.csv": "name,word\na,b\n",
    }.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


@pytest.fixture
def folder(sound, tmp_path):
    """A copy to be spoilt."""
    return Path(shutil.copytree(sound, tmp_path / "walks"))


def test_a_study_without_a_fault(folder):
    assert reading.load([folder])["walks"].title == "Walks in a room"


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_one_line(fault, folder, monkeypatch):
    name, old, new, expected = FAULTS[fault]
    if name != "walk.py":
        # The planner harms nobody, so it needs no processes of its own: they would take most of the
        # time.
        monkeypatch.setattr(watchdog, "verdict", lambda name, judge, limit: judge())
    file = folder / name
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8", newline="")
    began = time.process_time()
    with pytest.raises(Fault) as caught:
        reading.load([folder])
    message = str(caught.value)
    assert expected in message
    assert message.isprintable()
    assert len(message) < 1500
    assert re.search(r"(experiments|artefacts|claims|assumptions)\.yaml|\.csv", message)
    assert time.process_time() - began < 5


def test_a_planner_with_dots_in_its_name(folder):
    """Its code is part of the params of its runs."""
    (folder / "walk.py").rename(folder / "walk.v2.py")
    file = folder / E
    file.write_text(file.read_text().replace("walk.py", "walk.v2.py"))
    study = reading.load([folder])
    before = digest.source_digest(str(folder / "walk.v2.py"))
    assert targets.run_params(study, "full", "walks", "first", "mine", "0")["job"][
        "planner"
    ].endswith("walk.v2.py")
    (folder / "walk.v2.py").write_text(
        (folder / "walk.v2.py").read_text().replace("pass", "return None")
    )
    digest._reached.cache_clear()
    digest._syntax.cache_clear()
    assert digest.source_digest(str(folder / "walk.v2.py")) != before


def test_numbers_without_claims_are_audited(folder):
    (folder / C).unlink()
    (folder / S).unlink()
    made = targets.files_of_scale(reading.load([folder]), "full")
    assert "results/full/walks/audit.csv" in made
    assert "results/full/summary.md" in made
    assert "results/full/walks/claims.csv" not in made


def test_a_summary_without_claims():
    claims = summary.read_claims([])
    numbers = pd.DataFrame({"study": ["walks"], "counted": [True], "verdict": ["agrees"]})
    assert headline.outcome(numbers, claims).loc[
        "walks", ["numbers", "agrees", "supported"]
    ].to_list() == [1, 1, 0]


def test_a_folder_of_a_study_with_braces(folder):
    other = folder.parent / "a{b}" / "walks"
    shutil.copytree(folder, other)
    with pytest.raises(Fault, match="Snakemake reads braces as a pattern"):
        reading.check_names(reading.load([other]), [])


@pytest.mark.parametrize("name", ["con", "w" * 101, "walks\n"])
def test_a_name_of_a_study_that_no_folder_can_have(name, folder):
    study = reading.load([folder])["walks"]
    with pytest.raises(Fault, match="not a name of a study"):
        reading.check_names({name: study}, [])


@pytest.mark.parametrize("name", ["mean", "median", "iqr", "std"])
def test_predictions_of_a_million_runs_are_those_of_many(name):
    """Beyond some size an experiment hardly errs by itself, and costs no more to predict."""
    values = np.random.default_rng(1).normal(size=300)
    many = statistics.predicted(name, values, statistics.MOST_PREDICTED, np.random.default_rng(2))
    more = statistics.predicted(name, values, 1_000_000, np.random.default_rng(2))
    assert np.quantile(more, [0.025, 0.5, 0.975]) == pytest.approx(
        np.quantile(many, [0.025, 0.5, 0.975]), abs=0.08
    )
    drawn = statistics.resampled(name, values, 1_000_000, np.random.default_rng(2))
    assert drawn.std() < 0.1 * more.std()


def test_a_million_runs_of_one_group():
    groups = [np.random.default_rng(number).normal(number, size=20) for number in range(4)]
    drawn = statistics.predicted_within("mean", groups, 1_000_000, np.random.default_rng(0))
    means = sorted(group.mean() for group in groups)
    assert np.quantile(drawn, [0.1, 0.4, 0.6, 0.9]) == pytest.approx(means, abs=0.05)


def test_a_reference_below_the_shortest_path_is_told():
    runs = pd.DataFrame(
        {
            "problem": ["across"],
            "length": [11.0],
            "reference": [9.9],
            "bound": [10.3],
            "feasible": [True],
        }
    )
    with pytest.raises(
        ValueError, match=r"problem across: reference 9.9 lies below the exact shortest length 10.3"
    ):
        metrics.values(runs, "gap_reference", {})
    assert metrics.values(runs.assign(reference=10.29), "gap_reference", {}).iloc[0] > 0


def test_a_metric_without_its_column_is_told():
    runs = pd.DataFrame({"problem": ["across"], "feasible": [True]})
    with pytest.raises(
        ValueError, match="metric bad_samples: no run has it: their table has no column bad_samples"
    ):
        metrics.values(runs, "bad_samples", {})


def test_dollars_begin_no_formula():
    assert sheet._plain("$\\frac{1}{$ x") == "\\$\\frac{1}{\\$ x"
