"""Claims in words as experiments."""

from __future__ import annotations

from physim.reproduction.studies.bends import BENDS, ROUTES
from physim.reproduction.studies.danger_mode import AVOIDANCE, HYSTERESIS, SWITCHING, THRESHOLDS
from physim.reproduction.studies.efficiency import OPERATION, UPDATES
from physim.reproduction.studies.straight_road import ALPHA, ENERGY
from physim.reproduction.study import Study


def studies() -> tuple[Study, ...]:
    """All experiments, in the order of the paper."""
    return (
        ALPHA, ENERGY, BENDS, ROUTES, AVOIDANCE, SWITCHING, HYSTERESIS, THRESHOLDS, UPDATES,
        OPERATION,
    )  # fmt: skip
