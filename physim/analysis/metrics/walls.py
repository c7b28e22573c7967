"""Where along a wall a robot came near or touched it."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from physim.analysis.metrics.distances import placed
from physim.geometry.shapes import FloatArray, body_parts
from physim.record import Record
from physim.world.walls import stretch_text


def along_wall(record: Record, body: int, point: FloatArray | tuple[float, float]) -> str:
    """``at (1.5, 4), boundaries[0][16] to [17]``: a point (2,) [m] of a boundary of a run.

    Empty for a robot; the point alone for obstacles and the walls of a corridor.
    """
    if body < record.robots:
        return ""
    boundaries = record.world_settings.get("boundaries")
    written = boundaries if isinstance(boundaries, list | tuple) else None
    return stretch_text(written, record.bodies[body].name, point)


def near_wall(record: Record, robot: int, body: int, step: int) -> str:
    """Where along a wall it was nearest to a robot at a step, as `along_wall` says it.

    Empty for a robot, and where the record does not hold that step.
    """
    k = int(np.searchsorted(record.steps, step))
    if body < record.robots or k == len(record.steps) or record.steps[k] != step:
        return ""
    line = nearest_points(record, body, robot, np.asarray(record.pose_at(step)))
    return along_wall(record, body, line[0])


def nearest_points(record: Record, a: int, b: int, pose: FloatArray) -> FloatArray:
    """Nearest points (2, 2) [m] of two bodies with the robots at ``pose`` (N, 3).

    Of bodies that overlap the two are one point, of both.
    """

    def shape(body: int) -> Any:
        if body < record.robots:
            return placed(record, body, pose[body][None])[0]
        parts = body_parts(record.walls, body - record.robots)
        return shapely.GeometryCollection(
            [shapely.LineString(one) if len(one) == 2 else shapely.Polygon(one) for one in parts]
        )

    return np.asarray(shapely.get_coordinates(shapely.shortest_line(shape(a), shape(b))))
