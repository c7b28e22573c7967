"""Deviations and formation errors as this page takes them: at the decisions of the robots.

The paper's figures are of its update instants, which are at most 0.2 s apart; physim's own metrics
are of every sample, and so a little larger where robots turn.
"""

from __future__ import annotations

import numpy as np

from physim.analysis.metrics import Series, column_over_time, has_formation, last_decisions
from physim.analysis.metrics.progress import active_decisions
from physim.geometry.shapes import FloatArray
from physim.record import Record


def deviations(record: Record) -> Series:
    """Deviation of each robot from its own path, left positive: values (K, N) [m] over time [s]."""
    return column_over_time(record, "deviation")


def deviation_rms(record: Record) -> float:
    """Root mean square deviation [m] of all robots: that of a decision counts as long as it held.

    nan where no active robot decided.
    """
    rows, held = active_decisions(record)
    total = held.sum()
    return float(np.sqrt(held @ np.square(rows["deviation"]) / total)) if total > 0 else np.nan


def formation_errors(record: Record) -> Series | None:
    """Formation error of each robot, (10): values (K, N) [m] over time [s]; None without any."""
    return column_over_time(record, "formation_error") if has_formation(record) else None


def formation_error_peak(record: Record) -> float:
    """Largest size of a formation error at a decision [m]; nan where there is none."""
    return _largest(record, record.updates["formation_error"])


def formation_error_final(record: Record) -> float:
    """Largest size of the formation errors at the robots' last decisions [m]."""
    return _largest(record, record.updates["formation_error"][last_decisions(record)])


def _largest(record: Record, errors: FloatArray) -> float:
    if not has_formation(record) or not len(errors):
        return np.nan
    return float(np.abs(errors).max())
