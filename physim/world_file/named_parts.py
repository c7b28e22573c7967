"""The parts that a world names, controller and stages, held against what is registered."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from physim.errors import ControllerError, Fault, Location
from physim.part_checks import HOOKS, robot_faults, world_doubts, world_faults
from physim.registry import CONTROLLER, STAGES, Kind, checked_settings, find_part, made_part
from physim.world import ControllerChoice, Robot, World
from physim.world.stages import MOST_STAGES
from physim.world_file.nodes import holds_unreadable


class Named(NamedTuple):
    """A part as a world names it, valid or not."""

    kind: Kind
    where: Location
    choice: Mapping[str, Any]


def check_parts(
    values: Mapping[str, Any], trusted: bool, robots: Mapping[int, Robot], world: World | None
) -> tuple[type[Any] | None, list[Fault], tuple[Fault, ...]]:
    """Class of the controller; faults of all parts that ``values`` name; what they warn of.

    ``trusted`` allows the controller to be ``module:Class``. ``robots`` are those without a fault
    of their own; ``world`` is None where the values have another fault.
    """
    controller: type[Any] | None = None
    faults: list[Fault] = []
    warnings: list[Fault] = []
    for named in _named(values):
        is_controller = named.kind is CONTROLLER
        name = named.choice.get("type")
        if not isinstance(name, str) or not name:
            continue  # which the model refuses
        try:
            part = find_part(named.kind, name, trusted and is_controller)
            controller = part if is_controller else controller
            made, found = _made(named, part)
            if made is not None:
                found = robot_faults(made, robots) if is_controller else []
                if world is not None and not found:
                    found = world_faults(made, world, named.where)
                    warnings += world_doubts(made, world, named.where)
            faults += found
        except ControllerError as error:
            faults.append(Fault((*named.where, "type"), str(error)))
    return controller, faults, tuple(warnings)


def _named(values: Mapping[str, Any]) -> Iterator[Named]:
    """Every part that is named, in the order of a step; what is no mapping the model refuses."""
    choice = values.get("controller", {})
    if isinstance(choice, Mapping):
        usual = ControllerChoice.model_fields["type"].default
        yield Named(CONTROLLER, ("controller",), {"type": usual, **choice})
    for kind in STAGES:
        listed: Any = values
        for key in kind.key:
            listed = listed.get(key) if isinstance(listed, Mapping) else None
        for k, choice in enumerate(listed[:MOST_STAGES] if isinstance(listed, list) else ()):
            if isinstance(choice, Mapping):
                yield Named(kind, (*kind.key, k), choice)


def _made(named: Named, part: type[Any]) -> tuple[Any, list[Fault]]:
    """The part, where it has something to say of worlds, and the faults of its settings.

    It is None where a setting is wrong; one that could not even be read is a fault of the document.
    """
    kind, where, choice = named
    settings = {key: value for key, value in choice.items() if key != "type"}
    unread = {key for key, value in settings.items() if holds_unreadable(value)}
    settings = {key: value for key, value in settings.items() if key not in unread}
    made, faults = checked_settings(part, settings, where)
    if faults or unread or not any(hasattr(part, hook) for hook in HOOKS):
        key = len(where)
        return None, [fault for fault in faults if unread.isdisjoint(fault.location[key:][:1])]
    return made_part(kind, part, made, choice["type"]), []


__all__ = ["check_parts"]
