"""What all runners share: where the robots of the corridor stand, and how a rate is measured.

Runners are started by the Python of the environment that their simulator is installed in, with
their task as JSON on the command line, and print their result as JSON on the last line. They
import nothing but the standard library, numpy and their simulator.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

LANES, SPACING, FIRST_X, AHEAD = 8, 1.2, 3.0, 62.0
"""Lanes, [m] between them and between robots in a lane, [m] first robot, [m] road ahead."""
WIDTH = 10.0
"""[m] of the corridor"""
SPEED, STEP, PERIOD = 0.8, 0.05, 0.1
"""[m/s] of every robot, [s] a step, [s] between two decisions"""
LENGTH_OF_ROBOT, WIDTH_OF_ROBOT = 0.5, 0.3
"""[m] of the rectangles"""
RADIUS = 0.29
"""[m] of the discs: about the circumscribed circle of the rectangles"""
SETTLING = 3
"""Steps from the start that do not count."""
PACKED = 0.55
"""[m] between robots in a lane that are to run into a dead end at once"""


def places(robots: int, spacing: float = SPACING) -> Iterator[tuple[float, float]]:
    """Where the robots stand, in lanes along the x axis."""
    for i in range(robots):
        yield FIRST_X + i // LANES * spacing, lane(i)


def lane(i: int) -> float:
    """Y of the lane of a robot [m]."""
    return (i % LANES - (LANES - 1) / 2) * SPACING


def road_length(robots: int, dead_end: bool = False, spacing: float = PACKED) -> float:
    """Length of the corridor [m]; that of a dead end leaves 1 m before the first row.

    ``spacing`` is that of the robots in a dead end.
    """
    columns = (robots - 1) // LANES + 1
    if dead_end:
        return FIRST_X + (columns - 1) * spacing + 1.25
    return FIRST_X + columns * SPACING + AHEAD


def rate(
    step: Callable[[], Any], robots: int, seconds: float, most: int, again: Callable[[], Any],
    whole: bool = False,
) -> dict[str, Any]:  # fmt: skip
    """Robot-steps per second of processor time, and those of the two spans that it is made of.

    A span lasts ``seconds`` at least; one before them warms up. After ``most`` steps the robots are
    taken back to the start by ``again``, which does not count; where what they do changes on their
    way, spans are ``whole`` ways. Two spans that disagree had something else in them.
    """
    spans = [_span(step, seconds, most, again, whole) for _ in range(3)][1:]
    steps, spent = (sum(each) for each in zip(*spans, strict=True))
    return {
        "rate": robots * steps / spent, "steps": steps,
        "spans": [robots * steps / spent for steps, spent in spans],
    }  # fmt: skip


def _span(
    step: Callable[[], Any], seconds: float, most: int, again: Callable[[], Any], whole: bool
) -> tuple[int, float]:
    """Steps of a span, and the processor time that it took [s]."""
    spent, steps = 0.0, 0
    while spent < seconds:
        again()
        for _ in range(SETTLING):
            step()
        began, count, passed = time.process_time(), 0, 0.0
        while count < most and (whole or spent + passed < seconds):
            step()
            count += 1
            passed = time.process_time() - began
        spent += passed
        steps += count
    return steps, spent


def task() -> dict[str, Any]:
    """What is asked for."""
    asked: dict[str, Any] = json.loads(sys.argv[1])
    return asked


def report(**found: Any) -> None:
    """Print the result, with the memory that it took."""
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(json.dumps({**found, "memory": memory}), flush=True)
