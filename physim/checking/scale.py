"""Numbers that are valid but out of scale: millimetres, degrees, speeds nobody drives."""

from __future__ import annotations

from math import pi, radians
from typing import Any

import numpy as np

from physim.checking.findings import MOST_ALIKE, Diagnostics
from physim.checking.starts import is_drawn
from physim.errors import Location
from physim.layout import PartialLayout, corridor_line
from physim.world.faults import describe

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


def check_scale(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn of numbers whose unit is likely another one."""
    world = laid.world
    _check_lengths(laid, found)
    count = 0
    for i in range(len(world.robots)):
        before = len(found.warnings)
        _check_robot(laid, i, found)
        count += len(found.warnings) > before
        if count >= MOST_ALIKE:
            break
    for i, robot in enumerate(world.robots):
        _check_choices(("robots", i), robot.speeds, robot.omegas, found)
    is_sound = not any(fault.location[:1] == ("controller",) for fault in found.errors)
    if world.controller is not None and is_sound:  # its own check knows more
        settings = world.controller.settings
        _check_choices(("controller",), settings.get("speeds"), settings.get("omegas"), found)
    step, duration = world.time.step, world.time.duration
    if duration is not None and duration > LONGEST_RUN:
        found.warn(
            ("time", "duration"),
            f"{duration:.6g} s is {duration / 3600.0:.4g} hours; durations are in seconds"
            + _thousandth(duration, "milliseconds"),
        )
    steps = duration / step if duration and step else 0.0
    if steps > MOST_STEPS:
        found.warn(
            ("time", "step"),
            f"{step:.4g} s makes {steps:,.0f} steps in {duration:.6g} s: such a run takes hours; "
            "steps are in seconds, and 0.01 is usual",
        )


def _check_lengths(laid: PartialLayout, found: Diagnostics) -> None:
    width = corridor_line(laid.world)[1]
    if width is not None and width.max() > WIDEST_CORRIDOR:
        widest = float(width.max())
        found.warn(
            ("corridor", "width"),
            f"{widest:.6g} m is very wide for a corridor; lengths are in metres"
            + _thousandth(widest, "millimetres"),
        )
    lines = [(laid.reference_key, laid.reference)]
    if laid.world.boundaries is not None:
        numbers = [int(name.split()[1]) - 1 for name in laid.boundaries]
        lines += zip([("boundaries", k) for k in numbers], laid.boundaries.values(), strict=True)
    for where, line in lines:
        if line is not None and float(np.ptp(line, axis=0).max()) > LARGEST_GROUND:
            extent = float(np.ptp(line, axis=0).max())
            found.warn(
                where,
                f"it spans {extent:.6g} m; lengths are in metres"
                + _thousandth(extent, "millimetres"),
            )
            break


def _check_robot(laid: PartialLayout, i: int, found: Diagnostics) -> None:
    where: Location = ("robots", i)
    robot, name = laid.world.robots[i], describe(laid.names[i])
    if i in laid.footprints:
        outline = laid.footprints[i]
        size = float(np.ptp(outline, axis=0).max())
        if size > LONGEST_ROBOT:
            found.warn(
                (*where, "footprint"),
                f"{name} is {size:.6g} m long; lengths are in metres"
                + _thousandth(size, "millimetres"),
            )
        elif size < SHORTEST_ROBOT:
            found.warn(
                (*where, "footprint"),
                f"{name} is only {size:.4g} m long; lengths are in metres",
            )
    heading = 0.0 if is_drawn(laid, i) else robot.pose[2]
    if abs(heading) > 2.0 * pi:
        found.warn(
            (*where, "pose", 2),
            f"{heading:.6g} rad is more than a full turn; headings are in radians; if "
            f"degrees are meant, write {radians(heading):.6g}",
        )
    v, omega = robot.limits.v, robot.limits.omega
    if v is not None and v > FASTEST:
        found.warn(
            (*where, "limits", "v"),
            f"{v:.6g} m/s is very fast; speeds are in metres per second"
            + _thousandth(v, "millimetres per second"),
        )
    if omega is not None and omega > FASTEST_TURN:
        found.warn(
            (*where, "limits", "omega"),
            f"{omega:.6g} rad/s is very fast; it is in radians per second; if degrees per "
            f"second are meant, write {radians(omega):.6g}",
        )


def _thousandth(value: float, unit: str) -> str:
    return f"; if {unit} are meant, write {value / 1000.0:.6g}"


def _check_choices(where: Location, speeds: Any, omegas: Any, found: Diagnostics) -> None:
    """Speeds to choose from that leave no way forward or no way straight on."""
    if _are_numbers(speeds) and max(speeds) <= 0.0:
        found.warn((*where, "speeds"), "no speed above 0: there is no way forward; add 1.0")
    if _are_numbers(omegas):
        if 0.0 not in omegas:
            message = "0 is not among them: there is no way straight on; add 0"
            found.warn((*where, "omegas"), message)
        elif min(omegas) >= 0.0 or max(omegas) <= 0.0:
            side = "left" if max(omegas) > 0.0 else "right"
            only = f"only turns to the {side}" if any(omegas) else "no turn at all"
            found.warn((*where, "omegas"), f"{only}; give turns to both sides")


def _are_numbers(given: Any) -> bool:
    is_list = isinstance(given, tuple) and len(given) > 0
    return is_list and all(type(number) in (int, float) for number in given)
