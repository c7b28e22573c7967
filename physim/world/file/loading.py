"""From a file or a text to a `World`, with every fault found and its place.

Controller and stages that a world names are held against what is registered.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple
from warnings import warn

from physim.errors import ControllerError, Fault, Location, Position, WorldError
from physim.parts.registry import (
    CONTROLLER,
    STAGES,
    Kind,
    advice,
    checked_settings,
    find_part,
    made_part,
)
from physim.parts.world_checks import HOOKS, robot_faults, world_doubts, world_faults
from physim.world import ControllerChoice, Robot, RobotGroup, World
from physim.world.faults import KeyFault, describe
from physim.world.file.controller_given import check_one_controller, of_another_controller
from physim.world.file.files import world_document
from physim.world.file.nodes import (
    Document,
    Member,
    Node,
    holds_unreadable,
)
from physim.world.file.overrides import apply_overrides
from physim.world.file.reading import read_document, refused
from physim.world.group import is_group
from physim.world.run import MOST_STAGES


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
    if kind is CONTROLLER:
        faults = [of_another_controller(fault) for fault in faults]
    if faults or unread or not any(hasattr(part, hook) for hook in HOOKS):
        key = len(where)
        return None, [fault for fault in faults if unread.isdisjoint(fault.location[key:][:1])]
    return made_part(kind, part, made, choice["type"]), []


MOST_FAULTS = 100
"""Faults of one world that are reported one by one."""


def load_world(
    path: str | os.PathLike[str],
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
) -> World:
    """Read a world file, a shipped world by its name (`straight`), or that inside a ``record.h5``.

    ``overrides`` (``["time.step=0.02"]``, or one alone as a text) and ``controller`` are as the
    command line gives them.

    Raises `WorldError` with every fault found, each with its line and column. What is to be noted
    about the text, such as settings that ``controller`` leaves out, is a Python warning.
    """
    world, document = read_world(path, overrides=overrides, controller=controller)
    for line in warning_lines(document):
        warn(line, stacklevel=2)
    return world


def read_world(
    path: str | os.PathLike[str],
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    check_controller: bool = True,
) -> tuple[World, Document]:
    """As `load_world`, with the document, by which later faults find their place (`located`).

    ``check_controller`` is that of `parse_world`.
    """
    return world_of(
        world_document(path), overrides=overrides, controller=controller,
        check_controller=check_controller,
    )  # fmt: skip


def parse_world(
    text: str,
    source: str = "<text>",
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    check_controller: bool = True,
) -> World:
    """Read a world from the text of a world file. Raises `WorldError` as `load_world` does.

    Without ``check_controller`` names and settings of controller and stages are taken as they are
    written, and none of them is looked up or imported: for a world that is only to be read.
    """
    document = read_document(text, source)
    return world_of(
        document, overrides=overrides, controller=controller, check_controller=check_controller
    )[0]


def world_of(
    document: Document,
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    check_controller: bool = True,
) -> tuple[World, Document]:
    """World of a document, and the document with the overrides in it.

    A ``controller`` given here replaces the one of the document and may be ``module:Class``; the
    document's settings are left out, with a warning in the document returned, where they are
    those of another ``type``.
    """
    checked = validate(
        document, overrides=overrides, controller=controller, check_controller=check_controller
    )
    if checked.world is None:
        raise located(checked.faults, checked.document)
    warnings = (*checked.document.warnings, *checked.warnings)
    return checked.world, replace(checked.document, warnings=warnings)


@dataclass(frozen=True)
class Validated:
    """A document held against the model."""

    document: Document
    """with the overrides in it"""
    values: dict[str, Any]
    """what stands in it, valid or not"""
    faults: list[Fault]
    """every one of the model, the controller and the stages; those of the text are in the
    document"""
    world: World | None
    """None where there is any fault"""
    controller: type[Any] | None
    """class of the controller; None where it cannot be had"""
    warnings: tuple[Fault, ...] = ()
    """what controller and stages warn of"""


def validate(
    document: Document,
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    check_controller: bool = True,
) -> Validated:
    """Hold a document against the model, and return the faults instead of raising them.

    Raises `WorldError` only where there are no values to check: no mapping, or an override that
    cannot be read.
    """
    if document.root.members is None:
        raise refused(
            document.source,
            document.root.line,
            document.root.column,
            "a world is a mapping of keys to values: name, time, corridor, robots, …",
        )
    overrides = (overrides,) if isinstance(overrides, str) else overrides
    if controller is not None:
        check_one_controller(overrides, controller, document.source)
        document = _with_controller(document, controller)
    document = apply_overrides(document, overrides)
    values = document.values()
    chosen: type[Any] | None = None
    warnings: tuple[Fault, ...] = ()
    faults: list[Fault] = []
    world: World | None = None
    try:
        world = World(**values)
    except WorldError as error:
        faults = list(error.faults)
    if check_controller:
        robots = dict(enumerate(world.robots)) if world is not None else _sound_robots(values)
        sound = None if document.faults else world
        chosen, of_parts, warnings = check_parts(values, controller is not None, robots, sound)
        if world is not None:
            of_parts, warnings = world.as_written(of_parts), tuple(world.as_written(warnings))
        faults += [*of_parts, *_missing_parts(document, controller)]
    world = None if faults or document.faults else world
    return Validated(document, values, faults, world, chosen, warnings)


def _missing_parts(document: Document, controller: str | None) -> Iterator[Fault]:
    """Faults of the parts that the run of a record had from Python: without them it is another."""
    for kind, name in document.from_python:
        if kind != CONTROLLER.word:
            yield Fault((), f"its {kind} {name} came from Python, which no command can give")
        elif controller is None:
            yield Fault(CONTROLLER.key, f"was the class {name}, {advice(CONTROLLER, name)}")


def located(faults: Iterable[Fault], document: Document | None) -> WorldError:
    """Error of these faults and those of the document, each with its place in the file.

    Without a document (a world made in Python) there are no places. Faults of values that could
    not even be read are left out, since the document says why.
    """
    if document is None:
        return WorldError(_capped(list(faults)))
    found = in_order([*document.faults, *placed(faults, document)])
    kept = _capped([fault for fault, _ in found])
    return WorldError(kept, [position for _, position in found][: len(kept)])


def warning_lines(document: Document, found: Iterable[Fault] | None = None) -> list[str]:
    """What was ``found``, else what is to be noted about the text, a line each, with its place."""
    faults = document.warnings if found is None else found
    return [f"{place}: {fault}" for fault, place in in_order(placed(faults, document))]


def placed(faults: Iterable[Fault], document: Document) -> list[tuple[Fault, Position]]:
    """Each fault with its place, but for those of values that could not even be read."""
    return [
        (fault, document.position(fault.location, isinstance(fault, KeyFault)))
        for fault in faults
        if not _is_unreadable(fault.location, document)
    ]


def in_order(faults: list[tuple[Fault, Position]]) -> list[tuple[Fault, Position]]:
    """Faults in the order in which they stand in the file."""
    return sorted(faults, key=lambda pair: (pair[1].line, pair[1].column))


def _is_unreadable(location: Location, document: Document) -> bool:
    return any(location[:n] in document.unreadable for n in range(len(location) + 1))


def _capped(faults: list[Fault]) -> list[Fault]:
    if len(faults) <= MOST_FAULTS:
        return faults
    return [*faults[: MOST_FAULTS - 1], Fault((), "more faults follow; correct these first")]


def _with_controller(document: Document, name: str) -> Document:
    """Put the controller of the command line in the place of the world's.

    Settings belong to the ``type`` beside them, and are left out, with a warning, where that is
    another one; without a ``type`` they are for whatever runs.
    """
    root = document.root
    members = dict(root.members or {})
    old = members.get("controller")
    settings = old.node.members if old is not None and old.node.members is not None else {}
    chosen = settings["type"].node.value if "type" in settings else name
    left = [] if chosen == name else [str(key) for key in settings if key != "type"]
    warnings = document.warnings
    if left:
        own = " (--set controller.KEY=VALUE gives it its own)"
        text = unused_settings(left, chosen, name) + own
        warnings = (*warnings, Fault(("controller",), text))
    kept = {key: member for key, member in settings.items() if key not in left}
    kept["type"] = Member(1, 1, Node(1, 1, name, override="--controller"))
    line, column = (old.line, old.column) if old is not None else (root.line, root.column)
    members["controller"] = Member(line, column, Node(line, column, members=kept))
    chosen_root = Node(root.line, root.column, members=members, size=root.size, height=root.height)
    return replace(document, root=chosen_root, warnings=warnings)


def unused_settings(keys: Sequence[str], of: Any, by: str) -> str:
    """Say that settings of one controller are not used by another."""
    many = "settings" if len(keys) > 1 else "setting"
    return f"{many} {', '.join(keys)} of {describe(of)}: not used by {describe(by)}"


def _sound_robots(values: dict[str, Any]) -> dict[int, Robot]:
    """Robots that have no fault themselves, of a world that has some, by number of the entry.

    Of a group the first one stands for all.
    """
    given = values.get("robots")
    found = {}
    for i, entry in enumerate(given if isinstance(given, list) else []):
        with suppress(WorldError, ValueError, TypeError):
            robot = RobotGroup(**entry).robot(i, 0, 0) if is_group(entry) else Robot(**entry)
            if robot.footprint is not None and robot.path is not None:
                found[i] = robot
    return found
