"""Robots on their paths: abreast in lanes, in rows one behind the other, apart at the start."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, cos, sin
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.importing.drawing import Drawing, ImportSourceError, Options, number, refused, rounded
from physim.importing.fit import Fit
from physim.importing.lanes import Lane, drawn_in, is_narrower, lane
from physim.importing.line import directions_at, points_at, stations, stretch
from physim.importing.placed import Placed
from physim.importing.stops import CLEAR, corners_of, least_stop_gap

LANE = 2.0
"""[m] from lane to lane at size 1"""
ROW, COLUMN = 4.0, 3.2
"""[m] from robot to robot of a lane at size 1, with lanes beside it and alone"""
GAP = 0.5
"""[m] least distance between two robots at the start at size 1"""
WALL_GAP = 0.15
"""[m] least distance of a robot to a wall at the start at size 1"""
SPREADS = (1.0, 1.25, 1.5)
"""[-] how many times as far apart as need be robots start, where they would stop too near"""
CUT, MOST_CUT = 0.4, 6.4
"""[m] steps in which a path is shortened until its robots stop apart, and how far, at size 1"""
MOST_CUT_SHARE = 0.15
"""[-] share of the path by which it is shortened for that at most"""
MOST_SHARE = 0.6
"""[-] share of the path that the group may take up at the start"""


@dataclass(frozen=True)
class _Group:
    """Lanes of a group, the lane and start of each robot from the rear, least gap at the stops."""

    found: Fit
    made: list[Lane]
    lanes: list[Lane]
    poses: list[tuple[float, float, float]]
    gap: float


def fill_in(path: Path, drawing: Drawing, found: Fit, options: Options) -> tuple[Fit, list[Placed]]:
    """Place ``--robots`` boxes in ``--lanes`` lanes, the first of them furthest ahead.

    Neighbouring lanes are staggered, so that the group arrives as it starts: no two stop abreast
    of each other. Where two would stop near each other in a bend, the path ends before that.
    Returns the fit with the path that they follow. Raises ImportSourceError when there is no room
    for so many.
    """
    count = options.robots or options.lanes or 1
    lanes = min(1 if options.lanes is None else options.lanes, count)
    group = _stopping_apart(path, drawing, _group(path, drawing.area, found, count, lanes))
    for one in group.made:
        if is_narrower(one):
            drawing.changes.append(f"lane {one.offset:+.2f} m beside the path {drawn_in(one)}")
    return group.found, [
        Placed(f"r{count - n}", found.box, group.poses[n],
               one.offset if one.is_plain else one.line)
        for n, one in reversed(list(enumerate(group.lanes)))
    ]  # fmt: skip


def _group(
    path: Path, area: Any, found: Fit, count: int, lanes: int, spread: float = 1.0
) -> _Group:
    """Lanes and starts, robots ``spread`` times as far apart along the path as they need be."""
    made = [
        lane(found.reference, (k - 0.5 * (lanes - 1)) * LANE * found.size, area, found.room,
             found.size)
        for k in range(lanes)
    ]  # fmt: skip
    order = sorted(range(lanes), key=lambda k: (abs(k - 0.5 * (lanes - 1)), -k))
    files = lanes == 1 or any(abs(one.offset) - one.narrowest > 0.01 for one in made)
    step = (
        spread * found.size * (COLUMN if files else ROW / lanes)
    )  # in one file where lanes are drawn in
    own = [made[order[(count - 1 - n) % lanes]] for n in range(count)]
    poses = _poses(path, area, found, own, step)
    outlines = [corners_of(found.box)] * count
    lines = [one.line for one in own]
    gap = least_stop_gap(found.reference, lines, poses, outlines, found.size)[0]
    return _Group(found, made, own, poses, gap)


def _stopping_apart(path: Path, drawing: Drawing, group: _Group) -> _Group:
    """The group on a path that ends earlier, where its robots would stop too near each other."""
    found, wanted = group.found, CLEAR * group.found.size
    if group.gap >= wanted:
        return group
    best, cut, apart = group, 0.0, 1.0
    for spread, less in _tries(found):
        line = stretch(found.reference, 0.0, float(stations(found.reference)[-1]) - less)
        shorter = replace(found, reference=rounded(line))
        count, lanes = len(group.lanes), len(group.made)
        try:
            other = _group(path, drawing.area, shorter, count, lanes, spread)
        except ImportSourceError:  # no room at the start on a shorter path
            continue
        if min(other.gap, wanted) > best.gap:
            best, cut, apart = other, less, spread
        if other.gap >= wanted:
            break
    if best is not group:
        done = [f"path shortened by {cut:.2f} m more at its end"] if cut > 0.0 else []
        done += [f"robots {apart:g} times as far apart as usual"] if apart > 1.0 else []
        drawing.changes.append(
            f"{', '.join(done)}: in the last bend two would stop {group.gap:.2f} m from each "
            f"other, and do so {best.gap:.2f} m apart now"
        )
    return best


def _tries(found: Fit) -> list[tuple[float, float]]:
    """Spreads of a group, and by how much the path is shortened [m], in the order of trying."""
    most = min(MOST_CUT * found.size, MOST_CUT_SHARE * float(stations(found.reference)[-1]))
    cuts = np.arange(0.0, most, CUT * found.size)
    return [(spread, float(cut)) for spread in SPREADS for cut in cuts if (spread, cut) != (1, 0)]


def _poses(
    path: Path, area: Any, found: Fit, lanes: list[Lane], step: float
) -> list[tuple[float, float, float]]:
    """Poses from the rear to the front: each as far back as the gaps allow."""
    length = float(stations(found.reference)[-1])
    inner = area.buffer(-WALL_GAP * found.size)
    shapely.prepare(inner)
    poses: list[tuple[float, float, float]] = []
    shapes: list[Any] = []
    station = 0.0
    for one in lanes:
        while True:
            if station > MOST_SHARE * length:
                if not poses:
                    raise refused(
                        path,
                        f"no room for a robot of {number(found.box[0])} x {number(found.box[1])} m "
                        f"on the first {MOST_SHARE * length:.1f} m of the path, "
                        f"{WALL_GAP * found.size:.2g} m clear of the walls; a smaller --robot "
                        "LENGTH,WIDTH, or another --from",
                    )
                raise refused(
                    path,
                    f"room for {len(poses)} of {len(lanes)} robots of {number(found.box[0])} x "
                    f"{number(found.box[1])} m on the first {MOST_SHARE * length:.1f} m of the "
                    "path; fewer --robots, more --lanes, or a smaller --robot LENGTH,WIDTH",
                )
            pose = _pose(found, one, station)
            shape = box_at(pose, found.box)
            if inner.covers(shape) and not (
                shapes and shapely.distance(shape, shapes).min() < GAP * found.size
            ):
                break
            station += 0.1 * found.size
        poses.append(pose)
        shapes.append(shape)
        station += step
    return poses


def _pose(found: Fit, one: Lane, station: float) -> tuple[float, float, float]:
    """Place on a lane beside a station of the reference path, heading along the lane."""
    beside = points_at(found.reference, np.array([station]))[0]
    if one.offset != 0.0:
        tx, ty = directions_at(found.reference, np.array([station]), found.size)[0]
        beside = beside + one.offset * np.array([-ty, tx])
    own = float(shapely.LineString(one.line).project(shapely.Point(beside)))
    x, y = points_at(one.line, np.array([own]))[0]
    tx, ty = directions_at(one.line, np.array([own]), found.size)[0]
    return round(float(x), 3), round(float(y), 3), round(atan2(ty, tx), 4)


def box_at(pose: tuple[float, float, float], box: tuple[float, float]) -> Any:
    """Rectangle of a robot as a shapely polygon, world frame."""
    x, y, heading = pose
    a, b = 0.5 * box[0], 0.5 * box[1]
    corners = np.array([(-a, -b), (a, -b), (a, b), (-a, b)])
    c, s = cos(heading), sin(heading)
    return shapely.Polygon(corners @ np.array([[c, s], [-s, c]]) + (x, y))
