"""Robots on their paths: where they start and where they stop, filled in or as they are drawn.

A group that is filled in goes abreast in lanes, in rows one behind the other, apart at the start
and, where it can be, at its stops: in a bend two may come to stand too near each other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, ImportSourceError, number, refused, rounded
from physim.authoring.importing.fit import Fit
from physim.authoring.importing.lanes import Lane, lane
from physim.authoring.importing.lines import (
    Outline,
    Pose,
    directions_at,
    is_closed,
    length_of,
    points_at,
    pose_at,
    station_of,
    stretch,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.placed import Placed, shape_at
from physim.authoring.importing.stops import least_stop_gap
from physim.geometry.area import shrunk
from physim.geometry.shapes import FloatArray

CLEAR = 0.9
"""[m] at size 1: the gap between robots at their stops that a group is given where it can be"""


LANE, ROW = 2.0, 4.0
"""[m] from one lane to the next, and from one robot to the next in a lane, of several, at size 1"""
COLUMN = 3.2
"""[m] from robot to robot of a lane at size 1, where no lane is beside it"""
GAP = 0.5
"""[m] least distance between two robots at the start at size 1"""
WALL_GAP = 0.15
"""[m] least distance of a robot to a wall at the start at size 1"""
SPREADS = (1.0, 1.25, 1.5)
"""[-] how many times as far apart as need be robots start, where they would stop too near"""
CUT, MOST_CUT = 0.4, 6.4
"""[m] steps in which a path is shortened until its robots stop apart, and how far, at size 1"""
BETTER = 0.01
"""[m] by which robots stop farther apart at least, if a path is shortened for it"""
MOST_CUT_SHARE = 0.15
"""[-] share of the path by which it is shortened for that at most"""
ELSEWHERE = 0.3
"""[-] share of a lane from its place at which a robot would count as on another leg"""
ON = 0.6
"""[m] from the joint of a lap, where a robot may count as at its end, to the last, at size 1"""
MOST_ELSEWHERE = 500
"""Places at which robots would count as on another leg, before it is given up"""
ROUND = 4.0
"""[-] times its offset that a lane leads or lags beside a path that turns"""
LONGER = 3.0
"""[-] times as long as a stretch of its path a stretch of a lane is at most"""
MOST_SHARE = 0.6
"""[-] share of the path that the group may take up at the start"""


def _offsets(lanes: int) -> list[float]:
    """Offsets [m] of lanes abreast, left positive: from the middle outwards, left before right."""
    offsets = [LANE * (k - 0.5 * (lanes - 1)) for k in range(lanes)]
    return sorted(offsets, key=lambda offset: (abs(offset), -offset))


@dataclass(frozen=True)
class _Group:
    """Lanes of a group, its robots from the front to the rear, least gap at their stops [m]."""

    found: Fit
    lanes: list[Lane]
    robots: list[Placed]
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
    outline, size = Outline(drawing.area), found.size
    made = [
        lane(found.reference, offset * size, outline, found.room, size, lanes)
        for offset in _offsets(lanes)
    ]
    inner = shrunk(drawing.area, WALL_GAP * size, 16)
    shapely.prepare(inner)
    group = _group(path, drawing, inner, found, made, count)
    group = _stopping_apart(path, drawing, inner, group)
    drawing.changes += [
        f"lane {one.offset:+.2f} m beside the path {narrowing}"
        for one in sorted(group.lanes, key=lambda one: one.offset)
        if (narrowing := one.narrowing())
    ]
    return group.found, group.robots


def _group(
    path: Path,
    drawing: Drawing,
    inner: Any,
    found: Fit,
    made: list[Lane],
    count: int,
    spread: float = 1.0,
) -> _Group:
    """Starts in lanes, robots ``spread`` times as far apart along the path as they need be."""
    reference, size, lanes = found.reference, found.size, len(made)
    in_one_file = lanes == 1 or any(abs(one.offset) - one.narrowest > 0.01 for one in made)
    step = spread * size * (COLUMN if in_one_file else ROW / lanes)
    own = [made[i % lanes] for i in range(count)]
    poses = _poses(path, drawing, inner, found, own[::-1], step)[::-1]
    robots = [
        Placed(f"r{i + 1}", found.box, pose, one.line, one.plain_offset)
        for i, (one, pose) in enumerate(zip(own, poses, strict=True))
    ]
    return _Group(found, made, robots, least_stop_gap(reference, robots, size)[0])


def _stopping_apart(path: Path, drawing: Drawing, inner: Any, group: _Group) -> _Group:
    """The group on a path that ends earlier, where its robots would stop too near each other."""
    found, wanted = group.found, CLEAR * group.found.size
    if group.gap >= wanted:
        return group
    best, cut, apart = group, 0.0, 1.0
    for spread, less in _tries(found):
        line = stretch(found.reference, 0.0, length_of(found.reference) - less)
        shorter = replace(found, reference=rounded(line))
        lanes = [_ending_beside(one, shorter, less) for one in group.lanes]
        try:
            other = _group(path, drawing, inner, shorter, lanes, len(group.robots), spread)
        except ImportSourceError:  # no room at the start on a shorter path
            continue
        if min(other.gap, wanted) > best.gap + BETTER:
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


def _ending_beside(one: Lane, shorter: Fit, less: float) -> Lane:
    """A lane as far as a path goes that ends ``less`` [m] earlier."""
    if one.offset == 0.0:
        return replace(one, line=shorter.reference)
    length = length_of(one.line)
    first = max(length - LONGER * less - ROUND * abs(one.offset), 0.0)
    beside = _beside(shorter, one, length_of(shorter.reference))
    end = first + station_of(stretch(one.line, first, length), beside)
    return replace(one, line=rounded(stretch(one.line, 0.0, end)))


def _tries(found: Fit) -> list[tuple[float, float]]:
    """Spreads of a group, and by how much the path is shortened [m], in the order of trying."""
    most = min(MOST_CUT * found.size, MOST_CUT_SHARE * length_of(found.reference))
    cuts = np.arange(0.0, most, CUT * found.size)
    return [(spread, float(cut)) for spread in SPREADS for cut in cuts if (spread, cut) != (1, 0)]


def _poses(
    path: Path, drawing: Drawing, inner: Any, found: Fit, lanes: list[Lane], step: float
) -> list[Pose]:
    """Poses from the rear to the front: each as far back as the gaps allow, within ``inner``."""
    most = MOST_SHARE * length_of(found.reference)
    poses: list[Pose] = []
    shapes: list[Any] = []
    centres = np.full((len(lanes), 2), np.inf)
    near = hypot(*found.box) + GAP * found.size
    elsewhere = 0
    station = ON * found.size if is_closed(found.reference) else 0.0
    for one in lanes:
        while True:
            if station > most:
                raise _no_room(path, drawing, found, len(poses), len(lanes), most)
            pose = _pose(found, one, station)
            shape = shape_at(found.box, pose)
            is_there = _counts_there(found, one, pose, station)
            elsewhere += not is_there
            if elsewhere > MOST_ELSEWHERE:
                raise _beside_itself(path, drawing, found, one)
            if is_there and inner.covers(shape):
                close = np.flatnonzero(np.hypot(*(centres - pose[:2]).T) <= near)
                if all(shape.distance(shapes[k]) >= GAP * found.size for k in close):
                    break
            station += (0.1 if is_there else 0.5) * found.size
        centres[len(poses)] = pose[:2]
        poses.append(pose)
        shapes.append(shape)
        station += step
    return poses


def _beside_itself(path: Path, drawing: Drawing, found: Fit, one: Lane) -> ImportSourceError:
    """Error where a path comes by itself nearer than its lanes are beside it, all along."""
    message = f"a lane {abs(one.offset):.2f} m beside the path is as near to another leg of it all "
    message += "along, where a run could not tell which one a robot is on; fewer --lanes, or a "
    message += "smaller --robot"
    return drawing.refused_at(path, message, found.reference[0], "path")


def _no_room(
    path: Path, drawing: Drawing, found: Fit, placed: int, wanted: int, most: float
) -> ImportSourceError:
    """Error where only some of the robots, or none, start on the first ``most`` [m] of a path.

    At the path where that is drawn; the wall is the one nearest to where the next would stand.
    """
    box = f"{number(found.box[0])} x {number(found.box[1])} m"
    start, end = points_at(found.reference, 0.0), points_at(found.reference, most)
    wall = drawing.named(end if placed else start, "boundary", "obstacle")
    where = f"on the first {most:.1f} m of the path"
    message = (
        f"no room for a robot of {box} {where}, {WALL_GAP * found.size:.2g} m clear of the walls"
        f"{wall}; a smaller --robot LENGTH,WIDTH, or another --from"
    )
    if placed:
        message = (
            f"room for {placed} of {wanted} robots of {box} {where}{wall and f', beside{wall}'}; "
            "fewer --robots, more --lanes, or a smaller --robot LENGTH,WIDTH"
        )
    if drawing.is_on(start, "path", found.size):
        return drawing.refused_at(path, message, start, "path")
    return refused(path, message)


def _counts_there(found: Fit, one: Lane, pose: Pose, station: float) -> bool:
    """Whether a run takes a robot for where it is, not for one on another leg that is as near."""
    point, length = np.array(pose[:2]), length_of(found.reference)
    away = abs(station_of(found.reference, point) - station)
    own = station_of(one.line, point) / length_of(one.line)
    is_near = away <= abs(one.offset) + 0.5 * found.size
    return is_near and abs(own - station / length) < ELSEWHERE


def _beside(found: Fit, one: Lane, station: float) -> FloatArray:
    """Point (2,) [m] beside a station as far as a lane is; on the path for one drawn in."""
    beside: FloatArray = points_at(found.reference, station)
    if one.is_plain and one.offset != 0.0:
        tx, ty = directions_at(found.reference, station, found.size)
        beside = beside + one.offset * np.array([-ty, tx])
    return beside


def _pose(found: Fit, one: Lane, station: float) -> Pose:
    """Place on a lane beside a station of the reference path, heading along the lane."""
    at = station_of(one.line, _beside(found, one, station))
    x, y, heading = pose_at(one.line, at, found.size)
    return round(x, 3), round(y, 3), round(heading, 4)
