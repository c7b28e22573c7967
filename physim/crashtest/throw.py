"""Simulate the cases of a batch by the physics that runs every world."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.contacts import Phase
from physim.crashtest.batch import Batch
from physim.crashtest.case import STEPS
from physim.crashtest.verdict import NEVER
from physim.geometry.shapes import IntArray
from physim.physics import Physics


class Simulated(NamedTuple):
    """What the engine found in M cases."""

    sample: IntArray
    """(M,) of the first physical contact, or NEVER"""
    rejected: int
    """false contacts of the engine that were kept out"""


def simulate_cases(batch: Batch) -> Simulated:
    """Drive every robot for STEPS steps."""
    physics = Physics(batch.shapes, batch.walls, batch.start, batch.mass, batch.dt)
    case_of = np.repeat(np.arange(len(batch.cases)), np.diff(batch.first_robot))
    sample = np.full(len(batch.cases), NEVER, dtype=np.int64)
    command = batch.command.copy()
    _note(physics, case_of, sample)
    for _ in range(STEPS):
        # What has touched goes back where it came from: a pile-up would only cost time.
        command = np.where(sample[case_of, None] == NEVER, batch.command, -batch.command)
        physics.step(command)
        _note(physics, case_of, sample)
    return Simulated(sample, physics.rejected)


def _note(physics: Physics, case_of: IntArray, sample: IntArray) -> None:
    """Note the cases that touch for the first time at the present sample."""
    rows = physics.contacts
    if not len(rows):
        return
    case = case_of[rows["a"][rows["phase"] == Phase.BEGAN]]
    sample[case[sample[case] == NEVER]] = physics.step_number
