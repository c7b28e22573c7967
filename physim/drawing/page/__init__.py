"""A run in the browser: one HTML file to watch, scrub and ask why, from the record alone."""

from __future__ import annotations

from physim.drawing.page.document import MOST_RUNS, Page, drawn_between, page, write_page

__all__ = ["MOST_RUNS", "Page", "drawn_between", "page", "write_page"]
