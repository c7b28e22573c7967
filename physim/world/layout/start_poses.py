"""Start poses: as written, or placed by the seed in a region, apart from everything.

Each robot draws from streams of its own: its heading from (seed, "heading", i), its place from
(seed, "start", i). Places are drawn and dropped until one fits, so that every place that fits is
equally likely; where robots crowd, the tightest of many is taken instead. A footprint is kept
``min_gap`` from robots, boundaries and obstacles, `SLACK` on the safe side. Needs shapely alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
import shapely

from physim.errors import Fault, Location, WorldError
from physim.geometry.polygon import circumscribed_radius, least_width
from physim.geometry.shapes import FloatArray
from physim.randomness import stream
from physim.tolerances import CONTACT
from physim.world import Start, World
from physim.world.layout.places import Candidates, Occupancy, PathFrame
from physim.world.scene import Layout

SLACK = 2.0 * CONTACT
"""[m] by which a gap is larger than asked for, so that no rounding makes it smaller"""
LOOSE_ROUNDS, TIGHT_ROUNDS = 12, 8
"""Times that a group is placed anew: at first where a place is found, then as tight as can be."""
BATCHES = (32, 128, 512, 2048)
"""Places drawn for one robot before its round is given up"""
TIGHT_BATCH = 1024
MOST_TIGHT = 100
"""Robots of a group that are placed as tight as can be: with more a refusal would take minutes."""
MOST_DRAWN = 200_000
"""Poses drawn for a group, after which it is placed anew no more: about 10 s of processor time."""
FILLED = 0.4
"""[-] share of a region that robots with half their gap around them fill at random with ease"""


def start_poses(laid: Layout) -> FloatArray:
    """Start poses (N, 3) [m, m, rad] of a layout, whatever its own are.

    Raises WorldError when a region does not hold its robots.
    """
    world = laid.world
    occupied = Occupancy(laid.footprints, [shape for _, shape in (*laid.walls, *laid.solids)])
    free, along = laid.area.polygon, PathFrame(laid.reference)
    poses = np.full((len(world.robots), 3), np.nan)
    groups: dict[tuple[Start, Location], list[int]] = {}
    for i, robot in enumerate(world.robots):
        start = world.start_of(i)
        if robot.pose is not None:
            x, y, heading = robot.pose
            poses[i] = x, y, drawn_heading(world.seed, i) if heading == "random" else heading
            occupied.stand(i, poses[i], gap=0.0)
        elif start is not None:
            shared: Location = ("start",) if robot.start is None else ()
            groups.setdefault((start, shared), []).append(i)
    faults = []
    for (start, where), members in groups.items():
        group = _Group(start, members, where, occupied, along, free, world)
        fault = group.place(poses, laid.paths)
        faults += [fault] if fault is not None else []
    if faults:
        raise WorldError(faults)
    return poses


def drawn_heading(seed: int, robot: int) -> float:
    """Random heading [rad] of a robot, uniform in [-pi, pi)."""
    return float(stream(seed, "heading", robot).uniform(-pi, pi))


class _Group:
    """Robots that share a region."""

    def __init__(
        self, start: Start, members: list[int], where: Location, occupied: Occupancy,
        along: PathFrame, accessible: shapely.Polygon, world: World,
    ) -> None:  # fmt: skip
        self.start, self.members, self.where = start, members, where
        self.occupied, self.along, self.world, self.seed = occupied, along, world, world.seed
        self.free = shapely.intersection(shapely.Polygon(start.region), accessible)
        shapely.prepare(self.free)

    def place(self, poses: FloatArray, paths: Sequence[FloatArray]) -> Fault | None:
        """Fill in the poses of the group; the fault that says why not otherwise."""
        if self.free.area <= 0.0:
            return self._fault("none of it lies in the accessible area; draw it inside")
        start = self.start
        candidates = Candidates(start, self.members, self.free, self.along, paths, self.occupied)
        if candidates.gap is not None:
            low, high = candidates.gap
            return self._fault(
                f"no part of it lies {low:.4g} to {high:.4g} m along the reference path, where "
                f"{start.abreast} abreast are to stand; draw it over one stretch of that path"
            )
        streams = {i: stream(self.seed, "start", i) for i in self.members}
        radius = {i: circumscribed_radius(self.occupied.footprints[i]) for i in self.members}
        order = sorted(self.members, key=lambda i: -radius[i])
        if start.abreast is not None:
            order = self.members
        most, stuck = -1, order[0]
        rounds = [False] * LOOSE_ROUNDS
        if len(self.members) <= MOST_TIGHT:
            rounds += [True] * TIGHT_ROUNDS
        for attempt, tight in enumerate(rounds):
            if candidates.drawn > MOST_DRAWN:
                break
            placed: list[int] = []
            for i in order:
                pose = self._found(i, candidates, streams[i], tight)
                if pose is None:
                    break
                poses[i] = pose
                self.occupied.stand(i, pose, start.min_gap)
                placed.append(i)
            if len(placed) == len(order):
                return None
            if len(placed) > most:
                most, stuck = len(placed), order[len(placed)]
            self.occupied.leave(placed)
            if not placed and attempt >= 1:
                break
        return self._fault(self._crowded(most, stuck, candidates))

    def _found(
        self, i: int, candidates: Candidates, draw: np.random.Generator, tight: bool
    ) -> FloatArray | None:
        """Pose at which robot i is apart from all: the first that is drawn, or the tightest."""
        heading = drawn_heading(self.seed, i)
        for size in (TIGHT_BATCH,) if tight else BATCHES:
            poses, gap = candidates.draw(i, draw, size, heading), self.start.min_gap + SLACK
            if not tight:
                first = self.occupied.first_fit(i, poses, self.free, gap)
                if first is not None:
                    return np.asarray(poses[first])
                continue
            room = self.occupied.room(i, poses, self.free, gap)
            fits = np.flatnonzero(room >= 0.0)
            if len(fits):
                return np.asarray(poses[fits[np.argmin(room[fits])]])
        return None

    def _crowded(self, placed: int, stuck: int, candidates: Candidates) -> str:
        """What to do about robots that do not fit: in figures."""
        gap, n, name = self.start.min_gap, len(self.members), self.world.robots[stuck].name
        room = self.free.difference(self.occupied.kept_clear(gap))
        if placed == 0 and (too_narrow := self._narrow(room, name)):
            return too_narrow
        free = room.area
        need = sum(
            shapely.Polygon(self.occupied.footprints[i]).buffer(0.5 * gap).area
            for i in self.members
        )
        counted = (
            f"{placed} of {n} robots could be placed in it with gaps of {gap:.6g} m, then none "
            f'for "{name}"; {free:.3g} m² of it are free, and the robots with half the gap around '
            f"them take {need:.3g} m²"
        )
        if too_wide := self._too_wide(room, stuck, candidates):
            return f"{counted}; {too_wide}"
        if need > FILLED * free:
            return (
                f"{counted}; about {_rounded_up(need / FILLED)} m² are enough: enlarge the region, "
                "or use a smaller min_gap or fewer robots"
            )
        rows = ", fewer abreast or none" if self.start.abreast is not None else ""
        return f"{counted}, but not in this shape; use a wider region{rows} or a smaller min_gap"

    def _too_wide(self, room: shapely.Geometry, stuck: int, candidates: Candidates) -> str:
        """What to say where the robots abreast of one need more width than ``room`` has there."""
        abreast, gap = self.start.abreast, self.start.min_gap
        if abreast is None:
            return ""
        place = self.members.index(stuck) // abreast * abreast
        row = self.members[place : place + abreast]
        need = sum(self._across(i) for i in row) + (len(row) - 1) * gap
        wide = candidates.width_beside(stuck, room)
        if need <= wide:
            return ""
        return (
            f"side by side {len(row)} abreast with these gaps need {need:.4g} m across the road, "
            f"{need + 2.0 * gap:.4g} m from wall to wall, and {wide:.4g} m of it are {gap:.6g} m "
            "from all walls; use fewer abreast, a smaller min_gap, or a wider region and road"
        )

    def _across(self, i: int) -> float:
        """Width [m] that robot i takes across the road; if it may stand at a slant, the least."""
        footprint = self.occupied.footprints[i]
        return (
            float(np.ptp(footprint[:, 1]))
            if self.start.heading == "along"
            else (least_width(footprint))
        )

    def _narrow(self, room: shapely.Geometry, name: str) -> str:
        """What to say where no place of ``room`` is as wide as any robot at its narrowest."""
        wide = 0.0
        if not room.is_empty:
            wide = 2.0 * shapely.maximum_inscribed_circle(room, tolerance=1e-3).length
        need = min(least_width(self.occupied.footprints[i]) for i in self.members)
        if wide >= need:
            return ""
        return (
            f'no place in it is as wide as "{name}" needs: {self.free.area:.3g} of its '
            f"{shapely.Polygon(self.start.region).area:.3g} m² lie in the accessible area, and "
            f"{self.start.min_gap:.6g} m (min_gap) from all else the widest place is {wide:.3g} m "
            f"wide, while a robot is {need:.3g} m at its narrowest; move the region inside, or use "
            "a wider one or a smaller min_gap"
        )

    def _fault(self, message: str) -> Fault:
        where = self.where or (*self.world.entry_of(self.members[0]), "start")
        return Fault((*where, "region"), message)


def _rounded_up(area: float) -> str:
    unit = 10.0 ** max(np.floor(np.log10(area)) - 1.0, 0.0)
    return f"{np.ceil(area / unit) * unit:.0f}"
