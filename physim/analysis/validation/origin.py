"""Was a record made from a world: from the one inside it, and from one that is given?

The first is answered by values: a record of no step is made of the text inside and compared with
this one. The second is answered by the two texts, key by key. A class that a record names is a
user's code: it is never run because a record names it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import shapely

from physim.analysis.validation.finding import (
    Finding,
    first_difference,
    unlike_attributes,
    unlike_scene,
)
from physim.errors import ControllerError, RecordError, plural
from physim.parts.declarations import Declared, kept_distance
from physim.parts.registry import DISTURBANCE, FILTER, SENSING, made_controller
from physim.record import Record, RecordWriter
from physim.record.checks import reading_world
from physim.record.digest import KNOWN
from physim.simulation.team import driving, united
from physim.world import World
from physim.world.differences import differences
from physim.world.scene import Scene

AREA = 1e-6
"""[m] The edges of an area may differ by this: another version of the library that makes them
rounds in its own way."""
LOOKED_AT = 20
"""Places of each edge of an area that are looked at: it may be drawn anew between two corners."""
BY = "by the world inside it"
PATHS = tuple(path for path in KNOWN if not path.startswith("/areas"))
SAME = ("name", "seed", "dt", "steps_planned", "safe_distance")
"""Attributes that follow from the world inside"""


@dataclass(frozen=True)
class Inside:
    """What the world inside a record gives."""

    scene: Scene
    controller: Any | None
    """the world's own controller, or team of controllers, where it decided and can be made without
    running a user's code"""
    why_not: str
    """why there is no controller; empty where there is one"""
    stages: tuple[str, ...]
    """words of the kinds of stages that stood in the run, of the world or given"""

    def fits(self, record: Record) -> bool:
        """Whether it has as many robots and bodies: else nothing is held robot by robot."""
        return len(self.scene.bodies) == len(record.bodies) and self.scene.robots == record.robots


def world_inside(record: Record) -> Inside:
    """Build scene and controller of the world inside.

    Raises RecordError, one line, where there is no text or it cannot be read or built: every run
    writes it, and without it neither scene nor decisions could be judged.
    """
    controller, why_not = None, ""
    try:
        scene = record.scene
        world, named = scene.world, scene.world.controller.type
        if record.controller:
            why_not = f"{record.controller} was given from Python"
        elif ":" in named:
            why_not = f"no code is run because a record names it ({named})"
        else:
            with reading_world(record.where):
                controller = united(driving(world, made_controller(world)))
    except ControllerError as error:
        why_not = str(error).splitlines()[0]
    listed = ((SENSING, world.sensing.stages), (FILTER, world.filters),
             (DISTURBANCE, world.disturbances))  # fmt: skip
    stages = [kind.word for kind, choices in listed if choices]
    if (scene.robots, len(scene.bodies)) != (record.robots, len(record.bodies)):
        ours, theirs = (
            f"{plural(one.robots, 'robot')} of {plural(len(one.bodies), 'body', 'bodies')}"
            for one in (scene, record)
        )
        controller, why_not = None, f"the world inside has {ours}, the record {theirs}"
    return Inside(scene, controller, why_not, (*stages, *(kind for kind, _ in record.given)))


def compare_with_world(record: Record, inside: Inside) -> tuple[Finding, ...]:
    """Hold what is known before the first step against a record of the world inside at its start.

    Seed, step, names, footprints, walls, paths, areas, leads, start poses and what the controller
    declares. Lengths and angles must agree within `LENGTH`, the edges of areas within `AREA`.
    """
    judged = record.judged is not None  # no controller of the world's did anything
    scene, controller = inside.scene, None if judged else inside.controller
    distance = record.safe_distance if controller is None else kept_distance(controller)
    writer = RecordWriter(
        None, scene, record.world_text, safe_distance=distance,
        accessible=scene.area.accessible_rings,
        safe=() if judged else scene.area.safe_rings(record.safe_distance),
        declared=record.declared if controller is None else Declared.of(controller),
    )  # fmt: skip
    writer.close("interrupted", steps_run=0, rejected=0, wall_clock={})
    with writer.record() as start:
        found = [
            *unlike_attributes(record, start, SAME[:2] if judged else SAME, BY),
            *unlike_scene(record, start, PATHS, BY, exact=False),
        ]
        own_start = record.samples and not record.begun_at and not judged
        if record.moving == start.moving and own_start:
            pose = record.read("/steps/pose", 0, 1), scene.moving_start[None]
            first = first_difference(record, "/steps/pose", *pose, BY, False, record.steps)
            found += [] if first is None else [first]
        return (*found, *_areas(record, start))


def _areas(record: Record, start: Record) -> Iterator[Finding]:
    for name in ("accessible", "safe"):
        one, other = (
            shapely.MultiLineString([[*ring, ring[0]] for ring in getattr(of, name)])
            for of in (record, start)
        )
        if one.equals_exact(other):
            continue
        far = shapely.hausdorff_distance(one, other, densify=1.0 / LOOKED_AT)
        if one.is_empty != other.is_empty or far > AREA:
            yield Finding(f"the {name} area is another in the record than {BY}")


def check_made_from(record: Record, world: World, where: str | Path) -> None:
    """Raise RecordError unless a record was made from ``world``, whatever its seed and coarseness.

    Names the first key that differs.
    """
    for key, (recorded, given) in differences(record.world, world).items():
        if key not in ("seed", "time.record_every"):
            raise RecordError(
                f"{record.where}: not made from {where}: {key} is {recorded} in the record, "
                f"{given} in the world (if the run had --set or --controller, give the same here)"
            )
