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
from numpy.typing import NDArray

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
        return self.share(self.clearance < self.safe_distance)

    def share(self, where: NDArray[np.bool_]) -> float:
        """Share of the path at whose stations something holds, ``where`` (K,)."""
        weight = np.gradient(self.station) if len(self.station) > 1 else np.ones(1)
        return float(weight[where].sum() / weight.sum())

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


@dataclass(frozen=True)
class Way:
    """Room along a path, whoever takes it: K stations."""

    station: FloatArray
    """(K,) [m]"""
    clearance: FloatArray
    """(K,) [m]; negative outside the accessible area"""
    narrowest: tuple[float, float, float, float]
    """station, x, y and clearance [m]"""


class Ways:
    """Room along paths of one world; a path that several robots share is looked at once."""

    def __init__(self, ground: Ground) -> None:
        self._area = ground.area
        self._pieces = _pieces([shape for _, shape in (*ground.walls, *ground.solids)])
        self._tree = shapely.STRtree(self._pieces)
        self._known: dict[bytes, Way] = {}

    def along(self, path: FloatArray) -> Way:
        """Room along a path (n, 2) [m]."""
        key = path.tobytes()
        if key not in self._known:
            self._known[key] = self._look(path)
        return self._known[key]

    def _look(self, path: FloatArray) -> Way:
        line = shapely.LineString(path)
        stations = _stations(path)
        points = line.interpolate(stations)
        found = self._tree.query_nearest(points, return_distance=True, all_matches=False)
        clearance = np.full(len(points), np.inf)
        clearance[found[0][0]] = found[1]
        narrowest = self._narrowest(line)
        if self._area is not None:
            outside = ~shapely.covers(self._area.polygon, points)
            if outside.any():
                clearance[outside] *= -1.0
                k = int(np.argmin(clearance))
                narrowest = (stations[k], points[k].x, points[k].y, clearance[k])
        s, x, y, least = (float(value) for value in narrowest)
        return Way(stations, clearance, (s, x, y, least))

    def _narrowest(self, line: Any) -> tuple[float, float, float, float]:
        """Station, place and clearance of the point of a path that has least room: exact."""
        k = int(self._tree.query_nearest(line, all_matches=False)[0])
        nearest = self._pieces[k]
        place = shapely.get_point(shapely.shortest_line(line, nearest), 0)
        return line.project(place), place.x, place.y, float(nearest.distance(line))


def profile_of(
    number: int, name: str, way: Way, outline: FloatArray, safe_distance: float | None
) -> ClearanceProfile:
    """Room along a path against the radii of the robot that takes it."""
    r, R = inscribed_radius(outline), circumscribed_radius(outline)
    stretches = _stretches(way.station, way.clearance, r, R)
    return ClearanceProfile(
        number, name, way.station, way.clearance, r, R, way.narrowest, stretches, safe_distance
    )


def _stations(path: FloatArray) -> FloatArray:
    """Evenly spread stations, and those of the waypoints unless there are too many."""
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    count = int(np.clip(np.ceil(way[-1] / SPACING) + 1, 2, MOST_STATIONS))
    even = np.linspace(0.0, way[-1], count)
    stations = np.union1d(even, way) if len(way) <= MOST_STATIONS else even
    return np.asarray(stations[np.diff(stations, prepend=-1.0) > CONTACT])


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
