"""Parts of a run by name: those that installed packages register, and, when trusted, any class.

A package registers a part by the entry point group of its kind (`Kind.group`). ``module:Class``
imports a module, so it is taken from the command line or Python alone, never from a world file.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from collections.abc import Mapping
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

from physim.errors import ControllerError, Fault, Location, WorldError, nearest
from physim.world.faults import faults_of, shown, unknown_key
from physim.world.frozen import thawed

if TYPE_CHECKING:
    from pydantic import BaseModel


class Kind(NamedTuple):
    """A kind of part that is found by name."""

    word: str
    """what it is called in messages"""
    group: str
    """of entry points"""
    methods: tuple[str, ...]
    """that its classes must have"""
    key: Location
    """where a world names it, one or a list; empty where no world does"""
    option: str
    """of the command line that takes a class too; empty where none does"""


CONTROLLER = Kind("controller", "physim.controllers", ("decide",), ("controller",), "--controller")
SENSING = Kind("sensing stage", "physim.sensing", ("start", "sense"), ("sensing", "stages"), "")
FILTER = Kind("filter", "physim.filters", ("start", "filter"), ("filters",), "")
DISTURBANCE = Kind(
    "disturbance", "physim.disturbances", ("start", "disturb"), ("disturbances",), ""
)
OBSERVER = Kind("observer", "physim.observers", ("start", "after_step", "close"), (), "--observer")
METRIC = Kind("metric", "physim.metrics", ("measure",), (), "")
PLOT = Kind("plot", "physim.plots", ("draw",), (), "")
STAGES = (SENSING, FILTER, DISTURBANCE)
"""Kinds of which a world lists any number, in the order of a step."""
KINDS = (CONTROLLER, *STAGES, OBSERVER)
"""Kinds that take part in a run; metrics and plots look at its record."""

OWN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "")
"""Where the code of physim is, which no message about somebody else's code points into."""


def part_names(kind: Kind) -> dict[str, str]:
    """Name and one-line description of every registered part of a kind, by name.

    One that cannot be imported is listed with the reason.
    """
    found = {}
    entries = _entries(kind)
    for name in sorted(entries):
        try:
            found[name] = _first_line(_registered(kind, entries, name))
        except ControllerError as error:
            found[name] = str(error)
    return found


def controller_names() -> dict[str, str]:
    """Name and one-line description of every registered controller, by name."""
    return part_names(CONTROLLER)


def shipped_parts(kind: Kind) -> list[str]:
    """Names of the parts of a kind that come with physim."""
    entries = _entries(kind).items()
    return sorted(name for name, (target, *_) in entries if target.startswith("physim."))


def find_part(kind: Kind, name: str, trusted: bool = False) -> type[Any]:
    """Return the class of a part: a registered name, or ``module:Class`` when trusted.

    Raises `ControllerError` when it is unknown, may not be named here, or cannot be imported.
    """
    entries = _entries(kind)
    if name in entries:
        return _registered(kind, entries, name)
    if ":" in name:
        if not trusted:
            option = f"; give it on the command line by {kind.option}" if kind.option else ""
            advice = option or f'; register it by an entry point in the group "{kind.group}"'
            raise ControllerError(
                f"{shown(name)} names a class; a world may name registered {kind.word}s only: "
                f"{', '.join(sorted(entries)) or 'none'}{advice}"
            )
        _make_folder_importable()
        return _load(kind, name, name)
    raise ControllerError(
        f"no {kind.word} is called {shown(name)}; registered: "
        f"{', '.join(sorted(entries)) or 'none'}{nearest(name[:100], sorted(entries))}"
    )


def check_part(kind: Kind, part: object) -> None:
    """Raise `ControllerError` where an object lacks a method of its kind, or is a class."""
    if isinstance(part, type):
        raise ControllerError(f"{kind.word} is the class {part.__name__}; give an instance of it")
    for method in kind.methods:
        if not callable(getattr(part, method, None)):
            raise ControllerError(
                f"{kind.word} {type(part).__name__} has no method {method}; it needs "
                f"{', '.join(kind.methods)}"
            )


def settings_model(part: type[Any]) -> type[BaseModel] | None:
    """Return the pydantic model of a part's settings, or None when it has none.

    Raises `ControllerError` when its ``Settings`` is something else.
    """
    from pydantic import BaseModel

    settings = getattr(part, "Settings", None)
    if settings is None:
        return None
    if not (isinstance(settings, type) and issubclass(settings, BaseModel)):
        raise ControllerError(f"{part.__name__}.Settings must be a pydantic model")
    return settings


def make_part(
    kind: Kind,
    name: str,
    settings: Mapping[str, Any],
    trusted: bool = False,
    where: Location | None = None,
) -> Any:
    """Make a part with its settings checked: ``cls(settings)``, or ``cls()`` without any.

    Raises `ControllerError` as `find_part` does, and `WorldError` with a fault at ``where`` (or
    ``kind.key``) and the key for each setting that is wrong.
    """
    part = find_part(kind, name, trusted)
    made, faults = checked_settings(part, settings, kind.key if where is None else where)
    if faults:
        raise WorldError(faults)
    return made_part(kind, part, made, name)


def made_part(kind: Kind, part: type[Any], settings: BaseModel | None, name: str) -> Any:
    """Make a part from its checked settings. Raises `ControllerError` where it fails."""
    try:
        return part() if settings is None else part(settings)
    except Exception as error:
        raise ControllerError(
            f"{kind.word} {shown(name)} cannot be made: {broken_by(error)}"
        ) from error


def checked_settings(
    part: type[Any], settings: Mapping[str, Any], where: Location
) -> tuple[BaseModel | None, list[Fault]]:
    """Settings object of a part, or the faults of ``settings``, each at ``where`` and its key.

    They are checked strictly, as JSON would be: text is no number, a list may fill a tuple.
    """
    from pydantic import ValidationError

    model = settings_model(part)
    allowed = [] if model is None else list(model.model_fields)
    faults = [unknown_key((*where, key), allowed) for key in settings if key not in allowed]
    if model is None:
        return None, faults
    known = {key: thawed(value) for key, value in settings.items() if key in allowed}
    try:
        made = model.model_validate_json(json.dumps(known), strict=True)
    except ValidationError as error:
        faults += [
            Fault((*where, *fault.location), fault.message) for fault in faults_of(error, model)
        ]
        return None, faults
    except (TypeError, ValueError) as error:
        return None, [*faults, Fault(where, f"settings cannot be read: {error}")]
    return made, faults


def _entries(kind: Kind) -> dict[str, tuple[str, ...]]:
    """``module:Class`` by name: several where packages give different ones the same name."""
    found: dict[str, set[str]] = {}
    for entry in entry_points(group=kind.group):
        found.setdefault(entry.name, set()).add(entry.value)
    return {name: tuple(sorted(targets)) for name, targets in found.items()}


def _registered(kind: Kind, entries: Mapping[str, tuple[str, ...]], name: str) -> type[Any]:
    """Import what is registered under a name; `ControllerError` where that are several classes."""
    target, *others = entries[name]
    if others:
        raise ControllerError(
            f"{kind.word} {shown(name)} is registered by several packages, as "
            f"{', '.join(entries[name])}; give all but one another name"
        )
    return _load(kind, target, name)


def _first_line(part: type[Any]) -> str:
    lines = (part.__doc__ or "").strip().splitlines()
    return lines[0] if lines else "no description"


def _load(kind: Kind, target: str, name: str) -> type[Any]:
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
        raise ControllerError(
            f"{kind.word} {shown(name)}: no module {shown(module_name)} in the current folder or "
            "on the Python path"
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
            arguments = "(observation, memory)" if kind is CONTROLLER else ""
            raise ControllerError(
                f"{kind.word} {shown(name)}: class {class_name} has no method {method}{arguments}"
            )
    return found


def _make_folder_importable() -> None:
    """Let ``module:Class`` name a file of the current folder, as ``python -m`` does."""
    folder = os.getcwd()
    if folder not in sys.path and "" not in sys.path:
        sys.path.insert(0, folder)
        importlib.invalidate_caches()


def broken_by(error: BaseException) -> str:
    """Type, text and place of an error in somebody else's code, on one line."""
    text = " ".join(str(error).split())[:200]
    if isinstance(error, SyntaxError):  # its text names file and line
        return f"{type(error).__name__}: {text}"
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename[:1] != "<"]
    ours = (OWN, importlib.__path__[0])  # what imports their module is not theirs
    theirs = [f for f in frames if not f.filename.startswith(ours)] or frames
    inside = [f for f in theirs if f.filename == theirs[0].filename]  # not what their code calls
    place = f" ({inside[-1].filename}:{inside[-1].lineno})" if inside else ""
    return f"{type(error).__name__}: {text}{place}"
