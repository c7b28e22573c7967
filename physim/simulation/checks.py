"""What is given to a step, taken as arrays of our own and checked, once.

Compiled code reads bytes as they lie and trusts what it is given, so all that parts and users give
comes through here. Kernels find the first number that may not be; it is worded here alone. Errors
say what is wrong; who raises them adds the part and the time (`physim.parts.user_code.naming`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.errors import ControllerError, plural
from physim.geometry.motion import twists
from physim.geometry.shapes import Flags, FloatArray, IntArray, read_only
from physim.parts.controller import LONGEST_HOLD, Decisions, Sensed
from physim.parts.declarations import NO_NUMBER, Declared
from physim.parts.user_code import kind_of
from physim.tolerances import SHARE
from physim.world.scene import Scene

COMMAND = (("v", "m/s"), ("omega", "rad/s"), ("lateral", "m/s"))
"""Quantity and unit of each part of a command."""


def array_of(name: str, values: Any, own: type, shape: Sequence[int | None]) -> NDArray[Any]:
    """An array that was given, as one of ours of the type ``own``: a read-only copy.

    ``shape`` has None where any size will do. Raises ControllerError for what is no array of
    numbers, whole ones where ``own`` is, or not of that shape.
    """
    kinds, words = ("iu", "whole numbers") if own is np.int64 else ("fiu", "numbers")
    is_array = isinstance(values, np.ndarray) and not isinstance(
        values, np.ma.MaskedArray | np.matrix
    )
    if not is_array or values.dtype.kind not in kinds:
        raise ControllerError(f"{name} is {kind_of(values)}; an array of {words} is needed")
    fits = values.ndim == len(shape) and all(
        size in (None, found) for size, found in zip(shape, values.shape, strict=True)
    )
    if not fits:
        wanted = ", ".join("any" if size is None else str(size) for size in shape)
        raise ControllerError(f"{name} has the shape {values.shape}; it must be ({wanted})")
    return read_only(np.array(values, dtype=own, order="C"))


# Commands


def taken_commands(
    scene: Scene, found: Any, given: FloatArray | None, limits: FloatArray
) -> FloatArray:
    """Commands (N, columns) of all robots as an array of our own; the very one given stays.

    Raises ControllerError where they are no numbers, or not finite and within ``limits`` (N,
    columns), and, where these are the scene's, within the curvatures that robots can drive.
    """
    commands = given
    if found is not given or commands is None:
        try:
            array = np.asarray(found)
            if np.ma.isMaskedArray(found) or array.dtype.kind not in "fiuO":
                raise TypeError
            commands = np.array(array, dtype=np.float64, order="C")
        except (TypeError, ValueError):
            raise ControllerError(
                f"commands are {kind_of(found)}; an array of numbers of the shape "
                f"{limits.shape} is needed"
            ) from None
        if commands.shape != limits.shape:
            raise ControllerError(
                f"commands have the shape {commands.shape}; it must be {limits.shape}"
            )
        read_only(commands)
    columns = limits.shape[1]
    curvature = scene.curvature if limits is scene.limits else np.full(len(limits), np.inf)
    place = command_fault(limits.reshape(-1), curvature, commands.reshape(-1), len(limits), columns)
    if place >= 0:
        i, column = divmod(place, columns + 1)
        raise ControllerError(f"{scene.names[i]}: {_beyond(commands[i], column, scene, i, limits)}")
    return commands


@compiled
def within(command: FloatArray, limits: FloatArray, curvature: float, columns: int) -> int:
    """Column of the first number of a command that is not finite and within, else -1.

    ``columns`` itself where omega is more than the curvature allows at that speed.
    """
    for column in range(columns):
        if not abs(command[column]) <= limits[column] * (1.0 + SHARE):
            return column
    if curvature < np.inf and abs(command[1]) > abs(command[0]) * curvature * (1.0 + SHARE):
        return columns
    return -1


@compiled
def command_fault(
    limits: FloatArray, curvature: FloatArray, command: FloatArray, robots: int, columns: int
) -> int:
    """What `within` finds of the first robot at fault, and (columns + 1) times its number; or -1.

    Limits and commands one row after the other.
    """
    for i in range(robots):
        first = columns * i
        column = within(command[first:], limits[first:], curvature[i], columns)
        if column >= 0:
            return (columns + 1) * i + column
    return -1


def _beyond(command: FloatArray, column: int, scene: Scene, i: int, limits: FloatArray) -> str:
    """Why a command of Robot i is refused, for what `within` found."""
    if column == len(command):
        bend = scene.curvature[i]
        return (
            f"command omega = {command[1]:g} rad/s at v = {command[0]:g} m/s; its drive turns by "
            f"{bend:.6g} rad for each metre at most, so {abs(command[0]) * bend:.6g} rad/s at that "
            "speed; observation.vehicle.clipped(v, omega, time) gives the nearest command"
        )
    value, most = float(command[column]), float(limits[i, column])
    quantity, unit = COMMAND[column]
    # as many digits as tell it from what is allowed: single precision rounds up
    texts = (f"{value:.{digits}g}" for digits in range(6, 18))
    told = next(text for text in texts if abs(float(text)) != most or abs(value) == most)
    is_rounded = float(np.float32(most)) == abs(value)
    hint = "; numbers of 32 bits are rounded: clip those of 64 bits" if is_rounded else ""
    return (
        f"command {quantity} = {told} {unit}; it must be finite and within {most:g} {unit} in "
        f"either direction{hint}"
    )


# Decisions

COMMANDED, HELD, MODE, RULE, PARTED, CONSIDERED = range(1, 7)
"""What of a decision may not be"""


def taken_decisions(found: Any, due: IntArray, columns: int) -> Decisions:
    """What a batch form returned for the robots ``due``, copied: it may write its own again.

    Raises ControllerError for what is not a row for each of them.
    """
    if not isinstance(found, Decisions):
        raise ControllerError(f"decide_all returned {kind_of(found)}; it must return Decisions")
    many = len(due)
    taken = Decisions(
        array_of("robot", found.robot, np.int64, (None,)),
        array_of("command", found.command, np.float64, (many, None)),
        array_of("hold", found.hold, np.float64, (many,)),
        array_of("mode", found.mode, np.int64, (many,)),
        array_of("rule", found.rule, np.int64, (many,)),
        array_of("report", found.report, np.float64, (many, columns)),
        array_of("considered", found.considered, np.int64, (None,)),
        array_of("considered_start", found.considered_start, np.int64, (many + 1,)),
    )
    if not np.array_equal(taken.robot, due):
        raise ControllerError(
            f"decided for robots {taken.robot.tolist()} when asked for {due.tolist()}"
        )
    return taken


def widened(decisions: Decisions, scene: Scene) -> Decisions:
    """Decisions whose commands have the scene's columns: the lateral speed is 0 where left out."""
    if decisions.command.shape[1] == 2 < scene.columns:
        return decisions._replace(command=twists(decisions.command))
    return decisions


def next_steps(scene: Scene, step: int, d: Decisions, declared: Declared) -> IntArray:
    """Steps (M,) of the next decisions: holds are rounded down, to one step at least (14).

    Raises ControllerError for commands beyond limits and for numbers that no record may hold.
    """
    steps = np.empty(len(d.robot), np.int64)
    modes, rules = len(declared.modes), len(declared.rules)
    columns = scene.columns
    if d.command.shape[1] != columns:
        raise ControllerError(
            f"command has the shape {d.command.shape}; it must be ({len(d.robot)}, {columns})"
        )
    allowed = Allowed(
        scene.limits.reshape(-1), scene.curvature, columns, scene.moving, modes, rules, scene.dt
    )
    command = np.ascontiguousarray(d.command).reshape(-1)
    what, k, column = decision_fault(
        d._replace(command=command), len(d.robot), len(d.considered), allowed, step, steps
    )
    if not what:
        return steps
    robot = d.robot[k]
    if what == COMMANDED:
        text = _beyond(d.command[k], column, scene, robot, scene.limits)
    elif what == HELD:
        text = f"hold = {d.hold[k]:g} s; it must be a time of at least 0 s"
    elif what in (MODE, RULE):
        name, given, most = ("mode", d.mode, modes) if what == MODE else ("rule", d.rule, rules)
        text = f"{name} = {given[k]}; allowed: {NO_NUMBER} to {most - 1}"
    elif what == PARTED:
        text = (
            f"considered_start is {d.considered_start}; it must part "
            f"{plural(len(d.considered), 'considered robot')} in their order"
        )
    else:
        listed = d.considered[d.considered_start[k] : d.considered_start[k + 1]].tolist()
        text = (
            f"considered is {listed}; it must list robots 0 to {scene.moving - 1}, each once, and "
            f"others than the robot itself, which is {robot}"
        )
    raise ControllerError(f"{scene.names[robot]} at {step * scene.dt:g} s: {text}")


class Allowed(NamedTuple):
    """What decisions of a scene may be."""

    limits: FloatArray
    """(N columns,)"""
    curvature: FloatArray
    columns: int
    moving: int
    modes: int
    rules: int
    dt: float


@compiled
def decision_fault(
    d: Decisions, many: int, listed: int, allowed: Allowed, step: int, next_step: IntArray
) -> tuple[int, int, int]:
    """What is wrong first, 0 where nothing is, in which row, and column of the command.

    Of so ``many`` decisions, which list so many robots considered. Writes ``next_step`` (M,).
    """
    start, limits, columns = d.considered_start, allowed.limits, allowed.columns
    if start[0] != 0 or start[many] != listed:
        return PARTED, 0, 0
    seen = np.full(allowed.moving, -1, np.int64)  # the row that considered each robot last
    for k in range(many):
        i = d.robot[k]
        column = within(
            d.command[columns * k :], limits[columns * i :], allowed.curvature[i], columns
        )
        if column >= 0:
            return COMMANDED, k, column
        if not d.hold[k] >= 0.0:
            return HELD, k, 0
        if not NO_NUMBER <= d.mode[k] < allowed.modes:
            return MODE, k, 0
        if not NO_NUMBER <= d.rule[k] < allowed.rules:
            return RULE, k, 0
        held = min(max(np.floor(d.hold[k] / allowed.dt + SHARE), 1.0), LONGEST_HOLD)
        next_step[k] = step + int(held)
        if not 0 <= start[k] <= start[k + 1] <= listed:
            return PARTED, k, 0
        for m in range(start[k], start[k + 1]):
            j = d.considered[m]
            if not 0 <= j < allowed.moving or j == d.robot[k] or seen[j] == k:
                return CONSIDERED, k, 0
            seen[j] = k
    return 0, 0, 0


# What is sensed

ROWS: dict[str, tuple[type, tuple[int, ...]]] = {
    "robot": (np.int64, ()), "pose": (np.float64, (3,)), "command": (np.float64, (2,)),
    "velocity": (np.float64, (3,)), "reference_station": (np.float64, ()), "age": (np.float64, ()),
    "heard": (np.float64, ()),
}  # fmt: skip
"""Type of each array of a `Sensed` with a row for each body that is sensed, and shape of a row"""
OBSERVERS: dict[str, type] = {"first": np.int64, "end": np.int64, "station": np.float64}
"""Type of each with a number for each observer"""


def taken_sensed(found: object, given: Sensed, scene: Scene) -> Sensed:
    """What a stage made of the rows it was given, copied; what stayed the same array stays.

    Poses and velocities may be NaN, of what is not seen; ``heard`` follows ``age`` where the stage
    does not speak of it. Raises ControllerError for other rows that are not finite, or do not fit,
    and of another step; every observer must have one of itself, and none of a robot twice.
    """
    if found is given:
        return given
    if not isinstance(found, Sensed):
        raise ControllerError(f"sense returned {kind_of(found)} first; that must be a Sensed")
    if not isinstance(found.step, int | np.integer) or found.step != given.step:
        raise ControllerError(
            f"step is {found.step!r}, the present one is {given.step}; rows of the past have their "
            "age, and the step of now: sensed._replace(step=...)"
        )
    rows = len(found.robot) if np.ndim(found.robot) else None
    if np.shape(found.heard) != np.shape(found.age) or (
        found.heard is given.heard and found.age is not given.age
    ):
        found = found._replace(heard=found.age)
    shapes = {name: (own, (rows, *row)) for name, (own, row) in ROWS.items()}
    shapes["command"] = (np.float64, (rows, scene.columns))
    shapes |= {name: (own, (scene.robots,)) for name, own in OBSERVERS.items()}
    arrays: dict[str, Any] = {}
    for name, (own, shape) in shapes.items():
        values = getattr(found, name)
        if values is not getattr(given, name):
            values = array_of(name, values, own, shape)
            is_fine = np.isfinite(values)
            if name in ("pose", "velocity"):
                unseen = np.isnan(arrays.get("pose", values)).all(axis=1, keepdims=True)
                is_fine |= unseen & np.isnan(values)
            elif name == "heard":
                is_fine |= values == np.inf
            if not is_fine.all():
                raise ControllerError(f"{name} is not finite")
        elif values.shape != shape:  # of other rows than the others are
            raise ControllerError(f"{name} has the shape {values.shape}; it must be {shape}")
        arrays[name] = values
    sensed = Sensed(given.step, **arrays, drive=given.drive)
    robot, robots, moving = sensed.robot, scene.robots, scene.moving
    names = [body.name for body in scene.bodies[:moving]]
    if len(robot) > robots * moving:
        raise ControllerError(
            f"{len(robot)} rows; {robots} robots have use for {robots * moving} at most"
        )
    if len(robot) and not 0 <= robot.min() <= robot.max() < moving:
        raise ControllerError(
            f"robot holds an index that does not exist; allowed: 0 to {moving - 1}"
        )
    looked = given.end > given.first
    i, j = rows_fault(robot, len(robot), sensed.first, sensed.end, looked, robots, moving)
    if i < 0:
        unseen = np.isnan(sensed.pose[:, 0])
        for i in range(robots if unseen.any() else 0):
            rows_i = sensed.rows(i)
            if unseen[rows_i][robot[rows_i] == i].any():
                raise ControllerError(f"the pose of {names[i]} in its own row is not finite")
        return sensed
    if j < 0:
        raise ControllerError(
            f"rows {sensed.first[i]} to {sensed.end[i]} of {names[i]}; there are {len(robot)}"
        )
    raise ControllerError(
        f"{names[i]} must have exactly one row of its own"
        if j == i
        else f"{names[i]} has several rows of {names[j]}; one is allowed"
    )


@compiled
def rows_fault(
    robot: IntArray,
    rows: int,
    first: IntArray,
    end: IntArray,
    looked: Flags,
    robots: int,
    moving: int,
) -> tuple[int, int]:
    """First observer whose rows are wrong: (i, -1) they are not there, (i, i) it has not one of
    itself, though it ``looked``, (i, j) it has several of another; (-1, -1) where none is."""
    seen = np.full(moving, -1, np.int64)
    for i in range(robots):
        if not 0 <= first[i] <= end[i] <= rows:
            return i, -1
        for m in range(first[i], end[i]):
            if seen[robot[m]] == i:
                return i, robot[m]
            seen[robot[m]] = i
        if looked[i] and seen[i] != i:
            return i, i
    return -1, -1
