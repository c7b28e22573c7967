"""Parts of a run by name: those that installed packages register, and, when trusted, any class.

A package registers a part by the entry point group of its kind (`Kind.group`). ``module:Class``
imports a module, so it is taken from the command line or Python alone, never from a world file.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import BaseModel, ValidationError

from physim.errors import ControllerError, Fault, Location, WorldError, dotted, nearest
from physim.installed import registered
from physim.parts.user_code import (
    folder_kept,
    kind_of,
    load_class,
    make_folder_importable,
    naming,
    place_of,
)
from physim.world.faults import describe, faults_of, unknown_key
from physim.world.kinds import thawed

if TYPE_CHECKING:
    from physim.parts.controller import Controller
    from physim.world import World


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
    one_is_enough: bool = False
    """whether a class needs only one of the methods"""

    def lacking(self, part: object) -> str:
        """The call of a method that a class or an object lacks, in words; empty where none."""
        has = [callable(getattr(part, call.partition("(")[0], None)) for call in self.calls]
        if self.one_is_enough and not has[-1] and callable(getattr(part, "batch", None)):
            return f"{self.calls[-1]}, which is asked in place of batch(scene); see start(scene)"
        if all(has) or (self.one_is_enough and any(has)):
            return ""
        return " or ".join(self.calls) if self.one_is_enough else self.calls[has.index(False)]


CONTROLLER = Kind(
    "controller", "physim.controllers",
    ("decide(observation, memory)", "decide_all(view, due, memory)"), ("controller",),
    "--controller", one_is_enough=True,
)  # fmt: skip
OF_ROBOTS = CONTROLLER._replace(option="")
"""Controllers of single robots and groups: no option of the command line takes their place"""
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
DRIVE = Kind(
    "drive", "physim.drives",
    ("most(v, omega)", "follow(command, state, dt)", "reach(state, time)"), ("drive",), "",
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
    for name in sorted(registered(kind.group)):
        try:
            doc = find_part(kind, name).__doc__
            found[name] = next(iter((doc or "").strip().splitlines()), "no description")
        except ControllerError as error:
            found[name] = str(error)
    return found


def shipped_parts(kind: Kind) -> list[str]:
    """Names of the parts of a kind that come with physim."""
    entries = registered(kind.group).items()
    return sorted(name for name, (target, *_) in entries if target.startswith("physim."))


def find_part(kind: Kind, name: str, trusted: bool = False) -> type[Any]:
    """Return the class of a part: a registered name, or ``module:Class`` when trusted.

    Raises `ControllerError` when it is unknown, may not be named here, or cannot be imported.
    """
    entries, what = registered(kind.group), f"{kind.word} {describe(name)}"
    target, *others = entries.get(name, (name,))
    known = ", ".join(sorted(entries)) or "none"
    if others:
        raise ControllerError(
            f"{what} is registered by several packages, as {', '.join(entries[name])}; give all "
            "but one another name"
        )
    if ":" not in target:
        own = f"give one of your own as {kind.option} MODULE:CLASS, or " if kind.option else ""
        name_one = "name one of these, or " if entries else ""
        raise ControllerError(
            f"no {kind.word} is called {describe(name)}; registered: {known}"
            f"{nearest(name[:100], sorted(entries))}; {name_one}{own}register one by an entry "
            f"point in the group {describe(kind.group)}, then pip install again"
        )
    if name not in entries:
        if not trusted:
            raise ControllerError(
                f"{describe(name)} names a class; a world may name registered {kind.word}s only: "
                f"{known}; {advice(kind, name)}"
            )
        make_folder_importable()
    return load_class(what, target, kind.lacking)


def advice(kind: Kind, name: str) -> str:
    """How a run is given a class: code is not run because a file names it."""
    if not kind.option:
        return f'register it in the entry points "{kind.group}"'
    return f"if you trust it, give {kind.option} {name}, in Python simulate(…, {kind.word}=…)"


def check_part(kind: Kind, part: object) -> None:
    """Raise `ControllerError` for a class, and for what lacks a method as its kind calls it."""
    if isinstance(part, type):
        raise ControllerError(
            f"{kind.word} is the class {part.__name__}; give an instance of it{place_of(part)}"
        )
    lacking, at = kind.lacking(part), None
    for call in kind.calls:
        name, _, given = call.rstrip(")").partition("(")
        method = getattr(part, name, None)
        try:
            if callable(method):
                inspect.signature(method).bind(*given.split(", "))
        except TypeError:
            lacking, at = call, method
            break
        except ValueError:  # built in, without a signature
            continue
    if lacking:
        raise ControllerError(
            f"{kind.word} {type(part).__name__} has no method {lacking}"
            f"{place_of(at) or place_of(type(part))}"
        )


def settings_model(part: type[Any]) -> type[BaseModel] | None:
    """Return the pydantic model of a part's settings, or None when it has none.

    Raises `ControllerError` when its ``Settings`` is something else.
    """
    settings = getattr(part, "Settings", None)
    if settings is None or (isinstance(settings, type) and issubclass(settings, BaseModel)):
        return settings
    raise ControllerError(
        f"{part.__name__}.Settings must be a pydantic model; it is {kind_of(settings)}"
        f"{place_of(part)}"
    )


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


def made_controller(world: World, trusted: bool = False) -> Controller:
    """Make the world's own controller. Raises as `make_part`."""
    choice = world.controller
    made: Controller = make_part(CONTROLLER, choice.type, choice.settings, trusted)
    return made


def made_part(kind: Kind, part: type[Any], settings: BaseModel | None, name: str) -> Any:
    """Make a part from its checked settings.

    Raises `ControllerError` where it fails, and where what its class gives lacks a method.
    """
    with naming(f"{kind.word} {describe(name)} cannot be made", part), folder_kept():
        made = part() if settings is None else part(settings)
        check_part(kind, made)
    return made


def make_by_defaults(kind: Kind, name: str, trusted: bool = False) -> Any:
    """Make a part that no world names: its settings are their defaults.

    Raises `ControllerError` as `make_part` does, and for a setting without default.
    """
    try:
        return make_part(kind, name, {}, trusted, ())
    except WorldError as error:
        needed = ", ".join(dotted(fault.location) for fault in error.faults)
        raise ControllerError(
            f"{kind.word} {describe(name)}: setting {needed} needs a default, because worlds do "
            f"not name {kind.word}s; from Python an object may be given"
        ) from error


def checked_settings(
    part: type[Any], settings: Mapping[str, Any], where: Location
) -> tuple[BaseModel | None, list[Fault]]:
    """Settings object of a part, or the faults of ``settings``, each at ``where`` and its key.

    They are checked strictly, as JSON would be: text is no number, a list may fill a tuple. A
    setting of None is left out, as in a world, which has no way to write it.
    """
    model = settings_model(part)
    allowed = [] if model is None else list(model.model_fields)
    faults: list[Fault] = []
    for key in (key for key in settings if key not in allowed):
        fault = unknown_key((*where, key), ["type", *allowed] if where and allowed else allowed)
        text = fault.message if allowed else f"{fault.message}; {part.__name__} takes no settings"
        faults.append(replace(fault, message=text))
    if model is None:
        return None, faults
    given = {key: thawed(settings[key]) for key in allowed if settings.get(key) is not None}
    try:
        with naming("settings cannot be read", model):
            return model.model_validate_json(json.dumps(given), strict=True), faults
    except ControllerError as error:
        if isinstance(error.__cause__, ValidationError):
            found = faults_of(error.__cause__, model)
            return None, faults + [Fault((*where, *one.location), one.message) for one in found]
        return None, [*faults, Fault(where, str(error))]
