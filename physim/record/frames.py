"""Tables of a record as pandas data frames, with names in the place of numbers.

pandas is no dependency of physim: it is imported when it is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from physim.contacts import Kind, Phase
from physim.errors import MissingExtraError, PhysimError

if TYPE_CHECKING:
    import pandas as pd

    from physim.record.reader import Record

FRAMES = ("steps", "updates", "contacts", "commands", "considered", "false_contacts", "sensed")


def frame(record: Record, table: str) -> pd.DataFrame:
    """One of `FRAMES`. Raises PhysimError for another, and where pandas is not installed."""
    if table not in FRAMES:
        raise PhysimError(f"table {table!r}; allowed: {', '.join(FRAMES)}")
    try:
        import pandas as pd
    except ImportError:
        raise MissingExtraError("to_pandas", "study") from None
    if table == "steps":
        columns = _steps(record)
    else:
        rows = getattr(record, table)
        columns = {"time": rows["step"] * record.dt, **{n: rows[n] for n in rows.dtype.names}}
    bodies = [body.name for body in record.bodies]
    for name in {"robot", "a", "b", "other", "observer", "body"} & set(columns):
        columns[name] = pd.Categorical.from_codes(columns[name], bodies)
    for name, words in (
        ("mode", [mode.name for mode in record.modes]),
        ("rule", [rule.name for rule in record.declared.rules]),
        ("phase", [phase.name.lower() for phase in Phase]),
        ("kind", [kind.name.lower() for kind in Kind]),
    ):
        if name in columns:
            columns[name] = [words[k] if k >= 0 else None for k in columns[name].tolist()]
    return pd.DataFrame(columns)


def _steps(record: Record) -> dict[str, Any]:
    """A row for each recorded sample and robot."""
    x, y, heading = record.pose.reshape(-1, 3).T
    return {
        "time": np.repeat(record.time, record.robots),
        "robot": np.tile(np.arange(record.robots), record.samples),
        "x": x,
        "y": y,
        "heading": heading,
        "clearance": record.clearance.ravel(),
        "boundary_clearance": record.boundary_clearance.ravel(),
        **({"steering": record.steering.ravel()} if record.holds("/steps/steering") else {}),
    }


__all__ = ["FRAMES", "frame"]
