"""Claims in words as experiments."""

from __future__ import annotations

from physim.reproduction.studies.bends import BENDS, ROUTES
from physim.reproduction.studies.group import (
    AVOIDANCE,
    HYSTERESIS,
    OPERATION,
    SWITCHING,
    THRESHOLDS,
    UPDATES,
)
from physim.reproduction.studies.straight_road import ALPHA, ENERGY
from physim.reproduction.study import Study


def studies() -> tuple[Study, ...]:
    """All experiments, in the order of the paper."""
    return (
        ALPHA, ENERGY, BENDS, ROUTES, AVOIDANCE, SWITCHING, HYSTERESIS, THRESHOLDS, UPDATES,
        OPERATION,
    )  # fmt: skip
