"""Collision times (11) of all pairs of robots under their present commands (Figs. 3c, 6d).

A decision's collision time covers only the bodies that the robot must consider, under the command
that it would take; this is what an observer sees who knows all poses and commands.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from physim.geometry.batch import collision_times as times_of_pair
from physim.geometry.shapes import FloatArray, IntArray
from physim.metrics.values import Moment, Series
from physim.metrics.way import blocks
from physim.record import Record

HORIZON = 10.0
"""[s] Later collisions are not looked for."""
MOST_TIMES = 400_000
"""Pairs and moments that are worked out; of more, moments are farther apart than decisions."""


def pair_collision_times(record: Record, horizon: float = HORIZON) -> tuple[Series, FloatArray]:
    """Least collision time over all pairs of robots after every step with decisions.

    Time (K,) [s] and values (K,) [s], inf where no pair meets within ``horizon``; and the pairs
    (K, 2) that would meet first. Each robot keeps the command applied to it then, on its arc.
    """
    steps = np.unique(record.updates["step"])
    pairs = np.array(list(combinations(range(record.robots), 2)), dtype=np.int64).reshape(-1, 2)
    steps = steps[np.isin(steps, record.steps) & (steps < record.steps_run)]
    if not len(steps) or not len(pairs):
        return Series(np.zeros(0), np.zeros(0)), np.zeros((0, 2))
    steps = steps[:: -(-len(steps) * len(pairs) // MOST_TIMES)]
    twist = _commands(record, steps)
    pose = record.pose[np.searchsorted(record.steps, steps)]
    shapes = record.shapes
    least, who = np.full(len(steps), np.inf), np.zeros((len(steps), 2))
    reach = _reach(record, twist, horizon)
    for i, j in pairs:
        gap = np.hypot(*(pose[:, i, :2] - pose[:, j, :2]).T)
        near = np.flatnonzero(gap <= reach[:, i] + reach[:, j])
        if not len(near):
            continue
        found = times_of_pair(
            shapes, int(i), pose[near, i], twist[near, i],
            shapes, int(j), pose[near, j], twist[near, j], horizon,
        )  # fmt: skip
        first = near[found < least[near]]
        who[first] = (i, j)
        least[near] = np.minimum(least[near], found)
    return Series(steps * record.dt, least), who


def shortest_pair_collision_time(record: Record, horizon: float = HORIZON) -> Moment | None:
    """Shortest collision time of any pair under present commands [s]; None where none meets."""
    (time, least), who = pair_collision_times(record, horizon)
    if not np.isfinite(least).any():
        return None
    k = int(np.argmin(least))
    a, b = (int(i) for i in who[k])
    return Moment(float(least[k]), round(float(time[k]) / record.dt), float(time[k]), a, b)


def _commands(record: Record, steps: IntArray) -> FloatArray:
    """Applied commands (K, N, 2) over the steps that begin at the samples (K,), increasing."""
    twist = np.zeros((len(steps), record.robots, 2))
    for first, last in blocks(record):
        mine = slice(*np.searchsorted(steps, (first, last)))
        if mine.start < mine.stop:
            twist[mine] = record.commands_over("applied", first, last)[steps[mine] - first]
    return twist


def _reach(record: Record, twist: FloatArray, horizon: float) -> FloatArray:
    """How far (K, N) [m] from its position any point of a robot comes within the horizon."""
    radius = record.shapes.radius
    return np.asarray(np.abs(twist[:, :, 0]) * horizon + radius)
