"""Kernels: plain typed functions that a C compiler compiled when physim was built.

`physim.joining` copies all of them into one module, which Cython turns into C (see CONTRIBUTING).
What is compiled gives the same bits as the plain functions, on every machine: no fast-math, nothing
contracted, no instructions but those that every processor of its kind has.

A kernel that only kernels call has no compiled form for Python. ``PHYSIM_KERNELS=plain`` lets all
plain functions run, to step through them.
"""

from __future__ import annotations

import ctypes
import functools
import importlib
import importlib.util
import os
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, cast

from physim.errors import PhysimError
from physim.joining import stamp

F = TypeVar("F", bound=Callable[..., Any])
HERE = Path(__file__).parent
IS_CHECKOUT = (HERE.parent / "setup.py").exists()
MEND = f"run: python -m pip install -e {HERE.parent}" if IS_CHECKOUT else "install physim again"


class BuildError(PhysimError, ImportError):
    """The compiled kernels are not there, or were built from other sources."""


def compiled(function: F) -> F:
    """The compiled form of a kernel, which stays at hand as ``py_func``."""
    found: Any = function
    if not is_plain():
        found = getattr(kernels(function.__module__), f"call_{function.__name__}", function)
    if found is not function:  # kernels that Python does not call have no compiled form
        functools.update_wrapper(found, function)
    found.py_func = function
    return cast(F, found)


def is_plain() -> bool:
    """Whether kernels are to run as Python."""
    return os.environ.get("PHYSIM_KERNELS") == "plain"


def address_of(kernel: Callable[..., None]) -> int:
    """Where a C library finds a kernel that takes whole numbers only and returns nothing."""
    if is_plain():
        return int(ctypes.cast(_callback(kernel), ctypes.c_void_p).value or 0)
    return int(getattr(kernels(kernel.__module__), f"address_of_{kernel.__name__}")())


@functools.cache
def _callback(kernel: Callable[..., None]) -> Any:
    """A plain kernel as a C function, which is kept: the library knows no more than its address."""
    numbers = [ctypes.c_int64] * kernel.__code__.co_argcount
    return ctypes.CFUNCTYPE(None, *numbers)(kernel)


@functools.cache
def kernels(module: str) -> ModuleType:
    """The compiled module that holds the kernels of a module.

    Raises BuildError where it is not there, or was built from other sources.
    """
    found, stamp_now = _built()
    if stamp_now != found.STAMP or module not in found.SOURCES:
        raise BuildError(f"physim: its kernels were compiled from other sources; {MEND}")
    return found


@functools.cache
def _built() -> tuple[ModuleType, str]:
    """What was built, and the stamp of the sources that lie here now."""
    try:
        found = importlib.import_module("physim._kernels")
    except ImportError as error:
        raise BuildError(f"physim: its kernels are not compiled ({error}); {MEND}") from None
    folders = {"physim": HERE}
    # found, not imported: its modules import this one
    controllers = importlib.util.find_spec("physim.controllers")
    if controllers is not None and controllers.origin is not None:
        folders["physim.controllers"] = Path(controllers.origin).parent
    return found, stamp(folders, found.SOURCES)
