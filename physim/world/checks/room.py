"""Room along a path: its clearance at every station against the radii of the robot, and against
what the controller keeps from the boundaries.

The clearance of a point is its distance to the nearest boundary or obstacle. With the reference
point on the path, a robot of circumscribed radius R and inscribed radius r (both about that point)
fits at any heading where the clearance exceeds R, at no heading where it is at most r, and between
the two only where it is aligned. Where a path has less room than the controller keeps, its robot
never leaves danger mode.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.errors import ControllerError, plural
from physim.geometry.area import Area, shrunk
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.parts.registry import settings_model
from physim.tolerances import CONTACT
from physim.world.checks.findings import Diagnostics
from physim.world.faults import describe
from physim.world.layout.layout import PartialLayout
from physim.world.layout.shared import Shared

SPACING = 0.25
"""[m] from one station of a profile to the next; waypoints are stations too"""
MOST_STATIONS = 2_000
"""Stations of one profile; longer paths have them further apart."""

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
    narrowest: Place
    """where the path has least room: the exact minimum"""
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


def clearance_profiles(
    laid: PartialLayout, safe_distance: float | None
) -> tuple[ClearanceProfile, ...]:
    """Room along the path of each robot whose path and footprint are sound.

    A path that several robots share is looked at once.
    """
    if not laid.walls and not laid.solids:
        return ()
    tree = shapely.STRtree(_pieces([shape for _, shape in (*laid.walls, *laid.solids)]))
    room_along = Shared(lambda path: _room_along(path, tree, laid.area))
    radii = Shared(lambda outline: (inscribed_radius(outline), circumscribed_radius(outline)))
    stretches: dict[tuple[int, float, float], tuple[Stretch, ...]] = {}
    profiles = []
    for i, path in laid.paths.items():
        if i not in laid.footprints:
            continue
        station, clearance, narrowest = room_along(path)
        r, R = radii(laid.footprints[i])
        key = (id(path), r, R)
        if key not in stretches:
            stretches[key] = _stretches(station, clearance, r, R)
        profiles.append(
            ClearanceProfile(
                i, laid.names[i], station, clearance, r, R, narrowest, stretches[key], safe_distance
            )
        )
    return tuple(profiles)


def _room_along(
    path: FloatArray, tree: shapely.STRtree, area: Area | None
) -> tuple[FloatArray, FloatArray, Place]:
    """Stations (K,), clearances (K,) and the narrowest place of a path (n, 2) [m]."""
    line = shapely.LineString(path)
    stations = _stations(path)
    points = line.interpolate(stations)
    found = tree.query_nearest(points, return_distance=True, all_matches=False)
    clearance = np.full(len(points), np.inf)
    clearance[found[0][0]] = found[1]
    narrowest = _narrowest(line, tree)
    if area is not None:
        outside = ~shapely.covers(area.polygon, points)
        if outside.any():
            clearance[outside] *= -1.0
            k = int(np.argmin(clearance))
            narrowest = (stations[k], points[k].x, points[k].y, clearance[k])
    s, x, y, least = (float(value) for value in narrowest)
    return stations, clearance, (s, x, y, least)


def _narrowest(line: Any, tree: shapely.STRtree) -> Place:
    """The point of a path that has least room: exact."""
    nearest = tree.geometries[int(tree.query_nearest(line, all_matches=False)[0])]
    place = shapely.get_point(shapely.shortest_line(line, nearest), 0)
    return line.project(place), place.x, place.y, float(nearest.distance(line))


def _stations(path: FloatArray) -> FloatArray:
    """Evenly spread stations, and those of the waypoints unless there are too many."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    count = int(np.clip(np.ceil(along[-1] / SPACING) + 1, 2, MOST_STATIONS))
    even = np.linspace(0.0, along[-1], count)
    stations = np.union1d(even, along) if len(along) <= MOST_STATIONS else even
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


NEARLY_ALL = 0.95
"""Share of a path over which a robot in danger is taken never to leave danger mode"""


def setting(laid: PartialLayout, controller: type[Any] | None, key: str) -> float | None:
    """A length among the controller's settings [m]: as set, else its default; None without one."""
    try:
        model = settings_model(controller) if controller is not None else None
    except ControllerError:
        return None
    field = model.model_fields.get(key) if model is not None else None
    if field is None or laid.world.controller is None:
        return None
    value = laid.world.controller.settings.get(key, field.default)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and 1e-9 <= value <= 1e6 else None


def check_safe_area(laid: PartialLayout, safe_distance: float | None, found: Diagnostics) -> None:
    """Warn where no place is as far from the boundaries as the controller wants to be."""
    if laid.area is None or safe_distance is None:
        return
    if shrunk(laid.area.polygon, safe_distance, 4).is_empty:
        found.warn(
            ("controller", "safe_distance"),
            f"no place is {safe_distance:.4g} m from every boundary, so there is no safe area; "
            f"the largest distance is {_largest_distance(laid.area):.4g} m; widen the corridor, or "
            "set safe_distance below that",
        )


def check_always_danger(
    profiles: tuple[ClearanceProfile, ...], threshold: float | None, found: Diagnostics
) -> None:
    """Warn of a distance threshold [m] for boundaries that is beyond the room beside the paths.

    A robot on its path, or led away from the walls to the safe distance, reaches them up to its
    inscribed radius at least: never too large, so that the warning is never without need.
    """
    if threshold is None:
        return
    always: list[tuple[float, ClearanceProfile]] = []
    for profile in profiles:
        if profile.inscribed <= 0.0:
            continue  # the reference point may lie outside the footprint
        room = np.maximum(profile.clearance, profile.safe_distance or 0.0) - profile.inscribed
        if profile.share(room < threshold) >= NEARLY_ALL:
            always.append((float(room.max()), profile))
    if not always:
        return
    room_there, first = max(always, key=lambda pair: pair[0])
    others = f", {plural(len(always) - 1, 'other robot')} no more" if len(always) > 1 else ""
    found.warn(
        ("controller", "boundary_low"),
        f"below {threshold:.4g} m from a boundary a robot is in danger mode, and "
        f"{describe(first.robot)} has at most {room_there:.4g} m beside it on "
        f"its path{others}: it would not leave danger mode and may never arrive; set "
        "boundary_low below that, or widen the road",
    )


def check_turning_room(
    laid: PartialLayout, profiles: tuple[ClearanceProfile, ...], found: Diagnostics
) -> None:
    """Warn of paths in the danger area, where no place of the safe area lets the robot turn."""
    if laid.area is None:
        return
    largest: float | None = None
    tight = []
    for profile in profiles:
        if profile.safe_distance is None or (profile.danger_share or 0.0) < NEARLY_ALL:
            continue
        largest = _largest_distance(laid.area) if largest is None else largest
        if profile.safe_distance <= largest < profile.safe_distance + profile.circumscribed:
            tight.append(profile)
    if not tight or largest is None:
        return
    first = tight[0]
    others = f" (of {plural(len(tight) - 1, 'more robot')} too)" if len(tight) > 1 else ""
    found.warn(
        laid.path_key(first.number),
        f"the path of {describe(first.robot)}{others} lies in the danger area, "
        f"less than {first.safe_distance:.4g} m from a wall, over {first.danger_share:.0%} of its "
        f"length, and no place is more than {largest:.4g} m from the walls, too little to turn "
        f"in the safe area, which takes {first.circumscribed:.4g} m more than the safe distance: "
        "the robot may come to a standstill; lead the path along the middle, or widen the road",
    )


def _largest_distance(area: Area) -> float:
    """Largest distance [m] that a place of the accessible area has from the boundaries."""
    return float(shapely.maximum_inscribed_circle(area.polygon, tolerance=1e-3).length)
