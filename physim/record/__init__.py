"""The record of a run: one HDF5 file, written as the run goes, read by everything above."""

from __future__ import annotations

from physim.record.checks import check_record
from physim.record.layout import NO_ORIGIN, Origin
from physim.record.reader import Record
from physim.record.writer import RecordWriter

__all__ = ["NO_ORIGIN", "Origin", "Record", "RecordWriter", "check_record"]
