"""Numbers that are valid, but whose unit is likely another one: millimetres, degrees, speeds."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians
from typing import Any

import numpy as np

from physim.errors import Fault, Location
from physim.units import figure
from physim.world import Corridor, Robot, World, each_robot
from physim.world.checks.findings import MOST_ALIKE
from physim.world.faults import describe, in_metres

LONGEST_ROBOT = 30.0
"""[m] A longer robot is likely given in millimetres or centimetres."""
SHORTEST_ROBOT = 0.01
"""[m]"""
WIDEST_CORRIDOR = 500.0
"""[m]"""
WIDEST_FOR_ROBOTS = 50.0
"""[-] times the longest robot"""
LARGEST_GROUND = 50_000.0
"""[m] from end to end"""
FASTEST = 50.0
"""[m/s]"""
FASTEST_TURN = 20.0
"""[rad/s] three turns a second"""
FULL_TURN = 6.2832
"""[rad]"""
LONGEST_RUN = 86_400.0
"""[s]"""
MOST_STEPS = 5_000_000
"""of a run: beyond that it takes hours and its record gigabytes"""


def check_scale(world: World) -> Iterator[Fault]:
    """Numbers of a world as written, before it is laid out: what that says may follow from them."""
    for where, message in _doubts(world):
        yield Fault(where, message, "warning")


def _doubts(world: World) -> Iterator[tuple[Location, str]]:
    robots, entries = each_robot(world.robots, world.seed)
    sizes = [float(np.ptp(robot.outline, axis=0).max()) for robot in robots]
    if isinstance(world.corridor, Corridor):
        widest, longest = float(np.max(world.corridor.width)), max(sizes, default=0.0)
        if widest > WIDEST_CORRIDOR or widest > WIDEST_FOR_ROBOTS * longest > 0.0:
            said = f"{figure(widest, 6)} m is very wide for a corridor; {in_metres(widest)}"
            yield ("corridor", "width"), said
    yield from _large_ground(world)
    told: dict[Location, str] = {}
    for robot, e, size in zip(robots, entries, sizes, strict=True):
        if len(told) < MOST_ALIKE:
            for where, said in _of_robot(robot, size, ("robots", e)):
                told.setdefault(where, said)  # of a group the first
    yield from told.items()
    if world.start is not None:
        yield from _turned(("start", "heading"), world.start.heading)
    step, duration = world.time.step, world.time.duration
    if duration > LONGEST_RUN:
        hours = (
            f"{figure(duration, 6)} s is {duration / 3600.0:.4g} hours; durations are in seconds"
        )
        yield ("time", "duration"), hours + _thousandth(duration, "milliseconds")
    if duration / step > MOST_STEPS:
        yield (
            ("time", "step"),
            f"{step:.4g} s makes {duration / step:,.0f} steps in {figure(duration, 6)} s: such a "
            "run takes hours; steps are in seconds, and 0.01 is usual",
        )


def _large_ground(world: World) -> Iterator[tuple[Location, str]]:
    """The first line that is longer than any place."""
    lines: list[tuple[Location, Any]] = [
        (("boundaries", k), line) for k, line in enumerate(world.boundaries or ())
    ]
    if isinstance(world.corridor, Corridor):
        lines.insert(0, (("corridor", "centreline"), world.corridor.centreline))
    if world.reference_path is not None:
        lines.insert(0, (("reference_path",), world.reference_path))
    for where, line in lines:
        extent = float(np.ptp(np.array(line), axis=0).max())
        if extent > LARGEST_GROUND:
            yield where, f"it spans {figure(extent, 6)} m; {in_metres(extent)}"
            return


def _of_robot(robot: Robot, size: float, where: Location) -> Iterator[tuple[Location, str]]:
    name, limits = describe(robot.name), robot.limits
    if size > LONGEST_ROBOT:
        yield (*where, "footprint"), f"{name} is {figure(size, 6)} m long; {in_metres(size)}"
    elif size < SHORTEST_ROBOT:
        said = f"{name} is only {size:.4g} m long; lengths are in metres"
        yield (*where, "footprint"), said
    if robot.pose is not None:
        yield from _turned((*where, "pose", 2), robot.pose[2])
    if robot.start is not None:
        yield from _turned((*where, "start", "heading"), robot.start.heading)
    if limits.v > FASTEST:
        said = f"{figure(limits.v, 6)} m/s is very fast; speeds are in metres per second"
        yield (*where, "limits", "v"), said + _thousandth(limits.v, "millimetres per second")
    if limits.omega > FASTEST_TURN:
        yield (
            (*where, "limits", "omega"),
            f"{figure(limits.omega, 6)} rad/s is very fast; it is in radians per second; if "
            f"degrees per second are meant, write {radians(limits.omega):.6g}",
        )


def _turned(where: Location, heading: Any) -> Iterator[tuple[Location, str]]:
    if isinstance(heading, int | float) and abs(heading) > FULL_TURN:
        yield (
            where,
            f"{heading:.6g} rad is more than a full turn; headings are in radians; if degrees are "
            f"meant, write {radians(heading):.6g}",
        )


def _thousandth(value: float, unit: str) -> str:
    return f"; if {unit} are meant, write {value / 1000.0:.6g}"
