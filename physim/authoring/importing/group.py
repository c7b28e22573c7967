"""Boxes that are filled in: a group in lanes beside the path, in rows one behind the other."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np
import shapely

from physim.authoring.importing.area import Place
from physim.authoring.importing.drawing import Drawing, ImportSourceError
from physim.authoring.importing.drawn import Placed, lane, lap
from physim.authoring.importing.options import Options
from physim.authoring.importing.size import SMALLEST, Size, check_way, fitting, two_digits
from physim.geometry.shapes import FloatArray
from physim.world.ground.area import shrunk
from physim.world.ground.lines import placed_outline
from physim.world.ground.polyline import Polyline

LANE, ROW, COLUMN = 2.0, 4.0, 3.2
"""[m] at size 1 from lane to lane, from row to row of several lanes, and from robot to robot of
one"""
GAP, WALL_GAP = 0.5, 0.15
"""[m] at size 1 least distance at the start of robots to each other, and to a wall"""
SHRUNK = 0.9
"""[-] from one size that is tried to the next"""
MOST_SHARE = 0.6
"""[-] share of the path that the group may take up at the start"""


def reach_of(options: Options) -> float:
    """How far [m] beside the path lanes go, at size 1."""
    return 0.5 * LANE * (_lanes(options) - 1)


def _lanes(options: Options) -> int:
    return min(options.lanes or 1, options.robots or options.lanes or 1)


def fill_in(
    drawing: Drawing, where: Place, line: FloatArray, size: Size, options: Options
) -> tuple[Size, list[Placed]]:
    """Place ``--robots`` boxes in ``--lanes`` lanes beside a path (n, 2) [m], the first foremost.

    With ``--robot fit`` all shrink until they have room: the size is that at which they have.
    Raises ImportSourceError where a lane, or so many robots, have none.
    """
    while True:
        try:
            return size, _filled(drawing, where, line, size, options)
        except ImportSourceError:
            factor = two_digits(SHRUNK * size.factor)
            if options.robot != "fit" or factor < SMALLEST:
                raise
            size = replace(size, factor=factor, box=fitting(factor))


def _filled(
    drawing: Drawing, where: Place, line: FloatArray, size: Size, options: Options
) -> list[Placed]:
    """Boxes of one size.

    Neighbouring lanes are staggered, so that the group arrives as it starts: no two stop abreast
    of each other.
    """
    factor, abreast = size.factor, _lanes(options)
    count = options.robots or abreast
    sides = [round(factor * LANE * (k - 0.5 * (abreast - 1)), 3) for k in range(abreast)]
    lanes = []
    for offset in sorted(sides, key=lambda side: (abs(side), -side)):  # the middle first
        what = f"lane {offset:+g} m beside the path" if offset else "path"
        beside = lane(drawing, line, offset)
        advice = f"--lanes {max(abreast - 1, 1)}, or a smaller --robot"
        width = size.box[1] + 2.0 * WALL_GAP * factor
        check_way(drawing, where, beside, width, what, None, advice)
        lanes.append((beside, offset))
    inner = shrunk(where.area, WALL_GAP * factor, 16)
    shapely.prepare(inner)
    half = np.array(size.box) / 2.0
    box = half * [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    step = factor * (ROW / len(lanes) if len(lanes) > 1 else COLUMN)
    way, near = Polyline(line), hypot(*size.box) + GAP * factor
    station, robots, shapes = 0.0, list[Placed](), list[object]()
    centres = np.full((count, 2), np.inf)
    for k in reversed(range(count)):
        beside, offset = lanes[k % len(lanes)]
        while True:
            if station > MOST_SHARE * way.length:
                is_fit = options.robot == "fit"
                more = (
                    "a longer path" if is_fit else "a smaller --robot LENGTH,WIDTH, or --robot fit"
                )
                raise drawing.refusal(
                    f"room for {len(robots)} of {count} robots of {size.box[0]:g} x "
                    f"{size.box[1]:g} m on the first {station:.1f} m of the path; fewer "
                    f"--robots, more --lanes, {more}"
                )
            pose = _pose(way, Polyline(beside), offset, station, factor)
            shape = placed_outline(box, pose)
            close = np.flatnonzero(np.hypot(*(centres - pose[:2]).T) <= near)
            is_apart = all(shape.distance(shapes[j]) >= GAP * factor for j in close)
            if is_apart and inner.covers(shape):
                break
            station += 0.1 * factor
        centres[len(robots)] = pose[:2]
        shapes.append(shape)
        robots.append(Placed(f"r{k + 1}", size.box, size.box, pose, beside, offset))
        station += step
    robots.reverse()
    return [lap(one) for one in robots] if way.is_ring() else robots


def _pose(
    way: Polyline, beside: Polyline, offset: float, station: float, window: float
) -> tuple[float, float, float]:
    """Place on a lane beside a station of the reference path, heading along the lane."""
    tx, ty = way.chords(station, window)
    at = beside.nearest(way.at(station)[0] + offset * np.array([-ty, tx]))[0]
    (x, y), (cx, cy) = beside.at(at)[0], beside.chords(at, window)
    return round(float(x), 3), round(float(y), 3), round(float(np.arctan2(cy, cx)), 4)
