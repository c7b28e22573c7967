"""What placing robots at random rests on: what is occupied, and where to look for room."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import floor

import numpy as np
import shapely

from physim.geometry.arc_length import Polyline
from physim.geometry.outline import placed_outline, placed_outlines
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray, IntArray
from physim.world import Start
from physim.world.layout.shared import Shared

ROUNDING = 1e-6
"""[m] by which more is looked at than is near, so that no rounding leaves anything out"""
SMALLEST_CELL = 0.1
"""[m]"""
OUTLINE_STEP = 0.25
"""[m] apart are the points of a region's outline by which its stretch of road is found"""


class Occupancy:
    """Walls, obstacles and the robots that stand already; footprints (n, 2) in their frames."""

    def __init__(self, footprints: Sequence[FloatArray], walls: Sequence[shapely.Geometry]) -> None:
        self.footprints = [np.asarray(footprint) for footprint in footprints]
        self.walls = shapely.GeometryCollection(list(walls))
        shapely.prepare(self.walls)
        count, radius = len(self.footprints), Shared(circumscribed_radius)
        self.radius = np.array([radius(f) for f in self.footprints])
        self.largest = float(self.radius.max(initial=0.0))
        self.widest = 0.0
        self.cells = Cells(max(2.0 * self.largest, SMALLEST_CELL))
        self.outline = np.empty(count, dtype=object)
        self.place = np.full((count, 2), np.inf)
        self.gap = np.zeros(count)

    def stand(self, i: int, pose: FloatArray, gap: float) -> None:
        """Robot i stands at a pose and wants others ``gap`` [m] away."""
        self.outline[i] = placed_outline(self.footprints[i], pose)
        self.place[i] = pose[:2]
        self.gap[i] = gap
        self.widest = max(self.widest, gap)
        self.cells.put(i, float(pose[0]), float(pose[1]))

    def leave(self, robots: Iterable[int]) -> None:
        """These robots stand no more."""
        for i in robots:
            self.cells.take(i, *self.place[i].tolist())
            self.place[i] = np.inf

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
        widest = max(self.widest, gap)
        some = self.cells.near(pose[0], pose[1], self.radius[i] + self.largest + widest + room)
        away = np.hypot(*(self.place[some] - pose[:2]).T)
        wanted = np.maximum(self.gap[some], gap)
        close = away <= self.radius[i] + self.radius[some] + wanted + room
        if not close.any():
            return np.inf
        near = self.outline[some[close]]
        return float((shapely.distance(near, outline) - wanted[close]).min())

    def kept_clear(self, gap: float) -> shapely.Geometry:
        """Where nothing may stand: within ``gap`` of walls and standing robots."""
        standing = self.outline[np.isfinite(self.place[:, 0])]
        return shapely.union_all([self.walls.buffer(gap), *shapely.buffer(standing, gap)])


class Cells:
    """Which robots stand near a place, by squares of side ``size`` [m]."""

    def __init__(self, size: float) -> None:
        self.size = size
        self._robots: dict[tuple[int, int], set[int]] = {}

    def put(self, i: int, x: float, y: float) -> None:
        """Robot i stands at a place."""
        self._robots.setdefault(self._cell(x, y), set()).add(i)

    def take(self, i: int, x: float, y: float) -> None:
        """Robot i, at that place, stands no more."""
        self._robots[self._cell(x, y)].discard(i)

    def near(self, x: float, y: float, reach: float) -> IntArray:
        """Robots within ``reach`` [m] of a place and perhaps some others, increasing."""
        reach += ROUNDING
        (left, low), (right, high) = (
            self._cell(x - reach, y - reach),
            self._cell(x + reach, y + reach),
        )
        if (right - left + 1) * (high - low + 1) >= len(self._robots):
            found = [i for robots in self._robots.values() for i in robots]
        else:
            square = ((a, b) for a in range(left, right + 1) for b in range(low, high + 1))
            found = [i for cell in square for i in self._robots.get(cell, ())]
        return np.array(sorted(found), dtype=np.int64)

    def _cell(self, x: float, y: float) -> tuple[int, int]:
        return floor(x / self.size), floor(y / self.size)


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


class Candidates:
    """Where to look for room for each robot of a group: anywhere in the region, or its own cell.

    In rows every robot has a cell, in which the middle of its footprint lies: the region's stretch
    of the reference path is cut into as many parts as there are rows, each row into as many bands
    as it has robots. In a row they stand in the order of their paths from right to left.
    """

    def __init__(
        self,
        start: Start,
        members: Sequence[int],
        free: shapely.Geometry,
        along: PathFrame,
        paths: Sequence[FloatArray],
        occupied: Occupancy,
    ) -> None:
        self.start, self.along, self.occupied, self.free = start, along, occupied, free
        self.drawn = 0
        """poses drawn so far"""
        self.gap: tuple[float, float] | None = None
        """[m] along the reference path, where a row has no place: cells are cut of one stretch"""
        self.cells: dict[int, tuple[float, float, float, float]] = {}
        if start.abreast is not None:
            self._cut(members, start.abreast, paths)

    def draw(self, i: int, draw: np.random.Generator, size: int, heading: float) -> FloatArray:
        """Poses (size, 3) to try for robot i, whose random heading would be ``heading``."""
        self.drawn += size
        if i in self.cells:
            low, high, right, left = self.cells[i]
            origin, direction = self.along.at(draw.uniform(low, high, size))
            normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
            place = origin + draw.uniform(right, left, size)[:, None] * normal
            headings = self._headings(place, heading)
            return np.column_stack([place - self._middle(i, headings), headings])
        place = draw.uniform(*self._box(i, heading), (size, 2))
        return np.column_stack([place, self._headings(place, heading)])

    def _middle(self, i: int, headings: FloatArray) -> FloatArray:
        """Middle (B, 2) of footprint i from its reference point, at headings (B,)."""
        low, high = shapely.bounds(shapely.Polygon(self.occupied.footprints[i])).reshape(2, 2)
        x, y = 0.5 * (low + high)
        c, s = np.cos(headings), np.sin(headings)
        return np.stack([c * x - s * y, s * x + c * y], axis=1)

    def _headings(self, place: FloatArray, heading: float) -> FloatArray:
        wanted = self.start.heading
        if wanted == "along":
            _, direction = self.along.at(self.along.project(place)[0])
            return np.asarray(np.arctan2(direction[:, 1], direction[:, 0]))
        return np.full(len(place), heading if wanted == "random" else wanted)

    def _box(self, i: int, heading: float) -> tuple[FloatArray, FloatArray]:
        """Corners between which the reference point of robot i must lie to be in the region."""
        low, high = np.array(self.free.bounds).reshape(2, 2)
        if self.start.heading == "along":
            return low - self.occupied.radius[i], high + self.occupied.radius[i]
        angle = heading if self.start.heading == "random" else self.start.heading
        bounds = shapely.bounds(placed_outline(self.occupied.footprints[i], (0.0, 0.0, angle)))
        low, high = low - bounds[:2], high - bounds[2:]
        return np.minimum(low, high), np.maximum(low, high)

    def _cut(self, members: Sequence[int], abreast: int, paths: Sequence[FloatArray]) -> None:
        outline = shapely.get_coordinates(shapely.segmentize(self.free, OUTLINE_STEP))
        station, deviation = self.along.project(outline)
        rows = [members[k : k + abreast] for k in range(0, len(members), abreast)]
        ends = np.linspace(station.max(), station.min(), len(rows) + 1)
        order = np.argsort(station)
        station, deviation = station[order], deviation[order]
        line_of = Shared(shapely.LineString)
        for row, (high, low) in zip(rows, pairwise(ends), strict=True):
            margin = OUTLINE_STEP
            first = np.searchsorted(station, low - margin)
            end = np.searchsorted(station, high + margin, side="right")
            here = deviation[first:end]
            if not len(here):
                begin = self.along.station[1]
                self.gap = (float(low - begin), float(high - begin))
                return
            bands = np.linspace(here.min(), here.max(), len(row) + 1)
            middle = 0.5 * (low + high)
            lane = {i: self._lane(line_of(paths[i]), middle) for i in row}
            ordered = sorted(row, key=lambda i: (lane[i], i))
            for i, (right, left) in zip(ordered, pairwise(bands), strict=True):
                self.cells[i] = (*self._within(low, high), *self._within(right, left))

    def _within(self, low: float, high: float) -> tuple[float, float]:
        """The middle part of a side of a cell in which robots are placed."""
        spread = self.start.spread
        if spread == 1.0:
            return float(low), float(high)
        middle, half = 0.5 * (low + high), 0.5 * spread * (high - low)
        return float(middle - half), float(middle + half)

    def _lane(self, line: shapely.LineString, station: float) -> float:
        """Deviation [m] of a robot's own path from the reference path near a station."""
        origin, direction = self.along.at(np.array([station]))
        x, y = line.interpolate(line.project(shapely.Point(origin[0]))).coords[0]
        return float(direction[0, 0] * (y - origin[0, 1]) - direction[0, 1] * (x - origin[0, 0]))
