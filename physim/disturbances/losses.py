"""Losses of a link from one robot to another: independent, or in bursts by Gilbert and Elliott.

Time goes in slots, of one message or one detection each. In the bad state of the link everything is
lost, in the good one nothing. In a slot the link is drawn anew as bad with probability a, as good
with probability b, and else stays as it was. So it turns bad with probability a where it was good,
and good with probability b where it was bad: bursts last 1 / b slots in the mean, and the share a /
(a + b) of all slots is bad. With a + b = 1 slots are independent. What was drawn last is found by
looking back, so nothing is remembered.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from physim.compiled import compiled
from physim.disturbances.named import Stream
from physim.randomness import Words, philox, share


class Losses(BaseModel):
    """Keys of what may be lost."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    probability: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="[-] share that is lost"
    )
    interval: Annotated[float, Field(ge=0.0, le=1.0e4)] = Field(
        default=0.1, description="[s] time from one to the next, rounded to physics steps"
    )
    burst: Annotated[float, Field(ge=1.0, le=1.0e6)] | None = Field(
        default=None,
        description="mean number that is lost one after the other; when absent, each is lost "
        "independently of the others",
    )
    stream: Stream = 0

    @model_validator(mode="after")
    def _consistent(self) -> Losses:
        left = 1.0 - self.probability
        if self.burst is not None and self.burst * left < 1.0 - 1e-12 and left > 0.0:
            raise ValueError(
                f"burst is {self.burst:g}; with probability {self.probability:g} the mean is "
                f"{1.0 / left:.4g} even where losses are independent: give that or more"
            )
        return self

    def slot_steps(self, dt: float) -> int:
        """Physics steps of a slot."""
        return max(1, round(self.interval / dt))

    @property
    def chance(self) -> Chance:
        """The chances of a slot."""
        p = self.probability
        if self.burst is None or p == 1.0:
            return Chance(p, 1.0 - p, p)
        good = 1.0 / self.burst
        return Chance(good * p / (1.0 - p), good, p)


class Chance(NamedTuple):
    """Chances of a slot."""

    bad: float
    """of being drawn anew as bad"""
    good: float
    """as good"""
    share: float
    """of being bad in the first slot, and in any other"""


class LastDrawn(NamedTuple):
    """When a link was drawn last."""

    slot: int
    is_bad: bool


@compiled
def last_drawn(key: Words, chance: Chance, slot: int, i: int, j: int) -> LastDrawn:
    """The slot, up to ``slot``, in which the link from j to i was drawn last, and as what."""
    found = np.empty(4, np.uint64)
    block = -1
    while slot >= 0:
        if slot // 4 != block:
            block = slot // 4
            one = np.uint64(block)
            philox(key[0], key[1], one, np.uint64(i), np.uint64(j), np.uint64(0), found)
        drawn = share(found[slot % 4])
        if slot == 0:
            return LastDrawn(0, drawn < chance.share)
        if drawn < chance.bad:
            return LastDrawn(slot, True)
        if drawn < chance.bad + chance.good:
            return LastDrawn(slot, False)
        slot -= 1
    return LastDrawn(0, False)
