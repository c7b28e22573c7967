"""Robots at the start as they are seldom meant: far from their paths, walled off, facing away."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, place_text, plural
from physim.geometry.arc_length import Polyline
from physim.geometry.outline import placed_outline
from physim.geometry.polygon import circumscribed_radius
from physim.tolerances import LENGTH
from physim.world.checks.stations import lines_of
from physim.world.faults import describe
from physim.world.layout.robots import shared
from physim.world.scene import Layout

FAR = 10.0
"""[-] times its circumscribed radius that a robot starts from its path, if that is told"""
NEARLY = 1.0 - 1e-9
"""[-] share of the way to a path that no wall may cross: it may end at one"""


def check_footprints(laid: Layout) -> Iterator[Fault]:
    """Footprints that do not hold the point about which their robot turns."""
    origin = shapely.Point(0.0, 0.0)
    hulls = shared(lambda outline: shapely.Polygon(outline).convex_hull, laid.footprints)
    for i, hull in enumerate(hulls):
        if (far := hull.distance(origin)) > LENGTH:
            yield Fault(
                (*laid.entry_key(i), "footprint"),
                "the reference point (0, 0), about which the robot turns and which follows the "
                f"path, lies {far:.4g} m outside the footprint; corners are given relative to that "
                "point",
                "warning",
            )


def check_start_used(laid: Layout) -> Iterator[Fault]:
    """A region of the world's in which no robot starts."""
    world = laid.world
    if world.start is not None and all(
        world.start_of(entry) is not world.start for entry in world.robots
    ):
        yield Fault(
            ("start",),
            "no robot starts in this region, as each has a pose or a region of its own; remove the "
            "pose of those that the seed should place, or remove start",
            "warning",
        )


def check_walled_off(laid: Layout) -> Iterator[Fault]:
    """Robots that count as on a stretch of their path which lies beyond a wall or an obstacle.

    It is the one nearest to the start. The first such robot is told.
    """
    if not laid.names or not (laid.walls or laid.solids):
        return
    edges = [shapely.get_coordinates(shape) for _, shape in (*laid.walls, *laid.solids)]
    pieces = np.concatenate([np.stack([one[:-1], one[1:]], axis=1) for one in edges])
    walls = shapely.STRtree(shapely.linestrings(pieces))
    starts, paths = shapely.points(laid.start[:, :2]), lines_of(laid)
    ways = shapely.get_coordinates(shapely.shortest_line(starts, paths)).reshape(-1, 2, 2)
    begin, end = ways[:, 0], ways[:, 1]
    short = shapely.linestrings(np.stack([begin, begin + NEARLY * (end - begin)], axis=1))
    hidden = np.unique(walls.query(short, predicate="intersects")[0]).tolist()
    if hidden:
        i, left = hidden[0], len(hidden) - 1
        more = f", and {plural(left, 'more robot')} so" if left else ""
        yield Fault(
            (*laid.entry_key(i), "pose"),
            f"{describe(laid.names[i])} counts as at station {paths[i].project(starts[i]):.2f} m "
            f"of its path, which is nearest at {place_text(end[i, 0], end[i, 1], 4)}, beyond a "
            f"wall or an obstacle{more}; start it nearer to where it is to begin, or lead the path "
            "farther from what is between",
            "warning",
        )


def check_far(laid: Layout) -> Iterator[Fault]:
    """Robots that are written to start far from their paths, as where x and y are swapped."""
    far = []
    for i, line in enumerate(lines_of(laid)):
        if laid.robots[i].pose is not None:
            start = shapely.Point(laid.start[i, :2])
            away = line.distance(start)
            if away > FAR * circumscribed_radius(laid.footprints[i]):
                far.append((i, away, line.interpolate(line.project(start))))
    if far:
        i, away, foot = far[0]
        more = f", and {plural(len(far) - 1, 'more robot')} so" if len(far) > 1 else ""
        yield Fault(
            (*laid.entry_key(i), "pose"),
            f"{describe(laid.names[i])} starts {away:.4g} m away from its path, which is nearest "
            f"at {place_text(foot.x, foot.y, 4)}{more}; are x and y swapped, or is the path "
            "another's?",
            "warning",
        )


def check_headings(laid: Layout) -> Iterator[Fault]:
    """Robots that are written to start with their backs to their path."""
    for i, line in enumerate(lines_of(laid)):
        pose = laid.robots[i].pose
        if pose is None or pose[2] == "random" or abs(pose[2]) > 2.0 * pi:
            continue
        station = line.project(shapely.Point(pose[:2]))
        along = float(np.arctan2(*Polyline(line.coords).at(station)[1][::-1]))
        away = abs((pose[2] - along + pi) % (2.0 * pi) - pi)
        if away > pi / 2.0 + 1e-6:
            yield Fault(
                (*laid.entry_key(i), "pose", 2),
                f"{describe(laid.names[i])} starts facing {np.degrees(away):.0f} degrees away from "
                f"its path, which goes {along:.4g} rad ({np.degrees(along):.0f} degrees) there; it "
                "will have to turn round",
                "warning",
            )


def check_random_headings(laid: Layout) -> Iterator[Fault]:
    """Robots whose random heading may, with another seed, let them start in contact.

    Judged by the circle that the robot sweeps when it turns on the spot: no false comfort, but a
    warning may be too cautious for a long robot.
    """
    poses = [robot.pose for robot in laid.robots]
    random = {i for i, pose in enumerate(poses) if pose is not None and pose[2] == "random"}
    if not random:
        return
    swept = [
        shapely.Point(laid.start[i, :2]).buffer(circumscribed_radius(laid.footprints[i]) + LENGTH)
        if i in random
        else placed_outline(laid.footprints[i], laid.start[i])
        for i in range(len(poses))
    ]
    others = [*laid.walls, *laid.solids]
    names = [*(name for name, _ in others), *map(describe, laid.names)]
    tree = shapely.STRtree([*(shape for _, shape in others), *swept])
    met: dict[int, str] = {}
    for i, k in np.transpose(tree.query(swept, predicate="intersects")).tolist():
        if i in random and k != len(others) + i:
            met.setdefault(i, names[k])
    for i, name in sorted(met.items()):
        yield Fault(
            (*laid.entry_key(i), "pose", 2),
            f"random; with this seed {describe(laid.names[i])} starts clear, with another it may "
            f"touch {name}; leave room to turn, or write a heading",
            "warning",
        )


def check_expected(laid: Layout) -> Iterator[Fault]:
    """Distances that the world expects, but does not keep at the start."""
    expect, count = laid.world.expect, len(laid.names)
    if expect is None:
        return
    shapes = np.array([placed_outline(laid.footprints[i], laid.start[i]) for i in range(count)])
    names = [describe(name) for name in laid.names]

    def fault(key: str, who: str, gap: float, than: str) -> Fault:
        return Fault(
            ("expect", key), f"{who} {gap:.4g} m apart at the start, which is {than}", "warning"
        )

    def nearest(tree: list[Any], exclusive: bool) -> tuple[int, int, float]:
        pairs, gaps = shapely.STRtree(tree).query_nearest(
            shapes, exclusive=exclusive, all_matches=False, return_distance=True
        )
        k = int(np.argmin(gaps))
        return int(pairs[0, k]), int(pairs[1, k]), float(gaps[k])

    if (least := expect.min_boundary_distance) is not None:
        around = [*laid.walls, *laid.solids]
        i, k, gap = nearest([shape for _, shape in around], False)
        if gap < least - LENGTH:
            who = f"{names[i]} and {around[k][0]} are"
            yield fault("min_boundary_distance", who, gap, f"less than {least:.6g} m")
    if count < 2:
        return
    if (least := expect.min_distance) is not None:
        i, k, gap = nearest(list(shapes), True)
        if gap < least - LENGTH:
            who = f"{names[min(i, k)]} and {names[max(i, k)]} are"
            yield fault("min_distance", who, gap, f"less than {least:.6g} m")
    if (most := expect.max_distance) is not None:
        apart = np.hypot(*(laid.start[:, None, :2] - laid.start[:, :2]).transpose(2, 0, 1))
        i, k = sorted(int(one) for one in np.unravel_index(np.argmax(apart), apart.shape))
        gap = float(shapely.distance(shapes[i], shapes[k]))
        if gap > most + LENGTH:
            yield fault(
                "max_distance", f"{names[i]} and {names[k]} are", gap, f"more than {most:.6g} m"
            )
