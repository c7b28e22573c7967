"""Decisions at a fixed period, for comparison with event-triggered ones (14)."""

from __future__ import annotations

import numpy as np
import pytest

from physim import parse_world, simulate
from physim.geometry.shapes import IntArray

FACING_A_WALL = """
name: facing a wall
time: {step: 0.01, duration: 3.0}
corridor: {centreline: [[0.0, 0.0], [30.0, 0.0]], width: 6.0}
robots:
  - {name: r1, footprint: {length: 1.0, width: 1.0}, pose: [5.0, 1.9, 1.5], path: {offset: 0.0}}
formation: {}
controller:
  {beta: 0.05, distance_low: 0, distance_high: 0, time_low: 0, time_high: 0, boundary_low: 0}
"""


def intervals(*overrides: str) -> IntArray:
    """Steps from every decision to the next."""
    world = parse_world(FACING_A_WALL, overrides=overrides)
    with simulate(world) as record:
        return np.asarray(record.updates["next_step"] - record.updates["step"])


def test_near_a_wall_decisions_come_earlier() -> None:
    assert intervals().min() < 10


@pytest.mark.parametrize(("period", "steps"), [(0.1, 10), (0.03, 3), (0.01, 1)])
def test_without_events_every_decision_holds_for_the_period(period: float, steps: int) -> None:
    found = intervals(
        "controller.event_triggered=false",
        f"controller.update_period={period}",
        f"controller.dwell_times=[{period}]",
    )
    assert set(found.tolist()) == {steps}
