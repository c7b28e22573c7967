"""Who pushed whom: robots that came into a contact otherwise than by their own commands.

A robot counts as pushed when it closes on the other body by more than its command says, while it
touches a further robot; that one is the pusher, or whoever pushes it in turn. A robot that stands
by command and is pushed by nobody was run into by the other. Where there is no other that came, at
a wall or where both stand, it was moved by one that it touches, whichever way: by itself it does
not move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from physim.contacts import touching
from physim.geometry.motion import arcs
from physim.record import Record
from physim.tolerances import PUSH
from physim.validation.decisions import DecisionTable


@dataclass(frozen=True)
class Touch:
    """Where two bodies touch: a sample, a point [m], and the normal from a to b."""

    a: int
    b: int
    step: int
    point: tuple[float, float]
    normal: tuple[float, float]

    def towards(self, robot: int) -> tuple[float, float]:
        """Normal from a robot of the two to the other body."""
        x, y = self.normal
        return (x, y) if robot == self.a else (-x, -y)


def pushed_by(record: Record, table: DecisionTable, robot: int, touch: Touch) -> int | None:
    """Robot to be charged in place of ``robot``; None where it moved by its own command."""
    if touch.step == 0:
        return None
    ends = {touch.a, touch.b}
    pusher = _pusher(record, table, robot, touch, ends)
    if pusher is not None or not stands(table, robot, touch.step):
        return pusher
    other = touch.a + touch.b - robot
    if other < record.robots:
        pusher = _pusher(record, table, other, touch, ends)
        if pusher is None and not stands(table, other, touch.step):
            return other
    for one in (robot, other):
        if pusher is None and one < record.robots:
            pusher = _pusher(record, table, one, touch, ends, carried=True)
    return pusher


def stands(table: DecisionTable, robot: int, step: int) -> bool:
    """Whether a robot was commanded to stand in the step that led to a sample.

    That is, to move no point of its footprint by `PUSH` or more: a command of 1e-15 rad/s stands.
    """
    if table.last(robot, step - 1) is None:
        return False
    v, omega = table.held(robot, step - 1)
    return abs(v) + float(table.radius[robot]) * abs(omega) < PUSH


def _pusher(
    record: Record,
    table: DecisionTable,
    robot: int,
    touch: Touch,
    seen: set[int],
    carried: bool = False,
) -> int | None:
    """Robot at the end of the chain of pushes into a contact, not counting those ``seen``.

    ``carried``: of a robot that stands by command, whichever way it moves.
    """
    if not carried and not _exceeds_command(record, table, robot, touch):
        return None
    for contact in _contacts(record, robot, touch.step):
        third = contact.a + contact.b - robot
        if third >= record.robots or third in seen:
            continue
        idle = stands(table, third, touch.step)
        further = _pusher(record, table, third, contact, seen | {third}, carried and idle)
        if further is not None:
            return further
        if not idle:
            return third
    return None


def _exceeds_command(record: Record, table: DecisionTable, robot: int, touch: Touch) -> bool:
    """Whether a robot closed on the other body by more than its command says."""
    step = touch.step
    before, now = record.read("/steps/pose", step - 1, step + 1)[:, robot]
    command = np.array([table.held(robot, step - 1)])
    x, y, turn = (now - arcs(before[None], command, record.dt)[0]) / record.dt
    across, along = touch.point[0] - now[0], touch.point[1] - now[1]
    nx, ny = touch.towards(robot)
    return bool((x - turn * along) * nx + (y + turn * across) * ny > PUSH)


def _contacts(record: Record, robot: int, step: int) -> list[Touch]:
    """Contacts of a robot in the step that led to a sample, the hardest first."""
    rows = record.contacts
    rows = touching(rows[(rows["step"] == step) | (rows["step"] == step - 1)])
    rows = rows[(rows["a"] == robot) | (rows["b"] == robot)]
    rows = rows[np.argsort(-rows["impulse"], kind="stable")]
    return [
        Touch(
            int(row["a"]), int(row["b"]), step,
            (float(row["x"]), float(row["y"])), (float(row["nx"]), float(row["ny"])),
        )
        for row in rows
    ]  # fmt: skip
