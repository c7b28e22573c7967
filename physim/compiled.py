"""Compile kernels with numba, and keep the compiled code on disk without ever serving it stale.

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

import numba

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
    """Compile a kernel: no fast-math (results are bit-equal on one machine), cached on disk.

    The plain function stays at hand as ``kernel.py_func``.
    """
    kernel = numba.njit(cache=True, error_model="numpy")(function)
    _stamp_cache(kernel)
    return cast(F, kernel)


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
        return bool(cast(Any, kernel)._cache._cache_file._load_index())
    except (AttributeError, OSError):
        return False
