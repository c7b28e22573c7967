"""Parts of a run by name: those that installed packages register, and, when trusted, any class.

A package registers a part by the entry point group of its kind (`Kind.group`). ``module:Class``
imports a module, so it is taken from the command line or Python alone, never from a world file.
"""

from __future__ import annotations

import functools
import json
import os
import sys
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

from physim.errors import ControllerError, Fault, Location, WorldError, dotted, nearest
from physim.escaping import escaped
from physim.parts.user_code import (
    attribute,
    broken_by,
    folder_kept,
    kind_of,
    load_class,
    make_folder_importable,
    place_of,
    takes,
)
from physim.world.faults import describe, faults_of, unknown_key
from physim.world.kinds import thawed

if TYPE_CHECKING:
    from pydantic import BaseModel


class Kind(NamedTuple):
    """A kind of part that is found by name."""

    word: str
    """what it is called in messages"""
    group: str
    """of entry points"""
    calls: tuple[str, ...]
    """of the methods that its classes must have, each with its arguments"""
    key: Location
    """where a world names it, one or a list; empty where no world does"""
    option: str
    """of the command line that takes a class too; empty where none does"""

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods that its classes must have."""
        return tuple(call.partition("(")[0] for call in self.calls)

    def usage(self, method: str) -> str:
        """How a method is called: ``sense(scene, truth, sensed, state)``."""
        return self.calls[self.methods.index(method)]

    @property
    def place(self) -> str:
        """Where a world names it, as ``sensing.stages``; empty where no world does."""
        return dotted(self.key)


CONTROLLER = Kind(
    "controller", "physim.controllers", ("decide(observation, memory)",), ("controller",),
    "--controller",
)  # fmt: skip
SENSING = Kind(
    "sensing stage", "physim.sensing", ("start(scene)", "sense(scene, truth, sensed, state)"),
    ("sensing", "stages"), "",
)  # fmt: skip
FILTER = Kind(
    "filter", "physim.filters", ("start(scene)", "filter(scene, sensed, nominal, state)"),
    ("filters",), "",
)  # fmt: skip
DISTURBANCE = Kind(
    "disturbance", "physim.disturbances",
    ("start(scene)", "disturb(scene, truth, filtered, state)"), ("disturbances",), "",
)  # fmt: skip
OBSERVER = Kind(
    "observer", "physim.observers", ("start(simulation)", "after_step(step)", "close(ended)"), (),
    "--observer",
)  # fmt: skip
METRIC = Kind("metric", "physim.metrics", ("measure(record)",), (), "")
PLOT = Kind("plot", "physim.plots", ("draw(record)",), (), "")
STAGES = (SENSING, FILTER, DISTURBANCE)
"""Kinds of which a world lists any number, in the order of a step."""
KINDS = (CONTROLLER, *STAGES, OBSERVER)
"""Kinds that take part in a run; metrics and plots look at its record."""


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
            raise ControllerError(
                f"{describe(name)} names a class; a world may name registered {kind.word}s only: "
                f"{', '.join(sorted(entries)) or 'none'}; {advice(kind, name)}"
            )
        make_folder_importable(kind, name)
        return load_class(kind, name, name)
    known = sorted(entries)
    raise ControllerError(
        f"no {kind.word} is called {describe(name)}; registered: {', '.join(known) or 'none'}"
        f"{_elsewhere(kind, name) or nearest(name[:100], known) or _own(kind, name, trusted)}"
    )


def advice(kind: Kind, name: str) -> str:
    """How a run is given a class: code is not run because a file names it."""
    if not kind.option:
        return f'register it in the entry points "{kind.group}"'
    return f"if you trust it, give {kind.option} {name}, in Python simulate(…, {kind.word}=…)"


def check_part(kind: Kind, part: object) -> None:
    """Raise `ControllerError` where an object lacks a method of its kind, or is a class."""
    if isinstance(part, type):
        raise ControllerError(
            f"{kind.word} is the class {part.__name__}; give an instance of it{place_of(part)}"
        )
    for method in kind.methods:
        if not callable(attribute(part, method)):
            raise ControllerError(
                f"{kind.word} {type(part).__name__} has no method {method}; it needs "
                f"{', '.join(kind.methods)}{place_of(type(part))}"
            )


def settings_model(part: type[Any]) -> type[BaseModel] | None:
    """Return the pydantic model of a part's settings, or None when it has none.

    Raises `ControllerError` when its ``Settings`` is something else.
    """
    from pydantic import BaseModel

    settings = attribute(part, "Settings")
    if settings is None:
        return None
    if not (isinstance(settings, type) and issubclass(settings, BaseModel)):
        raise ControllerError(
            f"{part.__name__}.Settings must be a pydantic model; it is {kind_of(settings)}"
            f"{place_of(settings) or place_of(part)}"
        )
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
    """Make a part from its checked settings.

    Raises `ControllerError` where it fails, and where what its class gives lacks a method.
    """
    given = () if settings is None else (settings,)
    try:
        with folder_kept():
            made = part(*given)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        reason = broken_by(error)
        if isinstance(error, TypeError) and not takes(part, *given):
            reason = _unmade(part, bool(given))
        raise ControllerError(f"{kind.word} {describe(name)} cannot be made: {reason}") from error
    lacking = [method for method in kind.methods if not callable(attribute(made, method))]
    if isinstance(made, type) or lacking:
        raise ControllerError(
            f"{kind.word} {describe(name)} cannot be made: {part.__name__}() gives "
            f"{kind_of(made)}; it must give an object with {', '.join(kind.methods)}"
            f"{place_of(part)}"
        )
    return made


def make_by_defaults(kind: Kind, name: str, trusted: bool = False) -> Any:
    """Make a part that no world names: its settings are their defaults.

    Raises `ControllerError` as `find_part` and `made_part` do, and for a setting without default.
    """
    part = find_part(kind, name, trusted)
    made, faults = checked_settings(part, {}, ())
    if faults:
        needed = ", ".join(dotted(fault.location) for fault in faults)
        raise ControllerError(
            f"{kind.word} {describe(name)}: setting {needed}: needs a default, because worlds do "
            f"not name {kind.word}s; from Python an object may be given{place_of(part)}"
        )
    return made_part(kind, part, made, name)


def checked_settings(
    part: type[Any], settings: Mapping[str, Any], where: Location
) -> tuple[BaseModel | None, list[Fault]]:
    """Settings object of a part, or the faults of ``settings``, each at ``where`` and its key.

    They are checked strictly, as JSON would be: text is no number, a list may fill a tuple. A
    setting of None is left out, as in a world, which has no way to write it.
    """
    from pydantic import ValidationError

    model = settings_model(part)
    allowed = [] if model is None else list(model.model_fields)
    faults: list[Fault] = []
    for key in (key for key in settings if key not in allowed):
        known_keys = ["type", *allowed] if where and allowed else allowed
        fault = unknown_key((*where, key), known_keys)
        text = fault.message if allowed else f"{fault.message}; {part.__name__} takes no settings"
        faults.append(replace(fault, message=text))
    if model is None:
        return None, faults
    given = {key: value for key, value in settings.items() if value is not None}
    known = {key: thawed(value) for key, value in given.items() if key in allowed}
    try:
        made = model.model_validate_json(json.dumps(known), strict=True)
    except ValidationError as error:
        faults += [
            Fault((*where, *fault.location), fault.message) for fault in faults_of(error, model)
        ]
        return None, faults
    except (TypeError, ValueError) as error:
        return None, [*faults, Fault(where, f"settings cannot be read: {error}")]
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a validator of the user's
        reason = f"settings cannot be read: {broken_by(error)}"
        return None, [*faults, Fault(where, reason)]
    return made, faults


def _entries(kind: Kind) -> dict[str, tuple[str, ...]]:
    """``module:Class`` by name: several where packages give different ones the same name."""
    return _installed(kind.group, tuple((folder, _changed(folder)) for folder in sys.path))


@functools.lru_cache
def _installed(
    group: str, folders: tuple[tuple[str, int | None], ...]
) -> dict[str, tuple[str, ...]]:
    """Entry points of a group, read anew once packages come or go: every run asks, in 3 ms."""
    found: dict[str, set[str]] = {}
    for entry in entry_points(group=group):
        found.setdefault(entry.name, set()).add(entry.value)
    return {name: tuple(sorted(targets)) for name, targets in found.items()}


def _changed(folder: str) -> int | None:
    """When something was put into a folder or taken out of it last; None where it is none."""
    try:
        return os.stat(folder or os.curdir).st_mtime_ns
    except (OSError, ValueError):
        return None


def _registered(kind: Kind, entries: Mapping[str, tuple[str, ...]], name: str) -> type[Any]:
    """Import what is registered under a name; `ControllerError` where they are several classes."""
    target, *others = entries[name]
    if others:
        raise ControllerError(
            f"{kind.word} {describe(name)} is registered by several packages, as "
            f"{', '.join(entries[name])}; give all but one another name"
        )
    return load_class(kind, target, name)


def _unmade(part: type[Any], settings: bool) -> str:
    """Why a class cannot be made of what its ``Settings`` say that it is made of."""
    name = part.__name__
    has, made = ("has", f"{name}(settings)") if settings else ("has no", f"{name}()")
    init = part.__init__
    return (
        f"class {name} {has} Settings, so it is made as {made}, which its __init__ does not take"
        f"{place_of(init if hasattr(init, '__code__') else part)}"
    )


def _elsewhere(kind: Kind, name: str) -> str:
    """What else is registered by a name: another kind of part, or in a group that is none."""
    kinds = (*KINDS, METRIC, PLOT)
    for other in kinds:
        if other is not kind and name in _entries(other):
            article = "an" if other.word[0] in "aeiou" else "a"
            named = f", which a world names under {other.place}" if other.key else ""
            return f"; {describe(name)} is {article} {other.word}{named}"
    groups = {other.group for other in kinds}
    for entry in entry_points(name=name):
        if entry.group.startswith("physim") and entry.group not in groups:
            return (
                f"; {describe(name)} is registered in {describe(entry.group)}, which is no group "
                f"of parts; write {describe(kind.group)}, then pip install again"
            )
    return ""


def _own(kind: Kind, name: str, trusted: bool) -> str:
    registered = f"register one by an entry point in the group {describe(kind.group)}"
    path, dot, own = name.removesuffix(".py").removeprefix("./").rpartition(".")
    module, own = (path, own) if dot and "/" not in name else (path + dot + own, "CLASS")
    like = f"{escaped(module.replace('/', '.'))[:40]}:{escaped(own)[:40]}"
    given = f"one of your own is given as MODULE:CLASS, here {like}; or " if trusted else ""
    return f"; {given}{registered}, then pip install again"


def _first_line(part: type[Any]) -> str:
    return next(iter((part.__doc__ or "").strip().splitlines()), "no description")
