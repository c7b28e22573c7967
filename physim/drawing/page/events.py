"""What happens to each robot besides modes and contacts: where it came closest, where it stood."""

from __future__ import annotations

import numpy as np

from physim.drawing.page.packing import Pack
from physim.geometry.shapes import IntArray
from physim.record import Record
from physim.simulation.arrival import STILL_TIME, still_distances

LEAST = 1.0
"""[s] for which it stands at least"""


def pack_events(record: Record, pack: Pack) -> None:
    """Add the closest moments of each robot, and the spans in which it stood before it arrived."""
    found = record.extremes
    for name, column in (("near", "clearance"), ("near_wall", "boundary_clearance")):
        prefix = "clearance" if name == "near" else "boundary"
        pack.real(name, found[column], 1e-3)
        pack.whole(f"{name}_step", found[f"{prefix}_step"])
        pack.whole(f"{name}_body", found[f"{prefix}_other"])
    stood = stands(record)
    for k, name in enumerate(("stand_robot", "stand_from", "stand_to")):
        pack.whole(name, stood[:, k])


def stands(record: Record) -> IntArray:
    """Spans (S, 3) in which robots stood for `LEAST` or longer: robot, first and last step.

    It ends where the robot arrives.
    """
    steps = np.asarray(record.steps, dtype=np.int64)
    spans: list[tuple[int, int, int]] = []
    still = still_distances(record.shapes.radius[: record.robots]) / STILL_TIME
    """[m/s] A robot that moves slower from sample to sample stands."""
    if len(steps) > 1:
        took = np.diff(steps) * record.dt
        for robot in range(record.robots):
            moved = np.hypot(*np.diff(record.pose[:, robot, :2], axis=0).T)
            edges = np.diff(np.concatenate(([0], moved < still[robot] * took, [0])).astype(np.int8))
            arrived = int(np.searchsorted(steps, record.arrived[robot]))  # the sample
            for first, end in zip(
                np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True
            ):
                last = end if record.arrived[robot] < 0 else min(int(end), arrived)
                if (steps[last] - steps[first]) * record.dt >= LEAST - 1e-9:
                    spans.append((robot, int(steps[first]), int(steps[last])))
    return np.array(spans, dtype=np.int64).reshape(-1, 3)
