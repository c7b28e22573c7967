"""Paths as points."""

from __future__ import annotations

from physim.geometry.shapes import FloatArray
from physim.record import Record


def path_of(record: Record, robot: int) -> FloatArray:
    """Waypoints (n, 2) [m] of a robot's own path."""
    lines = record.paths
    points: FloatArray = lines.points[lines.start[robot] : lines.start[robot + 1]]
    return points
