"""One row of the contact table: what physics writes and the record keeps.

A row stands for one pair of touching bodies at one step. An *episode* is a maximal run of a pair:
its first row has phase `BEGAN`, the rows while it lasts `STAYS`, and one row at the first sample
without contact `ENDED`. A *graze* is a row of its own kind, `SWEPT`: the two touch between two
samples and are apart at both, so the engine, which looks at samples only, lets them pass.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from physim.geometry.polygon import smallest_width
from physim.geometry.shapes import Shapes
from physim.tolerances import DEEP, IMPACT_SPEED, SETTLED_DEPTH, TUNNEL_FRACTION


class Phase(IntEnum):
    """Where in its episode a contact row stands."""

    BEGAN = 0
    """first sample of an episode"""
    STAYS = 1
    """touching at the sample before, too"""
    ENDED = 2
    """first sample apart"""


class Kind(IntEnum):
    """How a contact was found."""

    PHYSICAL = 0
    """the shapes touch at a sample"""
    SWEPT = 1
    """they touch between two samples only"""


CONTACT_ROW = np.dtype(
    [
        ("step", "<i8"),
        ("a", "<i4"),
        ("b", "<i4"),
        ("phase", "i1"),
        ("kind", "i1"),
        ("x", "<f8"),
        ("y", "<f8"),
        ("nx", "<f8"),
        ("ny", "<f8"),
        ("depth", "<f8"),
        ("impulse", "<f8"),
    ]
)
"""Contact row: sample, body ids a < b, `Phase`, `Kind`, deepest point x, y [m], unit normal nx, ny
from a to b (world frame), depth [m] (0 when just touching), impulse [N s] of the step that led to
the sample, along the normal and by friction together. In a row of phase *ended* the bodies are
apart: depth is minus their distance, point and normal are those of the gap, impulse is what they
exchanged in the step in which they parted. In a row of kind *swept* step is the sample at the end
of the step in which they touch, phase is *began*; point, normal and depth are those of the instant
at which they are closest (deepest), from exact geometry; impulse is 0. Packed, so no byte is
undefined."""

FALSE_CONTACT_ROW = np.dtype([("step", "<i8"), ("a", "<i4"), ("b", "<i4"), ("distance", "<f8")])
"""A contact that the engine reported and the exact check rejected: sample, body ids a < b, signed
distance [m] of the two at that sample, above the contact tolerance. At most one a sample and
pair."""


def touching(rows: NDArray[np.void]) -> NDArray[np.void]:
    """Rows of `CONTACT_ROW` whose bodies touch at the sample: physical, and not ended."""
    kept: NDArray[np.void] = rows[(rows["phase"] != Phase.ENDED) & (rows["kind"] == Kind.PHYSICAL)]
    return kept


def allowed_depth(shapes: Shapes, step: float) -> float:
    """How deep [m] bodies may be in each other at the end of a step of ``step`` [s].

    An impact is found where a step ends, as deep as the bodies closed in it: ``DEEP`` at 0.01 s or
    less and ``IMPACT_SPEED``, in proportion more in longer steps. But a robot that is beyond a wall
    by more than half is pushed out on the wrong side: so no more than a quarter of the smallest
    width of the robots' footprints ``shapes``, and at least twice the depth at which contacts
    settle, which robots narrower than 8 mm pay for. The engine keeps to it
    (`physim.simulation.engine.cutting`); a contact that is deeper all the same was not held: from
    there on a record is not physical, and every report says so.
    """
    bounds = zip(shapes.part_start[:-1].tolist(), shapes.part_start[1:].tolist(), strict=True)
    parts = {shapes.vertices[low:high].tobytes() for low, high in bounds}
    if not parts:
        return DEEP
    narrowest = smallest_width([np.frombuffer(part).reshape(-1, 2) for part in parts])
    impact = DEEP + IMPACT_SPEED * max(0.0, step - 0.01)
    return max(2.0 * SETTLED_DEPTH, min(impact, TUNNEL_FRACTION * narrowest))
