"""A world made ready to run: every length resolved, everything in arrays.

A `World` is what its author wrote; a `Scene` is what it means: boundaries as drawn segments, paths
as waypoints, footprints as convex parts, stop stations, bodies by id. It depends on the world and
the seed alone and does not change during a run.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import shapely

from physim.errors import Location
from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Shapes
from physim.world.group import RobotGroup
from physim.world.robot import Offset, Robot

if TYPE_CHECKING:
    from physim.geometry.timed_paths import TimedPaths
    from physim.geometry.walls import WallTree
    from physim.parts.drive import Drive
    from physim.world import World
    from physim.world.ground.area import Area
    from physim.world.ground.pieces import Pieces

Named = tuple[str, Any]
"""A shapely line or polygon, and before it what messages call it"""

DENSITY = 100.0
"""[kg/m^2] mass of a robot whose world gives none, over its area"""


@dataclass(frozen=True)
class Body:
    """One row of the body table: what moves first, robots, movers, obstacles that can be pushed,
    each in file order; then boundaries, then the other obstacles."""

    id: int
    kind: str
    """``robot``, ``mover``, ``boundary`` or ``obstacle``"""
    name: str


class Driven(NamedTuple):
    """Robots with one drive of the same settings."""

    type: str
    drive: Drive
    robots: IntArray
    """(M,) which, increasing"""


@dataclass(frozen=True)
class Moved:
    """A body that moves beside the robots."""

    kind: str
    """``mover`` or ``obstacle``"""
    name: str
    key: Location
    """where it is written"""
    outline: FloatArray
    """(n, 2) [m] in its own frame, counter-clockwise"""
    start: FloatArray
    """(3,) pose at step 0"""
    mass: float
    """[kg] inf of a mover"""


@dataclass(frozen=True)
class FormationPlan:
    """What (7) needs, the same for every robot of the cluster."""

    active: bool
    """False in a world without formation: each robot goes at the speed of its controller"""
    gain: float
    """alpha [1/s]"""
    speed: float
    """nu_0 [m/s]; 1 and without meaning where there is no formation"""
    v_min: float
    """[m/s] least forward speed that (7) may give"""
    v_max: float
    """[m/s] greatest forward speed that (7) may give"""
    lead: FloatArray
    """(N,) [m] desired lead of Robot i over Robot 1 along s*: the paper's -l_i; lead[0] = 0"""
    adjacency: IntArray
    """(N, N) 1 where j is in N_i, in a world that lists pairs; (0, 0) when neighbours are those
    within ``range``"""
    range: float
    """[m] along s* within which formation neighbours are; inf where all are"""


@dataclass(frozen=True)
class Layout:
    """Where everything of a world lies at the start: plain geometry, with no kernel called.

    World frame [m] but for the footprints, which are in the frames of their robots.
    """

    world: World
    """the effective world as written, with the seed in it"""
    robots: tuple[Robot, ...]
    """the N robots that its entries stand for"""
    entries: tuple[int, ...]
    """for each robot the number of the entry in which it is written"""
    centreline: FloatArray | None
    """(n, 2) middle of the corridor; None in a world with boundaries"""
    widths: FloatArray | None
    """(n,) full width of the corridor at these points"""
    boundaries: dict[str, FloatArray]
    """polylines (n, 2) by name, in the order of their ids"""
    obstacles: list[FloatArray]
    """outlines (n, 2) of those that stand"""
    reference: FloatArray
    """(n, 2) waypoints of s*"""
    area: Area
    """accessible face"""
    footprints: list[FloatArray]
    """N outlines (n, 2), counter-clockwise; one array for robots of the same outline"""
    parts: list[tuple[FloatArray, ...]]
    """convex parts (n, 2) of each of these"""
    paths: list[FloatArray]
    """N paths (n, 2); one array for robots of the same path"""
    start: FloatArray
    """(N, 3) poses [m, m, rad]"""
    passage: float | None
    """[m] clear width along the reference path that a road drawn by the seed guarantees; None where
    the road is written"""
    pushed: dict[int, FloatArray] = field(default_factory=dict)
    """outlines (n, 2) at the start of obstacles that can be pushed, by their numbers in the file"""

    @property
    def names(self) -> list[str]:
        """Names of the N robots."""
        return [robot.name for robot in self.robots]

    @property
    def reference_key(self) -> Location:
        """Where the reference path is written."""
        if self.passage is not None:
            return ("corridor", "random")
        own = self.world.reference_path is not None
        return ("reference_path",) if own else ("corridor", "centreline")

    def obstacle_key(self, k: int) -> Location:
        """Where obstacle k of those that stand is written."""
        where: Location = ("obstacles", self.standing[k])
        return where if self.passage is None else ("corridor", "random")

    @cached_property
    def standing(self) -> list[int]:
        """Numbers in the file of the obstacles that stand."""
        every = range(len(self.obstacles) + len(self.pushed))
        return [k for k in every if k not in self.pushed]

    @cached_property
    def moved(self) -> list[Moved]:
        """What moves beside the robots: movers, then obstacles that can be pushed."""
        found = [
            Moved("mover", mover.name, ("movers", k), counter_clockwise(mover.outline),
                  np.array(mover.poses[0]), np.inf)
            for k, mover in enumerate(self.world.movers)
        ]  # fmt: skip
        for k, ring in self.pushed.items():
            middle = shapely.get_coordinates(shapely.Polygon(ring).centroid)[0]
            entry, name = self.world.obstacles[k], f"obstacle {k + 1}"
            found.append(
                Moved("obstacle", name, ("obstacles", k), counter_clockwise(ring - middle),
                      np.array([*middle, 0.0]), getattr(entry, "mass", np.inf))
            )  # fmt: skip
        return found

    def entry_key(self, i: int) -> Location:
        """Where Robot i is written."""
        return ("robots", self.entries[i])

    def path_entry(self, i: int) -> Location:
        """Where the path of Robot i is written, of one beside the reference path the mapping."""
        return path_location(self.world, self.entries, i)

    def path_key(self, i: int) -> Location:
        """Where the path of Robot i is written."""
        where = self.path_entry(i)
        return (*where, "offset") if isinstance(self.robots[i].path, Offset) else where

    @cached_property
    def walls(self) -> list[Named]:
        """Boundaries as shapely lines."""
        return [
            (wall_label(name), shapely.LineString(line)) for name, line in self.boundaries.items()
        ]

    @cached_property
    def solids(self) -> list[Named]:
        """Obstacles as shapely polygons."""
        drawn = self.passage is not None
        return [
            (f"obstacle {k + 1}" if drawn else f"obstacles[{k}]", shapely.Polygon(ring))
            for k, ring in zip(self.standing, self.obstacles, strict=True)
        ]


def path_location(world: World, entries: Sequence[int], i: int) -> Location:
    """Where the path of Robot i is written: a group may have several, taken in turn.

    ``entries`` are the numbers of the entries of all robots.
    """
    e = entries[i]
    group = world.robots[e]
    if isinstance(group, RobotGroup) and group.paths is not None:
        return ("robots", e, "paths", (i - bisect_left(entries, e)) % len(group.paths))
    return ("robots", e, "path")


def wall_label(name: str) -> str:
    """What messages call a boundary: its key where it is drawn."""
    kind, _, number = name.partition(" ")
    return f"boundaries[{int(number) - 1}]" if kind == "boundary" else "the edge of the corridor"


@dataclass(frozen=True)
class Scene:
    """Arrays of one run: N robots, lengths [m], angles [rad], world frame unless said.

    B bodies move: the N robots, then movers, then obstacles that can be pushed.
    """

    world: World
    """the effective world, after every override"""
    seed: int
    dt: float
    """[s] physics step"""
    steps: int
    """number of physics steps of the run; sample 0 is the start"""
    bodies: tuple[Body, ...]
    shapes: Shapes
    """footprints of the B bodies that move, each in its own frame (origin = reference point, x
    forward; of an obstacle the middle of its area)"""
    walls: Shapes
    """boundaries (parts of two vertices) and obstacles that stand (convex parts), world frame;
    body k of ``walls`` is body id B + k"""
    wall_tree: WallTree
    """which parts of ``walls`` are near a place"""
    mass: FloatArray
    """(B,) [kg]; inf of movers"""
    limits: FloatArray
    """(N, columns) largest |v| [m/s] and |omega| [rad/s], and lateral speed [m/s]"""
    curvature: FloatArray
    """(N,) [1/m] largest |omega| over |v|, inf of robots that can turn on the spot"""
    braking: FloatArray
    """(N,) [m/s²] by which robots brake, inf of those that stop at once"""
    drives: tuple[Driven, ...]
    """of the robots that do not just follow their commands"""
    start: FloatArray
    """(N, 3) pose of robots at sample 0"""
    movers: TimedPaths
    """paths of the movers, bodies N to N + ``movers.many`` - 1"""
    paths: Polylines
    """own path s_i of each robot"""
    reference: Polylines
    """the one reference path s* (a single polyline)"""
    outside: tuple[FloatArray, ...]
    """for each path the stretches (M, 2) [m], from station to station, outside the area"""
    speeds: tuple[tuple[float, ...] | None, ...]
    """for each robot its own set of speeds, multiples of nu; None: the controller's"""
    omegas: tuple[tuple[float, ...] | None, ...]
    """for each robot its own set of rotational speeds [rad/s]; None: the controller's"""
    stop_station: FloatArray
    """(N,) [m] along the own path, see `physim.simulation.arrival`"""
    formation: FormationPlan
    sensing_range: float
    """[m] within which robots see and consider others and walls"""
    arrival_tolerance: float
    """[m] along its path by which a robot that has arrived may be short of its stop, or past it"""
    layout: Layout
    """the same as plain geometry, before it was packed"""

    @property
    def area(self) -> Area:
        """Accessible face."""
        return self.layout.area

    @property
    def robots(self) -> int:
        """Number of robots N."""
        return len(self.start)

    @property
    def columns(self) -> int:
        """Numbers of a command: v and omega, and in a world with an omnidirectional robot lateral
        [m/s], left positive."""
        return int(self.limits.shape[1])

    @property
    def steers(self) -> bool:
        """Whether some robot has wheels that steer."""
        return any(getattr(one.drive, "steers", False) for one in self.drives)

    @property
    def moving(self) -> int:
        """Number of bodies that move, B."""
        return len(self.mass)

    @property
    def moving_start(self) -> FloatArray:
        """(B, 3) pose at sample 0."""
        if self.moving == self.robots:
            return self.start
        return np.vstack([self.start, *(one.start for one in self.layout.moved)])

    @cached_property
    def pieces(self) -> Pieces:
        """Which parts of ``walls`` join, and where robots may be beside them."""
        from physim.world.ground.pieces import pieces_of

        return pieces_of(self.walls, self.area)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the N robots: labels only."""
        return tuple(body.name for body in self.bodies[: self.robots])
