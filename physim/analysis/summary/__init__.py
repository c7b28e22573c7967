"""The summary of a run from its record alone: as a value, as JSON and as a short table."""

from __future__ import annotations

from physim.analysis.summary.summary import Contacts, Summary, summarise
from physim.analysis.summary.table import table, table_rows

__all__ = ["Contacts", "Summary", "summarise", "table", "table_rows"]
