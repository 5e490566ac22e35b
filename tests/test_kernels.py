"""Kernels that create no arrays (`allocation_free`)."""

import ast
import importlib
import inspect
import pkgutil
import textwrap

import numpy as np
import pytest
from numba import types
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError

import bezierplan
from bezierplan import kernels

MODULES = [
    importlib.import_module(each.name)
    for each in pkgutil.walk_packages(bezierplan.__path__, "bezierplan.")
]
KERNELS = {
    f"{module.__name__}.{name}": each
    for module in MODULES
    for name, each in vars(module).items()
    if isinstance(each, Dispatcher) and each.py_func.__module__ == module.__name__
}
FREE = {name: each for name, each in KERNELS.items() if each.targetoptions.get("_nrt") is False}


def called(kernel):
    """The kernels that a kernel calls by name, but for those that are always part of their
    caller.
    """
    found, known = [], kernel.py_func.__globals__
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(kernel.py_func)))):
        if isinstance(node, ast.Name):
            found.append(known.get(node.id))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found.append(getattr(known.get(node.value.id), node.attr, None))
    return [
        each
        for each in found
        if isinstance(each, Dispatcher) and each.targetoptions.get("inline") != "always"
    ]


def test_allocation_free_kernels_call_only_their_like():
    """Otherwise it would depend on who compiles a kernel first whether it counts references."""
    wrong = [
        (name, each.py_func.__name__)
        for name, kernel in FREE.items()
        for each in called(kernel)
        if each not in FREE.values()
    ]
    assert len(FREE) > 100
    assert wrong == []


def has_array(returned):
    """Whether a type of numba is an array, or holds one."""
    return isinstance(returned, types.Array) or (
        isinstance(returned, types.BaseTuple) and any(map(has_array, returned.types))
    )


def test_allocation_free_kernels_return_no_array():
    """Nobody would count the reference to it. The kernels are those that the smoke subset and other
    tests have compiled.
    """
    looked_at = 0
    for name, kernel in FREE.items():
        for signature, *_ in kernel._cache._cache_file._load_index():
            kernel.compile(signature)
        looked_at += len(kernel.overloads) > 0
        assert not any(
            has_array(each.signature.return_type) for each in kernel.overloads.values()
        ), name
    assert looked_at > 0.5 * len(FREE)


def test_a_kernel_that_creates_an_array_is_refused(tmp_path, monkeypatch):
    (tmp_path / "kernels_of_mine.py").write_text(
        "import numpy as np\nfrom bezierplan.kernels import allocation_free\n\n"
        "@allocation_free\ndef three(x):\n    return np.full(3, x).sum()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    mine = importlib.import_module("kernels_of_mine")
    with pytest.raises(NumbaError, match="returning of array passed"):
        mine.three(1.0)


def test_an_allocation_free_kernel_works_on_views():
    shifted = kernels.allocation_free(lambda x: x[1:][-1])
    assert shifted(np.arange(4.0)) == 3.0
