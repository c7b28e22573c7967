"""Claims in words as experiments, a module each; every module holds one `Study` named STUDY."""

from __future__ import annotations

from physim.reproduction.study import Study


def studies() -> tuple[Study, ...]:
    """All experiments, in the order of the paper."""
    from physim.reproduction.studies import (
        alpha,
        bends,
        energy,
        hysteresis,
        operation,
        routes,
        switching,
        updates,
    )

    modules = (alpha, energy, bends, routes, switching, hysteresis, updates, operation)
    return tuple(module.STUDY for module in modules)
