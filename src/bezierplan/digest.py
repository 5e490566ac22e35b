"""Digests of source code.

A digest names what a result depends on, so that an edit re-runs exactly the jobs that it can change; it also names the folder
in which numba keeps the compiled kernels of a module, because numba itself does not notice an edit in a module that a kernel calls.
"""

import ast
import hashlib
import os
import sys
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent
ROOT = PACKAGE.name


def _module_file(module: str) -> Path | None:
    """The source file of a module of this package, or None."""
    place = PACKAGE.parent.joinpath(*module.split("."))
    for file in (place.with_suffix(".py"), place / "__init__.py"):
        if file.is_file():
            return file
    return None


@cache
def _parsed(file: Path) -> ast.Module:
    """The syntax tree of a file, without docstrings."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:]
    return tree


@cache
def _dumped(file: Path) -> str:
    return ast.dump(_parsed(file))


def _imports(module: str, tree: ast.Module) -> set[str]:
    """Names of the modules of this package that a syntax tree imports, parent packages included."""
    is_package = _module_file(module).name == "__init__.py"
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = module.split(".") if is_package else module.split(".")[:-1]
                base = ".".join(parents[: len(parents) - node.level + 1] + ([base] if base else []))
            found.add(base)
            found.update(f"{base}.{alias.name}" for alias in node.names)
    ours = {name for name in found if name.split(".")[0] == ROOT and _module_file(name)}
    return ours.union(*map(_parents, ours))


def _parents(module: str) -> set[str]:
    """Names of the packages that a module lies in."""
    parts = module.split(".")
    return {".".join(parts[:n]) for n in range(1, len(parts))}


def source_digest(*modules: str) -> str:
    """Digest of modules and of every module of this package that they import, directly or not.

    A module is a dotted name of this package or the path of a planner's file. Comments, docstrings and layout do not
    count: the digest is taken over syntax trees.
    """
    own = [module for module in modules if not module.endswith(".py")]
    todo, trees = [*modules, *set().union(*map(_parents, own))], {}
    while todo:
        module = todo.pop()
        if module in trees:
            continue
        file = Path(module) if module.endswith(".py") else _module_file(module)
        if file is None:
            raise ValueError(f"no module {module} in the package {ROOT}")
        file = file.resolve()
        trees[module] = _dumped(file)
        todo += _imports(ROOT if module.endswith(".py") else module, _parsed(file))
    text = "\n".join(f"{name} {trees[name]}" for name in sorted(trees))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


# numba tries them in this order; the others serve the libraries that keep kernels of their own.
LOCATORS = "bezierplan.kernel_cache.KernelCacheLocator,InTreeCacheLocator,UserWideCacheLocator"


def kernel_folder(module: str, file: str) -> Path:
    """The folder of compiled kernels of a module, of this package or a reader's own, in its present state."""
    ours = module.split(".")[0] == ROOT and _module_file(module) is not None
    return Path(os.environ["NUMBA_CACHE_DIR"]) / f"{Path(file).stem}-{source_digest(module if ours else file)}"


def point_numba_cache() -> None:
    """Give compiled kernels a place: `.cache/kernels` of the working tree or, where that cannot be written, of the user's home.

    numba reads the variables once, when it is imported; so an earlier import is corrected as well.
    """
    tree = PACKAGE.parents[1]
    place = tree if os.access(tree, os.W_OK) else Path.home()
    given = {"CACHE_DIR": str(place / ".cache" / "kernels"), "CACHE_LOCATOR_CLASSES": LOCATORS}
    for name, value in given.items():
        os.environ[f"NUMBA_{name}"] = value
        if "numba" in sys.modules:
            setattr(sys.modules["numba"].config, name, value)
