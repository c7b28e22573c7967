"""A centreline with widths becomes a corridor: two walls, two caps, and the centreline between."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, listed, moved_to, place, refused, rounded
from physim.authoring.importing.enclosure import check_size
from physim.authoring.importing.lines import (
    CrossingError,
    distances_to,
    length_of,
    points_at,
    samples,
    stations,
    without_loops,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.source import read_text
from physim.authoring.importing.track_file import TrackFile, read_track_file
from physim.authoring.importing.work import check_work
from physim.geometry.shapes import FloatArray
from physim.world.layout.self_overlap import legs_that_meet

CLOSED = 2.0
"""[-] A track is closed when its ends are no further apart than this times its longest step."""
CLOSED_SHARE, CLOSABLE_SHARE = 0.2, 0.5
"""[-] ... and than this share of its length; and than the second, if --start says it is closed"""
GAP = 2.0
"""[m] of road left out where a closed track is cut open"""
FOLDED = 0.5
"""[-] share of the stated width below which a wall is reported as too near"""
SLIGHTLY = 0.05
"""[-] share by which a road may be narrower than stated before that is reported"""
ABOUT = 2.0
"""[-] times the stated width along the road within which a narrower place explains a near wall"""
NEAR = 1e-6
"""[m] points of the file this near the road's centreline lie on it, and not in the gap"""
HAIR = 1e-7
"""[-] share by which walls are drawn in, so that one that two stretches share crosses nothing"""
THIN = 2e-3
"""[m] by which they are drawn in where they would still touch to the millimetre"""
BEND = 3.0
"""[-] Widths along the track within which it may overlap, in bends of many points"""
SHORTEST_LOOP = 0.01
"""[m] A loop shorter than this is not told."""
LONGEST_LOOP = 6.0
"""[-] A loop of a sideways line is a bend up to this times the largest width on that side."""

SMOOTH = "noisy points become a clean track when they are smoothed or thinned"
"""What to do about a track that crosses itself and should not."""
ELSEWHERE = "; one that begins in a tight corner is cut open elsewhere by --start"


@dataclass(frozen=True)
class _Road:
    """Points (n, 2) of the centreline and of both walls beside them [m]."""

    centre: FloatArray
    right: FloatArray
    left: FloatArray

    def cut(self, start: float, length: float) -> _Road:
        """Stretch of a closed road (last point as the first) from a station of its centreline."""
        station = stations(self.centre)
        twice = np.concatenate((station, station[1:] + station[-1]))
        inside = twice[(twice > start + 1e-6) & (twice < start + length - 1e-6)]
        at = np.concatenate(([start], inside, [start + length]))
        lines = (np.vstack([line, line[1:]]) for line in (self.centre, self.right, self.left))
        return _Road(*(np.stack([np.interp(at, twice, line[:, k]) for k in (0, 1)], axis=1)
                       for line in lines))  # fmt: skip


def read_track(path: Path, options: Options) -> Drawing:
    """Read a race-track CSV into a drawing with its centreline as the reference path."""
    file = read_track_file(path, read_text(path), options.unit)
    closed, total = _closed(file, options)
    kind = "closed" if closed else "open"
    drawing = Drawing(kind="centreline with widths (race-track convention)")
    drawing.changes += file.changes
    width = file.left + file.right
    drawing.facts.append(
        f"{len(file.points)} points, {total:.1f} m, {kind}, {width.min():.2f} to "
        f"{width.max():.2f} m wide as stated; {options.unit:g} m per unit"
    )
    drawing.facts += moved_to(file.origin)
    road = _road(file, closed)
    check_work(path, [road.centre, road.left, road.right])
    check_size(path, np.ptp(np.vstack([road.left, road.right]), axis=0))
    if _shares_a_wall(file, closed):
        road = _road(file, closed, THIN)
        drawing.changes.append(
            f"two stretches of the road share a wall: walls drawn in by {1000.0 * THIN:g} mm, so "
            "that each has its own"
        )
    if closed:
        road = _opened(path, road, total, options, drawing)
    elif options.start is not None or options.gap is not None:
        raise refused(path, "--start and --gap are for closed tracks; this one is open")
    _report_folds(file, drawing, road)
    left = _wall(path, "left", road.left, float(file.left.max()), drawing, closed)
    right = _wall(path, "right", road.right, float(file.right.max()), drawing, closed)
    crossing = shapely.intersection(shapely.LineString(left), shapely.LineString(right))
    if not crossing.is_empty:
        at = place(shapely.get_coordinates(crossing)[0])
        raise refused(
            path,
            f"the left edge meets the right one at {at}: the track crosses itself "
            f"there, or its points are noisy; {SMOOTH}",
        )
    _check_overlap(path, road)
    drawing.facts += _as_made(road.centre, left, right, float(width.min()))
    caps = [np.array([left[0], right[0]]), np.array([left[-1], right[-1]])]
    drawing.boundaries = [rounded(line) for line in (left, right, *caps)]
    drawing.reference = rounded(road.centre)
    return drawing


def _shares_a_wall(file: TrackFile, closed: bool) -> bool:
    """Whether two stretches share a wall: nothing of it is left to cut off, or touches itself to
    the millimetre, where it is drawn in by `THIN`."""
    as_stated, drawn_in = _road(file, closed), _road(file, closed, THIN)
    for side, width in (("left", file.left), ("right", file.right)):
        longest = LONGEST_LOOP * float(width.max())
        stated, thin = (
            _without_loops(getattr(one, side), longest) for one in (as_stated, drawn_in)
        )
        if thin is None:
            continue  # said where the wall is made
        if stated is None or stated[1] > 1.1 * thin[1] + 0.1:
            return True
        line = rounded(stated[0])
        if len(line) > 1 and not shapely.LineString(line).is_simple:
            return True
    return False


def _without_loops(wall: FloatArray, longest: float) -> tuple[FloatArray, float] | None:
    """A wall without its loops, and how long they were [m]; None where one is no bend."""
    try:
        clean, loops = without_loops(wall, longest)
    except CrossingError:
        return None
    return clean, sum(length for _, length in loops)


def _check_overlap(path: Path, road: _Road) -> None:
    """Refuse stretches that run into each other, far from each other along the road."""
    left, right = road.left, road.right
    halves = (np.hypot(*(side - road.centre).T) for side in (left, right))
    width = 2.0 * np.maximum(*halves)  # what a bend takes goes by the wider side
    if found := legs_that_meet(width, left, right, BEND):
        station = stations(road.centre)
        raise refused(
            path,
            f"the track runs into itself at {place(np.array(found[2]))}: its stretches at "
            f"{station[found[0]]:.1f} m and {station[found[1]]:.1f} m along it have less than "
            "their widths between them; make the widths there smaller",
        )


def _as_made(centre: FloatArray, left: FloatArray, right: FloatArray, stated: float) -> list[str]:
    """Say how far apart the walls are [m] where that is less than the file states.

    The sum of the shortest distances from the centreline to either wall, as `physim preview` has
    it: at a corner the walls keep their distance along its bisector, and lie nearer beside it.
    """
    at = samples(length_of(centre), 0.1)
    points = points_at(centre, at)
    width = distances_to(left, points) + distances_to(right, points)
    k = int(np.argmin(width))
    if width[k] >= (1.0 - SLIGHTLY) * stated:
        return []
    return [
        f"walls {width[k]:.2f} to {width.max():.2f} m apart as made, narrowest at "
        f"{place(points[k])}: in bends they lie nearer than stated"
    ]


def _report_folds(file: TrackFile, drawing: Drawing, road: _Road) -> None:
    """Report where a wall lies much nearer to the centreline than the width that is stated."""
    on_road = distances_to(road.centre, file.points) < NEAR
    for side, wall, width in (("left", road.left, file.left), ("right", road.right, file.right)):
        gap = distances_to(wall, file.points)
        share = np.where(on_road, gap / width, 1.0)
        k = int(np.argmin(share))
        if share[k] < FOLDED:
            why = "narrows abruptly" if _narrows(file.points, width, k, gap[k]) else "folds"
            drawing.changes.append(
                f"{side} wall comes within {gap[k]:.2f} m of the centreline at "
                f"{place(file.points[k])}, {width[k]:.2f} m are stated: the road {why} there"
            )


def _narrows(points: FloatArray, width: FloatArray, k: int, gap: float) -> bool:
    """Whether the road close to point ``k`` is stated to be about as narrow as ``gap`` [m]."""
    at = stations(points)
    close = np.abs(at - at[k]) <= ABOUT * width[k]
    return bool((width[close] <= 1.1 * gap + NEAR).any())


def _closed(file: TrackFile, options: Options) -> tuple[bool, float]:
    """Whether the last point leads back to the first, and the length of the centreline [m]."""
    steps = np.hypot(*np.diff(file.points, axis=0).T)
    gap = float(np.hypot(*(file.points[0] - file.points[-1])))
    length = float(steps.sum())
    most = min(CLOSED * float(steps.max()), CLOSED_SHARE * length)
    if options.open:
        most = -1.0
    elif options.start is not None:
        most = CLOSABLE_SHARE * length
    closed = len(file.points) > 3 and gap <= most
    return closed, length + (gap if closed else 0.0)


def _road(file: TrackFile, closed: bool, spare: float = 0.0) -> _Road:
    """Walls at the stated widths, square to the direction from the point before to the next."""
    points, right, left = file.points, file.right, file.left
    if closed and np.hypot(*(points[0] - points[-1])) > 1e-6:
        points, right, left = (np.concatenate((a, a[:1])) for a in (points, right, left))
    ahead = np.vstack([points[1:], points[1:2] if closed else points[-1:]])
    behind = np.vstack([points[-2:-1] if closed else points[:1], points[:-1]])
    after, before = ahead - points, points - behind
    for d in (after, before):
        length = np.hypot(*d.T)
        d /= np.where(length > 0.0, length, 1.0)[:, None]
    direction = after + before
    size = np.hypot(*direction.T)
    direction = np.where((size > 1e-9)[:, None], direction, after)
    direction /= np.hypot(*direction.T)[:, None]
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    right, left = (1.0 - HAIR) * right - spare, (1.0 - HAIR) * left - spare
    return _Road(points, points - right[:, None] * normal, points + left[:, None] * normal)


def _opened(path: Path, road: _Road, total: float, options: Options, drawing: Drawing) -> _Road:
    """Cut a closed road open: a robot's path has a beginning and an end."""
    start = 0.0 if options.start is None else options.start
    gap = GAP if options.gap is None else options.gap
    if not 0.0 <= start < total:
        raise refused(path, f"--start {start:g}: the track is {total:.1f} m long, from 0")
    if not 0.0 < gap < 0.5 * total:
        raise refused(path, f"--gap {gap:g}: more than 0 and less than half of {total:.1f} m")
    cut = road.cut(start, total - gap)
    drawing.changes.append(
        f"closed track cut open at station {start:g} m, {place(cut.centre[0])}: the corridor ends "
        f"{gap:g} m before it begins (--start, --gap; --open: it is no closed one)"
    )
    return cut


def _wall(
    path: Path, side: str, line: FloatArray, width: float, drawing: Drawing, closed: bool
) -> FloatArray:
    try:
        clean, loops = without_loops(line, LONGEST_LOOP * width)
    except CrossingError as error:
        raise refused(
            path,
            f"the {side} edge crosses itself at {place(error.point)}: the track passes over itself "
            f"there, or two of its stretches overlap, or its points are noisy; {SMOOTH}"
            f"{ELSEWHERE * closed}",
        ) from None
    drawing.changes += listed(
        [loop for loop in loops if loop[1] >= SHORTEST_LOOP],
        lambda loop: (
            f"{side} wall crossed itself in a tight bend at {place(loop[0])}: loop of "
            f"{loop[1]:.2f} m cut off"
        ),
    )
    return clean
