"""Width of the corridor along a robot's path (Fig. 4)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray
from physim.geometry.width import width_feet
from physim.metrics.settings import world_settings
from physim.metrics.values import Place
from physim.record import Record

EVERY = 0.1
"""[m] between two places at which the width is taken"""
CAPS = ("start cap", "end cap")
"""What closes the ends of a ``corridor``: across the path, on neither side of it."""


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
    """(K,) [m]; inf where a side is open"""


def corridor_width(record: Record, robot: int = 0, every: float = EVERY) -> Width:
    """Width along a robot's path, every 0.1 m (Fig. 4).

    *Left* is the half-plane left of the path's direction. The caps of a corridor do not count.
    Raises PhysimError for a robot that is not there.
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
    left, right = width_feet(places, along[k], boundary_segments(record))
    width = np.hypot(*(left - places).T) + np.hypot(*(right - places).T)
    return Width(at, places, left, right, width)


def width_extreme(course: Width, robot: int, largest: bool) -> Place | None:
    """Least or greatest width along a robot's path [m] (Fig. 4); None where all is open."""
    width = np.where(np.isfinite(course.width), course.width, np.nan)
    if np.isnan(width).all():
        return None
    k = int(np.nanargmax(width) if largest else np.nanargmin(width))
    return Place(float(width[k]), float(course.station[k]), robot)


def boundary_segments(record: Record) -> FloatArray:
    """Segments (S, 4) ax, ay, bx, by [m] of boundaries and obstacles, without a corridor's caps."""
    walls, robots = record.walls, record.robots
    corridor = world_settings(record).get("corridor") is not None
    found = []
    for body in record.bodies[robots:]:
        if corridor and body.kind == "boundary" and body.name in CAPS:
            continue
        first, last = walls.body_start[body.id - robots : body.id - robots + 2]
        for part in range(first, last):
            points = walls.vertices[walls.part_start[part] : walls.part_start[part + 1]]
            ends = points[1:] if len(points) == 2 else np.roll(points, -1, axis=0)
            found.append(np.hstack((points[: len(ends)], ends)))
    return np.concatenate(found) if found else np.zeros((0, 4))
