"""The controller that is checked, made anew as often as a rule needs it."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from physim.control import Controller
from physim.errors import ControllerError, WorldError
from physim.registry import CONTROLLER, checked_settings, find_part, made_part
from physim.testing.answers import Make
from physim.world import World


@dataclass(frozen=True)
class Candidate:
    """A controller by its class and settings, or by an object that is copied."""

    name: str
    kind: type[Any]
    settings: Mapping[str, Any] | None
    """None: those of a world that has this controller, else the controller's own"""
    given: Controller | None
    """the object; it is never asked itself"""

    def maker(self, world: World | None = None) -> Make:
        """How to make it for a world.

        Raises ControllerError where it cannot be made or copied, WorldError with a fault for each
        setting that is wrong.
        """
        if self.given is not None:
            original = _copy(self.given, self.name)
            return lambda: _copy(original, self.name)
        settings = self.settings
        if settings is None:
            settings = world.controller.settings if world is not None and self._is_in(world) else {}
        made, faults = checked_settings(self.kind, settings, CONTROLLER.key)
        if faults:
            raise WorldError(faults)

        def make() -> Controller:
            controller: Controller = made_part(CONTROLLER, self.kind, made, self.name)
            return controller

        return make

    def _is_in(self, world: World) -> bool:
        """Whether it is the world's own controller."""
        try:
            return self.kind is find_part(
                CONTROLLER, world.controller.type, trusted=":" in self.name
            )
        except ControllerError:
            return False


def candidate(
    controller: type[Any] | Controller | str, settings: Mapping[str, Any] | None
) -> Candidate:
    """Take a class, an object, a registered name or ``module:Class``. Raises ControllerError."""
    if isinstance(controller, str):
        return Candidate(
            controller, find_part(CONTROLLER, controller, trusted=True), settings, None
        )
    kind = controller if isinstance(controller, type) else type(controller)
    if not callable(getattr(controller, "decide", None)):
        raise ControllerError(f"{kind.__name__} has no method decide(observation, memory)")
    if isinstance(controller, type):
        return Candidate(kind.__name__, kind, settings, None)
    if settings is not None:
        raise ControllerError(
            f"settings go with a class or a name; the {kind.__name__} given is made already"
        )
    return Candidate(kind.__name__, kind, None, controller)


def _copy(controller: Controller, name: str) -> Controller:
    try:
        return copy.deepcopy(controller)
    except Exception as error:
        reason = " ".join(str(error).split())[:200]
        raise ControllerError(
            f"the {name} given cannot be copied ({type(error).__name__}: {reason}); give its class"
        ) from error
