"""The analytic contacts of a run: contacts and near approaches computed from the poses alone.

Every pair of bodies that move, and of one that moves and a wall, is followed over every step,
block by block, so memory stays flat however long the run; movers not with each other, nor with
walls. Footprints and walls come from the record; what the engine said
is not looked at here. Between two samples position and angle go linearly, as the engine moves
them. Discs leave out only what is farther than ``reach`` and farther than the two could move in
the step, so a leap in a forged record makes dear the steps it is in, and no others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.decisions import movers_of
from physim.compiled import compiled
from physim.errors import RecordError
from physim.geometry.bodies import body_distance, point_gap
from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    IntRows3,
    Part,
    Rows2,
    Rows3,
    Shapes,
    read_only,
)
from physim.geometry.swept import swept_time
from physim.record import Record
from physim.tolerances import CONTACT

FULL = -1
"""Count returned when the output has no room for another row."""


@compiled
def travel_bound(start: FloatArray, end: FloatArray, radius: float) -> float:
    """Upper bound [m] on how far any point of a body moves in one step."""
    travel = np.hypot(end[0] - start[0], end[1] - start[1])
    return float(travel + radius * abs(end[2] - start[2]))


@compiled
def touch_in_step(before: float, now: float, moved: float) -> bool:
    """Whether a step may hold a contact that begins in it: only then it is looked at closely.

    ``before`` and ``now`` [m] are the distances at its two samples, ``moved`` [m] bounds the
    relative travel.
    """
    if before <= CONTACT:
        return False
    return now <= CONTACT or before + now <= moved + 4.0 * CONTACT


@compiled
def scan_robots(
    poses: Rows3,
    samples: int,
    robots: int,
    first: int,
    shapes: Shapes,
    reach: float,
    dt: float,
    room: int,
    who: IntRows3,
    values: Rows2,
) -> int:
    """Write a row for each pair of robots nearer than ``reach`` [m]; returns how many, or FULL.

    A pair that is farther apart has a row if it touches in the step that ends there.
    ``poses`` (B N, 3) are those of N ``robots`` at B ``samples``, which are looked at from
    ``first`` (0 or 1) on. ``who`` (C, 3), C being the ``room``, takes the sample's number in the
    block and robots a < b, ``values`` (C, 2) the signed distance [m] and the time since the sample
    before [s] at which a contact begins (NaN: none begins).
    """
    count = 0
    order = np.arange(robots)
    travel = np.zeros(robots)
    largest = 0.0
    for i in range(robots):
        largest = max(largest, shapes.radius[i])
    for k in range(first, samples):
        now, old, farthest = poses[robots * k :], poses[robots * max(0, k - 1) :], 0.0
        for i in range(robots):
            travel[i] = travel_bound(old[i], now[i], shapes.radius[i])
            farthest = max(farthest, travel[i])
        for m in range(1, robots):
            i = order[m]
            place = m
            while place > 0 and now[order[place - 1], 0] > now[i, 0]:
                order[place] = order[place - 1]
                place -= 1
            order[place] = i
        for m in range(robots):
            for n in range(m + 1, robots):
                a, b = min(order[m], order[n]), max(order[m], order[n])
                dx = now[order[n], 0] - now[order[m], 0]
                if dx > max(reach, travel[order[m]] + farthest) + shapes.radius[order[m]] + largest:
                    break
                moved = travel[a] + travel[b]
                far = max(reach, moved) + shapes.radius[a] + shapes.radius[b]
                dy = now[b, 1] - now[a, 1]
                if dx * dx + dy * dy > far * far:
                    continue
                d = body_distance(shapes, a, now[a], shapes, b, now[b])
                entry = np.nan
                if k > 0 and (d <= CONTACT or d <= moved):
                    before = body_distance(shapes, a, old[a], shapes, b, old[b])
                    if touch_in_step(before, d, moved):
                        entry = swept_time(shapes, a, old[a], now[a], shapes, b, old[b], now[b], dt)
                if d > reach and not np.isfinite(entry):
                    continue
                if count == room:
                    return FULL
                who[count, 0], who[count, 1], who[count, 2] = k, a, b
                values[count, 0], values[count, 1] = d, entry
                count += 1
    return count


@compiled
def scan_walls(
    poses: Rows3,
    samples: int,
    robots: int,
    first: int,
    shapes: Shapes,
    walls: Shapes,
    boundaries: int,
    reach: float,
    dt: float,
    room: int,
    who: IntRows3,
    values: Rows2,
) -> int:
    """`scan_robots` for each robot and each boundary or obstacle, whose id is N + its index.

    Of a wall the parts at its ends are left out that are farther from all poses than they reach.
    """
    count = 0
    still, ends = np.zeros(3), np.zeros(2, np.int64)
    for i in range(robots):
        radius, low_x, low_y, high_x, high_y = shapes.radius[i], np.inf, np.inf, -np.inf, -np.inf
        for k in range(samples):
            px, py = poses[robots * k + i, 0], poses[robots * k + i, 1]
            low_x, low_y = min(low_x, px), min(low_y, py)
            high_x, high_y = max(high_x, px), max(high_y, py)
        x, y = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
        near = np.hypot(high_x - x, high_y - y) + radius + reach + 1e-6
        for w in range(boundaries):
            ends[0], ends[1] = walls.body_start[w + 1], walls.body_start[w]
            for p in range(walls.body_start[w], walls.body_start[w + 1]):
                part = Part(walls.vertices, walls.part_start[p], walls.part_start[p + 1])
                if point_gap(part, x, y) <= near:
                    ends[0], ends[1] = min(ends[0], p), p + 1
            if ends[0] >= ends[1]:
                continue
            wall = Shapes(walls.vertices, walls.part_start, ends, walls.radius[w:])
            spare = 0.0  # the wall is farther than `reach` by that: no contact before it is used up
            for k in range(first, samples):
                end = poses[robots * k + i]
                start = poses[robots * max(0, k - 1) + i]
                if spare > 0.0:
                    spare -= travel_bound(start, end, radius)
                    if spare > 0.0:
                        continue
                d = body_distance(wall, 0, still, shapes, i, end)
                entry = np.nan
                if k > 0:
                    moved = travel_bound(start, end, radius)
                    if d <= CONTACT or d <= moved:
                        before = body_distance(wall, 0, still, shapes, i, start)
                        if touch_in_step(before, d, moved):
                            entry = swept_time(wall, 0, still, still, shapes, i, start, end, dt)
                if d > reach:
                    spare = d - reach - CONTACT
                    if not np.isfinite(entry):
                        continue
                if count == room:
                    return FULL
                who[count, 0], who[count, 1], who[count, 2] = k, i, robots + w
                values[count, 0], values[count, 1] = d, entry
                count += 1
    return count


FARTHEST_STEP = 1.0e6
"""[m] along an axis that no robot goes in one step: beyond it a search for contacts has no end"""
BLOCK_POSES = 1 << 14
"""Poses in one block."""
LEAST_STEPS = 16
"""Steps in a block of very many robots."""

NEAR = np.dtype(
    [("step", "<i8"), ("a", "<i4"), ("b", "<i4"), ("distance", "<f8"), ("entry", "<f8")]
)
"""A pair that is near at a sample: signed distance [m]; entry [s] since the sample before of a
contact that begins in this step, NaN when none begins, inf when one should but was not found."""


@dataclass
class AnalyticContacts:
    """What the geometry says of all samples."""

    reach: float
    """[m] pairs farther apart than this are not listed"""
    touching: NDArray[np.void]
    """rows of `NEAR` at which the shapes touch, in the order of steps"""
    grazes: NDArray[np.void]
    """rows of `NEAR`: apart at both samples of the step, touching between them"""
    nearest: NDArray[np.void]
    """a row of `NEAR` for each pair that came within ``reach``: where it was nearest, and first so;
    the nearest pair first"""


def pose_blocks(record: Record) -> Iterator[tuple[FloatArray, int]]:
    """Poses (K, B, 3) of consecutive samples and the step of the first; each block begins with
    the last sample of the one before. Raises RecordError for a step that no robot makes."""
    size = max(LEAST_STEPS, BLOCK_POSES // max(1, record.moving))
    for first in range(0, max(1, record.samples - 1), size):
        last = min(first + size + 1, record.samples)
        if last > first:
            poses = np.ascontiguousarray(record.read("/steps/pose", first, last))
            far = np.abs(np.diff(poses[..., :2], axis=0)).max(axis=(1, 2), initial=0.0)
            if (far > FARTHEST_STEP).any():
                k = int(np.argmax(far > FARTHEST_STEP))
                raise RecordError(
                    f"{record.where}: /steps/pose, row {first + 1 + k}: a step of {far[k]:.6g} m; "
                    "make the record again"
                )
            yield poses, record.begun_at + first


MOST_UNKNOWN = 1_000_000
"""Pairs that touch at a sample, beyond those in the record: as many as can be told apart in some
seconds. A thousand robots in one place have as many at two samples."""


def analytic_contacts(record: Record) -> AnalyticContacts:
    """Compute the contacts and approaches of a record that holds the poses of every step.

    Raises RecordError if it is damaged, and where far more touches than it says.
    """
    shapes, walls = record.shapes, record.walls
    reach = float(shapes.radius.max())  # about half the length of a robot
    touching, grazes, nearest = [np.zeros(0, NEAR)], [np.zeros(0, NEAR)], np.zeros(0, NEAR)
    room = Room()
    left, movers = len(record.contacts) + MOST_UNKNOWN, movers_of(record)
    for poses, start in pose_blocks(record):
        row = start - record.begun_at
        rows = near_rows(poses, row, shapes, walls, reach, record.dt, room)
        is_mover = (movers.start <= rows["a"]) & (rows["a"] < movers.stop)
        rows = rows[~(is_mover & ((rows["b"] < movers.stop) | (rows["b"] >= record.moving)))]
        rows["step"] += record.begun_at
        touching.append(rows[rows["distance"] <= CONTACT])
        left -= len(touching[-1])
        if left < 0:
            raise RecordError(
                f"{record.where}: bodies touch more than {MOST_UNKNOWN} times, counted over pairs "
                f"and samples, that /contacts, of {len(record.contacts)} rows, does not have; no "
                "run has such"
            )
        grazes.append(rows[(rows["distance"] > CONTACT) & np.isfinite(rows["entry"])])
        within = rows[rows["distance"] <= reach]
        nearest = np.concatenate((nearest, within))
        nearest = nearest[least_of_pairs(nearest["a"], nearest["b"], nearest["distance"])]
    return AnalyticContacts(reach, np.concatenate(touching), np.concatenate(grazes), nearest)


def least_of_pairs(a: IntArray, b: IntArray, values: FloatArray) -> IntArray:
    """Rows of the least value of each pair, of equal ones the first; the least of all first."""
    order = np.argsort(values, kind="stable")
    pairs = a[order].astype(np.int64) << 32 | b[order]
    return np.asarray(order[np.sort(np.unique(pairs, return_index=True)[1])])


def pair_distance(record: Record, pose: FloatArray, a: int, b: int) -> float:
    """Signed distance [m] of ``a``, which moves, and ``b`` of a record at poses (B, 3)."""
    shapes = record.shapes
    if b < record.moving:
        return float(body_distance(shapes, a, pose[a], shapes, b, pose[b]))
    still = read_only(np.zeros(3))
    return float(body_distance(shapes, a, pose[a], record.walls, b - record.moving, still))


class Room:
    """How many rows a scan may find: more once it was too few, for what comes next too."""

    def __init__(self) -> None:
        self.rows = 1024

    def filled(
        self, scan: Callable[[int, IntArray, FloatArray], int], columns: int
    ) -> tuple[IntArray, FloatArray]:
        """Output of a scan with as much room as it needs: (C, 3), and (C, ``columns``) or (C,)."""
        while True:
            who = np.empty((self.rows, 3), dtype=np.int64)
            values = np.empty((self.rows, columns) if columns > 1 else self.rows)
            count = scan(self.rows, who, values)
            if count != FULL:
                return who[:count], values[:count]
            self.rows *= 4


def near_rows(
    poses: FloatArray,
    start: int,
    shapes: Shapes,
    walls: Shapes,
    reach: float,
    dt: float,
    room: Room,
) -> NDArray[np.void]:
    """Rows of `NEAR` of a block, sorted by step, a and b; its first sample only if ``start`` is 0.

    The other blocks begin with a sample that has been looked at already.
    """
    first = 0 if start == 0 else 1
    (samples, robots), flat = poses.shape[:2], poses.reshape(-1, 3)
    scans = (
        partial(scan_robots, flat, samples, robots, first, shapes, reach, dt),
        partial(
            scan_walls, flat, samples, robots, first, shapes, walls, len(walls.radius), reach, dt
        ),
    )
    found = [room.filled(scan, 2) for scan in scans]
    rows = np.zeros(sum(len(who) for who, _ in found), NEAR)
    who = np.concatenate([pair[0] for pair in found])
    values = np.concatenate([pair[1] for pair in found])
    rows["step"], rows["a"], rows["b"] = who[:, 0] + start, who[:, 1], who[:, 2]
    rows["distance"], rows["entry"] = values.T
    return rows[np.lexsort((rows["b"], rows["a"], rows["step"]))]
