"""Rows of tables by step and pair: keys, stretches, distances."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from physim.geometry.separation import body_distance
from physim.geometry.shapes import IntArray
from physim.record import Record

MOST_SAMPLES = 1000
"""Samples of one stretch whose distances are computed."""


def distance_at(record: Record, a: int, b: int, step: int) -> float:
    """Signed distance [m] of bodies a < b at a sample, from the record's poses."""
    shapes, pose = record.shapes, record.read("/steps/pose", step, step + 1)[0]
    if b < record.robots:
        return float(body_distance(shapes, a, pose[a], shapes, b, pose[b]))
    still = np.zeros(3)
    return float(body_distance(shapes, a, pose[a], record.walls, b - record.robots, still))


def distances_over(record: Record, a: int, b: int, step: int, steps: int) -> list[float]:
    """`distance_at` of each sample of a stretch, of the first `MOST_SAMPLES` at most."""
    return [distance_at(record, a, b, step + k) for k in range(min(steps, MOST_SAMPLES))]


def places(rows: NDArray[np.void]) -> list[tuple[int, int, int]]:
    """Step and bodies of each row."""
    return list(zip(*(rows[key].tolist() for key in ("step", "a", "b")), strict=True))


def row_keys(rows: NDArray[np.void], bodies: int) -> IntArray:
    """One number for step and pair of each row, increasing with step, then a, then b."""
    key = (rows["step"] * bodies + rows["a"]) * bodies + rows["b"]
    return np.asarray(key, dtype=np.int64)


def stretches(keys: IntArray, bodies: int) -> Iterator[tuple[int, int, int, int]]:
    """a, b, first step and number of steps of each run of consecutive steps of a pair."""
    step, pair = keys // (bodies * bodies), keys % (bodies * bodies)
    order = np.lexsort((step, pair))
    step, pair = step[order], pair[order]
    cut = np.flatnonzero((np.diff(pair) != 0) | (np.diff(step) != 1)) + 1
    for run in np.split(np.arange(len(step)), cut) if len(step) else ():
        a, b = divmod(int(pair[run[0]]), bodies)
        yield a, b, int(step[run[0]]), len(run)
