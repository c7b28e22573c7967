"""What is occupied: walls, obstacles and robots that stand, and what room is left beside them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import shapely

from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.world.ground.lines import placed_outline, placed_outlines
from physim.world.layout.robots import shared

ROUNDING = 1e-6
"""[m] by which more is looked at than is near, so that no rounding leaves anything out"""


class Occupancy:
    """Walls, obstacles and the robots that stand already; footprints (n, 2) in their frames."""

    def __init__(self, footprints: Sequence[FloatArray], walls: Sequence[shapely.Geometry]) -> None:
        self.footprints = [np.asarray(footprint) for footprint in footprints]
        self.walls = shapely.GeometryCollection(list(walls))
        shapely.prepare(self.walls)
        count = len(self.footprints)
        self.radius = np.array(shared(circumscribed_radius, footprints))
        self.outline = np.empty(count, dtype=object)
        self.place = np.full((count, 2), np.inf)
        """of those that stand; no other is near"""
        self.gap = np.zeros(count)

    def stand(self, i: int, pose: FloatArray, gap: float) -> None:
        """Robot i stands at a pose and wants others ``gap`` [m] away."""
        self.outline[i] = placed_outline(self.footprints[i], pose)
        self.place[i] = pose[:2]
        self.gap[i] = gap

    def leave(self, robots: Iterable[int]) -> None:
        """These robots stand no more."""
        self.place[list(robots)] = np.inf

    def room(self, i: int, poses: FloatArray, free: shapely.Geometry, gap: float) -> FloatArray:
        """Room [m] beyond ``gap`` around robot i at poses (B, 3): negative where it does not fit.

        It must lie in ``free``. Each distance asks for the larger gap of the two robots.
        """
        room = np.full(len(poses), -1.0)
        outlines = placed_outlines(self.footprints[i], poses)
        inside = np.flatnonzero(shapely.covers(free, outlines))
        room[inside] = shapely.distance(self.walls, outlines[inside]) - gap
        for k in inside[room[inside] >= 0.0]:
            spare = self._spare(i, poses[k], outlines[k], gap, ROUNDING)
            if spare >= 0.0:  # few fit in a crowd, and only of these more than the nearest counts
                spare = self._spare(i, poses[k], outlines[k], gap, float(room[k]))
            room[k] = min(room[k], spare)
        return room

    def first_fit(
        self, i: int, poses: FloatArray, free: shapely.Geometry, gap: float
    ) -> int | None:
        """Which of the poses (B, 3) is the first with `room` for robot i; None where none has."""
        outlines = placed_outlines(self.footprints[i], poses)
        for k in np.flatnonzero(shapely.covers(free, outlines)):
            near_wall = shapely.dwithin(self.walls, outlines[k], gap + ROUNDING)
            if near_wall and shapely.distance(self.walls, outlines[k]) - gap < 0.0:
                continue
            if self._spare(i, poses[k], outlines[k], gap, ROUNDING) >= 0.0:
                return int(k)
        return None

    def _spare(
        self, i: int, pose: FloatArray, outline: shapely.Polygon, gap: float, room: float
    ) -> float:
        """Room [m] of robot i to the nearest robot, inf where that is surely more than ``room``."""
        reach = self.radius[i] + self.radius + np.maximum(self.gap, gap) + room
        some = np.flatnonzero(np.abs(self.place[:, 0] - pose[0]) <= reach)
        away = np.hypot(*(self.place[some] - pose[:2]).T)
        wanted = np.maximum(self.gap[some], gap)
        close = away <= reach[some]
        if not close.any():
            return np.inf
        near = self.outline[some[close]]
        return float((shapely.distance(near, outline) - wanted[close]).min())

    def kept_clear(self, gap: float) -> shapely.Geometry:
        """Where nothing may stand: within ``gap`` of walls and standing robots."""
        standing = self.outline[np.isfinite(self.place[:, 0])]
        return shapely.union_all([self.walls.buffer(gap), *shapely.buffer(standing, gap)])
