"""Contacts as values: one row per touching pair of bodies and sample.

Which pairs touch is decided elsewhere; here the history of that set becomes phases and rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

Pair = tuple[int, int]
"""Ids of two bodies, the smaller first."""

CONTACT = np.dtype(
    [
        ("step", "i8"),
        ("a", "i4"),
        ("b", "i4"),
        ("phase", "i1"),
        ("kind", "i1"),
        ("x", "f8"),
        ("y", "f8"),
        ("nx", "f8"),
        ("ny", "f8"),
        ("depth", "f8"),
        ("impulse", "f8"),
    ]
)
"""A contact: sample, body ids a < b, `Phase`, `Kind`, deepest point x, y [m], unit normal nx, ny
from a to b (world frame), depth [m], impulse [N s]. In a row of phase *ended* the bodies are apart:
depth is minus their distance, the point is midway between the nearest features, the normal points
from a to b along the gap."""


class Phase(IntEnum):
    """Where in its life a contact is at a sample."""

    BEGAN = 0
    """touching, and not at the sample before"""
    STAYS = 1
    """touching, as at the sample before"""
    ENDED = 2
    """apart, touching at the sample before"""


class Kind(IntEnum):
    """How a contact was found."""

    PHYSICAL = 0
    """shapes overlap or touch at a sample"""
    SWEPT = 1
    """shapes meet between two samples only"""


Closeness = tuple[float, float, float, float, float]
"""Signed distance [m], point x, y [m], normal nx, ny: as a pair of bodies is described."""


def no_contacts() -> NDArray[np.void]:
    """Return an empty array of contacts."""
    return np.zeros(0, CONTACT)


def contact_rows(
    step: int,
    before: Iterable[Pair],
    now: Iterable[Pair],
    describe: Callable[[int, int], Closeness],
    impulse: Mapping[Pair, float],
) -> NDArray[np.void]:
    """Return the rows of one sample, sorted by a and b.

    ``before`` and ``now`` are the pairs that touch at the last sample and at this one; a pair in
    neither has no row. ``describe`` gives where and how deep a pair is, ``impulse`` [N s] what it
    exchanged in the step (0 where it is not named).
    """
    before, now = frozenset(before), frozenset(now)
    pairs = sorted(before | now)
    rows = []
    for pair in pairs:
        separation, x, y, nx, ny = describe(*pair)
        phase = _phase(pair in before, pair in now)
        strength = impulse.get(pair, 0.0)
        rows.append((step, *pair, phase, Kind.PHYSICAL, x, y, nx, ny, -separation, strength))
    return np.array(rows, dtype=CONTACT)


def _phase(touched: bool, touches: bool) -> Phase:
    if not touches:
        return Phase.ENDED
    return Phase.STAYS if touched else Phase.BEGAN
