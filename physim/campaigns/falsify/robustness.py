"""How safe a run was, as one number: its signed swept clearance [m].

It is the least of three figures of a record:

- the shortest distance of two robots, and that of a robot and a boundary or obstacle, over the
  samples of all physics steps; negative where shapes overlap, by their depth;
- minus the depth of every contact between two samples, by exact geometry.

So it is at most 0 if and only if something touched, at a sample or between two: contacts between
samples are found without a miss, and the sign never errs. How deep a contact is the engine decides:
of runs with contacts the worse is that whose severest contact closed faster (`Judged.aim`). The
size may err to the high side, never
to the low one. A gap that opens and closes within a step without contact is that of the nearer
sample: too large by at most half of what the two travel in the step. The depth of a contact is that
at its samples, after the engine has eased the two apart.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from physim.analysis.metrics import Episode, Graze, contact_episodes, grazes, severest
from physim.analysis.metrics.distances import shortest_boundary_distance, shortest_distance
from physim.parts.declarations import NO_NUMBER
from physim.record import Record

ROBOTS, WALL = "robots", "wall"
"""Kinds of failure: two robots touch; a robot touches a boundary or an obstacle."""


LEADS = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4)
"""[-] of the time until the first contact: so long before it is each of the moments kept"""


class Moment(NamedTuple):
    """Where all robots were at a recorded sample."""

    time: float
    """[s]"""
    poses: tuple[tuple[float, float, float], ...]
    """[m, m, rad] of each robot"""


class Touched(NamedTuple):
    """The first contact of a run, at a sample or between two."""

    kind: str
    """`ROBOTS` or `WALL`"""
    pair: tuple[str, str]
    """names of the two bodies"""
    time: float
    """[s] of the first sample in contact, or of the sample after a contact between two"""
    modes: tuple[str, str] = ("", "")
    """names of the modes in which the two were by their last decisions; "" where there is none"""


@dataclass(frozen=True)
class Judged:
    """What a run says about safety. One that broke off has a ``reason`` and no clearance."""

    clearance: float | None
    """[m] the signed swept clearance; None where the run broke off"""
    pair: tuple[str, str] = ("", "")
    """names of the two that came nearest, or overlapped most"""
    time: float = 0.0
    """[s] when they did"""
    touched: Touched | None = None
    """None where nothing touched"""
    reason: str = ""
    """why there was no run, or why it broke off: one line"""
    before: tuple[Moment, ...] = field(default=(), compare=False)
    """moments before the first contact, the last of them first"""
    closing: float = field(default=0.0, compare=False)
    """[m/s] closing speed of the severest contact; 0 without one, and of contacts between samples
    alone"""
    refused: bool = False
    """the world was no world that can be run; otherwise the run broke off"""

    @property
    def failed(self) -> bool:
        """Whether something touched."""
        return self.touched is not None

    @property
    def aim(self) -> float | None:
        """What a search makes least: the clearance [m]; of contacts, minus the closing speed [m/s].

        None where the run broke off.
        """
        return -self.closing if self.failed else self.clearance


def judged(record: Record) -> Judged:
    """Judge a record that holds the contacts and extremes of a whole run."""
    names = [body.name for body in record.bodies]
    found: list[tuple[float, float, int, int]] = []
    for moment in (shortest_distance(record), shortest_boundary_distance(record)):
        if moment is not None:
            found.append((moment.value, moment.time, moment.a, moment.b or 0))
    between = grazes(record)
    found += [(-graze.depth, graze.time, graze.a, graze.b) for graze in between]
    episodes = contact_episodes(record)
    touches: list[Episode | Graze] = [*episodes, *between]
    # touching within the contact tolerance is touching, though the distance may be above 0
    found += [(0.0, one.time, one.a, one.b) for one in touches]
    first = min(touches, key=lambda one: (one.step, one.a, one.b), default=None)
    touched: Touched | None = None
    before: tuple[Moment, ...] = ()
    if first is not None:
        before = _before(record, first.step)
        kind = ROBOTS if first.robots else WALL
        modes = _mode(record, first.a, first.step), _mode(record, first.b, first.step)
        touched = Touched(kind, (names[first.a], names[first.b]), first.time, modes)
    if not found:
        return Judged(float("inf"))
    value, time, a, b = min(found)
    hardest = severest(record, episodes)
    closing = 0.0 if hardest is None else hardest[1].closing
    return Judged(value, (names[a], names[b]), time, touched, before=before, closing=closing)


def _before(record: Record, step: int) -> tuple[Moment, ...]:
    """The recorded samples that lie as long before a step as `LEADS` say, or a little longer."""
    wanted = [step - max(1, round(share * step)) for share in LEADS]
    rows = np.searchsorted(record.steps, wanted, side="right") - 1
    found = dict.fromkeys(int(at) for at in record.steps[rows] if at > 0)
    return tuple(
        Moment(at * record.dt, tuple((x, y, h) for x, y, h in record.pose_at(at).tolist()))
        for at in found
    )


def _mode(record: Record, body: int, step: int) -> str:
    """Name of the mode of a body's last decision before a step; "" where it made none."""
    if body >= record.robots or "updates" not in record.tables:
        return ""
    rows = record.updates[: int(np.searchsorted(record.updates["step"], step))]
    mine = rows["mode"][rows["robot"] == body]
    return "" if not len(mine) or mine[-1] == NO_NUMBER else record.modes[mine[-1]].name
