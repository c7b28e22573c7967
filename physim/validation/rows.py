"""Rows of tables by step and pair: keys, stretches, distances."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.separation import body_distance
from physim.geometry.shapes import IntArray
from physim.record import Record
from physim.validation.ledger import robot_shapes


def distance_at(record: Record, a: int, b: int, step: int) -> float:
    """Signed distance [m] of bodies a < b at a sample, from the record's poses."""
    shapes, pose = robot_shapes(record), record.read("/steps/pose", step, step + 1)[0]
    if b < record.robots:
        return float(body_distance(shapes, a, pose[a], shapes, b, pose[b]))
    still = np.zeros(3)
    return float(body_distance(shapes, a, pose[a], record.walls, b - record.robots, still))


def body_keys(rows: NDArray[np.void], bodies: int) -> IntArray:
    """One increasing number for step and pair."""
    key = (rows["step"] * bodies + rows["a"]) * bodies + rows["b"]
    return np.unique(key.astype(np.int64))


def stretches(keys: IntArray, bodies: int) -> list[tuple[int, int, int, int]]:
    """a, b, first step and number of steps of each run of consecutive steps of a pair."""
    step, pair = keys // (bodies * bodies), keys % (bodies * bodies)
    order = np.lexsort((step, pair))
    step, pair = step[order], pair[order]
    if not len(step):
        return []
    cut = np.flatnonzero((np.diff(pair) != 0) | (np.diff(step) != 1)) + 1
    firsts = np.concatenate(([0], cut))
    sizes = np.diff(np.concatenate((firsts, [len(step)])))
    return [
        (int(pair[k] // bodies), int(pair[k] % bodies), int(step[k]), int(size))
        for k, size in zip(firsts, sizes, strict=True)
    ]
