"""Between controllers and the loop: plain controllers as a batch, and checks of what they say."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from physim.control import Controller, Decision, Decisions, Observation, Snapshot
from physim.errors import ControllerError, PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.scene import Scene

ROUNDING = 1e-9
"""Share of a step, and of a limit, that rounding may take up."""
LONGEST_HOLD = 10**9
"""[steps] a hold of inf: never again"""


class PlainBatch:
    """A controller that decides for one robot at a time, asked for each robot that is due."""

    def __init__(
        self, controller: Controller, scene: Scene, observe: Callable[[int], Observation]
    ) -> None:
        self.controller = controller
        self.scene = scene
        self.observe = observe
        self.memory: list[Any] = [None] * scene.robots

    def decide_due(self, snapshot: Snapshot, due: IntArray) -> Decisions:
        """Decide for robots ``due``; every one sees the same snapshot, whatever their order."""
        decisions = [self._decide(int(i), snapshot.step * self.scene.dt) for i in due]
        for i, decision in zip(due, decisions, strict=True):
            self.memory[i] = decision.memory
        return Decisions(
            due,
            np.array([(d.v, d.omega) for d in decisions], dtype=np.float64),
            np.array([d.hold for d in decisions], dtype=np.float64),
            np.array([int(d.mode) for d in decisions], dtype=np.int64),
            np.array([_report_row(d) for d in decisions]),
        )

    def _decide(self, i: int, time: float) -> Decision:
        name = type(self.controller).__name__
        where = f"controller {name}, {self.scene.names[i]} at {time:g} s"
        try:
            decision: object = self.controller.decide(self.observe(i), self.memory[i])
        except PhysimError:
            raise
        except Exception as error:
            raise ControllerError(f"{where}: {type(error).__name__}: {error}") from error
        if not isinstance(decision, Decision):
            given = type(decision).__name__
            raise ControllerError(f"{where}: decide returned {given}; it must return a Decision")
        return decision


def check_commands(scene: Scene, time: float, robots: IntArray, command: FloatArray) -> None:
    """Refuse commands (M, 2) that are not finite or beyond the robots' limits."""
    if command.shape != (len(robots), 2):
        raise ControllerError(
            f"commands at {time:g} s have the shape {command.shape}; it must be ({len(robots)}, 2)"
        )
    allowed = scene.limits[robots] * (1.0 + ROUNDING)
    fine = np.abs(command) <= allowed  # False for NaN
    if fine.all():
        return
    row, column = np.argwhere(~fine)[0]
    quantity, unit = (("v", "m/s"), ("omega", "rad/s"))[column]
    raise ControllerError(
        f"{scene.names[robots[row]]} at {time:g} s: command {quantity} = "
        f"{command[row, column]:g} {unit}; its limit is {scene.limits[robots[row], column]:g} "
        f"{unit}"
    )


def hold_steps(scene: Scene, time: float, robots: IntArray, hold: FloatArray) -> IntArray:
    """Steps (M,) that decisions hold: ``hold`` [s] rounded down, one at least (14)."""
    fine = hold >= 0.0
    if not fine.all():
        row = int(np.argmin(fine))
        raise ControllerError(
            f"{scene.names[robots[row]]} at {time:g} s: hold = {hold[row]:g} s; it must be a "
            "time of at least 0 s"
        )
    steps = np.floor(hold / scene.dt + ROUNDING)
    return np.minimum(np.maximum(steps, 1.0), LONGEST_HOLD).astype(np.int64)


def _report_row(decision: Decision) -> tuple[float, ...]:
    r = decision.report
    return (
        *r.target,
        r.distance,
        r.boundary_distance,
        r.collision_time,
        float(r.considered),
        float(r.evaluations),
    )
