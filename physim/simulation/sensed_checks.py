"""What a sensing stage returns: taken as arrays of our own, and refused where it does not fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.compiled import compiled
from physim.errors import ControllerError
from physim.geometry.shapes import IntArray, read_only
from physim.parts.controller import Sensed
from physim.world.scene import Scene

KINDS: dict[str, tuple[str, Any]] = {
    "robot": ("iu", np.int64), "pose": ("fiu", np.float64), "command": ("fiu", np.float64),
    "reference_station": ("fiu", np.float64), "age": ("fiu", np.float64), "first": ("iu", np.int64),
    "end": ("iu", np.int64), "station": ("fiu", np.float64),
}  # fmt: skip
"""Kinds of numbers that each array of a `Sensed` may have, and the one that it gets."""


def sound_sensed(found: Sensed, given: Sensed, scene: Scene, part: object) -> Sensed:
    """What a stage made of the rows it was ``given``, copied, in the types of compiled code.

    That reads bytes as they lie, and counts on each robot once among the rows of an observer.
    Raises ControllerError for rows that are not finite or do not fit, and of another step; every
    observer must have one of itself.
    """
    if found is given:
        return found
    where = f"sensing stage {type(part).__name__} at {given.step * scene.dt:g} s"
    if not isinstance(found.step, int | np.integer) or found.step != given.step:
        raise ControllerError(
            f"{where}: step is {found.step!r}, the present one is {given.step}; rows of the past "
            "have their age, and the step of now: sensed._replace(step=...)"
        )
    for name, (kinds, _) in KINDS.items():
        _check_kind(name, getattr(found, name), kinds, where)
    _check_shapes(found, scene, where)
    copies = (_copied(getattr(found, name), getattr(given, name), KINDS[name][1]) for name in KINDS)
    sensed = Sensed(given.step, *copies)
    _check_numbers(sensed, scene, where)
    row = observer_in_doubt(sensed.robot, sensed.first, sensed.end, scene.robots)
    if row >= 0:
        _refuse_rows(sensed, scene, row, where)
    return sensed


def _check_kind(name: str, values: Any, kinds: str, where: str) -> None:
    is_array = isinstance(values, np.ndarray) and not isinstance(values, np.ma.MaskedArray)
    if not is_array or values.dtype.kind not in kinds:
        kind = values.dtype if is_array else type(values).__name__
        needed = "whole numbers" if kinds == "iu" else "numbers"
        raise ControllerError(f"{where}: {name} is of type {kind}; an array of {needed} is needed")


def _copied(values: Any, given: Any, own: Any) -> Any:
    """One array as ours; the very one that was given stays."""
    return values if values is given else read_only(np.array(values, dtype=own, order="C"))


def _check_shapes(sensed: Sensed, scene: Scene, where: str) -> None:
    rows, robots = sensed.robot.shape[:1], scene.robots
    shapes = {
        "robot": rows, "pose": (*rows, 3), "command": (*rows, 2), "reference_station": rows,
        "age": rows, "first": (robots,), "end": (robots,), "station": (robots,),
    }  # fmt: skip
    for name, shape in shapes.items():
        found = getattr(sensed, name).shape
        if not rows or found != shape:
            raise ControllerError(
                f"{where}: {name} has the shape {found}, not {shape or '(rows,)'}"
            )
    if rows[0] > robots**2:
        raise ControllerError(
            f"{where}: {rows[0]} rows; {robots} robots have use for {robots**2} at most"
        )


def _check_numbers(sensed: Sensed, scene: Scene, where: str) -> None:
    for name in KINDS:
        if not np.isfinite(getattr(sensed, name)).all():
            raise ControllerError(f"{where}: {name} is not finite")
    robot, robots = sensed.robot, scene.robots
    if len(robot) and not 0 <= robot.min() <= robot.max() < robots:
        raise ControllerError(
            f"{where}: robot holds an index that does not exist; allowed: 0 to {robots - 1}"
        )


@compiled
def observer_in_doubt(robot: IntArray, first: IntArray, end: IntArray, robots: int) -> int:
    """The first observer whose rows are not there, or not of each robot once with itself; or -1."""
    seen = np.full(robots, -1)  # the observer that had a row of each robot last
    for i in range(robots):
        if not 0 <= first[i] <= end[i] <= len(robot):
            return i
        for row in range(first[i], end[i]):
            if seen[robot[row]] == i:
                return i
            seen[robot[row]] = i
        if seen[i] != i:
            return i
    return -1


def _refuse_rows(sensed: Sensed, scene: Scene, i: int, where: str) -> None:
    first, end, rows = int(sensed.first[i]), int(sensed.end[i]), len(sensed.robot)
    if not 0 <= first <= end <= rows:
        raise ControllerError(
            f"{where}: rows {first} to {end} of {scene.names[i]}; there are {rows}"
        )
    times = np.bincount(sensed.robot[first:end], minlength=scene.robots)
    if times[i] != 1:
        raise ControllerError(f"{where}: {scene.names[i]} must have exactly one row of its own")
    other = scene.names[int(np.argmax(times > 1))]
    raise ControllerError(
        f"{where}: {scene.names[i]} has {times.max()} rows of {other}; one is allowed"
    )
