"""Pictures of a record for papers and reports, from the record alone.

Names are imported when first used: the style alone is had without the record.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physim.drawing.plots.pictures import FORMATS, NAMES, draw, names, not_replaced

__all__ = ["FORMATS", "NAMES", "draw", "names", "not_replaced"]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module 'physim.plots' has no attribute '{name}'")
    return getattr(import_module("physim.drawing.plots.pictures"), name)
