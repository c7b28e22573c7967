"""What parts say of a world before it runs, so that all commands refuse alike; and their errors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from physim.errors import ControllerError, Fault, Location
from physim.parts.registry import Kind
from physim.parts.user_code import MistakenError, asked, attribute, broken_by, kind_of, place_of

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
    for fault in _faults(controller, "robot_faults", "(robots)", dict(enumerate(robots))):
        where = fault.location
        if where[:1] == ("robots",) and where[1:] and where[1] in range(len(entries)):
            fault = replace(fault, location=("robots", entries[int(where[1])], *where[2:]))
        found[fault] = None
    return list(found)


def world_faults(part: object, world: World, where: Location) -> list[Fault]:
    """What a controller or stage at ``where`` says against a world; empty where nothing.

    Raises `ControllerError` where its ``world_faults`` fails.
    """
    return _faults(part, "world_faults", "(world, where)", world, where)


def world_doubts(part: object, world: World, where: Location) -> list[Fault]:
    """What a controller or stage at ``where`` warns of; as `world_faults`."""
    return _faults(part, "world_doubts", "(world, where)", world, where)


def _faults(part: object, hook: str, usage: str, *given: Any) -> list[Fault]:
    """What a method says, where the part has it: its class may answer the question by an error."""
    say = attribute(part, hook)
    if say is None:
        return []
    name = getattr(say, "__qualname__", "")
    try:
        answer = asked(say, f"{hook}{usage}", *given)
        faults = list(answer) if isinstance(answer, Iterable) else []
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise ControllerError(f"{name} fails: {broken_by(error)}") from error
    wrong = [fault for fault in faults if not isinstance(fault, Fault)]
    if wrong or not isinstance(answer, Iterable) or isinstance(answer, str):
        text = isinstance(answer, str) or not wrong
        returned = kind_of(answer) if text else f"{kind_of(wrong[0])} among them"
        raise ControllerError(
            f"{name} returned {returned}; it must return a list of faults, "
            f"physim.Fault(location, message), empty where there are none{place_of(say)}"
        )
    return faults


def listed(key: str, given: Any) -> tuple[Any, ...]:
    """Parts of a kind that were given from Python. Raises `ControllerError` where they are one."""
    if isinstance(given, Iterable) and not isinstance(given, str):
        return tuple(given)
    name = given if isinstance(given, str) else type(given).__name__
    raise ControllerError(
        f"{key} must be a list of objects; {kind_of(given)} given; write {key}=[{name}(…)]"
    )


def call(kind: Kind, part: object, method: str, *given: Any) -> Any:
    """Call a method of a part within `naming`; `MistakenError` where it does not take that."""
    return asked(getattr(part, method), kind.usage(method), *given)


def two(part: object, method: str, answer: Any, what: str) -> tuple[Any, Any]:
    """Both of what a method of a stage returned: ``what`` and its next state."""
    if type(answer) is not tuple or len(answer) != 2:
        raise returned(part, method, f"{kind_of(answer)}; it must return ({what}, state)")
    return answer


def returned(part: object, method: str, answer: str) -> MistakenError:
    """Error of a method that returned what it may not, with the line at which it is written."""
    return MistakenError(f"{method} returned {answer}{place_of(getattr(part, method))}")


@contextmanager
def naming(kind: Kind, part: object, time: float) -> Iterator[None]:
    """Make an error within a part one line that names it, the time [s] and the line of code."""
    try:
        yield
    except (ControllerError, KeyboardInterrupt):
        raise
    except BaseException as error:
        where = f"{kind.word} {type(part).__name__} at {time:g} s"
        raise ControllerError(f"{where}: {broken_by(error)}") from error
