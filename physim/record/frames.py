"""Tables of a record as pandas data frames, with names in the place of numbers.

pandas is no dependency of physim: it is imported when it is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from physim.contacts import Kind, Phase
from physim.errors import PhysimError

if TYPE_CHECKING:
    import pandas as pd

    from physim.record.reader import Record

FRAMES = ("steps", "updates", "contacts")


def frame(record: Record, table: str) -> pd.DataFrame:
    """One of `FRAMES`. Raises PhysimError for another, and where pandas is not installed."""
    if table not in FRAMES:
        raise PhysimError(f"table {table!r}; allowed: {', '.join(FRAMES)}")
    try:
        import pandas as pd
    except ImportError:
        raise PhysimError("to_pandas needs pandas (pip install pandas)") from None
    columns = {"steps": _steps, "updates": _updates, "contacts": _contacts}[table](record)
    return pd.DataFrame(columns)


def _steps(record: Record) -> dict[str, Any]:
    """A row for each recorded sample and robot."""
    count, robots = record.samples, record.robots
    pose = np.asarray(record.pose).reshape(-1, 3)
    return {
        "time": np.repeat(record.time, robots),
        "robot": _named(record, np.tile(np.arange(robots), count)),
        "x": pose[:, 0],
        "y": pose[:, 1],
        "heading": pose[:, 2],
        "clearance": np.asarray(record.clearance).reshape(-1),
        "boundary_clearance": np.asarray(record.boundary_clearance).reshape(-1),
    }


def _updates(record: Record) -> dict[str, Any]:
    """A row for each decision."""
    rows = record.updates
    found: dict[str, Any] = {"time": rows["step"] * record.dt}
    for name in rows.dtype.names or ():
        found[name] = np.array(rows[name])
    found["robot"] = _named(record, rows["robot"])
    for column, words in (("mode", record.modes), ("rule", record.declared.rules)):
        names = [one.name for one in words]
        found[column] = [names[k] if 0 <= k < len(names) else None for k in rows[column].tolist()]
    return found


def _contacts(record: Record) -> dict[str, Any]:
    """A row for each touching pair and step."""
    rows = record.contacts
    found: dict[str, Any] = {"time": rows["step"] * record.dt}
    for name in rows.dtype.names or ():
        found[name] = np.array(rows[name])
    found["a"], found["b"] = _named(record, rows["a"]), _named(record, rows["b"])
    found["phase"] = [Phase(k).name.lower() for k in rows["phase"].tolist()]
    found["kind"] = [Kind(k).name.lower() for k in rows["kind"].tolist()]
    return found


def _named(record: Record, ids: Any) -> Any:
    """Names of bodies, as a categorical column."""
    import pandas as pd

    return pd.Categorical.from_codes(ids, [body.name for body in record.bodies])


__all__ = ["FRAMES", "frame"]
