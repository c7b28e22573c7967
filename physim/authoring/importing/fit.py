"""How large the robots may be, and which stretch of the reference path they can use.

The shipped controller is tuned for boxes of about 1.8 × 1.0 m. Where the path has not the room for
them, everything shrinks by one factor: robots, speeds, and every setting that is a length or a
speed. Angles, times and gains stay, so the scaled group moves as the large one would.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, DrawnRobot, place, rounded
from physim.authoring.importing.lines import (
    clearances,
    directions_at,
    is_closed,
    length_of,
    points_at,
    samples,
    station_of,
    stretch,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.outlines import spans_of
from physim.authoring.importing.path_area import MOST_TRIMMED, TOLD, check_inside, inside
from physim.authoring.importing.path_starts import (
    begin_at_robots,
    follow_the_nearest,
    path_of,
    robots_on,
    stand_on,
)
from physim.authoring.importing.work import GRAIN, coarse
from physim.geometry.shapes import FloatArray

LENGTH, WIDTH = 1.8, 1.0
"""[m] the box at size 1"""
ROOM = 1.8
"""[m] clearance that the box needs at size 1: half its diagonal, 1.03 m, and as much again as
the shipped controller needs to move on: with 1.2 m it stops in danger mode"""
END_ROOM = 1.6
"""[-] times the room, where the path begins and ends"""
MOST_LEFT_OUT = 3.0
"""[-] times the room that a path may be too narrow for at either end, before robots are smaller"""
STOP_ROOM = 1.3
"""[m] way that is left free ahead of a robot at the end of its path, at size 1: what it goes in
`time_low` of the shipped controller, 1 s, at the formation's highest speed, 1.3 m/s"""
SMALLEST = 0.01
UNLIKE = 1.5
"""[-] times as long as the shortest robot another is, if that is told"""
DOUBTED = 0.1
"""[m] clearance below which, if there is no more anywhere, the scale is doubted"""


@dataclass(frozen=True)
class Fit:
    """Factor ``size`` on the group, box (length, width) [m], path (n, 2), clearance needed [m]."""

    size: float
    box: tuple[float, float]
    reference: FloatArray
    room: float
    narrowest: float
    narrowest_at: FloatArray


def fit(path: Path, drawing: Drawing, options: Options) -> Fit:
    """Choose the largest size, at most 1, at which the group passes everywhere along the path.

    With ``options.robot`` or drawn robots the size is theirs. Raises ImportSourceError when the
    path leaves the area or has no room at all.
    """
    assert drawing.reference is not None  # the pipeline finds one before
    is_drawn = bool(drawing.robots) and options.robots is None
    if is_drawn:
        follow_the_nearest(drawing)
    box, size = _given_box(drawing, options), 1.0
    if box is not None:
        length_of_one = _smallest(drawing, options, box[0])
        size = round(length_of_one / LENGTH, 2 if length_of_one > 0.2 else 4)
    if is_drawn:
        begin_at_robots(drawing, size)
    on_it = robots_on(drawing, drawing.reference) if is_drawn else []
    way = _way(path, drawing, drawing.reference, size, on_it, "path")
    if box is not None:
        room, ends = room_of(box), _ends_for(drawing, way, box, size)
    else:
        size, ends = _largest_size(path, drawing, way)
        box = (float(f"{LENGTH * size:.2g}"), float(f"{WIDTH * size:.2g}"))
        room = ROOM * size
        ends = (ends[0], _clear_end(drawing.area, way, room, ends, _stop_way(box, size), room))
    trimmed, k = _trimmed(path, drawing, way, ends, box[1], is_drawn)
    if is_drawn:
        fitted = {id(drawing.reference): trimmed}
        for line in drawing.paths.values():
            if id(line) not in fitted:
                fitted[id(line)] = _own(path, drawing, line, size)
        drawing.paths = {name: fitted[id(line)] for name, line in drawing.paths.items()}
        drawing.reference = trimmed
    narrowest = float(2.0 * way.gaps[k])
    return Fit(size, box, trimmed, room, narrowest, points_at(way.line, way.at[k]))


@dataclass(frozen=True)
class _Way:
    """A path (n, 2) in the area, what messages call it, samples (k,) of it, and their clearances.

    All in metres; ``rear`` is the station of the last robot drawn on it.
    """

    line: FloatArray
    name: str
    at: FloatArray
    gaps: FloatArray
    rear: float


def _way(
    path: Path,
    drawing: Drawing,
    line: FloatArray,
    size: float,
    robots: Sequence[DrawnRobot],
    name: str,
) -> _Way:
    """A path without what is outside at its ends; refused where it leaves the area otherwise."""
    places = [stand_on(one, line, size)[0] for one in robots]
    line = inside(drawing, line, name)
    at = samples(length_of(line), min(0.1, length_of(line) / 500.0))
    gaps = clearances(points_at(line, at), coarse(drawing.area, GRAIN))
    doubt = "; check --scale" if gaps.max() < DOUBTED else ""
    check_inside(path, drawing, line, doubt, name)
    rear = min((station_of(line, one) for one in places), default=float("inf"))
    return _Way(line, name, at, gaps, rear)


def _own(path: Path, drawing: Drawing, line: FloatArray, size: float) -> FloatArray:
    """A path (n, 2) of robots drawn, as far as they can use it; refused as the reference is."""
    robots = robots_on(drawing, line)
    way = _way(path, drawing, line, size, robots, path_of(robots))
    width, length = np.max([spans_of(one.outline) for one in robots], axis=0).tolist()
    ends = _ends_for(drawing, way, (length, width), size)
    return _trimmed(path, drawing, way, ends, width, is_drawn=True)[0]


def _ends_for(
    drawing: Drawing, way: _Way, box: tuple[float, float], size: float
) -> tuple[int, int]:
    """First and last sample of a path between which a box (length, width) [m] has room.

    Where robots stand it begins, whatever room there is, and their laps stay whole.
    """
    room, last = room_of(box), len(way.at) - 1
    if is_closed(way.line) and way.rear < way.at[-1]:
        return 0, last
    ends = _ends(way, room) or _ends(way, 0.5 * box[1]) or (0, last)
    for ahead in (max(_stop_way(box, size), END_ROOM * room), END_ROOM * room):
        last = _clear_end(drawing.area, way, room, ends, ahead)
        if last != ends[1]:
            break
    first = min(ends[0], max(int(np.searchsorted(way.at, way.rear)) - 1, 0))
    return first, last


def _stop_way(box: tuple[float, float], size: float) -> float:
    """[m] that is to be free ahead of the middle of a box at the end of its path."""
    return 0.5 * box[0] + STOP_ROOM * size


def _trimmed(
    path: Path, drawing: Drawing, way: _Way, ends: tuple[int, int], width: float, is_drawn: bool
) -> tuple[FloatArray, int]:
    """A path between two of its samples, which is told, and the sample where it is narrowest.

    Refused where that is too narrow for a robot of some width [m].
    """
    at, (first, last) = way.at, ends
    inner = way.gaps[first : last + 1]
    k = first + _narrowest(at[first : last + 1], inner)
    if inner.min() <= 0.5 * width:
        where = points_at(way.line, at[k])
        wall = drawing.named(where, "boundary", "obstacle")
        message = (
            f"the {way.name} passes {max(inner.min(), 0.0):.3g} m from a boundary{wall} at "
            f"{place(where)}; a robot {width:g} m wide does not fit; move the path, or "
            f"{'draw narrower robots' if is_drawn else 'give --robot LENGTH,WIDTH'}"
        )
        raise drawing.refused_at(path, message, where, "path")
    for name, left_out in (("start", at[first]), ("end", at[-1] - at[last])):
        if left_out > TOLD:
            drawing.changes.append(
                f"{way.name} shortened by {left_out:.2f} m at its {name}, away from the boundary"
            )
    return rounded(stretch(way.line, float(at[first]), float(at[last]))), k


def room_of(box: tuple[float, float]) -> float:
    """Clearance [m] that lets a robot of given length and width turn, and a margin."""
    return 0.5 * hypot(*box) + 0.15 * box[0] / LENGTH


def _narrowest(at: FloatArray, gaps: FloatArray) -> int:
    """Sample with the least clearance, away from the ends, where a wall ahead is nearest."""
    sideways = gaps < 0.95 * (np.minimum(at - at[0], at[-1] - at) + gaps[[0, -1]].min())
    return int(np.argmin(np.where(sideways, gaps, np.inf) if sideways.any() else gaps))


def _given_box(drawing: Drawing, options: Options) -> tuple[float, float] | None:
    """Length of the robots, and width of those on the path, where the user gave or drew them."""
    if options.robot is not None:
        return options.robot
    if drawing.robots:
        spans = np.array([spans_of(robot.outline) for robot in drawing.robots])
        on_it = [robot.name not in drawing.paths for robot in drawing.robots]
        width = spans[on_it if any(on_it) else slice(None), 0].max()
        return float(spans[:, 1].max()), float(width)
    return None


def _smallest(drawing: Drawing, options: Options, length: float) -> float:
    """Length [m] of the robot by which speeds and distances go, of the shortest that is drawn.

    ``length`` is that of the longest; what suits it is too fast for much smaller ones.
    """
    if options.robot is not None or options.robots is not None or not drawing.robots:
        return length
    shortest = min(float(spans_of(one.outline)[1]) for one in drawing.robots)
    if length > UNLIKE * shortest:
        drawing.facts.append(
            f"robots of {shortest:.2f} to {length:.2f} m: speeds and distances go by the shortest"
        )
    return shortest


def _largest_size(path: Path, drawing: Drawing, way: _Way) -> tuple[float, tuple[int, int]]:
    at, gaps = way.at, way.gaps
    size = 1.0
    while size >= SMALLEST:
        rounded_size = float(f"{size:.2g}")
        ends = _ends(way, ROOM * rounded_size, MOST_LEFT_OUT)
        if ends is not None:
            return rounded_size, ends
        size *= 0.96
    # what must be free: from the first place with room to the last, and all that may not be cut off
    roomy = np.append(np.flatnonzero(gaps >= ROOM * SMALLEST), [len(at) // 2])
    most = int(MOST_TRIMMED * len(at))
    inner = slice(min(most, roomy.min()), max(len(at) - most, roomy.max() + 1))
    k = inner.start + int(np.argmin(gaps[inner]))
    leaves = np.flatnonzero((gaps[:-1] >= 0.0) & (gaps[1:] < 0.0)) + 1
    leaves = leaves[(leaves >= inner.start) & (leaves < inner.stop)]
    k = int(leaves[0]) if leaves.size else k  # not where it ends outside
    where = points_at(way.line, at[k])
    wall = drawing.named(where, "boundary", "obstacle")
    beyond = "leaves the area" if gaps[k] < 0.0 else f"comes within {gaps[k]:.3g} m of a boundary"
    doubt = "; check --scale" if gaps.max() < DOUBTED else ""
    message = (
        f"the path {beyond}{wall} at {place(where)}; it must keep away from the boundaries{doubt}"
    )
    raise drawing.refused_at(path, message, where, "path")


def _ends(way: _Way, room: float, rooms: float = inf) -> tuple[int, int] | None:
    """First and last sample between which the clearance is at least ``room`` everywhere.

    None where there are none, or less clearance than that on the first or last so many ``rooms``.
    """
    at, gaps = way.at, way.gaps
    roomy = np.flatnonzero(gaps >= room - 1e-9)
    if not roomy.size:
        return None
    first, last = int(roomy[0]), int(roomy[-1])
    if max(at[first], at[-1] - at[last]) > rooms * room:
        return None
    most, near = MOST_TRIMMED * at[-1], 2.0 * room
    wide = np.flatnonzero(gaps >= END_ROOM * room)  # a wall ahead is further away, if it can be
    begin, end = first, last
    if wide.size and at[wide[0]] <= min(at[first] + near, most):
        begin = int(wide[0])
    if wide.size and at[-1] - at[wide[-1]] <= min(at[-1] - at[last] + near, most):
        end = int(wide[-1])
    if at[end] - at[begin] < 4.0 * room:
        begin, end = first, last
    if at[begin] > most or at[-1] - at[end] > most or at[end] - at[begin] < 4.0 * room:
        return None
    return (begin, end) if (gaps[begin : end + 1] >= room - 1e-9).all() else None


def _clear_end(
    area: Any,
    way: _Way,
    room: float,
    ends: tuple[int, int],
    ahead: float,
    beside: float | None = None,
) -> int:
    """Last sample from which the way on is free for ``ahead`` [m].

    To the sides for ``beside``, ``END_ROOM * room`` where not given, as far as those have it.
    The end stays where no sample of the last stretch, twice ``room`` long, will do.
    """
    at, gaps, (first, last) = way.at, way.gaps, ends
    wide = END_ROOM * room if beside is None else beside
    tail = np.flatnonzero(at >= max(at[last] - 2.0 * room, at[first] + 4.0 * room))
    tail = tail[(tail <= last) & (at[tail] >= (1.0 - MOST_TRIMMED) * at[-1])]
    if not tail.size:
        return last
    points = points_at(way.line, at[tail])
    end = points + ahead * directions_at(way.line, at[tail], room)
    free = shapely.covers(area, shapely.linestrings(np.stack([points, end], axis=1)))
    clear = tail[free]
    if not clear.size:
        return last
    return int(clear[gaps[clear] >= min(wide, float(gaps[clear].max())) - 1e-6][-1])
