"""Numbers that are valid but out of scale: millimetres, degrees, speeds nobody drives."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi, radians
from typing import Any

import numpy as np

from physim.checking.sketch import RobotSketch, Sketch, number
from physim.checking.telling import MOST_ALIKE, Told
from physim.errors import Location
from physim.geometry.shapes import FloatArray
from physim.world.faults import shown

LONGEST_ROBOT = 30.0
"""[m] A longer robot is likely given in millimetres or centimetres."""
SHORTEST_ROBOT = 0.01
"""[m]"""
WIDEST_CORRIDOR = 500.0
"""[m]"""
LARGEST_GROUND = 50_000.0
"""[m] from end to end"""
FASTEST = 50.0
"""[m/s]"""
FASTEST_TURN = 20.0
"""[rad/s] three turns a second"""
LONGEST_RUN = 86_400.0
"""[s]"""
MOST_STEPS = 5_000_000
"""of a run: beyond that it takes hours and its record gigabytes"""


def check_scale(
    sketch: Sketch, values: Mapping[str, Any], outlines: dict[int, FloatArray], told: Told
) -> None:
    """Warn of numbers whose unit is likely another one."""
    _check_lengths(sketch, told)
    count = 0
    for robot in sketch.robots:
        before = len(told.warnings)
        _check_robot(robot, outlines.get(robot.number), told)
        count += len(told.warnings) > before
        if count >= MOST_ALIKE:
            break
    for k, given in enumerate(_list(values.get("robots"))[: len(sketch.robots)]):
        if isinstance(given, Mapping):
            _check_choices(("robots", k), given, told)
    controller = values.get("controller")
    is_sound = not any(fault.location[:1] == ("controller",) for fault in told.errors)
    if isinstance(controller, Mapping) and is_sound:  # its own check knows more
        _check_choices(("controller",), controller, told)
    if sketch.duration is not None and sketch.duration > LONGEST_RUN:
        told.warn(
            ("time", "duration"),
            f"{sketch.duration:.6g} s is {sketch.duration / 3600.0:.4g} hours; durations are in "
            "seconds" + _thousandth(sketch.duration, "milliseconds"),
        )
    steps = sketch.duration / sketch.step if sketch.duration and sketch.step else 0.0
    if steps > MOST_STEPS:
        told.warn(
            ("time", "step"),
            f"{sketch.step:.4g} s makes {steps:,.0f} steps in {sketch.duration:.6g} s: such a run "
            "takes hours; steps are in seconds, and 0.01 is usual",
        )


def _check_lengths(sketch: Sketch, told: Told) -> None:
    if sketch.width is not None and sketch.width.max() > WIDEST_CORRIDOR:
        widest = float(sketch.width.max())
        told.warn(
            ("corridor", "width"),
            f"{widest:.6g} m is very wide for a corridor; lengths are in metres"
            + _thousandth(widest, "millimetres"),
        )
    for where, line in ((sketch.reference_key, sketch.reference), *_drawn(sketch)):
        if line is not None and float(np.ptp(line, axis=0).max()) > LARGEST_GROUND:
            extent = float(np.ptp(line, axis=0).max())
            told.warn(
                where,
                f"it spans {extent:.6g} m; lengths are in metres"
                + _thousandth(extent, "millimetres"),
            )
            break


def _drawn(sketch: Sketch) -> list[tuple[Location, FloatArray | None]]:
    return [(("boundaries", k), line) for k, line in enumerate(sketch.boundaries or ())]


def _check_robot(robot: RobotSketch, outline: FloatArray | None, told: Told) -> None:
    where: Location = ("robots", robot.number)
    name = shown(robot.name)
    if outline is not None:
        size = float(np.ptp(outline, axis=0).max())
        if size > LONGEST_ROBOT:
            told.warn(
                (*where, "footprint"),
                f"{name} is {size:.6g} m long; lengths are in metres"
                + _thousandth(size, "millimetres"),
            )
        elif size < SHORTEST_ROBOT:
            told.warn(
                (*where, "footprint"),
                f"{name} is only {size:.4g} m long; lengths are in metres",
            )
    if robot.heading is not None and abs(robot.heading) > 2.0 * pi:
        told.warn(
            (*where, "pose", 2),
            f"{robot.heading:.6g} rad is more than a full turn; headings are in radians; if "
            f"degrees are meant, write {radians(robot.heading):.6g}",
        )
    if robot.v is not None and robot.v > FASTEST:
        told.warn(
            (*where, "limits", "v"),
            f"{robot.v:.6g} m/s is very fast; speeds are in metres per second"
            + _thousandth(robot.v, "millimetres per second"),
        )
    if robot.omega is not None and robot.omega > FASTEST_TURN:
        told.warn(
            (*where, "limits", "omega"),
            f"{robot.omega:.6g} rad/s is very fast; it is in radians per second; if degrees per "
            f"second are meant, write {radians(robot.omega):.6g}",
        )


def _thousandth(value: float, unit: str) -> str:
    return f"; if {unit} are meant, write {value / 1000.0:.6g}"


def _check_choices(where: Location, given: Mapping[str, Any], told: Told) -> None:
    """Speeds to choose from that leave no way forward or no way straight on."""
    speeds = [number(value, -1e9, 1e9) for value in _list(given.get("speeds"))]
    omegas = [number(value, -1e9, 1e9) for value in _list(given.get("omegas"))]
    ahead = [speed for speed in speeds if speed is None or speed > 0.0]
    if speeds and not ahead:
        told.warn((*where, "speeds"), "no speed above 0: there is no way forward; add 1.0")
    if omegas and None not in omegas:
        turns = [omega for omega in omegas if omega is not None]
        if 0.0 not in turns:
            told.warn((*where, "omegas"), "0 is not among them: there is no way straight on; add 0")
        elif min(turns) >= 0.0 or max(turns) <= 0.0:
            side = "left" if max(turns) > 0.0 else "right"
            only = f"only turns to the {side}" if any(turns) else "no turn at all"
            told.warn((*where, "omegas"), f"{only}; give turns to both sides")


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
