"""Code that users write: importing and calling it, and its errors on one line each.

A line names the file and line of their code, not of ours.
"""

from __future__ import annotations

import importlib
import inspect
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, chdir, contextmanager, nullcontext
from typing import Any

import numpy as np
import pydantic

from physim.errors import ControllerError, PhysimError, nearest
from physim.world.faults import describe

OWN = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "")
"""Where the code of physim is, which no message about somebody else's code points into."""
NOT_THEIRS = (OWN, importlib.__path__[0], pydantic.__path__[0], "<")
"""Beginnings of the files that import their modules, call their validators, or are none"""


@contextmanager
def naming(what: str, written: object = None) -> Iterator[None]:
    """Make every error within a ControllerError of one line, which begins with ``what``.

    It ends with the line of the user's code that the error came through. Where that is none, as
    for what they returned, it is the one at which ``written`` stands, a function or class.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise ControllerError(f"{what}: {broken_by(error, written)}") from error


def broken_by(error: BaseException, written: object = None) -> str:
    """Type, text and place of an error in somebody else's code, on one line; see `naming`."""
    if isinstance(error, PhysimError):
        text = str(error)
    elif isinstance(error, pydantic.ValidationError):
        text = first_fault(error)
    else:
        text = "".join(traceback.format_exception_only(error))[:200]
    text = " ".join(text.split())
    frames = traceback.extract_tb(error.__traceback__)
    theirs = [frame for frame in frames if not frame.filename.startswith(NOT_THEIRS)]
    if theirs:  # not what their code calls
        last = [frame for frame in theirs if frame.filename == theirs[0].filename][-1]
        return f"{text} ({last.filename}:{last.lineno})"
    return f"{text}{place_of(written)}"


def first_fault(error: pydantic.ValidationError) -> str:
    """The first of pydantic's faults: ``modes.0.colour is 'red': String should match …``."""
    fault = error.errors(include_url=False)[0]
    place = ".".join(map(str, fault["loc"]))
    given = "missing" if fault["type"] == "missing" else f"{fault['input']!r:.100}"
    return f"{place} is {given}: {fault['msg'].removeprefix('Value error, ')}"


def place_of(written: Any) -> str:
    """`` (file:line)`` at which a function, method or class is written; empty if unknown."""
    try:
        code = getattr(inspect.unwrap(written), "__code__", None)
        line = code.co_firstlineno if code else inspect.getsourcelines(written)[1]
        return f" ({inspect.getsourcefile(written)}:{line})"
    except (OSError, TypeError):  # written nowhere
        return ""


def is_shipped(part: object) -> bool:
    """Whether a part comes with physim: an error in it is a fault of ours, and told as one."""
    return type(part).__module__.partition(".")[0] == "physim"


def kind_of(value: object) -> str:
    """Say what a value is, for a message about what was given."""
    if value is None:
        return "None"
    if type(value) is np.ndarray:
        return f"an array of {value.dtype} of the shape {value.shape}"
    name = type(value).__name__
    word = f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"
    if isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        return f"{word} of {len(value)}"
    return word


def folder_kept() -> AbstractContextManager[None]:
    """Be in the same working folder afterwards: code that is loaded may go to its weights, but the
    files of a command are meant where it was given."""
    return chdir(os.curdir) if os.path.exists(os.curdir) else nullcontext()


def load_class(what: str, target: str, lacking: Callable[[object], str]) -> type[Any]:
    """Import ``module:Class``, of which ``lacking`` says the method that it lacks.

    Every failure is a `ControllerError` on one line, which begins with ``what``.
    """
    module_name, _, class_name = target.partition(":")
    module = f"module {describe(module_name)}"
    if "/" in module_name or module_name.endswith(".py"):
        stem = module_name.removesuffix(".py").rsplit("/", 1)[-1]
        raise ControllerError(
            f"{what} names a file; write the module: {stem}:{class_name}, and run in its folder, "
            "or put that on PYTHONPATH"
        )
    try:
        with naming(f"{what}: {module} cannot be imported"), folder_kept():
            found: Any = importlib.import_module(module_name)
    except ControllerError as error:
        cause = error.__cause__
        lost = cause.name if isinstance(cause, ModuleNotFoundError) else None
        if lost is None or not f"{module_name}.".startswith(f"{lost}."):
            raise
        raise ControllerError(
            f"{what}: no {module} in the current folder or on the Python path"
        ) from cause
    written = found
    for part in class_name.split("."):
        found = getattr(found, part, None)
    if not isinstance(found, type):
        classes = sorted(key for key, value in vars(written).items() if isinstance(value, type))
        place = place_of(found) or f" ({getattr(written, '__file__', module_name)})"
        raise ControllerError(
            f"{what}: {module} has no class {describe(class_name)}"
            f"{nearest(class_name[:100], classes)}{place}"
        )
    if lack := lacking(found):
        raise ControllerError(f"{what}: class {class_name} has no method {lack}{place_of(found)}")
    return found


def make_folder_importable() -> None:
    """Let ``module:Class`` name a file of the current folder.

    The folder comes last, other than with ``python -m``: what physim and its libraries import later
    must not be a file of the user that has the same name, such as an ``av.py`` for vehicles.
    """
    folder = os.getcwd()
    if folder not in sys.path and "" not in sys.path:
        sys.path.append(folder)
        importlib.invalidate_caches()
