"""Room that robots have: distances, collision times (11) and corridor widths (Figs. 3, 4, 6).

Distances and collision times are those over time and for all pairs; extremes are in `Figures`.

A decision's collision time covers only the bodies that the robot must consider, under the
command that it would take; `pair_collision_times` are what an observer sees who knows all
poses and present commands.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import shapely

from physim.analysis.metrics.metric import Moment, Series
from physim.analysis.metrics.progress import blocks, twists_over
from physim.errors import PhysimError
from physim.geometry.queries import collision_times as times_of_pairs
from physim.geometry.shapes import FloatArray, IntArray, body_parts
from physim.record import Record
from physim.world.ground.corridor import SIDES, width_spacing, widths_at
from physim.world.walls import stretch_text

MOST_DISTANCES = 100_000
"""Distances that `pair_distances` works out."""


def collision_times(record: Record) -> Series | None:
    """Least collision time (11) [s] at each step with decisions, over all robots (Figs. 3, 6).

    Time (K,) of the steps, values (K,); inf where the decisions saw no collision coming. None where
    the controller reports no collision times.
    """
    times = record.column("collision_time", absent=np.nan)
    if np.isnan(times).all():
        return None
    steps, place = np.unique(record.updates["step"], return_inverse=True)
    least = np.full(len(steps), np.inf)
    np.fmin.at(least, place, times)
    return Series(steps * record.dt, least)


def pair_distances(record: Record, most: int = MOST_DISTANCES) -> tuple[Series, IntArray]:
    """Distances (11) [m] of every pair of robots over time (Figs. 3, 6): 0 where they touch.

    Time (K,), values (K, P) and the pairs (P, 2), robots a < b. Samples are evenly spread over
    the recorded ones, so that there are at most about ``most`` distances, and two times at least:
    the shortest ones are `shortest_distance`'s, not theirs.
    """
    pairs = np.array(list(combinations(range(record.robots), 2)), dtype=np.int64).reshape(-1, 2)
    count = min(record.samples, max(2, most // max(1, len(pairs))))
    rows = np.unique(np.linspace(0, record.samples - 1, count).round().astype(np.int64))
    if not record.samples or not len(pairs):
        return Series(np.zeros(0), np.zeros((0, len(pairs)))), pairs
    shapes = np.stack([placed(record, i, record.pose[rows, i]) for i in range(record.robots)])
    found = shapely.distance(shapes[pairs[:, 0]], shapes[pairs[:, 1]])
    return Series(record.time[rows], np.asarray(found.T)), pairs


def placed(record: Record, robot: int, pose: FloatArray) -> FloatArray:
    """Shape of a body that moves at poses (K, 3), as shapely geometries (K,), world frame."""
    cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    turn = np.stack([np.stack([cos, sin], -1), np.stack([-sin, cos], -1)], axis=1)
    own = body_parts(record.shapes, robot)
    parts = [shapely.polygons(part @ turn + pose[:, None, :2]) for part in own]
    whole = parts[0] if len(parts) == 1 else shapely.multipolygons(np.stack(parts, axis=-1))
    return np.asarray(whole)


HORIZON = 10.0
"""[s] Later collisions are not looked for."""
MOST_TIMES = 400_000
"""Pairs and moments that are worked out; of more, moments are farther apart than decisions."""


def pair_collision_times(record: Record, horizon: float = HORIZON) -> tuple[Series, FloatArray]:
    """Least collision time over all pairs of robots after every step with decisions; of a log that
    was judged after every step, and of robots with movers and what can be pushed, too.

    Time (K,) [s] and values (K,) [s], inf where no pair meets within ``horizon``; and the pairs
    (K, 2) that would meet first. Each robot keeps the command applied to it then, on its arc; of a
    log the motion seen.
    """
    steps = record.steps if record.judged else np.unique(record.updates["step"])
    bodies = record.moving if record.judged else record.robots
    i, j = np.triu_indices(bodies, 1)
    i, j = i[i < record.robots], j[i < record.robots]
    steps = steps[np.isin(steps, record.steps) & (steps < record.steps_run)]
    if not len(steps) or not len(i):
        return Series(np.zeros(0), np.zeros(0)), np.zeros((0, 2))
    steps = steps[:: -(-len(steps) * len(i) // MOST_TIMES)]
    twist = np.zeros((len(steps), bodies, 3))
    for begin, end in blocks(record):
        mine = slice(*np.searchsorted(steps, (begin, end)))
        if mine.start < mine.stop:
            twist[mine] = twists_over(record, begin, end)[steps[mine] - begin]
    pose, shapes = record.moving_pose[np.searchsorted(record.steps, steps)], record.shapes
    reach = np.hypot(twist[:, :, 0], twist[:, :, 2]) * horizon + shapes.radius[:bodies]
    gap = np.hypot(*np.moveaxis(pose[:, i, :2] - pose[:, j, :2], 2, 0))
    k, pair = np.nonzero(gap <= reach[:, i] + reach[:, j])
    a, b = i[pair], j[pair]
    times = np.full(gap.shape, np.inf)
    times[k, pair] = times_of_pairs(
        shapes, a, pose[k, a], twist[k, a], shapes, b, pose[k, b], twist[k, b], horizon,
        frame="body",
    )  # fmt: skip
    first = np.argmin(times, axis=1)
    least = times[np.arange(len(steps)), first]
    who = np.where(np.isfinite(least)[:, None], np.stack((i[first], j[first]), axis=1), 0)
    return Series(np.asarray(steps * record.dt), least), who


def shortest_pair_collision_time(record: Record, horizon: float = HORIZON) -> Moment | None:
    """Shortest collision time of any pair under present commands [s]; None where none meets."""
    (time, least), who = pair_collision_times(record, horizon)
    if not np.isfinite(least).any():
        return None
    k = int(np.argmin(least))
    step = round(float(time[k]) / record.dt)
    return Moment(float(least[k]), step, float(time[k]), *map(int, who[k]))


class Width(NamedTuple):
    """Free width at places along a path: shortest distance to the left plus to the right [m]."""

    station: FloatArray
    """(K,) [m] along the path"""
    points: FloatArray
    """(K, 2) [m] the places"""
    left: FloatArray
    """(K, 2) [m] nearest point of a boundary or obstacle on the left; not finite where open"""
    right: FloatArray
    """(K, 2) [m] the same on the right"""
    width: FloatArray
    """(K,) [m]; inf where a side is open, NaN where the two nearest points are not on opposite
    sides (`physim.world.ground.corridor.side_feet`): there is no width there"""


def corridor_width(record: Record, robot: int = 0) -> Width:
    """Width along a robot's path, every 0.1 m, at 60 to 100,000 places (Fig. 4).

    In a world with a corridor: to its left and to its right wall. Obstacles, and boundaries of
    other worlds, are left where they lie in the half-plane left of the path's direction, and so
    for right; a path close to a bent boundary may find the same one on both sides there. Near a
    wall across the path, as at the end of a room, one or both nearest points may lie on that wall,
    before or behind the path: such places have no width. Raises PhysimError for a robot that
    is not there.
    """
    if not (isinstance(robot, int | np.integer) and 0 <= robot < record.robots):
        raise PhysimError(f"robot {robot!r} given; there are 0 to {record.robots - 1}")
    lines = record.paths
    run = slice(lines.start[robot], lines.start[robot + 1])
    length = float(lines.station[run][-1])
    every = width_spacing(length)
    at: FloatArray = every * np.arange(float(int(length / every + 1e-9) + 1))
    walls, obstacles = sides_of(record)
    found = widths_at(lines.points[run], at, obstacles, walls)
    counts = ~np.isfinite(found.width) | found.between
    width = np.where(counts, found.width, np.nan)
    return Width(at, found.point, found.left_foot, found.right_foot, width)


def sides_of(record: Record) -> tuple[tuple[FloatArray, FloatArray] | None, FloatArray]:
    """Segments (S, 4) ax, ay, bx, by [m] of a corridor's two walls, and of all else.

    None for a world without a corridor. Its caps are left out.
    """
    corridor = record.world_settings.get("corridor") is not None
    named: dict[str, FloatArray] = {}
    others = [np.zeros((0, 4))]
    for body in record.bodies[record.moving :]:
        mine = [np.zeros((0, 4))]
        for points in body_parts(record.walls, body.id - record.moving):
            ends = points[1:] if len(points) == 2 else np.roll(points, -1, axis=0)
            mine.append(np.hstack((points[: len(ends)], ends)))
        if corridor and body.kind == "boundary":
            named[body.name] = np.concatenate(mine)
        else:
            others += mine
    if set(SIDES) <= set(named):
        return (named[SIDES[0]], named[SIDES[1]]), np.concatenate(others)
    return None, np.concatenate([*named.values(), *others])


def along_wall(record: Record, body: int, point: FloatArray | tuple[float, float]) -> str:
    """``at (1.5, 4), boundaries[0][16] to [17]``: a point (2,) [m] of a boundary of a run.

    Empty for what moves; the point alone for obstacles and the walls of a corridor.
    """
    if body < record.moving:
        return ""
    boundaries = record.world_settings.get("boundaries")
    written = boundaries if isinstance(boundaries, list | tuple) else None
    return stretch_text(written, record.bodies[body].name, point)


def near_wall(record: Record, robot: int, body: int, step: int) -> str:
    """Where along a wall it was nearest to a robot at a step, as `along_wall` says it.

    Empty for what moves, and where the record does not hold that step.
    """
    k = int(np.searchsorted(record.steps, step))
    if body < record.moving or k == len(record.steps) or record.steps[k] != step:
        return ""
    line = nearest_points(record, body, robot, np.asarray(record.pose_at(step)))
    return along_wall(record, body, line[0])


def nearest_points(record: Record, a: int, b: int, pose: FloatArray) -> FloatArray:
    """Nearest points (2, 2) [m] of two bodies with all that moves at ``pose`` (B, 3).

    Of bodies that overlap the two are one point, of both.
    """

    def shape(body: int) -> Any:
        if body < record.moving:
            return placed(record, body, pose[body][None])[0]
        parts = body_parts(record.walls, body - record.moving)
        return shapely.GeometryCollection(
            [shapely.LineString(one) if len(one) == 2 else shapely.Polygon(one) for one in parts]
        )

    return np.asarray(shapely.get_coordinates(shapely.shortest_line(shape(a), shape(b))))
