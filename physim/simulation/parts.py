"""The parts of a run: found by name or given from Python, with what each was set by."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from physim.errors import ControllerError, Fault, Notice
from physim.parts.controller import Controller
from physim.parts.given import GivenSettings, given_settings
from physim.parts.registry import (
    CONTROLLER,
    DISTURBANCE,
    FILTER,
    SENSING,
    STAGES,
    Kind,
    check_part,
    checked_settings,
    find_part,
    made_part,
    make_part,
)
from physim.parts.user_code import kind_of
from physim.parts.world_checks import driver_faults, faults_said
from physim.simulation.team import driving, united
from physim.world import World
from physim.world.file.loading import drives_none, unused_settings
from physim.world.group import Driver


def driven_by(world: World, controller: Controller | str | None) -> World:
    """The world with another controller, where that is a name, as ``--controller`` has it.

    Settings of the world belong to the type beside them: that one keeps them, another goes without,
    which a `Notice` tells. Where the world names no type they are for whatever runs. Raises
    WorldError, and ControllerError for an unknown controller.
    """
    if not isinstance(controller, str):
        return world
    find_part(CONTROLLER, controller, trusted=True)  # an unknown one is refused before a notice
    own = world.controller
    mine = own.type == controller or "type" not in own.model_fields_set
    if own.settings and not mine:
        left = unused_settings([*own.settings], own.type, controller)
        advice = f'changed(controller={{"type": "{controller}", …}}) gives it its own'
        if ":" in controller:  # which no world may name
            kind = controller.rpartition(":")[2]
            advice = f"with settings of its own give it as an object, controller={kind}(…)"
        text = f"world {world.name}: controller: {left} ({advice})"
        warnings.warn(text, Notice, stacklevel=4)
    return world.changed(controller={**(own.settings if mine else {}), "type": controller})


class Part(NamedTuple):
    """One part of a run."""

    kind: Kind
    name: str
    """the world's, or ``module:Class`` of an object"""
    made: Any
    settings: GivenSettings
    from_python: bool
    """whether it stands in place of or beside what the world names"""


@dataclass(frozen=True)
class Parts:
    """Controller and stages of a run, in their order."""

    all: tuple[Part, ...]
    """the world's own controller, or what takes its place, first"""
    driving: tuple[tuple[Controller, Driver], ...]
    """what decides, and for which robots"""
    controller: Controller
    """all of these as one"""

    def of(self, kind: Kind) -> tuple[Any, ...]:
        """Parts of a stage."""
        return tuple(part.made for part in self.all if part.kind == kind)

    @property
    def names(self) -> tuple[str, ...]:
        """What each is called, stages with their kind."""
        return tuple(
            name if kind == CONTROLLER else f"{kind.word} {name}" for kind, name, *_ in self.all
        )

    @property
    def settings(self) -> tuple[GivenSettings, ...]:
        """Settings of each of the names."""
        return tuple(part.settings for part in self.all)

    @property
    def given(self) -> tuple[Part, ...]:
        """Those that came from Python."""
        return tuple(part for part in self.all if part.from_python)

    def set_otherwise(self, others: Sequence[GivenSettings]) -> str:
        """In what the parts of another run, of the same names, are set otherwise; "" in nothing."""
        for name, other, own in zip(self.names, others, self.settings, strict=True):
            for key in (*other.settings, *other.not_known, *own.settings, *own.not_known):
                if (there := other.told(key)) != (here := own.told(key)):
                    return f"{name} has {key} {there}, here {here}"
        return ""

    def faults(self, world: World) -> list[Fault]:
        """What they say against a world; see `physim.parts.world_checks`."""
        found: list[Fault] = []
        for controller, driver in self.driving:
            found += driver_faults(controller, world, driver)
        for kind in STAGES:
            for k, part in enumerate(self.of(kind)):
                found += faults_said(part, "world_faults", world, (*kind.key, k))
        return found


def parts_of(
    world: World, controller: Controller | str | None, stages: Mapping[Kind, Any]
) -> Parts:
    """Parts that a world names, with what is given from Python.

    A controller takes the place of the world's own; stages stand behind those of the world. Raises
    ControllerError for what is no such part, WorldError for settings that are wrong.
    """
    own = world.controller
    if controller is None or isinstance(controller, str):
        name = own.type if controller is None else controller
        settings = own.settings if own.type == name else {}
        chosen = make_part(CONTROLLER, name, settings, trusted=controller is not None)
        from_python = name != own.type
    else:
        check_part(CONTROLLER, controller)
        chosen, from_python = controller, not _is_worlds_own(controller, world)
        name = class_name(controller) if from_python else own.type
    drivers = driving(world, chosen, name if from_python else None)
    if from_python and not any(one.is_own for _, one in drivers):
        raise ControllerError(f"controller {drives_none(name)}")
    found = [Part(CONTROLLER, name, chosen, given_settings(chosen), from_python)]
    in_world = {
        SENSING: world.sensing.stages, FILTER: world.filters, DISTURBANCE: world.disturbances
    }  # fmt: skip
    for kind in STAGES:
        for k, choice in enumerate(in_world[kind]):
            made = make_part(kind, choice.type, choice.settings, where=(*kind.key, k))
            found.append(Part(kind, choice.type, made, given_settings(made), False))
        for part in listed(str(kind.key[0]), stages[kind]):
            check_part(kind, part)
            found.append(Part(kind, class_name(part), part, given_settings(part), True))
    return Parts(tuple(found), drivers, united(drivers))


def listed(key: str, given: Any) -> tuple[Any, ...]:
    """Parts of a kind that were given from Python. Raises `ControllerError` where they are one."""
    if isinstance(given, Iterable) and not isinstance(given, str):
        return tuple(given)
    name = given if isinstance(given, str) else type(given).__name__
    raise ControllerError(
        f"{key} must be a list of objects; {kind_of(given)} given; write {key}=[{name}(…)]"
    )


def class_name(part: object) -> str:
    """``module:Class`` of an object."""
    return f"{type(part).__module__}:{type(part).__qualname__}"


def _is_worlds_own(given: object, world: World) -> bool:
    """Whether an object is, as far as it tells, what the world's choice of a controller makes."""
    own, kind = world.controller, type(given)
    if ":" in own.type:  # no code is run because a world names it
        if class_name(given) != own.type:
            return False
    elif find_part(CONTROLLER, own.type) is not kind:
        return False
    settings, faults = checked_settings(kind, own.settings, CONTROLLER.key)
    if faults:
        return False
    try:
        made = made_part(CONTROLLER, kind, settings, own.type)
    except ControllerError:
        return False
    both = ((getattr(one, "settings", None), given_settings(one)) for one in (given, made))
    return next(both) == next(both)
