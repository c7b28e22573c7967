"""Names under which files are written until they are whole."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from uuid import uuid4


def draft_of(path: Path) -> Path:
    """A hidden name in the folder of a file that nobody else takes for it."""
    return path.with_name(f".physim-{uuid4().hex}.part")


def discard(draft: Path) -> None:
    """Remove what is left of a draft after an error, which stays the one to be told.

    A folder that is gone or read-only by now would raise another, about a name nobody gave.
    """
    with suppress(OSError):
        draft.unlink(missing_ok=True)


__all__ = ["discard", "draft_of"]
