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
from shapely.ops import substring

from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT
from physim.world.checks.stations import lines_of, spans
from physim.world.ground.area import united
from physim.world.ground.polyline import Polyline
from physim.world.layout.robots import shared
from physim.world.scene import Layout

SPACING = 0.25
"""[m] from one station of a profile to the next; waypoints are stations too"""
MOST_STATIONS = 2_000
"""Stations of one profile; longer paths have them further apart."""

Place = tuple[float, float, float, float]
"""Station, x, y and clearance [m] of a point of a path"""

ANY, ALIGNED, NOT = "fits at any heading", "fits only aligned", "does not fit"


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
    """where this part of the path has least room; outside the area the deepest station"""

    @property
    def verdict(self) -> str:
        """The worst of the part judged; touching does not fit."""
        if self.narrowest[3] > self.circumscribed + CONTACT:
            return ANY
        return ALIGNED if self.narrowest[3] > self.inscribed + CONTACT else NOT

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
            "station": [round(float(s), 6) for s in self.station],
            "clearance": [round(float(c), 6) for c in self.clearance],
        }


def inscribed_radius(outline: FloatArray) -> float:
    """Distance [m] of the reference point from the outline; 0 when it is not inside."""
    shape, origin = shapely.Polygon(outline), shapely.Point(0.0, 0.0)
    return float(shape.exterior.distance(origin)) if shape.covers(origin) else 0.0


def clearance_profiles(laid: Layout) -> tuple[ClearanceProfile, ...]:
    """Room along the path of each robot; a path that several robots share is looked at once.

    Of obstacles that overlap the outline is that of all together.
    """
    solid = united([shape for _, shape in laid.solids]).boundary
    lines = [*(shape for _, shape in laid.walls), *shapely.get_parts(solid)]
    points = [shapely.get_coordinates(line) for line in lines]
    pieces = np.concatenate([np.stack([one[:-1], one[1:]], axis=1) for one in points])
    tree = shapely.STRtree(shapely.linestrings(pieces))
    inner, outer = (shared(of, laid.footprints) for of in (inscribed_radius, circumscribed_radius))
    rooms: dict[int, tuple[FloatArray, FloatArray]] = {}
    least: dict[tuple[int, float, float], Place] = {}
    profiles = []
    for i, (line, span) in enumerate(zip(lines_of(laid), spans(laid).tolist(), strict=True)):
        key, last = id(line), span[1]
        first = min(span[0], last)
        if key not in rooms:
            station = _stations(line)
            rooms[key] = station, _clearance(line.interpolate(station), tree, laid.area.polygon)
        if (key, first, last) not in least:
            least[key, first, last] = _narrowest(line, *rooms[key], tree, first, last)
        profiles.append(
            ClearanceProfile(
                i, laid.names[i], *rooms[key], inner[i], outer[i], (first, last),
                least[key, first, last],
            )
        )  # fmt: skip
    return tuple(profiles)


def _stations(line: Any) -> FloatArray:
    """Evenly spread stations, and those of the waypoints unless there are too many."""
    along = Polyline(line.coords).station
    count = int(np.clip(np.ceil(along[-1] / SPACING) + 1, 2, MOST_STATIONS))
    even = np.linspace(0.0, along[-1], count)
    stations = np.union1d(even, along) if len(along) <= MOST_STATIONS else even
    return np.asarray(stations[np.diff(stations, prepend=-1.0) > CONTACT])


def _clearance(points: Any, tree: shapely.STRtree, area: Any) -> FloatArray:
    """(K,) [m] of points (K,) to the nearest wall; negative outside the accessible area."""
    clearance = tree.query_nearest(points, return_distance=True, all_matches=False)[1]
    signed = np.where(shapely.covers(area, points), clearance, -clearance)
    return np.asarray(signed + 0.0)  # no -0.0


def _narrowest(
    line: Any,
    station: FloatArray,
    clearance: FloatArray,
    tree: shapely.STRtree,
    first: float,
    last: float,
) -> Place:
    """The place of a part of a path that has least room: the exact minimum, the first of equal."""
    part = substring(line, first, last)
    nearest = tree.geometries[int(tree.query_nearest(part, all_matches=False)[0])]
    place, room = shapely.get_point(shapely.shortest_line(part, nearest), 0), part.distance(nearest)
    at = first + (float(part.project(place)) if part.length > 0.0 else 0.0)
    inside = (station >= first - CONTACT) & (station <= last + CONTACT)
    seen = np.where(inside, clearance, np.inf)
    if seen.min() <= room + CONTACT:  # along a wall, or outside
        k = int(np.flatnonzero(seen <= seen.min() + CONTACT)[0])
        at, room, place = float(station[k]), float(seen[k]), line.interpolate(station[k])
    return at, place.x, place.y, float(room)
