"""Rows as a Parquet file. Raises MissingExtraError when imported where pyarrow is not installed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from physim.campaigns.rows import ROW, Row, as_table
from physim.errors import MissingExtraError
from physim.files import written

try:
    import pyarrow as pa
    from pyarrow import parquet
except ImportError:
    raise MissingExtraError("--parquet", "study") from None


def write_parquet(rows: Sequence[Row], file: Path) -> None:
    """Write rows with the columns of ``results.csv``; what has no value is null.

    Raises PhysimError where the file cannot be written.
    """
    types = {"string": pa.string(), "integer": pa.int64(), "number": pa.float64()}
    declared = ROW.json_schema()["properties"]
    names, *values = as_table(rows)
    made = {}
    for k, name in enumerate(names):
        one = declared.get(name, {"type": "number"})  # else a metric that a package registered
        kind = one["anyOf"][0]["type"] if "anyOf" in one else one["type"]
        made[name] = pa.array([row[k] for row in values], types[kind])
    with written(file) as stream:
        parquet.write_table(pa.table(made), stream)
