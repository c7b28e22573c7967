"""Edits of `physim.geometry`."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits.geometry import distances, paths, shapes, walls

EDITS: tuple[Edit, ...] = tuple(
    edit for part in (paths, shapes, distances, walls) for edit in part.EDITS
)
