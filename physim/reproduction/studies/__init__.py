"""Claims in words as experiments."""

from __future__ import annotations

from physim.reproduction.studies.alpha import ALPHA
from physim.reproduction.studies.avoidance import AVOIDANCE
from physim.reproduction.studies.bends import BENDS
from physim.reproduction.studies.energy import ENERGY
from physim.reproduction.studies.hysteresis import HYSTERESIS
from physim.reproduction.studies.operation import OPERATION
from physim.reproduction.studies.routes import ROUTES
from physim.reproduction.studies.switching import SWITCHING
from physim.reproduction.studies.thresholds import THRESHOLDS
from physim.reproduction.studies.updates import UPDATES
from physim.reproduction.study import Study


def studies() -> tuple[Study, ...]:
    """All experiments, in the order of the paper."""
    return (
        ALPHA, ENERGY, BENDS, ROUTES, AVOIDANCE, SWITCHING, HYSTERESIS, THRESHOLDS, UPDATES,
        OPERATION,
    )  # fmt: skip
