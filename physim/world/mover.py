"""What moves beside the robots: movers on timed paths, and obstacles that can be pushed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from physim.errors import Fault, Location
from physim.tolerances import LENGTH
from physim.world.base import Model
from physim.world.kinds import (
    MOST_POINTS,
    Angle,
    Coordinate,
    Label,
    Number,
    Point,
    Polygon,
    Sequence,
    either,
    plain,
)
from physim.world.robot import Footprint, outline_of

if TYPE_CHECKING:
    from physim.world.model import World

MOST_MOVERS = 1_000
FULL = 2.0 * math.pi
TURN = 1e-6
"""[rad] by which the last heading of a loop may miss the first"""


def _kind(value: Any) -> str:
    value = plain(value)
    return "<pose>" if isinstance(value, list | tuple) and len(value) == 3 else "<point>"


Waypoint = Annotated[
    Annotated[tuple[Coordinate, Coordinate, Angle], Sequence, Tag("<pose>")]
    | Annotated[tuple[Coordinate, Coordinate], Sequence, Tag("<point>")],
    Discriminator(_kind),
]


class Mover(Model):
    """A body that follows its path whatever stands there: it pushes, and nothing pushes it."""

    name: Label = Field(description="label, different from those of robots and other movers")
    footprint: Footprint = Field(
        description="[m] {length, width} centred on the reference point, or corners [x, y] in the "
        "mover's frame (x forward)"
    )
    waypoints: Annotated[
        tuple[Waypoint, ...], Field(min_length=2, max_length=MOST_POINTS), Sequence
    ] = Field(
        description="[m, rad] where the reference point goes, [x, y] or [x, y, heading]; straight "
        "on where the heading stays, on an arc where it turns"
    )
    times: Annotated[
        tuple[Annotated[Number, Field(ge=0.0, le=1.0e9)], ...] | None,
        Sequence,
    ] = Field(default=None, description="[s] when it is at each waypoint; or give speed")
    speed: Annotated[Number, Field(gt=0.0, le=1000.0)] | None = Field(
        default=None, description="[m/s] along the whole way, from 0 s on; or give times"
    )
    repeat: Literal["once", "loop", "to_and_fro"] = Field(
        default="once",
        description="what follows the last waypoint: once (it stays there), loop (from the first "
        "one again, where the last one is) or to_and_fro (back the same way)",
    )

    @property
    def outline(self) -> tuple[Point, ...]:
        """Corners [m] in its own frame."""
        return outline_of(self.footprint)

    @property
    def poses(self) -> tuple[tuple[float, float, float], ...]:
        """Its waypoints with their headings, 0 where none is written."""
        return tuple((*one[:2], one[2] if len(one) == 3 else 0.0) for one in self.waypoints)

    @property
    def moments(self) -> tuple[float, ...]:
        """[s] when it is at each waypoint."""
        if self.times is not None:
            return self.times
        found = [0.0]
        for way in map(way_between, self.poses, self.poses[1:]):
            found.append(found[-1] + way / (self.speed or 1.0))
        return tuple(found)


class Obstacle(Model):
    """An obstacle that can be pushed: it moves while something pushes it, and then stands."""

    corners: Polygon = Field(description="[m] its corners at the start")
    mass: Annotated[Number, Field(gt=0.0, le=1.0e9)] = Field(
        description="[kg] mass of the obstacle, which can be pushed"
    )


ObstacleEntry = Annotated[
    Annotated[Polygon, Tag("<list>")] | Annotated[Obstacle, Tag("<mapping>")],
    either("<list>", "<mapping>"),
]


def way_between(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    """Length [m] of the way from one pose to the next: an arc where the heading turns."""
    half = 0.5 * (b[2] - a[2])
    return math.dist(a[:2], b[:2]) * (half / math.sin(half) if half else 1.0)


def mover_faults(world: World) -> Iterator[Fault]:
    """Movers whose waypoints and times do not make a path."""
    for k, mover in enumerate(world.movers):
        yield from _path_faults(("movers", k), mover)


def _path_faults(where: Location, mover: Mover) -> Iterator[Fault]:
    poses, times = mover.poses, mover.times
    sizes = [len(one) for one in mover.waypoints]
    if 3 in sizes and 2 in sizes:
        message = "has no heading, but others have one; write [x, y, heading] at all, or at none"
        yield Fault((*where, "waypoints", sizes.index(2)), message)
        return
    if times is not None and mover.speed is not None:
        yield Fault((*where, "speed"), "given beside times; a mover has one of them")
    elif times is None and mover.speed is None:
        yield Fault((*where, "times"), "missing; give the time [s] of each waypoint, or a speed")
    elif times is not None and len(times) != len(poses):
        message = f"{len(times)} times for {len(poses)} waypoints; give one for each"
        yield Fault((*where, "times"), message)
    for n, (before, after) in enumerate(pairwise(times or ()), start=1):
        if after <= before:
            message = f"{after!r} s is not after {before!r} s, the time before it"
            yield Fault((*where, "times", n), f"{message}; times must increase")
    for n, (a, b) in enumerate(pairwise(poses), start=1):
        place: Location = (*where, "waypoints", n)
        apart = math.dist(a[:2], b[:2])
        if mover.speed is not None and apart <= LENGTH:
            message = "is where the waypoint before it is, and a speed needs a way between them"
            yield Fault(place, f"{message}; leave it out, or give times instead of the speed")
        elif apart > LENGTH and abs(b[2] - a[2]) > math.pi:
            message = f"turns by {b[2] - a[2]:.4g} rad on the way here, more than half a turn"
            yield Fault(place, f"{message}; write waypoints in between")
    turn = (poses[-1][2] - poses[0][2]) / FULL
    is_closed = math.dist(poses[0][:2], poses[-1][:2]) <= LENGTH
    if mover.repeat == "loop" and not (is_closed and abs(turn - round(turn)) * FULL <= TURN):
        first = ", ".join(f"{value:g}" for value in mover.waypoints[0])
        message = f"is not the first one, [{first}], and a loop must end where it begins"
        yield Fault((*where, "waypoints", len(poses) - 1), f"{message}; add that one at the end")
