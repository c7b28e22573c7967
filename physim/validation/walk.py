"""The samples of a record with stations and decisions, block by block.

Whatever is computed at every sample shares these blocks, so poses are read and robots are followed
along their paths once, and memory stays flat.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, read_only
from physim.geometry.tracking import Tracking
from physim.record import Record
from physim.validation.ledger import pose_blocks


class SampleBlock(NamedTuple):
    """B consecutive samples of a record and the decisions made at them."""

    first: int
    """step of the first sample"""
    pose: FloatArray
    """(B, N, 3)"""
    course: FloatArray
    """(B, N, 3) station, deviation, reference station [m], computed from the poses"""
    held: FloatArray
    """(B, N, 2) nominal commands held before each of these steps: what a snapshot tells"""
    rows: NDArray[np.void]
    """decisions at these samples, rows of the update table"""
    row: int
    """number of the first of them in the table"""
    overlap: int
    """samples at its beginning that belong to the block before: 0 or 1"""

    @property
    def station(self) -> FloatArray:
        """(B, N) [m] along the own path."""
        return self.course[:, :, 0]

    @property
    def reference_station(self) -> FloatArray:
        """(B, N) [m] along s*."""
        return self.course[:, :, 2]

    @property
    def at(self) -> NDArray[np.int64]:
        """(M,) which of the samples each decision was made at."""
        return np.asarray(self.rows["step"] - self.first, dtype=np.int64)


def sample_blocks(record: Record) -> Iterator[SampleBlock]:
    """Blocks of a record that holds the poses of every step. Each decision comes once."""
    updates, radius = record.updates, record.shapes.radius
    tracking = None
    for pose, first in pose_blocks(record):
        if tracking is None:
            tracking = Tracking(record.paths, record.reference, radius, pose[0])
        course = tracking.course(pose)  # its first sample is the last of the block before: it stays
        last = first + len(pose)
        end = last if last >= record.samples else last - 1
        low, high = (int(k) for k in np.searchsorted(updates["step"], (first, end)))
        held = read_only(record.commands_over("nominal", first - 1, last - 1))
        yield SampleBlock(first, pose, course, held, updates[low:high], low, 0 if first == 0 else 1)
