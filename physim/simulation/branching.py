"""Branches: a run that goes on from the sample of another, with something changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from physim.errors import PhysimError
from physim.geometry.shapes import read_only
from physim.parts.controller import Controller
from physim.parts.registry import DISTURBANCE, FILTER, SENSING, STAGES
from physim.simulation.parts import Part
from physim.simulation.state import SimulationState
from physim.world import World
from physim.world.differences import differences
from physim.world.scene import Scene

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation

FREE = (
    "name", "controller", "formation", "sensing", "filters", "disturbances", "expect",
    "time.duration", "time.record_every",
)  # fmt: skip
"""Keys of a world that may change in mid-run: they move and reshape no body."""


def branch_of(
    simulation: Simulation,
    controller: Controller | str | Mapping[str, Any] | None,
    changes: Mapping[str, Any],
) -> Simulation:
    """See `Simulation.branch`."""
    scene, parts = simulation.scene, simulation.parts
    given = {kind: [one.made for one in parts.given if one.kind == kind] for kind in STAGES}
    if isinstance(controller, Mapping):
        changes, controller = {**changes, "controller": controller}, None
    elif controller is None:
        own = parts.all[0]
        controller = own.made if own.from_python else None
    world: World | Scene = scene
    if changes or isinstance(controller, str):
        world = scene.world.changed(**changes)
        check_changes(scene.world, world)
    branch = type(simulation)(
        world, scene.seed, controller, sensing=given[SENSING], filters=given[FILTER],
        disturbances=given[DISTURBANCE],
    )  # fmt: skip
    branch.restore(taken_over(simulation, branch))
    return branch


def check_changes(world: World, other: World) -> None:
    """Raise PhysimError, one line, for the first key of a world that may not change in mid-run."""
    for key, (before, after) in differences(world, other).items():
        if not f"{key}.".startswith(tuple(f"{one}." for one in FREE)):
            raise PhysimError(
                f"branch: {key} is {before} and cannot become {after} in mid-run; allowed: "
                f"{', '.join(FREE)}"
            )


def taken_over(simulation: Simulation, branch: Simulation) -> SimulationState:
    """State of a simulation as that of a branch, which stands at sample 0.

    Parts that are the same keep theirs; others have that with which they begin.
    """
    state, new = simulation.state, branch.state
    known = dict(zip(STAGES, state.stages, strict=True))
    left = [
        (part, own)
        for kind in STAGES
        for part, own in zip(_of(simulation, kind), known[kind], strict=True)
    ]
    stages = []
    for kind, begun in zip(STAGES, new.stages, strict=True):
        states = []
        for part, own in zip(_of(branch, kind), begun, strict=True):
            k = next((k for k, (one, _) in enumerate(left) if _alike(one, part)), None)
            states.append(own if k is None else left.pop(k)[1])
        stages.append(tuple(states))
    changed: dict[str, Any] = {}
    if not _alike(simulation.parts.all[0], branch.parts.all[0]):
        due = read_only(np.full_like(new.next_decision, state.now.step))
        changed = {"mode": new.mode, "memory": new.memory, "next_decision": due}
    return replace(
        state, scene=new.scene, parts=new.parts, settings=new.settings, stages=tuple(stages),
        **changed,
    )  # fmt: skip


def _of(simulation: Simulation, kind: Any) -> list[Part]:
    return [part for part in simulation.parts.all if part.kind == kind]


def _alike(one: Part, other: Part) -> bool:
    """Whether two parts are the same object, or of one name with the same settings."""
    if one.made is other.made:
        return True
    known = not (one.settings.not_known or other.settings.not_known)
    return known and one[:2] == other[:2] and one.settings == other.settings
