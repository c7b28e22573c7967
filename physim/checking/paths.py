"""Paths: inside the accessible area, with room for the robot, in order, and long enough."""

from __future__ import annotations

import numpy as np
import shapely

from physim.checking.clearance import (
    NOT,
    ClearanceProfile,
    Ways,
    inscribed_radius,
    profile_of,
)
from physim.checking.ground import Ground
from physim.checking.sketch import RobotSketch, Sketch
from physim.checking.telling import MOST_ALIKE, Told
from physim.errors import Location, plural
from physim.geometry.corridor import SHARPEST_TURN, offset_polyline
from physim.geometry.polygon import least_width
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH
from physim.world.faults import shown

SHORTEST = 1.0
"""[m] A path or reference path shorter than this is hardly meant."""


def own_paths(sketch: Sketch, told: Told) -> dict[int, FloatArray]:
    """Waypoints (n, 2) [m] of every sound path, by number of the robot."""
    paths: dict[int, FloatArray] = {}
    is_told = False
    for robot in sketch.robots:
        if robot.path is not None:
            paths[robot.number] = robot.path
        elif robot.offset is not None and sketch.reference is not None:
            sideways = np.full(len(sketch.reference), robot.offset)
            try:
                paths[robot.number] = offset_polyline(sketch.reference, sideways)
            except ValueError as error:
                if not is_told:  # the same waypoint for all robots
                    where: Location = ("robots", robot.number, "path", "offset")
                    told.error(where, f"the reference path {error}")
                is_told = True
    return paths


def check_paths(sketch: Sketch, paths: dict[int, FloatArray], ground: Ground, told: Told) -> None:
    """Every path lies inside the accessible area, and in the sense of the reference path."""
    for number, path in paths.items():
        robot = sketch.robots[number]
        _check_inside(robot, path, ground, told)
        _check_offset_folds(sketch, robot, path, told)
        _check_sense(sketch, robot, path, told)


def path_key(robot: RobotSketch) -> Location:
    """Where the path of a robot stands."""
    where: Location = ("robots", robot.number, "path")
    return where if robot.offset is None else (*where, "offset")


def _check_inside(robot: RobotSketch, path: FloatArray, ground: Ground, told: Told) -> None:
    if ground.area is None:
        return
    outside = ground.area.outside_stretches(path)
    if not len(outside):
        return
    first, last = outside[0]
    more = (
        f" and on {plural(len(outside) - 1, 'more stretch', 'more stretches')}"
        if len(outside) > 1
        else ""
    )
    line = shapely.LineString(path)
    middle = line.interpolate((first + last) / 2.0)
    place = f"from {first:.2f} m to {last:.2f} m along it{more}"
    through = next((name for name, solid in ground.solids if solid.covers(middle)), None)
    if through is not None:
        told.warn(
            path_key(robot),
            f"the path of {shown(robot.name)} leads through {through} {place}; the robot will "
            "have to find its way round; lead the path round it",
        )
    else:
        told.error(
            path_key(robot),
            f"the path of {shown(robot.name)} leaves the accessible area {place}; keep it "
            "between the boundaries",
        )


def _check_offset_folds(sketch: Sketch, robot: RobotSketch, path: FloatArray, told: Told) -> None:
    """Warn of a path beside the reference path that runs backwards in a tight bend."""
    if robot.offset is None or sketch.reference is None:
        return
    turned = (np.diff(path, axis=0) * np.diff(sketch.reference, axis=0)).sum(axis=1) <= 0.0
    if turned.any():
        x, y = path[int(np.argmax(turned))]
        told.warn(
            path_key(robot),
            f"{robot.offset:g} m to the side, the path of {shown(robot.name)} runs backwards near "
            f"({x:.6g}, {y:.6g}), where the reference path bends more tightly than that; use a "
            "smaller offset, or waypoints of its own",
        )


def _check_sense(sketch: Sketch, robot: RobotSketch, path: FloatArray, told: Told) -> None:
    """Own paths go the way of the reference path, on which the formation measures."""
    if sketch.reference is None or robot.offset is not None:
        return
    reference = shapely.LineString(sketch.reference)
    line = shapely.LineString(path)
    if line.length < SHORTEST:
        told.warn(
            path_key(robot),
            f"the path of {shown(robot.name)} is only {line.length:.4g} m long; lengths are in "
            "metres",
        )
    first, last = (reference.project(shapely.Point(path[k])) for k in (0, -1))
    if last < first - LENGTH and not _is_ring(path):
        told.warn(
            path_key(robot),
            f"the path of {shown(robot.name)} runs against the reference path, from station "
            f"{first:.2f} m back to {last:.2f} m; are the waypoints in order?",
        )


def _is_ring(path: FloatArray) -> bool:
    return float(np.hypot(*(path[0] - path[-1]))) < SHORTEST


def check_reference(sketch: Sketch, told: Told) -> None:
    """The reference path goes forward and does not pass through itself."""
    line = sketch.reference
    if line is None:
        return
    steps = np.diff(line, axis=0)
    steps /= np.hypot(*steps.T)[:, None]
    turn = np.arccos(np.clip((steps[:-1] * steps[1:]).sum(axis=1), -1.0, 1.0))
    is_corridor = sketch.reference_key[0] == "corridor"
    if not is_corridor:  # the walls of a corridor cannot be drawn there, which is told
        for k in np.flatnonzero(turn > SHARPEST_TURN)[:MOST_ALIKE]:
            x, y = line[k + 1]
            told.warn(
                sketch.reference_key,
                f"the reference path turns back by {np.degrees(turn[k]):.0f} degrees at "
                f"({x:.6g}, {y:.6g}); are the waypoints in order?",
            )
        if not shapely.LineString(line).is_simple:
            told.warn(
                sketch.reference_key,
                "the reference path crosses or touches itself; a robot near that place may be "
                "counted on the wrong branch",
            )
    length = float(shapely.LineString(line).length)
    if length < SHORTEST:
        told.warn(
            sketch.reference_key,
            f"the reference path is only {length:.4g} m long; lengths are in metres",
        )


def profiles_of(
    sketch: Sketch,
    paths: dict[int, FloatArray],
    outlines: dict[int, FloatArray],
    ground: Ground,
    safe_distance: float | None,
) -> tuple[ClearanceProfile, ...]:
    """Room along the path of each robot whose path and footprint are sound."""
    if not ground.walls and not ground.solids:
        return ()
    ways = Ways(ground)
    return tuple(
        profile_of(
            number, sketch.robots[number].name, ways.along(path), outlines[number], safe_distance
        )
        for number, path in paths.items()
        if number in outlines
    )


def check_width(sketch: Sketch, outlines: dict[int, FloatArray], told: Told) -> set[int]:
    """Refuse a corridor too narrow for robots however they are turned; numbers of those.

    A robot needs the least width of its footprint, a nonconvex one at least the diameter of its
    inscribed circle. Told once, where the width stands.
    """
    if sketch.width is None or sketch.centreline is None:
        return set()
    k = int(np.argmin(sketch.width))
    width = float(sketch.width[k])
    needed = {number: _narrowest_gap(outline) for number, outline in outlines.items()}
    too_wide = {number for number, gap in needed.items() if gap >= width - CONTACT}
    if too_wide:
        worst = max(sorted(too_wide), key=lambda number: needed[number])
        more = f", and {len(too_wide) - 1} more do not fit either" if len(too_wide) > 1 else ""
        x, y = sketch.centreline[k]
        told.error(
            ("corridor", "width", k) if sketch.is_width_listed else ("corridor", "width"),
            f"{width:.4g} m at ({x:.6g}, {y:.6g}) is too narrow: {shown(sketch.robots[worst].name)}"
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
    sketch: Sketch, profiles: tuple[ClearanceProfile, ...], ground: Ground, told: Told
) -> None:
    """Tell of paths so close to a wall that the robot fits there at no heading.

    An error where the controller follows the path itself; a warning where it keeps a safe distance
    and moves the target into the safe area, or where an obstacle is in the way. Robots that share
    a path are told once.
    """
    together: dict[tuple[float, ...], list[ClearanceProfile]] = {}
    for profile in profiles:
        # outside the area, or on a wall: told as a path that leaves the area
        if profile.verdict == NOT and profile.narrowest[3] > CONTACT:
            together.setdefault(profile.narrowest, []).append(profile)
    for (station, x, y, clearance), group in together.items():
        point = shapely.Point(x, y)
        near = [(s.distance(point), name) for name, s in (*ground.walls, *ground.solids)]
        name = min(near)[1]
        first = group[0]
        others = f", shared with {len(group) - 1} more," if len(group) > 1 else ","
        message = (
            f"{shown(sketch.robots[first.number].name)} does not fit at station {station:.2f} m of "
            f"its path{others} at ({x:.6g}, {y:.6g}): {clearance:.4g} m to {name}, while the "
            f"footprint reaches {first.inscribed:.4g} m from the reference point even at its "
            "narrowest"
        )
        where = path_key(sketch.robots[first.number])
        if first.safe_distance is not None:
            told.warn(
                where,
                f"{message}; the controller leads it through the safe area, "
                f"{first.safe_distance:.4g} m from the boundaries, where there is one",
            )
        elif any(name == wall for wall, _ in ground.walls):
            told.error(where, f"{message}; lead the path further away, or widen the place")
        else:
            told.warn(where, f"{message}; lead the path further away")


def check_passage(
    sketch: Sketch,
    paths: dict[int, FloatArray],
    profiles: tuple[ClearanceProfile, ...],
    ground: Ground,
    told: Told,
) -> None:
    """Refuse a robot that cannot get from one end of its path to the other, whatever way it takes.

    It cannot where the area less a margin of its inscribed radius falls apart between the two
    ends: no point of it that keeps this distance from the walls leads from one to the other.
    """
    if ground.area is None:
        return
    known: dict[float, list[object]] = {}
    faulty = {fault.location[:2] for fault in told.errors}
    for profile in profiles:
        if ("robots", profile.number) in faulty:
            continue
        r = profile.inscribed
        if r not in known:
            room = ground.area.polygon.buffer(-r, quad_segs=8)
            known[r] = [part for part in shapely.get_parts(room) if not part.is_empty]
        robot = sketch.robots[profile.number]
        path = paths[profile.number]
        ends = [shapely.Point(path[0]), shapely.Point(path[-1])]
        if robot.position is not None:
            ends[0] = shapely.Point(robot.position)
        rooms = [_part_of(known[r], end) for end in ends]
        if rooms[0] is None or rooms[0] != rooms[1]:
            told.error(
                path_key(robot),
                f"there is no way for {shown(robot.name)} from its start to the end of its path: "
                f"somewhere the room is narrower than {2.0 * r:.4g} m, the narrowest that the "
                "robot can pass; widen the place, or make the robot smaller",
            )


def _part_of(parts: list[object], point: shapely.Point) -> int | None:
    """Number of the part nearest to a point; None without any."""
    if not parts:
        return None
    return int(np.argmin(shapely.distance(parts, point)))
