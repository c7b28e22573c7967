"""Pictures of a record for papers and reports, from the record alone; matplotlib is loaded late."""

from __future__ import annotations

from physim.plots.pictures import FORMATS, NAMES, draw

__all__ = ["FORMATS", "NAMES", "draw"]
