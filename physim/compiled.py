"""Compile kernels with numba, and keep the compiled code on disk without ever serving it stale.

A kernel has two forms, each made when it is first needed. Called from Python it is compiled as a
*whole*: with everything it calls, into machine code that is kept on disk. Called from another
kernel it gives a *piece* of code for that whole, see `physim.linking`. numba by itself would
optimise each kernel anew inside its callers, and theirs, and so take a third longer. With a version
of numba whose internals are not known here it does so: results are the same, bit for bit.

numba's own cache looks only at the file a function stands in: after an edit of a function that it
calls from another file, the old code would be used. Here the cache of every kernel is stamped
with the state of all sources of the package but those of `ROOMS_WITHOUT_KERNELS`, so any edit of
the others compiles anew.

numba keeps compiled code beside the sources or in the user's home. Where neither is writable, as in
a container, it goes to a temporary folder of the user's, or is not kept at all; a note on stderr
says which.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import multiprocessing
import os
import stat
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from physim.stray_settings import load_numba

F = TypeVar("F", bound=Callable[..., Any])

ROOMS_WITHOUT_KERNELS = (
    "authoring", "campaigns", "cli", "drawing", "record", "reproduction", "statistics", "testing",
    "world",
)  # fmt: skip
"""Rooms in which no kernel stands, nor anything that one calls or reads (classes aside)"""

LINKED_SERIES = ("0.61", "0.62", "0.63", "0.64", "0.65", "0.66", "0.67", "0.68")
"""Versions of numba that `physim.linking` was tried with; any other compiles kernels by itself."""


def compiles() -> bool:
    """Whether kernels are compiled: not with numba's ``NUMBA_DISABLE_JIT=1``, to step through."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") == "0"


@functools.cache
def links_kernels() -> bool:
    """Whether kernels are put together by `physim.linking`, rather than by numba alone."""
    import numba

    return ".".join(numba.__version__.split(".")[:2]) in LINKED_SERIES


@functools.cache
def source_stamp() -> str:
    """Hash of every source file that kernels may stand in."""
    from importlib.util import find_spec

    folders = [Path(__file__).parent]
    controllers = find_spec("physim.controllers")
    if controllers is not None and controllers.origin is not None:
        folders.append(Path(controllers.origin).parent)
    without = {Path(__file__).resolve().parent / room for room in ROOMS_WITHOUT_KERNELS}
    hasher = hashlib.sha256()
    for file in sorted({file.resolve() for folder in folders for file in folder.rglob("*.py")}):
        if not without.isdisjoint((file.with_suffix(""), *file.parents)):
            continue
        hasher.update(f"{file.name}\0".encode() + file.read_bytes())
    return hasher.hexdigest()


def compiled(function: F) -> F:
    """Make a `Kernel` of a function; it is called as before.

    Where nothing `compiles` it stays the plain function.
    """
    if compiles():
        return cast(F, Kernel(function))
    function.py_func = function.whole = function  # type: ignore[attr-defined]
    return function


def direct(kernel: F) -> F:
    """Return the compiled function of a kernel itself: a call costs a third of a microsecond less.

    For what is called at every step; it is made here and now.
    """
    return cast(F, cast(Kernel, kernel).whole)


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
        options = {}
        if links_kernels():
            from physim.linking import WholeCompiler

            options = {"pipeline_class": WholeCompiler}
        try:
            kernel = _dispatcher(self.py_func, cache=True, **options)
        except RuntimeError:  # no folder that numba knows is writable
            kernel = _dispatcher(self.py_func, cache=_keep_in_temporary_folder(), **options)
        _stamp_cache(kernel)
        return kernel

    @functools.cached_property
    def piece(self) -> Any:
        """What other kernels call: a numba dispatcher that Python cannot call."""
        options = {}
        if links_kernels():
            from physim.linking import PieceCompiler

            options = {"pipeline_class": PieceCompiler}
        return _dispatcher(self.py_func, no_cpython_wrapper=True, **options)

    @property
    def _numba_type_(self) -> Any:
        """How numba sees a kernel that stands in the code it compiles."""
        return self.piece._numba_type_


def callback(arguments: int) -> Callable[[F], Callback]:
    """Make a `Callback` of a function of so many addresses."""
    return lambda function: Callback(function, arguments)


class Callback:
    """A function compiled so that a C library can call it: it takes addresses, and returns nothing.

    The plain function stays at hand as ``py_func``; the compiled one is kept on disk like a kernel.
    Where nothing `compiles` the library calls the plain function.
    """

    def __init__(self, function: Callable[..., Any], arguments: int) -> None:
        self.py_func = function
        self._arguments = arguments

    @property
    def address(self) -> int:
        """Where the function lies that the library calls."""
        if compiles():
            return int(self._function.address)
        return ctypes.cast(self._plain, ctypes.c_void_p).value or 0

    @functools.cached_property
    def _plain(self) -> Any:
        return ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * self._arguments)(self.py_func)

    @functools.cached_property
    def _function(self) -> Any:
        from numba.core import types
        from numba.core.ccallback import CFunc

        options = {}
        if links_kernels():
            from physim.linking import WholeCompiler

            options = {"pipeline_class": WholeCompiler}
        signature = (types.int64,) * self._arguments, types.void
        function = CFunc(self.py_func, signature, {}, {"error_model": "numpy"}, **options)
        try:
            function.enable_caching()
        except RuntimeError:  # no folder that numba knows is writable
            if _keep_in_temporary_folder():
                function.enable_caching()
        _stamp_cache(function)
        function.compile()
        return function


def _dispatcher(function: Callable[..., Any], **options: Any) -> Any:
    options = {"error_model": "numpy", "no_cfunc_wrapper": True, **options}
    return load_numba().njit(**options)(function)


def _keep_in_temporary_folder() -> bool:
    """Let numba keep compiled code in a temporary folder of the user's; False if none can be had.

    The environment hands the folder to worker processes. Code is run from it, so it must belong to
    the user and be closed to everybody else.
    """
    import numba

    user = os.getuid() if hasattr(os, "getuid") else "user"
    folder = Path(tempfile.gettempdir(), f"physim-kernels-{user}")
    try:
        is_new = not folder.exists()
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
        is_own = stat.S_ISDIR(found.st_mode) and found.st_uid == user and not found.st_mode & 0o077
        if hasattr(os, "getuid") and not is_own:
            raise PermissionError(folder)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        _note("kernels are compiled anew each time, since no folder for them is writable")
        return False
    if is_new:
        _note(f"compiled kernels are kept in {folder}, since no other folder for them is writable")
    os.environ["NUMBA_CACHE_DIR"] = str(folder)
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    return True


@functools.cache
def _note(what: str) -> None:
    """Say one line on stderr, once, and not from worker processes."""
    if multiprocessing.parent_process() is None:
        print(f"note: {what}; NUMBA_CACHE_DIR can name one", file=sys.stderr)


def _stamp_cache(kernel: Any) -> None:
    """Make the kernel's disk cache depend on ``source_stamp``; without a cache, do nothing.

    What is compiled with and without `physim.linking` is kept apart.
    """
    from numba.core.caching import IndexDataCacheFile

    class StampedCacheFile(IndexDataCacheFile):
        """A cache file that cannot be read is none, and its kernel is compiled anew.

        Its types may be of modules now gone, or it was cut short: then any error may come of it.
        """

        def _load_index(self) -> Any:
            try:
                return super()._load_index()  # type: ignore[no-untyped-call]
            except Exception:
                return {}

        def load(self, key: Any) -> Any:
            try:
                return super().load(key)  # type: ignore[no-untyped-call]
            except Exception:
                return None

    cache = getattr(kernel, "_cache", None)
    implementation = getattr(cache, "_impl", None)
    if cache is None or implementation is None:
        return
    stamp = (implementation.locator.get_source_stamp(), source_stamp())
    cache._cache_file = StampedCacheFile(  # type: ignore[no-untyped-call]
        cache_path=cache._cache_path,
        filename_base=implementation.filename_base + ("" if links_kernels() else ".unlinked"),
        source_stamp=stamp,
    )


def is_cached(kernel: Callable[..., Any]) -> bool:
    """Whether compiled code of a kernel lies on disk for the present sources."""
    try:
        return bool(cast(Kernel, kernel).whole._cache._cache_file._load_index())
    except (AttributeError, OSError):
        return False
