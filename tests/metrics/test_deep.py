"""Contacts that are too deep to be true, and impacts that are only as deep as a step is long."""

from __future__ import annotations

import pytest

from physim.analysis import metrics
from physim.contacts import Phase
from physim.record import Record
from physim.tolerances import DEEP
from tests.metrics.histories import history

DT = 0.01
"""[s] step of a history"""
COMMANDS = ((10.0, 0.0), (4.0, -2.0))
"""v [m/s] and omega [rad/s] of two robots"""
RADIUS = 0.5 * (1.8**2 + 1.0) ** 0.5
"""[m] of their footprints"""


def touching(depth: float, a: int = 0, b: int = 1) -> Record:
    """Two robots with fast commands, and one contact of three samples, the second the deepest."""
    rows = [
        {"robot": i, "nominal_v": v, "nominal_omega": omega}
        for i, (v, omega) in enumerate(COMMANDS)
    ]
    contacts = [
        (40, a, b, Phase.BEGAN, 0.5 * depth),
        (41, a, b, Phase.STAYS, depth),
        (42, a, b, Phase.ENDED, -0.1),
    ]
    return history(rows, contacts)


def test_an_impact_may_be_as_deep_as_the_two_move_in_a_step() -> None:
    far = (10.0 + 4.0 + 2.0 * RADIUS) * DT
    assert far > 5.0 * DEEP
    assert metrics.deep_contacts(touching(0.99 * far)) == ()
    (deep,) = metrics.deep_contacts(touching(1.01 * far))
    assert (deep.a, deep.b, deep.depth_time) == (0, 1, pytest.approx(0.41))
    assert deep.depth == pytest.approx(1.01 * far)
    assert deep.allowed == pytest.approx(far)


def test_at_a_wall_one_robot_moves_alone() -> None:
    assert metrics.deep_contacts(touching(0.099, 0, 2)) == ()
    (deep,) = metrics.deep_contacts(touching(0.101, 0, 2))
    assert deep.allowed == pytest.approx(10.0 * DT)


def test_what_stands_may_be_as_deep_as_the_tolerance() -> None:
    contacts = [(40, 0, 1, Phase.BEGAN, 1.5 * DEEP)]
    (deep,) = metrics.deep_contacts(history([{"robot": 0}, {"robot": 1}], contacts))
    assert deep.allowed == DEEP
    contacts = [(40, 0, 1, Phase.BEGAN, 0.5 * DEEP)]
    assert metrics.deep_contacts(history([{"robot": 0}, {"robot": 1}], contacts)) == ()
