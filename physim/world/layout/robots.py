"""What robots look like and where they go: footprints and paths, as their entries mean them.

Robots of equal outlines share one array, and so do robots of equal paths.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from physim.errors import Fault
from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray, read_only
from physim.world import Offset, Robot, RobotGroup, World
from physim.world.ground.corridor import offset_polyline
from physim.world.layout.shape_checks import corners_of_line, outline_fault
from physim.world.robot import outline_of
from physim.world.scene import path_location

Given = TypeVar("Given")
Found = TypeVar("Found")


def shared(work_out: Callable[[Given], Found], given: Sequence[Given]) -> list[Found]:
    """What is worked out of each thing, once for robots that share the very same one."""
    known = {key: work_out(one) for key, one in {id(one): one for one in given}.items()}
    return [known[id(one)] for one in given]


def footprints_of(world: World, robots: Sequence[Robot], faults: list[Fault]) -> list[FloatArray]:
    """Footprints (n, 2) [m]; of a group all are judged, drawn by this seed or not."""
    known: dict[Any, FloatArray] = {}
    for e, entry in enumerate(world.robots):
        several = entry.footprints if isinstance(entry, RobotGroup) else None
        shapes: Any = (entry.footprint,) if several is None else several
        for k, footprint in enumerate(shapes):
            outline = outline_of(footprint)
            if outline in known:
                continue
            if message := outline_fault(outline):
                where = ("footprint",) if several is None else ("footprints", k)
                faults.append(Fault(("robots", e, *where), message))
            else:
                known[outline] = read_only(counter_clockwise(np.array(outline)))
    return [] if faults else [known[robot.outline] for robot in robots]


def paths_of(
    world: World,
    robots: Sequence[Robot],
    entries: Sequence[int],
    reference: FloatArray,
    faults: list[Fault],
) -> list[FloatArray]:
    """Waypoints (n, 2) [m] of every path."""
    known: dict[Any, FloatArray] = {}
    is_bend_told = False
    for i, robot in enumerate(robots):
        if robot.path in known:
            continue
        known[robot.path] = reference  # until it is known better
        where = path_location(world, entries, i)
        try:
            if isinstance(robot.path, Offset):
                offset = np.full(len(reference), robot.path.offset)
                line = corners_of_line(offset_polyline(reference, offset))
            else:
                line = np.array(robot.path)
            if len(corners_of_line(line)) < 2:  # on the centre of a bend its points are one
                faults.append(Fault(where, "must have two distinct points"))
            known[robot.path] = read_only(line)
        except ValueError as error:
            if not is_bend_told:
                faults.append(Fault((*where, "offset"), f"the reference path {error}"))
            is_bend_told = True
    return [known[robot.path] for robot in robots]
