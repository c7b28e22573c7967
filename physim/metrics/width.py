"""Width of the corridor along a robot's path (Fig. 4)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.errors import PhysimError
from physim.geometry.corridor import SIDES
from physim.geometry.shapes import FloatArray
from physim.geometry.width import side_feet
from physim.metrics.values import Place
from physim.record import Record

EVERY = 0.1
"""[m] between two places at which the width is taken"""


class Width(NamedTuple):
    """Free width at places along a path: shortest distance to the left plus to the right [m]."""

    station: FloatArray
    """(K,) [m] along the path"""
    points: FloatArray
    """(K, 2) [m] the places"""
    left: FloatArray
    """(K, 2) [m] nearest point of a boundary or obstacle on the left; not finite where open"""
    right: FloatArray
    """(K, 2) [m] the same on the right"""
    width: FloatArray
    """(K,) [m]; inf where a side is open, NaN where the two nearest points are not on opposite
    sides (`side_feet`): there is no width there"""


def corridor_width(record: Record, robot: int = 0, every: float = EVERY) -> Width:
    """Width along a robot's path, every 0.1 m (Fig. 4).

    In a world with a corridor: to its left and to its right wall. Obstacles, and boundaries of
    other worlds, are left where they lie in the half-plane left of the path's direction, and so
    for right; a path close to a bent boundary may find the same one on both sides there. Near a
    wall across the path, as at the end of a room, one or both nearest points may lie on that wall,
    before or behind the path: such places have no width. Raises PhysimError for a robot that
    is not there.
    """
    if not 0 <= robot < record.robots:
        raise PhysimError(f"robot {robot} given; there are 0 to {record.robots - 1}")
    lines = record.paths
    run = slice(lines.start[robot], lines.start[robot + 1])
    points, station = lines.points[run], lines.station[run]
    at: FloatArray = every * np.arange(float(int(station[-1] / every + 1e-9) + 1))
    k = np.clip(np.searchsorted(station, at, side="right") - 1, 0, len(station) - 2)
    along = np.diff(points, axis=0) / np.diff(station)[:, None]
    places = points[k] + (at - station[k])[:, None] * along[k]
    walls, obstacles = sides_of(record)
    left, right, between = side_feet(places, along[k], obstacles, walls)
    width = np.hypot(*(left - places).T) + np.hypot(*(right - places).T)
    counts = ~np.isfinite(width) | between
    return Width(at, places, left, right, np.where(counts, width, np.nan))


def width_extreme(course: Width, robot: int, largest: bool) -> Place | None:
    """Least or greatest width along a robot's path [m] (Fig. 4); None where there is none."""
    width = np.where(np.isfinite(course.width), course.width, np.nan)
    if np.isnan(width).all():
        return None
    k = int(np.nanargmax(width) if largest else np.nanargmin(width))
    return Place(float(width[k]), float(course.station[k]), robot)


def sides_of(record: Record) -> tuple[tuple[FloatArray, FloatArray] | None, FloatArray]:
    """Segments (S, 4) ax, ay, bx, by [m] of a corridor's two walls, and of all else.

    None for a world without a corridor. Its caps are left out.
    """
    corridor = record.world_settings.get("corridor") is not None
    named: dict[str, FloatArray] = {}
    others = [np.zeros((0, 4))]
    for body in record.bodies[record.robots :]:
        if corridor and body.kind == "boundary":
            named[body.name] = _segments(record, body.id)
        else:
            others.append(_segments(record, body.id))
    if set(SIDES) <= set(named):
        return (named[SIDES[0]], named[SIDES[1]]), np.concatenate(others)
    return None, np.concatenate([*named.values(), *others])


def _segments(record: Record, body: int) -> FloatArray:
    walls, k = record.walls, body - record.robots
    found = []
    for part in range(walls.body_start[k], walls.body_start[k + 1]):
        points = walls.vertices[walls.part_start[part] : walls.part_start[part + 1]]
        ends = points[1:] if len(points) == 2 else np.roll(points, -1, axis=0)
        found.append(np.hstack((points[: len(ends)], ends)))
    return np.concatenate(found) if found else np.zeros((0, 4))
