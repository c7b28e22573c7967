"""Compile kernels with numba, and keep the compiled code on disk without ever serving it stale.

A kernel has two forms, each made when it is first needed. Called from Python it is compiled as a
*whole*: with everything it calls, into machine code that is kept on disk. Called from another
kernel it gives a *piece* of code for that whole, see `physim.linking`. numba by itself would
optimise each kernel anew inside its callers, and theirs, and so take three times as long.

numba's own cache looks only at the file a function stands in: after an edit of a function that it
calls from another file, the old code would be used. Here the cache of every kernel is stamped
with the state of all sources of the package, so any edit compiles anew.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


@functools.cache
def source_stamp() -> str:
    """Hash of every source file that kernels may stand in."""
    from importlib.util import find_spec

    folders = [Path(__file__).parent]
    controllers = find_spec("physim.controllers")
    if controllers is not None and controllers.origin is not None:
        folders.append(Path(controllers.origin).parent)
    hasher = hashlib.sha256()
    for file in sorted({file.resolve() for folder in folders for file in folder.rglob("*.py")}):
        hasher.update(f"{file.name}\0".encode() + file.read_bytes())
    return hasher.hexdigest()


def compiled(function: F) -> F:
    """Make a `Kernel` of a function; it is called as before."""
    return cast(F, Kernel(function))


class Kernel:
    """A function compiled without fast-math: results are bit-equal on one machine.

    The plain function stays at hand as ``kernel.py_func``.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function

    def __call__(self, *args: Any, **named: Any) -> Any:
        """Run the compiled function."""
        return self.whole(*args, **named)

    @functools.cached_property
    def whole(self) -> Any:
        """What Python calls: a numba dispatcher with a cache on disk."""
        from physim.linking import WholeCompiler

        kernel = _dispatcher(self.py_func, cache=True, pipeline_class=WholeCompiler)
        _stamp_cache(kernel)
        return kernel

    @functools.cached_property
    def piece(self) -> Any:
        """What other kernels call: a numba dispatcher that Python cannot call."""
        from physim.linking import PieceCompiler

        return _dispatcher(self.py_func, no_cpython_wrapper=True, pipeline_class=PieceCompiler)

    @property
    def _numba_type_(self) -> Any:
        """How numba sees a kernel that stands in the code it compiles."""
        return self.piece._numba_type_


def _dispatcher(function: Callable[..., Any], **options: Any) -> Any:
    import numba

    options = {"error_model": "numpy", "no_cfunc_wrapper": True, **options}
    return numba.njit(**options)(function)


def _stamp_cache(kernel: Any) -> None:
    """Make the kernel's disk cache depend on ``source_stamp``; without a cache, do nothing."""
    from numba.core.caching import IndexDataCacheFile

    cache = getattr(kernel, "_cache", None)
    implementation = getattr(cache, "_impl", None)
    if cache is None or implementation is None:
        return
    stamp = (implementation.locator.get_source_stamp(), source_stamp())
    cache._cache_file = IndexDataCacheFile(  # type: ignore[no-untyped-call]
        cache_path=cache._cache_path,
        filename_base=implementation.filename_base,
        source_stamp=stamp,
    )


def is_cached(kernel: Callable[..., Any]) -> bool:
    """Whether compiled code of a kernel lies on disk for the present sources."""
    try:
        return bool(cast(Kernel, kernel).whole._cache._cache_file._load_index())
    except (AttributeError, OSError):
        return False
