"""Compile kernels with numba, and keep the compiled code on disk without ever serving it stale.

numba's own cache looks only at the file a function stands in: after an edit of a function that it
calls from another file, the old code would be used. Here the cache of every kernel is stamped
with the state of all sources of the package, so any edit compiles anew.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


@functools.cache
def source_stamp() -> tuple[tuple[str, int, int], ...]:
    """Name, modification time [ns] and size of every source file that kernels may stand in."""
    from importlib.util import find_spec

    folders = [Path(__file__).parent]
    controllers = find_spec("physim.controllers")
    if controllers is not None and controllers.origin is not None:
        folders.append(Path(controllers.origin).parent)
    files = sorted({file.resolve() for folder in folders for file in folder.rglob("*.py")})
    stats = [(file, file.stat()) for file in files]
    return tuple((str(file), stat.st_mtime_ns, stat.st_size) for file, stat in stats)


def compiled(function: F) -> F:
    """Compile a kernel: no fast-math (results are bit-equal on one machine), cached on disk.

    The plain function stays at hand as ``kernel.py_func``.
    """
    kernel = numba.njit(cache=True, error_model="numpy")(function)
    _stamp_cache(kernel)
    return cast(F, kernel)


def _stamp_cache(kernel: Any) -> None:
    """Make the kernel's disk cache depend on ``source_stamp``; without a cache, do nothing."""
    from numba.core.caching import IndexDataCacheFile

    cache = kernel._cache
    implementation = getattr(cache, "_impl", None)
    if implementation is None:
        return
    stamp = (*cache._source_stamp, source_stamp())
    cache._source_stamp = stamp
    cache._cache_file = IndexDataCacheFile(
        cache_path=cache._cache_path,
        filename_base=implementation.filename_base,
        source_stamp=stamp,
    )
