"""Edits of the paper's controller: every rule, broken one way or another."""

from __future__ import annotations

from tests.sabotage.edit import Edit
from tests.sabotage.edits.controllers import (
    avoidance,
    checking,
    decision_reports,
    following,
    formation,
    memory,
    mode_switching,
    plain_form,
    plans,
    switching,
)

EDITS: tuple[Edit, ...] = tuple(
    edit
    for part in (
        avoidance,
        mode_switching,
        plans,
        switching,
        decision_reports,
        plain_form,
        following,
        formation,
        memory,
        checking,
    )
    for edit in part.EDITS
)
