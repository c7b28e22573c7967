"""Room along a path: its clearance at every station against the radii of the robot.

The clearance of a point is its distance to the nearest boundary or obstacle. With the reference
point on the path, a robot of circumscribed radius R and inscribed radius r (both about that point)
fits at any heading where the clearance exceeds R, at no heading where it is at most r, and between
the two only where it is aligned.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
import shapely

from physim.checking.ground import Ground
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT

SPACING = 0.25
"""[m] from one station of a profile to the next; waypoints are stations too"""
MOST_STATIONS = 2_000
"""Stations of one profile; longer paths have them further apart."""

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
    narrowest: tuple[float, float, float, float]
    """station, x, y and clearance [m] where the path has least room: the exact minimum"""
    stretches: tuple[Stretch, ...]
    safe_distance: float | None
    """[m] L; None where the controller has none"""

    @property
    def verdict(self) -> str:
        """The worst of the path."""
        return verdict(self.narrowest[3], self.inscribed, self.circumscribed)

    @property
    def danger_share(self) -> float | None:
        """Share of the path nearer to a wall than the safe distance; None without one."""
        if self.safe_distance is None:
            return None
        weight = np.gradient(self.station) if len(self.station) > 1 else np.ones(1)
        return float(weight[self.clearance < self.safe_distance].sum() / weight.sum())

    def as_json(self) -> dict[str, Any]:
        """Return the profile as JSON holds it: lengths in metres."""
        station, x, y, clearance = self.narrowest
        return {
            "robot": self.robot,
            "length": float(self.station[-1]),
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


def profile_of(
    number: int,
    name: str,
    path: FloatArray,
    outline: FloatArray,
    ground: Ground,
    safe_distance: float | None,
) -> ClearanceProfile:
    """Clearance along a path (n, 2) [m], of a world whose accessible area is known."""
    line = shapely.LineString(path)
    stations = _stations(path)
    points = line.interpolate(stations)
    shapes = [shape for _, shape in (*ground.walls, *ground.solids)]
    clearance = _distance(points, shapes)
    narrowest = _narrowest(line, shapes)
    if ground.area is not None:
        area = ground.area.polygon
        outside = ~shapely.covers(area, points)
        if outside.any():
            clearance[outside] *= -1.0
            k = int(np.argmin(clearance))
            narrowest = (stations[k], points[k].x, points[k].y, clearance[k])
    r, R = inscribed_radius(outline), circumscribed_radius(outline)
    s, x, y, least = (float(value) for value in narrowest)
    return ClearanceProfile(
        number, name, stations, clearance, r, R, (s, x, y, least),
        _stretches(stations, clearance, r, R), safe_distance,
    )  # fmt: skip


def _stations(path: FloatArray) -> FloatArray:
    """Evenly spread stations, and those of the waypoints unless there are too many."""
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    count = int(np.clip(np.ceil(way[-1] / SPACING) + 1, 2, MOST_STATIONS))
    even = np.linspace(0.0, way[-1], count)
    stations = np.union1d(even, way) if len(way) <= MOST_STATIONS else even
    return np.asarray(stations[np.diff(stations, prepend=-1.0) > CONTACT])


def _distance(points: Any, shapes: list[Any]) -> FloatArray:
    """(K,) [m] from each point to the nearest of the shapes."""
    tree = shapely.STRtree(_pieces(shapes))
    (which, _), distance = tree.query_nearest(points, return_distance=True, all_matches=False)
    found = np.full(len(points), np.inf)
    found[which] = distance
    return found


def _pieces(shapes: list[Any]) -> list[Any]:
    """Long polylines cut into segments, which a tree finds faster; solids as they are."""
    pieces: list[Any] = []
    for shape in shapes:
        if shape.geom_type != "LineString":
            pieces.append(shape)
            continue
        points = shapely.get_coordinates(shape)
        pieces += list(shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1)))
    return pieces


def _narrowest(line: Any, shapes: list[Any]) -> tuple[float, float, float, float]:
    """Station, place and clearance of the point of a path that has least room: exact."""
    nearest = min(shapes, key=lambda shape: float(shape.distance(line)))
    place = shapely.get_point(shapely.shortest_line(line, nearest), 0)
    return line.project(place), place.x, place.y, float(nearest.distance(line))


def _stretches(
    stations: FloatArray, clearance: FloatArray, inscribed: float, circumscribed: float
) -> tuple[Stretch, ...]:
    verdicts = [verdict(float(c), inscribed, circumscribed) for c in clearance]
    found, k = [], 0
    for told, group in groupby(verdicts):
        count = len(list(group))
        found.append(Stretch(float(stations[k]), float(stations[k + count - 1]), told))
        k += count
    return tuple(found)
