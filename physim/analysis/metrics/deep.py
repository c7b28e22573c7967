"""Contacts that are too deep to be true: the engine could not hold two bodies apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from physim.analysis.metrics.walls import along_wall
from physim.contacts import allowed_depth, touching
from physim.errors import place_text
from physim.record import Record


@dataclass(frozen=True)
class Deep:
    """A pair of bodies that sank into each other by more than `physim.contacts.allowed_depth`."""

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
    along: str
    """where along a wall, `physim.analysis.metrics.walls.along_wall`; empty between robots"""

    def sentence(self, names: Sequence[str]) -> str:
        """Who, where, when, how deep, and what it means; ``names`` by body id."""
        x, y = self.place
        where = self.along.removeprefix("at ") or place_text(x, y, 4)
        return (
            f"NOT PHYSICAL from {self.time:.2f} s on: {names[self.a]} and {names[self.b]} sink "
            f"into each other by up to {1e3 * self.depth:.1f} mm (at {self.depth_time:.2f} s, "
            f"{where}); allowed are {1e3 * self.allowed:.0f} mm. The engine could "
            "not hold them apart: their motion from then on is not physical."
        )


def deep_contacts(record: Record) -> tuple[Deep, ...]:
    """Pairs deeper than allowed at a sample, in the order of time; empty where all were held."""
    rows = touching(record.contacts)
    allowed = allowed_depth(record.shapes, record.dt)
    rows = rows[rows["depth"] > allowed]
    found = []
    for a, b in np.unique(np.stack((rows["a"], rows["b"]), 1), axis=0).tolist():
        mine = rows[(rows["a"] == a) & (rows["b"] == b)]
        worst = mine[int(np.argmax(mine["depth"]))]
        place = (float(worst["x"]), float(worst["y"]))
        found.append(
            Deep(
                a, b, int(mine["step"].min()) * record.dt, allowed, float(worst["depth"]),
                int(worst["step"]) * record.dt, place, along_wall(record, b, place),
            )
        )  # fmt: skip
    return tuple(sorted(found, key=lambda one: (one.time, one.a, one.b)))
