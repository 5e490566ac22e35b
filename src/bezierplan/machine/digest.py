"""Digests of source code.

A digest names what a result depends on, so that an edit re-runs exactly the jobs that it can
change; it also names the folder in which numba keeps the compiled kernels of a module, because
numba itself does not notice an edit in a module that a kernel calls.
"""

import ast
import contextlib
import hashlib
import importlib.metadata
import inspect
import json
import os
import textwrap
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from bezierplan.places import PACKAGE, find_cache_folder

ROOT = PACKAGE.name


# Modules that affect how a job starts and ends, but never what it writes.
NEUTRAL = {
    f"{ROOT}.{name}"
    for name in (
        "places",
        "machine.digest",
        "machine.kernel_cache",
        "machine.opened_files",
        "running.jobs.log",
    )
}

COMPUTING = {
    **{
        name: [name]
        for name in ("numpy", "scipy", "shapely", "pandas", "pyarrow", "jinja2", "seaborn")
    },
    "numba": ["numba", "llvmlite"],
    "matplotlib": ["matplotlib", "pillow"],
    "PIL": ["pillow"],
}
"""Modules of libraries whose versions can change what a job writes -> names of these libraries."""


class _Module(NamedTuple):
    """A module: its dotted name, and the folder in which it is looked up, ours or another."""

    home: Path
    name: str

    def parents(self) -> set["_Module"]:
        """Return the packages that contain the module."""
        parts = self.name.split(".")
        return {_Module(self.home, ".".join(parts[:n])) for n in range(1, len(parts))}


@cache
def _find_file(module: _Module) -> Path | None:
    """Return the source file of a module, or None."""
    place = module.home.joinpath(*module.name.split("."))
    # A file outside the package may have dots in its name.
    places = (place.with_suffix(".py"), place / "__init__.py", module.home / f"{module.name}.py")
    return next((file for file in places if file.is_file()), None)


def _read_module(name: str) -> _Module:
    """Return the module that an argument of `compute_source_digest` names."""
    if name.endswith(".py"):
        file = Path(name).resolve()
        return _Module(file.parent, file.stem)
    return _Module(PACKAGE.parent, name)


def name_module(planner: str) -> str:
    """Return the argument of `compute_source_digest` for a planner, a name or a path."""
    return planner if planner.endswith(".py") else f"{PACKAGE.name}.planners.{planner}"


class _Syntax(NamedTuple):
    """The syntax of a file: the digest of its tree without docstrings; its imports, each as leading
    dots, module and name in it; and its docstring.
    """

    tree: str
    imports: list[list[int | str]]
    about: str


@cache
def _parse_file(file: Path) -> _Syntax:
    """Return the syntax of a file. It is kept for later processes, because parsing takes as long as
    importing.
    """
    source = file.read_bytes()
    # The name includes this module's own code, because another version may digest differently.
    name = hashlib.sha256(source + Path(__file__).read_bytes()).hexdigest()
    kept = find_cache_folder() / "syntax" / f"{name}.json"
    try:
        return _Syntax(*json.loads(kept.read_bytes()))
    except (OSError, ValueError, TypeError):
        parsed = _parse(source)
    # A folder that cannot be written only costs time.
    with contextlib.suppress(OSError):
        keep_json(parsed, kept)
    return parsed


def keep_json(content: Any, file: Path) -> None:
    """Write plain values to a file, which is whole whenever it is read."""
    file.parent.mkdir(parents=True, exist_ok=True)
    # Several processes may write the same file at once: each has a part of its own.
    part = file.with_suffix(f".{os.getpid()}")
    part.write_text(json.dumps(content))
    part.replace(file)


def read_docstring(module: str) -> str:
    """Return the docstring of a module, which is read and not imported."""
    return _parse_file(_find_file(_read_module(module))).about


def _parse(source: bytes) -> _Syntax:
    """Return the syntax of source code."""
    tree = ast.parse(source)
    about = ast.get_docstring(tree) or ""
    imports = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imports.update((0, alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            imports.update((node.level, node.module or "", alias.name) for alias in node.names)
        # Docstrings do not count, unless the file itself reads some.
        elif (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            and ast.get_docstring(node) is not None
            and b"__doc__" not in source
        ):
            node.body = node.body[1:]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "About":
            # The words about a planner's setting; what remains is its unit.
            node.args = node.args[2:]
    return _Syntax(hash_text(repr(_nest(tree))), sorted(map(list, imports)), about)


def _nest(part: Any) -> tuple | str:
    """Return a syntax tree as nested tuples, without fields that are empty: newer Pythons have more
    of these.
    """
    if isinstance(part, ast.JoinedStr):
        # Python 3.12.1 ends some formats with an empty text.
        part = ast.JoinedStr([each for each in part.values if getattr(each, "value", None) != ""])
    if isinstance(part, ast.AST):
        fields = ((name, _nest(value)) for name, value in ast.iter_fields(part))
        return (type(part).__name__, *(each for each in fields if each[1] not in ("None", ())))
    return tuple(map(_nest, part)) if isinstance(part, list) else repr(part)


def hash_text(text: str) -> str:
    """Return the digest of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def _find_imports(module: _Module) -> set[_Module]:
    """Return the modules that a module imports, with their packages: from this package and, for a
    file outside it, from the file's folder.
    """
    file = _find_file(module)
    packages = module.name.split(".") if file.name == "__init__.py" else module.name.split(".")[:-1]
    modules = set()
    for level, base, name in _parse_file(file).imports:
        above = packages[: len(packages) - level + 1] if level else []
        base = ".".join([*above, *filter(None, [base])])
        # What `from a import b` takes from a may be a module, too: both places are tried.
        for full in filter(None, {base, ".".join(filter(None, [base, name]))}):
            ours = full.split(".")[0] == ROOT
            # Modules next to this package are not part of it.
            if ours or module.home != PACKAGE.parent:
                modules.add(_Module(PACKAGE.parent if ours else module.home, full))
    found = {each for each in modules if _find_file(each)}
    return found.union(*(each.parents() for each in found))


def compute_source_digest(*modules: str) -> str:
    """Return the digest of modules and everything that they import, directly or indirectly, from
    this package or, for a file, from its folder.

    A module is a dotted name of this package or the path of a file, such as a user's planner.
    Comments, docstrings and layout do not count: the digest is taken over syntax trees. Raises
    ValueError for a missing module.
    """
    return _find_reached(*modules).digest


def find_sources(*modules: str) -> list[Path]:
    """Return the files of code on which `compute_source_digest` of modules depends."""
    return _find_reached(*modules).files


@cache
def describe_code(functions: tuple[Callable, ...], *modules: str) -> dict[str, str]:
    """Return what the results of a job depend on: a digest of functions, of all that they import
    from this package, and of further modules; and the versions, by library, of those among
    `COMPUTING` that these import.
    """
    trees = []
    named = set(modules)
    # Not the whole module of a function: it has many jobs, and an edit of one would rerun them all.
    for function in functions:
        tree, imports, _ = _parse(textwrap.dedent(inspect.getsource(function)).encode())
        trees.append(tree)
        named.update(
            name
            for _, base, part in imports
            for name in (base, f"{base}.{part}")
            if name.split(".")[0] == ROOT and _find_file(_read_module(name))
        )
    reached = _find_reached(*sorted(named))
    versions = {name: find_library_version(name) for name in sorted(reached.libraries)}
    return {"code": hash_text(" ".join([*trees, reached.digest]))} | versions


# The version of an installed library.
find_library_version = cache(importlib.metadata.version)


class _Reach(NamedTuple):
    """Everything that modules depend on: the digest of `compute_source_digest`, the libraries among
    `COMPUTING` that are imported anywhere, and files of source.
    """

    digest: str
    libraries: set[str]
    files: list[Path]


@cache
def _find_reached(*modules: str) -> _Reach:
    """Return everything that modules depend on. Raises ValueError for a missing module."""
    todo, texts, libraries = [], {}, set()
    for module in map(_read_module, modules):
        if _find_file(module) is None:
            raise ValueError(f"no module {module.name} in {module.home}")
        # To import a module, Python runs the packages that contain it.
        todo += [module, *module.parents()]
    while todo:
        module = todo.pop()
        file = _find_file(module)
        if module not in texts and file and module.name not in NEUTRAL:
            # What a module declares may stand in a file of data with its name.
            beside, syntax = file.with_suffix(".csv"), _parse_file(file)
            data = beside.read_text(encoding="utf-8") if beside.is_file() else ""
            texts[module] = f"{module.name} {syntax.tree}{data}"
            todo += _find_imports(module)
            for level, base, _ in syntax.imports:
                libraries.update(COMPUTING.get(base.split(".")[0], ()) if not level else ())
    # Sorted, because sets of imports come in another order in each process.
    digest = hash_text("\n".join(sorted(texts.values())))
    return _Reach(digest, libraries, [*map(_find_file, texts)])


@cache
def compute_content_digest(*files: str) -> str:
    """Return the digest of the content of files, in this order: unlike a timestamp, it shows a
    change. A file that is not there has another one than an empty file.
    """
    contents = (file.read_bytes() if file.is_file() else b"no file" for file in map(Path, files))
    return hashlib.sha256(
        b"".join(hashlib.sha256(content).digest() for content in contents)
    ).hexdigest()[:16]


@cache
def name_state(module: str, file: str) -> str:
    """Return a name of the current state of a module, ours or the user's."""
    ours = module.split(".")[0] == ROOT and _find_file(_read_module(module))
    return f"{Path(file).stem}-{compute_source_digest(module if ours else file)}"
