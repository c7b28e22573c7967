"""Contacts as episodes: who touched whom, when and how hard."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, touching
from physim.record import Record


@dataclass(frozen=True)
class Episode:
    """A contact that lasts: a maximal run of consecutive samples at which two bodies touch."""

    a: int
    """body ids, a < b"""
    b: int
    robots: bool
    """both are robots; otherwise b is a boundary or an obstacle"""
    step: int
    """first sample"""
    time: float
    """[s] of the first sample"""
    samples: int
    """number of samples"""
    depth: float
    """[m] greatest depth"""
    impact: float
    """[N s] impulse of the first sample: the hit itself"""
    impulse: float
    """[N s] sum over the samples: the hit and all pushing after it"""


@dataclass(frozen=True)
class Graze:
    """A contact between two samples: the bodies touch within a step and are apart at its ends."""

    a: int
    """body ids, a < b"""
    b: int
    robots: bool
    """both are robots; otherwise b is a boundary or an obstacle"""
    step: int
    """sample at the end of the step"""
    time: float
    """[s] of that sample"""
    depth: float
    """[m] greatest depth within the step, 0 when they only touch"""


def contact_episodes(record: Record) -> tuple[Episode, ...]:
    """Contact episodes in the order of their beginning; their number is "contacts: N".

    Contacts between two samples are none of them, see `grazes`.
    """
    rows = touching(record.contacts)
    rows = rows[np.lexsort((rows["step"], rows["b"], rows["a"]))]
    if not len(rows):
        return ()
    pair = (np.diff(rows["a"]) != 0) | (np.diff(rows["b"]) != 0)
    firsts = np.flatnonzero(np.concatenate(([True], pair | (np.diff(rows["step"]) > 1))))
    runs = np.split(rows, firsts[1:])
    episodes = [_episode(record, run) for run in runs]
    return tuple(sorted(episodes, key=lambda episode: (episode.step, episode.a, episode.b)))


def grazes(record: Record) -> tuple[Graze, ...]:
    """Contacts between two samples, in the order of time. A pair may have one a step."""
    rows = record.contacts[record.contacts["kind"] == Kind.SWEPT]
    columns = zip(*(rows[key].tolist() for key in ("a", "b", "step", "depth")), strict=True)
    return tuple(
        Graze(a, b, b < record.robots, step, step * record.dt, depth)
        for a, b, step, depth in columns
    )


def _episode(record: Record, run: NDArray[np.void]) -> Episode:
    a, b, step = int(run["a"][0]), int(run["b"][0]), int(run["step"][0])
    return Episode(
        a, b, b < record.robots, step, step * record.dt, len(run),
        float(run["depth"].max()), float(run["impulse"][0]), float(run["impulse"].sum()),
    )  # fmt: skip
