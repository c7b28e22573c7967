"""A branch beside the run that it went on from: where the two part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from physim.record import Record
from physim.units import amount

APART = 1e-3
"""[m] from where a point of a body counts as elsewhere than in the other run"""


@dataclass(frozen=True)
class Parting:
    """Where two runs part, and how far they come to be apart while both last."""

    time: float
    """[s] of the first sample at which a point of a body is more than `APART` elsewhere"""
    body: int
    """which, the farthest of them"""
    name: str
    """of that body"""
    farthest: float
    """[m] from a body's reference point to where that is in the other run, at most"""
    farthest_time: float
    """[s]"""
    farthest_name: str

    def __str__(self) -> str:
        """``from 80.41 s on (r3 first), up to 2.31 m apart (r4 at 95.20 s)``."""
        return (
            f"from {self.time:.2f} s on ({self.name} first), up to {amount(self.farthest, 'm', 2)}"
            f" apart ({self.farthest_name} at {self.farthest_time:.2f} s)"
        )


def is_branch(branch: Record, original: Record) -> bool:
    """Whether a record is of a branch of the run of another."""
    digest = branch.origin.digest
    return bool(digest) and digest == original.digest()


def parting(original: Record, branch: Record) -> Parting | None:
    """Where a branch parts from its original; None where it never does while both last."""
    steps, mine, theirs = np.intersect1d(
        branch.steps, original.steps, assume_unique=True, return_indices=True
    )
    if not len(steps):
        return None
    off = branch.moving_pose[mine] - original.moving_pose[theirs]
    far = np.hypot(off[..., 0], off[..., 1])
    elsewhere = far + branch.shapes.radius * np.abs(off[..., 2])
    apart = np.flatnonzero((elsewhere > APART).any(axis=1))
    if not len(apart):
        return None
    bodies, body = branch.bodies, int(np.argmax(elsewhere[apart[0]]))
    first, (last, who) = int(apart[0]), np.unravel_index(np.argmax(far), far.shape)
    return Parting(
        float(steps[first] * branch.dt), body, bodies[body].name,
        float(far[last, who]), float(steps[last] * branch.dt), bodies[int(who)].name,
    )  # fmt: skip
