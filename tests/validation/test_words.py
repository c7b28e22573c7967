"""What a report says of a robot: by its command, and by all that its controller reported."""

from __future__ import annotations

import physim
from physim import Decision, Mode
from physim.control import Report
from physim.validation import report, validate
from tests.validation.runs import LANE, REAR_END


class Saying:
    """Drives as in REAR_END; the fast one, which comes from behind, tells the same each time."""

    def __init__(self, mode=None, **told) -> None:
        self.told = ((Mode.SAFE, Report()), (mode, Report(**told)))

    def decide(self, observation, memory):
        v, omega = REAR_END[observation.index]
        mode, told = self.told[observation.index]
        return Decision(v=v, omega=omega, hold=0.1, mode=mode, report=told)


def words(mode=None, **told):
    record = physim.simulate(physim.parse_world(LANE), controller=Saying(mode, **told))
    return " ".join(report(validate(record)).split())


def test_a_robot_that_says_it_has_arrived_and_drives_on():
    text = words(Mode.ARRIVED, distance=0.5, collision_time=0.1, considered=1)
    assert "fast said that it had arrived, yet its command was to move." in text
    assert "ms before: arrived, v 1.400 m/s" in text
    assert "standing" not in text
    assert "stood" not in text
