"""Did the robots move as commanded? Poses against exact arcs, from each sample to the next.

A robot that touches nothing follows the arc of its applied command exactly (the engine moves it
along the chord of that very arc), so its pose at each sample follows from the one before and from
the recorded commands. Left out are robots that one in contact could reach in the step: the engine
eases it out of an overlap, and it may push them on its way though they touch nothing at either
sample.

A robot in contact moves as far as the contact allows, and where that leads the engine alone knows.
But it takes nothing from nowhere. The engine solves for velocities from rest, under forces that
would give every robot its commanded one, with contacts that take energy and add none. So robots
that push each other have no more energy than they were commanded to have, and one of them at most
all of it:

    m_i (v_i^2 + k_i^2 omega_i^2) <= sum over j of m_j (v_j^2 + k_j^2 omega_j^2)

with radii of gyration k, and none is faster than `LEVER` times the fastest command among them: so
fast is a light one that heavy ones squeeze out of a gap of 3 degrees between them. Twice a step
each is eased out of overlaps, by a share of their depths.
Pushing each other are robots that touch at either sample of the step, or that touched just before,
and, where that does not explain a step, those within `PUSHED` of them, which they may meet in it.

What can be pushed is held to the same as a robot that is commanded to stand. A mover is where its
path has it at every sample, whatever it touches; with its mass it gives what it pushes any energy.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from physim.analysis.validation.analytic_contacts import pair_distance, pose_blocks
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.finding import Finding, stretches
from physim.contacts import touching
from physim.geometry.motion import arcs
from physim.geometry.polygon import moment
from physim.geometry.shapes import FloatArray, IntArray, body_parts
from physim.geometry.timed_paths import timed_poses
from physim.record import Record
from physim.tolerances import ONE_STEP, PUSHED, ULPS
from physim.world.scene import Scene

HEAVIEST = 1e30
"""[kg] mass of a mover here"""
MOST_LOOKED_AT = 100
"""Steps of a block in which robots near others are looked for; in no honest run there was one"""
LEVER = 40.0
"""[-] Without this what is said of masses would let a light robot go anywhere."""

Strayed = tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]
"""Of M steps that bodies made and may not have made: sample at the end, body, gap [m], turn [rad],
and what was allowed [m], NaN of movers and of what touches nothing"""


@dataclass(frozen=True)
class Motion:
    """What the check of the motion looked at and found."""

    checked: int
    """steps of robots that touch nothing, of such obstacles that can be pushed, and of movers"""
    held: int
    """steps of robots in contact that were held to what they may move; 0 where no masses are
    known"""
    off: tuple[Finding, ...]
    """those that did not follow their commands, or their paths"""
    far: tuple[Finding, ...]
    """robots in contact that moved farther than commands and pushes allow"""

    @property
    def strays(self) -> tuple[Finding, ...]:
        """Both, in the order of time."""
        both = (*self.off, *self.far)
        return tuple(sorted(both, key=lambda one: (one.step or 0, one.bodies)))


def check_motion(record: Record, table: DecisionTable, scene: Scene | None) -> Motion:
    """Hold every pose against the one before, those of movers against their paths.

    See the module for what is left out; without a ``scene``, which has masses and paths, that are
    what is in contact, and movers, too.
    """
    touched = np.zeros((record.samples, record.moving), dtype=np.bool_)
    rows = touching(record.contacts)
    for who in ("a", "b"):
        mine = rows[rows[who] < record.moving]
        touched[mine["step"] - record.begun_at, mine[who]] = True
    pushing = None if scene is None else Pushing(record, scene.mass)
    checked = held = 0
    off, far = [], []
    for poses, first in pose_blocks(record):
        last = first + len(poses) - 1
        command = table.held_over(first, last)
        both = touched[first - record.begun_at : last - record.begun_at + 1]
        free = ~both[:-1] & ~both[1:]
        pushed = ~free
        free[:, table.movers], pushed[:, table.movers] = scene is not None, False
        start = np.ascontiguousarray(poses[:-1].reshape(-1, 3))
        ends = arcs(start, command.reshape(-1, 3), record.dt).reshape(*free.shape, 3)
        if scene is not None and table.movers:
            times = record.dt * np.arange(first + 1, last + 1)
            ends[:, table.movers] = [timed_poses(scene.movers, time) for time in times.tolist()]
        checked += int(free.sum())
        off.append(_off(poses, first, ends, free))
        if pushing is not None:
            held += int(pushed.sum())
            far.append(pushing.too_far(poses, first, command, pushed))
    found: list[tuple[Finding, ...]] = [(), ()]
    for k, some in enumerate((off, far)):
        if some:
            step, robot, gap, turn, allowed = map(np.concatenate, zip(*some, strict=True))
            kept = np.ones(len(step), dtype=np.bool_)
            if some is off:
                shift = np.maximum(gap, turn * table.radius[robot])
                places = zip(robot.tolist(), step.tolist(), shift.tolist(), strict=True)
                kept[:] = [
                    place[0] in table.movers or not _pushed(record, table, touched, *place)
                    for place in places
                ]
            strayed = (step[kept], robot[kept], gap[kept], turn[kept], allowed[kept])
            found[k] = tuple(_stretches(table, strayed))
    return Motion(checked, held, *found)


def _off(poses: FloatArray, first: int, ends: FloatArray, free: NDArray[np.bool_]) -> Strayed:
    """Steps of ``free`` (K - 1, B) bodies that end elsewhere than at ``ends`` (K - 1, B, 3)."""
    apart = np.abs(poses[1:] - ends)
    gap, turn = np.hypot(apart[..., 0], apart[..., 1]), apart[..., 2]
    slack = _slack(poses)
    at = np.nonzero(free & ~((gap <= slack) & (turn <= slack)))
    return at[0] + first + 1, at[1], gap[at], turn[at], np.full(len(at[0]), np.nan)


def _slack(poses: FloatArray) -> FloatArray:
    """(K - 1, B) [m, rad] that rounding may make of a step to each pose but the first."""
    return np.asarray(ONE_STEP + ULPS * np.spacing(np.abs(poses[1:]).max(axis=2)))


def _stretches(table: DecisionTable, strayed: Strayed) -> Iterator[Finding]:
    """Consecutive steps of a body as one, by the greatest of them."""
    step, robot, *values = strayed
    for run in stretches(step, robot):
        gap, turn, allowed = (float(column[run].max()) for column in values)
        who, at = int(robot[run[0]]), int(step[run[0]])
        what = (
            f"in contact it moved {gap:.3g} m and {turn:.3g} rad in a step; its command and what "
            f"pushes it allow {allowed:.3g} m"
        )
        if math.isnan(allowed) and who in table.movers:
            what = f"its pose is {gap:.3g} m and {turn:.3g} rad from where its path has it"
        elif math.isnan(allowed) and who >= table.record.robots:
            what = f"it touches nothing, yet it moved {gap:.3g} m and {turn:.3g} rad in a step"
        elif math.isnan(allowed):
            what = (
                f"it touches nothing, yet its pose is {gap:.3g} m and {turn:.3g} rad from where "
                "its command leads from the sample before"
            )
        yield Finding(what, (who,), at, at * table.record.dt, len(run))


def _pushed(
    record: Record, table: DecisionTable, touched: NDArray[np.bool_], robot: int, step: int,
    shift: float,
) -> bool:  # fmt: skip
    """Whether a robot may have been shifted by ``shift`` [m] by one that is eased out of a contact.

    Eased are robots that touch something at the sample before. Within the step such a one may go
    forth and back: it reaches as far as its poses differ, and as its command would take it, and
    `PUSHED` more. What it meets is shifted by no more than twice that.
    """
    before, after = record.pose_at(step - 1), record.pose_at(step)
    for j in np.flatnonzero(touched[step - 1 - record.begun_at]).tolist():
        x, y, turn = np.abs(after[j] - before[j]).tolist()
        v, omega, lateral = table.held(j, step - 1)
        radius = float(table.radius[j])
        reach = PUSHED + math.hypot(x, y) + radius * turn
        reach += (math.hypot(v, lateral) + radius * abs(omega)) * record.dt
        if shift <= 2.0 * reach and pair_distance(record, before, robot, j) <= reach:
            return True
    return False


class Pushing:
    """Holds steps of robots in contact to the energy of their commands."""

    def __init__(self, record: Record, mass: FloatArray) -> None:
        """Sort the contacts of a record; ``mass`` (B,) [kg] of what moves."""
        self.record, self.mass = record, np.minimum(mass, HEAVIEST)
        self.gyration = np.sqrt(
            [moment(body_parts(record.shapes, i), 1.0) for i in range(record.moving)]
        )

    def too_far(
        self, poses: FloatArray, first: int, command: FloatArray, held: NDArray[np.bool_]
    ) -> Strayed:
        """Steps of a block of poses (K, B, 3) that are longer than pushes and commands allow.

        Looked at is what is ``held`` (K - 1, B). ``first`` is the sample of the first pose,
        ``command`` (K - 1, B, 3) the twists that were applied.
        """
        steps, robots = held.shape
        rows = self.record.contacts_over(first, first + steps + 1)
        before = rows[rows["step"] < first + steps]
        after = touching(rows[rows["step"] > first])
        at = (before["step"] - first) * robots
        pairs = np.concatenate((
            _between_robots(before, at, robots),
            _between_robots(after, (after["step"] - first - 1) * robots, robots),
        ))  # fmt: skip
        speed = np.hypot(command[..., 0], command[..., 2])
        rate = np.hypot(speed, self.gyration * command[..., 1]).ravel()
        overlap = np.maximum(before["depth"], 0.0)
        depth = np.bincount(at + before["a"], overlap, held.size).astype(np.float64)
        allowed = self._allowed(_groups(pairs, held.size), rate, depth).reshape(held.shape)
        moved = np.diff(poses, axis=0)
        gap, turn = np.hypot(moved[..., 0], moved[..., 1]), np.abs(moved[..., 2])
        shift, slack = np.hypot(gap, self.gyration * turn), _slack(poses)
        far = held & ~(shift <= allowed * (1.0 + ONE_STEP) + slack)
        for k in np.flatnonzero(far.any(axis=1))[:MOST_LOOKED_AT].tolist():
            mine = pairs[pairs[:, 0] // robots == k] % robots
            group = _groups(np.concatenate((mine, self._near(poses[k]))), robots)
            part = slice(k * robots, (k + 1) * robots)
            allowed[k] = self._allowed(group, rate[part], depth[part])
        where = np.nonzero(far & ~(shift <= allowed + slack))
        return where[0] + first + 1, where[1], gap[where], turn[where], allowed[where]

    def _allowed(self, group: IntArray, rate: FloatArray, depth: FloatArray) -> FloatArray:
        """[m] what robots may move that push each other in groups, commanded to ``rate`` [m/s]."""
        mass, fastest = np.resize(self.mass, len(group)), np.zeros(len(group))
        np.maximum.at(fastest, group, rate)
        energetic = np.sqrt(np.bincount(group, mass * rate**2)[group] / mass)
        eased = np.bincount(group, depth)[group]
        speed = np.minimum(energetic, LEVER * fastest[group])
        return np.asarray(speed * self.record.dt + 2.0 * eased)

    def _near(self, pose: FloatArray) -> IntArray:
        """Pairs (M, 2) of robots within `PUSHED` of each other."""
        reach = self.record.shapes.radius[: len(pose)]
        apart = np.hypot(*(pose[:, None, :2] - pose[None, :, :2]).T)
        close = np.argwhere(np.triu(apart <= reach[:, None] + reach[None] + PUSHED, 1)).tolist()
        near = [(a, b) for a, b in close if pair_distance(self.record, pose, a, b) <= PUSHED]
        return np.array(near, dtype=np.int64).reshape(-1, 2)


def _between_robots(rows: NDArray[np.void], at: IntArray, robots: int) -> IntArray:
    """Pairs (M, 2) of rows between robots, numbered from ``at`` (K,) for the step of each row."""
    some = rows["b"] < robots
    return np.column_stack((at[some] + rows["a"][some], at[some] + rows["b"][some]))


def _groups(pairs: IntArray, count: int) -> IntArray:
    """(count,) the group of each, where those of the pairs (M, 2) belong together."""
    linked = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(linked, directed=False)[1])
