"""The parts of a run that are found by name or given from Python: controller and stages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from physim.control import Controller
from physim.errors import ControllerError, Fault
from physim.part_checks import call, listed, naming, robot_faults, world_faults
from physim.registry import CONTROLLER, STAGES, Kind, check_part, make_part
from physim.scene import Scene
from physim.stages import Disturbance, Filter, SenseStage
from physim.world import World


@dataclass(frozen=True)
class Parts:
    """Controller and stages of a run, in their order."""

    controller: Controller
    sensing: tuple[SenseStage, ...] = ()
    filters: tuple[Filter, ...] = ()
    disturbances: tuple[Disturbance, ...] = ()
    given: tuple[tuple[str, str], ...] = ()
    """stage and name of what was given from Python in place of or beside what the world names"""
    names: tuple[str, ...] = ()
    """of all of them"""

    def start(self, scene: Scene) -> tuple[tuple[Any, ...], ...]:
        """States of sensing stages, filters and disturbances at sample 0."""
        states = []
        for kind, parts in self.stages:
            begun = []
            for part in parts:
                with naming(kind, part, 0.0):
                    begun.append(call(kind, part, "start", scene))
            states.append(tuple(begun))
        return tuple(states)

    @property
    def stages(self) -> tuple[tuple[Kind, tuple[Any, ...]], ...]:
        """Parts of the stages by kind, in the order of a step."""
        return tuple(zip(STAGES, (self.sensing, self.filters, self.disturbances), strict=True))


def parts_of(
    world: World,
    controller: Controller | str | None,
    sensing: Sequence[SenseStage],
    filters: Sequence[Filter],
    disturbances: Sequence[Disturbance],
) -> Parts:
    """Parts that a world names, with what is given from Python.

    A controller takes the place of the world's own; stages stand behind those of the world. Raises
    ControllerError for what is no such part, WorldError for settings that are wrong.
    """
    chosen = _controller(world, controller)
    name = "" if controller is None else _given_name(controller, chosen, world)
    given = [("controller", name)] if name else []
    names = [name or world.controller.type]
    found: list[tuple[Any, ...]] = []
    in_world = (world.sensing.stages, world.filters, world.disturbances)
    given_ones = (sensing, filters, disturbances)
    beside = [listed(str(k.key[0]), them) for k, them in zip(STAGES, given_ones, strict=True)]
    for kind, choices, extra in zip(STAGES, in_world, beside, strict=True):
        for part in extra:
            check_part(kind, part)
            given.append((kind.word, class_name(part)))
        named = (
            make_part(kind, choice.type, choice.settings, where=(*kind.key, k))
            for k, choice in enumerate(choices)
        )
        found.append((*named, *extra))
        names += [f"{kind.word} {choice.type}" for choice in choices]
        names += [f"{kind.word} {class_name(part)}" for part in extra]
    return Parts(chosen, found[0], found[1], found[2], tuple(given), tuple(names))


def part_faults(parts: Parts, world: World) -> list[Fault]:
    """What the parts of a run say against a world; see `physim.part_checks`."""
    faults = robot_faults(parts.controller, dict(enumerate(world.robots)))
    faults += world_faults(parts.controller, world, CONTROLLER.key)
    for kind, stage in parts.stages:
        for k, part in enumerate(stage):
            faults += world_faults(part, world, (*kind.key, k))
    return faults


def class_name(part: object) -> str:
    """``module:Class`` of an object."""
    return f"{type(part).__module__}:{type(part).__qualname__}"


def _controller(world: World, given: Controller | str | None) -> Controller:
    made: Controller
    if isinstance(given, str):
        made = make_part(CONTROLLER, given, {}, trusted=True)
        return made
    if isinstance(given, type):
        raise ControllerError(f"controller is the class {given.__name__}; give an instance of it")
    if given is None:
        made = make_part(CONTROLLER, world.controller.type, world.controller.settings)
        return made
    check_part(CONTROLLER, given)
    return given


def _given_name(given: Controller | str, chosen: Controller, world: World) -> str:
    """Name of a controller, ``module:Class`` of an object; empty where it is the world's own."""
    own = world.controller
    if isinstance(given, str):
        return "" if given == own.type else given
    if ":" not in own.type and _alike(chosen, make_part(CONTROLLER, own.type, own.settings)):
        return ""
    name = class_name(given)
    return "" if name == own.type else name


def _alike(one: Controller, other: Controller) -> bool:
    settings = (getattr(controller, "settings", None) for controller in (one, other))
    return type(one) is type(other) and next(settings) == next(settings)
