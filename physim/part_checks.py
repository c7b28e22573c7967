"""What parts say of a world before it runs, so that all commands refuse alike; and their errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from physim.control import ChecksRobots
from physim.errors import ControllerError, Fault, Location, PhysimError
from physim.registry import Kind, broken_by

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


def robot_faults(controller: object, robots: Mapping[int, Robot]) -> list[Fault]:
    """What a controller says about robots before a run; empty where it says nothing.

    ``robots`` by number. Raises `ControllerError` where its ``robot_faults`` fails.
    """
    if not isinstance(controller, ChecksRobots):
        return []
    return _told(controller.robot_faults, robots)


def world_faults(part: object, world: World, where: Location) -> list[Fault]:
    """What a controller or stage at ``where`` says against a world; empty where nothing.

    Raises `ControllerError` where its ``world_faults`` fails.
    """
    return _told(part.world_faults, world, where) if isinstance(part, ChecksWorld) else []


def world_doubts(part: object, world: World, where: Location) -> list[Fault]:
    """What a controller or stage at ``where`` warns of; as `world_faults`."""
    return _told(part.world_doubts, world, where) if isinstance(part, DoubtsWorld) else []


def _told(say: Callable[..., Iterable[Fault]], *given: Any) -> list[Fault]:
    name = getattr(say, "__qualname__", "")
    try:
        faults = list(say(*given))
    except Exception as error:
        raise ControllerError(f"{name} fails: {broken_by(error)}") from error
    if not all(isinstance(fault, Fault) for fault in faults):
        raise ControllerError(f"{name} must return faults, Fault(location, message)")
    return faults


@contextmanager
def naming(kind: Kind, part: object, time: float) -> Iterator[None]:
    """Make an error within a part one line that names it, the time [s] and the line of code."""
    try:
        yield
    except PhysimError:
        raise
    except (Exception, SystemExit) as error:
        where = f"{kind.word} {type(part).__name__} at {time:g} s"
        raise ControllerError(f"{where}: {broken_by(error)}") from error
