"""Faults of movers and of obstacles that can be pushed: where they start, and where movers go."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, place_text
from physim.geometry.polygon import circumscribed_radius, convex_parts, smallest_width
from physim.geometry.shapes import FloatArray
from physim.geometry.timed_paths import timed_paths, timed_poses
from physim.tolerances import CONTACT, TUNNEL_FRACTION
from physim.units import figure
from physim.world import Mover
from physim.world.faults import describe
from physim.world.ground.lines import placed_outline, placed_outlines
from physim.world.scene import Layout

SAGITTA = 1e-4
"""[m] by which a corner on an arc may pass beyond the hull of the outlines that are looked at"""
MOST_LOOKS = 2_000
"""of a way between two waypoints"""
FINER = 1_000
"""parts of a look in which is found when a mover leaves"""
BEYOND = 1e-6
"""[m] out of the accessible area that a mover may be: rounding of where it joins a wall"""


def mover_step_faults(step: float, movers: Sequence[Mover]) -> Iterator[Fault]:
    """Movers so fast that something could pass through them in a step, or they through it."""
    for k, mover in enumerate(movers):
        paths = timed_paths([mover.poses], [mover.moments], [mover.repeat])
        reach = circumscribed_radius(mover.outline)
        fastest = float((paths.row[:, 4] + reach * np.abs(paths.row[:, 6])).max())
        limit = TUNNEL_FRACTION * smallest_width(convex_parts(mover.outline))
        if fastest * step > limit:
            n = int(np.argmax(paths.row[:, 4] + reach * np.abs(paths.row[:, 6])))
            yield Fault(
                ("movers", k, "waypoints", n + 1),
                f"{describe(mover.name)} moves {figure(fastest * step)} m in a step of "
                f"{step:.6g} s on its way here; at most {limit:.4g} m are allowed, a quarter of "
                f"its smallest width: let it be slower, or use a step of at most "
                f"{limit / fastest:.2g} s",
            )


def way_faults(laid: Layout) -> Iterator[Fault]:
    """Movers that leave the accessible area on their way: the first place of each."""
    area = laid.area.polygon
    shapely.prepare(area)
    for k, mover in enumerate(laid.world.movers):
        outline, times = laid.moved[k].outline, mover.moments
        paths = timed_paths([mover.poses], [times], ["once"])
        reach = circumscribed_radius(outline)
        for n in range(1, len(times)):
            row = paths.row[n - 1]
            radius = reach + (abs(row[4] / row[6]) if row[6] else 0.0)
            turn = abs(row[6]) * (times[n] - times[n - 1])
            angle = 2.0 * np.sqrt(2.0 * SAGITTA / radius)
            looks = np.linspace(times[n - 1], times[n], 2 + min(MOST_LOOKS, int(turn / angle)))
            poses = np.vstack([timed_poses(paths, float(time)) for time in looks])
            if (found := _out(outline, poses, area)) is not None:
                first, (x, y), far = found
                finer = np.linspace(looks[first], looks[first + 1], FINER + 1)
                poses = np.vstack([timed_poses(paths, float(time)) for time in finer])
                again = _out(outline, poses, area)
                yield Fault(
                    ("movers", k, "waypoints", n),
                    f"{describe(mover.name)} leaves the accessible area on its way here, first at "
                    f"{finer[again[0] if again else 0]:.4g} s, and farthest by {figure(far)} m at "
                    f"{place_text(x, y)}; keep its whole footprint between the boundaries and off "
                    "the obstacles",
                )
                break


def _out(outline: FloatArray, poses: FloatArray, area: Any) -> tuple[int, FloatArray, float] | None:
    """Last of poses (n, 3) before an outline leaves an area, and where and how far [m] it is out.

    Of each two poses that follow each other all in between is looked at, as if it were straight.
    """
    first, worst, place = len(poses), BEYOND, None
    for part in convex_parts(outline):
        placed = placed_outlines(part, poses)
        pairs = np.array([[placed[k], placed[k + 1]] for k in range(len(placed) - 1)])
        swept = shapely.convex_hull(shapely.multipolygons(pairs))
        for k in np.flatnonzero(~shapely.covers(area, swept)).tolist():
            points = shapely.get_coordinates(shapely.difference(swept[k], area))
            away = shapely.distance(shapely.points(points), area)
            if len(points) and away.max() > BEYOND:
                first = min(first, k)
                if away.max() > worst:
                    worst, place = float(away.max()), points[np.argmax(away)]
    return None if place is None else (first, place, worst)


def moved_faults(laid: Layout) -> Iterator[Fault]:
    """Movers and obstacles that can be pushed which start in or against something."""
    if not laid.moved:
        return
    robots = [placed_outline(*one) for one in zip(laid.footprints, laid.start, strict=True)]
    there = [(describe(name), shape) for name, shape in zip(laid.names, robots, strict=True)]
    bodies = list(there)
    for one in laid.moved:
        shape, name = placed_outline(one.outline, one.start), describe(one.name)
        is_mover = one.kind == "mover"
        place = (*one.key, "waypoints" if is_mover else "corners")
        for other, body in there if is_mover else (*bodies, *laid.walls, *laid.solids):
            if shapely.dwithin(shape, body, CONTACT):
                said = "overlaps" if shape.intersection(body).area > 0.0 else "touches"
                yield Fault(place, f"{name} {said} {other} at the start; move them apart")
        if not is_mover and not laid.area.polygon.covers(shape):
            message = "starts outside the accessible area; move it between the boundaries"
            yield Fault(place, f"{name} {message}")
        bodies.append((name, shape))
