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
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.randomness import stream
from physim.tolerances import CONTACT
from physim.world import Start
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
    poses = np.full((len(laid.robots), 3), np.nan)
    groups: dict[tuple[Start, Location], list[int]] = {}
    for i, robot in enumerate(laid.robots):
        start = world.start_of(robot)
        if robot.pose is not None:
            x, y, heading = robot.pose
            poses[i] = x, y, drawn_heading(world.seed, i) if heading == "random" else heading
            occupied.stand(i, poses[i], gap=0.0)
        elif start is not None:
            shared: Location = ("start",) if robot.start is None else ()
            groups.setdefault((start, shared), []).append(i)
    faults = []
    for (start, where), members in groups.items():
        group = _Group(start, members, where, occupied, along, free, laid)
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
        along: PathFrame, accessible: shapely.Polygon, laid: Layout,
    ) -> None:  # fmt: skip
        self.start, self.members, self.where = start, members, where
        self.occupied, self.along, self.laid, self.seed = occupied, along, laid, laid.world.seed
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
        return self._fault(self._crowded(most, stuck))

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

    def _crowded(self, placed: int, stuck: int) -> str:
        """What to do about robots that do not fit: in figures."""
        start, name = self.start, self.laid.names[stuck]
        free = self.free.difference(self.occupied.kept_clear(start.min_gap)).area
        need = sum(
            shapely.Polygon(self.occupied.footprints[i]).buffer(0.5 * start.min_gap).area
            for i in self.members
        )
        fewer = "fewer robots" if start.abreast is None else "fewer robots or fewer abreast"
        return (
            f"{placed} of {len(self.members)} robots could be placed in it with gaps of "
            f'{start.min_gap:.6g} m, then none for "{name}"; {free:.3g} m² of it are free, and the '
            f"robots with half the gap around them take {need:.3g} m², best no more than "
            f"{FILLED:.0%} of it; enlarge the region, or use a smaller min_gap or {fewer}"
        )

    def _fault(self, message: str) -> Fault:
        where = self.where or (*self.laid.entry_key(self.members[0]), "start")
        return Fault((*where, "region"), message)
