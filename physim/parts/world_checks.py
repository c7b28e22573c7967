"""What parts say of a world before it runs, so that all commands refuse alike."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from physim.errors import ControllerError, Fault, Location
from physim.parts.user_code import kind_of, naming

if TYPE_CHECKING:
    from physim.world import Robot, World

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
    controller: object, robots: Sequence[Robot], entries: Sequence[int]
) -> list[Fault]:
    """What a controller says about robots before a run; empty where it says nothing.

    It is given robots by number; each fault is told once, at the entry of ``robots`` that the robot
    is written in. Raises `ControllerError` where its ``robot_faults`` fails.
    """
    found: dict[Fault, None] = {}
    for fault in _faults(controller, "robot_faults", dict(enumerate(robots))):
        where = fault.location
        if where[:1] == ("robots",) and where[1:] and where[1] in range(len(entries)):
            fault = replace(fault, location=("robots", entries[int(where[1])], *where[2:]))
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
