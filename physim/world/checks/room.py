"""Room along a path: its clearance at every station against the radii of the robot.

The clearance of a point is its distance to the nearest boundary or obstacle. With the reference
point on the path, a robot of circumscribed radius R and inscribed radius r (both about that point)
fits at any heading where the clearance exceeds R, at no heading where it is at most r, and between
the two only where it is aligned. Only the stations that the reference point is to reach are judged:
from that nearest to the start to the stop station.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from physim.geometry.area import Area, united
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT
from physim.world.checks.standing import reached
from physim.world.layout.shared import Shared
from physim.world.scene import Layout

SPACING = 0.25
"""[m] from one station of a profile to the next; waypoints are stations too"""
MOST_STATIONS = 2_000
"""Stations of one profile; longer paths have them further apart."""
CLOSER, ROUNDS = 32, 4
"""Places looked at about a station outside the area, and how often again about the deepest."""

Place = tuple[float, float, float, float]
"""Station, x, y and clearance [m] of a point of a path"""

ANY, ALIGNED, NOT = "fits at any heading", "fits only aligned", "does not fit"


@dataclass(frozen=True)
class Stretch:
    """Neighbouring stations of one verdict."""

    first: float
    """[m] station"""
    last: float
    """[m] station"""
    verdict: str
    """`ANY`, `ALIGNED` or `NOT`"""


@dataclass(frozen=True)
class ClearanceProfile:
    """Room along the path of one robot; K stations."""

    number: int
    """of the robot, from 0"""
    robot: str
    station: FloatArray
    """(K,) [m] along the path"""
    clearance: FloatArray
    """(K,) [m] to the nearest boundary or obstacle; negative outside the accessible area"""
    inscribed: float
    """[m] largest circle about the reference point within the footprint; 0 when that is outside"""
    circumscribed: float
    """[m] smallest circle about the reference point around the footprint"""
    reached: tuple[float, float]
    """[m] first and last station at which the robot is to be, which alone are judged"""
    narrowest: Place
    """where this part of the path has least room: the exact minimum, outside the deepest place"""
    stretches: tuple[Stretch, ...]
    """of this part"""
    safe_distance: float | None
    """[m] L; None where the controller has none"""

    @property
    def verdict(self) -> str:
        """The worst of the path."""
        return verdict(self.narrowest[3], self.inscribed, self.circumscribed)

    @property
    def danger_share(self) -> float | None:
        """Share of the part judged nearer to a wall than the safe distance; None without one."""
        if self.safe_distance is None:
            return None
        return self.share(self.clearance < self.safe_distance)

    def share(self, where: NDArray[np.bool_]) -> float:
        """Share of the part judged at whose stations something holds, ``where`` (K,)."""
        weight = np.gradient(self.station) if len(self.station) > 1 else np.ones(1)
        weight = np.where(self.is_reached, weight, 0.0)
        return float(weight[where].sum() / weight.sum())

    @property
    def is_reached(self) -> NDArray[np.bool_]:
        """(K,) which stations are judged: at least one."""
        return _within(self.station, self.reached)

    def as_json(self) -> dict[str, Any]:
        """Return the profile as JSON holds it: lengths in metres."""
        station, x, y, clearance = self.narrowest
        return {
            "robot": self.robot,
            "length": float(self.station[-1]),
            "reached": {"from": self.reached[0], "to": self.reached[1]},
            "inscribed_radius": self.inscribed,
            "circumscribed_radius": self.circumscribed,
            "verdict": self.verdict,
            "narrowest": {"station": station, "x": x, "y": y, "clearance": clearance},
            "safe_distance": self.safe_distance,
            "danger_share": self.danger_share,
            "stretches": [
                {"from": part.first, "to": part.last, "verdict": part.verdict}
                for part in self.stretches
            ],
            "station": [round(float(s), 6) for s in self.station],
            "clearance": [round(float(c), 6) for c in self.clearance],
        }


def verdict(clearance: float, inscribed: float, circumscribed: float) -> str:
    """Whether a robot fits where its reference point has this much room; touching does not."""
    if clearance > circumscribed + CONTACT:
        return ANY
    return ALIGNED if clearance > inscribed + CONTACT else NOT


def inscribed_radius(outline: FloatArray) -> float:
    """Distance [m] of the reference point from the outline; 0 when it is not inside."""
    shape, origin = shapely.Polygon(outline), shapely.Point(0.0, 0.0)
    return float(shape.exterior.distance(origin)) if shape.covers(origin) else 0.0


def clearance_profiles(laid: Layout, safe_distance: float | None) -> tuple[ClearanceProfile, ...]:
    """Room along the path of each robot whose path and footprint are sound.

    A path that several robots share is looked at once.
    """
    if not laid.walls and not laid.solids:
        return ()
    around = _Surroundings.of(laid)
    room_along = Shared(lambda path: _room_along(path, around))
    radii = Shared(lambda outline: (inscribed_radius(outline), circumscribed_radius(outline)))
    part_of, profiles = reached(laid), []
    narrowest: dict[tuple[int, float, float], Place] = {}
    stretches: dict[tuple[int, float, float, float, float], tuple[Stretch, ...]] = {}
    for i, path in enumerate(laid.paths):
        room, part = room_along(path), part_of[i]
        r, R = radii(laid.footprints[i])
        if (id(path), *part) not in narrowest:
            narrowest[id(path), *part] = _narrowest(room, around, part)
        if (id(path), *part, r, R) not in stretches:
            stretches[id(path), *part, r, R] = _stretches(room, part, r, R)
        profiles.append(
            ClearanceProfile(
                i, laid.names[i], room.station, room.clearance, r, R, part,
                narrowest[id(path), *part], stretches[id(path), *part, r, R], safe_distance,
            )
        )  # fmt: skip
    return tuple(profiles)


def _within(station: FloatArray, part: tuple[float, float]) -> NDArray[np.bool_]:
    """(K,) stations that lie in a part of the path; of none the nearest to its middle."""
    inside = (station >= part[0] - CONTACT) & (station <= part[1] + CONTACT)
    if not inside.any():
        inside[np.argmin(np.abs(station - sum(part) / 2.0))] = True
    return np.asarray(inside)


@dataclass(frozen=True)
class _Surroundings:
    """What has a distance to a path: walls, and outlines of all that is solid."""

    tree: shapely.STRtree
    area: Area | None

    @classmethod
    def of(cls, laid: Layout) -> _Surroundings:
        """Those of a world; of obstacles that overlap the outline is that of all together."""
        solid = united([shape for _, shape in laid.solids]).boundary
        lines = [*(shape for _, shape in laid.walls), *shapely.get_parts(solid)]
        return cls(shapely.STRtree(_pieces(lines)), laid.area)

    def clearance(self, points: Any) -> FloatArray:
        """(K,) [m] of points (K,) to the nearest line; negative outside the accessible area."""
        found = self.tree.query_nearest(points, return_distance=True, all_matches=False)
        clearance = np.full(len(points), np.inf)
        clearance[found[0][0]] = found[1]
        if self.area is not None:
            clearance[~shapely.covers(self.area.polygon, points)] *= -1.0
        return clearance + 0.0  # no -0.0


@dataclass(frozen=True)
class _Room:
    """Room along a path, whoever takes it; K stations."""

    line: Any
    station: FloatArray
    clearance: FloatArray
    """(K,) negative outside the accessible area"""
    narrowest: Place
    """of what does not lie outside"""


def _room_along(path: FloatArray, around: _Surroundings) -> _Room:
    """Room along all of a path (n, 2) [m]; what lies outside the area is not its narrowest."""
    line = shapely.LineString(path)
    stations = _stations(path)
    clearance = around.clearance(line.interpolate(stations))
    return _Room(line, stations, clearance, _nearest_wall(line, around.tree))


def _narrowest(room: _Room, around: _Surroundings, part: tuple[float, float]) -> Place:
    """The place of a part of a path that has least room, or lies farthest outside the area."""
    within = _within(room.station, part)
    inside = np.where(within, room.clearance, np.inf)
    if inside.min() < 0.0:
        return _deepest(room, around, part, float(room.station[int(np.argmin(inside))]))
    least = room.narrowest
    if not part[0] <= least[0] <= part[1]:
        least = _nearest_wall(substring(room.line, *part), around.tree, part[0])
    if least[3] <= CONTACT:  # what is crossed may lie between two stations
        deepest = _deepest(room, around, part, least[0])
        least = min(least, deepest, key=lambda place: place[3])
    as_tight = np.flatnonzero(within & (room.clearance <= least[3] + CONTACT))
    return _at(room, int(as_tight[0])) if len(as_tight) else least  # the first along a wall


def _deepest(
    room: _Room, around: _Surroundings, part: tuple[float, float], station: float
) -> Place:
    """The place about a station of a part of a path that is farthest outside, the first of equal.

    Between the station before and the one after, to less than a millimetre.
    """
    at = int(np.searchsorted(room.station, station))
    ends = room.station[max(at - 1, 0)], room.station[min(at + 1, len(room.station) - 1)]
    low, high = (float(np.clip(end, *part)) for end in ends)
    for _ in range(ROUNDS):
        stations = np.append(np.linspace(low, high, CLOSER + 1), station)
        stations.sort()
        points = room.line.interpolate(stations)
        clearance = around.clearance(points)
        k = int(np.flatnonzero(clearance <= clearance.min() + CONTACT)[0])
        station = float(stations[k])
        low, high = stations[max(k - 1, 0)], stations[min(k + 1, CLOSER + 1)]
    return station, points[k].x, points[k].y, float(clearance[k])


def _at(room: _Room, k: int) -> Place:
    point = room.line.interpolate(room.station[k])
    return float(room.station[k]), point.x, point.y, float(room.clearance[k])


def _nearest_wall(part: Any, tree: shapely.STRtree, first: float = 0.0) -> Place:
    """The point of a part of a path from station ``first`` [m] on that has least room: exact."""
    nearest = tree.geometries[int(tree.query_nearest(part, all_matches=False)[0])]
    place = shapely.get_point(shapely.shortest_line(part, nearest), 0)
    station = first + (float(part.project(place)) if part.length > 0.0 else 0.0)
    return station, place.x, place.y, float(nearest.distance(part))


def _stations(path: FloatArray) -> FloatArray:
    """Evenly spread stations, and those of the waypoints unless there are too many."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    count = int(np.clip(np.ceil(along[-1] / SPACING) + 1, 2, MOST_STATIONS))
    even = np.linspace(0.0, along[-1], count)
    stations = np.union1d(even, along) if len(along) <= MOST_STATIONS else even
    return np.asarray(stations[np.diff(stations, prepend=-1.0) > CONTACT])


def _pieces(lines: list[Any]) -> list[Any]:
    """Polylines cut into segments, which a tree finds faster."""
    pieces: list[Any] = []
    for line in lines:
        points = shapely.get_coordinates(line)
        pieces += list(shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1)))
    return pieces


def _stretches(
    room: _Room, part: tuple[float, float], inscribed: float, circumscribed: float
) -> tuple[Stretch, ...]:
    within = _within(room.station, part)
    stations, clearance = room.station[within], room.clearance[within]
    fits = (clearance > inscribed + CONTACT).astype(int) + (clearance > circumscribed + CONTACT)
    firsts = np.flatnonzero(np.diff(fits, prepend=-1))
    lasts = np.append(firsts[1:], len(fits)) - 1
    return tuple(
        Stretch(first, last, verdict(least, inscribed, circumscribed))
        for first, last, least in zip(
            stations[firsts].tolist(), stations[lasts].tolist(), clearance[firsts].tolist(),
            strict=True,
        )
    )  # fmt: skip
