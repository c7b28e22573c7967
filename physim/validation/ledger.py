"""The analytic contacts of a run: contacts and near approaches computed from the poses alone.

Every pair robot-robot and robot-boundary is followed over every step, block by block, so memory
stays flat however long the run. Footprints and walls come from the record; what the engine said
is not looked at here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.record import Record
from physim.tolerances import CONTACT
from physim.validation.scan import FULL, scan_robots, scan_walls

BLOCK_POSES = 1 << 14
"""Poses of robots in one block."""
LEAST_STEPS = 16
"""Steps in a block of very many robots."""

NEAR = np.dtype(
    [("step", "<i8"), ("a", "<i4"), ("b", "<i4"), ("distance", "<f8"), ("entry", "<f8")]
)
"""A pair that is near at a sample: signed distance [m]; entry [s] since the sample before of a
contact that begins in this step, NaN when none begins, inf when one should but was not found."""


@dataclass
class Approach:
    """A stretch of consecutive samples over which two bodies are nearer than ``reach``."""

    a: int
    b: int
    first: int
    last: int
    step: int
    """sample of the smallest distance"""
    distance: float
    """[m] smallest signed distance at a sample"""


@dataclass
class AnalyticContacts:
    """What the geometry says of K samples."""

    reach: float
    """[m] pairs farther apart than this are not listed"""
    samples: int
    robot_pairs: int
    wall_pairs: int
    touching: NDArray[np.void]
    """rows of `NEAR` at which the shapes touch, in the order of steps"""
    grazes: NDArray[np.void]
    """rows of `NEAR`: apart at both samples of the step, touching between them"""
    approaches: list[Approach] = field(default_factory=list)


def near_reach(record: Record, shapes: Shapes) -> float:
    """[m] what counts as near: the largest radius of a robot, about half its length.

    Never less than twice what any robot can move in a step of this record, so that no contact
    between samples is left out.
    """
    fastest = 0.0
    for poses, _ in pose_blocks(record):
        if len(poses) > 1:
            moved = np.abs(np.diff(poses, axis=0))
            way = np.hypot(moved[..., 0], moved[..., 1]) + shapes.radius * moved[..., 2]
            fastest = max(fastest, float(way.max()))
    return max(float(shapes.radius.max()), 2.0 * fastest + 1e-6)


def pose_blocks(record: Record) -> Iterator[tuple[FloatArray, int]]:
    """Poses (B, N, 3) of consecutive samples and the number of the first; each block begins with
    the last sample of the one before."""
    size = max(LEAST_STEPS, BLOCK_POSES // max(1, record.robots))
    for first in range(0, max(1, record.samples - 1), size):
        last = min(first + size + 1, record.samples)
        if last > first:
            yield np.ascontiguousarray(record.read("/steps/pose", first, last)), first


def analytic_contacts(record: Record) -> AnalyticContacts:
    """Compute the contacts and approaches of a record that holds the poses of every step.

    Raises RecordError if it is damaged.
    """
    shapes, walls = record.shapes, record.walls
    reach = near_reach(record, shapes)
    bodies = len(walls.body_start) - 1
    touching, grazes = [np.zeros(0, NEAR)], [np.zeros(0, NEAR)]
    running: dict[tuple[int, int], Approach] = {}
    done: list[Approach] = []
    for poses, start in pose_blocks(record):
        rows = near_rows(poses, start, shapes, walls, reach, record.dt)
        touching.append(rows[rows["distance"] <= CONTACT])
        grazes.append(rows[(rows["distance"] > CONTACT) & np.isfinite(rows["entry"])])
        follow(rows, running, done)
    done += running.values()
    done.sort(key=lambda approach: (approach.distance, approach.step, approach.a, approach.b))
    return AnalyticContacts(
        reach, record.samples, record.robots * (record.robots - 1) // 2, record.robots * bodies,
        np.concatenate(touching), np.concatenate(grazes), done,
    )  # fmt: skip


def near_rows(
    poses: FloatArray, start: int, shapes: Shapes, walls: Shapes, reach: float, dt: float
) -> NDArray[np.void]:
    """Rows of `NEAR` of a block, sorted by step, a and b; its first sample only if ``start`` is 0.

    The other blocks begin with a sample that has been looked at already.
    """
    first = 0 if start == 0 else 1

    def robots(who: IntArray, values: FloatArray) -> int:
        return scan_robots(poses, first, shapes, reach, dt, who, values)

    def boundaries(who: IntArray, values: FloatArray) -> int:
        return scan_walls(poses, first, shapes, walls, reach, dt, who, values)

    found = [filled(robots, 2), filled(boundaries, 2)]
    rows = np.zeros(sum(len(who) for who, _ in found), NEAR)
    who = np.concatenate([pair[0] for pair in found])
    values = np.concatenate([pair[1] for pair in found])
    rows["step"], rows["a"], rows["b"] = who[:, 0] + start, who[:, 1], who[:, 2]
    rows["distance"], rows["entry"] = values.T
    return rows[np.lexsort((rows["b"], rows["a"], rows["step"]))]


def follow(
    rows: NDArray[np.void], running: dict[tuple[int, int], Approach], done: list[Approach]
) -> None:
    """Lengthen the approaches that go on in a block, in place, and move ended ones to ``done``."""
    rows = rows[np.lexsort((rows["step"], rows["b"], rows["a"]))]
    if not len(rows):
        done += running.values()
        running.clear()
        return
    new = (np.diff(rows["a"]) != 0) | (np.diff(rows["b"]) != 0) | (np.diff(rows["step"]) > 1)
    for run in np.split(rows, np.flatnonzero(new) + 1):
        nearest = run[int(np.argmin(run["distance"]))]
        a, b, first, last = (int(v) for v in (run["a"][0], run["b"][0], *run["step"][[0, -1]]))
        now = Approach(a, b, first, last, int(nearest["step"]), float(nearest["distance"]))
        before = running.pop((a, b), None)
        if before is not None and before.last == first - 1:
            now.first = before.first
            if before.distance <= now.distance:
                now.step, now.distance = before.step, before.distance
        elif before is not None:
            done.append(before)
        running[a, b] = now


def filled(
    scan: Callable[[IntArray, FloatArray], int], columns: int
) -> tuple[IntArray, FloatArray]:
    """Output of a scan, (C, 3) and (C, ``columns``), with as much room as it needs."""
    room = 1024
    while True:
        who, values = np.empty((room, 3), dtype=np.int64), np.empty((room, columns))
        count = scan(who, values)
        if count != FULL:
            return who[:count], values[:count]
        room *= 4
