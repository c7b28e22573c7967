"""Contacts that are too deep to be true."""

from __future__ import annotations

import pytest

from physim.analysis import metrics
from physim.contacts import Phase
from physim.record import Record
from physim.tolerances import DEEP
from tests.metrics.histories import history

COMMANDS = ((10.0, 0.0), (4.0, -2.0))
"""v [m/s] and omega [rad/s] of two robots"""


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


@pytest.mark.parametrize("b", [1, 2], ids=["robot", "wall"])
def test_no_contact_may_be_deeper_than_the_tolerance_however_fast_the_bodies_are(b: int) -> None:
    assert metrics.deep_contacts(touching(0.99 * DEEP, 0, b)) == ()
    (deep,) = metrics.deep_contacts(touching(1.01 * DEEP, 0, b))
    assert (deep.a, deep.b, deep.time, deep.depth_time) == (0, b, pytest.approx(0.41), deep.time)
    assert deep.depth == pytest.approx(1.01 * DEEP)
    assert deep.allowed == DEEP


def test_a_deep_contact_is_told_from_its_first_deep_sample() -> None:
    contacts = [
        (40, 0, 1, Phase.BEGAN, 0.5 * DEEP),
        (41, 0, 1, Phase.STAYS, 1.5 * DEEP),
        (42, 0, 1, Phase.STAYS, 2.5 * DEEP),
    ]
    (deep,) = metrics.deep_contacts(history([{"robot": 0}, {"robot": 1}], contacts))
    assert (deep.time, deep.depth_time) == (pytest.approx(0.41), pytest.approx(0.42))
