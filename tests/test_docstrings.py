"""Docstrings name modules, functions and attributes that exist; those of public names describe each
parameter and attribute.
"""

import ast
import inspect
import re
from functools import cache
from pathlib import Path

import pytest
from numpydoc.docscrape import NumpyDocString

from bezierplan import api, planners
from bezierplan.analysis import metrics, statistics
from bezierplan.geometry import checker, region, shortest_paths
from bezierplan.geometry.shortest_paths import graph
from bezierplan.workspaces import problem

PACKAGE = Path(__file__).parents[1] / "src" / "bezierplan"
FILES = sorted(PACKAGE.rglob("*.py"))
# A name with dots in backticks, perhaps with what it is called with.
NAME = re.compile(r"`([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+)(?:\([^`]*\))?`")
# First parts of names that are not of this package, and last parts of names of files.
FOREIGN = {"bp", "np", "object", "properties", "pyarrow", "rng", "scipy"}
ENDINGS = {"csv", "json", "md", "parquet", "py", "svg", "txt", "yaml"}


def dotted(file: Path) -> tuple[str, ...]:
    """The parts of a module's name."""
    parts = file.relative_to(PACKAGE).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


# Where a name may begin: with any of the parts of a module's own.
MODULES: dict[tuple[str, ...], list[Path]] = {}
for each in FILES:
    for start in range(len(dotted(each))):
        MODULES.setdefault(dotted(each)[start:], []).append(each)


@cache
def tree(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


def defined(body: list[ast.stmt]) -> dict[str, ast.stmt]:
    """The names that a module or class defines or imports, with how."""
    found: dict[str, ast.stmt] = {}
    for node in body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                found[name] = node
            case ast.Assign(targets=targets):
                found |= {target.id: node for target in targets if isinstance(target, ast.Name)}
            case ast.AnnAssign(target=ast.Name(id=name)):
                found[name] = node
            case ast.Import(names=names) | ast.ImportFrom(names=names):
                found |= {alias.asname or alias.name: node for alias in names}
    return found


@cache
def classes() -> dict[str, list[ast.ClassDef]]:
    """The classes of all modules, by name."""
    found: dict[str, list[ast.ClassDef]] = {}
    for file in FILES:
        for node in tree(file).body:
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(node)
    return found


def is_there(name: str) -> bool:
    """Whether a name is that of a module, of what a module defines, or of an attribute of a
    class.
    """
    parts = tuple(name.removeprefix("bezierplan.").split("."))
    if any(parts[1] in defined(each.body) for each in classes().get(parts[0], [])):
        return True
    return parts in MODULES or any(
        _holds(tree(file).body, parts[end:])
        for end in range(1, len(parts))
        for file in MODULES.get(parts[:end], [])
    )


def _holds(body: list[ast.stmt], parts: tuple[str, ...]) -> bool:
    node = defined(body).get(parts[0])
    return node is not None and (
        len(parts) == 1 or not isinstance(node, ast.ClassDef) or _holds(node.body, parts[1:])
    )


def named(file: Path) -> set[str]:
    """The names with dots in the docstrings of a file, without foreign ones and names of files."""
    texts = [
        node.value.value
        for node in ast.walk(tree(file))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    ]
    names = {name for text in texts if isinstance(text, str) for name in NAME.findall(text)}
    return {
        name
        for name in names
        if name.split(".")[0] not in FOREIGN and name.rpartition(".")[2] not in ENDINGS
    }


# Every process that runs tests collects them all, so the files are parsed only when a test runs.
@pytest.mark.parametrize(
    "file",
    [file for file in FILES if NAME.search(file.read_text(encoding="utf-8"))],
    ids=lambda file: str(file.relative_to(PACKAGE)),
)
def test_names_in_docstrings_exist(file):
    assert [name for name in sorted(named(file)) if not is_there(name)] == []


def test_a_name_that_is_gone_is_found():
    assert is_there("bezierplan.running.columns.Outcome.length")
    assert is_there("columns.Outcome")
    assert is_there("shortest_paths.graph")
    assert not is_there("columns.Outcome.width")
    assert not is_there("columns.outcome")
    assert not is_there("problem.Plan")


# What users and other programs see: sections of its docstrings name all that there is, in its
# order.
TUPLES = [
    *(
        planners.Plan,
        problem.Path,
        problem.Problem,
        checker.Check,
        graph.Bound,
        metrics.Metric,
        statistics.Prediction,
    ),
    *(region.GridRegion, region.CircleRegion, region.PolygonRegion),
]
FUNCTIONS = [
    *(api.read_map, api.plan, api.check, api.shortest_path, api.results, api.replay),
    *(
        checker.check,
        shortest_paths.shortest_path,
        shortest_paths.least_length,
        region.region,
        region.blocks,
    ),
    *(
        metrics.values,
        metrics.unit,
        statistics.statistic,
        statistics.interval,
        statistics.prediction,
    ),
]


def section(documented, name):
    """The names in a section of a docstring, without stars."""
    listed = NumpyDocString(inspect.getdoc(documented))[name]
    return [each.strip().lstrip("*") for entry in listed for each in entry.name.split(",")]


@pytest.mark.parametrize("documented", TUPLES, ids=lambda each: each.__name__)
def test_every_attribute_is_described(documented):
    assert section(documented, "Attributes") == list(documented._fields)


@pytest.mark.parametrize(
    "documented", FUNCTIONS, ids=lambda each: f"{each.__module__}.{each.__name__}"
)
def test_every_parameter_is_described(documented):
    assert section(documented, "Parameters") == list(inspect.signature(documented).parameters)
    assert section(documented, "Returns")
