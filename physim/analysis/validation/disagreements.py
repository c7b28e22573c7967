"""Disagreements of two sources about a pair of bodies, their causes, and rows by step and pair."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.geometry.separation import body_distance
from physim.geometry.shapes import IntArray, read_only
from physim.record import Record

TOLERANCE = "within tolerance"
GRAZE = "graze between samples"
REJECTED = "rejected false contact of the engine"
UNEXPLAINED = "unexplained"

ROUNDING = 1e-12
"""[m] Two ways to compute one distance differ by less, up to 10 km from the origin."""

DEPTH_SLACK = 1e-9
"""[m] How well a recorded depth or distance must agree with the one computed here."""


@dataclass(frozen=True)
class Disagreement:
    """A stretch of consecutive samples over which two sources disagree about a pair."""

    a: int
    b: int | None
    """body ids; None where one body is concerned"""
    step: int
    """first sample"""
    steps: int
    """number of samples"""
    time: float
    """[s] of the first sample; of a swept contact, of its first touch"""
    distance: float
    """[m] signed, at the first sample, from the poses; of a swept contact the least between its
    samples; NaN where no distance is in question"""
    cause: str
    what: str
    """what each of the two says"""

    @classmethod
    def at(
        cls,
        record: Record,
        pair: tuple[int, int | None],
        step: int,
        distance: float,
        what: str,
        *,
        steps: int = 1,
        cause: str = UNEXPLAINED,
    ) -> Disagreement:
        """One that begins at a sample of a record, without a cause unless one is given."""
        return cls(*pair, int(step), steps, float(step * record.dt), float(distance), cause, what)


MOST_SAMPLES = 1000
"""Samples of one stretch whose distances are computed."""


def distance_at(record: Record, a: int, b: int, step: int) -> float:
    """Signed distance [m] of bodies a < b at a sample, from the record's poses."""
    shapes, pose = record.shapes, record.pose_at(step)
    if b < record.robots:
        return float(body_distance(shapes, a, pose[a], shapes, b, pose[b]))
    still = read_only(np.zeros(3))
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


def distinct(keys: IntArray) -> IntArray:
    """`numpy.unique`, which is several times as slow for millions of numbers in order."""
    ordered: IntArray = np.sort(keys)
    return np.delete(ordered, 1 + np.flatnonzero(ordered[1:] == ordered[:-1]))


def stretches(keys: IntArray, bodies: int) -> Iterator[tuple[int, int, int, int]]:
    """a, b, first step and number of steps of each run of consecutive steps of a pair."""
    step, pair = keys // (bodies * bodies), keys % (bodies * bodies)
    order = np.lexsort((step, pair))
    step, pair = step[order], pair[order]
    cut = np.flatnonzero((np.diff(pair) != 0) | (np.diff(step) != 1)) + 1
    for run in np.split(np.arange(len(step)), cut) if len(step) else ():
        a, b = divmod(int(pair[run[0]]), bodies)
        yield a, b, int(step[run[0]]), len(run)
