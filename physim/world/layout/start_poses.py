"""Start poses: as written, or placed by the seed in a region, apart from everything.

Each robot draws from streams of its own: its heading from (seed, "heading", i), its place from
(seed, "start", i). Places are drawn and dropped until one fits, so that every place that fits is
equally likely; where robots crowd, the tightest of many is taken instead. A footprint is kept
``min_gap`` from robots, boundaries and obstacles, `SLACK` on the safe side. Needs shapely alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, WorldError
from physim.geometry.shapes import FloatArray
from physim.randomness import stream
from physim.tolerances import CONTACT
from physim.units import figure
from physim.world import Start
from physim.world.ground.lines import placed_outline
from physim.world.ground.polyline import Polyline
from physim.world.layout.occupancy import Occupancy
from physim.world.layout.robots import shared
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
OUTLINE_STEP = 0.25
"""[m] apart are the points of a region's outline by which its stretch of road is found"""


def start_poses(laid: Layout) -> FloatArray:
    """Start poses (N, 3) [m, m, rad] of a layout, whatever its own are.

    Raises WorldError when a region does not hold its robots.
    """
    world = laid.world
    around = [shape for _, shape in (*laid.walls, *laid.solids)]
    around += [placed_outline(one.outline, one.start) for one in laid.moved]
    occupied = Occupancy(laid.footprints, around)
    along, lines = PathFrame(laid.reference), shared(shapely.LineString, laid.paths)
    poses = np.full((len(laid.robots), 3), np.nan)
    groups: dict[tuple[Start, bool], list[int]] = {}
    for i, robot in enumerate(laid.robots):
        start = world.start_of(robot)
        if robot.pose is not None:
            x, y, heading = robot.pose
            poses[i] = x, y, drawn_heading(world.seed, i) if heading == "random" else heading
            occupied.stand(i, poses[i], gap=0.0)
        elif start is not None:
            groups.setdefault((start, robot.start is None), []).append(i)
    faults = []
    for (start, is_worlds), members in groups.items():
        free = shapely.intersection(shapely.Polygon(start.region), laid.area.polygon)
        shapely.prepare(free)
        said = "none of it lies in the accessible area; draw it inside"
        if free.area > 0.0:
            group = _Group(start, members, free, along, lines, occupied, world.seed)
            said = group.place(poses, laid.names)
        if said:
            holder = () if is_worlds else laid.entry_key(members[0])
            faults.append(Fault((*holder, "start", "region"), said))
    if faults:
        raise WorldError(faults)
    return poses


def drawn_heading(seed: int, robot: int) -> float:
    """Random heading [rad] of a robot, uniform in [-pi, pi)."""
    return float(stream(seed, "heading", robot).uniform(-pi, pi))


class PathFrame(Polyline):
    """The reference path, prolonged straight on at both ends: stations, deviations, headings."""

    def __init__(self, reference: FloatArray) -> None:
        begin, end = reference[1] - reference[0], reference[-1] - reference[-2]
        far = 10.0 * float(np.ptp(reference, axis=0).max()) + 1000.0
        first = reference[0] - far * begin / np.hypot(*begin)
        last = reference[-1] + far * end / np.hypot(*end)
        super().__init__(np.vstack([first, reference, last]))
        self.own = shapely.LineString(reference)

    def project(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Stations (B,) and deviations (B,), left positive, of points (B, 2) [m].

        Only a point next to an end of the path is beside what prolongs that end: this may cross
        the road elsewhere.
        """
        places = shapely.points(points)
        station = shapely.line_locate_point(self.shape, places)
        own = shapely.line_locate_point(self.own, places)
        begin, end = self.station[1], self.station[-2]
        before, after = own <= 0.0, own >= self.own.length
        strays = ((station < begin) & ~before) | ((station > end) & ~after)
        if strays.any():
            back = np.minimum((points - self.points[1]) @ self.direction[0], 0.0)
            on = np.maximum((points - self.points[-2]) @ self.direction[-1], 0.0)
            beside = begin + own + np.where(before, back, 0.0) + np.where(after, on, 0.0)
            station = np.where(strays, beside, station)
        origin, direction = self.at(station)
        apart = points - origin
        return station, direction[:, 0] * apart[:, 1] - direction[:, 1] * apart[:, 0]


class _Group:
    """Robots that share a region: each is placed anywhere in it, or in rows in a cell of its own.

    In a cell lies the middle of the robot's footprint: the region's stretch of the reference path
    is cut into as many parts as there are rows, each row into as many bands as it has robots. In a
    row they stand in the order of their paths from right to left. ``lines`` are all robots' paths.
    """

    def __init__(
        self, start: Start, members: list[int], free: Any, along: PathFrame,
        lines: Sequence[Any], occupied: Occupancy, seed: int,
    ) -> None:  # fmt: skip
        self.start, self.members, self.free = start, members, free
        self.along, self.lines, self.occupied, self.seed = along, lines, occupied, seed
        self.drawn = 0
        """poses drawn so far"""
        self.cells: dict[int, tuple[float, float, float, float]] = {}
        """ends of the cell of each robot: stations, and deviations [m]"""

    def place(self, poses: FloatArray, names: Sequence[str]) -> str:
        """Fill in the poses of the group; otherwise say why not."""
        if self.start.abreast is not None and (said := self._cut(self.start.abreast)):
            return said
        streams = {i: stream(self.seed, "start", i) for i in self.members}
        order = self.members
        if self.start.abreast is None:
            order = sorted(order, key=lambda i: -self.occupied.radius[i])
        most, stuck = -1, order[0]
        tight_rounds = TIGHT_ROUNDS if len(order) <= MOST_TIGHT else 0
        for attempt in range(LOOSE_ROUNDS + tight_rounds):
            if self.drawn > MOST_DRAWN:
                break
            placed: list[int] = []
            for i in order:
                pose = self._found(i, streams[i], is_tight=attempt >= LOOSE_ROUNDS)
                if pose is None:
                    break
                poses[i] = pose
                self.occupied.stand(i, pose, self.start.min_gap)
                placed.append(i)
            if len(placed) == len(order):
                return ""
            if len(placed) > most:
                most, stuck = len(placed), order[len(placed)]
            self.occupied.leave(placed)
            if not placed and attempt >= 1:
                break
        gap, shapes = self.start.min_gap, (self.occupied.footprints[i] for i in order)
        free = self.free.difference(self.occupied.kept_clear(gap)).area
        need = sum(shapely.Polygon(shape).buffer(0.5 * gap).area for shape in shapes)
        fewer = "fewer robots" if self.start.abreast is None else "fewer robots or fewer abreast"
        remedy = f"enlarge it, or use a smaller min_gap or {fewer}"
        if not most:
            remedy = "enlarge it or the road about it, or make the robots smaller"
        return (
            f"{most} of {len(order)} robots could be placed in it with gaps of {gap:.6g} m, and "
            f'none for "{names[stuck]}": {free:.3g} m² of it are free, and robots with '
            f"half the gap around them take {need:.3g} m²; {remedy}"
        )

    def _found(self, i: int, draw: np.random.Generator, is_tight: bool) -> FloatArray | None:
        """Pose at which robot i is apart from all: the first that is drawn, or the tightest."""
        heading, gap = drawn_heading(self.seed, i), self.start.min_gap + SLACK
        for size in (TIGHT_BATCH,) if is_tight else BATCHES:
            poses = self._draw(i, draw, size, heading)
            if not is_tight:
                first = self.occupied.first_fit(i, poses, self.free, gap)
                if first is not None:
                    return np.asarray(poses[first])
                continue
            room = self.occupied.room(i, poses, self.free, gap)
            fits = np.flatnonzero(room >= 0.0)
            if len(fits):
                return np.asarray(poses[fits[np.argmin(room[fits])]])
        return None

    def _draw(self, i: int, draw: np.random.Generator, size: int, heading: float) -> FloatArray:
        """Poses (size, 3) to try for robot i, whose random heading would be ``heading``."""
        self.drawn += size
        outline, wanted = self.occupied.footprints[i], self.start.heading
        angle = heading if wanted == "random" else wanted
        if i in self.cells:
            first, last, right, left = self.cells[i]
            origin, direction = self.along.at(draw.uniform(first, last, size))
            normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
            place = origin + draw.uniform(right, left, size)[:, None] * normal
        elif angle == "along":
            low, high = np.array(self.free.bounds).reshape(2, 2)
            radius = self.occupied.radius[i]
            place = draw.uniform(low - radius, high + radius, (size, 2))
        else:  # where the reference point must lie for the footprint to be in the region
            bounds = shapely.bounds(placed_outline(outline, (0.0, 0.0, angle)))
            low, high = (np.array(self.free.bounds) - bounds).reshape(2, 2)
            place = draw.uniform(np.minimum(low, high), np.maximum(low, high), (size, 2))
        headings = np.full(size, 0.0 if angle == "along" else angle)
        if angle == "along":
            _, direction = self.along.at(self.along.project(place)[0])
            headings = np.arctan2(direction[:, 1], direction[:, 0])
        if i in self.cells:
            x, y = shapely.bounds(shapely.Polygon(outline)).reshape(2, 2).mean(axis=0)
            c, s = np.cos(headings), np.sin(headings)
            place = place - np.stack([c * x - s * y, s * x + c * y], axis=1)
        return np.column_stack([place, headings])

    def _cut(self, abreast: int) -> str:
        """Give each robot its cell; say why a row has none: cells are cut of one stretch."""
        outline = shapely.get_coordinates(shapely.segmentize(self.free, OUTLINE_STEP))
        station, deviation = self.along.project(outline)
        rows = [self.members[k : k + abreast] for k in range(0, len(self.members), abreast)]
        ends = np.linspace(station.max(), station.min(), len(rows) + 1)
        for row, (high, low) in zip(rows, pairwise(ends), strict=True):
            near = (station >= low - OUTLINE_STEP) & (station <= high + OUTLINE_STEP)
            if not near.any():
                low, high = low - self.along.station[1], high - self.along.station[1]
                return (
                    f"no part of it lies {figure(low)} to {figure(high)} m along the reference "
                    f"path, where {abreast} abreast are to stand; draw it over one stretch of that"
                )
            bands = np.linspace(deviation[near].min(), deviation[near].max(), len(row) + 1)
            (x0, y0), (dx, dy) = self.along.at(0.5 * (low + high))
            lane = {}
            for i in row:
                foot = self.lines[i].interpolate(self.lines[i].project(shapely.Point(x0, y0)))
                lane[i] = float(dx * (foot.y - y0) - dy * (foot.x - x0)), i
            for i, band in zip(sorted(row, key=lane.__getitem__), pairwise(bands), strict=True):
                self.cells[i] = (*self._middle_part(low, high), *self._middle_part(*band))
        return ""

    def _middle_part(self, low: float, high: float) -> tuple[float, float]:
        """The part of a side of a cell in which robots are placed."""
        spread = self.start.spread
        if spread == 1.0:
            return float(low), float(high)
        middle, half = 0.5 * (low + high), 0.5 * spread * (high - low)
        return float(middle - half), float(middle + half)
