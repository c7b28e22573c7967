"""Robots at the start as they are seldom meant: far from their paths, walled off, facing away."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, place_text, plural
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.units import figure
from physim.world.checks.stations import lines_of
from physim.world.faults import describe
from physim.world.ground.lines import placed_outline
from physim.world.ground.polyline import Polyline
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
                f"path, lies {figure(far)} m outside the footprint; corners are relative to it",
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
    walls, ways = shapely.STRtree(shapely.linestrings(pieces)), _ways(laid)
    ways[:, 1] = ways[:, 0] + NEARLY * (ways[:, 1] - ways[:, 0])
    hidden = walls.query(shapely.linestrings(ways), predicate="intersects")[0]
    for i in np.unique(hidden)[:1].tolist():
        station = lines_of(laid)[i].project(shapely.Point(ways[i, 1]))
        yield Fault(
            (*laid.entry_key(i), "pose"),
            f"{describe(laid.names[i])} counts as at station {station:.2f} m of its path, which is "
            f"nearest at {_end(ways[i])}, beyond a wall or an obstacle"
            f"{_so(len(np.unique(hidden)) - 1)}; start it nearer to where it is to begin, or lead "
            "the path farther from what is between",
            "warning",
        )


def check_far(laid: Layout) -> Iterator[Fault]:
    """Robots that are written to start far from their paths, as where x and y are swapped."""
    ways, reach = _ways(laid), np.array(shared(circumscribed_radius, laid.footprints))
    away = np.hypot(*(ways[:, 1] - ways[:, 0]).T)
    is_posed = np.array([robot.pose is not None for robot in laid.robots])
    far = np.flatnonzero((away > FAR * reach) & is_posed)
    for i in far[:1].tolist():
        yield Fault(
            (*laid.entry_key(i), "pose"),
            f"{describe(laid.names[i])} starts {figure(away[i])} m away from its path, which is "
            f"nearest at {_end(ways[i])}{_so(len(far) - 1)}; are x and y swapped, or is the path "
            "another's?",
            "warning",
        )


def _ways(laid: Layout) -> FloatArray:
    """(N, 2, 2) [m] where each robot starts, and the nearest point of its path."""
    lines = shapely.shortest_line(shapely.points(laid.start[:, :2]), lines_of(laid))
    return np.asarray(shapely.get_coordinates(lines).reshape(-1, 2, 2))


def _end(way: FloatArray) -> str:
    return place_text(way[1, 0], way[1, 1], 4)


def _so(more: int) -> str:
    return f", and {plural(more, 'more robot')} so" if more else ""


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
                "turns round, or drives there backwards",
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
    expect = laid.world.expect
    if expect is None or not laid.names:
        return
    names = [describe(name) for name in laid.names]
    shapes = [placed_outline(*one) for one in zip(laid.footprints, laid.start, strict=True)]
    around = [*laid.walls, *laid.solids]
    found = {"min_boundary_distance": _nearest(shapes, [shape for _, shape in around], False)}
    if len(shapes) > 1:
        found["min_distance"] = _nearest(shapes, shapes, True)
        apart = np.hypot(*(laid.start[:, None, :2] - laid.start[:, :2]).transpose(2, 0, 1))
        i, k = sorted(int(one) for one in np.unravel_index(np.argmax(apart), apart.shape))
        found["max_distance"] = i, k, float(shapely.distance(shapes[i], shapes[k]))
    for key, (i, k, gap) in found.items():
        allowed, side = getattr(expect, key), -1.0 if key.startswith("min") else 1.0
        if allowed is not None and side * (gap - allowed) > LENGTH:
            other = around[k][0] if key == "min_boundary_distance" else names[k]
            yield Fault(
                ("expect", key),
                f"{names[i]} and {other} are {figure(gap)} m apart at the start, which is "
                f"{'less' if side < 0.0 else 'more'} than {allowed:.6g} m",
                "warning",
            )


def _nearest(shapes: list[Any], others: list[Any], exclusive: bool) -> tuple[int, int, float]:
    """Numbers of the two that are nearest to each other, and how far apart they are [m]."""
    pairs, gaps = shapely.STRtree(others).query_nearest(
        shapes, exclusive=exclusive, all_matches=False, return_distance=True
    )
    k = int(np.argmin(gaps))
    i, j = pairs[:, k].tolist()
    return (min(i, j), max(i, j), float(gaps[k])) if exclusive else (i, j, float(gaps[k]))
