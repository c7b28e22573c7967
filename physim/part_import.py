"""Importing the class of a part, ``module:Class``; every failure is one line that names it."""

from __future__ import annotations

import importlib
import os
import sys
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any

from physim.author_code import broken_by
from physim.errors import ControllerError, nearest
from physim.world.faults import describe as shown

if TYPE_CHECKING:
    from physim.registry import Kind


def load_class(kind: Kind, target: str, name: str) -> type[Any]:
    """Import ``module:Class``; every failure is a `ControllerError` on one line."""
    module_name, _, class_name = target.partition(":")
    if "/" in module_name or module_name.endswith(".py"):
        stem = module_name.removesuffix(".py").rsplit("/", 1)[-1]
        raise ControllerError(
            f"{kind.word} {shown(name)} names a file; write the module: {stem}:{class_name}, and "
            "run in its folder or put that on PYTHONPATH"
        )
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name != module_name:
            raise ControllerError(
                f"{kind.word} {shown(name)}: module {shown(module_name)} cannot be imported: "
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
            f"{kind.word} {shown(name)}: no module {shown(module_name)} in the current folder or "
            f"on the Python path{advice}"
        ) from error
    except (Exception, SystemExit) as error:
        raise ControllerError(
            f"{kind.word} {shown(name)}: module {shown(module_name)} cannot be imported: "
            f"{broken_by(error)}"
        ) from error
    found: Any = module
    for part in class_name.split("."):
        found = getattr(found, part, None)
    if not isinstance(found, type):
        classes = sorted(key for key, value in vars(module).items() if isinstance(value, type))
        raise ControllerError(
            f"{kind.word} {shown(name)}: module {shown(module_name)} has no class "
            f"{shown(class_name)}{nearest(class_name[:100], classes)}"
        )
    for method in kind.methods:
        if not callable(getattr(found, method, None)):
            raise ControllerError(
                f"{kind.word} {shown(name)}: class {class_name} has no method {kind.usage(method)}"
            )
    return found


def make_folder_importable() -> None:
    """Let ``module:Class`` name a file of the current folder, as ``python -m`` does."""
    folder = os.getcwd()
    if folder not in sys.path and "" not in sys.path:
        sys.path.insert(0, folder)
        importlib.invalidate_caches()


def _package(kind: Kind, name: str, target: str) -> str:
    """Name of the package that registered a target under a name; empty where none did."""
    for entry in entry_points(group=kind.group, name=name):
        if entry.value == target and entry.dist is not None:
            return entry.dist.name
    return ""
