"""What is varied, and how far: a box of numbers, each point of it a world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, NamedTuple

import numpy as np
import shapely

from physim.errors import PhysimError, plural
from physim.geometry.shapes import FloatArray
from physim.parts.controller import Controller
from physim.parts.registry import made_controller
from physim.parts.world_checks import robot_faults
from physim.simulation.team import driving
from physim.world import Robot, World, each_robot
from physim.world.ground.lines import placed_outline
from physim.world.layout.layout import lay_out
from physim.world.layout.occupancy import Occupancy
from physim.world.scene import Layout

POSE, HEADING, SPEED = KINDS = ("pose", "heading", "speed")
"""What can be varied."""
USUAL = (POSE, HEADING)
"""What is varied where nothing is said: how robots start, not what they are."""
REACH = 1.0
"""[m] along x and along y that a robot with a written place may start from it"""
TURN = 0.5
"""[rad] that a robot with a written heading may start off it, to either side"""
SLOWEST = 0.5
"""[-] share of its limits of speed that a robot may have"""
HALVINGS = 20
"""of the span in which the least limit that the controller takes is looked for"""
GAP = 0.3
"""[m] that starts keep from all else at least, where the world itself keeps it"""
SLACK = 1e-9
"""[m] by which a gap that is kept may be smaller, so that the start as written is within bounds"""
SHARES = (1.0, 0.75, 0.5, 0.25)
"""[-] of the way from the start in the world to the one asked for at which starts are tried"""


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
            *(placed_outline(one.outline, one.start) for one in laid.moved),
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
    laid = lay_out(world)
    return Starts(laid, [None] * len(laid.robots))


def pinned(world: World, seed: int | None = None) -> tuple[World, Layout]:
    """The world with each robot by itself at the pose where ``seed`` puts it, and its layout.

    Without ``seed`` the world's own. Groups become robots one by one. Raises WorldError where the
    world cannot be run.
    """
    laid = lay_out(world, seed)
    robots = tuple(
        robot.model_copy(update={"pose": tuple(pose), "start": None})
        for robot, pose in zip(laid.robots, laid.start.tolist(), strict=True)
    )
    return laid.world.changed(robots=robots, start=None), laid


def least_limit(controller: Any, robot: Robot, key: str) -> float:
    """The least limit that a robot may have: half of its own, or more where that is refused.

    A robot that chooses among turns faster than its limit is refused, by the world where they are
    its own and by the controller where they are of its settings. Each limit is looked at alone.
    """

    def takes(limit: float) -> bool:
        limits = robot.limits.model_copy(update={key: limit})
        return not robot_faults(controller, [robot.model_copy(update={"limits": limits})], [0])

    taken = float(getattr(robot.limits, key))
    refused = SLOWEST * taken
    if key == "omega" and robot.omegas:
        refused = max(refused, *map(abs, robot.omegas))
    if takes(refused):
        return refused
    for _ in range(HALVINGS):
        middle = 0.5 * (taken + refused)
        taken, refused = (middle, refused) if takes(middle) else (taken, middle)
    return taken


class Dimension(NamedTuple):
    """One number that is varied."""

    kind: str
    key: str
    """x, y, heading; v, omega"""
    robot: int
    base: float
    """its value in the world"""
    low: float
    high: float


@dataclass(frozen=True)
class Drawn:
    """A world of the space."""

    world: World
    repaired: bool
    """what was asked for could not be; this is as near to it as there was room"""


class Space:
    """The worlds that lie within the bounds around one; that one has every start written down."""

    def __init__(self, world: World, vary: Sequence[str] = USUAL, seed: int | None = None) -> None:
        """Lay out the bounds. Raises WorldError for a world that cannot be run, PhysimError where
        nothing can be varied."""
        self.world, laid = pinned(world, seed)
        self.robots, _ = each_robot(self.world.robots, self.world.seed)
        self.vary = tuple(kind for kind in KINDS if kind in vary)
        starts = [world.start_of(robot) for robot in laid.robots]
        self._regions = [None if one is None else shapely.Polygon(one.region) for one in starts]
        self._any_heading = [
            robot.pose[2] == "random" if robot.pose is not None else one is None
            or one.heading == "random"
            for robot, one in zip(laid.robots, starts, strict=True)
        ]  # fmt: skip
        self.starts = Starts(laid, self._regions)
        self.dimensions = tuple(self._dimensions())
        if not self.dimensions:
            raise PhysimError(f"--vary {','.join(vary)}: nothing in this world can be varied so")
        self.low = np.array([one.low for one in self.dimensions])
        self.high = np.array([one.high for one in self.dimensions])

    def _dimensions(self) -> list[Dimension]:
        found: list[Dimension] = []
        controllers: dict[int, Controller] = {}
        if SPEED in self.vary:  # one of one's own is asked only where that is needed
            own = made_controller(self.world, trusted=True)
            controllers = {i: one for one, who in driving(self.world, own) for i in who.robots}
        for i, robot in enumerate(self.robots):
            x, y, heading = self.starts.base[i].tolist()
            if POSE in self.vary:
                left, low, right, high = (x - REACH, y - REACH, x + REACH, y + REACH)
                if (region := self._regions[i]) is not None:
                    left, low, right, high = region.bounds
                found.append(Dimension(POSE, "x", i, x, left, right))
                found.append(Dimension(POSE, "y", i, y, low, high))
            if HEADING in self.vary:
                turn = pi if self._any_heading[i] else TURN
                ends = heading - turn, heading + turn
                found.append(Dimension(HEADING, "heading", i, heading, *ends))
            for key in ("v", "omega") if controllers else ():
                limit, least = getattr(robot.limits, key), least_limit(controllers[i], robot, key)
                if least < limit:
                    found.append(Dimension(SPEED, key, i, limit, least, limit))
        return found

    @property
    def base(self) -> FloatArray:
        """(D,) the point of the world itself, each number from 0 at its least to 1."""
        values = np.array([one.base for one in self.dimensions])
        point: FloatArray = np.clip((values - self.low) / (self.high - self.low), 0.0, 1.0)
        return point

    def at(self, point: FloatArray) -> Drawn:
        """The world at a point (D,) of the unit box, or as near to it as is allowed."""
        values = self.low + np.clip(point, 0.0, 1.0) * (self.high - self.low)
        poses = self.starts.base.copy()
        limits: list[dict[str, float]] = [{} for _ in self.robots]
        for one, value in zip(self.dimensions, values.tolist(), strict=True):
            if one.kind in (POSE, HEADING):
                poses[one.robot, ("x", "y", "heading").index(one.key)] = value
            else:
                limits[one.robot][one.key] = value
        poses, moved = self.starts.repaired(poses)
        robots = tuple(
            robot.model_copy(
                update={"pose": tuple(pose), "limits": robot.limits.model_copy(update=limit)}
            )
            for robot, pose, limit in zip(self.robots, poses.tolist(), limits, strict=True)
        )
        return Drawn(self.world.changed(robots=robots), moved)

    def lines(self) -> list[str]:
        """What is varied and how far, a line a kind."""
        found, count = [], plural(len(self.robots), "robot")
        if POSE in self.vary:
            places = {
                f"up to {REACH:g} m along x and y from the start"
                if one is None
                else "anywhere in the start region"
                for one in self._regions
            }
            gap = float(self.starts.gap.min())
            where = ", or ".join(sorted(places, reverse=True))
            found.append(f"pose      {count}: {where}; {gap:.3g} m or more from all else")
        if HEADING in self.vary:
            around = sum(self._any_heading)
            some = (
                (around, "any"),
                (len(self._any_heading) - around, f"{TURN:g} rad to either side"),
            )
            words = [f"{number} of {count}: {what}" for number, what in some if number]
            found.append(f"heading   {'; '.join(words)}")
        if SPEED in self.vary:
            found.append(
                f"speed     limits of v and omega of {count}: from {SLOWEST:.0%} to 100% of each, "
                "but none below what its controller takes"
            )
        return found
