"""Collision times (11) of many questions at once, by marching with shapely's distances.

No point of a body moves faster than |v| + |omega| * (its distance from the reference point), so a
step of distance / (sum for both bodies) cannot step over a contact. Slow, and independent of how
the kernels find it: neither bounds along axes nor closed forms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from tests.oracles.motion import arc, placed
from tests.oracles.tolerances import TIME, TOUCH
from tests.oracles.view import shape

MOST_STEPS = 1000
"""A march that takes more is next to a graze: its answer is unsure."""


@dataclass(frozen=True)
class Question:
    """When does a body under a command first touch one of the others?"""

    parts: tuple[np.ndarray, ...]
    pose: np.ndarray
    command: tuple[float, float]
    others: tuple[tuple[tuple[np.ndarray, ...], np.ndarray, tuple[float, float]], ...]
    """parts, pose and held command of every other robot"""
    walls: tuple[np.ndarray, ...]
    horizon: float
    translation: bool = False
    """velocity vectors kept without turning, in place of arcs"""


@dataclass(frozen=True)
class Answer:
    """xi is in [time, time + TIME] if ``sure``; inf when there is none within the horizon."""

    time: float
    sure: bool


def collision_times(questions):
    """Answers to questions, one each."""
    rows = _Rows()
    for number, question in enumerate(questions):
        rows.add(number, question)
    return rows.march(len(questions))


class _Rows:
    """Pairs of convex parts, one row each, padded to arrays."""

    def __init__(self):
        self.owner, self.horizon, self.bound = [], [], []
        self.mine, self.theirs = [], []
        self.still = []

    def add(self, number, question):
        def twist(command):
            return (command[0], 0.0) if question.translation else tuple(command)

        my_twist = twist(question.command)
        walls = shapely.GeometryCollection([shape(part) for part in question.walls])
        for part in question.parts:
            for parts, pose, command in question.others:
                for other in parts:
                    self._row(number, question, (part, question.pose, my_twist),
                              (other, pose, twist(command)), None)  # fmt: skip
            if question.walls:
                nothing = (part, np.zeros(3), (0.0, 0.0))
                self._row(number, question, (part, question.pose, my_twist), nothing, walls)

    def _row(self, number, question, mine, theirs, still):
        self.owner.append(number)
        self.horizon.append(question.horizon)
        self.mine.append(mine)
        self.theirs.append(theirs)
        self.still.append(still)
        self.bound.append(_fastest(mine, theirs))

    def march(self, count):
        time, sure = np.full(count, np.inf), np.ones(count, dtype=bool)
        if not self.owner:
            return [Answer(np.inf, True)] * count
        owner, horizon = np.array(self.owner), np.array(self.horizon)
        bound, still = np.array(self.bound), np.array(self.still, dtype=object)
        mine, theirs = _packed(self.mine), _packed(self.theirs)
        is_still = np.array([s is not None for s in self.still])

        def gaps(rows, at):
            a = shapely.polygons(_moved(mine, rows, at))
            b = still[rows].copy()
            moving = ~is_still[rows]
            if moving.any():
                b[moving] = shapely.polygons(_moved(theirs, rows[moving], at[moving]))
            return shapely.distance(a, b)

        t = np.zeros(len(owner))
        active = np.arange(len(owner))
        hits = []
        for _ in range(MOST_STEPS):
            gap = gaps(active, t[active])
            touching = active[gap <= TOUCH]
            hits.append(touching)
            np.minimum.at(time, owner[touching], t[touching])
            on = (gap > TOUCH) & (bound[active] > 0.0)
            active, gap = active[on], gap[on]
            t[active] += 0.999999 * (gap - 0.25 * TOUCH) / bound[active]
            active = active[t[active] <= np.minimum(horizon[active], time[owner[active]] + TIME)]
            if not len(active):
                break
        sure[owner[active]] = False  # marches that were not brought to an end
        hits = np.concatenate(hits)
        hits = hits[t[hits] <= time[owner[hits]] + TIME]
        grazing = hits[gaps(hits, t[hits] + TIME) > 0.0] if len(hits) else hits
        sure[owner[grazing]] = False
        return [Answer(float(a), bool(b)) for a, b in zip(time, sure, strict=True)]


def _fastest(mine, theirs):
    """No two points of two parts ever approach each other faster [m/s]."""
    (part_a, pose_a, (v_a, omega_a)), (part_b, pose_b, (v_b, omega_b)) = mine, theirs
    if omega_a == 0.0 and omega_b == 0.0:
        return np.hypot(
            v_a * np.cos(pose_a[2]) - v_b * np.cos(pose_b[2]),
            v_a * np.sin(pose_a[2]) - v_b * np.sin(pose_b[2]),
        )
    turning = abs(omega_a) * np.hypot(*part_a.T).max() + abs(omega_b) * np.hypot(*part_b.T).max()
    return abs(v_a) + abs(v_b) + turning


def _packed(bodies):
    """Parts padded to equal numbers of vertices by repeating the last, poses, commands."""
    most = max(len(part) for part, _, _ in bodies)
    parts = [np.vstack([p, np.tile(p[-1], (most - len(p), 1))]) for p, _, _ in bodies]
    return (
        np.array(parts),
        np.array([pose for _, pose, _ in bodies], dtype=float),
        np.array([command for _, _, command in bodies], dtype=float),
    )


def _moved(packed, rows, at):
    parts, pose, command = packed
    poses = arc(pose[rows], command[rows], at)
    return placed(parts[rows], poses)
