"""What parts say of a world before it runs, so that all commands refuse alike.

A controller or stage may have two methods that are given the world and the part's place in it, such
as ``("filters", 0)``, and return faults: ``world_faults(world, where)``, why a sound world cannot
be run with it, and ``world_doubts(world, where)``, what `physim check` warns of. A controller may
also have ``robot_faults(robots)``, see `physim.parts.controller.ChecksRobots`.
``Fault((*where, key), message)`` points at a setting, ``Fault(("arrival", "tolerance"), message)``
at a value of the world.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from physim.errors import ControllerError, Fault, Location
from physim.parts.drive import ANY, PLAIN
from physim.parts.registry import OF_ROBOTS, find_part, shipped_parts
from physim.parts.user_code import kind_of, naming
from physim.world.faults import describe
from physim.world.group import each_robot
from physim.world.kinds import FrozenMapping
from physim.world.run import ControllerChoice

if TYPE_CHECKING:
    from physim.world import Robot, World
    from physim.world.group import Driver

HOOKS = ("robot_faults", "world_faults", "world_doubts")
"""Methods by which a part says it; one without any of them is not made before it is to run."""


def faults_said(part: object, hook: str, *given: Any) -> list[Fault]:
    """What one of `HOOKS` says; nothing where the part lacks it.

    Raises `ControllerError` where it fails.
    """
    if (say := getattr(part, hook, None)) is None:
        return []
    with naming(f"{type(part).__name__}.{hook}", say):
        answer = say(*given)
        faults = (
            answer if isinstance(answer, str) or not isinstance(answer, Iterable) else [*answer]
        )
        if isinstance(faults, list) and all(isinstance(fault, Fault) for fault in faults):
            return faults
        raise ControllerError(
            f"returned {kind_of(answer)}; it must return a list of physim.Fault(location, message),"
            " empty where there are none"
        )


def robot_faults(
    controller: object,
    robots: Sequence[Robot],
    entries: Sequence[int],
    driver: Driver | None = None,
) -> list[Fault]:
    """What a controller says about robots before a run; empty where it says nothing.

    It is given robots by number, those of its ``driver`` where it does not drive all; each fault is
    told once, at the entry of ``robots`` that the robot is written in. Raises `ControllerError`
    where its ``robot_faults`` fails.
    """
    own = range(len(robots)) if driver is None else driver.robots
    found = faults_said(controller, "robot_faults", {i: robots[i] for i in own})
    return _placed(found, entries, ("controller",) if driver is None else driver.where)


def drive_faults(controller: object, world: World, driver: Driver) -> list[Fault]:
    """What drives of its robots a controller, or its class, does not say that it can drive.

    It says it by ``drives``, names of drives or `ANY`; without it those are `PLAIN` alone. Raises
    `ControllerError` where that is no tuple or list of names.
    """
    can = getattr(controller, "drives", (PLAIN,))
    name = (controller if isinstance(controller, type) else type(controller)).__name__
    if not isinstance(can, tuple | list) or not all(isinstance(one, str) for one in can):
        raise ControllerError(f'drives of {name} is {kind_of(can)}; write drives = ("{PLAIN}",)')
    if ANY in can:
        return []
    drives = ((e, world.robots[e].drive) for e in driver.entries)
    found = [(e, one.type) for e, one in drives if one is not None and one.type not in can]
    if not found:  # to find the others would import them all
        return []
    shipped = {part: find_part(OF_ROBOTS, part) for part in shipped_parts(OF_ROBOTS)}
    is_shipped = driver.type in shipped
    own = ", in a controller of your own," if is_shipped else ""
    drives_of = "its drives" if is_shipped else f"the drives of {name}"
    all_can = {part: getattr(made, "drives", (PLAIN,)) for part, made in shipped.items()}
    return [
        Fault(
            ("robots", e, "drive"),
            f"{describe(one)} is no drive for {describe(driver.type)}, which drives "
            f"{', '.join(can) or 'none'}; give these robots a controller that drives {one} "
            f"({', '.join(part for part in all_can if {one, ANY} & {*all_can[part]})}), or"
            f'{own} add "{one}" to {drives_of}',
        )
        for e, one in found
    ]


def driver_faults(controller: object, world: World, driver: Driver) -> list[Fault]:
    """What a controller says against the robots that it drives, and then against the world."""
    robots, entries = each_robot(world.robots, world.seed)
    found = drive_faults(controller, world, driver)
    found = found or robot_faults(controller, robots, entries, driver)
    return found or said_of_driven(controller, "world_faults", world, driver)


def said_of_driven(controller: object, hook: str, world: World, driver: Driver) -> list[Fault]:
    """What a hook says of a world in which its robots are alone, and it is the world's own."""
    if not driver.is_own or len(driver.entries) < len(world.robots):
        own = (world.robots[e] for e in driver.entries)
        alone = tuple(entry.model_copy(update={"controller": None}) for entry in own)
        choice = ControllerChoice(type=driver.type, settings=FrozenMapping(driver.settings))
        world = world.model_copy(update={"robots": alone, "controller": choice})
    found = faults_said(controller, hook, world, ("controller",))
    return _placed(found, driver.entries, driver.where)


def _placed(faults: Iterable[Fault], entries: Sequence[int], where: Location) -> list[Fault]:
    """Faults, each once, at the ``entries`` of their robots, those of settings at ``where``."""
    found: dict[Fault, None] = {}
    for fault in faults:
        at = fault.location
        if at[:1] == ("robots",) and at[1:] and at[1] in range(len(entries)):
            fault = replace(fault, location=("robots", entries[int(at[1])], *at[2:]))
        elif at[:1] == ("controller",):
            fault = replace(fault, location=(*where, *at[1:]))
        found[fault] = None
    return list(found)
