"""From a file or a text to a `World`: values first, then what lies between them, then its parts.

Each is looked at only where the one before is sound; geometry follows when the world is laid out.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from warnings import warn

from physim.errors import ControllerError, Fault, Location, WorldError
from physim.parts.registry import (
    CONTROLLER,
    DRIVE,
    OF_ROBOTS,
    STAGES,
    Kind,
    advice,
    checked_settings,
    find_part,
    made_part,
)
from physim.parts.world_checks import (
    HOOKS,
    drive_faults,
    driver_faults,
    faults_said,
    said_of_driven,
)
from physim.world import World
from physim.world.faults import describe
from physim.world.file.document import Document, apply_overrides, put, read_document
from physim.world.file.files import world_document


def read_world(
    path: str | os.PathLike[str],
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    seed: int | None = None,
    check_controller: bool = True,
) -> tuple[World, Document]:
    """Read a world file, a shipped world by its name (`straight`), or that inside a ``record.h5``.

    ``overrides`` (``["time.step=0.02"]``, or one alone as a text), ``controller`` and ``seed`` are
    as the command line gives them. The controller may be ``module:Class``; it replaces that of the
    world, whose settings are left out where they are those of another ``type``.

    Without ``check_controller`` names and settings of controller and stages are taken as they are
    written, and none of them is looked up or imported: for a world that is only to be read.

    Returns the world and its document, which gives faults found later their place, and holds in
    ``warnings`` what is to be noted. Raises `WorldError` with every fault of the stage that is not
    sound, each with its line and column.
    """
    return _world_of(world_document(path), overrides, controller, seed, check_controller)


def load_world(
    path: str | os.PathLike[str],
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
) -> World:
    """Read a world file, a shipped world by its name (`straight`), or that inside a ``record.h5``.

    ``overrides`` (``["time.step=0.02"]``, or one alone as a text) and ``controller`` are as the
    command line gives them; the controller may be ``module:Class``. Raises WorldError with every
    fault found, each with its line and column. What should be noted is a Python warning.
    """
    world, document = read_world(path, overrides=overrides, controller=controller)
    for line in document.lines(document.warnings):
        warn(line, stacklevel=2)
    return world


def parse_world(
    text: str,
    source: str = "<text>",
    *,
    overrides: Sequence[str] = (),
    controller: str | None = None,
    check_controller: bool = True,
) -> World:
    """Read a world from the text of a world file, as `load_world` does from a file.

    ``source`` is what messages call the text. Without ``check_controller`` names and settings of
    controller and stages are taken as they are written, and none of them is looked up or imported.
    """
    document = read_document(text, source)
    return _world_of(document, overrides, controller, None, check_controller)[0]


def _world_of(
    document: Document,
    overrides: Sequence[str],
    controller: str | None,
    seed: int | None,
    check_controller: bool,
) -> tuple[World, Document]:
    if not isinstance(document.values, dict):
        message = "a world is a mapping of keys to values: name, time, corridor, robots, …"
        raise document.error([Fault((), message)])
    if controller is not None:
        document = _with_controller(document, controller)
    document = apply_overrides(document, overrides)
    given = document.values.get("controller")
    if controller is not None and not (isinstance(given, dict) and given.get("type") == controller):
        message = f"would take the place of --controller {describe(controller)}; give one of them"
        raise document.error([Fault(("controller", "type"), message)])
    if seed is not None:
        document = put(document, ("seed",), seed, "--seed")
    try:
        world = World(**document.values)
    except WorldError as error:
        raise document.error(error.faults) from None
    if not check_controller:
        return world, document
    faults, doubts = _of_parts(world, document, trusted=controller is not None)
    for kind, name in document.from_python:  # without them the run of a record is another
        if kind != CONTROLLER.word:
            faults.append(
                Fault((), f"its {kind} {name} came from Python, which no command can give")
            )
        elif controller is None:
            message = f"was the class {name}, {advice(CONTROLLER, name)}"
            faults.append(Fault(CONTROLLER.key, message))
    if controller is not None and not any(one.is_own for one in world.drivers()):
        faults.append(Fault(CONTROLLER.key, drives_none(controller)))
    if faults:
        raise document.error(faults)
    return world, replace(document, warnings=(*document.warnings, *doubts))


def _of_parts(world: World, document: Document, trusted: bool) -> tuple[list[Fault], list[Fault]]:
    """Faults of the parts that a world names, and what they warn of.

    ``trusted`` allows the world's own controller to be ``module:Class``, none of its robots'.
    """
    driving = {one.where: one for one in world.drivers()}
    named: list[tuple[Kind, Location, str]] = [
        (DRIVE, ("robots", e, "drive"), entry.drive.type)
        for e, entry in enumerate(world.robots)
        if entry.drive is not None
    ]
    named.append((CONTROLLER, CONTROLLER.key, world.controller.type))
    named += [(OF_ROBOTS, at, one.type) for at, one in driving.items() if at != CONTROLLER.key]
    for kind, choices in zip(
        STAGES, (world.sensing.stages, world.filters, world.disturbances), strict=True
    ):
        named += [(kind, (*kind.key, k), choice.type) for k, choice in enumerate(choices)]
    faults: list[Fault] = []
    doubts: list[Fault] = []
    for kind, where, name in named:
        driver, given = driving.get(where), document.values
        for key in where:
            given = given.get(key, {}) if isinstance(given, dict) else given[key]
        named_alone = isinstance(given, str)
        given = {} if named_alone else {k: value for k, value in given.items() if k != "type"}
        try:
            part = find_part(kind, name, trusted and kind is CONTROLLER)
            settings, found = checked_settings(part, given, where)
            sound = not any(fault.location[2:3] == DRIVE.key for fault in faults)
            if sound and not found and driver is not None:
                found = drive_faults(part, world, driver)
            is_idle = driver is None and kind is CONTROLLER  # every robot has its own
            if sound and not found and not is_idle and any(hasattr(part, hook) for hook in HOOKS):
                made = made_part(kind, part, settings, name)
                if driver is not None:
                    found = driver_faults(made, world, driver)
                    doubts += [] if found else said_of_driven(made, "world_doubts", world, driver)
                else:
                    found = faults_said(made, "world_faults", world, where)
                    doubts += [] if found else faults_said(made, "world_doubts", world, where)
            faults += found
        except ControllerError as error:
            faults.append(Fault(where if named_alone else (*where, "type"), str(error)))
    return faults, doubts


def _with_controller(document: Document, name: str) -> Document:
    """Put the controller of the command line in the place of the world's.

    Settings belong to the ``type`` beside them, and are left out, with a warning, where that is
    another one; without a ``type`` they are for whatever runs.
    """
    old = document.values.get("controller")
    given = dict(old) if isinstance(old, dict) else {}
    own = given.pop("type", name)
    if given and own != name:
        text = unused_settings([*given], own, name)
        note = Fault(
            ("controller",), f"{text} (set its own with --set controller.KEY=VALUE)", "warning"
        )
        document, given = replace(document, warnings=(*document.warnings, note)), {}
    document = replace(document, values={**document.values, "controller": given})
    return put(document, ("controller", "type"), name, "--controller")


def drives_none(name: str) -> str:
    """Say that a controller in the place of the world's own would drive no robot."""
    return (
        f"{describe(name)} would drive no robot: each has a controller of its own, which stays; "
        "leave that of one out"
    )


def unused_settings(keys: Sequence[str], of: Any, by: str) -> str:
    """Say that settings of one controller are not used by another."""
    many = "settings" if len(keys) > 1 else "setting"
    return f"{many} {', '.join(keys)} of {describe(of)}: not used by {describe(by)}"
