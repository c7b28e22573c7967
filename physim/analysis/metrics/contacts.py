"""Contacts as episodes: who touched whom, when, how hard.

Severity is closing speed, change of speed of each body, and energy lost. All three are about
the first sample of a contact, the impact. Pushing after it shows in the impulse of the whole
contact.

- Closing speed [m/s]: of the contact point of one body against that of the other, along the
  normal, over the step that led to the contact, from the poses; 0 where they do not close.
  Between samples bodies go straight, so it is off by at most |v| |omega| dt / 2 of each body.
  Of a robot that was free until it was stopped within the step, by an impact that would have
  ended too deep (`physim.simulation.engine.cutting`), it is that of its command.
- Change of speed of a body [m/s]: impulse of the impact over its mass. That is how fast its
  reference point, which the engine takes for the centre of mass, would change its velocity
  were nothing else in its way: of a body that touches a third at the same sample it is an
  upper bound as to this contact, and a lower one as to all that it undergoes.
- Energy lost [J]: (1 - e) / 2 times impulse times closing speed, with the elasticity e of the
  world; exact for two bodies that touch at a point without friction. What friction takes is
  not in it, so it errs low where the world has friction.

Both are of the impact alone: robots take up their commands again at the next step, so that the
motion shows no bounce.

References: impulse and energy of an impact with restitution, e.g. Stronge, Impact Mechanics
(2000), chapter 3; change of speed ("delta-v") is what crash research reports for severity.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from physim.analysis.metrics.distances import along_wall
from physim.analysis.metrics.metric import section
from physim.contacts import Kind, Phase, allowed_depth, touching
from physim.errors import place_text
from physim.geometry.motion import Twist, chord_velocity, twists
from physim.geometry.polygon import signed_area
from physim.geometry.shapes import FloatArray, read_only
from physim.geometry.swept import Least, least_gap
from physim.record import Record
from physim.world import Physics
from physim.world.scene import DENSITY

STOPPED = 1e-6
"""Share of its way that a robot lacks at least that was stopped within a step"""


@dataclass(frozen=True)
class Touch:
    """Two bodies that touch."""

    a: int
    """body ids, a < b"""
    b: int
    robots: bool
    """both are robots; otherwise b is a mover, a boundary or an obstacle"""
    step: int
    """first sample; of a graze the one at the end of its step"""
    time: float
    """[s] of that sample; of a graze when the two are closest, or the middle of its step where
    recorded poses do not tell that"""
    depth: float
    """[m] greatest depth"""
    place: tuple[float, float]
    """[m] world frame, where it began; of a graze where the two are closest"""
    normal: tuple[float, float]
    """from a to b, there"""


@dataclass(frozen=True)
class Episode(Touch):
    """A contact that lasts: a maximal run of consecutive samples at which two bodies touch."""

    samples: int
    """number of samples"""
    depth_step: int
    """the first sample that has the greatest depth"""
    impact: float | None
    """[N s] impulse of the first sample: the hit itself; None where poses alone are known"""
    impulse: float | None
    """[N s] all that the two exchange: the hit and the pushing after it, until they are apart"""


@dataclass(frozen=True)
class Graze(Touch):
    """A contact between two samples: the bodies touch within a step and are apart at its ends."""


def contact_episodes(record: Record) -> tuple[Episode, ...]:
    """Contact episodes in the order of their beginning; their number is "contacts: N".

    Contacts between two samples are none of them, see `grazes`; nor are those in which no robot
    takes part, as where a mover pushes an obstacle: these stand in the record alone.
    """
    of_robot = record.contacts["a"] < record.robots
    rows = record.contacts[(record.contacts["kind"] == Kind.PHYSICAL) & of_robot]
    rows = rows[np.lexsort((rows["step"], rows["b"], rows["a"]))]
    # of a row of phase ended the impulse is the push of the step in which the two part
    ended = rows["phase"] == Phase.ENDED
    pair = (np.diff(rows["a"]) != 0) | (np.diff(rows["b"]) != 0)
    firsts = np.flatnonzero(pair | (np.diff(rows["step"]) > 1) | ended[:-1]) + 1
    episodes = []
    for run in np.split(rows, firsts):
        if not len(mine := touching(run)):
            continue
        a, b, step = (int(run[name][0]) for name in ("a", "b", "step"))
        deepest = mine[int(np.argmax(mine["depth"]))]
        episodes.append(
            Episode(
                a, b, b < record.robots, step, step * record.dt, float(deepest["depth"]),
                (float(mine["x"][0]), float(mine["y"][0])),
                (float(mine["nx"][0]), float(mine["ny"][0])), len(mine), int(deepest["step"]),
                *((None, None) if record.judged else
                  (float(run["impulse"][0]), float(run["impulse"].sum()))),
            )
        )  # fmt: skip
    return tuple(sorted(episodes, key=lambda episode: (episode.step, episode.a, episode.b)))


def grazes(record: Record) -> tuple[Graze, ...]:
    """Contacts of robots between two samples, in the order of time; a pair may have one a step."""
    of_robot = record.contacts["a"] < record.robots
    rows = record.contacts[(record.contacts["kind"] == Kind.SWEPT) & of_robot]
    columns = (rows[key].tolist() for key in ("a", "b", "step", "depth", "x", "y", "nx", "ny"))
    found = []
    for a, b, step, depth, x, y, nx, ny in zip(*columns, strict=True):
        within = 0.5 * record.dt
        if np.isin((step - 1, step), record.steps).all():
            within = float(least_in_step(record, a, b, step).time)
        time = (step - 1) * record.dt + within
        found.append(Graze(a, b, b < record.robots, step, time, depth, (x, y), (nx, ny)))
    return tuple(sorted(found, key=lambda one: one.time))


def least_in_step(record: Record, a: int, b: int, step: int) -> Least:
    """Least signed distance [m] of two bodies, and when, within the step that ends at a sample."""
    shapes = record.shapes
    old, new = record.pose_at(step - 1), record.pose_at(step)
    if b < record.moving:
        return least_gap(shapes, a, old[a], new[a], shapes, b, old[b], new[b], record.dt)
    still, w = read_only(np.zeros(3)), b - record.moving
    return least_gap(record.walls, w, still, still, shapes, a, old[a], new[a], record.dt)


@dataclass(frozen=True)
class Deep:
    """A pair of bodies that sank into each other by more than `physim.contacts.allowed_depth`."""

    a: int
    """body ids, a < b"""
    b: int
    time: float
    """[s] of the first sample deeper than allowed"""
    allowed: float
    """[m]"""
    depth: float
    """[m] greatest depth"""
    depth_time: float
    """[s] of the greatest depth"""
    place: tuple[float, float]
    """[m] world frame, where it is deepest"""
    along: str
    """where along a wall, `physim.analysis.metrics.distances.along_wall`; empty between robots"""
    judged: bool = False
    """the poses are of a log, no run made them"""

    def sentence(self, names: Sequence[str]) -> str:
        """Who, where, when, how deep, and what it means; ``names`` by body id."""
        where = self.along.removeprefix("at ") or place_text(*self.place, 4)
        if self.judged:
            return (
                f"NOT SOLID from {self.time:.2f} s on: {names[self.a]} and {names[self.b]} overlap "
                f"by up to {1e3 * self.depth:.1f} mm (at {self.depth_time:.2f} s, {where}): poses "
                "of the log, or footprints or walls of the world, are off by as much."
            )
        return (
            f"NOT PHYSICAL from {self.time:.2f} s on: {names[self.a]} and {names[self.b]} sink "
            f"into each other by up to {1e3 * self.depth:.1f} mm (at {self.depth_time:.2f} s, "
            f"{where}); allowed are {1e3 * self.allowed:.0f} mm. The engine could "
            "not hold them apart: their motion from then on is not physical."
        )


def deep_contacts(record: Record) -> tuple[Deep, ...]:
    """Contacts too deep to be true, a pair each, by time: the engine could not hold them apart."""
    rows, allowed = touching(record.contacts), allowed_depth(record.shapes, record.dt)
    rows = rows[rows["depth"] > allowed]
    found = []
    for a, b in np.unique(np.stack((rows["a"], rows["b"]), 1), axis=0).tolist():
        mine = rows[(rows["a"] == a) & (rows["b"] == b)]
        worst = mine[int(np.argmax(mine["depth"]))]
        place = (float(worst["x"]), float(worst["y"]))
        begins, at = (int(step) * record.dt for step in (mine["step"].min(), worst["step"]))
        where = along_wall(record, b, place)
        is_log = record.judged is not None
        found.append(Deep(a, b, begins, allowed, float(worst["depth"]), at, place, where, is_log))
    return tuple(sorted(found, key=lambda one: (one.time, one.a, one.b)))


@dataclass(frozen=True)
class Severity:
    """How hard two bodies met."""

    closing: float
    """[m/s] along the normal, just before"""
    sliding: float
    """[m/s] along each other, just before"""
    changes: tuple[float, ...] | None
    """[m/s] change of speed of each robot of the two, a first; None where masses are not known"""
    energy: float | None
    """[J] lost; None where the world is not known"""


Held = Callable[[int, int], Twist]
"""Applied command of a robot over the step from a sample on"""


def severity(
    record: Record, episode: Episode, mass: FloatArray | None, held: Held | None = None
) -> Severity:
    """Severity of a contact; ``mass`` (N,) [kg] as `masses` gives them.

    Needs the poses of every step. ``held`` says what commands were applied; without it they are
    sought in the record each time.
    """
    a, b, step = episode.a, episode.b, episode.step
    normal = np.array(episode.normal)
    one, other = (point_velocity(record, body, step, episode.place, held) for body in (a, b))
    relative = one - other
    closing = max(0.0, float(relative @ normal))
    sliding = float(abs(relative @ np.array((-normal[1], normal[0]))))
    if mass is None or episode.impact is None:
        return Severity(closing, sliding, None, None)
    changes = tuple(episode.impact / float(mass[i]) for i in (a, b) if i < record.robots)
    material = section(record, "physics", Physics) or Physics()
    energy = 0.5 * (1.0 - material.elasticity) * episode.impact * closing
    return Severity(closing, sliding, changes, energy)


def masses(record: Record) -> FloatArray | None:
    """(N,) [kg] of the robots, by the world inside; None where the record has no text of it.

    A robot without a mass of its own has `DENSITY` over the area of its footprint.
    """
    entries = record.world_settings.get("robots")
    given: list[Any] = []
    for entry in entries if isinstance(entries, list) else ():
        one = entry if isinstance(entry, dict) else {}
        count = one.get("count", 1)  # an entry with a count stands for many
        given += [one.get("mass")] * min(count if isinstance(count, int) else 1, record.robots)
    if len(given) != record.robots or not all(isinstance(m, int | float | None) for m in given):
        return None
    area = [sum(abs(signed_area(part)) for part in parts) for parts in record.footprints]
    return np.array(
        [DENSITY * a if m is None else float(m) for a, m in zip(area, given, strict=True)]
    )


def point_velocity(
    record: Record, body: int, step: int, point: tuple[float, float], held: Held | None = None
) -> FloatArray:
    """Velocity (2,) [m/s] of a body's material at a point [m] in the step that led to a sample.

    0 for what stands still, and at the first sample. ``held`` as for `severity`.
    """
    if body >= record.moving or step <= record.begun_at:
        return np.zeros(2)
    before, now = record.pose_at(step - 1)[body], record.pose_at(step)[body]
    moved = (now - before) / record.dt
    rows = touching(record.contacts_over(step - 1, step))
    touched = body in rows["a"] or body in rows["b"] or body >= record.robots
    if not touched and (held is not None or "updates" in record.tables):
        if held is None:
            v, omega, lateral = twists(record.commands_over("applied", step - 1, step)[0])[body]
        else:
            v, omega, lateral = held(body, step - 1)
        along = chord_velocity(float(before[2]), v, omega, lateral, record.dt)
        wanted = np.array((*along, omega))
        if moved @ wanted < (wanted @ wanted) * (1.0 - STOPPED):
            moved = wanted  # it was stopped within the step
    vx, vy, omega = moved
    x, y = point[0] - now[0], point[1] - now[1]
    return np.array((vx - omega * y, vy + omega * x))
