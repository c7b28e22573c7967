"""Shortest and largest distances over all physics steps, also those that are not recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import IntArray
from physim.record import layout

if TYPE_CHECKING:
    from physim.geometry.clearance import Clearances


class Extremes:
    """Running extremes: ``rows`` (N,) of `layout.EXTREME`, ``farthest`` one `layout.FARTHEST`."""

    def __init__(self, robots: int) -> None:
        """Begin with nothing seen."""
        self.rows: NDArray[np.void] = np.full(robots, layout.NO_EXTREME)
        self.farthest: NDArray[np.void] = layout.NO_FARTHEST.copy()

    def note(self, step: IntArray, found: Clearances) -> None:
        """Take the samples ``step`` (B,) into account; the earliest of equal values is kept."""
        if not len(step):
            return
        robots = np.arange(len(self.rows))
        for key, when, who, values, others in (
            ("clearance", "clearance_step", "clearance_other", found.clearance, found.other),
            ("boundary_clearance", "boundary_step", "boundary_other",
             found.boundary_clearance, found.boundary_other),
        ):  # fmt: skip
            at = np.argmin(values, axis=0)
            least = values[at, robots]
            closer = least < self.rows[key]
            self.rows[key][closer] = least[closer]
            self.rows[when][closer] = step[at][closer]
            self.rows[who][closer] = others[at, robots][closer]
        at = int(np.argmax(found.farthest))
        if found.farthest[at] > self.farthest["farthest"]:
            self.farthest[...] = (
                found.farthest[at], step[at], found.farthest_a[at], found.farthest_b[at],
            )  # fmt: skip
