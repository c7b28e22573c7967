"""Metrics of one's own in rows: a text in each row, and of all rows a column for each metric."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from physim.errors import PhysimError

if TYPE_CHECKING:
    import pyarrow as pa

    from physim.analysis.metrics import Metric
    from physim.analysis.metrics.registered import Registered

TEXT = "metrics"
"""The column of rows with ``gap=0.25; stops=90.0``: names in order, those that had a meaning."""
PREFIX = "metric_"
"""Of columns of their numbers, so that no metric's name is that of another column."""
ONE = r"[a-z][a-z0-9_]*=-?[0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)?"
PATTERN = rf"({ONE}(; {ONE})*)?"
MOST = 1000
"""Different metrics of a campaign: rows may come from strangers."""


@functools.cache
def installed() -> Registered:
    """The metrics that packages registered, looked for once in a process."""
    from physim.analysis.metrics import DEFINITIONS, own_metrics  # readers of rows need none

    return own_metrics(DEFINITIONS)


def text_of(found: Mapping[str, Metric]) -> str:
    """The values of one's own metrics of a run, as a row has them."""
    names = sorted(installed().definitions.keys() & found.keys())
    return "; ".join(f"{name}={float(found[name].value)!r}" for name in names)


def with_columns(table: pa.Table) -> pa.Table:
    """Rows with a column of numbers for each metric that any of them has; null where a row has not.

    Raises PhysimError for more than `MOST` metrics and for what is no finite number.
    """
    import pyarrow as pa

    texts = table[TEXT].combine_chunks().dictionary_encode()
    words = [dict(part.split("=") for part in one.split("; ")) if one else {}
             for one in texts.dictionary.to_pylist()]  # fmt: skip
    names = sorted({name for one in words for name in one})
    if len(names) > MOST:
        raise PhysimError(f"rows have {len(names):,} metrics; allowed: at most {MOST:,}")
    for name in names:
        values = pa.array([_number(name, one[name]) if name in one else None for one in words],
                          pa.float64())  # fmt: skip
        table = table.append_column(PREFIX + name, values.take(texts.indices))
    return table


def columns_of(table: pa.Table) -> list[str]:
    """Names of the columns of one's own metrics."""
    return [name for name in table.column_names if name.startswith(PREFIX)]


def title_of(column: str) -> tuple[str, str]:
    """Name of the metric of a column, and its unit where it is installed here."""
    name = column.removeprefix(PREFIX)
    known = installed().definitions.get(name)
    unit = "" if known is None or known.unit == "-" else known.unit
    return name, unit


def _number(name: str, text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise PhysimError(f"metric {name}: {text} stands in a row; allowed: a finite number")
    return value


__all__ = ["PREFIX", "columns_of", "installed", "text_of", "title_of", "with_columns"]
