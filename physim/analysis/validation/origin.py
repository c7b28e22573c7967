"""Is a record that of the world inside it? Scene and controller are made anew and compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.errors import ControllerError, RecordError, WorldError
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Column, Declared, Mode, Rule
from physim.parts.registry import CONTROLLER, DISTURBANCE, FILTER, SENSING, make_part
from physim.record import Record
from physim.tolerances import LENGTH
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Scene

AREA = 1e-6
"""[m] The edges of an area may differ by this: another version of the library that makes them
rounds in its own way."""


@dataclass(frozen=True)
class Inside:
    """What the world inside a record gives."""

    scene: Scene | None
    """None where the record holds no text of its world"""
    controller: Any | None
    """the world's own controller, where it decided and can be made without running code of
    somebody's own"""
    why_not: str
    """why there is no controller; empty where there is one"""
    stages: tuple[str, ...] | None
    """words of the kinds of stages that stood in the run, of the world or given; None: unknown"""


@dataclass(frozen=True)
class Origin:
    """What the comparison of a record with the world inside it found."""

    held: bool
    """False where the record holds no text of its world: nothing was compared"""
    differences: tuple[str, ...]
    """what is in the record, and what it is by the world; one line each"""


def world_inside(record: Record) -> Inside:
    """Build scene and controller of the world inside.

    Raises RecordError, one line, where the text cannot be read or built.
    """
    given = [kind for kind, _ in record.given]
    if not record.world_text.strip():
        return Inside(None, None, "the record holds no text of its world", None)
    try:
        scene = build_scene(record.world)
    except WorldError as error:
        where = record.path or "record in memory"
        told = str(error).splitlines()[0].removeprefix(f"world of {where}:")
        raise RecordError(f"{where}: the world inside cannot be read: {told.strip()}") from error
    world = scene.world
    named = ((SENSING, world.sensing.stages), (FILTER, world.filters),
             (DISTURBANCE, world.disturbances))  # fmt: skip
    stages = [kind.word for kind, choices in named if choices]
    return Inside(scene, *_controller(record, scene), (*stages, *given))


def _controller(record: Record, scene: Scene) -> tuple[Any | None, str]:
    """The world's own controller, or why it is not made."""
    if record.controller:
        return None, f"{record.controller} was given from Python"
    choice = scene.world.controller
    if ":" in choice.type:
        return None, f"no code is run because a record names it ({choice.type})"
    try:
        return make_part(CONTROLLER, choice.type, choice.settings), ""
    except WorldError as error:
        raise RecordError(
            f"{record.path or 'record in memory'}: the world inside cannot be read: "
            f"{str(error).splitlines()[0]}"
        ) from error
    except ControllerError as error:
        return None, str(error).splitlines()[0]


def compare_with_world(record: Record, inside: Inside) -> Origin:
    """Hold what is known before the first step against the world inside.

    Seed, step, names, footprints, walls, paths, areas, leads, start poses and what the controller
    declares. Lengths and angles must agree within `LENGTH`, the edges of areas within `AREA`. A
    record made without the text of a world is not compared.
    """
    scene = inside.scene
    if scene is None:
        return Origin(False, ())
    found = (*_values(record, scene), *_arrays(record, scene), *_areas(record, scene))
    return Origin(True, (*found, *_declared(record, inside)))


def _declared(record: Record, inside: Inside) -> Iterator[str]:
    """Modes, rules and columns, and L, against those of the world's own controller."""
    if inside.controller is None:
        return
    ours, settings = Declared.of(inside.controller), getattr(inside.controller, "settings", None)
    for key in ("modes", "rules", "columns"):
        one, other = getattr(record.declared, key), getattr(ours, key)
        if one != other:
            k = next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), -1)
            told, by = (_told(some[k]) if k >= 0 else f"{len(some)} {key}" for some in (one, other))
            yield f"{key} of the controller: {told} in the record, {by} by the world inside it"
    distance = float(getattr(settings, "safe_distance", 0.0))
    if record.safe_distance != distance:
        yield (
            f"safe_distance is {record.safe_distance:g} in the record, {distance:g} by the world "
            "inside it"
        )


def _told(one: Mode | Rule | Column) -> str:
    return f"{one.name} ({', '.join(str(value) for value in list(vars(one).values())[1:])})"


def _values(record: Record, scene: Scene) -> Iterator[str]:
    pairs: list[tuple[str, Any, Any]] = [
        ("name", record.name, scene.world.name),
        ("seed", record.seed, scene.seed),
        ("dt", record.dt, scene.dt),
        ("steps_planned", record.steps_planned, scene.steps),
        ("number of robots", record.robots, scene.robots),
    ]
    for k, (one, other) in enumerate(zip(record.bodies, scene.bodies, strict=False)):
        pairs += [
            (f"{field} of body {k}", getattr(one, field), getattr(other, field))
            for field in ("id", "kind", "name")
        ]
    pairs.append(("number of bodies", len(record.bodies), len(scene.bodies)))
    for name, inside, world in pairs:
        if inside != world:
            yield f"{name} is {inside} in the record, {world} by the world inside it"


def _arrays(record: Record, scene: Scene) -> Iterator[str]:
    names, shapes = record.names, record.shapes
    ours: list[tuple[str, Any, Any]] = [
        ("vertex", record.walls.vertices, scene.walls.vertices),
        ("start of part", record.walls.part_start, scene.walls.part_start),
        ("first part of body", record.walls.body_start, scene.walls.body_start),
    ]
    ours = [(f"walls: {what}", one, other) for what, one, other in ours]
    ours += [
        ("footprints: vertex", shapes.vertices, scene.shapes.vertices),
        ("footprints: start of part", shapes.part_start, scene.shapes.part_start),
        ("footprints: first part of robot", shapes.body_start, scene.shapes.body_start),
        ("paths: point", record.paths.points, scene.paths.points),
        ("paths: start", record.paths.start, scene.paths.start),
        ("reference path: point", record.reference.points, scene.reference.points),
        ("stop station of robot", record.stop_station, scene.stop_station),
        ("lead of robot", record.lead, scene.formation.lead),
    ]
    if record.samples:
        ours.append(("start pose of robot", record.read("/steps/pose", 0, 1)[0], scene.start))
    for what, inside, world in ours:
        if inside.shape != world.shape:
            yield f"{what}: {len(inside)} in the record, {len(world)} by the world inside it"
            continue
        wrong = np.abs(inside - world) > LENGTH
        if wrong.any():
            k = int(np.argwhere(wrong)[0][0])
            who = f" ({names[k]})" if what.endswith("pose of robot") and k < len(names) else ""
            told, by = _shown(inside[k]), _shown(world[k])
            yield f"{what} {k}{who} is {told} in the record, {by} by the world inside it"


def _areas(record: Record, scene: Scene) -> Iterator[str]:
    for name, inside, world in (
        ("accessible", record.accessible, scene.area.accessible_rings),
        ("safe", record.safe, scene.area.safe_rings(record.safe_distance)),
    ):
        one, other = (shapely.MultiLineString([*map(_closed, rings)]) for rings in (inside, world))
        if one.is_empty != other.is_empty or shapely.hausdorff_distance(one, other) > AREA:
            yield f"the {name} area is another in the record than by the world inside it"


def _closed(ring: FloatArray) -> FloatArray:
    return np.concatenate((ring, ring[:1]))


def _shown(value: Any) -> str:
    if np.ndim(value):
        return "(" + ", ".join(f"{float(one):.10g}" for one in value) + ")"
    return f"{float(value):.10g}"
