"""Controllers that are given beside a world, and settings that are not those of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from physim.errors import Fault, WorldError
from physim.world.faults import KeyFault, describe
from physim.world.file.nodes import OverridePosition


def check_one_controller(overrides: Sequence[str], controller: str, source: str) -> None:
    """Raise WorldError where an override would take the place of the controller given beside it."""
    for override in overrides:
        key = override.partition("=")[0].strip()
        if key in ("controller", "controller.type"):
            message = (
                f"would take the place of --controller {describe(controller)}; give one of them, "
                "and settings as --set controller.KEY=VALUE"
            )
            place = OverridePosition(source, 1, 1, key)
            raise WorldError([Fault(tuple(key.split(".")), message)], [place])


def of_another_controller(fault: Fault) -> Fault:
    """An unknown key of a controller, with what to do if it is one of another controller."""
    if not isinstance(fault, KeyFault) or "did you mean" in fault.message:
        return fault
    key = ".".join(map(str, fault.location))
    return replace(
        fault,
        message=f"{fault.message}; if it is a setting of another controller, name that one, by "
        f"controller.type or --controller, or leave it out (of a file: --set {key}=null)",
    )
