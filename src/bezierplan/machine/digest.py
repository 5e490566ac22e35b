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

from bezierplan.places import PACKAGE, cache_folder

ROOT = PACKAGE.name


# Modules that affect how a job starts and ends, but never what it writes.
NEUTRAL = {
    f"{ROOT}.{name}"
    for name in (
        "places",
        "machine.digest",
        "machine.kernel_cache",
        "machine.opened",
        "running.jobs.log",
    )
}

COMPUTING = {
    **{name: [name] for name in ("numpy", "scipy", "shapely", "pandas", "pyarrow", "jinja2")},
    "numba": ["numba", "llvmlite"],
    "matplotlib": ["matplotlib", "pillow"],
    "PIL": ["pillow"],
    "seaborn": ["seaborn"],
}
"""Modules of libraries whose versions can change what a job writes -> names of these libraries."""


class _Module(NamedTuple):
    """A module by its dotted name, and the folder in which it is looked up: ours or another."""

    home: Path
    name: str

    def file(self) -> Path | None:
        """The module's source file, or None."""
        return _file(self.home, self.name)

    def parents(self) -> set["_Module"]:
        """The packages that contain the module."""
        parts = self.name.split(".")
        return {_Module(self.home, ".".join(parts[:n])) for n in range(1, len(parts))}


@cache
def _file(home: Path, name: str) -> Path | None:
    """The source file of a module, by its dotted name in a folder, or None."""
    place = home.joinpath(*name.split("."))
    # A file outside the package may have dots in its name.
    places = (place.with_suffix(".py"), place / "__init__.py", home / f"{name}.py")
    return next((file for file in places if file.is_file()), None)


def _module(name: str) -> _Module:
    """A module from an argument of `source_digest`."""
    if name.endswith(".py"):
        file = Path(name).resolve()
        return _Module(file.parent, file.stem)
    return _Module(PACKAGE.parent, name)


def module_of(planner: str) -> str:
    """A planner, given as a name or the path of a file, as an argument of `source_digest`."""
    return planner if planner.endswith(".py") else f"{PACKAGE.name}.planners.{planner}"


class _Syntax(NamedTuple):
    """What a file computes: the digest of its syntax tree without docstrings; what it imports:
    (leading dots, module, name in it); and its docstring.
    """

    tree: str
    imports: list[list[int | str]]
    about: str


@cache
def _syntax(file: Path) -> _Syntax:
    """Return the syntax of a file, kept from earlier processes: parsing takes as long as
    importing.
    """
    source = file.read_bytes()
    # What was kept by other code than this module's is not read.
    name = hashlib.sha256(source + Path(__file__).read_bytes()).hexdigest()
    kept = cache_folder() / "syntax" / f"{name}.json"
    try:
        return _Syntax(*json.loads(kept.read_bytes()))
    except (OSError, ValueError, TypeError):
        parsed = _parsed(source)
    # Nothing depends on whether it can be kept.
    with contextlib.suppress(OSError):
        keep_json(parsed, kept)
    return parsed


def keep_json(content: Any, file: Path) -> None:
    """Write plain values to a file, which is whole whenever it is read."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(f".{os.getpid()}")
    part.write_text(json.dumps(content))
    part.replace(file)


def docstring(module: str) -> str:
    """Return the docstring of a module, which is read and not imported."""
    return _syntax(_module(module).file()).about


def _parsed(source: bytes) -> _Syntax:
    tree = ast.parse(source)
    about = ast.get_docstring(tree) or ""
    imports = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imports.update((0, alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            imports.update((node.level, node.module or "", alias.name) for alias in node.names)
        elif (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            and ast.get_docstring(node) is not None
            and b"__doc__" not in source
        ):
            node.body = node.body[1:]
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id == "About"
        ):
            # The words about a planner's setting; what remains is its unit.
            node.args = node.args[2:]
    return _Syntax(_digest(repr(_nested(tree))), sorted(map(list, imports)), about)


def _nested(part: Any) -> tuple | str:
    """Return a syntax tree as nested tuples, without fields that are empty: newer Pythons have
    more of these.
    """
    if isinstance(part, ast.AST):
        fields = ((name, _nested(value)) for name, value in ast.iter_fields(part))
        return (type(part).__name__, *(each for each in fields if each[1] not in ("None", ())))
    return tuple(map(_nested, part)) if isinstance(part, list) else repr(part)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def _imports(module: _Module) -> set[_Module]:
    """The modules that a module imports, with their packages: from this package and, for a file
    outside it, from the file's folder.
    """
    file = module.file()
    packages = module.name.split(".") if file.name == "__init__.py" else module.name.split(".")[:-1]
    modules = set()
    for level, base, name in _syntax(file).imports:
        above = packages[: len(packages) - level + 1] if level else []
        base = ".".join([*above, *filter(None, [base])])
        for full in filter(None, {base, ".".join(filter(None, [base, name]))}):
            ours = full.split(".")[0] == ROOT
            # Modules next to this package are not part of it.
            if ours or module.home != PACKAGE.parent:
                modules.add(_Module(PACKAGE.parent if ours else module.home, full))
    found = {each for each in modules if each.file()}
    return found.union(*(each.parents() for each in found))


def source_digest(*modules: str) -> str:
    """Digest of modules and everything that they import, directly or indirectly, from this package
    or, for a file, from its folder.

    A module is a dotted name of this package or the path of a file, such as a user's planner.
    Comments, docstrings and layout do not count: the digest is taken over syntax trees. Raises
    ValueError for a missing module.
    """
    return _reached(*modules).digest


def sources(*modules: str) -> list[Path]:
    """Return the files of code on which `source_digest` of modules depends."""
    return _reached(*modules).files


@cache
def code_account(functions: tuple[Callable, ...], *modules: str) -> dict[str, str]:
    """Return the digest of some functions, of all that they import from this package, and of
    further modules, and by name the versions of the libraries among `COMPUTING` that these import:
    what a job's results depend on.
    """
    trees = []
    named = set(modules)
    for function in functions:
        tree, imports, _ = _parsed(textwrap.dedent(inspect.getsource(function)).encode())
        trees.append(tree)
        named.update(
            name
            for _, base, part in imports
            for name in (base, f"{base}.{part}")
            if name.split(".")[0] == ROOT and _module(name).file()
        )
    reached = _reached(*sorted(named))
    versions = {name: library_version(name) for name in sorted(reached.libraries)}
    return {"code": _digest(" ".join([*trees, reached.digest]))} | versions


@cache
def library_version(name: str) -> str:
    """The version of an installed library."""
    return importlib.metadata.version(name)


class _Reach(NamedTuple):
    """What modules depend on: the digest of `source_digest`; the libraries among `COMPUTING` that
    are imported anywhere; and files of source.
    """

    digest: str
    libraries: set[str]
    files: list[Path]


@cache
def _reached(*modules: str) -> _Reach:
    todo, texts, libraries = [], {}, set()
    for module in map(_module, modules):
        if module.file() is None:
            raise ValueError(f"no module {module.name} in {module.home}")
        todo += [module, *module.parents()]
    while todo:
        module = todo.pop()
        if module not in texts and module.file() and module.name not in NEUTRAL:
            # What a module declares may stand in a file of data with its name.
            beside = module.file().with_suffix(".csv")
            data = beside.read_text(encoding="utf-8") if beside.is_file() else ""
            texts[module] = f"{module.name} {_syntax(module.file()).tree}{data}"
            todo += _imports(module)
            for level, base, _ in _syntax(module.file()).imports:
                libraries.update(COMPUTING.get(base.split(".")[0], ()) if not level else ())
    digest = _digest("\n".join(sorted(texts.values())))
    return _Reach(digest, libraries, [module.file() for module in texts])


@cache
def content_digest(*files: str) -> str:
    """Return the digest of the content of files, in this order: unlike a timestamp, it shows a
    change. A file that is not there has another one than an empty file.
    """
    places = map(Path, files)
    contents = (file.read_bytes() if file.is_file() else b"no file" for file in places)
    return hashlib.sha256(
        b"".join(hashlib.sha256(content).digest() for content in contents)
    ).hexdigest()[:16]


@cache
def state_of(module: str, file: str) -> str:
    """Return a name of the current state of a module, ours or the user's."""
    ours = module.split(".")[0] == ROOT and _module(module).file() is not None
    return f"{Path(file).stem}-{source_digest(module if ours else file)}"
