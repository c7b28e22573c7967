"""A contact is foretold however long before it the last decision was."""

from __future__ import annotations

from math import inf

import pytest

import physim
from physim import Decision
from physim.analysis.validation import report, validate
from tests.validation.runs import LANE


class Once:
    """Decides at the start and never again."""

    def __init__(self, *commands: tuple[float, float]) -> None:
        self.commands = commands

    def decide(self, observation, memory):
        v, omega = self.commands[observation.index]
        return Decision(v=v, omega=omega, hold=inf)


def run(commands, **changes):
    world = physim.parse_world(LANE, overrides=[f"{key}={value}" for key, value in changes.items()])
    return validate(physim.simulate(world, controller=Once(*commands)))


@pytest.mark.parametrize(
    ("commands", "seconds"),
    [
        (((0.0, 0.0), (0.1, 0.0)), 16.0),  # straight on, 15 s
        (((0.03, 0.01), (0.1, 0.0)), 22.0),  # the one in front on a circle, 21 s
    ],
)
def test_a_contact_long_after_the_last_decision_is_foretold(commands, seconds):
    found = run(commands, **{"time.duration": seconds, "robots.1.pose": "[4.6, 0.0, 0.0]"})
    assert found.verdict.startswith("contacts: ")
    first = found.contacts[0].prediction
    assert (first.made, first.verdict) == (0.0, "same step")
    assert first.touched > 10.0
    assert abs(first.predicted - first.touched) <= first.slack
    assert f"at every decision of the last {first.touched:.3f} s" in report(found)
