"""Considered robots, packed decision after decision in the file, as rows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.errors import RecordError
from physim.record import layout
from physim.record.repeats import repeated
from physim.record.row_checks import Source


def considered_rows(
    source: Source, decisions: NDArray[np.void], others: NDArray[Any], robots: int
) -> NDArray[np.void]:
    """Rows of `layout.CONSIDERED`: ``others`` (E,), as many of them as each decision counts.

    ``decisions`` are rows of `layout.CONSIDERING`; ``source`` names ``others``. Raises RecordError
    where there are more or fewer than counted, for a robot that is not there, and for one that is
    considered twice in a decision.
    """
    count = decisions["count"]
    counted = int(count.sum(dtype=np.int64))
    if len(others) != counted:
        raise RecordError(
            f"{source.where}: {source.path} has {len(others)} rows, /considered counts {counted}; "
            "make the record again"
        )
    source.within("it", others, 0, robots - 1)
    rows = np.empty(counted, dtype=layout.CONSIDERED)
    rows["step"], rows["robot"] = (np.repeat(decisions[name], count) for name in ("step", "robot"))
    rows["other"] = others
    source.refuse(
        repeated([np.repeat(np.arange(len(decisions)), count), others]),
        lambda k: (
            f"robot {rows['robot'][k]} considers {others[k]} at step {rows['step'][k]} again; it "
            "may be there once"
        ),
    )
    return rows


__all__ = ["considered_rows"]
