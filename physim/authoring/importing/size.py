"""How large the robots are, and whether paths have the room for them.

The shipped controller is tuned for boxes of about 1.8 × 1.0 m. With ``--robot fit`` everything
shrinks by one factor where the path has not the room for them: robots, speeds, and every setting
that is a length or a speed. Angles, times and gains stay, so the scaled group moves as the large
one would.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, hypot, log10

import numpy as np
import shapely

from physim.authoring.importing.area import Place
from physim.authoring.importing.drawing import Drawing, Shape, place
from physim.authoring.importing.drawn import Placed
from physim.authoring.importing.options import Options
from physim.geometry.shapes import FloatArray
from physim.world.ground.polyline import Polyline

LENGTH, WIDTH = 1.8, 1.0
"""[m] the box at size 1"""
ROOM = 1.8
"""[m] clearance that the box needs at size 1: half its diagonal, 1.03 m, and as much again as
the shipped controller needs to move on: with 1.2 m it stops in danger mode"""
ENOUGH = 0.98
"""[-] share of the room that is enough for the usual size: a path found on a grid may lack it"""
SMALLEST = 0.01
"""[-] factor of the smallest robots"""
MOST_SAMPLES = 5_000
"""Places of a path at which its clearance is looked up"""
SLIVER = 1e-6
"""[m] of a path outside the area that are rounding"""


@dataclass(frozen=True)
class Size:
    """Factor on the group, box (length, width) [m], and what is told of how it came about."""

    factor: float
    box: tuple[float, float]
    told: str


def fitting(factor: float) -> tuple[float, float]:
    """Length and width [m] of the box of a factor."""
    return float(f"{LENGTH * factor:.2g}"), float(f"{WIDTH * factor:.2g}")


def factor_of(length: float) -> float:
    """Factor by which speeds and distances go of robots of a length [m]."""
    return round(length / LENGTH, 2 if length > 0.2 else 4)


def room_of(box: tuple[float, float]) -> float:
    """Clearance [m] that lets a robot of given length and width turn, and a margin."""
    return 0.5 * hypot(*box) + 0.15 * box[0] / LENGTH


def size_of(
    drawing: Drawing, where: Place, line: FloatArray, options: Options, reach: float
) -> Size:
    """Size of the boxes of a group on a path (n, 2) [m]; its lanes go ``reach`` [m] beside it.

    ``reach`` is that at factor 1. Raises ImportSourceError where they do not fit.
    """
    shape = next(iter(drawing.of("path")), None)
    if isinstance(options.robot, tuple):
        factor = factor_of(options.robot[0])
        advice = "move it, or give a smaller --robot LENGTH,WIDTH, or --robot fit"
        check_way(drawing, where, line, options.robot[1], "path", shape, advice)
        return Size(factor, options.robot, "as asked (--robot)")
    gap, at = check_way(drawing, where, line, 0.0, "path", shape, "move it")
    most = gap / (ROOM + reach)
    factor = two_digits(1.0 if most > ENOUGH else most)
    small = ",".join(f"{side:g}" for side in fitting(factor))
    if factor < SMALLEST:
        raise drawing.refusal(
            f"the path comes within {gap:.3g} m of a wall at {place(at)}; it must keep away from "
            "the walls; move it, or check --scale",
            shape,
        )
    if options.robot is None and factor < 1.0:
        raise drawing.refusal(
            f"{gap:.3g} m to a wall at {place(at)}: robots of the usual {LENGTH:g} x {WIDTH:g} m "
            f"need {ROOM + reach:g} m{' with so many --lanes' if reach else ''}; move the path, "
            f"--robot fit makes them {small}, or say --robot LENGTH,WIDTH",
            shape,
        )
    told = "as large as fits (--robot fit)" if options.robot else "the usual size (--robot)"
    return Size(factor, fitting(factor), told)


def two_digits(factor: float) -> float:
    """A factor rounded down to two digits."""
    digits = 10.0 ** (1 - floor(log10(factor))) if factor > 0.0 else 1.0
    return floor(factor * digits + 1e-9) / digits


def size_as_drawn(robots: Sequence[Placed]) -> Size:
    """Size of a group that is drawn: speeds and distances go by the shortest of its robots."""
    lengths = [one.box[0] for one in robots]
    shortest = robots[int(np.argmin(lengths))]
    told = "as drawn"
    if max(lengths) > 1.5 * min(lengths):
        told += f", {min(lengths):.2f} to {max(lengths):.2f} m long; speeds go by the shortest"
    return Size(factor_of(shortest.box[0]), shortest.box, told)


def check_way(
    drawing: Drawing,
    where: Place,
    line: FloatArray,
    width: float,
    what: str,
    shape: Shape | None,
    advice: str,
) -> tuple[float, FloatArray]:
    """Least clearance [m] along a path (n, 2) [m], and where (2,).

    Raises ImportSourceError, with ``advice``, for one that leaves the area, or passes too near a
    wall for a robot of a ``width`` [m].
    """
    beyond = shapely.get_parts(shapely.LineString(line).difference(where.area))
    beyond = beyond[shapely.length(beyond) > SLIVER]
    if len(beyond):
        ends = shapely.get_coordinates(beyond[0])
        at = ends[-1] if (ends[0] == line[0]).all() else ends[0]
        said = f"leaves the area at {place(at)}, or leads through a wall there"
        raise drawing.refusal(f"the {what} {said}{_named(drawing, at)}; {advice}", shape)
    way = Polyline(line)
    count = int(min(max(way.length / 0.05, 200), MOST_SAMPLES))
    points = np.vstack([way.at(np.linspace(0.0, way.length, count))[0], line])
    gaps = where.clearance.at(points)
    gap, at = float(gaps.min()), points[np.argmin(gaps)]
    if gap < 0.5 * width:
        raise drawing.refusal(
            f"the {what} passes {gap:.3g} m from a wall at {place(at)}{_named(drawing, at)}: "
            f"a robot {width:g} m wide does not fit; {advice}",
            shape,
        )
    return gap, at


def _named(drawing: Drawing, at: FloatArray) -> str:
    walls = [one for one in drawing.of("boundary", "obstacle") if one.label]
    wall = min(walls, key=lambda one: one.geometry.distance(shapely.Point(at)), default=None)
    return f" ({wall})" if wall is not None else ""
