"""What robots look like and where they go: footprints and paths, as their entries mean them.

Robots of equal outlines share one array, and so do robots of equal paths.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from physim.errors import Fault, Location
from physim.geometry.corridor import offset_polyline
from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray, read_only
from physim.tolerances import LENGTH
from physim.world import Offset, RobotGroup
from physim.world.layout.shape_checks import corners_of_line, outline_fault
from physim.world.robot import outline_of


def footprints_of(world: Any, faults: list[Fault]) -> dict[int, FloatArray]:
    """Footprints that are polygons; robots of the same outline share one, looked at once."""
    known: dict[Any, str | FloatArray] = {}

    def looked_at(outline: Any) -> str | FloatArray:
        if outline not in known:
            fault = outline_fault(outline)
            known[outline] = fault or read_only(counter_clockwise(np.array(outline)))
        return known[outline]

    for e, entry in enumerate(world.entries):  # of a group all, drawn by this seed or not
        several = entry.footprints if isinstance(entry, RobotGroup) else None
        for k, footprint in enumerate(several or ()):
            shape = looked_at(outline_of(footprint))
            if isinstance(shape, str):
                faults.append(Fault(("robots", e, "footprints", k), shape))
    found = {}
    for i, robot in enumerate(world.robots):
        if robot.outline is None:
            continue
        shape, where = looked_at(robot.outline), world.entry_of(i)
        if not isinstance(shape, str):
            found[i] = shape
        elif getattr(world.entries[where[1]], "footprints", None) is None:
            faults.append(Fault((*where, "footprint"), shape))
    return found


def path_of(world: Any, i: int) -> Location:
    """Where the path of Robot i is written: a group may have several, taken in turn."""
    where = world.entry_of(i)
    group = world.entries[where[1]]
    if isinstance(group, RobotGroup) and group.paths is not None:
        return (*where, "paths", world.place_of(i) % len(group.paths))
    return (*where, "path")


def paths_of(
    world: Any, reference: FloatArray | None, faults: list[Fault]
) -> dict[int, FloatArray]:
    """Waypoints (n, 2) of every sound path, robots on the same one sharing it.

    A bend of s* too sharp for all is reported once.
    """
    found: dict[int, FloatArray] = {}
    known: dict[Any, _Waypoints] = {}
    is_bend_told = False
    for i, robot in enumerate(world.robots):
        where = path_of(world, i)
        if robot.path not in known:
            known[robot.path] = _waypoints(robot.path, reference)
        path = known[robot.path]
        if path.bend and not is_bend_told:
            faults.append(Fault((*where, "offset"), f"the reference path {path.bend}"))
            is_bend_told = True
        elif path.is_point:
            faults.append(Fault(where, "must have two distinct points"))
        elif path.line is not None:
            found[i] = path.line
    return found


class _Waypoints(NamedTuple):
    """What a path as written means."""

    line: FloatArray | None = None
    """(n, 2) [m]; None where it is no path"""
    bend: str = ""
    """why it cannot run beside the reference path"""
    is_point: bool = False
    """whether all its waypoints are one"""


def _waypoints(path: Any, reference: FloatArray | None) -> _Waypoints:
    if not isinstance(path, Offset):
        line = distinct(path)[0]
    elif reference is None:
        line = None
    else:
        try:
            beside = offset_polyline(reference, np.full(len(reference), path.offset))
            line = distinct(beside)[0]  # on the centre of a bend its points are one
            if line is None:
                return _Waypoints(is_point=True)
        except ValueError as error:
            return _Waypoints(bend=str(error))
    if line is not None and len(corners_of_line(line)) < 2:
        return _Waypoints(is_point=True)
    return _Waypoints(None if line is None else read_only(line))


def distinct(points: Sequence[Any] | FloatArray | None) -> tuple[FloatArray | None, list[int]]:
    """Points (n, 2) [m] of a polyline without repeated neighbours, and which of them these are.

    None where fewer than two are left.
    """
    line = np.array(() if points is None else points, dtype=np.float64).reshape(-1, 2)
    kept = list(range(len(line)))
    if (np.hypot(*np.diff(line, axis=0).T) <= LENGTH).any():
        kept = [0]
        for k in range(1, len(line)):
            if np.hypot(*(line[k] - line[kept[-1]])) > LENGTH:
                kept.append(k)
        line = line[kept]
    return (line, kept) if len(kept) > 1 else (None, [])
