"""Was a record made from a world: from the one inside it, and from one that is given?

The first is answered by values: scene and controller are made anew from the text inside and
compared with what the record holds. The second is answered by the two texts, key by key. A class
that a record names is a user's code: it is never run because a record names it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import yaml

from physim.errors import ControllerError, RecordError, WorldError, plural
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import Column, Declared, Mode, Rule
from physim.parts.registry import CONTROLLER, DISTURBANCE, FILTER, SENSING, make_part
from physim.record import Record
from physim.record.checks import unreadable_world
from physim.tolerances import LENGTH
from physim.world import World
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Scene

AREA = 1e-6
"""[m] The edges of an area may differ by this: another version of the library that makes them
rounds in its own way."""
LOOKED_AT = 20
"""Places of each edge of an area that are looked at: it may be drawn anew between two corners."""


@dataclass(frozen=True)
class Inside:
    """What the world inside a record gives."""

    scene: Scene | None
    """None where it has other robots or bodies than the record: see `fitting`"""
    controller: Any | None
    """the world's own controller, where it decided and can be made without running a user's code"""
    why_not: str
    """why there is no controller; empty where there is one"""
    stages: tuple[str, ...] | None
    """words of the kinds of stages that stood in the run, of the world or given; None: unknown"""


@dataclass(frozen=True)
class Origin:
    """What the comparison of a record with the world inside it found."""

    differences: tuple[str, ...]
    """what is in the record, and what it is by the world; one line each"""


def world_inside(record: Record) -> Inside:
    """Build scene and controller of the world inside.

    Raises RecordError, one line, where there is no text or it cannot be read or built: every run
    writes it, and without it neither scene nor decisions could be judged.
    """
    given = [kind for kind, _ in record.given]
    if not record.world_text.strip():
        raise RecordError(
            f"{record.where}: holds no text of its world, against which its scene and decisions "
            "are held; make the record again"
        )
    try:
        scene = build_scene(record.world)
    except WorldError as error:
        raise unreadable_world(record.where, error) from error
    world = scene.world
    named = ((SENSING, world.sensing.stages), (FILTER, world.filters),
             (DISTURBANCE, world.disturbances))  # fmt: skip
    stages = [kind.word for kind, choices in named if choices]
    return Inside(scene, *_controller(record, scene), (*stages, *given))


def fitting(record: Record, inside: Inside) -> Inside:
    """What the world inside gives, without its scene where that has other numbers of robots or of
    bodies than the record: robot by robot nothing can be held against such a world."""
    scene = inside.scene
    if scene is None or (scene.robots, len(scene.bodies)) == (record.robots, len(record.bodies)):
        return inside
    ours, theirs = (
        f"{plural(one.robots, 'robot')} of {plural(len(one.bodies), 'body', 'bodies')}"
        for one in (scene, record)
    )
    return Inside(None, None, f"the world inside has {ours}, the record {theirs}", None)


def controller_name(record: Record) -> str:
    """What decided: ``module:Class`` of one given from Python, or as the world inside names it;
    empty where the record names none."""
    if record.controller or not record.world_text.strip():
        return record.controller
    return record.world.controller.type


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
        raise unreadable_world(record.where, error) from error
    except ControllerError as error:
        return None, str(error).splitlines()[0]


def compare_with_world(record: Record, inside: Inside) -> Origin:
    """Hold what is known before the first step against the world inside.

    Seed, step, names, footprints, walls, paths, areas, leads, start poses and what the controller
    declares. Lengths and angles must agree within `LENGTH`, the edges of areas within `AREA`.
    """
    scene = inside.scene
    if scene is None:
        return Origin(())
    found = (*_values(record, scene), *_arrays(record, scene), *_areas(record, scene))
    return Origin((*found, *_declared(record, inside)))


def _declared(record: Record, inside: Inside) -> Iterator[str]:
    """Modes, rules and columns, and L, against those of the world's own controller."""
    if inside.controller is None:
        return
    ours, settings = Declared.of(inside.controller), getattr(inside.controller, "settings", None)
    for key in ("modes", "rules", "columns"):
        one, other = getattr(record.declared, key), getattr(ours, key)
        if one != other:
            k = next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), -1)
            recorded, exact = (
                _declaration(some[k]) if k >= 0 else f"{len(some)} {key}" for some in (one, other)
            )
            yield _line(f"{key} of the controller:", recorded, exact)
    distance = float(getattr(settings, "safe_distance", 0.0))
    if record.safe_distance != distance:
        yield _line("safe_distance is", _text(record.safe_distance), _text(distance))


def _declaration(one: Mode | Rule | Column) -> str:
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
            yield _line(f"{name} is", inside, world)


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
            yield _line(f"{what}:", len(inside), len(world))
            continue
        wrong = np.abs(inside - world) > LENGTH
        if wrong.any():
            k = int(np.argwhere(wrong)[0][0])
            who = f" ({names[k]})" if what.endswith("pose of robot") and k < len(names) else ""
            yield _line(f"{what} {k}{who} is", _text(inside[k]), _text(world[k]))


def _areas(record: Record, scene: Scene) -> Iterator[str]:
    for name, inside, world in (
        ("accessible", record.accessible, scene.area.accessible_rings),
        ("safe", record.safe, scene.area.safe_rings(record.safe_distance)),
    ):
        if _same_rings(inside, world):
            continue
        one, other = (shapely.MultiLineString([*map(_closed, rings)]) for rings in (inside, world))
        far = shapely.hausdorff_distance(one, other, densify=1.0 / LOOKED_AT)
        if one.is_empty != other.is_empty or far > AREA:
            yield f"the {name} area is another in the record than by the world inside it"


def _same_rings(some: Sequence[FloatArray], others: Sequence[FloatArray]) -> bool:
    return len(some) == len(others) and all(map(np.array_equal, some, others))


def _closed(ring: FloatArray) -> FloatArray:
    return np.concatenate((ring, ring[:1]))


def _line(what: str, recorded: object, exact: object) -> str:
    return f"{what} {recorded} in the record, {exact} by the world inside it"


def _text(value: Any) -> str:
    if np.ndim(value):
        return "(" + ", ".join(f"{float(one):.10g}" for one in value) + ")"
    return f"{float(value):.10g}"


def check_made_from(record: Record, world: World, where: str | Path) -> None:
    """Raise RecordError unless a record was made from ``world``, whatever its seed and coarseness.

    Names the first key that differs.
    """
    inside = _without_choices(record.world_settings)
    found = _difference(inside, _without_choices(yaml.safe_load(world.to_yaml())), "")
    if found is not None:
        key, recorded, given = found
        raise RecordError(
            f"{record.where}: not made from {where}: {key} is {_short(recorded)} in the record, "
            f"{_short(given)} in the world (--set and --controller take the changes of a run)"
        )


def _without_choices(world: Mapping[str, Any]) -> dict[str, Any]:
    """A world as plain values, without what each run may choose: seed and coarseness."""
    plan = {key: value for key, value in world.items() if key != "seed"}
    if isinstance(time := plan.get("time"), Mapping):
        plan["time"] = {key: value for key, value in time.items() if key != "record_every"}
    return plan


def _difference(a: object, b: object, key: str) -> tuple[str, object, object] | None:
    """First place at which two trees of plain values differ: key, value in a, value in b."""
    if isinstance(a, dict) and isinstance(b, dict):
        for name in [*a, *(n for n in b if n not in a)]:
            where = f"{key}.{name}" if key else str(name)
            found = _difference(a.get(name), b.get(name), where)
            if found is not None:
                return found
        return None
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for k, (one, other) in enumerate(zip(a, b, strict=True)):
            found = _difference(one, other, f"{key}[{k}]")
            if found is not None:
                return found
        return None
    return None if a == b else (key, a, b)


def _short(value: object) -> str:
    if isinstance(value, list):
        return f"a list of {len(value)}"
    text = "absent" if value is None else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
