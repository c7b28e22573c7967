"""Code that users write: importing and calling it, and its errors on one line each.

A line names the file and line of their code, not of ours.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import os
import re
import site
import sys
import sysconfig
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.machinery import PathFinder
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any

import numpy as np
import pydantic

from physim.errors import ControllerError, nearest
from physim.world.faults import describe

if TYPE_CHECKING:
    from physim.parts.registry import Kind


OWN = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "")
"""Where the code of physim is, which no message about somebody else's code points into."""


class MistakenError(Exception):
    """What a part gave or takes is not what it must be; the text says all, its own line too."""


def broken_by(error: BaseException) -> str:
    """Type, text and place of an error in somebody else's code, on one line."""
    if isinstance(error, MistakenError):
        return str(error)
    text = " ".join(_said(error).split())[:200]
    if isinstance(error, SyntaxError):  # its text names file and line
        return f"{type(error).__name__}: {text}"
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename[:1] != "<"]
    # what imports their module and calls their validators is not theirs
    ours = (OWN, importlib.__path__[0], pydantic.__path__[0])
    theirs = [f for f in frames if not f.filename.startswith(ours)] or frames
    inside = [f for f in theirs if f.filename == theirs[0].filename]  # not what their code calls
    place = f" ({inside[-1].filename}:{inside[-1].lineno})" if inside else ""
    return f"{type(error).__name__}: {text}{place}"


def _said(error: BaseException) -> str:
    """Text of an error, whose class may be theirs, too."""
    try:
        return str(error)
    except KeyboardInterrupt:
        raise
    except BaseException:
        return "(its text cannot be had)"


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


def attribute(owner: object, name: str, default: Any = None) -> Any:
    """Attribute of somebody else's object or class, whose code may be asked for it.

    Raises ControllerError for whatever that raises.
    """
    try:
        return getattr(owner, name, default)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        kind = type(owner)  # not isinstance, which asks the owner
        of = getattr(owner, "__name__", "") if issubclass(kind, type) else kind.__name__
        raise ControllerError(f"{of}.{name} cannot be read: {broken_by(error)}") from error


def is_shipped(part: object) -> bool:
    """Whether a part comes with physim: an error in it is a fault of ours, and told as one."""
    return type(part).__module__.partition(".")[0] == "physim"


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
    """`` (file:line)`` at which a function, method or class is written; empty if unknown.

    Of a module its file alone.
    """
    try:
        if inspect.ismodule(written):
            return f" ({inspect.getsourcefile(written) or written.__file__})"
        code = getattr(inspect.unwrap(written), "__code__", None)
        if code is not None:
            return f" ({code.co_filename}:{code.co_firstlineno})"
        return f" ({inspect.getsourcefile(written)}:{inspect.getsourcelines(written)[1]})"
    except Exception:  # what may be asked of somebody's object may fail in any way
        return ""


def kind_of(value: object) -> str:
    """Say what a value is, for a message about what was given."""
    if value is None:
        return "None"
    if isinstance(value, np.ndarray):
        return f"an array of the shape {value.shape}"
    name = type(value).__name__
    word = f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"
    if isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        return f"{word} of {len(value)}"
    return word


@contextmanager
def folder_kept() -> Iterator[None]:
    """Be in the same working folder afterwards: code that is loaded may go to its weights, but the
    files of a command are meant where it was given."""
    try:
        before = os.getcwd()
    except OSError:  # deleted
        yield
        return
    try:
        yield
    finally:
        with suppress(OSError):
            if os.getcwd() != before:
                os.chdir(before)


def load_class(kind: Kind, target: str, name: str) -> type[Any]:
    """Import ``module:Class``; every failure is a `ControllerError` on one line."""
    module_name, _, class_name = target.partition(":")
    if "/" in module_name or module_name.endswith(".py"):
        stem = module_name.removesuffix(".py").rsplit("/", 1)[-1]
        raise ControllerError(
            f"{kind.word} {describe(name)} names a file; write the module: {stem}:{class_name}, "
            "and run in its folder, or put that on PYTHONPATH"
        )
    try:
        with folder_kept():
            module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if not f"{module_name}.".startswith(f"{error.name}."):
            raise ControllerError(
                f"{kind.word} {describe(name)}: module {describe(module_name)} cannot be imported: "
                f"{broken_by(error)}"
            ) from error
        package = _package(kind, name, target)
        advice = (
            f"; package {package} registers it: name it in py-modules of its pyproject.toml, then "
            "pip install again"
            if package
            else ""
        )
        raise ControllerError(
            f"{kind.word} {describe(name)}: no module {describe(module_name)} in the current "
            f"folder or on the Python path{advice}"
        ) from error
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise ControllerError(
            f"{kind.word} {describe(name)}: module {describe(module_name)} cannot be imported: "
            f"{broken_by(error)}"
        ) from error
    found: Any = module
    for part in class_name.split("."):
        found = attribute(found, part)
    if not isinstance(found, type):
        if found is not None:
            raise ControllerError(
                f"{kind.word} {describe(name)}: module {describe(module_name)} has no class "
                f"{describe(class_name)}: it is {kind_of(found)}"
                f"{place_of(found) or place_of(module)}"
            )
        classes = sorted(key for key, value in vars(module).items() if isinstance(value, type))
        raise ControllerError(
            f"{kind.word} {describe(name)}: module {describe(module_name)} has no class "
            f"{describe(class_name)}{nearest(class_name[:100], classes)}{place_of(module)}"
        )
    for method in kind.methods:
        if not callable(attribute(found, method)):
            raise ControllerError(
                f"{kind.word} {describe(name)}: class {class_name} has no method "
                f"{kind.usage(method)}{place_of(found)}"
            )
    return found


def make_folder_importable(kind: Kind, target: str) -> None:
    """Let ``module:Class`` name a file of the current folder.

    The folder comes after what is installed, other than with ``python -m``: what physim and its
    libraries import later must not be a file of the user that has the same name, such as an
    ``av.py`` for vehicles. Raises ControllerError where an installed module would be taken for the
    file that is meant.
    """
    folder, installed = os.getcwd(), _installed()
    if folder not in sys.path and "" not in sys.path:
        last = max((k for k, one in enumerate(sys.path) if one in installed), default=-1)
        sys.path.insert(last + 1, folder)
        importlib.invalidate_caches()
    name = re.split("[.:]", target, maxsplit=1)[0]
    hidden = _found(name) if PathFinder.find_spec(name, [folder]) is not None else ""
    others = tuple(os.path.join(one, "") for one in installed)
    if hidden in ("built-in", "frozen") or hidden.startswith(others):
        raise ControllerError(
            f"{kind.word} {describe(target)}: {describe(name)} is a module of this folder, and "
            f"another that is installed ({hidden}); rename yours"
        )


def _installed() -> set[str]:
    """Folders of the standard library and of what is installed."""
    paths = sysconfig.get_paths()
    library = (paths[key] for key in ("stdlib", "purelib", "platlib"))
    return {*library, *site.getsitepackages(), site.getusersitepackages()}


def _found(name: str) -> str:
    """Where Python finds a module; empty where nowhere, or in no file."""
    try:
        found = importlib.util.find_spec(name)
    except (ImportError, ValueError):  # made by hand, without a spec
        return ""
    return "" if found is None else found.origin or ""


def _package(kind: Kind, name: str, target: str) -> str:
    """Name of the package that registered a target under a name; empty where none did."""
    for entry in entry_points(group=kind.group, name=name):
        if entry.value == target and entry.dist is not None:
            return entry.dist.name
    return ""
