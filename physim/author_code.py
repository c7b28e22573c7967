"""Errors of parts that others write: one line each, with the line of their code, not of ours."""

from __future__ import annotations

import importlib
import inspect
import os
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np

OWN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "")
"""Where the code of physim is, which no message about somebody else's code points into."""


class MistakenError(Exception):
    """What a part gave or takes is not what it must be; the text says all, its own line too."""


def broken_by(error: BaseException) -> str:
    """Type, text and place of an error in somebody else's code, on one line."""
    if isinstance(error, MistakenError):
        return str(error)
    text = " ".join(str(error).split())[:200]
    if isinstance(error, SyntaxError):  # its text names file and line
        return f"{type(error).__name__}: {text}"
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename[:1] != "<"]
    ours = (OWN, importlib.__path__[0])  # what imports their module is not theirs
    theirs = [f for f in frames if not f.filename.startswith(ours)] or frames
    inside = [f for f in theirs if f.filename == theirs[0].filename]  # not what their code calls
    place = f" ({inside[-1].filename}:{inside[-1].lineno})" if inside else ""
    return f"{type(error).__name__}: {text}{place}"


def asked(call: Callable[..., Any], usage: str, *given: Any) -> Any:
    """Call a method of a part; `MistakenError` where it does not take what it is given.

    ``usage`` is how it is called, such as ``filter(scene, sensed, nominal, state)``.
    """
    try:
        return call(*given)
    except TypeError as error:
        if takes(call, *given):
            raise
        raise MistakenError(
            f"it is called as {usage}, which it does not take{place_of(call)}"
        ) from error


def takes(call: Callable[..., Any], *given: Any) -> bool:
    """Whether arguments go with what a function or class declares; True where that is unknown."""
    try:
        inspect.signature(call).bind(*given)
    except TypeError:
        return False
    except ValueError:  # built in, without a signature
        return True
    return True


def place_of(written: Any) -> str:
    """`` (file:line)`` at which a function, method or class is written; empty if unknown."""
    try:
        code = getattr(inspect.unwrap(written), "__code__", None)
        if code is not None:
            return f" ({code.co_filename}:{code.co_firstlineno})"
        return f" ({inspect.getsourcefile(written)}:{inspect.getsourcelines(written)[1]})"
    except (OSError, TypeError, ValueError):
        return ""


def kind_of(value: object) -> str:
    """Say what a value is, for a message that tells what was given instead of it."""
    if value is None:
        return "None"
    if isinstance(value, np.ndarray):
        return f"an array of the shape {value.shape}"
    name = type(value).__name__
    word = f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"
    if isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        return f"{word} of {len(value)}"
    return word
