"""Branches: a run that goes on from the sample of another, with something changed."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from physim.errors import PhysimError
from physim.parts.controller import Controller
from physim.parts.declarations import NO_NUMBER
from physim.parts.registry import DISTURBANCE, FILTER, SENSING, STAGES, Kind
from physim.simulation.parts import Part, driven_by
from physim.simulation.state import SimulationState
from physim.world import World
from physim.world.differences import differences
from physim.world.group import Driver
from physim.world.layout.scene_builder import scene_of
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation

FREE = (
    "name", "controller", "robots.N.controller", "formation", "sensing", "filters",
    "disturbances", "expect", "time.duration", "time.record_every",
)  # fmt: skip
"""Keys of a world that may change in mid-run: they move and reshape no body."""


def branch_of(
    simulation: Simulation,
    controller: Controller | str | Mapping[str, Any] | None,
    changes: Mapping[str, Any],
) -> Simulation:
    """See `Simulation.branch`."""
    scene, parts, changes = simulation.scene, simulation.parts, dict(changes)
    given = {kind: [one.made for one in parts.given if one.kind == kind] for kind in STAGES}
    for kind in STAGES:
        stages = changes.get(key := str(kind.key[0]))
        if isinstance(stages, Sequence) and not isinstance(stages, str):
            objects = [one for one in stages if not isinstance(one, Mapping | BaseModel)]
            if objects:  # in place of those that were given; else of those that the world names
                given[kind] = changes.pop(key)
            elif not stages:
                given[kind] = []
    if isinstance(controller, Mapping):
        changes["controller"], controller = controller, None
    elif controller is None:
        own = parts.all[0]
        controller = own.made if own.from_python else None
    free = {key.partition(".")[0] for key in FREE}
    for key in changes:
        if key in World.model_fields and key not in free:
            raise PhysimError(f"branch: {key} cannot change in mid-run; allowed: {', '.join(FREE)}")
    if changes or isinstance(controller, str):
        world = scene.world.changed(**changes)
        check_changes(scene.world, world)
        scene = scene_with(scene, driven_by(world, controller))
    branch = type(simulation)(
        scene, None, controller, sensing=given[SENSING], filters=given[FILTER],
        disturbances=given[DISTURBANCE],
    )  # fmt: skip
    branch.restore(taken_over(simulation, branch))
    return branch


def scene_with(scene: Scene, world: World) -> Scene:
    """A scene with another world, in which all that was laid out stays where it is."""
    return scene_of(replace(scene.layout, world=world))


def check_changes(world: World, other: World) -> dict[str, tuple[str, str]]:
    """What differs in another world, as `differences` has it.

    Raises PhysimError, one line, for the first key that may not change in mid-run.
    """
    found = differences(world, other)
    for key, (before, after) in found.items():
        whose = re.sub(r"^robots\.\d+\.", "robots.N.", key)
        if not f"{whose}.".startswith(tuple(f"{one}." for one in FREE)):
            raise PhysimError(
                f"branch: {key} is {before} and cannot become {after} in mid-run; allowed: "
                f"{', '.join(FREE)}"
            )
    return found


def taken_over(simulation: Simulation, branch: Simulation) -> SimulationState:
    """State of a simulation as that of a branch, which stands at sample 0.

    Stages that are the same keep theirs, and so do robots whose controller is the same; others
    have that with which they begin, and such robots decide at once.
    """
    state, new = simulation.state, branch.state
    left = [
        (part, own)
        for kind, states in zip(STAGES, state.stages, strict=True)
        for part, own in zip(_of(simulation, kind), states, strict=True)
    ]
    stages = []
    for kind, begun in zip(STAGES, new.stages, strict=True):
        states = []
        for part, own in zip(_of(branch, kind), begun, strict=True):
            same = next((k for k, (one, _) in enumerate(left) if _alike(one, part)), None)
            states.append(own if same is None else left.pop(same)[1])
        stages.append(tuple(states))

    modes = [one.name for one in branch.declared.modes]
    numbers = np.array([
        *(modes.index(one.name) if one.name in modes else NO_NUMBER
          for one in simulation.declared.modes), NO_NUMBER,
    ])  # fmt: skip
    mode, due = new.mode.copy(), np.full_like(new.next_decision, state.now.step)
    memory = {name: array.copy() for name, array in new.memory.items()}
    for own, made, driver, is_given in _members(branch):
        for before, other, past, was_given in _members(simulation):
            if made is not other and (is_given or was_given or driver[:2] != past[:2]):
                continue  # of another type, or with other settings
            kept = [i for i in driver.robots if i in past.robots]
            mode[kept], due[kept] = numbers[state.mode[kept]], state.next_decision[kept]
            for name in [one for one in memory if one.startswith(own)]:
                known, array = state.memory[before + name.removeprefix(own)], memory[name]
                if len(kept) < len(driver.robots) and array.shape[:1] == mode.shape:
                    array[kept] = known[kept]
                else:
                    memory[name] = known.copy()
    return replace(
        state, scene=new.scene, parts=new.parts, settings=new.settings, stages=tuple(stages),
        mode=mode, memory=memory, next_decision=due,
    )  # fmt: skip


def _of(simulation: Simulation, kind: Kind) -> list[Part]:
    return [part for part in simulation.parts.all if part.kind == kind]


def _members(simulation: Simulation) -> list[tuple[str, Controller, Driver, bool]]:
    """What drives robots: how the names of its memories begin, itself, whom, and whether it was
    given from Python."""
    parts = simulation.parts
    return [
        (f"{k}/" if len(parts.driving) > 1 else "", made, driver,
         driver.is_own and parts.all[0].from_python)
        for k, (made, driver) in enumerate(parts.driving)
    ]  # fmt: skip


def _alike(one: Part, other: Part) -> bool:
    """Whether two stages are the same object, or of one name with the same settings."""
    if one.made is other.made:
        return True
    known = not (one.settings.not_known or other.settings.not_known)
    return known and one[:2] == other[:2] and one.settings == other.settings
