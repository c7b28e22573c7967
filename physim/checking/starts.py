"""Robots at the start, as they are seldom meant: shapes, places and headings."""

from __future__ import annotations

from math import pi

import numpy as np
import shapely

from physim.checking.findings import Diagnostics
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.layout import PartialLayout
from physim.tolerances import LENGTH
from physim.world import World
from physim.world.faults import describe
from physim.world_file.geometry_check import Placed, placed_outline


def check_footprints(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn of footprints that do not hold the point about which their robot turns."""
    for i, outline in laid.footprints.items():
        far = shapely.Polygon(outline).convex_hull.distance(shapely.Point(0.0, 0.0))
        if far > LENGTH:
            found.warn(
                ("robots", i, "footprint"),
                f"the reference point (0, 0), about which the robot turns and which follows the "
                f"path, lies {far:.4g} m outside the footprint; corners count from that point",
            )


def check_expected(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn of a least distance between robots that two of them already fall below at the start."""
    expect = laid.world.expect
    least = expect.min_distance if expect is not None else None
    shapes, names = [], []
    for i, outline in laid.footprints.items():
        pose = laid.world.robots[i].pose
        is_random = pose is not None and pose[2] == "random"
        if not np.isnan(laid.start[i]).any() and not is_random:
            shapes.append(placed_outline(laid.start[i], outline))
            names.append(laid.names[i])
    if least is None or len(shapes) < 2:
        return
    tree = shapely.STRtree(shapes)
    (one, other), gaps = tree.query_nearest(shapes, exclusive=True, return_distance=True)
    k = int(np.argmin(gaps))
    if gaps[k] < least - LENGTH:
        found.warn(
            ("expect", "min_distance"),
            f"{describe(names[one[k]])} and {describe(names[other[k]])} are {gaps[k]:.4g} m apart "
            f"at the start, so {least:.6g} m cannot hold",
        )


def check_start_used(world: World | None, found: Diagnostics) -> None:
    """Warn of a region of the world's in which no robot starts."""
    if world is None or world.start is None:
        return
    if all(world.start_of(i) is not world.start for i in range(len(world.robots))):
        found.warn(
            ("start",),
            "no robot starts in this region, as each has a pose or a region of its own; take the "
            "pose away from those that the seed should place, or take start away",
        )


def is_drawn(laid: PartialLayout, i: int) -> bool:
    """Whether a robot has no heading written: it is random, or there is no pose."""
    pose = laid.world.robots[i].pose
    return pose is None or pose[2] == "random"


def check_random_headings(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn where another seed may let a robot with a random heading start in contact.

    Judged by the circle that the robot sweeps when it turns on the spot: no false comfort, but a
    warning may be too cautious for a long robot.
    """
    faulty = {fault.location[1] for fault in laid.faults if fault.location[2:] == ("pose",)}
    posed = [i for i in laid.footprints if laid.world.robots[i].pose is not None]
    random = {i for i in posed if is_drawn(laid, i) and i not in faulty}
    if not random:
        return
    turning = [
        Placed(i, laid.names[i], _circle(laid.start[i], outline))
        if i in random
        else Placed(i, laid.names[i], placed_outline(laid.start[i], outline))
        for i, outline in laid.footprints.items()
        if i not in faulty and not np.isnan(laid.start[i]).any()
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
            ("robots", index, "pose", 2),
            f"random; with this seed {describe(laid.names[index])} starts free, with another "
            f"it may touch {name}; leave room to turn, or write a heading",
        )


def _circle(pose: FloatArray, outline: FloatArray) -> shapely.Polygon:
    radius = circumscribed_radius(outline)
    return shapely.Point(pose[:2]).buffer(radius + LENGTH, quad_segs=16)


def check_headings(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn of robots that start with their backs to their path."""
    for i, path in laid.paths.items():
        if is_drawn(laid, i):
            continue
        pose = laid.world.robots[i].pose
        along = direction_near(path, pose[:2])
        away = abs((pose[2] - along + pi) % (2.0 * pi) - pi)
        if away > pi / 2.0 + 1e-6 and abs(pose[2]) <= 2.0 * pi:
            found.warn(
                ("robots", i, "pose", 2),
                f"{describe(laid.names[i])} starts facing {np.degrees(away):.0f} degrees away from "
                f"its path, which goes {along:.4g} rad there; it will have to turn round",
            )


def direction_near(path: FloatArray, position: tuple[float, float]) -> float:
    """Direction [rad] of the segment of a path that is nearest to a place."""
    a, b = path[:-1], path[1:]
    d = b - a
    share = np.clip(((position - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0.0, 1.0)
    k = int(np.argmin(np.hypot(*(a + share[:, None] * d - position).T)))
    return float(np.arctan2(d[k, 1], d[k, 0]))
