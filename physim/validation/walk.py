"""One walk over a record: poses, stations and decisions, block by block.

Whatever is worked out at every sample takes part in the same walk, so poses are read and robots are
followed along their paths once, and memory stays flat.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, read_only
from physim.geometry.tracking import Tracking
from physim.record import Record
from physim.validation.ledger import blocks, robot_shapes


class Stretch(NamedTuple):
    """B consecutive samples of a record and the decisions made at them."""

    first: int
    """step of the first sample"""
    pose: FloatArray
    """(B, N, 3)"""
    course: FloatArray
    """(B, N, 3) station, deviation, reference station [m], worked out from the poses"""
    held: FloatArray
    """(B, N, 2) nominal commands held before each of these steps: what a snapshot tells"""
    rows: NDArray[np.void]
    """decisions at these samples, rows of the update table"""
    row: int
    """number of the first of them in the table"""
    overlap: int
    """samples at its beginning that belong to the stretch before: 0 or 1"""

    @property
    def at(self) -> NDArray[np.int64]:
        """(M,) which of the samples each decision was made at."""
        return np.asarray(self.rows["step"] - self.first, dtype=np.int64)


def walk(record: Record) -> Iterator[Stretch]:
    """Go over a record that holds the poses of every step. Each decision comes once."""
    updates, radius = record.updates, robot_shapes(record).radius
    tracking = None
    for pose, first in blocks(record):
        if tracking is None:
            tracking = Tracking(record.paths, record.reference, radius, pose[0])
        course = tracking.course(pose)  # its first sample is the last of the block before: it stays
        last = first + len(pose)
        end = last if last >= record.samples else last - 1
        low, high = (int(k) for k in np.searchsorted(updates["step"], (first, end)))
        held = read_only(record.commands_over("nominal", first - 1, last - 1))
        yield Stretch(first, pose, course, held, updates[low:high], low, 0 if first == 0 else 1)
