"""Asking the stages of a step: what they answer is checked, and their errors name them."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.author_code import kind_of
from physim.control import Sensed, Snapshot
from physim.control_loop import check_applied, check_commands
from physim.errors import ControllerError
from physim.geometry.shapes import FloatArray, read_only
from physim.part_checks import call, naming, returned, two
from physim.registry import DISTURBANCE, FILTER, SENSING
from physim.scene import Scene
from physim.stages import Disturbance, Filter, SenseStage, check_sensed


def ask_sense(
    part: SenseStage, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
) -> tuple[Sensed, Any]:
    """What robots know after a sensing stage, and its next state."""
    with naming(SENSING, part, truth.step * scene.dt):
        answer = call(SENSING, part, "sense", scene, truth, sensed, state)
        found, state = two(part, "sense", answer, "sensed")
        if not isinstance(found, Sensed):
            raise returned(part, "sense", f"{kind_of(found)} first; that must be a Sensed")
        check_sensed(found, scene, part)
    return found, state


def ask_filter(
    part: Filter, scene: Scene, sensed: Sensed, nominal: FloatArray, state: Any
) -> tuple[FloatArray, Any]:
    """Commands (N, 2) after a filter, within the robots' limits, and its next state."""
    time = sensed.step * scene.dt
    with naming(FILTER, part, time):
        answer = call(FILTER, part, "filter", scene, sensed, nominal, state)
        found, state = two(part, "filter", answer, "commands")
        commands = _commands(scene, part, "filter", found)
    try:
        check_commands(scene, time, np.arange(scene.robots), commands)
    except ControllerError as error:
        raise ControllerError(f"filter {type(part).__name__}: {error}") from None
    return commands, state


def ask_disturbance(
    part: Disturbance, scene: Scene, truth: Snapshot, filtered: FloatArray, state: Any
) -> tuple[FloatArray, Any]:
    """Commands (N, 2) after a disturbance, and its next state."""
    time = truth.step * scene.dt
    with naming(DISTURBANCE, part, time):
        answer = call(DISTURBANCE, part, "disturb", scene, truth, filtered, state)
        found, state = two(part, "disturb", answer, "commands")
        commands = _commands(scene, part, "disturb", found)
    check_applied(scene, time, commands, part)
    return commands, state


def _commands(scene: Scene, part: object, method: str, found: Any) -> FloatArray:
    """Commands as an array of our own, unless they are what was given."""
    if isinstance(found, np.ndarray) and not found.flags.writeable:
        return found
    try:
        return read_only(np.array(found, dtype=np.float64))
    except (TypeError, ValueError):
        must = f"those must be an array of numbers, shape ({scene.robots}, 2)"
        raise returned(part, method, f"{kind_of(found)} as commands; {must}") from None
