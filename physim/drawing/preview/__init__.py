"""A picture of a world before it is run, from the world alone; matplotlib is loaded late."""

from __future__ import annotations

from physim.drawing.preview.picture import FORMATS, save_preview

__all__ = ["FORMATS", "save_preview"]
