"""Edits of the paper's controller: every rule, broken one way or another."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits.controllers import (
    avoidance,
    checking,
    following,
    formation,
    memory,
    mode_switching,
    mode_switching_rest,
    switching,
)

EDITS: tuple[Edit, ...] = tuple(
    edit
    for part in (
        avoidance,
        mode_switching,
        mode_switching_rest,
        switching,
        following,
        formation,
        memory,
        checking,
    )
    for edit in part.EDITS
)
