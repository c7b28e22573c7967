"""All edits, by room."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits import (
    geometry, physics,
)

EDITS: tuple[Edit, ...] = (
    *geometry.EDITS, *physics.EDITS,
)
