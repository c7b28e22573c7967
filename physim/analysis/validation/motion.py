"""Did the robots move as commanded? Poses against exact arcs, from each sample to the next.

A robot that touches nothing follows the arc of its applied command exactly (the engine moves it
along the chord of that very arc), so its pose at each sample follows from the one before and from
the recorded commands. Left out are robots that one in contact could reach in the step: the engine
eases it out of an overlap, and it may push them on its way though they touch nothing at either
sample.

A robot in contact moves as far as the contact allows, and where that leads the engine alone knows.
But it takes nothing from nowhere: what robots that push each other may do in a step has no more
energy than what they were commanded to do, and they are eased by no more than their overlaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import pose_blocks
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.pushing import Pushing, TooFar
from physim.contacts import touching
from physim.geometry.motion import arcs
from physim.geometry.separation import body_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.record import Record
from physim.tolerances import ONE_STEP, PUSHED, ULPS


@dataclass(frozen=True)
class Stray:
    """A stretch of consecutive steps in which a robot did not follow its commands."""

    robot: int
    step: int
    """sample at the end of the first such step"""
    steps: int
    time: float
    """[s] of that sample"""
    gap: float
    """[m] largest distance of a pose from the end of the arc; in contact, of a step"""
    turn: float
    """[rad] largest difference of a heading; in contact, turn of a step"""
    allowed: float | None = None
    """[m] what a step may be in contact, turns included; None where the robot touches nothing"""

    @property
    def sentence(self) -> str:
        """What is wrong."""
        if self.allowed is None:
            return (
                f"it touches nothing, yet its pose is {self.gap:.3g} m and {self.turn:.3g} rad "
                "from where its command leads from the sample before"
            )
        return (
            f"in contact it moved {self.gap:.3g} m and {self.turn:.3g} rad in a step; its command "
            f"and what pushes it allow {self.allowed:.3g} m"
        )


@dataclass(frozen=True)
class Motion:
    """What the check of the motion looked at and found."""

    checked: int
    """steps of robots that touch nothing"""
    held: int
    """steps of robots in contact that were held to what they may move; 0 where no masses are
    known"""
    strays: tuple[Stray, ...]
    """in the order of time"""


class _Off(NamedTuple):
    """Steps (M,) of robots that end elsewhere than the arc."""

    step: IntArray
    robot: IntArray
    gap: FloatArray
    turn: FloatArray


def check_motion(record: Record, table: DecisionTable, mass: FloatArray | None) -> Motion:
    """Hold every pose against the one before; see the module for what is left out.

    ``mass`` (N,) [kg] of the robots; without it robots in contact are left out, too.
    """
    touched = _touched(record)
    checked = held = 0
    found, far = [], []
    pushing = None if mass is None else Pushing(record, mass)
    for poses, first in pose_blocks(record):
        last = first + len(poses) - 1
        command = record.commands_over("applied", first, last)
        free = ~touched[first:last] & ~touched[first + 1 : last + 1]
        checked += int(free.sum())
        found.append(_off(poses, first, command, record.dt, free))
        if pushing is not None:
            held += int((~free).sum())
            far.append(pushing.too_far(poses, first, command, ~free))
    off = _Off(*(np.concatenate(column) for column in zip(*found, strict=True)))
    strays = _strays(record, table, off, touched)
    if far:
        too_far = TooFar(*map(np.concatenate, zip(*far, strict=True)))
        for i in np.unique(too_far.robot).tolist():
            step, _, *sizes = (column[too_far.robot == i] for column in too_far)
            strays += _stretches(record, i, step, *sizes)
    return Motion(checked, held, tuple(sorted(strays, key=lambda one: (one.step, one.robot))))


def _touched(record: Record) -> NDArray[np.bool_]:
    """(K, N) whether a robot touches something at a sample."""
    touched = np.zeros((record.samples, record.robots), dtype=np.bool_)
    rows = touching(record.contacts)
    for who in ("a", "b"):
        mine = rows[rows[who] < record.robots]
        touched[mine["step"], mine[who]] = True
    return touched


def _off(
    poses: FloatArray, first: int, command: FloatArray, dt: float, free: NDArray[np.bool_]
) -> _Off:
    steps, robots = free.shape
    start = np.ascontiguousarray(poses[:-1].reshape(-1, 3))
    ends = arcs(start, np.ascontiguousarray(command.reshape(-1, 2)), dt).reshape(steps, robots, 3)
    apart = np.abs(poses[1:] - ends)
    gap, turn = np.hypot(apart[..., 0], apart[..., 1]), apart[..., 2]
    slack = ONE_STEP + ULPS * np.spacing(np.abs(poses[1:]).max(axis=2))
    step, robot = np.nonzero(free & ~((gap <= slack) & (turn <= slack)))
    return _Off(step + first + 1, robot, gap[step, robot], turn[step, robot])


def _strays(
    record: Record, table: DecisionTable, off: _Off, touched: NDArray[np.bool_]
) -> list[Stray]:
    shapes = record.shapes
    strays: list[Stray] = []
    for i in range(record.robots):
        mine = off.robot == i
        step, gap, turn = off.step[mine], off.gap[mine], off.turn[mine]
        shift = np.maximum(gap, turn * shapes.radius[i])
        kept = np.array(
            [
                not _pushed(record, table, shapes, i, int(k), float(far), touched)
                for k, far in zip(step, shift, strict=True)
            ],
            dtype=np.bool_,
        )
        step, gap, turn = step[kept], gap[kept], turn[kept]
        strays += _stretches(record, i, step, gap, turn)
    return strays


def _stretches(
    record: Record,
    robot: int,
    step: IntArray,
    gap: FloatArray,
    turn: FloatArray,
    allowed: FloatArray | None = None,
) -> Iterator[Stray]:
    """Steps of a robot in rising order, consecutive ones as one."""
    cuts = np.flatnonzero(np.diff(step) != 1) + 1
    for run in np.split(np.arange(len(step)), cuts) if len(step) else ():
        at = int(step[run[0]])
        yield Stray(
            robot, at, len(run), at * record.dt, float(gap[run].max()), float(turn[run].max()),
            None if allowed is None else float(allowed[run].max()),
        )  # fmt: skip


def _pushed(
    record: Record,
    table: DecisionTable,
    shapes: Shapes,
    robot: int,
    step: int,
    shift: float,
    touched: NDArray[np.bool_],
) -> bool:
    """Whether a robot may have been shifted by ``shift`` [m] by one that is eased out of a contact.

    Eased are robots that touch something at the sample before. Within the step such a one may go
    forth and back: it reaches as far as its poses differ, and as its command would take it, and
    `PUSHED` more. What it meets is shifted by no more than twice that.
    """
    if not touched[step - 1].any():
        return False
    before, after = record.pose_at(step - 1), record.pose_at(step)
    for j in np.flatnonzero(touched[step - 1]).tolist():
        x, y, turn = np.abs(after[j] - before[j]).tolist()
        v, omega = table.held(j, step - 1)
        radius = float(shapes.radius[j])
        reach = PUSHED + math.hypot(x, y) + radius * turn
        reach += (abs(v) + radius * abs(omega)) * record.dt
        if shift > 2.0 * reach:
            continue
        if body_distance(shapes, robot, before[robot], shapes, j, before[j]) <= reach:
            return True
    return False
