"""Contacts too deep to be true: where the engine could not hold two bodies apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physim.contacts import touching
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.tolerances import DEEP


@dataclass(frozen=True)
class Deep:
    """A pair of bodies that sank into each other by more than they may.

    That is `physim.tolerances.DEEP`, or what one step at their fastest commands carries them, if
    that is more: an impact is found at the next sample only.
    """

    a: int
    """body ids, a < b"""
    b: int
    time: float
    """[s] of the first sample deeper than allowed"""
    allowed: float
    """[m]"""
    depth: float
    """[m] greatest depth"""
    depth_time: float
    """[s] of the greatest depth"""
    place: tuple[float, float]
    """[m] world frame, where it is deepest"""

    def sentence(self, names: Sequence[str]) -> str:
        """Who, where, when, how deep, and what it means; ``names`` by body id."""
        x, y = self.place
        return (
            f"NOT PHYSICAL from {self.time:.2f} s on: {names[self.a]} and {names[self.b]} sink "
            f"into each other by up to {1e3 * self.depth:.1f} mm (at {self.depth_time:.2f} s, "
            f"({x:.3f}, {y:.3f}) m); allowed are {1e3 * self.allowed:.0f} mm. The "
            "engine could not hold them apart: their motion from then on is not physical."
        )


def deep_contacts(record: Record) -> tuple[Deep, ...]:
    """Pairs deeper than allowed at a sample, in the order of time; empty where all were held."""
    rows = touching(record.contacts)
    rows = rows[rows["depth"] > DEEP]
    if not len(rows):
        return ()
    found, advance = [], _advance(record)
    for a, b in np.unique(np.stack((rows["a"], rows["b"]), 1), axis=0).tolist():
        mine = rows[(rows["a"] == a) & (rows["b"] == b)]
        allowed = max(DEEP, float(advance[[i for i in (a, b) if i < record.robots]].sum()))
        mine = mine[mine["depth"] > allowed]
        if not len(mine):
            continue
        worst = mine[int(np.argmax(mine["depth"]))]
        found.append(
            Deep(
                a, b, int(mine["step"].min()) * record.dt, allowed, float(worst["depth"]),
                int(worst["step"]) * record.dt, (float(worst["x"]), float(worst["y"])),
            )
        )  # fmt: skip
    return tuple(sorted(found, key=lambda one: (one.time, one.a, one.b)))


def _advance(record: Record) -> FloatArray:
    """(N,) [m] farthest that a point of each robot goes in one step, by its fastest command."""
    far = np.zeros(record.robots)
    for rows in (record.updates, record.commands):
        radius = record.shapes.radius[rows["robot"]]
        speed = np.abs(rows["applied_v"]) + radius * np.abs(rows["applied_omega"])
        np.maximum.at(far, rows["robot"], speed * record.dt)
    return far
