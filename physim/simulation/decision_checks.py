"""Checks of commands and decisions: quick ones in compiled code, and those that say what is wrong.

A quick check that has a doubt leaves the word to the thorough one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.errors import ControllerError, plural
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.parts.controller import FASTEST, LONGEST_HOLD, Decisions
from physim.parts.declarations import NO_NUMBER, Declared
from physim.tolerances import SHARE
from physim.world.scene import Scene

COMMAND = (("v", "m/s"), ("omega", "rad/s"))
"""Quantity and unit of either part of a command."""


def checked(
    scene: Scene, step: int, due: IntArray, decisions: Decisions, declared: Declared
) -> IntArray:
    """Steps (M,) of the next decisions; ControllerError says what is wrong with these."""
    time = step * scene.dt
    check_commands(scene, time, due, decisions.command)
    check_decisions(scene, time, decisions, declared)
    return step + hold_steps(scene, time, due, decisions.hold)


def plainly_fine(
    scene: Scene, step: int, due: IntArray, d: Decisions, declared: Declared
) -> IntArray | None:
    """What `checked` returns, at a fraction of its cost, or None where that has to look."""
    many, columns = len(due), len(declared.columns)
    shapes = d.command.shape, d.hold.shape, d.mode.shape, d.rule.shape, d.considered_start.shape
    if (
        shapes != ((many, 2), (many,), (many,), (many,), (many + 1,))
        or d.report.shape != (many, columns)
        or not d.command.dtype == d.hold.dtype == np.float64
        or not d.mode.dtype == d.rule.dtype == np.int64
        or not getattr(d.considered, "dtype", None) == d.considered_start.dtype == np.int64
        or d.considered.ndim != 1
        or not d.command.flags.c_contiguous
    ):
        return None
    next_step = np.empty(many, dtype=np.int64)
    fine = fits(
        scene.limits, due, d.command, d.hold, d.mode, d.rule, d.considered, d.considered_start,
        len(declared.modes), len(declared.rules), step, scene.dt, next_step,
    )  # fmt: skip
    return next_step if fine else None


@compiled
def fits(
    limits: FloatArray,
    due: IntArray,
    command: FloatArray,
    hold: FloatArray,
    mode: IntArray,
    rule: IntArray,
    considered: IntArray,
    considered_start: IntArray,
    modes: int,
    rules: int,
    step: int,
    dt: float,
    next_step: IntArray,
) -> bool:
    """Whether decisions pass all checks of `checked`; writes their ``next_step`` (M,)."""
    seen = np.full(len(limits), -1)  # the row that considered each robot last
    for k in range(len(due)):
        for column in range(2):
            if not abs(command[k, column]) <= limits[due[k], column] * (1.0 + SHARE):
                return False
        if not (hold[k] >= 0.0 and NO_NUMBER <= mode[k] < modes and NO_NUMBER <= rule[k] < rules):
            return False
        held = min(max(np.floor(hold[k] / dt + SHARE), 1.0), LONGEST_HOLD)
        next_step[k] = step + np.int64(held)
        first, end = considered_start[k], considered_start[k + 1]
        if not 0 <= first <= end <= len(considered) or end - first >= len(limits):
            return False
        for j in considered[first:end]:
            if not 0 <= j < len(limits) or j == due[k] or seen[j] == k:
                return False
            seen[j] = k
    return bool(considered_start[0] == 0 and considered_start[-1] == len(considered))


def outside(scene: Scene, step: int, given: ArrayLike) -> FloatArray:
    """Commands (N, 2) from outside, a copy; ControllerError where robots cannot take them."""
    try:
        if np.iscomplexobj(given):
            raise TypeError
        nominal = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ControllerError(
            f"commands at {step * scene.dt:g} s are not an array of numbers (N, 2)"
        ) from None
    if nominal.shape != scene.limits.shape or not within(scene.limits, nominal):
        check_commands(scene, step * scene.dt, None, nominal)
    return read_only(nominal)


@compiled
def within(limits: FloatArray, command: FloatArray) -> bool:
    """Whether all commands (N, 2) are finite and within the robots' limits (N, 2)."""
    for i in range(len(limits)):
        for column in range(2):
            if not abs(command[i, column]) <= limits[i, column] * (1.0 + SHARE):
                return False
    return True


def check_commands(scene: Scene, time: float, robots: IntArray | None, command: FloatArray) -> None:
    """Refuse commands (M, 2) of ``robots``, or all, not finite or beyond the robots' limits."""
    limits = scene.limits if robots is None else scene.limits[robots]
    if command.shape != limits.shape:
        raise ControllerError(
            f"commands at {time:g} s have the shape {command.shape}; it must be {limits.shape}"
        )
    fine = np.abs(command) <= limits * (1.0 + SHARE)  # False for NaN
    if np.count_nonzero(fine) == fine.size:
        return
    row, column = np.argwhere(~fine)[0]
    quantity, unit = COMMAND[column]
    value, most = command[row, column], limits[row, column]
    raise ControllerError(
        f"{scene.names[row if robots is None else robots[row]]} at {time:g} s: command {quantity} "
        f"= {_beside(value, most)} {unit}; it must be finite and within "
        f"{most:g} {unit} in either direction{_if_rounded(value, most)}"
    )


def _if_rounded(value: float, most: float) -> str:
    """A hint where a value beyond a limit is that limit, rounded to 32 bits."""
    is_rounded = float(np.float32(most)) == abs(value)
    return "; numbers of 32 bits are rounded: clip those of 64 bits" if is_rounded else ""


def _beside(value: float, most: float) -> str:
    """A value with as many digits as tell it from what is allowed: single precision rounds up."""
    texts = (f"{value:.{digits}g}" for digits in range(6, 18))
    return next(text for text in texts if abs(float(text)) != most or abs(value) == most)


def check_applied(scene: Scene, time: float, applied: FloatArray, part: object) -> None:
    """Refuse applied commands that are no finite (N, 2) within `FASTEST`."""
    name, shape = type(part).__name__, (scene.robots, 2)
    if np.shape(applied) != shape:
        raise ControllerError(
            f"disturbance {name}: commands at {time:g} s have the shape {np.shape(applied)}; it "
            f"must be {shape}"
        )
    wrong = ~(np.abs(applied) <= FASTEST)  # also for NaN
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        quantity, unit = COMMAND[column]
        raise ControllerError(
            f"disturbance {name}: {scene.names[row]} at {time:g} s: command {quantity} = "
            f"{applied[row, column]:g} {unit}; it must be finite, at most {FASTEST:g} {unit} in "
            "either direction"
        )


def check_decisions(scene: Scene, time: float, decisions: Decisions, declared: Declared) -> None:
    """Refuse numbers of modes, rules and robots, and shapes, that no record may hold."""
    d, robots = decisions, decisions.robot
    many = len(robots)
    start = d.considered_start.astype(np.int64)
    shapes = (
        ("hold", d.hold.shape, (many,)),
        ("mode", d.mode.shape, (many,)),
        ("rule", d.rule.shape, (many,)),
        ("report", d.report.shape, (many, len(declared.columns))),
        ("considered", np.shape(d.considered), (len(d.considered),)),
        ("considered_start", start.shape, (many + 1,)),
    )
    for name, found, wanted in shapes:
        if found != wanted:
            raise ControllerError(
                f"decisions at {time:g} s: {name} has the shape {found}; it must be {wanted}"
            )
    for name, values, most in (
        ("mode", d.mode, len(declared.modes)),
        ("rule", d.rule, len(declared.rules)),
    ):
        if values.min() < NO_NUMBER or values.max() >= most:
            row = int(np.argmax((values < NO_NUMBER) | (values >= most)))
            raise ControllerError(
                f"{scene.names[robots[row]]} at {time:g} s: {name} = {values[row]}; allowed: "
                f"{NO_NUMBER} to {most - 1}"
            )
    if len(d.considered) and (d.considered.min() < 0 or d.considered.max() >= scene.robots):
        raise ControllerError(
            f"decisions at {time:g} s: considered robots {d.considered.min()} to "
            f"{d.considered.max()}; allowed: 0 to {scene.robots - 1}"
        )
    counts = np.diff(start)
    if start[0] or start[-1] != len(d.considered) or (counts < 0).any():
        raise ControllerError(
            f"decisions at {time:g} s: considered_start is {start}; it must part "
            f"{plural(len(d.considered), 'considered robot')} in their order"
        )
    rows, others = np.repeat(np.arange(many), counts), np.asarray(d.considered, dtype=np.int64)
    order = np.lexsort((others, rows))
    wrong = np.repeat(robots, counts) == others
    wrong[order[1:]] |= (np.diff(rows[order]) == 0) & (np.diff(others[order]) == 0)
    if wrong.any():
        row = int(rows[wrong][0])
        raise ControllerError(
            f"{scene.names[robots[row]]} at {time:g} s: considered lists "
            f"{d.considered[start[row] : start[row + 1]].tolist()}; it must list others than the "
            f"robot itself, which is {robots[row]}, each once"
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
    steps = np.floor(hold / scene.dt + SHARE)
    return np.minimum(np.maximum(steps, 1.0), LONGEST_HOLD).astype(np.int64)
