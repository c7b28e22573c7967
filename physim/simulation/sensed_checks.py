"""What a sensing stage returns: taken as arrays of our own, and refused where it does not fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.errors import ControllerError
from physim.geometry.shapes import read_only
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

    That reads bytes as they lie, and counts on each robot once among the rows of an observer: it
    would write past its arrays.
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
    _check_rows(sensed, scene, where)
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


def _check_rows(sensed: Sensed, scene: Scene, where: str) -> None:
    """Refuse rows of an observer that are not there, or not of each robot once with itself."""
    first, end, rows, robots = sensed.first, sensed.end, len(sensed.robot), scene.robots
    is_there = (first >= 0) & (first <= end) & (end <= rows)
    if not is_there.all():
        i = int(np.argmin(is_there))
        raise ControllerError(
            f"{where}: rows {first[i]} to {end[i]} of {scene.names[i]}; there are {rows}"
        )
    counts = end - first
    observer = np.repeat(np.arange(robots), counts)
    row = np.arange(len(observer)) + np.repeat(first - np.cumsum(counts) + counts, counts)
    times = np.bincount(observer * robots + sensed.robot[row], minlength=robots**2)
    times = times.reshape(robots, robots)
    if (own := times.diagonal() != 1).any():
        name = scene.names[int(np.argmax(own))]
        raise ControllerError(f"{where}: {name} must have exactly one row of its own")
    if (twice := times > 1).any():
        i, j = np.argwhere(twice)[0]
        raise ControllerError(
            f"{where}: {scene.names[i]} has {times[i, j]} rows of {scene.names[j]}; one is allowed"
        )
