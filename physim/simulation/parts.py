"""The parts of a run: found by name or given from Python, started, and asked at every step.

What they answer is checked, and their errors name them.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from physim.errors import ControllerError, Fault, Notice
from physim.geometry.shapes import FloatArray, read_only
from physim.parts.controller import Controller, Sensed, Snapshot
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
from physim.parts.stages import Disturbance, Filter, SensingStage
from physim.parts.user_code import kind_of, place_of
from physim.parts.world_checks import (
    call,
    listed,
    naming,
    returned,
    robot_faults,
    two,
    world_faults,
)
from physim.simulation.decision_checks import check_applied, check_commands
from physim.simulation.sensed_checks import sound_sensed
from physim.world import World, each_robot
from physim.world.file.loading import unused_settings
from physim.world.scene import Scene

NUMBERS = "fiuO"
"""Kinds of arrays of numbers; those of objects may be some"""


def driven_by(world: World, controller: Controller | str | None) -> World:
    """The world with another controller, where that is a name, as ``--controller`` has it.

    Settings of the world belong to the type beside them: that one keeps them, another goes without,
    which a `Notice` tells. Where the world names no type they are for whatever runs. Raises
    WorldError.
    """
    if not isinstance(controller, str):
        return world
    own = world.controller
    mine = own.type == controller or "type" not in own.model_fields_set
    if own.settings and not mine:
        left = unused_settings([*own.settings], own.type, controller)
        advice = f'(changed(controller={{"type": "{controller}", …}}) gives it its own)'
        text = f"world {world.name}: controller: {left} {advice}"
        warnings.warn(text, Notice, stacklevel=4)
    return world.changed(controller={**(own.settings if mine else {}), "type": controller})


@dataclass(frozen=True)
class Parts:
    """Controller and stages of a run, in their order."""

    controller: Controller
    sensing: tuple[SensingStage, ...] = ()
    filters: tuple[Filter, ...] = ()
    disturbances: tuple[Disturbance, ...] = ()
    given: tuple[tuple[str, str], ...] = ()
    """stage and name of what was given from Python in place of or beside what the world names"""
    given_settings: tuple[GivenSettings, ...] = ()
    """of each of these"""
    names: tuple[str, ...] = ()
    """of all of them"""
    settings: tuple[GivenSettings, ...] = ()
    """of each of the names"""

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

    def set_otherwise(self, others: Sequence[GivenSettings]) -> str:
        """In what the parts of another run, of the same names, are set otherwise; "" in nothing."""
        for name, other, own in zip(self.names, others, self.settings, strict=True):
            for key in (*other.settings, *other.not_known, *own.settings, *own.not_known):
                if (there := other.told(key)) != (here := own.told(key)):
                    return f"{name} has {key} {there}, here {here}"
        return ""

    @property
    def stages(self) -> tuple[tuple[Kind, tuple[Any, ...]], ...]:
        """Parts of the stages by kind, in the order of a step."""
        return tuple(zip(STAGES, (self.sensing, self.filters, self.disturbances), strict=True))


def parts_of(
    world: World,
    controller: Controller | str | None,
    sensing: Sequence[SensingStage],
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
    settings = [given_settings(chosen)]
    of_given = settings[:] if name else []
    names = [name or world.controller.type]
    found: list[tuple[Any, ...]] = []
    in_world = (world.sensing.stages, world.filters, world.disturbances)
    given_ones = (sensing, filters, disturbances)
    beside = [listed(str(k.key[0]), them) for k, them in zip(STAGES, given_ones, strict=True)]
    for kind, choices, extra in zip(STAGES, in_world, beside, strict=True):
        for part in extra:
            check_part(kind, part)
            given.append((kind.word, class_name(part)))
        named = [
            make_part(kind, choice.type, choice.settings, where=(*kind.key, k))
            for k, choice in enumerate(choices)
        ]
        found.append((*named, *extra))
        settings += map(given_settings, found[-1])
        of_given += settings[len(settings) - len(extra) :]
        names += [f"{kind.word} {choice.type}" for choice in choices]
        names += [f"{kind.word} {class_name(part)}" for part in extra]
    return Parts(
        chosen, found[0], found[1], found[2], tuple(given), tuple(of_given), tuple(names),
        tuple(settings),
    )  # fmt: skip


def part_faults(parts: Parts, world: World) -> list[Fault]:
    """What the parts of a run say against a world; see `physim.parts.world_checks`."""
    faults = robot_faults(parts.controller, *each_robot(world.robots, world.seed))
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
        own = world.controller  # its settings stand for this one: see `driven_by`
        settings = own.settings if own.type == given else {}
        made = make_part(CONTROLLER, given, settings, trusted=True)
        return made
    if isinstance(given, type):
        raise ControllerError(
            f"controller is the class {given.__name__}; give an instance of it{place_of(given)}"
        )
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
    name = class_name(given)
    same = name == own.type
    if ":" not in own.type:
        same = find_part(CONTROLLER, own.type) is type(given)
    return "" if same and _as_in_world(chosen, type(given), world) else name


def _as_in_world(given: Controller, part: type[Any], world: World) -> bool:
    """Whether an object has, as far as it tells, the settings that the world gives to its class."""
    own = world.controller
    made, faults = checked_settings(part, own.settings, CONTROLLER.key)
    if faults:
        return False
    try:
        other = made_part(CONTROLLER, part, made, own.type)
    except ControllerError:
        return False
    settings = (getattr(controller, "settings", None) for controller in (given, other))
    return bool(next(settings) == next(settings)) and given_settings(given) == given_settings(other)


def ask_sense(
    part: SensingStage, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
) -> tuple[Sensed, Any]:
    """What robots know after a sensing stage, and its next state."""
    with naming(SENSING, part, truth.step * scene.dt):
        answer = call(SENSING, part, "sense", scene, truth, sensed, state)
        found, state = two(part, "sense", answer, "sensed")
        if not isinstance(found, Sensed):
            raise returned(part, "sense", f"{kind_of(found)} first; that must be a Sensed")
        found = sound_sensed(found, sensed, scene, part)
    return found, state


def ask_filter(
    part: Filter, scene: Scene, sensed: Sensed, nominal: FloatArray, state: Any
) -> tuple[FloatArray, Any]:
    """Commands (N, 2) after a filter, within the robots' limits, and its next state."""
    time = sensed.step * scene.dt
    with naming(FILTER, part, time):
        answer = call(FILTER, part, "filter", scene, sensed, nominal, state)
        found, state = two(part, "filter", answer, "commands")
        commands = _commands(scene, part, "filter", found, nominal)
    try:
        check_commands(scene, time, None, commands)
    except ControllerError as error:
        raise ControllerError(f"filter {type(part).__name__}: {error}") from None
    return commands, state


def ask_disturbance(
    part: Disturbance, scene: Scene, truth: Snapshot, filtered: FloatArray, state: Any
) -> tuple[FloatArray, Any]:
    """Commands (N, 2) after a disturbance, and its next state."""
    time = truth.step * scene.dt
    with naming(DISTURBANCE, part, time):
        answer = call(DISTURBANCE, part, "disturb", scene, truth, filtered, state)
        found, state = two(part, "disturb", answer, "commands")
        commands = _commands(scene, part, "disturb", found, filtered)
    check_applied(scene, time, commands, part)
    return commands, state


def _commands(scene: Scene, part: object, method: str, found: Any, given: FloatArray) -> FloatArray:
    """Commands as an array of our own, unless they are the very array that was given."""
    commands = given
    if found is given:
        return commands
    try:
        if np.ma.isMaskedArray(found) or np.asarray(found).dtype.kind not in NUMBERS:
            raise TypeError
        commands = np.array(found, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        must = f"those must be an array of numbers, shape ({scene.robots}, 2)"
        kind = kind_of(found)
        if isinstance(found, np.ndarray):
            kind += f" of {found.dtype}"
        raise returned(part, method, f"{kind} as commands; {must}") from None
    return read_only(commands)
