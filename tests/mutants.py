"""Plants faults in a copy of the tree, one at a time: another operator, a term or a factor less,
`min` for `max`, a number one higher. They are drawn from the code of claims, numbers and runs, with
the commit as seed. The tests that are nearest to what has the fault must fail.

    python tests/mutants.py [NUMBER [WORD]]

NUMBER: of faults, 40 by default. WORD: only in files whose path contains it. Exits with 1 unless
nine in ten are caught; those of tests/data/equivalent_mutants.csv change nothing and are left out.
"""

import ast
import csv
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import NamedTuple

from bezierplan.machine import digest

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "bezierplan"
PLACES = tuple(
    f"src/bezierplan/{place}"
    for place in ("analysis/claims/", "analysis/numbers/", "analysis/measures.py", "running/")
)
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", ".snakemake", "results", "__pycache__")
OPERATORS = {ast.Lt: ast.LtE, ast.Gt: ast.GtE, ast.Eq: ast.NotEq, ast.And: ast.Or}
NAMES = {"min": "max", "minimum": "maximum", "argmin": "argmax", "any": "all", "mean": "median"}
for pairs in (OPERATORS, NAMES):
    pairs |= {new: old for old, new in pairs.items()}
NEAREST = 6
"""So many tests are asked."""


class Fault(NamedTuple):
    """What stands in a file from one byte to another, and what takes its place."""

    file: str
    old: str
    new: str
    begin: int
    end: int
    line: int


def other(node: ast.AST) -> ast.AST | None:
    """Return what may take the place of a piece of code."""
    match node:
        case ast.Compare(left, [op], right) if type(op) in OPERATORS:
            return ast.Compare(left, [OPERATORS[type(op)]()], right)
        case ast.BoolOp(op, values):
            return ast.BoolOp(OPERATORS[type(op)](), values)
        case ast.BinOp(left, ast.Add() | ast.Sub() | ast.Mult() | ast.Div()):
            return left
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            return operand
        case ast.Name("min" | "max" | "any" | "all" as name):
            return ast.Name(NAMES[name])
        case ast.Attribute(value, name) if name in NAMES:
            return ast.Attribute(value, NAMES[name])
        case ast.Constant(int() as number) if not isinstance(number, bool):
            return ast.Constant(number + 1)
    return None


def faults(file: str) -> Iterator[Fault]:
    """Yield all faults that a file can have; types, messages and decorators have none."""
    source = (ROOT / file).read_bytes()
    lines = source.splitlines(keepends=True)
    todo: list[ast.AST] = [ast.parse(source)]
    while todo:
        node = todo.pop()
        if new := other(node):
            places = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
            begin, end = (len(b"".join(lines[: line - 1])) + column for line, column in places)
            yield Fault(
                file, source[begin:end].decode(), f"({ast.unparse(new)})", begin, end, node.lineno
            )
        for name, value in ast.iter_fields(node):
            if name not in ("annotation", "returns", "decorator_list", "exc"):
                parts = value if isinstance(value, list) else [value]
                todo += [part for part in parts if type(part) not in (ast.JoinedStr, str)]
        todo = [part for part in todo if isinstance(part, ast.AST)]


def nearest(fault: Fault) -> list[str]:
    """Return the tests that name the module that has a fault, and then those that import the least
    beside it; none that starts a whole workflow.
    """
    found, home, stem = [], ROOT / fault.file, Path(fault.file).stem
    # Kinds of checks are imported by their names in a study.
    home = home.parents[1] / "check.py" if home.parent.name == "kinds" else home
    # What is reached leaves out modules that change no result, such as that of logs.
    neutral = ".".join(home.relative_to(SOURCE.parent).with_suffix("").parts) in digest.NEUTRAL
    for test in ROOT.glob("tests/test_*.py"):
        text, reached = test.read_text(), digest.find_sources(str(test))
        workflow = re.search("^import starts", text, re.MULTILINE)
        if (home in reached or (neutral and f" import {stem}\n" in text)) and not workflow:
            found.append((stem not in text, len(reached), f"tests/{test.name}"))
    return [test for *_, test in sorted(found)[:NEAREST]]


def failure(tests: Collection[str], tree: Path) -> str:
    """Return the end of what some tests say if one fails in a tree, or has no end."""
    pytest = [sys.executable, "-m", "pytest", "-q", "-x", "-m", "not rare", *tests]
    try:
        done = subprocess.run(
            pytest, cwd=tree, capture_output=True, text=True, timeout=600 * len(tests)
        )
    except subprocess.TimeoutExpired:
        return "no end"
    # 5: every test of a file is rare, or skipped.
    return done.stdout[-500:] if done.returncode not in (0, 5) else ""


def is_caught(fault: Fault, tree: Path) -> bool:
    """Return whether a test fails with a fault in a tree."""
    file = tree / fault.file
    clean = file.read_bytes()
    file.write_bytes(clean[: fault.begin] + fault.new.encode() + clean[fault.end :])
    # One after the other, because the nearest finds most.
    caught = any(failure([test], tree) for test in nearest(fault))
    file.write_bytes(clean)
    word, old = "caught" if caught else "SURVIVES", " ".join(fault.old.split())
    print(f"{word:10}{fault.file}:{fault.line}: {old} -> {fault.new}", flush=True)
    return caught


def main(number: str = "40", word: str = "") -> int:
    """Plant so many faults; return the exit status."""
    with (ROOT / "tests/data/equivalent_mutants.csv").open() as rows:
        same = {(row["file"], row["old"], row["new"]) for row in csv.DictReader(rows)}
    files = sorted(str(file.relative_to(ROOT)) for file in SOURCE.rglob("*.py"))
    chosen = [file for file in files if file.startswith(PLACES) and word in file]
    possible = [fault for file in chosen for fault in faults(file) if fault[:3] not in same]
    commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True).stdout
    drawn = random.Random(commit).sample(possible, min(int(number), len(possible)))
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(shutil.copytree(ROOT, Path(folder, "tree"), ignore=LEFT_OUT))
        (tree / "results").symlink_to(ROOT / "results")
        if said := failure({test for fault in drawn for test in nearest(fault)}, tree):
            sys.exit(f"a test fails without a fault:\n{said}")
        caught = sum(is_caught(fault, tree) for fault in drawn)
    print(f"{caught} of {len(drawn)} faults caught")
    return int(caught < 0.9 * len(drawn))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
