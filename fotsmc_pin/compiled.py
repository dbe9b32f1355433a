"""The one way to compile: `@kernel`, Numba in nopython mode with a cache on disk.

A call of a kernel from Python first looks up the types of all arguments, which in a tick of control
costs as much as the arithmetic. `specialized` does so once, for arrays that the caller owns;
`restricted` keeps a kernel that is given a user's arrays from being compiled again during a run.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
import warnings
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, overload

import numba
from numba import extending
from numba.core import cgutils, types
from numba.core.caching import NullCache
from numba.extending import intrinsic

if TYPE_CHECKING:
    from collections.abc import Callable

    Kernel: TypeAlias = Callable[..., Any]
    Function = TypeVar("Function", bound=Callable[..., Any])


class CacheWarning(UserWarning):
    """Machine code cannot be kept on disk with the Numba that is installed."""


@overload
def kernel(function: Function) -> Function: ...
@overload
def kernel(*, rounds_freely: bool = ..., is_part: bool = ...) -> Callable[[Function], Function]: ...
def kernel(function: Any = None, *, rounds_freely: bool = False, is_part: bool = False) -> Any:
    """Compile `function` on its first call and keep the machine code on disk.

    With `NUMBA_DISABLE_JIT=1` the function stays plain Python. Where no cache folder can be
    written, or the function's module cannot be imported by its name, the kernel is compiled anew
    in each process. A division by zero gives infinity or NaN and no error: where a call may fail,
    Numba counts references to each array in it, which costs more than a short kernel's arithmetic.

    Args:
        function: what to compile.
        rounds_freely: let the processor add several terms of a sum at a time, and multiply and add
            in one step, which rounds differently from one operation after the other.
        is_part: put its machine code into each kernel that calls it, as if it were written there.
            For steps of a law that take its named rows, which are costly to hand over.
    """
    if function is None:
        return partial(kernel, rounds_freely=rounds_freely, is_part=is_part)
    options = {
        "error_model": "numpy",
        "fastmath": {"reassoc", "contract"} if rounds_freely else False,
        "forceinline": is_part,
    }
    try:
        compiled = numba.njit(cache=_importable(function), **options)(function)
    except RuntimeError:  # Numba found no folder that it may write to.
        compiled = numba.njit(**options)(function)
    if not _follows_every_source(compiled):
        warnings.warn(
            f"Numba {numba.__version__} keeps its cache in a way that is not known here: kernels "
            "are compiled anew in each process; install a Numba that constraints.txt names",
            CacheWarning,
            stacklevel=2,
        )
        compiled = numba.njit(**options)(function)
    return compiled


def specialized(function: Function, *examples: Any) -> Function:
    """Return the machine code of the kernel `function` for the types of `examples`.

    It is compiled here and now. Each call must give exactly these types and memory layouts: they
    are not checked. With compilation switched off this is the plain function.
    """
    settle: Any = getattr(function, "compile", None)
    if settle is None:
        return function
    code: Function = settle(tuple(numba.typeof(value) for value in examples))
    return code


def address(function: Callable[..., None], *examples: Any) -> Any:
    """Return where the machine code of a kernel lies, for `call` inside another one.

    So one kernel can run another that is only known when it runs, such as the law of a task, and
    both are kept on disk. The kernel returns nothing. With compilation switched off this is the
    function.
    """
    if not hasattr(function, "overloads"):
        return function
    specialized(function, *examples)
    made: Any = function
    found = made.overloads[tuple(numba.typeof(value) for value in examples)]
    return int(found.library.get_pointer_to_function(found.fndesc.llvm_func_name))


def call(function: Any, dt: float, arguments: tuple[Any, ...]) -> None:
    """Run the kernel at an `address` with `dt` and a tuple of arrays, which are not checked."""
    function(dt, *arguments)


@intrinsic
def _called(typing_context, function, dt, arguments):  # type: ignore[no-untyped-def]
    def generated(context, builder, signature, values):  # type: ignore[no-untyped-def]
        place, period, packed = values
        kinds = (signature.args[1], *signature.args[2].types)
        shape = context.call_conv.get_function_type(types.none, kinds)
        pointer = builder.inttoptr(place, shape.as_pointer())
        given = [period, *cgutils.unpack_tuple(builder, packed)]
        status, _ = context.call_conv.call_function(builder, pointer, types.none, kinds, given)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return context.get_dummy_value()

    return types.none(function, dt, arguments), generated


@extending.overload(call, inline="always")
def _compiled_call(function, dt, arguments):  # type: ignore[no-untyped-def]
    return lambda function, dt, arguments: _called(function, dt, arguments)


def restricted(function: Function, *examples: Any) -> Function:
    """Compile the kernel `function` for the types of `examples`; from now on it refuses others.

    A refusal is a `TypeError`. With compilation switched off nothing is refused.
    """
    kernel: Any = function
    if hasattr(kernel, "disable_compile") and not kernel.signatures:
        specialized(function, *examples)
        kernel.disable_compile()
    return function


def is_kernel(function: Any) -> bool:
    """Return whether a function was made by `kernel`; with compilation off, whether it may be."""
    if numba.config.DISABLE_JIT:
        return inspect.isfunction(function)
    return hasattr(function, "py_func") and hasattr(function, "overloads")


def _importable(function: Any) -> bool:
    """Return whether the module of `function` can be imported by its name.

    Cached code asks for it; the name that `runpy` gives to a file cannot be imported.
    """
    name = function.__module__
    return name in sys.modules and all(part.isidentifier() for part in name.split("."))


def _follows_every_source(dispatcher: Any) -> bool:
    """Invalidate the cached machine code when any kernel of the package changes.

    Numba watches only the file in which a kernel stands, not those of the kernels that it calls,
    and would go on running the old ones. Nor does it see that a file runs under another name, as
    a script and as a module. Returns False where the cache cannot be made to do so.
    """
    if not hasattr(dispatcher, "py_func"):  # compilation is switched off
        return True
    cache: Any = getattr(dispatcher, "_cache", None)
    if isinstance(cache, NullCache):
        return True
    cache_file: Any = getattr(cache, "_cache_file", None)
    if not hasattr(cache_file, "_source_stamp"):
        return False
    module = dispatcher.py_func.__module__
    cache_file._source_stamp = (cache_file._source_stamp, _kernel_sources(), module)
    return True


@cache
def _kernel_sources() -> str:
    """Digest of every file of the package that holds a kernel, or the names of its rows."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        text = path.read_bytes()
        if any(mark in text for mark in (b"@kernel", b"NamedTuple", b"(Gains)")):
            digest.update(text)
    return digest.hexdigest()
