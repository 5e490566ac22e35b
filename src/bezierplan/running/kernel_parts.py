"""Kernels as parts of others: LLVM's code of them, which is optimised and translated to machine
code only within kernels that Python calls.

By itself, numba optimises every kernel, translates it and wraps it for Python, though only other
kernels call it, and optimises it once more within each of its callers, and these within theirs.
"""

from types import FunctionType
from typing import Any

from llvmlite.binding import parse_bitcode
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult


class _Code(JITCodeLibrary):
    """The code of a part, and of the parts that it calls."""

    def _optimize_final_module(self) -> None:
        """Done with each kernel that calls it, of all code at once."""

    def _finalize_final_module(self) -> None:
        """Ready to be linked; the code is not given to the engine that would translate it."""
        self._finalize_dynamic_globals()
        self._finalized = True


class PartCompiler(Compiler):
    """numba's compiler up to code that other kernels can link."""

    def compile_extra(self, func: FunctionType) -> Any:
        """The part, whose `entry_point` is no function but what its callers find it by."""
        state = self.state
        state.flags.no_compile = state.flags.no_cpython_wrapper = True
        state.library = _Code(state.targetctx.codegen(), func.__qualname__)
        part = super().compile_extra(func)._replace(entry_point=object())
        state.targetctx.insert_user_function(part.entry_point, part.fndesc, [part.library])
        return part


def to_file(part: Any) -> tuple:
    """What is kept of a part."""
    # numba leaves out the same two: nobody needs them, and not all can be pickled.
    part.fndesc.typemap = part.fndesc.calltypes = None
    code = part.library.serialize_using_bitcode()
    return code, part.fndesc, part.environment, part.signature, part.reload_init


def from_file(target: Any, kept: tuple) -> Any:
    """The part that was kept."""
    (name, _, bitcode), fndesc, environment, signature, reload_init = kept
    for reload in reload_init:
        reload()
    code = _Code(target.codegen(), name)
    code._final_module = parse_bitcode(bitcode)
    code._finalize_final_module()
    return CompileResult(
        typing_context=target.typing_context,
        target_context=target,
        entry_point=object(),
        typing_error=None,
        type_annotation=None,
        signature=signature,
        objectmode=False,
        lifted=(),
        fndesc=fndesc,
        library=code,
        call_helper=None,
        environment=environment,
        metadata=None,
        reload_init=reload_init,
        referenced_envs=(),
    )
