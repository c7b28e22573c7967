"""Paths: inside the accessible area, with room for the robot, in order, and long enough."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from shapely.ops import substring

from physim.errors import Location, place_text, plural
from physim.geometry.area import NEAR_EDGE, united
from physim.geometry.corridor import offset_polyline
from physim.geometry.path import SHARPEST_TURN
from physim.geometry.polygon import least_width
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH
from physim.world import Offset
from physim.world.checks.findings import MOST_ALIKE, Diagnostics
from physim.world.checks.room import NOT, ClearanceProfile, inscribed_radius
from physim.world.checks.way import is_ring
from physim.world.faults import describe
from physim.world.layout.shared import Shared
from physim.world.scene import Layout
from physim.world.walls import stretch_text

SHORTEST = 1.0
"""[m] A path or reference path shorter than this is hardly meant."""


def check_paths(laid: Layout, found: Diagnostics) -> set[Location]:
    """Every path lies inside the accessible area, and in the sense of the reference path.

    Keys of those that do not lie inside, or lead through a wall.
    """
    astray: set[Location] = set()
    outside = Shared(laid.area.outside_stretches)
    told: set[Location] = set()
    for i, path in enumerate(laid.paths):
        if laid.path_key(i) in told:
            continue  # the path of others of the group
        told.add(laid.path_key(i))
        if outside is not None:
            lies_inside = _check_inside(laid, i, path, outside(path), found)
            if not (_check_walls_in_the_way(laid, i, path, found) and lies_inside):
                astray.add(laid.path_key(i))
        if isinstance(laid.world.robots[i].path, Offset):
            _check_offset_folds(laid, i, found)
        else:
            _check_sense(laid, i, path, found)
            called = f"the path of {describe(laid.names[i])}"
            _check_turns(path, laid.path_key(i), called, 1, found)
    return astray


def _check_inside(
    laid: Layout, i: int, path: FloatArray, outside: FloatArray, found: Diagnostics
) -> bool:
    """Report the stretches (M, 2) [m] of a path outside the area; whether there are none."""
    if not len(outside):
        return True
    first, last = outside[0]
    more = (
        f" and on {plural(len(outside) - 1, 'more stretch', 'more stretches')}"
        if len(outside) > 1
        else ""
    )
    line = shapely.LineString(path)
    place = f"from {first:.2f} m to {last:.2f} m along it{more}"
    edge = first + NEAR_EDGE if first > 0.0 else last - NEAR_EDGE  # where it goes out, or comes in
    met = [one for one in laid.solids if one[1].covers(line.interpolate(edge))]
    through = met[0][0] if met else None
    stretch = substring(line, first, last)
    solids = united([one for _, one in laid.solids if one.intersects(stretch)])
    if met and stretch.difference(solids).length > LENGTH:
        found.error(
            laid.path_key(i),
            f"the path of {describe(laid.names[i])} leaves the accessible area {place}: {through} "
            "cuts off what lies beyond it; make it smaller or move it, or let the path end there",
        )
    elif through is not None:
        found.warn(
            laid.path_key(i),
            f"the path of {describe(laid.names[i])} leads through {through} {place}; the robot "
            "will have to find a way around it; lead the path around it",
        )
    else:
        found.error(
            laid.path_key(i),
            f"the path of {describe(laid.names[i])} leaves the accessible area {place}; keep it "
            "between the boundaries",
        )
    return False


def _check_walls_in_the_way(laid: Layout, i: int, path: FloatArray, found: Diagnostics) -> bool:
    """Warn of a path through a wall that stands in the accessible area; whether it does not."""
    line = shapely.LineString(path)
    if not line.intersects(laid.area.inner):
        return True
    met = shapely.points(shapely.get_coordinates(line.intersection(laid.area.inner)))
    stations = shapely.line_locate_point(line, met)
    first = int(np.argmin(stations))
    wall = min(laid.walls, key=lambda one: float(one[1].distance(met[first])))[0]
    more = f" and at {plural(len(met) - 1, 'more place')}" if len(met) > 1 else ""
    found.warn(
        laid.path_key(i),
        f"the path of {describe(laid.names[i])} leads through {wall} at "
        f"{place_text(met[first].x, met[first].y)}, {stations[first]:.2f} m along it{more}; the "
        "robot will have to find a way around it; lead the path around it",
    )
    return False


def _check_offset_folds(laid: Layout, i: int, found: Diagnostics) -> None:
    """Warn of a path beside the reference path that runs backwards in a tight bend."""
    path: Any = laid.world.robots[i].path
    offset = path.offset
    beside = offset_polyline(laid.reference, np.full(len(laid.reference), offset))
    legs = np.diff(laid.reference, axis=0)
    along = (np.diff(beside, axis=0) * legs).sum(axis=1)
    turned = along < -LENGTH * np.hypot(*legs.T)  # one that vanishes is no part of the path
    if turned.any():
        x, y = beside[int(np.argmax(turned))]
        found.warn(
            laid.path_key(i),
            f"{offset:g} m to the side, the path of "
            f"{describe(laid.names[i])} runs backwards near {place_text(x, y)}, where the "
            "reference path bends more tightly than that; use a smaller offset, or waypoints of "
            "its own",
        )


def _check_sense(laid: Layout, i: int, path: FloatArray, found: Diagnostics) -> None:
    """Own paths go the way of the reference path, on which the formation measures.

    Without one they may go any way: then it is told of a robot alone that starts near the end.
    """
    reference = shapely.LineString(laid.reference)
    line = shapely.LineString(path)
    if line.length < SHORTEST:
        found.warn(
            laid.path_key(i),
            f"the path of {describe(laid.names[i])} is only {line.length:.4g} m long; lengths are "
            "in metres",
        )
    first, last = (reference.project(shapely.Point(path[k])) for k in (0, -1))
    at = laid.start[i, :2]
    is_begun = bool(np.isfinite(at).all()) and line.project(shapely.Point(at)) < 0.5 * line.length
    is_meant = laid.world.formation is None and is_begun
    if last < first - LENGTH and not is_ring(path) and not is_meant:
        found.warn(
            laid.path_key(i),
            f"the path of {describe(laid.names[i])} runs against the reference path, from station "
            f"{first:.2f} m back to {last:.2f} m; are the waypoints in order?",
        )


def check_reference(laid: Layout, found: Diagnostics) -> None:
    """The reference path goes forward and does not pass through itself."""
    line = laid.reference
    is_corridor = laid.reference_key[0] == "corridor"
    if not is_corridor:  # the walls of a corridor cannot be drawn there, which is reported
        _check_turns(line, laid.reference_key, "the reference path", MOST_ALIKE, found)
        if not shapely.LineString(line).is_simple:
            found.warn(
                laid.reference_key,
                "the reference path crosses or touches itself; a robot near that place may be "
                "projected onto the wrong branch",
            )
    length = float(shapely.LineString(line).length)
    if length < SHORTEST:
        found.warn(
            laid.reference_key,
            f"the reference path is only {length:.4g} m long; lengths are in metres",
        )


def _check_turns(
    line: FloatArray, where: Location, called: str, most: int, found: Diagnostics
) -> None:
    """Warn of the first places, so many at ``most``, where a path turns back on itself."""
    steps = np.diff(line, axis=0)
    steps /= np.hypot(*steps.T)[:, None]
    turn = np.arccos(np.clip((steps[:-1] * steps[1:]).sum(axis=1), -1.0, 1.0))
    back = np.flatnonzero(turn > SHARPEST_TURN)
    for k in back[:most]:
        x, y = line[k + 1]
        left = len(back) - most
        more = f" and at {plural(left, 'more place')}" if most == 1 and left > 0 else ""
        found.warn(
            where,
            f"{called} turns back by {np.degrees(turn[k]):.0f} degrees at {place_text(x, y)}{more}"
            ", where a robot may stand for ever; are the waypoints in order?",
        )


def check_width(laid: Layout, found: Diagnostics) -> set[int]:
    """Refuse a corridor too narrow for robots however they are turned; numbers of those.

    A robot needs the least width of its footprint, a nonconvex one at least the diameter of its
    inscribed circle. Reported once, where the width stands.
    """
    centreline, widths = laid.centreline, laid.widths
    if centreline is None or widths is None:
        return set()
    k = int(np.argmin(widths))
    width = float(widths[k])
    narrowest = Shared(_narrowest_gap)
    needed = {number: narrowest(outline) for number, outline in enumerate(laid.footprints)}
    too_wide = {number for number, gap in needed.items() if gap >= width - CONTACT}
    if too_wide:
        worst = max(sorted(too_wide), key=lambda number: needed[number])
        more = f", and {len(too_wide) - 1} more do not fit either" if len(too_wide) > 1 else ""
        x, y = centreline[k]
        is_listed = isinstance(getattr(laid.world.corridor, "width", None), tuple)
        found.error(
            ("corridor", "width", k) if is_listed else ("corridor", "width"),
            f"{width:.4g} m at {place_text(x, y)} is too narrow: {describe(laid.names[worst])}"
            f" needs more than {needed[worst]:.4g} m however it is turned{more}; widen the "
            "corridor, or make the robots smaller",
        )
    return too_wide


def _narrowest_gap(outline: FloatArray) -> float:
    """Width [m] that a corridor must exceed for a robot to get through: never too large."""
    hull = shapely.Polygon(outline).convex_hull
    is_convex = hull.area <= shapely.Polygon(outline).area * (1.0 + 1e-9)
    return least_width(outline) if is_convex else 2.0 * inscribed_radius(outline)


def check_room(
    laid: Layout,
    profiles: tuple[ClearanceProfile, ...],
    astray: set[Location],
    found: Diagnostics,
) -> None:
    """Report paths so close to a wall that the robot fits there at no heading.

    An error where the controller follows the path itself; a warning where it keeps a safe distance
    and moves the target into the safe area, or where an obstacle is in the way. Robots that share
    a path are reported once. What of ``astray`` (`check_paths`) touches a wall is reported already.
    """
    together: dict[tuple[float, ...], list[ClearanceProfile]] = {}
    for profile in profiles:
        is_told = laid.path_key(profile.number) in astray and profile.narrowest[3] <= CONTACT
        if profile.verdict == NOT and not is_told:
            together.setdefault(profile.narrowest, []).append(profile)
    for (station, x, y, clearance), group in together.items():
        point = shapely.Point(x, y)
        near = [(s.distance(point), name, s) for name, s in (*laid.walls, *laid.solids)]
        _, name, wall = min(near, key=lambda one: one[:2])
        foot = shapely.get_coordinates(shapely.shortest_line(wall, point))[0]
        at = stretch_text(laid.world.boundaries, name, foot)
        first = group[0]
        others = f", shared with {len(group) - 1} more," if len(group) > 1 else ","
        message = (
            f"{describe(first.robot)} does not fit at station {station:.2f} m of "
            f"its path{others} at {place_text(x, y)}: {clearance:.4g} m to {name} {at}, while the "
            f"footprint reaches {first.inscribed:.4g} m from the reference point even at its "
            "narrowest"
        )
        where = laid.path_key(first.number)
        if first.safe_distance is not None:
            found.warn(
                where,
                f"{message}; the controller leads it through the safe area, "
                f"{first.safe_distance:.4g} m from the boundaries, where there is one",
            )
        elif any(name == wall for wall, _ in laid.walls):
            found.error(where, f"{message}; lead the path further away, or widen the place")
        else:
            found.warn(where, f"{message}; lead the path further away")


def check_passage(laid: Layout, profiles: tuple[ClearanceProfile, ...], found: Diagnostics) -> None:
    """Refuse a robot that cannot get from its start to its stop, whatever way it takes.

    It cannot where the area less a margin of its inscribed radius falls apart between the two: no
    point of it that keeps this distance from the walls leads from one to the other.
    """
    known: dict[float, list[object]] = {}
    faulty = {fault.location[:2] for fault in found.errors}
    for profile in profiles:
        if laid.world.entry_of(profile.number) in faulty:
            continue
        r = profile.inscribed
        if r not in known:
            room = laid.area.shrunk(r, 8)
            known[r] = [part for part in shapely.get_parts(room) if not part.is_empty]
        path, position = laid.paths[profile.number], laid.start[profile.number, :2]
        begin = path[0] if np.isnan(position).any() else position
        stop = shapely.LineString(path).interpolate(profile.reached[1])
        ends = [shapely.Point(begin), stop]
        rooms = [_part_of(known[r], end) for end in ends]
        if rooms[0] is None or rooms[0] != rooms[1]:
            found.error(
                laid.path_key(profile.number),
                f"no route leads {describe(profile.robot)} from its start to its stop: "
                f"somewhere the free space is narrower than {2.0 * r:.4g} m, the least that the "
                "robot can pass; widen the place, or make the robot smaller",
            )


def _part_of(parts: list[object], point: shapely.Point) -> int | None:
    """Number of the part nearest to a point; None without any."""
    if not parts:
        return None
    return int(np.argmin(shapely.distance(parts, point)))
