"""Claims in words as experiments, a module each; every module holds one `Study` named STUDY."""

from __future__ import annotations

from physim.reproduction.study import Study


def studies() -> tuple[Study, ...]:
    """All experiments, in the order of the paper."""
    from physim.reproduction.studies import (
        alpha,
        avoidance,
        bends,
        energy,
        hysteresis,
        operation,
        routes,
        switching,
        thresholds,
        updates,
    )

    modules = (
        alpha, energy, bends, routes, avoidance, switching, hysteresis, thresholds, updates,
        operation,
    )  # fmt: skip
    return tuple(module.STUDY for module in modules)
