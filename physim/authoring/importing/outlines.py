"""The outline of a drawn robot: which way it heads, and its footprint in its own frame."""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, listed, place
from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray

Footprint = tuple[float, float] | FloatArray
"""Length and width [m], or an outline (n, 2) [m] in the robot's frame"""
AS_SMALL = 0.01
"""[-] by which drawn rectangles differ in area that are as small: coordinates are rounded"""
ALIKE = 0.02
"""[-] of the root of its area by which an outline may miss its mirror image"""
DENT = 0.002
"""[m] Rounding to the millimetre moves a corner by 0.7 mm, and those beside it the other way."""
AS_NEAR = 0.2
"""[-] by which the cosines of two angles to the path differ at most that are as near"""
ROUND = 0.915
"""[-] least over greatest distance from its centre of an outline without a direction of its own: an
octagon has 0.924, an oval that is a tenth longer than wide 0.909"""
SQUARE, ASKEW = 0.6, 0.05
"""[-] share of an outline that lies along the sides of its rectangle, and [rad] to what angle"""
AS_LONG = 0.02
"""[-] of the moments of an outline by which they differ at least in one that has a long axis"""
FEW_CORNERS = 6
"""of an outline that lies on its sides; one with more may be an oval, which has none"""
MOST_CORNERS = 100
"""of an outline whose mirror images are looked at; what has more is round"""


def drop_marks(drawing: Drawing) -> None:
    """Leave out outlines of robots within those of others, as of the heading; they are listed.

    So are those that are drawn twice, as the filling and the line of one shape, unless they have
    names of their own. Those that stay get their names.
    """
    outlines = [one.outline for one in drawing.robots]
    if len(outlines) < 2 or min(map(len, outlines)) < 3:
        drawing.name_robots()
        return
    shapes = shapely.make_valid(np.array([shapely.Polygon(one) for one in outlines], dtype=object))
    within, about = shapely.STRtree(shapes).query(shapes, predicate="covered_by")
    is_less = shapely.area(shapes[within]) < shapely.area(shapes[about])
    marks = {int(k): int(j) for k, j in zip(within[is_less], about[is_less], strict=True)}
    pairs = {(int(k), int(j)) for k, j in zip(within, about, strict=True)}
    names = [one.drawn_name for one in drawing.robots]
    twice = {  # and each of which earlier one
        k: j for k, j in sorted(pairs, reverse=True)
        if j < k and (j, k) in pairs and names[j] == names[k]
    }  # fmt: skip
    left_out = marks.keys() | twice.keys()
    kept = [k for k in range(len(outlines)) if k not in left_out]
    drawing.robots = [drawing.robots[k] for k in kept]
    drawing.name_robots()  # what is left out has no name to keep
    called = {k: one.name for k, one in zip(kept, drawing.robots, strict=True)}
    drawing.changes += listed(
        [
            f"robot at {place(outlines[k][0])}: within {called.get(j, 'another')}, a mark on it, "
            "left out"
            for k, j in marks.items()
        ]
        + [
            f"robot at {place(outlines[k][0])}: {called.get(j, 'another')} drawn twice, left out"
            for k, j in twice.items()
        ]
    )


def rectangle_of(outline: FloatArray, ahead: FloatArray) -> tuple[FloatArray, float]:
    """Middle (2,) [m] and heading [rad] of the rectangle about an outline that a robot takes.

    The smallest one lies on a side of the convex hull; an oval has an axis instead. Of all that are
    larger by `AS_SMALL` at most, and their four directions, those count in which the outline is its
    own mirror image, as a triangle is on one of its sides. Where there is none (an arrow with a
    shaft lies smallest on a side of its head), its lines of symmetry count, if it has any; not so
    of what lies mostly along its sides (`SQUARE`), as a box without a corner, or an L. Of these
    directions the one nearest to the direction ``ahead``; of two as near, as at a corner of the
    path, the one along which the rectangle is longer. A round outline takes ``ahead`` itself.
    """
    hull = np.array(shapely.Polygon(outline).convex_hull.exterior.coords)
    whole, outline = outline, _corners(outline)
    if _is_round(outline):
        heading = atan2(ahead[1], ahead[0])
        return _box(hull, heading)[0], heading

    def area(angle: float) -> float:
        return float(np.prod(2.0 * _box(hull, angle)[1]))

    sides = [atan2(y, x) for x, y in np.diff(hull, axis=0)]
    least = min(map(area, sides))
    along = [angle for angle in sides if area(angle) <= least * (1.0 + AS_SMALL)]
    is_square = max(_share(outline, angle) for angle in along) >= SQUARE
    axis = None if is_square or len(outline) <= FEW_CORNERS else _long_axis(whole)
    if axis is not None and _is_mirrored(outline, axis):
        along = [axis]
    smallest = [angle + turn for angle in along for turn in (0.0, pi / 2.0)]
    axes = [angle for angle in smallest if _is_mirrored(outline, angle)]
    if not axes and not is_square:
        axes = [angle for angle in _lines(outline) if _is_mirrored(outline, angle)]
    axes = axes or smallest
    directions = [angle + turn for angle in axes for turn in (0.0, pi)]

    def rank(angle: float) -> float:
        half = _box(hull, angle)[1]
        cosine = float(cos(angle) * ahead[0] + sin(angle) * ahead[1])
        return cosine + AS_NEAR * float(half[0] > half[1] * (1.0 + AS_SMALL))

    heading = max(directions, key=rank)
    return _box(hull, heading)[0], (heading + pi) % (2.0 * pi) - pi


def _box(points: FloatArray, angle: float) -> tuple[FloatArray, FloatArray]:
    """Middle (2,) and half the extent (2,) [m] of the rectangle about points in a direction."""
    turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
    low, high = (points @ turn).min(axis=0), (points @ turn).max(axis=0)
    return turn @ (low + high) / 2.0, (high - low) / 2.0


def _corners(outline: FloatArray) -> FloatArray:
    """An outline about its centre of area, without points that do not show."""
    polygon = shapely.Polygon(outline)
    plain = polygon.simplify(0.2 * ALIKE * polygon.area**0.5)
    return np.asarray(np.array(plain.exterior.coords)[:-1] - plain.centroid.coords[0])


def _is_round(outline: FloatArray) -> bool:
    """Whether an outline about its centre is a circle, as coarsely as small ones are drawn."""
    inner = shapely.LinearRing(outline).distance(shapely.Point(0.0, 0.0))
    return bool(inner >= ROUND * np.hypot(*outline.T).max())


def _long_axis(outline: FloatArray) -> float | None:
    """Direction [rad] in which an outline is longest by its moments; None where in every one."""
    x, y = (outline - shapely.Polygon(outline).centroid.coords[0]).T
    after_x, after_y = np.roll(x, -1), np.roll(y, -1)
    cross = x * after_y - after_x * y
    cross *= np.sign(cross.sum())  # either way round
    xx, yy = (cross @ (u * u + u * v + v * v) for u, v in ((x, after_x), (y, after_y)))
    xy = cross @ (x * after_y + 2.0 * x * y + 2.0 * after_x * after_y + after_x * y) / 2.0
    is_long = hypot(xx - yy, 2.0 * xy) > AS_LONG * (xx + yy)
    return 0.5 * atan2(2.0 * xy, xx - yy) if is_long else None


def _share(outline: FloatArray, angle: float) -> float:
    """Share of an outline that goes in a direction, or across it."""
    x, y = (np.roll(outline, -1, axis=0) - outline).T
    off = np.abs((np.arctan2(y, x) - angle + pi / 4.0) % (pi / 2.0) - pi / 4.0)
    length = np.hypot(x, y)
    return float(length[off < ASKEW].sum() / length.sum())


def _lines(outline: FloatArray) -> list[float]:
    """Directions [rad] in which a polygon about its centre may be its own mirror image: every
    line of symmetry goes through the centre and a corner, or the middle of a side."""
    middles = (outline + np.roll(outline, -1, axis=0)) / 2.0
    return [atan2(y, x) for x, y in np.vstack([outline, middles])]


def _is_mirrored(outline: FloatArray, angle: float) -> bool:
    """Whether an outline about its centre is alike on both sides of a direction."""
    if len(outline) > MOST_CORNERS:
        return False
    c, s = cos(2.0 * angle), sin(2.0 * angle)
    image = shapely.LinearRing(outline @ np.array([[c, s], [s, -c]]))
    ring = shapely.LinearRing(outline)
    return bool(ring.hausdorff_distance(image) <= ALIKE * shapely.Polygon(ring).area ** 0.5)


def without_dents(outline: FloatArray) -> FloatArray:
    """A counter-clockwise outline (n, 2) [m] without corners that dent it by `DENT` at most.

    It covers the one given; all that was left out lies within `DENT` of its sides.
    """
    kept, count = list(range(len(outline))), len(outline)
    place = 0
    while place < len(kept) and len(kept) > 3:
        i, j, k = kept[place - 1], kept[place], kept[(place + 1) % len(kept)]
        side = outline[k] - outline[i]
        between = outline[[m % count for m in range(i + 1, k if k > i else k + count)]]
        right = side[1] * (between - outline[i])[:, 0] - side[0] * (between - outline[i])[:, 1]
        x, y = outline[j] - outline[i]
        if side[1] * x - side[0] * y < 0.0 and np.abs(right).max() <= DENT * np.hypot(*side):
            del kept[place]
            place = max(0, place - 1)
        else:
            place += 1
    return outline[kept]


def footprint_of(outline: FloatArray, centre: FloatArray, heading: float) -> Footprint:
    """Outline in the robot's frame [m], counter-clockwise; a rectangle as (length, width).

    To the millimetre, and `without_dents`: a round outline of many points would be slivers else.
    """
    c, s = cos(heading), sin(heading)
    own = counter_clockwise(((outline - centre) @ np.array([[c, -s], [s, c]])).round(3))
    own = without_dents(own)
    half = np.abs(own).max(axis=0)
    if len(own) == 4 and np.abs(np.abs(own) - half).max() <= 0.0015:
        return round(2.0 * float(half[0]), 2), round(2.0 * float(half[1]), 2)
    return own


def spans_of(outline: FloatArray) -> FloatArray:
    """Shorter and longer side [m] of the smallest rectangle about an outline."""
    rectangle = shapely.Polygon(outline).minimum_rotated_rectangle
    corners = shapely.get_coordinates(rectangle)[:3]
    return np.sort(np.hypot(*np.diff(corners, axis=0).T))
