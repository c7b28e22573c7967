"""Distances of single moments, as pictures tell them of now."""

from __future__ import annotations

import numpy as np

from physim.geometry.clearance import ClearanceFinder
from physim.geometry.shapes import FloatArray, IntArray
from physim.geometry.wall_grid import build_wall_grid
from physim.record import Record

REACH, CELL = 10.0, 2.0
"""[m] of the look-up of walls: a matter of speed, not of values"""
MOST_POSES = 100_000
"""whose distances are worked out in one go"""


class Distances:
    """Distances of each robot to the nearest robot and wall [m], negative = depth, at samples.

    A record of every step has them. Those of one with fewer samples are the least since the sample
    before, which is another moment: they are worked out from the poses.
    """

    def __init__(self, record: Record) -> None:
        self._record = record
        self._finder: ClearanceFinder | None = None
        if record.record_every > 1:
            grid = build_wall_grid(record.walls, REACH, CELL)
            self._finder = ClearanceFinder(record.shapes, record.walls, grid)

    def at(self, samples: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the distances (M, N) to robots and to walls at M samples, given by index."""
        record = self._record
        if self._finder is None:
            return record.clearance[samples], record.boundary_clearance[samples]
        block = max(1, MOST_POSES // record.robots)
        found = [
            self._finder.find(record.pose[samples[first : first + block]])
            for first in range(0, len(samples), block)
        ]
        return (
            np.concatenate([one.clearance for one in found]),
            np.concatenate([one.boundary_clearance for one in found]),
        )
