"""Robots at the start as they are seldom meant, and numbers that are valid but out of scale.

Millimetres, degrees, speeds nobody drives; starts with the back to the path.
"""

from __future__ import annotations

from math import pi, radians
from typing import Any

import numpy as np
import shapely

from physim.errors import Location
from physim.geometry.outline import placed_outline
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world import Corridor, World
from physim.world.checks.findings import MOST_ALIKE, Diagnostics
from physim.world.faults import describe
from physim.world.layout.shape_checks import Placed
from physim.world.layout.shared import Shared
from physim.world.number_hints import in_metres
from physim.world.scene import Layout


def check_footprints(laid: Layout, found: Diagnostics) -> None:
    """Warn of footprints that do not hold the point about which their robot turns."""
    away = Shared(
        lambda outline: shapely.Polygon(outline).convex_hull.distance(shapely.Point(0.0, 0.0))
    )
    for i, outline in enumerate(laid.footprints):
        far = away(outline)
        if far > LENGTH:
            found.warn(
                (*laid.world.entry_of(i), "footprint"),
                f"the reference point (0, 0), about which the robot turns and which follows the "
                f"path, lies {far:.4g} m outside the footprint; corners are given "
                "relative to that point",
            )


def check_expected(laid: Layout, found: Diagnostics) -> None:
    """Warn of distances to others, or to a wall or obstacle, that are not kept at the start."""
    expect = laid.world.expect
    placed = []
    for i in range(len(laid.footprints)):
        pose = laid.world.robots[i].pose
        if not (pose is not None and pose[2] == "random"):
            placed.append(i)
    if expect is None:
        return
    shapes = [placed_outline(laid.footprints[i], laid.start[i]) for i in placed]
    if expect.min_boundary_distance is not None:
        _check_near_walls(laid, placed, shapes, expect.min_boundary_distance, found)
    if len(placed) < 2:
        return

    def told(key: str, one: int, other: int, gap: float, than: str) -> None:
        """Warn of two that are so far [m] apart."""
        names = (describe(laid.names[placed[k]]) for k in (one, other))
        message = f"{' and '.join(names)} are {gap:.4g} m apart at the start, which is {than}"
        found.warn(("expect", key), message)

    if (least := expect.min_distance) is not None:
        near = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=least)
        one, other = near[:, near[0] < near[1]]
        gaps = shapely.distance(np.array(shapes)[one], np.array(shapes)[other])
        k = int(np.argmin(gaps)) if len(gaps) else 0
        if len(gaps) and gaps[k] < least - LENGTH:
            told("min_distance", one[k], other[k], gaps[k], f"less than {least:.6g} m")
    if (most := expect.max_distance) is not None:
        one, other = _far_apart(laid.start[placed, :2])
        gap = shapely.distance(shapes[one], shapes[other])
        if gap > most + LENGTH:
            told("max_distance", one, other, gap, f"more than {most:.6g} m")


def _check_near_walls(
    laid: Layout, placed: list[int], shapes: list[Any], least: float, found: Diagnostics
) -> None:
    around = [*laid.walls, *laid.solids]
    tree = shapely.STRtree([shape for _, shape in around])
    pairs, gaps = tree.query_nearest(shapes, all_matches=False, return_distance=True)
    if not len(gaps) or gaps.min() >= least - LENGTH:
        return
    k = int(np.argmin(gaps))
    found.warn(
        ("expect", "min_boundary_distance"),
        f"{describe(laid.names[placed[pairs[0, k]]])} is {gaps[k]:.4g} m from "
        f"{around[pairs[1, k]][0]} at the start, which is less than {least:.6g} m",
    )


def _far_apart(places: FloatArray) -> tuple[int, int]:
    """Which two of at least two places (n, 2) are farthest apart: two corners of their hull."""
    corners = shapely.get_coordinates(shapely.MultiPoint(places).convex_hull)
    apart = np.hypot(*(corners[:, None] - corners).transpose(2, 0, 1))
    pair = corners[list(np.unravel_index(np.argmax(apart), apart.shape))]
    one, other = (int(np.argmin(np.hypot(*(places - corner).T))) for corner in pair)
    return (one, other) if one < other else (other, one)


def check_start_used(world: World | None, found: Diagnostics) -> None:
    """Warn of a region of the world's in which no robot starts."""
    if world is None or world.start is None:
        return
    if all(world.start_of(i) is not world.start for i in range(len(world.robots))):
        found.warn(
            ("start",),
            "no robot starts in this region, as each has a pose or a region of its own; remove the "
            "pose of those that the seed should place, or remove start",
        )


def is_drawn(laid: Layout, i: int) -> bool:
    """Whether a robot has no heading written: it is random, or there is no pose."""
    pose = laid.world.robots[i].pose
    return pose is None or pose[2] == "random"


def check_random_headings(laid: Layout, found: Diagnostics) -> None:
    """Warn where another seed may let a robot with a random heading start in contact.

    Judged by the circle that the robot sweeps when it turns on the spot: no false comfort, but a
    warning may be too cautious for a long robot.
    """
    posed = [i for i in range(len(laid.footprints)) if laid.world.robots[i].pose is not None]
    random = {i for i in posed if is_drawn(laid, i)}
    if not random:
        return
    turning = [
        Placed(i, laid.names[i], _circle(laid.start[i], outline))
        if i in random
        else Placed(i, laid.names[i], placed_outline(outline, laid.start[i]))
        for i, outline in enumerate(laid.footprints)
    ]
    others = [*laid.walls, *laid.solids]
    tree = shapely.STRtree([*(shape for _, shape in others), *(p.shape for p in turning)])
    names = [*(name for name, _ in others), *(describe(p.name) for p in turning)]
    shapes = [p.shape for p in turning]
    met: dict[int, str] = {}
    for i, k in np.transpose(tree.query(shapes, predicate="intersects")):
        robot = turning[i]
        itself = k == len(others) + i
        if robot.number in random and not itself:
            met.setdefault(robot.number, names[k])
    for index, name in sorted(met.items()):
        found.warn(
            (*laid.world.entry_of(index), "pose", 2),
            f"random; with this seed {describe(laid.names[index])} starts clear, with another "
            f"it may touch {name}; leave room to turn, or write a heading",
        )


def _circle(pose: FloatArray, outline: FloatArray) -> shapely.Polygon:
    radius = circumscribed_radius(outline)
    return shapely.Point(pose[:2]).buffer(radius + LENGTH, quad_segs=16)


def check_headings(laid: Layout, found: Diagnostics) -> None:
    """Warn of robots that start with their backs to their path."""
    for i, path in enumerate(laid.paths):
        if is_drawn(laid, i):
            continue
        pose: Any = laid.world.robots[i].pose
        along = direction_near(path, pose[:2])
        away = abs((pose[2] - along + pi) % (2.0 * pi) - pi)
        if away > pi / 2.0 + 1e-6 and abs(pose[2]) <= 2.0 * pi:
            found.warn(
                (*laid.world.entry_of(i), "pose", 2),
                f"{describe(laid.names[i])} starts facing {np.degrees(away):.0f} degrees away from "
                f"its path, which goes {along:.4g} rad ({np.degrees(along):.0f} degrees) there; it "
                "will have to turn round",
            )


def direction_near(path: FloatArray, position: tuple[float, float]) -> float:
    """Direction [rad] of the segment of a path that is nearest to a place."""
    a, b = path[:-1], path[1:]
    d = b - a
    share = np.clip(((position - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0.0, 1.0)
    k = int(np.argmin(np.hypot(*(a + share[:, None] * d - position).T)))
    return float(np.arctan2(d[k, 1], d[k, 0]))


LONGEST_ROBOT = 30.0
"""[m] A longer robot is likely given in millimetres or centimetres."""
SHORTEST_ROBOT = 0.01
"""[m]"""
WIDEST_CORRIDOR = 500.0
"""[m]"""
WIDEST_FOR_ROBOTS = 50.0
"""[-] times the longest robot"""
LARGEST_GROUND = 50_000.0
"""[m] from end to end"""
FASTEST = 50.0
"""[m/s]"""
FASTEST_TURN = 20.0
"""[rad/s] three turns a second"""
LONGEST_RUN = 86_400.0
"""[s]"""
MOST_STEPS = 5_000_000
"""of a run: beyond that it takes hours and its record gigabytes"""


def check_scale(world: World, found: Diagnostics) -> list[Location]:
    """Warn of numbers whose unit is likely another one; returns where such lengths stand.

    Whatever else is found where they stand for what they are follows from them.
    """
    already = len(found.warnings)
    _check_lengths(world, found)
    count = 0
    for i in range(len(world.robots)):
        if world.place_of(i) > 0 and not getattr(_entry(world, i), "is_drawn", False):
            continue  # as the first of its group
        before = len(found.warnings)
        _check_robot(world, i, found)
        count += len(found.warnings) > before
        if count >= MOST_ALIKE:
            break
    if world.start is not None:
        _check_heading(("start", "heading"), world.start.heading, found)
    for e, robot in enumerate(world.entries):
        _check_choices(("robots", e), robot.speeds, robot.omegas, found)
    is_sound = not any(fault.location[:1] == ("controller",) for fault in found.errors)
    if world.controller is not None and is_sound:  # its own check knows more
        settings = world.controller.settings
        _check_choices(("controller",), settings.get("speeds"), settings.get("omegas"), found)
    lengths = [
        fault.location
        for fault in found.warnings[already:]
        if fault.location[-1:] in (("footprint",), ("width",))
    ]
    step, duration = world.time.step, world.time.duration
    if duration is not None and duration > LONGEST_RUN:
        found.warn(
            ("time", "duration"),
            f"{duration:.6g} s is {duration / 3600.0:.4g} hours; durations are in seconds"
            + _thousandth(duration, "milliseconds"),
        )
    steps = duration / step if duration and step else 0.0
    if steps > MOST_STEPS:
        found.warn(
            ("time", "step"),
            f"{step:.4g} s makes {steps:,.0f} steps in {duration:.6g} s: such a run takes hours; "
            "steps are in seconds, and 0.01 is usual",
        )
    return lengths


def _entry(world: Any, i: int) -> Any:
    return world.entries[world.entry_of(i)[1]]


def _check_lengths(world: World, found: Diagnostics) -> None:
    corridor = world.corridor
    longest = max(float(np.ptp(robot.outline, axis=0).max()) for robot in world.robots)
    widest = float(np.max(corridor.width)) if isinstance(corridor, Corridor) else 0.0
    if widest > WIDEST_CORRIDOR or widest > WIDEST_FOR_ROBOTS * longest > 0.0:
        found.warn(
            ("corridor", "width"),
            f"{widest:.6g} m is very wide for a corridor; {in_metres(widest)}",
        )
    own = world.reference_path is not None
    lines: list[tuple[Location, Any]] = [
        (("reference_path",) if own else ("corridor", "centreline"), world.reference)
    ]
    lines += [(("boundaries", k), line) for k, line in enumerate(world.boundaries or ())]
    for where, line in lines:
        if len(line) and float(np.ptp(line, axis=0).max()) > LARGEST_GROUND:
            extent = float(np.ptp(line, axis=0).max())
            found.warn(
                where,
                f"it spans {extent:.6g} m; {in_metres(extent)}",
            )
            break


def _check_robot(world: World, i: int, found: Diagnostics) -> None:
    where, robot = world.entry_of(i), world.robots[i]
    name, size = describe(robot.name), float(np.ptp(robot.outline, axis=0).max())
    if size > LONGEST_ROBOT:
        message = f"{name} is {size:.6g} m long; {in_metres(size)}"
        found.warn((*where, "footprint"), message)
    elif size < SHORTEST_ROBOT:
        message = f"{name} is only {size:.4g} m long; lengths are in metres"
        found.warn((*where, "footprint"), message)
    if robot.pose is not None and robot.pose[2] != "random":
        _check_heading((*where, "pose", 2), robot.pose[2], found)
    if robot.start is not None:
        _check_heading((*where, "start", "heading"), robot.start.heading, found)
    v, omega = robot.limits.v, robot.limits.omega
    if v is not None and v > FASTEST:
        found.warn(
            (*where, "limits", "v"),
            f"{v:.6g} m/s is very fast; speeds are in metres per second"
            + _thousandth(v, "millimetres per second"),
        )
    if omega is not None and omega > FASTEST_TURN:
        found.warn(
            (*where, "limits", "omega"),
            f"{omega:.6g} rad/s is very fast; it is in radians per second; if degrees per "
            f"second are meant, write {radians(omega):.6g}",
        )


def _check_heading(where: Location, heading: Any, found: Diagnostics) -> None:
    """Of a heading that could be read."""
    if isinstance(heading, int | float) and abs(heading) > 2.0 * pi:
        found.warn(
            where,
            f"{heading:.6g} rad is more than a full turn; headings are in radians; if "
            f"degrees are meant, write {radians(heading):.6g}",
        )


def _thousandth(value: float, unit: str) -> str:
    return f"; if {unit} are meant, write {value / 1000.0:.6g}"


def _check_choices(where: Location, speeds: Any, omegas: Any, found: Diagnostics) -> None:
    """Speeds to choose from that leave no forward motion or no straight one."""
    if _are_numbers(speeds) and max(speeds) <= 0.0:
        found.warn((*where, "speeds"), "no speed above 0: there is no way forward; add 1.0")
    if _are_numbers(omegas):
        if 0.0 not in omegas:
            message = "0 is not among them: there is no way straight on; add 0"
            found.warn((*where, "omegas"), message)
        elif min(omegas) >= 0.0 or max(omegas) <= 0.0:
            side = "left" if max(omegas) > 0.0 else "right"
            only = f"only turns to the {side}" if any(omegas) else "no turn at all"
            found.warn((*where, "omegas"), f"{only}; give turns to both sides")


def _are_numbers(given: Any) -> bool:
    is_list = isinstance(given, tuple) and len(given) > 0
    return is_list and all(type(number) in (int, float) for number in given)
