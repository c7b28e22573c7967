"""Names under which files are written until they are whole."""

from __future__ import annotations

from pathlib import Path
from uuid import uuid4


def draft_of(path: Path) -> Path:
    """A hidden name in the folder of a file that nobody else takes for it."""
    return path.with_name(f".physim-{uuid4().hex}.part")


__all__ = ["draft_of"]
