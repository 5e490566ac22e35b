"""Plants faults in a copy of the tree, one at a time: another operator, a term or a factor less,
`min` for `max`, a number one higher. They are drawn from the code of claims, numbers and runs, with
the commit as seed. The tests that import what has the fault must fail.

    python tests/mutants.py [--number N] [--seed WORD] [WORD ...]

WORD: only faults of files whose path contains one of the words. Exits with 1 unless nine in ten are
caught; those of tests/data/equivalent_mutants.csv change nothing and are left out.
"""

import argparse
import ast
import csv
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from bezierplan.machine import digest

ROOT = Path(__file__).resolve().parents[1]
PLACES = ("analysis/claims/", "analysis/numbers/", "analysis/measures.py", "running/")
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", ".snakemake", "results", "__pycache__")
OPERATORS = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.And: ast.Or}
OPERATORS |= {ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Or: ast.And}
NAMES = {"min": "max", "minimum": "maximum", "argmin": "argmax", "any": "all", "mean": "median"}
NAMES |= {new: old for old, new in NAMES.items()}


class Fault(NamedTuple):
    """What stands in a file from one byte to another, and what takes its place."""

    file: str
    old: str
    new: str
    place: tuple[int, int]
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.old} -> {self.new}"


def others(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what may take the place of a piece of code."""
    match node:
        case ast.Compare(left, [op], right) if type(op) in OPERATORS:
            yield ast.Compare(left, [OPERATORS[type(op)]()], right)
        case ast.BoolOp(op, values):
            yield ast.BoolOp(OPERATORS[type(op)](), values)
        case ast.BinOp(left, ast.Add() | ast.Sub() | ast.Mult() | ast.Div(), right):
            if not any(isinstance(getattr(side, "value", 0), str) for side in (left, right)):
                yield left
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield operand
        case ast.Call(ast.Name(name), given, more) if name in NAMES:
            yield ast.Call(ast.Name(NAMES[name]), given, more)
        case ast.Call(ast.Attribute(value, name), given, more) if name in NAMES:
            yield ast.Call(ast.Attribute(value, NAMES[name]), given, more)
        case ast.Constant(int() as number) if not isinstance(number, bool):
            yield ast.Constant(number + 1)


def faults(file: str, source: bytes) -> Iterator[Fault]:
    """Yield all faults that a file can have; types, messages and decorators have none."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    todo: list[ast.AST] = [ast.parse(source)]
    while todo:
        node = todo.pop()
        for other in others(node):
            begin = starts[node.lineno - 1] + node.col_offset
            end = starts[node.end_lineno - 1] + node.end_col_offset
            old = " ".join(source[begin:end].decode().split())
            yield Fault(file, old, f"({ast.unparse(other)})", (begin, end), node.lineno)
        for name, value in ast.iter_fields(node):
            if name not in ("annotation", "returns", "decorator_list", "exc"):
                parts = value if isinstance(value, list) else [value]
                todo += [part for part in parts if isinstance(part, ast.AST)]
        todo = [part for part in todo if not isinstance(part, ast.JoinedStr)]


def tests_of(fault: Fault) -> list[str]:
    """Return the tests that import what has a fault, and then those that import a module of its
    folder which needs it; none that starts a whole workflow.
    """
    module = ".".join(Path(fault.file).with_suffix("").parts[1:])
    folder = module.rpartition(".")[0].removesuffix(".kinds")
    found = []
    for test in sorted((ROOT / "tests").glob("test_*.py"), key=lambda test: test.stat().st_size):
        text = test.read_text()
        nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
        known = {f"{node.module}.{name.name}" for node in nodes for name in node.names}
        known |= {node.module for node in nodes}
        near = [name for name in known if name.startswith(folder) and digest._module(name).file()]
        needing = [name for name in near if ROOT / fault.file in digest.sources(name)]
        if (needing or (near and ".kinds." in module)) and "import starts" not in text:
            found.append((module not in known, f"tests/{test.name}"))
    return [test for _, test in sorted(found, key=lambda each: each[0])]


def fails(tests: Iterable[str], tree: Path) -> bool:
    """Return whether one of some tests fails in a tree, or has no end."""
    pytest = [sys.executable, "-m", "pytest", "-q", "-x", "-m", "not rare", *tests]
    try:
        return subprocess.run(pytest, cwd=tree, capture_output=True, timeout=1800).returncode != 0
    except subprocess.TimeoutExpired:
        return True


def is_caught(fault: Fault, tree: Path) -> bool:
    """Return whether a test fails with a fault in a tree."""
    file, (begin, end) = tree / fault.file, fault.place
    clean = file.read_bytes()
    file.write_bytes(clean[:begin] + fault.new.encode() + clean[end:])
    caught = fails(tests_of(fault), tree)
    file.write_bytes(clean)
    print(f"{'caught' if caught else 'SURVIVES':10}{fault}", flush=True)
    return caught


def every(words: list[str]) -> list[Fault]:
    """Return the faults of files whose paths have one of the words that change something."""
    with (ROOT / "tests/data/equivalent_mutants.csv").open() as rows:
        same = {(row["file"], row["old"], row["new"]) for row in csv.DictReader(rows)}
    source = ROOT / "src/bezierplan"
    files = [str(file.relative_to(source)) for file in sorted(source.rglob("*.py"))]
    chosen = [file for file in files if file.startswith(PLACES)]
    if words:
        chosen = [file for file in chosen if any(word in file for word in words)]
    names = [f"src/bezierplan/{file}" for file in chosen]
    found = [fault for name in names for fault in faults(name, (ROOT / name).read_bytes())]
    return [fault for fault in found if fault[:3] not in same]


def main() -> int:
    """Run the faults that the command line asks for; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    parser.add_argument("--seed", default=head.stdout)
    parser.add_argument("--number", type=int, default=40)
    parser.add_argument("words", nargs="*", metavar="WORD")
    asked = parser.parse_args()
    possible = every(asked.words)
    drawn = random.Random(asked.seed).sample(possible, min(asked.number, len(possible)))
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(shutil.copytree(ROOT, Path(folder, "tree"), ignore=LEFT_OUT))
        (tree / "results").symlink_to(ROOT / "results")
        if fails({test for fault in drawn for test in tests_of(fault)}, tree):
            sys.exit("a test fails without a fault")
        caught = sum(is_caught(fault, tree) for fault in drawn)
    print(f"{caught} of {len(drawn)} faults caught")
    return int(caught < 0.9 * len(drawn))


if __name__ == "__main__":
    sys.exit(main())
