"""Starts that are written down; which may be: clear of walls and of one another; what to do with
those that are not.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.world import World
from physim.world.layout.layout import lay_out
from physim.world.layout.places import Occupancy
from physim.world.scene import Layout

GAP = 0.3
"""[m] that starts keep from all else at least, where the world itself keeps it"""
SLACK = 1e-9
"""[m] by which a gap that is kept may be smaller, so that the start as written is within bounds"""
SHARES = (1.0, 0.75, 0.5, 0.25)
"""[-] of the way from its start in the world to the one asked for that a robot is tried at"""


class Starts:
    """Where N robots of a world may start: each at its own gap from all, in its own region.

    ``base`` (N, 3) are their starts in the world [m, m, rad], ``free`` the polygons that must hold
    their footprints. A robot keeps `GAP`, or as much as it has at the base where that is less.
    """

    def __init__(self, laid: Layout, regions: Sequence[shapely.Geometry | None]) -> None:
        self.base = np.array(laid.start)
        self._footprints = laid.footprints
        self._walls = [
            *(shapely.LineString(line) for line in laid.boundaries.values()),
            *(shapely.Polygon(ring) for ring in laid.obstacles),
        ]
        area = laid.area.polygon
        self.free = [area if one is None else shapely.intersection(area, one) for one in regions]
        for one in self.free:
            shapely.prepare(one)
        self.gap = np.zeros(len(self.base))
        standing, gap = self._standing(self.base), self.gap.copy()
        for i, pose in enumerate(self.base):
            standing.leave([i])
            gap[i] = max(0.0, min(GAP, self._room(standing, i, pose)) - SLACK)
            standing.stand(i, pose, 0.0)
        self.gap = gap

    def _standing(self, poses: FloatArray) -> Occupancy:
        occupied = Occupancy(self._footprints, self._walls)
        for i, pose in enumerate(poses):
            occupied.stand(i, pose, float(self.gap[i]))
        return occupied

    def _room(self, standing: Occupancy, i: int, pose: FloatArray) -> float:
        return float(standing.room(i, pose[None], self.free[i], float(self.gap[i]))[0])

    def fit(self, poses: FloatArray) -> bool:
        """Whether robots may start at poses (N, 3)."""
        standing = self._standing(poses)
        for i, pose in enumerate(poses):
            standing.leave([i])
            if self._room(standing, i, pose) < 0.0:
                return False
            standing.stand(i, pose, float(self.gap[i]))
        return True

    def repaired(self, poses: FloatArray) -> tuple[FloatArray, bool]:
        """Poses (N, 3) at which robots may start, and whether they are others than those given.

        Where these do not fit, each robot in turn goes as far towards its own as there is room
        beside those before it and the starts in the world of those after it.
        """
        if self.fit(poses):
            return poses, False
        standing, found = self._standing(self.base), self.base.copy()
        for i, (base, wanted) in enumerate(zip(self.base, poses, strict=True)):
            standing.leave([i])
            tried = (base + share * (wanted - base) for share in SHARES)
            found[i] = next((p for p in tried if self._room(standing, i, p) >= 0.0), base)
            standing.stand(i, found[i], float(self.gap[i]))
        return found, True


def starts_of(world: World) -> Starts:
    """Where the robots of a world may start, its own starts first. Raises WorldError."""
    return Starts(lay_out(world), [None] * len(world.robots))


def pinned(world: World, seed: int | None = None) -> tuple[World, Layout]:
    """The world with each robot by itself at the pose where ``seed`` puts it, and its layout.

    Without ``seed`` the world's own. Groups become robots one by one. Raises WorldError where the
    world cannot be run.
    """
    laid = lay_out(world, seed)
    robots = tuple(
        robot.model_copy(update={"pose": tuple(pose), "start": None})
        for robot, pose in zip(laid.world.robots, laid.start.tolist(), strict=True)
    )
    return laid.world.changed(robots=robots, start=None), laid
