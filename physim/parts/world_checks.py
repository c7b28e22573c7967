"""What parts say of a world before it runs, so that all commands refuse alike."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from physim.errors import ControllerError, Fault, Location
from physim.parts.user_code import kind_of, naming
from physim.world.group import each_robot
from physim.world.kinds import FrozenMapping
from physim.world.run import ControllerChoice

if TYPE_CHECKING:
    from physim.world import Robot, World
    from physim.world.group import Driver

HOOKS = ("robot_faults", "world_faults", "world_doubts")
"""Methods by which a part says it; one without any of them is not made before it is to run."""


@runtime_checkable
class ChecksWorld(Protocol):
    """A controller or stage that can say with which worlds it does not go."""

    def world_faults(self, world: World, where: Location) -> Iterable[Fault]:
        """Why a world that is sound otherwise cannot be run with this part; or nothing.

        ``where`` is the part's place in the world, such as ``("filters", 0)``, so that
        ``Fault((*where, key), message)`` points at a setting, and
        ``Fault(("arrival", "tolerance"), message)`` at a value of the world.
        """
        ...


@runtime_checkable
class DoubtsWorld(Protocol):
    """A controller or stage that knows what in a world is seldom meant."""

    def world_doubts(self, world: World, where: Location) -> Iterable[Fault]:
        """What `physim check` warns of; ``where`` as for `ChecksWorld`."""
        ...


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
    found = _faults(controller, "robot_faults", {i: robots[i] for i in own})
    return _placed(found, entries, ("controller",) if driver is None else driver.where)


def driver_faults(controller: object, world: World, driver: Driver) -> list[Fault]:
    """What a controller says against the robots that it drives, and then against the world."""
    robots, entries = each_robot(world.robots, world.seed)
    found = robot_faults(controller, robots, entries, driver)
    return found or _of_driver(controller, "world_faults", world, driver)


def driver_doubts(controller: object, world: World, driver: Driver) -> list[Fault]:
    """What a controller warns of in a world with the robots that it drives."""
    return _of_driver(controller, "world_doubts", world, driver)


def _of_driver(controller: object, hook: str, world: World, driver: Driver) -> list[Fault]:
    """Asked as if its robots were alone in the world, and it the world's controller."""
    if not driver.is_own or len(driver.entries) < len(world.robots):
        own = (world.robots[e] for e in driver.entries)
        alone = tuple(entry.model_copy(update={"controller": None}) for entry in own)
        choice = ControllerChoice(type=driver.type, settings=FrozenMapping(driver.settings))
        world = world.model_copy(update={"robots": alone, "controller": choice})
    return _placed(_faults(controller, hook, world, ("controller",)), driver.entries, driver.where)


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


def world_faults(part: object, world: World, where: Location) -> list[Fault]:
    """What a controller or stage at ``where`` says against a world; empty where nothing.

    Raises `ControllerError` where its ``world_faults`` fails.
    """
    return _faults(part, "world_faults", world, where)


def world_doubts(part: object, world: World, where: Location) -> list[Fault]:
    """What a controller or stage at ``where`` warns of; as `world_faults`."""
    return _faults(part, "world_doubts", world, where)


def _faults(part: object, hook: str, *given: Any) -> list[Fault]:
    """What a method says, where the part has it."""
    say = getattr(part, hook, None)
    if say is None:
        return []
    with naming(f"{type(part).__name__}.{hook}", say):
        answer = say(*given)
        if not isinstance(answer, str) and isinstance(answer, Iterable):
            faults = list(answer)
            if all(isinstance(fault, Fault) for fault in faults):
                return faults
        raise ControllerError(
            f"returned {kind_of(answer)}; it must return a list of physim.Fault(location, message),"
            " empty where there are none"
        )
