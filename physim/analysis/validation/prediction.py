"""Collision times held against contacts: when was a contact due, and when did it come?

A prediction is made at a decision of one of the two bodies: collision time (11) of the pair under
the commands that both hold from then on, computed here from poses and commands, plus the time
then. What a mover is commanded is its twist at that moment, what can be pushed is to stand. After
the last decision before a contact both keep their commands, so the contact must come
when it was predicted, to TIME = 1e-6 s, and be seen at the sample after that. Slack: between two
samples bodies move on the chord, not on the arc (`tolerances.chord`), which shifts a contact by
the gap of the two over the closing speed.

Earlier predictions say for how long a contact lay ahead under the commands of the moment.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from physim import tolerances
from physim.analysis.validation.analytic_contacts import pair_distance
from physim.analysis.validation.decisions import STILL, DecisionTable
from physim.contacts import Kind, Phase
from physim.geometry.collision import collision_time_pair
from physim.geometry.motion import Twist, arc
from physim.geometry.shapes import FloatArray
from physim.record import Record

HORIZON = 10.0
"""[s] how far ahead one query looks; a contact later than that takes several"""
MOST_SLACK = 10.0 * HORIZON
"""[s] A touch is not looked for longer than that after the step at which it was found: a forged
command that turns 10^4 rad/s has a slack of hours."""
AS_COMMANDED = 1e-7
"""[m, rad] A robot within this of the arc that it was to follow has moved as commanded."""

AGREES = "agrees"
DISAGREES = "disagrees"
NOT_COMPARED = "cannot be compared: "
"""begins the third verdict, which ends in why"""
NOT_AS_COMMANDED = f"{NOT_COMPARED}a robot was pushed"
TURNED = f"{NOT_COMPARED}the mover turned"
TOUCHED_BEFORE = f"{NOT_COMPARED}they touched before"
NO_DECISION = f"{NOT_COMPARED}no decision before it"


@dataclass(frozen=True)
class Prediction:
    """What the last decision before a contact foretold, and what came."""

    a: int
    b: int
    step: int
    """first sample of the contact"""
    found: float
    """[s] time of that sample"""
    touched: float
    """[s] first touch between the samples, by the swept check; the sample where it has none"""
    made: float | None
    """[s] time of the last decision of either before the contact"""
    predicted: float | None
    """[s]; inf when no contact was predicted"""
    slack: float
    """[s] by which chord and tolerance may shift the contact"""
    verdict: str
    """`AGREES`, `DISAGREES`, or `NOT_COMPARED` and why"""

    @property
    def error(self) -> float | None:
        """[s] predicted time less time of first touch, where the two can be compared."""
        if self.predicted is None or self.verdict not in (AGREES, DISAGREES):
            return None
        return self.predicted - self.touched

    def due_text(self, digits: int) -> str:
        """When the contact was due, with so many decimals."""
        if self.predicted is None:
            return "-"
        return "none" if math.isinf(self.predicted) else f"{self.predicted:.{digits}f} s"


def pair_time(
    record: Record,
    a: int,
    b: int,
    pose: FloatArray,
    twist_a: Twist,
    twist_b: Twist,
) -> float:
    """Collision time (11) [s] of bodies a < b at ``pose`` (B, 3) under constant twists."""
    shapes, mine, theirs = record.shapes, np.array(twist_a), np.array(twist_b)
    if b < record.moving:
        return collision_time_pair(shapes, a, pose[a], mine, shapes, b, pose[b], theirs, HORIZON)
    still, wall = np.zeros(3), b - record.moving
    return collision_time_pair(record.walls, wall, still, still, shapes, a, pose[a], mine, HORIZON)


class Predictor:
    """Makes predictions for pairs of one record."""

    def __init__(self, record: Record, table: DecisionTable) -> None:
        self.record = record
        self.table = table

    def due(self, a: int, b: int, step: int, until: float = HORIZON) -> float:
        """Collision time [s] from a step on, under the commands held from then on.

        Looked for up to ``until`` [s], at least; inf where there is none. Each query begins on the
        arcs where the one before ended, so that none needs more advances than it may take.
        """
        other = self.table.held(b, step) if b < self.record.moving else STILL
        held = {a: self.table.held(a, step), b: other}
        start = self.record.pose_at(step)
        for k in range(max(1, math.ceil(until / HORIZON))):
            later = k * HORIZON
            pose = start.copy()
            for i in (i for i in held if k and i < self.record.moving):
                (x, y, heading), (v, omega, lateral) = start[i], held[i]
                pose[i] = arc(x, y, heading, v, omega, lateral, later)
            found = pair_time(self.record, a, b, pose, held[a], held[b])
            if math.isfinite(found):
                return later + found
        return math.inf

    def predict(self, a: int, b: int, step: int, touched: float, closing: float) -> Prediction:
        """Hold the contact that begins at ``step`` against what was predicted before it.

        ``touched`` [s] is the first touch by the swept check, ``closing`` [m/s] the speed at
        which the two closed.
        """
        dt, found = self.record.dt, step * self.record.dt
        robots = [i for i in (a, b) if i < self.record.robots]
        moving = [i for i in (a, b) if i < self.record.moving]
        made = self.table.last_before(robots, step)
        if made is None:
            return Prediction(a, b, step, found, touched, None, None, 0.0, NO_DECISION)
        gap = tolerances.CONTACT + sum(
            tolerances.chord(*self.table.held(i, made), dt) for i in moving
        )
        slack = tolerances.TIME + gap / max(closing, tolerances.CLOSING_SPEED)
        until = found + dt + min(slack, MOST_SLACK) - made * dt
        predicted = made * dt + self.due(a, b, made, until)
        is_near = self._is_near(a, b, step, predicted, gap)
        slow = is_near and b < self.record.moving and predicted >= (step - 2) * dt
        verdict = DISAGREES
        if slow or found - dt - slack <= predicted <= found + slack:
            verdict = AGREES
        elif (
            predicted == made * dt  # they still touch
            or is_near  # perhaps on the arc alone, by less than the chord is off it
            or self._touched_then(a, b, made, step, predicted, slack)
        ):
            verdict = TOUCHED_BEFORE
        for i in moving:
            if not self._as_commanded(i, made, step):
                verdict = TURNED if i in self.table.movers else NOT_AS_COMMANDED
        return Prediction(a, b, step, found, touched, made * dt, predicted, slack, verdict)

    def _as_commanded(self, body: int, start: int, end: int) -> bool:
        before, now = (self.record.pose_at(step)[body] for step in (start, end))
        (x, y, heading), (v, omega, lateral) = before, self.table.held(body, start)
        goal = arc(x, y, heading, v, omega, lateral, (end - start) * self.record.dt)
        return bool(np.abs(np.array(goal) - now).max() <= AS_COMMANDED)

    def _is_near(self, a: int, b: int, step: int, predicted: float, gap: float) -> bool:
        """Whether the two are within 2 ``gap`` at the predicted time, up to ``step``: a graze."""
        place = predicted / self.record.dt
        if place > step + 1:
            return False
        before = max(self.record.begun_at, min(math.floor(place), self.record.steps_run - 1))
        start, end = self.record.pose_at(before), self.record.pose_at(before + 1)
        now = start + (place - before) * (end - start)
        return abs(pair_distance(self.record, now, a, b)) <= 2.0 * gap

    def _touched_then(
        self, a: int, b: int, made: int, step: int, predicted: float, slack: float
    ) -> bool:
        """Whether the two touched at the predicted time, in passing, before the contact."""
        rows, dt = self.record.contacts_over(made + 1, step + 1), self.record.dt
        rows = rows[(rows["a"] == a) & (rows["b"] == b) & (rows["phase"] == Phase.BEGAN)]
        when = rows["step"][(rows["step"] < step) | (rows["kind"] == Kind.SWEPT)]
        came = (when * dt - dt - slack <= predicted) & (predicted <= when * dt + slack)
        return bool(came.any())

    def ahead(self, contact: Prediction) -> float:
        """[s] for how long before a contact it lay ahead at every decision of the two.

        At those of the last `HORIZON`, and at the last one however early.
        """
        dt, touched, made = self.record.dt, contact.touched, contact.made or 0.0
        first = min(round(made / dt), contact.step - math.floor(HORIZON / dt))
        robots = [i for i in (contact.a, contact.b) if i < self.record.robots]
        steps = np.unique(np.concatenate([self.table.steps(i) for i in robots]))
        lead = 0.0
        for step in steps[(steps >= first) & (steps < contact.step)][::-1].tolist():
            before = touched - step * dt
            if math.isinf(self.due(contact.a, contact.b, step, before)):
                break
            lead = before
        return lead
