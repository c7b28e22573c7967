"""How the run ended, who had arrived, and the counts in attributes, against what happened."""

from __future__ import annotations

import numpy as np

from physim.arrival import arrivals, still_steps
from physim.geometry.shapes import IntArray
from physim.record import Record
from physim.record.layout import ARRIVED, OPTIONAL
from physim.scene import Scene
from physim.validation.mismatch import Mismatches
from physim.validation.walk import SampleBlock

BY = "by the poses"


class ArrivalCheck:
    """Judges arrival anew, from poses and stations (`physim.arrival`)."""

    def __init__(self, record: Record, scene: Scene) -> None:
        self.dt = record.dt
        self.least = scene.stop_station - scene.arrival_tolerance
        self.window = still_steps(record.dt)
        self.pose = np.zeros((0, record.robots, 3))
        self.station = np.zeros((0, record.robots))
        self.away: IntArray = np.full(record.robots, -1)
        """(N,) last sample at which each robot had not arrived"""
        self.all_since: int | None = None
        """first sample at which all had arrived"""

    def take(self, block: SampleBlock) -> None:
        """Continue with the samples of a block."""
        pose = np.concatenate((self.pose, block.pose[block.overlap :]))
        station = np.concatenate((self.station, block.station[block.overlap :]))
        known = len(self.pose)
        found = np.zeros((len(pose) - known, pose.shape[1]), dtype=np.bool_)
        near = (station[known:] >= self.least).any(axis=0)
        if near.any():
            judged = arrivals(pose[:, near], station[:, near], self.least[near], self.dt)
            found[:, near] = judged[known:]
        first = block.first + block.overlap
        samples = first + np.arange(len(found))[:, None]
        away = np.where(~found, samples, -1).max(axis=0, initial=-1)
        self.away = np.maximum(self.away, away)
        together = np.flatnonzero(found.all(axis=1))
        if self.all_since is None and len(together):
            self.all_since = first + int(together[0])
        self.pose, self.station = pose[-self.window :], station[-self.window :]

    def since(self, samples: int) -> IntArray:
        """(N,) sample from which on each robot has arrived, to the last; -1 where it has not."""
        return np.asarray(np.where(self.away + 1 < samples, self.away + 1, -1))


def check_ending(record: Record, scene: Scene, exact: ArrivalCheck, found: Mismatches) -> None:
    """Hold ``ended`` and ``/robots/arrived`` against the poses.

    A run ends as soon as all robots have arrived, or when its steps are over. What a run that was
    killed noted of arrivals may be older than its last sample: it is not looked at.
    """
    last, planned = record.steps_run, scene.steps
    if exact.all_since is not None and exact.all_since < last:
        found.add(
            "attribute", "steps_run", last, exact.all_since, f"{BY}: all robots had arrived then"
        )
    arrived = exact.all_since is not None
    since = exact.since(record.samples)
    if record.ended == "finished" and not arrived:
        missing = [record.names[i] for i in np.flatnonzero(since < 0)]
        found.add(
            "attribute", "ended", "finished", "not", f"{BY}: {', '.join(missing)} had not arrived"
        )
    elif record.ended in ("duration", "interrupted") and arrived:
        found.add("attribute", "ended", record.ended, "finished", f"{BY}: all robots had arrived")
    if last > planned or (record.ended == "duration" and last != planned):
        found.add("attribute", "steps_run", last, planned, "by the world inside")
    if record.ended == "running":
        return
    for i in np.flatnonzero(record.arrived != since).tolist():
        found.add(ARRIVED, None, int(record.arrived[i]), int(since[i]), BY, row=i, robot=i)


def check_counts(record: Record, found: Mismatches) -> None:
    """Hold counts and lists in attributes against the tables."""
    if record.ended != "running" and "false_contacts" in record.tables:
        count = len(record.false_contacts)
        if record.rejected_contacts != count:
            found.add(
                "attribute", "rejected_contacts", record.rejected_contacts, count,
                "by the table /false_contacts",
            )  # fmt: skip
    for table in OPTIONAL:
        if table not in record.tables and (rows := len(record.read(f"/{table}"))):
            found.add(
                "attribute", "tables", f"without {table}", f"with {table}",
                f"by that table, which has {rows} rows",
            )  # fmt: skip
    steps = record.steps[1:]
    exact = (np.arange(len(steps)) + 1) * record.record_every
    if len(exact):
        exact[-1] = min(int(exact[-1]), int(steps[-1]))
    wrong = np.flatnonzero(steps != exact)
    for k in wrong[:1].tolist():
        apart = int(steps[k] - (steps[k - 1] if k else 0))
        found.add(
            "attribute", "record_every", record.record_every, apart, "by the recorded steps"
        )  # fmt: skip
